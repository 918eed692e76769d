"""The camera's axes in local east, north, up, and its yaw, pitch and roll (Appendix A).

Yaw is the direction of the optical axis clockwise from north, pitch its angle above
the horizontal, roll the turn of the picture about it (sigma 1, 2, 3 of TM X-3050).
"""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.linear import pseudo_inverse


def camera_axes(radians: Floats) -> Floats:
    """The image x axis, image y axis and optical axis as rows, (F, 3, 3), east, north, up.

    Args:
        radians: camera yaw, pitch, roll, (F, 3)
    """
    (s1, s2, s3), (c1, c2, c3) = np.sin(radians).T, np.cos(radians).T
    x = np.stack([-c1 * c3 - s1 * s2 * s3, s1 * c3 - c1 * s2 * s3, c2 * s3], axis=-1)
    y = np.stack([c1 * s3 - s1 * s2 * c3, -s1 * s3 - c1 * s2 * c3, c2 * c3], axis=-1)
    z = np.stack([s1 * c2, c1 * c2, s2], axis=-1)
    return np.stack([x, y, z], axis=-2)


def camera_angles_deg(axes: Floats) -> Floats:
    """Camera yaw 0 to 360, pitch -90 to 90, roll 0 to 360 degrees, (..., 3).

    Where the camera looks straight up or down only yaw and roll together are
    defined: roll is 0 there.

    Args:
        axes: image x, image y and optical axis as rows, (..., 3, 3), east, north, up
    """
    pitch = np.arcsin(np.clip(axes[..., 2, 2], -1.0, 1.0))
    level = np.hypot(axes[..., 2, 0], axes[..., 2, 1]) > 1e-12
    yaw = np.where(
        level,
        np.arctan2(axes[..., 2, 0], axes[..., 2, 1]),
        np.arctan2(axes[..., 0, 1], -axes[..., 0, 0]),
    )
    roll = np.where(level, np.arctan2(axes[..., 0, 2], axes[..., 1, 2]), 0.0 * pitch)
    angles = np.stack([yaw % (2 * np.pi), pitch, roll % (2 * np.pi)], axis=-1)
    return np.asarray(np.degrees(angles))


def turns_by_angles(radians: Floats) -> Floats:
    """Small rotations about the camera's axes for small changes of yaw, pitch, roll, (F, 3, 3).

    Yaw turns about down, pitch about the level axis and roll about the optical axis.

    Args:
        radians: camera yaw, pitch, roll, (F, 3)

    Returns:
        Derivatives, (F, 3, 3): rows are the rotations, columns the angles.
    """
    (_, s2, s3), (_, c2, c3) = np.sin(radians).T, np.cos(radians).T
    zero, one = np.zeros_like(s2), np.ones_like(s2)
    yaw = np.stack([-c2 * s3, -c2 * c3, -s2], axis=-1)
    pitch = np.stack([-c3, s3, zero], axis=-1)
    roll = np.stack([zero, zero, one], axis=-1)
    return np.stack([yaw, pitch, roll], axis=-1)


def angles_by_turns(radians: Floats) -> Floats:
    """Derivatives of yaw, pitch, roll with respect to small rotations about the camera's axes.

    At a pitch of 90 degrees yaw and roll turn about the same axis: the derivatives
    are then those of least length.

    Args:
        radians: camera yaw, pitch, roll, (F, 3)

    Returns:
        Derivatives, (F, 3, 3): rows are the angles, columns the rotations.
    """
    return pseudo_inverse(turns_by_angles(radians))


def ahead(axes: Floats, direction: Floats) -> Floats:
    """Cosine of the angle between the optical axis and each landmark; negative behind the camera.

    Args:
        axes: image x, image y and optical axis as rows, (..., 3, 3)
        direction: unit vectors to the landmarks in the same frame, (..., L, 3)

    Returns:
        Cosines, (..., L).
    """
    return np.asarray((axes[..., 2, None, :] * direction).sum(axis=-1))
