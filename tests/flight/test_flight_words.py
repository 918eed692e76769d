"""What the output says of a flight: refraction, angles of attack, time, repeated picks."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

import numpy as np
import pytest

from tests.kit.random_flights import lenses
from vopd.flight.flight import CameraPath, Flight, LandmarkSet, Picks, Refraction
from vopd.flight.solved_flight import solve
from vopd.flight.words import flight_words
from vopd.geometry.geodetic import local_axes
from vopd.geometry.lens_model import project

CAMERA = np.array([6_379_137.0, 0.0, 0.0])  # 1000 m above the equator
RAY = np.array([[-0.2, -0.1, 1.0], [0.3, 0.1, 1.0], [0.1, -0.2, 1.0], [-0.1, 0.2, 1.0]])
LEVEL_NORTH = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])  # right, down, forward
CONSTANT = Refraction(0.13, decays=False)


def flight(**changes: Any) -> Flight:
    """One frame, level to the north, of four landmarks 10 km to the north of the camera."""
    lens = lenses()["pinhole"]
    made = Flight(
        name="a flight",
        source="flight.toml",
        lens=lens,
        frame=np.arange(1),
        image_name=(),
        time_s=np.zeros(1),
        epoch=None,
        picks=Picks(np.zeros(4, int), np.arange(4), project(lens, RAY).pixel, np.ones(4)),
        landmarks=LandmarkSet(
            tuple("abcd"),
            CAMERA + 10e3 * RAY @ LEVEL_NORTH @ local_axes(CAMERA),
            np.full((4, 3), np.nan),
        ),
        path=CameraPath(CAMERA[None], np.full(3, np.nan)),
        mount=np.eye(3),
    )
    return replace(made, **changes)


def said(name: str, **changes: Any) -> str:
    return flight_words(solve(flight(**changes))).conventions[name]


def test_no_refraction() -> None:
    assert said("refraction", refraction=Refraction(0.0)) == "off"


def test_constant_refraction_and_the_most_it_does() -> None:
    """k s cos(elevation) / 2R of the landmark farthest along the ground: 10 km by hypot(1, .3)."""
    degree = np.degrees(0.13 * 10e3 * np.sqrt(1.0 + 0.3**2) / (2.0 * 6371e3))
    assert said("refraction", refraction=CONSTANT) == (
        "coefficient 0.13 at the ground, constant; "
        f"it raises lines of sight by {degree:.5f} degree at most"
    )


def test_refraction_that_decays() -> None:
    """All lines are below 3 km: it is less than constant refraction, and more than exp(-3/8)."""
    words = said("refraction", refraction=Refraction(0.2))
    start, _, figure = words.removesuffix(" degree at most").rpartition(" by ")
    assert start == (
        "coefficient 0.2 at the ground, decaying with height over 8 km; it raises lines of sight"
    )
    constant = np.degrees(0.2 * 10e3 * np.sqrt(1.0 + 0.3**2) / (2.0 * 6371e3))
    assert constant * np.exp(-3.0 / 8.0) < float(figure) < constant


def test_without_a_position_nothing_is_raised() -> None:
    unknown = CameraPath(np.full((1, 3), np.nan), np.full(3, np.nan))
    words = said("refraction", refraction=CONSTANT, path=unknown)
    assert words == "coefficient 0.13 at the ground, constant"


@pytest.mark.parametrize(
    ("velocity", "wind", "expected"),
    [
        (None, None, "none: the velocity is not known"),
        ([[9.0, 0.0, 0.0]], None, "u v w the velocity against the ground, as no wind is given, in"),
        ([[9.0, 0.0, 0.0]], [[1.0, 0.0]], "u v w the velocity relative to the air in the body"),
    ],
)
def test_what_angles_of_attack_are_against(
    velocity: list[list[float]] | None, wind: list[list[float]] | None, expected: str
) -> None:
    path = CameraPath(
        CAMERA[None],
        np.full(3, np.nan),
        velocity_m_s=None if velocity is None else np.array(velocity),
        wind_m_s=None if wind is None else np.array(wind),
    )
    assert expected in said("angles of attack", path=path)


def test_where_time_begins() -> None:
    assert said("time") == "seconds of the flight"
    epoch = datetime(2024, 5, 1, 12, 30, 0, 250_000, UTC)
    zero = "seconds of the flight; zero is 2024-05-01T12:30:00.250000Z"
    assert said("time", epoch=epoch) == zero


@pytest.mark.parametrize(
    ("repeatability_px", "expected"),
    [(np.nan, "as stated in the project"), (0.4, "by points picked several times")],
)
def test_where_the_repeatability_is_from(repeatability_px: float, expected: str) -> None:
    one = flight()
    picks = replace(one.picks, repeatability_px=repeatability_px)
    assert flight_words(solve(replace(one, picks=picks))).repeated == expected
