"""Yaw, pitch and roll of body axes (forward, right, down) in local north, east, down."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.linear import pseudo_inverse

POLE = 1e-12
LARGEST_DEG = 360.001
"""Angles are kept within a full circle, but for rounding; one beyond this is out of range."""


def body_angles_deg(body_to_ned: Floats) -> Floats:
    """Yaw 0 to 360, pitch -90 to 90, roll 0 to 360 degrees, (..., 3).

    Yaw turns about down, pitch about the new right, roll about the new forward axis.
    Where forward is straight up or down only yaw and roll together are defined:
    roll is 0 there.

    Args:
        body_to_ned: forward, right and down as columns in north, east, down, (..., 3, 3)
    """
    m = body_to_ned
    pitch = -np.arcsin(np.clip(m[..., 2, 0], -1.0, 1.0))
    level = np.hypot(m[..., 0, 0], m[..., 1, 0]) > POLE
    straight = np.arctan2(-m[..., 0, 1], m[..., 1, 1])
    yaw = np.where(level, np.arctan2(m[..., 1, 0], m[..., 0, 0]), straight)
    roll = np.where(level, np.arctan2(m[..., 2, 1], m[..., 2, 2]), 0.0 * pitch)
    angles = np.stack([yaw % (2.0 * np.pi), pitch, roll % (2.0 * np.pi)], axis=-1)
    return np.asarray(np.degrees(angles))


def body_axes(radians: Floats) -> Floats:
    """Forward, right and down of a body as columns in north, east, down, (F, 3, 3).

    Args:
        radians: yaw, pitch, roll, (F, 3)
    """
    (s1, s2, s3), (c1, c2, c3) = np.sin(radians).T, np.cos(radians).T
    forward = np.stack([c1 * c2, s1 * c2, -s2], axis=-1)
    right = np.stack([c1 * s2 * s3 - s1 * c3, s1 * s2 * s3 + c1 * c3, c2 * s3], axis=-1)
    down = np.stack([c1 * s2 * c3 + s1 * s3, s1 * s2 * c3 - c1 * s3, c2 * c3], axis=-1)
    return np.stack([forward, right, down], axis=-1)


def turns_by_body_angles(radians: Floats) -> Floats:
    """Small rotations about forward, right, down for small changes of yaw, pitch, roll, (F, 3, 3).

    Args:
        radians: yaw, pitch, roll, (F, 3)

    Returns:
        Derivatives, (F, 3, 3): rows are the rotations, columns the angles.
    """
    (_, s2, s3), (_, c2, c3) = np.sin(radians).T, np.cos(radians).T
    zero, one = np.zeros_like(s2), np.ones_like(s2)
    yaw = np.stack([-s2, s3 * c2, c3 * c2], axis=-1)
    pitch = np.stack([zero, c3, -s3], axis=-1)
    roll = np.stack([one, zero, zero], axis=-1)
    return np.stack([yaw, pitch, roll], axis=-1)


def body_angles_by_turns(radians: Floats) -> Floats:
    """Derivatives of yaw, pitch, roll with respect to small rotations about forward, right, down.

    At a pitch of 90 degrees yaw and roll turn about the same axis: the derivatives
    are then those of least length.

    Args:
        radians: yaw, pitch, roll, (F, 3)

    Returns:
        Derivatives, (F, 3, 3): rows are the angles, columns the rotations.
    """
    return pseudo_inverse(turns_by_body_angles(radians))
