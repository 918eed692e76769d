"""Editing numbers for the printer: FORMATs as templates, and the fields that do not fit.

A line of the listing is one `%` template; numbers below one have no zero before
the point, as the 1974 printer left it, and rounding is that of C's printf.
"""

from __future__ import annotations

import numpy as np

from vopd.job import Bools, Floats
from vopd.listing.layout import Field, Line


def template(line: Line, odd: frozenset[int] = frozenset()) -> str:
    """The line, with the blank lines before it, as a `%` template.

    The fields in `odd` take text instead of a number.
    """
    pieces = [(first, literal.replace("%", "%%"), len(literal)) for first, literal in line.literals]
    for place, field in enumerate(line.fields):
        kind = "s" if place in odd else "d" if field.edit == "I" else f".{field.decimals}f"
        pieces.append((field.first, f"%{field.width}{kind}", field.width))
    text, column = "\n" * line.blank_lines, 1
    for first, piece, width in sorted(pieces):
        text += " " * (first - column) + piece
        column = first + width
    return text + "\n"


def without_leading_zeros(text: str) -> str:
    """Drop the zero before a point, keeping the columns.

    Every field of the listing is wide enough for a blank or a sign before it.
    """
    return text.replace(" 0.", "  .").replace("-0.", " -.")


def too_wide(field: Field, values: Floats) -> Bools:
    """Which numbers may not fit their field, or are none; a few that just fit are among them."""
    digits = field.width - (field.decimals + 1 if field.edit == "F" else 0)
    size = np.where(values < 0, -10.0, 1.0) * values  # a sign takes the place of a digit
    fits: Bools = size < 10.0**digits - 1.0
    return ~fits


def fixed(value: float, field: Field) -> str:
    """One number edited for its field: asterisks where it does not fit."""
    if np.isnan(value):
        text = "NaN"
    elif np.isinf(value):
        text = ("-" if value < 0 else "") + ("Infinity" if field.width > 8 else "Inf")
    elif field.edit == "I":
        text = str(int(value))
    else:
        text = f"{value:.{field.decimals}f}"
        text = text.replace("0.", ".", 1) if text.lstrip("-").startswith("0.") else text
    return text.rjust(field.width) if len(text) <= field.width else "*" * field.width


def exponential(value: float, field: Field) -> str:
    """One number with an exponent, one digit before the point (FORMAT 102)."""
    return f"{value:.{field.decimals}E}".rjust(field.width)


def general(value: float, width: int, digits: int) -> str:
    """One number edited by G `width`.`digits`, as FTLUP prints its tables."""
    if not np.isfinite(value):
        return f"{value:.0f}".replace("nan", "NaN").replace("inf", "Infinity").rjust(width)
    mantissa, power = f"{abs(value):.{digits - 1}E}".split("E")
    places = digits - 1 - int(power)  # behind the point
    sign = "-" if np.signbit(value) else ""
    if value == 0 or 0 <= places <= digits:
        text = f"{abs(value):.{digits - 1 if value == 0 else places}f}".removeprefix("0")
        return f"{sign}{text if '.' in text else text + '.'}    ".rjust(width)
    exponent = int(power) + 1
    return f"{sign}.{mantissa.replace('.', '')}E{exponent:+03d}".rjust(width)
