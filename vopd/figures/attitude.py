"""Angles against time, with bands of 95 %: attitude and angles of attack."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.history import History
from vopd.attitude.uncertainty import ANGLES
from vopd.figures.style import COLOURS, FLAGGED, caption, label

# Break the lines of a figure where frames are missing and where angles wrap.

GAP = 3.0  # a step this many times the median step between frames is a gap


def in_time(history: History) -> Ints:
    """Sort the frames of a job that have a time, by time; gives their indices."""
    time_s, _ = history.order_axis
    known = np.flatnonzero(np.isfinite(time_s))
    return np.asarray(known[np.argsort(time_s[known], kind="stable")])


def unwrapped_about(angles: Floats) -> float:
    """Find where to cut the circle, degrees: opposite to the mean of the angles.

    Angles in the 360 degrees from there on do not wrap unless they go all around.

    Args:
        angles: degrees; NaN is left out
    """
    known = np.radians(angles[np.isfinite(angles)])
    mean = np.degrees(np.arctan2(np.sin(known).sum(), np.cos(known).sum()))
    return float(round(mean) - 180.0)


def from_cut(angles: Floats, cut: float) -> Floats:
    """Move angles to between `cut` and `cut` + 360 degrees."""
    return np.asarray((angles - cut) % 360.0 + cut)


def broken(time_s: Floats, angles: Floats) -> tuple[Floats, Ints]:
    """Insert a NaN into a line of angles wherever it must be interrupted.

    Args:
        time_s: in order, (T,)
        angles: degrees, (T,)

    Returns:
        The times, NaN at a break; and the index of each in the arrays given, -1 at a break.
    """
    step = np.diff(time_s)
    usual = np.median(step[step > 0.0]) if (step > 0.0).any() else np.inf
    after = np.flatnonzero((step > GAP * usual) | (np.abs(np.diff(angles)) > 180.0)) + 1
    index = np.insert(np.arange(len(time_s)), after, -1)
    return np.where(index < 0, np.nan, time_s[index]), index


def picked(values: Floats, index: Ints) -> Floats:
    """Take the values along a line with breaks; NaN at a break."""
    return np.where(index < 0, np.nan, values[index])


# Mark the frames of a figure against time: flagged, misfits, and those with errata above sigma.


class FrameMark(NamedTuple):
    """How frames are marked: with a symbol at the angle, or at the bottom of the panel."""

    flag: str  # of `vopd.attitude.flags.MEANING`; empty for any other flag
    text: str  # in the legend
    look: dict[str, Any]
    at_bottom: bool = False


MARKS = (
    FrameMark("", "flagged", {"marker": "o", "mfc": "none", "mec": FLAGGED, "mew": 0.6, "ms": 5}),
    FrameMark("misfit", "misfit", {"marker": "X", "mfc": FLAGGED, "mec": "white", "ms": 8}),
    FrameMark(
        "model_error",
        "model error",
        {"marker": "|", "mec": COLOURS[5], "mew": 1.2, "ms": 9},
        at_bottom=True,
    ),
)


def marked(history: History, mark: FrameMark) -> Bools:
    """Find the frames with a mark (F,); of other flags those without a mark of their own."""
    raised = history.flags.raised
    if mark.flag:
        return raised[mark.flag]
    own = [one.flag for one in MARKS if one.flag]
    found = np.zeros(len(history.estimate.frame), bool)
    for name, frames in raised.items():
        if name not in own:
            found = found | frames
    return found


def draw_marks(axis: Any, history: History, order: Ints, angle: Floats, known: Bools) -> None:
    """Draw the marks of one job into a panel.

    Args:
        axis: the panel
        history: the job
        order: indices of the frames in order of time
        angle: the angle of each of these, as it is drawn
        known: which of them have one
    """
    time_s = history.order_axis[0][order]
    for mark in MARKS:
        here = known & marked(history, mark)[order]
        if not here.any():
            continue
        if mark.at_bottom:
            axis.plot(
                time_s[here], [0.03] * int(here.sum()), ls="", zorder=1.5,
                transform=axis.get_xaxis_transform(), **mark.look,
            )  # fmt: skip
        else:
            axis.plot(time_s[here], angle[here], ls="", **mark.look)


def draw_legend(figure: Any, histories: Sequence[History]) -> None:
    """Put the legend of jobs, band and marks below the panels, where no data are."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    colour = COLOURS[0] if len(histories) == 1 else "0.5"
    handles: list[Any] = []
    texts: list[str] = []
    if len(histories) > 1:
        for number, history in enumerate(histories[: len(COLOURS)]):
            handles.append(Line2D([], [], color=COLOURS[number]))
            texts.append(label(history, histories))
    handles.append(Patch(color=colour, alpha=0.3, lw=0))
    texts.append("95 % interval")
    for mark in MARKS:
        if any((marked(h, mark) & h.has_attitude).any() for h in histories):
            handles.append(Line2D([], [], ls="", **mark.look))
            texts.append(mark.text)
    figure.legend(handles, texts, loc="outside lower center", ncols=4)


# Draw angles against time with bands of 95 %, and below them half the width of the bands.

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


NO_ATTACK = (
    "no frame has angles of attack: they need the vehicle's velocity, from a track with times"
)


def has_attack(histories: Sequence[History]) -> bool:
    """Tell whether some frame has angles of attack.

    Args:
        histories: of the jobs
    """
    return any(np.isfinite(h.estimate.attack_deg).any() for h in histories)


def attack(figure: Any, histories: Sequence[History], _: int | str | None) -> str:
    """Draw the angles of attack alpha, beta and eta, or say why there are none."""
    if not has_attack(histories):
        figure.text(0.5, 0.5, NO_ATTACK, ha="center", va="center", wrap=True)
        return caption(histories)
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
    """Take the values of one of `ANGLES`, degrees (F,); NaN if a frame has none."""
    e = history.estimate
    index = ANGLES.index(name)
    angles = (e.camera_deg, e.vehicle_deg, e.attack_deg)[index // 3]
    return np.asarray(angles[:, index % 3])


def interval_of(history: History, name: str) -> Floats:
    """Find the 95 % interval of one of `ANGLES`: ends relative to it, degrees (2, F).

    NaN where there is none or it is infinite.
    """
    doubt, index = history.uncertainty, ANGLES.index(name)
    half = doubt.half_width_95[:, index]
    ends = np.stack([-half, half])
    if name == "eta":
        ends = doubt.eta_interval_95_deg.T - values_of(history, name)
    return np.where(np.isfinite(ends) & np.isfinite(half), ends, np.nan)


def in_range(angle: float, lowest: float) -> float:
    """Move an angle to between `lowest` and `lowest` + 360 degrees."""
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
    """Find the points of a broken line that have a neighbour without a break between."""
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
