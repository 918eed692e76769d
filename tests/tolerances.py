"""Every tolerance of the tests: quantity, unit, absolute tolerance, reason."""

from __future__ import annotations

from typing import NamedTuple


class Tolerance(NamedTuple):
    """How far a number may be from the expected one."""

    unit: str
    absolute: float
    reason: str


TOLERANCES = {
    "rae printed angle": Tolerance("deg", 1e-8, "the golden values have ten decimals"),
    "rae printed cosine": Tolerance("1", 0.6e-8, "half a unit of the eighth decimal"),
    "rae RADEC2 angle": Tolerance("deg", 0.6e-8, "half a unit of the eighth decimal"),
    "rae table 6.4": Tolerance("deg", 0.51e-4, "half a unit of the fourth decimal"),
    "rae table 6.4 early": Tolerance("deg", 1.01e-4, "one unit: three corrections, unknown start"),
    "listing angle": Tolerance("deg", 1e-9, "double precision through one inverse"),
    "extrapolated table value": Tolerance("", 1e-9, "values up to 1E5 by a few operations"),
    "matrix element": Tolerance("1", 1e-12, "double precision through a few products"),
    "pole matrix element": Tolerance("1", 3e-8, "phi near 90 loses half the digits of its sine"),
    "exact attitude": Tolerance("1", 1e-10, "elements of M from stars .05 rad and more apart"),
    "least squares angle": Tolerance("deg", 2e-6, "a general minimiser stops this far away"),
    "partial derivative": Tolerance("mm/rad", 1e-5, "central differences, step 1e-6 rad"),
    "stack element": Tolerance("1", 1e-12, "sums over a longer axis may round otherwise"),
}
"""By name; the unit is that of the number compared."""


def within(name: str) -> float:
    """The absolute tolerance of that name."""
    return TOLERANCES[name].absolute
