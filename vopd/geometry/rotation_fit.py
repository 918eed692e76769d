"""Fit the rotation of a camera to landmarks in an ideal image, for a stack of trials."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.geometry.linear import crossing, inverse
from vopd.geometry.rotations import partials_by_turns, rotation_of_directions

SETTLED = 1e-8  # radians, .002 seconds of arc: no flag and no chance depends on less


class Sights(NamedTuple):
    """Sights of T trials: L landmarks and their places in the image."""

    direction: Floats  # (T, L, 3) unit vectors, east, north, up
    image: Floats  # (T, L, 2) image coordinates without distortion
    used: Bools  # (T, L)
    focal_length: float

    def of(self, trials: Bools) -> Sights:
        """Take some of the trials."""
        return self._replace(
            direction=self.direction[trials], image=self.image[trials], used=self.used[trials]
        )

    def equations(self, axes: Floats) -> tuple[Floats, Floats]:
        """Form residuals (T, 2L) and partials (T, 2L, 3) by small turns about the camera's axes.

        Args:
            axes: image x, image y and optical axis as rows, (T, 3, 3), east, north, up
        """
        directions = np.where(self.used[..., None], self.direction, 0.0)
        p, q, r = np.moveaxis(directions @ axes.swapaxes(1, 2), -1, 0)
        x, y = (np.where(self.used, part / r, 0.0) for part in (p, q))
        measured = np.where(self.used[..., None], self.image, 0.0)
        residual = measured - self.focal_length * np.stack([x, y], axis=-1)
        partials = -partials_by_turns(x, y, self.focal_length) * self.used[..., None, None]
        coordinates = (len(self.used), 2 * self.used.shape[1])
        return (
            np.moveaxis(residual, -1, 1).reshape(coordinates),
            np.moveaxis(partials, -2, 1).reshape(*coordinates, 3),
        )


def fit_rotations(
    sights: Sights, axes: Floats, passes: int, settled: float = SETTLED
) -> tuple[Floats, Floats]:
    """Improve camera axes by least squares of the image coordinates, until they settle.

    Args:
        sights: the trials
        axes: where to start, image x, image y and optical axis as rows, (T, 3, 3)
        passes: how many times at most
        settled: a turn that ends a trial, radians

    Returns:
        The axes, (T, 3, 3), and the last turns, (T, 3), radians.
    """
    axes, last = axes.copy(), np.zeros(axes.shape[:2])
    left = np.arange(len(axes))
    for _ in range(passes):
        residual, partials = sights.equations(axes[left])
        across = partials.swapaxes(1, 2)
        turn = (inverse(across @ partials) @ (across @ residual[..., None]))[..., 0]
        last[left] = turn
        axes[left] = _turned(axes[left], np.where(np.isfinite(turn), turn, 0.0))
        moving = np.abs(turn).max(axis=1) >= settled
        if not moving.all():  # nor does a trial move whose turn is not a number
            left, sights = left[moving], sights.of(moving)
        if not len(left):
            break
    return axes, last


def huber_weight(length: Floats, bend: Floats | float) -> Floats:
    """Weigh residuals by Huber's rule: 1 up to the bend, then falling as bend over length.

    Args:
        length: of the residuals, (...)
        bend: in the same unit, positive, broadcast against (...)
    """
    return np.asarray(bend / np.maximum(length, bend))


def closest_axes(sights: Sights) -> Floats:
    """Find the camera axes (T, 3, 3) that bring the directions closest to the rays."""
    focal = np.broadcast_to(sights.focal_length, sights.used.shape)
    ray = np.concatenate([sights.image, focal[..., None]], axis=-1)
    ray = ray / np.linalg.norm(ray, axis=-1, keepdims=True)
    ray, direction = (np.where(sights.used[..., None], v, 0.0) for v in (ray, sights.direction))
    axes, _ = rotation_of_directions(ray, direction)
    return axes


def _turned(axes: Floats, turn: Floats) -> Floats:
    """Turn axes about themselves by small angles; they stay orthogonal (Cayley)."""
    half = turn / 2.0
    square = (half**2).sum(axis=1)[:, None, None]
    along = half[:, :, None] * half[:, None, :]
    turned = (1.0 - square) * np.eye(3) + 2.0 * (along - crossing(half))
    return np.asarray(turned / (1.0 + square) @ axes)
