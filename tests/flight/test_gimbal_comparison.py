"""The sentence about the gimbal's angles: rotations about the camera's axes, by hand."""

from __future__ import annotations

import re

import numpy as np

from tests.approved.texts import assert_approved
from vopd.flight.words import gimbal_sentence

NAN = [np.nan] * 3


def right_down_forward(sentence: str) -> list[list[float]]:
    """Read median, least and largest rotation about each axis."""
    number = r"([+-]\d+\.\d\d)"
    found = re.findall(rf"{number} \({number} to {number}\)", sentence)
    return [[float(one) for one in axis] for axis in found]


def test_the_median_is_not_moved_by_one_frame() -> None:
    """A level camera turned to the right by 1, 2, 40 degrees, the short way through north.

    Frame 4 has no gimbal.
    """
    gimbal = np.array([[359.5, 0.0, 0.0], [20.0, 0.0, 0.0], [300.0, 0.0, 0.0], NAN])
    solved = np.array([[0.5, 0.0, 0.0], [22.0, 0.0, 0.0], [340.0, 0.0, 0.0], [1.0, 2.0, 3.0]])
    sentence = gimbal_sentence(solved, gimbal)
    assert_approved(sentence)
    assert right_down_forward(sentence) == [[0, 0, 0], [2, 1, 40], [0, 0, 0]]


def test_near_nadir_yaw_and_roll_do_not_exaggerate() -> None:
    """Straight down with its upper edge to the north, its right is east and its down south.

    Looking 2 degrees east of that turns it to its right, about its down: 2. Its azimuth is then
    90 and its elevation -88, with its right side up: roll -90. Looking 3 degrees north of that
    turns it upward, about its right.
    """
    gimbal = np.array([[0.0, -90.0, 0.0]])
    east = right_down_forward(gimbal_sentence(np.array([[90.0, -88.0, 270.0]]), gimbal))
    assert [axis[0] for axis in east] == [0, 2, 0]
    north = right_down_forward(gimbal_sentence(np.array([[0.0, -87.0, 0.0]]), gimbal))
    assert [axis[0] for axis in north] == [3, 0, 0]


def test_each_axis_by_itself() -> None:
    level = np.zeros((1, 3))
    turned = np.diag([5.0, 6.0, 7.0])
    found = [right_down_forward(gimbal_sentence(one[None], level)) for one in turned]
    assert [[axis[0] for axis in one] for one in found] == [[0, 5, 0], [6, 0, 0], [0, 0, 7]]


def test_frames_without_one_of_both() -> None:
    one = np.zeros((1, 3))
    two = np.concatenate([one, one])
    part = np.array([[0.0, np.nan, 0.0], [1.0, 0.0, 0.0]])  # of one frame no pitch is known
    for solved, gimbal in (
        (one, one),
        (two, two),
        (two, part),
        (one, np.array([NAN])),
        (np.array([NAN]), one),
    ):
        assert_approved(gimbal_sentence(solved, gimbal))
