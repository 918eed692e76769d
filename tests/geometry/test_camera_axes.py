"""A camera's axes by its yaw, pitch and roll: by hand, and as three rotations by scipy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.tolerances import assert_close
from vopd.geometry.rotations import (
    ahead,
    angles_by_turns,
    camera_angles_deg,
    camera_axes,
    turns_by_angles,
)

EAST, NORTH, UP = np.eye(3)
ANGLES_DEG = np.random.default_rng(3).uniform((0, -80, 0), (360, 80, 360), (50, 3))
STEP_RAD = 1e-4


@pytest.mark.parametrize(
    ("angles_deg", "axes"),
    [
        ((0, 0, 0), (-EAST, UP, NORTH)),  # level, to the north: image x points west
        ((90, 0, 0), (NORTH, UP, EAST)),  # yaw turns from north to east
        ((180, 0, 0), (EAST, UP, -NORTH)),
        ((0, 90, 0), (-EAST, -NORTH, UP)),  # pitch raises the optical axis
        ((0, -90, 0), (-EAST, NORTH, -UP)),
        ((0, 0, 90), (UP, EAST, NORTH)),  # roll turns image y toward the east there
        ((90, 0, 180), (-NORTH, -UP, EAST)),
    ],
)
def test_axes_by_hand(angles_deg: tuple[float, ...], axes: tuple[np.ndarray, ...]) -> None:
    """Several frames of the same angles too, two and three of them: rows stay rows."""
    for frames in (1, 2, 3):
        found = camera_axes(np.radians(np.tile(np.array(angles_deg, float), (frames, 1))))
        assert_close("rae element", found, np.tile(np.array(axes), (frames, 1, 1)))


def test_axes_as_three_rotations() -> None:
    """Of the camera that looks north: about its optical axis, then about west, then about down."""
    level = np.array([-EAST, UP, NORTH])
    expected = [
        Rotation.from_rotvec(-yaw * UP).apply(
            Rotation.from_rotvec(pitch * EAST).apply(
                Rotation.from_rotvec(roll * NORTH).apply(level)
            )
        )
        for yaw, pitch, roll in np.radians(ANGLES_DEG)
    ]
    assert_close("rae element", camera_axes(np.radians(ANGLES_DEG)), expected)


def test_angles_of_axes() -> None:
    found = camera_angles_deg(camera_axes(np.radians(ANGLES_DEG)))
    assert_close("rae rotation", found, ANGLES_DEG)


def test_small_rotations_by_angles() -> None:
    """By central differences: the rotation from one attitude to the next, in camera axes."""
    radians = np.radians(ANGLES_DEG)
    expected = np.empty((len(radians), 3, 3))
    for k in range(3):
        change = STEP_RAD / 2 * np.eye(3)[k]
        before, after = camera_axes(radians - change), camera_axes(radians + change)
        turn = before @ after.swapaxes(1, 2)  # takes the axes before to those after, in the camera
        expected[:, :, k] = Rotation.from_matrix(turn).as_rotvec() / STEP_RAD
    assert_close("rae rotation by angles", turns_by_angles(radians), expected)
    product = angles_by_turns(radians) @ turns_by_angles(radians)
    assert_close("rae rotation", product, np.tile(np.eye(3), (len(radians), 1, 1)))


def test_what_is_ahead() -> None:
    axes = camera_axes(np.zeros((2, 3)))
    direction = np.array([[NORTH, -NORTH, EAST], [0.6 * NORTH + 0.8 * UP, UP, NORTH]])
    assert_close("rae element", ahead(axes, direction), [[1.0, -1.0, 0.0], [0.6, 0.0, 1.0]])
    slanted = camera_axes(np.radians([[37.0, 25.0, 110.0]]))
    yaw, pitch = np.radians([37.0, 25.0])
    view = [np.sin(yaw) * np.cos(pitch), np.cos(yaw) * np.cos(pitch), np.sin(pitch)]
    assert_close("rae element", ahead(slanted, np.eye(3)[None]), [view])
