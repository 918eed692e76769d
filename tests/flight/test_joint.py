"""The joint solve: its algebra and its minimum against dense matrices, its edges."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.stats import chi2

from tests.approved.texts import refused
from tests.kit.dense_minimum import dense_minimum, drawn_problem
from tests.kit.flight_project import uneven_flight
from tests.kit.joint_flights import (
    Dense,
    drone,
    flight_of,
    random_problem,
    scaled_close,
)
from tests.tolerances import assert_close, within
from vopd.arrays import Bools
from vopd.estimate import COMMON_PART
from vopd.findings import VopdError
from vopd.flight.flight import Flight, FlightOptions, TrackFixes
from vopd.flight.misfits.misfit import log_likelihood, size_spoken_for
from vopd.flight.solve.equations import Priors
from vopd.flight.solve.errors import places_by_stated
from vopd.flight.solve.joint import (
    JointSolution,
    covariance,
    covariance_of_sums,
    propagated,
    solve_jointly,
)
from vopd.flight.solve.rotations import LOSSES, solve
from vopd.flight.solve.sizes import (
    explained,
    residual_freedom,
    sigma_freedom,
    size_of_residuals,
)

NAMES = ("least-squares", "huber", "cauchy")

# Elimination, against dense matrices of the same rows


@cache
def solved(loss: str, width: int) -> tuple[JointSolution, Dense]:
    """A random problem; every second one of a rolling shutter."""
    rng = np.random.default_rng(10 * width + len(loss))
    flight, priors, readout = random_problem(rng, width, loss, width % 2 == 1)
    solution = solve_jointly(flight, priors, readout=readout)
    assert solution.solved.attitudes.converged.all()
    return solution, Dense(solution)


PROBLEMS = [("least-squares", width) for width in (0, 1, 2, 3, 4)]
PROBLEMS += [(loss, width) for loss in NAMES[1:] for width in (0, 2, 3)]


@pytest.mark.parametrize(("loss", "width"), PROBLEMS)
def test_covariances_are_those_of_the_dense_equations(loss: str, width: int) -> None:
    solution, dense = solved(loss, width)
    found = covariance(solution)
    assert set(found.component) == {"reading", *dense.component}
    total = np.zeros_like(dense.inverse)
    for name, own in found.component.items():
        total += dense.part(name)
        expected = dense.turns_and_times(dense.part(name))
        for rows, columns in ((slice(3), slice(3)), (slice(3), 3), (3, 3)):
            scaled_close("joint algebra", own[:, rows, columns], expected[:, rows, columns])
    scaled_close("joint algebra", found.turn, dense.turns(total))
    place, inverse = dense.place, dense.inverse
    scaled_close("joint algebra", found.place_m2, place @ inverse @ place.swapaxes(1, 2))
    prior = np.concatenate([np.zeros(3 * dense.frames), 1.0 / dense.prior[3 * dense.frames :]])
    scaled_close("joint algebra", found.place_prior_m2, place * prior @ place.swapaxes(1, 2))
    turned = inverse[: 3 * dense.frames].reshape(dense.frames, 3, -1)
    scaled_close("joint algebra", found.turn_place, turned @ place.swapaxes(1, 2))


@pytest.mark.parametrize(("loss", "width"), PROBLEMS)
def test_sums_and_propagated_errors_are_those_of_the_dense_equations(loss: str, width: int) -> None:
    solution, dense = solved(loss, width)
    rng = np.random.default_rng(width)
    weight, by = rng.normal(size=(dense.frames, 3, 2)), np.zeros((len(dense.inverse), 2))
    by[: 3 * dense.frames] = weight.reshape(-1, 2)
    whole, component = covariance_of_sums(solution, weight)
    assert set(component) == {"reading", *dense.component}
    for name, own in component.items():
        scaled_close("joint algebra", own, by.T @ dense.part(name) @ by)
    scaled_close("joint algebra", whole, sum(component.values()))
    change = rng.normal(size=(len(dense.residual) // 2, 2, 2))
    weighted = dense.weight[:, None] * change.reshape(-1, 2)
    expected = -(dense.inverse @ dense.rows.T @ weighted)
    moved, _, common = propagated(solution, change)
    scaled_close("joint algebra", moved, expected[: 3 * dense.frames].reshape(-1, 3, 2))
    scaled_close("joint algebra", common, expected[dense.common :])


@pytest.mark.parametrize(("loss", "width"), PROBLEMS)
def test_the_gradient_at_a_solution_is_nothing(loss: str, width: int) -> None:
    solution, dense = solved(loss, width)
    state, free = solution.state, solution.model.free
    errors = [state.fix_m.ravel(), state.parameter, state.landmark_m[free].ravel()]
    error = np.concatenate([np.zeros(3 * dense.frames), *errors])
    gradient = dense.rows.T @ (dense.weight * dense.residual) - dense.prior * error
    assert np.sqrt(gradient @ dense.inverse @ gradient) < within("joint minimum")


@pytest.mark.parametrize("width", [0, 1, 2, 3, 4])
def test_residuals_at_the_stated_places_have_the_joint_cost(width: int) -> None:
    """With the marginal covariance of readings, places, landmarks and what is common."""
    solution, dense = solved("least-squares", width)
    residual = solution.stated_residual.ravel()
    weight = dense.marginal_weight()
    assert_close("joint cost", residual @ weight @ residual, solution.normal.cost)
    assert_close("joint residual", weight @ residual, dense.residual)
    sign, logarithm = np.linalg.slogdet(dense.normal)
    assert sign == 1.0
    assert_close("joint log determinant", solution.factored.log_determinant, logarithm)


@pytest.mark.parametrize("width", [0, 1, 2, 3, 4])
def test_degrees_of_freedom_are_traces_of_the_marginal_weights(width: int) -> None:
    """Of the residuals W, of the picks' unit covariance; and of their squares (W R)^2."""
    solution, dense = solved("least-squares", width)
    weight, prior = dense.marginal_weight(), dense.prior[3 * dense.frames :]
    left, exact = residual_freedom(solution)
    assert exact == len(dense.residual) - 3 * dense.frames
    assert_close("degrees of freedom", left, np.trace(weight))
    assert_close("degrees of freedom", sigma_freedom(solution), np.trace(weight @ weight))
    parts = 1.0 - np.diag(dense.inverse)[3 * dense.frames :] * prior
    names = [name.removesuffix(COMMON_PART) for name in dense.component]
    for name, own in explained(solution).items():
        same = [other in (name, "interpolation" * (name == "position")) for other in names]
        assert_close("degrees of freedom", own, parts[same].sum())


def test_the_size_of_all_residuals_is_the_joint_cost_over_its_freedom() -> None:
    solution, dense = solved("least-squares", 2)
    freedom = len(dense.residual) - 3 * dense.frames
    size, chance = size_of_residuals(solution, np.ones(dense.frames, bool))
    assert_close("degrees of freedom", size**2 * freedom, solution.normal.cost)
    assert_close("degrees of freedom", chance, chi2.sf(solution.normal.cost, freedom))
    assert size_of_residuals(solution, np.zeros(dense.frames, bool)) == (1.0, 1.0)


def test_frames_of_two_landmarks_have_one_degree_of_freedom() -> None:
    """Those of one have none."""
    flight = uneven_flight([2, 2, 1, 2, 2])
    solution = solve_jointly(flight, Priors())
    size, chance = size_of_residuals(solution, np.ones(5, bool))
    cost = solution.normal.frame_cost[[0, 1, 3, 4]].sum()
    assert_close("degrees of freedom", [4.0 * size**2, chance], [cost, chi2.sf(cost, 4)])


def test_what_stated_errors_explain_is_taken_from_the_cost() -> None:
    """Of those that are not solved for: as a step to the least cost would take, by Newton."""
    rng, loss = np.random.default_rng(7), "huber"
    flight, priors, _ = random_problem(rng, 2, loss, False)
    flight.picks.pixel[:3] += [8.0, -6.0]  # of which a robust loss believes less
    stated = {"k2": 0.05, "p2": 2e-3, "centre_v": 4.0}
    flight = replace(flight, options=FlightOptions(loss, parameter_sigma=stated))
    solution = solve_jointly(flight, priors)
    dense = Dense(solution)
    change = solution.stated[1].reshape(-1, len(stated))
    weighted = dense.weight[:, None] * change
    followed = dense.rows.T @ weighted
    left = change.T @ weighted - followed.T @ dense.inverse @ followed
    gradient = weighted.T @ dense.residual
    explained_by = gradient @ np.linalg.solve(np.eye(len(stated)) + left, gradient)
    size, _ = size_of_residuals(solution, np.ones(dense.frames, bool))
    freedom = len(dense.residual) - 3 * dense.frames
    assert explained_by > 1.0
    assert_close("joint cost", size**2 * freedom, solution.normal.cost - explained_by)


@pytest.mark.parametrize("width", [0, 2, 3])
def test_stated_errors_move_the_places_that_are_solved_for(width: int) -> None:
    """By a step of all unknowns; a clock that is late moves the cameras along their way besides."""
    flight, priors, _ = random_problem(np.random.default_rng(width), width, "huber", False)
    parameter = {name: one for name, one in priors.parameter.items() if "clock" not in name}
    stated = {"k2": 0.05, "clock": 0.05, "clock_rate": 1e-3}
    options = FlightOptions("huber", parameter_sigma=stated)
    solution = solve_jointly(replace(flight, options=options), replace(priors, parameter=parameter))
    dense = Dense(solution)
    change = solution.stated[1].reshape(-1, len(stated))
    step = -dense.inverse @ (dense.rows.T @ (dense.weight[:, None] * change))
    place = dense.place @ step
    velocity = np.array([3.0, 4.0, 0.5])  # of random problems
    since_s = (np.arange(dense.frames) - (dense.frames - 1) / 2.0) / 30.0
    place[:, :, 1] += 0.05 * velocity
    place[:, :, 2] += 1e-3 * since_s[:, None] * velocity
    scaled_close("joint algebra", places_by_stated(solution), place @ place.swapaxes(1, 2))


@pytest.mark.parametrize("width", [0, 1, 2, 3])
def test_the_likelihood_is_that_of_the_marginal_covariance(width: int) -> None:
    """Twice the restricted one, of readings in pixels; what all errors add, and no turn fits."""
    rng = np.random.default_rng(width)
    flight, priors, _ = random_problem(rng, width, "least-squares", False)
    sigma_px = rng.uniform(0.5, 2.0, len(flight.picks.frame))
    picks = replace(flight.picks, sigma_px=sigma_px)
    solution = solve_jointly(replace(flight, picks=picks), priors)
    dense = Dense(solution)
    turns, errors = np.split(dense.rows, [3 * dense.frames], axis=1)
    marginal = np.eye(len(errors)) + errors / dense.prior[3 * dense.frames :] @ errors.T
    fitted = turns.T @ np.linalg.solve(marginal, turns)
    logs = np.linalg.slogdet(marginal)[1] + np.linalg.slogdet(fitted)[1]
    logs += 2.0 * np.log(np.repeat(sigma_px, 2)).sum()
    found = log_likelihood(solution)
    assert_close("joint cost", found, -(solution.normal.cost + logs))


@pytest.mark.parametrize("component", ["reading", "position", "landmark"])
def test_the_size_that_is_spoken_for_is_the_likeliest(component: str) -> None:
    """Of errors drawn three times as large as stated; with others it is less likely."""
    rng = np.random.default_rng(5)
    fixes = TrackFixes(np.arange(12), np.ones((12, 1)), np.full((12, 3), 1.0))
    drawn = Priors(fixes, np.full((8, 3), 0.5), {"east": 1.0, "north": 1.0, "up": 1.0})
    flight = flight_of(rng, drone(rng, 12, 8), 1.0, drawn)
    stated, sigma_px = drawn.scaled(component, 1 / 3), 1 / 3 if component == "reading" else 1.0

    def of(factor: float) -> JointSolution:
        one_px = sigma_px * (factor if component == "reading" else 1.0)
        own = replace(flight, picks=flight.picks.with_sigma(one_px))
        return solve_jointly(own, stated.scaled(component, factor))

    first = of(1.0)
    found, gain = size_spoken_for(first, component)
    there, *beside = (log_likelihood(of(found * by)) for by in (1.0, 0.9, 1.1))
    assert there > max(beside) and 2.0 < found < 4.5
    assert_close("joint cost", gain, there - log_likelihood(first))


# The minimum, against a dense solution with a geometry of its own


@pytest.mark.parametrize("seed", [0, 1, 2, 3, 6, 8, 9])
def test_the_solution_is_that_of_dense_matrices(seed: int) -> None:
    """From a start a third of a sigma away; tools/dense_agreement.py takes fifty problems."""
    solution = solve_jointly(*drawn_problem(seed))
    found = dense_minimum(solution, np.random.default_rng(seed))
    assert np.abs(found.away).max() < within("dense minimum")
    if solution.model.loss is LOSSES["least-squares"]:
        own = np.sqrt(np.diag(np.linalg.inv(found.slopes.T @ found.slopes)))
        assert_close("sigma by differences", own, np.ones_like(own))


# Special cases and edges


def seen_flight(loss: str) -> Flight:
    rng = np.random.default_rng(5)
    return flight_of(rng, drone(rng, 12, 6, seen=0.8), 1.0, Priors(), loss=loss)


@pytest.mark.parametrize("arm_m", [None, (0.3, 0.1, -0.2)])
@pytest.mark.parametrize("loss", NAMES)
def test_with_nothing_else_unknown_it_is_the_solve_of_rotations(
    loss: str, arm_m: tuple[float, float, float] | None
) -> None:
    """To the last bit, and in no pass of its own."""
    flight = seen_flight(loss)
    if arm_m is not None:
        flight = replace(flight, path=replace(flight.path, lever_arm_m=np.array(arm_m)))
    expected = solve(flight)
    for priors in (Priors(), Priors(landmark_m=np.zeros((6, 3)))):
        found = solve_jointly(flight, priors)
        assert found.passes == 0
        for own, other in zip(found.solved.attitudes, expected.attitudes, strict=True):
            assert np.array_equal(own, other, equal_nan=True)
        assert np.array_equal(found.solved.camera_m, expected.camera_m)
        assert not found.moved_m.any()


@pytest.mark.parametrize("loss", NAMES)
def test_small_sigmas_tend_to_the_solve_of_rotations(loss: str) -> None:
    flight = seen_flight(loss)
    expected = solve(flight).attitudes.rotation
    fixes = TrackFixes(np.arange(12), np.ones((12, 1)), np.full((12, 3), 1e-6))
    for priors in (
        Priors(fixes),
        Priors(None, np.full((6, 3), 1e-6)),
        Priors(None, None, {"up": 1e-6}),
    ):
        found = solve_jointly(flight, priors)
        assert found.passes > 0
        assert_close("solve of a micrometre", found.solved.attitudes.rotation, expected)


def test_an_exact_coordinate_stays_among_others_that_move() -> None:
    """A height that is known, and a landmark known but for its height."""
    flight = seen_flight("least-squares")
    fixes = TrackFixes(np.arange(12), np.ones((12, 1)), np.tile([2.0, 2.0, 0.0], (12, 1)))
    marks = np.array([[0.0, 0.0, 1.0]] + [[0.0] * 3] * 4 + [[0.5] * 3])
    found = solve_jointly(flight, Priors(fixes, marks))
    assert found.model.free.tolist() == [0, 5]
    assert (np.abs(found.moved_m[:, :2]) > within("exact coordinate")).all()
    assert np.abs(found.moved_m[:, 2]).max() < within("exact coordinate")
    assert np.abs(found.state.landmark_m[0, :2]).max() < within("exact coordinate")
    assert np.abs(found.state.landmark_m[0, 2]) > within("exact coordinate")
    assert not found.state.landmark_m[1:5].any()
    level = Priors(replace(fixes, sigma_m=np.tile([2.0, 2.0, 1e-5], (12, 1))), marks)
    known, nearly = covariance(found), covariance(solve_jointly(flight, level))
    scaled_close("a hundredth of a millimetre", known.turn, nearly.turn)
    level_m2 = np.tile(np.diag([4.0, 4.0]), (12, 1, 1))
    assert_close("table value", known.place_prior_m2[:, :2, :2], level_m2)


@pytest.mark.parametrize("seed", [0, 1, 9])
def test_picks_far_off_under_a_robust_loss_still_depend_on_a_free_parameter(seed: int) -> None:
    """With the loss's own curvature they seemed to say less than nothing of it: it was refused."""
    rng = np.random.default_rng(seed)
    fixes = TrackFixes(np.arange(5), np.ones((5, 1)), np.full((5, 3), 3.0))
    flight = flight_of(rng, drone(rng, 5, 12), 0.7, Priors(fixes), loss="cauchy")
    assert solve_jointly(flight, Priors(parameter={"centre_u": np.inf, "centre_v": np.inf})).settles


def damaged(flight: Flight) -> Flight:
    """Frame 2 without a place, 4 without picks, 5 with one landmark, 6 with two."""
    position_m, picks = flight.path.position_m.copy(), flight.picks
    position_m[2] = np.nan
    count = {4: 0, 5: 1, 6: 2}
    keep = np.array([k < count.get(f, 9) for f, k in zip(picks.frame, picks.landmark, strict=True)])
    some = replace(
        picks, frame=picks.frame[keep], landmark=picks.landmark[keep], pixel=picks.pixel[keep],
        sigma_px=picks.sigma_px[keep],
    )  # fmt: skip
    return replace(flight, path=replace(flight.path, position_m=position_m), picks=some)


@pytest.mark.parametrize("more", [{}, {"focal": np.inf, "k1": 0.01}])
@pytest.mark.parametrize("loss", ["least-squares", "cauchy"])
def test_frames_without_an_attitude_change_no_other(loss: str, more: dict[str, float]) -> None:
    """The others are those of the flight without them, with the same fixes."""
    rng = np.random.default_rng(7)
    scene = drone(rng, 8, 5)
    fixes = TrackFixes(np.arange(8) // 2, np.tile([0.4, 0.6], (8, 1)), np.full((5, 3), 1.0))
    marks = np.full((5, 3), 0.1) if more else None
    flight = damaged(flight_of(rng, scene, 1.0, Priors(fixes), loss=loss))
    found = solve_jointly(flight, Priors(fixes, marks, more))
    known = np.isfinite(found.solved.attitudes.rotation[:, 0, 0])
    assert known.tolist() == [True, True, False, True, False, False, True, True]
    own = covariance(found)
    for part in (own.turn, own.place_m2, own.turn_place, *own.component.values()):
        assert np.array_equal(np.isfinite(part).all(axis=(1, 2)), known)

    rows = np.isin(flight.picks.frame, np.flatnonzero(known))
    left = part_of(flight, known, rows)
    fewer = replace(fixes, first=fixes.first[known], weight=fixes.weight[known])
    alone = solve_jointly(left, Priors(fewer, marks, more))
    rotation = found.solved.attitudes.rotation[known]
    assert_close("same solve", alone.solved.attitudes.rotation, rotation)
    assert_close("same solve", alone.state.fix_m, found.state.fix_m)
    scaled_close("joint algebra", covariance(alone).turn, own.turn[known])
    weight = np.zeros((8, 3, 3))
    weight[known] = np.eye(3) / known.sum()
    both = covariance_of_sums(found, weight), covariance_of_sums(alone, weight[known])
    scaled_close("joint algebra", both[0][0], both[1][0])


def part_of(flight: Flight, frames: Bools, rows: Bools) -> Flight:
    """Some frames and picks of a flight."""
    picks, path = flight.picks, flight.path
    assert path.velocity_m_s is not None
    return replace(
        flight,
        frame=flight.frame[frames],
        time_s=flight.time_s[frames],
        picks=replace(
            picks,
            frame=(np.cumsum(frames) - 1)[picks.frame[rows]],
            landmark=picks.landmark[rows],
            pixel=picks.pixel[rows],
            sigma_px=picks.sigma_px[rows],
        ),
        path=replace(
            path, position_m=path.position_m[frames], velocity_m_s=path.velocity_m_s[frames]
        ),
    )


def test_a_parameter_without_a_prior_is_solved_for() -> None:
    """A wide prior is as good as none; the place of a frame is unknown then as well."""
    flight = seen_flight("least-squares")
    free = solve_jointly(flight, Priors(None, None, {"focal": np.inf, "k1": np.inf}))
    wide = solve_jointly(flight, Priors(None, None, {"focal": 1e6, "k1": 1e3}))
    sigma = np.sqrt(np.diag(free.factored.common))
    assert_close("wide prior", free.state.parameter / sigma, wide.state.parameter / sigma)
    turn = covariance(free).turn
    scaled_close("wide prior", turn, covariance(wide).turn)
    unknown = Priors(None, None, dict.fromkeys(("east", "north", "up"), np.inf))
    assert (np.einsum("fii->f", covariance(solve_jointly(flight, unknown)).turn) > 0.0).all()


def test_a_parameter_that_no_pick_depends_on_is_refused() -> None:
    flight = seen_flight("least-squares")
    still = replace(flight, path=replace(flight.path, velocity_m_s=None))
    with refused(VopdError):
        solve_jointly(still, Priors(None, None, {"focal": np.inf, "clock": np.inf}))
    found = solve_jointly(still, Priors(None, None, {"clock": 0.1}))  # its prior is all there is
    assert_close("table value", found.factored.common, [[0.01]])


def test_a_landmark_that_is_not_seen_is_no_unknown() -> None:
    flight = seen_flight("least-squares")
    marks = flight.landmarks
    more = replace(
        marks, name=(*marks.name, "hidden"), sigma_m=np.full((7, 3), 0.1),
        position_m=np.vstack([marks.position_m, marks.position_m[:1] + 5.0]),
    )  # fmt: skip
    found = solve_jointly(replace(flight, landmarks=more), Priors(None, np.full((7, 3), 0.1)))
    expected = solve_jointly(flight, Priors(None, np.full((6, 3), 0.1)))
    assert found.model.free.tolist() == [0, 1, 2, 3, 4, 5]
    assert np.array_equal(found.solved.attitudes.rotation, expected.solved.attitudes.rotation)


@pytest.mark.parametrize("picks", [1, 2, 3])
def test_one_frame_with_one_fix(picks: int) -> None:
    """With one pick nothing is known; two give all that the linear theory allows."""
    rng = np.random.default_rng(picks)
    scene = drone(rng, 1, picks)
    fixes = TrackFixes(np.zeros(1, np.int64), np.ones((1, 1)), np.full((1, 3), 1.0))
    priors = Priors(fixes)
    found = solve_jointly(flight_of(rng, scene, 1.0, priors), priors)
    own = covariance(found)
    assert np.isfinite(own.turn).all() == (picks > 1)
    if picks > 1:
        dense = Dense(found)
        scaled_close("joint algebra", own.turn, dense.turns(dense.inverse))
        ratio = np.linalg.eigvalsh(own.place_m2[0])  # prior variances are 1
        assert (ratio <= 1.0 + within("table value")).all()
        assert ((ratio < 1.0 - within("table value")).sum()) == min(2 * picks - 3, 3)
