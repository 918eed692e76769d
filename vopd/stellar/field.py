"""Stars, or ground points, and their images: the problem that every method solves."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np
from numpy.typing import ArrayLike

from vopd.arrays import Bools, Floats, Ints
from vopd.findings import VopdError, numbers, refuse_other_kind
from vopd.geometry.linear import norm, unit
from vopd.records import Rows

# Unit vectors of images, stars and ground points
#
# Camera axes: x and y are those of the photograph (a positive, held in front of
# the lens), z points backward, so that the camera looks along -z and the third
# component R of every image is negative. Object axes: for stars U points to
# right ascension 0, declination 0, and W to the celestial pole; for ground points
# they are the axes of the points' coordinates.


def image_directions(image_mm: Floats, focal_length_mm: Floats | float) -> Floats:
    """Convert images to unit vectors P, Q, R in camera axes.

    Args:
        image_mm: x, y from the principal point, (..., 2), mm
        focal_length_mm: principal distance, positive, broadcast against (...), mm

    Returns:
        Unit vectors, (..., 3).

    Source: Rae (1987), eq. 3.2.
    """
    x, y = image_mm[..., 0], image_mm[..., 1]
    minus_f = np.broadcast_to(-np.asarray(focal_length_mm, dtype=float), x.shape)
    return unit(np.stack([x, y, minus_f], axis=-1))


def image_points_mm(camera_vectors: Floats, focal_length_mm: Floats | float) -> Floats:
    """Project directions in camera axes to image coordinates.

    Args:
        camera_vectors: vectors in camera axes, any length, (..., 3)
        focal_length_mm: principal distance, positive, broadcast against (...), mm

    Returns:
        x, y, (..., 2), mm; not finite at right angles to the optical axis. A
        vector behind the camera (z >= 0) gets the image of its opposite, as in
        program STARS: test the sign of z.

    Source: Rae (1987), eqs. 2.1 and 2.2.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = -np.asarray(focal_length_mm, dtype=float) / camera_vectors[..., 2]
        points: Floats = camera_vectors[..., :2] * scale[..., None]
    return points


def star_directions(ra_deg: ArrayLike, dec_deg: ArrayLike) -> Floats:
    """Convert right ascension and declination to unit vectors U, V, W in celestial axes.

    Args:
        ra_deg: right ascension, (...), degrees
        dec_deg: declination, (...), degrees, -90 to 90

    Returns:
        Unit vectors, (..., 3).

    Raises:
        VopdError: where they are no numbers, or not as many

    Source: Rae (1987), eq. 2.5.
    """
    both = numbers(ra_deg, "ra_deg"), numbers(dec_deg, "dec_deg")
    try:
        alpha, delta = np.broadcast_arrays(*map(np.radians, both))
    except ValueError:
        shapes = " and ".join(str(one.shape) for one in both)
        raise VopdError(f"ra_deg and dec_deg must have as many stars, not {shapes}") from None
    return np.stack(
        [np.cos(alpha) * np.cos(delta), np.sin(alpha) * np.cos(delta), np.sin(delta)], axis=-1
    )


def right_ascension_declination_deg(directions: Floats) -> tuple[Floats, Floats]:
    """Convert directions in celestial axes to right ascension and declination.

    Args:
        directions: vectors of any length, (..., 3)

    Returns:
        Right ascension, (...), degrees, -180 to 180 as program RADEC2 prints it,
        and declination, (...), degrees, -90 to 90.
    """
    u, v, w = (directions[..., k] for k in range(3))
    return np.degrees(np.arctan2(v, u)), np.degrees(np.arctan2(w, np.hypot(u, v)))


def ground_directions(points_m: Floats, camera_m: Floats) -> Floats:
    """Find the unit vectors U, V, W from the camera to ground points.

    Args:
        points_m: positions of the points, (..., n, 3), metres, rectangular axes
        camera_m: position of the camera in the same axes, (..., 3), metres

    Returns:
        Unit vectors, (..., n, 3); NaN for a point at the camera.

    Source: Rae (1987), eq. 5.1.
    """
    return unit(points_m - np.asarray(camera_m, dtype=float)[..., None, :])


# Reasons of failure


class Failure(IntEnum):
    """The reason why a problem has no solution; `NONE` if it has one."""

    NONE = 0
    NOT_FINITE = 1
    TOO_FEW_STARS = 2
    SAME_STAR = 3
    GREAT_CIRCLE = 4
    PRINCIPAL_POINT = 5
    NO_ROTATION = 6
    AXIS_IN_PLANE = 7
    SINGULAR = 8
    NO_CONVERGENCE = 9
    BEHIND_CAMERA = 10
    NOT_A_ROTATION = 11
    TOO_UNCERTAIN = 12


REASONS = {
    Failure.NOT_FINITE: "a coordinate is not a finite number",
    Failure.TOO_FEW_STARS: "too few stars",
    Failure.SAME_STAR: "the same star twice: two directions, or two images, coincide",
    Failure.GREAT_CIRCLE: "the stars, or their images, lie on one great circle",
    Failure.PRINCIPAL_POINT: "an image at the principal point, where weight wR (eq. 3.17) is "
    "infinite",
    Failure.NO_ROTATION: "the rotation is zero, or a star lies on its axis",
    Failure.AXIS_IN_PLANE: "the rotation axis lies in the plane of the two stars",
    Failure.SINGULAR: "the stars leave the attitude undetermined, or every weight is zero",
    Failure.NO_CONVERGENCE: "no convergence",
    Failure.BEHIND_CAMERA: "a star lies behind the camera in the solution",
    Failure.NOT_A_ROTATION: "the matrix as solved is far from a rotation: the stars lie too near "
    "one great circle for the errors of their images",
    Failure.TOO_UNCERTAIN: "the stars do not determine the attitude with readings of this accuracy",
}
"""What each code means, as the end of a sentence."""


def first_failure(*failures: Ints) -> Ints:
    """Choose for each problem the first of several codes that is not `NONE`."""
    worst = failures[-1]
    for failure in reversed(failures[:-1]):
        worst = np.where(failure != Failure.NONE, failure, worst)
    return worst


def when(condition: Bools | np.bool_, failure: Failure) -> Ints:
    """Fill an array with one code where a condition holds, and with `NONE` elsewhere."""
    return np.where(condition, failure, Failure.NONE)


# The star field

DEGENERATE = 1e-6
"""Sine below which directions coincide or lie in one plane: .2 seconds of arc.

Star positions given to .01 second are rough by 5e-8 radian, so that stars closer
to one great circle than this tell nothing but their rounding."""

TOO_LARGE = 1e50
"""Coordinates from here on count as not finite, so that no power of theirs overflows."""


@dataclass(frozen=True, eq=False, repr=False)
class StarField(Rows):
    """Stars, or ground points, and their images: one problem, or a stack of them.

    `take` has some of the problems of a stack, along its first axis.

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
            VopdError: the shapes do not fit, n is 0, a principal distance is not positive,
                something is no number, or errors are no covariance matrices.
        """
        vectors, images = numbers(directions, "directions"), numbers(image_mm, "image_mm")
        focal = numbers(focal_length_mm, "focal_length_mm")[..., None]
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
                errors = np.broadcast_to(numbers(errors, "errors"), (*shape, 2, 2))
        except ValueError:
            raise VopdError(
                "the shapes of a star field do not fit: directions "
                f"{vectors.shape}, images {images.shape}, focal lengths {focal.shape}, "
                f"used {present.shape}"
            ) from None
        if errors is not None:
            errors = np.where(mask[..., None, None], errors, np.eye(2))
            if not ((errors[..., 0, 0] > 0.0) & (np.linalg.det(errors) > 0.0)).all():
                raise VopdError("the errors of a star field must be covariance matrices of x and y")
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

    def select(self, stars: Ints | Bools) -> StarField:
        """Select some of the stars of each problem, or subsets of them as a stack of problems.

        Args:
            stars: numbers counted from 0, (k,), a mask (n,), or p subsets of k numbers, (p, k)

        Returns:
            Problems of k stars, a stack (...); with subsets a stack (..., p).
        """
        focal = self.focal_length_mm
        if stars.ndim == 2:
            focal = np.broadcast_to(focal[..., None, :], (*focal.shape[:-1], len(stars), 1))
        return StarField(
            self.directions[..., stars, :],
            self.image_mm[..., stars, :],
            focal,
            self.used[..., stars],
            None if self.errors is None else self.errors[..., stars, :, :],
        )

    def select_each(self, stars: Ints) -> StarField:
        """Select other stars in each problem of a stack.

        Args:
            stars: numbers counted from 0, (..., k)
        """
        errors = self.errors
        if errors is not None:
            errors = np.take_along_axis(errors, stars[..., None, None], axis=-3)
        return StarField(
            np.take_along_axis(self.directions, stars[..., None], axis=-2),
            np.take_along_axis(self.image_mm, stars[..., None], axis=-2),
            self.focal_length_mm,
            np.take_along_axis(self.used, stars, axis=-1),
            errors,
        )

    def problems(self) -> Iterator[StarField]:
        """Iterate over the problems of a stack (p,), each without a stack axis."""
        for k in range(len(self.used)):
            yield replace(self, **{name: value[k] for name, value in self.by_row().items()})

    @classmethod
    def stack(cls, fields: Sequence[StarField]) -> StarField:
        """Stack single problems of as many stars, which all state errors, or none does."""
        own = [one.by_row() for one in fields]
        return replace(fields[0], **{name: np.stack([one[name] for one in own]) for name in own[0]})

    @classmethod
    def stacks(cls, fields: Sequence[StarField]) -> Iterator[tuple[list[int], StarField]]:
        """Stack single problems, those of as many stars together; with their indices."""
        alike: dict[tuple[int, bool], list[int]] = {}
        for k, one in enumerate(fields):
            alike.setdefault((one.used.shape[-1], one.errors is None), []).append(k)
        for indices in alike.values():
            yield indices, cls.stack([fields[k] for k in indices])

    def flat(self) -> StarField:
        """Flatten the stack to one axis."""
        stack = self.used.ndim - 1
        arrays = self.by_row().items()
        return replace(self, **{name: a.reshape(-1, *a.shape[stack:]) for name, a in arrays})

    def whitened(self, values: Floats) -> Floats:
        """Divide image coordinates by their standard deviations, without correlation.

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
        """Find the problems that no method can solve.

        Returns:
            `Failure.NOT_FINITE`, `Failure.TOO_FEW_STARS` or `Failure.NONE`, (...).
        """
        finite = np.isfinite(self.directions).all(axis=-1) & np.isfinite(self.image_mm).all(axis=-1)
        failure = np.where(self.count < least, Failure.TOO_FEW_STARS, Failure.NONE)
        sound = finite.all(axis=-1) & np.isfinite(self.focal_length_mm[..., 0])
        return np.where(sound, failure, Failure.NOT_FINITE)


def refuse_other_field(field: object, function: str, stars: int | None = None) -> None:
    """Refuse what is no star field, or one of another number of stars.

    Args:
        field: that a method was given
        function: its name
        stars: how many it takes; None: any

    Raises:
        VopdError: with what the method takes
    """
    refuse_other_kind(field, StarField, function, "a StarField")
    count = field.used.shape[-1] if isinstance(field, StarField) else 0
    if stars is not None and count != stars:
        raise VopdError(
            f"{function} takes {stars} stars, not {count}: field.select(np.array([0, 1])) has the "
            "first two, and `collinearity` and `wahba` take all"
        )


def refuse_other_sigma(reading_sigma_mm: float | None) -> None:
    """Refuse a standard deviation of readings that is none; None is one that is not stated.

    Raises:
        VopdError: it is not above 0, or no number
    """
    if reading_sigma_mm is not None:
        sigma = numbers(reading_sigma_mm, "reading_sigma_mm")
        if not (sigma.ndim == 0 and 0.0 < sigma < np.inf):
            raise VopdError(f"reading_sigma_mm is {reading_sigma_mm!r}, not a number above 0")


def coincide(a: Floats, b: Floats) -> Bools:
    """Test whether two unit vectors (..., 3) are the same direction, or opposite, (...)."""
    close: Bools = norm(np.cross(a, b)) < DEGENERATE
    return close


def _contained(values: Floats, used: Bools, idle: list[float]) -> Floats:
    """Replace values of stars that are not used, and make absurdly large ones NaN."""
    values = np.where(np.abs(values) < TOO_LARGE, values, np.nan)
    return np.where(used[..., None], values, idle)
