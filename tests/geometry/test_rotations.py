"""Rotations, axes and angles: products of stacks, mounts, turns, partials of images, by hand."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.tolerances import assert_close
from vopd.geometry.earth import NED_FROM_ENU, east_north_up
from vopd.geometry.linear import (
    ARCSEC_PER_RADIAN,
    angle_between,
    crossing,
    dot,
    norm,
    transform,
    unit,
)
from vopd.geometry.rotations import (
    DOWN,
    FORWARD,
    LARGEST_DEG,
    ahead,
    angles_by_turns,
    body_angles_by_turns,
    body_angles_deg,
    body_axes,
    camera_angles_deg,
    camera_axes,
    mount_by_angles,
    partials_by_turns,
    rotation_matrices,
    turns_by_angles,
    turns_by_body_angles,
)

RIGHT, BELOW, AHEAD = np.eye(3)  # the camera's axes, and forward, right, down of a body
V, W = np.array([[1.0, 2.0, 3.0], [-4.0, 0.5, 2.0]]), np.array([[3.0, -1.0, 2.0], [0.0, 5.0, 1.0]])


def test_products_lengths_and_angles_of_vectors() -> None:
    assert dot(V, W).tolist() == [7.0, 4.5]
    assert_close("ratio", norm(V), [np.sqrt(14.0), np.sqrt(20.25)])
    assert_close("ratio", norm(unit(V)), [1.0, 1.0])
    assert np.isnan(unit(np.zeros((1, 3)))).all()
    assert_close("ratio", crossing(V) @ W[..., None], np.cross(V, W)[..., None])
    assert_close("ratio", ARCSEC_PER_RADIAN, 206264.80624709636)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1.0, np.pi / 2, np.pi - 1e-9, np.pi])
def test_angles_between_vectors_of_any_length(angle: float) -> None:
    other = 7.0 * np.array([np.cos(angle), np.sin(angle), 0.0])
    assert_close("unit element", angle_between(np.array([3.0, 0.0, 0.0]), other), angle)


def test_a_matrix_times_each_vector() -> None:
    matrix = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 2.0], [3.0, 0.0, 0.0]])
    assert transform(matrix, V).tolist() == [[2.0, 6.0, 3.0], [0.5, 4.0, -12.0]]


def test_mounts_by_name() -> None:
    """Forward: the camera's z is forward, its x right, its y down. Down: its top is forward."""
    forward, right, down = np.eye(3)
    for mount, axes in ((FORWARD, (right, down, forward)), (DOWN, (right, -forward, down))):
        for camera_axis, body_axis in zip(np.eye(3), axes, strict=True):
            assert np.array_equal(mount @ camera_axis, body_axis)
        assert np.linalg.det(mount) == 1.0


@pytest.mark.parametrize("angles", [(90.0, 0.0, 0.0), (0.0, -90.0, 0.0), (20.0, 35.0, -50.0)])
def test_mounts_by_angles_are_three_turns_in_order(angles: tuple[float, ...]) -> None:
    turn = Rotation.from_euler("ZYX", angles, degrees=True).as_matrix()
    assert_close("unit rotation", mount_by_angles(angles), turn @ FORWARD)


def test_partials_of_an_image_by_differences() -> None:
    """Of a direction that is turned about x, y and z; a distance below 0 turns the image over."""
    direction, step = np.array([0.3, -0.2, 1.0]), 1e-6
    for distance in (1.0, 152.0, -152.0):
        found = partials_by_turns(np.array(0.3), np.array(-0.2), distance)
        for axis in range(3):
            turn = Rotation.from_rotvec(step * np.eye(3)[axis])
            there, back = turn.apply(direction), turn.inv().apply(direction)
            slope = (there[:2] / there[2] - back[:2] / back[2]) / (2 * step)
            assert_close("derivative by steps", found[:, axis] / distance, slope)
    many = partials_by_turns(np.array([0.3, 0.1]), np.array([-0.2, 0.4]), np.array([2.0, 3.0]))
    assert_close("ratio", many[1], partials_by_turns(np.array(0.1), np.array(0.4), 3.0))


def test_local_axes_by_hand() -> None:
    """At 90 degrees east on the equator, and at the pole; NED and ENU exchange into each other."""
    found = east_north_up(np.array([0.0, np.pi / 2]), np.array([np.pi / 2, 0.0]))
    assert_close("unit rotation", found[..., 0], [[-1, 0, 0], [0, 0, 1], [0, 1, 0]])
    assert_close("unit rotation", found[..., 1], [[0, 1, 0], [-1, 0, 0], [0, 0, 1]])
    slanted = east_north_up(np.array(0.4), np.array(0.9))
    assert_close("unit rotation", slanted @ slanted.T, np.eye(3))
    assert_close("unit rotation", np.linalg.det(slanted), 1.0)
    assert (NED_FROM_ENU @ [1.0, 2.0, 3.0]).tolist() == [2.0, 1.0, -3.0]


@pytest.mark.parametrize(
    ("angles", "shown"),
    [
        ((-30.0, 10.0, -20.0), (330.0, 10.0, 340.0)),
        ((40.0, 90.0, 15.0), (55.0, 90.0, 0.0)),
        ((40.0, -90.0, 15.0), (25.0, -90.0, 0.0)),
        ((10.0, 89.999999, 20.0), (10.0, 89.999999, 20.0)),
    ],
)
def test_camera_angles_are_0_to_360_and_roll_is_0_straight_up_and_down(
    angles: tuple[float, ...], shown: tuple[float, ...]
) -> None:
    axes = camera_axes(np.radians([angles]))
    found = camera_angles_deg(axes)[0]
    assert ((found >= [0.0, -90.0, 0.0]) & (found <= [360.0, 90.0, 360.0])).all()
    assert_close("rae element near a pole", camera_axes(np.radians(found[None])), axes)
    if abs(angles[1]) == 90.0:
        assert found[2] == 0.0
    else:
        assert_close("angle at a pole", found, shown)


@pytest.mark.parametrize("off_deg", [1e-3, 1e-5, 1e-7, 1e-9])
def test_angles_beside_straight_up_and_down_are_those_of_the_rounded_turn(off_deg: float) -> None:
    """By hand: yaw and roll alone are as uncertain as the small elements, all three are not."""
    yaw, roll = np.linspace(3.0, 357.0, 60), np.linspace(1.0, 340.0, 60)
    angles = np.stack([yaw, np.tile([1.0, -1.0], 30) * (90.0 - off_deg), roll], axis=1)
    rounded = turned(angles).as_matrix() + 1e-15 * np.resize([1.0, -1.0, 0.5, -0.7], (60, 3, 3))
    back = turned(body_angles_deg(rounded)).as_matrix()
    assert_close("unit rotation", back, turned(angles).as_matrix())
    view = camera_axes(np.radians(angles)) + 1e-15 * np.resize([1.0, -1.0, 0.7], (60, 3, 3))
    back = camera_axes(np.radians(camera_angles_deg(view)))
    assert_close("unit rotation", back, camera_axes(np.radians(angles)))


def test_camera_angles_of_rounded_and_unknown_axes() -> None:
    axes = camera_axes(np.radians([[0.0, 90.0, 0.0]]))
    axes[0, 2, 2] = 1.0 + 1e-15
    assert camera_angles_deg(axes)[0, 1] == 90.0
    assert np.isnan(camera_angles_deg(np.full((1, 3, 3), np.nan))).all()


def test_camera_derivatives_straight_up_are_those_of_least_length() -> None:
    """Yaw turns about down, which is backward there, and roll about forward: half of it each."""
    found = angles_by_turns(np.array([[0.3, np.pi / 2, 0.0]]))[0]
    assert_close("unit rotation", found[:, 2], [-0.5, 0.0, 0.5])


# Yaw, pitch, roll of a body: as three turns by scipy, at the poles, and their derivatives


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


def test_an_angle_below_0_by_rounding_is_no_whole_turn() -> None:
    axes = turned(np.array([[0.0, 0.0, 0.0]])).as_matrix()
    axes[0, 1, 0] = axes[0, 2, 1] = -1e-20
    assert body_angles_deg(axes)[0].tolist() == [0.0, 0.0, 0.0]


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


# A camera's axes by its yaw, pitch and roll: by hand, and as three rotations by scipy


EAST, NORTH, UP = np.eye(3)
MORE_ANGLES_DEG = np.random.default_rng(3).uniform((0, -80, 0), (360, 80, 360), (50, 3))
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
        for yaw, pitch, roll in np.radians(MORE_ANGLES_DEG)
    ]
    assert_close("rae element", camera_axes(np.radians(MORE_ANGLES_DEG)), expected)


def test_angles_of_axes() -> None:
    found = camera_angles_deg(camera_axes(np.radians(MORE_ANGLES_DEG)))
    assert_close("rae rotation", found, MORE_ANGLES_DEG)


def test_small_rotations_by_angles() -> None:
    """By central differences: the rotation from one attitude to the next, in camera axes."""
    radians = np.radians(MORE_ANGLES_DEG)
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


# Rotations by their vector against scipy's `Rotation`


@pytest.mark.parametrize("size_rad", [0.0, 1e-12, 1e-6, 9e-4, 1.1e-3, 0.1, 1.0, 3.0, 30.0])
def test_matrices_as_scipy_has_them(size_rad: float) -> None:
    vector = size_rad * np.random.default_rng(5).uniform(-1.0, 1.0, (200, 3))
    assert_close("rae element", rotation_matrices(vector), Rotation.from_rotvec(vector).as_matrix())
