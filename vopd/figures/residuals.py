"""Residuals by landmark."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.attitude.history import History
from vopd.attitude.long_history import frame_landmarks
from vopd.figures.style import COLOURS, FLAGGED, caption, plain, short

# Draw residuals by landmark; in the column of a landmark, time runs from left to right.

COLUMN = 0.8  # the width of a column, in terms of the distance between two
DRAWN = 5000  # up to this many points are drawn one by one in .svg and .pdf
NAMED = 40  # up to this many columns have their label below
LONG = 4  # characters of a label; longer ones are turned


def residuals(figure: Any, histories: Sequence[History], _: int | str | None) -> str:
    """Draw residuals x and y, a column for each landmark."""
    units, words = histories[0].estimate.units, histories[0].about.words
    number, when, pair, outlier = points(histories)
    numbers = np.array(sorted(set(number.tolist())), dtype=np.int64)
    column = np.searchsorted(numbers, number)
    span = np.ptp(when) if len(when) else 0.0
    along = (when - when.min()) / span - 0.5 if span > 0.0 else np.zeros(len(when))
    across = column + COLUMN * along
    axes = figure.subplots(2, 1, sharex=True)
    size = 14.0 if len(across) < 300 else 4.0
    for axis, values, name in zip(axes, pair.T * units.residuals_per_image, "xy", strict=True):
        rms = [np.sqrt(np.mean(values[column == k] ** 2)) for k in range(len(numbers))]
        axis.bar(
            np.arange(len(numbers)), 2.0 * np.array(rms), 0.96, -np.array(rms), color="0.88",
            label="root mean square, both ways", zorder=0,
        )  # fmt: skip
        axis.scatter(
            across, values, size, color=COLOURS[0], lw=0, alpha=0.8, label="one frame",
            rasterized=len(across) > DRAWN,
        )  # fmt: skip
        axis.plot(
            across[outlier], values[outlier], "o", mfc="none", mec=FLAGGED, ls="", label="outlier"
        )
        axis.axhline(0.0, color="0.3", lw=0.6)
        axis.set_ylabel(f"residual {name}, {units.residual}\n{words.surface}")
        axis.grid(visible=False, axis="x")
    _labels(axes[-1], [_label(histories, n) for n in numbers.tolist()])
    handles, texts = axes[0].get_legend_handles_labels()
    figure.legend(handles, texts, loc="outside lower center", ncols=3)
    order = ""
    if span and histories[0].order_axis[1] == "frame":
        order = f"; columns from left to right: frames {when.min():g} to {when.max():g}"
    elif span:
        order = f"; columns from left to right: {when.min():.3f} to {when.max():.3f} s"
    return caption(histories) + f"\nmeasured minus computed{order}"


def points(histories: Sequence[History]) -> tuple[Ints, Floats, Floats, Any]:
    """List every residual as a point: landmark, time, x, y, and whether an outlier."""
    parts: list[tuple[Any, ...]] = []
    for h in histories:
        rows = frame_landmarks(h)
        along = h.order_axis[0][rows.frame]
        here = rows.used & np.isfinite(rows.residual).all(axis=1) & np.isfinite(along)
        parts.append((rows.landmark[here], along[here], rows.residual[here], rows.outlier[here]))
    number, when, pair, outlier = (np.concatenate(part) for part in zip(*parts, strict=True))
    return number, when, pair, outlier


def _label(histories: Sequence[History], number: int) -> str:
    """Name a landmark as the first job does that has a name for it."""
    names = (h.estimate.landmark_names.get(number) for h in histories)
    label = next((name for name in names if name), str(number))
    return plain(short(label))


def _labels(axis: Any, labels: list[str]) -> None:
    every = max(1, -(-len(labels) // NAMED))
    turned = 90.0 if max(map(len, labels), default=0) > LONG else 0.0
    axis.set_xticks(np.arange(len(labels))[::every], labels[::every], rotation=turned)
    axis.set_xlim(-0.6, len(labels) - 0.4)
    axis.set_xlabel("landmark")
