"""Linear algebra on stacks of small vectors and matrices."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from vopd.arrays import Floats

# Stacks of matrices: one without a result gives NaN and affects no other
#
# numpy raises `LinAlgError` for a whole stack where one of its matrices is singular,
# or its singular values do not converge. Here that matrix, and any with an element
# that is not finite, gives NaN.

FAR_FROM_SINGULAR = 1e6  # a condition number
WELL_DETERMINED = 1e4  # one of normal equations, which are then as good as singular values


def inverse(matrices: Floats) -> Floats:
    """Invert matrices, (..., N, N); NaN where a matrix is singular.

    Args:
        matrices: (..., N, N)
    """
    (found,) = _of_each(_inverses, matrices, np.eye(matrices.shape[-1]))
    return found


def _inverses(matrices: Floats) -> tuple[Any]:
    """Invert matrices at once, those aside whose determinant is 0 by the same factors."""
    try:
        return (np.linalg.inv(matrices),)
    except np.linalg.LinAlgError:
        singular = np.asarray(np.linalg.slogdet(matrices)[0] == 0.0)
        rest = np.where(singular[..., None, None], np.eye(matrices.shape[-1]), matrices)
        return (np.where(singular[..., None, None], np.nan, np.linalg.inv(rest)),)


@np.errstate(all="ignore")
def pseudo_inverse(matrices: Floats) -> Floats:
    """Compute the Moore-Penrose inverses of matrices, (..., N, M).

    Those of square matrices that are far from singular are their inverses, and those of
    tall ones are by the normal equations, which takes a fraction of the time.

    Args:
        matrices: (..., M, N)
    """
    square = matrices.shape[-2] == matrices.shape[-1]
    if matrices.shape[-2] < matrices.shape[-1]:
        return _pseudo_inverse(matrices)
    across = matrices.swapaxes(-1, -2)
    solved_for = matrices if square else across @ matrices
    plain = inverse(solved_for)
    condition = np.linalg.norm(solved_for, axis=(-2, -1)) * np.linalg.norm(plain, axis=(-2, -1))
    near = ~(condition < (FAR_FROM_SINGULAR if square else WELL_DETERMINED))
    found = plain if square else plain @ across
    found[near] = _pseudo_inverse(matrices[near])
    return found


def _pseudo_inverse(matrices: Floats) -> Floats:
    (found,) = _of_each(lambda a: (np.linalg.pinv(a),), matrices, np.zeros(matrices.shape[-2:]))
    return found


def singular_values(matrices: Floats) -> tuple[Floats, Floats]:
    """Decompose matrices into singular values and right singular vectors.

    Args:
        matrices: (..., M, N)

    Returns:
        The sizes, largest first, (..., K), and the vectors as rows, (..., K, N).
    """

    def svd(a: Floats) -> tuple[Floats, Floats]:
        _, sizes, axes = np.linalg.svd(a, full_matrices=False)
        return sizes, axes

    sizes, axes = _of_each(svd, matrices, np.zeros(matrices.shape[-2:]))
    return sizes, axes


def eigenvectors(matrices: Floats) -> Floats:
    """Find eigenvectors of symmetric matrices as columns, (..., N, N), smallest eigenvalue first.

    Args:
        matrices: symmetric, (..., N, N)
    """
    (found,) = _of_each(lambda a: (np.linalg.eigh(a)[1],), matrices, np.eye(matrices.shape[-1]))
    return found


@np.errstate(all="ignore")
def _of_each(
    function: Callable[[Floats], tuple[Any, ...]], matrices: Floats, harmless: Floats
) -> tuple[Floats, ...]:
    """Apply a function to each matrix; NaN for one that is not finite."""
    if np.isfinite(matrices).all():
        return _together(function, matrices, harmless)
    finite = np.asarray(np.isfinite(matrices).all(axis=(-2, -1)))
    safe = np.where(finite[..., None, None], matrices, harmless)
    found = _together(function, safe, harmless)
    missing = (~finite.reshape(finite.shape + (1,) * (one.ndim - finite.ndim)) for one in found)
    return tuple(np.where(gone, np.nan, one) for one, gone in zip(found, missing, strict=True))


def _together(
    function: Callable[[Floats], tuple[Any, ...]], matrices: Floats, harmless: Floats
) -> tuple[Floats, ...]:
    """Apply a function to a stack at once, or to its halves if numpy refuses one of its matrices.

    A singular matrix among thousands costs a dozen calls so, and not a call for each.
    """
    try:
        return function(matrices)
    except np.linalg.LinAlgError:
        stack = matrices.reshape(-1, *matrices.shape[-2:])
        if len(stack) == 1:
            one = function(np.broadcast_to(harmless, matrices.shape))
            return tuple(np.full_like(part, np.nan) for part in one)
        halves = [_together(function, half, harmless) for half in np.array_split(stack, 2)]
        joined = (np.concatenate(parts) for parts in zip(*halves, strict=True))
        return tuple(part.reshape(*matrices.shape[:-2], *part.shape[1:]) for part in joined)


# Stacks of vectors: the last axis is x, y, z

ARCSEC_PER_RADIAN = 3600.0 * 180.0 / np.pi


def dot(a: Floats, b: Floats) -> Floats:
    """Multiply vectors to scalars.

    Args:
        a: vectors, (..., 3)
        b: vectors, (..., 3), broadcast against `a`

    Returns:
        The products, (...).
    """
    product: Floats = np.einsum("...i,...i->...", a, b)
    return product


def norm(a: Floats) -> Floats:
    """Measure the lengths of vectors, (...).

    Args:
        a: vectors (..., 3)
    """
    return np.sqrt(dot(a, a))


def unit(a: Floats) -> Floats:
    """Scale vectors to length 1.

    Args:
        a: vectors, (..., 3)

    Returns:
        Unit vectors, (..., 3); NaN where a vector has length 0.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        direction: Floats = a / norm(a)[..., None]
    return direction


def angle_between(a: Floats, b: Floats) -> Floats:
    """Measure angles between vectors, by the arc tangent.

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
    """Multiply each of a set of vectors by a matrix.

    Args:
        matrix: (..., 3, 3)
        vectors: (..., n, 3)

    Returns:
        The products M v, (..., n, 3).
    """
    product: Floats = np.einsum("...ij,...nj->...ni", matrix, vectors)
    return product


def crossing(vector: Floats) -> Floats:
    """Write the cross product with v as matrices, (..., 3, 3): times w they are v x w.

    Args:
        vector: v, (..., 3)
    """
    matrix = np.zeros((*vector.shape, 3))
    for one, (i, j) in enumerate(((1, 2), (2, 0), (0, 1))):
        matrix[..., i, j], matrix[..., j, i] = -vector[..., one], vector[..., one]
    return matrix


# Confidence ellipses and ellipsoids


def confidence_ellipse(
    covariance: Floats, freedom: float | None = None, probability: float = 0.95
) -> tuple[Floats, Floats]:
    """Draw ellipses that contain the true point with a given probability.

    Args:
        covariance: of the two coordinates, (..., 2, 2)
        freedom: degrees of freedom from which its scale is estimated (F distribution);
            None: the scale is known (chi-square distribution)
        probability: of the ellipse

    Returns:
        Semi-axes (..., 2), the longer one first, and the direction of the longer one (...),
        from the second coordinate toward the first, 0 to pi.
    """
    finite = np.asarray(np.isfinite(covariance).all(axis=(-2, -1), keepdims=True))
    sizes, axes = np.linalg.eigh(np.where(finite, covariance, 0.0))
    missed = 1.0 - probability
    square = -2.0 * np.log(missed)  # both distributions have closed forms for two coordinates
    if freedom is not None:
        square = freedom * (missed ** (-2.0 / freedom) - 1.0)
    semi_axes = np.sqrt(np.maximum(sizes[..., ::-1], 0.0) * square)
    angle = np.arctan2(axes[..., 0, 1], axes[..., 1, 1]) % np.pi
    known = finite[..., 0, 0]
    return np.where(known[..., None], semi_axes, np.nan), np.where(known, angle, np.nan)


def covariance_factor_95(freedom: Floats) -> Floats:
    """Calculate the factor of a 3 x 3 covariance whose ellipsoid contains the truth with 95 %.

    Args:
        freedom: degrees of freedom from which the covariance's scale is estimated, 1 or more, (...)

    Returns:
        3 F(.95; 3, freedom), (...); for infinite degrees the chi-square quantile 7.815.
    """
    from scipy.special import chdtri, fdtri  # `vopd run` needs none of it

    different, which = np.unique(np.clip(freedom, 1.0, 1e9), return_inverse=True)
    factor = (3.0 * fdtri(3.0, different, 0.95))[which].reshape(np.shape(freedom))
    return np.asarray(np.where(np.isinf(freedom), chdtri(3.0, 0.05), factor))
