"""Residuals against time, a line a landmark, and in their standard deviations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.history import History
from vopd.attitude.residuals import outliers
from vopd.figures.attitude import broken, label_time_axis, picked
from vopd.figures.style import (
    COLOURS,
    FLAGGED,
    caption,
    label,
    legend_below,
    name_text,
    round_number,
    width_in,
)
from vopd.findings import count_text

DRAWN = 2000  # up to this many points are drawn one by one in .svg and .pdf
NAMED = 40  # up to this many columns have their label below
LONG = 4  # characters of a label; longer ones are turned
COLUMN = 0.8  # the width of a column of a single image, in terms of the distance between two
FEW = 100  # frames of a landmark, up to which each of its residuals has a mark
MANY, MEANS = 200, 60  # if a landmark has more residuals, lines are means: so many of that one
FAR = 8.0  # times the 99th percentile: residuals beyond are drawn at the edge
MARKS = "os^Dvp"
OWN_SIGMA = ("residuals", "sample")  # of `SOURCES`: residuals say nothing about such a sigma
HELD = 1e-6  # part of a reading's variance that is left as a residual: below it fits by itself
BESIDE_IN = 6.0  # width of a figure, below which panels are not side by side
MOST_SIGMAS = 5.0  # of the histogram; what is beyond stands in its last bins, and is counted


class Residuals(NamedTuple):
    """All residuals of some jobs, N of them."""

    landmark: Ints  # (N,)
    job: Ints  # (N,) index
    time: Floats  # (N,) time or frame
    pair: Floats  # (N, 2) x, y measured minus computed, image units
    sigmas: Floats  # (N, 2) the same in their standard deviations; NaN where it is not known
    outlier: Bools  # (N,)


def residual_points(histories: Sequence[History]) -> Residuals:
    """List every residual that has a time.

    The standard deviation of a residual is that of its reading, less what the fit of the frame's
    three angles takes of it.
    """
    parts: list[tuple[Any, ...]] = []
    for job, h in enumerate(histories):
        along = h.order_axis[0]
        for frames, e in h.estimates():
            pair = e.residual_xy
            here = e.used & np.isfinite(pair).all(axis=2) & np.isfinite(along[frames])[:, None]
            fitted = np.einsum("fjc,fcj->fj", e.partials, e.gain)
            left = np.stack(np.split(1.0 - fitted, 2, axis=1), axis=-1)
            with np.errstate(invalid="ignore", divide="ignore"):
                sigma = h.uncertainty.reading.sigma * np.sqrt(np.where(left > HELD, left, np.nan))
                sigma = sigma * e.relative_sigma[..., None]
                sigmas = pair / np.where(sigma > 0.0, sigma, np.nan)  # 0: it is left out
            odd = outliers(e) if e.outlier is None else e.outlier
            time = np.broadcast_to(along[frames][:, None], here.shape)
            count = np.full(int(here.sum()), job)
            parts.append((e.landmark[here], count, time[here], pair[here], sigmas[here], odd[here]))
    return Residuals(*(np.concatenate(part) for part in zip(*parts, strict=True)))


def draw_residuals(
    figure: Any, histories: Sequence[History], _: int | str | None = None, __: Any = None
) -> str:
    """Draw residuals x and y against time and in sigmas; those of a single image by landmark."""
    found = residual_points(histories)
    if len(found.time) and np.ptp(found.time) > 0.0:
        return _against_time(figure, histories, found)
    return _by_landmark(figure, histories, found)


def _against_time(figure: Any, histories: Sequence[History], found: Residuals) -> str:
    units = histories[0].estimate.units
    names, values, sigmas = _directions(histories, found)
    narrow = width_in(figure) < BESIDE_IN
    if narrow:  # the histogram and the landmarks' names below, in place of beside
        rows = figure.subplots(4, 1, height_ratios=(1, 1, 1, 0.8))
        axes = np.array([[one, rows[3]] for one in rows[:3]])
        for one in rows[:2]:
            one.sharex(rows[2])
            one.tick_params(labelbottom=False)
    else:
        axes = figure.subplots(3, 2, width_ratios=(3, 1), sharex="col", sharey="row")
    numbers, own = np.unique(found.landmark, return_inverse=True)
    squares = (values**2).sum(axis=1)
    rms = np.sqrt(np.bincount(own, squares) / (2.0 * np.bincount(own)))
    coloured = np.argsort(-rms, kind="stable")[: len(COLOURS)]
    with np.errstate(invalid="ignore"):
        limit = [_limit(values), _sigma_limit(sigmas)]
    cut = [int((np.abs(values) > limit[0]).any(axis=1).sum())]
    cut.append(int((np.abs(sigmas) > limit[1]).any(axis=1).sum()))
    for row, data in enumerate((values[:, 0], values[:, 1], sigmas)):
        axis, most = axes[row, 0], limit[row // 2]
        axis.axhline(0.0, color="0.3", lw=0.6)
        if row < 2:
            _lines(axis, found, data, own, coloured, most)
            odd = found.outlier
            if odd.any():
                axis.plot(
                    found.time[odd], np.clip(data[odd], -most, most), "s", mfc="none", mec=FLAGGED,
                    ms=9, label="does not fit",
                )  # fmt: skip
            axis.set_ylabel(f"residual {names[row]}")
        else:
            for column, mark in enumerate(("o", "x")):
                axis.plot(
                    found.time, np.clip(data[:, column], -most, most), mark, mew=0.6,
                    ms=2.5 if len(data) <= DRAWN else 1.0, color=COLOURS[column], mfc="none",
                    label=names[column][0], alpha=0.7 if len(data) <= DRAWN else 0.25,
                    rasterized=len(data) > DRAWN,
                )  # fmt: skip
            axis.axhspan(-1.96, 1.96, color="0.5", alpha=0.15, lw=0, label="95 % of errors")
            axis.set_ylabel("residual, in\nits sigma")
            handles, texts = axis.get_legend_handles_labels()
            if narrow:
                legend = axis.legend(handles, texts, loc="upper left", ncols=3, fontsize="small",
                                     bbox_to_anchor=(0.0, -0.3))  # fmt: skip
            else:
                legend = figure.legend(handles, texts, loc="outside lower center", ncols=3)
            for mark in legend.get_lines():
                mark.set(markersize=5.0, alpha=1.0)
        for side, at in ((1.0, "^"), (-1.0, "v")):
            beyond = (side * data > most) if row < 2 else (side * data > most).any(axis=1)
            axis.plot(
                found.time[beyond], [side * most] * int(beyond.sum()), at, color="black", ms=6
            )
        axis.set_ylim(-1.06 * most, 1.06 * most)
    label_time_axis(axes[2, 0], histories)
    shown = dict(zip(*reversed(axes[0, 0].get_legend_handles_labels()), strict=True))
    named = {
        str(place): f"{_label(histories, int(numbers[k]))}: {_three_digits(rms[k])}"
        for place, k in enumerate(coloured)
    }
    rest = count_text(len(numbers) - len(coloured), "other")
    named |= {"others": rest, "does not fit": "does not fit"}
    kept = [one for one in named if one in shown]
    handles, texts = [shown[one] for one in kept], [named[one] for one in kept]
    title = f"rms, {units.residual}"
    if narrow:
        figure.legend(handles, texts, loc="outside lower center", ncols=2, title=title)
    else:
        for axis in axes[:2, 1]:
            axis.axis("off")
        # a legend beside one row alone parts it from others
        axes[0, 1].set_subplotspec(axes[0, 1].get_gridspec()[:2, 1])
        axes[0, 1].legend(
            handles, texts, loc="upper left", title=title, bbox_to_anchor=(-0.1, 1.02),
            alignment="left",
        )  # fmt: skip
    far = _histogram(axes[2, 1], sigmas, upright=narrow)
    told = ["picked minus computed" if units.image == "px" else "measured minus computed"]
    longest = int(np.unique(own + len(numbers) * found.job, return_counts=True)[1].max())
    if longest > MANY:
        told.append(f"lines: means of {_of_a_mean(longest)} residuals, dots: single ones")
        if others := len(numbers) - len(coloured):
            told[-1] += f", of {count_text(others, 'other landmark')} these alone"
    told += filter(None, [_rms_text(found, histories)])
    for count, most, unit in zip(cut, limit, (units.residual, "sigma"), strict=True):
        if count:
            many = count_text(count, "residual")
            told.append(f"{many} beyond {most:.3g} {unit} at the edge, as triangles")
    if far:
        told.append(f"{far} beyond {MOST_SIGMAS:g} sigma in the histogram's last bins")
    return f"{caption(histories)}\n{'; '.join(told)}"


def _rms_text(found: Residuals, histories: Sequence[History]) -> str:
    """Say how large the residuals that fit are in their standard deviations; else empty."""
    known = found.sigmas[np.isfinite(found.sigmas) & ~found.outlier[:, None]]
    if not len(known):
        return ""
    size = f"{_three_digits(float(np.sqrt(np.mean(known**2))))} (1 if sigma is right"
    fitted = all(h.uncertainty.reading.source in OWN_SIGMA for h in histories)
    size += "; sigma is from these residuals)" if fitted else ")"
    return f"in sigmas, rms of those that fit: {size}"


def _three_digits(value: float) -> str:
    """Write a size with three digits, so that sizes below each other can be compared."""
    return f"{value:#.3g}".rstrip(".")


def _directions(histories: Sequence[History], found: Residuals) -> tuple[list[str], Floats, Floats]:
    """Name the directions of residuals, and turn them so: of pixels u and v, as they are picked.

    Returns:
        The names, the residuals (N, 2), and these in their standard deviations (N, 2).
    """
    units, words = histories[0].estimate.units, histories[0].about.words
    values = found.pair * units.residuals_per_image
    if units.image == "px":
        return ["u, px,\nto the right", "v, px,\ndown"], -values, -found.sigmas
    ways = ("x to the left", "y up")
    names = [f"{way}, {units.residual}\n{words.surface}" for way in ways]
    return names, values, found.sigmas


def _limit(values: Floats) -> float:
    """Choose how far an axis goes: as far as all values, or if a few are far off beside most."""
    size = np.abs(values)
    most, usual = float(size.max()), float(np.quantile(size, 0.99))
    return max(3.0 * usual if most > FAR * usual > 0.0 else most, 1e-9)


def _sigma_limit(sigmas: Floats) -> float:
    """Choose how far the axis in sigmas goes: a frame that misfits leaves the others readable."""
    size = np.abs(sigmas[np.isfinite(sigmas)])
    if not len(size):
        return 3.0
    readable = round_number(max(2.0 * MOST_SIGMAS, 3.0 * float(np.quantile(size, 0.75))))
    most = float(size.max())
    return readable if most > 2.0 * readable else max(most, 3.0)


def _lines(
    axis: Any, found: Residuals, data: Floats, own: Ints, coloured: Ints, most: float
) -> None:
    """Draw a line for each landmark of each job, broken where frames are missing."""
    rank = np.full(int(own.max(initial=0)) + 1, -1)
    rank[coloured] = np.arange(len(coloured))
    order = np.lexsort((found.time, own, found.job))
    ends = np.flatnonzero(np.diff(own[order]) | np.diff(found.job[order])) + 1
    longest = int(np.diff([0, *ends.tolist(), len(order)]).max())
    labelled = set()
    for part in sorted(np.split(order, ends), key=lambda part: int(rank[own[part[0]]])):
        place = int(rank[own[part[0]]])
        name = None if place in labelled else "others" if place < 0 else str(place)
        labelled.add(place)
        look: dict[str, Any] = {"color": "0.7", "lw": 0.6, "zorder": 1, "label": name}
        if place >= 0:
            look |= {"color": COLOURS[place], "lw": 1.0, "marker": MARKS[place], "ms": 3.5}
            look["zorder"] = 2
        time, values = found.time[part], np.clip(data[part], -most, most)
        if longest > MANY:
            if place < 0:
                continue
            times, values = _means(time, values, _of_a_mean(longest))
        else:
            times, index = broken(time, np.zeros(len(time)))
            values = picked(values, index)
        look["markevery"] = 1 if len(times) <= FEW else max(len(times) // 25, 1)
        axis.plot(times, values, **look)
    if longest > MANY:
        axis.plot(
            found.time, np.clip(data, -most, most), ",", color="0.7", zorder=0, rasterized=True
        )


def _of_a_mean(longest: int) -> int:
    """Choose of how many residuals a mean is, if the landmark with the most has so many."""
    return -(-longest // MEANS)


def _means(time: Floats, values: Floats, each: int) -> tuple[Floats, Floats]:
    """Average as many residuals at a time, none across a gap: times and values, NaN at a gap."""
    _, index = broken(time, np.zeros(len(time)))
    made: list[tuple[float, float]] = []
    for run in np.split(index, np.flatnonzero(index < 0)):
        held = run[run >= 0]
        parts = np.array_split(held, max(len(held) // each, 1))
        made += [(time[part].mean(), values[part].mean()) for part in parts] + [(np.nan, np.nan)]
    times, means = np.array(made[:-1]).T
    return times, means


def _histogram(axis: Any, sigmas: Floats, upright: bool) -> int:
    """Draw how often residuals have which size, in sigmas; gives how many are in the end bins.

    Args:
        axis: the panel
        sigmas: the residuals
        upright: whether the size grows to the right, in place of up as beside other panels
    """
    values = sigmas[np.isfinite(sigmas)]
    axis.tick_params(labelleft=False, left=not upright, labelbottom=upright, bottom=upright)
    axis.grid(visible=False)
    if not len(values):
        axis.text(0.5, 0.5, "no sigma", ha="center", transform=axis.transAxes)
        return 0
    edges = np.linspace(-MOST_SIGMAS, MOST_SIGMAS, 31)
    held = np.clip(values, edges[0], edges[-1])
    way: Any = "vertical" if upright else "horizontal"
    axis.hist(held, edges, density=True, orientation=way, color=COLOURS[4], alpha=0.6)
    size = np.linspace(edges[0], edges[-1], 101)
    line = (size, np.exp(-(size**2) / 2.0) / np.sqrt(2.0 * np.pi))
    axis.plot(*(line if upright else line[::-1]), color="black", lw=1.0)
    if upright:
        axis.set_xlabel("residual, in its sigma; line: as expected")
        axis.set_ylabel("how many")
    else:
        axis.set_xlabel("how many;\nline: as expected")
    return int((np.abs(values) > MOST_SIGMAS).sum())


# A single image: residuals by landmark


def _by_landmark(figure: Any, histories: Sequence[History], found: Residuals) -> str:
    """Draw residuals x and y, a column for each landmark; several jobs side by side in each."""
    numbers, column = np.unique(found.landmark, return_inverse=True)
    jobs = len(histories)
    across = column + (COLUMN * (found.job / (jobs - 1) - 0.5) if jobs > 1 else 0.0)
    axes = figure.subplots(2, 1, sharex=True, sharey=True)
    size = 14.0 if len(across) < 300 else 4.0
    names, values, _ = _directions(histories, found)
    most = 1.08 * max(float(np.abs(values).max(initial=0.0)), 1e-9)
    alone = np.bincount(column).max(initial=0) <= 1  # each is its own root mean square
    coloured = 1 < jobs <= len(COLOURS)
    of_jobs = [label(one, histories) for one in histories] if coloured else ["one frame"]
    for axis, own, name in zip(axes, values.T, names, strict=True):
        if alone:
            axis.vlines(across, 0.0, own, color=COLOURS[0], lw=1.5)
        else:
            rms = [np.sqrt(np.mean(own[column == k] ** 2)) for k in range(len(numbers))]
            axis.bar(
                np.arange(len(numbers)), 2.0 * np.array(rms), 0.96, -np.array(rms), color="0.88",
                label="root mean square, both ways", zorder=0,
            )  # fmt: skip
        for job in range(len(of_jobs)):
            here = found.job == job if coloured else np.ones(len(own), dtype=bool)
            axis.scatter(
                across[here], own[here], size, color=COLOURS[job], lw=0, alpha=0.8,
                label=str(job), rasterized=len(across) > DRAWN,
            )  # fmt: skip
        odd = found.outlier
        if odd.any():
            look = {"mfc": "none", "mec": FLAGGED, "ls": ""}
            axis.plot(across[odd], own[odd], "s", label="does not fit", **look)
        axis.axhline(0.0, color="0.3", lw=0.6)
        axis.set_ylim(-most, most)
        axis.set_ylabel(f"residual {name}")
        axis.grid(visible=False, axis="x")
    _labels(axes[-1], [_label(histories, n) for n in numbers.tolist()])
    handles, texts = axes[0].get_legend_handles_labels()
    if len(texts) > 1:  # matplotlib leaves out what is labelled with a name that begins with _
        texts = [of_jobs[int(one)] if one.isdecimal() else one for one in texts]
        legend_below(figure, handles, texts, 4)
    order = "; columns from left to right: the jobs" if jobs > 1 else ""
    units = histories[0].estimate.units
    picked = "picked" if units.image == "px" else "measured"
    told = [f"{picked} minus computed{order}"]
    if len(values):
        rms_text = _three_digits(float(np.sqrt(np.mean(values**2))))
        told.append(f"rms of a coordinate {rms_text} {units.residual}")
    told += filter(None, [_rms_text(found, histories)])
    return f"{caption(histories)}\n{'; '.join(told)}"


def _label(histories: Sequence[History], number: int) -> str:
    """Name a landmark as the first job does that has a name for it."""
    names = (h.estimate.landmark_names.get(number) for h in histories)
    return name_text(next((name for name in names if name), str(number)))


def _labels(axis: Any, labels: list[str]) -> None:
    every = max(1, -(-len(labels) // NAMED))
    turned = 90.0 if max(map(len, labels), default=0) > LONG else 0.0
    axis.set_xticks(np.arange(len(labels))[::every], labels[::every], rotation=turned)
    axis.set_xlim(-0.6, len(labels) - 0.4)
    axis.set_xlabel("landmark")
