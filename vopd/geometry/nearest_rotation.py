"""The rotation nearest to a matrix, by its singular values."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats


class NearestRotation(NamedTuple):
    """Rotations and how well they are determined.

    `rotation` (..., 3, 3) is NaN where the matrix is not finite. `largest` (...) is the
    largest singular value; `second` (...) is the second one plus the third, the third
    with the sign of the matrix's determinant: where it is 0 the rotation about one axis
    is not determined.
    """

    rotation: Floats
    largest: Floats
    second: Floats


def nearest_rotation(matrix: Floats) -> NearestRotation:
    """The rotations whose elements differ least from those of matrices in the sum of squares.

    Args:
        matrix: (..., 3, 3)

    Source: F. L. Markley, Attitude determination using vector observations and
    the singular value decomposition, J. Astronautical Sciences 36 (1988).
    """
    finite = np.isfinite(matrix).all(axis=(-2, -1), keepdims=True)
    left, sizes, right = np.linalg.svd(np.where(finite, matrix, 0.0))
    sign = np.sign(np.linalg.det(left) * np.linalg.det(right))
    left = left * np.stack([np.ones_like(sign), np.ones_like(sign), sign], axis=-1)[..., None, :]
    return NearestRotation(
        rotation=np.where(finite, left @ right, np.nan),
        largest=sizes[..., 0],
        second=sizes[..., 1] + sign * sizes[..., 2],
    )
