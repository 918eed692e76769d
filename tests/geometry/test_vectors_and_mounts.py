"""Products of stacks of vectors, mounts, partials of images and radial factors, by hand."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.tolerances import assert_close
from vopd.geometry.earth import NED_FROM_ENU, east_north_up
from vopd.geometry.lens import radial_factor
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
    angles_by_turns,
    camera_angles_deg,
    camera_axes,
    mount_by_angles,
    partials_by_turns,
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


def test_the_radial_factor_and_the_centre() -> None:
    found = radial_factor(np.array([0.0, 10.0, 20.0]), np.array([0.5, 0.1, -0.4]))
    assert_close("ratio", found, [1.0, 0.99, 1.02])


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


def test_camera_angles_of_rounded_and_unknown_axes() -> None:
    axes = camera_axes(np.radians([[0.0, 90.0, 0.0]]))
    axes[0, 2, 2] = 1.0 + 1e-15
    assert camera_angles_deg(axes)[0, 1] == 90.0
    assert np.isnan(camera_angles_deg(np.full((1, 3, 3), np.nan))).all()


def test_camera_derivatives_straight_up_are_those_of_least_length() -> None:
    """Yaw turns about down, which is backward there, and roll about forward: half of it each."""
    found = angles_by_turns(np.array([[0.3, np.pi / 2, 0.0]]))[0]
    assert_close("unit rotation", found[:, 2], [-0.5, 0.0, 0.5])
