"""Fields of two listings: tolerances, units apart, numbers between two."""

from __future__ import annotations

from decimal import Decimal

import pytest

from vopd.findings import VopdError
from vopd.listing.compare import (
    TOLERANCES,
    exact_units,
    fields_agree,
    may_hold,
    printed_number,
    tolerance_rows,
    units_apart,
)
from vopd.listing.formats import Field

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


@pytest.mark.parametrize("units", [0, 0.1, "2.5", Decimal("1E-9"), 10**9])
def test_tolerances_are_taken_exactly(units: float | Decimal | str) -> None:
    assert exact_units(units) == Decimal(str(units))


REFUSED = {
    "two": "units: not a number: 'two'", "": "units: not a number: ''",
    "-1": "units: not a number of 0 or more: '-1'",
    "nan": "units: not a number of 0 or more: 'nan'",
    "inf": "units: not a number of 0 or more: 'inf'", "1,5": "units: not a number: '1,5'",
    "-1E-9": "units: not a number of 0 or more: '-1E-9'",
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
