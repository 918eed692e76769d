"""Weights of whole stars, and how the directions of images depend on their coordinates."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.stellar.field import StarField


def star_weights(field: StarField) -> Floats:
    """Weights of the stars' directions, (..., n): the inverse mean variance of x and y."""
    if field.errors is None:
        return field.used.astype(np.float64)
    variance = np.trace(field.errors, axis1=-2, axis2=-1) / 2.0
    return np.where(field.used, 1.0 / variance, 0.0)


def ray_partials(field: StarField) -> Floats:
    """Derivatives of the directions P, Q, R by image x and y, (..., n, 3, 2), per mm."""
    photo = field.photo
    with np.errstate(divide="ignore"):
        distance = field.focal_length_mm / -photo[..., 2]  # from the lens to the image
    across = np.eye(3)[:, :2] - photo[..., :, None] * photo[..., None, :2]
    partials = across / distance[..., None, None]
    return np.where(field.used[..., None, None], partials, 0.0)


def direction_weights(field: StarField, reading_sigma_mm: float | None) -> Floats:
    """Weights of P, Q and R from the covariance of each star's image coordinates.

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
