"""The collinearity solution: differential corrections (section 2, program STARS).

Subroutine PARSHL differentiates by omega, phi, kappa. Turns about the camera's
own axes have simpler derivatives and are defined for every attitude;
`turns_of_angles` leads from one set to the other.
"""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from vopd.arrays import Floats
from vopd.findings import VopdError, numbers, refuse_other_word
from vopd.geometry.linear import crossing, norm, transform, unit
from vopd.geometry.rotations import partials_by_turns
from vopd.stellar.angles import omega_phi_kappa_deg, orientation_matrix
from vopd.stellar.field import (
    Failure,
    StarField,
    first_failure,
    image_points_mm,
    refuse_other_field,
    refuse_other_sigma,
    when,
)
from vopd.stellar.methods.two_star import closed_form
from vopd.stellar.methods.wahba import wahba_rotation
from vopd.stellar.methods.weights import WeightRule, least_squares, residual_weights
from vopd.stellar.solution import StarSolution, behind_camera


def image_partials(image_mm: Floats, focal_length_mm: Floats) -> Floats:
    """Differentiate image coordinates by small rotations of the stars.

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
    """Differentiate small rotations of the camera by omega, phi, kappa.

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
    """Turn orientation matrices about the camera's x, y, z axes.

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
    """Build matrices that rotate vectors about an axis (Rodrigues' formula).

    Args:
        axis: unit vectors, (..., 3)
        angle_rad: angles, (...), radians, positive by the right-hand rule

    Returns:
        Rotation matrices, (..., 3, 3).
    """
    cross = crossing(axis)
    sine, cosine = np.sin(angle_rad)[..., None, None], np.cos(angle_rad)[..., None, None]
    return np.eye(3) + sine * cross + (1.0 - cosine) * (cross @ cross)


# The solution

StartRule = Literal["svd", "two-star"]

LIMIT = 50  # corrections after which a solution to convergence is given up
SHIFT = 1e-12
"""Converged when the last correction moves no image by more than this many focal lengths."""

UNDETERMINED = 1e-8
"""Ratio of singular values of the design below which the attitude is undetermined."""


def collinearity(
    field: StarField,
    *,
    initial_deg: ArrayLike | None = None,
    start: StartRule = "svd",
    weights: WeightRule = "uniform",
    corrections: int | None = None,
    reading_sigma_mm: float | None = None,
) -> StarSolution:
    """Find the attitude that minimises the sum of squares of the image residuals.

    Args:
        field: the stars and their images
        initial_deg: omega, phi, kappa to start from, (..., 3), degrees
        start: where to start without `initial_deg`: "svd", the singular-value
            solution of Wahba's problem, or "two-star", the two-star Church
            solution of the widest pair, as the report does
        weights: "uniform"; "listed", the rules of subroutine RESWTS; "robust",
            Huber's, after a first correction without weights. The field's own
            `errors` count with "uniform" and "robust"
        corrections: make exactly this many, to omega, phi and kappa as program
            STARS does (4 there), converged or not; no solution where phi is
            +-90. None: until none moves an image by 1e-12 focal lengths, 50 at
            most, by turns of the axes, which are defined for every attitude
        reading_sigma_mm: scale of the robust weights, mm; None: from the residuals

    Returns:
        The solution. It fails with fewer than two stars, where they leave the
        attitude undetermined, where there is no convergence, and where a star
        ends behind the camera; in the last two cases `matrix` is where the
        corrections ended.

    Raises:
        VopdError: where an argument is of another kind, or no such word

    Source: Rae (1987), eqs. 2.1 to 2.13; the field's `errors` make W of eq. 2.13.
    """
    refuse_other_field(field, "collinearity")
    refuse_other_word(start, get_args(StartRule), "start")
    refuse_other_word(weights, get_args(WeightRule), "weights")
    refuse_other_sigma(reading_sigma_mm)
    if corrections is not None and not (
        isinstance(corrections, int | np.integer) and corrections >= 0
    ):
        raise VopdError(f"corrections is {corrections!r}, not a whole number from 0 on")
    stack = field.used.shape[:-1]
    flat = field.flat()
    unfit = flat.unfit(least=2)
    matrix = np.where(
        (unfit == Failure.NONE)[:, None, None], _start(flat, stack, initial_deg, start), np.nan
    )
    last = np.where(flat.used[..., None], np.ones_like(flat.image_mm), 0.0)
    iterations, converged = np.zeros(len(matrix), int), np.zeros(len(matrix), bool)

    for step in range(LIMIT if corrections is None else corrections):
        live = np.flatnonzero(np.isfinite(matrix).all(axis=(1, 2)) & ~converged)
        if live.size == 0:
            break
        some = flat if live.size == len(matrix) else flat.take(live)
        rule = rule_of_step(weights, step)
        matrix[live], shift, last[live] = correct(
            some, matrix[live], rule, reading_sigma_mm, listed=corrections is not None
        )
        iterations[live] += 1
        settled = (shift < SHIFT) & (rule == weights)
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


def _start(
    flat: StarField, stack: tuple[int, ...], initial_deg: ArrayLike | None, start: StartRule
) -> Floats:
    """Choose rotations (k, 3, 3) to start from; NaN where the stars determine none."""
    if initial_deg is not None:
        given = numbers(initial_deg, "initial_deg")
        if given.shape not in ((3,), (*stack, 3)):
            raise VopdError(f"initial_deg has the shape {given.shape}, not {(*stack, 3)}")
        angles = np.broadcast_to(given, (*stack, 3))
        return orientation_matrix(angles.reshape(-1, 3))
    return start_rotation(flat, start)


def start_rotation(field: StarField, start: StartRule) -> Floats:
    """Estimate first attitudes for collinearity, (k, 3, 3); NaN where the stars determine none."""
    if start == "two-star":
        return closed_form(field)
    matrix, determined = wahba_rotation(field)
    return np.where(determined[:, None, None], matrix, np.nan)


def rule_of_step(weights: WeightRule, step: int) -> WeightRule:
    """Choose the weights of one correction: robust ones begin after a first one without weights."""
    return "uniform" if weights == "robust" and step == 0 else weights


def correct(
    field: StarField, matrix: Floats, rule: WeightRule, sigma_mm: float | None, *, listed: bool
) -> tuple[Floats, Floats, Floats]:
    """Correct attitudes once (eq. 2.10), by the angles as listed or by turning the axes.

    Args:
        field: k problems
        matrix: their attitudes, (k, 3, 3)
        rule: of the weights
        sigma_mm: scale of the robust weights, mm; None: from the residuals
        listed: whether omega, phi and kappa are corrected

    Returns:
        The corrected attitudes, NaN where the stars leave them undetermined; the largest
        shift of an image, (k,), focal lengths; and the weights, (k, n, 2).
    """
    camera = transform(matrix, field.directions)
    computed = image_points_mm(camera, field.focal_length_mm)
    residuals = np.where(field.used[..., None], field.image_mm - computed, 0.0)
    residuals = residuals if rule == "listed" else field.whitened(residuals)
    weight = residual_weights(rule, residuals, field, sigma_mm)
    design = image_partials(computed, field.focal_length_mm)
    design = design if rule == "listed" else field.whitened(design)
    design = np.where(field.used[..., None, None], design, 0.0)
    if listed:
        angles_deg = omega_phi_kappa_deg(matrix)
        design = design @ turns_of_angles(matrix, angles_deg)[:, None]
    rows = design.reshape(len(matrix), -1, 3)
    side, flat_weight = residuals.reshape(len(matrix), -1), weight.reshape(len(matrix), -1)
    turn, spread = least_squares(rows, side, flat_weight)
    shift = np.abs(np.einsum("pnk,pk->pn", rows, turn)).max(axis=-1)
    moved = orientation_matrix(angles_deg + np.degrees(turn)) if listed else turned(matrix, turn)
    moved = np.where((spread > UNDETERMINED)[:, None, None], moved, np.nan)
    return moved, shift / field.focal_length_mm[:, 0], weight
