"""Weights of observations and stars, and weighted least squares for stacks of small problems."""

from __future__ import annotations

from typing import Literal

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.geometry.linear import inverse, singular_values
from vopd.geometry.rotation_fit import huber_weight
from vopd.stellar.field import StarField

# Weights of observations: as listed, robust, and by Church's formulas

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
    """Weigh the image coordinates by one of the three rules.

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
    """Weigh residuals exactly as subroutine RESWTS does.

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
    """Weigh stars by Huber's rule: 1 for small residuals, falling as 1/length for large ones.

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
    return np.broadcast_to(huber_weight(length, bend)[..., None], residuals_mm.shape)


def church_formula_weights(
    image_mm: Floats, focal_length_mm: Floats, reading_sigma_mm: float | None = None
) -> Floats:
    """Weigh direction cosines by wP, wQ, wR, from errors of the image coordinates.

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


# Weights of stars and of directions


def star_weights(field: StarField) -> Floats:
    """Weigh the stars' directions, (..., n), by the inverse mean variance of x and y."""
    if field.errors is None:
        return field.used.astype(np.float64)
    variance = np.trace(field.errors, axis1=-2, axis2=-1) / 2.0
    return np.where(field.used, 1.0 / variance, 0.0)


def ray_partials(field: StarField) -> Floats:
    """Differentiate the directions P, Q, R by image x and y, (..., n, 3, 2), per mm."""
    photo = field.photo
    with np.errstate(divide="ignore"):
        distance = field.focal_length_mm / -photo[..., 2]  # from the lens to the image
    across = np.eye(3)[:, :2] - photo[..., :, None] * photo[..., None, :2]
    partials = across / distance[..., None, None]
    return np.where(field.used[..., None, None], partials, 0.0)


def direction_weights(field: StarField, reading_sigma_mm: float | None) -> Floats:
    """Weigh P, Q and R by the covariance of each star's image coordinates.

    Args:
        field: the stars, with `errors`
        reading_sigma_mm: standard deviation of a reading; keeps the weight of R finite
            at the principal point, as in `church_formula_weights`

    Returns:
        wP, wQ, wR, (..., 3, n), mm**2.

    Source: Rae (1987), eqs. 3.13 and 3.14.
    """
    partials = ray_partials(field)
    errors = np.broadcast_to(np.eye(2), (*field.used.shape, 2, 2))
    if field.errors is not None:
        errors = field.errors
    variance = np.einsum("...nki,...nij,...nkj->...kn", partials, errors, partials)
    if reading_sigma_mm is not None:
        image, f = field.image_mm, field.focal_length_mm
        cube = ((image**2).sum(axis=-1) + f**2) ** 3
        size = np.trace(errors, axis1=-2, axis2=-1) / 2.0
        variance[..., 2, :] += f**2 * (size * reading_sigma_mm) ** 2 / cube
    with np.errstate(divide="ignore"):
        return np.asarray(1.0 / variance)


# Least squares


def least_squares(design: Floats, observed: Floats, weights: Floats) -> tuple[Floats, Floats]:
    """Solve weighted least squares by orthogonalisation of the design's columns.

    Args:
        design: derivatives of n observations by k unknowns, (..., n, k)
        observed: the observations, (..., n)
        weights: their weights, (..., n), not negative

    Returns:
        The unknowns, (..., k), not finite where they are undetermined, and the smallest over
        the largest singular value of the weighted design, (...), 0 to 1.
    """
    count, unknown = design.shape[-2:]
    if count < unknown:
        return np.full((*observed.shape[:-1], unknown), np.nan), np.zeros(observed.shape[:-1])
    root = np.sqrt(weights)
    orthogonal, triangle = np.linalg.qr(design * root[..., None])
    side = np.einsum("...nk,...n->...k", orthogonal, observed * root)
    unknowns = np.einsum("...kl,...l->...k", inverse(triangle), side)
    sizes, _ = singular_values(triangle)
    with np.errstate(invalid="ignore"):
        return unknowns, np.nan_to_num(sizes[..., -1] / sizes[..., 0])
