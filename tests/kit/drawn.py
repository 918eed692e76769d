"""A figure as lines of text that show all that is drawn in it: what, where, and how it looks.

Coordinates have four to five digits of the width or height of their panel, so that they are the
same on each processor; of long lines their ends, extremes and means are shown.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.collections import Collection, PathCollection
from matplotlib.colors import to_hex
from matplotlib.image import AxesImage
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.quiver import Quiver, QuiverKey
from matplotlib.table import Table
from matplotlib.text import Annotation, Text

SHOWN = 12  # points of a line that are all shown
Scale = tuple[int, int]
"""Decimals that are shown along x and y; negative: digits, along a logarithmic scale."""


def described(figure: Any) -> list[str]:
    """Describe a figure."""
    width, height = figure.get_size_inches()
    return [f"figure {width:.2f} x {height:.2f} in", *_part(figure)]


def _part(figure: Any) -> Iterator[str]:
    """Describe a figure, or a part of one."""
    if figure.get_suptitle():
        yield f"title {figure._suptitle.get_fontsize():g} pt"
        yield from (f"  {line}" for line in figure.get_suptitle().split("\n"))
    for one in figure.subfigs:
        box = one.bbox.transformed(figure.transSubfigure.inverted())
        yield f"part from {box.y0:.3f} to {box.y1:.3f}"
        yield from _part(one)
    for one in figure.legends:
        yield from _legend(one)
    for axis in () if figure.subfigs else figure.axes:
        yield from _panel(axis)


def _panel(axis: Any) -> Iterator[str]:
    """Describe a panel: its place and its axes, and all that is drawn in it."""
    place = axis.get_subplotspec()
    grid, rows, columns = place.get_gridspec(), place.rowspan, place.colspan
    high, wide = (
        [round(float(part), 3) for part in one]
        for one in (grid.get_height_ratios(), grid.get_width_ratios())
    )
    sides = [side for side, one in axis.spines.items() if one.get_visible()]
    along = axis.get_shared_x_axes(), axis.get_shared_y_axes()
    yield (
        f"panel {rows.start} to {rows.stop} of {high}, {columns.start} to {columns.stop} of {wide},"
        f" aspect {axis.get_aspect()}, {axis.get_anchor()}, shared by "
        f"{[len(each.get_siblings(axis)) for each in along]}, {sides if axis.axison else 'no axes'}"
    )
    titles = (axis._left_title, axis.title, axis._right_title)
    yield from (f"  title {_text(one)}" for one in titles if one.get_text())
    for name, one in (("x", axis.xaxis), ("y", axis.yaxis)) if axis.axison else ():
        yield f"  {name} {_scale(one)}"
    scale = tuple(_decimals(one) for one in (axis.xaxis, axis.yaxis))
    other = {id(one) for one in (*titles, axis.patch, axis.xaxis, axis.yaxis)}
    other |= {id(one) for one in axis.spines.values()}
    drawn = [one for one in axis.get_children() if id(one) not in other]
    for look, alike in groupby(drawn, lambda one: _area(one) if isinstance(one, Patch) else one):
        if isinstance(look, Legend):
            yield from (f"  {line}" for line in _legend(look))
        elif isinstance(look, Artist):
            yield f"  {_artist(look, axis, scale)}"
        else:
            corners = np.vstack([_corners(one) for one in alike])
            yield f"  {look}: {_points(corners, scale)}"


def _corners(one: Any) -> Any:
    """The corners of an area; of an upright rectangle, two."""
    corners = one.get_path().transformed(one.get_patch_transform()).vertices
    ends = np.stack([corners.min(axis=0), corners.max(axis=0)])
    return ends if (corners[:, None] == ends).any(axis=1).all() else corners


def _scale(one: Any) -> str:
    """Describe an axis: its label, scale and limits, and the numbers along it."""
    ends, decimals = one.get_view_interval(), _decimals(one)
    (low, high), rim = sorted(ends), 1e-6 * abs(ends[1] - ends[0])  # a number at an end may be cut
    at = [tick for tick in one.get_majorticklocs() if low + rim < tick < high - rim]
    texts = one.get_major_formatter().format_ticks(at)
    text = (
        f"{_line(one.get_label_text())} {one.label.get_fontsize():g} pt {one.get_scale()} "
        f"{' '.join(_number(end, decimals) for end in ends)}: "
        f"{' '.join(_number(tick, decimals) for tick in at)}: {' | '.join(map(_line, texts))}"
    )
    for tick in one.get_major_ticks(len(at))[:1]:
        label, mark, grid = tick.label1, tick.tick1line, tick.gridline
        text += f" {label.get_fontsize():g} pt turned {label.get_rotation():g}"
        text += "" if label.get_visible() else ", no labels"
        text += f", marks {mark.get_markersize():g}" if mark.get_visible() else ", no marks"
        text += f", grid {grid.get_alpha()}" if grid.get_visible() else ", no grid"
    return text


def _line(text: str) -> str:
    return text.replace("\n", "/")


def _decimals(one: Any) -> int:
    """Choose how many decimals show a ten-thousandth of an axis."""
    low, high = one.get_view_interval()
    if one.get_scale() == "log":
        return -5
    span = abs(high - low) * 1.003  # whose digits are the same on any processor
    return max(int(4 - np.floor(np.log10(span))), 0) if span > 0.0 else 4


def _number(value: float, decimals: int) -> str:
    """Write a number, and one halfway between two of these decimals alike on any processor."""
    if not np.isfinite(value):
        return str(value)
    if decimals < 0:
        return f"{value * (1.0 + 3e-9):#.{-decimals}g}"
    return f"{round(value + 0.00317 * 10.0**-decimals, decimals) + 0.0:.{decimals}f}"


def _points(points: Any, scale: Scale | tuple[int, ...] = (2, 2)) -> str:
    """Write points (n, 2): all of them, or ends, extremes and means."""
    points = np.ma.filled(np.ma.asarray(points, dtype=float), np.nan).reshape(-1, 2)
    if len(points) <= SHOWN:
        return " ".join(f"({_number(x, scale[0])} {_number(y, scale[1])})" for x, y in points)
    gaps = ~np.isfinite(points).all(axis=1)
    text = f"{len(points)} points" + ("" if not gaps.any() else f", {gaps.sum()} missing, first ")
    text += " ".join(map(str, np.flatnonzero(gaps)[:6]))
    if gaps.all():
        return text
    known = points[~gaps]
    turned = known * np.cos(np.arange(len(known)))[:, None]
    told = (known[0], known[-1], known.min(0), known.max(0), known.mean(0), turned.mean(0))
    return f"{text}: {_points(told, scale)}"


def _colour(colour: Any) -> str:
    """Write a colour, or the first of several."""
    if isinstance(colour, str):
        return colour if colour == "none" else to_hex(colour, keep_alpha=True)
    each = np.atleast_2d(np.asarray(colour, float))
    found = dict.fromkeys(to_hex(one, keep_alpha=True) for one in each if each.size)
    return "/".join(list(found)[:4]) or "none"


def _common(one: Artist) -> str:
    """Describe what artists of each kind have."""
    text, label = f"z {one.get_zorder():g}", str(one.get_label())
    text += f" {_line(label)!r}" if label and not label.startswith("_") else ""
    text += "" if one.get_alpha() is None else f" alpha {one.get_alpha():g}"
    text += " rasterized" if one.get_rasterized() else ""
    for effect in one.get_path_effects() or ():
        look = effect._gc  # type: ignore[attr-defined]
        text += f" outlined {look['linewidth']:g} {look['foreground']}"
    return text


def _text(one: Any) -> str:
    """Describe a text and its ground."""
    text = f"{_line(one.get_text())!r} {one.get_fontsize():g} pt {one.get_fontweight()} "
    text += f"{_colour(one.get_color())} {one.get_ha()} {one.get_va()}"
    text += f" turned {one.get_rotation():.0f}" if one.get_rotation() else ""
    if ground := one.get_bbox_patch():
        text += f" on {_look(ground)} {ground.get_boxstyle().pad:.2f}"
    return text


def _note(one: Any, scale: Scale) -> str:
    """Describe a text beside a point, or an arrow to one."""
    aside = np.asarray(one.xyann, float)
    if one.anncoords != "offset points":
        away = f"from {_points(aside, scale)}"
    elif one.get_zorder() == 6.0 and aside[0]:  # half as wide as its letters, and more
        away = f"{'right' if aside[0] > 0.0 else 'left'} up {aside[1]:.2f}"
    else:
        away = f"aside {_points(aside)}"
    at = _points(one.xy, scale if one.xycoords == "data" else (2, 2))
    text = f"note {_text(one)} {one.xycoords} {at} {away} {_common(one)}"
    text += " inside" if one.get_annotation_clip() else ""
    if one.arrow_patch is not None:
        kind = type(one.arrow_patch.get_arrowstyle()).__name__
        text += f" {kind} {_look(one.arrow_patch)} {_common(one.arrow_patch)}"
    return text


def _artist(one: Any, axis: Any, scale: Scale) -> str:
    """Describe what is drawn in a panel."""
    of_data = one.get_transform() == axis.transData
    if isinstance(one, Annotation):
        return _note(one, scale)
    if isinstance(one, Text):
        at = _points(one.get_position(), scale if of_data else (3, 3))
        return f"text {_text(one)} {at} {_common(one)}"
    if isinstance(one, Line2D):
        every = "" if one.get_markevery() in (None, 1) else f" at {one.get_markevery()}"
        return f"line {_marks(one)}{every} {_common(one)}: {_points(one.get_xydata(), scale)}"
    if isinstance(one, Table):
        return _table(one)
    if isinstance(one, Quiver):
        begin, by = np.column_stack([one.X, one.Y]), np.column_stack([one.U, one.V]) / one.scale
        look = f"{_colour(one.get_facecolor())} {one.width} {one.angles} {one.scale_units}"
        text = f"arrows {look} scale {one.scale:.6g} {_common(one)}"
        return f"{text}: {_points(begin, scale)} by {_points(by, scale)}"
    if isinstance(one, QuiverKey):
        where = f"{one.X:g} {one.Y:g} {one.coord} {one.labelpos}"
        return f"key {_text(one.text)} {one.U:.6g} at {where} {_common(one)}"
    if isinstance(one, Collection):
        return f"{_collection(one, scale)} {_common(one)}"
    if isinstance(one, AxesImage):
        data = np.asarray(one.get_array(), float)
        turned = data * np.cos(np.arange(data.size)).reshape(data.shape)
        look = f"{one.origin} {one.get_interpolation()} {_points(one.get_extent(), scale)}"
        if data.ndim == 2:
            look += f" {one.get_cmap().name} {one.get_clim()}"
        mean, other = np.nanmean(data), np.nanmean(turned)
        return f"image {data.shape} {mean:.1f} {100.0 * other:.0f} {look} {_common(one)}"
    return f"{type(one).__name__} {_common(one)}"


def _marks(one: Any) -> str:
    """Describe the look of a line and its marks."""
    text = f"{_colour(one.get_color())} {one.get_linestyle()} {one.get_linewidth():g}"
    text += "" if one.get_solid_capstyle() == "projecting" else f" {one.get_solid_capstyle()}"
    if one.get_marker() in ("", "None", None):
        return text
    colours = f"{_colour(one.get_markerfacecolor())} {_colour(one.get_markeredgecolor())}"
    size = f"{one.get_markersize():g} {one.get_markeredgewidth():g}"
    return f"{text} marks {one.get_marker()!r} {size} {colours}"


def _look(one: Any) -> str:
    """Describe the look of an area."""
    colours = f"{_colour(one.get_facecolor())} edge {_colour(one.get_edgecolor())}"
    return f"{colours} {one.get_linestyle()} {one.get_linewidth():g}"


def _area(one: Any) -> str:
    return f"area {_look(one)} {_common(one)}"


def _table(one: Any) -> str:
    """Describe a table: its look, and the texts of its rows."""
    cells = one.get_celld()
    each = {
        f"{cell.get_fontsize():g} pt, {cell.get_height():.4f}, {cell.visible_edges}, {cell._loc}"
        for cell in cells.values()
    }
    lines = [f"table {one._loc} {' and '.join(sorted(each))}"]
    for row in sorted({row for row, _ in cells}):
        columns = sorted(column for own, column in cells if own == row)
        texts = (_line(cells[row, column].get_text().get_text()) for column in columns)
        lines.append(" | ".join(texts))
    return "\n    ".join(lines)


def _collection(one: Any, scale: Scale) -> str:
    """Describe several marks, lines or areas of one look."""
    widths = " ".join(f"{wide:g}" for wide in np.unique(one.get_linewidth()))
    dashed = "" if all(dashes is None for _, dashes in one.get_linestyle()) else " dashed"
    look = f"{_colour(one.get_facecolor())} edge {_colour(one.get_edgecolor())} {widths}{dashed}"
    if isinstance(one, PathCollection):
        sizes = np.unique(one.get_sizes()).tolist()
        return f"marks {look} {sizes}: {_points(one.get_offsets(), scale)}"
    if hasattr(one, "levels"):
        return f"contours {look}: {' '.join(f'{level:.5f}' for level in one.levels)}"
    parts = [path.vertices for path in one.get_paths()]
    return f"{len(parts)} parts {look}: {_points(np.vstack([np.zeros((0, 2)), *parts]), scale)}"


def _legend(one: Any) -> Iterator[str]:
    """Describe a legend."""
    where = getattr(one, "_outside_loc", None) or one._loc
    title, frame = one.get_title().get_text(), "framed" if one.get_frame_on() else "no frame"
    box = one.get_bbox_to_anchor().transformed(
        one.parent.transSubfigure.inverted() if not one.isaxes else one.axes.transAxes.inverted()
    )
    at = _points((box.x0, box.y0), (3, 3))
    columns = f"{one._ncols} columns {one._alignment}"
    yield f"legend {title!r} at {where} of {at}, {columns}, {frame}, {one.borderaxespad:g}"
    for handle, text in zip(one.legend_handles, one.get_texts(), strict=True):
        look = _marks(handle) if isinstance(handle, Line2D) else ""
        look = _look(handle) if isinstance(handle, Patch) else look
        if isinstance(handle, Collection):
            look = f"{_colour(handle.get_facecolor())} edge {_colour(handle.get_edgecolor())}"
        alpha = "" if handle.get_alpha() is None else f" alpha {handle.get_alpha():g}"
        yield f"  {_line(text.get_text())!r} {text.get_fontsize():g} pt: {look}{alpha}"
