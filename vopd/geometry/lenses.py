"""Lens models of digital cameras: from a ray in camera axes to pixels, and back.

Camera axes: x right, y down, z forward. Pixels: u right, v down, (0, 0) is the
centre of the first pixel. A ray X, Y, Z in front of the camera meets the plane
Z = 1 at x = X/Z, y = Y/Z; the lens moves that point to xd, yd, and

    u = fx xd + skew yd + cx        v = fy yd + cy
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, IntEnum
from functools import cached_property
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.geometry import brown_lens, fisheye_lens, radial_table_lens
from vopd.geometry.image_partials import partials_by_turns


class LensKind(Enum):
    """The families of lens models."""

    BROWN = "brown"  # pinhole with up to 12 coefficients in OpenCV's order; none is a pinhole
    FISHEYE = "fisheye"  # equidistant, four coefficients (Kannala and Brandt, as OpenCV)
    RADIAL_TABLE = "radial-table"  # the 1974 table of distortion by radius


class Unseen(IntEnum):
    """Why a ray has no image."""

    SEEN = 0
    BEHIND_CAMERA = 1  # 90 degrees or more off the optical axis
    OUTSIDE_FIELD = 2  # beyond the radius where the model folds over, or its table ends


UNSEEN_MEANING = {
    Unseen.BEHIND_CAMERA: "lies behind the camera",
    Unseen.OUTSIDE_FIELD: "lies outside the field in which the lens model holds",
}


@dataclass(frozen=True, eq=False)
class Lens:
    """The lens of a digital camera.

    Args:
        kind: the family of the model
        size_px: width and height of the image, pixels
        focal_px: fx, fy, (2,)
        centre_px: cx, cy, the principal point, (2,), (0, 0) the centre of the first pixel
        k: coefficients in OpenCV's order, (12,) for BROWN: k1 k2 p1 p2 k3 k4 k5 k6 s1 s2
            s3 s4, zero where not used; (4,) for FISHEYE; none for RADIAL_TABLE
        skew_px: pixels of u for a unit of yd, b2 of Metashape; 0 for most
        table: for RADIAL_TABLE rows of measured radius and what is to be added to it,
            pixels, (n, 2), the first radius 0; fx and fy must be equal
    """

    kind: LensKind
    size_px: tuple[int, int]
    focal_px: Floats
    centre_px: Floats
    k: Floats
    skew_px: float = 0.0
    table: Floats | None = None

    @cached_property
    def field_radius(self) -> float:
        """The widest angle from the optical axis that the model can invert, as its tangent."""
        if self.kind is LensKind.RADIAL_TABLE:
            return radial_table_lens.field_radius(_normalised_table(self))
        if self.kind is LensKind.FISHEYE:
            return fisheye_lens.field_radius(self.k)
        return brown_lens.field_radius(self.k)


class Projection(NamedTuple):
    """Where rays meet the image; `pixel` and `by_turns` are NaN where `unseen` is not 0."""

    pixel: Floats  # (..., 2) u, v
    by_turns: Floats  # (..., 2, 3) by small right-handed turns of the ray about x, y, z, radians
    distorted: Floats  # (..., 2) xd, yd: u and v by a pixel of focal length
    unseen: Ints  # (...) of Unseen


@np.errstate(all="ignore")
def project(lens: Lens, ray: Floats) -> Projection:
    """The images of rays, and how they move when the rays turn.

    Args:
        lens: the lens
        ray: in camera axes, of any length, (..., 3)
    """
    behind = ~(ray[..., 2] > 0.0)
    x, y = (np.where(behind, np.nan, ray[..., k] / ray[..., 2]) for k in (0, 1))
    (xd, yd), by_xy = _distort(lens, x, y)
    outside = ~behind & ~(np.hypot(x, y) <= lens.field_radius)
    unseen = np.where(behind, Unseen.BEHIND_CAMERA, np.where(outside, Unseen.OUTSIDE_FIELD, 0))
    seen = np.where(unseen == 0, 1.0, np.nan)
    distorted = np.stack([xd, yd], axis=-1) * seen[..., None]
    pixels = _pixels_by_distorted(lens)
    by_turns = _turned(pixels, by_xy, partials_by_turns(x, y, 1.0))
    return Projection(
        (distorted.reshape(-1, 2) @ pixels.T).reshape(distorted.shape) + lens.centre_px,
        by_turns * seen[..., None, None],
        distorted,
        unseen.astype(np.int64),
    )


def _turned(pixels: Floats, by_xy: Floats, turns: Floats) -> Floats:
    """The product of (2, 2), (..., 2, 2) and (..., 2, 3), written out: matrices are too small."""
    (fx, skew), (_, fy) = pixels
    (a, b), (c, d) = np.moveaxis(by_xy, (-2, -1), (0, 1))
    turned = np.empty_like(turns)
    for k in range(3):
        across, down = turns[..., 0, k], turns[..., 1, k]
        v = c * across + d * down
        turned[..., 0, k], turned[..., 1, k] = fx * (a * across + b * down) + skew * v, fy * v
    return turned


@np.errstate(all="ignore")
def ray_of_pixel(lens: Lens, pixel: Floats) -> Floats:
    """Unit rays in camera axes, (..., 3), of pixels; NaN outside the field of the lens model.

    The distortion is undone by iteration to the last bits.

    Args:
        lens: the lens
        pixel: u, v, (..., 2)
    """
    distorted = np.linalg.solve(
        _pixels_by_distorted(lens), np.moveaxis(pixel - lens.centre_px, -1, 0).reshape(2, -1)
    )
    xd, yd = (row.reshape(pixel.shape[:-1]) for row in distorted)
    if lens.kind is LensKind.RADIAL_TABLE:
        x, y = radial_table_lens.undistort(_normalised_table(lens), xd, yd)
    elif lens.kind is LensKind.FISHEYE:
        x, y = fisheye_lens.undistort(lens.k, xd, yd)
    else:
        x, y = brown_lens.undistort(lens.k, xd, yd)
    ray = np.stack([x, y, np.where(np.isfinite(x), 1.0, np.nan)], axis=-1)
    return np.asarray(ray / np.linalg.norm(ray, axis=-1, keepdims=True))


def _distort(lens: Lens, x: Floats, y: Floats) -> tuple[tuple[Floats, Floats], Floats]:
    if lens.kind is LensKind.RADIAL_TABLE:
        return radial_table_lens.distort(_normalised_table(lens), x, y)
    if lens.kind is LensKind.FISHEYE:
        return fisheye_lens.distort(lens.k, x, y)
    return brown_lens.distort(lens.k, x, y)


def _pixels_by_distorted(lens: Lens) -> Floats:
    fx, fy = lens.focal_px
    return np.array([[fx, lens.skew_px], [0.0, fy]])


def _normalised_table(lens: Lens) -> Floats:
    """Measured and ideal radius in units of the focal length, (n, 2)."""
    assert lens.table is not None
    radius, added = lens.table.T / lens.focal_px[0]
    return np.stack([radius, radius + added], axis=1)
