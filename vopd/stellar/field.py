"""Stars, or ground points, and their images: the problem that every method solves."""

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

Star positions given to .01 second are rough by 5e-8 radian, so that stars closer
to one great circle than this tell nothing but their rounding."""

TOO_LARGE = 1e50
"""Coordinates from here on count as not finite, so that no power of theirs overflows."""


@dataclass(frozen=True)
class StarField:
    """Stars, or ground points, and their images: one problem, or a stack of them.

    Attributes:
        directions: unit vectors to the stars in object axes, (..., n, 3)
        image_mm: x, y of their images from the principal point, (..., n, 2), mm (or
            any other unit, which then is that of every `_mm` here)
        focal_length_mm: principal distance, positive, (..., 1), mm
        used: which of the n stars a problem has, (..., n); the others may hold anything
        errors: covariance matrices of x and y for a reading sigma of 1, (..., n, 2, 2);
            None: the identity, errors of all coordinates alike
    """

    directions: Floats
    image_mm: Floats
    focal_length_mm: Floats
    used: Bools
    errors: Floats | None = None

    @classmethod
    def of(
        cls,
        directions: ArrayLike,
        image_mm: ArrayLike,
        focal_length_mm: ArrayLike,
        used: ArrayLike = True,
        errors: ArrayLike | None = None,
    ) -> StarField:
        """Make a star field of arrays whose stack shapes broadcast against each other.

        Args:
            directions: unit vectors to the stars, (..., n, 3)
            image_mm: x, y from the principal point, (..., n, 2), mm
            focal_length_mm: principal distance, one number or one a problem (...), mm
            used: which stars there are: all, or (..., n)
            errors: covariance matrices of x and y for a reading sigma of 1,
                (..., n, 2, 2); None: errors of all coordinates alike

        Returns:
            The field, with all as arrays of one stack shape.

        Raises:
            VopdError: the shapes do not fit, n is 0, or a principal distance is not positive.
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
            raise VopdError("a star field needs one star at least")
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
            if errors is not None:
                errors = np.broadcast_to(np.asarray(errors, dtype=np.float64), (*shape, 2, 2))
        except ValueError as error:
            raise VopdError(f"the shapes of a star field do not fit: {error}") from None
        return cls(
            _contained(vectors, mask, [0.0, 0.0, 1.0]),
            _contained(images, mask, [0.0, 0.0]),
            focal,
            mask,
            errors,
        )

    @property
    def photo(self) -> Floats:
        """Unit vectors P, Q, R of the images in camera axes, (..., n, 3); 0 if not used."""
        directions = image_directions(self.image_mm, self.focal_length_mm)
        return np.where(self.used[..., None], directions, 0.0)

    @property
    def count(self) -> Ints:
        """How many stars each problem has, (...)."""
        counts: Ints = self.used.sum(axis=-1)
        return counts

    def select(self, index: Ints) -> StarField:
        """Subsets of the stars as a stack of problems.

        Args:
            index: numbers of the stars, counted from 0, of p subsets of k stars, (p, k)

        Returns:
            The subsets, a stack (..., p) of problems of k stars.
        """
        return StarField(
            self.directions[..., index, :],
            self.image_mm[..., index, :],
            np.broadcast_to(
                self.focal_length_mm[..., None, :], (*self.used.shape[:-1], len(index), 1)
            ),
            self.used[..., index],
            None if self.errors is None else self.errors[..., index, :, :],
        )

    def only(self, stars: Ints | Bools) -> StarField:
        """The same problems with only some of their stars, given by number or by a mask (n,)."""
        return StarField(
            self.directions[..., stars, :],
            self.image_mm[..., stars, :],
            self.focal_length_mm,
            self.used[..., stars],
            None if self.errors is None else self.errors[..., stars, :, :],
        )

    def flat(self) -> StarField:
        """The same problems with the stack as one axis."""
        n = self.used.shape[-1]
        return StarField(
            self.directions.reshape(-1, n, 3),
            self.image_mm.reshape(-1, n, 2),
            self.focal_length_mm.reshape(-1, 1),
            self.used.reshape(-1, n),
            None if self.errors is None else self.errors.reshape(-1, n, 2, 2),
        )

    def take(self, problems: Ints | Bools) -> StarField:
        """Some of the problems of a stack, chosen along its first axis."""
        return StarField(
            self.directions[problems],
            self.image_mm[problems],
            self.focal_length_mm[problems],
            self.used[problems],
            None if self.errors is None else self.errors[problems],
        )

    def whitened(self, values: Floats) -> Floats:
        """Image coordinates in terms of their standard deviations, without correlation.

        Args:
            values: anything with the axes x and y, (..., n, 2) or (..., n, 2, k)

        Returns:
            The same shape; errors of these values have the reading sigma alone.
        """
        if self.errors is None:
            return values
        root = np.linalg.inv(np.linalg.cholesky(self.errors))
        if values.ndim == self.errors.ndim:
            return np.asarray(root @ values)
        return np.asarray(np.einsum("...ij,...j->...i", root, values))

    def unfit(self, least: int) -> Ints:
        """Codes for problems that no method can solve.

        Args:
            least: how many stars the method needs

        Returns:
            `Failure.NOT_FINITE`, `Failure.TOO_FEW_STARS` or `Failure.NONE`, (...).
        """
        finite = np.isfinite(self.directions).all(axis=-1) & np.isfinite(self.image_mm).all(axis=-1)
        failure = np.where(self.count < least, Failure.TOO_FEW_STARS, Failure.NONE)
        sound = finite.all(axis=-1) & np.isfinite(self.focal_length_mm[..., 0])
        return np.where(sound, failure, Failure.NOT_FINITE)


def coincide(a: Floats, b: Floats) -> Bools:
    """Whether two unit vectors (..., 3) are the same direction, or opposite, (...)."""
    close: Bools = norm(np.cross(a, b)) < DEGENERATE
    return close


def _contained(values: Floats, used: Bools, idle: list[float]) -> Floats:
    """Replace values of stars that are not used, and make absurdly large ones NaN."""
    values = np.where(np.abs(values) < TOO_LARGE, values, np.nan)
    return np.where(used[..., None], values, idle)
