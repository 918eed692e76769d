"""Editing for the printer one field at a time: what a line is without numbers, and odd numbers."""

from __future__ import annotations

import numpy as np

from vopd.listing.line_formats import Field, Line


def blank(line: Line) -> str:
    """The line, with the blank lines before it and its end, its fields left blank."""
    width = max((field.last for field in line.fields), default=0)
    return "\n" * line.blank_lines + line.text.ljust(width) + "\n"


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
        return f"{value:.0f}".replace("inf", "Infinity").rjust(width)
    mantissa, power = f"{abs(value):.{digits - 1}E}".split("E")
    places = digits - 1 - int(power)  # behind the point
    sign = "-" if np.signbit(value) else ""
    if value == 0 or 0 <= places <= digits:
        text = f"{abs(value):.{digits - 1 if value == 0 else places}f}".removeprefix("0")
        return f"{sign}{text if '.' in text else text + '.'}    ".rjust(width)
    exponent = int(power) + 1
    letter = "E" if abs(exponent) < 100 else ""  # which makes room for a third digit
    return f"{sign}.{mantissa.replace('.', '')}{letter}{exponent:+03d}".rjust(width)
