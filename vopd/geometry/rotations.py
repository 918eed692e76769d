"""Quaternions of attitudes: scalar first, Hamilton's product, scalar part 0 or more.

The quaternion of frame A to frame B is that of the rotation which carries A's axes
into B's: cosine of half the angle, and the sine times the axis. A vector's
components in A are q (0, components in B) q*. An attitude that is not known is NaN.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vopd.arrays import Floats


@np.errstate(all="ignore")
def from_yaw_pitch_roll(angles_deg: Floats) -> Floats:
    """Quaternion of local north-east-down to body, (F, 4) w x y z.

    Args:
        angles_deg: yaw, pitch, roll, (F, 3): first about down, then about the new
            right, then about the new forward axis
    """
    half = np.radians(angles_deg) / 2.0
    (sy, sp, sr), (cy, cp, cr) = np.sin(half).T, np.cos(half).T
    return _normal(
        [
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        ]
    )


def from_axes(axes: Floats) -> Floats:
    """Quaternion of frame A to frame B, (F, 4) w x y z.

    The largest of its four parts is found first, and the others by it.

    Args:
        axes: B's axes in components of A, as rows, (F, 3, 3)
    """
    (a, b, c), (d, e, f), (g, h, i) = np.moveaxis(axes.swapaxes(1, 2), 0, -1)
    trace = a + e + i
    by_each = np.array(
        [
            [1.0 + trace, h - f, c - g, d - b],
            [h - f, 1.0 + 2.0 * a - trace, b + d, c + g],
            [c - g, b + d, 1.0 + 2.0 * e - trace, f + h],
            [d - b, c + g, f + h, 1.0 + 2.0 * i - trace],
        ]
    )
    largest = np.argmax([trace, a, e, i], axis=0)
    return _normal(by_each[largest, :, np.arange(len(axes))].T)


def product(one: Floats, other: Floats) -> Floats:
    """The product of two quaternions: from A to B, then from B to C, (F, 4) w x y z.

    Args:
        one: A to B, (F, 4)
        other: B to C, (F, 4)
    """
    (a, b, c, d), (w, x, y, z) = one.T, other.T
    return _normal(
        [
            a * w - b * x - c * y - d * z,
            a * x + b * w + c * z - d * y,
            a * y - b * z + c * w + d * x,
            a * z + b * y - c * x + d * w,
        ]
    )


def angle_between_deg(one: Floats, other: Floats) -> Floats:
    """The angle of the rotation from one attitude to another, 0 to 180 degrees, (F,).

    Args:
        one: quaternions, (F, 4)
        other: quaternions of the same two frames, (F, 4)
    """
    between = product(one * [1.0, -1.0, -1.0, -1.0], other)
    half = np.arctan2(np.linalg.norm(between[:, 1:], axis=1), np.abs(between[:, 0]))
    return np.asarray(np.degrees(2.0 * half))


@np.errstate(all="ignore")
def _normal(parts: Sequence[Floats] | Floats) -> Floats:
    """Unit quaternions (F, 4), scalar part not negative, of four parts; NaN where not known."""
    found = np.stack(list(parts), axis=-1)
    found = found / np.linalg.norm(found, axis=1, keepdims=True)
    known = np.isfinite(found).all(axis=1, keepdims=True)
    return np.where(known, np.where(found[:, :1] < 0.0, -found, found) + 0.0, np.nan)
