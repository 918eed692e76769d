"""Two printed fields against each other: how many units of the last digit they lie apart."""

from __future__ import annotations

import re
from decimal import Context, Decimal, InvalidOperation

from vopd.compare.tolerances import TOLERANCES
from vopd.findings import VopdError
from vopd.listing.line_formats import Field

_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[ED][+-]?[0-9]{1,3})?")
_EXACT = Context(prec=60)


def units_allowed(units: float | Decimal | str) -> Decimal:
    """`--units` as an exact number; VopdError if it is negative or no finite number."""
    try:
        exact = Decimal(str(units))
    except InvalidOperation:
        raise VopdError(f"units: not a number: {str(units)!r}") from None
    if not exact.is_finite() or exact < 0:
        raise VopdError(f"units: not a number of 0 or more: {str(units)!r}")
    return exact


def number(text: str) -> Decimal | None:
    """A printed number, exactly; None for blanks, asterisks, NaN and any other text."""
    text = text.strip()
    return Decimal(text.replace("D", "E")) if _NUMBER.fullmatch(text) else None


def off_by(field: Field, expected: str, actual: str) -> Decimal | None:
    """How far apart two numbers are, in units of the last printed digit; None for other text.

    The last digit is the FORMAT's for I and F fields, the one printed for E and
    G fields (the coarser of two). Angles that wrap are compared around the circle.
    """
    one, other = number(expected), number(actual)
    if one is None or other is None:
        return None
    apart = _EXACT.abs(_EXACT.subtract(one, other))
    period = TOLERANCES[field.quantity].period
    if period is not None:
        apart = _EXACT.remainder(apart, period)
        apart = min(apart, _EXACT.subtract(period, apart))
    digits = (-int(value.as_tuple().exponent) for value in (one, other))
    places = field.decimals if field.edit in "IF" else min(digits)
    return _EXACT.scaleb(apart, places)


def agree(field: Field, expected: str, actual: str, units: Decimal) -> bool:
    """Whether two fields say the same: the same text, or numbers near enough."""
    if expected.rstrip() == actual.rstrip():
        return True
    if not units:
        return False
    apart = off_by(field, expected, actual)
    if apart is None:
        return expected.strip() == actual.strip()
    return apart <= _EXACT.multiply(units, TOLERANCES[field.quantity].digits)
