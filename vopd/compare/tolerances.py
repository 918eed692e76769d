"""How far two listings may differ: one tolerance for each quantity of a listing.

A listing prints rounded decimals. Two correct programs whose numbers differ in the last bits can
round them to neighbouring decimals, so one unit of the last printed digit is allowed unless the
table says otherwise. `vopd diff --units` multiplies it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal

from vopd.listing.line_formats import LINES

_ROUNDING = "rounded to its last printed digit"
_GIVEN = "input, only rounded or converted"
_FROM_0 = "rounded; 0 and 360 are one direction"
_FROM_MINUS_180 = "rounded; -180 and 180 are one direction"
_IDENTIFIES = "identifies, does not measure"


@dataclass(frozen=True)
class Tolerance:
    """How far one quantity may differ between two listings.

    Args:
        unit: unit of the quantity, blank for a number without one
        reason: why so much is allowed
        digits: difference allowed at `--units 1`, in units of the last printed digit; 0 for none
        period: value after which the quantity repeats, such as 360 degrees; None for none
    """

    unit: str
    reason: str
    digits: Decimal = Decimal(1)
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
"""A tolerance for each quantity that the fields of `vopd.listing.line_formats` name."""


def tolerance_rows() -> Iterator[tuple[str, ...]]:
    """The rows of the printed table: a heading, then quantity, unit, tolerance, period, reason."""
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
