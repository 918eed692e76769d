"""Fit the rotation of a camera to landmarks in an ideal image, for a stack of trials."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.geometry.linear import crossing, inverse
from vopd.geometry.rotations import nearest_rotation, partials_by_turns

SETTLED = 1e-8  # radians, .002 seconds of arc: no flag and no chance depends on less


class Sights(NamedTuple):
    """What a camera sees in each of T trials: L landmarks and where they are in the image."""

    direction: Floats  # (T, L, 3) unit vectors, east, north, up
    image: Floats  # (T, L, 2) image coordinates without distortion
    used: Bools  # (T, L)
    focal_length: float

    def of(self, trials: Bools) -> Sights:
        """Some of the trials."""
        return self._replace(
            direction=self.direction[trials], image=self.image[trials], used=self.used[trials]
        )

    def equations(self, axes: Floats) -> tuple[Floats, Floats]:
        """Residuals (T, 2L) and partials (T, 2L, 3) by small turns about the camera's axes.

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


class RotationFit(NamedTuple):
    """Camera axes after some passes of Gauss and Newton, and the last turns."""

    axes: Floats  # (T, 3, 3)
    turn: Floats  # (T, 3) radians


def fit_rotations(
    sights: Sights, axes: Floats, passes: int, settled: float = SETTLED
) -> RotationFit:
    """Improve camera axes by least squares of the image coordinates, until they settle.

    Args:
        sights: the trials
        axes: where to start, image x, image y and optical axis as rows, (T, 3, 3)
        passes: how many times at most
        settled: a turn that ends a trial, radians
    """
    fit = RotationFit(axes.copy(), np.zeros(axes.shape[:2]))
    left = np.arange(len(axes))
    for _ in range(passes):
        residual, partials = sights.equations(fit.axes[left])
        across = partials.swapaxes(1, 2)
        turn = (inverse(across @ partials) @ (across @ residual[..., None]))[..., 0]
        fit.turn[left] = turn
        fit.axes[left] = _turned(fit.axes[left], np.where(np.isfinite(turn), turn, 0.0))
        moving = np.abs(turn).max(axis=1) >= settled
        if not moving.all():  # nor does a trial move whose turn is not a number
            left, sights = left[moving], sights.of(moving)
        if not len(left):
            break
    return fit


def closest_axes(sights: Sights) -> Floats:
    """Camera axes (T, 3, 3) by the singular values of the sum over landmarks of ray direction'."""
    focal = np.broadcast_to(sights.focal_length, sights.used.shape)
    ray = np.concatenate([sights.image, focal[..., None]], axis=-1)
    ray = ray / np.linalg.norm(ray, axis=-1, keepdims=True)
    ray, direction = (np.where(sights.used[..., None], v, 0.0) for v in (ray, sights.direction))
    return nearest_rotation(ray.swapaxes(1, 2) @ direction).rotation


def _turned(axes: Floats, turn: Floats) -> Floats:
    """Axes turned about themselves by small angles, kept orthogonal (Cayley)."""
    half = turn / 2.0
    square = (half**2).sum(axis=1)[:, None, None]
    along = half[:, :, None] * half[:, None, :]
    turned = (1.0 - square) * np.eye(3) + 2.0 * (along - crossing(half))
    return np.asarray(turned / (1.0 + square) @ axes)
