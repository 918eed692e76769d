"""Derivatives of image coordinates for small rotations of the camera or changes of its angles.

Subroutine PARSHL differentiates by omega, phi, kappa. Turns about the camera's
own axes have simpler derivatives and are defined for every attitude;
`turns_of_angles` leads from one set to the other.
"""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.cross_product import crossing
from vopd.geometry.image_partials import partials_by_turns
from vopd.geometry.vectors import norm, unit


def image_partials(image_mm: Floats, focal_length_mm: Floats) -> Floats:
    """Derivatives of image coordinates with respect to small rotations of the stars.

    Args:
        image_mm: x, y from the principal point, (..., n, 2), mm
        focal_length_mm: principal distance, (..., 1), mm

    Returns:
        Derivatives by right-handed turns of M U about the camera's x, y, z axes,
        (..., n, 2, 3), mm per radian.
    """
    f = np.asarray(focal_length_mm)
    return partials_by_turns(-image_mm[..., 0] / f, -image_mm[..., 1] / f, -f)


def turns_of_angles(matrix: Floats, angles_deg: Floats) -> Floats:
    """Small rotations that result from small changes of omega, phi, kappa.

    The camera axes turn about the object's x, the once turned y and the new z:
    seen from the camera, M U turns the other way.

    Args:
        matrix: orientation matrices, (k, 3, 3)
        angles_deg: their omega, phi, kappa, (k, 3), degrees

    Returns:
        For each angle a column: the turn about the camera's x, y, z, (k, 3, 3).
    """
    kappa = np.radians(angles_deg[:, 2])
    zero, one = np.zeros_like(kappa), np.ones_like(kappa)
    about_y = np.stack([np.sin(kappa), np.cos(kappa), zero], axis=-1)
    about_z = np.stack([zero, zero, one], axis=-1)
    return -np.stack([matrix[:, :, 0], about_y, about_z], axis=-1)


def turned(matrix: Floats, turn_rad: Floats) -> Floats:
    """Orientation matrices after a rotation about the camera's x, y, z axes.

    Args:
        matrix: orientation matrices, (k, 3, 3)
        turn_rad: rotation vectors in camera axes, (k, 3), radians

    Returns:
        The turned matrices, (k, 3, 3).
    """
    angle = norm(turn_rad)
    axis = np.where((angle > 0)[:, None], unit(turn_rad), [1.0, 0.0, 0.0])
    return rotation_about(axis, angle) @ matrix


def rotation_about(axis: Floats, angle_rad: Floats) -> Floats:
    """Matrices that rotate vectors about an axis (Rodrigues' formula).

    Args:
        axis: unit vectors, (..., 3)
        angle_rad: angles, (...), radians, positive by the right-hand rule

    Returns:
        Rotation matrices, (..., 3, 3).
    """
    cross = crossing(axis)
    sine, cosine = np.sin(angle_rad)[..., None, None], np.cos(angle_rad)[..., None, None]
    return np.eye(3) + sine * cross + (1.0 - cosine) * (cross @ cross)
