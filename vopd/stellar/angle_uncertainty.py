"""Standard deviations of an attitude's angles, and the region in which the optical axis points."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.confidence_ellipse import ConfidenceEllipse, confidence_ellipse
from vopd.geometry.linear import pseudo_inverse
from vopd.stellar.angles import alpha_delta_swing_deg, omega_phi_kappa_deg
from vopd.stellar.methods.small_turns import turns_of_angles


def angle_sigmas_rad(matrix: Floats, covariance: Floats) -> Floats:
    """Standard deviations of omega, phi, kappa, alpha, delta, swing.

    Where phi or delta is +-90 degrees the outer two angles are not determined
    singly; their deviations are then those of the changes of least length.

    Args:
        matrix: rotations from object to camera axes, (k, 3, 3)
        covariance: of turns of M U about the camera's axes, (k, 3, 3), radians squared

    Returns:
        (k, 6), radians.
    """
    found = []
    for turns in (
        turns_of_angles(matrix, omega_phi_kappa_deg(matrix)),
        turns_of_pointing(matrix),
    ):
        angles = pseudo_inverse(turns)
        found.append(np.einsum("kai,kij,kaj->ka", angles, covariance, angles))
    with np.errstate(invalid="ignore"):
        return np.asarray(np.sqrt(np.concatenate(found, axis=-1)))


def turns_of_pointing(matrix: Floats) -> Floats:
    """Small rotations of M U that result from small changes of alpha, delta, swing.

    Args:
        matrix: rotations from object to camera axes, (k, 3, 3)

    Returns:
        For each angle a column: the turn about the camera's x, y, z, (k, 3, 3).
    """
    swing = np.radians(alpha_delta_swing_deg(matrix)[:, 2])
    zero, one = np.zeros_like(swing), np.ones_like(swing)
    east = np.stack([-np.cos(swing), np.sin(swing), zero], axis=-1)
    behind = np.stack([zero, zero, -one], axis=-1)
    return np.stack([-matrix[:, :, 2], east, behind], axis=-1)


def boresight_region(
    matrix: Floats, covariance: Floats, freedom: float | None
) -> ConfidenceEllipse:
    """The ellipse on the sky that holds the true optical axis with 95 percent probability.

    Args:
        matrix: rotations from object to camera axes, (k, 3, 3)
        covariance: of turns of M U about the camera's axes, (k, 3, 3), radians squared
        freedom: degrees of freedom of the reading error; None where it is known

    Returns:
        Semi-axes in radians, and the direction of the longer one from north toward
        increasing right ascension.
    """
    swing = np.radians(alpha_delta_swing_deg(matrix)[:, 2])
    s, c = np.sin(swing), np.cos(swing)
    # A turn t of M U moves the axis by (t_y, -t_x) along the camera's x, y.
    east = np.stack([-s, -c], axis=-1)
    north = np.stack([-c, s], axis=-1)
    by_turns = np.stack([east, north], axis=-2)
    spread = by_turns @ covariance[:, :2, :2] @ np.swapaxes(by_turns, -1, -2)
    return confidence_ellipse(spread, freedom)
