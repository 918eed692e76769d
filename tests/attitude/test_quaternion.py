"""Quaternions against scipy's Rotation."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tests.tolerances import assert_close, within
from vopd.attitude.quaternion import angle_between_deg, from_axes, from_yaw_pitch_roll, product

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
