"""Quaternions against scipy's Rotation."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tests.tolerances import assert_close, within
from vopd.geometry.rotations import angle_between_deg, from_axes, from_yaw_pitch_roll, product

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
