"""Orientation matrices and their angles: omega, phi, kappa and alpha, delta, swing.

The matrix M takes object to camera coordinates: [P Q R]' = M [U V W]' (eq. 3.1).
omega, phi, kappa turn the camera axes, first about x (y towards z), then about
the new y (z towards x), then about the new z (x towards y) (eqs. 2.3, 2.4).
alpha, delta are the right ascension and declination of the optical axis, swing
is the angle of the photograph's y axis from north towards increasing right
ascension (program CHURCH). Both triples are computed from the elements as they
are: for a matrix that is not quite orthogonal they describe slightly different
attitudes. `vopd.geometry.rotations` makes one attitude of it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from vopd.arrays import Floats
from vopd.findings import VopdError, numbers

ARCSEC = float(np.degrees(1.0)) * 3600.0  # in a radian
POLE = 1e-8
"""Cosine of the middle angle below which only the sum of the outer two is known.

The square root of the machine's precision: above it the arc tangents of the
outer angles are the better ones, below it their sum is."""


def orientation_matrix(omega_phi_kappa_deg: Floats) -> Floats:
    """Build orientation matrices M from the angles omega, phi, kappa.

    Args:
        omega_phi_kappa_deg: the three angles, (..., 3), degrees

    Returns:
        Rotation matrices from object to camera axes, (..., 3, 3).

    Source: Rae (1987), eq. 2.4, subroutine JNKMAT.
    """
    radians = np.radians(_of_shape(omega_phi_kappa_deg, "omega_phi_kappa_deg", (3,)))
    so, sp, sk = np.moveaxis(np.sin(radians), -1, 0)
    co, cp, ck = np.moveaxis(np.cos(radians), -1, 0)
    rows = [
        [ck * cp, so * sp * ck + co * sk, -co * sp * ck + so * sk],
        [-sk * cp, -so * sp * sk + co * ck, co * sp * sk + so * ck],
        [sp, -so * cp, co * cp],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def omega_phi_kappa_deg(matrix: Floats) -> Floats:
    """Extract the angles omega, phi, kappa from orientation matrices.

    Args:
        matrix: from object to camera axes, (..., 3, 3); not quite orthogonal ones are allowed

    Returns:
        The angles, (..., 3), degrees: omega and kappa in -180 to 180, phi in -90
        to 90. Where phi is +-90 only omega +- kappa is defined: kappa is then 0.

    Source: Rae (1987), eq. 3.5, with the quadrants resolved.
    """
    m = _elements(matrix)
    at_pole = np.hypot(m[0][0], m[1][0]) < POLE
    omega = np.where(at_pole, np.arctan2(m[1][2], m[1][1]), np.arctan2(-m[2][1], m[2][2]))
    kappa = np.where(at_pole, 0.0, np.arctan2(-m[1][0], m[0][0]))
    triple: Floats = np.degrees(np.stack([omega, _arcsin(m[2][0]), kappa], axis=-1))
    return triple


def alpha_delta_swing_deg(matrix: Floats) -> Floats:
    """Extract the angles alpha, delta, swing, as program CHURCH prints them, from matrices.

    Args:
        matrix: from object to camera axes, (..., 3, 3); not quite orthogonal ones are allowed

    Returns:
        The angles, (..., 3), degrees: alpha and swing in -180 to 180, delta in -90
        to 90. Where delta is +-90 only alpha +- swing is defined: swing is then 0.
    """
    m = _elements(matrix)
    at_pole = np.hypot(m[0][2], m[1][2]) < POLE
    north = np.where(m[2][2] < 0.0, -1.0, 1.0)  # delta = 90 has m33 = -1
    at_pole_alpha = np.arctan2(north * m[1][1], north * m[1][0])
    alpha = np.where(at_pole, at_pole_alpha, np.arctan2(-m[2][1], -m[2][0]))
    swing = np.where(at_pole, 0.0, np.arctan2(m[0][2], m[1][2]))
    triple: Floats = np.degrees(np.stack([alpha, _arcsin(-m[2][2]), swing], axis=-1))
    return triple


def matrix_from_alpha_delta_swing(alpha_delta_swing: Floats) -> Floats:
    """Build orientation matrices M from the angles alpha, delta, swing.

    Args:
        alpha_delta_swing: the three angles, (..., 3), degrees

    Returns:
        Rotation matrices, (..., 3, 3). The optical axis is minus the third row;
        at swing 0 the photograph's y axis points north and, seen from inside the
        sphere, its x axis west.
    """
    radians = np.radians(_of_shape(alpha_delta_swing, "alpha_delta_swing", (3,)))
    alpha, delta, swing = (radians[..., k, None] for k in range(3))
    zero = np.zeros_like(alpha)
    ca, sa, cd, sd = np.cos(alpha), np.sin(alpha), np.cos(delta), np.sin(delta)
    axis = np.concatenate([ca * cd, sa * cd, sd], axis=-1)
    north = np.concatenate([-ca * sd, -sa * sd, cd], axis=-1)
    west = np.concatenate([sa, -ca, zero], axis=-1)
    x = np.cos(swing) * west + np.sin(swing) * north
    y = -np.sin(swing) * west + np.cos(swing) * north
    return np.stack([x, y, -axis], axis=-2)


def orthogonality_defect(matrix: Floats) -> Floats:
    """Measure how far matrices are from rotations: the largest element of ``|M M' - I|``.

    Args:
        matrix: (..., 3, 3)

    Returns:
        The defects, (...); 0 for a rotation.
    """
    matrix = _of_shape(matrix, "matrix", (3, 3))
    product = np.einsum("...ij,...kj->...ik", matrix, matrix)
    defect: Floats = np.abs(product - np.eye(3)).max(axis=(-2, -1))
    return defect


def _elements(matrix: Floats) -> list[list[Floats]]:
    """Split matrices into nine elements, each an array of the stack's shape."""
    matrix = _of_shape(matrix, "matrix", (3, 3))
    return [[matrix[..., i, j] for j in range(3)] for i in range(3)]


def _of_shape(value: ArrayLike, name: str, shape: tuple[int, ...]) -> Floats:
    """Make an array of numbers whose last axes have this shape, or raise `VopdError`."""
    found = numbers(value, name)
    if found.shape[-len(shape) :] != shape:
        wanted = ", ".join(["...", *map(str, shape)])
        raise VopdError(f"{name} has the shape {found.shape}, not ({wanted})")
    return found


def _arcsin(sine: Floats) -> Floats:
    """Take the arc sine of an element that may pass 1, as those of a Church matrix do."""
    return np.arcsin(np.clip(sine, -1.0, 1.0))
