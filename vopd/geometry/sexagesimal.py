"""Angles as people write them: decimal degrees, or degrees, minutes and seconds."""

from __future__ import annotations

import re

NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d{1,3})?", re.ASCII)
SEXAGESIMAL = re.compile(
    r"(?P<sign>[+-])? ?(?P<whole>\d{1,4}) ?(?P<unit>[dh°:]| ) ?"
    r"(?P<minutes>\d{1,2}) ?(['′m:]| |$) ?"  # noqa: RUF001
    r"((?P<seconds>\d{1,2}(\.\d*)?) ?(\"|''|″|s)?)?",
    re.ASCII,
)
"""In a text with single blanks: any number of them in several places takes hours."""


def parse_number(text: str) -> float:
    """Read a plain decimal number.

    Returns:
        Its value.

    Raises:
        ValueError: the text is something else, such as NaN or 1_000.
    """
    stripped = text.strip()
    if NUMBER.fullmatch(stripped) is None:
        raise ValueError(f"not a number: {stripped!r}")
    return float(stripped)


def parse_angle_deg(text: str, *, hours: bool = False) -> float:
    """Read an angle in decimal degrees, or in degrees, minutes and seconds.

    Args:
        text: `-4.43`, `-4 25 49.68`, `-4:25:49.68`, `-4°25'49.68"` or `5h12m3s`; the
            sign counts for the whole angle, in -0 25 0 too
        hours: whether hours are allowed; they must be marked h

    Returns:
        The angle, degrees.

    Raises:
        ValueError: the text is none of these, or its minutes or seconds are 60 or more.
    """
    stripped = text.strip().replace("−", "-")  # noqa: RUF001
    if NUMBER.fullmatch(stripped):
        return float(stripped)
    match = SEXAGESIMAL.fullmatch(" ".join(stripped.split()))
    if match is None or (match["unit"] == "h" and not hours):
        raise ValueError(
            f"not an angle: {stripped!r} (decimal degrees, or degrees minutes seconds)"
        )
    minutes, seconds = int(match["minutes"]), float(match["seconds"] or 0.0)
    if minutes >= 60 or seconds >= 60.0:
        raise ValueError(f"minutes and seconds must be below 60: {stripped!r}")
    size = int(match["whole"]) + minutes / 60.0 + seconds / 3600.0
    if match["unit"] == "h":
        size *= 15.0
    return -size if match["sign"] == "-" else size


def format_dms(angle_deg: float, decimals: int = 2) -> str:
    """Write an angle as degrees, minutes and seconds, `-4°25'49.68"`.

    Args:
        angle_deg: the angle, degrees
        decimals: of the seconds

    Returns:
        The text; the sign is kept for angles between -1 and 0, but not before a zero.
    """
    unit = 10**decimals
    ticks = round(abs(angle_deg) * 3600 * unit)
    sign = "-" if angle_deg < 0 < ticks else ""
    whole, rest = divmod(ticks, 3600 * unit)
    minutes, ticks = divmod(rest, 60 * unit)
    width = 3 + decimals if decimals else 2
    return f"{sign}{whole}°{minutes:02d}'{ticks / unit:0{width}.{decimals}f}\""
