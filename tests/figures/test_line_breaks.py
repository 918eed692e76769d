"""Where the circle is cut, and where lines of angles are broken, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from tests.kit.histories import by_hand
from vopd.figures import broken, from_cut, in_time, picked, unwrapped_about


@pytest.mark.parametrize(
    ("angles", "cut"),
    [([0.0], -180.0), ([100.0], -80.0), ([350.0, 30.0], -170.0), ([-100.0], -280.0),
     ([20.4, np.nan], -160.0), ([20.6], -159.0), ([90.0, 90.0, 91.0], -90.0)],
)  # fmt: skip
def test_the_cut_is_opposite_to_the_mean(angles: list[float], cut: float) -> None:
    """At a whole degree."""
    assert unwrapped_about(np.array(angles)) == cut


def test_angles_from_the_cut() -> None:
    """The cut itself belongs to the angles that begin there."""
    angles = np.array([-170.0, 190.0, 189.0, 0.0, 720.0])
    assert from_cut(angles, -170.0).tolist() == [-170.0, -170.0, 189.0, 0.0, 0.0]
    assert from_cut(angles, 100.0).tolist() == [190.0, 190.0, 189.0, 360.0, 360.0]


BREAKS = {  # times, angles: the index of each point, -1 at a break
    "three usual steps": ([0, 1, 2, 5, 6], [0, 0, 0, 0, 0], [0, 1, 2, 3, 4]),
    "more": ([0, 1, 2, 5.1, 6], [0, 0, 0, 0, 0], [0, 1, 2, -1, 3, 4]),
    "equal times": ([0, 0, 0, 0, 1, 3.9], [0] * 6, [0, 1, 2, 3, 4, 5]),
    "no steps": ([4, 4, 4], [0, 0, 0], [0, 1, 2]),
    "median and not mean": ([0, 1, 2, 3, 13], [0] * 5, [0, 1, 2, 3, -1, 4]),
    "half a circle": ([0, 1, 2], [0, 180, 0], [0, 1, 2]),
    "over half": ([0, 1, 2, 3], [0, 180.5, 0, 1], [0, -1, 1, -1, 2, 3]),
    "an angle that is none": ([0, 1, 2], [0, np.nan, 0], [0, 1, 2]),
    "one": ([7], [0], [0]),
    "none": ([], [], []),
}


@pytest.mark.parametrize("name", BREAKS)
def test_where_a_line_breaks(name: str) -> None:
    times, angles, expected = BREAKS[name]
    where, index = broken(np.array(times, float), np.array(angles, float))
    assert index.tolist() == expected
    seen = [None if np.isnan(x) else x for x in where.tolist()]
    assert seen == [None if k < 0 else times[k] for k in expected]
    values = picked(np.array(angles, float) + 5.0, index).tolist()
    for value, k in zip(values, expected, strict=True):
        assert np.isnan(value) if k < 0 or np.isnan(angles[k]) else value == angles[k] + 5.0


def test_frames_of_equal_times_stay_in_their_order() -> None:
    """Of more frames than are sorted by insertion."""
    times = np.tile([1.0, 0.0, np.nan, 1.0], 20)
    zeros, ones = np.flatnonzero(times == 0.0), np.flatnonzero(times == 1.0)
    order = in_time(by_hand(80, time_s=times)).tolist()
    assert order == [*zeros.tolist(), *ones.tolist()]
