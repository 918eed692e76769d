"""Uncertainty of an attitude from stars: how errors of the image coordinates rotate the solution.

Every method's solution turns by a small rotation vector when the readings
change. Its derivatives by the image coordinates give the covariance about the
camera's axes for readings good to 1 mm, which scales with the reading variance.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.cross_product import crossing
from vopd.geometry.linear import inverse
from vopd.geometry.vectors import transform
from vopd.stellar.directions import image_points_mm
from vopd.stellar.field import StarField
from vopd.stellar.methods.church import ChurchWeights, element_weights
from vopd.stellar.methods.small_turns import image_partials
from vopd.stellar.methods.star_weights import ray_partials, star_weights
from vopd.stellar.solution import StarSolution

LARGEST_SIGMA_DEG = 3.0
"""Standard deviation of an attitude from which it is refused.

Up to there the actual errors of all methods have the stated deviation to some
tenths; beyond, errors no longer grow in proportion to those of the readings."""

STEP_MM = 1e-4
"""Change of an image coordinate by which a pair's solution is differentiated."""


def collinearity_covariance(
    field: StarField, rotation: Floats, weights: Floats | None = None
) -> Floats:
    """Covariance of a collinearity solution about the camera's axes.

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
    """Covariance of a singular-value solution about the camera's axes.

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
    """Covariance of the rotation nearest to a Church solution, about the camera's axes.

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
    """Covariance of a method for two stars, from differences of solutions.

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
    """Covariance of a result whose derivatives by x and y of each star are (..., n, 3, 2)."""
    if field.errors is None:
        return np.asarray(np.einsum("...nik,...njk->...ij", gain, gain))
    return np.asarray(np.einsum("...nik,...nkl,...njl->...ij", gain, field.errors, gain))
