"""Weighted least squares for stacks of small problems."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats


class LeastSquares(NamedTuple):
    """Solutions of a stack of least-squares problems.

    Attributes:
        unknowns: (..., k), not finite where they are undetermined
        spread: smallest over largest singular value of the weighted design, (...), 0 to 1
    """

    unknowns: Floats
    spread: Floats


def least_squares(design: Floats, observed: Floats, weights: Floats) -> LeastSquares:
    """Weighted least squares by orthogonalisation of the design's columns.

    The columns are made orthogonal one after the other (modified Gram-Schmidt),
    each step for the whole stack at once. This is as accurate as a
    singular-value decomposition of each design and several times faster.

    Args:
        design: derivatives of n observations by k unknowns, (..., n, k), n >= k
        observed: the observations, (..., n)
        weights: their weights, (..., n), not negative

    Returns:
        The solutions and how well each design determines them.
    """
    root = np.sqrt(weights)
    count = design.shape[-1]
    columns = [design[..., k] * root for k in range(count)]
    side = observed * root
    triangle = np.zeros((*side.shape[:-1], count, count))
    projected = []
    with np.errstate(divide="ignore", invalid="ignore"):
        for k in range(count):
            triangle[..., k, k] = length = np.sqrt(_sum_of_products(columns[k], columns[k]))
            direction = columns[k] / length[..., None]
            for later in range(k + 1, count):
                triangle[..., k, later] = along = _sum_of_products(direction, columns[later])
                columns[later] = columns[later] - along[..., None] * direction
            projected.append(_sum_of_products(direction, side))
            side = side - projected[k][..., None] * direction
        unknowns = np.empty((*side.shape[:-1], count))
        for k in reversed(range(count)):
            known = sum(
                (triangle[..., k, j] * unknowns[..., j] for j in range(k + 1, count)), start=0.0
            )
            unknowns[..., k] = (projected[k] - known) / triangle[..., k, k]
    return LeastSquares(unknowns, _spread(triangle))


def _spread(matrix: Floats) -> Floats:
    """Smallest over largest singular value; 0 where an element is not finite."""
    finite = np.isfinite(matrix).all(axis=(-2, -1), keepdims=True)
    singular = np.linalg.svd(np.where(finite, matrix, 0.0), compute_uv=False)
    with np.errstate(invalid="ignore"):
        return np.nan_to_num(singular[..., -1] / singular[..., 0])


def _sum_of_products(a: Floats, b: Floats) -> Floats:
    total: Floats = np.einsum("...n,...n->...", a, b)
    return total
