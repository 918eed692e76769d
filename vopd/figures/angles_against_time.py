"""Draw angles against time with bands of 95 %, and below them half the width of the bands."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from vopd.arrays import Floats
from vopd.attitude.history import History
from vopd.attitude.uncertainty import ANGLES
from vopd.figures.frame_marks import draw_legend, draw_marks
from vopd.figures.line_breaks import broken, from_cut, in_time, picked, unwrapped_about
from vopd.figures.style import COLOURS, caption

POINTS = 60  # up to this many frames, each frame has a point
BELOW_IN = 0.42  # inches from the axis down to its legend, past the numbers and the label
DECADES = 6.0  # the most that the scale of the half-widths shows


def attitude(figure: Any, histories: Sequence[History], _: int | str | None) -> str:
    """Draw yaw, pitch, roll of the camera on the left, of the vehicle on the right."""
    axes = figure.subplots(4, 2, sharex=True, height_ratios=(1, 1, 1, 0.7))
    for column, body in enumerate(("camera", "vehicle")):
        names = [f"{body}_{angle}" for angle in ("yaw", "pitch", "roll")]
        _panels(axes[:, column], histories, names)
        axes[0, column].set_title(body)
    draw_legend(figure, histories)
    return caption(histories)


def attack(figure: Any, histories: Sequence[History], _: int | str | None) -> str:
    """Draw the angles of attack alpha, beta and eta."""
    axes = figure.subplots(4, 1, sharex=True, height_ratios=(1, 1, 1, 0.7))
    _panels(axes, histories, ["alpha", "beta", "eta"])
    draw_legend(figure, histories)
    return caption(histories)


def _panels(axes: Any, histories: Sequence[History], names: list[str]) -> None:
    for axis, name in zip(axes[:-1], names, strict=True):
        cut = unwrapped_about(np.concatenate([values_of(h, name) for h in histories]))
        for number, history in enumerate(histories):
            _angle(axis, history, name, COLOURS[number % len(COLOURS)], cut)
        axis.set_ylabel(f"{name.split('_')[-1]}, degrees")
        lowest = 0.0 if name.endswith(("yaw", "roll")) else -180.0
        axis.yaxis.set_major_formatter(lambda y, _, low=lowest: f"{in_range(y, low):.6g}")
    marks = ("-", "--", ":")
    for mark, name in zip(marks, names, strict=True):
        for number, history in enumerate(histories):
            _half_width(axes[-1], history, name, mark, COLOURS[number % len(COLOURS)])
    _width_scale(axes[-1], [name.split("_")[-1] for name in names], marks)
    axes[-1].set_xlabel(histories[0].order_axis[1])


def values_of(history: History, name: str) -> Floats:
    """The values of one of `ANGLES`, degrees (F,); NaN where a frame has none."""
    e = history.estimate
    index = ANGLES.index(name)
    angles = (e.camera_deg, e.vehicle_deg, e.attack_deg)[index // 3]
    return np.asarray(angles[:, index % 3])


def interval_of(history: History, name: str) -> Floats:
    """The 95 % interval of one of `ANGLES`, as ends relative to the angle, degrees (2, F).

    NaN where there is none or it is infinite.
    """
    doubt, index = history.uncertainty, ANGLES.index(name)
    half = doubt.half_width_95[:, index]
    ends = np.stack([-half, half])
    if name == "eta":
        ends = doubt.eta_interval_95_deg.T - values_of(history, name)
    return np.where(np.isfinite(ends) & np.isfinite(half), ends, np.nan)


def in_range(angle: float, lowest: float) -> float:
    """The same direction as an angle between `lowest` and `lowest` + 360 degrees."""
    return float(np.round(angle - lowest, 9) % 360.0 + lowest)


def _angle(axis: Any, history: History, name: str, colour: str, cut: float) -> None:
    order = in_time(history)
    angle = from_cut(values_of(history, name)[order], cut)
    time_s = history.order_axis[0][order]
    low, high = interval_of(history, name)[:, order]
    known = np.isfinite(angle)
    times, index = broken(time_s, angle)
    line = picked(angle, index)
    axis.fill_between(
        times, line + picked(low, index), line + picked(high, index), color=colour, alpha=0.3,
        lw=0, label="band",
    )  # fmt: skip
    marker = "." if known.sum() <= POINTS else ""
    axis.plot(times, line, color=colour, lw=1.0, marker=marker)
    alone = known & ~_has_neighbour(index, known)
    if alone.any():
        ends = np.nan_to_num([-low[alone], high[alone]])
        axis.errorbar(time_s[alone], angle[alone], ends, fmt=".", color=colour, capsize=3)
    draw_marks(axis, history, order, angle, known)


def _has_neighbour(index: Any, known: Any) -> Any:
    """Which points of a broken line have a neighbour without a break between."""
    if not len(known):
        return known
    present = np.append(-1, np.append(index, -1))
    whole = (present >= 0) & known[present]
    beside = np.zeros(len(known), bool)
    here = np.flatnonzero(whole)
    beside[present[here]] = whole[here - 1] | whole[here + 1]
    return beside


def _half_width(axis: Any, history: History, name: str, mark: str, colour: str) -> None:
    order = in_time(history)
    low, high = interval_of(history, name)[:, order]
    half = (high - low) / 2.0
    times, index = broken(history.order_axis[0][order], np.zeros(len(order)))
    marker = "." if np.isfinite(half).sum() <= POINTS else ""
    positive = np.where(half > 0.0, half, np.nan)
    axis.plot(times, picked(positive, index), ls=mark, color=colour, lw=1.0, marker=marker, ms=2.5)


def _width_scale(axis: Any, names: list[str], marks: tuple[str, ...]) -> None:
    """Set the logarithmic scale of the half-widths, and a legend of the lines."""
    from matplotlib.transforms import ScaledTranslation

    axis.set_ylabel("half of 95 %,\ndegrees")
    shown = np.concatenate([line.get_ydata() for line in axis.lines])
    shown = shown[np.isfinite(shown)]
    if len(shown):
        from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

        axis.set_yscale("log")
        axis.yaxis.set_major_locator(LogLocator(subs=(1.0, 3.0), numticks=7))
        axis.yaxis.set_major_formatter(FuncFormatter(lambda y, _: f"{y:g}"))
        axis.yaxis.set_minor_formatter(NullFormatter())
        low, high = shown.min(), shown.max()
        axis.set_ylim(max(low / 2.0, high * 10.0**-DECADES), high * 2.0)
    handles = [axis.plot([], [], color="0.3", ls=mark)[0] for mark in marks]
    below = axis.transAxes + ScaledTranslation(0.0, -BELOW_IN, axis.figure.dpi_scale_trans)
    axis.legend(
        handles, names, loc="upper left", bbox_to_anchor=(0.0, 0.0), bbox_transform=below, ncols=3
    )
