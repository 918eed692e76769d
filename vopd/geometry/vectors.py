"""Products, lengths and angles of stacks of vectors: the last axis is x, y, z."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats

ARCSEC_PER_RADIAN = 3600.0 * 180.0 / np.pi


def dot(a: Floats, b: Floats) -> Floats:
    """Scalar products of vectors.

    Args:
        a: vectors, (..., 3)
        b: vectors, (..., 3), broadcast against `a`

    Returns:
        The products, (...).
    """
    product: Floats = np.einsum("...i,...i->...", a, b)
    return product


def norm(a: Floats) -> Floats:
    """Lengths of vectors, (...).

    Args:
        a: vectors (..., 3)
    """
    return np.sqrt(dot(a, a))


def unit(a: Floats) -> Floats:
    """Vectors of length 1 in the same directions.

    Args:
        a: vectors, (..., 3)

    Returns:
        Unit vectors, (..., 3); NaN where a vector has length 0.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        direction: Floats = a / norm(a)[..., None]
    return direction


def angle_between(a: Floats, b: Floats) -> Floats:
    """Angles between vectors, computed by the arc tangent.

    An arc cosine would lose half the digits of a small angle, and fail where
    rounding takes its argument past 1.

    Args:
        a: vectors of any length, (..., 3)
        b: vectors of any length, (..., 3), broadcast against `a`

    Returns:
        The angles, (...), radians, 0 to pi.
    """
    return np.arctan2(norm(np.cross(a, b)), dot(a, b))


def transform(matrix: Floats, vectors: Floats) -> Floats:
    """Each of a set of vectors multiplied by a matrix.

    Args:
        matrix: (..., 3, 3)
        vectors: (..., n, 3)

    Returns:
        The products M v, (..., n, 3).
    """
    product: Floats = np.einsum("...ij,...nj->...ni", matrix, vectors)
    return product
