"""The array types for annotations, and a function that counts different values in rows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


def distinct_in_rows(values: Ints, used: Bools) -> Ints:
    """The number of different values in each row, (F,).

    Args:
        values: whole numbers, as landmark numbers, (F, L)
        used: which of them count, (F, L)
    """
    order = np.argsort(np.where(used, values, np.iinfo(np.int64).max), axis=1, kind="stable")
    ordered, kept = np.take_along_axis(values, order, 1), np.take_along_axis(used, order, 1)
    new = kept.copy()
    new[:, 1:] &= ~kept[:, :-1] | (ordered[:, 1:] != ordered[:, :-1])
    return np.asarray(new.sum(axis=1))
