"""Pages: the report's own, line by line by fortranformat, and how frames and runs end."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.kit import page_by_fortranformat
from tests.kit.jobs import RESULT_ARRAYS, case, film, with_arrays, without
from vopd.listing.formats import Field, fixed
from vopd.listing.pages import end_of_case, listing_text, pages
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
