"""Strips of patches: each landmark as it was clicked, and as it was found in other frames.

A patch is turned and stretched by positions, attitude and lens as if it were seen from the first
one's camera: all of a strip are alike if they are of the same point.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePath
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vopd.arrays import Floats
from vopd.attitude.history import History
from vopd.attitude.long_history import frame_landmarks
from vopd.figures.image import Photograph, camera_index
from vopd.figures.style import (
    COLOURS,
    FLAGGED,
    caption,
    name_text,
    plain,
    short_start,
    width_in,
)
from vopd.findings import VopdError
from vopd.geometry.earth import local_axes
from vopd.scene import ImageScene, JobScene

SIDE = 41  # pixels of the first frame along a side of a patch as it is drawn
ALIKE = 25  # of which the middle is compared with the first
COLUMNS, FEWEST, MOST_STRIPS = 12, 4, 12
WIDE_IN = 9.0  # width of a figure with so many columns; a narrower one has fewer
GAP = 12  # pixels between patches: their labels
FRAME_SHOWN = 7  # characters of a frame's name below a patch
LEVELS = 31  # of grey, with which the picture is half as large
CROSS = np.array([[-5, 0], [-2, 0], [2, 0], [5, 0], [0, -5], [0, -2], [0, 2], [0, 5]])
FLAT = 0.1  # sine of the angle below which a line of sight grazes the ground
NO_PATCHES = "no figure of patches: no source has both landmarks picked and their photographs"


class _Patch(NamedTuple):
    """A landmark in a frame."""

    k: int  # index of the frame in the history
    pixel: Floats | None = None  # of a click that is not used
    kind: str = ""  # click, wrong or found


def has_patches(histories: Sequence[History]) -> bool:
    """Tell whether a job is of clicks that were followed through a video.

    Args:
        histories: the jobs
    """
    scenes = (h.estimate.scene() for h in histories if h.estimate.scene is not None)
    return any(scene.clicks is not None and scene.photograph is not None for scene in scenes)


def draw_patches(
    figure: Any, histories: Sequence[History], frame: int | str | None, photograph: Any = None
) -> str:
    """Draw a strip of patches of each landmark: of its first click, and of frames spread evenly.

    Args:
        figure: to draw in
        histories: the jobs, of which the first with photographs is drawn
        frame: as for other figures of one frame; strips are of all
        photograph: reads a photograph; None takes that of the project

    Raises:
        VopdError: where no job has picks and photographs
    """
    for history in histories:
        scene = history.estimate.scene() if history.estimate.scene is not None else None
        read = photograph or (scene.photograph if scene is not None else None)
        if scene is not None and scene.image is not None and read and history.has_attitude.any():
            return _draw(figure, history, scene, read)
    raise VopdError(NO_PATCHES)


def _draw(figure: Any, history: History, scene: JobScene, read: Photograph) -> str:
    from matplotlib.collections import LineCollection
    from matplotlib.patches import Rectangle

    most = max(round(COLUMNS * min(width_in(figure) / WIDE_IN, 1.0)), FEWEST)
    strips = _strips(history, scene, most)
    if not strips:
        raise VopdError(NO_PATCHES)
    shown = list(strips)[:MOST_STRIPS]
    frames = _Frames(history, scene, read)
    columns = max(len(strips[mark]) for mark in shown)
    step = SIDE + GAP
    sheet = np.full((len(shown) * step, columns * step), np.nan)  # between patches the page
    axis = figure.subplots()
    axis.grid(visible=False)
    rows = frame_landmarks(history)
    crosses: list[Floats] = []
    for row, mark in enumerate(shown):
        strip = strips[mark]
        first: Floats | None = None
        low, high = 0.0, 255.0
        for column, one in enumerate(strip):
            place, found = frames.place(one, mark)
            patch = frames.patch(one.k, place, strip[0].k, mark)
            x, y = column * step, row * step
            odd = {history.estimate.landmark_label(n) for n in rows.odd_in(one.k)}
            wrong = one.kind == "wrong" or scene.names[mark] in odd
            told = short_start(PurePath(history.estimate.frame_label(one.k)).stem, FRAME_SHOWN)
            if first is None:
                first = patch
                if np.isfinite(first).any():
                    low, high = np.nanpercentile(first, (1, 99)) + np.array([-20.0, 20.0])
            else:
                told += f"  {_correlation(first, patch):.2f}" if found else " not found"
            scaled = np.clip((patch - low) / max(high - low, 1.0), 0.0, 1.0)
            coarse = np.round(scaled * LEVELS) / LEVELS
            sheet[y : y + SIDE, x : x + SIDE] = np.nan_to_num(245.0 * coarse, nan=255.0)
            colour = FLAGGED if wrong else COLOURS[0] if one.kind == "click" else "0.6"
            width = 2.5 if wrong else 1.6 if one.kind == "click" else 0.6
            box = Rectangle((x - 0.5, y - 0.5), SIDE, SIDE, fc="none", ec=colour, lw=width)
            axis.add_patch(box)
            if found:
                crosses.append(CROSS + np.array([x + SIDE // 2, y + SIDE // 2]))
            axis.text(
                x + SIDE / 2, y + SIDE + 0.5, plain(told), fontsize=6.5, ha="center", va="top",
                color=FLAGGED if wrong else "black", fontweight="bold" if wrong else "normal",
            )  # fmt: skip
    ends = np.concatenate(crosses).reshape(-1, 2, 2)
    axis.add_collection(LineCollection(list(ends), colors="#ffd400", linewidths=0.9))
    axis.imshow(sheet, cmap="gray", vmin=0.0, vmax=255.0, interpolation="none", zorder=0)
    axis.set_yticks([row * step + SIDE / 2 for row in range(len(shown))],
                    [name_text(scene.names[mark], 16) for mark in shown])  # fmt: skip
    axis.set_xticks([])
    axis.set_anchor("N")
    axis.tick_params(length=0)
    for side in axis.spines.values():
        side.set_visible(False)
    more = f"; {len(strips) - len(shown)} landmarks more" if len(strips) > len(shown) else ""
    clicks = "thick blue border: clicks; " if scene.clicks is not None else ""
    return (
        f"{caption([history])}\n{clicks}thickest, red, bold: does not fit; "
        f"not found: where it should be; white: beyond the picture{more}\n"
        "each patch turned and stretched to look like the first; below it the frame, and the "
        "correlation with the first"
    )


def _strips(history: History, scene: JobScene, columns: int) -> dict[int, list[_Patch]]:
    """Choose the patches of each landmark: clicks first, then frames spread evenly."""
    e = history.estimate
    known = np.flatnonzero(history.has_attitude)
    of_scene = {camera_index(history, int(k), scene): int(k) for k in known}
    clicks: dict[int, list[_Patch]] = {}
    if scene.clicks is not None:
        for at, mark, pixel, wrong in zip(*scene.clicks(), strict=True):
            if int(at) in of_scene:
                one = _Patch(of_scene[int(at)], pixel, "wrong" if wrong else "click")
                clicks.setdefault(int(mark), []).append(one)
    spread = known[np.unique(np.linspace(0, len(known) - 1, columns).round().astype(int))]
    if scene.clicks is None:
        assert scene.image is not None
        for k in spread.tolist():
            view = scene.image(*e.frame_key(k))
            for mark in view.landmark.tolist():
                clicks.setdefault(mark, []).append(_Patch(k))
        return dict(sorted(clicks.items()))
    found = {}
    half = (spread[1] - spread[0]) / 2.0 if len(spread) > 1 else 0.0
    for mark, own in sorted(clicks.items()):
        own.sort(key=lambda one: (one.kind != "wrong", one.k))
        strip: dict[int, _Patch] = {}
        for k in spread.tolist():
            near = [one for one in own if abs(one.k - k) <= half and one.k not in strip]
            one = near[0] if near else _Patch(k, None, "found")
            strip.setdefault(one.k, one)
        good = [one for one in own if one.kind == "click"] or own
        first = min(good, key=lambda one: one.k)
        strip.pop(first.k, None)
        found[mark] = [first, *(strip[k] for k in sorted(strip))][:columns]
    return found


class _Frames:
    """The frames that patches are cut from: their views and photographs, each read once."""

    def __init__(self, history: History, scene: JobScene, read: Photograph) -> None:
        self._history, self._scene, self._read = history, scene, read
        self._views: dict[int, ImageScene] = {}
        self._grey: dict[int, NDArray[np.uint8]] = {}

    def view(self, k: int) -> ImageScene:
        """Project the landmarks on the image of a frame."""
        if k not in self._views:
            assert self._scene.image is not None
            self._views[k] = self._scene.image(*self._history.estimate.frame_key(k))
        return self._views[k]

    def grey(self, k: int) -> NDArray[np.uint8]:
        """Read the photograph of a frame, (H, W), 0 to 255."""
        if k not in self._grey:
            picture = self._read(*self._history.estimate.frame_key(k)).convert("L")
            self._grey[k] = np.asarray(picture)
        return self._grey[k]

    def place(self, one: _Patch, mark: int) -> tuple[Floats, bool]:
        """Find where a landmark is in a frame, (2,): as clicked or found, or else as computed."""
        if one.pixel is not None:
            return one.pixel, True
        view = self.view(one.k)
        own = np.flatnonzero((view.landmark == mark) & np.isfinite(view.pixel).all(axis=1))
        return (view.pixel[own[0]], True) if len(own) else (view.computed[mark], False)

    def _matrix(self, k: int, first: int, mark: int) -> Floats:
        """Find the shift in a frame of a shift in the first one on the ground, (2, 2)."""
        scene = self._scene
        mark_m = scene.landmark_m[mark]
        here, there = self.view(first), self.view(k)
        start_m, end_m = (
            scene.camera_m[camera_index(self._history, one, scene)] for one in (first, k)
        )
        from_local, to_local = (local_axes(one[None])[0] for one in (start_m, end_m))
        up = local_axes(mark_m[None])[0][2]
        away = mark_m - start_m
        if abs(away @ up) < FLAT * np.linalg.norm(away):
            up = away
        middle = here.computed[mark]
        pixels = middle + np.array([[0.0, 0.0], [8.0, 0.0], [0.0, 8.0]])
        ray = here.direction_of(pixels) @ from_local
        ground = start_m + ray * ((away @ up) / (ray @ up))[:, None]
        seen = there.pixel_of((ground - end_m) @ to_local.T)
        return np.asarray((seen[1:] - seen[0]).T / 8.0)

    def patch(self, k: int, place: Floats, first: int, mark: int) -> Floats:
        """Cut a patch, (SIDE, SIDE), as the first frame would see it; NaN beyond the picture."""
        from scipy.ndimage import map_coordinates

        half = SIDE // 2
        v, u = np.mgrid[-half : half + 1, -half : half + 1]
        at = place + np.stack([u, v], axis=-1) @ self._matrix(k, first, mark).T
        if not np.isfinite(at).all():
            return np.full((SIDE, SIDE), np.nan)
        where = at[..., ::-1].transpose(2, 0, 1)
        return np.asarray(map_coordinates(self.grey(k), where, float, order=1, cval=np.nan))


def _correlation(first: Floats, patch: Floats) -> float:
    """Correlate the middles of two patches; NaN where one has no contrast."""
    edge = (SIDE - ALIKE) // 2
    some = slice(edge, SIDE - edge)
    both = np.stack([one[some, some].ravel() for one in (first, patch)])
    both = both[:, np.isfinite(both).all(axis=0)]
    if not both.size:
        return float("nan")
    a, b = both - both.mean(axis=1, keepdims=True)
    size = float(np.sqrt((a @ a) * (b @ b)))
    return float(a @ b) / size if size > 0.0 else float("nan")
