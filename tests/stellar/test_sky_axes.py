"""Where cameras point on the sky and on the Earth, from axes that are laid down by hand."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.tolerances import assert_close
from vopd.geometry.rotations import DOWN, FORWARD, mount_by_angles
from vopd.stellar.sky import BODY_FRAME, CAMERA_FRAME, SkyFrame, axes_of_body, sky_pointing

LOCAL = Rotation.from_euler("zyx", [40.0, -50.0, 70.0], degrees=True).as_matrix()
"""From ICRF axes to east, north, up."""

OF_DATE = Rotation.from_euler("zyx", [10.0, 20.0, -30.0], degrees=True).as_matrix()


def camera(azimuth_deg: float, elevation_deg: float, roll_deg: float) -> np.ndarray:
    """Right, up and backward of a camera as rows, in ICRF axes; roll is clockwise."""
    a, e, r = np.radians([azimuth_deg, elevation_deg, roll_deg])
    view = np.array([np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.sin(e)])
    level = np.array([np.cos(a), -np.sin(a), 0.0])
    top = np.cross(level, view)
    right = np.cos(r) * level - np.sin(r) * top
    up = np.cos(r) * top + np.sin(r) * level
    return np.array([right, up, -view]) @ LOCAL


ANGLES = [(30.0, 20.0, 0.0), (200.0, -35.0, 10.0), (350.0, 60.0, 300.0), (0.0, 0.0, 90.0)]


@pytest.mark.parametrize("angles", ANGLES)
def test_azimuth_elevation_and_roll(angles: tuple[float, float, float]) -> None:
    found = sky_pointing(camera(*angles), SkyFrame(OF_DATE, LOCAL, 0.0), FORWARD)
    names = ("azimuth_deg", "elevation_deg", "camera_roll_deg")
    turns = (np.array([found[name] for name in names]) - angles + 180.0) % 360.0 - 180.0
    assert_close("rae angle", turns, np.zeros(3))
    names = ("vehicle_yaw_deg", "vehicle_pitch_deg", "vehicle_roll_deg")
    turns = (np.array([found[name] for name in names]) - angles + 180.0) % 360.0 - 180.0
    assert_close("rae angle", turns, np.zeros(3))


def by_hand(axis: np.ndarray, suffix: str) -> dict[str, float]:
    ra = np.degrees(np.arctan2(axis[1], axis[0])) % 360.0
    dec = np.degrees(np.arcsin(axis[2]))
    return {f"ra{suffix}_deg": ra, f"ra{suffix}_hours": ra / 15.0, f"dec{suffix}_deg": dec}


@pytest.mark.parametrize("angles", ANGLES)
def test_right_ascension_and_declination(angles: tuple[float, float, float]) -> None:
    """Right ascensions are 0 to 360 degrees; with a date there are those of the date too."""
    matrix = camera(*angles)
    axis = -matrix[2]
    expected = by_hand(axis, "")
    bare = sky_pointing(matrix, None, None)
    dated = sky_pointing(matrix, SkyFrame(OF_DATE, None, 0.0), FORWARD)
    placed = sky_pointing(matrix, SkyFrame(OF_DATE, LOCAL, 0.0), None)
    assert list(bare) == ["ra_deg", "ra_hours", "dec_deg"]
    assert list(dated) == [*bare, "ra_of_date_deg", "ra_of_date_hours", "dec_of_date_deg"]
    assert list(placed) == [*dated, "azimuth_deg", "elevation_deg", "camera_roll_deg"]
    both = expected | by_hand(OF_DATE @ axis, "_of_date")
    for found in (bare, dated, placed):
        for name in set(found) & set(both):
            assert_close("rae angle", found[name], both[name])


VEHICLES = [  # a mount, the camera's angles, the vehicle's yaw, pitch and roll
    (mount_by_angles([90.0, 0.0, 0.0]), (20.0, 0.0, 0.0), (-70.0, 0.0, 0.0)),
    (mount_by_angles([0.0, 30.0, 0.0]), (20.0, 50.0, 0.0), (20.0, 20.0, 0.0)),
    (mount_by_angles([0.0, 0.0, 25.0]), (20.0, 50.0, 65.0), (20.0, 50.0, 40.0)),
    (DOWN, (20.0, -60.0, 0.0), (20.0, 30.0, 0.0)),
    (DOWN, (110.0, -70.0, 270.0), (20.0, 0.0, -20.0)),  # left wing down: it looks to the right
]


@pytest.mark.parametrize(("mount", "angles", "vehicle"), VEHICLES)
def test_a_vehicle(
    mount: np.ndarray, angles: tuple[float, float, float], vehicle: tuple[float, float, float]
) -> None:
    found = sky_pointing(camera(*angles), SkyFrame(OF_DATE, LOCAL, 0.0), mount)
    names = ("vehicle_yaw_deg", "vehicle_pitch_deg", "vehicle_roll_deg")
    turns = (np.array([found[name] for name in names]) - vehicle + 180.0) % 360.0 - 180.0
    assert_close("rae angle", turns, np.zeros(3))


PLACE = (30.0, 180.0, 500.0)
EAST, NORTH, UP = (0.0, -1.0, 0.0), (0.5, 0.0, 0.75**0.5), (-(0.75**0.5), 0.0, 0.5)
"""Of a place at latitude 30, longitude 180, in Earth-centred axes."""


def test_axes_on_the_earth() -> None:
    """A level camera toward north is forward; mounted to look right, the vehicle heads west."""
    matrix = camera(0.0, 0.0, 0.0)
    down = [-one for one in UP]
    ahead = axes_of_body(matrix, None, LOCAL, PLACE).earth_fixed
    assert ahead is not None
    assert_close("rae element", ahead, [NORTH, EAST, down])
    right = axes_of_body(matrix, mount_by_angles([90.0, 0.0, 0.0]), LOCAL, PLACE).earth_fixed
    assert right is not None
    assert_close("rae element", right, [[0.0, 1.0, 0.0], NORTH, down])
    for local, place in ((None, PLACE), (LOCAL, None), (None, None)):
        assert axes_of_body(matrix, FORWARD, local, place).earth_fixed is None


def test_axes_among_the_stars() -> None:
    """Right, down, ahead of a camera; forward, right, down of a vehicle."""
    right, up, back = matrix = camera(*ANGLES[1])
    found = axes_of_body(matrix, None, None, None).celestial
    assert_close("rae element", found, [right, -up, -back])
    body = axes_of_body(matrix, FORWARD, None, None).celestial
    assert_close("rae element", body, [-back, right, -up])
    below = axes_of_body(matrix, DOWN, None, None).celestial
    assert_close("rae element", below, [up, right, -back])
    assert CAMERA_FRAME == "camera: x right, y down, z forward (the view)"
    assert BODY_FRAME == "vehicle body: x forward, y right, z down"
