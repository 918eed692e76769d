"""How far two listings may disagree: one row a quantity, for every field of the listing.

Both listings print rounded decimals, so two correct programs whose doubles
differ in the last bits can print neighbouring last digits: one unit of the last
printed digit is allowed unless a row says otherwise. `--units` multiplies it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal

from vopd.listing.line_formats import LINES

_ROUNDING = "rounded to its last printed digit"
_GIVEN = "input, only rounded or converted"
_WRAPS = "rounded; 0 and 360 are one direction"
_TURNS = "rounded; -180 and 180 are one direction"
_NAME = "a name, not a measure"


@dataclass(frozen=True)
class Tolerance:
    """What one quantity is allowed.

    `digits` is the difference allowed at `--units 1`, in units of the last
    printed digit (0: equal numbers); `period` the value after which it repeats.
    """

    unit: str
    reason: str
    digits: Decimal = Decimal(1)
    period: Decimal | None = None


_TURN = Decimal(360)

TOLERANCES = {
    "text": Tolerance("", "compared exactly, but for trailing blanks", Decimal(0)),
    "landmark number": Tolerance("", _NAME, Decimal(0)),
    "frame number": Tolerance("", _NAME, Decimal(0)),
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
    "camera yaw": Tolerance("deg", _WRAPS, period=_TURN),
    "camera pitch": Tolerance("deg", _TURNS, period=_TURN),
    "camera roll": Tolerance("deg", _WRAPS, period=_TURN),
    "frame centre": Tolerance("mm", _ROUNDING),
    "vehicle yaw": Tolerance("deg", _WRAPS, period=_TURN),
    "vehicle pitch": Tolerance("deg", _TURNS, period=_TURN),
    "vehicle roll": Tolerance("deg", _WRAPS, period=_TURN),
    "angle of attack": Tolerance("deg", _TURNS, period=_TURN),
    "angle of sideslip": Tolerance("deg", _TURNS, period=_TURN),
    "total angle of attack": Tolerance("deg", _ROUNDING),
    "residual": Tolerance("mm", _ROUNDING),
    "standard deviation": Tolerance("mm", _ROUNDING),
    "table position": Tolerance("", "a count", Decimal(0)),
    "table value": Tolerance("", _GIVEN),
}
"""Quantity to tolerance; the fields of `vopd.listing.line_formats` name the quantities."""


def table() -> Iterator[tuple[str, ...]]:
    """The table to print: a heading, then quantity, unit, allowance, period and reason."""
    yield "quantity", "unit", "at 1 unit", "modulo", "reason"
    decimals = {
        field.quantity: field.decimals
        for line in LINES.values()
        for field in line.fields
        if field.edit in "IF"
    }
    for quantity, row in TOLERANCES.items():
        if not row.digits:
            allowed = "equal"
        elif quantity in decimals:
            allowed = f"{row.digits.scaleb(-decimals[quantity]):f}"
        else:
            allowed = f"{row.digits} digit"
        yield quantity, row.unit, allowed, str(row.period or ""), row.reason
