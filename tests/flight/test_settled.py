"""Flights solved with their positions and landmarks: what is stated counts, row by row."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.joint_flights import Scene, axes, drone, flight_of, turned_out
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.attitude.history import HistoryOptions
from vopd.attitude.included import included_text, left_out_text
from vopd.attitude.sigmas import Sigmas
from vopd.estimate import Estimate
from vopd.export.tables import dataframe
from vopd.flight import estimate
from vopd.flight.estimate import FlightEstimates, flight_estimate
from vopd.flight.flight import Flight, FlightOptions, TrackFixes
from vopd.flight.result import FlightResult, solve_flight_read
from vopd.flight.solve import joint
from vopd.flight.solve.equations import Priors
from vopd.flight.solve.errors import priors_of, with_sigmas
from vopd.flight.solve.rotations import SolvedFlight, solve

GPS = (2.0, 2.0, 4.0)


def own_fixes(frames: int, sigma_m: tuple[float, ...] | Floats = GPS) -> TrackFixes:
    sigma = np.broadcast_to(sigma_m, (frames, 3)).astype(np.float64)
    return TrackFixes(np.arange(frames), np.ones((frames, 1)), sigma)


def drawn(
    priors: Priors, seed: int = 1, frames: int = 6, sigma_px: float = 1.0, stated: bool = True
) -> tuple[Flight, Scene]:
    rng = np.random.default_rng(seed)
    scene = drone(rng, frames, 6)
    flight = flight_of(rng, scene, sigma_px, priors)
    picks = replace(flight.picks, one_sigma_px=sigma_px, stated=stated)
    picks = replace(picks, least_sigma_px=sigma_px if stated else 0.3)
    return replace(flight, picks=picks), scene


def rotations(result: FlightResult) -> Floats:
    return result.estimates.solved.attitudes.rotation


def test_exact_positions_and_landmarks_give_the_rotations_of_each_frame_alone() -> None:
    flight, _ = drawn(Priors())
    result = solve_flight_read(flight)
    assert np.array_equal(rotations(result), solve(flight).attitudes.rotation)
    assert result.estimate.errors is None and result.estimate.moved is None


def test_what_exact_places_give_for_the_reading_sigma_serves_tests_and_history(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Frames are estimated once; normal equations formed to look for errors of the inputs."""
    made, formed, normal = list[int](), list[object](), joint.Normal

    def counted(solved: SolvedFlight, whole: FlightEstimates | None = None) -> Estimate:
        made.append(len(solved.flight.frame))
        return flight_estimate(solved, whole)

    def noted(*arguments: Any) -> joint.Normal:
        formed.append(arguments)
        return normal(*arguments)

    monkeypatch.setattr(estimate, "flight_estimate", counted)
    monkeypatch.setattr(joint, "Normal", noted)
    flight, _ = drawn(Priors(), stated=False)
    result = solve_flight_read(flight)
    freedom = result.history().uncertainty.reading.freedom
    assert_close("degrees of freedom", freedom, 2.0 * 36 - 3 * 6)
    assert [frames for frames in made if frames > 1] == [6] and len(formed) == 1


def test_positions_that_are_held_give_the_same_rotations_and_the_position_as_a_component() -> None:
    flight, _ = drawn(Priors(own_fixes(6)))
    held = replace(flight, options=FlightOptions(solve_position=False))
    result = solve_flight_read(held)
    assert np.array_equal(rotations(result), solve(flight).attitudes.rotation)
    assert result.history().uncertainty.components["position"][:, 3:6].min() > 0.1
    assert np.abs(rotations(result) - rotations(solve_flight_read(flight))).max() > 1e-3


def test_a_stated_position_weighs_and_the_table_has_the_place_as_solved() -> None:
    flight, scene = drawn(Priors(own_fixes(6)))
    result = solve_flight_read(flight)
    off, given = (
        np.linalg.norm(at - scene.camera_m, axis=1)
        for at in (result.estimates.solved.camera_m, flight.path.position_m)
    )
    assert np.median(off) < 0.5 * np.median(given)
    table = dataframe([result.history()])
    moved = table[["moved_east_m", "moved_north_m", "moved_up_m"]].to_numpy()
    found, stated = result.estimates.solved.camera_m, flight.path.position_m
    assert_close(
        "place of a solve", np.linalg.norm(moved, axis=1), np.linalg.norm(found - stated, axis=1)
    )
    sigma = table[["sigma_east_m", "sigma_north_m", "sigma_up_m"]].to_numpy()
    assert (sigma < GPS).all() and (sigma > 0.0).all()


def test_each_row_counts_by_itself() -> None:
    """Frames in turn with an RTK fix and with a float solution."""
    sigma = np.where(np.arange(6) % 2, 2.0, 0.02)[:, None] * np.ones(3)
    flight, _ = drawn(Priors(own_fixes(6, sigma)))
    own = solve_flight_read(flight).history().estimate.position_sigma
    assert own is not None and own[1::2].min() > 5.0 * own[::2].max()


def test_a_camera_that_stands_has_one_place_in_all_frames() -> None:
    place = dict.fromkeys(("east", "north", "up"), 0.3)
    flight, _ = drawn(Priors(None, None, place))
    one = solve_flight_read(flight).history()
    assert one.estimate.moved is not None
    assert_close("place of a solve", one.estimate.moved, np.tile(one.estimate.moved[0], (6, 1)))
    assert "position" in one.uncertainty.common
    assert (np.linalg.eigvalsh(one.uncertainty.covariance_common_deg2) > 0.0).any(axis=1).all()


def test_a_place_that_is_guessed_far_off_leaves_the_reading_sigma_as_it_is() -> None:
    """Residuals at the stated place are longer than the focal length: they are the place's."""
    flight, _ = drawn(Priors(), frames=1, stated=False)
    sigma_m, own, found = np.full(3, 300.0), axes(flight.path.position_m), []
    for off_m in ([0.0, 0.0, 0.0], [250.0, 0.0, 0.0]):
        moved = flight.path.position_m + turned_out(own, np.array([off_m]))
        path = replace(flight.path, position_m=moved, bias_sigma_m=sigma_m)
        found.append(solve_flight_read(replace(flight, path=path)).estimates.reading)
    near, far = found
    assert near is not None and far is not None and far.source == near.source == "residuals"
    assert_close("reading sigma of two starts", far.sigma, near.sigma)


def test_what_is_stated_and_not_solved_for_is_propagated() -> None:
    flight, _ = drawn(Priors(own_fixes(6)))
    parameter = {"focal": 3.0, "k1": 0.01, "clock": 0.1, "refraction": 0.06}
    speed = np.tile([3.0, 2.0, 0.0], (6, 1))
    flight = replace(
        flight,
        options=FlightOptions(parameter_sigma=parameter),
        path=replace(flight.path, velocity_m_s=speed),
    )
    found = solve_flight_read(flight).history().uncertainty
    common = ["focal", "distortion", "time", "refraction"]
    assert list(found.components) == ["reading", "position", *common]
    assert list(found.common) == common
    squares = sum(one**2 for one in found.components.values())
    assert_close("ratio", found.total, np.sqrt(squares))


# The reading sigma


def test_a_stated_reading_sigma_is_used_as_it_is() -> None:
    flight, _ = drawn(Priors(own_fixes(6)))
    reading = solve_flight_read(flight).history().uncertainty.reading
    assert (reading.sigma, reading.freedom, reading.source) == (1.0, np.inf, "stated")


def test_one_that_the_residuals_reject_gives_way_to_theirs() -> None:
    flight, _ = drawn(Priors(own_fixes(20)), frames=20, sigma_px=3.0)
    picks = replace(flight.picks.with_sigma(0.5), least_sigma_px=0.5)
    reading = solve_flight_read(replace(flight, picks=picks)).history().uncertainty.reading
    assert 2.0 < reading.sigma < 4.0 and reading.source == "residuals" and reading.freedom < 180.0


def test_one_that_is_not_stated_is_that_with_which_the_flight_is_solved() -> None:
    flight, _ = drawn(Priors(own_fixes(20)), frames=20, sigma_px=2.0, stated=False)
    wrong = replace(flight, picks=flight.picks.with_sigma(1.0))
    found = [solve_flight_read(one) for one in (flight, wrong)]
    sigmas = [one.history().uncertainty.reading.sigma for one in found]
    assert_close("reading sigma by rounds", sigmas[0], sigmas[1])
    again = solve_flight_read(with_sigmas(flight, Sigmas(reading=sigmas[0])))
    assert_close("rotation by another reading sigma", rotations(again), rotations(found[0]))
    assert 1.4 < sigmas[0] < 2.8


# Standard deviations that the user gives


EVERY_SIGMA = (
    "position", "landmark", "focal_length", "time_s", "reading", "velocity", "wind", "mount_deg"
)  # fmt: skip


@pytest.mark.parametrize("name", EVERY_SIGMA)
def test_the_user_s_standard_deviations_are_those_of_a_project_that_states_them(name: str) -> None:
    flight, _ = drawn(Priors(own_fixes(6), np.full((6, 3), 0.5)))
    speed = np.tile([3.0, 2.0, 0.0], (6, 1))
    flight = replace(flight, path=replace(flight.path, velocity_m_s=speed))
    given = Sigmas(**{name: 0.7})
    one = solve_flight_read(flight).history(given)
    other = solve_flight_read(with_sigmas(flight, given)).history()
    assert np.array_equal(one.estimate.vehicle_deg, other.estimate.vehicle_deg)
    assert np.array_equal(one.uncertainty.total, other.uncertainty.total, equal_nan=True)
    plain = solve_flight_read(flight).history().uncertainty.total
    assert not np.array_equal(one.uncertainty.total, plain, equal_nan=True)


def test_standard_deviations_that_are_given_later_leave_those_from_before() -> None:
    """No picture of a flight has fiducials, whose errors would move it as a whole."""
    flight, _ = drawn(Priors(own_fixes(6), np.full((6, 3), 0.5)))
    first, then = Sigmas(landmark=0.7, mount_deg=0.3), Sigmas(reading=0.4, wind=2.0, fiducial=5.0)
    both = Sigmas(landmark=0.7, mount_deg=0.3, reading=0.4, wind=2.0)
    one = solve_flight_read(with_sigmas(flight, first)).history(then)
    other = solve_flight_read(flight).history(both)
    assert one.uncertainty.components.keys() == other.uncertainty.components.keys()
    assert np.array_equal(one.uncertainty.total, other.uncertainty.total, equal_nan=True)


def test_a_standing_camera_s_position_is_given_for_all_frames_together() -> None:
    flight, _ = drawn(Priors())
    path = replace(flight.path, position_m=np.tile(flight.path.position_m[3], (6, 1)))
    still = with_sigmas(replace(flight, path=path), Sigmas(position=2.0))
    assert priors_of(still).parameter == dict.fromkeys(("east", "north", "up"), 2.0)
    moving = priors_of(with_sigmas(flight, Sigmas(position=2.0)))
    assert moving.fixes is not None and moving.fixes.sigma_m.tolist() == [[2.0] * 3] * 6


# What the standard deviations include


def test_the_errors_that_are_included_and_those_that_are_not_are_named() -> None:
    flight, _ = drawn(Priors(own_fixes(6)))
    one = solve_flight_read(flight).history()
    assert_approved([included_text(one), left_out_text(one, one.about.words.sigma_keys)])


def test_an_error_of_the_angles_of_attack_alone_is_told_by_these() -> None:
    """A clock may turn the vehicle by next to nothing, and alpha by much."""
    flight, _ = drawn(Priors(own_fixes(6)))
    one = solve_flight_read(flight).history()
    tiny, large = np.full((1, 3), 3e-6), np.array([[0.4, 0.2, 0.1]])
    own = {"velocity": np.hstack([tiny, tiny, large]), "landmark": np.hstack([tiny, tiny, tiny])}
    uncertainty = replace(one.uncertainty, components={n: o.repeat(6, 0) for n, o in own.items()})
    assert_approved([included_text(replace(one, uncertainty=uncertainty))])


def test_an_error_of_both_is_told_by_both() -> None:
    """A clock of seconds turns a glider's alpha by all, and its yaw as much as the picks do."""
    flight, _ = drawn(Priors(own_fixes(6)))
    one = solve_flight_read(flight).history()
    turn, none, attack = (np.full((1, 3), size) for size in (1.1, 0.0, 220.0))
    own = {
        "reading": np.hstack([turn, turn, turn]), "time": np.hstack([turn, turn, attack]),
        "wind": np.hstack([none, none, turn]), "position": np.hstack([turn, turn / 20.0, attack]),
    }  # fmt: skip
    uncertainty = replace(one.uncertainty, components={n: o.repeat(6, 0) for n, o in own.items()})
    assert_approved([included_text(replace(one, uncertainty=uncertainty))])


def test_parts_of_a_long_flight_say_the_same() -> None:
    flight, _ = drawn(Priors(own_fixes(6)))
    result = solve_flight_read(flight)
    parts = result.history_parts(HistoryOptions())
    assert included_text(parts.head) == included_text(parts.whole)


def test_more_landmarks_than_can_be_solved_for_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    flight, _ = drawn(Priors(None, np.full((6, 3), 0.5)))
    monkeypatch.setattr(joint, "MOST_COMMON", 17)
    with refused():
        solve_flight_read(flight)
    held = replace(flight, options=FlightOptions(solve_position=False))
    assert solve_flight_read(held).solved.all()
