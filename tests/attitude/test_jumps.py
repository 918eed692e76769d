"""Which frames turn too fast against their neighbours, by yaws and times."""

from __future__ import annotations

import numpy as np
import pytest

from vopd.attitude.flags import jumps

NONE = float("nan")


def jumped(yaws: list[float], times: list[float], rate: float | None) -> list[int]:
    half = np.radians(yaws) / 2.0
    q = np.stack([np.cos(half), 0.0 * half, 0.0 * half, np.sin(half)], axis=1)
    return np.flatnonzero(jumps(np.array(times), q, rate)).tolist()


@pytest.mark.parametrize(
    ("yaws", "times", "expected"),
    [
        ([0.0, 9.9], [0.0, 1.0], []), ([0.0, 10.1], [0.0, 1.0], [0, 1]),
        ([0.0, 10.1], [1.0, 0.0], [0, 1]), ([0.0, 9.9], [1.0, 0.0], []),  # times go back
        ([0.0, 19.9], [0.0, 2.0], []), ([0.0, 20.1], [0.0, 2.0], [0, 1]),
        ([0.0, 0.1], [3.0, 3.0], [0, 1]), ([5.0, 5.0], [3.0, 3.0], []),  # no time between them
        ([0.0], [0.0], []), ([], [], []), ([NONE, 3.0], [0.0, 1.0], []),
        ([0.0, NONE, 15.0], [0.0, 1.0, 2.0], []),  # two seconds apart
        ([0.0, NONE, 25.0], [0.0, 1.0, 2.0], [0, 2]),
        ([0.0, 90.0, 3.0], [0.0, NONE, 1.0], []),  # a frame without a time
        ([0.0, 90.0, 13.0], [0.0, NONE, 1.0], [0, 2]),
        ([355.0, 4.0, 13.0], [0.0, 1.0, 2.0], []), ([0.0, 359.0, 350.0], [0.0, 1.0, 2.0], []),
        ([0.0, 1.0, 30.0, 2.0, 3.0], [0.0, 1.0, 2.0, 3.0, 4.0], [2]),
        ([30.0, 0.0, 1.0], [0.0, 1.0, 2.0], [0]), ([0.0, 1.0, 30.0], [0.0, 1.0, 2.0], [2]),
        ([0.0, 1.0, 30.0, 31.0], [0.0, 1.0, 2.0, 3.0], [1, 2]),
        ([0.0, 30.0, 60.0, 61.0, 62.0], [0.0, 1.0, 2.0, 3.0, 4.0], [0, 1]),
        ([0.0, 1.0, 2.0, 30.0, 60.0], [0.0, 1.0, 2.0, 3.0, 4.0], [3, 4]),
        ([0.0, 1.0, 30.0, 60.0, 61.0, 62.0], [0.0, 1.0, 2.0, 3.0, 4.0, 5.0], [2]),
    ],
)  # fmt: skip
def test_more_than_ten_degrees_a_second(
    yaws: list[float], times: list[float], expected: list[int]
) -> None:
    """Both neighbours, or one that is not itself fast against its other neighbour."""
    assert jumped(yaws, times, 10.0) == expected
    assert jumped(yaws, times, None) == []
