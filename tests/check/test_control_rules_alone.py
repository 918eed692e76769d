"""Each rule about control cards by itself: every axis and table, both sides of a comparison."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.kit.asked_rules import Asked, changed, told
from tests.kit.jobs import film, without
from vopd.check import control_rules

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


TABLES = {  # part, array, group and field
    "frames": ("clock", "frame", 6, "IFRM"),
    "times": ("trajectory", "time_s", 7, "TX"),
    "radii": ("camera", "lens_radius_mm", 1, "XRR"),
    "altitudes": ("wind", "altitude_ft", 4, "ALT"),
}


@pytest.mark.parametrize("how", ["falls", "repeats"])
@pytest.mark.parametrize("name", TABLES)
def test_the_first_row_that_does_not_exceed_the_one_before(name: str, how: str) -> None:
    """Frames that are dropped are not corrected for the lens or the wind; they do have a time."""
    part, array, group, field = TABLES[name]
    table = getattr(getattr(JOB, part), array).copy()
    for row in {1, len(table) - 1}:
        bad = table.copy()
        bad[row] = bad[row - 1] - (3 if how == "falls" else 0)
        job = changed(part, JOB, **{array: bad})
        words = f"{bad[row]:g} does not exceed {bad[row - 1]:g}: "
        for dropped in ((), (1, 2, 3, 4)):
            unused = dropped and name in ("radii", "altitudes")
            severity = "warning" if unused else "error"
            end = "no frame uses this table" if unused else "the run would stop here"
            asked = Asked()
            (found,) = control_rules.tables_in_order(without(job, *dropped), asked, None)
            assert (asked.named, found.severity) == ([(group, row, field)], severity)
            assert found.message == words + end


@pytest.mark.parametrize("other", TABLES)
@pytest.mark.parametrize("name", TABLES)
def test_two_tables_out_of_order_are_two_errors(name: str, other: str) -> None:
    """Whichever of them a run would come to first."""
    job = JOB
    for part, array, _, _ in {TABLES[name], TABLES[other]}:
        table = getattr(getattr(job, part), array).copy()
        table[-1] = table[-2]
        job = changed(part, job, **{array: table})
    found = list(control_rules.tables_in_order(job, Asked(), None))
    assert len(found) == len({name, other})
    assert {one.severity for one in found} == {"error"}


@pytest.mark.parametrize("row", [0, 1, -1])
@pytest.mark.parametrize("name", ["times", "radii", "altitudes"])
def test_a_table_that_holds_no_number_is_not_out_of_order(name: str, row: int) -> None:
    """The field has an error of its own."""
    part, array, _, _ = TABLES[name]
    table = getattr(getattr(JOB, part), array).copy()
    table[row] = np.nan
    assert told(control_rules.tables_in_order, changed(part, JOB, **{array: table})) == []


ENDS = {  # first and last frame of the table of group 6: what is said of frames 1 to 4
    (1, 4): [],
    (0, 5): [],
    (2, 4): [(0, "1 frame is", "frame 1")],
    (3, 9): [(0, "2 frames are", "frame 1")],
    (1, 3): [(1, "1 frame is", "frame 4")],
    (0, 1): [(1, "3 frames are", "frame 4")],
    (2, 3): [(0, "1 frame is", "frame 1"), (1, "1 frame is", "frame 4")],
    (7, 9): [(0, "4 frames are", "frame 1")],
}


@pytest.mark.parametrize("ends", ENDS)
def test_how_many_frames_are_outside_a_table(ends: tuple[int, int]) -> None:
    first, last = ends
    job = changed("clock", JOB, frame=np.array(ends), time_s=np.array([first - 1.0, last - 1.0]))
    found = [one for one in told(control_rules.tables_span, job) if one[0][0] == 6]
    words = "outside this table, which is extrapolated:"
    assert found == [
        ((6, row, "IFRM"), f"{count} {words} {what}") for row, count, what in ENDS[ends]
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
