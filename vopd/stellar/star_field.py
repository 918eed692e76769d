"""The problem: stars, or ground points, and their images on one photograph."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from vopd.arrays import Bools, Floats, Ints
from vopd.findings import VopdError
from vopd.geometry.vectors import norm
from vopd.stellar.directions import image_directions
from vopd.stellar.failures import Failure

DEGENERATE = 1e-6
"""Sine below which directions coincide or lie in one plane: .2 seconds of arc.

Star positions given to .01 second are 5e-8 radian rough, so that stars closer
to one great circle than this say nothing but their rounding."""

TOO_LARGE = 1e50
"""Coordinates from here on count as not finite, so that no power of theirs overflows."""


@dataclass(frozen=True)
class StarField:
    """Stars, or ground points, and their images: one problem, or a stack of them.

    directions (..., n, 3)     unit vectors in the object frame
    image_mm (..., n, 2)       x, y from the principal point
    focal_length_mm (..., 1)   positive
    used (..., n)              which of the n there are; the others may hold anything
    """

    directions: Floats
    image_mm: Floats
    focal_length_mm: Floats
    used: Bools

    @classmethod
    def of(
        cls,
        directions: ArrayLike,
        image_mm: ArrayLike,
        focal_length_mm: ArrayLike,
        used: ArrayLike = True,
    ) -> StarField:
        """The four of them as arrays of one stack shape.

        The focal length is one number or one a problem (...); `used` is all,
        or (..., n). Raises VopdError where the shapes do not fit or n is 0.
        """
        vectors = np.asarray(directions, dtype=np.float64)
        images = np.asarray(image_mm, dtype=np.float64)
        focal = np.asarray(focal_length_mm, dtype=np.float64)[..., None]
        present = np.asarray(used, dtype=np.bool_)
        if vectors.shape[-1:] != (3,) or images.shape[-1:] != (2,):
            raise VopdError(
                f"directions must be (..., n, 3) and images (..., n, 2), "
                f"not {vectors.shape} and {images.shape}"
            )
        if 0 in (vectors.shape[-2:-1] + images.shape[-2:-1]):
            raise VopdError("a star field needs room for one star at least")
        if not (focal > 0).all():
            raise VopdError("a focal length must be positive")
        try:
            shape = np.broadcast_shapes(
                vectors.shape[:-1], images.shape[:-1], focal.shape, present.shape
            )
            mask = np.broadcast_to(present, shape)
            vectors = np.broadcast_to(vectors, (*shape, 3))
            images = np.broadcast_to(images, (*shape, 2))
            focal = np.broadcast_to(focal, (*shape[:-1], 1))
        except ValueError as error:
            raise VopdError(f"the shapes of a star field do not fit: {error}") from None
        return cls(
            _contained(vectors, mask, [0.0, 0.0, 1.0]),
            _contained(images, mask, [0.0, 0.0]),
            focal,
            mask,
        )

    @property
    def photo(self) -> Floats:
        """P, Q, R of the images (eq. 3.2): (..., n, 3)."""
        return image_directions(self.image_mm, self.focal_length_mm)

    @property
    def count(self) -> Ints:
        """How many stars each problem has: (...)."""
        counts: Ints = self.used.sum(axis=-1)
        return counts

    def select(self, index: Ints) -> StarField:
        """Subsets of the stars as a stack: index (p, k) gives problems (..., p) of k stars."""
        return StarField(
            self.directions[..., index, :],
            self.image_mm[..., index, :],
            np.broadcast_to(
                self.focal_length_mm[..., None, :], (*self.used.shape[:-1], len(index), 1)
            ),
            self.used[..., index],
        )

    def unfit(self, least: int) -> Ints:
        """NOT_FINITE, TOO_FEW_STARS (below `least`) or NONE of each problem: (...)."""
        finite = np.isfinite(self.directions).all(axis=-1) & np.isfinite(self.image_mm).all(axis=-1)
        failure = np.where(self.count < least, Failure.TOO_FEW_STARS, Failure.NONE)
        sound = finite.all(axis=-1) & np.isfinite(self.focal_length_mm[..., 0])
        return np.where(sound, failure, Failure.NOT_FINITE)


def coincide(a: Floats, b: Floats) -> Bools:
    """Whether two directions are one, or opposite: (..., 3) and (..., 3), to (...)."""
    close: Bools = norm(np.cross(a, b)) < DEGENERATE
    return close


def _contained(values: Floats, used: Bools, idle: list[float]) -> Floats:
    """Idle values where a star is not used, NaN where its own are beyond all sense."""
    values = np.where(np.abs(values) < TOO_LARGE, values, np.nan)
    return np.where(used[..., None], values, idle)
