"""What stays in space when angles are expressed by the other vertical, for any attitude."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit.estimates import estimate, position
from tests.kit.wgs84_film import camera_matrix
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.attitude.vertical import lean_deg, with_vertical
from vopd.estimate import Estimate

CAMERA = np.array([[30.0, -60.0, 20.0], [200.0, 110.0, 15.0], [10.0, -170.0, 340.0]])
VEHICLE = np.array([[10.0, 120.0, 40.0], [300.0, -100.0, 200.0], [77.0, 12.0, 3.0]])


def made() -> Estimate:
    effect = np.random.default_rng(3).normal(0.0, 0.05, (3, 9))
    return estimate(CAMERA, vehicle_deg=VEHICLE, slip_effect_deg=effect)


def enu(one: Estimate) -> Floats:
    """East, north, up as rows, Earth-fixed."""
    north, east, down = np.moveaxis(one.position.north_east_down, 1, 0)
    return np.stack([east, north, -down], axis=1)


def in_space(one: Estimate, more: Floats | float = 0.0) -> tuple[Floats, Floats]:
    """The camera's axes as rows and the vehicle's as columns, Earth-fixed."""
    effect = np.zeros((3, 9)) + more
    camera = [camera_matrix(*angles) for angles in one.camera_deg + effect[:, :3]]
    vehicle = Rotation.from_euler("ZYX", one.vehicle_deg + effect[:, 3:6], degrees=True)
    ned = one.position.north_east_down.swapaxes(1, 2)
    return np.array(camera) @ enu(one), ned @ vehicle.as_matrix()


@pytest.mark.parametrize("there", [False, True])
def test_directions_and_attitudes_in_space_stay(there: bool) -> None:
    """And a pitch beyond 90 degrees, of camera and vehicle, stays beyond it."""
    old = made()
    new = with_vertical(old, "geocentric")
    if there:
        new = with_vertical(new, "geodetic")
    assert_close("attitude in space", new.direction @ enu(new), old.direction @ enu(old))
    for ours, theirs in zip(in_space(new), in_space(old), strict=True):
        assert_close("attitude in space", ours, theirs)
    for name in ("camera_deg", "vehicle_deg"):
        before, after = getattr(old, name), getattr(new, name)
        assert (np.cos(np.radians(before[:, 1])) * np.cos(np.radians(after[:, 1])) > 0.0).all()
        assert ((after[:, 1] >= -180.0) & (after[:, 1] <= 180.0)).all()
        assert ((after[:, ::2] >= 0.0) & (after[:, ::2] < 360.0)).all()
    for name in ("residual", "image", "attack_deg", "time_s", "used", "relative_sigma"):
        assert getattr(new, name) is getattr(old, name)


def test_what_the_errata_change_is_the_same_turn_in_space() -> None:
    old = made()
    new = with_vertical(old, "geocentric")
    assert old.slip_effect_deg is not None and new.slip_effect_deg is not None
    for ours, theirs in zip(
        in_space(new, new.slip_effect_deg), in_space(old, old.slip_effect_deg), strict=True
    ):
        assert_close("attitude in space", ours, theirs)
    assert np.array_equal(new.slip_effect_deg[:, 6:], old.slip_effect_deg[:, 6:])
    assert ((new.slip_effect_deg >= -180.0) & (new.slip_effect_deg <= 180.0)).all()


def test_the_lean_has_no_sign() -> None:
    place = replace(
        position(2),
        latitude_deg=np.array([40.0, -40.0]),
        geocentric_latitude_deg=np.array([39.8, -39.8]),
    )
    assert_close("table value", lean_deg(place), [0.2, 0.2])


def test_an_angle_that_passes_north_changes_by_little() -> None:
    """A yaw of 359.99 and one of 0.01 are .02 apart."""
    old = replace(made(), camera_deg=np.array([[359.999, -60.0, 0.001]] * 3))
    new = with_vertical(old, "geocentric")
    assert new.slip_effect_deg is not None
    assert not new.slip_effect_deg[:, :3].round().any()
