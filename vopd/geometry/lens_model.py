"""Lens models of digital cameras: from a ray in camera axes to pixels, and back.

Camera axes: x right, y down, z forward. Pixels: u right, v down, (0, 0) is the
centre of the first pixel.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from vopd.arrays import Floats


class LensKind(Enum):
    """The families of lens models."""

    BROWN = "brown"  # pinhole with up to 12 coefficients in OpenCV's order; none is a pinhole
    FISHEYE = "fisheye"  # equidistant, four coefficients (Kannala and Brandt, as OpenCV)
    RADIAL_TABLE = "radial-table"  # the 1974 table of distortion by radius


@dataclass(frozen=True, eq=False)
class Lens:
    """The lens of a digital camera.

    Args:
        kind: the family of the model
        size_px: width and height of the image, pixels
        focal_px: fx, fy, (2,)
        centre_px: cx, cy, the principal point, (2,), (0, 0) the centre of the first pixel
        k: coefficients in OpenCV's order, (12,) for BROWN: k1 k2 p1 p2 k3 k4 k5 k6 s1 s2
            s3 s4, zero where not used; (4,) for FISHEYE
        skew_px: pixels of u for a unit of y/z, b2 of Metashape; 0 for most
        table: for RADIAL_TABLE rows of radius and distortion in pixels, (n, 2)
    """

    kind: LensKind
    size_px: tuple[int, int]
    focal_px: Floats
    centre_px: Floats
    k: Floats
    skew_px: float = 0.0
    table: Floats | None = None
