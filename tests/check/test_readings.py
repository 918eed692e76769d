"""The spread of three readings and its limit, and readings that are copies."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import norm, studentized_range

from tests.approved.texts import assert_approved
from tests.kit.command import vopd
from tests.kit.jobs import case, reread
from tests.tolerances import assert_close
from vopd.cards.write import write_deck
from vopd.check import noise_in, spread_limit_in
from vopd.job import Job, Readings, copied_readings_text


def film(fiducials: np.ndarray, landmarks: np.ndarray) -> Readings:
    """Readings (F, 4, 3, 2) and (F, L, 3, 2) of frames numbered from 1."""
    frames, count = landmarks.shape[:2]
    return Readings.of(
        frame=1 + np.arange(frames),
        fiducial_in=fiducials,
        landmark=np.tile(1 + np.arange(count), (frames, 1)),
        present=np.ones((frames, count), bool),
        landmark_in=landmarks,
    )


def random_film(frames: int, sigma_in: float) -> Readings:
    random = np.random.default_rng(3)
    shape = (frames, 4, 3, 2)
    return film(sigma_in * random.standard_normal(shape), sigma_in * random.standard_normal(shape))


@pytest.mark.parametrize(("frames", "sigma_in"), [(1, 0.01), (100, 0.004), (1000, 0.03)])
def test_the_chance_of_a_finding_is_as_documented(frames: int, sigma_in: float) -> None:
    """The range of three normal readings, exactly, for 16 triples a frame."""
    readings = random_film(frames, sigma_in)
    limit = spread_limit_in(readings)
    assert limit > 0.010
    chance = 16 * frames * studentized_range.sf(limit / noise_in(readings), 3, np.inf)
    stated = 0.001  # of a deck without a bad reading
    assert 0.8 * stated < chance < 1.01 * stated  # Bonferroni's bound is close, and a bound


def test_the_noise_is_that_of_the_film() -> None:
    """16,000 variances: their median is known to 1 %, its root to half of that, four times."""
    readings = random_film(1000, 0.02)
    assert_close("noise of a film", noise_in(readings), 0.02)
    readings.landmark_in[::7, 0, 0] += 0.5  # bad readings hardly move it
    assert_close("noise with bad readings", noise_in(readings), 0.02)


def test_a_short_film_has_the_usual_noise() -> None:
    """Sixteen triples without any spread count 16 against 50 of .003 in: .003 sqrt(50/66)."""
    still = film(np.zeros((1, 4, 3, 2)), np.zeros((1, 4, 3, 2)))
    assert_close("table value", noise_in(still), 0.003 * np.sqrt(50.0 / 66.0))


def test_places_without_a_landmark_do_not_count() -> None:
    """Masked places hold zeros, which have no spread."""
    readings = random_film(50, 0.02)
    wide = np.tile(readings.landmark_in, (1, 9, 1, 1))
    wide[:, 4:] = 0.0
    wide = reread(
        film(readings.fiducial_in, wide),
        present=np.broadcast_to(np.arange(36) < 4, (50, 36)),
    )
    assert noise_in(wide) == noise_in(readings)


def test_small_differences_are_never_questioned() -> None:
    still = film(np.zeros((300, 4, 3, 2)), np.zeros((300, 4, 3, 2)))
    assert spread_limit_in(still) == 0.010


def test_a_reading_that_is_no_number_leaves_the_noise_of_the_others() -> None:
    """The limit was .010 in then, whatever the film: 158 warnings in a noisy one."""
    readings = random_film(1000, 0.02)
    readings.fiducial_in[0, 0, 0, 0] = np.nan
    assert_close("noise with bad readings", noise_in(readings), 0.02)


def test_a_film_without_frames_has_the_usual_noise_and_the_limit_of_one_triple() -> None:
    """Three differences, each on two sides, at a chance of .001."""
    empty = film(np.zeros((0, 4, 3, 2)), np.zeros((0, 1, 3, 2)))
    assert_close("table value", noise_in(empty), 0.003)
    limit = 0.003 * np.sqrt(2.0) * norm.isf(0.001 / 6.0)
    assert_close("table value", spread_limit_in(empty), float(limit))


# Copies


SAID = "their spread says nothing about how well the points were read"


def copies(points: int) -> Job:
    """Case 1, four fiducials and three landmarks, the first of which are read once and copied."""
    job = case(1)
    fiducial, landmark = job.readings.fiducial_in.copy(), job.readings.landmark_in.copy()
    for k in range(points):
        point = fiducial[0, k] if k < 4 else landmark[0, k - 4]
        point[:] = point[0]
    readings = reread(job.readings, fiducial_in=fiducial, landmark_in=landmark)
    return replace(job, readings=readings)


@pytest.mark.parametrize(("points", "told"), [(0, 0), (3, 0), (4, 4), (7, 7)])
def test_more_than_half_of_the_points(points: int, told: int) -> None:
    text = copied_readings_text(copies(points).readings)
    assert bool(text) == bool(told)
    assert_approved(text)


def test_a_point_that_agrees_in_x_alone_is_no_copy() -> None:
    job = copies(7)
    landmark = job.readings.landmark_in.copy()
    landmark[0, :, 1, 1] += 0.001
    readings = reread(job.readings, landmark_in=landmark)
    assert "in 4 of 7 points" in copied_readings_text(readings)


def test_points_that_are_not_on_the_film_do_not_count() -> None:
    """A frame with fewer landmarks than another has zeros in their place."""
    job = case(1)
    wider = reread(
        job.readings,
        landmark=np.pad(job.readings.landmark, ((0, 0), (0, 30))),
        present=np.pad(job.readings.present, ((0, 0), (0, 30))),
        landmark_in=np.pad(job.readings.landmark_in, ((0, 0), (0, 30), (0, 0), (0, 0))),
    )
    assert copied_readings_text(wider) == ""


@pytest.mark.parametrize("command", ["check", "attitude", "report", "plot"])
def test_the_commands_say_so_once(
    command: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    if command == "report":
        request.getfixturevalue("no_figures")
    deck = tmp_path / "copies.dat"
    deck.write_text(write_deck([copies(7)]))
    suffix = {"check": ".txt", "attitude": ".csv", "report": ".html", "plot": ".png"}[command]
    figure = ("--figure", "image") if command == "plot" else ()
    out = tmp_path / f"out{suffix}"
    done = vopd(command, deck, "-o", out, *figure)
    assert done.status == 0
    text = out.read_text() if command == "check" else done.stderr
    assert text.count(SAID) == 1 and "basic data" in text


def test_a_clean_deck_has_no_such_warning(tmp_path: Path) -> None:
    deck = tmp_path / "case1.dat"
    deck.write_text(write_deck([case(1)]))
    assert SAID not in vopd("check", deck).stdout + vopd("attitude", deck).stderr
