"""Positions that the picks do not hold, and other positions that fit as well."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

from tests.approved.texts import refused
from tests.kit.joint_flights import LensTruth, axes, drone, flight_of
from tests.tolerances import assert_close
from vopd.attitude.history import History
from vopd.flight.flight import Flight, TrackFixes
from vopd.flight.result import solve_flight_read
from vopd.flight.solve import held
from vopd.flight.solve.equations import Priors
from vopd.flight.solve.errors import priors_of
from vopd.flight.solve.held import other_solutions_deg, position_ratio
from vopd.flight.solve.joint import PASSES, JointSolution, covariance, solve_jointly, widened
from vopd.flight.solve.rotations import solve


def own_fixes(frames: int, sigma_m: tuple[float, float, float]) -> Priors:
    return Priors(
        TrackFixes(np.arange(frames), np.ones((frames, 1)), np.tile(sigma_m, (frames, 1)))
    )


def nadir(seed: int, landmarks: int, sigma_m: tuple[float, float, float]) -> tuple[Flight, Priors]:
    """Five frames from 100 m, straight down."""
    rng, priors = np.random.default_rng(seed), own_fixes(5, sigma_m)
    scene = drone(rng, 5, landmarks, tilt_deg=3.0)
    flight = flight_of(rng, scene, 1.0, priors)
    return replace(flight, picks=replace(flight.picks, stated=True)), priors


@pytest.mark.parametrize("sigma_m", [(2.0, 2.0, 4.0), (2.0, 3.0, 0.0)])
def test_the_ratio_is_the_largest_in_any_direction(sigma_m: tuple[float, float, float]) -> None:
    """By the generalised eigenvalues of both covariances; an exact height is none."""
    flight, priors = nadir(1, 4, sigma_m)
    found = covariance(solve_jointly(flight, priors))
    free = np.flatnonzero(sigma_m)
    for ratio, after, before in zip(
        position_ratio(found), found.place_m2, found.place_prior_m2, strict=True
    ):
        values = eigh(after[np.ix_(free, free)], before[np.ix_(free, free)], eigvals_only=True)
        assert_close("ratio of positions", ratio, np.sqrt(values[-1]))


def history_of(flight: Flight) -> History:
    return solve_flight_read(flight).history()


def test_two_landmarks_hold_no_position_and_six_do() -> None:
    flight, priors = nadir(2, 2, (2.0, 2.0, 4.0))
    assert_close(
        "ratio of positions", position_ratio(covariance(solve_jointly(flight, priors))), 1.0
    )
    assert history_of(flight).flags.raised["position_not_held"].all()
    assert not history_of(nadir(2, 6, (2.0, 2.0, 4.0))[0]).flags.raised["position_not_held"].any()


def test_a_position_of_a_third_of_a_metre_matters_from_100_m() -> None:
    """.3 m north and .3 m east are .17 degree each: .06 square degrees together."""
    flight, _ = nadir(4, 2, (0.3, 0.3, 0.0))
    flight = replace(flight, picks=replace(flight.picks, sigma_px=0.1 * flight.picks.sigma_px))
    assert history_of(flight).flags.raised["position_not_held"].all()


def test_a_position_that_hardly_matters_is_not_flagged() -> None:
    """Centimetres of 100 m: the picks cannot improve them, and need not."""
    flight, priors = nadir(3, 4, (0.02, 0.02, 0.04))
    assert (position_ratio(covariance(solve_jointly(flight, priors))) > 0.9).all()
    assert not history_of(flight).flags.raised["position_not_held"].any()


@pytest.mark.parametrize(("seed", "expected"), [(10, [True, True]), (7, [False, True])])
def test_three_landmarks_below_may_have_a_second_position(seed: int, expected: list[bool]) -> None:
    """Positions to 10 m from 100 m; a fourth landmark would tell."""
    rng, priors = np.random.default_rng(seed), own_fixes(2, (10.0, 10.0, 20.0))
    flight = flight_of(rng, drone(rng, 2, 3, tilt_deg=3.0), 1.0, priors)
    history = history_of(replace(flight, picks=replace(flight.picks, stated=True)))
    assert history.flags.raised["second_solution"].tolist() == expected
    turned = other_solutions_deg(solve_jointly(flight, priors))
    assert np.isfinite(turned).tolist() == expected
    named = [
        f"{one:.2f} degrees" in text for one, text in zip(turned, history.flag_text, strict=True)
    ]
    assert named == expected


def solved_too_high(seed: int) -> JointSolution:
    """Two frames of three landmarks, their places 60 m too high."""
    rng, priors = np.random.default_rng(seed), own_fixes(2, (10.0, 10.0, 20.0))
    flight = flight_of(rng, drone(rng, 2, 3, tilt_deg=3.0), 1.0, priors)
    place_m = flight.path.position_m
    higher = place_m * (1.0 + 60.0 / np.linalg.norm(place_m, axis=1, keepdims=True))
    return solve_jointly(replace(flight, path=replace(flight.path, position_m=higher)), priors)


@pytest.mark.parametrize("seed", [23, 37, 57])
def test_a_long_valley_leads_to_its_bottom(seed: int) -> None:
    """A whole step rises and a small one falls there: the damping has more than two sizes."""
    solution = solved_too_high(seed)
    assert solution.solved.attitudes.converged.all() and solution.passes < PASSES


@pytest.mark.parametrize("seed", [7, 12])
def test_a_second_position_may_fit_as_badly_as_the_first(seed: int) -> None:
    """Places are 60 m too high, three standard deviations: the cost is far above what is usual."""
    solution = solved_too_high(seed)
    assert solution.normal.frame_cost[1] > 10.0
    assert np.isfinite(other_solutions_deg(solution)).tolist() == [False, True]


@pytest.mark.parametrize("clock", [np.inf, 5.0])
def test_a_position_that_a_clock_moves_has_no_second_one(clock: float) -> None:
    """One frame of three landmarks, exact fixes: it can only be on the line of the flight."""
    rng, priors = np.random.default_rng(10), Priors(None, None, {"clock": clock})
    scene, speed_m_s = drone(rng, 1, 3, tilt_deg=3.0), (3.0, 4.0, 0.5)
    solution = solve_jointly(flight_of(rng, scene, 1.0, priors, velocity_m_s=speed_m_s), priors)
    assert np.isnan(other_solutions_deg(solution)).all()


def test_positions_that_frames_share_or_that_are_known_well_are_not_searched() -> None:
    rng = np.random.default_rng(10)
    scene = drone(rng, 2, 3, tilt_deg=3.0)
    shared = TrackFixes(np.zeros(2, np.int64), np.full((2, 2), 0.5), np.full((2, 3), 10.0))
    for priors in (Priors(shared), own_fixes(2, (2.0, 2.0, 4.0)), Priors(None, None, {"up": 10.0})):
        solution = solve_jointly(flight_of(rng, scene, 1.0, priors), priors)
        assert np.isnan(other_solutions_deg(solution)).all()


@pytest.mark.parametrize("free", [("clock",), ("focal", "aspect", "centre", "k1", "clock")])
def test_free_parameters_that_the_picks_cannot_hold(free: tuple[str, ...]) -> None:
    """Five frames of two landmarks have five coordinates more than angles; none has a velocity."""
    flight, _ = nadir(4, 2, (0.3, 0.3, 0.0))
    still = replace(flight, path=replace(flight.path, velocity_m_s=None))
    with refused():
        solve_flight_read(replace(still, options=replace(still.options, free=free)))
    if len(free) > 1:  # five for five coordinates: those that are not held stay as they are stated
        just = replace(still, options=replace(still.options, free=free[:-1]))
        assert "focal" not in solve_flight_read(just).flight.options.free


@pytest.mark.parametrize(
    ("free", "within"),
    [(("focal", "k1"), False), (("focal", "k1"), True), (("focal", "centre"), True)],
)
def test_a_parameter_is_undetermined_by_its_variance_where_others_are_known(
    free: tuple[str, ...], within: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """That of picks of .3 px whose images the parameter moves, by differences of the true lens."""
    rng = np.random.default_rng(6)
    scene = drone(rng, 3, 8)
    flight = flight_of(rng, scene, 0.3, Priors())
    flight = replace(flight, options=replace(flight.options, free=free))
    joint = solve_jointly(flight, priors_of(flight))
    variance = np.diag(joint.factored.common)
    away = scene.landmark_m[scene.landmark] - scene.camera_m[scene.frame]
    ray = np.einsum(
        "pij,pjk,pk->pi", scene.rotation[scene.frame], axes(scene.camera_m)[scene.frame], away
    )
    inflated = []
    for name in joint.model.names:
        if name in LensTruth._fields and np.isinf(priors_of(flight).parameter[name]):
            step = 1e-3 * max(abs(getattr(LensTruth(), name)), 1.0)
            other = LensTruth()._replace(**{name: getattr(LensTruth(), name) + step})
            slope = (other.image(ray) - LensTruth().image(ray)) / step
            known = 0.3**2 / (slope**2).sum()
            inflated.append(variance[joint.model.names.index(name)] / known)
    limit = max(inflated) * (1.5 if within else 0.05)
    monkeypatch.setattr(held, "UNDETERMINED", limit)
    first = solve(widened(flight, priors_of(flight)), np.zeros(len(flight.picks.frame), bool))
    found = held.undetermined(flight, np.zeros(len(flight.picks.frame), bool), first)
    assert (found is None) == within
