"""Numbers punched in columns, read many cards at a time and written one by one.

The machine of 1974 read a blank inside or after a number as a zero, and put
the decimal point where the FORMAT implies it when none was punched.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vopd.arrays import Bools, Floats
from vopd.cards.card import BLANK, Bytes
from vopd.cards.formats import Item

_POWERS = 10.0 ** np.arange(23)  # exact, so a quotient by one is correctly rounded
_PLAIN = re.compile(r"-?\d*\.\d*\d|-?\d+\.")
_FEW = 64  # fields that are read faster one by one
_SIMPLE = {"I": re.compile(rb"-?\d+"), "F": re.compile(rb"-?(?:\d+\.?\d*|\.\d+)")}
_REAL = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+))((?:[EeDd][+-]?|[+-])\d+)")


class Column(NamedTuple):
    """One field of many cards: the values, which are no numbers, which look misplaced."""

    value: Floats
    bad: Bools
    doubtful: Bools


def read_column(text: Bytes, item: Item) -> Column:
    """Read one field of many cards; `text` is (n, width) bytes, a blank field is zero.

    Doubtful is a number whose blanks count as zeros where that may not be
    meant: between digits, or after the last when no point was punched.
    """
    if len(text) <= _FEW:
        return _read_few(text, item)
    chars = np.ascontiguousarray(text.T)  # (width, n)
    first = chars[0]
    digits = chars - np.uint8(ord("0"))
    minus = first == ord("-")
    simple = (digits[1:] < 10).all(axis=0) & (minus | (first == BLANK) | (digits[0] < 10))
    value = np.asarray(_POWERS[: item.width][::-1] @ np.where(digits < 10, digits, np.uint8(0)))
    value = value / _POWERS[item.decimals]
    np.negative(value, out=value, where=minus)
    bad, doubtful = np.zeros((2, len(text)), bool)
    rest = np.flatnonzero(~simple)
    if len(rest):
        value[rest], bad[rest], doubtful[rest] = _read_any(chars[:, rest], item)
    return Column(value, bad, doubtful)


def _read_few(text: Bytes, item: Item) -> Column:
    """The same for a few cards, one after the other."""
    simple, joined, width = _SIMPLE[item.kind], text.tobytes(), text.shape[1]
    implied = float(_POWERS[item.decimals])
    value, bad, doubtful = np.zeros(len(text)), *np.zeros((2, len(text)), bool)
    rest: list[int] = []
    for row, start in enumerate(range(0, len(joined), width)):
        field = joined[start : start + width].lstrip(b" ")
        if simple.fullmatch(field):
            value[row] = float(field) if b"." in field else float(field) / implied
        elif field:
            rest.append(row)
    if rest:
        chars = np.ascontiguousarray(text[rest].T)
        value[rest], bad[rest], doubtful[rest] = _read_any(chars, item)
    return Column(value, bad, doubtful)


def _read_any(chars: Bytes, item: Item) -> Column:
    """The same for fields that are not simply digits, with a blank or a minus before them."""
    blank = chars == BLANK
    started = np.logical_or.accumulate(~blank)
    digits = chars - np.uint8(ord("0"))
    digit = digits < 10
    zero = blank & started
    sign = np.zeros_like(blank)
    sign[0] = ~blank[0] & ~digit[0]
    sign[1:] = ~digit[1:] & ~blank[1:] & ~started[:-1]
    point = (chars == ord(".")) if item.kind == "F" else np.zeros_like(blank)
    sign &= ~point
    minus = (sign & (chars == ord("-"))).any(axis=0)
    signed = minus | (sign & (chars == ord("+"))).any(axis=0)
    points = point.sum(axis=0)

    plain = (blank | digit | sign | point).all(axis=0) & (points < 2)
    plain &= signed | ~sign.any(axis=0)
    plain &= (digit | zero).any(axis=0) | ~started[-1]
    size = _scaled(np.where(digit, digits, 0), point, item.decimals)
    value: Floats = np.where(minus, -size, size)

    before, after = np.logical_or.accumulate(digit), np.logical_or.accumulate(digit[::-1])[::-1]
    doubtful = (zero & before & after).any(axis=0) | (started[-1] & blank[-1] & (points == 0))
    bad = ~plain
    for row in np.flatnonzero(bad):
        unusual = _read_exponent(chars[:, row].tobytes().decode("ascii"), item)
        if unusual is not None:
            value[row], bad[row] = unusual, False
            doubtful[row] = zero[:, row].any()  # a blank in an exponent is worth much
    return Column(np.where(bad, np.nan, value), bad, doubtful & ~bad)


def _scaled(digits: NDArray[np.uint8], point: Bools, implied: int) -> Floats:
    """The value of rows of digits, a point counting as the digit 0 in its place."""
    width = len(digits)
    whole = _POWERS[width - 1 :: -1][:width] @ digits.astype(np.float64)
    punched = point.any(axis=0)
    behind = np.where(punched, width - 1 - point.argmax(axis=0), 0)
    high = np.floor(whole / _POWERS[behind + 1])  # in front of the point
    value = np.where(punched, whole - 9 * high * _POWERS[behind], whole)
    return np.asarray(value / _POWERS[np.where(punched, behind, implied)])


def _read_exponent(text: str, item: Item) -> float | None:
    """A number with an exponent, as FORTRAN reads it, or None."""
    number = _REAL.fullmatch(text.lstrip().replace(" ", "0"))
    if item.kind != "F" or number is None:
        return None
    mantissa, exponent = number.groups()
    shift = 0 if "." in mantissa else item.decimals
    value = float(f"{mantissa}e{int(exponent.lstrip('EeDd')) - shift}")
    return value if np.isfinite(value) else None


def write_number(value: float, item: Item) -> str | None:
    """The shortest text that this field reads back as exactly `value`; None if there is none."""
    if item.kind == "I":
        text = str(int(value))
        return text.rjust(item.width) if len(text) <= item.width else None
    for text in _spellings(float(value), item.decimals):
        if len(text) <= item.width and _reads_as(text, value, item):
            return text.rjust(item.width)
    return None


def _reads_as(text: str, value: float, item: Item) -> bool:
    if _PLAIN.fullmatch(text) and len(text) <= 15:  # exact digits by an exact power, rounded once
        return float(text).hex() == float(value).hex()
    column = np.frombuffer(text.rjust(item.width).encode(), np.uint8)[None]
    read = read_column(column, item)
    return not read.bad[0] and float(read.value[0]).hex() == float(value).hex()


def _spellings(value: float, implied: int) -> Iterator[str]:
    """Ways to punch a number, the plainest first: with a point, implied, with an exponent."""
    sign = "-" if np.signbit(value) else ""
    mantissa, exponent = np.format_float_scientific(abs(value), trim="-").split("e")
    digits, power = mantissa.replace(".", ""), int(exponent)
    places = len(digits) - 1 - power  # behind the point
    if -20 < places <= 0:
        yield f"{sign}{digits}{'0' * -places}."
        yield f"{sign}{digits}{'0' * (implied - places)}"
    elif 0 < places < 30:
        padded = digits.rjust(places, "0")
        yield f"{sign}{padded[: len(padded) - places]}.{padded[len(padded) - places :]}"
        if places <= implied:
            yield f"{sign}{digits}{'0' * (implied - places)}"
    yield f"{sign}{digits}.E{power - len(digits) + 1}"
    yield f"{sign}{digits}E{power - len(digits) + 1 + implied}"
    yield f"{sign}{digits}{power - len(digits) + 1 + implied:+d}"
