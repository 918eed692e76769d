"""Each rule of `vopd check` by itself: every axis, both sides of what it compares."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit.jobs import film, reread, without
from vopd import check as control_rules
from vopd import check as film_rules
from vopd.check import CardLocations
from vopd.findings import Finding
from vopd.job import Job

Rule = Callable[..., Iterator[Finding]]
Told = list[tuple[tuple[int, int, str], str]]


class Asked(CardLocations):
    """Keeps which card and field of a group a rule names."""

    def __init__(self) -> None:
        self.named: list[tuple[int, int, str]] = []

    def warning(self, group: int, row: int, field: str, message: str) -> Finding:
        self.named.append((group, row, field))
        return Finding(message).warned()


def told(rule: Rule, job: Job, *limit: float) -> Told:
    """What a rule says of a job: group, index of the card, field; message."""
    asked = Asked()
    messages = [one.message for one in rule(job, asked, *limit)]
    return list(zip(asked.named, messages, strict=True))


def changed(part: str, job: Job, **values: Any) -> Job:
    """The job with some arrays of one of its parts replaced."""
    change = reread if part == "readings" else replace
    return replace(job, **{part: change(getattr(job, part), **values)})


# The film


JOB = film(4)  # frames 1 to 4 of landmarks 11 to 15
MM_PER_INCH = 0.713816400205


@pytest.mark.parametrize("axis", [0, 1])
def test_beside_a_reading_that_is_no_number_the_other_axis_is_named(axis: int) -> None:
    """It said that readings differ by nan."""
    read = JOB.readings.fiducial_in.copy()
    read[1, 2, 0, axis], read[1, 2, 1, 1 - axis] = np.nan, read[1, 2, 0, 1 - axis] + 5.0
    ((where, said),) = told(film_rules.reading_spread, changed("readings", JOB, fiducial_in=read))
    assert where[2] == ("YSAVE", "XSAVE")[axis] and "differ by 5.0" in said


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
    assert_approved(found)


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
    found = told(film_rules.lens_reach, job)
    assert bool(found) == (row is not None)
    assert_approved(found)


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
    found = told(film_rules.too_few_landmarks, job)
    assert bool(found) == bool(left)
    assert_approved(found)


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
    found = told(film_rules.fiducials, job)
    assert bool(found) == bool(said)
    assert_approved(found, parts=[f"{low:.3f}", f"{high:.3f}"] if said else [])


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
    assert_approved(told(film_rules.reading_spread, job, 0.0))


def test_the_outermost_landmark_that_takes_part() -> None:
    """Landmark 11 is farther, and ignored; where every frame is dropped there is none."""
    away = np.array([[6.0, -8.0], [8.0, 0.0], [-3.0, 0.0], [0.0, -3.0], [3.0, 3.0]]) / MM_PER_INCH
    job = film(1)
    points = np.repeat((away + 7.0)[None, :, None], 3, axis=2)
    job = changed("readings", job, fiducial_in=np.full((1, 4, 3, 2), 7.0), landmark_in=points)
    table = np.array([0.0, 7.0])
    job = changed("camera", job, lens_radius_mm=table, lens_distortion_um=np.zeros(2))
    ignoring = changed("ignored", job, everywhere=np.array([11]))
    assert_approved(told(film_rules.lens_reach, ignoring))
    assert told(film_rules.lens_reach, without(job, 1)) == []


@pytest.mark.parametrize(("first", "card"), [(2.99, None), (3.01, 0), (7.5, 1)])
def test_the_innermost_landmark_is_in_the_lens_table_too(first: float, card: int | None) -> None:
    """A run warns of either end; the nearest is 3 mm from the centre, the farthest 8."""
    away = np.array([[8.0, 0.0], [0.0, 8.0], [-3.0, 0.0], [0.0, -3.0], [3.0, 3.0]]) / MM_PER_INCH
    points = np.repeat((away + 7.0)[None, :, None], 3, axis=2)
    job = changed("readings", film(1), fiducial_in=np.full((1, 4, 3, 2), 7.0), landmark_in=points)
    table = np.array([first, 9.0] if card != 1 else [9.0, first])
    job = changed("camera", job, lens_radius_mm=table, lens_distortion_um=np.zeros(2))
    found = told(film_rules.lens_reach, job)
    assert [where for where, _ in found] == ([] if card is None else [(1, card, "XRR")])
    assert all("3.00 mm" in said for _, said in found)


# Control cards


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
    assert_approved(
        told(control_rules.altitudes, job),
        parts=[f"{height + 501.0:.1f}", f"{height - 501.0:.1f}"],
    )


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
    degrees, minutes = angle
    assert bool(found) == bool(SIGNS[angle])
    assert_approved(
        found,
        parts=[f"{minutes:g}", f"{degrees:g}", f"{degrees + minutes / 60:.5f}"]
        if SIGNS[angle]
        else [],
    )


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
    found = told(control_rules.signs, job)
    assert bool(found) == (row >= 0)
    assert_approved(found)
    found = told(control_rules.unused_landmarks, job)
    assert bool(found) == (row >= 0)
    assert_approved(found)


OUT = {  # landmarks of group 12; those of the film are 11 to 15: whether all are ignored
    (0, 0): False, (11, 12, 13, 14): False, (11, 12, 13, 14, 15): True,
    (15, 14, 0, 13, 12, 11, 99): True, (11, 12, 13, 14, 99): False, (): False,
}  # fmt: skip


@pytest.mark.parametrize("out", OUT)
def test_whether_every_landmark_is_to_be_ignored(out: tuple[int, ...]) -> None:
    job = changed("ignored", JOB, everywhere=np.array(out, np.int64))
    found = told(control_rules.ignored_all, job)
    assert bool(found) == bool(OUT[out])
    assert_approved(found)


def test_a_zero_of_group_12_names_no_landmark() -> None:
    numbers = JOB.readings.landmark.copy()
    numbers[numbers == 15] = 0
    job = changed("readings", JOB, landmark=numbers)
    job = changed("ignored", job, everywhere=np.array([11, 12, 13, 14, 0]))
    assert told(control_rules.ignored_all, job) == []


# Tables


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
        for dropped in ((), (1, 2, 3, 4)):
            unused = dropped and name in ("radii", "altitudes")
            severity = "warning" if unused else "error"
            asked = Asked()
            (found,) = control_rules.tables_in_order(without(job, *dropped), asked)
            assert (asked.named, found.severity) == ([(group, row, field)], severity)
            assert_approved(found.message, parts=[f"{bad[row]:g}", f"{bad[row - 1]:g}"])


@pytest.mark.parametrize("other", TABLES)
@pytest.mark.parametrize("name", TABLES)
def test_two_tables_out_of_order_are_two_errors(name: str, other: str) -> None:
    """Whichever of them a run would come to first."""
    job = JOB
    for part, array, _, _ in {TABLES[name], TABLES[other]}:
        table = getattr(getattr(job, part), array).copy()
        table[-1] = table[-2]
        job = changed(part, job, **{array: table})
    found = list(control_rules.tables_in_order(job, Asked()))
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
    assert_approved(found)


@pytest.mark.parametrize("ends", [(9, 2), (3, 3), (4, 1)])
def test_frames_are_outside_no_table_that_is_out_of_order(ends: tuple[int, int]) -> None:
    job = changed("clock", JOB, frame=np.array(ends), time_s=np.array([0.0, 1.0]))
    assert told(control_rules.tables_span, job) == []


@pytest.mark.parametrize(
    ("focal_mm", "warned"), [(1e-3, False), (0.0, True), (-10.4, True), (float("nan"), False)]
)
def test_a_focal_length_is_above_0(focal_mm: float, warned: bool) -> None:
    found = told(control_rules.focal_length, changed("camera", JOB, focal_length_mm=focal_mm))
    assert [at for at, _ in found] == [(8, 0, "CC")] * warned
    assert_approved([text for _, text in found])
