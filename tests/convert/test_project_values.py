"""The tables and keys of a project that is made of a deck, worked by hand from the cards."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import refused
from tests.tolerances import assert_close
from vopd.convert.deck_to_flight import DeckProject, deck_project
from vopd.findings import VopdError
from vopd.job import Job, Landmarks, Wind
from vopd.synthetic import Plan
from vopd.synthetic.flight import make

M = 1000.0 / 3280.8336  # of a foot, as the program of 1974 has it
NO_MOUNT = "group 3 takes the vehicle's angles from the camera's one by one"


def job() -> Job:
    """Three frames of five landmarks."""
    return make(Plan(frames=3, landmarks=5, seed=4))[0][0]


def project_of(**changes: Any) -> DeckProject:
    return deck_project(replace(job(), **changes))


def rows(project: DeckProject, name: str) -> tuple[str, list[list[float]]]:
    """Header and numbers of a table, whose last line has its end."""
    text = project.contents[name].decode()
    assert text.endswith("\n") and not text.endswith("\n\n")
    header, *lines = text.splitlines()
    return header, [[float(cell) for cell in line.split(",")] for line in lines]


def keys(project: DeckProject) -> dict[str, Any]:
    return tomllib.loads(project.contents["flight.toml"].decode())


def test_a_landmark_given_twice_is_as_it_was_given_last() -> None:
    marks = Landmarks(
        number=np.array([3, 5, 3]),
        longitude_deg=np.array([-107.0, -106.0, -105.0]),
        longitude_min=np.array([30.0, 15.0, 45.0]),
        latitude_deg=np.array([33.0, 34.0, 35.0]),
        latitude_min=np.array([6.0, 12.0, 18.0]),
        altitude_ft=np.array([4000.0, 5000.0, 6000.0]),
    )
    header, found = rows(project_of(landmarks=marks), "landmarks.csv")
    assert header == "landmark,lat_deg,lon_deg,h_m"
    assert [row[0] for row in found] == [3.0, 5.0]
    assert_close("ratio", [row[1:3] for row in found], [[35.3, -104.25], [34.2, -105.75]])
    assert_close("five decimals", [row[3] for row in found], [6000.0 * M, 5000.0 * M])


def test_the_wind_comes_from_where_it_does_not_go() -> None:
    toward = [[10.0, 0.0], [0.0, 10.0], [-3.0, -4.0], [0.0, -10.0], [-10.0, 0.0]]
    wind = Wind(np.array([0.0, 100.0, 200.0, 300.0, 400.0]), np.array(toward))
    project = project_of(wind=wind)
    header, found = rows(project, "wind.csv")
    assert header == "h_m,from_deg,speed_m_s"
    height, direction, speed = np.array(found).T
    assert_close("four decimals", height, np.array([0.0, 100.0, 200.0, 300.0, 400.0]) * M)
    expected = [180.0, 270.0, np.degrees(np.arctan2(4.0, 3.0)), 90.0, 0.0]
    assert_close("five decimals", direction, expected)
    assert_close("five decimals", speed, np.array([10.0, 10.0, 5.0, 10.0, 10.0]) * M)
    assert keys(project)["wind"]["file"] == "wind.csv"


def test_calm_is_no_wind() -> None:
    project = project_of(wind=Wind(np.array([0.0]), np.zeros((1, 2))))
    assert "wind.csv" not in project.contents and "wind" not in keys(project)


@pytest.mark.parametrize(
    ("multiplier", "offset", "mount", "noted"),
    [
        ((1, 1, 1), (0, 0, 0), None, False),
        ((1, 1, 1), (0, 0, -210), [0.0, 0.0, 210.0], False),
        ((1, 1, 1), (0, 0, 30), [0.0, 0.0, -30.0], False),
        ((1, 1, 1), (360, -360, 30), [0.0, 0.0, -30.0], False),
        ((1, 1, 1), (1, 0, 30), None, True),
        ((1, 1, 1), (0, 180, 0), None, True),
        ((1, 1, -1), (0, 0, 0), None, True),
    ],
)
def test_only_a_turn_about_the_view_is_a_mount(
    multiplier: tuple[int, ...], offset: tuple[int, ...], mount: list[float] | None, noted: bool
) -> None:
    camera = replace(
        job().camera, multiplier=np.array(multiplier, float), offset_deg=np.array(offset, float)
    )
    project = project_of(camera=camera)
    expected = {} if mount is None else {"mount": {"ypr_deg": mount}}
    assert keys(project).get("vehicle", {}) == expected
    assert any(note.startswith(NO_MOUNT) for note in project.notes) is noted


def test_the_track_is_in_degrees_metres_and_metres_a_second() -> None:
    """At the origin, and 100 kft above it: the origin's own latitude and longitude."""
    path = job().trajectory
    still = replace(
        path,
        time_s=path.time_s[:2],
        position_ft=np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1e5]]),
        velocity_ft_s=np.array([[1.0, 2.0, 3.0], [-10.0, 20.0, -30.0]]),
        altitude_ft=np.array([0.0, 1e5]),
    )
    header, found = rows(project_of(trajectory=still), "track.csv")
    assert header == "t_s,lat_deg,lon_deg,h_m,vn_m_s,ve_m_s,vd_m_s"
    table = np.array(found)
    assert_close("flight time", table[:, 0], path.time_s[:2])
    assert_close("ratio", table[:, 1], path.origin_latitude_deg)
    assert_close("ratio", table[:, 2], path.origin_longitude_deg)
    assert_close("five decimals", table[1, 3] - table[0, 3], 1e5 * M)
    assert_close("five decimals", table[:, 4:], still.velocity_ft_s * M)


def test_frames_have_their_times_once() -> None:
    """A frame that is read twice counts the first time, and that is noted."""
    one = job()
    twice = np.array([0, 1, 2, 1])
    project = project_of(readings=one.readings.take(twice))
    header, found = rows(project, "times.csv")
    assert header == "frame,t_s" and [row[0] for row in found] == one.readings.frame.tolist()
    once = rows(project_of(), "times.csv")[1]
    assert found == once
    assert "frames that are read more than once: the first time is kept" in project.notes
    header, picks = rows(project, "picks.csv")
    assert header == "frame,landmark,u_px,v_px" and len(picks) == 3 * 5 * 3
    assert picks == rows(project_of(), "picks.csv")[1]


def test_the_distortion_is_noted_where_there_is_one() -> None:
    camera = job().camera
    note = "the lens's distortion (group 1) is taken off the picks: the lens has none"
    assert np.any(camera.lens_distortion_um) and note in project_of().notes
    none = replace(camera, lens_distortion_um=np.zeros(25))
    assert note not in project_of(camera=none).notes


def test_keys_that_the_cards_decide() -> None:
    """The title is without the printer's column; a pixel is .7138164002 mm / 1000."""
    one = job()
    ignored = replace(one.ignored, everywhere=np.array([0, 4, 99, 2, 4]))
    project = project_of(title="1  A TITLE" + " " * 70, ignored=ignored)
    found = keys(project)
    assert found["flight"] == {"name": "A TITLE"}
    lens = found["camera"]["lens"]
    expected = one.camera.focal_length_mm * 1000.0 / 0.713816400205
    assert lens["model"] == "brown"
    assert_close("ratio", lens["fx_px"] / expected, 1.0)
    assert found["solve"]["check_landmarks"] == ["2", "4"]
    assert found["atmosphere"] == {"refraction": "off"}
    for section in ("landmarks", "track"):
        assert found[section]["height"] == "ellipsoid"
    assert "solve" not in keys(project_of())


@pytest.mark.parametrize(
    "changes",
    [
        {"readings": job().readings.take(np.zeros(0, np.int64))},
        {"camera": replace(job().camera, focal_length_mm=0.000713)},
    ],
)
def test_what_is_no_flight_is_refused(changes: dict[str, Any]) -> None:
    with refused(VopdError):
        project_of(**changes)


def test_a_focal_length_of_more_than_a_pixel_is_one() -> None:
    assert project_of(camera=replace(job().camera, focal_length_mm=0.000715))
