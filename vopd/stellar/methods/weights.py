"""Weights of the observations: those of the listing, robust ones, and Church's formulas."""

from __future__ import annotations

from typing import Literal

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.stellar.field import StarField

WeightRule = Literal["uniform", "listed", "robust"]

VANISHING_MM = 1e-7  # RESWTS: TOOLTL
LISTED_VARIANCE_MM2 = 0.000009  # (.003 mm)**2
LISTED_LIMIT, LISTED_ABOVE_LIMIT = 9.0, 3.0

HUBER_BEND = 2.0
"""Length of a residual, in reading sigmas, up to which a star counts fully.

Readings with normal errors in x and y stay within it 86 times of 100."""

MEDIAN_LENGTH = np.sqrt(2.0 * np.log(2.0))
"""Median length of a plane vector with unit normal errors in x and y."""


def residual_weights(
    rule: WeightRule, residuals_mm: Floats, field: StarField, reading_sigma_mm: float | None
) -> Floats:
    """Weights of the image coordinates by one of the three rules.

    Args:
        rule: which rule
        residuals_mm: observed minus computed, (..., n, 2), mm
        field: the stars; those not used get weight 0
        reading_sigma_mm: scale of the robust rule, mm; None: from the residuals

    Returns:
        The weights, (..., n, 2).
    """
    weight = np.ones_like(residuals_mm)
    if rule == "listed":
        weight = listed(residuals_mm)
    elif rule == "robust":
        weight = huber(residuals_mm, field.used, field.focal_length_mm, reading_sigma_mm)
    return np.where(field.used[..., None], weight, 0.0)


def listed(residuals_mm: Floats) -> Floats:
    """Weights exactly as subroutine RESWTS sets them.

    Each coordinate has its own: (.003 mm / residual)**2, but 3 where that
    passes 9, and 0 where the residual is below 1E-7 mm. The weight does not
    fall steadily with the residual, and data without errors have none at all.

    Args:
        residuals_mm: observed minus computed, (..., n, 2), mm

    Returns:
        The weights, (..., n, 2), 0 to 9.
    """
    size = np.abs(residuals_mm)
    vanishing = size < VANISHING_MM
    weight = LISTED_VARIANCE_MM2 / np.where(vanishing, 1.0, size) ** 2
    weight = np.where(weight > LISTED_LIMIT, LISTED_ABOVE_LIMIT, weight)
    return np.where(vanishing, 0.0, weight)


def huber(
    residuals_mm: Floats,
    used: Bools,
    focal_length_mm: Floats,
    reading_sigma_mm: float | None = None,
) -> Floats:
    """Huber's weights, one a star: 1 for small residuals, falling as 1/length for large ones.

    Args:
        residuals_mm: observed minus computed, (..., n, 2), mm
        used: which stars there are, (..., n)
        focal_length_mm: principal distance, (..., 1), mm; a billionth of it is
            the least bend, so that rounding is not weighed
        reading_sigma_mm: standard deviation of a reading, mm; the bend is at two
            of them. None: from the median residual

    Returns:
        The weights, the same for x and y, (..., n, 2), above 0 and up to 1.
    """
    length = np.hypot(residuals_mm[..., 0], residuals_mm[..., 1])
    if reading_sigma_mm is None:
        count = used.sum(axis=-1, keepdims=True)
        freedom = np.sqrt(2.0 * count / np.maximum(2.0 * count - 3.0, 1.0))
        middle = np.nanmedian(np.where(used, length, np.nan), axis=-1, keepdims=True)
        sigma = middle / MEDIAN_LENGTH * freedom
    else:
        sigma = np.asarray(reading_sigma_mm)
    bend = np.maximum(HUBER_BEND * sigma, 1e-9 * focal_length_mm)
    weight = bend / np.maximum(length, bend)
    return np.broadcast_to(weight[..., None], residuals_mm.shape)


def church_formula_weights(
    image_mm: Floats, focal_length_mm: Floats, reading_sigma_mm: float | None = None
) -> Floats:
    """Weights wP, wQ, wR of direction cosines from errors of the image coordinates.

    Args:
        image_mm: x, y from the principal point, (..., n, 2), mm
        focal_length_mm: principal distance, (..., 1), mm
        reading_sigma_mm: standard deviation of a reading, mm. It keeps wR finite
            at the principal point: to the next order R varies there by
            f**2 (r**2 + sigma**2) sigma**2 / d**6, so that sigma**2 stands
            beside r**2. None: wR is infinite there

    Returns:
        wP, wQ, wR, (..., 3, n), mm**2.

    Source: Rae (1987), eqs. 3.15 to 3.17.
    """
    x2, y2 = image_mm[..., 0] ** 2, image_mm[..., 1] ** 2
    f2 = focal_length_mm**2
    cube = (x2 + y2 + f2) ** 3
    bound = 0.0 if reading_sigma_mm is None else reading_sigma_mm**2
    with np.errstate(divide="ignore"):
        w_p = cube / ((y2 + f2) ** 2 + x2 * y2)
        w_q = cube / ((x2 + f2) ** 2 + x2 * y2)
        w_r = cube / (f2 * (x2 + y2 + bound))
    return np.stack([w_p, w_q, w_r], axis=-2)
