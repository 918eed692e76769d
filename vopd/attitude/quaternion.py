"""Quaternions of attitudes: scalar first, Hamilton's product, w not negative.

The quaternion of frame A to frame B is that of the turn which carries A's axes
into B's: cosine of half the angle, and the sine times the axis. A vector's
components in A are q (0, components in B) q*.
"""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats


def from_yaw_pitch_roll(angles_deg: Floats) -> Floats:
    """North-east-down to body, (..., 4) w x y z, of yaw, pitch, roll (..., 3) degrees.

    First about down, then about the new right, then about the new forward axis.
    """
    half = np.radians(angles_deg) / 2.0
    (c1, c2, c3), (s1, s2, s3) = np.moveaxis(np.cos(half), -1, 0), np.moveaxis(np.sin(half), -1, 0)
    q = np.stack(
        [
            c1 * c2 * c3 + s1 * s2 * s3,
            c1 * c2 * s3 - s1 * s2 * c3,
            c1 * s2 * c3 + s1 * c2 * s3,
            s1 * c2 * c3 - c1 * s2 * s3,
        ],
        axis=-1,
    )
    return _canonical(q)


def from_axes(axes: Floats) -> Floats:
    """Of frame A to frame B, (..., 4), from B's axes in A, rows of `axes` (..., 3, 3)."""
    m = np.moveaxis(axes, (-2, -1), (0, 1))
    trace = m[0, 0] + m[1, 1] + m[2, 2]
    squares = np.stack([trace, *(2.0 * m[k, k] - trace for k in range(3))], axis=-1) + 1.0
    products = np.zeros((*trace.shape, 4, 4))  # four times q q'
    for k in range(4):
        products[..., k, k] = squares[..., k]
    for one, (i, j) in enumerate(((1, 2), (2, 0), (0, 1)), 1):
        products[..., 0, one] = products[..., one, 0] = m[i, j] - m[j, i]
        products[..., i + 1, j + 1] = products[..., j + 1, i + 1] = m[i, j] + m[j, i]
    largest = squares.argmax(axis=-1)
    q = np.take_along_axis(products, largest[..., None, None], axis=-2)[..., 0, :]
    with np.errstate(invalid="ignore"):
        return _canonical(q / np.linalg.norm(q, axis=-1, keepdims=True))


def product(one: Floats, other: Floats) -> Floats:
    """Of A to C, (..., 4): `one` is A to B, `other` is B to C."""
    w, x, y, z = np.moveaxis(one, -1, 0)
    e, f, g, h = np.moveaxis(other, -1, 0)
    q = np.stack(
        [
            w * e - x * f - y * g - z * h,
            w * f + x * e + y * h - z * g,
            w * g - x * h + y * e + z * f,
            w * h + x * g - y * f + z * e,
        ],
        axis=-1,
    )
    return _canonical(q)


def angle_between_deg(one: Floats, other: Floats) -> Floats:
    """The angle (...), 0 to 180 degrees, of the turn from one attitude to another."""
    w, *xyz = np.moveaxis(product(one * [1.0, -1.0, -1.0, -1.0], other), -1, 0)
    return np.asarray(np.degrees(2.0 * np.arctan2(np.sqrt(sum(v * v for v in xyz)), np.abs(w))))


def _canonical(q: Floats) -> Floats:
    return np.asarray(np.where(q[..., :1] < 0.0, -q, q) + 0.0)
