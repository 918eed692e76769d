"""Angles against time, with bands of 95 %: attitude and angles of attack."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.conventions import conventions
from vopd.attitude.history import History, is_turned
from vopd.attitude.included import one_turn_texts
from vopd.attitude.uncertainty import ANGLES
from vopd.figures.style import (
    COLOURS,
    FLAGGED,
    LABEL_SHOWN,
    caption,
    label,
    legend_below,
    plain,
    short,
)
from vopd.findings import angle_in_range, angle_text, count_text

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


# Flags: a row a flag below the panels, a mark a frame

TOLD_BY = {"second_solution": "two_landmarks"}
"""Flags that another one of the same frame brings with it, and so are not drawn beside it."""


def flagged_frames(history: History) -> dict[str, Bools]:
    """Mark the frames of each flag (F,), by its name; a fact has one flag.

    Args:
        history: of a job
    """
    found = {}
    for name, frames in history.flags.raised.items():
        own = frames & history.has_attitude
        if name in TOLD_BY:
            own = own & ~history.flags.raised[TOLD_BY[name]]
        if own.any():
            found[name] = own
    return found


def brought_by(name: str, histories: Sequence[History]) -> list[str]:
    """List the flags that a flag brings with it, of those that some frame has."""
    brought = [one for one, by in TOLD_BY.items() if by == name]
    return [one for one in brought if any(h.flags.raised[one].any() for h in histories)]


def draw_flags(axis: Any, histories: Sequence[History]) -> None:
    """Draw a row of marks for each flag.

    Args:
        axis: the panel
        histories: the jobs
    """
    of_jobs = [flagged_frames(h) for h in histories]
    names = list(dict.fromkeys(name for found in of_jobs for name in found))
    total = sum(int(h.has_attitude.sum()) for h in histories)
    texts = []
    for row, name in enumerate(names):
        times = [
            h.order_axis[0][found[name]]
            for h, found in zip(histories, of_jobs, strict=True)
            if name in found
        ]
        at = np.concatenate(times)
        axis.plot(
            at, np.full(len(at), float(row)), "|", color=FLAGGED, ms=7, mew=0.8,
            rasterized=len(at) > MANY,
        )  # fmt: skip
        told = ", ".join([name, *brought_by(name, histories)])
        texts.append(f"{told.replace('_', ' ')}\n{len(at)} of {total}")
    axis.set_ylim(len(names) - 0.4, -0.6)
    axis.set_yticks(range(len(names)), texts, fontsize="small")
    axis.tick_params(axis="y", length=0)
    axis.grid(visible=False, axis="y")


BAND = "95 % interval; where none is seen, it is no wider than the line"


OTHERS = "0.7"
"""The colour of the jobs that are more than there are colours: they are no names' twice."""


def _coloured(histories: Sequence[History]) -> list[tuple[History, str]]:
    """Give each job its colour, those without one of their own first, behind the others."""
    alike = [(history, OTHERS) for history in histories[len(COLOURS) :]]
    return [*alike, *zip(histories, COLOURS, strict=False)]


def draw_legend(figure: Any, histories: Sequence[History]) -> None:
    """Put the legend of jobs and band below the panels, where no data are."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    colour = COLOURS[0] if len(histories) == 1 else "0.5"
    handles: list[Any] = []
    texts: list[str] = []
    if len(histories) > 1:
        for number, history in enumerate(histories[: len(COLOURS)]):
            handles.append(Line2D([], [], color=COLOURS[number]))
            texts.append(label(history, histories))
    if others := len(histories[len(COLOURS) :]):
        handles.append(Line2D([], [], color=OTHERS))
        texts.append(f"{count_text(others, 'other job')} in grey: a figure of fewer names them")
    handles.append(Patch(color=colour, alpha=0.3, lw=0))
    texts.append(BAND)
    legend_below(figure, handles, texts, 4)


# Draw angles against time with bands of 95 %, and below them half the width of the bands.

POINTS = 60  # up to this many frames, each frame has a point
DECADES = 6.0  # the most that the scale of the half-widths shows


MANY = 2000  # frames above which bands and marks are one picture in .svg and .pdf
FLAG_IN = 0.22  # the height of a row of flags, in terms of that of a panel


def draw_attitude(
    figure: Any, histories: Sequence[History], _: int | str | None = None, __: Any = None
) -> str:
    """Draw yaw, pitch, roll of the vehicle, and on its left of a camera that is turned against it.

    Args:
        figure: to draw in
        histories: the jobs
    """
    bodies = ["camera", "vehicle"] if any(map(is_turned, histories)) else ["vehicle"]
    of_vehicle = any(h.about.words.attack for h in histories)
    why = f"\n{NO_ATTACK}" if of_vehicle and not has_attack(histories) else ""
    names = [[f"{body}_{angle}" for angle in ("yaw", "pitch", "roll")] for body in bodies]
    if single_frames(histories):
        draw_table(figure, histories, [one for column in names for one in column])
        return caption(histories) + why
    axes = _grid(figure, histories, 3, len(names))
    for column, body in enumerate(bodies):
        _panels(axes[:, column], histories, names[column])
        if len(bodies) > 1:
            axes[0, column].set_title(body)
    if len(bodies) > 1 and len(axes) > 4:
        axes[4, 1].tick_params(labelleft=False)
    draw_legend(figure, histories)
    one = "" if len(bodies) > 1 else "\ncamera and vehicle are one: no mount turns them apart"
    turn = "".join(f"\n{plain(told)}" for told in one_turn_texts(histories)[:1])
    return caption(histories) + one + turn + why


def _grid(figure: Any, histories: Sequence[History], panels: int, columns: int) -> Any:
    """Divide a figure into panels of angles, of half-widths, and of flags if there are any."""
    flags = len({name for h in histories for name in flagged_frames(h)})
    ratios = [1.0] * panels + [0.7] + ([FLAG_IN * flags + 0.05] if flags else [])
    return figure.subplots(len(ratios), columns, sharex=True, height_ratios=ratios, squeeze=False)


# A source of one image: a table in the place of panels with a dot


def single_frames(histories: Sequence[History]) -> bool:
    """Tell whether no job has more than one frame with an attitude.

    Args:
        histories: the jobs
    """
    return all(h.has_attitude.sum() <= 1 for h in histories)


def draw_table(figure: Any, histories: Sequence[History], names: Sequence[str]) -> None:
    """Write the angles of jobs of one frame as a table, with their 95 % intervals and flags.

    Args:
        figure: to draw in
        histories: the jobs
        names: of `ANGLES`
    """
    have = [h for h in histories if h.has_attitude.any()]
    both = {name.split("_")[0] for name in names} >= {"camera", "vehicle"}
    angles = [name.replace("_", " ") if both else name.split("_")[-1] for name in names]
    rows = [["", "frame", *angles, "flags"]]
    for h in have:
        k = int(np.argmax(h.has_attitude))
        cells = []
        for name in names:
            value = float(values_of(h, name)[k])
            low, high = interval_of(h, name)[:, k]
            half = in_half_circle(name, value, value)
            cells.append(_with_half(value, float(high - low) / 2.0, half))
        flags = ", ".join(one.replace("_", " ") for one in flagged_frames(h)) or "none"
        rows.append(
            [label(h, histories), short(h.estimate.frame_label(k), LABEL_SHOWN), *cells, flags]
        )
    axis = figure.subplots()
    axis.axis("off")
    from_north = "; yaw from true north" if any(one.endswith("yaw") for one in names) else ""
    axis.set_title(
        f"degrees ± half of the 95 % interval{from_north}", loc="left", fontsize="medium",
        fontweight="bold",
    )  # fmt: skip
    upright = len(have) <= MOST_UPRIGHT
    if upright:  # a column for each job
        columns, *texts = [list(line) for line in zip(*rows, strict=True)]
        if len(have) == 1:
            columns, *texts = texts
    else:
        columns, texts = rows[0], rows[1:]
    table = axis.table(
        [[plain(cell) for cell in row] for row in texts], colLabels=columns, loc="upper center",
        cellLoc="left", colLoc="left", edges="horizontal",
    )  # fmt: skip
    table.auto_set_font_size(False)
    table.set_fontsize(11 if upright else 7)
    table.scale(1.0, 1.6 if upright else 1.3)


MOST_UPRIGHT = 4  # jobs of a table with a column for each; more have a row each


def _with_half(value: float, half: float, half_circle: bool) -> str:
    """Write an angle with half of its interval, to two digits of that and no more than four."""
    if not np.isfinite(value):
        return "none"
    if not np.isfinite(half):
        return f"{angle_text(value, 4, half_circle)} ± ?"
    digits = 4 if half <= 0.0 else int(np.clip(1 - np.floor(np.log10(half)), 0, 4))
    return f"{angle_text(value, digits, half_circle)} ± {half:.{digits}f}"


NO_ATTACK = (
    "no frame has angles of attack: they need the vehicle's velocity, from a track with times"
)


def has_attack(histories: Sequence[History]) -> bool:
    """Tell whether some frame has angles of attack.

    Args:
        histories: of the jobs
    """
    return any(np.isfinite(h.estimate.attack_deg).any() for h in histories)


def shows_attack(histories: Sequence[History]) -> bool:
    """Tell whether angles of attack are shown unasked: those of a vehicle, or in a known wind.

    Args:
        histories: of the jobs
    """
    return has_attack([h for h in histories if h.about.words.attack])


def draw_attack(
    figure: Any, histories: Sequence[History], _: int | str | None = None, __: Any = None
) -> str:
    """Draw the angles of attack alpha, beta and eta.

    Args:
        figure: to draw in
        histories: the jobs, of which some frame has them
    """
    names = ["alpha", "beta", "eta"]
    told = [caption(histories), conventions(histories)["angles of attack"]]
    if not any("wind" in h.uncertainty.components for h in histories):
        told.append("errors of the wind are not in the intervals")
    if single_frames(histories):
        draw_table(figure, histories, names)
    else:
        _panels(_grid(figure, histories, 3, 1)[:, 0], histories, names)
        draw_legend(figure, histories)
    return "\n".join(told)


ANGLE_TEXTS = {
    "yaw": "yaw from\ntrue north",
    "pitch": "pitch",
    "roll": "roll",
    "alpha": "alpha, attack\nin pitch",
    "beta": "beta, attack\nin yaw",
    "eta": "eta, attack\nin total",
}
"""What the axes of angles say."""


def _panels(axes: Any, histories: Sequence[History], names: list[str]) -> None:
    for axis, name in zip(axes[:3], names, strict=True):
        cut = unwrapped_about(np.concatenate([values_of(h, name) for h in histories]))
        for history, colour in _coloured(histories):
            _angle(axis, history, name, colour, cut)
        axis.set_ylabel(f"{ANGLE_TEXTS[name.split('_')[-1]]}, degrees")
        axis.yaxis.set_major_formatter(
            lambda y, _, name=name, axis=axis: (
                f"{angle_in_range(y, 9, in_half_circle(name, *axis.get_ylim())):.6g}"
            )
        )
    marks = ("-", "--", ":")
    for mark, name in zip(marks, names, strict=True):
        for history, colour in _coloured(histories):
            _half_width(axes[3], history, name, mark, colour)
    _width_scale(axes[3], [name.split("_")[-1] for name in names], marks)
    if len(axes) > 4:
        draw_flags(axes[4], histories)
    label_time_axis(axes[-1], histories)


def label_time_axis(axis: Any, histories: Sequence[History]) -> None:
    """Label the axis of times; where frames have none, that of their numbers, which are whole."""
    along = {h.order_axis[1] for h in histories}
    axis.set_xlabel("; of jobs without times: ".join(sorted(along, reverse=True)))
    if not any(np.isfinite(h.estimate.time_s).any() for h in histories):
        from matplotlib.ticker import MaxNLocator

        axis.xaxis.set_major_locator(MaxNLocator(steps=[1, 2, 5, 10], integer=True))


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


def in_half_circle(name: str, low: float, high: float) -> bool:
    """Tell whether angles in a range are written from -180 to 180, and not from 0 to 360.

    Yaw is not, and a roll on both sides of 180 is not either: it goes on to 181, as in the table.

    Args:
        name: of the angle
        low: end of the range, degrees
        high: end of the range, less than a turn above
    """
    beyond = name.endswith("roll") and np.floor((low + 180.0) / 360.0) < np.floor(
        (high + 180.0) / 360.0
    )
    around_zero = np.floor(low / 360.0) < np.floor(high / 360.0)
    return not (name.endswith("yaw") or (beyond and not around_zero))


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
        lw=0, label="band", rasterized=len(times) > MANY,
    )  # fmt: skip
    marker = "." if known.sum() <= POINTS and colour != OTHERS else ""
    axis.plot(times, line, color=colour, lw=1.0, marker=marker)
    alone = known & ~_has_neighbour(index, known)
    if alone.any():
        ends = np.nan_to_num([-low[alone], high[alone]])
        axis.errorbar(time_s[alone], angle[alone], ends, fmt=".", color=colour, capsize=3)


def _has_neighbour(index: Any, known: Any) -> Any:
    """Find the points of a broken line that have a neighbour without a break between."""
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
    positive = np.where(half > 0.0, half, np.nan)
    known = np.isfinite(positive)
    alone = known & ~_has_neighbour(index, known)
    at = np.flatnonzero((index >= 0) & alone[index])  # dots elsewhere would hide the lines' styles
    axis.plot(
        times, picked(positive, index), ls=mark, color=colour, lw=1.0, ms=2.5,
        marker="." if len(at) else "", markevery=at.tolist() or None,
    )  # fmt: skip


def _width_scale(axis: Any, names: list[str], marks: tuple[str, ...]) -> None:
    """Set the logarithmic scale of the half-widths, and a legend of the lines."""
    axis.set_ylabel("half of the\nband, degrees")
    shown = np.concatenate([line.get_ydata() for line in axis.lines])
    shown = shown[np.isfinite(shown)]
    if len(shown):
        from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

        axis.set_yscale("log")
        low, high = shown.min(), shown.max()
        low, high = max(low / 2.0, high * 10.0**-DECADES), high * 2.0
        steps = (1.0, 2.0, 5.0) if high < 30.0 * low else (1.0, 3.0)
        axis.yaxis.set_major_locator(LogLocator(subs=steps, numticks=7))
        axis.yaxis.set_major_formatter(FuncFormatter(lambda y, _: f"{y:g}"))
        axis.yaxis.set_minor_formatter(NullFormatter())
        axis.set_ylim(low, high)
    handles = [axis.plot([], [], color="0.3", ls=mark)[0] for mark in marks]
    axis.legend(
        handles, names, loc="lower right", bbox_to_anchor=(1.0, 0.98), ncols=3, fontsize="small",
        borderaxespad=0.0,
    )  # fmt: skip
