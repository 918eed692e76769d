"""How images move when the camera turns: what PARSHL computes, by turns of the axes.

PARSHL differentiates by omega, phi, kappa. Turns about the camera's own axes
have simpler derivatives and no gimbal lock; `turns_of_angles` leads from one
set to the other.
"""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.vectors import norm, unit


def image_partials(image_mm: Floats, focal_length_mm: Floats) -> Floats:
    """Derivatives of image coordinates by a small right-handed turn of M U.

    (..., n, 2), (..., 1) to (..., n, 2, 3), mm per radian about x, y, z of the camera.
    """
    x, y = image_mm[..., 0], image_mm[..., 1]
    f = np.broadcast_to(focal_length_mm, x.shape)
    by_turn = [[x * y / f, -(f + x * x / f), -y], [f + y * y / f, -x * y / f, x]]
    return np.stack([np.stack(row, axis=-1) for row in by_turn], axis=-2)


def turns_of_angles(matrix: Floats, angles_deg: Floats) -> Floats:
    """Turns of M U that increments of omega, phi, kappa make, as columns: (k, 3, 3).

    The camera axes turn about the object's x, the once turned y and the new z:
    seen from the camera, M U turns the other way.
    """
    kappa = np.radians(angles_deg[:, 2])
    zero, one = np.zeros_like(kappa), np.ones_like(kappa)
    about_y = np.stack([np.sin(kappa), np.cos(kappa), zero], axis=-1)
    about_z = np.stack([zero, zero, one], axis=-1)
    return -np.stack([matrix[:, :, 0], about_y, about_z], axis=-1)


def turned(matrix: Floats, turn: Floats) -> Floats:
    """M after a turn of M U, radians about x, y, z of the camera: (k, 3, 3), (k, 3)."""
    angle = norm(turn)
    axis = np.where((angle > 0)[:, None], unit(turn), [1.0, 0.0, 0.0])
    return rotation_about(axis, angle) @ matrix


def rotation_about(axis: Floats, angle_rad: Floats) -> Floats:
    """Matrices that turn vectors about an axis (Rodrigues' formula).

    Args:
        axis: unit vectors, (..., 3)
        angle_rad: angles, (...), radians, positive by the right-hand rule

    Returns:
        Rotation matrices, (..., 3, 3).
    """
    x, y, z = (axis[..., k] for k in range(3))
    zero = np.zeros_like(x)
    cross = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1)
    cross = cross.reshape(*x.shape, 3, 3)
    sine, cosine = np.sin(angle_rad)[..., None, None], np.cos(angle_rad)[..., None, None]
    return np.eye(3) + sine * cross + (1.0 - cosine) * (cross @ cross)
