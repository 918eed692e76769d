"""Figures of attitude histories, frames and stars, drawn with matplotlib."""

from __future__ import annotations

import io
import os
import re
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from math import floor, log10
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.history import History
from vopd.attitude.long_history import frame_landmarks
from vopd.attitude.uncertainty import ANGLES
from vopd.estimate import Units
from vopd.files import optional_package
from vopd.findings import VopdError, count_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure


# Choose the jobs that a figure shows: of many, those that a person should look at first.

MOST_DRAWN = 20
"""Jobs of one figure: with more, none can be told from another, and each takes .2 s."""

WORST = "the most frames that did not converge, misfit or have a flag"


def drawn_jobs(histories: Sequence[History]) -> list[History]:
    """Select the jobs to draw: all, or of more than `MOST_DRAWN` the worst, in their order.

    Args:
        histories: the jobs
    """
    if len(histories) <= MOST_DRAWN:
        return list(histories)
    have = [k for k, one in enumerate(histories) if one.has_attitude.any()]
    have.sort(key=lambda k: _badness(histories[k]), reverse=True)
    return [histories[k] for k in sorted(have[:MOST_DRAWN])]


def left_out_text(histories: Sequence[History]) -> str:
    """Say which jobs a figure shows if it does not show all; else empty.

    Args:
        histories: the jobs
    """
    drawn = len(drawn_jobs(histories))
    return "" if drawn == len(histories) else f"{drawn} of {len(histories)} jobs, with {WORST}"


def _badness(history: History) -> tuple[int, int, int]:
    """Count the frames that did not converge, misfit, and have any flag."""
    raised = history.flags.raised
    return (
        int(raised["not_converged"].sum()),
        int(raised["misfit"].sum()),
        int(history.flags.any().sum()),
    )


# Draw figures of attitude histories with matplotlib, which is imported when first needed.
#
# Every figure shows all histories it is given, those of several jobs and sources
# too. Lines break where frames are missing, between jobs, and where an angle wraps.

Inches = tuple[float, float]


SUFFIXES = (".png", ".svg", ".pdf")
_UNDATED: dict[str, dict[str, Any]] = {  # without dates, so that the same figure is the same file
    ".png": {"Software": None},
    ".svg": {"Date": None, "Creator": None},
    ".pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}


@contextmanager
def matplotlib_figure(size_in: Inches) -> Iterator[Any]:
    """Open a new figure, with the style of all figures in force.

    Args:
        size_in: width and height, inches

    Raises:
        VopdError: where matplotlib is not installed
    """
    figure_class, style = _matplotlib()
    with style():
        yield figure_class(figsize=size_in, layout="constrained")


def save(
    figure: Figure, suffix: str, dpi: int = 150, note: Callable[[str], object] = lambda _: None
) -> bytes:
    """Write the figure to a file; the same figure always gives the same bytes.

    Args:
        figure: what `draw` has made
        suffix: of `SUFFIXES`
        dpi: dots an inch, for .png
        note: is given a sentence if no installed font has some characters

    Raises:
        VopdError: where the figure cannot be written
    """
    _, style = _matplotlib()
    file = io.BytesIO()
    with style(), warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        engine = figure.get_layout_engine()
        if engine is not None:
            engine.execute(figure)
            figure.set_layout_engine(None)  # with one, savefig draws everything twice
        try:
            figure.savefig(file, format=suffix[1:], metadata=_UNDATED[suffix], dpi=dpi)
        except (ValueError, OverflowError, OSError) as error:
            if "SOURCE_DATE_EPOCH" not in os.environ:  # which PDF reads, whatever it has then
                raise
            raise VopdError("SOURCE_DATE_EPOCH is not a number of seconds since 1970") from error
        figure.set_layout_engine(engine)
    missing = {found[1] for one in warned if (found := MISSING.match(str(one.message)))}
    if missing and suffix != ".svg":
        names = ", ".join(sorted(chr(int(code)) for code in missing)[:5])
        note(f"no font has {names}; install Noto Sans CJK, or draw as .svg")
    for one in warned:
        if not (MISSING.match(str(one.message)) or "constrained_layout" in str(one.message)):
            warnings.warn_explicit(one.message, one.category, one.filename, one.lineno)
    return _renamed(file.getvalue()) if suffix == ".svg" else file.getvalue()


MISSING = re.compile(r"Glyph (\d+) .* missing from")


def _renamed(text: bytes) -> bytes:
    """Number the ids of an SVG in order: some of matplotlib's depend on memory addresses."""
    ids = dict.fromkeys(re.findall(rb'\bid="([^"]+)"', text))
    names = {old: b"v%d" % number for number, old in enumerate(ids)}
    return re.sub(rb'(\bid="|#)([^"#)]+)(?=["\)])', lambda m: m[1] + names.get(m[2], m[2]), text)


def svg(figure: Figure) -> str:
    """Write the figure as SVG text."""
    return save(figure, ".svg").decode("utf-8")


def ready() -> None:
    """Check that matplotlib is installed.

    Raises:
        VopdError: where matplotlib is not installed
    """
    _matplotlib()


def _matplotlib() -> tuple[Any, Any]:
    return optional_package("matplotlib.figure", "plots").Figure, style


# The look of all figures: colours that the colour-blind can tell apart, sizes, captions.

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00")  # Okabe and Ito
FLAGGED = "#b30000"
_SETTINGS: dict[Any, Any] = {
    "font.size": 9.0,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.useoffset": False,
    "legend.frameon": False,
    "svg.hashsalt": "vopd",
    "svg.fonttype": "none",  # texts are texts: the viewer has fonts for them
    "path.simplify": True,
}


@contextmanager
def style() -> Iterator[None]:
    """Apply the style for drawing and saving a figure, and restore the old settings afterwards."""
    import matplotlib as mpl

    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(_SETTINGS)
        mpl.rcParams["font.family"] = [*mpl.rcParams["font.family"], *_more_fonts()]
        yield


MORE_FONTS = (
    "Noto Sans CJK JP", "Noto Sans CJK SC", "Noto Sans JP", "Noto Sans SC", "Source Han Sans",
    "IPAexGothic", "IPAGothic", "TakaoPGothic", "WenQuanYi Zen Hei", "WenQuanYi Micro Hei",
    "Droid Sans Fallback", "Hiragino Sans", "Yu Gothic", "MS Gothic", "PingFang SC",
    "Microsoft YaHei", "SimHei", "Noto Sans KR", "Malgun Gothic", "Apple SD Gothic Neo",
    "Arial Unicode MS",
)  # fmt: skip
"""Fonts for Japanese, Chinese and Korean names, which matplotlib's own font does not have."""


@cache
def _more_fonts() -> list[str]:
    """List those of `MORE_FONTS` that are installed."""
    from matplotlib.font_manager import fontManager

    installed = {font.name for font in fontManager.ttflist}
    return [name for name in MORE_FONTS if name in installed]


def caption(histories: Sequence[History]) -> str:
    """Write the caption: sources, the title if there is one job, and the fixes in force."""
    names = list(dict.fromkeys(h.about.source for h in histories))
    text = ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
    if len(histories) == 1:
        text += f", job {histories[0].about.job}: {histories[0].about.title}"
    else:
        text += f", {len(histories)} jobs"
    fixes = histories[0].about.fixes
    if fixes:
        text += f"\ncorrected run, not the original: {fixes}"
    return plain(text)


def label(history: History, histories: Sequence[History]) -> str:
    """Label a job in a legend."""
    sources = {h.about.source for h in histories}
    return plain(history.about.label if len(sources) > 1 else f"job {history.about.job}")


LONGEST_TEXT = 300  # characters


def plain(text: str) -> str:
    """Escape text for matplotlib: no formulas, and `?` for unprintable characters.

    Of a text that no figure has room for the end is left out.
    """
    if len(text) > LONGEST_TEXT:
        text = f"{text[: LONGEST_TEXT - 1]}…"
    return "".join(c if c.isprintable() or c == "\n" else "?" for c in text).replace("$", r"\$")


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


# Draw residuals by landmark; in the column of a landmark, time runs from left to right.

COLUMN = 0.8  # the width of a column, in terms of the distance between two
DRAWN = 5000  # up to this many points are drawn one by one in .svg and .pdf
NAMED = 40  # up to this many columns have their label below
LONG = 4  # characters of a label; longer ones are turned
SHOWN = 16  # characters of a label that are shown


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
    return plain(_short(label))


def _short(label: str, most: int = SHOWN) -> str:
    return label if len(label) <= most else f"{label[: most - 1]}…"


def _labels(axis: Any, labels: list[str]) -> None:
    every = max(1, -(-len(labels) // NAMED))
    turned = 90.0 if max(map(len, labels), default=0) > LONG else 0.0
    axis.set_xticks(np.arange(len(labels))[::every], labels[::every], rotation=turned)
    axis.set_xlim(-0.6, len(labels) - 0.4)
    axis.set_xlabel("landmark")


# Draw the errors of several methods for every pair of stars, one panel for each angle.

SIZE_IN = (9.0, 10.0)
MARKERS = "osD^v*"
APART = 0.12
"""Distance of the methods' marks of one pair, in distances of the pairs."""


def draw_errors_by_pair(
    pairs: Sequence[str], methods: Sequence[str], panels: dict[str, Floats]
) -> Figure:
    """Draw panels one below the other, a mark for each pair and method.

    Args:
        pairs: names of the pairs
        methods: names of the methods
        panels: errors in degrees of each method (columns) by pair (rows), by the panel's title

    Raises:
        VopdError: where matplotlib is not installed
    """
    with matplotlib_figure(SIZE_IN) as figure:
        axes = np.atleast_1d(figure.subplots(len(panels), 1, sharex=True))
        place = np.arange(len(pairs))
        for axis, (title, errors) in zip(axes, panels.items(), strict=True):
            axis.axhline(0.0, color="0.5", lw=0.8)
            for k, method in enumerate(methods):
                shift = (k - (len(methods) - 1) / 2.0) * APART
                axis.plot(
                    place + shift, errors[:, k], MARKERS[k % len(MARKERS)], ms=6,
                    color=COLOURS[k % len(COLOURS)], label=method,
                )  # fmt: skip
            axis.set_title(title, fontsize="medium")
            axis.set_ylabel("degrees")
            axis.set_xticks(place, pairs)
        axes[0].legend(ncols=len(methods), loc="lower center", bbox_to_anchor=(0.5, 1.12))
        drawn: Figure = figure
    return drawn


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
        label = plain(_short(e.landmark_label(number), 40))
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


# Figures by their names


class FigureKind(NamedTuple):
    """A kind of figure. Sizes are width, height."""

    draw: Callable[[Any, Sequence[History], int | str | None], str]  # gives a line below the title
    title: str
    size_in: Inches
    least_in: Inches  # smaller ones cannot hold its panels and their labels


FIGURES = {
    "attitude": FigureKind(attitude, "Camera and vehicle attitude", (9.0, 8.0), (7.5, 6.0)),
    "attack": FigureKind(attack, "Angles of attack", (9.0, 7.0), (5.0, 5.5)),
    "residuals": FigureKind(residuals, "Residuals by landmark", (9.0, 5.0), (5.0, 3.5)),
    "image": FigureKind(image, "One frame's image", (9.0, 6.5), (6.0, 4.0)),
}
"""Every kind of figure by its name."""


def draw(
    name: str,
    histories: Sequence[History],
    frame: int | str | None = None,
    size_in: Inches | None = None,
) -> Figure:
    """Draw one figure of `FIGURES`, or `all` of them one below the other.

    Args:
        name: of `FIGURES`, or "all"
        histories: one or more jobs; of many the worst are drawn (`drawn_jobs`)
        frame: number, or name, of the frame whose image is drawn, in the first job
            that has it; None takes the frame with the most landmarks
        size_in: width and height, inches; None takes the usual size

    Raises:
        VopdError: where matplotlib is not installed, no frame has an attitude, that
            frame has none, no frame has angles of attack for `attack`, or the size cannot
            hold the panels
    """
    refuse_small(name, size_in)
    figure_class, style = _matplotlib()
    if not any(h.has_attitude.any() for h in histories):
        raise VopdError("no frame has an attitude")
    names = list(FIGURES) if name == "all" else [name]
    drawn, left_out = drawn_jobs(histories), left_out_text(histories)
    if name == "attack" and not has_attack(drawn):
        raise VopdError(NO_ATTACK)
    heights = [FIGURES[one].size_in[1] for one in names]
    with style():
        figure = figure_class(figsize=size_in or (9.0, sum(heights)), layout="constrained")
        parts = figure.subfigures(len(names), 1, height_ratios=heights, squeeze=False)[:, 0]
        for one, part in zip(names, parts, strict=True):
            kind = FIGURES[one]
            if one == "image":  # of one frame, which can be that of any job
                more = kind.draw(part, histories, frame)
            else:
                more = kind.draw(part, drawn, frame) + (left_out and f"\n{left_out}")
            part.suptitle(f"{kind.title}\n{more}", fontsize="medium")
    return figure  # type: ignore[no-any-return]


def least_size_in(name: str) -> Inches:
    """Find the smallest width and height, inches, of a figure, or of "all"."""
    if name != "all":
        return FIGURES[name].least_in
    total = sum(kind.size_in[1] for kind in FIGURES.values())
    stretch = max(kind.least_in[1] / kind.size_in[1] for kind in FIGURES.values())
    return max(kind.least_in[0] for kind in FIGURES.values()), round(total * stretch, 1)


def refuse_small(name: str, size_in: Inches | None) -> None:
    """Check that a figure fits in a size.

    Raises:
        VopdError: where it does not, with the smallest size that does
    """
    width, height = least_size_in(name)
    if size_in is not None and not (size_in[0] >= width and size_in[1] >= height):
        raise VopdError(
            f"the figure {name!r} does not fit in {size_in[0]:g}x{size_in[1]:g} inches: "
            f"the smallest size is {width:g}x{height:g}"
        )


# Draw a photograph of stars: where they were read and where the attitude puts them.

STARS_SIZE_IN = (9.0, 6.5)
MOST_LABELS = 60
"""Above this number of stars their names would hide each other and are left out."""


class StarPicture(NamedTuple):
    """What is drawn of one photograph.

    Attributes:
        title: what is solved, and how
        images: x right and y up from the principal point, (n, 2)
        residuals: observed minus computed, (n, 2)
        labels: the stars' names or numbers
        unit: of the images, "mm" or "px"
    """

    title: str
    images: Floats
    residuals: Floats
    labels: Sequence[str]
    unit: str


def draw_star_residuals(picture: StarPicture, size_in: Inches | None = None) -> Figure:
    """Draw the image of a photograph as seen from behind the camera, with its residuals as arrows.

    Args:
        picture: what to draw
        size_in: width and height, inches

    Raises:
        VopdError: where matplotlib is not installed
    """
    units = Units(image=picture.unit)
    if picture.unit == "px":
        units = Units(image="px", residual="px", residuals_per_image=1.0)
    images, residuals = picture.images, picture.residuals
    with matplotlib_figure(size_in or STARS_SIZE_IN) as figure:
        axis = figure.subplots()
        far = max(float(np.abs(images).max(initial=0.0)), 1e-3) * ROOM
        scale = arrow_scale(residuals, 2.0 * far)
        residual_arrows(axis, images - residuals, residuals, scale, units)
        axis.plot(*(images - residuals).T, "+", color="0.2", ms=9, label="computed")
        axis.plot(*images.T, "o", mfc="none", mec=COLOURS[0], ms=7, label="measured")
        axis.plot(0.0, 0.0, "x", color="0.5", ms=8, label="principal point")
        if len(images) <= MOST_LABELS:
            for label, point in zip(picture.labels, images, strict=True):
                axis.annotate(plain(_short(label, 40)), point, (7, 7), textcoords="offset points")
        axis.set(xlim=(-far, far), ylim=(-far, far), aspect="equal")
        axis.set_xlabel(f"x, {picture.unit} in the image, to the right")
        axis.set_ylabel(f"y, {picture.unit} in the image, up")
        axis.legend(loc="upper left", bbox_to_anchor=(1.02, 1.0))
        arrows = f"arrows: residuals, measured minus computed, {scale:g} times as long"
        figure.suptitle(f"{plain(picture.title)}\n{arrows}", fontsize="medium")
        drawn: Figure = figure
    return drawn
