"""Flights whose least cost is found by dense matrices, with a geometry and a loss of their own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from tests.kit.joint_flights import (
    LENS,
    NED_FROM_ENU,
    Dense,
    LensTruth,
    at_frames,
    axes,
    drone,
    flight_of,
    turned_out,
)
from vopd.arrays import Floats
from vopd.flight.flight import Flight, FlightOptions, TrackFixes
from vopd.flight.solve.equations import Priors
from vopd.flight.solve.joint import JointSolution
from vopd.flight.solve.rotations import CAUCHY, HUBER

LOSSES = ("least-squares", "huber", "cauchy")

# Problems


def drawn_problem(seed: int) -> tuple[Flight, Priors]:
    """A short flight with some of all that can be unknown, drawn from its priors."""
    rng = np.random.default_rng(seed)
    frames, landmarks = int(rng.integers(2, 6)), int(rng.integers(3, 7))
    height_m = float(rng.choice([60.0, 100.0, 400.0]))
    scene = drone(rng, frames, landmarks, height_m=height_m, tilt_deg=rng.uniform(0.0, 50.0))
    sigma_m = rng.choice([0.02, 0.5, 2.0]) * np.array([1.0, 1.0, 2.0])
    fixes = [  # none, own, between two, in the middle of three
        None,
        TrackFixes(np.arange(frames), np.ones((frames, 1)), np.tile(sigma_m, (frames, 1))),
        TrackFixes(
            np.sort(rng.integers(0, 3, frames)),
            rng.dirichlet([1.0, 1.0], frames),
            np.tile(sigma_m, (4, 1)),
        ),
        TrackFixes(
            np.sort(rng.integers(0, 3, frames)),
            np.tile([0.2, 0.5, 0.3], (frames, 1)),
            np.tile(sigma_m, (5, 1)),
        ),
    ][seed % 4]
    parameter: dict[str, float] = {}
    if fixes is None or rng.random() < 0.3:
        parameter |= dict(zip(("east", "north", "up"), sigma_m.tolist(), strict=True))
    if rng.random() < 0.5:
        parameter |= {"focal": 5.0, "k1": 0.02, "k2": 0.02, "centre_u": 2.0, "centre_v": 2.0}
    if rng.random() < 0.5:
        parameter["clock"] = 0.1
    landmark_m = None
    if rng.random() < 0.6:
        landmark_m = np.tile(rng.choice([0.05, 0.3, 2.0], (landmarks, 1)), (1, 3))
    priors = Priors(fixes, landmark_m, parameter)
    loss = "least-squares" if seed < 8 else LOSSES[(seed - 7) % 3]
    velocity = tuple(rng.normal(0.0, 5.0, 3).tolist())
    flight = flight_of(rng, scene, 1.0, priors, velocity_m_s=velocity, loss=loss)
    if loss != "least-squares":
        flight.picks.pixel[0] += [20.0, -30.0]
    return flight, priors


SIGMA = {"focal": 4.0, "centre_u": 3.0, "centre_v": 4.0, "k1": 0.05, "k2": 0.05, "clock": 0.08}
NAMES = {"centre": ("centre_u", "centre_v"), "track-offset": ("east", "north", "up")}


def drawn(
    seed: int, free: tuple[str, ...], stated: dict[str, float], frames: int = 12,
    landmarks: int = 8, fix_m: float = 0.0, mark_m: float = 0.0, velocity_m_s: float = 4.0,
) -> Flight:  # fmt: skip
    """A drone with picks of 1 px, its lens and clock wrong by what is stated."""
    rng = np.random.default_rng(seed)
    fixes, marks = None, None
    if fix_m:
        each = np.full((frames, 3), fix_m)
        fixes = TrackFixes(np.arange(frames), np.ones((frames, 1)), each)
    if mark_m:
        marks = np.full((landmarks, 3), mark_m)
    speed = (0.6 * velocity_m_s, 0.8 * velocity_m_s, 0.0)
    priors = Priors(fixes, marks, stated)
    flight = flight_of(rng, drone(rng, frames, landmarks), 1.0, priors, velocity_m_s=speed)
    return replace(
        flight,
        picks=replace(flight.picks, stated=True),
        path=replace(flight.path, bias_sigma_m=np.zeros(3)),
        options=FlightOptions(free=free, parameter_sigma=stated),
    )


WITHOUT_ONE = ("focal", "k1", "clock", "centre")


def freed_problem(seed: int) -> tuple[Flight, tuple[str, ...]]:
    """A short flight with some of lens and clock free; of some nothing is stated."""
    rng = np.random.default_rng(seed + 500)
    names = tuple(rng.permutation([*WITHOUT_ONE, "k2"])[: 1 + seed % 4].tolist())
    wrong = [p for name in names for p in NAMES.get(name, (name,))]
    stated = {p: SIGMA[p] for p in wrong if rng.random() < 0.6}
    flight = drawn(
        seed, names, stated, int(rng.integers(3, 6)), 8,
        float(rng.choice([0.0, 0.5])), float(rng.choice([0.0, 0.3])),
    )  # fmt: skip
    return flight, names


# Their least cost


def residuals_by_hand(solution: JointSolution) -> Callable[[Floats], Floats]:
    """Residuals of picks and priors, by steps from the solution in turns, fixes, common errors."""
    flight, priors, state = solution.model.flight, solution.model.priors, solution.state
    picks, marks, names = flight.picks, flight.landmarks.position_m, solution.model.names
    frames, free = len(flight.frame), solution.model.free
    camera_axes, mark_axes = axes(flight.path.position_m), axes(marks[free])
    line = marks[picks.landmark] - flight.path.position_m[picks.frame]
    prior = [] if priors.fixes is None else [priors.fixes.sigma_m.ravel()]
    prior += [np.array(list(priors.parameter.values()))]
    prior += [] if priors.landmark_m is None else [priors.landmark_m[free].ravel()]
    sigma = np.concatenate(prior)
    found = [state.fix_m.ravel(), state.parameter, state.landmark_m[free].ravel()]
    error = np.concatenate(found)
    cuts = np.cumsum([3 * frames, state.fix_m.size, len(names)])

    def residual(step: Floats) -> Floats:
        wrong = error + step[3 * frames :]
        turn, *_ = np.split(step, cuts)
        _, fix, values, mark = np.split(np.concatenate([turn, wrong]), cuts)
        by = dict(zip(names, values.tolist(), strict=True))
        rotation = Rotation.from_rotvec(turn.reshape(-1, 3)).as_matrix() @ state.rotation
        moved = np.tile([by.get(name, 0.0) for name in ("east", "north", "up")], (frames, 1))
        assert flight.path.velocity_m_s is not None
        moved += flight.path.velocity_m_s @ NED_FROM_ENU * by.get("clock", 0.0)
        if priors.fixes is not None:
            moved += at_frames(priors.fixes, fix.reshape(-1, 3))
        moved = turned_out(camera_axes, moved)
        own, away = axes(flight.path.position_m + moved), line - moved[picks.frame]
        further = np.zeros_like(marks)
        further[free] = turned_out(mark_axes, mark.reshape(-1, 3))
        away += further[picks.landmark]
        ray = np.einsum("pij,pjk,pk->pi", rotation[picks.frame], own[picks.frame], away)
        lens = LensTruth()
        lens = lens._replace(**{n: getattr(lens, n) + by[n] for n in LENS if n in by})
        off = (picks.pixel - lens.image(ray)) / picks.sigma_px[:, None]
        return np.concatenate([off.ravel(), wrong / sigma])

    return residual


class Minimum(NamedTuple):
    """The least cost of all unknowns at once, by dense matrices."""

    away: Floats  # from the solution, in standard deviations
    slopes: Floats  # of all residuals there, by unknowns in standard deviations


def dense_minimum(solution: JointSolution, rng: np.random.Generator) -> Minimum:
    """Minimise the cost by Newton's steps, slopes by differences, until steps are rounding.

    Args:
        solution: from where steps are counted
        rng: of the start, a third of a standard deviation away
    """
    sigma = np.sqrt(np.diag(Dense(solution).inverse))
    residual, loss = residuals_by_hand(solution), solution.model.flight.options.loss
    picks = 2 * len(solution.model.flight.picks.frame)

    def at(away: Floats) -> Floats:
        return residual(sigma * away)

    def slopes(away: Floats, parts: tuple[float, ...], step: float) -> Floats:
        """Differentiate: parts of the differences over one step, two steps, ... both ways."""
        both = [
            sum(p * (at(away + k * e) - at(away - k * e)) for k, p in enumerate(parts, 1))
            for e in step * np.eye(len(away))
        ]
        return np.stack(both, axis=1) / step

    def step_of(away: Floats, by: Floats, newton: float) -> Floats:
        """Solve for a step; reweighting alone has a minimum wherever it begins."""
        off = at(away)
        pairs = off[:picks].reshape(-1, 2)
        weight, curvature = _weight((pairs**2).sum(axis=1), loss)
        own = np.eye(len(off))
        blocks = weight[:, None, None] * np.eye(2)
        blocks = (
            blocks + newton * 2.0 * curvature[:, None, None] * pairs[:, :, None] * pairs[:, None]
        )
        for k, block in enumerate(blocks):
            own[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = block
        weighted = np.concatenate([(weight[:, None] * pairs).ravel(), off[picks:]])
        return np.asarray(-np.linalg.solve(by.T @ own @ by, by.T @ weighted))

    away = rng.normal(0.0, 0.3, len(sigma))
    for _ in range(200):
        step = step_of(away, slopes(away, (0.5,), 1e-2), 0.0)
        away = away + step * min(1.0, 0.3 / np.abs(step).max())
        if np.abs(step).max() < NEAR:
            break
    for _ in range(4):
        by = slopes(away, (0.75, -0.15, 1 / 60), 0.1)
        for _ in range(20):
            step = step_of(away, by, 1.0)
            away = away + step
            if np.abs(step).max() < ROUNDING:
                break
    return Minimum(away, by)


NEAR, ROUNDING = 1e-5, 1e-10  # standard deviations: slopes hardly change; steps no longer count


def _weight(squares: Floats, loss: str) -> tuple[Floats, Floats]:
    """Differentiate a loss by the squared length once and twice."""
    if loss == "huber":
        flat = squares > HUBER**2
        length = np.sqrt(np.where(flat, squares, 1.0))
        return np.where(flat, HUBER / length, 1.0), np.where(flat, -HUBER / 2.0 / length**3, 0.0)
    if loss == "cauchy":
        weight = 1.0 / (1.0 + squares / CAUCHY**2)
        return weight, -((weight / CAUCHY) ** 2)
    return np.ones_like(squares), np.zeros_like(squares)
