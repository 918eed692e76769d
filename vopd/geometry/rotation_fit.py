"""Fit the rotation of a camera to landmarks in an ideal image, for a stack of trials."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.geometry.linear import crossing, inverse
from vopd.geometry.rotations import ahead, partials_by_turns, rotation_of_directions

SETTLED = 1e-8  # radians, .002 seconds of arc: no flag and no chance depends on less


class Sights(NamedTuple):
    """Sights of T trials: L landmarks and their places in the image."""

    direction: Floats  # (T, L, 3) unit vectors, east, north, up
    image: Floats  # (T, L, 2) image coordinates without distortion
    used: Bools  # (T, L)
    focal_length: Floats | float  # (T, 1) where the trials are of several cameras
    image_by_ray: Floats | None = None  # (T, L, 2, 3) of a lens whose image is none of a plane

    def of(self, trials: Bools) -> Sights:
        """Take some of the trials."""
        by_ray = None if self.image_by_ray is None else self.image_by_ray[trials]
        focal = self.focal_length
        return self._replace(
            direction=self.direction[trials],
            image=self.image[trials],
            used=self.used[trials],
            focal_length=focal[trials] if isinstance(focal, np.ndarray) else focal,
            image_by_ray=by_ray,
        )

    @property
    def ray(self) -> Floats:
        """Trace the image points back to unit vectors in image axes, (T, L, 3)."""
        if self.image_by_ray is None:
            focal = np.broadcast_to(self.focal_length, self.used.shape)
            ray = np.concatenate([self.image, focal[..., None]], axis=-1)
        else:  # a change along the ray itself moves no image
            ray = np.cross(self.image_by_ray[..., 0, :], self.image_by_ray[..., 1, :])
        return np.asarray(ray / np.linalg.norm(ray, axis=-1, keepdims=True))

    def in_front(self, axes: Floats) -> Bools:
        """Mark trials whose landmarks are all on the side of the camera that the image shows.

        Args:
            axes: of the camera, (T, 3, 3)
        """
        front = ahead(axes, self.direction) > 0.0
        if self.image_by_ray is not None:
            front = (self.ray * (self.direction @ axes.swapaxes(1, 2))).sum(axis=-1) > 0.0
        return np.asarray((front | ~self.used).all(axis=1))

    def equations(self, axes: Floats) -> tuple[Floats, Floats]:
        """Form residuals (T, 2L) and partials (T, 2L, 3) by small turns about the camera's axes.

        Args:
            axes: image x, image y and optical axis as rows, (T, 3, 3), east, north, up
        """
        directions = np.where(self.used[..., None], self.direction, 0.0)
        if self.image_by_ray is not None:
            return self._on_the_sphere(directions @ axes.swapaxes(1, 2), self.image_by_ray)
        p, q, r = np.moveaxis(directions @ axes.swapaxes(1, 2), -1, 0)
        x, y = (np.where(self.used, part / r, 0.0) for part in (p, q))
        measured = np.where(self.used[..., None], self.image, 0.0)
        focal = np.asarray(self.focal_length)
        residual = measured - focal[..., None] * np.stack([x, y], axis=-1)
        partials = -partials_by_turns(x, y, focal)
        return self._by_coordinates(residual, partials)

    def _on_the_sphere(self, seen: Floats, by_ray: Floats) -> tuple[Floats, Floats]:
        """Form the equations by the angles between rays and directions, (T, L, 3), in image axes.

        What lies between the two on the sphere is in the image by its derivatives at the ray:
        beside a plane's image it has no edge and no part that is stretched.
        """
        ray = self.ray
        along = (ray * seen).sum(axis=-1)
        across = seen - along[..., None] * ray
        sine = np.linalg.norm(across, axis=-1)
        angle = np.where(sine > 0.0, np.arctan2(sine, along) / np.where(sine > 0.0, sine, 1.0), 1.0)
        residual = -(by_ray @ (across * angle[..., None])[..., None])[..., 0]
        return self._by_coordinates(residual, by_ray @ crossing(seen))

    def _by_coordinates(self, residual: Floats, partials: Floats) -> tuple[Floats, Floats]:
        """Arrange residuals (T, L, 2) and partials (T, L, 2, 3): all x, then all y."""
        residual = np.where(self.used[..., None], residual, 0.0)
        partials = np.where(self.used[..., None, None], partials, 0.0)
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
        axes[left] = turned(axes[left], np.where(np.isfinite(turn), turn, 0.0))
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
    seen = sights.ray, sights.direction
    ray, direction = (np.where(sights.used[..., None], one, 0.0) for one in seen)
    axes, _ = rotation_of_directions(ray, direction)
    return axes


def turned(axes: Floats, turn: Floats) -> Floats:
    """Turn axes about themselves by small angles; they stay orthogonal (Cayley).

    Args:
        axes: as rows, (T, 3, 3)
        turn: radians, (T, 3)
    """
    half = turn / 2.0
    square = (half**2).sum(axis=1)[:, None, None]
    along = half[:, :, None] * half[:, None, :]
    by_turn = (1.0 - square) * np.eye(3) + 2.0 * (along - crossing(half))
    return np.asarray(by_turn / (1.0 + square) @ axes)
