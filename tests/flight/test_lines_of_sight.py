"""Lines of sight: refraction by an integral along the path, curvature, and positions."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from tests.tolerances import assert_close, within
from vopd.flight.flight import Refraction
from vopd.flight.solve.lines_of_sight import refraction_rad, sight_lines
from vopd.geometry.earth import earth_centred_m, geodetic, local_axes

PATHS = (  # length, height of camera and landmark, metres
    (10e3, 1000.0, 0.0), (50e3, 30e3, 0.0), (300e3, 30e3, 0.0), (5e3, 0.0, 2500.0),
    (2e3, 100.0, 100.0), (400.0, 5.0, 5.001),
)  # fmt: skip


def by_integral(length: float, camera: float, landmark: float) -> float:
    """The curvature times (1 - s/L) over a path that rises evenly in flat layers."""
    rise = (landmark - camera) / length

    def bent(s: float) -> float:
        height = camera + (landmark - camera) * s / length
        return 0.13 / 6371e3 * np.sqrt(1 - rise**2) * np.exp(-height / 8000.0) * (1 - s / length)

    return float(quad(bent, 0.0, length, epsabs=1e-16, epsrel=1e-11)[0])


@pytest.mark.parametrize("path", PATHS)
def test_refraction_is_the_integral_along_the_path(path: tuple[float, float, float]) -> None:
    length, camera, landmark = path
    found = refraction_rad(
        Refraction(), *(np.array([x]) for x in path), np.array([(landmark - camera) / length])
    )
    assert_close("flight refraction", found[0], by_integral(*path))


def test_constant_refraction_is_k_s_over_twice_the_radius() -> None:
    zero = np.zeros(1)
    raised = refraction_rad(Refraction(0.13, False), np.array([10e3]), zero, zero, zero)
    assert_close("flight refraction", raised[0], 0.13 * 10e3 / (2 * 6371e3))  # 21 seconds of arc


def lines(east_north_up: list[float], refraction: Refraction) -> np.ndarray:
    camera = earth_centred_m(40.0, -75.0, 100.0)
    landmark = camera + np.array(east_north_up) @ local_axes(camera)
    first = np.zeros(1, np.int64)
    return sight_lines(camera[None], landmark[None], first, first, refraction).direction[0]


def test_refraction_raises_level_lines_and_leaves_vertical_ones() -> None:
    level, bent = lines([0, 10e3, 0], Refraction(0.0)), lines([0, 10e3, 0], Refraction())
    assert_close("flight direction", level, [0.0, 1.0, 0.0])
    assert bent[2] > 0.9e-4 and abs(bent[0]) < within("ratio")
    assert_close("flight direction", lines([0, 0, -90.0], Refraction()), [0.0, 0.0, -1.0])


def test_the_earth_curves_away() -> None:
    """A point of the same height 10 km north lies s2/2R lower, and its line is s/2R below level."""
    camera, north = earth_centred_m(45.0, 10.0, 0.0), earth_centred_m(45.09, 10.0, 0.0)
    first = np.zeros(1, np.int64)
    seen = sight_lines(camera[None], north[None], first, first, Refraction(0.0))
    radius = 6367382.0  # of the meridian at 45 degrees, a (1 - e2) / (1 - e2 sin2)^1.5
    assert_close("curvature", -np.arcsin(seen.direction[0, 2]), seen.distance_m[0] / (2 * radius))


def test_positions_there_and_back() -> None:
    rng = np.random.default_rng(4)
    given = np.degrees(np.arcsin(rng.uniform(-1, 1, 200))), rng.uniform(-180, 180, 200)
    height = rng.uniform(-100.0, 40e3, 200)
    found = geodetic(earth_centred_m(*given, height))
    assert_close("latitude, deg", found.latitude_deg, given[0])
    assert_close("latitude, deg", found.longitude_deg, given[1])
    assert_close("flight position", found.height_m, height)
    assert_close("flight position", earth_centred_m(0.0, 90.0, 2.0), [0.0, 6378139.0, 0.0])
    assert_close("flight position", earth_centred_m(90.0, 0.0, 2.0), [0.0, 0.0, 6356754.3142])


# Refraction of lines of sight at their heights, near equal heights, and which way they bend


CAMERA_M = 3000.0


def integral(length: float, camera: float, landmark: float, rise: float) -> float:
    """Curvature k cos(e) exp(-z / H) / R times (1 - s / L), summed along the path."""

    def bent(s: float) -> float:
        height = camera + (landmark - camera) * s / length
        return float(np.exp(-height / 8000.0) * (1.0 - s / length))

    size = 0.13 * np.sqrt(1.0 - rise**2) / 6371e3
    return float(size * quad(bent, 0.0, length, epsrel=1e-12)[0])


@pytest.mark.parametrize("growth", [-2.0, -0.05, -1.1e-4, -0.9e-4, 0.0, 0.9e-4, 1.1e-4, 0.05, 2.0])
def test_refraction_on_both_sides_of_level(growth: float) -> None:
    """Growth is the difference of heights in scale heights of 8 km."""
    landmark, length = CAMERA_M + 8000.0 * growth, 40e3
    rise = 8000.0 * growth / length
    found = refraction_rad(
        Refraction(), *(np.array([x]) for x in (length, CAMERA_M, landmark, rise))
    )
    assert_close("flight refraction", found[0], integral(length, CAMERA_M, landmark, rise))


def test_a_rise_beyond_one_by_rounding_is_straight_up() -> None:
    for decays in (True, False):
        one = refraction_rad(
            Refraction(0.13, decays), *(np.array([x]) for x in (100.0, 0.0, 100.0, 1.0 + 1e-15))
        )
        assert one.tolist() == [0.0]


@pytest.mark.parametrize("azimuth_deg", [20.0, 70.0, 200.0])
@pytest.mark.parametrize("down_m", [0.0, 2500.0, -4000.0])
def test_lines_are_raised_in_their_own_vertical_planes(azimuth_deg: float, down_m: float) -> None:
    camera = earth_centred_m(40.0, -75.0, CAMERA_M)
    way = np.radians(azimuth_deg)
    away = np.array([np.sin(way) * 20e3, np.cos(way) * 20e3, -down_m])
    marks = np.stack([np.full(3, 7e6), camera + away @ local_axes(camera)])  # the first not seen
    frame, mark = np.zeros(1, np.int64), np.ones(1, np.int64)
    seen = sight_lines(camera[None], marks, frame, mark, Refraction())
    length = np.linalg.norm(away)
    east, north, up = seen.direction[0]
    assert_close("flight direction", np.hypot(east, north) ** 2 + up**2, 1.0)
    assert_close("flight direction", np.arctan2(east, north) % (2 * np.pi), way)
    sunk = 20e3**2 / 2 / 6.37e6  # the Earth curves away, so that the landmark is higher
    straight = -down_m / length
    raised = integral(length, CAMERA_M, CAMERA_M - down_m + sunk, straight)
    assert_close("curvature", seen.raised_rad[0], raised)
    assert_close("flight direction", np.arcsin(up) - np.arcsin(straight), seen.raised_rad[0])
    assert_close("flight position", seen.distance_m[0], length)
    assert_close("latitude, deg", seen.camera.latitude_deg[0], 40.0)
    assert_close("flight direction", seen.axes[0], local_axes(camera))
