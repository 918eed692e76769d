"""Geocentric latitudes and TGTCAM against hand work and rotations by scipy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tests.tolerances import assert_close
from vopd.program.geocentric import LANDMARK_FOUR_PHI, ORIGIN_FOUR_PHI, geocentric
from vopd.program.tgtcam import tgtcam

RAD = 57.29577951


@pytest.mark.parametrize(
    ("phi", "origin", "landmark"),
    [
        # sin 2PHI, sin 4PHI, sin 6PHI are 0, 0, 0 at the equator
        (0.0, 0.0, 0.0),
        # 1, 0, -1 at 45: 45 - .1932398611111 - .00000072222222222 for both
        (45.0, 44.80675941666668, 44.80675941666668),
        # .5, .8660254037844, 1 at 15: 15 - .09661993055555 + .00000072222222222
        #   + .00028220400... (.0003258611111111 * .8660254037844 = .000282204000)
        #   or + .00002822039... (.0000325861111111 * .8660254037844 = .000028220400)
        (15.0, 14.903662995667, 14.903409012067),
        # -.5, .8660254037844, -1 at 105: 105 + .09661993055555 - .00000072222222222 + the same
        (105.0, 105.096901412333, 105.096647428733),
        (-45.0, -44.80675941666668, -44.80675941666668),
    ],
)
def test_series_by_hand(phi: float, origin: float, landmark: float) -> None:
    """The last term has a plus; the landmarks' sin 4PHI is a tenth of the origin's."""
    assert_close("geocentric latitude", geocentric(phi, ORIGIN_FOUR_PHI), origin)
    assert_close("geocentric latitude", geocentric(phi, LANDMARK_FOUR_PHI), landmark)


def test_the_printed_latitudes() -> None:
    """LAT-GOCN of Appendix H for landmarks 66, 67, 28 and 62, and 66 in case 2."""
    geodetic = np.array(
        [32 + 50 / 60, 32 + 49.75 / 60, 33 + 22.5 / 60, 33 + 15.8 / 60, 32.838333333]
    )
    printed = [f"{latitude:.5f}" for latitude in geocentric(geodetic, LANDMARK_FOUR_PHI)]
    assert printed == ["32.65728", "32.65313", "33.19748", "33.08611", "32.66227"]


def test_other_factor_of_sin_6phi() -> None:
    assert_close("geocentric latitude", geocentric(45.0, 0.0, -1e-3), 45 - 0.1932398611111 + 1e-3)


def test_straight_down() -> None:
    """10 km above an origin on the equator at Greenwich; the landmark is the origin."""
    seen = tgtcam(6378.0, 0.0, 0.0, np.array([[0.0], [0.0], [10.0]]), *at(0.0, 0.0, 6378.0))
    assert_close("direction cosine", np.ravel(seen), (0.0, 0.0, -1.0))


def test_east_and_north() -> None:
    """From the Earth's centre side by side: a camera at 0 N 0 E, landmarks at the height r/cos.

    At longitude 1 degree and radius r/cos 1 the landmark stands due east in the
    camera's own horizon; at latitude 1 due north.
    """
    r = 6378.0 / math.cos(1 / RAD)
    here = np.zeros((3, 1))
    for landmark, axis in (((1.0, 0.0, r), 0), ((0.0, 1.0, r), 1)):
        seen = tgtcam(6378.0, 0.0, 0.0, here, *at(*landmark))
        assert_close("direction cosine", np.ravel(seen), np.eye(3)[axis])


def at(longitude: float, latitude: float, radius: float) -> tuple[np.ndarray, ...]:
    """One landmark as (L, F) arrays: degrees, degrees, km."""
    return np.array([[longitude]]), np.array([[latitude]]), np.array([[radius]])


def level(longitude: float, latitude: float) -> Rotation:
    """Earth-centred axes to east, north, up: about Z by 90 + longitude, X by 90 - latitude."""
    about_z = Rotation.from_rotvec([0.0, 0.0, -(np.pi / 2 + longitude)])
    return Rotation.from_rotvec([-(np.pi / 2 - latitude), 0.0, 0.0]) * about_z


def outward(longitude: float, latitude: float, radius: float) -> np.ndarray:
    """An Earth-centred place: up, seen from the axes that stand there."""
    return radius * level(longitude, latitude).inv().apply([0.0, 0.0, 1.0])


LONGITUDE = st.floats(-180.0, 180.0)
LATITUDE = st.floats(-85.0, 85.0)


@given(LONGITUDE, LATITUDE, st.integers(0, 2**32 - 1))
def test_against_rotations(longitude: float, latitude: float, seed: int) -> None:
    """Three frames of two landmarks each, within 200 km of an origin anywhere."""
    rng = np.random.default_rng(seed)
    rz, origin = 6378.165, (longitude / RAD, latitude / RAD)
    xyz = rng.uniform([-80.0, -80.0, 20.0], [80.0, 80.0, 60.0], (3, 3))
    thj = longitude + rng.uniform(-1.0, 1.0, (2, 3))
    phij = latitude + rng.uniform(-1.0, 1.0, (2, 3))
    rj = rz + rng.uniform(-1.0, 4.0, (2, 3))
    seen = tgtcam(rz, origin[1], origin[0], xyz.T, thj, phij, rj)
    for f in range(3):
        camera = outward(*origin, rz) + level(*origin).inv().apply(xyz[f])
        east_of, north_of = (
            math.atan2(camera[1], camera[0]),
            math.asin(camera[2] / math.hypot(*camera)),
        )
        axes = level(east_of, north_of)  # the camera's own vertical, through the Earth's centre
        for j in range(2):
            away = outward(thj[j, f] / RAD, phij[j, f] / RAD, rj[j, f]) - camera
            wanted = axes.apply(away / math.hypot(*away))
            assert_close("direction cosine", [part[j, f] for part in seen], wanted)
