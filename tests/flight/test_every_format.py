"""One flight in every format that a project can name: the same angles."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.kit.flight_files import (
    LANDMARKS,
    LENSES,
    OTHER_LENSES,
    PICKS,
    POSITION,
    TRACKS,
    WINDS,
    Part,
    project,
)
from tests.kit.flight_project import truth_deg
from tests.tolerances import assert_close
from vopd.flight.result import FlightResult, solve_flight

LENS, SEEN = LENSES["inline"], PICKS["CSV of frames"]
MARKS, TRACK = LANDMARKS["CSV, geodetic"], TRACKS["CSV by seconds"]


def solved(folder: Path, *parts: Part) -> FlightResult:
    for name, text in project(*parts).items():
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return solve_flight(str(folder / "flight.toml"))


@pytest.mark.parametrize("name", LENSES)
def test_lenses(tmp_path: Path, name: str) -> None:
    found = solved(tmp_path, LENSES[name], SEEN, MARKS, TRACK)
    assert_close("flight angle", found.estimate.camera_deg, truth_deg())


@pytest.mark.parametrize("track", TRACKS)
@pytest.mark.parametrize("picks", PICKS)
def test_picks_and_tracks(tmp_path: Path, picks: str, track: str) -> None:
    if PICKS[picks].frames_by == "number" and TRACKS[track].frames_by == "image":
        return  # numbers of frames say nothing of images
    found = solved(tmp_path, LENS, PICKS[picks], MARKS, TRACKS[track])
    assert_close("flight angle", found.estimate.camera_deg, truth_deg())


@pytest.mark.parametrize("name", LANDMARKS)
def test_landmarks(tmp_path: Path, name: str) -> None:
    found = solved(tmp_path, LENS, SEEN, LANDMARKS[name], TRACK)
    assert_close("flight angle", found.estimate.camera_deg, truth_deg())


@pytest.mark.parametrize("name", WINDS)
def test_winds(tmp_path: Path, name: str) -> None:
    found = solved(tmp_path, LENS, SEEN, MARKS, TRACK, WINDS[name])
    assert_close("flight angle", found.estimate.camera_deg, truth_deg())
    assert found.flight.path.wind_m_s is not None


@pytest.mark.parametrize("name", OTHER_LENSES)
def test_other_lenses_are_read(tmp_path: Path, name: str) -> None:
    """The picks were made with another lens, so the angles are some tenths of a degree off."""
    found = solved(tmp_path, OTHER_LENSES[name], SEEN, MARKS, POSITION)
    assert_close("angle with another lens", found.estimate.camera_deg, truth_deg())
