"""Differences of printed numbers that no circle and no field width could hold."""

from __future__ import annotations

from decimal import Decimal

from vopd.listing.compare import TOLERANCES, units_apart
from vopd.listing.formats import Field


def test_an_angle_of_ninety_digits_is_not_brought_back_to_a_circle() -> None:
    angle = next(name for name, one in TOLERANCES.items() if one.period is not None)
    field = Field("yaw", angle, "F", 1, 100, 3)
    assert units_apart(field, "1.E90", "0.") == Decimal(10) ** 93
