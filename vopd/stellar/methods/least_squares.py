"""Weighted least squares for stacks of problems."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats


def least_squares(design: Floats, observed: Floats, weights: Floats) -> tuple[Floats, Floats]:
    """Weighted least squares by the singular-value decomposition.

    Args:
        design: derivatives of n observations by k unknowns, (..., n, k), n >= k
        observed: the observations, (..., n)
        weights: their weights, (..., n), not negative

    Returns:
        The solutions (..., k), not finite where they are undetermined, and the
        smallest over the largest singular value (...), 0 to 1, of the weighted design.
    """
    root = np.sqrt(weights)
    rows, sides = design * root[..., None], observed * root
    sound = np.isfinite(rows).all(axis=(-2, -1), keepdims=True)
    rows = np.where(sound, rows, 0.0)  # the SVD raises on NaN
    left, singular, right = np.linalg.svd(rows, full_matrices=False)
    with np.errstate(divide="ignore", invalid="ignore"):
        spread = np.nan_to_num(singular[..., -1] / singular[..., 0])
        turned = np.einsum("...nk,...n->...k", left, sides) / singular
        solution: Floats = np.einsum("...kj,...k->...j", right, turned)
    return solution, spread
