"""Pages: the report's own, line by line by fortranformat; several jobs; stopped runs; tape 10."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from fortranformat import FortranRecordWriter
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.kit import page_by_fortranformat
from tests.kit.jobs import RESULT_ARRAYS, case, film, with_arrays, without
from tests.kit.page_by_fortranformat import no_leading_zeros
from vopd.errata import fixes
from vopd.job import Clock, Job, Wind
from vopd.listing import pages as module
from vopd.listing.formats import Field, fixed
from vopd.listing.pages import (
    end_of_case,
    end_of_job,
    frame_pages,
    frames_of,
    head,
    listing_text,
    pages,
    pages_of_frames,
    pages_of_jobs,
)
from vopd.listing.tape10 import tape10
from vopd.program.vopd import run
from vopd.results import Outcome, Results

PRINTED = {*RESULT_ARRAYS} - {
    "frame", "outcome", "landmark", "used", "ignored", "start_deg",
    "correction_rad", "last_pass", "singular", "at_centre", "airspeed_ft_s",
    "outside_clock", "outside_trajectory", "outside_wind",
}  # fmt: skip
"""The fields that are real numbers on a page."""


def solved(frames: int) -> Results:
    """A real film of five landmarks a frame."""
    return run(film(frames))


def with_numbers(results: Results, rng: np.random.Generator) -> Results:
    """The same pages with other numbers: of every size, both signs, some that do not fit."""
    new = {}
    for name in sorted(PRINTED):
        shape = getattr(results, name).shape
        size = 10.0 ** rng.uniform(-9.0, 4.0, shape)
        size *= np.where(rng.random(shape) > 0.98, 1e6, 1.0)
        new[name] = size * rng.choice([-1.0, 1.0], shape)
    frames = rng.integers(-999, 9999, results.frame.shape)
    landmark = rng.integers(-9, 99, results.landmark.shape)
    return with_arrays(results, frame=frames, landmark=landmark, **new)


def with_ends(results: Results, rng: np.random.Generator) -> Results:
    """The same with landmarks ignored and frames that end in every way."""
    outcomes = [Outcome.SOLVED, Outcome.DROPPED, Outcome.EXACT, Outcome.EXACT_LATE]
    outcome = rng.choice(outcomes, len(results.frame))
    used = rng.random(results.used.shape) < 0.7
    used[outcome == Outcome.DROPPED] = False
    ignored = ~used & (rng.random(used.shape) < 0.5) & (outcome != Outcome.DROPPED)[:, None]
    residual = np.where(rng.random(results.residual_mm.shape) < 0.5, 0.0, results.residual_mm)
    return with_arrays(results, outcome=outcome, used=used, ignored=ignored, residual_mm=residual)


CASE_1 = (Path(__file__).parent / "case1_page.lst").read_text(encoding="ascii")


def lines(results: Results) -> list[str]:
    """The pages' lines without the title at the end."""
    text = listing_text(results)
    assert text.endswith(results.job.title + "\n")
    return text.removesuffix(results.job.title + "\n").split("\n")


def line_after(results: Results, heading: str) -> str:
    found = lines(results)
    return found[next(k for k, line in enumerate(found) if heading in line) + 1]


def test_the_page_of_case_1() -> None:
    """Character for character, and the title once more when the job is done."""
    assert listing_text(run(case(1))) == CASE_1 + CASE_1.split("\n")[0] + "\n"


def test_an_ignored_frame_has_a_line_and_no_page() -> None:
    """FORMAT 88: three blank lines, no title, no page eject."""
    job = without(film(1), 1)
    assert listing_text(run(job)) == (
        "\n\n\n      FRAME   1IGNORED BY USERS DIRECTION\n" + job.title + "\n"
    )


def test_an_ignored_landmark_has_a_line_in_group_1() -> None:
    """FORMAT 90, before the landmarks that are used, wherever it was read."""
    results = with_arrays(run(film(1)), ignored=np.array([[False, False, False, True, False]]))
    results = with_arrays(results, used=~results.ignored)
    found = lines(results)
    assert found[3] == "   14  IGNORED BY USERS DIRECTION"
    assert [line[:5] for line in found[4:8]] == ["   11", "   12", "   13", "   15"]
    assert sum("14  IGNORED" in line for line in found) == 1


def test_the_end_of_a_run() -> None:
    """FORMAT 105."""
    assert end_of_case() == b"\n\n END OF CASE\n"


def exact(outcome: Outcome) -> Results:
    results = run(film(1))
    return with_arrays(
        results, outcome=np.array([outcome]), residual_mm=np.zeros_like(results.residual_mm)
    )


def test_residuals_that_vanish_before_pass_22() -> None:
    """After group 3: FORMAT 102 for each landmark, two blank lines before it, and FORMAT 103."""
    found = lines(exact(Outcome.EXACT))
    at = next(k for k, line in enumerate(found) if "XCO FINAL" in line) + 6
    pair = "       0.00000000E+00       0.00000000E+00"
    assert found[at:] == ["", "", pair] * 5 + ["", "", "", " END OF JOB", ""]


def test_residuals_that_vanish_in_pass_22() -> None:
    """Groups 4 to 6 are printed already; 102 and 103 follow, and group 7 is missing."""
    found = lines(exact(Outcome.EXACT_LATE))
    whole = lines(exact(Outcome.SOLVED))
    assert found[: len(whole) - 2] == whole[:-2]
    assert whole[-2].startswith("0        STANDARD DEVIATION")
    assert found[len(whole) - 2 : len(whole) + 1] == ["", "", "       0.00000000E+00" * 2]
    assert found[-5:] == ["", "", "", " END OF JOB", ""]


def test_minus_zero_and_small_residuals_that_vanish_print_their_sign() -> None:
    results = exact(Outcome.EXACT)
    results.residual_mm[0, 0] = (-0.0, 0.0)
    assert "      -0.00000000E+00       0.00000000E+00" in lines(results)


@pytest.mark.parametrize(
    ("value", "field"),
    [
        (5.0, "    5.00000"),
        (0.5, "     .50000"),
        (-0.5, "    -.50000"),
        (-0.0000001, "    -.00000"),  # rounds to zero and keeps its sign
        (0.0000001, "     .00000"),
        (0.999996, "    1.00000"),  # rounds up to one
        (-0.999994, "    -.99999"),
        (0.015625, "     .01562"),  # a tie in binary: to the even digit, as printf
        (0.046875, "     .04688"),
        (-0.015625, "    -.01562"),
        (0.000005, "     .00001"),  # 5.0000000000000004E-6: no tie
        (9999.999994, " 9999.99999"),
        (-999.999994, " -999.99999"),
        (9999.999996, " **********"),  # 10000.00000 has eleven characters
        (-999.999996, " **********"),
        (-1000.0, " **********"),
        (1e308, " **********"),
        (np.nan, "        NaN"),
        (np.inf, "   Infinity"),
        (-np.inf, "  -Infinity"),
    ],
)
def test_a_field_by_hand(value: float, field: str) -> None:
    """XPC of group 2 is F10.5 in columns 38 to 47; column 37 belongs to its neighbour's end."""
    results = run(film(1))
    results.vehicle_ft[0] = (1.0, -2.0, 1234567.25)
    results.centre_in[0] = (value, 5.25)
    wanted = f"             1.00     -2.001234567.25{field[1:]}   5.25000  10.40000"
    assert line_after(results, "0VEHICLE") == wanted


def test_numbers_of_more_than_31_bits() -> None:
    """Of eight decimals: 2**31 are 21.47483648 mm."""
    results = run(film(1))
    results.residual_mm[0, 0] = (21.47483647, -21.47483649)
    results.residual_mm[0, 1] = (42.9, -1234.5)
    found = "\n".join(lines(results))
    assert "       21.47483647    -21.47483649" in found
    assert "       42.90000000  -1234.50000000" in found


def test_narrow_fields_and_columns_that_touch() -> None:
    """F7.3 has no place for Infinity but for Inf; ALPHA and BETA touch, as case 4 prints them."""
    results = run(film(1))
    results.centre_mm[0] = (np.inf, -np.inf)
    results.alpha_deg[0], results.beta_deg[0], results.eta_deg[0] = 112.175, -158.836, 1000.0
    results.camera_deg[0] = (0.0004, -0.0004, 359.9996)
    results.vehicle_deg[0] = (99999.9996, -0.5, 360.0)
    results.time_s[0] = -999.9994
    assert line_after(results, "0 FRAME") == (
        "    1 -999.999     .000    -.000  360.000    Inf   -Inf"
        " 100000.000      -.500  360.000 112.175-158.8361000.000"
    )
    results.eta_deg[0] = 9999.9996
    assert line_after(results, "0 FRAME").endswith("-158.836********")


def test_numbers_too_long_for_their_names() -> None:
    """I5, I4, I3 and I10 of landmark 1000, -100; FRAME is I5 on a page."""
    results = run(film(1))
    results.landmark[0, :2] = (1000, -100)
    results.frame[0] = 99999
    found = lines(results)
    assert [line[:5] for line in found[3:5]] == [" 1000", " -100"]
    assert found[11][:4] == "1000"
    assert [line[:4] for line in found[17:19]] == [" ***", " ***"]
    assert found[23][:5] == "99999"
    assert [line[-10:] for line in found[25:27]] == ["      1000", "      -100"]


@settings(max_examples=30)
@given(st.integers(0, 2**32 - 1))
def test_against_fortranformat(seed: int) -> None:
    """Any numbers, any landmarks, frames that end in any way: every line is fortranformat's."""
    rng = np.random.default_rng(seed)
    results = with_ends(with_numbers(solved(6), rng), rng)
    wanted = "".join(page_by_fortranformat.page(results, f) for f in range(6))
    assert listing_text(results) == wanted + results.job.title + "\n"


def test_pages_in_pieces_are_the_listing() -> None:
    """Many frames, more than are made at a time, in their order."""
    one = run(without(film(3), 2))
    many = one.take(np.tile(np.arange(3), 1500))
    pieces = list(pages(many))
    assert len(pieces) > 2
    title = one.job.title + "\n"
    assert b"".join(pieces).decode() == listing_text(one).removesuffix(title) * 1500 + title


def test_a_title_is_printed_as_it_is() -> None:
    """No zero is taken from it."""
    title = "1 TEST 0.5 MM -0.5".ljust(80)
    text = listing_text(run(replace(film(1), title=title)))
    assert text.startswith(title + "\n\n L-MARK")
    assert text.endswith(title + "\n")


@pytest.mark.parametrize(
    ("width", "texts"),
    [
        (4, [" Inf", "-Inf"]),
        (7, ["    Inf", "   -Inf"]),
        (8, ["Infinity", "    -Inf"]),
        (9, [" Infinity", "-Infinity"]),
        (15, ["       Infinity", "      -Infinity"]),
    ],
)
def test_infinity_is_as_long_as_its_field_allows(width: int, texts: list[str]) -> None:
    """As gfortran writes it: the whole word where it fits, with its sign."""
    field = Field("XP", "film", "F", 1, width, 3)
    assert [fixed(value, field) for value in (np.inf, -np.inf)] == texts
    assert fixed(np.nan, field) == "NaN".rjust(width)


# A table out of order (Appendix D)


MESSAGE = (
    "1TABLE BELOW OUT OF ORDER FOR FTLUP AT POSITION     2\n TABLE IS STORED IN LOCATION 000000\n\n"
)
WIND = Wind(np.array([3.0, 2.0]), np.array([[-0.25, 9.0], [1e6, 9.0]]))
WIND_TABLE = (
    "   3.0000000      2.0000000    \n"  # one blank, then 15 columns each
    "  -.25000000      1000000.0    \n"
)


def test_in_the_time_table() -> None:
    """Before group 1: no page at all, not even the title."""
    job = replace(film(1), clock=Clock(np.array([2, 1]), np.array([0.0, 12.5])))
    table = (
        "   2.0000000      1.0000000    \n"  # one blank, then 15 columns each
        "    .0000000      12.500000    \n"
    )
    assert listing_text(run(job)) == MESSAGE + table


def whole_page(job: Job) -> list[str]:
    return listing_text(run(job)).split("\n")


def up_to(page: list[str], heading: str) -> str:
    """The page's lines before that heading."""
    return "\n".join(page[: next(k for k, line in enumerate(page) if heading in line)]) + "\n"


def test_in_the_lens_table() -> None:
    """After group 3, in the first pass of the first frame that is not dropped."""
    job = without(film(2), 1)
    lens = replace(job.camera, lens_radius_mm=job.camera.lens_radius_mm[::-1])
    text = listing_text(run(replace(job, camera=lens)))
    first = "\n\n\n      FRAME   1IGNORED BY USERS DIRECTION\n"
    assert text.startswith(first)
    page, table = text.removeprefix(first).split(MESSAGE)
    wanted = up_to(whole_page(job)[4:], "0L-MARK        X")
    assert page == wanted
    assert [len(line) for line in table.split("\n")] == [121, 121, 121, 16] * 2 + [0]


def test_in_the_wind_table() -> None:
    """After group 4, in pass 22; the title is not printed again."""
    text = listing_text(run(replace(film(1), wind=WIND)))
    page, table = text.split(MESSAGE)
    assert page == up_to(whole_page(film(1)), "0 FRAME   TIME")
    assert table == WIND_TABLE


@pytest.mark.parametrize(
    ("value", "field"),
    [
        # eight digits and four blanks from .1 to 1E8, otherwise an exponent
        (65.0, "  65.000000    "),
        (0.1, "  .10000000    "),
        (-0.12345678, " -.12345678    "),
        (12345678.0, "  12345678.    "),
        (99999999.4, "  99999999.    "),
        (99999999.6, "  .10000000E+09"),  # rounds up to nine digits before the point
        (9999999.96, "  10000000.    "),
        (0.09999999999, "  .10000000    "),  # rounds up to .1
        (0.0999, "  .99900000E-01"),
        (-123456789.0, " -.12345679E+09"),
        (1e99, "  .10000000+100"),  # the letter makes room
        (-1e-101, " -.10000000-100"),
        (0.0, "   .0000000    "),
        (np.inf, "       Infinity"),
    ],
)
def test_a_table_value_by_hand(value: float, field: str) -> None:
    """G15.8; the first value of VARD stands in columns 2 to 16 of the last line."""
    wind = replace(WIND, velocity_ft_s=np.array([[value, 0.0], [1.0, 0.0]]))
    text = listing_text(run(replace(film(1), wind=wind)))
    assert text.split("\n")[-2] == " " + field + "  1.0000000    "


@given(st.lists(st.floats(-1e12, 1e12), min_size=2, max_size=20))
def test_tables_by_fortranformat(values: list[float]) -> None:
    """Format 8G15.8, but for a lost carry (`1000000 .`), zero and ties."""
    wind = Wind(np.full(len(values), 7.0), np.array(values)[:, None] * [1.0, 0.0])
    table = listing_text(run(replace(film(1), wind=wind))).split(MESSAGE)[1]
    writer = FortranRecordWriter("(1X,8G15.8)")
    rows = [values[k : k + 8] for k in range(0, len(values), 8)]
    wanted = [no_leading_zeros(writer.write(row)) for row in rows]
    got = table.split("\n")[len(rows) : -1]
    for ours, theirs, row in zip(got, wanted, rows, strict=True):
        for k, value in enumerate(row):
            digits = f"{abs(value):.30e}".split("e")[0].replace(".", "")
            tie = digits[8:].rstrip("0") == "5"
            field = theirs[1 + 15 * k : 16 + 15 * k]
            if value and not tie and " ." not in field.strip():
                assert ours[1 + 15 * k : 16 + 15 * k] == field


@pytest.mark.parametrize("stopped", [(), (0,), (1,), (2,), (0, 1, 2)])
def test_a_run_of_several_jobs_ends_where_its_last_job_stops(stopped: tuple[int, ...]) -> None:
    """The lines that end a run are printed unless a table stopped the last of its jobs."""
    jobs = [replace(film(1), title=f"1 JOB {k}".ljust(80)) for k in range(3)]
    results = [run(replace(job, wind=WIND) if k in stopped else job) for k, job in enumerate(jobs)]
    alone = [listing_text(one) for one in results]
    end = "" if 2 in stopped else end_of_case().decode()
    assert listing_text(results) == "".join(alone) + end
    assert [one.endswith(WIND_TABLE) for one in alone] == [k in stopped for k in range(3)]
    together = [b"".join(pages).decode() for pages in pages_of_jobs(results)]
    assert together == alone


def test_a_run_without_jobs() -> None:
    assert listing_text([]) == end_of_case().decode()


# Several jobs printed together


@cache
def titled(frames: int, title: str = "1 JOB", focal_mm: float = 10.4) -> Results:
    """A film of so many frames; the focal length is printed and not used again."""
    results = run(film(frames))
    camera = replace(results.job.camera, focal_length_mm=focal_mm)
    job = replace(results.job, title=title.ljust(80), camera=camera)
    return replace(results, job=job)


def run_to_end(results: Results, *outcomes: Outcome) -> Results:
    return replace(results, outcome=np.array(outcomes))


def joined(jobs: Sequence[Results]) -> list[str]:
    return [b"".join(pieces).decode() for pieces in pages_of_jobs(jobs)]


def test_each_job_has_its_own_title_frames_and_focal_length() -> None:
    jobs = [
        titled(2, "1 ONE"),
        titled(1, "1 TWO", 99.5),
        titled(3, "1 THREE", 7.25),
    ]
    made = joined(jobs)
    for text, one, name in zip(made, jobs, ("ONE", "TWO", "THREE"), strict=True):
        lines = text.split("\n")
        titles = [line for line in lines if line.startswith("1")]
        assert titles == [f"1 {name}".ljust(80)] * (len(one.frame) + 1)
        assert lines[-2] == titles[0] and lines[-1] == ""
        vehicles = [lines[k + 1] for k, line in enumerate(lines) if line.startswith("0VEHICLE")]
        focal = {"ONE": "10.40000", "TWO": "99.50000", "THREE": "7.25000"}[name]
        assert [line[57:67].strip() for line in vehicles] == [focal] * len(one.frame)
        frames = [lines[k + 1][:5] for k, line in enumerate(lines) if line.startswith("0 FRAME")]
        assert [int(frame) for frame in frames] == one.frame.tolist()


@pytest.mark.parametrize("chunk", [1, 2, 3, 1000])
def test_long_jobs_are_printed_in_pieces_and_short_ones_together(
    chunk: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The text is the same; a piece has at most so many pages."""
    jobs = [
        titled(1, "1 A"),
        titled(2, "1 LONGER" + "X" * 20),
        titled(3, "1 B"),
        titled(1, "1 C"),
    ]
    alone = [listing_text(one) for one in jobs]
    monkeypatch.setattr(module, "CHUNK", chunk)
    assert joined(jobs) == alone
    for one, text in zip(jobs, alone, strict=True):
        pieces = [piece.decode() for piece in pages(one)]
        assert "".join(pieces) == text and pieces[-1] == one.job.title + "\n"
        counts = [piece.count("0VEHICLE") for piece in pieces[:-1]]
        frames = len(one.frame)
        assert counts == [min(chunk, frames - k) for k in range(0, frames, chunk)]


@pytest.mark.parametrize(
    ("first", "last"), [(0, None), (1, None), (0, 2), (1, 3), (2, 3), (1, 1), (0, 4)]
)
@pytest.mark.parametrize("chunk", [2, 1000])
def test_some_of_the_frames(
    first: int, last: int | None, chunk: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = pages_of_frames(frames_of([titled(4)]))
    monkeypatch.setattr(module, "CHUNK", chunk)
    assert b"".join(frame_pages(titled(4), first, last)) == b"".join(whole[first:last])


def test_frames_that_end_in_different_ways_stand_in_their_order() -> None:
    ends = Outcome.SOLVED, Outcome.DROPPED, Outcome.EXACT, Outcome.EXACT_LATE, Outcome.SOLVED
    results = run_to_end(titled(5), *ends)
    made = [page.decode() for page in pages_of_frames(frames_of([results]))]
    all_groups = ["L-MARK LONG", "VEHICLE", "XCO", "R DIST", "PSI", "RESIDUALS "]
    words = [*all_groups, "END OF JOB", "STANDARD", "IGNORED"]
    groups = [[word for word in words if word in page] for page in made]
    assert groups == [
        [*all_groups, "STANDARD"], ["IGNORED"], [*all_groups[:3], "END OF JOB"],
        [*all_groups, "END OF JOB"], [*all_groups, "STANDARD"],
    ]  # fmt: skip
    for k in (0, 3, 4):
        assert made[k].split("\n0 FRAME")[1].split("\n")[1].startswith(f"{k + 1:5d}")
    assert made[1] == "\n\n\n      FRAME   2IGNORED BY USERS DIRECTION\n"


def test_frames_with_other_numbers_of_landmarks() -> None:
    """Some ignored, which have their line in group 1; some that were not read."""
    used = np.ones((3, 5), bool)
    ignored = np.zeros((3, 5), bool)
    used[1, 2], used[2, :3], ignored[2, 0] = False, False, True
    made = pages_of_frames(frames_of([with_arrays(titled(3), used=used, ignored=ignored)]))
    counts = []
    for page in made:
        blocks = page.decode().split("\n0")
        counts.append((
            blocks[0].count("\n") - 2, blocks[0].count("IGNORED"), blocks[2].count("\n"),
            blocks[3].count("\n"), blocks[5].count("\n"),
        ))  # fmt: skip
    assert counts == [(5, 0, 5, 5, 5), (4, 0, 4, 4, 4), (3, 1, 2, 2, 2)]


def test_residuals_that_vanish_are_printed_of_landmarks_that_take_part() -> None:
    used = np.ones((2, 5), bool)
    used[0, 1], used[1, 2:] = False, False
    ends = run_to_end(titled(2), Outcome.EXACT, Outcome.EXACT_LATE)
    results = with_arrays(ends, used=used, residual_mm=np.arange(20.0).reshape(2, 5, 2))
    first, second = (page.decode() for page in pages_of_frames(frames_of([results])))
    wanted = "".join(f"\n\n{x:21.8E}{x + 1:21.8E}\n" for x in (0.0, 4.0, 6.0, 8.0))
    assert first.endswith(f"{wanted}\n\n\n END OF JOB\n") and first.count("E+00") == 8
    wanted = "".join(f"\n\n{x:21.8E}{x + 1:21.8E}\n" for x in (10.0, 12.0))
    assert second.endswith(f"{wanted}\n\n\n END OF JOB\n") and second.count("E+01") == 4


def test_a_corrected_run_says_so_below_each_title() -> None:
    """At the end of the job too; the original's numbers have the title alone."""
    original, corrected = run(film(2)), run(film(2), fixes("first-landmark"))
    title = original.job.title
    assert head(original) == title
    assert head(corrected) == f"{title}\n CORRECTED RUN, NOT THE ORIGINAL: first-landmark"
    assert end_of_job(corrected) == f"{head(corrected)}\n".encode()
    text = listing_text(corrected)
    assert text.count(f"{head(corrected)}\n") == 3 and text.count(title) == 3
    assert text.startswith(f"{head(corrected)}\n\n L-MARK")
    both = joined([original, corrected, original])
    assert both == [listing_text(one) for one in (original, corrected, original)]


def test_a_dropped_frame_beside_others() -> None:
    """Its line stands between the pages, without a title."""
    results = run(without(film(3), 2))
    text = listing_text(results)
    assert text.count(results.job.title) == 3
    first, rest = text.split("\n\n\n      FRAME   2IGNORED BY USERS DIRECTION\n")
    assert first.count("0VEHICLE") == rest.count("0VEHICLE") == 1


# Tape 10


RECORD = struct.Struct("<i7di")
"""What a FORTRAN program writes: the length, seven numbers, the length."""


def test_case_4_has_two_records_of_the_printed_numbers() -> None:
    """Frame 55 is ignored; the report prints frames 60 and 65."""
    records = list(RECORD.iter_unpack(tape10(run(case(4)))))
    assert [(first, last) for first, *_, last in records] == [(56, 56), (56, 56)]
    assert [[f"{number:.3f}" for number in record[1:-1]] for record in records] == [
        ["-0.697", "225.133", "-86.339", "181.954", "112.219", "-156.597", "111.912"],
        ["-0.612", "225.465", "-86.386", "181.407", "112.175", "-158.836", "111.930"],
    ]


def test_only_frames_that_reach_the_end_of_pass_22_are_on_it() -> None:
    """A frame whose residuals vanish earlier is not, one whose residuals vanish in pass 22 is."""
    results = run(film(5))
    outcome = np.array(
        [Outcome.SOLVED, Outcome.DROPPED, Outcome.EXACT, Outcome.EXACT_LATE, Outcome.STOPPED]
    )
    records = RECORD.iter_unpack(tape10(replace(results, outcome=outcome)))
    assert [record[1] for record in records] == results.time_s[[0, 3]].tolist()


def test_the_seven_numbers_of_a_record() -> None:
    """Time, vehicle yaw, pitch, roll, alpha, beta, eta; not the camera's angles."""
    results = run(film(2))
    numbers = np.arange(14.0).reshape(2, 7) / 3.0
    alpha, beta, eta = numbers[:, 4:].T
    changed = replace(
        results, time_s=numbers[:, 0], vehicle_deg=numbers[:, 1:4], alpha_deg=alpha,
        beta_deg=beta, eta_deg=eta, camera_deg=np.full((2, 3), 99.0),
    )  # fmt: skip
    assert tape10(changed) == b"".join(RECORD.pack(56, *row, 56) for row in numbers.tolist())
