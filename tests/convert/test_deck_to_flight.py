"""A deck as a flight project: its solve has the angles of the deck with all fixes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import vopd
from tests.kit.command import CASE_1, DECKS
from tests.kit.command import vopd as run
from tests.kit.readings import reread
from tests.tolerances import within
from vopd.errata import fixes
from vopd.job import Job
from vopd.synthetic import Plan, make


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
    assert flight.findings == ()


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
    assert ran.status == 1 and "2 jobs; choose one with --job" in ran.stderr
    assert run("new", tmp_path / "p", "--deck", deck, "--job", "3").status == 1
    assert run("new", tmp_path / "p", "--deck", deck, "--job", "2").status == 0
    assert run("new", tmp_path / "q", "--job", "2").status == 2
    assert run("new", tmp_path / "q", "--deck", deck, "--lens", "x").status == 2
    assert not (tmp_path / "q").exists()


def test_angles_that_no_mount_gives_are_said(tmp_path: Path) -> None:
    (job,) = vopd.read_deck(CASE_1)
    camera = replace(job.camera, multiplier=np.array([1.0, -1.0, 1.0]))
    ran = run("new", tmp_path / "p", "--deck", written(tmp_path, replace(job, camera=camera)))
    assert ran.status == 0 and "which no mount does" in ran.stdout


def test_a_deck_that_cannot_be_a_project_names_the_group(tmp_path: Path) -> None:
    cases = {
        "trajectory_out_of_order": "group 7: times must increase, and do not at position",
        "lens_out_of_order": "group 1: radial distances must increase",
        "time_out_of_order": "group 6: frame numbers must increase",
    }
    for name, message in cases.items():
        ran = run("new", tmp_path / "p", "--deck", DECKS / "regression" / f"{name}.dat")
        assert ran.status == 1 and message in ran.stderr, ran.stderr
    inputs = DECKS.parent / "tests" / "robustness" / "inputs"
    ran = run("new", tmp_path / "p", "--deck", inputs / "focal_length_of_zero.dat")
    assert ran.status == 1 and "group 8: a focal length of 0 mm is none" in ran.stderr
    assert not (tmp_path / "p").exists()


def test_a_reading_that_no_film_reader_has_is_left_out(tmp_path: Path) -> None:
    inputs = DECKS.parent / "tests" / "robustness" / "inputs"
    (job, *_) = make(Plan(frames=4))[0]
    readings = job.readings.landmark_in.copy()
    readings[1, 0, 2] = 9999.0
    far = replace(job, readings=reread(job.readings, landmark_in=readings))
    ran = run("new", tmp_path / "p", "--deck", written(tmp_path, far))
    assert ran.status == 0 and "1 point is read more than 100 in from the centre" in ran.stdout
    assert vopd.solve_flight(tmp_path / "p" / "flight.toml").solved.all()
    ran = run("new", tmp_path / "q", "--deck", inputs / "fiducial_of_1e30.dat")
    assert ran.status == 1 and "no landmark is read in any frame" in ran.stderr


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
