"""What is drawn in a figure, read from its artists."""

from __future__ import annotations

from typing import Any

import numpy as np

OKABE_ITO = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00")
DARK_RED = "#b30000"


def points(line: Any) -> list[list[float]]:
    """The points of a line, (n, 2); None for NaN."""
    both = np.column_stack([np.asarray(values, float) for values in line.get_data()])
    return [[None if np.isnan(one) else one for one in pair] for pair in both.tolist()]


def labelled(axis: Any) -> dict[str, Any]:
    """The lines of an axis by their label."""
    return {line.get_label(): line for line in axis.lines}


def arrows_and_key(axis: Any) -> tuple[Any, Any]:
    """The arrows of an axis, and the key of their length, None without one."""
    (arrows,) = [one for one in axis.collections if hasattr(one, "U")]
    keys = [one for one in axis.get_children() if type(one).__name__ == "QuiverKey"]
    return arrows, keys[0] if keys else None


def texts(legend: Any) -> list[str]:
    """The texts of a legend."""
    return [text.get_text() for text in legend.get_texts()]


def ticks(axis: Any) -> tuple[list[float], list[str]]:
    """Where the fixed ticks of an x axis are, and their labels."""
    return list(axis.get_xticks()), [label.get_text() for label in axis.get_xticklabels()]
