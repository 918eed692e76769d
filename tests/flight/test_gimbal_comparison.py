"""The sentence about the gimbal's angles: medians and ranges, by hand."""

from __future__ import annotations

import numpy as np

from vopd.flight.estimate import gimbal_sentence

NAN = [np.nan] * 3


def test_the_median_is_not_moved_by_one_frame() -> None:
    """Solved less gimbal in yaw: 1, 2, 40, the short way through north; frame 4 has no gimbal."""
    gimbal = np.array([[359.5, -10.0, 0.0], [20.0, -10.0, 1.0], [300.0, -10.0, 2.0], NAN])
    solved = np.array(
        [[0.5, -10.5, 0.25], [22.0, -10.25, 1.5], [340.0, -12.0, 1.0], [1.0, 2.0, 3.0]]
    )
    assert gimbal_sentence(solved, gimbal) == (
        "not used; solved less gimbal, degrees, median of 3 frames and range: "
        "yaw +2.00 (+1.00 to +40.00), pitch -0.50 (-2.00 to -0.25), roll +0.25 (-1.00 to +0.50)"
    )


def test_one_frame_and_none() -> None:
    one = np.array([[10.0, -10.0, 0.0]])
    assert "median of 1 frame and range: yaw +1.00 (+1.00 to +1.00)" in gimbal_sentence(
        one + 1.0, one
    )
    two = np.concatenate([one, one])
    assert "median of 2 frames and range: yaw" in gimbal_sentence(two + 1.0, two)
    part = np.array([[10.0, np.nan, 0.0], [11.0, -11.0, 1.0]])  # of one frame no pitch is known
    assert "median of 1 frame and range: yaw -1.00" in gimbal_sentence(two, part)
    none = "in the images' tags, and no frame with an attitude has them"
    assert gimbal_sentence(one, np.array([NAN])) == gimbal_sentence(np.array([NAN]), one) == none
