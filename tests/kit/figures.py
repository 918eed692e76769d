"""Marks and texts of drawn figures, and a film of five frames with angles by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from tests.kit.histories import by_hand
from vopd.attitude.history import History
from vopd.figures.attitude import draw_attack

OKABE_ITO = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00")
GREY = "#b2b2b2"
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


# A film of five frames


TIMES = [3.0, 0.0, 1.0, 2.0, 12.0]  # in order 1, 2, 3, 0, 4; 9 s are a gap, and the last is alone
FIRST = [-4.0, -64.0, -8.0, 100.0, 20.0, 60.0, -5.0, 10.0, 30.0]
DRAWN = np.add.outer(4.0 * np.arange(5), FIRST)  # in order of time
ANGLES = DRAWN[[3, 0, 1, 2, 4]] % np.array([360.0, np.inf, 360.0, *[np.inf] * 6])
ANGLES[:, [1, 6]] = DRAWN[[3, 0, 1, 2, 4]][:, [1, 6]]
HALF = np.add.outer(np.arange(5) / 64.0, np.arange(1, 10) / 8.0)
ETA = ANGLES[:, 8:] + [-0.5, 0.75]


def film(frames: int = 5, **changes: Any) -> History:
    given: dict[str, Any] = {"angles_deg": ANGLES, "half_deg": HALF, "eta_deg": ETA}
    return by_hand(frames, **(given | {"time_s": np.array(TIMES)} | changes))


def alike(frames: int, *starts_deg: float, **changes: Any) -> list[History]:
    """Jobs whose angles all start there, and turn by a tenth a frame."""
    rows = np.tile(np.arange(frames)[:, None] / 10.0, 9)
    return [
        by_hand(frames, angles_deg=rows + start, half_deg=np.ones((frames, 9)), **changes)
        for start in starts_deg
    ]


def panels(histories: list[History], which: Any = draw_attack) -> list[Any]:
    figure = Figure()
    which(figure, histories, None)
    return figure.axes
