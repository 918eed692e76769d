"""Where the camera was in each frame: tracks by time or by image, clocks, fixed places, errors."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.flight_project import keys, track
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.findings import VopdError
from vopd.flight.coordinates import HeightDatum
from vopd.flight.flight import CameraPath, TrackFixes, TrackSlopes
from vopd.flight.formats.picks import Names, PickRows
from vopd.flight.formats.track import TrackRows, photo_number
from vopd.flight.project import track as track_module
from vopd.flight.project.keys import Project, Section
from vopd.flight.project.stated import Notes
from vopd.flight.project.times import BRING_TIMES, FrameTimes, first_whole_second, frames_of
from vopd.flight.project.track import (
    PathRead,
    covering_text,
    doubts_of_holes,
    doubts_of_leaps,
    doubts_of_scatter,
    height_datum,
    path_by_image,
    path_by_time,
    read_path,
    rows_of_images,
    times_of_track,
    track_clock,
    track_height,
    track_on_clock,
    why_nowhere,
)
from vopd.geometry.earth import earth_centred_m, geodetic

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
    return path_by_time(section, track, position, times, Notes(said, {}), "t.csv")


def columns(found: CameraPath) -> tuple[Floats, Floats, Floats]:
    assert found.velocity_m_s is not None and found.acceleration_m_s2 is not None
    return found.position_m, found.velocity_m_s, found.acceleration_m_s2


@pytest.mark.parametrize("at_once", [20_000, 1, 2, 3])
def test_cubic_motion_is_exact_by_cubic_pieces(
    at_once: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(track_module, "FRAMES_AT_ONCE", at_once)
    frame_s, said = np.array([0.0, 0.4, 2.0, 5.1, 6.9]), list[str]()
    found = path(frame_s, said, JERK, interpolate="cubic")
    position, velocity, _ = moved(frame_s, JERK)
    assert_close("flight position", found.position_m, position)
    assert found.velocity_m_s is not None and found.velocity_sigma_m_s is not None
    assert (np.abs(found.velocity_m_s - velocity) < 2.0 * found.velocity_sigma_m_s).all()
    assert_approved(said)


@pytest.mark.parametrize("key", [{}, {"interpolate": "linear"}])
def test_linear_is_usual_and_goes_along_chords(key: dict[str, str]) -> None:
    """Between 1 and 3 s the middle is the mean of the ends; differences of a square are exact."""
    said = list[str]()
    found = columns(path(np.array([2.0, 3.0, 4.0]), said, np.zeros(3), **key))
    (before, after), velocity = moved(np.array([1.0, 3.0]), 0.0 * JERK)[0], moved([3, 4], 0 * JERK)
    assert_close("flight position", found[0][0], (before + after) / 2.0)
    assert_close("flight speed", found[1][1:], velocity[1])
    assert_close("flight speed", found[2][1], velocity[2][0])
    assert_approved(said[0])


def test_rows_far_from_the_frames_of_a_long_track_say_nothing() -> None:
    """A path that is smooth about its frames, and noise of a kilometre 30,000 rows away."""
    time_s, frame_s = np.arange(-50_000, 50_000) * 0.01, np.array([0.0, 0.0055])
    position = START + SPEED * time_s[:, None]
    position[:10_000] += np.random.default_rng(1).normal(0.0, 1000.0, (10_000, 3))
    rows = TrackRows(position, False, None, "seconds", time_s, "CSV")
    section, times = Section("p.toml", "track", {}), FrameTimes(frame_s, (), None)
    found = path_by_time(section, rows, position, times, Notes([], {}), "t.csv")
    assert found.row_s is not None and len(found.row_s) < len(time_s)
    assert_close("flight position", found.position_m, START + SPEED * frame_s[:, None])
    assert_close("flight speed", columns(found)[1], np.tile(SPEED @ NED_FROM_XYZ.T, (2, 1)))
    near = TrackRows(position[15_000:], False, None, "seconds", time_s[15_000:], "CSV")
    smooth = path_by_time(section, near, position[15_000:], times, Notes([], {}), "t.csv")
    assert found.velocity_sigma_m_s is not None and smooth.velocity_sigma_m_s is not None
    assert_close("flight speed", found.velocity_sigma_m_s, smooth.velocity_sigma_m_s)


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


def test_a_velocity_of_the_track_is_interpolated_and_the_acceleration_is_its_change() -> None:
    own = np.stack([TRACK_S, -2.0 * TRACK_S, 3.0 * TRACK_S], axis=1)
    said = list[str]()
    found = path(np.array([2.0, 5.0]), said, JERK, {"velocity_m_s": own}, interpolate="cubic")
    assert_close("table value", found.velocity_m_s, [[2.0, -4.0, 6.0], [5.0, -10.0, 15.0]])
    assert_close("table value", found.acceleration_m_s2, [[1.0, -2.0, 3.0]] * 2)
    assert_approved(said[1:])


def test_sigmas_and_lever_arm_are_the_project_s_or_the_file_s() -> None:
    keys = {"sigma_t_s": 0.25, "sigma_m": [1.0, 2.0, 3.0], "lever_arm_m": [0.1, 0.2, 0.3]}
    found = path(np.array([1.0]), [], JERK, None, **keys)
    assert found.fixes is not None and found.fixes.sigma_m.tolist() == [[1.0, 2.0, 3.0]] * 6
    assert found.lever_arm_m is not None and found.lever_arm_m.tolist() == [0.1, 0.2, 0.3]
    own = np.tile([3.0, 4.0, 5.0], (6, 1)) * np.array([1, 1, 1, 1, 1, 0])[:, None]
    found = path(np.array([1.0]), [], JERK, {"sigma_m": own})
    assert found.fixes is not None and found.fixes.sigma_m.tolist() == own.tolist()
    assert found.lever_arm_m is None and found.bias_sigma_m.tolist() == [0.0] * 3
    assert path(np.array([1.0]), [], JERK, sigma_m="exact").fixes is None


def test_a_track_that_is_exact_is_not_so_between_its_positions() -> None:
    found = path(np.array([1.5]), [], JERK, sigma_m="exact").fixes
    assert found is not None and found.exact and found.weight.shape == (1, 4)
    assert found.sigma_m[::3].tolist() == [[0.0] * 3] * 6
    assert found.frame_sigma_m.max() > 0.1


def test_frames_where_the_track_has_no_positions_are_counted() -> None:
    """More than ten steps, and five seconds; not frames at a position, nor outside of the track."""
    rows = np.concatenate([np.arange(0.0, 10.0, 0.5), np.arange(14.6, 20.0, 0.5), [30.0, 30.5]])
    at = [3.2, 9.5, 9.6, 12.0, 14.5, 14.6, 19.7, 30.0, 31.0, np.nan]
    assert_approved(doubts_of_holes(np.array(at), rows, "t.csv"))
    for few in ([3.2, 9.5, 14.6, 30.0], [-5.0, 40.0, np.nan], []):
        assert doubts_of_holes(np.array(few), rows, "t.csv") == []
    for row_s in (rows[rows < 14.0], np.array([0.0, 1.0, 2.0, 3.0, 13.0]), rows * 0.4, None):
        assert doubts_of_holes(np.array(at), row_s, "t.csv") == []
    assert doubts_of_holes(np.array([4.0]), np.array([0.0, 1.0, 2.0, 3.0, 13.1]), "t.csv")


def test_a_position_that_the_track_leaps_to_is_named() -> None:
    """60 m aside for one of four seconds: there and back 120 m/s^2; 40 m, 80 m/s^2."""
    position = np.array([START + k * SPEED for k in range(5)])
    rows = TrackRows(position, False, None, "seconds", np.arange(5.0), "CSV", line=(2, 3, 4, 5, 6))
    for aside_m, named in ((40.0, False), (60.0, True)):
        moved = position + aside_m * np.eye(3)[1] * (np.arange(5) == 3)[:, None]
        said = doubts_of_leaps(rows, moved, None, "t.csv")
        assert len(said) == named
    assert_approved(said)
    longer = np.array([START + k * SPEED for k in range(30)])
    eight = 60.0 * np.eye(3)[1] * (np.arange(30) % 4 == 1)[:, None]
    of_many = replace(rows, time_s=np.arange(30.0), line=range(2, 32))
    assert_approved(doubts_of_leaps(of_many, longer + eight, None, "t.csv"))
    noisy = position + 5.0 * np.eye(3)[1] * (np.arange(5) == 3)[:, None]
    quick = replace(rows, time_s=np.arange(5.0) / 100.0)
    assert doubts_of_leaps(quick, noisy, None, "t.csv") == []
    for aside_m, named in ((4.9, False), (5.1, True)):  # a leap there and back of 10 m
        moved = position + aside_m * np.eye(3)[1] * (np.arange(5) == 3)[:, None]
        ten_a_second = replace(rows, time_s=np.arange(5.0) / 10.0)
        assert bool(doubts_of_leaps(ten_a_second, moved, None, "t.csv")) == named
    # 1.45 m there and back within .05 s: 29 m/s more, which the half second before does not last
    uneven = replace(rows, time_s=np.array([0.0, 0.5, 0.55, 1.05, 1.55]))
    still = np.tile(START, (5, 1)) + 1.45 * np.eye(3)[1] * (np.arange(5) == 2)[:, None]
    assert doubts_of_leaps(uneven, still, None, "t.csv") == []


def test_a_leap_is_more_than_the_errors_of_fixes_make() -> None:
    """60 m aside make a leap of 120 m; fixes of 6 m in each direction make leaps of 25 m rms."""
    aside = 60.0 * np.eye(3)[1] * (np.arange(5) == 3)[:, None]
    position = np.array([START + k * SPEED for k in range(5)]) + aside
    rows = TrackRows(position, False, None, "seconds", np.arange(5.0), "CSV", line=(2, 3, 4, 5, 6))
    for sigma_m, named in ((6.0, False), (0.1, True)):
        fixes = TrackFixes(np.zeros(1, np.int64), np.ones((1, 1)), np.full((5, 3), sigma_m))
        assert bool(doubts_of_leaps(rows, position, fixes, "t.csv")) == named


@pytest.mark.parametrize(
    ("noise_m", "alike", "stated_m", "jitter_s", "said"),
    [(3.0, 0.0, 3.0, 0.0, 0), (3.0, 0.0, 1.5, 0.0, 20), (3.0, 0.98, 1.5, 0.0, 0),
     (0.1, 0.0, 0.02, 0.0, 0), (3.0, 0.0, 1.5, 0.05, 0)],
)  # fmt: skip
def test_positions_that_scatter_by_more_than_is_stated_are_told(
    noise_m: float, alike: float, stated_m: float, jitter_s: float, said: int
) -> None:
    """Twenty climbs of a minute, ten positions a second; errors alike as of a usual receiver."""
    found = list[str]()
    for seed in range(20):
        rng = np.random.default_rng(seed)
        time_s = np.arange(600) / 10.0 + rng.uniform(-jitter_s, jitter_s, 600)
        path = [20.0 * np.sin(time_s / 3.0), 5.0 * time_s, 10.0 * np.abs(time_s) ** 1.5]
        error_m = rng.normal(0.0, noise_m, (600, 3))
        for k in range(1, 600):
            error_m[k] = alike * error_m[k - 1] + np.sqrt(1.0 - alike**2) * error_m[k]
        position = START + (np.stack(path, axis=1) + error_m)[:, [2, 0, 1]]
        rows = TrackRows(position, False, None, "seconds", time_s, "CSV")
        fixes = TrackFixes(np.zeros(1, np.int64), np.ones((1, 1)), np.full((600, 3), stated_m))
        found += doubts_of_scatter(rows, position, fixes, "t.csv")
    assert len(found) == said
    if said:
        assert_approved(found[0])


def test_some_frames_keep_the_fixes_on_which_they_depend() -> None:
    """Frames halfway between fixes 0 and 1, 3 and 4, and at the last, 5; fixes of 1 to 6 m."""
    weight = np.array([[0.5, 0.5], [0.5, 0.5], [1.0, 0.0]])
    sigma_m = np.outer(np.arange(1.0, 7.0), np.ones(3))
    between = np.array([False, False, False, False, True, False])
    fixes = TrackFixes(np.array([0, 3, 5]), weight, sigma_m, between)
    some = fixes.of_frames(np.array([1, 2]))
    assert fixes.seen_by(np.array([1, 2])).tolist() == [3, 4, 5]
    assert some.first.tolist() == [0, 2] and some.sigma_m[:, 0].tolist() == [4.0, 5.0, 6.0]
    assert some.between is not None and some.between.tolist() == [False, True, False]
    assert some.at_frames(some.sigma_m[..., None])[:, 0, 0].tolist() == [4.5, 6.0]
    wide = np.ones((3, 3))  # a velocity by three fixes from the one before
    slopes = TrackSlopes(np.array([0, 2, 3]), wide, wide, *np.zeros((2, 3, 3)), np.zeros(3))
    some = replace(fixes, slopes=slopes).of_frames(np.array([1]))
    assert some.sigma_m[:, 0].tolist() == [3.0, 4.0, 5.0] and some.first.tolist() == [1]
    assert some.slopes is not None and some.slopes.first.tolist() == [0]


@pytest.mark.parametrize(
    ("track_s", "lines"),
    [
        ([0.0, 1.0, 1.0, 0.5], ()),
        ([0.0, 1.0, np.nan, 2.0], ()),
        ([0.0, 2.0, 1.0, 0.5], (2, 3, 5, 8)),
        ([3.0], (2,)),
    ],
)
def test_a_track_that_does_not_go_on_is_refused(
    track_s: list[float], lines: tuple[int, ...]
) -> None:
    position = np.tile(START, (len(track_s), 1))
    rows = TrackRows(position, False, None, "seconds", np.array(track_s), "CSV", line=lines)
    times = FrameTimes(np.zeros(1), (), None)
    with refused(VopdError):
        path_by_time(keys(), rows, position, times, Notes([], {}), "t.csv")


def test_two_positions_are_a_track() -> None:
    rows = TrackRows(np.array([START, START + 4.0]), False, None, "seconds", np.arange(2.0), "CSV")
    times = FrameTimes(np.array([0.25]), (), None)
    found = path_by_time(keys(), rows, rows.coordinate, times, Notes([], {}), "t.csv")
    assert_close("flight position", found.position_m[0], START + 1.0)
    noisy = replace(rows, sigma_m=np.full((2, 3), 0.1))
    found = path_by_time(keys(), noisy, rows.coordinate, times, Notes([], {}), "t.csv")
    assert found.fixes is not None and found.fixes.slopes is None  # what bends is not known


def test_frames_without_times_are_refused() -> None:
    with refused(VopdError):
        path(np.array([np.nan, np.nan]), [], JERK)
    assert np.isfinite(path(np.array([np.nan, 1.0]), [], JERK).position_m[1]).all()


# Sections [track] and [position]: CRS, heights, by time or by image, and every refusal


PLACE = np.array([[15.0, 45.0, 100.0], [15.0, 45.0, 130.0], [15.0, 45.0, 160.0]])  # 30 m/s up
ELLIPSOID = {"height": "ellipsoid"}


def track_rows(**given: Any) -> TrackRows:
    usual = {"crs": None, "clock": "seconds", "time_s": np.arange(3.0), "said": "CSV, 3 rows"}
    return TrackRows(PLACE, **({"geodetic": True} | usual | given))


def times(time_s: Any = (0.5, 1.0), image: tuple[str, ...] = (), **more: Any) -> FrameTimes:
    return FrameTimes(np.array(time_s, dtype=float), image, None, **more)


def read(section: str, keys: dict[str, Any], rows: Any, when: FrameTimes) -> PathRead:
    """What is read of a project with one section, whose file holds these rows."""
    project: Any = SimpleNamespace(
        name="p.toml",
        has=lambda name: name == section,
        section=lambda name: Section("p.toml", name, keys),
        open=lambda name: SimpleNamespace(name="t.csv"),
        read=lambda *_: rows,
    )
    return read_path(project, when)


def refusal(section: str, keys: dict[str, Any], rows: Any = None, when: Any = None) -> str:
    with pytest.raises(VopdError) as error:
        read(section, keys, rows, when or times())
    return str(error.value)


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        ({"lat_deg": 45.0, "lon_deg": 15.0, "h_m": 100.0}, earth_centred_m(45.0, 15.0, 100.0)),
        (
            {"lat_deg": 45.0, "lon_deg": 15.0, "h_m": 100.0, "height": {"undulation_m": 40.0}},
            earth_centred_m(45.0, 15.0, 140.0),
        ),
    ],
)
def test_a_fixed_position_is_that_of_every_frame(keys: Any, expected: Any) -> None:
    more = {"lever_arm_m": [1.0, 2.0, 3.0], "sigma_m": 0.5}
    found = read("position", ELLIPSOID | keys | more, None, times())
    assert_close("flight position", found.path.position_m, [expected, expected])
    assert found.path.bias_sigma_m.tolist() == [0.5, 0.5, 0.5] and found.path.fixes is None
    assert found.path.lever_arm_m is not None
    assert found.path.lever_arm_m.tolist() == [1.0, 2.0, 3.0]
    assert found.path.velocity_m_s is None and found.missing == {}
    assert found.doubts == []
    assert_approved(found.said)
    assert found.times.time_s.tolist() == [0.5, 1.0]


def test_a_fixed_position_in_map_coordinates_has_x_to_the_east() -> None:
    """On the central meridian of zone 33 at the equator: 500,000 east is 15 degrees."""
    keys = {"x_m": 500000.0, "y_m": 0.0, "z_m": 7.0, "crs": "EPSG:32633"}
    where = geodetic(read("position", ELLIPSOID | keys, None, times()).path.position_m)
    assert_close("latitude on either Earth", where.longitude_deg, [15.0, 15.0])
    assert_close("latitude on either Earth", where.latitude_deg, [0.0, 0.0])
    assert_close("flight position", where.height_m, [7.0, 7.0])


def test_positions_that_cannot_be_used_name_their_section() -> None:
    xyz = {"x_m": 1.0, "y_m": 2.0, "z_m": 3.0}
    assert_approved(refusal("position", xyz))
    wrong = ELLIPSOID | {"lat_deg": 95.0, "lon_deg": 15.0, "h_m": 100.0}
    assert refusal("position", wrong).startswith("p.toml: [position] lat_deg: must be")
    assert_approved(refusal("track", {}, track_rows(geodetic=False)))
    rows = replace(track_rows(), coordinate=PLACE + np.array([0.0, 50.0, 0.0]))
    assert refusal("track", ELLIPSOID, rows).startswith("p.toml: [track]: latitude 95: x is")


def test_the_crs_of_a_track_is_the_file_s_under_any_of_its_names() -> None:
    """WGS 84 in zone 33 is EPSG:32633; on its central meridian 15 degrees are 500,000 m."""
    own = track_rows(crs="EPSG:32633", geodetic=False)
    own = replace(own, coordinate=np.array([[500000.0, 0.0, 30.0 * k] for k in range(3)]))
    assert_approved(refusal("track", ELLIPSOID | {"crs": "EPSG:32634"}, own))
    for given in ({}, {"crs": "EPSG:32633"}, {"crs": "WGS84 UTM 33N"}):
        where = geodetic(read("track", ELLIPSOID | given, own, times()).path.position_m)
        assert_close("latitude on either Earth", where.longitude_deg, [15.0, 15.0])
        assert_close("flight position", where.height_m, [15.0, 30.0])


def test_a_track_by_time_says_its_file_and_goes_up() -> None:
    found = read("track", ELLIPSOID, track_rows(), times())
    assert_close("flight position", found.path.position_m[0], earth_centred_m(45, 15, 115))
    assert_close("flight speed", found.path.velocity_m_s, [[0, 0, -30], [0, 0, -30]])
    assert_approved(found.said)


def test_heights_of_a_track_are_the_format_s_or_the_project_s() -> None:
    above = {"height": {"undulation_m": 40.0}}
    found = read("track", above, track_rows(), times())
    assert_close("flight position", found.path.position_m[1], earth_centred_m(45, 15, 170))
    found = read("track", {}, track_rows(height="ellipsoid"), times())
    assert_close("flight position", found.path.position_m[1], earth_centred_m(45, 15, 130))
    assert height_datum(Section("p.toml", "track", {})) is None
    ground = Section("p.toml", "track", {"height": {"ground_m": 20.0}})
    on_a_geoid = HeightDatum("undulation", 40.0, ground_m=20.0)
    assert height_datum(ground, Section("p.toml", "landmarks", above)) == on_a_geoid
    marks = Section("p.toml", "landmarks", {"height": "ellipsoid"})
    with refused(VopdError):  # a file that says it, and a ground besides
        track_height(ground, track_rows(height="ellipsoid"), marks)
    for key in ("ground_m", "undulation_m"):
        assert_approved(refusal("track", {"height": {key: -1e12}}, track_rows()))
    said = refusal("track", {"height": "geoid"}, track_rows())
    assert_approved(said)


IMAGES = ("a.jpg", "b.jpg")


@pytest.mark.parametrize(
    ("time_s", "image", "by_image"),
    [(None, IMAGES, True), (np.arange(3.0), IMAGES, True), (np.arange(3.0), (), False)],
)
def test_images_have_their_own_rows_where_the_picks_have_images(
    time_s: Any, image: tuple[str, ...], by_image: bool
) -> None:
    """A frame at .5 s is between the rows; image b.jpg is the first."""
    rows = track_rows(image=["b.jpg", "c.jpg", "a.jpg"], time_s=time_s)
    found = read("track", ELLIPSOID, rows, times(image=image)).path.position_m[:, 0]
    heights = [160.0, 100.0] if by_image else [115.0, 130.0]
    assert_close("flight position", found, [earth_centred_m(45, 15, h)[0] for h in heights])


def test_some_frames_without_a_position_are_no_error_and_all_are() -> None:
    found = read("track", ELLIPSOID, track_rows(), times((1.0, 9.0)))
    assert np.isfinite(found.path.position_m[:, 0]).tolist() == [True, False]
    assert_approved(
        refusal("track", ELLIPSOID | {"offset_s": 1000.0}, track_rows(), times((7.0, np.nan, 3.5)))
    )
    rows = track_rows(image=["x.jpg", "y.jpg", "z.jpg"], time_s=None)
    assert_approved(refusal("track", ELLIPSOID, rows, times(image=IMAGES)))


def test_what_is_said_of_a_track_that_has_other_images_or_another_clock() -> None:
    section = Section("p.toml", "track", {"offset_s": 0.25})
    rows = track_rows(image=["x.jpg", "A.JPG", "B.jpg"])
    assert_approved(why_nowhere(section, rows, times(image=IMAGES)))
    since = 1.7e9 + np.array([12345.25, 12400.0, 86400.0])
    when = times((5.0,))._replace(epoch=datetime.fromtimestamp(1.7e9 - 60.0, UTC))
    said = why_nowhere(section, track_rows(clock="utc", time_s=since), when)
    assert_approved(said)
    assert_approved(why_nowhere(section, track_rows(clock="seconds", time_s=since), when))
    for hours, is_zone in ((14.0, True), (15.0, False)):
        late = track_rows(time_s=np.array([0.0, 1.0, 2.0]) + 3600.0 * hours)
        assert ("a time zone?" in why_nowhere(section, late, times((5.0,)))) == is_zone
    undated = times((5.0,))
    assert_approved(why_nowhere(section, track_rows(clock="seconds", time_s=since), undated))
    between = track_rows(time_s=np.array([40.0, 50.0, 60.0]))
    assert_approved(why_nowhere(section, between, times((-9_999.0, 99_999.0))))


def test_an_offset_covers_frames_that_are_a_little_beyond_a_track() -> None:
    """As an epoch that is cut to milliseconds, before a track that begins at the first frame."""
    own_s, offset_s = np.array([0.0, 5.0, 10.0]), 0.25
    for frames_s in ([-0.0003, 4.0], [6.0, 10.02], [-0.1, -0.05], [10.01, 10.04]):
        text = covering_text(own_s, np.array(frames_s), offset_s)
        assert_approved(text)
        moved_s = own_s + float(text.split(" covers")[0].split()[-1]) - offset_s
        assert moved_s[0] <= min(frames_s) and max(frames_s) <= moved_s[-1]
    for frames_s in ([0.0, 10.0], [-0.2, 4.0], [-0.01, 10.01], [-0.01, 9.995], [6.0, 12.0]):
        assert covering_text(own_s, np.array(frames_s), offset_s) == ""


def test_whole_seconds_are_doubted_where_a_track_is_by_time() -> None:
    """At 30 m/s; and not where the project allows for it, or seconds have parts."""
    found = read("track", ELLIPSOID, track_rows(), times(whole_seconds=True))
    assert_approved(found.doubts)
    allowed = read("track", ELLIPSOID | {"sigma_t_s": 0.3}, track_rows(), times(whole_seconds=True))
    assert allowed.doubts == []
    assert read("track", ELLIPSOID, track_rows(), times()).doubts == []


# GPS time of a track to UTC: the leap seconds of IERS Bulletin C, from their first days on


LEAPS = [  # the first day, and GPS time less UTC before it and from it on
    ((2009, 1, 1), 14.0, 15.0),
    ((2012, 7, 1), 15.0, 16.0),
    ((2015, 7, 1), 16.0, 17.0),
    ((2017, 1, 1), 17.0, 18.0),
]


def on_clock(since_1970_s: float, own: str = "gps", **given: str) -> float:
    """A track of two positions, a second apart; gives the first one's time."""
    times = np.array([since_1970_s, since_1970_s + 1.0])
    rows = TrackRows(np.zeros((2, 3)), True, None, own, times, "")
    first, second = track_clock(Section("flight.toml", "track", dict(given)), rows)
    assert second - first == 1.0
    return float(first)


@pytest.mark.parametrize(("day", "before", "after"), LEAPS)
def test_leap_seconds(day: tuple[int, int, int], before: float, after: float) -> None:
    start = datetime(*day, tzinfo=UTC)
    for moment, ahead in ((start - timedelta(hours=1), before), (start, after)):
        seconds = moment.timestamp()
        assert on_clock(seconds) == seconds - ahead
        assert on_clock(seconds, "utc-column", clock="gps") == seconds - ahead
        assert on_clock(seconds, "utc") == on_clock(seconds, clock="utc") == seconds


def test_gps_time_before_the_table_is_refused() -> None:
    start = datetime(2006, 1, 1, tzinfo=UTC).timestamp()
    assert on_clock(start) == start - 14.0
    assert on_clock(3e11) == 3e11 - 18.0  # after the year 9999
    with refused(VopdError):
        on_clock(start - 1.0)


def test_seconds_are_no_date() -> None:
    assert on_clock(12.5, "seconds") == 12.5
    for own, given in (("seconds", "gps"), ("utc", "seconds")):
        with refused(VopdError):
            on_clock(12.5, own, clock=given)


# Times of frames by rate, table or track; clocks of tracks


EPOCH = datetime(2026, 5, 1, 12, tzinfo=UTC)


def told(action: Any) -> str:
    with pytest.raises(VopdError) as refusal:
        action()
    return str(refusal.value)


def frames(folder: Path, frame: Any, epoch: Any = None, **keys: Any) -> Any:
    """Numbers, times and indices of the frames of three picks or so."""
    flight = Section("p.toml", "flight", {} if epoch is None else {"epoch": epoch})
    picks = Section("p.toml", "picks", keys)
    project = Project("p.toml", folder, {"flight": flight, "picks": picks})
    nothing = np.zeros(len(frame))
    rows = PickRows(frame, Names(["m"] * len(frame)), nothing, nothing, None, None, "")
    return frames_of(project, rows)


NUMBERS = np.array([12, 4, 12, 7])
NAMED = Names(["b", "a", "b", "c"])


@pytest.mark.parametrize("epoch", [None, EPOCH])
def test_times_by_the_rate_of_the_frames(epoch: Any, tmp_path: Path) -> None:
    """Frame 4 at 20 a second and .5 s is at .7 s."""
    keys = {"frame_rate_hz": 20, "first_frame_t_s": 0.5, "file": "p"}
    number, times, index = frames(tmp_path, NUMBERS, epoch, **keys)
    assert (number.tolist(), index.tolist()) == ([4, 7, 12], [2, 0, 2, 1])
    assert_close("time", times.time_s, [0.7, 0.85, 1.1])
    assert (times.image, times.epoch, times.said, times.whole_seconds) == ((), epoch, "", False)
    (tmp_path / "p").write_text("image\nb\na\nb\nc\n")
    number, times, index = frames(tmp_path, NAMED, epoch, **keys)
    assert_approved(times.doubts)
    assert (number.tolist(), index.tolist(), times.image) == (
        [0, 1, 2],
        [1, 0, 1, 2],
        ("a", "b", "c"),
    )
    assert np.isnan(times.time_s).all() and times.epoch == epoch
    assert np.isnan(frames(tmp_path, NUMBERS)[1].time_s).tolist() == [True] * 3
    for wrong in (
        {"frame_rate_hz": 0, "first_frame_t_s": 0},
        {"frame_rate_hz": -5, "first_frame_t_s": 0},
        {"frame_rate_hz": 20},
        {"frame_rate_hz": 20, "times": "t"},
    ):  # fmt: skip
        said = told(lambda wrong=wrong: frames(tmp_path, NUMBERS, **wrong))
        assert_approved(said)
    late = {"frame_rate_hz": 20, "first_frame_t_s": 1_777_636_722.5}
    for zero in (None, datetime(1970, 1, 1, tzinfo=UTC), datetime(2000, 1, 1, 12, tzinfo=UTC)):
        assert frames(tmp_path, NUMBERS, zero, **late)[1].time_s[0] == 1_777_636_722.7
    assert_approved(told(lambda: frames(tmp_path, NUMBERS, EPOCH, **late)))
    both = {"frame_rate_hz": 20, "times": "t"}
    assert_approved(told(lambda: frames(tmp_path, NAMED, **both)))


@pytest.mark.parametrize(
    ("images", "order", "time_s"),
    [
        (["f7.png", "f12.png"], ["f7.png", "f12.png"], [3.5, 6.0]),
        (["cover.png", "f7.png"], ["f7.png", "cover.png"], [3.5, np.nan]),
        (["a/f7", "f7", "f8"], ["f7", "f8", "a/f7"], [3.5, 4.0, np.nan]),
        (["f7.jpg", "f7.png", "f8.png"], ["f7.png", "f8.png", "f7.jpg"], [3.5, 4.0, np.nan]),
        (["L7", "f1_v8.png", "f7.png", "f8.png"], ["f7.png", "f8.png", "L7", "f1_v8.png"],
         [3.5, 4.0, np.nan, np.nan]),
        (["a7.png", "b7.png", "c8.png"], ["c8.png", "a7.png", "b7.png"], [4.0, np.nan, np.nan]),
        (["f07.png", "f7.png", "f8.png"], ["f8.png", "f07.png", "f7.png"], [4.0, np.nan, np.nan]),
        (["a7.png", "b7.png"], ["a7.png", "b7.png"], [np.nan, np.nan]),
    ],
)  # fmt: skip
def test_an_image_without_a_number_of_its_own_has_no_time(
    images: list[str], order: list[str], time_s: list[float], tmp_path: Path
) -> None:
    """At 2 a second; the others have theirs, and its first row is named."""
    rows = [f"{name},m" for name in ["x" + images[0], *images]]
    (tmp_path / "p.csv").write_text("\n".join(["image,landmark", *rows]))
    keys = {"frame_rate_hz": 2, "first_frame_t_s": 0.0, "file": "p.csv"}
    number, times, index = frames(tmp_path, Names(images), **keys)
    assert times.image == tuple(order) and (np.diff(number) > 0).all()
    assert [order[k] for k in index] == images
    np.testing.assert_array_equal(times.time_s, time_s)
    assert_approved(times.doubts)


@pytest.mark.parametrize("epoch", [None, EPOCH])
def test_times_by_a_table(epoch: Any, tmp_path: Path) -> None:
    """In UTC, zero is the epoch, or the whole second of the first frame that is picked."""
    table = tmp_path / "t"
    table.write_text("image,frame,t_s\nx,12,3.5\ny,4,1.5\nb,5,2.5\na,8,2.75\n")
    _, times, _ = frames(tmp_path, NUMBERS, epoch, times="t")
    assert np.array_equal(times.time_s, [1.5, np.nan, 3.5], equal_nan=True)
    assert (times.said, times.epoch) == ("t: times of 4 frames", epoch)
    _, times, _ = frames(tmp_path, NAMED, epoch, times="t")
    assert np.array_equal(times.time_s, [2.75, 2.5, np.nan], equal_nan=True)
    utc = (
        "image,t_utc\nz,2026-05-01T12:00:00Z\na,2026-05-01T12:00:09.75Z\nb,2026-05-01T12:00:08.5Z\n"
    )
    table.write_text(utc)
    _, times, _ = frames(tmp_path, NAMED, epoch, times="t")
    zero = 0.0 if epoch else 8.0
    assert np.array_equal(times.time_s, [9.75 - zero, 8.5 - zero, np.nan], equal_nan=True)
    assert times.epoch == EPOCH + timedelta(seconds=zero)
    table.write_text("frame,t_s,t_utc\n4,7,2026-05-01T12:00:00Z\n")
    assert frames(tmp_path, NUMBERS, epoch, times="t")[1].time_s[0] == 7.0
    none = "p.toml: [picks] times: t: none of the frames is there "
    table.write_text("image,frame,t_s\nz,5,1\n")
    assert told(lambda: frames(tmp_path, NUMBERS, times="t")) == none + "(4)"
    assert told(lambda: frames(tmp_path, NAMED, times="t")) == none + "(a)"
    for header, frame in (("image", NUMBERS), ("frame", NAMED), ("row", NAMED)):
        table.write_text(f"{header},t_s\n4,1\n5,2\n")
        missing = "frame" if header == "image" else "image"
        said = told(lambda frame=frame: frames(tmp_path, frame, times="t"))
        assert said.startswith(f"t: line 1: no column {missing}")
    table.write_text("frame,t_s\nb,1\na,1.5\na,1.5\n")  # as the picks', which may have them
    assert frames(tmp_path, NAMED, epoch, times="t")[1].time_s[:2].tolist() == [1.5, 1.0]
    assert told(lambda: frames(tmp_path, NUMBERS, times="t")) == none + "(4)"


@pytest.mark.parametrize(
    ("rows", "line", "later", "earlier"),
    [
        ("4,1\n5,1\n", 3, 5, 4), ("5,1\n4,2\n6,3\n", 2, 5, 4), ("4,1\n5,2\n6,1.5\n7,0\n", 4, 6, 5),
        ("9,5\n7,3\n8,2\n", 4, 8, 7),
    ],
)  # fmt: skip
def test_a_later_frame_has_a_later_time(
    rows: str, line: int, later: int, earlier: int, tmp_path: Path
) -> None:
    """The first pair in the order of the numbers is named, with the line of the later one."""
    (tmp_path / "t").write_text("frame,t_s\n" + rows)
    assert_approved(
        told(lambda: frames(tmp_path, NUMBERS, times="t")), parts=[line, later, earlier]
    )


def test_times_beside_those_that_are_read_are_said_not_to_be(tmp_path: Path) -> None:
    (tmp_path / "t").write_text("frame,t_utc,t_s\n4,2026-05-01T12:00:00Z,1\n")
    _, times, _ = frames(tmp_path, NUMBERS, times="t")
    assert times.time_s[0] == 1.0
    assert_approved(times.said)


@pytest.mark.parametrize("rows", ["5,1\n5,2\n", "5,2\n5,1\n", "4,0\n5,2\n6,3\n5,1\n"])
def test_a_frame_has_one_time(rows: str, tmp_path: Path) -> None:
    (tmp_path / "t").write_text("frame,t_s\n" + rows)
    said = told(lambda: frames(tmp_path, NUMBERS, times="t"))
    assert_approved(said)


def test_picks_with_a_column_of_times_are_the_file_of_times(tmp_path: Path) -> None:
    """It is named where the frames have no time; with another name of the column, too."""
    for own in ("t_s", "Time"):
        text = f"frame,landmark,u_px,v_px,{own}\n7,a,1,2,5.5\n7,b,1,2,5.5\n9,a,1,2,6\n"
        (tmp_path / "p").write_text(text)
        bring = frames(tmp_path, NUMBERS, file="p")[1].bring
        assert_approved(bring)
        times = frames(tmp_path, np.array([9, 7]), times="p")[1]
        assert times.time_s.tolist() == [5.5, 6.0]
    (tmp_path / "p").write_text("frame,landmark,u_px,v_px\n7,a,1,2\n")
    assert frames(tmp_path, NUMBERS, file="p")[1].bring == BRING_TIMES


def test_zero_is_a_whole_second() -> None:
    section = Section("p.toml", "picks", {"times": "t.csv"})

    def zero(*utc_s: float) -> datetime:
        return first_whole_second(np.array(utc_s), section, "times")

    start = EPOCH.timestamp()
    for given in ([0.25, 5.0], [np.nan, 0.25], [7.0, 0.999], [0.0, np.nan]):
        assert zero(*(start + np.array(given))) == EPOCH
    assert zero(-0.5) == datetime(1969, 12, 31, 23, 59, 59, tzinfo=UTC)
    for wrong in (1e18, 1e300, -1e15):
        assert_approved(told(lambda wrong=wrong: zero(wrong)), parts=[f"{wrong:g}"])


# Clocks of tracks


@pytest.mark.parametrize(
    ("own", "given", "ahead"),
    [
        ("utc", None, 0), ("utc", "utc", 0), ("utc", "gps", 18), ("gps", None, 18),
        ("gps", "gps", 18), ("gps", "utc", 0), ("utc-column", "utc", 0), ("utc-column", "gps", 18),
        ("seconds", None, 0), ("seconds", "seconds", 0),
        ("utc-column", None, "is needed: utc, gps"), ("utc", "seconds", "the file's times are utc"),
        ("gps", "seconds", "the file's times are gps"),
        ("seconds", "utc", "the file's times are seconds"),
        ("seconds", "gps", "the file's times are seconds"),
        ("utc-column", "seconds", "'seconds' is not known; known are utc, gps"),
        ("utc", "local", "'local' is not known; known are utc, gps, seconds"),
    ],
)  # fmt: skip
def test_the_clock_of_a_track(own: str, given: str | None, ahead: Any) -> None:
    """On the frames' clock, whose zero is the epoch; seconds stay as they are."""
    section = keys(**({} if given is None else {"clock": given}))
    start = EPOCH.timestamp()
    rows = track(own, start + 1.0, start + 2.5)
    if isinstance(ahead, str):
        said = told(lambda: track_clock(section, rows))
        assert_approved(said)
        return
    assert track_clock(section, rows).tolist() == [start + 1.0 - ahead, start + 2.5 - ahead]
    times = FrameTimes(np.zeros(1), (), EPOCH)
    zero = start if own != "seconds" else 0.0
    found = track_on_clock(section, rows, times)
    assert found.tolist() == [start - zero + 1.0 - ahead, start - zero + 2.5 - ahead]
    if own != "seconds":
        assert_approved(told(lambda: track_on_clock(section, rows, times._replace(epoch=None))))


@pytest.mark.parametrize(
    ("day", "ahead"),
    [
        ((2026, 5, 1), 18), ((2017, 1, 1), 18), ((2016, 12, 31), 17), ((2015, 7, 1), 17),
        ((2015, 6, 30), 16), ((2012, 7, 1), 16), ((2012, 6, 30), 15), ((2009, 1, 1), 15),
        ((2008, 12, 31), 14), ((2006, 1, 1), 14), ((2005, 12, 31), None),
    ],
)  # fmt: skip
def test_leap_seconds_are_those_of_the_first_position(day: Any, ahead: int | None) -> None:
    """A track that goes over a leap second keeps what it began with."""
    start = datetime(*day, tzinfo=UTC).timestamp()
    rows = track("gps", start, start + 4e8)
    if ahead is None:
        assert_approved(told(lambda: track_clock(keys(), rows)))
    else:
        assert track_clock(keys(), rows).tolist() == [start - ahead, start + 4e8 - ahead]


# The path and the times of frames by a track that has positions of images


def test_rows_of_images_by_name() -> None:
    """By the whole name, else by what stands behind the last slash of either, if that is one."""
    rows = track(None, 0, 0, 0, image=("b.jpg", "x/a.jpg", "a.jpg"))
    found = rows_of_images(keys(), rows, ("x/a.jpg", "y/a.jpg", "b.jpg", "z/b.jpg", "c.jpg"))
    assert found.tolist() == [1, 2, 0, -1, -1]  # b.jpg is of its own whole name
    twins = rows_of_images(keys(), rows, ("y/a.jpg", "z/a.jpg", "u/b.jpg", "v/b.jpg"))
    assert twins.tolist() == [-1, -1, -1, -1]  # two images, of which nothing says which it is
    inside = track(None, 0, 0, 0, 0, image=("x/a.jpg", "x/b.jpg", "y/b.jpg", "y/c.jpg"))
    for one in ("a.jpg", "y/a.jpg"):
        found = rows_of_images(keys(), inside, (one, "b.jpg", "y/b.jpg", "c.jpg"))
        assert found.tolist() == [0, -1, 2, 3]  # two are called b.jpg
    photos = track(None, 0, 0, image=("29", "7"), image_key=photo_number)
    found = rows_of_images(keys(), photos, ("MAX_0007.JPG", "d/MAX_0029.JPG", "MAX_0030.JPG"))
    assert found.tolist() == [1, 0, -1]
    assert_approved(told(lambda: rows_of_images(keys(), rows, ())))
    doubled = track(None, 0, 0, 0, 0, image=("b", "c", "b", "c"))
    assert_approved(told(lambda: rows_of_images(keys(), doubled, ("c",))))


@pytest.mark.parametrize(
    ("clock", "given", "late", "zero"),
    [("utc", None, 1.75, 3), ("utc", EPOCH, 4.75, 0), ("gps", EPOCH, -13.25, 0),
     ("utc-column", EPOCH, 4.75, 0), ("utc-column", None, 1.75, 3), ("gps", None, 1.75, -15)],
)  # fmt: skip
def test_frames_have_the_times_of_their_images(
    clock: str, given: Any, late: float, zero: int
) -> None:
    """Images at 4.75 and 3.25 s past the epoch: zero is 3 s past it, or the epoch."""
    start = EPOCH.timestamp()
    rows = track(clock, start + 4.25, start + 2.75, image=("b", "a"))
    section = keys(offset_s=0.5, **({"clock": "utc"} if clock == "utc-column" else {}))
    unknown = FrameTimes(np.full(3, np.nan), ("a", "b", "c"), given)
    times, own = times_of_track(section, rows, unknown)
    assert own is not None and own.tolist() == [late, late - 1.5]
    assert np.array_equal(times.time_s, [late - 1.5, late, np.nan], equal_nan=True)
    assert times.epoch == EPOCH + timedelta(seconds=zero)
    some = unknown._replace(time_s=np.array([np.nan, 5.0, np.nan]))
    kept = times_of_track(section, rows, some)[0]
    assert kept.time_s[1] == 5.0 and np.isnan(kept.time_s[0])
    assert kept.epoch == given  # the zero of the frames' own clock is not the track's
    assert times_of_track(keys(), track(None, 0.0, image=("a",)), unknown) == (unknown, None)


@pytest.mark.parametrize(
    ("apart_s", "offset_s"), [(1.9, 0.0), (3600.0, 0.0), (-2.1, 0.0), (3.0, 3.0)]
)
def test_times_of_images_are_held_against_those_of_the_track(
    apart_s: float, offset_s: float
) -> None:
    """A camera's clock an hour ahead, as in summer, was in the table in silence."""
    start = EPOCH.timestamp()
    rows = track("utc", start + 4.0, start + 5.0, image=("a", "b"))
    frames = FrameTimes(np.array([4.0, 5.0, np.nan]) + apart_s, ("a", "b", "c"), EPOCH)
    times, _ = times_of_track(keys(offset_s=offset_s), rows, frames)
    assert times.time_s.tolist()[:2] == [4.0 + apart_s, 5.0 + apart_s]
    assert_approved(times.doubts)


def test_the_path_at_images() -> None:
    """Rows by their names; what is not there is NaN in all columns; the file's own speed counts."""
    position = earth_centred_m([47.0, 48.0, 49.0], [16.0] * 3, [0.0] * 3)
    more = {
        "velocity_m_s": np.arange(9.0).reshape(3, 3),
        "gimbal_deg": 10.0 + np.arange(9.0).reshape(3, 3),
        "sigma_m": np.array([[3.0, 4.0, 5.0]] * 3),
        "sigma_by": "its own column",
    }  # fmt: skip
    rows = track(None, 0, 0, 0, image=("c", "a", "b"), **more)
    times = FrameTimes(np.zeros(3), ("a", "x", "c"), None)
    said: list[str] = []
    section = keys(file="t.csv", lever_arm_m=[1, 2, 3], velocity_sigma_m_s=0.5)
    path = path_by_image(section, rows, position, times, np.array([0.0, 1.0, 2.0]), Notes(said, {}))
    assert np.array_equal(
        path.position_m, position[[1, 0, 0]] * [[1], [np.nan], [1]], equal_nan=True
    )
    assert path.velocity_m_s is not None and path.gimbal_deg is not None
    assert np.array_equal(path.velocity_m_s, [[3, 4, 5], [np.nan] * 3, [0, 1, 2]], equal_nan=True)
    gimbal = [[13, 14, 15], [np.nan] * 3, [10, 11, 12]]
    assert np.array_equal(path.gimbal_deg, gimbal, equal_nan=True)
    assert said == ["t.csv: standard deviations by its own column", "velocity as the track has it"]
    assert path.acceleration_m_s2 is not None  # 3 m/s a second from row to row
    assert np.array_equal(path.acceleration_m_s2[[0, 2]], [[3.0] * 3] * 2)
    assert path.fixes is not None and path.fixes.sigma_m.tolist() == [[3.0, 4.0, 5.0]] * 3
    assert path.fixes.first.tolist() == [1, 0, 0]
    assert path.fixes.weight.tolist() == [[1.0], [0.0], [1.0]]
    assert path.velocity_sigma_m_s is not None
    assert path.velocity_sigma_m_s[[0, 2]].tolist() == [[0.5] * 3] * 2
    assert np.isnan(path.velocity_sigma_m_s[1]).all()
    assert path.lever_arm_m is not None and path.lever_arm_m.tolist() == [1.0, 2.0, 3.0]
    plain = path_by_image(keys(sigma_m=2), track(None, 0, 0, 0, image=("c", "a", "b")), position,
                          times, None, Notes(said, {}))  # fmt: skip
    assert plain.velocity_m_s is None and plain.gimbal_deg is None and plain.lever_arm_m is None
    assert plain.fixes is not None and plain.fixes.sigma_m.tolist() == [[2.0] * 3] * 3
    assert plain.velocity_sigma_m_s is None and len(said) == 2


def test_speeds_of_images_are_north_east_down_at_the_image() -> None:
    """20 m north, 10 m east and 5 m up in 2 s, in the order of time and not of the file."""
    start = earth_centred_m(0.0, 0.0, 0.0)  # x up, y east, z north
    step = np.array([5.0, 10.0, 20.0])
    position = start + np.outer([2.0, 0.0, 1.0], step)
    rows = track("utc", 0.0, 0.0, 0.0, image=("c", "a", "b"))
    times = FrameTimes(np.zeros(4), ("a", "b", "c", "d"), None)
    said: list[str] = []
    path = path_by_image(keys(), rows, position, times, np.array([4.0, 0.0, 2.0]), Notes(said, {}))
    assert path.velocity_m_s is not None
    assert_close("flight speed", path.velocity_m_s[:3], [[10.0, 5.0, -2.5]] * 3)
    assert np.isnan(path.velocity_m_s[3]).all()
    assert_approved(said)
    two = track("utc", 0.0, 0.0, image=("c", "a"))
    path = path_by_image(keys(), two, position[:2], times, np.array([4.0, 0.0]), Notes([], {}))
    assert path.velocity_m_s is not None
    assert_close("flight speed", path.velocity_m_s[[0, 2]], [[10.0, 5.0, -2.5]] * 2)
    some = np.array([4.0, 0.0, np.nan])  # the one without a time costs the others nothing
    path = path_by_image(keys(), rows, position, times, some, Notes([], {}))
    assert path.velocity_m_s is not None and path.acceleration_m_s2 is not None
    assert_close("flight speed", path.velocity_m_s[[0, 2]], [[10.0, 5.0, -2.5]] * 2)
    assert np.isnan(path.velocity_m_s[1]).all() and np.isfinite(path.position_m[1]).all()
    whole = track("utc", 0.0, 0.0, 0.0, image=("c", "a", "b"), whole_seconds=True)
    path = path_by_image(keys(), whole, position, times, np.array([4.0, 0.0, 2.0]), Notes(said, {}))
    assert path.velocity_m_s is None
    assert_approved(said[1:])


def test_speeds_of_images_do_not_depend_on_the_order_of_rows() -> None:
    """Of images that are faster and faster."""
    when, names = np.arange(5.0), ("a", "b", "c", "d", "e")
    moved = np.outer(when + when**2, [5.0, 10.0, 20.0])
    position, times = earth_centred_m(0.0, 0.0, 0.0) + moved, FrameTimes(when, names, None)
    found = []
    for order in ([0, 1, 2, 3, 4], [2, 0, 4, 1, 3]):
        rows = track("utc", *([0.0] * 5), image=tuple(names[k] for k in order))
        path = path_by_image(keys(), rows, position[order], times, when[order], Notes([], {}))
        assert path.velocity_m_s is not None and path.acceleration_m_s2 is not None
        found.append(np.hstack([path.position_m, path.velocity_m_s, path.acceleration_m_s2]))
    assert_close("flight speed", found[1], found[0])
    assert np.diff(found[0][:, 3]).min() > 20.0
