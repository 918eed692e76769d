"""Counting in the rows of an array, and finding numbers among others."""

from __future__ import annotations

import numpy as np

from vopd.arrays import among, distinct_in_rows, in_four_bytes


def test_different_values_of_each_row() -> None:
    """5 5 7; nothing used; one 9 of two; the largest number; all alike; and no columns at all."""
    values = np.array([[5, 7, 5], [1, 2, 3], [9, 4, 9], [2**62, 0, 2**62], [6, 6, 6]])
    used = np.array([[1, 1, 1], [0, 0, 0], [1, 0, 1], [1, 1, 0], [1, 1, 1]], bool)
    assert distinct_in_rows(values, used).tolist() == [2, 0, 1, 2, 1]
    assert distinct_in_rows(values[:, :0], used[:, :0]).tolist() == [0] * 5


def test_which_are_among_some() -> None:
    """Few are compared one by one, many by sorting: 10,000 comparisons, and 10,001."""
    values = np.array([3, 1, 4, 1, 5])
    assert among(values, np.array([1, 5])).tolist() == [False, True, False, True, True]
    assert among(values, np.array([], np.int64)).tolist() == [False] * 5
    assert among(values[:0], values).tolist() == []
    for count in (2000, 2001):
        some = np.arange(2, 2 + count)
        assert among(values, some).tolist() == [True, False, True, False, True]


def test_indices_in_half_of_their_memory() -> None:
    found = in_four_bytes(np.array([0, 2**31 - 1, 70_000]))
    assert found.dtype == np.int32 and found.tolist() == [0, 2**31 - 1, 70_000]
    already = np.array([1, 2], np.int32)
    assert in_four_bytes(already) is already  # type: ignore[arg-type]
