"""Starting from two landmarks in the place of the deck's estimate."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from vopd.stellar.closed_form_start import closed_form_start, euler_deg

import vopd
from tests.kit import wgs84_film
from tests.kit.wgs84_film import PLACES, camera_matrix, worst
from vopd.cli import cli
from vopd.errata import fixes

ROOT = Path(__file__).parents[2]
CASES = [ROOT / f"decks/appendix_h/case{n}.dat" for n in range(1, 5)]


@pytest.mark.parametrize("angles", [(195.3, -38.7, 285.8), (359.9, 89.0, 0.1), (1.0, 0.0, 180.0)])
def test_angles_of_a_matrix(angles: tuple[float, float, float]) -> None:
    assert np.abs(euler_deg(camera_matrix(*angles)) - angles).max() < 1e-9


def test_straight_down_yaw_takes_the_roll() -> None:
    """At pitch -90 only yaw + roll is defined."""
    yaw, pitch, roll = euler_deg(camera_matrix(100.0, -90.0, 25.0))
    assert abs(pitch + 90.0) < 1e-5 and roll == 0.0
    same = camera_matrix(yaw, pitch, roll) - camera_matrix(100.0, -90.0, 25.0)
    assert np.abs(same).max() < 1e-7


@pytest.mark.parametrize("place", PLACES)
def test_noise_free_starts_are_the_truth(place: tuple[float, float]) -> None:
    job, truth = wgs84_film.film(*place, decimals=None)
    assert worst(closed_form_start(vopd.run(job, fixes("all"))), truth) < 1e-5


@pytest.mark.parametrize("deck", CASES, ids=lambda path: path.stem)
def test_the_printed_cases_come_out_the_same(deck: Path) -> None:
    runner = CliRunner()
    by_deck = runner.invoke(cli, ["run", str(deck)])
    by_pair = runner.invoke(cli, ["run", str(deck), "--initial", "closed-form"])
    assert by_pair.exit_code == 0 and by_pair.stdout == by_deck.stdout
    assert "leads to another attitude" not in by_pair.stderr


def test_a_hopeless_estimate(tmp_path: Path) -> None:
    """From 18, 36, 85 degrees the solve of case 1 ends at a camera that looks away."""
    deck = tmp_path / "far.dat"
    near, far = "     198.      -36.      285.", "      18.       36.       85."
    deck.write_text(CASES[0].read_text().replace(near, far))
    runner = CliRunner()
    lost = runner.invoke(cli, ["run", str(deck)])
    found = runner.invoke(cli, ["run", str(deck), "--initial", "closed-form"])
    printed = "  730   70.871  195.270  -38.653  285.837"  # Appendix H
    assert printed not in lost.stdout
    assert printed in found.stdout
    assert "frame 730: the deck's first estimate leads to another attitude" in found.stderr


def test_a_frame_without_two_landmarks_starts_from_the_deck() -> None:
    job, _ = wgs84_film.film(33.08, -106.33, decimals=3)
    results = vopd.run(job)
    results.used[3, 1:] = False
    assert closed_form_start(results)[3].tolist() == job.camera.initial_deg.tolist()
