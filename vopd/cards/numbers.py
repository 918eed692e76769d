"""Numbers in fields of cards, as FORTRAN reads and writes them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vopd.arrays import Bools, Floats
from vopd.cards.deck import BLANK, Bytes
from vopd.cards.format import FormatItem, format_items

# Numbers read from fields of cards, many cards at a time
#
# As on the machine of 1974, a blank inside or after a number is a zero, and a
# number without a decimal point has the decimals of its FORMAT.

_POWERS = 10.0 ** np.arange(23)  # exact, so a quotient by one is correctly rounded
_LARGEST_EXPONENT = 9_999  # that of gfortran
FEW = 64  # fields that are read faster one by one
_SIMPLE = {"I": re.compile(rb"-?\d+"), "F": re.compile(rb"-?(?:\d+\.?\d*|\.\d+)")}
_REAL = (
    r"(?P<sign>[+-]? *)(?P<mantissa>[\d ]*(?:\.[\d ]*)?)"
    r"(?:(?:[EeDdQq] *)?(?P<signed>[+-][\d ]+)|[EeDdQq] *(?P<exponent>\d[\d ]*))?"
)
"""A real number as gfortran reads it where blanks are zeros: only the blanks between the
letter of an exponent and its first digit or sign are skipped."""


class FieldValues(NamedTuple):
    """The numbers of one field on many cards (cards,), or of all their fields (cards, fields)."""

    value: Floats  # the numbers; NaN where a field is not a number
    unreadable: Bools  # whether a field is not a number
    doubtful: Bools  # whether it is a number that may not be the one that was meant

    def questionable(self) -> list[list[int]]:
        """List the indices of fields that are unreadable or doubtful, in the order of the cards."""
        marked = self.unreadable | self.doubtful
        return np.argwhere(marked).tolist() if marked.any() else []


def read_field(text: Bytes, item: FormatItem) -> FieldValues:
    """Read one field of many cards as FORTRAN reads it with blanks as zeros.

    Doubtful is a number in which blanks count as zeros, between its digits or
    after the last one where no point was punched; and a zero without any digit,
    such as a point alone.

    Args:
        text: the columns of the field, shape (cards, width), as bytes
        item: the field in its FORMAT

    Returns:
        The values; a blank field is zero.
    """
    if len(text) <= FEW:
        joined, width = text.tobytes(), text.shape[1]
        fields = [joined[start : start + width] for start in range(0, len(joined), width)]
        return read_few(fields, [item] * len(fields))
    chars = np.ascontiguousarray(text.T)  # (width, cards)
    first = chars[0]
    digits = chars - np.uint8(ord("0"))
    minus = first == ord("-")
    simple = (digits[1:] < 10).all(axis=0) & (minus | (first == BLANK) | (digits[0] < 10))
    value = np.asarray(_POWERS[: item.width][::-1] @ np.where(digits < 10, digits, np.uint8(0)))
    value = value / _POWERS[item.decimals]
    np.negative(value, out=value, where=minus)
    unreadable, doubtful = np.zeros((2, len(text)), bool)
    rest = np.flatnonzero(~simple)
    if len(rest):
        value[rest], unreadable[rest], doubtful[rest] = _read_any(chars[:, rest], item)
    return FieldValues(value, unreadable, doubtful)


def read_few(fields: Sequence[bytes], items: Sequence[FormatItem]) -> FieldValues:
    """Read a few fields, one after the other, each as its own item reads it.

    Args:
        fields: the columns of each field
        items: the field in its FORMAT, one for each
    """
    unreadable, doubtful = np.zeros((2, len(fields)), bool)
    value = np.zeros(len(fields))
    for k, (columns, item) in enumerate(zip(fields, items, strict=True)):
        field = columns.lstrip(b" ")
        if not field:
            continue
        if _SIMPLE[item.kind].fullmatch(field):
            value[k] = float(field) if b"." in field else float(field) / item.implied
            continue
        chars = np.frombuffer(columns, np.uint8)[:, None]
        one = slice(k, k + 1)
        value[one], unreadable[one], doubtful[one] = _read_any(chars, item)
    return FieldValues(value, unreadable, doubtful)


def _read_any(chars: Bytes, item: FormatItem) -> FieldValues:
    """Read fields other than digits with a blank or a minus before them."""
    blank = chars == BLANK
    started = np.logical_or.accumulate(~blank)
    digits = chars - np.uint8(ord("0"))
    digit = digits < 10
    zero = blank & started
    real = item.kind == "F"
    point = (chars == ord(".")) if real else np.zeros_like(blank)
    sign = np.zeros_like(blank)  # the first character of the number, where it is a sign
    sign[0] = ~blank[0] & ~digit[0]
    sign[1:] = ~digit[1:] & ~blank[1:] & ~started[:-1]
    sign &= ~point
    minus = (sign & (chars == ord("-"))).any(axis=0)
    signed = minus | (sign & (chars == ord("+"))).any(axis=0)

    plain = (blank | digit | sign | point).all(axis=0) & (point.sum(axis=0) < 2)
    plain &= signed | ~sign.any(axis=0)
    no_digit = started[-1] & ~digit.any(axis=0)
    if not real:
        plain &= (digit | zero).any(axis=0) | ~started[-1]
    size = _scaled(np.where(digit, digits, 0), point, item.decimals)
    value: Floats = np.where(minus & (digit | point).any(axis=0), -size, size)
    doubtful = no_digit | _blanks_as_zeros(zero, digit, point) if zero.any() else no_digit

    unreadable = ~plain
    for card in np.flatnonzero(unreadable):
        text = chars[:, card].tobytes().decode("ascii").lstrip()
        unusual = _read_exponent(text, item)
        if unusual is not None:
            value[card], unreadable[card] = unusual, False
            doubtful[card] = " " in text or not re.match(r"[+-]?\.?\d", text)
    return FieldValues(np.where(unreadable, np.nan, value), unreadable, doubtful & ~unreadable)


def _blanks_as_zeros(zero: Bools, digit: Bools, point: Bools) -> Bools:
    """Mark fields with a blank between two digits, or at the end if no point was punched."""
    before, after = np.logical_or.accumulate(digit), np.logical_or.accumulate(digit[::-1])[::-1]
    between = (zero & before & after).any(axis=0)
    return np.asarray(between | (zero[-1] & ~point.any(axis=0)))


def _scaled(digits: NDArray[np.uint8], point: Bools, implied: int) -> Floats:
    """Add up rows of digits, a point counting as the digit 0 in its place."""
    width = len(digits)
    whole = _POWERS[width - 1 :: -1][:width] @ digits.astype(np.float64)
    punched = point.any(axis=0)
    behind = np.where(punched, width - 1 - point.argmax(axis=0), 0)
    high = np.floor(whole / _POWERS[behind + 1])  # in front of the point
    value = np.where(punched, whole - 9 * high * _POWERS[behind], whole)
    return np.asarray(value / _POWERS[np.where(punched, behind, implied)])


def _read_exponent(text: str, item: FormatItem) -> float | None:
    """Read a real number with an exponent; None if it is not one or is too large."""
    number = re.fullmatch(_REAL, text)
    if item.kind != "F" or number is None:
        return None
    sign, mantissa = number["sign"].strip(), number["mantissa"].replace(" ", "0")
    exponent = int((number["signed"] or number["exponent"] or "0").replace(" ", "0"))
    exponent -= 0 if "." in mantissa else item.decimals
    if abs(exponent) > _LARGEST_EXPONENT:
        return None
    whole, _, decimals = mantissa.partition(".")
    value = float(f"{sign}{whole or '0'}.{decimals}e{exponent}")
    return value if np.isfinite(value) else None


# Numbers written so that reading the text gives the same bits

_PLAIN = re.compile(r"-?\d*\.\d*\d|-?\d+\.")


def write_number(value: float, item: FormatItem) -> str | None:
    """Find the shortest text that a field reads back as exactly this number.

    Returns:
        The text, as wide as the field; None where no text of that width is this number.
    """
    if not np.isfinite(value):
        return None
    if item.kind == "I":
        text = str(int(value))
        return text.rjust(item.width) if len(text) <= item.width else None
    for text in _spellings(float(value), item.decimals):
        if len(text) <= item.width and _reads_as(text, value, item):
            return text.rjust(item.width)
    return None


def rounded_to_fit(value: float, form: int, field: int) -> float:
    """Round a number, by significant digits, to the nearest that a field holds exactly.

    Args:
        value: the number
        form: the number of the FORMAT, a key of `vopd.cards.format.FORMATS`
        field: the field's index in it
    """
    item = format_items(form)[field]
    for digits in range(17, 0, -1):
        rounded = float(f"{value:.{digits - 1}e}")
        if write_number(rounded, item) is not None:
            return rounded
    return value


def nearest_that_fits(value: float, item: FormatItem) -> str:
    """Suggest, in words for a message, the nearest to a number that does not fit its field.

    Args:
        value: a number for which `write_number` gives None
        item: the field in its FORMAT

    Returns:
        Such as "rounded to 7 decimals, 0.3333333"; empty where no rounding helps.
    """
    if item.kind == "I" or not np.isfinite(value):
        return ""
    for digits in range(17, 0, -1):
        rounded = float(f"{value:.{digits - 1}e}")
        if write_number(rounded, item) is not None:
            text = np.format_float_positional(rounded, trim="-")
            decimals = len(text.partition(".")[2])
            if 0 < decimals <= 12:
                return f"rounded to {decimals} decimal{'s' * (decimals > 1)}, {text}"
            return f"rounded to {digits} significant digits, {rounded:.{digits}g}"
    return ""


def _reads_as(text: str, value: float, item: FormatItem) -> bool:
    """Test a field's text for exactly this number, signed zeros told apart."""
    if _PLAIN.fullmatch(text) and len(text) <= 15:  # exact digits by an exact power, rounded once
        return float(text).hex() == float(value).hex()
    column = np.frombuffer(text.rjust(item.width).encode(), np.uint8)[None]
    read = read_field(column, item)
    return not read.unreadable[0] and float(read.value[0]).hex() == float(value).hex()


def _spellings(value: float, implied: int) -> Iterator[str]:
    """Try texts of a number, the plainest first: with a point, without one, with an exponent."""
    sign = "-" if np.signbit(value) else ""
    mantissa, exponent = np.format_float_scientific(abs(value), trim="-").split("e")
    digits, power = mantissa.replace(".", ""), int(exponent)
    decimals = len(digits) - 1 - power  # behind the point
    if -20 < decimals <= 0:
        yield f"{sign}{digits}{'0' * -decimals}."
        yield f"{sign}{digits}{'0' * (implied - decimals)}"
    elif 0 < decimals < 30:
        padded = digits.rjust(decimals, "0")
        yield f"{sign}{padded[: len(padded) - decimals]}.{padded[len(padded) - decimals :]}"
        if decimals <= implied:
            yield f"{sign}{digits}{'0' * (implied - decimals)}"
    yield f"{sign}{digits}.E{power - len(digits) + 1}"
    yield f"{sign}{digits}E{power - len(digits) + 1 + implied}"
    yield f"{sign}{digits}{power - len(digits) + 1 + implied:+d}"
