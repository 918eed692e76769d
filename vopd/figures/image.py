"""One frame's image: where its landmarks were measured and where they ought to be."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, log10
from typing import Any

import numpy as np

from vopd.arrays import Floats
from vopd.attitude.history import History
from vopd.figures.style import COLOURS, FLAGGED, caption
from vopd.findings import VopdError

LONGEST = 0.12  # of the picture's width is the longest arrow, about
ROOM = 1.35  # so far from the centre, in terms of the farthest point


def image(figure: Any, histories: Sequence[History], frame: int | None) -> str:
    """The film as seen from behind the camera, millimetres from the frame's centre."""
    history, k = chosen(histories, frame)
    used = history.estimate.used[k]
    measured = film_mm(history, k)
    residual = history.estimate.residual_xy[k][used]
    axis = figure.subplots()
    far = max(float(np.abs(measured).max()), 1e-3) * ROOM
    scale = _scale(residual, 2.0 * far)
    computed = measured - residual
    length = float(np.hypot(*residual.T).max()) if len(residual) else 0.0
    arrows = axis.quiver(
        *computed.T, *residual.T, angles="xy", scale_units="xy", scale=1.0 / scale,
        color=COLOURS[1], width=0.004, zorder=2,
    )  # fmt: skip
    axis.plot(*computed.T, "+", color="0.2", ms=9, label="computed")
    axis.plot(*measured.T, "o", mfc="none", mec=COLOURS[0], ms=7, label="measured")
    odd = history.flags.misfit[k][used]
    if odd.any():
        axis.plot(*measured[odd].T, "s", mfc="none", mec=FLAGGED, ms=12, label="outlier")
    axis.plot(0.0, 0.0, "x", color="0.5", ms=8, label="frame's centre")
    for number, place in zip(history.estimate.landmark[k][used], measured, strict=True):
        axis.annotate(str(number), place, (7, 7), textcoords="offset points")
    axis.set(xlim=(far, -far), ylim=(-far, far), aspect="equal")  # x grows to the left
    axis.set_xlabel("x, mm on the film, to the left")
    axis.set_ylabel("y, mm on the film, up")
    if length > 0.0:
        key = _round(length * 1000.0)
        axis.quiverkey(
            arrows, 1.05, 0.06, key / 1000.0, f"{key:g} µm", labelpos="S", coordinates="axes"
        )
    axis.legend(loc="upper left", bbox_to_anchor=(1.02, 1.0))
    e = history.estimate
    return (
        f"{caption([history])}\nframe {e.frame[k]}, {e.time_s[k]:.3f} s, {used.sum()} landmarks; "
        f"freed of distortion\n"
        f"arrows: residuals, measured minus computed, {scale:g} times as long"
    )


def chosen(histories: Sequence[History], frame: int | None) -> tuple[History, int]:
    """The history and the place in it of a frame by its number.

    None takes the one with the most landmarks, the first of several. Raises
    `VopdError` where no job has that frame, or it has no attitude.
    """
    have = [(h, int(k)) for h in histories for k in np.flatnonzero(h.has_attitude)]
    if frame is None:
        return max(have, key=lambda one: int(one[0].estimate.used[one[1]].sum()))
    for history, k in have:
        if history.estimate.frame[k] == frame:
            return history, k
    if any(frame in h.estimate.frame for h in histories):
        raise VopdError(f"frame {frame} has no attitude: it is ignored, or the run stopped there")
    numbers = [int(h.estimate.frame[k]) for h, k in have]
    raise VopdError(f"no frame {frame}: there are {min(numbers)} to {max(numbers)}")


def film_mm(history: History, k: int) -> Floats:
    """Where a frame's landmarks were measured, mm from its centre, freed of distortion (n, 2)."""
    return np.asarray(history.estimate.image[k][history.estimate.used[k]])


def _scale(residual: Floats, width: float) -> float:
    """How many times too long arrows are drawn, a round number."""
    longest = float(np.hypot(*residual.T).max()) if len(residual) else 0.0
    return _round(LONGEST * width / longest) if longest > 0.0 else 1.0


def _round(number: float) -> float:
    """The nearest number below of 1, 2, 5, 10, 20 ..."""
    if not number > 0.0:
        return 1.0
    power = 10.0 ** floor(log10(number))
    return next(step for step in (5.0, 2.0, 1.0) if step * power <= number * (1 + 1e-9)) * power
