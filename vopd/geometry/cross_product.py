"""The cross product with a vector, as a matrix."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats


def crossing(vector: Floats) -> Floats:
    """The matrices that multiply a vector w to give the cross product of v and w, (..., 3, 3).

    Args:
        vector: v, (..., 3)
    """
    matrix = np.zeros((*vector.shape, 3))
    for one, (i, j) in enumerate(((1, 2), (2, 0), (0, 1))):
        matrix[..., i, j], matrix[..., j, i] = -vector[..., one], vector[..., one]
    return matrix
