"""Listings made by hand from the report's case 1, with each kind of difference."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from decimal import Decimal
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.approved.texts import refused
from vopd.findings import VopdError
from vopd.listing import compare as listings
from vopd.listing.compare import Comparison, Difference, compare_listings
from vopd.listing.lines import ListingPage, page_cost

PAGE = (Path(__file__).parents[1] / "listing" / "case1_page.lst").read_text(encoding="ascii")
LINES = PAGE.splitlines()
END = LINES[0] + "\n\n\n END OF CASE\n"

LANDMARK = "L-MARK LONGITUDE LAT-GOCN RAD_ER_KM LAT-GODT ALTITUDE-FT XLAM XMU XNU"
ATTITUDE = "FRAME TIME SIG1 SIG2 SIG3 XP YP PSI THETA PHI ALPHA BETA ETA"
NAMES = {
    **dict.fromkeys((4, 5, 6), LANDMARK),
    8: "X Y Z XPC YPC CC",
    **dict.fromkeys((10, 11, 12), "L-MARK XCO_FINAL YCO_FINAL"),
    **dict.fromkeys((14, 15, 16), "L-MARK X Y R_DIST DELTA_R"),
    18: ATTITUDE,
    **dict.fromkeys((20, 21, 22), "RX(I) RY(I) L-MARK"),
}
"""The page's rows of numbers by line, and what the headings above them say."""

ABOUT = {
    line: 65 + k for start in (4, 10, 14, 20) for k, line in enumerate(range(start, start + 3))
}
"""The landmark that each row is about."""


def fields() -> Iterator[tuple[int, re.Match[str], str]]:
    """Line, place and name of every number; on this page none of them touch."""
    for line, names in NAMES.items():
        found = re.finditer(r"\S+", LINES[line - 1])
        for match, name in zip(found, names.split(), strict=True):
            yield line, match, name.replace("_", " ")
    deviation = re.search(r"\.11718", LINES[22])
    assert deviation is not None
    yield 23, deviation, "STANDARD DEVIATION"


FIELDS = list(fields())


def page(changes: Mapping[int, str | None] | None = None) -> str:
    """The page with some lines replaced; None takes a line out."""
    lines = {**dict(enumerate(LINES, 1)), **(changes or {})}
    return "".join(f"{text}\n" for text in lines.values() if text is not None)


def put(line: int, old: str, new: str) -> str:
    """The page with one piece of one line replaced by another of the same length."""
    text = LINES[line - 1]
    assert text.count(old) == 1 and len(old) == len(new)
    return page({line: text.replace(old, new)})


def only(result: Comparison) -> Difference:
    (difference,) = result.differences
    return difference


def frame(number: int, shift: int = 0) -> str:
    """The page as another frame; `shift` is added to all last digits, so every row changes."""
    text = PAGE.replace("  730 ", f"{number:5d} ")
    return re.sub(r"(\.\d*?)(\d)(?!\d)", lambda m: m[1] + str((int(m[2]) + shift) % 10), text)


def test_the_sample_page_has_81_fields() -> None:
    # title 1, landmarks 3 * 9, vehicle 6, readings 3 * 3, film 3 * 5, attitude 13, residuals 3 * 3,
    # deviation 1
    assert len(FIELDS) == 80
    result = compare_listings(PAGE, PAGE, units=0)
    assert result == Comparison(pages=1, fields_compared=81)


@pytest.mark.parametrize("units", [0, 1])
def test_every_single_digit_matters_and_is_named(units: int) -> None:
    flips = 0
    for line, match, name in FIELDS:
        for at in range(*match.span()):
            text = LINES[line - 1]
            if not text[at].isdigit():
                continue
            for digit in "0123456789".replace(text[at], ""):
                wrong = text[:at] + digit + text[at + 1 :]
                result = compare_listings(PAGE, page({line: wrong}), units=units)
                neighbour = abs(int(digit) - int(text[at])) == 1 and at == match.end() - 1
                if units and neighbour and name not in ("L-MARK", "FRAME"):
                    assert not result.differences
                    continue
                flips += 1
                found = only(result)
                assert (found.kind, found.field) == ("field", name)
                assert (found.page, found.frame) == (1, "730")
                assert (found.expected_line, found.actual_line) == (line, line)
                assert found.landmark == str(ABOUT.get(line, ""))
                assert found.expected == match[0]
                assert found.actual == wrong[slice(*match.span())]
                assert result.fields_compared == 81
    assert flips > 3000


def test_distance_is_told_in_units_of_the_last_digit() -> None:
    found = only(compare_listings(PAGE, put(15, "-.04424", "-.04431")))
    assert found.off_by == 7
    assert str(found) == (
        "page 1, frame 730, line 15, landmark 66, DELTA R: "
        "expected -.04424, actual -.04431 (off by 0.00007 mm)"
    )


@pytest.mark.parametrize(
    ("units", "actual", "same"),
    [
        (1, ".11719", True),
        (1, ".11717", True),
        (1, ".11720", False),
        (2, ".11720", True),
        (2.5, ".11720", True),
        (1.5, ".11720", False),
        (0.5, ".11719", False),
        (0, ".11719", False),
        (0, ".11718", True),
        ("0.5", ".11719", False),
        (Decimal(3), ".11715", True),
        (Decimal("2.999"), ".11715", False),
    ],
)
def test_units_are_exact(units: float, actual: str, same: bool) -> None:
    result = compare_listings(PAGE, put(23, ".11718", actual), units=units)
    assert (not result.differences) is same


@pytest.mark.parametrize("units", [-1, float("nan"), float("inf"), "two"])
def test_units_that_are_no_measure(units: float) -> None:
    with refused(VopdError):
        compare_listings(PAGE, PAGE, units=units)


def test_names_are_not_measures() -> None:
    # 66 for 65 is one unit of the last digit, and another landmark
    found = only(compare_listings(PAGE, put(10, "65    10", "64    10"), units=5))
    assert (found.field, found.landmark, found.actual) == ("L-MARK", "65", "64")


def test_fields_may_touch() -> None:
    # case 4, frame 65, of the report: ALPHA and BETA leave no blank between them
    row = (
        "   65    -.612  225.465  -86.386  181.407  5.130  3.742    225.465    -86.386"
        "  181.407 112.175-158.836 111.930"
    )
    wrong = row.replace("-158.836", "-158.838")
    found = only(compare_listings(page({18: row}), page({18: wrong})))
    assert (found.frame, found.field) == ("65", "BETA")
    assert (found.expected, found.actual) == ("-158.836", "-158.838")
    assert found.off_by == 2


@pytest.mark.parametrize(
    ("old", "one", "other", "apart"),
    [
        ("285.837", "359.999", "   .000", 1),  # SIG3
        ("  195.270  -38", "  360.000  -38", "     .001  -38", 1),  # SIG1
        ("    195.270    -", "       .000    -", "    359.998    -", 2),  # PSI
        (" 75.837", "359.999", "   .001", 2),  # PHI
        ("  -38.653  285", "  180.000  285", " -179.999  285", 1),  # SIG2
        ("   -38.653   75", "   180.000   75", "  -180.000   75", 0),  # THETA
        ("  -4.916", " 179.999", "-180.000", 1),  # ALPHA
        ("  19.770", "-179.999", " 179.999", 2),  # BETA
    ],
)
def test_angles_are_compared_around_the_circle(old: str, one: str, other: str, apart: int) -> None:
    expected, actual = put(18, old, one), put(18, old, other)
    assert not compare_listings(expected, actual, units=apart or 0.001).differences
    if apart:
        assert only(compare_listings(expected, actual, units=apart - 0.5)).off_by == apart
    assert only(compare_listings(expected, actual, units=0)).off_by == apart


@pytest.mark.parametrize(
    ("line", "old", "one", "other"),
    [
        (18, "  20.283", "    .000", " 360.000"),  # ETA: a size, not a direction
        (4, " -106.61083", "   -1.00000", "  359.00000"),  # longitude: printed as it was read
    ],
)
def test_other_angles_are_not(line: int, old: str, one: str, other: str) -> None:
    expected, actual = put(line, old, one), put(line, old, other)
    assert only(compare_listings(expected, actual, units=100)).off_by == Decimal(360) * 10 ** (
        3 if line == 18 else 5
    )


@pytest.mark.parametrize(
    ("one", "other", "equal_at"),
    [
        ("-.00000", " .00000", 1),  # the sign of a zero is a character
        (" .00001", "-.00000", 1),
        ("*******", "*******", 0),
        ("*******", "-.04424", None),
        ("    NaN", "    NaN", 0),
        ("    NaN", "-.04424", None),
        ("    NaN", "   -NaN", None),
        ("-.0x424", "-.04424", None),
        ("-.04 24", "-.04424", None),  # a blank is no digit
        ("       ", "-.04424", None),
        ("-1_0424", "-10424.", None),
        ("0.04424", " .04424", 1),
        ("4.4E-02", " .04400", 1),
    ],
)
def test_numbers_and_text(one: str, other: str, equal_at: int | None) -> None:
    for expected, actual in ((one, other), (other, one)):
        for units in (0, 1):
            result = compare_listings(
                put(15, "-.04424", expected), put(15, "-.04424", actual), units
            )
            if equal_at is not None and units >= equal_at:
                assert not result.differences
            else:
                found = only(result)
                assert found.field == "DELTA R"
                assert (found.expected, found.actual) == (expected.strip(), actual.strip())


def test_title_is_text() -> None:
    found = only(compare_listings(PAGE, put(1, "MILLIKEN", "MILLIKIN"), units=9))
    assert (found.field, found.frame) == ("TITLE", "730")


def test_blanks_at_ends_and_carriage_returns_are_harmless() -> None:
    stripped = "\n".join(line.rstrip() for line in LINES)
    assert not compare_listings(PAGE, stripped, units=0).differences
    assert not compare_listings(PAGE.replace("\n", "   \r\n"), PAGE, units=0).differences


@pytest.mark.parametrize("line", [3, 7, 9, 13, 17, 19, 23])
def test_a_heading_is_text(line: int) -> None:
    wrong = LINES[line - 1].replace("A", "O").replace("Y", "V")
    found = only(compare_listings(PAGE, page({line: wrong})))
    assert (found.kind, found.expected_line) == ("line", line)
    assert (found.expected, found.actual) == (LINES[line - 1], wrong)


def test_text_between_the_fields_is_one_difference() -> None:
    wrong = " x" + LINES[7][2:-1] + "9"
    found = only(compare_listings(PAGE, page({8: wrong})))
    assert (found.kind, found.actual) == ("line", wrong)
    found = only(compare_listings(PAGE, page({8: LINES[7] + "7"})))
    assert found.kind == "line"


@pytest.mark.parametrize("column", [0, 10, 133, 300])
@pytest.mark.parametrize("line", NAMES)
def test_text_behind_the_fields_is_one_difference(line: int, column: int) -> None:
    """However far to the right it stands."""
    longer = page({line: LINES[line - 1].ljust(column) + " X"})
    for one, other in ((PAGE, longer), (longer, PAGE)):
        assert only(compare_listings(one, other, units=9)).kind == "line"


@pytest.mark.parametrize("line", range(1, 24))
def test_a_missing_line_is_one_difference(line: int) -> None:
    shorter = frame(730, 1).splitlines()
    del shorter[line - 1]
    actual = "".join(f"{text}\n" for text in shorter)
    found = only(compare_listings(PAGE, actual, units=9))
    assert (found.kind, found.expected_line, found.actual_line) == ("missing line", line, None)
    assert (found.expected, found.frame) == (LINES[line - 1].rstrip(), "730")
    found = only(compare_listings(actual, PAGE, units=9))
    assert (found.kind, found.expected_line, found.actual_line) == ("extra line", None, line)
    assert (found.actual, found.frame) == (LINES[line - 1].rstrip(), "730")


def test_a_landmark_of_another_name_is_lost_and_added() -> None:
    other = (
        "   70  -106.40000  32.00000 20900.000  32.00000   1000.000  .1000000 -.2000000 -.9000000"
    )
    kinds = [found.kind for found in compare_listings(PAGE, page({5: other})).differences]
    assert sorted(kinds) == ["extra line", "missing line"]


def test_text_for_a_blank_line_is_one_difference() -> None:
    found = only(compare_listings(PAGE, page({2: " A NOTE"})))
    assert (found.kind, found.expected, found.actual) == ("line", "", " A NOTE")
    wrong = LINES[2].replace("L-MARK", "L-MORK")  # the heading's own place is below the blank line
    kinds = [found.kind for found in compare_listings(PAGE, page({2: None, 3: wrong})).differences]
    assert kinds == ["missing line", "line"]


def test_rows_below_a_heading_that_neither_has_are_text() -> None:
    wrong = {7: LINES[6].replace("VEHICLE", "VEHICEL")}
    moved = {**wrong, 8: LINES[7].replace("-28971.56", "-28971.57")}
    found = only(compare_listings(page(wrong), page(moved)))
    assert (found.kind, found.expected_line) == ("line", 8)


def test_a_page_missing_extra_or_of_another_frame() -> None:
    pages = [frame(number, number % 3) for number in range(1, 6)]
    for k in range(5):
        fewer = "".join(pages[:k] + pages[k + 1 :])
        found = only(compare_listings("".join(pages), fewer, units=0))
        assert (found.kind, found.page, found.frame) == ("missing page", k + 1, str(k + 1))
        assert (found.expected_line, found.actual_line) == (23 * k + 1, None)
        found = only(compare_listings(fewer, "".join(pages), units=0))
        assert (found.kind, found.page, found.frame) == ("extra page", k + 1, str(k + 1))
        assert (found.expected_line, found.actual_line) == (None, 23 * k + 1)


def test_the_pages_behind_a_missing_one_are_compared_with_their_own() -> None:
    expected = "".join(frame(number) for number in (7, 8, 9))
    actual = frame(7, 1) + frame(9, 1)
    found = only(compare_listings(expected, actual, units=9))
    assert (found.kind, found.frame) == ("missing page", "8")
    result = compare_listings(expected, actual, units=0.5)
    assert {found.frame for found in result.differences} == {"7", "8", "9"}
    assert (result.pages, result.fields_compared) == (2, 2 * 81)
    assert (result.pages_missing, result.pages_extra) == (1, 0)
    result = compare_listings(actual, expected)
    assert (result.pages, result.pages_missing, result.pages_extra) == (2, 0, 1)


def test_a_frame_that_repeats_in_a_stack_of_jobs_finds_its_likeness() -> None:
    other = {8: LINES[7].replace("143179.38", "120593.47"), 23: LINES[22].replace("11718", "02176")}
    expected = PAGE + page(other) + PAGE
    found = only(compare_listings(expected, page(other) + put(23, ".11718", ".11719")))
    assert (found.kind, found.page, found.frame) == ("missing page", 1, "730")
    third = {line: LINES[line - 1].replace("7", "1") for line in (8, 10, 11, 12, 14, 15, 16)}
    moved = {18: LINES[17].replace("20.283", "20.284")}  # on both pages: no page is the same
    found = only(
        compare_listings(
            PAGE + page(other) + page(third), page(other | moved) + page(third | moved)
        )
    )
    assert (found.kind, found.page, found.frame) == ("missing page", 1, "730")


def test_one_digit_of_the_frame_is_no_other_page() -> None:
    expected = frame(7) + frame(8) + frame(9)
    found = only(compare_listings(expected, frame(7) + frame(6) + frame(9)))
    assert (found.field, found.page, found.expected, found.actual) == ("FRAME", 2, "8", "6")


def test_a_long_listing_whose_frames_repeat_loses_one_page() -> None:
    # every page has drifted, so only the order and the frames tell which one is gone
    expected = [frame(k % 24 + 1) for k in range(480)]
    actual = [frame(k % 24 + 1, 1) for k in range(480) if k != 250]
    found = only(compare_listings("".join(expected), "".join(actual), units=9))
    assert (found.kind, found.page, found.frame) == ("missing page", 251, "11")


def test_pages_are_not_weighed_one_against_all(monkeypatch: pytest.MonkeyPatch) -> None:
    weighed = []

    def counted(one: ListingPage, other: ListingPage) -> float:
        weighed.append((one, other))
        return page_cost(one, other)

    monkeypatch.setattr(listings, "page_cost", counted)
    expected = [frame(number) for number in range(1000, 1600)]
    actual = [frame(number, 1) for number in range(1000, 1600) if number not in (1100, 1500)]
    result = compare_listings("".join(expected), "".join(actual), units=9)
    assert [found.frame for found in result.differences] == ["1100", "1500"]
    assert len(weighed) < 600


def test_titles_without_page_eject_leave_the_frames_apart() -> None:
    expected = "".join(" " + frame(number)[1:] for number in (7, 8, 9))
    actual = "".join(" " + frame(number, 1)[1:] for number in (7, 8, 9))
    lost = actual.splitlines()
    del lost[23 + 10]  # landmark 66's reading in frame 8
    found = only(compare_listings(expected, "\n".join(lost), units=9))
    assert (found.kind, found.page, found.frame) == ("missing line", 1, "8")


# Lines beside the seven output groups ------------------------------------------------------------

DROPPED = "\n\n\n      FRAME 731IGNORED BY USERS DIRECTION\n"
# Formats 102 and 103 end a page after output group 3, or after group 6 in the last pass
ZEROS = "\n\n       7.00000000E-10       0.00000000E+00\n\n\n\n END OF JOB\n"
EXACT = "".join(f"{line}\n" for line in LINES[:12]) + ZEROS
LATE = "".join(f"{line}\n" for line in LINES[:22]) + ZEROS
STOP = (
    "1TABLE BELOW OUT OF ORDER FOR FTLUP AT POSITION     3\n"
    " TABLE IS STORED IN LOCATION 000000\n"
    "\n"
    "  .10000000E+01  .20000000E+01  .15000000E+01\n"
    "  .12345678E-05  .20000000E+01  .30000000E+01\n"
)


@pytest.mark.parametrize(
    ("text", "old", "new", "field", "off_by", "count"),
    [
        (PAGE + DROPPED, "731I", "732I", "FRAME", 1, 82),
        (page({5: "   66  IGNORED BY USERS DIRECTION"}), " 66  I", " 69  I", "L-MARK", 3, 73),
        (EXACT, " 0.00000000E+00\n", "-2.00000000E+00\n", "RY(I)", 200000000, 45),
        (LATE, "7.00000000E-10", "7.00000300E-10", "RX(I)", 300, 82),
        (STOP, "    3\n", "    4\n", "POSITION", 1, 7),
        (STOP, ".12345678E-05", ".12345680E-05", "VALUE 1", 2, 7),
        (STOP, ".15000000E+01", ".15000003E+01", "VALUE 3", 3, 7),
        (STOP, ".30000000E+01", ".99999000E+00", "VALUE 3", 20000100, 7),  # the coarser digit
    ],
)  # fmt: skip
def test_the_other_lines(
    text: str, old: str, new: str, field: str, off_by: int, count: int
) -> None:
    assert text.count(old) == 1
    result = compare_listings(text, text.replace(old, new))
    found = only(result)
    assert (found.kind, found.field) == ("field", field)
    assert found.off_by == off_by
    assert result.fields_compared == count
    assert compare_listings(text, text, units=0) == Comparison(result.pages, count)


def test_a_dropped_frame_is_named_for_itself() -> None:
    result = compare_listings(PAGE + DROPPED + END, PAGE + END)
    assert [found.kind for found in result.differences] == ["missing line"] * 4
    assert result.differences[-1].frame == "731"
    found = only(compare_listings(DROPPED + PAGE, PAGE))
    assert (found.kind, found.page) == ("missing page", 1)


@pytest.mark.parametrize(
    "text", [" END OF CASE", " END OF JOB", " TABLE IS STORED IN LOCATION 000000"]
)
def test_fixed_text(text: str) -> None:
    found = only(compare_listings(PAGE + text, PAGE + text.replace("O", "0")))
    assert (found.kind, found.expected) == ("line", text)


# Transcripts of a damaged print ------------------------------------------------------------------


def test_each_illegible_field_is_left_out() -> None:
    for line, match, _ in FIELDS:
        text = LINES[line - 1]
        damaged = text[: match.start()] + "?" * len(match[0]) + text[match.end() :]
        result = compare_listings(page({line: damaged}), PAGE, units=0)
        assert result == Comparison(1, 80, 1), damaged
        assert compare_listings(
            PAGE, page({line: damaged}), units=1
        ).differences  # a ? in ACTUAL is text


def test_what_is_illegible_in_both_is_still_not_compared() -> None:
    damaged = put(15, "-.04424", "???????")
    assert compare_listings(damaged, damaged, units=0) == Comparison(1, 80, 1)
    assert compare_listings(page({15: "?"}), page({15: "?"}), units=0) == Comparison(1, 76, 0)


def test_an_illegible_field_hides_only_itself() -> None:
    damaged = put(15, "-.04424", "   ????")
    found = only(compare_listings(damaged, put(15, "3.21206", "3.21209"), units=0))
    assert found.field == "R DIST"
    assert not compare_listings(damaged, put(15, "-.04424", "*******"), units=0).differences


def test_a_field_with_a_legible_character_is_compared() -> None:
    found = only(compare_listings(put(15, "-.04424", "-.0442?"), PAGE, units=9))
    assert (found.field, found.expected, found.off_by) == ("DELTA R", "-.0442?", None)


def test_landmark_of_an_illegible_number_is_named_by_the_other() -> None:
    damaged = page({15: LINES[14].replace("66", "??")})
    found = only(compare_listings(damaged, put(15, "-.04424", "-.04429")))
    assert (found.landmark, found.field) == ("66", "DELTA R")


@pytest.mark.parametrize("line", range(2, 24))
def test_an_illegible_line_stands_for_any_one(line: int) -> None:
    names = NAMES.get(line, "DEVIATION" if line == 23 else "").split()
    for actual in (PAGE, frame(730, 1)):  # the rows after a heading that is lost are still fields
        result = compare_listings(page({line: "?"}), actual, units=9)
        assert replace(result, fields_within=0) == Comparison(1, 81 - len(names), len(names))
    if line != 18:
        found = only(compare_listings(page({line: "?"}), put(18, " 75.837", " 75.839")))
        assert (found.field, found.frame) == ("PHI", "730")


def test_fields_within_the_tolerance_are_counted() -> None:
    """A unit of the last digit is one; the same number in other characters is none."""
    near = put(18, " 75.837", " 75.836")
    assert compare_listings(PAGE, near) == Comparison(1, 81, fields_within=1)
    assert compare_listings(PAGE, near, units=0).fields_within == 0
    assert compare_listings(PAGE, PAGE).fields_within == 0
    assert compare_listings(PAGE, put(18, " 75.837", "75.8370")) == Comparison(1, 81)


def test_only_one_line_for_one() -> None:
    lines = {11: "?", 12: "?"}
    assert not compare_listings(page(lines), PAGE).differences
    found = only(compare_listings(page({**lines, 10: "?"}), page({10: None})))
    assert (found.kind, found.expected) == ("missing line", "?")
    assert only(compare_listings(PAGE, page({11: "?"}))).kind == "line"


def test_illegible_lines_reach_past_a_page_eject() -> None:
    assert not compare_listings(PAGE + "?\n" * 4, PAGE + END, units=0).differences
    ignored = "\n\n\n      FRAME  55IGNORED BY USERS DIRECTION\n"
    assert not compare_listings(
        "?\n" * 4 + PAGE + "?\n" * 4, ignored + PAGE + END, units=0
    ).differences
    stacked = (PAGE + "?\n") * 2 + PAGE + "?\n" * 4
    assert not compare_listings(stacked, (PAGE + END[:81]) * 2 + PAGE + END, units=0).differences
    assert not compare_listings("?\n" * 46 + PAGE, frame(7) + frame(8) + PAGE, units=0).differences
    extra = compare_listings(
        frame(7) + "?\n" * 4 + frame(9), frame(7) + frame(8) + frame(9), units=0
    )
    assert [d.kind for d in extra.differences] == ["missing line"] * 4 + ["extra page"]
    lost = compare_listings(PAGE + "?\n" * 3, PAGE + END, units=0)
    assert only(lost).kind == "extra line"
    lost = compare_listings(PAGE + "?\n" * 5, PAGE + END, units=0)
    assert only(lost).kind == "missing line"


@pytest.mark.parametrize(("illegible", "joined"), [(11, False), (12, True), (13, True)])
@pytest.mark.parametrize("before", [True, False])
def test_how_many_illegible_lines_stand_for_a_page(
    illegible: int, joined: bool, before: bool
) -> None:
    """Half of the lines of the page, which are 24 with a blank line, before a frame or behind."""
    other, lost = frame(8) + "\n", "?\n" * illegible
    assert len(other.splitlines()) == 24
    if before:  # with it on one page
        result = compare_listings(lost + " " + PAGE[1:], other + PAGE, units=0)
    else:
        result = compare_listings(PAGE + lost, PAGE + other, units=0)
    assert ("extra page" not in [one.kind for one in result.differences]) == joined


def test_frames_without_page_eject_that_end_early() -> None:
    """An exact frame has no line of its number: its lines have none, and not that before."""
    exact = "".join(f"{line}\n" for line in LINES[:12])
    stacked = "".join(" " + text[1:] for text in (frame(7), exact, frame(9)))
    lost = stacked.splitlines()
    for at, named in ((23 + 10, ""), (23 + 12 + 10, "9"), (10, "7")):
        short = [line for k, line in enumerate(lost) if k != at]
        found = only(compare_listings(stacked, "\n".join(short), units=9))
        assert (found.kind, found.frame) == ("missing line", named)


def test_an_illegible_title() -> None:
    result = compare_listings(page({1: "1?????"}), PAGE, units=0)
    assert result == Comparison(1, 80, 1)


# Any listing --------------------------------------------------------------------------------------

EDITS = st.lists(
    st.tuples(
        st.sampled_from(["drop", "double", "digit", "swap", "text"]),
        st.integers(0, 10_000),
        st.integers(0, 10_000),
    ),
    max_size=6,
)


def edited(text: str, edits: list[tuple[str, int, int]]) -> str:
    lines = text.splitlines()
    for what, where, how in edits:
        at = where % len(lines)
        line = lines[at]
        if what == "drop" and len(lines) > 1:
            del lines[at]
        elif what == "double":
            lines.insert(at, line)
        elif what == "swap":
            lines[at], lines[how % len(lines)] = lines[how % len(lines)], line
        elif what == "text":
            lines[at] = ["", "1", "x", "  65", "0 RESIDUALS", "-" * 120][how % 6]
        elif line:
            column = how % len(line)
            lines[at] = line[:column] + str(how % 10) + line[column + 1 :]
    return "".join(f"{line}\n" for line in lines)


@settings(max_examples=150, deadline=None)
@given(EDITS, EDITS)
def test_without_differences_exactly_when_the_text_is_the_same(
    ours: list[tuple[str, int, int]], theirs: list[tuple[str, int, int]]
) -> None:
    start = PAGE + frame(731, 3) + "\n\n\n      FRAME 732IGNORED BY USERS DIRECTION\n" + END
    one, other = edited(start, ours), edited(start, theirs)
    lines, others = ([line.rstrip() for line in text.split("\n")[:-1]] for text in (one, other))
    result = compare_listings(one, other, units=0)
    assert (not result.differences) is (lines == others)
    lost = [found for found in result.differences if found.kind.startswith("missing")]
    added = [found for found in result.differences if found.kind.startswith("extra")]
    grown = sum(found.actual.count("\n") + 1 for found in added) - sum(
        found.expected.count("\n") + 1 for found in lost
    )
    assert len(lines) + grown == len(others)  # no line unaccounted for


@settings(max_examples=150, deadline=None)
@given(st.sets(st.integers(0, 53), max_size=12), st.sets(st.integers(0, 159), max_size=20))
def test_damage_alone_is_no_difference(lost: set[int], blurred: set[int]) -> None:
    whole = DROPPED + PAGE + frame(731, 3) + END
    lines = whole.splitlines()
    assert len(lines) == 54 and len(FIELDS) == 80
    for k in blurred:
        line, match, _ = FIELDS[k % 80]
        at = line + (3 if k < 80 else 26)
        first, last = match.span()
        lines[at] = lines[at][:first] + "?" * (last - first) + lines[at][last:]
    for at in lost:
        lines[at] = "?"
    result = compare_listings("".join(f"{line}\n" for line in lines), whole, units=0)
    assert not result.differences
    assert result.fields_compared + result.fields_illegible == 1 + 81 + 81 + 1
