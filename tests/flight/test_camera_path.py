"""Where the camera was in each frame of a track by time: interpolation, motion, ends, errors."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.findings import VopdError
from vopd.flight import track as camera_path
from vopd.flight.flight import CameraPath
from vopd.flight.formats.track import TrackRows
from vopd.flight.project import Section
from vopd.flight.track import FrameTimes, _by_time

TRACK_S = np.array([0.0, 1.0, 3.0, 4.0, 6.5, 7.0])
START, SPEED = np.array([6378137.0 + 500.0, 0.0, 0.0]), np.array([2.0, 5.0, 20.0])
CHANGE, JERK = np.array([0.5, -1.0, 0.25]), np.array([0.1, 0.2, -0.3])
# at latitude and longitude 0 east is y, north z, and down -x
NED_FROM_XYZ = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])


def moved(time_s: Floats, jerk: Floats) -> tuple[Floats, Floats, Floats]:
    """Position, Earth-centred; velocity and acceleration north, east, down."""
    t = np.asarray(time_s)[:, None]
    position = START + SPEED * t + CHANGE * t**2 / 2 + jerk * t**3 / 6
    speed, change = SPEED + CHANGE * t + jerk * t**2 / 2, CHANGE + jerk * t
    return position, speed @ NED_FROM_XYZ.T, change @ NED_FROM_XYZ.T


def path(
    frame_s: Floats, said: list[str], jerk: Floats, rows: dict[str, Any] | None = None, **keys: Any
) -> CameraPath:
    position = moved(TRACK_S, jerk)[0]
    track = TrackRows(position, False, None, "seconds", TRACK_S, "CSV", **(rows or {}))
    section, times = Section("p.toml", "track", keys), FrameTimes(np.asarray(frame_s), (), None)
    return _by_time(section, track, position, times, said, "t.csv")


def columns(found: CameraPath) -> tuple[Floats, Floats, Floats]:
    assert found.velocity_m_s is not None and found.acceleration_m_s2 is not None
    return found.position_m, found.velocity_m_s, found.acceleration_m_s2


@pytest.mark.parametrize("at_once", [20_000, 1, 2, 3])
def test_cubic_motion_is_exact_by_cubic_pieces(
    at_once: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(camera_path, "FRAMES_AT_ONCE", at_once)
    frame_s, said = np.array([0.0, 0.4, 2.0, 5.1, 6.9]), list[str]()
    found = columns(path(frame_s, said, JERK, interpolate="cubic"))
    expected = moved(frame_s, JERK)
    assert_close("flight position", found[0], expected[0])
    assert_close("flight speed", found[1], expected[1])
    assert_close("flight speed", found[2], expected[2])
    assert said == [
        "positions between those of the track: cubic",
        "velocity by the differences of the track's positions",
    ]


@pytest.mark.parametrize("key", [{}, {"interpolate": "linear"}])
def test_linear_is_usual_and_goes_along_chords(key: dict[str, str]) -> None:
    """Between 1 and 3 s the middle is the mean of the ends; differences of a square are exact."""
    said = list[str]()
    found = columns(path(np.array([2.0, 3.0, 4.0]), said, np.zeros(3), **key))
    (before, after), velocity = moved(np.array([1.0, 3.0]), 0.0 * JERK)[0], moved([3, 4], 0 * JERK)
    assert_close("flight position", found[0][0], (before + after) / 2.0)
    assert_close("flight speed", found[1][1:], velocity[1])
    assert_close("flight speed", found[2][1], velocity[2][0])
    assert said[0] == "positions between those of the track: linear"


@pytest.mark.parametrize("interpolate", ["linear", "cubic"])
def test_a_track_holds_from_its_first_to_its_last_time(interpolate: str) -> None:
    frame_s = np.array([-1e-6, 0.0, 7.0, 7.0 + 1e-6, np.nan])
    found = path(frame_s, [], JERK, interpolate=interpolate)
    for values in columns(found):
        assert np.isfinite(values[1:3]).all() and np.isnan(values[[0, 3, 4]]).all()
    assert_close("flight position", found.position_m[1:3], moved([0.0, 7.0], JERK)[0])


def test_the_offset_is_added_to_the_track_s_times() -> None:
    """The track 2 s later: a frame at 5 s is where the track is at 3 s."""
    found = path(np.array([5.0]), [], JERK, interpolate="cubic", offset_s=2.0)
    assert_close("flight position", found.position_m, moved([3.0], JERK)[0])


def test_a_velocity_of_the_track_is_interpolated_and_the_acceleration_is_not() -> None:
    own = np.stack([TRACK_S, -2.0 * TRACK_S, 3.0 * TRACK_S], axis=1)
    said = list[str]()
    found = path(np.array([2.0, 5.0]), said, JERK, {"velocity_m_s": own}, interpolate="cubic")
    assert_close("table value", found.velocity_m_s, [[2.0, -4.0, 6.0], [5.0, -10.0, 15.0]])
    assert_close("flight speed", found.acceleration_m_s2, moved([2.0, 5.0], JERK)[2])
    assert said[1:] == ["velocity as the track has it"]


def test_sigmas_and_lever_arm_are_the_project_s_or_the_file_s() -> None:
    keys = {"sigma_t_s": 0.25, "sigma_m": [1.0, 2.0, 3.0], "lever_arm_m": [0.1, 0.2, 0.3]}
    found = path(np.array([1.0]), [], JERK, None, **keys)
    assert found.sigma_time_s == 0.25 and found.sigma_m.tolist() == [1.0, 2.0, 3.0]
    assert found.lever_arm_m is not None and found.lever_arm_m.tolist() == [0.1, 0.2, 0.3]
    own = np.tile([3.0, 4.0, 5.0], (6, 1)) * np.array([1, 1, 1, 1, 1, 0])[:, None]
    found = path(np.array([1.0]), [], JERK, {"sigma_m": own})
    assert_close("ratio", found.sigma_m, np.array([3.0, 4.0, 5.0]) * np.sqrt(5 / 6))
    assert (found.sigma_time_s, found.lever_arm_m) == (0.0, None)
    assert np.isnan(path(np.array([1.0]), [], JERK).sigma_m).all()


@pytest.mark.parametrize(
    ("track_s", "lines", "message"),
    [
        ([0.0, 1.0, 1.0, 0.5], (), "position 3: its time is not after the one before"),
        ([0.0, 1.0, np.nan, 2.0], (), "position 3: its time is not after the one before"),
        ([0.0, 2.0, 1.0, 0.5], (2, 3, 5, 8), "line 5: its time is not after the one before"),
        ([3.0], (2,), "one position is no track: give it as [position]"),
    ],
)
def test_a_track_that_does_not_go_on_is_refused(
    track_s: list[float], lines: tuple[int, ...], message: str
) -> None:
    position = np.tile(START, (len(track_s), 1))
    rows = TrackRows(position, False, None, "seconds", np.array(track_s), "CSV", line=lines)
    times = FrameTimes(np.zeros(1), (), None)
    with pytest.raises(VopdError) as refused:
        _by_time(Section("p.toml", "track", {}), rows, position, times, [], "t.csv")
    assert str(refused.value) == f"p.toml: [track] file: t.csv: {message}"


def test_two_positions_are_a_track() -> None:
    rows = TrackRows(np.array([START, START + 4.0]), False, None, "seconds", np.arange(2.0), "CSV")
    times = FrameTimes(np.array([0.25]), (), None)
    found = _by_time(Section("p.toml", "track", {}), rows, rows.coordinate, times, [], "t.csv")
    assert_close("flight position", found.position_m[0], START + 1.0)


def test_frames_without_times_are_refused() -> None:
    with pytest.raises(VopdError, match=r"file: is by time, and the frames have none: give \[pick"):
        path(np.array([np.nan, np.nan]), [], JERK)
    assert np.isfinite(path(np.array([np.nan, 1.0]), [], JERK).position_m[1]).all()
