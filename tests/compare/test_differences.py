"""Differences of two listings: places, kinds and texts; fields, tolerances, units apart."""

from __future__ import annotations

from dataclasses import replace
from decimal import Decimal

import pytest

from tests.approved.texts import refused
from vopd.findings import VopdError
from vopd.listing.compare import (
    TOLERANCES,
    Comparison,
    Difference,
    compare_listings,
    exact_units,
    fields_agree,
    may_hold,
    printed_number,
    read_within,
    tolerance_rows,
    undetermined_fields,
    units_apart,
)
from vopd.listing.formats import Field

# Every part of every difference that is reported, and every count, of small listings by hand


HEAD = "0 L-MARK  XCO FINAL     YCO FINAL"
TEXT = "  ANY OTHER TEXT"
FILM = "0L-MARK        X              Y           R DIST         DELTA R"
LANDMARKS = (
    " L-MARK LONGITUDE  LAT-GOCN RAD ER KM  LAT-GODT  ALTITUDE-FT    XLAM       XMU       XNU"
)


def row(landmark: int | str, x: str = "1.00000000", y: str = "2.00000000") -> str:
    return f"{landmark:>4}{x:>15}{y:>15}"


def frame(number: int | str, *rows: str) -> list[str]:
    """The lines of a page of a frame, whose number stands in its last line."""
    last = f"{number:>5}    1.000"
    above = (
        "0 FRAME   TIME     SIG1     SIG2     SIG3     XP     YP        PSI      THETA      PHI"
        "   ALPHA    BETA     ETA"
    )
    return ["1 TITLE", HEAD, *rows, above, last]


A, B, C = row(65), row(66), row(67, "3.00000000")
ONE, TWO, THREE = frame(7, A, B), frame(8, B, C), frame(9, row(68), row(69, "4.5"))

Case = tuple[list[str], list[str], list[Difference], tuple[int, int, int]]
CASES: dict[str, Case] = {  # EXPECTED, ACTUAL, differences; pages, fields compared, illegible
    "nothing": (ONE, ONE, [], (1, 9, 0)),
    "a unit of the last digit": (ONE, frame(7, row(65, "1.00000001"), B), [], (1, 9, 0)),
    "a field": (
        ONE, frame(7, A, row(66, y="2.00000005")),
        [Difference("field", 1, "7", 4, 4, "2.00000000", "2.00000005", "66", "YCO FINAL",
                    Decimal(5))],
        (1, 9, 0),
    ),
    "two fields": (
        ONE, frame(7, row(65, "****", ""), B),
        [Difference("field", 1, "7", 3, 3, "1.00000000", "****", "65", "XCO FINAL"),
         Difference("field", 1, "7", 3, 3, "2.00000000", "", "65", "YCO FINAL")],
        (1, 9, 0),
    ),
    "a field more": (
        frame(7, row(65, y="")), frame(7, A),
        [Difference("field", 1, "7", 3, 3, "", "2.00000000", "65", "YCO FINAL")], (1, 6, 0),
    ),
    "a line less": (
        ONE, frame(7, B), [Difference("missing line", 1, "7", 3, None, A, "")], (1, 6, 0)
    ),
    "a line more": (
        frame(7, B), ONE, [Difference("extra line", 1, "7", None, 3, "", A)], (1, 6, 0)
    ),
    "text for text": (
        frame(7, TEXT), frame(7, "  NO OTHER TEXT"),
        [Difference("line", 1, "7", 3, 3, TEXT, "  NO OTHER TEXT")], (1, 3, 0),
    ),
    "text behind the fields": (
        ONE, frame(7, A + " x", B), [Difference("line", 1, "7", 3, 3, A, A + " x")], (1, 6, 0)
    ),
    "the frame": (
        ONE, [*ONE[:-1], "  700    1.000"],
        [Difference("field", 1, "7", 6, 6, "7", "700", "", "FRAME", Decimal(693))], (1, 9, 0),
    ),
    "a page less": (
        ONE + TWO + THREE, ONE + THREE,
        [Difference("missing page", 2, "8", 7, None, "\n".join(TWO), "")], (2, 18, 0),
    ),
    "a page more": (
        ONE + THREE, ONE + TWO + THREE,
        [Difference("extra page", 2, "8", None, 7, "", "\n".join(TWO))], (2, 18, 0),
    ),
    "a page without a number less": (
        [*ONE, "1 A", TEXT], ONE, [Difference("missing page", 2, "", 7, None, "1 A\n" + TEXT, "")],
        (1, 9, 0),
    ),
    "a page without a number more": (
        ONE, [*ONE, "1 A", TEXT], [Difference("extra page", 2, "", None, 7, "", "1 A\n" + TEXT)],
        (1, 9, 0),
    ),
    "a field behind a lost page": (
        ONE + TWO, frame(8, B, row(67, "3.00000004")),
        [Difference("missing page", 1, "7", 1, None, "\n".join(ONE), ""),
         Difference("field", 2, "8", 10, 4, "3.00000000", "3.00000004", "67", "XCO FINAL",
                    Decimal(4))],
        (1, 9, 0),
    ),
    "an illegible field": (
        frame(7, row(65, "??????????"), B), frame(7, row(65, "9.0"), B), [], (1, 8, 1)
    ),
    "an illegible line": (frame(7, "?", B), ONE, [], (1, 6, 3)),
    "a field that is illegible in both": (
        frame(7, row(65, "??????????"), B), frame(7, row(65, "??????????"), B), [], (1, 8, 1)
    ),
    "a line that is illegible in both": (frame(7, "?", B), frame(7, "?", B), [], (1, 6, 0)),
    "text with a question mark in both": (frame(7, "WHAT?"), frame(7, "WHAT?"), [], (1, 3, 0)),
    "an illegible landmark": (
        frame(7, row("??"), B), frame(7, row(65, "7.00000000"), B),
        [Difference("field", 1, "7", 3, 3, "1.00000000", "7.00000000", "65", "XCO FINAL",
                    Decimal(600000000))],
        (1, 8, 1),
    ),
    "an illegible frame": (
        [*frame("?", A, B)], frame(7, row(65, "7.00000000"), B),
        [Difference("field", 1, "7", 3, 3, "1.00000000", "7.00000000", "65", "XCO FINAL",
                    Decimal(600000000))],
        (1, 8, 1),
    ),
    "a question mark in ACTUAL": (
        frame(7, A, B), frame(7, A, "?", B),
        [Difference("extra line", 1, "7", None, 4, "", "?")], (1, 9, 0),
    ),
    "a question mark for a line in ACTUAL": (
        frame(7, A, TEXT), frame(7, A, "?"), [Difference("line", 1, "7", 4, 4, TEXT, "?")],
        (1, 6, 0),
    ),
    "a blank line": (
        frame(7, A, B, ""), ONE, [Difference("missing line", 1, "7", 5, None, "", "")], (1, 9, 0)
    ),
    "a number behind the end of a line": (
        ["1 TITLE", LANDMARKS, "   65", *ONE[4:]],
        ["1 TITLE", LANDMARKS, "   65    10.00000", *ONE[4:]],
        [Difference("field", 1, "7", 3, 3, "", "10.00000", "65", "LONGITUDE")], (1, 5, 0),
    ),
    "a row of a table whose heading is illegible": (
        frame(7, A, "?", "  65" + "?" * 60), frame(7, A, FILM, "  65" + "*" * 60), [], (1, 7, 4)
    ),
    "a short page and one more": (
        frame(7, *"ABCDEFGHIJ"), [*frame(7, "A", "B"), "1 MORE", TEXT],
        [*(Difference("missing line", 1, "7", k + 1, None, "ABCDEFGHIJ"[k - 2], "")
           for k in range(4, 12)),
         Difference("extra page", 2, "", None, 7, "", "1 MORE\n" + TEXT)],
        (1, 5, 0),  # so short a text is taken for a row of the table
    ),
    "illegible lines for the page before": (
        [*"?????", " TITLE", *ONE[1:]], [*frame(6, C), *frame(7, A, row(66, "1.00000009"))],
        [Difference("line", 1, "7", 6, 6, " TITLE", "1 TITLE"),
         Difference("field", 1, "7", 9, 9, "1.00000000", "1.00000009", "66", "XCO FINAL",
                    Decimal(9))],
        (1, 8, 6),
    ),
    "illegible lines for the two pages before": (
        [*10 * "?", " TITLE", *ONE[1:]],
        [*frame(5, C), *frame(6, C), *frame(7, A, row(66, "1.00000009"))],
        [Difference("line", 1, "7", 11, 11, " TITLE", "1 TITLE"),
         Difference("field", 1, "7", 14, 14, "1.00000000", "1.00000009", "66", "XCO FINAL",
                    Decimal(9))],
        (1, 8, 12),
    ),
    "illegible lines for the page behind": (
        [*ONE, *"?????"], [*frame(7, A, row(66, "1.00000009")), *frame(8, C)],
        [Difference("field", 1, "7", 4, 4, "1.00000000", "1.00000009", "66", "XCO FINAL",
                    Decimal(9))],
        (1, 9, 6),
    ),
    "an empty listing": ([], ONE, [Difference("extra page", 1, "7", None, 1, "", "\n".join(ONE))],
                         (0, 0, 0)),
}  # fmt: skip


def text(lines: list[str]) -> str:
    return "".join(f"{line}\n" for line in lines)


@pytest.mark.parametrize("name", CASES)
def test_what_is_reported(name: str) -> None:
    expected, actual, differences, (pages, compared, illegible) = CASES[name]
    result = compare_listings(text(expected), text(actual))
    assert list(result.differences) == differences
    within = name == "a unit of the last digit"
    kinds = [one.kind for one in differences]
    alone = kinds.count("missing page"), kinds.count("extra page")
    found = tuple(differences)
    assert result == Comparison(pages, compared, illegible, 0, found, int(within), *alone)


LOW, HIGH = frame(7, row(65, "1.00000000"), B), frame(7, row(65, "1.00000004"), B)


def test_undetermined_fields_are_those_that_differ_at_all() -> None:
    """By line and name: the lowest and the highest text."""
    near = frame(7, row(65, "1.00000001"), B)
    assert undetermined_fields(text(LOW), text(near)) == {
        (3, "XCO FINAL"): ("1.00000000", "1.00000001")
    }
    for other in (frame(7, B), frame(7, A, B, C), frame(7, TEXT, B), ONE + TWO):
        with refused(VopdError):
            undetermined_fields(text(LOW), text(other))


HELD = {  # numbers in EXPECTED and ACTUAL, both between 1.00000000 and 1.00000004 or not
    ("1.00000000", "1.00000004"): True,
    ("1.00000001", "1.00000003"): True,
    ("1.00000000", "1.00000005"): False,
    ("0.99999999", "1.00000004"): False,
    ("1.00000004", "0.99999999"): False,
}


@pytest.mark.parametrize("pair", HELD)
def test_a_difference_that_is_not_determined(pair: tuple[str, str]) -> None:
    """Is reported all the same; the line is that of EXPECTED, which here has one more."""
    one = ["1 TITLE", TEXT, *frame(7, row(65, pair[0]), B)[1:]]
    other = frame(7, row(65, pair[1]), B)
    between = {(4, "XCO FINAL"): ("1.00000000", "1.00000004")}
    result = compare_listings(text(one), text(other), 1, between)
    _, found = result.differences
    assert (found.expected_line, found.actual_line) == (4, 3)
    assert (found.determined, result.fields_undetermined) == (not HELD[pair], HELD[pair])
    elsewhere = {(3, "XCO FINAL"): between[4, "XCO FINAL"], (4, "YCO FINAL"): ("0", "9")}
    result = compare_listings(text(one), text(other), 1, elsewhere)
    assert result.differences[1].determined and not result.fields_undetermined


# A difference in words, of each kind, as a reader sees it


FIELD = Difference(
    "field", 3, "65", 12, 14, "-1.25", "", landmark="28", field="X RESIDUAL", off_by=Decimal("2.0")
)
WORDS = {
    "a field": (
        FIELD,
        "page 3, frame 65, line 12 (14 in ACTUAL), landmark 28, X RESIDUAL: expected -1.25, "
        "actual (blank) (off by 2)",
    ),
    "not determined": (
        replace(FIELD, determined=False, actual="7.5", landmark=""),
        "page 3, frame 65, line 12 (14 in ACTUAL), X RESIDUAL: expected -1.25, actual 7.5 "
        "(off by 2, not determined)",
    ),
    "numbers that are equal": (
        Difference("field", 1, "", 4, 4, ".000", "-.000", field="X", off_by=Decimal("0.000")),
        "page 1, line 4, X: expected .000, actual -.000 (off by 0)",
    ),
    "text of a field": (
        Difference("field", 1, "", 4, 4, "A", "B", field="TITLE"),
        "page 1, line 4, TITLE: expected A, actual B",
    ),
    "a line": (
        Difference("line", 1, "", 4, None, "A B", "A C"),
        "page 1, line 4: the text differs\n    expected |A B\n    actual   |A C",
    ),
    "a missing line": (
        Difference("missing line", 2, "7", 9, None, "TEXT", ""),
        "page 2, frame 7, line 9: line missing from ACTUAL\n    -|TEXT",
    ),
    "an extra line": (
        Difference("extra line", 2, "7", None, 9, "", "TEXT"),
        "page 2, frame 7, line 9 of ACTUAL: line only in ACTUAL\n    +|TEXT",
    ),
    "a missing page": (
        Difference("missing page", 2, "7", 9, None, "ONE\nTWO", ""),
        "page 2, frame 7, line 9: page missing from ACTUAL (2 lines)",
    ),
    "an extra page": (
        Difference("extra page", 2, "7", None, 9, "", "ONE\nTWO\nTHREE"),
        "page 2, frame 7, line 9 of ACTUAL: page only in ACTUAL (3 lines)",
    ),
}


@pytest.mark.parametrize("name", WORDS)
def test_in_words(name: str) -> None:
    difference, words = WORDS[name]
    assert str(difference) == words


# Fields


# When two printed fields agree, and by how many units of the last digit they differ


def field(descriptor: str = "F", decimals: int = 3, quantity: str = "time") -> Field:
    return Field("NAME", quantity, descriptor, 1, 12, decimals)


TEXTS = {  # what is printed: its value
    "1": "1", " 1.25 ": "1.25", "-.5": "-0.5", "+2.": "2", "1.5E+03": "1500", "1.5E-9": "1.5E-9",
    ".25D+02": "25", "1.E100": "1E100", "7D3": "7000", "1.0E1000": None, "": None, "   ": None,
    "****": None, "NaN": None, "Infinity": None, "1 2": None, ".": None, "-": None, "1,5": None,
    "1.2.3": None, "0x1": None, "E5": None, "1e5": None, "--1": None, "?.5": None, "_1": None,
}  # fmt: skip


@pytest.mark.parametrize("text", TEXTS)
def test_the_value_of_a_printed_number(text: str) -> None:
    expected = TEXTS[text]
    assert printed_number(text) == (None if expected is None else Decimal(expected))


UNITS: list[tuple[Field, str, str, str | None]] = [
    (field(), "1.000", "1.002", "2"),
    (field(), "1.002", "1.000", "2"),
    (field(), "1.", "1.0025", "2.5"),  # in the FORMAT's last digit, whatever is printed
    (field(), "123456789012345.001", "123456789012345.003", "2"),  # to the last of all digits
    (field(quantity="camera yaw"), "123456789012345.001", "123456789012345.003", "2"),
    (field(), "1234567890.001", ".000", "1234567890001"),
    (field("I", 0), "7", "10", "3"),
    (field("I", 0), "7.5", "7.6", "0.1"),
    (field("E", 8), "1.50E+01", "1.52E+01", "2"),  # in the last digit that is printed
    (field("G", 8), "1.5", "1.52", "0.2"),  # of the coarser
    (field("G", 8), "1.52", "1.5", "0.2"),
    (field(), "NaN", "1.000", None),
    (field(), "1.000", "", None),
    (field(quantity="camera yaw"), "359.999", ".001", "2"),
    (field(quantity="camera yaw"), "1.000", "359.000", "2000"),
    (field(quantity="camera yaw"), "0.000", "720.001", "1"),
    (field(quantity="camera yaw"), "0.000", "180.001", "179999"),
    (field(quantity="camera yaw"), "-1000.000", "1000.000", "160000"),  # 200 of 2,000
    (field(quantity="total angle of attack"), ".000", "360.000", "360000"),
]


@pytest.mark.parametrize(("kind", "one", "other", "apart"), UNITS)
def test_units_of_the_last_digit(kind: Field, one: str, other: str, apart: str | None) -> None:
    assert units_apart(kind, one, other) == (None if apart is None else Decimal(apart))


AGREE = [  # quantity, two texts, units: whether they agree
    ("time", "  1.000", "  1.000", "0", True),
    ("time", "  1.000", "  1.000  ", "0", True),
    ("time", "  1.000", " 1.000", "0", False),  # the text is compared, not the number
    ("time", "  1.000", " 1.000", "1", True),
    ("time", "-.000", " .000", "0", False),
    ("time", "-.000", " .000", "0.001", True),
    ("time", "1.000", "1.001", "1", True),
    ("time", "1.000", "1.001", "0.999", False),
    ("time", "1.000", "1.002", "1", False),
    ("time", "1.000", "1.002", "2", True),
    ("time", "  ***", "***  ", "1", True),
    ("time", "  ***", "   NaN", "99", False),
    ("time", " NaN", "NaN", "1", True),
    ("time", "", "0.000", "99", False),
    ("landmark number", "65", "66", "99", False),
    ("landmark number", " 65", "65 ", "1", True),
    ("frame number", "1", "2", "99", False),
    ("table position", "1", "2", "99", False),
    ("text", "A", "B", "99", False),
    ("text", " A", "A", "1", True),
    ("text", "1", "2", "99", False),
    ("camera yaw", "360.000", ".000", "0.001", True),
    ("camera yaw", "360.000", ".000", "0", False),
]


@pytest.mark.parametrize(("quantity", "one", "other", "units", "same"), AGREE)
def test_whether_fields_agree(quantity: str, one: str, other: str, units: str, same: bool) -> None:
    kind = field("F" if quantity in ("time", "camera yaw") else "I", 3, quantity)
    assert fields_agree(kind, one, other, Decimal(units)) is same


def test_tolerances_of_a_unit_hold_to_their_limit() -> None:
    """A foot is a thousandth where radii are printed in thousands of feet."""
    foot = read_within("1ft")
    for quantity, limit, beyond in (
        ("landmark radius", "20935.699", "20935.700"),
        ("landmark altitude", "20936.698", "20936.699"),
    ):
        kind = field("F", 3, quantity)
        assert fields_agree(kind, "20935.698", limit, Decimal(0), foot)
        assert not fields_agree(kind, "20935.698", beyond, Decimal(0), foot)


@pytest.mark.parametrize("units", [0, 0.1, "2.5", Decimal("1E-9"), 10**9])
def test_tolerances_are_taken_exactly(units: float | Decimal | str) -> None:
    assert exact_units(units) == Decimal(str(units))


REFUSED = {
    "two": "units: not a number: 'two'", "": "units: not a number: ''",
    "-1": "units: not a number of 0 or more: '-1'",
    "nan": "units: not a number of 0 or more: 'nan'",
    "inf": "units: not a number of 0 or more: 'inf'", "1,5": "units: not a number: '1,5'",
    "-1E-9": "units: not a number of 0 or more: '-1E-9'",
    "1e400": "units: not a number of 0 or more: '1e400'",
    "1e99999999999": "units: not a number of 0 or more: '1e99999999999'",
    "1_0": "units: not a number: '1_0'", "\u0663": "units: not a number: '\u0663'",
}  # fmt: skip


@pytest.mark.parametrize("units", REFUSED)
def test_tolerances_that_are_none(units: str) -> None:
    with pytest.raises(VopdError) as refused:
        exact_units(units)
    assert str(refused.value) == REFUSED[units]


MAY_HOLD = [  # text, lowest, highest: whether it may be held
    (".001", ".001", ".003", True), (" .003 ", ".001", ".003", True),
    (".002", ".001", ".003", True), (".000", ".001", ".003", False),
    (".004", ".001", ".003", False), ("NaN", ".001", ".003", False),
    ("NaN", " NaN", ".003", True), (".002", "NaN", ".003", False), (".003 ", "NaN", " .003", True),
    (".002", ".001", "***", False), ("", ".001", ".003", False),
]  # fmt: skip


@pytest.mark.parametrize(("text", "low", "high", "may"), MAY_HOLD)
def test_what_lies_between(text: str, low: str, high: str, may: bool) -> None:
    assert may_hold(field(), text, low, high) is may


def test_what_lies_between_on_a_circle() -> None:
    """On the shorter way from the lowest to the highest."""
    yaw = field(quantity="camera yaw")
    found = [may_hold(yaw, text, "359.998", ".002") for text in ("360.000", ".001", ".003", "180.")]
    assert found == [True, True, False, False]


ROUNDED, GIVEN = "rounded to its last printed digit", "input, only rounded or converted"
FROM_0, FROM_MINUS_180 = (
    f"rounded; {ends} are one direction" for ends in ("0 and 360", "-180 and 180")
)
NAMES = "identifies, does not measure"
TABLE = [
    ("quantity", "unit", "at 1 unit", "modulo", "reason"),
    ("text", "", "equal", "", "compared exactly, but for trailing blanks"),
    ("landmark number", "", "equal", "", NAMES),
    ("frame number", "", "equal", "", NAMES),
    ("landmark longitude", "deg", "0.00001", "", GIVEN),
    ("geocentric latitude", "deg", "0.00001", "", ROUNDED),
    ("landmark radius", "1000 ft", "0.001", "", GIVEN),
    ("geodetic latitude", "deg", "0.00001", "", GIVEN),
    ("landmark altitude", "ft", "0.001", "", GIVEN),
    ("direction cosine", "", "0.0000001", "", ROUNDED),
    ("vehicle position", "ft", "0.01", "", ROUNDED),
    ("frame centre reading", "in", "0.00001", "", ROUNDED),
    ("focal length", "mm", "0.00001", "", GIVEN),
    ("landmark reading", "in", "0.00000001", "", ROUNDED),
    ("film coordinate", "mm", "0.00001", "", ROUNDED),
    ("film radius", "mm", "0.00001", "", ROUNDED),
    ("lens distortion", "mm", "0.00001", "", ROUNDED),
    ("time", "s", "0.001", "", ROUNDED),
    ("camera yaw", "deg", "0.001", "360", FROM_0),
    ("camera pitch", "deg", "0.001", "360", FROM_MINUS_180),
    ("camera roll", "deg", "0.001", "360", FROM_0),
    ("frame centre", "mm", "0.001", "", ROUNDED),
    ("vehicle yaw", "deg", "0.001", "360", FROM_0),
    ("vehicle pitch", "deg", "0.001", "360", FROM_MINUS_180),
    ("vehicle roll", "deg", "0.001", "360", FROM_0),
    ("angle of attack", "deg", "0.001", "360", FROM_MINUS_180),
    ("angle of sideslip", "deg", "0.001", "360", FROM_MINUS_180),
    ("total angle of attack", "deg", "0.001", "", ROUNDED),
    ("residual", "mm", "0.00000001", "", ROUNDED),
    ("standard deviation", "mm", "0.00001", "", ROUNDED),
    ("table position", "", "equal", "", "a count"),
    ("table value", "", "1 digit", "", GIVEN),
]


def test_the_table_of_tolerances() -> None:
    assert list(tolerance_rows()) == TABLE


# Differences of printed numbers that no circle and no field width could hold


def test_an_angle_of_ninety_digits_is_not_brought_back_to_a_circle() -> None:
    angle = next(name for name, one in TOLERANCES.items() if one.period is not None)
    field = Field("yaw", angle, "F", 1, 100, 3)
    assert units_apart(field, "1.E90", "0.") == Decimal(10) ** 93
