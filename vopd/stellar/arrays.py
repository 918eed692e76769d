"""Vectors on stacks: the last axis is xyz, every axis before it is a stack."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats

ARCSEC_PER_RADIAN = 3600.0 * 180.0 / np.pi


def dot(a: Floats, b: Floats) -> Floats:
    """Scalar products of (..., 3) and (..., 3): (...)."""
    product: Floats = np.einsum("...i,...i->...", a, b)
    return product


def norm(a: Floats) -> Floats:
    """Lengths of (..., 3): (...)."""
    return np.sqrt(dot(a, a))


def unit(a: Floats) -> Floats:
    """The same directions with length 1; NaN where a vector has no direction."""
    with np.errstate(divide="ignore", invalid="ignore"):
        direction: Floats = a / norm(a)[..., None]
    return direction


def angle_between(a: Floats, b: Floats) -> Floats:
    """Angles between (..., 3) and (..., 3), radians, 0 to pi.

    By the arc tangent: the listings' arc cosine loses half the digits of a
    small angle and fails when rounding takes its argument past 1.
    """
    return np.arctan2(norm(np.cross(a, b)), dot(a, b))


def transform(matrix: Floats, vectors: Floats) -> Floats:
    """(..., 3, 3) applied to each of (..., n, 3): (..., n, 3)."""
    product: Floats = np.einsum("...ij,...nj->...ni", matrix, vectors)
    return product


def inverse(columns: Floats) -> Floats:
    """Inverses of (..., 3, 3), by cross products (INV3X3); not finite where there is none."""
    a, b, c = (columns[..., :, k] for k in range(3))
    rows = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=-2)
    with np.errstate(divide="ignore", invalid="ignore"):
        inverted: Floats = rows / dot(a, np.cross(b, c))[..., None, None]
    return inverted


def rotation(axis: Floats, angle_rad: Floats) -> Floats:
    """Rodrigues' formula: the matrix that turns vectors about a unit axis.

    axis (..., 3), angle (...), positive by the right-hand rule: (..., 3, 3).
    """
    x, y, z = (axis[..., k] for k in range(3))
    zero = np.zeros_like(x)
    cross = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1)
    cross = cross.reshape(*x.shape, 3, 3)
    sine, cosine = np.sin(angle_rad)[..., None, None], np.cos(angle_rad)[..., None, None]
    return np.eye(3) + sine * cross + (1.0 - cosine) * (cross @ cross)


def least_squares(design: Floats, observed: Floats, weights: Floats) -> tuple[Floats, Floats]:
    """Weighted least squares on stacks.

    design (..., n, k), observed and weights (..., n), n >= k. Returns the
    solutions (..., k), not finite where they are undetermined, and the smallest
    over the largest singular value (...), 0 to 1, of the weighted design.
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
