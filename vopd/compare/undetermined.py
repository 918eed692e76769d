"""Fields whose printed digits are not determined, from two listings between which they lie.

A number that lies next to the boundary between two printed decimals is rounded up by one
computer and down by another, because their sines differ in the last bits. Two listings of
the same deck, with all numbers as low and as high as that can make them, say which fields
these are and what they may hold.
"""

from __future__ import annotations

from collections.abc import Mapping

from vopd.compare.field_comparison import units_apart
from vopd.findings import VopdError
from vopd.listing.line_formats import Field

Undetermined = Mapping[tuple[int, str], tuple[str, str]]
"""By line, from 1, and name of the field: its lowest and its highest number as printed."""


def may_hold(field: Field, text: str, low: str, high: str) -> bool:
    """Whether a field may hold a number: it is the lowest, the highest, or one between them.

    Args:
        field: the field; angles that wrap lie on the shorter way around the circle
        text: what it holds
        low: the lowest number as printed
        high: the highest
    """
    if text.strip() in (low.strip(), high.strip()):
        return True
    whole = units_apart(field, low, high)
    parts = units_apart(field, low, text), units_apart(field, text, high)
    if whole is None or parts[0] is None or parts[1] is None:
        return False
    return parts[0] + parts[1] == whole


def refuse_layout(reason: str) -> VopdError:
    """The error for two listings that are not of the same frames."""
    return VopdError(f"LOW and HIGH are not listings of the same frames: {reason}")
