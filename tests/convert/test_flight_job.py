"""The job of a flight: every record of it, its title, its mount and its wind."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.kit.flight_project import three_frames, truth_deg
from tests.tolerances import assert_close
from vopd.convert.flight_to_deck import (
    PunchedFlight,
    _roll_offset_deg,
    card_trajectory,
    card_wind,
    flight_job,
    to_ten_columns,
)
from vopd.findings import VopdError
from vopd.flight.flight import Flight
from vopd.flight.result import FlightEstimates, FlightResult
from vopd.flight.solve import solve
from vopd.geometry.earth import geodetic
from vopd.geometry.rotations import DOWN, mount_by_angles

FT = 3.2808336


def result(flight: Flight) -> FlightResult:
    return FlightResult(FlightEstimates(solve(flight)), ())


@pytest.fixture(scope="module")
def punched() -> PunchedFlight:
    return flight_job(result(three_frames()))


def test_every_record_of_the_job(punched: PunchedFlight) -> None:
    """Frames b and c of three have an attitude; the fourth landmark is a check landmark."""
    job = punched.job
    assert job.return_group == 13 and job.title == "1   F12".ljust(80)
    assert job.clock.frame.tolist() == job.readings.frame.tolist() == [1, 2]
    assert_close("flight time", job.clock.time_s, [2.1, 2.2])
    assert_close("flight time", job.trajectory.time_s, [2.1, 2.2])
    assert job.landmarks.number.tolist() == [1, 2, 3, 4]
    assert job.readings.landmark.tolist() == [[1, 2, 3, 4]] * 2
    assert job.ignored.everywhere.tolist() == [4, 0, 0, 0]
    camera = job.camera
    assert_close("five decimals", camera.focal_length_mm, 1495.0 * 0.005 * 0.713816400205)
    assert camera.multiplier.tolist() == [1, 1, 1] and (camera.offset_deg == 0.0).all()
    first = truth_deg()[1] % 360.0 - [0, 360, 0]
    assert_close("printed angle", camera.initial_deg, first)
    assert (np.round(camera.initial_deg, 3) == camera.initial_deg).all()
    velocity = np.tile(np.array([20.0, 5.0, -2.0]) * FT, (2, 1))
    assert_close("motion on cards", job.trajectory.velocity_ft_s, velocity)
    assert_close("motion on cards", job.wind.velocity_ft_s, np.tile([3.0, -1.0], (2, 1)) * FT)


def test_numbers_of_frames_and_then_of_landmarks(punched: PunchedFlight) -> None:
    frames = [("frame", 1, "b.jpg"), ("frame", 2, "c.jpg")]
    marks = [("landmark", k, n) for k, n in enumerate(("church", "mast", "bridge", "corner"), 1)]
    assert [tuple(row) for row in punched.numbers] == frames + marks


@pytest.mark.parametrize(
    ("name", "title"),
    [("", "1   FLIGHT"), ("Flüg 2", "1   Fl?g 2"), ("x" * 90, "1   " + "x" * 76)],
)
def test_the_title_is_eighty_columns_of_ascii(name: str, title: str) -> None:
    job = flight_job(result(replace(three_frames(), name=name))).job
    assert job.title == title.ljust(80) and len(job.title) == 80


def test_a_flight_without_an_attitude_is_refused() -> None:
    flight = three_frames()
    path = replace(flight.path, position_m=np.full((3, 3), np.nan))
    with pytest.raises(VopdError) as refused:
        flight_job(result(replace(flight, path=path)))
    assert str(refused.value) == "flight.toml: no frame has an attitude, so none can be punched"


@pytest.mark.parametrize(
    ("mount", "roll"),
    [
        (mount_by_angles([0.0, 0.0, 0.0]), 0.0),
        (mount_by_angles([0.0, 0.0, 30.0]), -30.0),
        (mount_by_angles([0.0, 0.0, -170.0]), 170.0),
        (mount_by_angles([1e-4, 0.0, 0.0]), None),  # the cosine is 1.5E-12 below 1
        (mount_by_angles([1e-5, 0.0, 0.0]), 0.0),
        (DOWN, None),
    ],
)
def test_a_mount_that_is_a_turn_about_the_view(mount: Any, roll: float | None) -> None:
    found = _roll_offset_deg(replace(three_frames(), mount=mount))
    assert (found is None) == (roll is None)
    assert_close("angle of a matrix", found or 0.0, roll or 0.0)


def test_notes_of_the_film_and_of_times_come_first() -> None:
    """The lens is not radial; a time is not known."""
    flight = replace(three_frames(), time_s=np.array([1.0, 2.0, np.nan]))
    notes = flight_job(result(flight)).notes
    assert notes[0].startswith("the lens is not radial: its distortion is taken off the picks")
    assert notes[1].startswith("the frames have no times that increase")
    assert notes[2].startswith("1 of 3 frames have no attitude") and notes[-1].startswith(
        "altitudes"
    )


def test_the_wind_is_by_altitude_upward_each_once_and_calm_where_there_is_none() -> None:
    flight = three_frames()
    wind = np.array([[9.0, 9.0], [1.0, 2.0], [3.0, 4.0]])
    windy = replace(flight, path=replace(flight.path, wind_m_s=wind))
    given: Any = type("Trajectory", (), {"altitude_ft": np.array([700.0, 300.0])})
    found = card_wind(windy, given, np.array([1, 2]))
    assert found.altitude_ft.tolist() == [300.0, 700.0]
    assert_close("five decimals", found.velocity_ft_s, np.array([[3.0, 4.0], [1.0, 2.0]]) * FT)
    given.altitude_ft = np.array([300.0, 300.0])
    assert_close(
        "five decimals", card_wind(windy, given, np.array([1, 2])).velocity_ft_s, wind[[1]] * FT
    )
    calm = card_wind(replace(flight, path=replace(flight.path, wind_m_s=None)), given, np.arange(2))
    assert (calm.altitude_ft.tolist(), calm.velocity_ft_s.tolist()) == ([0.0], [[0.0, 0.0]])


@pytest.mark.parametrize("value", [-0.0, -1e-12])
def test_no_minus_zero_is_written(value: float) -> None:
    assert np.signbit(to_ten_columns(np.array([value]))).tolist() == [False]


def test_the_trajectory_is_about_an_origin_that_the_card_holds() -> None:
    """Latitude and longitude of the first frame that is written, to ten columns; its own speed."""
    flight = three_frames()
    velocity = np.array([[9.0, 9.0, 9.0], [1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    flight = replace(flight, path=replace(flight.path, velocity_m_s=velocity))
    found = card_trajectory(solve(flight), flight, np.array([1, 2]), np.array([5.0, 6.0]))
    assert_close("five decimals", found.velocity_ft_s, velocity[1:] * FT)
    where = geodetic(flight.path.position_m)
    for own, full in (
        (found.origin_latitude_deg, where.latitude_deg[1]),
        (found.origin_longitude_deg, where.longitude_deg[1]),
    ):
        assert own == float(f"{own:.7f}") and own != full
        assert_close("angle at a pole", own, full)
    assert_close("cards of a flight", found.altitude_ft, where.height_m[1:] * FT)
    still = replace(flight, path=replace(flight.path, velocity_m_s=None))
    found = card_trajectory(solve(still), still, np.array([1, 2]), np.array([5.0, 6.0]))
    assert found.velocity_ft_s.tolist() == [[0.0] * 3] * 2
