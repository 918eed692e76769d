"""The image of one frame: landmarks measured and computed."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, log10
from typing import Any

import numpy as np

from vopd.arrays import Floats
from vopd.attitude.history import History
from vopd.attitude.long_history import frame_landmarks
from vopd.estimate import Units
from vopd.figures.style import COLOURS, FLAGGED, caption, plain, short
from vopd.findings import VopdError, count_text

# Draw the image of one frame: where its landmarks were measured and where they were computed.

LONGEST = 0.12  # about the length of the longest arrow, in terms of the width of the figure
LABELLED = 200  # up to this many landmarks have their label
ROOM = 1.35  # how far the axes go, in terms of the farthest point


def image(figure: Any, histories: Sequence[History], frame: int | str | None) -> str:
    """Draw the image as seen from behind the camera, in image units from its centre."""
    history, k = chosen(histories, frame)
    e, words = history.estimate, history.about.words
    rows = frame_landmarks(history)
    shown = (rows.frame == k) & rows.used
    shown &= np.isfinite(rows.image).all(axis=1) & np.isfinite(rows.residual).all(axis=1)
    measured, residual = rows.image[shown], rows.residual[shown]
    axis = figure.subplots()
    far = max(float(np.abs(measured).max(initial=0.0)), 1e-3) * ROOM
    scale = arrow_scale(residual, 2.0 * far)
    residual_arrows(axis, measured - residual, residual, scale, e.units)
    axis.plot(*(measured - residual).T, "+", color="0.2", ms=9, label="computed")
    axis.plot(*measured.T, "o", mfc="none", mec=COLOURS[0], ms=7, label="measured")
    odd = rows.outlier[shown]
    if odd.any():
        axis.plot(*measured[odd].T, "s", mfc="none", mec=FLAGGED, ms=12, label="outlier")
    axis.plot(0.0, 0.0, "x", color="0.5", ms=8, label=words.centre)
    few = len(measured) <= LABELLED
    for number, point in zip(rows.landmark[shown] if few else (), measured, strict=few):
        label = plain(short(e.landmark_label(number), 40))
        axis.annotate(label, point, (7, 7), textcoords="offset points")
    axis.set(xlim=(far, -far), ylim=(-far, far), aspect="equal")  # x grows to the left
    axis.set_xlabel(f"x, {e.units.image} {words.surface}, to the left")
    axis.set_ylabel(f"y, {e.units.image} {words.surface}, up")
    axis.legend(loc="upper left", bbox_to_anchor=(1.02, 1.0))
    when = f"{e.time_s[k]:.3f} s, " if np.isfinite(e.time_s[k]) else ""
    return (
        f"{caption([history])}\nframe {plain(e.frame_label(k))}, {when}"
        f"{count_text(history.landmarks[k], 'landmark')}; corrected for distortion"
        f"{'' if few else '; too many landmarks to label'}\n"
        f"arrows: residuals, measured minus computed, {scale:g} times as long"
        f"{_misfit(history, k)}"
    )


def _misfit(history: History, k: int) -> str:
    """Explain the misfit of a frame in one line."""
    flags = history.flags
    return f"\nmisfit: {plain(flags.detail['misfit'][k])}" if flags.raised["misfit"][k] else ""


def residual_arrows(axis: Any, start: Floats, residual: Floats, scale: float, units: Units) -> None:
    """Draw the residuals as arrows, and one of a round length as the key."""
    arrows = axis.quiver(
        *start.T, *residual.T, angles="xy", scale_units="xy", scale=1.0 / scale,
        color=COLOURS[1], width=0.004, zorder=2,
    )  # fmt: skip
    longest = float(np.hypot(*residual.T).max(initial=0.0)) * units.residuals_per_image
    if longest > 0.0:
        key = _round(longest)
        length, label = key / units.residuals_per_image, f"{key:g} {units.residual}"
        axis.quiverkey(arrows, 1.05, 0.06, length, label, labelpos="S", coordinates="axes")


def chosen(histories: Sequence[History], frame: int | str | None) -> tuple[History, int]:
    """Find the history that has a frame, and the index of the frame in it.

    Args:
        histories: the jobs
        frame: its number or name, in the first job that has it; None takes the
            frame with the most landmarks, the first of several

    Raises:
        VopdError: where no job has that frame, or it has no attitude
    """
    have = [(h, int(k)) for h in histories for k in np.flatnonzero(h.has_attitude)]
    if frame is None:
        counts = np.concatenate([h.landmarks[h.has_attitude] for h in histories])
        return have[int(counts.argmax())]
    asked = str(frame).strip()
    for history, k in have:
        if history.estimate.frame_label(k) == asked:
            return history, k
    if any(asked == h.estimate.frame_label(k) for h in histories for k in range(len(h.status))):
        raise VopdError(f"frame {asked} has no attitude: it is ignored, or the run stopped there")
    labels = [h.estimate.frame_label(k) for h, k in have]
    raise VopdError(f"no frame {asked}: there are {labels[0]} to {labels[-1]}")


def arrow_scale(residual: Floats, width: float) -> float:
    """Choose the scale of arrows, a round number."""
    longest = float(np.hypot(*residual.T).max(initial=0.0))
    return _round(LONGEST * width / longest) if longest > 0.0 else 1.0


def _round(number: float) -> float:
    """Round down to one of 1, 2, 5, 10, 20 ...; 1 for a number not above 0."""
    if not number > 0.0:
        return 1.0
    power = 10.0 ** floor(log10(number))
    return next(step for step in (5.0, 2.0, 1.0) if step * power <= number * (1 + 1e-9)) * power
