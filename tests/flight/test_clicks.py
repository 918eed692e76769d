"""Clicks as unknowns: against one dense matrix, drawn errors, clicks that do not fit, files."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.approved.texts import assert_approved, refused
from tests.kit.clicked_flights import ClickedFlight, clicked_flight, dense_solution, with_rows
from tests.kit.command import vopd
from tests.kit.flight_project import TOML, pixels, write_project
from tests.kit.joint_flights import NED_FROM_ENU, axes, turned_out
from tests.kit.video import write_video
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.attitude.included import left_out_text
from vopd.cli.new import write_project as write_adjusted
from vopd.findings import VopdError
from vopd.flight.adjust.adjustment import adjust
from vopd.flight.adjust.project import adjusted_project
from vopd.flight.check import check_flight
from vopd.flight.flight import Flight, FrameSlots
from vopd.flight.formats.picks import CLICKS, HIDDEN, Names
from vopd.flight.formats.tracked import TrackedRows, digest_of_rows, tracked_lines
from vopd.flight.misfits.click_tests import without_readings, without_wrong_clicks
from vopd.flight.misfits.unsolved import picks_outside
from vopd.flight.project.keys import read_project
from vopd.flight.project.read import flight_of, read_flight
from vopd.flight.project.tracked_picks import (
    correlation_of_neighbours,
    followed_findings,
    hidden_marks,
    track_digests,
)
from vopd.flight.result import FlightResult, solve_flight, solve_flight_read
from vopd.flight.solve import joint, next_click, normal
from vopd.flight.solve.clicks import AT_ONCE, errors_of_frames
from vopd.flight.solve.errors import priors_of
from vopd.flight.solve.joint import covariance_of_sums, solve_jointly
from vopd.flight.solve.next_click import next_click_texts, next_clicks, next_places
from vopd.flight.solve.normal import Normal
from vopd.flight.solve.rotations import SolvedFlight
from vopd.flight.solve.sizes import cost_of_frames


@pytest.mark.parametrize(("seed", "landmark_m"), [(0, 0.0), (1, 0.05)])
def test_joint_solution_is_that_of_one_dense_matrix(seed: int, landmark_m: float) -> None:
    """A row for each reading there; here readings of one place are one pick, and differences."""
    one = clicked_flight(np.random.default_rng(seed), 8, 4, every=4, reach=5, landmark_m=landmark_m)
    joint = solve_jointly(one.flight, priors_of(one.flight))
    dense = dense_solution(one, joint.state.rotation, 0.08)
    turn = Rotation.from_matrix(dense.rotation @ joint.state.rotation.swapaxes(1, 2)).as_rotvec()
    sigma = np.sqrt(np.diag(dense.turn))
    assert_close("dense minimum", turn.ravel() / sigma, 0.0 * sigma)
    assert_close("dense minimum", joint.state.click_px, dense.click_px)
    own = np.sqrt(np.einsum("fii->fi", joint.covariance.turn)).ravel()
    assert_close("dense minimum", own / sigma, np.ones_like(sigma))
    mean = np.tile(np.eye(3) / 8, (1, 8))
    total, parts = covariance_of_sums(joint, np.tile(np.eye(3) / 8, (8, 1, 1)))
    of_mean = mean @ dense.turn @ mean.T
    assert_close("dense minimum", total / np.abs(of_mean).max(), of_mean / np.abs(of_mean).max())
    assert "click, common" in parts


@pytest.mark.parametrize(("loss", "newton"), [("least-squares", False), ("huber", True)])
def test_a_product_of_all_frames_is_the_sum_of_theirs(
    loss: str, newton: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As many clicks are taken together; some picks are far off, so that the loss weighs them."""
    one = clicked_flight(np.random.default_rng(2), 9, 4, every=4, reach=5, landmark_m=0.05)
    pixel = one.rows.pixel + 3.0 * (np.arange(len(one.rows.pixel)) % 7 == 0)[:, None]
    flight = with_rows(one.flight, replace(one.rows, pixel=pixel))
    flight = replace(flight, options=replace(flight.options, loss=loss))
    joint = solve_jointly(flight, priors_of(flight))
    made = []
    for many in (1, 10**6):
        monkeypatch.setattr(normal, "MANY", many)
        made.append(Normal(joint.model, joint.state, newton=newton))
    together, alone = (one.common for one in made)
    assert_close("joint algebra", together / np.abs(alone).max(), alone / np.abs(alone).max())


def turns(one: ClickedFlight, solved: SolvedFlight) -> np.ndarray:
    """How far the solved cameras are turned from the true ones, about their axes, (F, 3)."""
    rotation = solved.attitudes.rotation
    return Rotation.from_matrix(rotation @ one.scene.rotation.swapaxes(1, 2)).as_rotvec()


def test_stated_sigmas_are_those_of_drawn_errors() -> None:
    """Thirty flights; `python -m tools.click_coverage` counts hundreds, by whole solves."""
    squares, inside = [], []
    for seed in range(30):
        one = clicked_flight(np.random.default_rng(seed), 20, 5, every=10, reach=15)
        joint = solve_jointly(one.flight, priors_of(one.flight))
        off = turns(one, joint.solved)
        known = np.linalg.inv(joint.covariance.turn)
        squares.append(np.einsum("fi,fij,fj->f", off, known, off).mean() / 3.0)
        of_mean, _ = covariance_of_sums(joint, np.tile(np.eye(3) / 20, (20, 1, 1)))
        mean = off.mean(axis=0)
        inside.append(mean @ np.linalg.solve(of_mean, mean) < 7.815)  # .95 of chi-square, 3
    assert_close("squares of thirty flights", np.mean(squares), 1.0)
    assert sum(inside) >= 25


def test_sigma_of_a_match_is_estimated_beside_clicks() -> None:
    sigmas = []
    for seed in range(1, 4):
        one = clicked_flight(np.random.default_rng(seed), 30, 5, every=15, reach=20, stated_px=0.2)
        result = solve_flight_read(one.flight)
        assert result.estimates.reading is not None and not messages(result)
        sigmas.append(result.estimates.reading.sigma)
    assert_close("sigma of a match", np.mean(sigmas), 0.08)


def messages(result: FlightResult) -> list[str]:
    """What is said, but for picks that are drawn outside their images."""
    outside = picks_outside(result.read)
    return [one.message for one in result.findings if one not in outside]


def moved(one: ClickedFlight, which: np.ndarray, by_px: list[float], carried: bool) -> FlightResult:
    """Solve with some readings moved, by an error of their click or as they are."""
    pixel = one.rows.pixel.copy()
    pixel[which] += one.rows.by_click[which] @ by_px if carried else by_px
    return solve_flight_read(with_rows(one.flight, replace(one.rows, pixel=pixel)))


def test_the_longest_runs_of_lost_frames_come_first() -> None:
    """Each by its middle; runs of the same length as they follow each other."""
    one = clicked_flight(np.random.default_rng(1), 30, 3, every=30, reach=30)
    clicks = one.flight.picks.clicks
    assert clicks is not None
    lost = replace(clicks, lost=np.array([2, 7, 8, 9, 12, 13, 20, 21]))
    flight = replace(one.flight, picks=replace(one.flight.picks, clicks=lost))
    found = next_places(solve_jointly(flight, priors_of(flight)))
    assert [each.frame for each in found] == ["8", "12", "20"]
    solved = solve_jointly(one.flight, priors_of(one.flight))
    most = [(each.frame, each.landmark) for each in next_clicks(solved)]
    names = one.flight.landmarks.name
    assert most
    assert [(each.frame, each.landmark) for each in next_places(solved)] == [
        (str(one.flight.frame[frame]), names[landmark]) for frame, landmark in most
    ]


def test_more_clicks_than_can_be_solved_for_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    one = clicked_flight(np.random.default_rng(1), 20, 5, every=10, reach=15)
    monkeypatch.setattr(joint, "MOST_COMMON", 17)
    with refused(VopdError):
        solve_jointly(one.flight, priors_of(one.flight))


def test_that_no_click_is_of_a_frame_with_an_attitude_is_said() -> None:
    """Two landmarks in one place, and picked in one pixel: no frame of them is solved."""
    one = clicked_flight(np.random.default_rng(12), 20, every=60, reach=60)
    rows = one.rows.where(np.isin(np.array(one.rows.landmark), ("P0", "P1")))
    marks, pixel = np.array(rows.landmark), rows.pixel.copy()
    for frame in range(20):
        here = rows.frame == frame
        pixel[here] = pixel[here & (marks == "P0")][0]
    flight = with_rows(one.flight, replace(rows, pixel=pixel))
    position_m = flight.landmarks.position_m.copy()
    position_m[flight.landmarks.name.index("P1")] = position_m[flight.landmarks.name.index("P0")]
    moved = replace(flight.landmarks, position_m=position_m)
    found = solve_flight_read(replace(flight, landmarks=moved))
    assert not found.solved.any()
    assert_approved(dict(found.history().about.words.conventions)["clicks"])


@pytest.mark.parametrize("named", [False, True], ids=["numbers", "images"])
def test_hidden_landmarks_are_not_asked_for(named: bool) -> None:
    """The first click that would tell most is marked as hidden there: another one is told."""
    one = clicked_flight(np.random.default_rng(1), 30, 3, every=30, reach=30)
    labels = tuple(f"{k}.jpg" if named else str(k) for k in range(30))
    flight = replace(one.flight, image_name=labels * named)
    first = next_clicks(solve_jointly(flight, priors_of(flight)))[0]
    clicks = flight.picks.clicks
    assert clicks is not None
    hidden = replace(clicks, hidden=frozenset({(labels[first.frame], first.landmark)}))
    flight = replace(flight, picks=replace(flight.picks, clicks=hidden))
    again = next_clicks(solve_jointly(flight, priors_of(flight)))
    assert (first.frame, first.landmark) not in [(each.frame, each.landmark) for each in again]
    assert again


def test_the_correlation_of_residuals_in_frames_beside_each_other() -> None:
    """Two marks in frames 0 to 3 and one in 5 to 6: seven pairs, whatever the order of picks."""
    frame, mark = np.array([0, 1, 2, 3] * 2 + [5, 6]), np.array([0] * 4 + [1] * 4 + [0, 0])
    rng = np.random.default_rng(4)
    residual, order = rng.normal(0.0, 1.0, (10, 2)) + 1.0, rng.permutation(10)
    pairs = [(k, k + 1) for k in (0, 1, 2, 4, 5, 6, 8)]
    before, after = (np.array([residual[pair[k]] for pair in pairs]) for k in (0, 1))
    expected = (before * after).sum() / np.sqrt((before**2).sum() * (after**2).sum())
    picks = SimpleNamespace(followed=np.ones(10, bool), frame=frame[order])
    model = SimpleNamespace(
        flight=SimpleNamespace(picks=picks), pick=np.arange(10), landmark=mark[order]
    )
    solved = SimpleNamespace(model=model, normal=SimpleNamespace(residual=residual[order]))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("vopd.flight.project.tracked_picks.FEWEST", 7)
        assert_close("ratio", correlation_of_neighbours(cast(Any, solved)), expected)
        patch.setattr("vopd.flight.project.tracked_picks.FEWEST", 8)
        assert np.isnan(correlation_of_neighbours(cast(Any, solved)))


def test_a_pick_without_some_readings_is_the_mean_of_the_others() -> None:
    """Those that are left read the same places, and their parts of a pick are about its place."""
    flight = clicked_flight(np.random.default_rng(3), every=10).flight
    before = flight.picks.clicks
    assert before is not None
    out = np.arange(len(before.pick)) % 3 == 0
    less = without_readings(flight, out).picks
    after = less.clicks
    assert after is not None and np.bincount(after.pick).max() > 1
    was = flight.picks.pixel[before.pick] + before.off_px
    assert_close("trial without noise", less.pixel[after.pick] + after.off_px, was[~out])
    mean = np.array([np.bincount(after.pick, after.part * off) for off in after.off_px.T])
    assert_close("trial without noise", mean, 0.0 * mean)


def test_a_click_on_another_mast_is_named_once_and_not_its_tracks() -> None:
    one = clicked_flight(np.random.default_rng(12))
    marks = np.array(one.rows.landmark)
    good = np.abs(turns(one, solve_flight_read(one.flight).estimates.solved)).max()
    for off_px in (3.0, 200.0):
        own = (marks == "P3") & (one.rows.from_frame == 39)
        found = moved(one, own, [off_px, 0.0], carried=True)
        assert [f.partition(",")[0] for f in messages(found)] == [
            "frame 39: the click of P3 does not fit the other clicks"
        ]
        assert f": it and {own.sum() - 1} places that are tracked" in messages(found)[0]
        assert np.abs(turns(one, found.estimates.solved)).max() < 2.0 * good


def test_exchanged_clicks_need_not_be_exact() -> None:
    """One of them lies 3 standard deviations beside the other landmark's image."""
    one = clicked_flight(np.random.default_rng(5), 10, 5, every=5, apart=0)
    rows, marks = one.rows, np.array(one.rows.landmark)
    first, second = ((rows.from_frame == 5) & (marks == name) for name in ("P1", "P2"))
    named = Names(np.where(first, "P2", np.where(second, "P1", marks)).tolist())
    pixel = rows.pixel.copy()
    pixel[first] += rows.by_click[first] @ [1.5, 0.0]
    rows = replace(rows, landmark=named, pixel=pixel)
    (said,) = messages(solve_flight_read(with_rows(one.flight, rows)))
    assert said.startswith("frame 5: the clicks of P1 and P2 are exchanged: ")


def test_places_that_do_not_fit_are_named_by_frame() -> None:
    one = clicked_flight(np.random.default_rng(12))
    here = (one.rows.frame == 30) & (np.array(one.rows.landmark) == "P2")
    found = moved(one, here, [0.0, 1.5], carried=False)
    *_, said = messages(found)
    assert said.startswith("frame 30: P2 does not fit the others")
    one_of_them = here & (one.rows.from_frame == one.rows.from_frame[here][0])
    *_, said = messages(moved(one, one_of_them, [0.0, 4.0], carried=False))
    assert said.startswith("frame 30: P2: the places tracked from several clicks contradict")


@pytest.mark.parametrize(
    ("frames", "by_px"), [((20,), 500.0), ((20, 35), 80.0), (range(20, 34), 60.0)]
)
def test_places_that_are_far_off_make_no_click_wrong(frames: Sequence[int], by_px: float) -> None:
    """Of the last ones the error of their click would explain more than that of any one of them."""
    one = clicked_flight(np.random.default_rng(12), every=60, reach=60)
    here = np.isin(one.rows.frame, frames) & (np.array(one.rows.landmark) == "P2")
    found = moved(one, here, [0.0, by_px], carried=False)
    good = solve_flight_read(one.flight)
    assert_approved(messages(found))
    kept, every = (flight.picks.clicks for flight in (found.flight, one.flight))
    assert kept is not None and every is not None
    assert len(kept.pick) == len(every.pick) - len(frames)
    ratio = np.abs(turns(one, found.estimates.solved)).max(axis=1)
    ratio /= np.abs(turns(one, good.estimates.solved)).max()
    assert ratio.max() < 2.0 and np.delete(ratio, frames).max() < 1.5


def test_a_frame_of_two_landmarks_with_a_place_that_is_far_off_costs_no_other() -> None:
    """Nothing tells which one it is: the frame has no attitude."""
    one = clicked_flight(np.random.default_rng(12), every=60, reach=60)
    marks, frame = np.array(one.rows.landmark), one.rows.frame
    two = (frame != 20) | np.isin(marks, ("P2", "P4"))
    rows = one.rows.where(two)
    pixel = rows.pixel.copy()
    pixel[(rows.frame == 20) & (np.array(rows.landmark) == "P2")] += 500.0
    found = solve_flight_read(with_rows(one.flight, replace(rows, pixel=pixel)))
    assert_approved(messages(found)[0])
    assert not found.solved[20] and found.solved.sum() == 59


@pytest.mark.parametrize("check", ["P0", "P1", "P3", "P5"])
def test_a_check_landmark_is_not_one_of_the_two_of_a_frame(check: str) -> None:
    """It takes no part in the solve, so that nothing that is far off is a reading of it."""
    one = clicked_flight(np.random.default_rng(12), every=60, reach=60)
    marks, frame = np.array(one.rows.landmark), one.rows.frame
    rows = one.rows.where((frame != 20) | np.isin(marks, ("P2", "P4", check)))
    pixel = rows.pixel.copy()
    pixel[(rows.frame == 20) & (np.array(rows.landmark) == "P2")] += 500.0
    flight = with_rows(one.flight, replace(rows, pixel=pixel))
    used = tuple(name != check for name in flight.landmarks.name)
    found = solve_flight_read(replace(flight, landmarks=replace(flight.landmarks, used=used)))
    assert_approved(messages(found)[0])
    assert not found.solved[20] and found.solved.sum() == 59


def test_a_place_that_is_far_off_beside_a_wrong_click() -> None:
    one = clicked_flight(np.random.default_rng(12), every=60, reach=60)
    marks, pixel = np.array(one.rows.landmark), one.rows.pixel.copy()
    pixel[(one.rows.frame == 20) & (marks == "P2")] += 300.0
    own = marks == "P3"
    pixel[own] += one.rows.by_click[own] @ [30.0, 0.0]
    found = solve_flight_read(with_rows(one.flight, replace(one.rows, pixel=pixel)))
    click, place = messages(found)
    assert click.startswith("frame 9: the click of P3") and place.startswith("frame 20: P2 (")


def guessed(flight: Flight, off_m: Floats) -> Flight:
    """Place all cameras elsewhere, east, north, up, as one who guesses it to a hundred metres."""
    path, own = flight.path, axes(flight.path.position_m)
    shifted = path.position_m + turned_out(own, np.tile(off_m, (len(own), 1)))
    return replace(flight, path=replace(path, position_m=shifted, bias_sigma_m=np.full(3, 100.0)))


@pytest.mark.parametrize(
    ("wrong_px", "off_m"), [(0.0, [150.0, 0.0, 30.0]), (30.0, [-80.0, -100.0, 30.0])]
)
def test_a_position_that_is_guessed_makes_no_click_wrong(wrong_px: float, off_m: Floats) -> None:
    """Its residuals are thousands of times what matches have; one click may be wrong as well."""
    one = clicked_flight(np.random.default_rng(3), 12, 6, every=60, reach=60)
    rows = one.rows
    pixel, own = rows.pixel.copy(), np.array(rows.landmark) == "P3"
    pixel[own] += rows.by_click[own] @ [wrong_px, 0.0]
    flight = with_rows(one.flight, replace(rows, pixel=pixel))
    near, far = (
        solve_flight_read(guessed(flight, np.array(off))) for off in ([0.0, 0.0, 0.0], off_m)
    )
    joint = far.estimates.joint
    assert joint is not None and joint.settles
    assert [said.partition(",")[0] for said in messages(far)] == [
        said.partition(",")[0] for said in messages(near)
    ]
    assert len(messages(far)) == (wrong_px > 0.0)
    turn = turns(one, far.estimates.solved) - turns(one, near.estimates.solved)
    sigma = np.sqrt(np.einsum("fii->fi", joint.covariance.turn))
    assert_close("two starts", turn / sigma, 0.0 * sigma)


def test_a_lens_that_is_off_costs_no_place() -> None:
    """Some places are then farther off than the others of their clicks."""
    one = clicked_flight(np.random.default_rng(3002))
    centre = one.flight.lens.centre_px
    rows = replace(one.rows, pixel=centre + 1.03 * (one.rows.pixel - centre))
    flight, said = without_wrong_clicks(with_rows(one.flight, rows))
    kept, every = flight.picks.clicks, one.flight.picks.clicks
    assert kept is not None and every is not None
    assert len(kept.pick) == len(every.pick) and not said


def test_a_landmark_with_wrong_coordinates_is_no_wrong_click() -> None:
    one = clicked_flight(np.random.default_rng(12), 30, every=15)
    position_m = one.flight.landmarks.position_m.copy()
    position_m[3] += 1.0
    marks = replace(one.flight.landmarks, position_m=position_m)
    said = " ".join(
        f.message for f in solve_flight_read(replace(one.flight, landmarks=marks)).findings
    )
    assert "coordinates of P3" in said and "the click of" not in said


def test_the_clicks_alone_name_an_error_that_the_tracks_were_led_astray_by() -> None:
    """A lens 3 % off, and tracks that leave their landmarks by 2.5 px in 40 frames, each its way.

    All readings together have no explanation; the clicks have. No click is rejected.
    """
    one = clicked_flight(np.random.default_rng(0), 40, 8, every=20, apart=0, match_px=0.05)
    rows, centre = one.rows, one.flight.lens.centre_px
    way = 2.4 * np.array([int(name[1:]) for name in rows.landmark])
    away_px = (rows.frame - rows.from_frame)[:, None] / 16.0
    astray = away_px * np.column_stack([np.cos(way), np.sin(way)])
    pixel = centre + 1.03 * (rows.pixel - centre) + astray
    result = solve_flight_read(with_rows(one.flight, replace(rows, pixel=pixel)))
    assert result.misfits
    said = [f.message for f in result.findings]
    (told,) = [message for message in said if "clicks alone" in message]
    assert not any("the click of" in message for message in said)
    assert_approved(told.partition("a focal length of")[2].partition("px")[2])
    focal_px, _, sigma_px = told.partition("a focal length of ")[2].split(" px")[0].split(" ")
    assert abs(float(focal_px) - 3090.0) < 3.0 * float(sigma_px)


def of_a_late_clock(one: ClickedFlight, late_s: float) -> ClickedFlight:
    """The same flight where the camera climbs, its frames late, .5 s being stated for them."""
    speed_m_s, path = np.array([6.0, 0.0, 8.0]), one.flight.path  # east, north, up
    moved_m = turned_out(axes(path.position_m), np.tile(speed_m_s, (len(path.position_m), 1)))
    path = replace(
        path,
        position_m=path.position_m - late_s * moved_m,
        velocity_m_s=np.tile(speed_m_s @ NED_FROM_ENU, (len(moved_m), 1)),
        acceleration_m_s2=np.zeros_like(moved_m),
    )
    options = replace(one.flight.options, parameter_sigma={"clock": 0.5})
    return one._replace(flight=replace(one.flight, path=path, options=options))


@pytest.mark.parametrize("late_s", [0.5, -0.5])
def test_a_clock_that_is_off_by_what_is_stated_makes_no_click_wrong(late_s: float) -> None:
    """The clock is named: the angles are those of the clock as it is stated."""
    one = of_a_late_clock(clicked_flight(np.random.default_rng(5), 30, every=30), late_s)
    result = solve_flight_read(one.flight)
    _, said = messages(result)
    assert result.misfits and " or " not in said
    offset_s, _, sigma_s = said.partition("offset_s = ")[2].split()[:3]
    assert abs(float(offset_s) + late_s) < 3.0 * float(sigma_s) < 0.1


def test_a_wrong_click_is_named_beside_a_clock_that_is_hardly_known() -> None:
    one = of_a_late_clock(clicked_flight(np.random.default_rng(5), 30, every=30), 0.0)
    own = np.array(one.rows.landmark) == "P3"
    (said,) = messages(moved(one, own, [8.0, 0.0], carried=True))
    assert_approved(said.partition(",")[0])


# A project with a tracked file

KEYS = 'pixel_grid = "centre"\ntracked = "tracked.csv"\n'
CLICKED_TOML = TOML.replace('pixel_grid = "centre"\nframe_rate', KEYS + "frame_rate")


def clicked_project(folder: Path, church_px: float = 0.0) -> Path:
    """A project of five frames: six landmarks clicked in frame 0 and tracked to the others.

    Args:
        folder: where it is written
        church_px: error of the first one's click along u, which its tracks have, too
    """
    path = write_project(folder, CLICKED_TOML)
    seen = pixels(0.05)
    seen[:, 0, 0] += church_px
    rows = (folder / "picks.csv").read_text().splitlines(keepends=True)
    (folder / "picks.csv").write_text("".join(rows[:7]))
    frame, mark = np.divmod(np.arange(30), 6)
    names = ("church", "mast", "bridge", "corner", "tower", "well")
    tracks = TrackedRows(
        frame, Names(names[k] for k in mark), seen.reshape(-1, 2),
        np.where(frame == 0, 0.5, 0.05), np.zeros(30, int), np.tile(np.eye(2), (30, 1, 1)),
        np.ones(30), (frame > 0).astype(int), track_digests(read_project(str(path))),
    )  # fmt: skip
    head, *lines = tracked_lines(tracks)
    (folder / "tracked.csv").write_text("".join([head, *lines]))
    rows = f"# rows: {digest_of_rows(folder / 'tracked.csv')}\n"
    (folder / "tracked.csv").write_text("".join([head, rows, *lines]))
    return path


def test_a_project_of_clicks_is_solved_from_its_tracked_file(tmp_path: Path) -> None:
    result = solve_flight(clicked_project(tmp_path))
    assert result.solved.all() and not result.findings
    history = result.history()
    assert (history.uncertainty.components["click"][:, :3] > 0.0).all()
    assert "6 clicks and 24 tracked places" in " ".join(result.about)
    assert not any("by vopd track" in one for one in result.about)
    tracked = tmp_path / "tracked.csv"
    tracked.write_text(
        tracked.read_text().replace("# clicks:", "# options: --every 2\n# clicks:", 1)
    )
    about = solve_flight(tmp_path / "flight.toml").about
    assert any(one.endswith("from them, by vopd track --every 2") for one in about)


def test_other_clicks_need_another_track(tmp_path: Path) -> None:
    path = clicked_project(tmp_path)
    with (tmp_path / "picks.csv").open("a") as file:
        file.write("3,mast,700,500\n")
    with refused(VopdError):
        solve_flight(path)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('pixel_grid = "centre"', 'pixel_grid = "one-based"'),
        ('pixel_grid = "centre"', 'pixel_grid = "centre"\nv = "up"'),
        ('pixel_grid = "centre"', 'pixel_grid = "centre"\ncolumns = { u_px = "v_px" }'),
    ],
    ids=["grid", "v", "columns"],
)
def test_clicks_that_are_read_otherwise_need_another_track(
    tmp_path: Path, old: str, new: str
) -> None:
    """The places that were tracked are of the pixels that they were read as."""
    path = clicked_project(tmp_path)
    head, picks, rest = path.read_text().partition("[picks]\n")
    path.write_text(head + picks + rest.replace(old, new, 1))
    with refused(VopdError):
        solve_flight(path)


def test_a_default_that_is_written_changes_no_track(tmp_path: Path) -> None:
    path = clicked_project(tmp_path)
    path.write_text(path.read_text().replace("[picks]\n", '[picks]\nv = "down"\n'))
    assert not solve_flight(path).findings


def test_a_tracked_file_says_which_clicks_it_is_of(tmp_path: Path) -> None:
    path = clicked_project(tmp_path)
    lines = (tmp_path / "tracked.csv").read_text().splitlines(keepends=True)
    rows = [one for one in lines if not one.startswith("#")]
    (tmp_path / "tracked.csv").write_text("".join(rows))
    with refused(VopdError):
        solve_flight(path)


def test_a_tracked_file_says_whether_it_was_edited(tmp_path: Path) -> None:
    path, tracked = clicked_project(tmp_path), tmp_path / "tracked.csv"
    text, said = tracked.read_text(), []
    edited = text.replace(",0.5000,", ",0.6000,", 1)
    for one in (edited, re.sub("(?m)^# rows: .*\n", "", edited)):
        tracked.write_text(one)
        said += [finding.message for finding in read_flight(str(path)).findings]
    assert_approved(said)


def test_sigmas_that_no_pick_has_are_told_of_a_tracked_file_and_its_project(tmp_path: Path) -> None:
    path = clicked_project(tmp_path)
    rows = (tmp_path / "tracked.csv").read_text()
    (tmp_path / "tracked.csv").write_text(rows.replace(",0.0500,", ",1e-9,", 1))
    path.write_text(path.read_text().replace(KEYS, KEYS + "sigma_px = 1e-6\n"))
    told = [one.message for one in read_flight(str(path)).findings]
    assert_approved([one for one in told if "sigma_px" in one])


def test_a_folder_in_the_folder_of_the_images_changes_nothing(tmp_path: Path) -> None:
    path, images = clicked_project(tmp_path), tmp_path / "images"
    path.write_text(path.read_text().replace(KEYS, KEYS + 'video = "images"\n'))
    images.mkdir()
    (images / "a.png").write_bytes(b"1")
    project = read_project(str(path))
    before = track_digests(project)
    (images / "b").mkdir()
    assert track_digests(project) == before
    (images / "b.png").write_bytes(b"1")
    after = track_digests(project)
    assert {key for key in after if after[key] != before[key]} == {"video"}


def test_clicks_that_were_not_tracked_are_told_of_the_tracked_flight(tmp_path: Path) -> None:
    """The church is clicked twice, far apart, and one click is of a name that is not known."""
    path = clicked_project(tmp_path)
    with (tmp_path / "picks.csv").open("a") as file:
        file.write("0,church,700,500\n0,tree,5,5\n")
    digests = track_digests(read_project(str(path)))
    head, *rows = (tmp_path / "tracked.csv").read_text().splitlines()
    kept = [row for row in rows if not row.startswith("# clicks:") and ",church," not in row]
    text = "\n".join([head, f"# clicks: {digests['clicks']}", *kept, ""])
    (tmp_path / "tracked.csv").write_text(text)
    said = [one.message for one in solve_flight(path).findings]
    checked = [one.message for one in check_flight(str(path))]
    assert all(one in checked for one in said)
    assert_approved("\n".join(checked))


def test_the_sigma_of_clicks_is_the_one_that_is_stated_now(tmp_path: Path) -> None:
    path = clicked_project(tmp_path)
    before = solve_flight(path).history().uncertainty.components["click"]
    path.write_text(path.read_text().replace(KEYS, KEYS + "sigma_px = 1.0\n"))
    after = solve_flight(path).history().uncertainty.components["click"]
    assert (after[:, :3] > 1.5 * before[:, :3]).all()


def test_the_sigmas_of_clicks_that_have_their_own_stay(tmp_path: Path) -> None:
    """A column says them, but for its empty cells, and so does a point that is clicked twice."""
    path = clicked_project(tmp_path)
    clicks = tmp_path / "picks.csv"
    head, *rows = clicks.read_text().splitlines()
    stated = path.read_text().replace(KEYS, KEYS + "sigma_px = 1.0\n")
    tracked = tmp_path / "tracked.csv"
    some = [f"{head},sigma_px", f"{rows[0]},0.5", *(f"{row}," for row in rows[1:])]
    for changed, sigma_px in (
        ([f"{head},sigma_px", *(f"{row},0.5" for row in rows)], {0.5}),
        (some, {0.5, 1.0}),
        ([head, *rows, rows[0]], {0.5}),
    ):
        clicks.write_text("\n".join([*changed, ""]))
        path.write_text(stated)
        digests = track_digests(read_project(str(path)))
        lines = tracked.read_text().splitlines()
        kept = [one for one in lines if not one.startswith("# clicks:")]
        tracked.write_text("\n".join([kept[0], f"# clicks: {digests['clicks']}", *kept[1:], ""]))
        picks = read_flight(str(path)).picks
        assert picks.clicks is not None and {*picks.clicks.sigma_px.tolist()} == sigma_px


def test_the_cost_of_clicked_frames_is_that_of_the_solution() -> None:
    """A click's error counts in the frames that it was tracked to; readings of one place do not."""
    one = clicked_flight(np.random.default_rng(3), 8, 4, every=4, reach=5, landmark_m=0.05)
    solution = solve_jointly(one.flight, priors_of(one.flight))
    cost = cost_of_frames(solution)
    clicks = solution.model.clicks
    assert clicks is not None and (cost > 0.0).all()
    readings = clicks.squares(solution.state.click_px).sum()
    assert np.abs(solution.state.click_px).max() > 0.1 and readings > 0.1
    assert_close("ratio", cost.sum() / (solution.normal.cost - readings), 1.0)


def test_residuals_of_an_adjusted_project_are_those_of_the_joint_solution(tmp_path: Path) -> None:
    """The errors of clicks, which the project does not hold, are solved for again and taken off."""
    path, new = clicked_project(tmp_path, church_px=1.0), tmp_path / "new"
    project = read_project(str(path))
    joint = adjust(flight_of(project), "focal")
    write_adjusted(new, adjusted_project(project, joint, new))
    held = solve_flight(new / "flight.toml")
    for name in ("residual", "test_residual"):
        first, again = (getattr(one.estimates.whole(), name) for one in (joint.result, held))
        assert_close("residual as solved", again, first)
    assert joint.result.next_clicks and not held.next_clicks


def test_the_page_of_picks_says_where_to_click_next(tmp_path: Path) -> None:
    """Three places, and others where the page says that a landmark is not to be seen."""
    path = clicked_project(tmp_path)
    path.write_text(path.read_text().replace("[picks]\n", '[picks]\nvideo = "a.mp4"\n'))
    write_video(tmp_path / "a.mp4", [100 * k for k in range(40)])
    picks, tracked = tmp_path / "picks.csv", tmp_path / "tracked.csv"
    rows = [row for row in tracked.read_text().splitlines() if not row.startswith("# ")]

    def places(file: str) -> list[tuple[str, str]]:
        digests = [
            f"# {name}: {one}" for name, one in track_digests(read_project(str(path))).items()
        ]
        tracked.write_text("\n".join([*digests, *rows, ""]))
        done = vopd("pick", path, "-o", tmp_path / "p.html")
        assert done.status == 0, done.stderr
        page = (tmp_path / "p.html").read_text(encoding="utf-8")
        assert f">Save {file}<" in page
        found = re.search(r'id="data">(.*?)</script>', page, re.S)
        assert found
        shown = json.loads(found[1])
        names = [one["name"] for one in shown["frames"]]
        return [(names[one["frame"]], one["landmark"]) for one in shown["places"]]

    found = places("clicks.csv")
    joint = solve_flight(path).estimates.joint
    assert joint is not None
    assert found == [(one.frame, one.landmark) for one in next_places(joint)]
    text = picks.read_text()
    picks.write_text(f"{CLICKS}\n{text}")
    assert places("picks.csv") == found
    picks.write_text(f"{CLICKS}\n{HIDDEN}{','.join(found[0])}\n{text}")
    others = places("picks.csv")
    assert len(others) == len(found) == 3 and found[0] not in others


@pytest.mark.parametrize(
    ("old", "new"), [("fx_px = 1500.0", "fx_px = 1501.0"), ("11:58:42Z", "11:58:42.5Z")]
)
def test_another_lens_or_epoch_is_said_and_the_picks_serve(
    old: str, new: str, tmp_path: Path
) -> None:
    path = clicked_project(tmp_path)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    said = " ".join(one.message for one in solve_flight(path).findings)
    assert "lens, landmarks or positions have changed" in said and "run vopd track again" in said


def test_the_mount_places_the_camera_by_a_lever_arm_only(tmp_path: Path) -> None:
    """Of a track whose positions are the camera's own it changes nothing that was predicted."""
    project = read_project(str(clicked_project(tmp_path)))
    other = project.changed("vehicle", "mount", "down")
    assert track_digests(other) == track_digests(project)
    arm = [project.changed("track", "lever_arm_m", [1.0, 0.0, 0.0]) for project in (project, other)]
    digests = [track_digests(one) for one in arm]
    assert {key for key in digests[0] if digests[0][key] != digests[1][key]} == {"project"}


def test_a_file_of_another_program_needs_tracked_from(tmp_path: Path) -> None:
    path = clicked_project(tmp_path)
    path.write_text(path.read_text().replace("tracked.csv", "picks.csv"))
    with refused(VopdError):
        solve_flight(path)


def test_a_tracked_file_that_is_missing_or_has_lost_everything(tmp_path: Path) -> None:
    path, tracked = clicked_project(tmp_path), tmp_path / "tracked.csv"
    rows = [row for row in tracked.read_text().splitlines() if not row[:1].isdigit()]
    tracked.write_text("\n".join([*rows, "1,mast,,,,0,,,,,,lost\n"]))
    with refused(VopdError):
        solve_flight(path)
    tracked.unlink()
    path.write_text(path.read_text().replace('file = "picks.csv"\n', ""))
    with refused(VopdError):
        solve_flight(path)
    path.write_text(path.read_text().replace("tracked = ", "tracked_from = "))
    path.write_text(path.read_text().replace('"tracked.csv"', '"unknown"'))
    with refused(VopdError):
        solve_flight(path)


def test_tracks_that_are_not_of_one_camera_that_moves_are_refused(tmp_path: Path) -> None:
    """One attitude is by picks, a lens of each image is of photographs, and places are near it."""
    path, tracked = clicked_project(tmp_path), tmp_path / "tracked.csv"
    toml, rows = path.read_text(), tracked.read_text()
    place = "[position]\nlat_deg = 47.6435\nlon_deg = 16.4759\nh_m = 540.0\n"
    stands = toml.replace('[track]\nfile = "track.csv"\n', place)
    stands = stands.replace('sigma_t_s = "exact"\n', '[solve]\nframes = "one"\n')
    path.write_text(stands)
    with refused(VopdError):
        solve_flight(path)
    path.write_text(toml)
    head, last = rows.rstrip("\n").rsplit("\n", 1)
    cells = last.split(",")

    def with_last_at(u_px: str) -> str:
        return "\n".join([head, ",".join([*cells[:2], u_px, *cells[3:]]), ""])

    tracked.write_text(with_last_at("-19200.5"))  # ten widths of the image
    with refused(VopdError):
        solve_flight(path)
    tracked.write_text(with_last_at("-19199.5"))
    assert read_flight(str(path)).picks.pixel[-1, 0] == -19199.5
    click = next(line for line in rows.splitlines() if line.endswith(",clicked"))
    frame, mark, _, *others = click.split(",")
    tracked.write_text(rows.replace(click, ",".join([frame, mark, "1e6", *others])))
    with refused(VopdError):  # tracking again alone would not help
        solve_flight(path)
    tracked.write_text(rows)
    (tmp_path / "lenses.csv").write_text("frame,lens\n0,a.json\n1,b.json\n")
    for name in "ab":
        camera = {"width": 1920, "height": 1080, "projection_type": "brown", "focal": 0.75}
        (tmp_path / f"{name}.json").write_text(json.dumps({"camera": camera}))
    lens = next(line for line in toml.splitlines() if line.startswith("lens ="))
    path.write_text(toml.replace(lens, 'of_images = "lenses.csv"'))
    with refused(VopdError):
        solve_flight(path)


@pytest.mark.parametrize("at_once", [1, 1000, AT_ONCE])
def test_errors_by_clicks_have_their_covariance_in_parts_of_any_size(
    at_once: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Their squares are B B' of all errors of clicks, where those reach two picks of a frame."""
    monkeypatch.setattr("vopd.flight.solve.clicks.AT_ONCE", at_once)
    picks = clicked_flight(np.random.default_rng(3), 20, 5, every=20, reach=20).flight.picks
    assert picks.clicks is not None
    slots = FrameSlots.of(picks.frame, 20)
    found = errors_of_frames(picks.clicks, slots, np.ones(len(picks.frame), bool))
    covariance = found @ found.swapaxes(1, 2)
    variance = picks.clicks.variance_px2(len(picks.frame))
    for pick in range(len(picks.frame)):
        own = slots.slot[pick] + np.array([0, slots.slots])
        part = covariance[picks.frame[pick]][np.ix_(own, own)]
        assert_close("table value", part, variance[pick])


def test_the_next_click_lowers_the_sigma_as_a_solve_with_it_does() -> None:
    one = clicked_flight(np.random.default_rng(3), 20, 5, every=20, reach=20)
    joint = solve_jointly(one.flight, priors_of(one.flight))
    found = next_clicks(joint)
    assert len(found) == 3
    picks = one.flight.picks
    for k, click in enumerate(found):
        some = found[: k + 1]
        more = replace(
            picks,
            frame=np.append(picks.frame, [one.frame for one in some]),
            landmark=np.append(picks.landmark, [one.landmark for one in some]),
            pixel=np.vstack([picks.pixel, [one.pixel for one in some]]),
            sigma_px=np.append(picks.sigma_px, np.full(k + 1, 0.5)),
        )
        flight = replace(one.flight, picks=more)
        again = solve_jointly(flight, priors_of(flight))
        rms = np.sqrt(np.einsum("fii->f", again.covariance.turn).mean() / 3.0)
        assert_close("dense minimum", click.after_deg / np.degrees(rms), 1.0)


def test_the_next_click_may_be_of_any_frame_with_an_attitude() -> None:
    """The first half of the flight has none: its frames have at most one click, and no track."""
    one = clicked_flight(np.random.default_rng(3), 20, 5, every=20, reach=20)
    rows = one.rows
    late = with_rows(one.flight, rows.where((rows.frame >= 10) | (rows.frame == rows.from_frame)))
    found = next_clicks(solve_jointly(late, priors_of(late)))
    assert found and all(click.frame >= 10 for click in found)


def test_clicks_that_tell_little_are_not_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """A landmark is clicked in every fourth frame, or in all; and of each one click is told."""
    few, many, all_ = (
        clicked_flight(np.random.default_rng(3), 20, 5, every=every, apart=apart, reach=20).flight
        for every, apart in ((20, 3), (4, 3), (1, 0))
    )
    one, other, every = (solve_jointly(flight, priors_of(flight)) for flight in (few, many, all_))
    found = next_clicks(one, 8)
    assert all(each.after_deg < 0.98 * each.before_deg for each in found)
    assert len({each.landmark for each in found}) == len(found) > 1
    assert next_clicks(other) == [] and next_clicks(every) == []
    assert_approved(next_click_texts(other))
    monkeypatch.setattr(next_click, "LEAST_GAIN", 0.0)
    little = next_clicks(other)
    assert len(little) == 3
    assert all(0.98 * each.before_deg < each.after_deg < each.before_deg for each in little)
    assert next_clicks(every) == []  # there is none


# Tracks of other programs


def test_a_flight_without_clicks_is_not_asked_for_more(tmp_path: Path) -> None:
    """Nor has it frames that are lost or marks that are hidden, or residuals of followed picks."""
    path = write_project(tmp_path)
    one = solve_flight(path).estimates.joint
    assert one is not None
    assert next_clicks(one) == next_places(one) == next_click_texts(one) == []
    assert np.isnan(correlation_of_neighbours(one))
    (tmp_path / "picks.csv").unlink()
    assert hidden_marks(read_project(str(path)), ("church",)) == frozenset()


def test_tracks_of_another_program_are_said_to_share_their_clicks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each landmark has one error in all frames, as a track has that no click is known of."""
    toml = CLICKED_TOML.replace("tracked.csv", "theirs.csv").replace(
        'tracked = "', 'tracked_from = "unknown"\ntracked = "'
    )
    path = write_project(tmp_path, toml)
    error = np.random.default_rng(1).normal(0.0, 0.5, (6, 2))
    noise = np.random.default_rng(2).normal(0.0, 0.05, (5, 6, 2))
    names = ("church", "mast", "bridge", "corner", "tower", "well")
    rows = [
        f"{frame},{name},{u:.4f},{v:.4f}"
        for frame, seen in enumerate(pixels() + error + noise)
        for name, (u, v) in zip(names, seen, strict=True)
    ]
    (tmp_path / "theirs.csv").write_text("\n".join(["frame,landmark,u_px,v_px", *rows, ""]))
    result = solve_flight(path)
    assert result.read.picks.followed is not None and result.read.picks.followed.all()
    history = result.history()
    left = left_out_text(history, history.about.words.sigma_keys)
    assert "click ([picks] tracked_from" in left
    assert result.estimates.joint is not None
    monkeypatch.setattr("vopd.flight.project.tracked_picks.FEWEST", 20)
    (said,) = followed_findings(result.flight, result.estimates.joint)
    assert "5 frames tell no more than 1, and it is 2.2 times less certain" in said.message
