"""Photographs of stars, and the errors of several methods for every pair of stars."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.estimate import Units
from vopd.figures.image import MOST_SHOWN_PX, NAME_SHOWN, ROOM, ROOM_IN, draw_arrows, image_border
from vopd.figures.style import (
    BEHIND,
    COLOURS,
    FLAGGED,
    Inches,
    halo,
    matplotlib_figure,
    name_text,
    place_names,
    plain,
    wrapped,
)
from vopd.findings import count_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Draw the errors of several methods for every pair of stars, one panel for each angle.

SIZE_IN = (9.0, 10.0)
MARKERS = "osD^v*"
APART = 0.12  # distance of the methods' marks of one pair, in distances of the pairs


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


# Draw a photograph of stars: where they were read and where the attitude puts them.

STARS_SIZE_IN = (9.0, 6.5)
MOST_LABELS = 200  # stars with their names, as far as there is room
FINE = 120  # points along each side, through which the grid of the sky is traced
MERIDIANS_DEG = (
    *(1 / 240, 1 / 120, 1 / 48, 1 / 24, 1 / 12, 1 / 8, 1 / 4, 1 / 2),
    *(5 / 4, 5 / 2, 5.0, 7.5, 15.0, 30.0),
)
"""Distances of meridians: 1, 2, 5, 10, 20, 30 s; 1, 2, 5, 10, 20, 30 min; 1, 2 h."""
PARALLELS_DEG = (
    *(1 / 360, 1 / 120, 1 / 60, 1 / 30, 1 / 12, 1 / 6, 1 / 3, 1 / 2),
    *(1.0, 2.0, 5.0, 10.0, 15.0, 30.0),
)
LINES = 6  # about as many of each kind
SKY, ON_DARK = "#7a3b9a", "#c9a0e8"


class StarPicture(NamedTuple):
    """What is drawn of one photograph."""

    title: str  # what is solved, and how
    images: Floats  # as measured, (n, 2)
    residuals: Floats  # observed minus computed, (n, 2)
    labels: Sequence[str]  # the stars' names or numbers
    unit: str  # of the images, "mm" or "px"
    odd: Sequence[bool] = ()  # which do not fit, or are named as mistaken; empty: none
    left_out: Sequence[bool] = ()  # which are not solved; empty: none
    edges: tuple[float, float, float, float] | None = None
    """Left, right, lower and upper edge of the image; None: not known. The coordinates are then
    x right and y up from the principal point."""
    centre: tuple[float, float] = (0.0, 0.0)  # principal point
    in_file: bool = False  # whether the coordinates are those of the file, and not from there
    y_down: bool = False
    photograph: Any = None  # a PIL image
    sky: Callable[[Floats], Floats] | None = None
    """Right ascension and declination at points of the picture, degrees, (n, 2)."""
    epoch: str = ""  # what they refer to
    point: str = "star"  # what was read, "star" or "ground point"


def draw_star_residuals(picture: StarPicture, size_in: Inches | None = None) -> Figure:
    """Draw a photograph of stars, as seen from behind the camera, with its residuals as arrows.

    Args:
        picture: the stars, and as far as they are known photograph, border and sky
        size_in: width and height, inches; None takes the usual size

    Raises:
        VopdError: where matplotlib is not installed
    """
    units = Units(image=picture.unit)
    if picture.unit == "px":
        units = Units(image="px", residual="px", residuals_per_image=1.0)
    images, residuals = picture.images, picture.residuals
    odd, out = (
        np.array(one, dtype=bool) if len(one) else np.zeros(len(images), dtype=bool)
        for one in (picture.odd, picture.left_out)
    )
    size_in = size_in or STARS_SIZE_IN
    with matplotlib_figure(size_in) as figure:
        axis = figure.subplots()
        edges = picture.edges or _edges_around(images, residuals, picture)
        left, right, low, high = edges
        width = abs(right - left)
        room = 0.0 if picture.edges is None else 0.03
        sides = np.array([[left, low], [right, high]])
        sides += (sides - sides.mean(axis=0)) * room
        outside = int((_beyond(images, edges) > 0.0).sum())
        if outside:  # of what the size of the image says
            far = np.vstack([images.min(axis=0), images.max(axis=0)])
            far += (far - far.mean(axis=0)) * 0.1
            upward = sides[1] > sides[0]
            low_side = np.minimum(sides.min(axis=0), far[0])
            high_side = np.maximum(sides.max(axis=0), far[1])
            sides = np.where(upward, [low_side, high_side], [high_side, low_side])
        axis.set(xlim=sides[:, 0], ylim=sides[:, 1], aspect="equal")
        axis.grid(visible=False)
        told = [f"{count_text(outside, picture.point)} outside the image"] if outside else []
        if picture.photograph is not None:
            shown = picture.photograph.convert("RGB")
            shown.thumbnail((MOST_SHOWN_PX, MOST_SHOWN_PX))
            axis.imshow(
                np.asarray(shown), extent=(left, right, low, high), zorder=0,
                origin="upper", interpolation="antialiased",
            )  # fmt: skip
        if picture.edges is not None:
            axis.add_patch(image_border(edges, "none" if picture.photograph else "0.97"))
        start = images - residuals
        scale, along = draw_arrows(axis, start, residuals, ~odd & ~out, width, units)
        look = {"ls": "", "mfc": "none", "path_effects": halo(3.0)}
        axis.plot(*start.T, "+", mec="0.2", ms=12, label="computed", **look)
        for here, mark, colour, size, text in (
            (~odd & ~out, "o", COLOURS[0], 7, "measured"),
            (out & ~odd, "D", COLOURS[3], 7, "left out"),
            (odd & ~out, "s", FLAGGED, 12, "does not fit"),
            (odd & out, "s", FLAGGED, 12, "does not fit, left out"),
        ):
            if here.any() or mark == "o":
                axis.plot(
                    *images[here].T, mark, mec=colour, mew=1.5, ms=size, label=text, zorder=4,
                    **look,
                )  # fmt: skip
        axis.plot(*picture.centre, "x", color="0.5", ms=8, label="principal point")
        if picture.sky is not None:
            colour = SKY if picture.photograph is None else ON_DARK
            marks = np.vstack([images, start, along, [picture.centre]])
            at = _draw_sky(axis, picture.sky, edges, colour, marks)
            along = np.vstack([along, at])
            epoch = f", {picture.epoch}" if picture.epoch else ""
            told.append(f"lines: right ascension and declination{epoch}")
        order = np.argsort(~odd, kind="stable")[:MOST_LABELS]
        names = [name_text(picture.labels[k], NAME_SHOWN) for k in order]
        names = [
            f"{name}: does not fit" if odd[k] else name
            for name, k in zip(names, order.tolist(), strict=True)
        ]
        span = np.abs(sides[1] - sides[0])
        per = float(((np.array(size_in) - ROOM_IN) / span).min()) * 72.0
        pt = np.array([per, -per if high < low else per])
        nameless = place_names(axis, images[order], names, pt, sides, odd[order], along)
        nameless += len(images) - len(order)
        if nameless:
            told.append(f"{count_text(nameless, 'name')} left out for want of room")
        where = "" if picture.in_file else " in the image"
        axis.set_xlabel(f"x, {picture.unit}{where}, to the right")
        axis.set_ylabel(f"y, {picture.unit}{where}, {'down' if picture.y_down else 'up'}")
        handles, texts = axis.get_legend_handles_labels()
        figure.legend(handles, texts, loc="outside lower center", ncols=5)
        long = "as long as they are" if scale == 1.0 else f"{scale:g} times as long"
        told.append(f"arrows: residuals, measured minus computed, {long}")
        text = wrapped(
            "\n".join([*map(plain, picture.title.splitlines()), "; ".join(told)]), size_in[0]
        )
        figure.suptitle(text, fontsize="medium")
        drawn: Figure = figure
    return drawn


def _beyond(points: Floats, edges: tuple[float, float, float, float]) -> Floats:
    """Find how far points are outside an image, (n,)."""
    low, high = np.sort(np.array(edges).reshape(2, 2), axis=1).T
    return np.asarray(np.maximum(low - points, points - high).max(axis=1))


def _edges_around(
    images: Floats, residuals: Floats, picture: StarPicture
) -> tuple[float, float, float, float]:
    """Choose edges around all stars, with the principal point in the middle."""
    away = np.abs(np.vstack([images, images - residuals]) - picture.centre)
    far = max(float(away.max(initial=0.0)), 1e-3) * ROOM
    x, y = picture.centre
    return (x - far, x + far, *((y + far, y - far) if picture.y_down else (y - far, y + far)))


def _draw_sky(
    axis: Any,
    sky: Callable[[Floats], Floats],
    edges: tuple[float, float, float, float],
    colour: str,
    marks: Floats,
) -> Floats:
    """Draw meridians and parallels over a picture, with right ascensions and declinations.

    Args:
        axis: to draw in
        sky: right ascension and declination at points of the picture, degrees
        edges: of the picture
        colour: of the lines
        marks: points that numbers stand far from, (m, 2)

    Returns:
        Where the numbers stand, (n, 2).
    """
    corners = np.array(edges).reshape(2, 2).T
    taken = marks
    x = np.linspace(*edges[:2], FINE)
    y = np.linspace(*edges[2:], FINE)
    points = np.stack(np.meshgrid(x, y), axis=-1)
    ra, dec = sky(points.reshape(-1, 2)).T.reshape(2, FINE, FINE)
    middle = ra[FINE // 2, FINE // 2]
    around = (ra - middle + 180.0) % 360.0 - 180.0  # of the middle of the picture
    cut = np.abs(np.gradient(around)).max(axis=0) > 90.0  # opposite to it
    around = np.where(cut, np.nan, around)
    for values, steps, name, first in (
        (around, MERIDIANS_DEG, _hours, middle),
        (dec, PARALLELS_DEG, _degrees, 0.0),
    ):
        if not np.isfinite(values).any():
            continue
        low, high = np.nanmin(values) + first, np.nanmax(values) + first
        if not high > low:
            continue
        step = next((one for one in steps if (high - low) / one <= LINES), steps[-1])
        levels = np.arange(np.ceil(low / step), np.floor(high / step) + 1.0) * step
        if not len(levels):
            continue
        lines = axis.contour(
            x, y, values + first, levels, colors=colour, linewidths=0.6, alpha=0.7, zorder=1,
            linestyles="solid",
        )  # fmt: skip
        before = len(taken)
        for path in lines.get_paths():
            taken = np.vstack([taken, _clear_points(path.vertices, taken, corners)])
        at = taken[before:].tolist()
        labels = axis.clabel(lines, fmt={one: name(one) for one in levels}, fontsize=7, manual=at)
        for one in labels:
            one.set(bbox=BEHIND, alpha=1.0, color=SKY)
    return taken[len(marks) :]


EDGE_WEIGHT = 3.0  # a number is no farther from all marks than so many times from the edge
AT_EDGE = 0.035  # of a picture's size: a line that is all nearer to the edge has no number


def _clear_points(line: Floats, marks: Floats, corners: Floats) -> Floats:
    """Choose the point of a line that is farthest from marks and from the picture's edge, if any.

    Args:
        line: its points, (n, 2)
        marks: points, (m, 2)
        corners: of the picture, (2, 2)

    Returns:
        The point, (1, 2); or (0, 2) if all of the line is at the edge.
    """
    inward = np.abs(line[:, None] - corners).min(axis=(1, 2))
    inner = inward > AT_EDGE * np.abs(corners[1] - corners[0]).min()
    line, inward = line[inner], inward[inner]
    if not len(line):
        return line
    away = np.linalg.norm(line[:, None] - marks, axis=2).min(axis=1)
    best = int(np.argmax(np.minimum(away, EDGE_WEIGHT * inward)))
    return line[best : best + 1]


def _hours(ra_deg: float) -> str:
    """Write a right ascension in hours, minutes and, if there are any, seconds."""
    seconds = round(ra_deg % 360.0 * 240.0) % 86400
    text = f"{seconds // 3600}h{seconds // 60 % 60:02d}m"
    return f"{text}{seconds % 60:02d}s" if seconds % 60 else text


def _degrees(dec_deg: float) -> str:
    """Write a declination in degrees, minutes and, if there are any, seconds."""
    seconds = round(abs(dec_deg) * 3600.0)
    sign = "" if not seconds else "-" if dec_deg < 0.0 else "+"
    text = f"{sign}{seconds // 3600}°"
    if seconds % 3600:
        text += f"{seconds // 60 % 60:02d}'"
    return f'{text}{seconds % 60:02d}"' if seconds % 60 else text
