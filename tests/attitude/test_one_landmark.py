"""Frames with one landmark: two turns out of three are determined."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.kit.estimates import estimate
from tests.tolerances import assert_close
from vopd.attitude.sigmas import Sigmas, angle_gains
from vopd.attitude.uncertainty import uncertainty
from vopd.estimate import Estimate
from vopd.geometry.rotations import angles_by_turns, turns_by_body_angles

ANGLES = np.array([[140.0, -60.0, 20.0], [20.0, 30.0, 330.0]])
GIVEN = Sigmas(reading=0.5, mount_deg=0.4)


def made() -> Estimate:
    """Two frames whose vehicle and angles of attack go with the camera in any way."""
    rng = np.random.default_rng(8)
    e = estimate(
        ANGLES, vehicle_deg=ANGLES[::-1] + 7.0, vehicle_by_camera=rng.normal(size=(2, 3, 3))
    )
    by_camera = rng.normal(size=(2, 3, 3))
    return replace(e, responses=replace(e.responses, attack_by_camera=by_camera))


def test_one_landmark_determines_two_turns_out_of_three() -> None:
    """The gains are those of least squares without the turn about the line of sight."""
    e = made()
    used = np.array([[False, True, False, False], [True] * 4])
    e = replace(e, used=used, gain=np.where([[[True]], [[False]]], np.nan, e.gain))
    found = angle_gains(e)
    by_turns = angles_by_turns(np.radians(e.camera_deg))[0]
    rows = np.where(np.tile(used[0], 2)[:, None], e.partials[0], 0.0) @ by_turns
    inverse = np.linalg.pinv(rows, rcond=1e-9)
    assert np.linalg.matrix_rank(rows, tol=1e-9) == 2
    to_attack, to_vehicle = e.responses.attack_by_camera[0], e.vehicle_by_camera[0]
    chain = np.vstack([np.eye(3), to_vehicle, to_attack]) @ by_turns
    body = turns_by_body_angles(np.radians(e.vehicle_deg))[0] @ to_vehicle @ by_turns
    assert_close("inverse element", found.angles[0], chain @ inverse)
    assert_close("inverse element", found.body[0], body @ inverse)
    free = np.linalg.svd(rows)[2][2]
    axis = body @ free / np.linalg.norm(body @ free)
    along = found.free_turn[0] @ axis
    assert_close("inverse element", np.abs(along), 1.0)
    assert_close("inverse element", found.free_turn[0] * along, axis)
    assert found.free[0].all() and not found.free[1].any() and not found.free_turn[1].any()
    covariance = uncertainty(e, GIVEN).covariance_deg2[0]
    assert np.isinf(covariance).all()
    assert np.array_equal(np.sign(covariance), np.sign(np.outer(axis, axis)))


def test_angles_that_the_free_turn_does_not_change_are_known() -> None:
    """The camera looks at the landmark: only camera roll and vehicle roll are free, in any
    attitude. Of these no component is stated, and the total is infinite.
    """
    angles = [[33.0, -21.0, 47.0], [140.0, 60.0, 200.0], [77.0, -85.0, 3.0]]
    e = estimate(angles, np.array([[0.0, 0.0], [3.0, 2.0], [-2.0, 3.0]]))
    nothing = np.full_like(e.gain, np.nan)
    used = np.tile([True, False, False], (3, 1))
    found = uncertainty(replace(e, used=used, gain=nothing, body_gain=nothing), GIVEN)
    free = np.isin(np.arange(9), [2, 5, 8])  # roll, and eta, which goes with it here
    assert (np.isinf(found.total) == free).all() and (np.isinf(found.half_width_95) == free).all()
    for one in found.components.values():
        assert (np.isnan(one) == free).all()
    no_attitude = np.full((3, 3), np.nan)
    lost = uncertainty(
        replace(e, camera_deg=no_attitude, gain=nothing, body_gain=nothing, used=used), GIVEN
    )
    assert np.isnan(lost.covariance_deg2).all() and np.isnan(lost.total).all()
