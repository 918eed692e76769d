"""Quaternions of attitudes: scalar first, Hamilton's product, scalar part 0 or more.

The quaternion of frame A to frame B is that of the rotation which carries A's axes
into B's: cosine of half the angle, and the sine times the axis. A vector's
components in A are q (0, components in B) q*. An attitude that is not known is NaN.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.spatial.transform import Rotation

from vopd.arrays import Floats


def from_yaw_pitch_roll(angles_deg: Floats) -> Floats:
    """Quaternion of local north-east-down to body, (F, 4) w x y z.

    Args:
        angles_deg: yaw, pitch, roll, (F, 3): first about down, then about the new
            right, then about the new forward axis
    """
    return _quaternions(lambda known: Rotation.from_euler("ZYX", known, degrees=True), angles_deg)


def from_axes(axes: Floats) -> Floats:
    """Quaternion of frame A to frame B, (F, 4) w x y z.

    Args:
        axes: B's axes in components of A, as rows, (F, 3, 3)
    """
    return _quaternions(lambda known: Rotation.from_matrix(known.swapaxes(1, 2)), axes)


def product(one: Floats, other: Floats) -> Floats:
    """The product of two quaternions: from A to B, then from B to C, (F, 4) w x y z.

    Args:
        one: A to B, (F, 4)
        other: B to C, (F, 4)
    """
    both = np.stack([one, other], axis=1)
    return _quaternions(lambda known: _rotation(known[:, 0]) * _rotation(known[:, 1]), both)


def angle_between_deg(one: Floats, other: Floats) -> Floats:
    """The angle of the rotation from one attitude to another, 0 to 180 degrees, (F,).

    Args:
        one: quaternions, (F, 4)
        other: quaternions of the same two frames, (F, 4)
    """
    between = product(one * [1.0, -1.0, -1.0, -1.0], other)
    half = np.arctan2(np.linalg.norm(between[:, 1:], axis=1), np.abs(between[:, 0]))
    return np.asarray(np.degrees(2.0 * half))


def _rotation(quaternion: Floats) -> Rotation:
    return Rotation.from_quat(np.roll(quaternion, -1, axis=-1))  # scipy has the scalar last


def _quaternions(rotations: Callable[[Floats], Rotation], given: Floats) -> Floats:
    """Quaternions of the rows that are known, scalar part not negative; NaN for the others."""
    known = np.isfinite(given).reshape(len(given), -1).all(axis=1)
    found = np.full((len(given), 4), np.nan)
    if known.any():
        scalar_first = np.roll(rotations(given[known]).as_quat(), 1, axis=-1)
        found[known] = np.where(scalar_first[:, :1] < 0.0, -scalar_first, scalar_first) + 0.0
    return found
