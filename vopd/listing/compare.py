"""Compare two listings page by page and field by field."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from dataclasses import field as derived
from decimal import Context, Decimal
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import BinaryIO, Literal

from vopd.findings import VopdError, listed
from vopd.inputs import is_number
from vopd.listing.formats import LINES, Field, Line
from vopd.listing.lines import (
    ILLEGIBLE,
    ListingLine,
    ListingPage,
    align,
    common_kind,
    frames_of_lines,
    is_listing,
    line_cost,
    page_cost,
    recognise_lines,
    split_pages,
)

# One difference and its text

Kind = Literal["field", "line", "missing line", "extra line", "missing page", "extra page"]


@dataclass(frozen=True, slots=True)
class Difference:
    """One difference between the listing EXPECTED and the listing ACTUAL."""

    # what differs: a field of a line, a whole line, or a line or page of one listing only
    kind: Kind
    page: int  # number of the page in EXPECTED, from 1; in ACTUAL where EXPECTED has no such page
    frame: str  # number of the frame as printed, blank where there is none
    expected_line: int | None  # number of the line in EXPECTED, from 1; None where it has none
    actual_line: int | None  # number of the line in ACTUAL, from 1; None where it has none
    expected: str  # the field, the line, or the lines of the page in EXPECTED
    actual: str  # the same in ACTUAL
    landmark: str = ""  # number of the landmark as printed, blank where there is none
    field: str = ""  # name of the field, as its heading prints it
    # how far two numbers are apart, in units of the last printed digit; None for text
    off_by: Decimal | None = None
    # False for a field whose digits depend on the last bits of sines, where both numbers are among
    # those that it may have
    determined: bool = True
    # how far they are apart in the field's own unit; None for text, and for a number that
    # identifies a frame or landmark
    apart: Decimal | None = derived(default=None, compare=False)
    unit: str = derived(default="", compare=False)  # that unit, blank for a number without one

    def __str__(self) -> str:
        """Describe the difference: where it is, and what either listing has there."""
        if self.kind == "field":
            apart = f"off by {self.amount()}" if self.off_by is not None else ""
            notes = ", ".join(filter(None, (apart, "" if self.determined else "not determined")))
            expected, actual = self.expected or "(blank)", self.actual or "(blank)"
            return f"{self.location()}: expected {expected}, actual {actual}" + (
                f" ({notes})" if notes else ""
            )
        if self.kind == "line":
            return (
                f"{self.location()}: the text differs\n"
                f"    expected |{self.expected}\n"
                f"    actual   |{self.actual}"
            )
        change, _, what = self.kind.partition(" ")
        whose = f"{what} missing from ACTUAL" if change == "missing" else f"{what} only in ACTUAL"
        text, sign = self.expected or self.actual, "-" if change == "missing" else "+"
        if what == "page":
            return f"{self.location()}: {whose} ({text.count(chr(10)) + 1} lines)"
        return f"{self.location()}: {whose}\n    {sign}|{text}"

    def amount(self) -> str:
        """Write how far two numbers are apart, with the unit; blank for text."""
        apart = self.off_by if self.apart is None else self.apart
        return "" if apart is None else f"{apart.normalize():f} {self.unit}".rstrip()

    def location(self) -> str:
        """Name page, frame, line, landmark and field, as far as they are known."""
        if self.expected_line is None:
            line = f"line {self.actual_line} of ACTUAL"
        elif self.actual_line in (None, self.expected_line):
            line = f"line {self.expected_line}"
        else:
            line = f"line {self.expected_line} ({self.actual_line} in ACTUAL)"
        named = (("frame", self.frame), ("landmark", self.landmark))
        frame, landmark = (f"{what} {name}" if name else "" for what, name in named)
        return ", ".join(filter(None, (f"page {self.page}", frame, line, landmark, self.field)))


# Tolerances, one for each quantity of a listing
#
# A listing prints rounded decimals. Two correct programs whose numbers differ in the last bits can
# round them to neighbouring decimals, so one unit of the last printed digit is allowed unless the
# table says otherwise. `vopd diff --units` multiplies it.

_ROUNDING = "rounded to its last printed digit"
_GIVEN = "input, only rounded or converted"
_FROM_0 = "rounded; 0 and 360 are one direction"
_FROM_MINUS_180 = "rounded; -180 and 180 are one direction"
_IDENTIFIES = "identifies, does not measure"


@dataclass(frozen=True)
class Tolerance:
    """How far one quantity may differ between two listings."""

    unit: str  # unit of the quantity, blank for a number without one
    reason: str  # why so much is allowed
    # difference allowed at `--units 1`, in units of the last printed digit; 0 for none
    digits: Decimal = Decimal(1)
    # value after which the quantity repeats, such as 360 degrees; None for none
    period: Decimal | None = None


_FULL_TURN = Decimal(360)

TOLERANCES = {
    "text": Tolerance("", "compared exactly, but for trailing blanks", Decimal(0)),
    "landmark number": Tolerance("", _IDENTIFIES, Decimal(0)),
    "frame number": Tolerance("", _IDENTIFIES, Decimal(0)),
    "landmark longitude": Tolerance("deg", _GIVEN),
    "geocentric latitude": Tolerance("deg", _ROUNDING),
    "landmark radius": Tolerance("1000 ft", _GIVEN),
    "geodetic latitude": Tolerance("deg", _GIVEN),
    "landmark altitude": Tolerance("ft", _GIVEN),
    "direction cosine": Tolerance("", _ROUNDING),
    "vehicle position": Tolerance("ft", _ROUNDING),
    "frame centre reading": Tolerance("in", _ROUNDING),
    "focal length": Tolerance("mm", _GIVEN),
    "landmark reading": Tolerance("in", _ROUNDING),
    "film coordinate": Tolerance("mm", _ROUNDING),
    "film radius": Tolerance("mm", _ROUNDING),
    "lens distortion": Tolerance("mm", _ROUNDING),
    "time": Tolerance("s", _ROUNDING),
    "camera yaw": Tolerance("deg", _FROM_0, period=_FULL_TURN),
    "camera pitch": Tolerance("deg", _FROM_MINUS_180, period=_FULL_TURN),
    "camera roll": Tolerance("deg", _FROM_0, period=_FULL_TURN),
    "frame centre": Tolerance("mm", _ROUNDING),
    "vehicle yaw": Tolerance("deg", _FROM_0, period=_FULL_TURN),
    "vehicle pitch": Tolerance("deg", _FROM_MINUS_180, period=_FULL_TURN),
    "vehicle roll": Tolerance("deg", _FROM_0, period=_FULL_TURN),
    "angle of attack": Tolerance("deg", _FROM_MINUS_180, period=_FULL_TURN),
    "angle of sideslip": Tolerance("deg", _FROM_MINUS_180, period=_FULL_TURN),
    "total angle of attack": Tolerance("deg", _ROUNDING),
    "residual": Tolerance("mm", _ROUNDING),
    "standard deviation": Tolerance("mm", _ROUNDING),
    "table position": Tolerance("", "a count", Decimal(0)),
    "table value": Tolerance("", _GIVEN),
}
"""A tolerance for each quantity that the fields of `vopd.listing.formats` name."""


def tolerance_rows() -> Iterator[tuple[str, ...]]:
    """List the printed table: heading, then quantity, unit, tolerance, period and reason."""
    yield "quantity", "unit", "at 1 unit", "modulo", "reason"
    decimals = {
        field.quantity: field.decimals
        for line in LINES.values()
        for field in line.fields
        if field.descriptor in "IF"
    }
    for quantity, row in TOLERANCES.items():
        if not row.digits:
            allowed = "equal"
        elif quantity in decimals:
            allowed = f"{row.digits.scaleb(-decimals[quantity]):f}"
        else:
            allowed = f"{row.digits} digit"
        yield quantity, row.unit, allowed, str(row.period or ""), row.reason


# Two printed fields
#
# All arithmetic is decimal and exact: what is compared is what is printed.

_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[ED][+-]?[0-9]{1,3})?")
_EXACT = Context(prec=60)
WRAPPED = 20  # digits: no angle that large is brought back to a circle


def exact_units(units: float | Decimal | str) -> Decimal:
    """Read the tolerance in units of the last digit, as an exact decimal.

    Args:
        units: 0 or more, fractions included

    Returns:
        The same number, exactly.

    Raises:
        VopdError: if `units` is negative, beyond 1e308, or no number.
    """
    text = str(units)
    if not is_number(text):
        raise VopdError(f"units: not a number: {text!r}")
    if not 0.0 <= float(text) < float("inf"):
        raise VopdError(f"units: not a number of 0 or more: {text!r}")
    return Decimal(text)


def printed_number(text: str) -> Decimal | None:
    """Read a printed number exactly; None for blanks, asterisks, NaN and other text."""
    text = text.strip()
    return Decimal(text.replace("D", "E")) if _NUMBER.fullmatch(text) else None


def apart(field: Field, expected: str, actual: str) -> Decimal | None:
    """Subtract two numbers, in the field's own unit; None for other text.

    Angles that wrap are compared around the circle.
    """
    one, other = printed_number(expected), printed_number(actual)
    if one is None or other is None:
        return None
    difference = _EXACT.abs(_EXACT.subtract(one, other))
    period = TOLERANCES[field.quantity].period
    if period is not None and difference.adjusted() < WRAPPED:
        difference = _EXACT.remainder(difference, period)
        difference = min(difference, _EXACT.subtract(period, difference))
    return difference


def units_apart(field: Field, expected: str, actual: str) -> Decimal | None:
    """Subtract two numbers, in units of the last printed digit; None for other text.

    The last digit is the FORMAT's for I and F fields, the one printed for E and G fields (the
    coarser of two).
    """
    one, other = printed_number(expected), printed_number(actual)
    difference = apart(field, expected, actual)
    if one is None or other is None or difference is None:
        return None
    digits = (-int(value.as_tuple().exponent) for value in (one, other))
    decimals = field.decimals if field.descriptor in "IF" else min(digits)
    return _EXACT.scaleb(difference, decimals)


Within = Mapping[str, Decimal]
"""How far numbers of a unit may differ, whatever their digits: by the unit of `TOLERANCES`."""
WITHIN_UNITS = ("deg", "ft", "in", "mm", "s")


def read_within(text: str) -> Within:
    """Read tolerances such as `.01deg,1ft`.

    Args:
        text: numbers of 0 or more, each with its unit: deg, ft, in, mm or s

    Raises:
        VopdError: for anything else, or for two of one unit.
    """
    found: dict[str, Decimal] = {}
    for one in text.split(","):
        parts = re.fullmatch(r"\s*(\d+\.?\d*|\.\d+)\s*([a-z]+)\s*", one, re.ASCII)
        if parts is None or parts[2] not in WITHIN_UNITS:
            units = listed([*WITHIN_UNITS], "or")
            raise VopdError(f"{one.strip()!r} is not a number with its unit, {units}")
        if parts[2] in found:
            raise VopdError(f"{parts[2]} is there twice: give one number for it")
        found[parts[2]] = Decimal(parts[1])
    if "ft" in found:
        found["1000 ft"] = found["ft"] / 1000
    return found


def fields_agree(
    field: Field, expected: str, actual: str, units: Decimal, within: Within = MappingProxyType({})
) -> bool:
    """Compare two fields: true for the same text, or numbers within either tolerance."""
    if expected.rstrip() == actual.rstrip():
        return True
    limit = within.get(TOLERANCES[field.quantity].unit)
    difference = None if limit is None else apart(field, expected, actual)
    if limit is not None and difference is not None and difference <= limit:
        return True
    if not units:
        return False
    off_by = units_apart(field, expected, actual)
    if off_by is None:
        return expected.strip() == actual.strip()
    return off_by <= _EXACT.multiply(units, TOLERANCES[field.quantity].digits)


# Fields whose printed digits are not determined
#
# A number that lies next to the boundary between two printed decimals is rounded up by one
# computer and down by another, because their sines differ in the last bits. Two listings of
# the same deck, with all numbers as low and as high as that can make them, say which fields
# these are and what they may hold.

Undetermined = Mapping[tuple[int, str], tuple[str, str]]
"""By line, from 1, and name of the field: its lowest and its highest number as printed."""


def may_hold(field: Field, text: str, low: str, high: str) -> bool:
    """Test a number for a field: it is the lowest, the highest, or one between them.

    Args:
        field: the field; angles that wrap lie on the shorter way around the circle
        text: what it holds
        low: the lowest number as printed
        high: the highest
    """
    if text.strip() in (low.strip(), high.strip()):
        return True
    whole = units_apart(field, low, high)
    parts = units_apart(field, low, text), units_apart(field, text, high)
    if whole is None or parts[0] is None or parts[1] is None:
        return False
    return parts[0] + parts[1] == whole


# Two listings: page by page, line by line, field by field
#
# Text must be equal except for blanks at the end of a line; numbers may differ as far as
# `TOLERANCES` says. EXPECTED may be the transcript of a damaged print: there a field of
# nothing but `?` is illegible and not compared, and a line that is a single `?` stands for any one
# line. In ACTUAL a `?` is text.

NONE: Undetermined = {}
_PagePair = tuple[ListingPage | None, ListingPage | None]


@dataclass
class Comparison:
    """How much of two listings was compared, and their differences in order."""

    pages: int = 0  # pages that both listings have
    fields_compared: int = 0  # fields that were compared
    fields_illegible: int = 0  # fields of EXPECTED that are illegible
    fields_undetermined: int = 0  # fields that differ in digits that are not determined
    # all differences; empty where they are yielded one by one
    differences: tuple[Difference, ...] = ()
    fields_within: int = 0  # fields that differ by no more than is allowed
    pages_missing: int = 0  # pages that EXPECTED alone has
    pages_extra: int = 0  # pages that ACTUAL alone has


def compare_listings(
    expected_text: str,
    actual_text: str,
    units: float | Decimal | str = 1.0,
    undetermined: Undetermined = NONE,
    within: Within = MappingProxyType({}),
) -> Comparison:
    """Compare two listings given as text.

    Args:
        expected_text: the listing to compare with; it may be a transcript with illegible parts
        actual_text: the listing to be judged
        units: how many units of its last printed digit a number may differ by, 0 or more;
            0 asks for identical text
        undetermined: fields of EXPECTED whose digits are not determined
        within: how far numbers may differ by their unit, besides, as `read_within` gives it

    Returns:
        The differences, and how many pages and fields were compared.

    Raises:
        VopdError: if `units` is negative, beyond 1e308, or no number.
    """
    result = Comparison()
    result.differences = tuple(
        find_differences(expected_text, actual_text, units, result, undetermined, within)
    )
    return result


def find_differences(
    expected_text: str,
    actual_text: str,
    units: float | Decimal | str,
    counts: Comparison,
    undetermined: Undetermined = NONE,
    within: Within = MappingProxyType({}),
) -> Iterator[Difference]:
    """Yield the differences one by one, and add to `counts` what has been compared so far.

    The arguments are those of `compare_listings`.
    """
    allowed = exact_units(units), within
    pages = align(split_pages(expected_text), split_pages(actual_text), page_cost)
    for expected, actual in _join_illegible_pages(pages):
        if expected is not None and actual is not None:
            counts.pages += 1
            yield from _compare_pages(expected, actual, allowed, counts, undetermined)
        elif expected is not None:
            counts.pages_missing += 1
            yield _page_without_partner("missing page", expected)
        elif actual is not None:
            counts.pages_extra += 1
            yield _page_without_partner("extra page", actual)


def _join_illegible_pages(pairs: Iterable[_PagePair]) -> list[_PagePair]:
    """Join pages of ACTUAL where illegible lines of EXPECTED stand for the pages between them."""
    joined: list[_PagePair] = []
    for expected, actual in pairs:
        if joined and not expected and _has_room(*joined[-1], actual):
            page, before = joined.pop()
            joined.append((page, _joined(before, actual)))
            continue
        while joined and not joined[-1][0] and _has_room(expected, actual, joined[-1][1]):
            actual = _joined(joined.pop()[1], actual)
        joined.append((expected, actual))
    return joined


def _has_room(
    expected: ListingPage | None, actual: ListingPage | None, more: ListingPage | None
) -> bool:
    """Test whether EXPECTED has illegible lines enough for most of one more page of ACTUAL."""
    if not expected or not actual or not more or ILLEGIBLE not in expected.lines:
        return False
    return 2 * (len(expected.lines) - len(actual.lines)) >= len(more.lines)


def _joined(first: ListingPage | None, second: ListingPage | None) -> ListingPage | None:
    """Join two pages to one."""
    if not first or not second:
        return first or second
    return ListingPage(first.number, first.first_line, first.lines + second.lines)


def _page_without_partner(
    kind: Literal["missing page", "extra page"], page: ListingPage
) -> Difference:
    """Report a page that only one of the listings has."""
    text = "\n".join(page.lines)
    if kind == "missing page":
        return Difference(kind, page.number, page.key or "", page.first_line, None, text, "")
    return Difference(kind, page.number, page.key or "", None, page.first_line, "", text)


def _compare_pages(
    expected: ListingPage,
    actual: ListingPage,
    allowed: tuple[Decimal, Within],
    counts: Comparison,
    undetermined: Undetermined,
) -> Iterator[Difference]:
    """Compare two pages that belong together, line by line."""
    kinds = recognise_lines(expected.lines, damaged=True)
    if expected.lines == actual.lines and not any(ILLEGIBLE in text for text in expected.lines):
        counts.fields_compared += sum(map(_count, kinds, expected.lines))
        return
    others = recognise_lines(actual.lines)
    frame = frames_of_lines(expected.lines, kinds)
    other_frame = frames_of_lines(actual.lines, others)
    for one, other in align(expected.with_kinds(kinds), actual.with_kinds(others), line_cost):
        named = (frame[one.number - expected.first_line] if one else "").strip("?")
        if other and not named:
            named = other_frame[other.number - actual.first_line]
        located = partial(
            Difference,
            page=expected.number,
            frame=named,
            expected_line=one.number if one else None,
            actual_line=other.number if other else None,
        )
        if one and other:
            yield from _compare_lines(one, other, allowed, counts, undetermined, located)
        elif one:
            yield located("missing line", expected=one.text, actual="")
        elif other:
            yield located("extra line", expected="", actual=other.text)


def _compare_lines(
    one: ListingLine,
    other: ListingLine,
    allowed: tuple[Decimal, Within],
    counts: Comparison,
    undetermined: Undetermined,
    located: partial[Difference],
) -> Iterator[Difference]:
    """Compare two lines that belong together, field by field."""
    if one.text == ILLEGIBLE:
        counts.fields_illegible += _count(other.kind, other.text)
        return
    if one.text == other.text and ILLEGIBLE not in one.text:
        kind = one.kind if one.kind is other.kind else common_kind(one, other)
        counts.fields_compared += _count(kind, one.text)
        return
    kind = common_kind(one, other)
    if kind is None or any(one.text[gap].rstrip() != other.text[gap].rstrip() for gap in kind.gaps):
        if one.text != other.text:
            yield located("line", expected=one.text, actual=other.text)
        return
    landmark = one.landmark.strip("?") or other.landmark
    for field in kind.fields:
        here, there = one.text[field.columns], other.text[field.columns]
        if not here.strip(" ?") and "?" in here:
            counts.fields_illegible += 1
            continue
        counts.fields_compared += bool(here.strip() or there.strip())
        if fields_agree(field, here, there, *allowed):
            counts.fields_within += bool(here != there and units_apart(field, here, there))
        else:
            between = undetermined.get((one.number, field.name))
            free = between is not None and all(
                may_hold(field, text, *between) for text in (here, there)
            )
            counts.fields_undetermined += free
            measured = TOLERANCES[field.quantity]
            yield located(
                "field",
                expected=here.strip(),
                actual=there.strip(),
                landmark=landmark,
                field=field.name,
                off_by=units_apart(field, here, there),
                determined=not free,
                apart=apart(field, here, there) if measured.digits else None,
                unit=measured.unit,
            )


def _count(kind: Line | None, text: str) -> int:
    """Count the fields of a line that are printed."""
    if kind is None or not kind.fields:
        return 0
    if len(text) >= kind.fields[-1].first:
        return len(kind.fields)
    return sum(bool(text[field.columns].strip()) for field in kind.fields)


def undetermined_fields(low_text: str, high_text: str) -> Undetermined:
    """Find the fields whose digits are not determined: those in which two listings differ.

    Args:
        low_text: a listing with all numbers as low as they may be
        high_text: the listing of the same deck with all numbers as high as they may be

    Raises:
        VopdError: where the two have other lines
    """
    found: dict[tuple[int, str], tuple[str, str]] = {}
    for one in compare_listings(low_text, high_text, 0).differences:
        if one.kind != "field" or one.expected_line is None:
            raise VopdError(f"LOW and HIGH are not listings of the same frames: {one}")
        found[one.expected_line, one.field] = one.expected, one.actual
    return found


# Listings from files

_TEXT = bytes([*range(0x20, 0x7F), 0x0A, 0x0D])
_CHUNK = 1 << 16
_BEGINNING = 1 << 20  # bytes within which a listing has its first heading: some 200 pages


A_FOLDER = (
    "is a folder, and two listings are compared: in a shell, for f in golden/*.lst; do vopd diff "
    "$f solved/$(basename $f); done"
)


def read_listing(name: str) -> str:
    """Read a listing.

    Args:
        name: name of the file; `-` is standard input

    Returns:
        The text, in printable ASCII.

    Raises:
        VopdError: if the file cannot be read, is empty, has a byte that is no printable ASCII
            character (reading stops there), or has no line that only a listing has in its
            first megabyte (reading stops there too).
    """
    where = "standard input" if name == "-" else name
    try:
        if name == "-":
            text = _read(sys.stdin.buffer, where)
        else:
            with Path(name).open("rb") as stream:
                text = _read(stream, where)
    except OSError as error:
        if name != "-" and Path(name).is_dir():
            raise VopdError(f"{where}: {A_FOLDER}") from None
        reason = error.strerror or str(error)
        raise VopdError(f"{where}: {reason[:1].lower()}{reason[1:]}") from None
    if not text:
        raise VopdError(f"{where}: empty, not a listing")
    return text


def _read(stream: BinaryIO, where: str) -> str:
    """Read a stream to its end, or to the first byte that no listing has."""
    chunks: list[bytes] = []
    size, known = 0, False
    while chunk := stream.read(_CHUNK):
        if chunk.translate(None, _TEXT):
            index = next(k for k, byte in enumerate(chunk) if byte not in _TEXT)
            line = sum(before.count(b"\n") for before in (*chunks, chunk[:index])) + 1
            raise VopdError(
                f"{where}: not a listing: line {line} has the byte 0x{chunk[index]:02X}, "
                "which is not a printable ASCII character"
            )
        chunks.append(chunk)
        size += len(chunk)
        if not known and size >= _BEGINNING:
            _refuse_without_heading(chunks, where, " in its first megabyte")
            known = True
    if chunks and not known:
        _refuse_without_heading(chunks, where)
    return b"".join(chunks).decode("ascii")


def _refuse_without_heading(chunks: list[bytes], where: str, within: str = "") -> None:
    """Refuse a text that has no line that only a listing has, as far as it has been read."""
    if not is_listing(b"".join(chunks).decode("ascii")):
        raise VopdError(
            f"{where}: not a listing: it has none of a listing's headings{within} "
            "(vopd run prints the listing of a deck)"
        )
