"""Residuals by landmark: in a landmark's column time goes from left to right."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.attitude.history import History
from vopd.figures.style import COLOURS, FLAGGED, caption

COLUMN = 0.8  # of the distance between two columns is used
DRAWN = 5000  # so many points are drawn one by one in .svg and .pdf
NAMED = 40  # so many columns have their number below


def residuals(figure: Any, histories: Sequence[History], _: int | None) -> str:
    """Residuals x and y in micrometres on the film, a column a landmark."""
    number, when, pair, outlier = points(histories)
    numbers = np.array(sorted(set(number.tolist())), dtype=np.int64)
    column = np.searchsorted(numbers, number)
    span = np.ptp(when) if len(when) else 0.0
    along = (when - when.min()) / span - 0.5 if span > 0.0 else np.zeros(len(when))
    place = column + COLUMN * along
    axes = figure.subplots(2, 1, sharex=True)
    size = 14.0 if len(place) < 300 else 4.0
    for axis, values, name in zip(axes, pair.T * 1000.0, "xy", strict=True):
        rms = [np.sqrt(np.mean(values[column == k] ** 2)) for k in range(len(numbers))]
        axis.bar(
            np.arange(len(numbers)), 2.0 * np.array(rms), 0.96, -np.array(rms), color="0.88",
            label="root mean square, both ways", zorder=0,
        )  # fmt: skip
        axis.scatter(
            place, values, size, color=COLOURS[0], lw=0, alpha=0.8, label="one frame",
            rasterized=len(place) > DRAWN,
        )  # fmt: skip
        axis.plot(
            place[outlier], values[outlier], "o", mfc="none", mec=FLAGGED, ls="", label="outlier"
        )
        axis.axhline(0.0, color="0.3", lw=0.6)
        axis.set_ylabel(f"residual {name}, µm on the film")
        axis.grid(visible=False, axis="x")
    _numbers(axes[-1], numbers)
    handles, texts = axes[0].get_legend_handles_labels()
    figure.legend(handles, texts, loc="outside lower center", ncols=3)
    seconds = (
        f"; columns from left to right: {when.min():.3f} to {when.max():.3f} s" if span else ""
    )
    return caption(histories) + f"\nmeasured minus computed{seconds}"


def points(histories: Sequence[History]) -> tuple[Ints, Floats, Floats, Any]:
    """Of every residual of every frame: landmark, time, x and y in mm, whether an outlier."""
    parts: list[tuple[Any, ...]] = []
    for h in histories:
        e, residual = h.estimate, h.estimate.residual_xy
        here = e.used & np.isfinite(residual).all(axis=2) & np.isfinite(e.time_s)[:, None]
        time_s = np.broadcast_to(e.time_s[:, None], here.shape)
        parts.append((e.landmark[here], time_s[here], residual[here], h.flags.misfit[here]))
    number, when, pair, outlier = (np.concatenate(part) for part in zip(*parts, strict=True))
    return number, when, pair, outlier


def _numbers(axis: Any, numbers: Ints) -> None:
    every = -(-len(numbers) // NAMED)
    axis.set_xticks(np.arange(len(numbers))[::every], numbers[::every].tolist())
    axis.set_xlim(-0.6, len(numbers) - 0.4)
    axis.set_xlabel("landmark number")
