"""The rules about tables by themselves: out of order, without a number, and too short."""

from __future__ import annotations

import numpy as np
import pytest

from tests.kit.asked_rules import Asked, changed, told
from tests.kit.jobs import film, without
from vopd import check as control_rules

JOB = film(4)  # frames 1 to 4 of landmarks 11 to 15


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


@pytest.mark.parametrize("ends", [(9, 2), (3, 3), (4, 1)])
def test_frames_are_outside_no_table_that_is_out_of_order(ends: tuple[int, int]) -> None:
    job = changed("clock", JOB, frame=np.array(ends), time_s=np.array([0.0, 1.0]))
    assert told(control_rules.tables_span, job) == []
