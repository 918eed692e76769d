"""Lens models of digital cameras: Brown, fisheye, and a table of radii.

A lens model moves a point of the plane at unit distance in front of the camera from where a
pinhole would have it (ideal) to where the lens shows it (distorted), and back. `MODELS` has a
row for each; a new model is its three functions, a member of `LensKind` and a row of `MODELS`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from enum import Enum, IntEnum
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import polynomial

from vopd.arrays import Bools, Floats, Ints
from vopd.geometry.rotations import partials_by_turns

# Brown: a rational radial part, tangential and thin prism terms, in OpenCV's order
# k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4.

ROUNDS_BROWN = 60
SMALL = 1e-15
LENSES = 64  # whose fields are kept: every pass of a solve asks for them
SMALLEST = 1e-100  # coefficient of a polynomial whose roots are looked for; a smaller one is 0


def distort_brown(k: Floats, x: Floats, y: Floats) -> tuple[tuple[Floats, Floats], Floats]:
    """Distort ideal points, with the derivatives of the result by the ideal point.

    Args:
        k: the coefficients, (12,)
        x: ideal, in the plane at unit distance, (...)
        y: ideal, (...)

    Returns:
        The distorted x and y, (...) each, and the derivatives (..., 2, 2): rows are distorted
        x and y, columns ideal x and y.
    """
    k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4 = (float(value) for value in k)
    r2 = x * x + y * y
    factor = ((k3 * r2 + k2) * r2 + k1) * r2 + 1.0
    slope = (3.0 * k3 * r2 + 2.0 * k2) * r2 + k1  # of the factor by r2
    if k4 or k5 or k6:
        d = ((k6 * r2 + k5) * r2 + k4) * r2 + 1.0
        factor = factor / d
        slope = (slope - factor * ((3.0 * k6 * r2 + 2.0 * k5) * r2 + k4)) / d
    xd, yd, mixed = x * factor, y * factor, 2.0 * x * y * slope
    by = np.empty((*np.shape(factor), 2, 2))
    by[..., 0, 0], by[..., 1, 1] = factor + 2.0 * x * x * slope, factor + 2.0 * y * y * slope
    if p1 or p2:
        xd = xd + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x)
        yd = yd + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y
        mixed = mixed + 2.0 * p1 * x + 2.0 * p2 * y
        by[..., 0, 0] += 2.0 * p1 * y + 6.0 * p2 * x
        by[..., 1, 1] += 6.0 * p1 * y + 2.0 * p2 * x
    by[..., 0, 1] = by[..., 1, 0] = mixed
    if s1 or s2 or s3 or s4:
        xd, yd = xd + s1 * r2 + s2 * r2 * r2, yd + s3 * r2 + s4 * r2 * r2
        prism_x, prism_y = s1 + 2.0 * s2 * r2, s3 + 2.0 * s4 * r2
        by[..., 0, 0] += 2.0 * x * prism_x
        by[..., 0, 1] += 2.0 * y * prism_x
        by[..., 1, 0] += 2.0 * x * prism_y
        by[..., 1, 1] += 2.0 * y * prism_y
    return (xd, yd), by


def undistort_brown(k: Floats, xd: Floats, yd: Floats) -> tuple[Floats, Floats]:
    """Remove the distortion of points by Newton's method.

    It starts from the point that the radial part alone would give.

    Args:
        k: the coefficients, (12,)
        xd: distorted, in the plane at unit distance, (...)
        yd: distorted, (...)

    Returns:
        The ideal x and y, (...) each; NaN where the model has no ideal point in its field.
    """
    limit = field_radius_brown(k)
    angle, moved = _radii_brown(tuple(k))
    rd = np.hypot(xd, yd)
    start = np.tan(np.interp(rd, moved, angle))
    scale = np.where(rd > 0.0, start / np.where(rd > 0.0, rd, 1.0), 1.0)
    x, y = xd * scale, yd * scale
    for _ in range(ROUNDS_BROWN):
        (xn, yn), by = distort_brown(k, x, y)
        determinant = by[..., 0, 0] * by[..., 1, 1] - by[..., 0, 1] * by[..., 1, 0]
        ex, ey = xd - xn, yd - yn
        dx = (by[..., 1, 1] * ex - by[..., 0, 1] * ey) / determinant
        dy = (by[..., 0, 0] * ey - by[..., 1, 0] * ex) / determinant
        x, y = x + dx, y + dy
        size = np.abs(dx) + np.abs(dy)
        if not (size > SMALL * (1.0 + np.abs(x) + np.abs(y))).any():
            break
    (xn, yn), _ = distort_brown(k, x, y)
    near = np.hypot(xn - xd, yn - yd) <= 1e-12 * (1.0 + rd)
    good = near & (np.hypot(x, y) <= limit) & (determinant > 0.0)
    return np.where(good, x, np.nan), np.where(good, y, np.nan)


def field_radius_brown(k: Floats) -> float:
    """Find the largest ideal radius for which the model can be inverted.

    There the radial part stops growing; infinite if it never does.

    Args:
        k: the coefficients, (12,)
    """
    return _field_radius_brown(tuple(k))


@lru_cache(LENSES)
def _field_radius_brown(k: tuple[float, ...]) -> float:
    over, under = _radial(k)
    grown = polynomial.polyadd(over, 2.0 * polynomial.polymulx(polynomial.polyder(over)))
    shrunk = 2.0 * polynomial.polymulx(polynomial.polyder(under))
    growth = polynomial.polysub(polynomial.polymul(grown, under), polynomial.polymul(over, shrunk))
    roots = [polynomial.polyroots(polynomial.polytrim(p, SMALLEST)) for p in (growth, under)]
    squares = np.concatenate(roots)
    real = squares.real[(np.abs(squares.imag) <= 1e-9 * np.abs(squares)) & (squares.real > 0.0)]
    return float(np.sqrt(real.min())) if len(real) else float("inf")


@lru_cache(LENSES)
def _radii_brown(k: tuple[float, ...]) -> tuple[Floats, Floats]:
    """Tabulate distorted radii, which do not decrease, by the ideal angle off the axis."""
    angle = np.linspace(0.0, min(np.arctan(_field_radius_brown(k)), 1.55), 1025)
    over, under = _radial(k)
    r = np.tan(angle)
    grown = r * polynomial.polyval(r * r, over) / polynomial.polyval(r * r, under)
    moved = np.maximum.accumulate(grown)  # a field may end at a pole, where the sign is anything
    angle.flags.writeable = moved.flags.writeable = False
    return angle, moved


def _radial(k: tuple[float, ...]) -> tuple[Floats, Floats]:
    """Write numerator and denominator of the radial factor as polynomials in r squared."""
    over = np.array([1.0, k[0], k[1], k[4]])
    under = np.array([1.0, k[5], k[6], k[7]])
    return over, under


# Equidistant fisheye (Kannala and Brandt, as in OpenCV): a ray at the angle t off the optical
# axis has its image at the radius t (1 + k1 t2 + k2 t4 + k3 t6 + k4 t8) focal lengths.

ROUNDS_FISHEYE = 60


def distort_fisheye(k: Floats, x: Floats, y: Floats) -> tuple[tuple[Floats, Floats], Floats]:
    """Distort ideal points, with the derivatives of the result by the ideal point.

    Args:
        k: the coefficients, (4,)
        x: ideal, in the plane at unit distance, (...)
        y: ideal, (...)

    Returns:
        The distorted x and y, (...) each, and the derivatives (..., 2, 2): rows are distorted
        x and y, columns ideal x and y.
    """
    r = np.hypot(x, y)
    angle = np.arctan(r)
    radius, slope = _radius(k, angle)
    away = r > 0.0
    factor = np.where(away, radius / np.where(away, r, 1.0), 1.0)
    return (x * factor, y * factor), radial_partials(x, y, factor, slope / (1.0 + r * r))


def radial_partials(x: Floats, y: Floats, factor: Floats, slope: Floats) -> Floats:
    """Differentiate the point (x, y) times a radial factor with respect to x and y, (..., 2, 2).

    Args:
        x: ideal, (...)
        y: ideal, (...)
        factor: distorted radius over ideal radius, (...)
        slope: derivative of the distorted radius by the ideal radius, (...)
    """
    r2 = x * x + y * y
    more = np.where(r2 > 0.0, (slope - factor) / np.where(r2 > 0.0, r2, 1.0), 0.0)
    rows = [[factor + more * x * x, more * x * y], [more * x * y, factor + more * y * y]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def undistort_fisheye(k: Floats, xd: Floats, yd: Floats) -> tuple[Floats, Floats]:
    """Remove the distortion of points by Newton's method on the angle from the axis.

    Args:
        k: the coefficients, (4,)
        xd: distorted, in the plane at unit distance, (...)
        yd: distorted, (...)

    Returns:
        The ideal x and y, (...) each; NaN where the model has no ideal point in its field.
    """
    limit = _angle_limit(tuple(k))
    nodes = np.linspace(0.0, min(limit, np.pi / 2), 1025)
    rd = np.hypot(xd, yd)
    angle = np.interp(rd, _radius(k, nodes)[0], nodes)
    for _ in range(ROUNDS_FISHEYE):
        radius, slope = _radius(k, angle)
        step = (rd - radius) / slope
        angle = angle + step
        if not (np.abs(step) > 1e-16 * (1.0 + angle)).any():
            break
    good = (np.abs(_radius(k, angle)[0] - rd) <= 1e-12) & (angle <= limit) & (angle < np.pi / 2)
    factor = np.where(rd > 0.0, np.tan(angle) / np.where(rd > 0.0, rd, 1.0), 1.0)
    return np.where(good, xd * factor, np.nan), np.where(good, yd * factor, np.nan)


def field_radius_fisheye(k: Floats) -> float:
    """Find the largest ideal radius for which the model can be inverted: an angle's tangent.

    At that angle from the axis the image's radius stops growing; infinite from 90 degrees on.

    Args:
        k: the coefficients, (4,)
    """
    limit = _angle_limit(tuple(k))
    return float(np.tan(limit)) if limit < np.pi / 2 else float("inf")


def _radius(k: Floats, angle: Floats) -> tuple[Floats, Floats]:
    """Evaluate the image's radius and its derivative by the angle."""
    t2 = angle * angle
    radius = angle * polynomial.polyval(t2, [1.0, *k])
    return np.asarray(radius), np.asarray(polynomial.polyval(t2, _growth(k)))


def _growth(k: Floats | tuple[float, ...]) -> Floats:
    """Differentiate the image's radius by the angle: a polynomial in the angle squared."""
    return np.array([1.0, 3.0 * k[0], 5.0 * k[1], 7.0 * k[2], 9.0 * k[3]])


@lru_cache(LENSES)
def _angle_limit(k: tuple[float, ...]) -> float:
    """Find the angle at which the image's radius stops growing; infinite if it never does."""
    roots = polynomial.polyroots(polynomial.polytrim(_growth(k), SMALLEST))
    real = roots.real[(np.abs(roots.imag) <= 1e-9 * np.abs(roots)) & (roots.real > 0.0)]
    return float(np.sqrt(real.min())) if len(real) else float("inf")


# A table of measured radii and those of a perfect lens, linear between its rows, so that neither
# direction needs iteration. Beyond the last row the lens is not known.


def distort_radial_table(
    table: Floats, x: Floats, y: Floats
) -> tuple[tuple[Floats, Floats], Floats]:
    """Distort ideal points, with the derivatives of the result by the ideal point.

    Args:
        table: measured and ideal radius, (n, 2), both growing from 0
        x: ideal, in the plane at unit distance, (...)
        y: ideal, (...)

    Returns:
        The distorted x and y, (...) each, and the derivatives (..., 2, 2): rows are distorted
        x and y, columns ideal x and y.
    """
    measured, ideal = table.T
    r = np.hypot(x, y)
    interval = np.clip(np.searchsorted(ideal, r, side="right") - 1, 0, len(ideal) - 2)
    slope = (np.diff(measured) / np.diff(ideal))[interval]
    radius = measured[interval] + slope * (r - ideal[interval])
    factor = np.where(r > 0.0, radius / np.where(r > 0.0, r, 1.0), slope)
    return (x * factor, y * factor), radial_partials(x, y, factor, slope)


def undistort_radial_table(table: Floats, xd: Floats, yd: Floats) -> tuple[Floats, Floats]:
    """Remove the distortion of points.

    Args:
        table: measured and ideal radius, (n, 2), both growing from 0
        xd: distorted, in the plane at unit distance, (...)
        yd: distorted, (...)

    Returns:
        The ideal x and y, (...) each; NaN where the point is beyond the last row.
    """
    measured, ideal = table.T
    rd = np.hypot(xd, yd)
    radius = np.interp(rd, measured, ideal, right=np.nan)
    first = ideal[1] / measured[1]
    factor = np.where(rd > 0.0, radius / np.where(rd > 0.0, rd, 1.0), first)
    return xd * factor, yd * factor


def field_radius_radial_table(table: Floats) -> float:
    """Look up the largest ideal radius of the table.

    Args:
        table: measured and ideal radius, (n, 2), both growing from 0
    """
    return float(table[-1, 1])


# The models, each a row of one table


class LensKind(Enum):
    """The families of lens models."""

    BROWN = "brown"  # pinhole with up to 12 coefficients in OpenCV's order; none is a pinhole
    FISHEYE = "fisheye"  # equidistant, four coefficients (Kannala and Brandt, as OpenCV)
    RADIAL_TABLE = "radial-table"  # the 1974 table of distortion by radius


class LensModel(NamedTuple):
    """One lens model; its first argument is always `Lens.coefficients`."""

    counts: tuple[int, ...]  # how many coefficients may be given; the others are 0
    distort: Callable[[Floats, Floats, Floats], tuple[tuple[Floats, Floats], Floats]]
    undistort: Callable[[Floats, Floats, Floats], tuple[Floats, Floats]]
    field_radius: Callable[[Floats], float]
    only_radial: Callable[[Floats], bool]  # points move along their radius, by it alone


MODELS = {
    LensKind.BROWN: LensModel(
        (0, 4, 5, 8, 12),
        distort_brown,
        undistort_brown,
        field_radius_brown,
        lambda k: not np.any(k[[2, 3, 8, 9, 10, 11]]),
    ),
    LensKind.FISHEYE: LensModel(
        (0, 1, 2, 3, 4),
        distort_fisheye,
        undistort_fisheye,
        field_radius_fisheye,
        lambda k: True,
    ),
    LensKind.RADIAL_TABLE: LensModel(
        (0,),
        distort_radial_table,
        undistort_radial_table,
        field_radius_radial_table,
        lambda table: True,
    ),
}


# The lens of a camera: from a ray in camera axes to pixels, and back
#
# Camera axes: x right, y down, z forward. Pixels: u right, v down, (0, 0) is the
# centre of the first pixel. A ray X, Y, Z in front of the camera meets the plane
# Z = 1 at x = X/Z, y = Y/Z; the lens moves that point to xd, yd, and
#
#     u = fx xd + skew yd + cx        v = fy yd + cy


class Unseen(IntEnum):
    """Why a ray has no image."""

    SEEN = 0
    BEHIND_CAMERA = 1  # 90 degrees or more off the optical axis
    OUTSIDE_FIELD = 2  # beyond the radius where the model folds over, or its table ends
    NOWHERE = 3  # no ray leads there from the camera


UNSEEN_MEANING = {
    Unseen.BEHIND_CAMERA: "lies behind the camera",
    Unseen.OUTSIDE_FIELD: "lies outside the field in which the lens model holds",
    Unseen.NOWHERE: "is at the camera's own place, or deep in the Earth,",
}


@dataclass(frozen=True, eq=False)
class Lens:
    """The lens of a digital camera."""

    kind: LensKind  # the family of the model
    size_px: tuple[int, int]  # width and height of the image, pixels
    focal_px: Floats  # fx, fy, (2,)
    centre_px: Floats  # cx, cy, the principal point, (2,), (0, 0) the centre of the first pixel
    # coefficients in OpenCV's order, (12,) for BROWN: k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4, zero
    # where not used; (4,) for FISHEYE; none for RADIAL_TABLE
    k: Floats
    skew_px: float = 0.0  # pixels of u for a unit of yd, b2 of Metashape; 0 for most
    # for RADIAL_TABLE rows of measured radius and what is to be added to it, pixels, (n, 2), the
    # first radius 0; fx and fy must be equal
    table: Floats | None = None

    @property
    def model(self) -> LensModel:
        """The functions of the lens's kind."""
        return MODELS[self.kind]

    @property
    def kinds(self) -> tuple[LensKind, ...]:
        """The kind of the lens, or those of several."""
        return (self.kind,)

    @property
    def coefficients(self) -> Floats:
        """Arguments of the model: `k`, or the table's measured and ideal radii at unit distance."""
        if self.table is None:
            return self.k
        radius, added = self.table.T / self.focal_px[0]
        return np.stack([radius, radius + added], axis=1)

    @property
    def pixels_by_distorted(self) -> Floats:
        """Derivatives of u, v by xd, yd, (2, 2)."""
        fx, fy = self.focal_px
        return np.array([[fx, self.skew_px], [0.0, fy]])

    @property
    def is_radial(self) -> bool:
        """Whether pixels are square and move along their radius alone, as in the 1974 table."""
        square = self.focal_px[0] == self.focal_px[1] and self.skew_px == 0.0
        return bool(square and self.model.only_radial(self.coefficients))

    @cached_property
    def field_radius(self) -> float:
        """The widest angle from the optical axis that the model can invert, as its tangent."""
        return self.model.field_radius(self.coefficients)

    def scaled(self, ratio: float) -> Lens:
        """Take the lens for the same pictures in another size: the distortion is of angles."""
        width, height = (round(ratio * side) for side in self.size_px)
        return replace(
            self,
            size_px=(width, height),
            focal_px=self.focal_px * ratio,
            centre_px=(self.centre_px + 0.5) * ratio - 0.5,
            skew_px=self.skew_px * ratio,
            table=None if self.table is None else self.table * ratio,
        )

    def of(self, rows: Any) -> Lens:
        """Take the lenses of some rows, by index or mask; one lens is that of all."""
        return self

    def by_rows(self, name: str) -> Floats:
        """Look up `size_px`, `focal_px` or `centre_px`, (2,), or of each row (..., 2)."""
        return np.asarray(getattr(self, name), dtype=np.float64)


@dataclass(frozen=True, eq=False)
class Lenses(Lens):
    """The lenses of rows that are not all of one camera; as one lens it is the first of them."""

    each: tuple[Lens, ...] = ()  # the lenses
    # the index of each row's lens, (R,); rays and pixels have R rows or R rows of rows
    which: Ints = field(default_factory=lambda: np.zeros(0, np.int64))

    @classmethod
    def join(cls, each: tuple[Lens, ...], which: Ints) -> Lenses:
        """Join lenses, of which the first is that by which focal lengths are counted."""
        first = each[0]
        return cls(
            first.kind, first.size_px, first.focal_px, first.centre_px, first.k, first.skew_px,
            first.table, each, which,
        )  # fmt: skip

    @property
    def kinds(self) -> tuple[LensKind, ...]:
        return tuple(one.kind for one in self.each)

    def scaled(self, ratio: float) -> Lens:
        return Lenses.join(tuple(one.scaled(ratio) for one in self.each), self.which)

    def of(self, rows: Any) -> Lens:
        return replace(self, which=self.which[rows])

    def by_rows(self, name: str) -> Floats:
        return np.array([getattr(one, name) for one in self.each], dtype=np.float64)[self.which]

    def parts(self) -> Iterator[tuple[Lens, Bools]]:
        """Iterate over the lenses with their rows, (R,)."""
        for k in np.unique(self.which).tolist():
            yield self.each[k], self.which == k


class Projection(NamedTuple):
    """Where rays meet the image; `pixel` and `by_turns` are NaN where `unseen` is not 0."""

    pixel: Floats  # (..., 2) u, v
    by_turns: Floats  # (..., 2, 3) by small right-handed turns of the ray about x, y, z, radians
    distorted: Floats  # (..., 2) xd, yd: u and v by a pixel of focal length
    unseen: Ints  # (...) of Unseen


@np.errstate(all="ignore")
def project(lens: Lens, ray: Floats) -> Projection:
    """Project rays on the image, with the derivatives of the pixels by small turns of the rays.

    Args:
        lens: the lens
        ray: in camera axes, of any length, (..., 3)
    """
    if isinstance(lens, Lenses):
        shape = ray.shape[:-1]
        pixel, distorted = np.empty((2, *shape, 2))
        whole = Projection(pixel, np.empty((*shape, 2, 3)), distorted, np.empty(shape, np.int64))
        for one, rows in lens.parts():
            for out, part in zip(whole, project(one, ray[rows]), strict=True):
                out[rows] = part
        return whole
    behind = ~(ray[..., 2] > 0.0)
    x, y = (np.where(behind, np.nan, ray[..., k] / ray[..., 2]) for k in (0, 1))
    (xd, yd), by_xy = lens.model.distort(lens.coefficients, x, y)
    outside = ~behind & ~(np.hypot(x, y) <= lens.field_radius)
    unseen = np.zeros(behind.shape, np.int64)
    unseen[behind], unseen[outside] = Unseen.BEHIND_CAMERA, Unseen.OUTSIDE_FIELD
    distorted = np.stack([xd, yd], axis=-1)
    pixels = lens.pixels_by_distorted
    by_turns = _turned(pixels, by_xy, partials_by_turns(x, y, 1.0))
    distorted[unseen != 0] = by_turns[unseen != 0] = np.nan
    return Projection(
        (distorted.reshape(-1, 2) @ pixels.T).reshape(distorted.shape) + lens.centre_px,
        by_turns,
        distorted,
        unseen,
    )


def _turned(pixels: Floats, by_xy: Floats, turns: Floats) -> Floats:
    """Multiply (2, 2), (..., 2, 2) and (..., 2, 3), written out: matrices are too small."""
    (fx, skew), (_, fy) = pixels
    a, b, c, d = (by_xy[..., row, column] for row in (0, 1) for column in (0, 1))
    turned = np.empty_like(turns)
    for k in range(3):
        across, down = turns[..., 0, k], turns[..., 1, k]
        v = c * across + d * down
        turned[..., 0, k], turned[..., 1, k] = fx * (a * across + b * down) + skew * v, fy * v
    return turned


@np.errstate(all="ignore")
def ray_of_pixel(lens: Lens, pixel: Floats) -> Floats:
    """Trace pixels back to unit rays in camera axes, (..., 3); NaN outside the lens model's field.

    The distortion is undone by iteration to the last bits.

    Args:
        lens: the lens
        pixel: u, v, (..., 2)
    """
    if isinstance(lens, Lenses):
        rays = np.empty((*pixel.shape[:-1], 3))
        for one, rows in lens.parts():
            rays[rows] = ray_of_pixel(one, pixel[rows])
        return rays
    distorted = np.linalg.solve(
        lens.pixels_by_distorted, np.moveaxis(pixel - lens.centre_px, -1, 0).reshape(2, -1)
    )
    xd, yd = (row.reshape(pixel.shape[:-1]) for row in distorted)
    x, y = lens.model.undistort(lens.coefficients, xd, yd)
    ray = np.stack([x, y, np.where(np.isfinite(x), 1.0, np.nan)], axis=-1)
    return np.asarray(ray / np.linalg.norm(ray, axis=-1, keepdims=True))
