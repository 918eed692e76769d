"""Coordinates of a feature: hidden ones are found again, by the joint solution and by trials."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import click
import numpy as np
import pytest
from scipy.special import chdtri

import vopd
from tests.approved.texts import assert_approved, refused
from tests.kit.command import DECKS, ROOT
from tests.kit.command import vopd as vopd_run
from tests.kit.simulated_films import SPHERE_1974, WGS84, Earth, Errors, Plan, job_of, simulate
from tests.tolerances import within
from vopd.arrays import Floats
from vopd.cli.adjust_deck import landmark_number
from vopd.convert import feature_trials
from vopd.convert.deck_to_flight import deck_flight
from vopd.convert.feature import (
    STEP,
    coordinates_of,
    deck_with_landmark,
    locate_feature,
    place_m,
    with_coordinates,
)
from vopd.convert.feature_trials import FeatureTrials, search_feature
from vopd.errata import NO_FIXES, Fixes, fixes
from vopd.findings import VopdError
from vopd.flight.adjust import tested
from vopd.flight.adjust.adjustment import adjust
from vopd.flight.coordinates import coordinates_at
from vopd.flight.misfits.leave_out import PICK
from vopd.job import Job
from vopd.synthetic import Plan as DemoPlan
from vopd.synthetic.flight import make

ALL = fixes("all")
FEET = np.array([364567.0, 305000.0, 1.0])  # of a degree of latitude, of longitude at 33 deg
OFF = np.array([0.15 / 60.0, -0.2 / 60.0, 400.0])  # 900 ft north, 1,000 west, 400 up


def film(earth: Earth, noise_in: float, seed: int, count: int = 1) -> list[Job]:
    """Every tenth frame of 40 seconds, of five landmarks; the camera flies 20,000 ft or more."""
    plan = Plan(
        Errors(reading_in=noise_in), landmarks=5, jobs=count, frames=160,
        decimals=3 if noise_in else None, earth=earth, acceleration_ft_s2=1.0,
    )  # fmt: skip
    films = simulate(plan, seed)
    jobs = [replace(job_of(films, k), return_group=13) for k in range(count)]
    return [replace(job, readings=job.readings.take(np.arange(5, 160, 10))) for job in jobs]


def hidden(job: Job, number: int) -> tuple[Job, Floats]:
    """The job with the landmark elsewhere, and where it is."""
    truth = coordinates_of(job, number)
    return with_coordinates(job, number, truth + OFF), truth


EARTHS = pytest.mark.parametrize(("earth", "chosen"), [(WGS84, ALL), (SPHERE_1974, NO_FIXES)])


def joint(job: Job, number: int, chosen: Fixes) -> tuple[Floats, Floats]:
    """Coordinates by the joint solution, and their covariance."""
    made = locate_feature(job, number, chosen, "film.dat").adjustment
    return np.array([one.after for one in made.parameters]), made.covariance


@EARTHS
def test_both_find_the_feature_of_a_film_without_noise(earth: Earth, chosen: Fixes) -> None:
    for drawn in film(earth, 0.0, 5, 3):
        job, truth = hidden(drawn, 12)
        after, _ = joint(job, 12, chosen)
        trials = search_feature(job, 12, chosen, "film.dat")
        assert trials.stands
        assert (np.abs(trials.coordinates - after) < trials.last_step).all()
        for found in (after, trials.coordinates):
            assert (np.abs(found - truth) * FEET).max() < within("feature without noise")


@EARTHS
def test_both_find_the_feature_of_a_noisy_film(earth: Earth, chosen: Fixes) -> None:
    """Trials within half a standard deviation of the joint solution, that within its own region."""
    for drawn in film(earth, 0.003, 6, 6):
        job, truth = hidden(drawn, 14)
        after, covariance = joint(job, 14, chosen)
        trials = search_feature(job, 14, chosen, "film.dat")
        assert (np.abs(trials.coordinates - after) < 0.5 * np.sqrt(np.diag(covariance))).all()
        off = after - truth
        assert off @ np.linalg.solve(covariance, off) < chdtri(3, 0.001)


def test_the_region_of_the_joint_solution_holds_the_truth() -> None:
    """Its chi-square over 25 films is 75, as three coordinates of each have it."""
    total, jobs = 0.0, film(WGS84, 0.003, 7, 25)
    for job in jobs:
        after, covariance = joint(job, 11, ALL)
        off = after - coordinates_of(job, 11)
        total += off @ np.linalg.solve(covariance, off)
    assert chdtri(3 * len(jobs), 0.9995) < total < chdtri(3 * len(jobs), 0.0005)


def test_the_hidden_feature_of_a_demo_is_found() -> None:
    """24 of 1,200 frames of its film, by the program as it was; readings to .001 in."""
    (demo,) = make(DemoPlan(frames=1200, landmarks=6, noise_in=0.0, seed=3))[0]
    demo = replace(demo, readings=demo.readings.take(np.arange(0, 1200, 50)), return_group=13)
    number = int(np.bincount(demo.readings.points.landmark).argmax())
    job, truth = hidden(demo, number)
    after, covariance = joint(job, number, NO_FIXES)
    trials = search_feature(job, number, NO_FIXES)
    assert trials.stands
    assert (np.abs(trials.coordinates - after) < 0.5 * np.sqrt(np.diag(covariance))).all()
    assert (np.abs(after - truth) < 4.0 * np.sqrt(np.diag(covariance))).all()


# The stacked deck


@cache
def searched() -> tuple[Job, FeatureTrials]:
    job, _ = hidden(film(SPHERE_1974, 0.003, 8)[0], 13)
    return job, search_feature(job, 13, NO_FIXES)


def test_the_stack_is_a_deck_whose_run_has_the_differences(tmp_path: Path) -> None:
    """The first job has the known landmarks alone, each other one the feature where it is said."""
    _, trials = searched()
    deck = tmp_path / "stack.dat"
    deck.write_text(vopd.write_deck(trials.jobs))
    jobs = vopd.run(vopd.read_deck(deck))
    assert len(jobs) == len(trials.jobs) == len(trials.trials)
    assert [one.job.return_group for one in jobs] == [9] * (len(jobs) - 1) + [13]
    known = jobs[0]
    assert not known.points.used[known.points.landmark == 13].any()
    for one, trial in zip(jobs[1:], trials.trials[1:], strict=True):
        assert one.points.used.all()
        at = coordinates_of(replace(one.job, landmarks=one.job.landmarks), 13)
        assert (at == trial.coordinates).all()
        turned = (one.vehicle_deg - known.vehicle_deg + 180.0) % 360.0 - 180.0
        rms = np.sqrt((turned**2).mean(axis=0))
        assert np.abs(rms - trial.difference_deg).max() < within("solved angle")


def test_differences_across_north_are_those_elsewhere() -> None:
    """The vehicle turned so that it looks north in the first frame with the known landmarks."""
    job, trials = searched()
    (known,) = vopd.run(trials.jobs[0]).vehicle_deg[:1, :1].tolist()
    offset = job.camera.offset_deg - np.array([*known, 0.0, 0.0])
    north = search_feature(
        replace(job, camera=replace(job.camera, offset_deg=offset)), 13, NO_FIXES
    )
    for one, other in zip(north.trials[1:], trials.trials[1:], strict=True):
        assert np.abs(one.difference_deg - other.difference_deg).max() < within("solved angle")


def test_what_keeps_trials_from_an_end_is_said() -> None:
    """Times of the trajectory that descend; and a card whose landmark is far from the readings."""
    job, _ = searched()
    time_s = job.trajectory.time_s.copy()
    time_s[2] = time_s[0]
    back = replace(job, trajectory=replace(job.trajectory, time_s=time_s))
    with refused(VopdError):
        search_feature(back, 13, NO_FIXES, "deck")
    far = with_coordinates(job, 13, coordinates_of(job, 13) + np.array([5.0, 5.0, 0.0]))
    with refused(VopdError):
        search_feature(far, 13, NO_FIXES, "deck")


def test_trials_that_do_not_come_to_rest_are_told_with_status_3(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The table has what there is; the sentence says what to do instead."""
    monkeypatch.setattr(feature_trials, "MOST_ROUNDS", 1)
    feature = ROOT / "tests" / "approved" / "inputs" / "feature.dat"
    monkeypatch.chdir(feature.parent)
    options = ("adjust", "feature.dat", "--free", "landmark:13", "--trials", "--format", "json")
    ran = vopd_run(*options)
    assert ran.status == 3 and json.loads(ran.stdout)["stands"] is False
    assert_approved(ran.stderr)


@pytest.mark.parametrize(("part", "held"), [(0.03, True), (0.001, False)])
def test_a_camera_that_hardly_moves_does_not_locate_a_landmark(
    part: float, held: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It flies 920 ft, or 31, and the landmark is 132,000 ft away.

    A reading, .003 in on the film reader or .0021 mm before 10.4 mm, is 27 ft there. Along the
    line that is 27 times 132,000 by what is flown: 3,900 ft, or 115,000, more than half of the way.
    """
    monkeypatch.setattr(feature_trials, "MOST_ROUNDS", 1)
    job = film(WGS84, 0.003, 9)[0]
    job = replace(job, readings=job.readings.take(np.array([0, 5, 10, 15])))
    middle = job.trajectory.position_ft.mean(axis=0)
    position_ft = middle + part * (job.trajectory.position_ft - middle)
    near = replace(job, trajectory=replace(job.trajectory, position_ft=position_ft))
    if held:
        assert not search_feature(near, 12, ALL, "film.dat").stands
    else:
        with refused(VopdError):
            search_feature(near, 12, ALL, "film.dat")


def test_trials_as_json_are_those_of_the_csv(tmp_path: Path) -> None:
    feature = ROOT / "tests" / "approved" / "inputs" / "feature.dat"
    options = ("adjust", feature, "--free", "landmark:13", "--trials", "-q")
    as_csv = [*csv.DictReader(vopd_run(*options, "--format", "csv").stdout.splitlines())]
    ran = vopd_run(*options, "--format", "json")
    found = json.loads(ran.stdout)
    assert ran.status == 0 and found["stands"] is True
    rows = [{k: "" if v is None else v for k, v in one.items()} for one in found["trials"]]
    assert [one.pop("best") for one in rows] == [one.pop("best") == "yes" for one in as_csv]
    assert [[str(v) for v in one.values()] for one in rows] == [[*one.values()] for one in as_csv]
    best = rows[-1]
    assert best["varied"] == "found"
    scale = {"latitude_deg": 60.0, "longitude_deg": 60.0, "altitude_ft": 1e-4}
    rounding = [abs(found[name] - best[name]) * size for name, size in scale.items()]
    assert max(rounding) < within("coordinates on cards")


def test_a_search_is_rounds_of_latitudes_longitudes_altitudes() -> None:
    """Nine trials a series, one coordinate moved by even steps; the best one is marked."""
    _, found = searched()
    first = found.trials[0]
    assert (first.job, first.varied, first.best) == (1, "known landmarks", False)
    assert found.trials[-1].varied == "found"
    rounding = np.abs(found.trials[-1].coordinates - found.coordinates)
    assert (rounding * [60.0, 60.0, 1e-4]).max() < within("coordinates on cards")
    rows = found.trials[1:-1]
    for k, name in enumerate(("latitude", "longitude", "altitude")):
        series = [one for one in rows if one.round == 1 and one.varied == name]
        assert len(series) % 9 == 0
        last = series[-9:]
        assert sum(one.best for one in last) == 1 and not last[0].best and not last[-1].best
        assert min(last, key=lambda one: one.apart_in).best
        steps = np.diff([one.coordinates for one in last], axis=0)
        off = np.abs(steps * [60.0, 60.0, 1e-4] - np.eye(3)[k] * [0.1, 0.1, 0.05])
        assert off.max() < 2.0 * within("coordinates on cards")
    assert [one.job for one in found.trials] == list(range(1, len(found.trials) + 1))


# The card of the landmark


def test_only_the_card_of_the_landmark_changes() -> None:
    content = (DECKS / "appendix_h" / "case1.dat").read_bytes()
    (job,) = vopd.read_deck(DECKS / "appendix_h" / "case1.dat")
    moved = with_coordinates(job, 66, np.array([32.8383333, -106.0, 12345.678]))
    card = b"        66     -106.     -32.7       32.       50.    10000."
    numbered = content.replace(card, card + b"            00000059")
    before = content.replace(b"\n", b"\r\n")
    for old, end in ((content, b"\n"), (before, b"\r\n"), (numbered, b"\n")):
        new = deck_with_landmark(old, "case1.dat", moved, 66)
        lines = list(zip(old.split(end), new.split(end), strict=True))
        (pair,) = [(a, b) for a, b in lines if a != b]
        moved_card = b"        66     -106.        0.       32.      50.3   12345.7"
        assert pair[0].startswith(card) and pair[1] == moved_card + pair[0][60:]
    latitude, longitude, altitude = coordinates_of(moved, 66)
    assert (longitude, altitude) == (-106.0, 12345.7)
    assert abs(latitude - 32.8383333) * 60.0 < within("coordinates on cards")


@pytest.mark.parametrize(
    ("longitude", "degrees", "minutes"),
    [
        (-106.9999999, -106.0, -59.99999),
        (-107.0, -107.0, 0.0),
        (-105.5, -106.0, 30.0),
        (-104.25, -104.0, -15.0),
        (-106.99999999, -107.0, 0.0),
    ],
)
def test_minutes_stay_below_sixty(longitude: float, degrees: float, minutes: float) -> None:
    (job,) = vopd.read_deck(DECKS / "appendix_h" / "case1.dat")
    marks = with_coordinates(job, 66, np.array([32.5, longitude, 100.0])).landmarks
    assert (marks.longitude_deg[1], marks.longitude_min[1]) == (degrees, minutes)
    assert (marks.latitude_deg[1], marks.latitude_min[1]) == (32.0, 30.0)


@EARTHS
def test_coordinates_of_a_position_and_back(earth: Earth, chosen: Fixes) -> None:
    """The position by the Earths of the films, which are apart from the package."""
    there = np.array([33.1, -106.4, 5432.1])
    position = earth.place(*there[:, None])[0]
    found = coordinates_at(
        position[None], (there + OFF)[None], lambda at: place_m(at, chosen), STEP.tolist()
    )[0]
    assert (np.abs(found - there) * FEET).max() < within("feature without noise")
    assert np.abs(place_m(found[None], chosen)[0] - position).max() < within("flight position")


NAMES = (
    (), ("landmarks",), ("focal",), ("landmark:13", "focal"), ("landmark:13", "landmark:14"),
    ("landmark:",), ("landmark:mast",), ("landmark:\u0663",), ("landmark:1234567890",),
)  # fmt: skip


@pytest.mark.parametrize("names", NAMES)
def test_of_a_deck_one_landmark_is_free_by_its_number(names: tuple[str, ...]) -> None:
    with pytest.raises(click.UsageError) as error:
        landmark_number(names)
    assert_approved(error.value.message)
    assert landmark_number(("landmark:123456789",)) == 123456789


# What cannot be located


def case1() -> Job:
    (job,) = vopd.read_deck(DECKS / "appendix_h" / "case1.dat")
    return job


def one_frame(job: Job) -> Job:
    return replace(job, readings=job.readings.take(np.array([0])))


def ignored(job: Job, *numbers: int) -> Job:
    everywhere = np.zeros_like(job.ignored.everywhere)
    everywhere[: len(numbers)] = numbers
    return replace(job, ignored=replace(job.ignored, everywhere=everywhere))


def twice(job: Job) -> Job:
    marks = job.landmarks
    rows = np.append(np.arange(len(marks.number)), 1)
    columns = {name: getattr(marks, name)[rows] for name in vars(marks)}
    return replace(job, landmarks=replace(marks, **columns))


def test_what_cannot_be_located_says_what_to_do() -> None:
    job = film(WGS84, 0.003, 9)[0]
    still = np.tile(job.trajectory.position_ft[:1], (len(job.trajectory.time_s), 1))
    unread = replace(job, readings=job.readings.take(np.arange(0)))
    for wrong, number in (
        (job, 99),
        (twice(job), 12),
        (unread, 12),
        (one_frame(job), 12),
        (ignored(job, 11, 13, 14, 15), 12),
        (replace(job, trajectory=replace(job.trajectory, position_ft=still)), 12),
        (with_coordinates(job, 12, coordinates_of(job, 12) * [1.0, 1.0, 1000.0]), 12),  # in space
        (with_coordinates(job, 12, np.array([90.0, -106.0, 0.0])), 12),
        (with_coordinates(job, 12, np.array([-90.0, -106.0, 0.0])), 12),
    ):
        with refused(VopdError):
            locate_feature(wrong, number, ALL, "film.dat")
        with refused(VopdError):
            search_feature(wrong, number, ALL, "film.dat")


def test_a_landmark_without_an_image_is_predicted_by_no_others() -> None:
    """Its latitude is south: it lies behind the camera that the other three landmarks tell."""
    (job,) = make(DemoPlan(frames=12, landmarks=4, noise_in=0.001, seed=7, earth="wgs84"))[0]
    south = coordinates_of(job, 2) * [-1.0, 1.0, 1.0]
    flight = deck_flight(with_coordinates(job, 2, south), NO_FIXES)
    tests = tested.tested_flight(adjust(flight, []).result).tests
    predicted = [flight.landmarks.name[k] for k in tests.landmark[tests.kind == PICK]]
    assert set(predicted) == {"1", "3", "4"}


def test_one_frame_holds_a_landmark_across_its_line_of_sight_alone() -> None:
    """What is stated stays along it, and the note says so."""
    job = film(WGS84, 0.003, 9)[0]
    found = locate_feature(one_frame(job), 12, ALL, "film.dat", 1000.0)
    assert 950.0 < found.sigma_ft[0] < 1000.1
    assert found.sigma_ft[1] < 100.0
    assert not any(one.held for one in found.adjustment.parameters)
    assert_approved(found.notes)


@pytest.mark.parametrize(("away_m", "is_held"), [(1000.0, True), (800.0, False)])
def test_a_feature_is_held_by_its_mean_distance(
    away_m: float, is_held: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of four cameras in a line, at which a reading leaves it free by 450 m."""
    camera_m = np.array([[away_m * one, 0.0, 0.0] for one in (0.5, 1.5, 0.75, 1.25)])
    focal_mm = 100.0
    slope = feature_trials.READING_IN * feature_trials.factor / focal_mm / 450.0
    monkeypatch.setattr(
        feature_trials, "earth_fixed", lambda *_: camera_m / feature_trials.M_PER_KM
    )
    monkeypatch.setattr(feature_trials, "origin_of", lambda _: None)
    monkeypatch.setattr(feature_trials, "place_m", lambda *_: np.zeros((1, 3)))
    monkeypatch.setattr(feature_trials, "by_position", lambda *_: np.eye(3))
    search: Any = SimpleNamespace(
        _known=SimpleNamespace(job=None, vehicle_ft=None), _compared=np.ones(4, bool), _fixes=None,
        _slopes=np.diag([3.0, 2.0, 1.0]) * slope, _name="a.dat", _number=7,
        _job=SimpleNamespace(camera=SimpleNamespace(focal_length_mm=focal_mm)),
    )  # fmt: skip
    if is_held:
        feature_trials._Search.check_held(search, np.zeros(3))
    else:
        with refused(VopdError):
            feature_trials._Search.check_held(search, np.zeros(3))
