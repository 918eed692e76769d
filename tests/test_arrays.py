"""Counting in the rows of an array."""

from __future__ import annotations

import numpy as np

from vopd.arrays import distinct_in_rows


def test_different_values_of_each_row() -> None:
    """5 5 7; nothing used; one 9 of two; the largest number; all alike; and no columns at all."""
    values = np.array([[5, 7, 5], [1, 2, 3], [9, 4, 9], [2**62, 0, 2**62], [6, 6, 6]])
    used = np.array([[1, 1, 1], [0, 0, 0], [1, 0, 1], [1, 1, 0], [1, 1, 1]], bool)
    assert distinct_in_rows(values, used).tolist() == [2, 0, 1, 2, 1]
    assert distinct_in_rows(values[:, :0], used[:, :0]).tolist() == [0] * 5
