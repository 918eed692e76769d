"""A job of cards as a flight project."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vopd
from tests.approved.texts import assert_approved, refused
from tests.kit.command import CASE_1, DECKS
from tests.kit.command import vopd as run
from tests.kit.jobs import reread
from tests.kit.simulated_films import SPHERE_1974, WGS84, Errors, job_of, simulate
from tests.kit.simulated_films import Plan as Films
from tests.tolerances import assert_close, within
from vopd.arrays import Floats
from vopd.convert.deck_to_flight import deck_flight, deck_project
from vopd.errata import NO_FIXES, fixes
from vopd.findings import VopdError
from vopd.flight.misfits.input_errors import SPEAK_FOR
from vopd.flight.project.inspect import NewProject
from vopd.flight.project.read import read_flight
from vopd.flight.result import solve_flight_read
from vopd.job import Job, Landmarks, Wind
from vopd.synthetic import Plan
from vopd.synthetic.flight import make

# A deck as a flight project: its solve has the angles of the deck with all fixes


def solved(folder: Path, deck: Path) -> vopd.FlightResult:
    ran = run("new", folder / "project", "--deck", deck)
    assert ran.status == 0, ran.stderr
    return vopd.solve_flight(folder / "project" / "flight.toml")


def agree(flight: vopd.FlightResult, deck: vopd.Run) -> None:
    """Frames that the deck drops are not in the project."""
    rows = np.flatnonzero(np.isin(deck.frame, flight.frame))
    rows = rows[np.unique(deck.frame[rows], return_index=True)[1]]
    attack = np.stack([deck.alpha_deg, deck.beta_deg, deck.eta_deg], axis=1)
    for mine, theirs in (
        (flight.camera_deg, deck.camera_deg),
        (flight.vehicle_deg, deck.vehicle_deg),
        (flight.attack_deg, attack),
    ):
        off = (mine - theirs[rows] + 180.0) % 360.0 - 180.0
        assert np.abs(off).max() < within("angle of a deck's project")


@pytest.mark.parametrize("case", ["case1", "case2", "case3"])
def test_the_project_of_a_case_of_the_report_has_its_angles(tmp_path: Path, case: str) -> None:
    """Their vehicle's roll is the camera's less 210 degrees, which is a mount."""
    deck = DECKS / "appendix_h" / f"{case}.dat"
    flight = solved(tmp_path, deck)
    agree(flight, vopd.run(vopd.read_deck(deck), fixes("all")))


def test_the_project_of_a_flight_has_its_angles(tmp_path: Path) -> None:
    jobs, _ = make(Plan(frames=60, seed=5))
    deck = tmp_path / "deck.dat"
    deck.write_text(vopd.write_deck(jobs))
    flight = solved(tmp_path, deck)
    agree(flight, vopd.run(jobs, fixes("all")))


EARTHS = {"1974": (NO_FIXES, SPHERE_1974), "WGS 84": (fixes("all"), WGS84)}


def ends_early(job: Job) -> Job:
    """The trajectory ends before the frames, and the wind far below them."""
    path, wind = job.trajectory, np.array([[10.0, 20.0], [11.0, 18.0]])
    two = {name: getattr(path, name)[:2] for name in vars(path) if np.ndim(getattr(path, name))}
    return replace(job, trajectory=replace(path, **two), wind=Wind(np.array([1e3, 2e3]), wind))


def begins_late(job: Job) -> Job:
    """The trajectory begins .1 s after the last frame."""
    path, last_s = job.trajectory, job.clock.time_s.max()
    later_s = path.time_s - path.time_s[0] + last_s + 0.1
    return replace(job, trajectory=replace(path, time_s=later_s))


def three_ignored(job: Job) -> Job:
    """Of four landmarks: the third is used all the same."""
    return replace(job, ignored=replace(job.ignored, everywhere=np.array([1, 2, 3, 0])))


def one_wind(job: Job) -> Job:
    return replace(job, wind=Wind(np.array([1e3]), np.array([[10.0, 20.0]])))


@pytest.mark.parametrize("change", [ends_early, begins_late, three_ignored, one_wind])
def test_a_project_solves_what_a_run_does(tmp_path: Path, change: Callable[[Job], Job]) -> None:
    (plain,) = make(Plan(frames=12, landmarks=4, noise_in=0.001, seed=7, earth="wgs84"))[0]
    job = change(plain)
    agree(solved(tmp_path, written(tmp_path, job)), vopd.run(job, fixes("all")))
    said = [one for one in deck_project(job).said if one not in deck_project(plain).said]
    assert bool(said) == (change in (ends_early, begins_late))
    read = read_flight(str(tmp_path / "project" / "flight.toml"))
    assert deck_flight(job, fixes("all")).landmarks.used == read.landmarks.used
    for text in said:
        assert_approved(text, parts=["12"])


@pytest.mark.parametrize("earth", EARTHS)
def test_a_clean_film_has_no_findings_on_its_own_earth(earth: str) -> None:
    chosen, exposed = EARTHS[earth]
    plan = Films(Errors(reading_in=0.003), landmarks=6, jobs=1, frames=40, earth=exposed)
    drawn = job_of(simulate(plan, 11), 0)
    assert solve_flight_read(deck_flight(drawn, chosen, "film.dat")).findings == ()


def test_a_demo_is_exposed_over_the_earth_of_1974() -> None:
    """Its landmarks are tens of metres from where the ellipsoid has them, as the camera is."""
    (one,) = make(Plan(frames=60, seed=5))[0]
    assert solve_flight_read(deck_flight(one, NO_FIXES, "demo.dat")).findings == ()
    (doubt,) = solve_flight_read(deck_flight(one, fixes("all"), "demo.dat")).findings
    assert doubt.message.startswith(SPEAK_FOR)  # of all, the camera's position or its focal length


@pytest.mark.parametrize("case", ["case1", "case2", "case4"])
def test_a_flight_in_memory_is_that_of_the_project(tmp_path: Path, case: str) -> None:
    """The files have ten decimals of a degree and four of a pixel."""
    deck = DECKS / "appendix_h" / f"{case}.dat"
    assert run("new", tmp_path, "--deck", deck).status == 0
    read = read_flight(str(tmp_path / "flight.toml"))
    (one,) = vopd.read_deck(deck)
    flight = deck_flight(one, fixes("all"), "case")
    assert flight.landmarks.name == read.landmarks.name
    assert flight.landmarks.used == read.landmarks.used
    assert flight.frame.tolist() == read.frame.tolist()
    assert flight.picks.landmark.tolist() == read.picks.landmark.tolist()
    assert set(flight.options.exact) == set(read.options.exact)
    assert_close("flight position", flight.landmarks.position_m, read.landmarks.position_m)
    assert_close("flight position", flight.path.position_m, read.path.position_m)
    assert_close("four decimals", flight.picks.pixel, read.picks.pixel)
    assert_close("four decimals", flight.picks.sigma_px, read.picks.sigma_px)
    assert_close("five decimals", flight.path.velocity_m_s, read.path.velocity_m_s)
    assert_close("times of a deck's project", flight.time_s, read.time_s)
    assert_close("unit rotation", flight.mount, read.mount)


def written(tmp_path: Path, job: Job) -> Path:
    deck = tmp_path / "deck.dat"
    deck.write_text(vopd.write_deck([job]))
    return deck


def test_what_the_deck_ignores_takes_no_part(tmp_path: Path) -> None:
    (job,) = make(Plan(frames=8, landmarks=5))[0]
    marks = job.landmarks.number
    everywhere = np.zeros_like(job.ignored.everywhere)
    everywhere[0] = marks[2]
    ignored = replace(
        job.ignored,
        frame=np.array([job.readings.frame[1], job.readings.frame[3]]),
        landmark=np.array([[marks[0], 0, 0, 0, 0, 0], [100, 0, 0, 0, 0, 0]]),
        everywhere=everywhere,
    )
    deck = written(tmp_path, replace(job, ignored=ignored))
    flight = solved(tmp_path, deck)
    assert len(flight.frame) == 7
    assert f'check_landmarks = ["{marks[2]}"]' in (tmp_path / "project/flight.toml").read_text()
    agree(flight, vopd.run(vopd.read_deck(deck), fixes("all")))


def test_a_job_is_chosen(tmp_path: Path) -> None:
    jobs, _ = make(Plan(frames=4, jobs=2))
    deck = tmp_path / "two.dat"
    deck.write_text(vopd.write_deck(jobs))
    ran = run("new", tmp_path / "p", "--deck", deck)
    assert ran.status == 1
    assert_approved(ran.stderr)
    assert run("new", tmp_path / "p", "--deck", deck, "--job", "3").status == 1
    assert run("new", tmp_path / "p", "--deck", deck, "--job", "2").status == 0
    assert run("new", tmp_path / "q", "--job", "2").status == 2
    assert run("new", tmp_path / "q", "--deck", deck, "--lens", "x").status == 2
    assert not (tmp_path / "q").exists()


def test_a_trajectory_of_one_row_is_a_position_without_wind(tmp_path: Path) -> None:
    (job,) = vopd.read_deck(CASE_1)
    path = job.trajectory
    one = {name: getattr(path, name)[:1] for name in ("time_s", "position_ft", "velocity_ft_s")}
    deck = written(
        tmp_path,
        replace(job, trajectory=replace(path, **one, altitude_ft=path.altitude_ft[:1])),
    )
    ran = run("new", tmp_path / "project", "--deck", deck)
    assert_approved([line for line in ran.stdout.splitlines() if "one row" in line])
    assert not (tmp_path / "project" / "wind.csv").exists()
    flight = vopd.solve_flight(tmp_path / "project" / "flight.toml")
    found = vopd.run(vopd.read_deck(deck), fixes("all"))
    assert np.isnan(flight.attack_deg).all()
    off = (flight.camera_deg - found.camera_deg + 180.0) % 360.0 - 180.0
    assert np.abs(off).max() < within("angle of a deck's project")


def test_angles_that_no_mount_gives_are_said(tmp_path: Path) -> None:
    (job,) = vopd.read_deck(CASE_1)
    camera = replace(job.camera, multiplier=np.array([1.0, -1.0, 1.0]))
    ran = run("new", tmp_path / "p", "--deck", written(tmp_path, replace(job, camera=camera)))
    assert ran.status == 0
    assert_approved([line for line in ran.stdout.splitlines() if "mount" in line])


def test_a_deck_that_cannot_be_a_project_names_the_group(tmp_path: Path) -> None:
    for name in ("trajectory_out_of_order", "lens_out_of_order", "time_out_of_order"):
        ran = run("new", tmp_path / "p", "--deck", DECKS / "regression" / f"{name}.dat")
        assert ran.status == 1
        assert_approved(ran.stderr.splitlines(keepends=True)[-1])
    inputs = DECKS.parent / "tests" / "robustness" / "inputs"
    ran = run("new", tmp_path / "p", "--deck", inputs / "focal_length_of_zero.dat")
    assert ran.status == 1
    assert_approved(ran.stderr.splitlines(keepends=True)[-1])
    assert not (tmp_path / "p").exists()


def test_a_reading_that_no_film_reader_has_is_left_out(tmp_path: Path) -> None:
    inputs = DECKS.parent / "tests" / "robustness" / "inputs"
    (job, *_) = make(Plan(frames=4))[0]
    readings = job.readings.landmark_in.copy()
    readings[1, 0, 2] = 9999.0
    far = replace(job, readings=reread(job.readings, landmark_in=readings))
    ran = run("new", tmp_path / "p", "--deck", written(tmp_path, far))
    assert ran.status == 0
    assert_approved([line for line in ran.stdout.splitlines() if "from the centre" in line])
    assert vopd.solve_flight(tmp_path / "p" / "flight.toml").solved.all()
    ran = run("new", tmp_path / "q", "--deck", inputs / "fiducial_of_1e30.dat")
    assert ran.status == 1
    assert_approved(ran.stderr.splitlines(keepends=True)[-1])


def test_a_deck_with_one_position_is_a_camera_that_does_not_move(tmp_path: Path) -> None:
    (job,) = make(Plan(frames=2))[0]
    path = job.trajectory
    names = ("time_s", "position_ft", "velocity_ft_s", "altitude_ft")
    still = replace(path, **{name: getattr(path, name)[:1] for name in names})
    deck = written(tmp_path, replace(job, trajectory=still))
    assert run("new", tmp_path / "project", "--deck", deck).status == 0
    text = (tmp_path / "project" / "flight.toml").read_text()
    assert "\n[position]\n" in text and "\n[track]\n" not in text
    assert not (tmp_path / "project" / "track.csv").exists()


# Readings of a deck as picks: pixels, the size of the image, sigma, and what is left out


@cache
def made() -> Job:
    return make(Plan(frames=3, landmarks=5, seed=4))[0][0]


def job(**changes: Any) -> Job:
    """Three frames of five landmarks, read without distortion."""
    one = made()
    camera = replace(one.camera, lens_distortion_um=np.zeros(25))
    return replace(one, **({"camera": camera} | changes))


def reading(change: Any) -> Job:
    """The job with its readings of landmarks, (F, L, 3, 2), changed in place."""
    one = job()
    inches = one.readings.landmark_in.copy()
    change(inches)
    return job(readings=reread(one.readings, landmark_in=inches))


def table(project: NewProject, name: str) -> Floats:
    return np.array([row.split(",") for row in project.contents[name].decode().split()[1:]], float)


def keys(project: NewProject) -> dict[str, Any]:
    return tomllib.loads(project.contents["flight.toml"].decode())


def away_px(one: Job) -> Floats:
    """To the right and up of the middle of the four fiducials, thousandths of an inch."""
    centre = one.readings.fiducial_in.mean(axis=(1, 2))[:, None, None]
    return np.asarray((one.readings.landmark_in - centre) * 1000.0)


def test_a_pixel_is_a_thousandth_of_an_inch_from_the_centre_of_the_frame() -> None:
    """x grows to the left and y up on film; u to the right and v down from the first pixel."""
    one = job()
    project, away = deck_project(one), away_px(one)
    width, height = keys(project)["camera"]["image_size_px"]
    found = table(project, "picks.csv")
    assert found[:, 0].tolist() == np.repeat(one.readings.frame, 15).tolist()
    assert found[:, 1].tolist() == np.repeat(one.readings.landmark.ravel(), 3).tolist()
    middle = np.array([width - 1, height - 1]) / 2.0
    assert_close("four decimals", found[:, 2:], middle - away.reshape(-1, 2))
    farthest = np.ceil(np.abs(away).max(axis=(0, 1, 2)))
    assert [width, height] == (2 * (farthest + 50)).tolist()
    cells = project.contents["picks.csv"].decode().split()[1].split(",")
    assert [len(cell.partition(".")[2]) for cell in cells] == [0, 0, 4, 4]


def test_what_the_cards_do_not_say_is_exact_and_readings_have_no_sigma() -> None:
    found = keys(deck_project(job()))
    assert "sigma_px" not in found["picks"] and found["picks"]["pixel_grid"] == "centre"
    assert found["landmarks"]["sigma_m"] == "exact"
    stated = {key: value for key, value in found["track"].items() if "sigma" in key}
    assert stated == dict.fromkeys(("sigma_m", "sigma_t_s", "velocity_sigma_m_s"), "exact")


def test_distortion_is_taken_off_by_the_table() -> None:
    """100 um at every radius: a point at r mm has its ideal place at r + .1."""
    one = job()
    camera = replace(one.camera, lens_distortion_um=np.full(25, 100.0))
    plain, shifted = (
        table(deck_project(each), "picks.csv")[:, 2:]
        - (np.array(keys(deck_project(each))["camera"]["image_size_px"]) - 1.0) / 2.0
        for each in (one, job(camera=camera))
    )
    mean = plain.reshape(-1, 3, 2).mean(axis=1)
    r_mm = np.hypot(*mean.T) * 0.000713816400205
    expected = plain * np.repeat((r_mm + 0.1) / r_mm, 3)[:, None]
    assert_close("printed feet", shifted, expected)


@pytest.mark.parametrize(
    ("away_in", "left_out"), [([99.9], 0), ([100.1], 1), ([-100.1], 1), ([200.0, 300.0], 2)]
)
def test_points_that_no_film_reader_has(away_in: list[float], left_out: int) -> None:
    """One coordinate of one of three readings is enough; the other frames keep theirs."""
    centre = job().readings.fiducial_in.mean(axis=(1, 2))

    def far(inches: Floats) -> None:
        for frame, away in enumerate(away_in):
            inches[frame, 2, 1, 0] = centre[frame, 0] + away

    project = deck_project(reading(far))
    notes = [note for note in project.said if "point" in note]
    assert len(notes) == bool(left_out)
    if left_out:
        assert_approved(notes, parts=[left_out])
    picks = table(project, "picks.csv")
    assert len(picks) == 45 - 3 * left_out


def test_no_landmark_at_all_is_refused() -> None:
    def far(inches: Floats) -> None:
        inches[...] = 1e6

    with refused(VopdError):
        deck_project(reading(far))


def test_what_the_deck_ignores_is_no_pick_and_what_it_ignores_everywhere_is() -> None:
    """A landmark in one frame, and a whole frame, are left out; one everywhere is a check."""
    one = job()
    marks, frames = one.readings.landmark[0], one.readings.frame
    ignored = replace(
        one.ignored,
        frame=frames[[0, 1]],
        landmark=np.array([[marks[1], 0, 0, 0, 0, 0], [100, 0, 0, 0, 0, 0]]),
        everywhere=np.array([marks[3], 0, 0, 0, 0]),
    )
    picks = table(deck_project(job(ignored=ignored)), "picks.csv")
    kept = [(frames[0], m) for m in np.delete(marks, 1)] + [(frames[2], m) for m in marks]
    assert [tuple(row) for row in picks[::3, :2].astype(int)] == [tuple(map(int, k)) for k in kept]


@pytest.mark.parametrize(("rows", "moving"), [(1, False), (2, True)])
def test_one_position_is_no_track(rows: int, moving: bool) -> None:
    one = job()
    path = one.trajectory
    names = ("time_s", "position_ft", "velocity_ft_s", "altitude_ft")
    few = replace(path, **{name: getattr(path, name)[:rows] for name in names})
    project = deck_project(job(trajectory=few))
    found = keys(project)
    assert ("track.csv" in project.contents) == moving == ("track" in found)
    first = table(deck_project(one), "track.csv")[0]
    if moving:
        assert found["track"] == {
            "file": "track.csv", "height": "ellipsoid",
            **dict.fromkeys(("sigma_m", "sigma_t_s", "velocity_sigma_m_s"), "exact"),
        }  # fmt: skip
        assert_close("ratio", table(project, "track.csv")[0], first)
    else:
        place = found["position"]
        assert place["height"] == "ellipsoid"
        numbers = [place["lat_deg"], place["lon_deg"], place["h_m"]]
        assert_close("five decimals", numbers, first[1:4])


@pytest.mark.parametrize(
    ("name", "decimals"),
    [
        ("picks.csv", [0, 0, 4, 4]),
        ("landmarks.csv", [0, 10, 10, 5]),
        ("times.csv", [0, 9]),
        ("track.csv", [9, 11, 11, 6, 6, 6, 6]),
        ("wind.csv", [4, 7, 6]),
    ],
)
def test_decimals_of_every_column(name: str, decimals: list[int]) -> None:
    """A micrometre of a position, a tenth of a nanosecond of a time, 1E-4 of a pixel."""
    one = job()
    wind = replace(one.wind, altitude_ft=np.array([1.0]), velocity_ft_s=np.array([[3.0, 4.0]]))
    cells = deck_project(job(wind=wind)).contents[name].decode().split()[1].split(",")
    assert [len(cell.partition(".")[2]) for cell in cells] == decimals


def test_a_table_out_of_order_names_its_group_and_position() -> None:
    one = job()
    time_s = one.trajectory.time_s.copy()
    time_s[2] = time_s[1]
    with refused(VopdError, parts=["position 3"]):
        deck_project(job(trajectory=replace(one.trajectory, time_s=time_s)))


# The tables and keys of a project that is made of a deck, worked by hand from the cards


M = 1000.0 / 3280.8336  # of a foot, as the program of 1974 has it
NO_MOUNT = "group 3 takes the vehicle's angles from the camera's one by one"


def small_job() -> Job:
    """Three frames of five landmarks."""
    return make(Plan(frames=3, landmarks=5, seed=4))[0][0]


def project_of(**changes: Any) -> NewProject:
    return deck_project(replace(small_job(), **changes))


def rows(project: NewProject, name: str) -> tuple[str, list[list[float]]]:
    """Header and numbers of a table, whose last line has its end."""
    text = project.contents[name].decode()
    assert text.endswith("\n") and not text.endswith("\n\n")
    header, *lines = text.splitlines()
    return header, [[float(cell) for cell in line.split(",")] for line in lines]


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
    height, direction, speed = np.array(found[:5]).T  # what follows goes on to the frames
    assert_close("four decimals", height, np.array([0.0, 100.0, 200.0, 300.0, 400.0]) * M)
    expected = [180.0, 270.0, np.degrees(np.arctan2(4.0, 3.0)), 90.0, 0.0]
    assert_close("five decimals", direction, expected)
    assert_close("five decimals", speed, np.array([10.0, 10.0, 5.0, 10.0, 10.0]) * M)
    assert keys(project)["wind"]["file"] == "wind.csv"


def test_calm_is_no_wind() -> None:
    project = project_of(wind=Wind(np.array([0.0]), np.zeros((1, 2))))
    assert "wind.csv" not in project.contents and not keys(project).get("wind")


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
        small_job().camera,
        multiplier=np.array(multiplier, float),
        offset_deg=np.array(offset, float),
    )
    project = project_of(camera=camera)
    expected = {} if mount is None else {"mount": {"ypr_deg": mount}}
    assert keys(project).get("vehicle", {}) == expected
    assert any(note.startswith(NO_MOUNT) for note in project.said) is noted


def test_the_track_is_in_degrees_metres_and_metres_a_second() -> None:
    """At the origin, and 100 kft above it: the origin's own latitude and longitude."""
    path = small_job().trajectory
    still = replace(
        path,
        time_s=path.time_s[:2],
        position_ft=np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1e5]]),
        velocity_ft_s=np.array([[1.0, 2.0, 3.0], [-10.0, 20.0, -30.0]]),
        altitude_ft=np.array([0.0, 1e5]),
    )
    header, found = rows(project_of(trajectory=still), "track.csv")
    assert header == "t_s,lat_deg,lon_deg,h_m,vn_m_s,ve_m_s,vd_m_s"
    table = np.array(found[:2])  # what follows goes on to the frames
    assert_close("flight time", table[:, 0], path.time_s[:2])
    assert_close("ratio", table[:, 1], path.origin_latitude_deg)
    assert_close("ratio", table[:, 2], path.origin_longitude_deg)
    assert_close("five decimals", table[1, 3] - table[0, 3], 1e5 * M)
    assert_close("five decimals", table[:, 4:], still.velocity_ft_s * M)


def test_frames_have_their_times_once() -> None:
    """A frame that is read twice counts the first time, and that is noted."""
    one = small_job()
    twice = np.array([0, 1, 2, 1])
    project = project_of(readings=one.readings.take(twice))
    header, found = rows(project, "times.csv")
    assert header == "frame,t_s" and [row[0] for row in found] == one.readings.frame.tolist()
    once = rows(project_of(), "times.csv")[1]
    assert found == once
    assert_approved([one for one in project.said if one not in project_of().said])
    header, picks = rows(project, "picks.csv")
    assert header == "frame,landmark,u_px,v_px" and len(picks) == 3 * 5 * 3
    assert picks == rows(project_of(), "picks.csv")[1]


def test_the_distortion_is_noted_where_there_is_one() -> None:
    camera = small_job().camera
    none = project_of(camera=replace(camera, lens_distortion_um=np.zeros(25)))
    assert np.any(camera.lens_distortion_um)
    assert_approved([one for one in project_of().said if one not in none.said])


@pytest.mark.parametrize(("off_ft", "told"), [(20.0, False), (-100.0, True)])
def test_another_altitude_than_that_of_the_position_is_told(off_ft: float, told: bool) -> None:
    """A run looks up the wind by the one, a project by the other."""
    path, plain = small_job().trajectory, project_of().said
    other = project_of(trajectory=replace(path, altitude_ft=path.altitude_ft + off_ft))
    said = [one for one in other.said if one not in plain]
    assert bool(said) == told
    for text in said:
        assert_approved(text, parts=["100"])


def test_keys_that_the_cards_decide() -> None:
    """The title is without the printer's column; a pixel is .7138164002 mm / 1000."""
    one = small_job()
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
    assert keys(project_of())["solve"] == {"position": "fixed"}


@pytest.mark.parametrize(
    "changes",
    [
        {"readings": small_job().readings.take(np.zeros(0, np.int64))},
        {"camera": replace(small_job().camera, focal_length_mm=0.000713)},
        {"clock": replace(small_job().clock, time_s=np.zeros_like(small_job().clock.time_s))},
    ],
)
def test_what_is_no_flight_is_refused(changes: dict[str, Any]) -> None:
    with refused(VopdError):
        project_of(**changes)


def test_a_focal_length_of_more_than_a_pixel_is_one() -> None:
    assert project_of(camera=replace(small_job().camera, focal_length_mm=0.000715))
