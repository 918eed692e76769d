"""A film of five frames with angles by hand, and the panels that are drawn of it."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from tests.kit.histories_by_hand import by_hand
from vopd.attitude.history import History
from vopd.figures import attack

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


def panels(histories: list[History], which: Any = attack) -> list[Any]:
    figure = Figure()
    which(figure, histories, None)
    return figure.axes
