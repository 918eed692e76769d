"""What the output says of a flight: refraction, angles of attack, time, repeated picks."""

from __future__ import annotations

import time
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit.random_flights import lenses
from vopd.estimate import MapGrid
from vopd.flight.estimate import flight_words
from vopd.flight.flight import CameraPath, Flight, FlightOptions, LandmarkSet, Picks, Refraction
from vopd.flight.solve import solve
from vopd.geometry.earth import local_axes
from vopd.geometry.lenses import project

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


def test_lines_of_sight_that_bend_the_other_way() -> None:
    words = said("refraction", refraction=Refraction(-0.1, decays=False))
    assert words.startswith("coefficient -0.1 at the ground, constant")


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


@pytest.mark.skipif(not hasattr(time, "tzset"), reason="no time zone by environment")
def test_where_time_begins(monkeypatch: pytest.MonkeyPatch) -> None:
    """In UTC, also where the computer's own zone is another."""
    monkeypatch.setenv("TZ", "Asia/Tokyo")
    time.tzset()
    try:
        _where_time_begins()
    finally:
        monkeypatch.delenv("TZ")
        time.tzset()


def _where_time_begins() -> None:
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


def test_every_other_sentence_about_a_flight() -> None:
    velocity = CameraPath(CAMERA[None], np.full(3, np.nan), velocity_m_s=np.array([[9.0, 0, 0]]))
    options = FlightOptions("cauchy")
    given = flight(about=("one", "two, x", "three"), options=options, path=velocity)
    words = flight_words(solve(given))
    assert [*words.conventions] == [
        "input", "solve", "pixels", "refraction", "angles of attack", "time",
    ]  # fmt: skip
    assert words.conventions["input"] == "one; two, x; three"
    assert words.conventions["solve"] == (
        "rotation by cauchy with the camera's position given; WGS 84; "
        "residuals in pixels of the image as it was taken, x to the left, y up"
    )
    assert words.conventions["pixels"] == "u right, v down, (0, 0) the centre of the first pixel"
    assert words.conventions["angles of attack"] == (
        "alpha = atan2(w, u), beta = atan2(v, u), eta = atan2(sqrt(v2 + w2), u), "
        "u v w the velocity against the ground, as no wind is given, in the body"
    )
    assert (words.source, words.landmark, words.reading) == (
        "project", "its name", "a pick's u or v",
    )  # fmt: skip
    assert words.flags == {
        "undetermined": (
            "fewer than two landmarks in different directions, or no position: no angles; what is "
            "not known is named",
            "pick more landmarks; look at the track's times",
        ),
        "outlier": (
            "a landmark does not fit the others (F test, .001 a frame, four landmarks or more); it "
            "is named",
            "look at its pick in that image and at its coordinates",
        ),
        "second_solution": (
            "an attitude with the landmarks on the camera's other side fits as well; the solve has "
            "taken the one with the landmarks in front",
            "none is needed where the view is beyond doubt",
        ),
    }


def test_the_gimbal_is_compared_with_the_solved_angles() -> None:
    """The camera looks level to the north: the gimbal said 3 degrees up."""
    path = CameraPath(CAMERA[None], np.full(3, np.nan), gimbal_deg=np.array([[0.0, 3.0, 0.0]]))
    sentence = said("gimbal", path=path, refraction=Refraction(0.0))
    assert_approved(sentence)
    assert "right -3.00" in sentence


@pytest.mark.parametrize(("convergence", "said_deg"), [(1.23456, "1.2346"), (-0.5, "-0.5000")])
def test_a_grid_has_its_convergence(convergence: float, said_deg: str) -> None:
    one = np.zeros(1)
    grid = MapGrid("EPSG:32633", one, one, np.array([convergence]))
    assert said("grid azimuth", grid=grid) == (
        f"true azimuth less {said_deg} degree, the meridian convergence of the landmarks' CRS at "
        "the first frame"
    )
