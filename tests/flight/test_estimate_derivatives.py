"""Every derivative of a flight's estimate, by differences of solves or of definitions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit.flight_project import LENS, MARK, UNUSED, local_to_camera, three_frames, truth_deg
from tests.tolerances import assert_close
from vopd.estimate import Estimate
from vopd.flight.estimate import _gain, flight_estimate
from vopd.flight.solve import solve
from vopd.geometry.lenses import project
from vopd.geometry.rotations import mount_by_angles


@pytest.fixture(scope="module")
def estimate() -> Estimate:
    return flight_estimate(solve(three_frames()))


def test_partials_are_differences_of_computed_coordinates(estimate: Estimate) -> None:
    step_deg = 1e-3
    for frame in (1, 2):
        direction = estimate.direction[frame, :UNUSED]
        for axis in range(3):
            more = np.eye(3)[axis] * step_deg
            there, back = (
                -project(LENS, direction @ local_to_camera(truth_deg()[frame] + way).T).pixel
                for way in (more, -more)
            )
            slope = ((there - back) / np.radians(2 * step_deg)).T.ravel()
            found = estimate.partials[frame, [0, 1, 2, 4, 5, 6], axis]
            assert_close("minimiser's residual", found / 1500.0, slope / 1500.0)
    assert (estimate.partials[1:, [UNUSED, 4 + UNUSED]] == 0.0).all()


@pytest.mark.parametrize("axis", [0, 1], ids=["u", "v"])
def test_angles_and_body_turn_as_gain_and_body_gain_say(axis: int) -> None:
    """With picks that count differently, and a mount aslant."""
    one = replace(three_frames(), mount=mount_by_angles([20.0, -35.0, 50.0]))
    base, step, slot = flight_estimate(solve(one)), 1e-2, 1
    ends = []
    for way in (step, -step):
        pixel = one.picks.pixel.copy()
        pixel[MARK * 2 + slot, axis] += way
        other = solve(replace(one, picks=replace(one.picks, pixel=pixel)))
        body = flight_estimate(other).camera_deg, one.mount @ other.attitudes.rotation[2]
        ends.append(body)
    camera = np.radians(ends[0][0][2] - ends[1][0][2]) / (2 * step)
    assert_close("flight response", camera, -base.gain[2, :, slot + MARK * axis])
    turn = Rotation.from_matrix(ends[0][1] @ ends[1][1].T).as_rotvec() / (2 * step)
    assert_close("flight response", -turn, -base.body_gain[2, :, slot + MARK * axis])
    by_camera = (base.vehicle_by_camera[2] @ camera)[None]
    vehicle = Rotation.from_euler("ZYX", base.vehicle_deg[2], degrees=True)
    moved = (vehicle * Rotation.from_rotvec(-turn * step)).as_euler("ZYX", degrees=True)
    change = (moved - base.vehicle_deg[2] + 180.0) % 360.0 - 180.0
    assert_close("flight response", np.radians(change) / step, by_camera[0])


def test_wind_and_acceleration_count_for_angles_of_attack(estimate: Estimate) -> None:
    """Relative to the air 17 m/s north, 6 m/s east, 2 m/s up."""
    assert_close("ratio", estimate.airspeed[1:], np.full(2, np.sqrt(17.0**2 + 6.0**2 + 2.0**2)))
    body = Rotation.from_euler("ZYX", truth_deg()[2], degrees=True)
    ends = []
    for way in (1e-6, -1e-6):
        u, v, w = body.inv().apply([17 + 4 * way, 6 + 5 * way, -2 + 6 * way])
        ends.append([np.arctan2(w, u), np.arctan2(v, u), np.arctan2(np.hypot(v, w), u)])
    slope = (np.array(ends[0]) - ends[1]) / 2e-6
    assert_close("derivative by steps", estimate.responses.attack_by_time[2], slope)
    assert_close("flight angle", estimate.attack_deg[2], np.degrees(np.mean(ends, axis=0)))


@pytest.mark.parametrize(("weak", "determined"), [(1e-13, True), (1e-15, False), (0.0, False)])
def test_from_which_ratio_on_turns_are_not_determined(weak: float, determined: bool) -> None:
    """Eigenvalues of the normal equations 1, 1 and a weak one; another frame is good."""
    partials = np.zeros((2, 4, 3))
    partials[:, [0, 1, 2], [0, 1, 2]] = [[1.0, 1.0, np.sqrt(weak)], [1.0, 2.0, 4.0]]
    found = _gain(partials, np.ones((2, 4)))
    assert np.isfinite(found[0]).all() == determined
    assert_close("ratio", found[1], np.linalg.pinv(partials[1]))
    assert np.isnan(_gain(np.full((1, 4, 3), np.nan), np.ones((1, 4)))).all()
