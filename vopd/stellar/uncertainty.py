"""Uncertainty of an attitude from stars, and of its angles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.linear import (
    confidence_ellipse,
    crossing,
    inverse,
    pseudo_inverse,
    transform,
)
from vopd.stellar.angles import alpha_delta_swing_deg, omega_phi_kappa_deg
from vopd.stellar.field import StarField, image_points_mm
from vopd.stellar.methods.church import ChurchWeights, element_weights
from vopd.stellar.methods.collinearity import image_partials, turns_of_angles
from vopd.stellar.methods.weights import ray_partials, star_weights
from vopd.stellar.solution import StarSolution

# Covariance about the camera's axes
#
# Every method's solution turns by a small rotation vector when the readings
# change. Its derivatives by the image coordinates give the covariance about the
# camera's axes for readings good to 1 mm, which scales with the reading variance.

LARGEST_SIGMA_DEG = 3.0
"""Standard deviation of an attitude from which it is refused.

Up to there the actual errors of all methods have the stated deviation to some
tenths; beyond, errors no longer grow in proportion to those of the readings."""

STEP_MM = 1e-4  # change of an image coordinate by which a pair's solution is differentiated


def collinearity_covariance(
    field: StarField, rotation: Floats, weights: Floats | None = None
) -> Floats:
    """Estimate the covariance of a collinearity solution about the camera's axes.

    Args:
        field: the problems that were solved, stack (...)
        rotation: their solutions, (..., 3, 3)
        weights: of the image coordinates, (..., n, 2); None: all alike

    Returns:
        (..., 3, 3), radians squared per mm squared of reading variance; NaN where
        the stars leave the attitude undetermined.
    """
    computed = image_points_mm(transform(rotation, field.directions), field.focal_length_mm)
    design = field.whitened(image_partials(computed, field.focal_length_mm))
    given = np.ones(field.image_mm.shape) if weights is None else weights
    weight = np.where(field.used[..., None], given, 0.0)
    design = np.where(field.used[..., None, None], design, 0.0)
    normal = np.einsum("...nak,...na,...nal->...kl", design, weight, design)
    inner = np.einsum("...nak,...na,...nal->...kl", design, weight**2, design)
    spread = inverse(normal)
    return np.asarray(spread @ inner @ spread)


def wahba_covariance(field: StarField) -> Floats:
    """Estimate the covariance of a singular-value solution about the camera's axes.

    Args:
        field: the problems that were solved, stack (...)

    Returns:
        (..., 3, 3), radians squared per mm squared of reading variance.
    """
    photo = field.photo
    weight = star_weights(field)
    size = weight.sum(axis=-1)[..., None, None]
    outer = np.einsum("...n,...ni,...nj->...ij", weight, photo, photo)
    turn = inverse(size * np.eye(3) - outer)[..., None, :, :] @ crossing(photo)
    gain = weight[..., None, None] * turn @ ray_partials(field)
    return _propagated(gain, field)


def church_covariance(
    field: StarField,
    rotation: Floats,
    *,
    weights: ChurchWeights = "uniform",
    reading_sigma_mm: float | None = None,
) -> Floats:
    """Estimate the covariance of the rotation nearest to a Church solution, about camera axes.

    Args:
        field: the problems that were solved, stack (...)
        rotation: the rotations nearest to their solutions, (..., 3, 3)
        weights: as for `church`
        reading_sigma_mm: as for `church`

    Returns:
        (..., 3, 3), radians squared per mm squared of reading variance.
    """
    weight = element_weights(field, weights, reading_sigma_mm)
    u = field.directions
    normal = np.einsum("...kn,...ni,...nj->...kij", weight, u, u)
    # Row k of M changes by the sum of weight * dp[k] * inverse(normal) u, here in camera axes.
    answer = np.einsum("...ij,...kjl,...nl->...kni", rotation, inverse(normal), u)
    answer = answer * weight[..., None]
    change = np.einsum("...kni,...nka->...nkia", answer, ray_partials(field))
    turn = 0.5 * (change - np.swapaxes(change, -2, -3))
    gain = np.stack([turn[..., 2, 1, :], turn[..., 0, 2, :], turn[..., 1, 0, :]], axis=-2)
    return _propagated(gain, field)


def pair_covariance(
    field: StarField, rotation: Floats, solve: Callable[[StarField], StarSolution]
) -> Floats:
    """Estimate the covariance of a method for two stars, from differences of solutions.

    Args:
        field: problems of two stars, stack (...)
        rotation: the rotations nearest to their solutions, (..., 3, 3)
        solve: the method

    Returns:
        (..., 3, 3), radians squared per mm squared of reading variance.
    """
    gain = np.zeros((*rotation.shape[:-2], 2, 3, 2))
    for star in range(2):
        for axis in range(2):
            ends = []
            for step in (STEP_MM, -STEP_MM):
                image = field.image_mm.copy()
                image[..., star, axis] += step
                ends.append(solve(replace(field, image_mm=image)).rotation())
            change = (ends[0] - ends[1]) @ np.swapaxes(rotation, -1, -2) / (2.0 * STEP_MM)
            gain[..., star, :, axis] = 0.5 * np.stack(
                [change[..., i, j] - change[..., j, i] for i, j in ((2, 1), (0, 2), (1, 0))],
                axis=-1,
            )
    return _propagated(gain, field)


def _propagated(gain: Floats, field: StarField) -> Floats:
    """Propagate reading errors to a result with derivatives (..., n, 3, 2) by x and y."""
    if field.errors is None:
        return np.asarray(np.einsum("...nik,...njk->...ij", gain, gain))
    return np.asarray(np.einsum("...nik,...nkl,...njl->...ij", gain, field.errors, gain))


# Sigmas of the angles, and the region of the optical axis


def angle_sigmas_rad(matrix: Floats, covariance: Floats) -> Floats:
    """Estimate the standard deviations of omega, phi, kappa, alpha, delta, swing.

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
    """Differentiate small rotations of M U by alpha, delta, swing.

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
) -> tuple[Floats, Floats]:
    """Estimate the ellipse on the sky that holds the true optical axis with 95 percent probability.

    Args:
        matrix: rotations from object to camera axes, (k, 3, 3)
        covariance: of turns of M U about the camera's axes, (k, 3, 3), radians squared
        freedom: degrees of freedom of the reading error; None where it is known

    Returns:
        Semi-axes, (k, 2), the longer one first, and the direction of the longer one, (k,),
        from north toward increasing right ascension, radians.
    """
    swing = np.radians(alpha_delta_swing_deg(matrix)[:, 2])
    s, c = np.sin(swing), np.cos(swing)
    # A turn t of M U moves the axis by (t_y, -t_x) along the camera's x, y.
    east = np.stack([-s, -c], axis=-1)
    north = np.stack([-c, s], axis=-1)
    by_turns = np.stack([east, north], axis=-2)
    spread = by_turns @ covariance[:, :2, :2] @ np.swapaxes(by_turns, -1, -2)
    return confidence_ellipse(spread, freedom)
