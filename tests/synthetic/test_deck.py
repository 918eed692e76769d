"""The deck that `vopd demo` writes, by its columns."""

from __future__ import annotations

import io
import re

import numpy as np
import pytest

from tests.kit.cards import cut
from tests.tolerances import assert_close
from vopd.cards.read import read_jobs
from vopd.cards.write import write_deck
from vopd.findings import Finding
from vopd.program.vopd import run
from vopd.synthetic import Plan
from vopd.synthetic.flight import make, truth_csv

PLANS = [
    Plan(),
    Plan(frames=1, landmarks=2, seed=5, trajectory_rows=2),
    Plan(frames=40, landmarks=17, seed=6, noise_in=0.0, focal_length_mm=8.0),
    Plan(frames=200, landmarks=6, seed=7, swing_deg=45.0, frame_in=(12.0, 9.0)),
    Plan(frames=9, jobs=7, seed=8),
]
"""Small decks of many shapes; together they set every option."""

CARD = re.compile(
    r"""(?x) ([14]) [0-9 ]{7} (\d\d) [0-9]  [0-9 ] (0[123]) \d{5}   # columns 1 to 19
    [ ]{21} ([ -]\d{6}) [ ]{3} ([ -]\d{6}) [ ]{6} (\d{4})           # columns 20 to 67"""
)


def deck(plan: Plan) -> str:
    return write_deck(make(plan)[0])


@pytest.mark.parametrize("plan", PLANS)
def test_the_same_plan_makes_the_same_deck_and_truth(plan: Plan) -> None:
    assert deck(plan) == deck(plan)
    assert truth_csv(make(plan)[1]) == truth_csv(make(plan)[1])


def test_another_seed_is_another_flight() -> None:
    one, other = (cut(deck(Plan(seed=seed))) for seed in (1, 2))
    assert one.trajectory != other.trajectory
    assert one.wind != other.wind
    assert one.origin[4:] != other.origin[4:]
    assert one.landmarks != other.landmarks


@pytest.mark.parametrize("plan", PLANS)
def test_the_deck_reads_and_runs_without_a_finding(plan: Plan) -> None:
    found: list[Finding] = []
    limits = plan.landmarks <= 6  # of 1974
    file = io.BytesIO(deck(plan).encode("ascii"))
    jobs = list(read_jobs(file, "demo", found.append, limits_1974=limits))
    assert (len(jobs), found) == (plan.jobs, [])
    for job in jobs:
        results = run(job)
        assert results.converged.all() and results.solved.all()
        flags = (results.outside_clock, results.outside_trajectory, results.outside_wind)
        assert not np.any([*flags, results.singular, results.at_centre.any(axis=1)])


@pytest.mark.parametrize("plan", [plan for plan in PLANS if plan.jobs == 1])
def test_cards_and_columns(plan: Plan) -> None:
    text = cut(deck(plan))
    points = 4 + plan.landmarks
    fields = [CARD.fullmatch(card) for card in text.basic_data]
    kind, number, reading, x, y, frame = np.array([f.groups() for f in fields if f]).T
    assert len(kind) == len(text.basic_data) == plan.frames * points * 3

    shape = plan.frames, points, 3
    assert (reading.reshape(shape) == ["01", "02", "03"]).all()
    assert (kind.reshape(shape)[:, :4] == "1").all() and (kind.reshape(shape)[:, 4:] == "4").all()
    numbers = number.astype(int).reshape(shape)
    assert (numbers[:, :4] == 0).all() and (numbers == numbers[:, :, :1]).all()
    for of_frame in numbers[:, 4:, 0]:
        assert len(set(of_frame)) == plan.landmarks
    assert set(numbers[:, 4:].ravel()) == set(text.landmarks) == {*range(1, numbers.max() + 1)}
    expected = 1 + np.arange(plan.frames)
    assert (frame.astype(int).reshape(shape) == expected[:, None, None]).all()

    place = np.stack([x, y], axis=1).astype(float).reshape(*shape, 2) / 1000.0
    near = 6.0 * plan.noise_in  # no reading of these is further off
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]) * plan.frame_in
    assert np.abs(place[:, :4] - corners[:, None]).max() <= near
    assert (place[:, 4:] > -near).all() and (place[:, 4:] < plan.frame_in + np.array(near)).all()


def test_a_long_deck_has_the_cards_that_it_should() -> None:
    """25 lens, 1 title, 1, 10 wind, ceil(203/16) = 13, 2, 30, 1, 5 landmarks, 1, 1, 200 x 18."""
    plan = Plan(frames=200, landmarks=2, trajectory_rows=30)
    text = cut(deck(plan))
    assert text.cards == 25 + 1 + 1 + 10 + 13 + 2 + 30 + 1 + len(text.landmarks) + 1 + 1 + 3600


@pytest.mark.parametrize("plan", [plan for plan in PLANS if plan.jobs == 1])
def test_the_truth_is_that_of_the_deck(plan: Plan) -> None:
    """Times and positions on straight lines between the cards; groups 3 and 8 as in case 1."""
    text = cut(deck(plan))
    header, *lines = truth_csv(make(plan)[1]).splitlines()
    assert header == (
        "frame,time_s,camera_yaw_deg,camera_pitch_deg,camera_roll_deg,"
        "vehicle_yaw_deg,vehicle_pitch_deg,vehicle_roll_deg,east_ft,north_ft,up_ft"
    )
    truth = np.array([[float(part) for part in line.split(",")] for line in lines])
    assert truth[:, 0].tolist() == list(range(1, plan.frames + 1))
    (frame_0, time_0), (frame_1, time_1) = text.clock
    slope = (time_1 - time_0) / (frame_1 - frame_0)
    assert_close("demo time", truth[:, 1], time_0 + slope * (truth[:, 0] - frame_0))
    table = np.array(text.trajectory)
    for column in (1, 2, 3):
        where = np.interp(truth[:, 1], table[:, 0], table[:, column])
        assert_close("demo position", truth[:, 7 + column], where)
    yaw, pitch, roll = truth[:, 2:5].T
    assert_close("demo angle", truth[:, 5], yaw)
    assert_close("demo angle", truth[:, 6], pitch)
    assert_close("demo angle", truth[:, 7], (roll - 210.0) % 360.0)
    away = (truth[:, 2:5] - text.origin[4:7] + 180.0) % 360.0 - 180.0
    swing = plan.swing_deg * np.array([1.0, 0.6, 0.8])
    assert (np.abs(away) <= swing + 0.5).all()  # the estimate is in whole degrees
