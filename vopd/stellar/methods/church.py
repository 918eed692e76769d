"""The Church method for three or more stars (section 3.2, program CHURCH)."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.stellar.failures import Failure, first_failure, when
from vopd.stellar.methods import observation_weights as weights
from vopd.stellar.methods.least_squares import least_squares
from vopd.stellar.star_field import DEGENERATE, StarField
from vopd.stellar.star_solution import StarSolution, closed

NEAR_GREAT_CIRCLE = 0.01
"""Flatness (see below) under which a reading error grows more than a hundredfold."""

AT_PRINCIPAL_POINT = 1e-6
"""Distance from the principal point, in focal lengths, at which wR is as good as infinite."""


def church(
    field: StarField, *, formula_weights: bool = False, reading_sigma_mm: float | None = None
) -> StarSolution:
    """The nine elements of M by linear least squares (eqs. 3.4, 3.11).

    No start value, no iteration; M comes out not quite orthogonal. Uniform
    weights, or wP, wQ, wR of eqs. 3.15 to 3.17; with a reading sigma wR stays
    finite at the principal point. Fails with fewer than three stars, with stars
    or images on one great circle, and with an image at the principal point
    under formula weights without a sigma.
    """
    directions, photo = field.directions, field.photo
    shape = (*field.used.shape[:-1], 3, field.used.shape[-1])  # rows of M, then stars
    weight = np.ones(shape)
    if formula_weights:
        weight = weights.church(field.image_mm, field.focal_length_mm, reading_sigma_mm)
    observed = np.swapaxes(photo, -1, -2)
    counts = field.used[..., None, :] & np.isfinite(weight)  # an infinite weight is a failure below
    weight = np.where(counts, weight, 0.0)
    matrix, _ = least_squares(
        np.broadcast_to(directions[..., None, :, :], (*shape, 3)), observed, weight
    )
    radius = np.hypot(field.image_mm[..., 0], field.image_mm[..., 1])
    central = field.used & (radius < AT_PRINCIPAL_POINT * field.focal_length_mm)
    infinite = central.any(axis=-1) & formula_weights & (reading_sigma_mm is None)
    failure = first_failure(
        field.unfit(least=3),
        when(flatness(field) < DEGENERATE, Failure.GREAT_CIRCLE),
        when(infinite, Failure.PRINCIPAL_POINT),
    )
    return closed(matrix, failure, field)


def flatness(field: StarField) -> Floats:
    """How far the stars, or their images, are from one great circle: (...), 0 to 1.

    The smallest over the largest singular value of their directions, about the
    radian measure of the shorter way across the group. 0 of fewer than three.
    """
    count = np.maximum(field.used.shape[-1], 3)
    spreads = []
    for vectors in (field.directions, field.photo):
        present = np.where(field.used[..., None], vectors, 0.0)
        padding = [(0, 0)] * (present.ndim - 2) + [(0, count - present.shape[-2]), (0, 0)]
        rows = np.pad(np.nan_to_num(present), padding)
        singular = np.linalg.svd(rows, compute_uv=False)
        with np.errstate(invalid="ignore"):
            spreads.append(np.nan_to_num(singular[..., -1] / singular[..., 0]))
    return np.minimum(*spreads)
