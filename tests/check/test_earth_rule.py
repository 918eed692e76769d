"""`vopd check` on decks for which the Earth of 1974 is too coarse, by numbers worked by hand."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit import wgs84_film
from tests.kit.command import CASE_1, vopd
from tests.kit.jobs import case
from tests.kit.wgs84_film import camera_matrix
from tests.tolerances import within
from vopd.cards.write import write_deck
from vopd.check import LIMIT_DEG, earth_cost
from vopd.job import Job
from vopd.pipeline import run

BERN = (46.6, 7.4)
LOW = 0.0032  # of a film from 36 km: 115 m


def shifted_m(latitude_deg: float) -> float:
    """By the listing's wrong digit: (.0003258611 - .0000325861) sin 4L degrees of 111.2 km."""
    series = (0.0003258611111 - 0.0000325861111) * np.sin(np.radians(4.0 * latitude_deg))
    return float(abs(series) * 111_200.0)


def low(scale: float = LOW, latitude_deg: float = BERN[0]) -> Job:
    """A film in the numbers that cards hold."""
    job = wgs84_film.film(latitude_deg, BERN[1], decimals=4, scale=scale)[0]
    marks = replace(
        job.landmarks,
        longitude_min=job.landmarks.longitude_min.round(5),
        latitude_min=job.landmarks.latitude_min.round(5),
        altitude_ft=job.landmarks.altitude_ft.round(4),
    )
    path = replace(
        job.trajectory,
        position_ft=job.trajectory.position_ft.round(4),
        altitude_ft=job.trajectory.altitude_ft.round(4),
    )
    return replace(job, landmarks=marks, trajectory=path)


@pytest.mark.parametrize("latitude", [46.6, 44.1, -46.0])
def test_close_to_the_ground_it_is_the_wrong_digit_over_the_height(latitude: float) -> None:
    """From 115 m nothing else counts: shift over distance, but for landmarks that are not below."""
    cost = earth_cost(low(LOW, latitude))
    assert abs(cost.shift_m[0] / shifted_m(latitude) - 1.0) < within("share of the Earth's cost")
    by_hand = np.degrees(shifted_m(latitude) / (1000.0 * cost.distance_km[0]))
    assert abs(cost.angle_deg[0] / by_hand - 1.0) < 2 * within("share of the Earth's cost")
    assert 0.11 < cost.distance_km[0] < 0.12


@pytest.mark.parametrize("place", wgs84_film.PLACES)
def test_it_is_what_a_run_is_wrong_by(place: tuple[float, float]) -> None:
    """The rotation from the solved to the true attitude; landmarks weigh a little otherwise."""
    job, truth = wgs84_film.film(*place, decimals=None)
    solved = run(job).camera_deg
    errors = [
        Rotation.from_matrix(camera_matrix(*t) @ camera_matrix(*s).T).magnitude()
        for t, s in zip(truth, solved, strict=True)
    ]
    off = np.abs(earth_cost(job).angle_deg - np.degrees(errors))
    assert off.max() < within("the Earth's cost")


def said(job: Job, folder: Path) -> str:
    deck = folder / "deck.dat"
    deck.write_text(write_deck([job]))
    done = vopd("check", deck)
    assert done.status == 0, done.stderr
    return " ".join(line for line in done.stdout.splitlines() if "1974" in line)


def test_a_drone_is_told_to_fix_the_earth(tmp_path: Path) -> None:
    text = said(low(), tmp_path)
    assert "spherical Earth of 1974 turns the attitude by 1.8" in text  # 3.6 m over 112 m
    assert "12 frames, most of all in frame 12" in text
    assert "displaces the landmarks by 3.6 m against the camera, 0.11 km away" in text
    assert text.count("--fix earth") == 1 and "warning: " in text and "basic data" in text


def test_a_flight_like_the_report_s_is_not(tmp_path: Path) -> None:
    for job in (case(1), case(4), low(1.0)):
        assert said(job, tmp_path) == ""
        assert np.nanmax(earth_cost(job).angle_deg) < LIMIT_DEG / 1.5


def test_a_tenth_of_a_degree_is_the_limit(tmp_path: Path) -> None:
    """By the wrong digit over the height .1036 and .0985, 2 % more than by the landmarks."""
    assert "turns the attitude by 0.10 degrees" in said(low(0.058), tmp_path)
    assert said(low(0.061), tmp_path) == ""


def test_one_frame_of_many(tmp_path: Path) -> None:
    """Only the last frame is near: it is named alone, at its first card."""
    job = wgs84_film.film(33.08, -106.33, decimals=3)[0]
    path = job.trajectory.position_ft.copy()
    path[-1, 2] = 12000.0
    trajectory = replace(job.trajectory, position_ft=path, altitude_ft=path[:, 2].copy())
    text = said(replace(job, trajectory=trajectory), tmp_path)
    assert " degrees in frame 12: " in text


def test_landmarks_that_are_ignored_do_not_count(tmp_path: Path) -> None:
    job = low()
    dropped = replace(
        job.ignored,
        frame=job.readings.frame.copy(),
        landmark=np.tile([100, 0, 0, 0, 0, 0], (len(job.readings.frame), 1)),
    )
    assert said(replace(job, ignored=dropped), tmp_path) == ""


def test_strict_counts_it_as_a_warning(tmp_path: Path) -> None:
    deck = tmp_path / "low.dat"
    deck.write_text(write_deck([low()]))
    assert vopd("check", "--strict", "-q", deck).status == 3
    assert "1974" not in vopd("check", CASE_1).stdout
