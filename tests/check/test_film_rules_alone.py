"""Each rule about the film by itself: every axis, both sides of what it compares."""

from __future__ import annotations

import numpy as np
import pytest

from tests.kit.asked_rules import changed, told
from tests.kit.jobs import film, without
from vopd import check as film_rules

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


RADII: dict[
    tuple[float, ...], int | None
] = {  # of the lens table, mm; a landmark is 10 mm from the centre: index of the card named
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


@pytest.mark.parametrize("frame", range(4))
@pytest.mark.parametrize(("short_in", "said"), [(0.049, False), (0.051, True), (-0.051, True)])
def test_corners_of_every_frame(frame: int, short_in: float, said: bool) -> None:
    """Two corners are 5 in from the centre, and two by so much less."""
    far = 5.0 - short_in
    square = np.array([[5.0, 0.0], [0.0, 5.0], [-5.0, 0.0], [0.0, -5.0]]) + 7.0
    fiducial = np.repeat(np.tile(square, (4, 1, 1))[:, :, None], 3, axis=2)
    fiducial[frame, 1, :, 1], fiducial[frame, 3, :, 1] = 7.0 + far, 7.0 - far
    fiducial[:, 2, :, 0] += [0.06, 0.06, -0.12]  # the mean of three readings counts
    numbers = np.array([11, 13, 12, 14])
    job = changed("readings", JOB, fiducial_in=fiducial, frame=numbers)
    low, high = min(5.0, far), max(5.0, far)
    words = (
        f"the fiducials of frame {numbers[frame]} form no rectangle: "
        f"{low:.3f} to {high:.3f} in from their centre"
    )
    assert told(film_rules.fiducials, job) == ([((0, 27 * frame, ""), words)] if said else [])


def test_copied_readings_are_told_at_the_first_card() -> None:
    copied = {
        name: np.repeat(getattr(JOB.readings, name)[:, :, :1], 3, axis=2)
        for name in ("fiducial_in", "landmark_in")
    }
    (found,) = told(film_rules.copied_readings, changed("readings", JOB, **copied))
    assert found[0] == (0, 0, "") and "readings" in found[1]
    spread = {name: values + np.arange(3)[:, None] * 0.002 for name, values in copied.items()}
    assert told(film_rules.copied_readings, changed("readings", JOB, **spread)) == []


def test_the_limit_of_a_short_film_is_not_zero_where_zero_is_asked_for() -> None:
    """No limit asked for is another thing than a limit of nothing."""
    points = np.full((4, 5, 3, 2), 5.0)
    points[2, 1, 0, 0] = 5.001
    job = changed("readings", JOB, landmark_in=points, fiducial_in=np.full((4, 4, 3, 2), 5.0))
    assert told(film_rules.reading_spread, job) == []
    words = "three readings of this point differ by 0.001 in (limit 0.000 in)"
    expected = [((0, 2 * 27 + 12 + 3, "XSAVE"), words)]
    assert told(film_rules.reading_spread, job, 0.0) == expected


def test_the_outermost_landmark_that_takes_part() -> None:
    """Landmark 11 is farther, and ignored; where every frame is dropped there is none."""
    away = np.array([[6.0, -8.0], [8.0, 0.0], [-3.0, 0.0], [0.0, -3.0], [3.0, 3.0]]) / MM_PER_INCH
    job = film(1)
    points = np.repeat((away + 7.0)[None, :, None], 3, axis=2)
    job = changed("readings", job, fiducial_in=np.full((1, 4, 3, 2), 7.0), landmark_in=points)
    table = np.array([0.0, 7.0])
    job = changed("camera", job, lens_radius_mm=table, lens_distortion_um=np.zeros(2))
    ignoring = changed("ignored", job, everywhere=np.array([11]))
    words = "a landmark is 8.00 mm from the centre: the lens table is extrapolated"
    assert told(film_rules.lens_reach, ignoring) == [((1, 1, "XRR"), words)]
    assert told(film_rules.lens_reach, without(job, 1)) == []
