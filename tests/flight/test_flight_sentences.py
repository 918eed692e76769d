"""Sentences about levels, positions and files of a flight, and whose epoch and grid it has."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

import vopd
from tests.approved.texts import assert_approved, refused
from tests.kit.flight_project import TOML, camera_m, marks_m, uneven_flight, write_project
from tests.tolerances import within
from vopd.findings import Finding, VopdError
from vopd.flight.coordinates import HeightDatum, crs_name, map_grid
from vopd.flight.flight import LEAPS, CameraPath
from vopd.flight.formats.by_content import read_by_content
from vopd.flight.formats.files import open_input
from vopd.flight.formats.landmarks import LANDMARK_FORMATS, LandmarkRows
from vopd.flight.formats.lens import make_lens
from vopd.flight.formats.track import TrackRows
from vopd.flight.project.inspect import (
    NewProject,
    look_at_landmarks,
    look_at_lens,
    look_at_picks,
    look_at_track,
)
from vopd.flight.project.keys import Section
from vopd.flight.project.read import landmark_crs, read_flight
from vopd.flight.project.times import FrameTimes, doubt_of_years
from vopd.flight.project.track import doubts_of_rounded_times, times_of_track
from vopd.flight.result import solve_flight_read
from vopd.flight.solve.joint import no_solution


@pytest.mark.parametrize(
    "name",
    [
        "ellipsoid", "egm96",
        "egm2008", "navd88",
        "same",
        "undulation",
    ],
)  # fmt: skip
def test_what_heights_are_above(name: str) -> None:
    assert_approved(HeightDatum(name, -37.5 if name == "undulation" else 0.0).said)


def test_positions_of_a_gcp_list_that_contradict_name_both_lines(tmp_path: Path) -> None:
    rows = [
        "EPSG:32633",
        "1 2 3 4 5 a.jpg one",
        "# x",
        "1 2 3 4 5 b.jpg one",
        "1 2 4 4 5 c.jpg one",
    ]
    (tmp_path / "g").write_text("\n".join(rows))
    with refused(VopdError):
        read_by_content(LANDMARK_FORMATS, open_input("g", tmp_path))


@pytest.mark.parametrize(("model", "count"), [("brown", 12), ("fisheye", 4)])
def test_a_lens_has_as_many_coefficients_as_its_model(model: str, count: int) -> None:
    lens = make_lens(model, (4, 3), (9.0, 8.0), (1.0, 2.0), (0.1, 0.2), 0.5)
    assert lens.k.tolist() == [0.1, 0.2, *[0.0] * (count - 2)]
    assert (lens.focal_px.tolist(), lens.centre_px.tolist()) == ([9.0, 8.0], [1.0, 2.0])
    assert (lens.skew_px, lens.size_px, lens.kind.value) == (0.5, (4, 3), model)


def test_what_a_new_project_says_of_files_that_there_are_not() -> None:
    new = NewProject()
    values: dict[tuple[str, str], str] = {}
    here = Path()
    look_at_lens(new, values, here, None)
    assert look_at_picks(new, values, here, None)
    look_at_landmarks(new, values, here, None)
    assert look_at_track(new, values, here, None) is None
    assert_approved(new.said)
    assert values == {} and [*new.needed] == [
        ("camera", "lens"), ("camera", "image_size_px"), ("picks", "file"), ("landmarks", "file"),
        ("landmarks", "height"), ("landmarks", "sigma_m"), ("track", "file"), ("track", "height"),
        ("track", "sigma_m"),
    ]  # fmt: skip


def test_a_new_project_names_files_from_its_own_folder(tmp_path: Path) -> None:
    write_project(tmp_path / "files")
    picks = tmp_path / "files" / "picks.csv"
    for folder, name in (
        (tmp_path / "new", "../files/picks.csv"),
        (tmp_path / "files", "picks.csv"),
        (tmp_path, "files/picks.csv"),
    ):
        values: dict[tuple[str, str], str] = {}
        look_at_picks(NewProject(), values, folder, str(picks))
        assert values == {("picks", "file"): f'"{name}"'}


START = datetime(2026, 5, 1, 12, tzinfo=UTC)


@pytest.mark.parametrize("given", [None, START - timedelta(minutes=1)])
@pytest.mark.parametrize("clock", ["utc", "seconds", None])
def test_whose_epoch_the_times_of_a_track_of_images_have(
    clock: str | None, given: datetime | None
) -> None:
    """The project's; without one the whole second of the first image. Half a second is added."""
    seconds = np.array([2.25, 4.25]) + (START.timestamp() if clock == "utc" else 0.0)
    rows = TrackRows(
        np.zeros((2, 3)), True, None, clock, None if clock is None else seconds, "", ["a", "b"]
    )
    section = Section("p.toml", "track", {"offset_s": 0.5})
    none = FrameTimes(np.full(3, np.nan), ("b", "x/a", "c"), given)
    times, own = times_of_track(section, rows, none)
    if clock is None:
        assert times is none and own is None
        return
    zero = given or (START + timedelta(seconds=2) if clock == "utc" else None)
    before = 0.0 if clock == "seconds" else (START - zero).total_seconds() if zero else 0.0
    assert times.epoch == (given if clock == "seconds" else zero)
    assert own is not None and own.tolist() == [2.75 + before, 4.75 + before]
    assert np.array_equal(times.time_s, [4.75 + before, 2.75 + before, np.nan], equal_nan=True)
    if clock == "seconds" and given is not None:
        late = replace(rows, time_s=seconds + START.timestamp())
        with refused(VopdError):
            times_of_track(section, late, none)
    dated = none._replace(time_s=np.array([7.0, 8.0, 9.0]))
    assert times_of_track(section, rows, dated)[0].time_s.tolist() == [7.0, 8.0, 9.0]


@pytest.mark.parametrize(
    ("whole", "sigma", "moves", "doubt"),
    [(True, False, True, True), (True, True, True, False), (False, False, True, False),
     (True, False, False, False)],
)  # fmt: skip
def test_whole_seconds_are_doubted_where_nothing_allows_for_them(
    whole: bool, sigma: bool, moves: bool, doubt: bool
) -> None:
    """The fastest frame counts: 3, 4 and 12 m/s are 13."""
    speed = np.array([[1.0, 1.0, 0.0], [3.0, 4.0, 12.0], [np.nan] * 3])
    path = CameraPath(np.zeros((3, 3)), velocity_m_s=speed if moves else None)
    section = Section("p", "track", {"sigma_t_s": 0.3} if sigma else {})
    found = doubts_of_rounded_times(section, FrameTimes(np.zeros(3), (), None, "", whole), path)
    assert bool(found) == bool(doubt)
    assert_approved(found)


@pytest.mark.parametrize(
    ("crs", "found"),
    [("EPSG:32633", "EPSG:32633"), ("WGS84 UTM 33N", "EPSG:32633"), ("WGS84 UTM 5S", "EPSG:32705"),
     ("wgs 84 utm 33 s", "EPSG:32733"), (" 'EPSG:25833' ", "EPSG:25833"), ("EPSG:4326", None)],
)  # fmt: skip
def test_the_grid_of_a_flight_is_that_of_its_landmarks(crs: str, found: str | None) -> None:
    rows = LandmarkRows(["a"], np.zeros((1, 3)), False, crs, None, [1], "")
    position = camera_m(np.array([2.0, 3.0]))
    position[1] = np.nan
    known = landmark_crs(Section("p.toml", "landmarks", {}), rows)
    assert known is not None
    grid = map_grid(crs_name(known), position)
    assert crs_name(crs) == (found or "EPSG:4326")
    if found is None:
        assert grid is None
        return
    assert grid is not None and grid.crs == found
    assert np.isnan(grid.easting[1]) and np.isfinite(grid.easting[0])
    if found.endswith("33"):
        convergence = np.degrees(
            np.arctan(np.tan(np.radians(1.4759)) * np.sin(np.radians(47.6435)))
        )
        assert abs(grid.convergence_deg[0] - convergence) < within("convergence of a sphere")


def test_picks_of_one_point_in_all_frames_are_told_as_such(tmp_path: Path) -> None:
    """Where all frames are one, a contradiction is not of any one of them."""
    fixed = (
        "[position]\nlat_deg = 47.6435\nlon_deg = 16.4759\nh_m = 540.0\n"
        "height = 'ellipsoid'\nsigma_m = 'exact'\n"
        '[solve]\nframes = "one"\n'
    )
    path = write_project(tmp_path, TOML.split("[track]")[0] + fixed)
    rows = (tmp_path / "picks.csv").read_text().splitlines()[:7]
    (tmp_path / "picks.csv").write_text("\n".join([*rows, "1,mast,5,5"]))
    found = [one.message for one in vopd.solve_flight(path).findings]
    assert any(one.startswith("all frames: mast is picked 2 times, up to ") for one in found)


def test_a_flight_without_a_solution_names_what_is_far_off() -> None:
    """A landmark 1200 km up; one that is 29 times as far as most is not; a track that leaps."""
    flight = uneven_flight([4, 4, 4])
    marks, places = flight.landmarks, flight.path.position_m
    usual_m = float(np.median(flight.pick_range_m))
    told = []
    for away_m in (0.0, 28.0 * usual_m, 1.2e6):
        moved = marks.position_m.copy()
        moved[2] += away_m * (places[0] / np.linalg.norm(places[0]))
        told.append(str(no_solution(replace(flight, landmarks=replace(marks, position_m=moved)))))
    held = replace(flight.options, solve_position=False)
    told.append(str(no_solution(replace(flight, options=held))))
    leaps = Finding(f"the track {LEAPS}", flight.source, severity="warning")
    told.append(str(no_solution(replace(flight, findings=(leaps,)))))
    doubted = Finding("[camera] readout_ms: 16000", flight.source, severity="warning")
    told.append(str(no_solution(replace(flight, findings=(doubted,)))))
    nowhere = replace(flight.path, position_m=np.full_like(places, np.nan))
    assert str(no_solution(replace(flight, path=nowhere))) == told[0] == told[1]
    assert_approved(told[1:])


def test_frames_that_are_years_from_time_zero_are_doubted() -> None:
    """A clock that lost 1024 weeks of GPS: seconds of -6e8, and nothing told."""
    year_s = 365.25 * 86_400.0

    def doubts(*time_s: float, epoch: datetime | None = NOON) -> list[str]:
        return doubt_of_years(FrameTimes(np.array(time_s), (), epoch), lambda k: f"frame {k}")

    assert_approved([*doubts(1.0, -1024 * 7 * 86_400.0), *doubts(np.nan, 3.001 * year_s)])
    assert not doubts(np.nan, 2.999 * year_s) and not doubts(np.nan)
    assert not doubts(1.7e9, epoch=datetime(1970, 1, 1, tzinfo=UTC)) and not doubts(9e9, epoch=None)


NOON = datetime(2026, 5, 1, 12, tzinfo=UTC)


@pytest.mark.parametrize("levels", [(45.0, 47.0), (-45.0, 45.0), (45.0, 46.0), (45.0, 435.0)])
def test_two_heights_of_the_geoid_are_as_near_as_the_places(
    levels: tuple[float, float], tmp_path: Path
) -> None:
    """Of places half a kilometre apart; a level 435 m up is the ground's."""
    own = iter(levels)
    keys = [
        f"height = {{ undulation_m = {next(own)} }}" if one.startswith("height") else one
        for one in TOML.splitlines()
    ]
    flight = read_flight(str(write_project(tmp_path, "\n".join(keys))))
    assert_approved([one.message for one in flight.findings])


# Mounts

MOUNTS = (
    '"down"',
    "{ ypr_deg = [0, -90, 0] }",  # the same
    "{ ypr_deg = [90, 0, 0] }",
    "{ ypr_deg = [180, 0, 90] }",  # looks back, and its roll turns the picture's right side down
    "{ ypr_deg = [-30, 0, 0] }",
    "{ ypr_deg = [0, -60, 0] }",
    "{ matrix = [[0, 1, 0], [0, 0, 1], [1, 0, 0]] }",  # its right is down, its down forward
)


@pytest.mark.parametrize("mount", MOUNTS)
def test_where_the_camera_looks_in_the_vehicle(tmp_path: Path, mount: str) -> None:
    path = write_project(tmp_path, f"{TOML}[vehicle]\nmount = {mount}\n")
    words = vopd.solve_flight(str(path)).history().about.words.conventions
    assert_approved(words["mount"])


def test_nothing_is_said_of_a_camera_that_is_the_vehicle_itself(tmp_path: Path) -> None:
    mount = "{ matrix = [[0, 0, 1], [1, 0, 0], [0, 1, 0]] }"
    path = write_project(tmp_path, f"{TOML}[vehicle]\nmount = {mount}\n")
    assert "mount" not in vopd.solve_flight(str(path)).history().about.words.conventions


# Landmarks that take no part


def test_of_landmarks_that_take_no_part_the_farthest_off_is_the_first(tmp_path: Path) -> None:
    path = write_project(tmp_path, TOML + '[solve]\ncheck_landmarks = ["tower", "well"]\n')
    rows = [row.split(",") for row in (tmp_path / "picks.csv").read_text().splitlines()]
    for row in rows:
        row[2:] = [str(float(row[2]) + 5.0), row[3]] if row[1] == "well" else row[2:]
    (tmp_path / "picks.csv").write_text("\n".join(",".join(row) for row in rows))
    told = vopd.solve_flight(str(path)).history().about.words.conventions["check landmarks"]
    assert told.index("well 3.5 px rms") < told.index("tower ")


def test_landmarks_that_take_no_part_say_how_far_off_they_are(tmp_path: Path) -> None:
    """3 and 4 px in each frame are 3.54 rms of u and v, 6 and 8 in one of five are 3.16."""
    path = write_project(tmp_path, TOML + '[solve]\ncheck_landmarks = ["tower", "well", "mast"]\n')
    rows = [row.split(",") for row in (tmp_path / "picks.csv").read_text().splitlines()]
    kept = [row for row in rows if row[1] != "mast"]
    for row in kept:
        if row[1] == "tower" or row[:2] == ["2", "well"]:
            times = 1.0 if row[1] == "tower" else 2.0
            row[2:] = [str(float(row[2]) + 3.0 * times), str(float(row[3]) - 4.0 * times)]
    (tmp_path / "picks.csv").write_text("\n".join(",".join(row) for row in kept))
    flight = vopd.solve_flight(str(path))
    assert_approved(flight.history().about.words.conventions["check landmarks"])
    told = flight.history().about.words.conventions["check landmarks"]
    assert told in " ".join(flight.summary(80).split()) and told in flight._repr_html_()
    marks = read_flight(str(path)).landmarks
    behind = replace(marks, position_m=marks.position_m.copy())
    behind.position_m[marks.name.index("tower")] = 2.0 * camera_m(np.array([2.2]))[0] - marks_m()[4]
    moved = solve_flight_read(replace(read_flight(str(path)), landmarks=behind))
    assert_approved(moved.history().about.words.conventions["check landmarks"])
