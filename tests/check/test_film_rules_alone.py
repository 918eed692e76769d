"""Each rule about the film by itself: every axis, both sides of what it compares."""

from __future__ import annotations

import numpy as np
import pytest

from tests.kit.asked_rules import changed, told
from tests.kit.jobs import film, without
from vopd.check import film_rules

JOB = film(4)  # frames 1 to 4 of landmarks 11 to 15
MM_PER_INCH = 0.713816400205


@pytest.mark.parametrize("axis", [0, 1])
def test_readings_just_at_the_limit_are_not_questioned(axis: int) -> None:
    """Whatever the binary fraction: of 0.037 and 0.017 the difference exceeds .020 in bits."""
    job = film(1)
    low = np.arange(1, 9000, 7)
    exact = low / 1000.0
    assert ((low + 20) / 1000.0 - exact > 0.02).any()
    for k in range(0, len(low) - 5, 5):
        points = np.full((1, 5, 3, 2), 5.0)
        points[0, :, :, axis] = exact[k : k + 5, None]
        points[0, :, 1, axis] = (low[k : k + 5] + 20) / 1000.0
        at = changed("readings", job, landmark_in=points)
        rule = film_rules.reading_spread
        assert [one for one in told(rule, at, 0.02) if one[0][1] >= 12] == []
    points[0, 2, 0, axis] -= 0.001
    (found,) = (
        one
        for one in told(
            film_rules.reading_spread, changed("readings", job, landmark_in=points), 0.02
        )
        if one[0][1] >= 12
    )
    words = "three readings of this point differ by 0.021 in (limit 0.020 in)"
    assert found == ((0, 12 + 3 * 2, ("XSAVE", "YSAVE")[axis]), words)


RADII = {  # of the lens table, mm; a landmark is 10 mm from the centre: index of the card named
    (0.0, 5.0, 9.99): 2,
    (0.0, 5.0, 10.01): None,
    (0.0, 9.99, 5.0): 1,
    (0.0, 10.01, 5.0): None,
    (9.99, 0.0, 5.0): 0,
}


@pytest.mark.parametrize("out", [False, True])
@pytest.mark.parametrize("radii", RADII)
def test_the_reach_of_the_lens_table(radii: tuple[float, ...], out: bool) -> None:
    """Its largest radius counts, and only landmarks that take part: number 11 may be ignored."""
    job = film(1)
    away = np.array([[6.0, -8.0], [3.0, 0.0], [-3.0, 0.0], [0.0, -3.0], [3.0, 3.0]]) / MM_PER_INCH
    centre = np.array([7.0, 5.0])
    corners = centre + np.array([[-5.0, -4.0], [5.0, -4.0], [5.0, 4.0], [-5.0, 4.0]])
    readings = {
        "fiducial_in": corners[None, :, None],
        "landmark_in": (centre + away)[None, :, None],
    }
    three = {name: np.repeat(values, 3, axis=2) for name, values in readings.items()}
    job = changed("readings", job, **three)
    job = changed("camera", job, lens_radius_mm=np.array(radii), lens_distortion_um=np.zeros(3))
    job = changed("ignored", job, everywhere=np.array([11 * out, 0, 0, 0, 0]))
    row = None if out else RADII[radii]
    words = "a landmark is 10.00 mm from the centre: the lens table is extrapolated"
    assert told(film_rules.lens_reach, job) == ([] if row is None else [((1, row, "XRR"), words)])


FEW = {  # landmarks of frame 2; whether it is dropped; landmarks ignored: the one that is left
    "five": ((11, 12, 13, 14, 15), False, (), None),
    "one": ((13, 13, 13, 13, 13), False, (), 13),
    "two": ((13, 13, 13, 13, 14), False, (), None),
    "one of a frame that is dropped": ((13, 13, 13, 13, 13), True, (), None),
    "one beside another that is ignored": ((12, 13, 13, 13, 13), False, (12,), 13),
}


@pytest.mark.parametrize("name", FEW)
def test_different_landmarks_that_take_part(name: str) -> None:
    landmarks, dropped, ignored, left = FEW[name]
    numbers = JOB.readings.landmark.copy()
    numbers[1] = landmarks
    job = changed("readings", without(JOB, 2) if dropped else JOB, landmark=numbers)
    job = changed("ignored", job, everywhere=np.array([*ignored, 0]))
    words = f"frame 2 has only landmark {left}; an attitude needs two different landmarks"
    assert told(film_rules.too_few_landmarks, job) == ([((0, 27, ""), words)] if left else [])
