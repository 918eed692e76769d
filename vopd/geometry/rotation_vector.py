"""Rotations by their vector: the axis times the angle in radians."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats

SMALL_RAD = 1e-3  # below it the series of the sine is exact to the last bit


@np.errstate(all="ignore")
def rotation_matrices(vector: Floats) -> Floats:
    """The matrices of right-handed rotations, (B, 3, 3), as scipy's `Rotation` has them.

    They go through the quaternion. To import scipy's takes a tenth of a second.

    Args:
        vector: axis times angle, radians, (B, 3)
    """
    square = vector[:, 0] * vector[:, 0] + vector[:, 1] * vector[:, 1] + vector[:, 2] * vector[:, 2]
    angle = np.sqrt(square)
    series = 0.5 - square / 48.0 + square * square / 3840.0
    x, y, z = (
        vector * np.where(angle <= SMALL_RAD, series, np.sin(angle / 2.0) / angle)[:, None]
    ).T
    w = np.cos(angle / 2.0)
    x2, y2, z2, w2 = x * x, y * y, z * z, w * w
    matrix = np.empty((len(vector), 3, 3))
    matrix[:, 0, 0], matrix[:, 1, 1] = x2 - y2 - z2 + w2, -x2 + y2 - z2 + w2
    matrix[:, 2, 2] = -x2 - y2 + z2 + w2
    matrix[:, 1, 0], matrix[:, 0, 1] = 2.0 * (x * y + z * w), 2.0 * (x * y - z * w)
    matrix[:, 2, 0], matrix[:, 0, 2] = 2.0 * (x * z - y * w), 2.0 * (x * z + y * w)
    matrix[:, 2, 1], matrix[:, 1, 2] = 2.0 * (y * z + x * w), 2.0 * (y * z - x * w)
    return matrix
