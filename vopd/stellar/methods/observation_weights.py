"""Weights of the observations: the listing's, a sound robust one, and Church's formulas."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Bools, Floats

VANISHING_MM = 1e-7  # RESWTS: TOOLTL
LISTED_VARIANCE_MM2 = 0.000009  # (.003 mm)**2
LISTED_LIMIT, LISTED_ABOVE_LIMIT = 9.0, 3.0

HUBER_BEND = 2.0
"""Length of a residual, in reading sigmas, up to which a star counts fully.

Readings with normal errors in x and y stay within it 86 times of 100."""

MEDIAN_LENGTH = np.sqrt(2.0 * np.log(2.0))
"""Median length of a plane vector with unit normal errors in x and y."""


def listed(residuals_mm: Floats) -> Floats:
    """Weights exactly as RESWTS sets them: residuals (..., n, 2), weights the same shape.

    Each coordinate has its own: (.003 mm / residual)**2, but 3 where that
    passes 9, and 0 where the residual is below 1E-7 mm. So the weight is not
    monotone in the residual, and data without errors have none at all.
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
    """Huber's weights, one a star: residuals (..., n, 2), used (..., n), focal (..., 1).

    1 up to HUBER_BEND reading sigmas, falling as 1/length beyond. The sigma is
    given, or taken from the median residual; a floor of 1e-9 of the focal
    length keeps rounding from being weighed.
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


def church(
    image_mm: Floats, focal_length_mm: Floats, reading_sigma_mm: float | None = None
) -> Floats:
    """wP, wQ, wR (eqs. 3.15 to 3.17) of images (..., n, 2): (..., 3, n), in mm**2.

    wR is infinite at the principal point, unless a reading sigma bounds it.
    With x and y uncertain by sigma, R varies by f**2 (r**2 + sigma**2) sigma**2
    / d**6 to the next order, so that sigma**2 stands beside r**2.
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
