"""Compare two printed fields: whether they agree, and by how many units of the last digit not.

All arithmetic is decimal and exact: what is compared is what is printed.
"""

from __future__ import annotations

import re
from decimal import Context, Decimal, InvalidOperation

from vopd.compare.tolerances import TOLERANCES
from vopd.findings import VopdError
from vopd.listing.line_formats import Field

_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[ED][+-]?[0-9]{1,3})?")
_EXACT = Context(prec=60)
WRAPPED = 20  # digits: no angle that large is brought back to a circle


def exact_units(units: float | Decimal | str) -> Decimal:
    """Read the tolerance in units of the last digit, as an exact decimal.

    Args:
        units: 0 or more, fractions included

    Returns:
        The same number, exactly.

    Raises:
        VopdError: if `units` is negative, not finite, or no number.
    """
    try:
        exact = Decimal(str(units))
    except InvalidOperation:
        raise VopdError(f"units: not a number: {str(units)!r}") from None
    if not exact.is_finite() or exact < 0:
        raise VopdError(f"units: not a number of 0 or more: {str(units)!r}")
    return exact


def printed_number(text: str) -> Decimal | None:
    """The exact value of a printed number; None for blanks, asterisks, NaN and other text."""
    text = text.strip()
    return Decimal(text.replace("D", "E")) if _NUMBER.fullmatch(text) else None


def units_apart(field: Field, expected: str, actual: str) -> Decimal | None:
    """The difference of two numbers in units of the last printed digit; None for other text.

    The last digit is the FORMAT's for I and F fields, the one printed for E and G fields (the
    coarser of two). Angles that wrap are compared around the circle.
    """
    one, other = printed_number(expected), printed_number(actual)
    if one is None or other is None:
        return None
    apart = _EXACT.abs(_EXACT.subtract(one, other))
    period = TOLERANCES[field.quantity].period
    if period is not None and apart.adjusted() < WRAPPED:
        apart = _EXACT.remainder(apart, period)
        apart = min(apart, _EXACT.subtract(period, apart))
    digits = (-int(value.as_tuple().exponent) for value in (one, other))
    decimals = field.decimals if field.descriptor in "IF" else min(digits)
    return _EXACT.scaleb(apart, decimals)


def fields_agree(field: Field, expected: str, actual: str, units: Decimal) -> bool:
    """Whether two fields have the same text, or numbers within the tolerance."""
    if expected.rstrip() == actual.rstrip():
        return True
    if not units:
        return False
    apart = units_apart(field, expected, actual)
    if apart is None:
        return expected.strip() == actual.strip()
    return apart <= _EXACT.multiply(units, TOLERANCES[field.quantity].digits)
