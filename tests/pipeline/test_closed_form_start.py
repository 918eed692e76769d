"""Starting from two landmarks in the place of the deck's estimate."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.kit import wgs84_film
from tests.kit.appendix_a import solve_input
from tests.kit.command import vopd
from tests.kit.jobs import film, reread, turned
from tests.kit.wgs84_film import PLACES, camera_matrix, worst
from tests.tolerances import assert_close, within
from vopd.errata import fixes
from vopd.geometry.rotations import camera_angles_deg
from vopd.job import Job
from vopd.pipeline import closed_form_start
from vopd.program.orient import FilmSight
from vopd.program.vopd import run_jobs
from vopd.results import Results

ROOT = Path(__file__).parents[2]
CASES = [ROOT / f"decks/appendix_h/case{n}.dat" for n in range(1, 5)]


def prepared(job: Job) -> FilmSight:
    return solve_input([job], fixes("all"))


@pytest.mark.parametrize("angles", [(195.3, -38.7, 285.8), (359.9, 89.0, 0.1), (1.0, 0.0, 180.0)])
def test_angles_of_a_matrix(angles: tuple[float, float, float]) -> None:
    assert_close("angle of a matrix", camera_angles_deg(camera_matrix(*angles)), angles)


def test_straight_down_yaw_takes_the_roll() -> None:
    """At pitch -90 only yaw + roll is defined."""
    yaw, pitch, roll = camera_angles_deg(camera_matrix(100.0, -90.0, 25.0))
    assert abs(pitch + 90.0) < within("angle at a pole") and roll == 0.0
    same = camera_matrix(yaw, pitch, roll) - camera_matrix(100.0, -90.0, 25.0)
    assert np.abs(same).max() < within("rae element near a pole")


@pytest.mark.parametrize("place", PLACES)
def test_noise_free_starts_are_the_truth(place: tuple[float, float]) -> None:
    job, truth = wgs84_film.film(*place, decimals=None)
    assert worst(closed_form_start(prepared(job)), truth) < within("attitude, noise-free arrays")


@pytest.mark.parametrize("deck", CASES, ids=lambda path: path.stem)
def test_the_printed_cases_come_out_the_same(deck: Path) -> None:
    by_deck = vopd("run", deck)
    by_pair = vopd("run", deck, "--initial", "closed-form", "--compare-initial")
    assert by_pair.status == 0 and by_pair.stdout == by_deck.stdout
    assert "leads to another attitude" not in by_pair.stderr


def test_a_hopeless_estimate(tmp_path: Path) -> None:
    """From 18, 36, 85 degrees the solve of case 1 ends at a camera that looks away."""
    deck = tmp_path / "far.dat"
    near, far = "     198.      -36.      285.", "      18.       36.       85."
    deck.write_text(CASES[0].read_text().replace(near, far))
    lost = vopd("run", deck)
    found = vopd("run", deck, "--initial", "closed-form")
    compared = vopd("run", deck, "--initial", "closed-form", "--compare-initial")
    printed = "  730   70.871  195.270  -38.653  285.837"  # Appendix H
    assert printed not in lost.stdout
    assert printed in found.stdout and "another attitude" not in found.stderr
    assert compared.stdout == found.stdout
    assert "frame 730: the deck's first estimate leads to another attitude" in compared.stderr


def test_the_comparison_needs_the_closed_form() -> None:
    refused = vopd("run", CASES[0], "--compare-initial")
    assert refused.status == 2 and "--compare-initial is only for" in refused.stderr


def test_a_frame_without_two_landmarks_starts_from_the_deck() -> None:
    job, _ = wgs84_film.film(33.08, -106.33, decimals=3)
    landmark = np.array(job.readings.present)
    landmark[3, 1:] = False
    one = replace(job, readings=reread(job.readings, present=landmark))
    (found,) = run_jobs([one], fixes("all"), None, closed_form_start)
    assert isinstance(found, Results)
    assert found.start_deg[3].tolist() == job.camera.initial_deg.tolist()
    assert found.start_deg[2].tolist() != job.camera.initial_deg.tolist()


@pytest.mark.parametrize("focal_mm", [0.0, -10.4, float("nan")])
def test_without_a_focal_length_a_job_starts_from_its_own_deck(focal_mm: float) -> None:
    """Of three jobs that are prepared together, the second; each has its own first estimate."""
    jobs = [turned(np.array([[140.0, -80.0, 60.0]]), np.array([k, 2.0, 3.0])) for k in range(3)]
    camera = replace(jobs[1].camera, focal_length_mm=focal_mm)
    jobs[1] = replace(jobs[1], camera=camera)
    solved = run_jobs(jobs, fixes(), None, closed_form_start)
    found = [one.start_deg[0].round().tolist() for one in solved if isinstance(one, Results)]
    assert found == [[140.0, -80.0, 60.0], [1.0, 2.0, 3.0], [140.0, -80.0, 60.0]]


@pytest.mark.parametrize("ignored", range(5))
def test_a_landmark_that_takes_no_part_is_not_looked_at(ignored: int) -> None:
    """It is misread by two inches, and nothing of the start is changed by it."""
    job = film(2)
    points = job.readings.landmark_in.copy()
    points[:, ignored] += 2.0
    everywhere = np.zeros(5, np.int64)
    everywhere[0] = 11 + ignored
    asked = replace(job.ignored, everywhere=everywhere)
    misread = replace(job, readings=reread(job.readings, landmark_in=points), ignored=asked)
    starts = [closed_form_start(prepared(one)) for one in (misread, replace(job, ignored=asked))]
    np.testing.assert_array_equal(*starts)
    assert starts[0].round().tolist() == [[140.0, -80.0, 60.0]] * 2
