"""ALPBET against hand work and a rotation by scipy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tests.tolerances import assert_close
from vopd.program.alpbet import alpbet

LEVEL_NORTH = (0.0, 0.0, 0.0)


def attack(
    velocity: tuple[float, ...], wind: tuple[float, ...], angles: tuple[float, ...]
) -> tuple[float, ...]:
    """Alpha, beta, eta, airspeed of one frame at yaw, pitch, roll `angles`."""
    psi, theta, phi = (np.array([angle]) for angle in angles)
    done = alpbet(np.array([velocity]), np.array([wind]), theta=theta, psi=psi, phi=phi)
    return tuple(float(part[0]) for part in done)


@pytest.mark.parametrize(
    ("velocity", "wind", "angles", "alpha", "beta", "eta", "airspeed"),
    [
        # velocity north, east, down; wind toward north, toward east; yaw, pitch, roll
        ((100.0, 0.0, 0.0), (0.0, 0.0), LEVEL_NORTH, 0.0, 0.0, 0.0, 100.0),
        # sinking with a level nose: the air comes from below, tan ALPHA = 10/100
        ((100.0, 0.0, 10.0), (0.0, 0.0), LEVEL_NORTH, 5.71059, 0.0, 5.71059, 100.4987562),
        # wind from the west, + VYO: the air comes from the left, tan BETA = -10/100
        ((100.0, 0.0, 0.0), (0.0, 10.0), LEVEL_NORTH, 0.0, -5.71059, 5.71059, 100.4987562),
        # wind from the south, + VXO: a tail wind, 100 - 30
        ((100.0, 0.0, 7.0), (30.0, 0.0), LEVEL_NORTH, 5.71059, 0.0, 5.71059, 70.3491293),
        # drifting east with the nose north: the air comes from the right
        ((100.0, 10.0, 0.0), (0.0, 0.0), LEVEL_NORTH, 0.0, 5.71059, 5.71059, 100.4987562),
        # the same, rolled right by 90: right is now down, so the right wing meets nothing,
        # and the air from the east meets the belly's other side: ALPHA = -5.7
        ((100.0, 10.0, 0.0), (0.0, 0.0), (0.0, 0.0, 90.0), -5.71059, 0.0, 5.71059, 100.4987562),
        # nose up by 30 on a level path
        ((100.0, 0.0, 0.0), (0.0, 0.0), (0.0, 30.0, 0.0), 30.0, 0.0, 30.0, 100.0),
        # nose east, flying north: the air comes from the left at 90
        ((100.0, 0.0, 0.0), (0.0, 0.0), (90.0, 0.0, 0.0), None, -90.0, 90.0, 100.0),
        # flying backwards: ETA passes 90
        ((-100.0, 0.0, 0.0), (0.0, 0.0), (0.0, 30.0, 0.0), -150.0, None, 150.0, 100.0),
    ],
)
def test_by_hand(
    velocity: tuple[float, ...],
    wind: tuple[float, ...],
    angles: tuple[float, ...],
    alpha: float | None,
    beta: float | None,
    eta: float,
    airspeed: float,
) -> None:
    """Arc tangent of .1 is 5.71059 degrees. None: a rounded zero over a rounded zero decides."""
    found = attack(velocity, wind, angles)
    for got, wanted in zip(found[:3], (alpha, beta, eta), strict=True):
        if wanted is not None:
            assert_close("angle of attack by hand", got, wanted)
    assert_close("airspeed by hand", found[3], airspeed)


ANGLE = st.floats(-360.0, 360.0)
SPEED = st.floats(-2000.0, 2000.0)


@given(st.tuples(SPEED, SPEED, SPEED), st.tuples(SPEED, SPEED), st.tuples(ANGLE, ANGLE, ANGLE))
def test_against_a_rotation(
    velocity: tuple[float, ...], wind: tuple[float, ...], angles: tuple[float, ...]
) -> None:
    """Body axes are north, east, down turned by yaw, pitch, roll; the wind is level."""
    body = Rotation.from_euler("ZYX", np.array(angles) * 0.0174532925)
    u, v, w = body.inv().apply(np.array(velocity) - (*wind, 0.0))
    alpha, beta, eta, airspeed = attack(velocity, wind, angles)
    assert_close("airspeed", airspeed, np.sqrt(u * u + v * v + w * w))
    assert 0.0 <= eta <= 180.0
    # tan ALPHA = w/u and so on: each angle turns (u, w) and so on back onto the first axis
    for angle, across in ((alpha, w), (beta, v), (eta, np.hypot(v, w))):
        length = np.hypot(u, across)
        radians = angle / 57.29577951
        assert_close("airspeed", length * np.cos(radians), u)
        assert_close("airspeed", length * np.sin(radians), across)


def test_frames_one_by_one() -> None:
    rng = np.random.default_rng(2)
    v1, v0, angles = rng.normal(size=(9, 3)), rng.normal(size=(9, 2)), rng.normal(size=(3, 9)) * 90
    whole = alpbet(v1, v0, *angles)
    for f in range(9):
        alone = alpbet(v1[f : f + 1], v0[f : f + 1], *angles[:, f : f + 1])
        assert [part[f] for part in whole] == [part[0] for part in alone]
