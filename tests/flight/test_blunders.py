"""Blunders of a flight: picks that do not fit, landmarks with wrong coordinates, what is said."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit.flight_project import EAST_NORTH_UP, FRAMES, MARKS, truth_deg, write_project
from tests.kit.joint_flights import drone, flight_of
from tests.tolerances import assert_close, within
from vopd.arrays import Bools
from vopd.attitude.residuals import equations_of
from vopd.flight.estimate import FlightEstimates
from vopd.flight.flight import Flight, TrackFixes
from vopd.flight.misfits import blunders, misfit, mistakes
from vopd.flight.misfits.blunders import (
    WRONG,
    Blunders,
    _together,
    blunder_findings,
    find_blunders,
    gross_picks,
)
from vopd.flight.project.read import read_flight
from vopd.flight.result import FlightResult, solve_flight_read
from vopd.flight.settled import settled
from vopd.flight.solve.equations import Priors
from vopd.flight.solve.rotations import solve

COUNT = len(MARKS)  # picks of a frame; pick COUNT * f + n is of frame f and landmark n
TOWER = MARKS.index("tower")


@pytest.fixture
def flight(tmp_path: Path) -> Flight:
    """Five frames of six landmarks, picked within .3 px, which are stated as 1 px or less."""
    return read_flight(str(write_project(tmp_path, noise_px=0.3)))


def picked(flight: Flight, away_px: dict[int, tuple[float, float]]) -> Flight:
    """The flight with some picks away from where they were."""
    pixel = flight.picks.pixel.copy()
    for pick, away in away_px.items():
        pixel[pick] += away
    return replace(flight, picks=replace(flight.picks, pixel=pixel))


def dropping(flight: Flight) -> Flight:
    return replace(flight, options=replace(flight.options, drop_blunders=True))


def moved(flight: Flight, mark: int, east_north_up_m: tuple[float, float, float]) -> Flight:
    """The flight with other coordinates of a landmark."""
    marks = flight.landmarks
    position = marks.position_m.copy()
    position[mark] += np.array(east_north_up_m) @ marks.axes[mark]
    return replace(flight, landmarks=replace(marks, position_m=position))


def messages(result: FlightResult) -> list[str]:
    return [one.message for one in result.findings]


def outliers(result: FlightResult) -> list[str]:
    return result.history().flags.detail["outlier"]


GROSS = {6: (40.0, 30.0), 8: (-25.0, 60.0), 22: (0.0, -1000.0)}
"""Two picks of frame 1, one of frame 3."""


def test_several_blunders_of_a_frame_are_named_and_flagged(flight: Flight) -> None:
    result = solve_flight_read(picked(flight, GROSS))
    assert_approved(messages(result))
    assert outliers(result) == ["", "church+bridge", "", "tower", ""]
    assert result.estimate.used.all()


def test_blunders_that_are_dropped_leave_the_other_picks(flight: Flight) -> None:
    """None is said to be used, and none is left to be found."""
    result = solve_flight_read(dropping(picked(flight, GROSS)))
    assert_approved(messages(result))
    assert outliers(result) == [""] * FRAMES
    assert np.flatnonzero(~result.estimate.used.ravel()).tolist() == sorted(GROSS)
    clean = solve_flight_read(flight)
    truth = truth_deg() % 360.0 - [0, 360, 0]
    for one in (clean, result):
        assert np.abs(one.camera_deg - truth).max() < within("angle of an example")
    assert messages(clean) == []


def test_a_gross_pick_turns_its_own_frame_alone(flight: Flight) -> None:
    """Positions and landmarks that are solved for stay where the other picks have them."""
    fixes = TrackFixes(np.arange(FRAMES), np.ones((FRAMES, 1)), np.full((FRAMES, 3), 2.0))
    path = replace(flight.path, fixes=fixes)
    marks = replace(flight.landmarks, sigma_m=np.full((COUNT, 3), 0.1))
    wrong = picked(replace(flight, path=path, landmarks=marks), {22: (0.0, -1000.0)})
    named, dropped = solve_flight_read(wrong), solve_flight_read(dropping(wrong))
    others = np.arange(FRAMES) != 3
    assert_close("table value", named.camera_deg[others], dropped.camera_deg[others])
    assert np.abs(named.camera_deg[3] - dropped.camera_deg[3]).max() > 1.0
    for one in (named, dropped):
        assert one.estimates.joint is not None and not one.misfits
    landmarks = [one.estimates.joint.state.landmark_m for one in (named, dropped)]
    assert_close("table value", *landmarks)
    assert named.history().flags.raised["misfit"].tolist() == [False, False, False, True, False]


@pytest.mark.parametrize(("more", "misfits"), [({}, False), ({28: (60.0, -40.0)}, True)])
def test_up_to_a_tenth_of_the_picks_are_blunders_of_a_flight_that_fits(
    more: dict[int, tuple[float, float]], misfits: bool, flight: Flight
) -> None:
    """Three of 30 picks are named and the others fit; with a fourth the flight misfits."""
    result = solve_flight_read(picked(flight, GROSS | more))
    assert result.misfits == misfits


@pytest.mark.parametrize("wrong_m", [0.0, 30.0])
def test_a_last_frame_of_a_check_landmark_alone_costs_no_other(
    flight: Flight, wrong_m: float
) -> None:
    check = MARKS.index("corner")
    before = flight.picks
    kept = (before.frame < FRAMES - 1) | (before.landmark == check)
    own = {name: getattr(before, name)[kept] for name in ("frame", "landmark", "pixel", "sigma_px")}
    picks = replace(before, **own)
    marks = replace(flight.landmarks, used=tuple(k != check for k in range(COUNT)))
    one = moved(replace(flight, picks=picks, landmarks=marks), TOWER, (wrong_m, 0.0, 0.0))
    result = solve_flight_read(dropping(one))
    assert np.isnan(result.camera_deg[-1]).all()
    truth = truth_deg()[:-1] % 360.0 - [0, 360, 0]
    assert np.abs(result.camera_deg[:-1] - truth).max() < within("angle of an example")
    assert any("tower" in said for said in messages(result)) == (wrong_m > 0.0)


def test_what_else_is_tried_of_a_misfit_knows_whether_a_landmark_is_named(
    flight: Flight, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another reading of the files is then named in its place only if it explains everything."""
    named: list[bool] = []

    def usual(_: object, __: object, one: bool, ___: object) -> list[str]:
        named.append(one)
        return []

    monkeypatch.setattr(mistakes, "usual_mistakes", usual)
    nothing: Any = None
    noise_px = np.random.default_rng(1).normal(0.0, 20.0, (len(flight.picks.frame), 2))
    rough = replace(flight, picks=replace(flight.picks, pixel=flight.picks.pixel + noise_px))
    two = moved(moved(flight, TOWER, (0.0, 3.0, 0.0)), MARKS.index("mast"), (5.0, -3.0, 0.0))
    for one in (rough, two):
        assert solve_flight_read(one, project=lambda: nothing).misfits
    monkeypatch.setattr(misfit, "significant_errors", lambda *_: [])  # nothing but the landmark
    assert solve_flight_read(two, project=lambda: nothing).misfits
    assert named == [False, True, True]


def test_no_mistake_is_tried_twice_of_a_misfit(
    flight: Flight, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Exchanges are first, and when they explain nothing, what is left of the usual mistakes."""
    tried: list[str] = []

    def explanations(table: tuple[Any, ...], *_: object) -> list[Any]:
        tried.extend(one.name for one in table)
        return []

    monkeypatch.setattr(mistakes, "explanations", explanations)
    nothing: Any = None
    noise_px = np.random.default_rng(1).normal(0.0, 60.0, (len(flight.picks.frame), 2))
    rough = replace(flight, picks=replace(flight.picks, pixel=flight.picks.pixel + noise_px))
    assert solve_flight_read(rough, project=lambda: nothing).misfits
    every = (*mistakes.AXES_MISTAKES, *mistakes.USUAL_MISTAKES)
    assert {one.name for one in every} < {*tried} and len({*tried}) == len(tried)


def test_errors_that_frames_share_count_root_of_their_number_times() -> None:
    """Of the landmark that most picks show: nine of 9, and four of 16, that take part."""
    landmark, used = np.repeat([0, 1], [9, 16]), np.repeat([True, False], [13, 12])
    marks = SimpleNamespace(name=("a", "b"))
    flight = SimpleNamespace(landmarks=marks, picks=SimpleNamespace(landmark=landmark))
    estimates: Any = SimpleNamespace(flight=flight, solved=SimpleNamespace(used=used))
    reading: Any = SimpleNamespace(test_sigma=1.0)
    assert blunders._Displacements(estimates, reading)._alike == 3.0


@pytest.mark.parametrize(
    ("along", "right", "shift_m", "directions", "determined"),
    [
        (1.0, [-6.0, 0.0, 0.0], [6.0, 0.0, 0.0], 3, True),  # standard deviations of 1 m
        (1.0, [-4.9, 0.0, 0.0], [4.9, 0.0, 0.0], 3, False),
        (0.01, [-6.0, 0.0, -0.001], [6.0, 0.0, 0.1], 3, False),  # 10 m along the line of sight
        (1e-9, [-6e9, 0.0, -1.0], [6e9, 0.0, 0.0], 2, False),  # seen along one line
    ],
)
def test_a_shift_along_one_line_of_sight_is_not_told(
    along: float, right: list[float], shift_m: list[float], directions: int, determined: bool
) -> None:
    """Weights across are 1 a square metre; what is known a millionth as well is not known."""
    sums: Any = object.__new__(blunders._Displacements)
    sums.normal, sums.right = np.diag([1.0, 1.0, along])[None], np.array([right])
    sums.frames = np.ones(1, np.int64)
    assert_close("table value", sums.shift_m()[0] / max(shift_m), np.array(shift_m) / max(shift_m))
    assert sums.is_determined().tolist() == [determined]
    assert sums.gain()[1].tolist() == [directions]


def test_three_picks_of_a_frame_stay(flight: Flight) -> None:
    """Four gross picks of six: three at most are dropped."""
    away = {k: (100.0 * (-1) ** k, 70.0 * k) for k in (12, 13, 15, 16)}
    result = solve_flight_read(dropping(picked(flight, away)))
    assert result.estimate.used.sum(axis=1).min() >= 3
    assert result.estimate.used[[0, 1, 3, 4]].all()


def test_a_column_of_sigmas_is_taken(flight: Flight) -> None:
    """12 px off are a blunder of a pick of .3 px, and none of one of 5 px."""
    sigma = np.where(np.arange(FRAMES * COUNT) % COUNT == 2, 5.0, 0.3)
    stated = replace(flight, picks=replace(flight.picks, sigma_px=sigma, one_sigma_px=0.3))
    assert outliers(solve_flight_read(picked(stated, {8: (12.0, 0.0)}))) == [""] * FRAMES
    found = outliers(solve_flight_read(picked(stated, {9: (12.0, 0.0)})))
    assert found == ["", "corner", "", "", ""]


def test_wrong_coordinates_are_named_once(flight: Flight) -> None:
    """The tower's 15 m east of where it is: no blunder in each frame."""
    wrong = moved(flight, TOWER, (15.0, 0.0, 0.0))
    result = solve_flight_read(wrong)
    assert_approved(messages(result))
    assert outliers(result) == [""] * FRAMES
    dropped = solve_flight_read(dropping(wrong))
    assert_approved(messages(dropped))
    assert (~dropped.estimate.used).sum(axis=0).tolist() == [
        FRAMES * (n == TOWER) for n in range(COUNT)
    ]


def test_a_small_shift_of_all_frames_is_seen_over_all_of_them(flight: Flight) -> None:
    """2.5 m at 610 m are 6 px, in no frame a blunder of picks of 3 px."""
    picks = replace(flight.picks, sigma_px=np.full(FRAMES * COUNT, 3.0), one_sigma_px=3.0)
    rough = replace(flight, picks=replace(picks, least_sigma_px=3.0))
    assert messages(solve_flight_read(rough)) == []
    result = solve_flight_read(moved(rough, TOWER, (9.0, 0.0, 0.0)))
    assert outliers(result) == [""] * FRAMES
    of_the_flight, own = messages(result)
    assert own.startswith("tower") and "tower" not in of_the_flight


@pytest.mark.parametrize("seed", [50, 165, 196, 213])
def test_landmarks_wrong_by_what_is_stated_are_not_named(seed: int) -> None:
    """Of 400 such flights 28 had one named: four landmarks tell little beside errors of theirs."""
    rng = np.random.default_rng(seed)
    marks_m = Priors(landmark_m=np.full((4, 3), 0.15))
    assert messages(solve_flight_read(flight_of(rng, drone(rng, 16, 4), 0.7, marks_m))) == []


@pytest.mark.parametrize("seed", [1, 4, 5, 6, 7, 8])
def test_rough_picks_make_no_landmark_wrong(seed: int) -> None:
    """Of 2 px, where nothing is stated: the residuals say so, and are those of what is tested."""
    rng = np.random.default_rng(seed)
    drawn = flight_of(rng, drone(rng, 12, 6), 2.0, Priors())
    picks = replace(drawn.picks, sigma_px=np.ones(len(drawn.picks.frame)))
    result = solve_flight_read(replace(drawn, picks=picks))
    assert not any(WRONG in one for one in messages(result))


def test_a_gross_pick_of_one_frame_is_no_wrong_coordinate(flight: Flight) -> None:
    result = solve_flight_read(picked(flight, {TOWER: (300.0, 0.0)}))
    (only,) = messages(result)
    assert only.startswith("frame 0: tower")


def test_a_landmark_of_two_frames_has_blunders_alone(flight: Flight) -> None:
    keep = (np.arange(FRAMES * COUNT) % COUNT != TOWER) | (np.arange(FRAMES * COUNT) < 2 * COUNT)
    picks = replace(
        flight.picks,
        frame=flight.picks.frame[keep], landmark=flight.picks.landmark[keep],
        pixel=flight.picks.pixel[keep], sigma_px=flight.picks.sigma_px[keep],
    )  # fmt: skip
    wrong = moved(replace(flight, picks=picks), TOWER, (15.0, 0.0, 0.0))
    assert outliers(solve_flight_read(wrong)) == ["tower", "tower", "", "", ""]


def test_picks_of_which_one_is_wrong_are_named_together(flight: Flight) -> None:
    """Four picks of a frame and 30 m of position: several explain one gross pick as well."""
    keep = ~np.isin(np.arange(FRAMES * COUNT), [6, 7])
    picks = replace(
        flight.picks,
        frame=flight.picks.frame[keep], landmark=flight.picks.landmark[keep],
        pixel=flight.picks.pixel[keep], sigma_px=flight.picks.sigma_px[keep],
    )  # fmt: skip
    fixes = TrackFixes(np.arange(FRAMES), np.ones((FRAMES, 1)), np.full((FRAMES, 3), 30.0))
    path = replace(flight.path, fixes=fixes)
    result = solve_flight_read(picked(replace(flight, picks=picks, path=path), {7: (9.0, 0.0)}))
    assert outliers(result) == [""] * FRAMES
    assert_approved(messages(result))


def test_the_flight_is_solved_until_nothing_changes(flight: Flight) -> None:
    """Each time without all that is left out; one of two gross picks is known before."""
    solves: list[list[int]] = []

    def without(out: Bools, before: FlightEstimates) -> FlightEstimates:
        solves.append(np.flatnonzero(out).tolist())
        return settled(wrong, out, before.joint)

    wrong = picked(flight, GROSS)
    one = np.arange(FRAMES * COUNT) == 22
    found, estimates = find_blunders(settled(wrong, one), one, without)
    assert solves == [sorted(GROSS)]
    assert np.flatnonzero(found.left_out).tolist() == sorted(GROSS)
    assert estimates is not None
    assert np.flatnonzero(~estimates.solved.used).tolist() == sorted(GROSS)
    none = np.zeros_like(one)
    clean, as_it_was = find_blunders(settled(flight, none), none, without)
    assert len(solves) == 1 and not clean.left_out.any()
    assert as_it_was is not None and as_it_was.solved.used.all()


def test_gross_picks_are_found_before_any_other_test(flight: Flight) -> None:
    """By their frames alone; a hundred millions of pixels hide nothing either."""
    found, lost = gross_picks(solve(flight))
    assert not found.any() and not lost.any()
    assert np.flatnonzero(gross_picks(solve(picked(flight, GROSS)))[0]).tolist() == sorted(GROSS)
    absurd = picked(flight, {13: (2e8, -1e8)})
    assert np.flatnonzero(gross_picks(solve(absurd))[0]).tolist() == [13]


OTHER_HEMISPHERE, NEXT_VILLAGE = (0.0, 0.0, -2.0), (0.0, 0.0, 0.0004)
"""By which part of its geocentric coordinates a position is off: 9,400 km and 1.9 km; landmarks are
.5 km away."""


def test_a_pick_that_is_in_no_image_is_not_used(tmp_path: Path) -> None:
    """100,000,000,000 px away; angles are those without its row."""
    project = write_project(tmp_path, noise_px=0.3)
    file = tmp_path / "picks.csv"
    head, *rows = file.read_text().splitlines()
    frame, name, _, v = rows[COUNT].split(",")
    found = []
    for own in ([f"{frame},{name},1e11,{v}"], []):
        file.write_text("\n".join([head, *rows[:COUNT], *own, *rows[COUNT + 1 :], ""]))
        found.append(solve_flight_read(read_flight(str(project))))
    np.testing.assert_array_equal(found[0].camera_deg, found[1].camera_deg)
    assert not messages(found[1])
    assert_approved(messages(found[0]), parts=[frame, name])


@pytest.mark.parametrize("sigma_m", [0.0, 2.0])
@pytest.mark.parametrize("off", [OTHER_HEMISPHERE, NEXT_VILLAGE])
def test_a_frame_whose_position_is_far_away_costs_no_other(
    flight: Flight, sigma_m: float, off: tuple[float, float, float]
) -> None:
    """The others are as if it had no position."""
    marks = replace(flight.landmarks, sigma_m=np.full((COUNT, 3), sigma_m))
    flight = replace(flight, landmarks=marks)
    position_m, frame = flight.path.position_m, np.arange(FRAMES) == 2
    away = np.where(frame[:, None], position_m * (1.0 + np.array(off)), position_m)
    nowhere = np.where(frame[:, None], np.nan, position_m)
    result, without = (
        solve_flight_read(replace(flight, path=replace(flight.path, position_m=one)))
        for one in (away, nowhere)
    )
    assert_approved(messages(result))
    assert result.misfits and not without.misfits
    assert result.solved.tolist() == (~frame).tolist()
    np.testing.assert_array_equal(result.camera_deg, without.camera_deg)


@pytest.mark.parametrize("sigma_m", [0.0, 2.0])
def test_residuals_of_picks_left_out_are_those_they_would_have(
    flight: Flight, sigma_m: float
) -> None:
    """Linearised where positions are solved for; picks that take part have them by the solve."""
    fixes = TrackFixes(np.arange(FRAMES), np.ones((FRAMES, 1)), np.full((FRAMES, 3), sigma_m))
    path = replace(flight.path, fixes=fixes if sigma_m else None)
    marks = replace(flight.landmarks, sigma_m=np.full((COUNT, 3), sigma_m))
    own, seen = flight.picks, np.delete(np.arange(FRAMES * COUNT), [0, COUNT + 2, 3 * COUNT])
    columns = {
        name: getattr(own, name)[seen] for name in ("frame", "landmark", "pixel", "sigma_px")
    }
    one = replace(flight, path=path, landmarks=marks, picks=replace(own, **columns))
    none = np.zeros(len(seen), bool)
    estimates = settled(one, none)
    part = next(iter(estimates.blocks))
    expected = equations_of(estimates.of(part.frames), [], part.frames).residual
    made = estimates.of(part.frames)
    if estimates.joint is not None and estimates.joint.passes:
        beside = estimates._residual_beside(made, part)
        used = np.tile(made.used, 2)
        assert_close("residual beside a solve", beside[used], expected[used])
    else:
        assert sigma_m == 0.0 and made.test_residual is None


def test_the_landmarks_are_where_the_tests_say() -> None:
    assert EAST_NORTH_UP[TOWER].tolist() == [20.0, 610.0, 60.0]


@pytest.mark.parametrize("count", [1, 3, 4])
@pytest.mark.parametrize("dropped", [False, True])
def test_three_that_do_not_fit_are_named_and_further_ones_counted(
    dropped: bool, count: int
) -> None:
    options: Any = SimpleNamespace(options=SimpleNamespace(drop_blunders=dropped))
    assert_approved(_together(["a", "b", "c", "d"][:count], options, True))


@pytest.mark.parametrize("misfits", [False, True])
def test_beside_an_error_of_all_no_pick_is_named_by_itself(tmp_path: Path, misfits: bool) -> None:
    """A wrong clock puts hundreds of tracked places off, and a landmark, which is named too."""
    flight = read_flight(str(write_project(tmp_path)))
    picks, marks = len(flight.picks.frame), len(flight.landmarks.name)
    found = Blunders(
        np.arange(picks) < 9, np.zeros(picks, bool), np.arange(marks) == 0, np.zeros(marks, bool),
        np.full((marks, 3), np.nan), np.zeros(picks, bool), np.full(picks, 3.0),
    )  # fmt: skip
    (told,) = blunder_findings(found, flight, misfits, explained=True)
    assert_approved(told.message)


def test_a_landmark_beside_an_error_of_all_is_named_by_itself(tmp_path: Path) -> None:
    """One alone, in a flight that does not misfit: with how far it is off, as any other."""
    flight = read_flight(str(write_project(tmp_path)))
    picks, marks = len(flight.picks.frame), len(flight.landmarks.name)
    none = np.zeros(picks, bool)
    found = Blunders(
        none, none, np.arange(marks) == 0, np.zeros(marks, bool), np.full((marks, 3), np.nan),
        none, np.full(picks, 3.0),
    )  # fmt: skip
    (told,) = blunder_findings(found, flight, False, explained=True)
    assert_approved(told.message)
