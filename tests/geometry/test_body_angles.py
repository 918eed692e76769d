"""Yaw, pitch, roll of a body: as three turns by scipy, at the poles, and their derivatives."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.tolerances import assert_close
from vopd.geometry.rotations import (
    LARGEST_DEG,
    body_angles_by_turns,
    body_angles_deg,
    body_axes,
    turns_by_body_angles,
)

ANGLES_DEG = np.random.default_rng(8).uniform((0, -80, 0), (360, 80, 360), (40, 3))
STEP = 1e-4


def turned(angles_deg: np.ndarray) -> Rotation:
    """Yaw about down, then pitch about the new right, then roll about the new forward."""
    return Rotation.from_euler("ZYX", angles_deg, degrees=True)


def test_axes_are_three_turns_and_angles_come_back() -> None:
    expected = turned(ANGLES_DEG).as_matrix()  # forward, right, down as columns
    assert_close("unit rotation", body_axes(np.radians(ANGLES_DEG)), expected)
    assert_close("angle there and back", body_angles_deg(expected), ANGLES_DEG)
    assert_close("angle there and back", body_angles_deg(expected[0]), ANGLES_DEG[0])


@pytest.mark.parametrize(
    ("angles", "shown"),
    [
        ((-30.0, 10.0, -20.0), (330.0, 10.0, 340.0)),
        ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
        ((180.0, 0.0, 180.0), (180.0, 0.0, 180.0)),
        ((30.0, 100.0, 0.0), (210.0, 80.0, 180.0)),  # over the top
        ((40.0, 90.0, 15.0), (25.0, 90.0, 0.0)),  # straight up: yaw less roll
        ((40.0, -90.0, 15.0), (55.0, -90.0, 0.0)),  # straight down: yaw and roll
        ((10.0, 89.999999, 20.0), (10.0, 89.999999, 20.0)),  # 2E-8 rad off straight up
    ],
)
def test_yaw_and_roll_are_0_to_360_and_roll_is_0_straight_up_and_down(
    angles: tuple[float, ...], shown: tuple[float, ...]
) -> None:
    found = body_angles_deg(turned(np.array([angles])).as_matrix())[0]
    assert_close("angle at a pole", (found - shown + 180.0) % 360.0 - 180.0, np.zeros(3))
    assert ((found >= [0.0, -90.0, 0.0]) & (found <= [360.0, 90.0, 360.0])).all()


def test_an_element_beyond_one_by_rounding_is_straight_up_and_nan_stays_so() -> None:
    axes = turned(np.array([[0.0, 90.0, 0.0]])).as_matrix()
    axes[0, 2, 0] = -1.0 - 1e-15
    assert body_angles_deg(axes)[0, 1] == 90.0
    assert np.isnan(body_angles_deg(np.full((1, 3, 3), np.nan))).all()


def test_small_turns_by_the_angles_and_back() -> None:
    for k in range(3):
        change = np.degrees(STEP) / 2 * np.eye(3)[k]
        turn = turned(ANGLES_DEG - change).inv() * turned(ANGLES_DEG + change)
        found = turns_by_body_angles(np.radians(ANGLES_DEG))[..., k]
        assert_close("rae rotation by angles", found, turn.as_rotvec() / STEP)
    both = body_angles_by_turns(np.radians(ANGLES_DEG)) @ turns_by_body_angles(
        np.radians(ANGLES_DEG)
    )
    assert_close("rae rotation", both, np.tile(np.eye(3), (len(ANGLES_DEG), 1, 1)))


def test_derivatives_straight_up_are_those_of_least_length() -> None:
    """Yaw and roll turn about one axis and take half of a turn about it each."""
    found = body_angles_by_turns(np.array([[0.3, np.pi / 2, 0.0]]))[0]
    assert_close("unit rotation", found[:, 0], [-0.5, 0.0, 0.5])
    assert_close("unit rotation", found[1], [0.0, 1.0, 0.0])


def test_angles_are_out_of_range_a_thousandth_beyond_a_circle() -> None:
    assert LARGEST_DEG == 360.001
