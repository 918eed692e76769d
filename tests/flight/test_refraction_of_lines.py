"""Refraction of lines of sight at their heights, near equal heights, and which way they bend."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from tests.tolerances import assert_close
from vopd.flight.flight import Refraction
from vopd.flight.solve import refraction_rad, sight_lines
from vopd.geometry.earth import earth_centred_m, local_axes

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
