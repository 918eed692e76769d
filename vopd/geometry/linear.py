"""Linear algebra on stacks of matrices; a matrix without a result gives NaN and affects no other.

numpy raises `LinAlgError` for a whole stack where one of its matrices is singular,
or its singular values do not converge. Here that matrix, and any with an element
that is not finite, gives NaN.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from vopd.arrays import Floats

FAR_FROM_SINGULAR = 1e6  # a condition number
WELL_DETERMINED = 1e4  # one of normal equations, which are then as good as singular values


class SingularValues(NamedTuple):
    """Singular values, largest first, (..., K), and the right singular vectors as rows."""

    sizes: Floats
    axes: Floats


def inverse(matrices: Floats) -> Floats:
    """The inverses of matrices, (..., N, N); NaN where a matrix is singular.

    Args:
        matrices: (..., N, N)
    """
    (found,) = _of_each(lambda a: (np.linalg.inv(a),), matrices, np.eye(matrices.shape[-1]))
    return found


@np.errstate(all="ignore")
def pseudo_inverse(matrices: Floats) -> Floats:
    """The Moore-Penrose inverses of matrices, (..., N, M).

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


def singular_values(matrices: Floats) -> SingularValues:
    """Singular values and right singular vectors of matrices.

    Args:
        matrices: (..., M, N)
    """

    def svd(a: Floats) -> tuple[Floats, Floats]:
        _, sizes, axes = np.linalg.svd(a, full_matrices=False)
        return sizes, axes

    return SingularValues(*_of_each(svd, matrices, np.zeros(matrices.shape[-2:])))


def eigenvectors(matrices: Floats) -> Floats:
    """Eigenvectors of symmetric matrices as columns, (..., N, N), smallest eigenvalue first.

    Args:
        matrices: symmetric, (..., N, N)
    """
    (found,) = _of_each(lambda a: (np.linalg.eigh(a)[1],), matrices, np.eye(matrices.shape[-1]))
    return found


@np.errstate(all="ignore")
def _of_each(
    function: Callable[[Floats], tuple[Any, ...]], matrices: Floats, harmless: Floats
) -> tuple[Floats, ...]:
    """The results for each matrix; those that are not finite are replaced by a harmless one."""
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
    """The results for each matrix; NaN for one of which numpy says that it has none."""
    try:
        return function(matrices)
    except np.linalg.LinAlgError:
        return _one_by_one(function, matrices, harmless)


def _one_by_one(
    function: Callable[[Floats], tuple[Any, ...]], matrices: Floats, harmless: Floats
) -> tuple[Floats, ...]:
    stack = matrices.reshape(-1, *matrices.shape[-2:])
    results = []
    for matrix in stack:
        try:
            results.append(function(matrix))
        except np.linalg.LinAlgError:
            results.append(tuple(np.full_like(one, np.nan) for one in function(harmless)))
    stacked = (np.stack(parts) for parts in zip(*results, strict=True))
    return tuple(part.reshape(*matrices.shape[:-2], *part.shape[1:]) for part in stacked)
