"""The texts of many numbers against Python's own formatting, number by number."""

from __future__ import annotations

import numpy as np
import pytest

from vopd.export.number_text import (
    number_text,
    whole_number_text,
    without_gaps,
    word_text,
)

DECIMALS = (0, 1, 4, 6, 8, 10, None)
RNG = np.random.default_rng(5)
ODD = [
    0.0, -0.0, np.nan, np.inf, -np.inf, 1e300, -1e300, 5e-324, -1e-310, 999999.9999995, 9.9999995,
    99.99999951, -0.9999999999, 1e15, 1e16, -(2.0**53), 2.0**63, 1e99, 1e100, -1e-99, 1e-100,
    9.9999999e99, 9.9999996e-100,
]  # fmt: skip


def expected(value: float, decimals: int | None) -> str:
    if np.isnan(value):
        return ""
    return f"{value:.6e}" if decimals is None else f"{value:.{decimals}f}"


def assert_as_python(values: np.ndarray, decimals: int | None) -> None:
    found = [without_gaps(one).decode() for one in number_text(values, decimals)]
    assert found == [expected(value, decimals) for value in values.tolist()]


@pytest.mark.parametrize("decimals", DECIMALS)
def test_numbers_of_all_sizes(decimals: int | None) -> None:
    for power in range(-110, 111, 5):
        values = RNG.normal(size=100) * 10.0**power
        assert_as_python(values, decimals)
        assert_as_python(values.round(3), decimals)
    assert_as_python(10.0 ** np.arange(-320, 309), decimals)
    assert_as_python(RNG.integers(-(2**63), 2**63 - 1, 2000).view(np.float64), decimals)


@pytest.mark.parametrize("decimals", DECIMALS)
def test_ties_are_decided_by_the_exact_value(decimals: int | None) -> None:
    halves = RNG.integers(-(10**7), 10**7, 3000) + 0.5
    for scale in (1.0, 10.0 ** -(decimals or 6), 0.25, 2.0**-10):
        assert_as_python(halves * scale, decimals)
        assert_as_python(np.nextafter(halves * scale, np.inf), decimals)


@pytest.mark.parametrize("decimals", DECIMALS)
def test_numbers_that_are_written_one_by_one(decimals: int | None) -> None:
    assert_as_python(np.array(ODD), decimals)
    for value in ODD:
        assert_as_python(np.array([value]), decimals)
    assert number_text(np.zeros((0, 3)), decimals).shape[:2] == (0, 3)


def test_columns_stand_side_by_side() -> None:
    text = number_text(np.array([[1.5, -20.25], [np.nan, 3.0]]), 1)
    assert [[without_gaps(cell) for cell in row] for row in text] == [
        [b"1.5", b"-20.2"],
        [b"", b"3.0"],
    ]


def test_whole_numbers_and_words() -> None:
    numbers = np.array([0, 7, -7, 10, 12345, -98765, 10**15, -(10**18)])
    assert [without_gaps(one) for one in whole_number_text(numbers)] == [
        str(one).encode() for one in numbers.tolist()
    ]
    words = ["", "two words", "größer", "日本", "two words"]
    assert [without_gaps(one).decode() for one in word_text(words)] == words
    assert word_text([]).shape == (0, 0)
