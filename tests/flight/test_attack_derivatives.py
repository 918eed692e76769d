"""Angles of attack: each angle by hand, each derivative by differences of their definition."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.flight.estimate import AttackAngles, angles_of_attack

BODY_TO_NED = Rotation.from_euler("ZYX", [[20.0, -8.0, 5.0], [200.0, 30.0, -70.0]], degrees=True)
VELOCITY = np.array([[60.0, -15.0, 9.0], [-3.0, 25.0, 40.0]])
ACCELERATION = np.array([[2.0, -7.0, 9.0], [-4.0, 6.0, 3.0]])
STEP = 1e-6


def attack() -> AttackAngles:
    return angles_of_attack(BODY_TO_NED.as_matrix(), VELOCITY, ACCELERATION)


def defined(body_to_ned: Rotation, velocity: Floats) -> Floats:
    """Alpha, beta, eta (F, 3), radians, as the field defines them."""
    u, v, w = body_to_ned.inv().apply(velocity).T
    return np.stack(
        [np.arctan2(w, u), np.arctan2(v, u), np.arccos(u / np.hypot(u, np.hypot(v, w)))]
    ).T


def slope(there: Floats, back: Floats) -> Floats:
    return (there - back) / (2.0 * STEP)


def test_angles_and_airspeed_by_hand() -> None:
    """3 forward, 4 to the right, 12 down: 13 in all."""
    one = angles_of_attack(np.eye(3)[None], np.array([[3.0, 4.0, 12.0]]), np.zeros((1, 3)))
    assert_close("table value", one.airspeed_m_s, [13.0])
    expected = [np.arctan(12 / 3), np.arctan(4 / 3), np.arctan(np.sqrt(160) / 3)]
    assert_close("table value", one.angle_deg[0], np.degrees(expected))
    root = np.sqrt(160)
    rows = [[-12 / 153, 0, 3 / 153], [-4 / 25, 3 / 25, 0],
            [-root / 169, 12 / (root * 169), 36 / (root * 169)]]  # fmt: skip
    assert_close("table value", one.by_velocity[0], rows)


def test_a_nose_that_rises_by_a_degree_has_a_degree_more_of_alpha() -> None:
    one = angles_of_attack(np.eye(3)[None], np.array([[50.0, 0.0, 4.0]]), np.zeros((1, 3)))
    assert_close("table value", one.by_turns[0, 0, 1], 1.0)
    assert_close("table value", one.by_turns[0, 1, 2], -1.0)  # the nose to the right of the wind


@pytest.mark.parametrize("axis", range(3), ids=["forward", "right", "down"])
def test_angles_by_small_turns_of_the_body(axis: int) -> None:
    turn = Rotation.from_rotvec(np.eye(3)[axis] * STEP)
    there = defined(BODY_TO_NED * turn, VELOCITY)
    back = defined(BODY_TO_NED * turn.inv(), VELOCITY)
    assert_close("derivative by steps", attack().by_turns[..., axis], slope(there, back))


@pytest.mark.parametrize("axis", range(3), ids=["north", "east", "down"])
def test_angles_by_the_velocity(axis: int) -> None:
    more = np.eye(3)[axis] * STEP
    there, back = (defined(BODY_TO_NED, VELOCITY + way) for way in (more, -more))
    assert_close("derivative by steps", attack().by_velocity[..., axis], slope(there, back))


def test_angles_by_time_are_by_the_acceleration() -> None:
    more = ACCELERATION * STEP
    there, back = (defined(BODY_TO_NED, VELOCITY + way) for way in (more, -more))
    assert_close("derivative by steps", attack().by_time, slope(there, back))


def test_no_velocity_and_no_motion_cost_no_other_frame() -> None:
    """And no warning of numpy's is shown: the suite makes an error of it."""
    velocity = np.array([[np.nan] * 3, [0.0] * 3, [30.0, 0.0, 0.0]])
    one = angles_of_attack(np.tile(np.eye(3), (3, 1, 1)), velocity, np.zeros((3, 3)))
    assert np.isnan(one.angle_deg[0]).all() and np.isnan(one.airspeed_m_s[0])
    assert one.airspeed_m_s[1:].tolist() == [0.0, 30.0]
    assert one.angle_deg[2].tolist() == [0.0, 0.0, 0.0]
