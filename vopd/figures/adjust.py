"""What `vopd adjust` has changed: parameters in their standard deviations, and the residuals."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from vopd.arrays import Floats
from vopd.figures.image import NAME_SHOWN
from vopd.figures.style import COLOURS, Inches, matplotlib_figure, name_text, plain, wrapped
from vopd.scene import Change

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_ROWS = 30  # parameters, and landmarks, of a figure
ROW_IN, REST_IN, WIDTH_IN = 0.24, 2.6, 9.0
NO_SIZE = 1e-9


def draw_adjusted(
    title: str,
    changes: Sequence[Change],
    landmarks: Sequence[str],
    rms_px: Floats,
    size_in: Inches | None = None,
) -> Figure:
    """Draw parameters before and after in standard deviations, and residuals before and after.

    Args:
        title: of the figure
        changes: of the parameters
        landmarks: names of landmarks, M of them
        rms_px: root mean square of a residual's coordinates before and after, of each landmark and
            of all, pixels, (M + 1, 2); NaN: it has none
        size_in: width and height, inches; None takes the usual size

    Raises:
        VopdError: where matplotlib is not installed
    """
    told = []
    shown = list(changes)
    if len(shown) > MOST_ROWS:
        moved = np.array([abs(one.moved) for one in shown])
        most = np.sort(np.argsort(-np.nan_to_num(moved), kind="stable")[:MOST_ROWS])
        shown = [shown[k] for k in most.tolist()]
        told.append(f"the {MOST_ROWS} of {len(changes)} parameters that moved most")
    with np.errstate(invalid="ignore"):
        known = np.flatnonzero(np.isfinite(rms_px[:-1]).any(axis=1))
    order = known[np.argsort(-np.nanmax(rms_px[known], axis=1), kind="stable")]
    if len(order) > MOST_ROWS:
        told.append(f"the {MOST_ROWS} of {len(order)} landmarks with the largest residuals")
    order = order[:MOST_ROWS]
    rows = [len(shown) + 1, len(order) + 2]
    usual = (WIDTH_IN, REST_IN + ROW_IN * sum(rows))
    with matplotlib_figure(size_in or usual) as figure:
        above, below = figure.subplots(2, 1, height_ratios=[max(one, 3) for one in rows])
        _parameters(above, shown)
        _residuals(below, [*(landmarks[k] for k in order), "all"], rms_px[[*order.tolist(), -1]])
        text = "\n".join([plain(title), *filter(None, ["; ".join(told)])])
        figure.suptitle(wrapped(f"Adjusted\n{text}", figure.get_size_inches()[0]),
                        fontsize="medium")  # fmt: skip
        drawn: Figure = figure
    return drawn


def _parameters(axis: Any, shown: Sequence[Change]) -> None:
    """Draw a row for each parameter: as stated at 0, and as solved."""
    axis.axvline(0.0, color="0.3", lw=0.8, zorder=1)
    for row, one in sorted(enumerate(shown), key=lambda pair: not pair[1].stated):
        if one.stated:
            axis.barh(
                row, 2.0, 0.7, -1.0, color="0.85", zorder=0, label="before, ± one sigma as stated"
            )
        if not np.isfinite(one.moved):
            axis.plot(0.0, row, "o", mfc="white", mec="0.3", label="not held: kept as stated")
            continue
        look: dict[str, Any] = {"fmt": "o", "color": COLOURS[0], "label": "after, ± one sigma"}
        if not one.stated:
            look |= {"fmt": "D", "color": COLOURS[1]}
            look["label"] = "after, in its own sigma: none was stated before"
        axis.errorbar(one.moved, row, xerr=one.sigma, ms=5, capsize=3, **look)
    axis.set_ylim(len(shown) - 0.4, -0.6)
    axis.set_yticks(range(len(shown)), [_parameter_text(one.name) for one in shown])
    axis.grid(visible=False, axis="y")
    axis.set_xlabel("change, in standard deviations")
    least, most = axis.get_xlim()
    axis.set_xlim(min(least, -1.2), max(most, 1.2))
    values = axis.twinx()
    values.set_ylim(axis.get_ylim())
    values.set_yticks(range(len(shown)), [plain(one.told) for one in shown], fontsize="small")
    values.set_ylabel("before → after,\n± one sigma", fontsize="small")
    for one in (axis, values):
        one.tick_params(axis="y", length=0)
    handles, texts = axis.get_legend_handles_labels()
    each = dict(zip(texts, handles, strict=True))
    axis.legend(
        each.values(), each.keys(), loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2,
        fontsize="small",
    )  # fmt: skip


def _parameter_text(name: str) -> str:
    """Shorten the name of a parameter; of a landmark's coordinate the axis stays."""
    mark, _, axis = name.rpartition(" ")
    return f"{name_text(mark, NAME_SHOWN)} {axis}" if mark else name_text(name, NAME_SHOWN)


def _residuals(axis: Any, names: Sequence[str], rms_px: Floats) -> None:
    """Draw the size of each landmark's residuals before and after."""
    place = np.arange(len(names))
    before, after = rms_px.T
    axis.hlines(place, before, after, color="0.6", lw=1.5)
    axis.plot(before, place, "o", mfc="white", mec="0.3", ms=7, label="before")
    axis.plot(after, place, "o", color=COLOURS[0], ms=5, label="after")
    axis.axhline(len(names) - 1.5, color="0.6", lw=0.8)
    axis.set_ylim(len(names) - 0.4, -0.6)
    axis.set_yticks(place, [name_text(name, NAME_SHOWN) for name in names])
    axis.tick_params(axis="y", length=0)
    axis.grid(visible=False, axis="y")
    axis.set_xlim(0.0, 1.08 * max(float(np.nanmax(rms_px, initial=0.0)), NO_SIZE))
    axis.set_xlabel("root mean square of the residuals, px")
    axis.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, fontsize="small")
