"""Write a number as the text of a card's field; reading the text gives the same bits."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from vopd.cards.formats import FormatItem, format_items
from vopd.cards.numbers import read_field

_PLAIN = re.compile(r"-?\d*\.\d*\d|-?\d+\.")


def write_number(value: float, item: FormatItem) -> str | None:
    """The shortest text that a field reads back as exactly this number.

    Args:
        value: the number
        item: the field in its FORMAT

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
    """The number nearest to one, by significant digits, that a field holds exactly.

    Args:
        value: the number
        form: the number of the FORMAT, a key of `vopd.cards.formats.FORMATS`
        field: the field's index in it
    """
    item = format_items(form)[field]
    for digits in range(17, 0, -1):
        rounded = float(f"{value:.{digits - 1}e}")
        if write_number(rounded, item) is not None:
            return rounded
    return value


def nearest_that_fits(value: float, item: FormatItem) -> str:
    """The number nearest to one that does not fit its field, as words for a message.

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
    """Whether a field with this text is exactly this number, signed zeros told apart."""
    if _PLAIN.fullmatch(text) and len(text) <= 15:  # exact digits by an exact power, rounded once
        return float(text).hex() == float(value).hex()
    column = np.frombuffer(text.rjust(item.width).encode(), np.uint8)[None]
    read = read_field(column, item)
    return not read.unreadable[0] and float(read.value[0]).hex() == float(value).hex()


def _spellings(value: float, implied: int) -> Iterator[str]:
    """Texts of a number, the plainest first: with a point, without one, with an exponent."""
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
