"""Whole frames aligned with one another: the turn of the camera from one to the next.

A frame is reduced, the frame before is laid over it with all positions known and the ground at the
landmarks' mean height, and three angles, a gain and a bias are adjusted until both agree, robustly.
After Lucas and Kanade (1981) and Baker and Matthews (2004).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.geometry.lenses import project, ray_of_pixel
from vopd.tracking.scene import FAR, Scene, View, turned_by

FINE_PX = 240  # width of a frame that is reduced for the last rounds
CELLS = 12  # along each side of a frame, each of which gives its points with the largest slopes
POINTS = 5_000
ROUNDS = 12
SETTLED = 0.01  # of a reduced pixel
ROBUST = 4.685  # of the scatter: Tukey's weights
LEAST_SHARED = 0.2  # of the points that must be seen in both frames


@dataclass(frozen=True, eq=False)
class Level:
    """A frame reduced by averaging squares of pixels."""

    grey: Floats  # (h, w)
    factor: int  # pixels of the frame along the side of such a square

    @cached_property
    def slopes(self) -> tuple[Floats, Floats]:
        """The derivatives along u and v, by a reduced pixel."""
        down, right = (np.asarray(one) for one in np.gradient(self.grey))
        return right, down


def reduced(grey: Floats) -> tuple[Level, Level]:
    """Reduce a frame for the alignment, coarse and fine.

    Args:
        grey: (H, W), of any kind of number
    """
    factor = 1
    while grey.shape[1] > 1.5 * FINE_PX * factor:
        factor *= 2
    fine = _mean(grey, factor)
    return Level(_mean(fine, 2), 2 * factor), Level(fine, factor)


def _mean(grey: Floats, factor: int) -> Floats:
    """Average squares of pixels; what is left over at the right and the bottom is cut off."""
    height, width = (side // factor for side in grey.shape)
    rows = grey[: height * factor, : width * factor].reshape(height, factor, width * factor)
    total = rows.sum(axis=1, dtype=np.float32 if grey.dtype.kind == "f" else np.uint32)
    ones = np.full(factor, 1.0 / factor**2, np.float32)
    return np.asarray(total.astype(np.float32).reshape(height, width, factor) @ ones)


class Alignment:
    """The alignment of frames of one video.

    Args:
        scene: all but the attitudes
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._rays: dict[int, Floats] = {}

    def turn(
        self, before: View, old: tuple[Level, Level], after: View, new: tuple[Level, Level]
    ) -> tuple[Floats, float]:
        """Find the attitude of a frame from another frame whose attitude is known.

        Returns:
            The attitude, (3, 3), and the correlation of both frames.
        """
        rotation, likeness = after.rotation, 0.0
        for one, other in zip(old, new, strict=True):
            now = View(after.frame, rotation, after.rate_rad_s, after.velocity_m_s)
            rotation, likeness = self._level(before, one, now, other)
        return rotation, likeness

    def _points(self, level: Level) -> tuple[Floats, Floats]:
        """Choose pixels with large slopes all over a level: their rays, and their grey."""
        key = level.factor
        if key not in self._rays:
            v, u = np.mgrid[: level.grey.shape[0], : level.grey.shape[1]]
            pixel = (np.stack([u, v], axis=-1) + 0.5) * key - 0.5
            self._rays[key] = ray_of_pixel(self._scene.lens, pixel)
        right, down = level.slopes
        steep = np.hypot(right, down)
        side = [max(-(-length // CELLS), 1) for length in steep.shape]
        cells = [-(-length // one) for length, one in zip(steep.shape, side, strict=True)]
        padded = np.full([c * s for c, s in zip(cells, side, strict=True)], -1.0)
        padded[: steep.shape[0], : steep.shape[1]] = steep
        blocks = padded.reshape(cells[0], side[0], cells[1], side[1]).swapaxes(1, 2)
        flat = blocks.reshape(cells[0] * cells[1], side[0] * side[1])
        most = min(max(POINTS // len(flat), 4), flat.shape[1])
        chosen = np.argpartition(-flat, most - 1, axis=1)[:, :most]
        cell = np.arange(len(flat))[:, None]
        row = (cell // cells[1]) * side[0] + chosen // side[1]
        column = (cell % cells[1]) * side[1] + chosen % side[1]
        inside = (row < steep.shape[0]) & (column < steep.shape[1])
        row, column = row[inside], column[inside]
        rays = self._rays[key][row, column]
        known = np.isfinite(rays[:, 0])
        return rays[known], level.grey[row, column][known]

    @np.errstate(all="ignore")
    def _level(self, before: View, old: Level, after: View, new: Level) -> tuple[Floats, float]:
        scene = self._scene
        rays, grey = self._points(old)
        place = scene.camera_m(before.frame, before.rotation)
        direction = rays @ before.rotation
        far = FAR * (1.0 + np.linalg.norm(scene.landmark_m - place, axis=1).max())
        reach = -place[2] / direction[:, 2]  # the site's zero is the landmarks' mean
        reach = np.where((reach > 0.0) & (reach < far), reach, far)
        away = place + direction * reach[:, None] - scene.camera_m(after.frame, after.rotation)
        ray = away @ after.rotation.T
        found = project(scene.lens, ray)
        start, by_turns = found.pixel, found.by_turns
        turn, likeness = np.zeros(3), 0.0
        at = (start + 0.5) / new.factor - 0.5
        by = by_turns / new.factor
        right, down = new.slopes
        height, width = new.grey.shape
        for _ in range(ROUNDS):
            x, y = (at + by @ turn).T
            inside = (x >= 0.0) & (x <= width - 1.001) & (y >= 0.0) & (y <= height - 1.001)
            if inside.sum() < max(LEAST_SHARED * len(grey), 20):
                return after.rotation, 0.0
            weights = _corners(x[inside], y[inside], width)
            seen, slope_u, slope_v = (_sampled(one, *weights) for one in (new.grey, right, down))
            own, here = grey[inside], by[inside]
            moves = slope_u[:, None] * here[:, 0] + slope_v[:, None] * here[:, 1]
            design = np.concatenate([moves, -own[:, None], -np.ones((len(own), 1))], axis=1)
            if not likeness:
                gain, bias = _line(own, seen)
            misfit = seen - gain * own - bias
            scatter = 1.4826 * float(np.median(np.abs(misfit))) + 1e-3
            weight = np.clip(1.0 - (misfit / (ROBUST * scatter)) ** 2, 0.0, None) ** 2
            normal = (design * weight[:, None]).T @ design
            normal[np.diag_indices(5)] *= 1.0 + 1e-6
            try:
                step = np.linalg.solve(normal, -(design * weight[:, None]).T @ misfit)
            except np.linalg.LinAlgError:
                return after.rotation, 0.0
            turn = turn + step[:3]
            gain, bias = gain + step[3], bias + step[4]
            likeness = _correlation(own, seen, weight)
            if np.abs(by[:, :, :] @ step[:3]).max() < SETTLED:
                break
        return turned_by(turn, after.rotation), likeness


def _corners(x: Floats, y: Floats, width: int) -> tuple[Ints, Floats, Floats]:
    """Split places into the index of the pixel before, and the parts of the way to the next."""
    left, top = x.astype(np.int64), y.astype(np.int64)
    return top * width + left, x - left, y - top


def _sampled(grey: Floats, index: Ints, right: Floats, down: Floats) -> Floats:
    """Sample a picture between four pixels."""
    flat, width = grey.ravel(), grey.shape[1]
    upper = flat[index] * (1.0 - right) + flat[index + 1] * right
    lower = flat[index + width] * (1.0 - right) + flat[index + width + 1] * right
    return np.asarray(upper * (1.0 - down) + lower * down)


def _line(x: Floats, y: Floats) -> tuple[float, float]:
    """Fit a gain and a bias."""
    centred = x - x.mean()
    gain = float(centred @ (y - y.mean()) / max(float(centred @ centred), 1e-9))
    return max(gain, 0.2), float(y.mean() - max(gain, 0.2) * x.mean())


def _correlation(x: Floats, y: Floats, weight: Floats) -> float:
    total = max(float(weight.sum()), 1e-9)
    x, y = x - weight @ x / total, y - weight @ y / total
    size = float(np.sqrt(float(weight @ x**2) * float(weight @ y**2)))
    return float(weight @ (x * y)) / max(size, 1e-9)
