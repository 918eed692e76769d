"""Format one number in one field, for the few that are not printed many at a time."""

from __future__ import annotations

import math

import numpy as np

from vopd.listing.line_formats import Field, Line


def line_without_numbers(line: Line) -> str:
    """The text of a line with its fields blank, with its line end and the blank lines before it.

    Args:
        line: the kind of line.
    """
    width = max((field.last for field in line.fields), default=0)
    return "\n" * line.blank_lines + line.text.ljust(width) + "\n"


def fixed(value: float, field: Field) -> str:
    """The text of a number in an F or I field; asterisks if it does not fit.

    Args:
        value: the number.
        field: gives the width and the decimals.
    """
    width = field.width
    if not math.isfinite(value):
        sign = "-" if value < 0 else ""
        text = "NaN" if math.isnan(value) else sign + "Infinity"
        if len(text) > width:
            text = sign + "Inf"
    elif field.descriptor == "I":
        text = str(int(value))
    else:
        text = f"{value:.{field.decimals}f}"
        if text.startswith(("0.", "-0.")):
            text = text.replace("0.", ".", 1)
    return text.rjust(width) if len(text) <= width else "*" * width


def exponential(value: float, field: Field) -> str:
    """The text of a number with an exponent, as FORMAT 102 prints it: one digit before the point.

    Args:
        value: the number.
        field: gives the width and the decimals.
    """
    return f"{value:.{field.decimals}E}".rjust(field.width)


def general(value: float, width: int, digits: int) -> str:
    """The text of a number in a field G `width`.`digits`, as FTLUP prints its tables.

    Args:
        value: the number.
        width: how many columns the field has.
        digits: how many significant digits it shows.
    """
    if not np.isfinite(value):
        return f"{value:.0f}".replace("inf", "Infinity").rjust(width)
    mantissa, power = f"{abs(value):.{digits - 1}E}".split("E")
    places = digits - 1 - int(power)  # behind the point
    sign = "-" if np.signbit(value) else ""
    if 0 <= places <= digits:
        text = f"{abs(value):.{places}f}".removeprefix("0")
        return f"{sign}{text if '.' in text else text + '.'}    ".rjust(width)
    exponent = int(power) + 1
    letter = "E" if abs(exponent) < 100 else ""  # which makes room for a third digit
    return f"{sign}.{mantissa.replace('.', '')}{letter}{exponent:+03d}".rjust(width)
