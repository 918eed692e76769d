"""The Church method for three or more stars (section 3.2, program CHURCH)."""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np

from vopd.arrays import Floats
from vopd.findings import refuse_other_word
from vopd.stellar.angles import orthogonality_defect
from vopd.stellar.field import (
    DEGENERATE,
    Failure,
    StarField,
    first_failure,
    refuse_other_field,
    refuse_other_sigma,
    when,
)
from vopd.stellar.methods.weights import (
    church_formula_weights,
    direction_weights,
    least_squares,
    star_weights,
)
from vopd.stellar.solution import StarSolution, closed_form_solution

ChurchWeights = Literal["uniform", "formula", "formula-r"]

NEAR_GREAT_CIRCLE = 0.01
"""Flatness (see below) under which a reading error grows more than a hundredfold."""

LARGEST_DEFECT = 0.1
"""Orthogonality defect from which the matrix as solved is no attitude.

Errors of the elements show in the defect as much as in the attitude: a tenth is
some 3 degrees. The perturbed sample of the report, with its large errors of .1
to .3 mm, has .0085."""

AT_PRINCIPAL_POINT = 1e-6
"""Distance from the principal point, in focal lengths, at which wR is as good as infinite."""


def church(
    field: StarField,
    *,
    weights: ChurchWeights = "uniform",
    reading_sigma_mm: float | None = None,
) -> StarSolution:
    """Solve the nine elements of M by linear least squares.

    It takes no start value and no iteration; the matrix is not quite orthogonal.

    Args:
        field: the stars and their images, three or more a problem
        weights: of the direction cosines: "uniform"; "formula", wP, wQ and wR of
            eqs. 3.15 to 3.17; or "formula-r", wR alone, since the other two hardly
            differ from star to star (section 3.2)
        reading_sigma_mm: standard deviation of a reading, mm; keeps wR finite at
            the principal point

    Returns:
        The solution. It fails with fewer than three stars, with stars or images
        on one great circle, where the matrix is far from a rotation (defect
        above .1: the stars lie too near a great circle for their errors), and
        with an image at the principal point under either formula without a sigma.

    Source: Rae (1987), eqs. 3.4 and 3.11.
    """
    refuse_other_field(field, "church")
    refuse_other_word(weights, get_args(ChurchWeights), "weights")
    refuse_other_sigma(reading_sigma_mm)
    weight = element_weights(field, weights, reading_sigma_mm)
    stars = np.broadcast_to(field.directions[..., None, :, :], (*weight.shape, 3))
    matrix, _ = least_squares(stars, np.swapaxes(field.photo, -1, -2), weight)
    radius = np.hypot(field.image_mm[..., 0], field.image_mm[..., 1])
    central = field.used & (radius < AT_PRINCIPAL_POINT * field.focal_length_mm)
    infinite = central.any(axis=-1) & (weights != "uniform") & (reading_sigma_mm is None)
    failure = first_failure(
        field.unfit(least=3),
        when(flatness(field) < DEGENERATE, Failure.GREAT_CIRCLE),
        when(infinite, Failure.PRINCIPAL_POINT),
        when(~(orthogonality_defect(matrix) < LARGEST_DEFECT), Failure.NOT_A_ROTATION),
    )
    return closed_form_solution(matrix, failure, field)


def element_weights(
    field: StarField, weights: ChurchWeights, reading_sigma_mm: float | None
) -> Floats:
    """Weigh the stars in the equations of each row of M, (..., 3, n); infinite weights are 0."""
    shape = (*field.used.shape[:-1], 3, field.used.shape[-1])
    weight = np.broadcast_to(star_weights(field)[..., None, :], shape).copy()
    if weights != "uniform":
        if field.errors is not None:
            formula = direction_weights(field, reading_sigma_mm)
        else:
            formula = church_formula_weights(
                field.image_mm, field.focal_length_mm, reading_sigma_mm
            )
        rows = slice(2, 3) if weights == "formula-r" else slice(0, 3)
        weight[..., rows, :] = formula[..., rows, :]
    return np.where(field.used[..., None, :] & np.isfinite(weight), weight, 0.0)


def flatness(field: StarField) -> Floats:
    """Measure how far the stars, or their images, are from lying on one great circle.

    Returns:
        The smallest over the largest singular value of their directions, (...),
        0 to 1: about the radian measure of the shorter way across the group. 0
        for fewer than three stars.
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
