"""Angles of attack, and quaternions of attitudes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats
from scipy.spatial.transform import Rotation

from tests.kit.histories import histories
from tests.tolerances import assert_close, within
from vopd.attitude.history import History
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.uncertainty import eta_interval_deg
from vopd.geometry.rotations import angle_between_deg, from_axes, from_yaw_pitch_roll, product

DECK = "appendix_h/case1"


def component(name: str, sigmas: Sigmas) -> tuple[History, np.ndarray]:
    (one,) = histories(DECK, sigmas=sigmas)
    return one, one.uncertainty.components[name][0]


def body(one: History) -> Rotation:
    """From the vehicle's axes to north, east, down, by yaw, pitch, roll."""
    return Rotation.from_euler("ZYX", one.estimate.vehicle_deg[0], degrees=True)


def airflow(one: History) -> np.ndarray:
    """The velocity relative to the air in the vehicle's axes, by alpha, beta and its size."""
    alpha, beta, eta = np.radians(one.estimate.attack_deg[0])
    forward = one.estimate.airspeed[0] * np.cos(eta)
    return np.array([1.0, np.tan(beta), np.tan(alpha)]) * forward


def attack_deg(velocity: np.ndarray) -> np.ndarray:
    u, v, w = velocity
    return np.degrees([np.arctan2(w, u), np.arctan2(v, u), np.arctan2(np.hypot(v, w), u)])


def test_the_mounting_turns_the_vehicle_about_its_own_axes() -> None:
    sigma = 0.02
    one, found = component("mount", Sigmas(mount_deg=sigma))
    there, flow = body(one), airflow(one)
    changes = []
    for axis in np.eye(3):
        turn = Rotation.from_rotvec(sigma * axis, degrees=True)
        angles = (there * turn).as_euler("ZYX", degrees=True) - there.as_euler("ZYX", degrees=True)
        changes.append([*angles, *(attack_deg(turn.inv().apply(flow)) - attack_deg(flow))])
    expected = np.sqrt((np.array(changes) ** 2).sum(axis=0))
    assert_close("small turn", found[3:], expected)
    assert not found[:3].any()
    u = one.uncertainty
    assert_close("covariance", u.covariance_common_deg2[0], sigma**2 * np.eye(3))


@pytest.mark.parametrize(("name", "axes"), [("velocity", 3), ("wind", 2)])
def test_velocity_and_wind_move_the_angles_of_attack_alone(name: str, axes: int) -> None:
    sigma = 3.0
    one, found = component(name, Sigmas(**{name: sigma}))
    there, flow = body(one), airflow(one)
    pushes = there.inv().apply(sigma * np.eye(3)[:axes])
    changes = [(attack_deg(flow + push) - attack_deg(flow - push)) / 2.0 for push in pushes]
    expected = np.sqrt((np.array(changes) ** 2).sum(axis=0))
    assert_close("small push", found[6:], expected)
    assert not found[:6].any()


@pytest.mark.parametrize("times", [2.8, 3.5, 5.0, 7.9, 8.1, 20.0])
def test_the_interval_of_eta_by_the_rice_distribution(times: float) -> None:
    """A length this large, or this small, has the probability .025 at the two ends."""
    s = 0.4
    covariance = np.eye(2)[None] * s**2
    ((low, high),) = eta_interval_deg(np.array([times * s]), np.array([s]), covariance)
    assert_close("probability", stats.rice.sf(times, low / s), 0.025)
    assert_close("probability", stats.rice.cdf(times, high / s), 0.025)


def test_near_zero_the_interval_of_eta_has_one_side() -> None:
    eta = np.array([0.0, 0.1, 1.0, 2.6])
    ends = eta_interval_deg(eta, np.ones(4), np.tile(np.eye(2), (4, 1, 1)))
    assert ends[:, 0].tolist() == [0.0] * 4
    assert (ends[:, 1] >= np.maximum(eta, 1.0)).all()


def test_the_interval_of_eta_stays_between_0_and_180() -> None:
    """Far from zero it is 1.96 s to either side, and half of s over eta s less by the curvature."""
    eta = np.array([170.0, 179.0, 180.0])
    ends = eta_interval_deg(eta, np.full(3, 2.0), np.tile(4.0 * np.eye(2), (3, 1, 1)))
    less = 0.5 * 4.0 / eta
    assert_close("probability", ends[:, 0], eta - less - 2.0 * 1.959963984540054)
    assert_close("probability", ends[0, 1], 170.0 - less[0] + 2.0 * 1.959963984540054)
    assert ends[1:, 1].tolist() == [180.0, 180.0]


@pytest.mark.parametrize(("times", "low"), [(2.7161, 0.0), (2.7163, 1e-3)])
def test_from_which_length_on_the_interval_of_eta_has_two_sides(times: float, low: float) -> None:
    """From where a length of zero has a chance below .025 of one this large: sqrt(-2 ln .025)."""
    assert_close("four decimals", stats.rice.isf(0.025, 0.0), 2.7162)
    ((found, _),) = eta_interval_deg(np.array([times]), np.ones(1), np.eye(2)[None])
    assert (found > 0.0) == (low > 0.0)


# Quaternions against scipy's Rotation


anything = st.floats(-720.0, 720.0)
three = st.tuples(anything, anything, anything)


def scalar_first(rotation: Rotation) -> np.ndarray:
    q = np.roll(rotation.as_quat(), 1)
    return -q if q[0] < 0.0 else q


@given(three)
def test_yaw_pitch_roll_as_scipy_has_them(angles: tuple[float, float, float]) -> None:
    (mine,) = from_yaw_pitch_roll(np.array([angles]))
    theirs = scalar_first(Rotation.from_euler("ZYX", angles, degrees=True))
    assert mine[0] >= 0.0 and abs(np.linalg.norm(mine) - 1.0) < within("rae element")
    assert min(np.abs(mine - theirs).max(), np.abs(mine + theirs).max()) < within("rae element")


@given(three, three)
def test_product_and_angle_between(one: tuple[float, ...], other: tuple[float, ...]) -> None:
    a, b = (Rotation.from_euler("ZYX", angles, degrees=True) for angles in (one, other))
    p, q = from_yaw_pitch_roll(np.array([one])), from_yaw_pitch_roll(np.array([other]))
    both = scalar_first(a * b)
    (mine,) = product(p, q)
    assert min(np.abs(mine - both).max(), np.abs(mine + both).max()) < within("rae element")
    angle = np.degrees((a.inv() * b).magnitude())
    assert_close("angle near a half turn", angle_between_deg(p, q)[0], angle)


@given(three)
def test_axes_give_the_quaternion_back(angles: tuple[float, float, float]) -> None:
    """Rows are the body's axes in the outer frame; half turns have a trace of -1."""
    axes = Rotation.from_euler("ZYX", angles, degrees=True).as_matrix().T
    mine, straight = from_axes(axes[None]), from_yaw_pitch_roll(np.array([angles]))
    near = min(np.abs(mine - straight).max(), np.abs(mine + straight).max())
    assert near < within("rae element")


def test_half_turns_and_nothing() -> None:
    for axis in np.eye(3):
        half = Rotation.from_rotvec(np.pi * axis).as_matrix().T
        assert np.abs(np.abs(from_axes(half[None])[0, 1:]) - axis).max() < within("rae element")
    assert np.isnan(from_axes(np.full((2, 3, 3), np.nan))).all()
    assert np.isnan(from_yaw_pitch_roll(np.full((2, 3), np.nan))).all()


RANDOM = Rotation.random(40, random_state=7)
TURNS = Rotation.from_rotvec(np.radians([
    [180.0, 0, 0], [0, 180, 0], [0, 0, 180], [0, 0, 0], [170, 0, 0], [0, -170, 0], [0, 0, 175],
    [127.3, 127.3, 0], [0, 127.3, 127.3], [127.3, 0, 127.3], [127.3, -127.3, 0],
]))  # fmt: skip
ROTATIONS = Rotation.concatenate([RANDOM, TURNS])


def many_scalar_first(rotations: Rotation) -> np.ndarray:
    """w x y z by scipy, with w >= 0."""
    found = np.roll(rotations.as_quat(), 1, axis=1)
    return np.where(found[:, :1] < 0.0, -found, found)


def test_every_rotation_by_its_axes() -> None:
    """Whichever of the four parts is the largest. B's axes in components of A are columns of the
    rotation that carries A's into them.
    """
    rows = ROTATIONS.as_matrix().swapaxes(1, 2)
    found, expected = from_axes(rows), many_scalar_first(ROTATIONS)
    assert set(np.abs(expected).argmax(axis=1)) == {0, 1, 2, 3}
    same = np.abs((found * expected).sum(axis=1))
    assert_close("rae element", same, np.ones(len(same)))
    assert (found[:, 0] >= 0.0).all()
    some = expected[:, 0] > 0.001
    assert_close("rae element", found[some], expected[some])


def test_products_and_angles_of_many() -> None:
    one, other = many_scalar_first(ROTATIONS), many_scalar_first(ROTATIONS[::-1])
    both = ROTATIONS * ROTATIONS[::-1]
    found, expected = product(one, other), many_scalar_first(both)
    assert (found[:, 0] >= 0.0).all()
    some = expected[:, 0] > 0.001
    assert_close("rae element", found[some], expected[some])
    between = np.degrees((ROTATIONS.inv() * ROTATIONS[::-1]).magnitude())
    for sign in (1.0, -1.0):
        assert_close("angle near a half turn", angle_between_deg(sign * one, other), between)
        assert_close("angle near a half turn", angle_between_deg(one, sign * other), between)


def test_no_part_is_minus_zero_and_what_is_not_known_is_nan() -> None:
    half_turns = np.array([[0.0, 0.0, 0.0], [300.0, 0.0, 0.0], [0.0, 0.0, 300.0]])
    level = from_yaw_pitch_roll(half_turns)
    assert (level[:, 0] > 0.0).all() and level[1, 3] < 0.0 and level[2, 1] < 0.0
    assert not np.signbit(np.delete(level.ravel(), [7, 9])).any()
    broken = from_yaw_pitch_roll(np.array([[np.nan, 0.0, 0.0], [0.0, np.inf, 0.0]]))
    assert np.isnan(broken).all()
    zero = product(level[:1], np.zeros((1, 4)))
    assert np.isnan(zero).all()
