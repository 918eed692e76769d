"""Leaving out by updating: against dense matrices, and against solving without."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from tests.kit.joint_flights import Dense, random_problem
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.attitude.reading_sigma import JobReadingSigma
from vopd.flight.misfits.leave_out import (
    FIX,
    FRAME,
    LANDMARK,
    PICK,
    POSITION,
    TIME,
    LeftOut,
    judge,
    leave_out,
)
from vopd.flight.solve.joint import JointSolution, solve_jointly

KNOWN = JobReadingSigma(1.0, np.inf, "given", np.zeros(1), 1.0)

# One step of Gauss and Newton without, by dense matrices: what updating is equal to


@cache
def solved(loss: str, width: int) -> tuple[JointSolution, Dense, LeftOut]:
    """A random problem, and its tests."""
    rng = np.random.default_rng(10 * width + len(loss))
    flight, priors, readout = random_problem(rng, width, loss, width == 1)
    path = replace(flight.path, acceleration_m_s2=np.zeros((len(flight.frame), 3)))
    solution = solve_jointly(replace(flight, path=path), priors, readout=readout)
    return solution, Dense(solution), leave_out(solution, KNOWN)


def without(dense: Dense, rows: Floats, prior: Floats, gone: Floats) -> tuple[float, Floats]:
    """The decrease of the cost, and the step, without some rows, priors and unknowns.

    Args:
        dense: the equations
        rows: those that stay, (2P,) of 0 and 1
        prior: weights of the priors that stay, (U,)
        gone: unknowns that are none then, (U,) of 0 and 1
    """
    weight, own = dense.weight * rows, gone == 0.0
    normal = dense.rows.T @ (weight[:, None] * dense.rows) + np.diag(prior)
    state = dense.state
    right = dense.rows.T @ (weight * dense.residual) - prior * state
    step = np.zeros(len(right))
    step[own] = np.linalg.solve(normal[np.ix_(own, own)], right[own])
    cost = (dense.weight * (1.0 - rows) * dense.residual**2).sum()
    cost += ((dense.prior - prior) * state**2).sum()
    return float(cost + right @ step), step


def freed(dense: Dense, columns: Floats) -> tuple[float, Floats]:
    """The decrease of the cost, and the step, with columns (2P, k) more, which have no prior."""
    rows = np.hstack([dense.rows, columns])
    normal = rows.T @ (dense.weight[:, None] * rows)
    normal[: len(dense.prior), : len(dense.prior)] += np.diag(dense.prior)
    right = columns.T @ (dense.weight * dense.residual)
    scale = 1.0 / np.sqrt(np.diag(normal))
    inverse = np.linalg.inv(normal * scale[:, None] * scale) * scale[:, None] * scale
    step = inverse[:, len(dense.prior) :] @ right
    return float(right @ step[len(dense.prior) :]), step


@pytest.mark.parametrize("freedom", [2, 4, 6])
def test_evidence_of_a_chance_below_all_numbers(freedom: int) -> None:
    """Chi-square of 2n degrees exceeds g by exp(-g/2) times n terms of exp(g/2)'s series."""
    gain = np.array([3000.0, 5000.0])
    some = solved("least-squares", 8)[2].take(np.arange(2))
    one = replace(some, freedom=np.full(2, freedom), gain=gain, chance=np.zeros(2))
    half = gain / 2.0
    terms = sum(half**k / math.factorial(k) for k in range(freedom // 2))
    assert_close("tail of chi-square", one.evidence, gain - 2.0 * np.log(terms))


def test_what_gains_nothing_fits_for_certain() -> None:
    tests = solved("least-squares", 0)[2]
    none = replace(
        tests, gain=np.zeros(len(tests.kind)), chance=tests.chance + 0.0,
        chance_of_all=tests.chance_of_all + 0.0,
    )  # fmt: skip
    judge(none, JobReadingSigma(1.0, np.inf, "stated", np.zeros(0), 1.0), 0.3, 5)
    assert (none.chance == 1.0).all() and (none.chance_of_all == 1.0).all()


def moves(test: LeftOut, k: int, step: Floats, frames: int) -> None:
    """The frame that moves most, and the mean, are those of a step of all unknowns."""
    turn = step[: 3 * frames].reshape(frames, 3)
    scale = np.abs(turn).max() + 1e-9
    largest, found = turn[test.moved_frame[k]] / scale, test.moved_rad[k] / scale
    assert_close("joint residual", found, largest)
    size = np.linalg.norm(turn, axis=1).max() / scale  # frames that are symmetric are alike
    assert_close("joint residual", np.linalg.norm(found), size)
    assert_close("joint residual", test.mean_moved_rad[k] / scale, turn.mean(axis=0) / scale)


PROBLEMS = [("least-squares", width) for width in (0, 1, 2, 3, 4)]


@pytest.mark.parametrize(("loss", "width"), PROBLEMS)
def test_picks_left_out_are_those_of_the_dense_equations(loss: str, width: int) -> None:
    solution, dense, tests = solved(loss, width)
    own = np.flatnonzero(tests.kind == PICK)
    count = np.bincount(solution.model.flight.picks.frame)
    assert len(own) == count[count > 2].sum()  # of two landmarks neither is predicted by the other
    for k in own:
        row = int(np.flatnonzero(solution.model.pick == tests.pick[k])[0])
        at, rows = slice(2 * row, 2 * row + 2), np.ones(len(dense.rows))
        rows[at] = 0.0
        gain, step = without(dense, rows, dense.prior, np.zeros(len(dense.prior)))
        assert_close("joint residual", tests.gain[k], gain)
        error = dense.residual[at] - dense.rows[at] @ step
        assert_close("joint residual", tests.off_px[k], error)  # sigma is 1 px
        turn = step[: 3 * dense.frames].reshape(-1, 3)[tests.frame[k]]
        assert_close("joint residual", tests.moved_rad[k] * 1e3, turn * 1e3)


@pytest.mark.parametrize(("loss", "width"), PROBLEMS)
def test_frames_left_out_are_those_of_the_dense_equations(loss: str, width: int) -> None:
    solution, dense, tests = solved(loss, width)
    own = np.flatnonzero(tests.kind == FRAME)
    assert len(own) == dense.frames
    frame = np.repeat(solution.model.flight.picks.frame[solution.model.pick], 2)
    for k in own:
        gone = np.zeros(len(dense.prior))
        gone[3 * tests.frame[k] : 3 * tests.frame[k] + 3] = 1.0
        rows = np.where(frame == tests.frame[k], 0.0, 1.0)
        gain, step = without(dense, rows, dense.prior, gone)
        assert_close("joint residual", tests.gain[k], gain)
        assert tests.freedom[k] == (rows == 0.0).sum() - 3
        moves(tests, k, step, dense.frames)


@pytest.mark.parametrize(("loss", "width"), PROBLEMS)
def test_times_and_positions_left_out_are_those_of_the_dense_equations(
    loss: str, width: int
) -> None:
    solution, dense, tests = solved(loss, width)
    columns = np.zeros((len(dense.rows), dense.frames, 3))
    for rows in solution.model.rows(solution.state):
        for b, frame in enumerate(rows.frames):
            at = (2 * rows.picks[b][:, None] + np.arange(2)).ravel()
            columns[at, frame] = rows.by_place[b].reshape(-1, 3)
    own = np.flatnonzero((tests.kind == TIME) | (tests.kind == POSITION))
    assert len(own) == dense.frames * (1 + (width == 0))
    count = np.bincount(solution.model.flight.picks.frame)
    for k in own:
        if tests.kind[k] == POSITION and count[tests.frame[k]] == 2:
            assert tests.freedom[k] < 3  # two landmarks do not determine a position
            continue
        added = columns[:, tests.frame[k]]
        if tests.kind[k] == TIME:
            added = added @ solution.model.velocity_m_s[tests.frame[k]][:, None]
        gain, step = freed(dense, added)
        assert_close("joint residual", tests.gain[k], gain)
        assert np.isnan(tests.error[k]).all() or gain > 25.0  # five standard deviations at least
        if np.isfinite(tests.error[k, 0]):
            error = step[len(dense.prior) :]
            assert_close("joint residual", tests.error[k, : added.shape[1]], error)
        moves(tests, k, step, dense.frames)


@pytest.mark.parametrize(("loss", "width"), PROBLEMS)
def test_landmarks_left_out_are_those_of_the_dense_equations(loss: str, width: int) -> None:
    solution, dense, tests = solved(loss, width)
    model = solution.model
    own = np.flatnonzero(tests.kind == LANDMARK)
    assert len(own) == len(model.flight.landmarks.name)
    assert len(model.free) < len(own)  # one is exact
    columns = np.zeros((len(dense.rows), len(own), 3))
    for rows in model.rows(solution.state):
        for b in range(len(rows.frames)):
            for n, pick in enumerate(rows.picks[b]):
                columns[2 * pick : 2 * pick + 2, model.landmark[pick]] = rows.by_landmark[b, n]
    for k in own:
        mark = int(tests.landmark[k])
        if mark in model.free:
            prior = dense.prior.copy()
            at = dense.common + len(model.names) + 3 * int(np.flatnonzero(model.free == mark)[0])
            prior[at : at + 3] = 0.0
            ones, none = np.ones(len(dense.rows)), np.zeros(len(prior))
            gain, step = without(dense, ones, prior, none)
        else:
            gain, step = freed(dense, columns[:, mark])
            told = np.isfinite(tests.error[k])
            assert_close("joint residual", tests.error[k][told], step[len(dense.prior) :][told])
        assert_close("joint residual", tests.gain[k], gain)
        moves(tests, k, step, dense.frames)
        changed = dense.rows @ step[: len(dense.prior)]
        if mark not in model.free:
            changed += columns[:, mark] @ step[len(dense.prior) :]
        others = np.repeat(model.landmark != mark, 2)
        left = (dense.residual - changed)[others]
        assert_close("joint residual", tests.rms_px[k], np.sqrt((left**2).mean()))


@pytest.mark.parametrize(("loss", "width"), PROBLEMS[1:])
def test_fixes_left_out_are_those_of_the_dense_equations(loss: str, width: int) -> None:
    solution, dense, tests = solved(loss, width)
    fixes = solution.model.priors.fixes
    assert fixes is not None
    own = np.flatnonzero(tests.kind == FIX)
    assert len(own) and not (fixes.between is not None and fixes.between[tests.fix[own]].any())
    for k in own:
        prior = dense.prior.copy()
        at = slice(3 * (dense.frames + tests.fix[k]), 3 * (dense.frames + tests.fix[k]) + 3)
        prior[at] = 0.0
        gain, step = without(dense, np.ones(len(dense.rows)), prior, np.zeros(len(prior)))
        assert_close("joint residual", tests.gain[k], gain)
        told = np.isfinite(tests.error[k])
        assert_close("joint residual", tests.error[k][told], (dense.state[at] + step[at])[told])
        moves(tests, k, step, dense.frames)
