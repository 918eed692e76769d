"""The rule about the Earth of 1974: its angle, its limit, its sentence."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.approved.texts import assert_approved
from tests.kit import wgs84_film
from tests.kit.command import CASE_1, vopd
from tests.kit.jobs import case, film, reread
from tests.kit.wgs84_film import camera_matrix
from tests.tolerances import within
from vopd import check as earth_rule
from vopd.cards.write import write_deck
from vopd.check import LIMIT_DEG, check_deck, earth_cost
from vopd.job import Job
from vopd.pipeline import run

# `vopd check` on decks for which the Earth of 1974 is too coarse, by numbers worked by hand


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
    angle_deg, shift_m, distance_km = earth_cost(low(LOW, latitude))
    assert abs(shift_m[0] / shifted_m(latitude) - 1.0) < within("share of the Earth's cost")
    by_hand = np.degrees(shifted_m(latitude) / (1000.0 * distance_km[0]))
    assert abs(angle_deg[0] / by_hand - 1.0) < 2 * within("share of the Earth's cost")
    assert 0.11 < distance_km[0] < 0.12


@pytest.mark.parametrize("place", wgs84_film.PLACES)
def test_it_is_what_a_run_is_wrong_by(place: tuple[float, float]) -> None:
    """The rotation from the solved to the true attitude; landmarks weigh a little otherwise."""
    job, truth = wgs84_film.film(*place, decimals=None)
    solved = run(job).camera_deg
    errors = [
        Rotation.from_matrix(camera_matrix(*t) @ camera_matrix(*s).T).magnitude()
        for t, s in zip(truth, solved, strict=True)
    ]
    off = np.abs(earth_cost(job)[0] - np.degrees(errors))
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
    assert_approved(text)
    assert text.count("--fix earth") == 1 and "warning: " in text and "basic data" in text
    for fix, told in ((), True), (("--fix", "earth"), False):
        assert ("1974 turns" in vopd("run", *fix, tmp_path / "deck.dat").stderr) == told


def test_a_flight_like_the_report_s_is_not(tmp_path: Path) -> None:
    for job in (case(1), case(4), low(1.0)):
        assert said(job, tmp_path) == ""
        assert np.nanmax(earth_cost(job)[0]) < LIMIT_DEG / 1.5


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


@pytest.mark.parametrize("ascends", [True, False])
def test_each_of_stacked_jobs_is_told_at_its_own_card(ascends: bool) -> None:
    """Whose basic data are read again; and the second too where the first cannot be run."""
    job = low()
    path = job.trajectory
    first = path if ascends else replace(path, time_s=path.time_s[::-1].copy())
    jobs = [
        replace(job, return_group=1, trajectory=first),
        replace(low(1.1 * LOW), title=job.title),
    ]
    found = check_deck(io.BytesIO(write_deck(jobs).encode()), "a.dat")
    cards = [one.card or 0 for one in found if "1974" in one.message]
    behind = write_deck(jobs[1]).count("\n")  # the second job's cards, at the end of the deck
    last = write_deck(jobs).count("\n")
    assert [one <= last - behind for one in cards] == ([True, False] if ascends else [False])


def test_strict_counts_it_as_a_warning(tmp_path: Path) -> None:
    deck = tmp_path / "low.dat"
    deck.write_text(write_deck([low()]))
    assert vopd("check", "--strict", "-q", deck).status == 3
    assert "1974" not in vopd("check", CASE_1).stdout


# What is said of the Earth of 1974: the limit, the frame, the numbers and their decimals


NONE, INF = np.nan, np.inf
COSTS: dict[tuple[float, ...], tuple[int, str] | None] = {  # degrees by frame: frame and words
    (0.1, 0.0999, 0.0): None,
    (NONE, NONE, NONE): None,
    (INF, 0.05, NONE): None,
    (0.0, 0.1001, 0.05): (2, "0.10 degrees in frame 2: "),
    (0.2, 0.0, 0.3): (3, "0.30 degrees in 2 frames, most of all in frame 3: "),
    (0.456, 0.2, 0.3): (1, "0.46 degrees in 3 frames, most of all in frame 1: "),
    (INF, NONE, 0.2): (3, "0.20 degrees in frame 3: "),
    (1.234, INF, 0.2): (1, "1.23 degrees in 2 frames, most of all in frame 1: "),
}


@pytest.mark.parametrize("angles", COSTS)
def test_the_sentence(angles: tuple[float, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    """The frame that costs most is named, with its own shift and distance, at its first card."""
    cost = np.array(angles), np.array([11.16, 22.26, 33.36]), np.array([1.114, 2.225, 3.336])
    monkeypatch.setattr(earth_rule, "earth_cost", lambda _: cost)
    deck = write_deck([film_of_thousandths(3)])
    found = check_deck(io.BytesIO(deck.encode()), "a.dat")
    told = [one for one in found if "Earth of 1974" in one.message]
    expected = COSTS[angles]
    if expected is None:
        assert told == []
        return
    frame, _words = expected
    (one,) = told
    assert_approved(one.message)
    first = len(deck.splitlines()) - 3 * 27 + 1
    assert (one.card, one.group, one.severity) == (first + 27 * (frame - 1), 0, "warning")
    assert one.columns is None


def film_of_thousandths(frames: int) -> Job:
    """A film of five landmarks, 27 cards a frame, as cards can hold it."""
    job = film(frames)
    readings, camera = job.readings, job.camera
    tables = {
        name: getattr(camera, name).round(4) for name in ("lens_radius_mm", "lens_distortion_um")
    }
    points = {name: getattr(readings, name).round(3) for name in ("landmark_in", "fiducial_in")}
    return replace(job, readings=reread(readings, **points), camera=replace(camera, **tables))


@pytest.mark.parametrize("out", range(5))
def test_only_landmarks_that_take_part_count(out: int) -> None:
    """An ignored landmark may be anywhere; the averages are over the four others."""
    job = film(2)
    asked = np.zeros(5, np.int64)
    asked[0] = 11 + out
    fewer = replace(job, ignored=replace(job.ignored, everywhere=asked))
    marks = replace(job.landmarks, altitude_ft=job.landmarks.altitude_ft.copy())
    marks.altitude_ft[out] += 50000.0
    moved = earth_cost(replace(fewer, landmarks=marks))
    for one, other in zip(earth_cost(fewer), moved, strict=True):
        np.testing.assert_array_equal(one, other)
    km = np.array([np.linalg.norm(at - path) for at in ground_km(job) for path in path_km(job)])
    distances = km.reshape(5, 2)[np.arange(5) != out].mean(axis=0)
    assert np.abs(moved[2] / distances - 1.0).max() < within("share of the Earth's cost")


def ground_km(job: Job) -> np.ndarray:
    """Landmarks on a plane at the origin, km east, north, up."""
    m = job.landmarks
    path = job.trajectory
    east = m.longitude_deg + m.longitude_min / 60.0 - path.origin_longitude_deg
    north = m.latitude_deg + m.latitude_min / 60.0 - path.origin_latitude_deg
    across = 111.32 * np.cos(np.radians(path.origin_latitude_deg))
    return np.column_stack([across * east, 110.9 * north, m.altitude_ft * FOOT_KM])


FOOT_KM = 0.3048e-3


def path_km(job: Job) -> np.ndarray:
    return job.trajectory.position_ft[:2] * FOOT_KM
