"""Each rule about control cards by itself: every axis, both sides of a comparison."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.kit.asked_rules import changed, told
from tests.kit.jobs import film
from vopd import check as control_rules

JOB = film(4)  # frames 1 to 4 of landmarks 11 to 15
EARTH_FT = 20925698.0


@pytest.mark.parametrize("axis", ["east", "north", "up", "both"])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_every_axis_of_a_position_counts_in_its_altitude(axis: str, sign: float) -> None:
    """The distance from the centre of the sphere, less the radius at sea level."""
    x, y, z = {
        "east": (sign * 3e5, 0.0, 1e5),
        "north": (0.0, sign * 3e5, 1e5),
        "up": (0.0, 0.0, 1e5 + sign * 5e4),
        "both": (sign * 2e5, 3e5, 1e5),
    }[axis]
    height = math.hypot(x, y, EARTH_FT + z) - EARTH_FT
    job = changed(
        "trajectory",
        JOB,
        time_s=np.arange(3.0),
        position_ft=np.array([[x, y, z]] * 3),
        velocity_ft_s=np.zeros((3, 3)),
        altitude_ft=height + np.array([0.0, 501.0, -501.0]),
        origin_radius_kft=EARTH_FT / 1000.0,
    )
    words = f"ft; X, Y, Z give {height:.1f} ft on a spherical Earth"
    assert told(control_rules.altitudes, job) == [
        ((7, 1, "H"), f"altitude {height + 501.0:.1f} {words}"),
        ((7, 2, "H"), f"altitude {height - 501.0:.1f} {words}"),
    ]


SIGNS = {  # degrees and minutes: whether their signs differ
    (33.0, 5.0): False, (-33.0, -5.0): False, (33.0, -5.0): True, (-33.0, 5.0): True,
    (33.0, 0.0): False, (-33.0, 0.0): False, (0.0, 5.0): False, (0.0, -5.0): False,
}  # fmt: skip


@pytest.mark.parametrize("angle", SIGNS)
@pytest.mark.parametrize("what", ["longitude", "latitude"])
def test_signs_of_degrees_and_minutes(what: str, angle: tuple[float, float]) -> None:
    """At the landmark of index 3 only."""
    columns = {}
    for name, value in zip(("deg", "min"), angle, strict=True):
        columns[f"{what}_{name}"] = getattr(JOB.landmarks, f"{what}_{name}").copy()
        columns[f"{what}_{name}"][3] = value
    marks = {"longitude_deg": np.ones(5), "longitude_min": np.ones(5),
             "latitude_deg": np.ones(5), "latitude_min": np.ones(5)}  # fmt: skip
    for name, values in columns.items():
        marks[name][3] = values[3]
    found = told(control_rules.signs, changed("landmarks", JOB, **marks))
    field = {"longitude": "THJMI", "latitude": "PHIJMI"}[what]
    degrees, minutes = angle
    words = (
        f"minutes {minutes:g} and degrees {degrees:g} differ in sign: "
        f"read as {degrees + minutes / 60:.5f}"
    )
    assert found == ([((9, 3, field), words)] if SIGNS[angle] else [])


@pytest.mark.parametrize("given", [1, 2, 5])
@pytest.mark.parametrize("index", range(5))
def test_only_the_landmarks_of_this_job_are_questioned(given: int, index: int) -> None:
    """Group 9 gives the last ones; the others stay from a job before."""
    minutes, number = np.ones(5), JOB.landmarks.number.copy()
    minutes[index], number[index] = -6.0, 91
    ones = np.ones(5)
    job = changed(
        "landmarks", JOB, number=number, longitude_deg=ones, longitude_min=minutes,
        latitude_deg=ones, latitude_min=minutes,
    )  # fmt: skip
    job = changed("ignored", job, everywhere=np.zeros(given, np.int64))
    row = index - (5 - given)
    signs = "minutes -6 and degrees 1 differ in sign: read as 0.90000"
    told_of = [((9, row, field), signs) for field in ("THJMI", "PHIJMI")]
    assert told(control_rules.signs, job) == (told_of if row >= 0 else [])
    unused = [((9, row, "ITGT"), "landmark 91 is in no frame")]
    assert told(control_rules.unused_landmarks, job) == (unused if row >= 0 else [])


OUT = {  # landmarks of group 12; those of the film are 11 to 15: whether all are ignored
    (0, 0): False, (11, 12, 13, 14): False, (11, 12, 13, 14, 15): True,
    (15, 14, 0, 13, 12, 11, 99): True, (11, 12, 13, 14, 99): False, (): False,
}  # fmt: skip


@pytest.mark.parametrize("out", OUT)
def test_whether_every_landmark_is_to_be_ignored(out: tuple[int, ...]) -> None:
    job = changed("ignored", JOB, everywhere=np.array(out, np.int64))
    words = "every landmark is to be ignored: the last two of each frame are kept"
    expected = [((12, 0, "IOUT"), words)] if OUT[out] else []
    assert told(control_rules.ignored_all, job) == expected


def test_a_zero_of_group_12_names_no_landmark() -> None:
    numbers = JOB.readings.landmark.copy()
    numbers[numbers == 15] = 0
    job = changed("readings", JOB, landmark=numbers)
    job = changed("ignored", job, everywhere=np.array([11, 12, 13, 14, 0]))
    assert told(control_rules.ignored_all, job) == []
