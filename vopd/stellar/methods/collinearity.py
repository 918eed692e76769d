"""The collinearity solution: differential corrections (section 2, program STARS)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from vopd.arrays import Bools, Floats, Ints
from vopd.geometry.vectors import transform
from vopd.stellar.directions import image_points_mm
from vopd.stellar.failures import Failure, first_failure, when
from vopd.stellar.methods import observation_weights as weighting
from vopd.stellar.methods.closed_form import closed_form
from vopd.stellar.methods.least_squares import least_squares
from vopd.stellar.methods.small_turns import image_partials, turned, turns_of_angles
from vopd.stellar.orientation_angles import omega_phi_kappa_deg, orientation_matrix
from vopd.stellar.star_field import StarField
from vopd.stellar.star_solution import StarSolution, behind_camera

Weights = Literal["uniform", "listed", "robust"]

LIMIT = 50
"""Corrections after which a solution to convergence is given up."""

LISTED_CORRECTIONS = 4  # DO 990 ITERAT = 1, 4

SHIFT = 1e-12
"""Converged when the last correction moves no image by more than this many focal lengths."""

UNDETERMINED = 1e-8
"""Ratio of singular values of the design below which the attitude is undetermined."""


@dataclass(frozen=True)
class _Step:
    """One correction of each of k live problems."""

    matrix: Floats  # (k, 3, 3), NaN where undetermined
    shift: Floats  # (k,), focal lengths
    weights: Floats  # (k, n, 2)


def collinearity(
    field: StarField,
    *,
    initial_deg: ArrayLike | None = None,
    weights: Weights = "uniform",
    corrections: int | None = None,
    reading_sigma_mm: float | None = None,
) -> StarSolution:
    """The attitude that makes the squares of the image residuals least (eqs. 2.1 to 2.13).

    initial_deg (..., 3) is omega, phi, kappa to start from; without it the
    closed form starts. Weights: "uniform"; "listed", RESWTS to the letter; or
    "robust", Huber's, after a first pass without (`reading_sigma_mm` fixes their
    scale). With `corrections` exactly so many are made, to omega, phi and kappa
    as STARS does (4 there; no solution where phi is +-90). Without, corrections
    turn the axes until none moves an image by 1e-12 focal lengths, 50 at most:
    the same minimum, reached from every attitude.

    Fails with fewer than two stars, where they leave the attitude undetermined,
    where there is no convergence, and where a star ends behind the camera.
    `matrix` is given in the last two cases: it is where the corrections ended.
    """
    stack = field.used.shape[:-1]
    flat = _flat(field)
    if initial_deg is None:
        start = closed_form(flat)
    else:
        angles = np.broadcast_to(np.asarray(initial_deg, dtype=float), (*stack, 3))
        start = orientation_matrix(angles.reshape(-1, 3))
    unfit = flat.unfit(least=2)
    matrix = np.where((unfit == Failure.NONE)[:, None, None], start, np.nan)
    last = np.where(flat.used[..., None], np.ones_like(flat.image_mm), 0.0)
    iterations, converged = np.zeros(len(matrix), int), np.zeros(len(matrix), bool)

    for step in range(LIMIT if corrections is None else corrections):
        live = np.flatnonzero(np.isfinite(matrix).all(axis=(1, 2)) & ~converged)
        if live.size == 0:
            break
        rule: Weights = "uniform" if weights == "robust" and step == 0 else weights
        made = _correct(
            _take(flat, live), matrix[live], rule, reading_sigma_mm, listed=corrections is not None
        )
        matrix[live], last[live] = made.matrix, made.weights
        iterations[live] += 1
        settled = (made.shift < SHIFT) & (rule == weights)
        if corrections is None or step + 1 == corrections:
            converged[live] = settled

    lost = ~np.isfinite(matrix).all(axis=(1, 2))
    failure = first_failure(
        unfit,
        when(lost, Failure.SINGULAR),
        when(~converged & (corrections is None), Failure.NO_CONVERGENCE),
        when(behind_camera(matrix, flat).any(axis=-1), Failure.BEHIND_CAMERA),
    )
    return StarSolution(
        matrix.reshape(*stack, 3, 3),
        failure.reshape(stack),
        iterations.reshape(stack),
        (converged & (failure == Failure.NONE)).reshape(stack),
        weights=None if weights == "uniform" else last.reshape(field.image_mm.shape),
    )


def _correct(
    field: StarField, matrix: Floats, rule: Weights, sigma_mm: float | None, *, listed: bool
) -> _Step:
    """One correction (eq. 2.10), to the angles as listed or by turning the axes."""
    camera = transform(matrix, field.directions)
    computed = image_points_mm(camera, field.focal_length_mm)
    residuals = np.where(field.used[..., None], field.image_mm - computed, 0.0)
    weight = _weights(rule, residuals, field, sigma_mm)
    design = image_partials(computed, field.focal_length_mm)
    design = np.where(field.used[..., None, None], design, 0.0)
    if listed:
        angles_deg = omega_phi_kappa_deg(matrix)
        design = design @ turns_of_angles(matrix, angles_deg)[:, None]
    rows = design.reshape(len(matrix), -1, 3)
    flat_weight = weight.reshape(len(matrix), -1)
    turn, spread = least_squares(rows, residuals.reshape(len(matrix), -1), flat_weight)
    shift = np.abs(np.einsum("pnk,pk->pn", rows, turn)).max(axis=-1)
    moved = orientation_matrix(angles_deg + np.degrees(turn)) if listed else turned(matrix, turn)
    moved = np.where((spread > UNDETERMINED)[:, None, None], moved, np.nan)
    return _Step(moved, shift / field.focal_length_mm[:, 0], weight)


def _weights(rule: Weights, residuals: Floats, field: StarField, sigma_mm: float | None) -> Floats:
    weight = np.ones_like(residuals)
    if rule == "listed":
        weight = weighting.listed(residuals)
    elif rule == "robust":
        weight = weighting.huber(residuals, field.used, field.focal_length_mm, sigma_mm)
    return np.where(field.used[..., None], weight, 0.0)


def _flat(field: StarField) -> StarField:
    """The stack as one axis."""
    n = field.used.shape[-1]
    return StarField(
        field.directions.reshape(-1, n, 3),
        field.image_mm.reshape(-1, n, 2),
        field.focal_length_mm.reshape(-1, 1),
        field.used.reshape(-1, n),
    )


def _take(field: StarField, index: Ints | Bools) -> StarField:
    return StarField(
        field.directions[index],
        field.image_mm[index],
        field.focal_length_mm[index],
        field.used[index],
    )
