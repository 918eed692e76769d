"""A flight tested by leaving out: what does not fit is named, and picks are predicted.

What is named is really left out and the flight solved again, until nothing else is significant, so
that one mistake is not blamed on all that it spoils (iterated data snooping; Kok, On data snooping
and multiple outlier testing, NOAA NOS NGS 30, 1984).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.special import bdtr, chdtrc

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.residuals import SIGNIFICANCE
from vopd.findings import VopdError
from vopd.flight.estimate import FlightEstimates
from vopd.flight.flight import Flight
from vopd.flight.misfits.blunders import gross_picks
from vopd.flight.misfits.exchanged import exchanges
from vopd.flight.misfits.leave_out import FIX, LANDMARK, PICK, TIME, LeftOut, judge, leave_out
from vopd.flight.result import FlightResult
from vopd.flight.settled import settled
from vopd.flight.solve.joint import JointSolution, solve_jointly
from vopd.flight.solve.rotations import solve
from vopd.flight.solve.sizes import fix_covariances
from vopd.geometry.linear import norm
from vopd.geometry.rotations import rotation_vectors

ROUNDS = 12  # of solving without what is named
ALIKE = 6.0  # in twice the log likelihood: what explains the residuals as well
MOST_GONE = 0.3  # of the picks: where more do not fit, the fault is not theirs
FAR_RAD = 0.01  # that a frame turns without a pick: the square is half a per cent of it
MOST_SOLVED = 30  # of such picks
NO_PRIOR = 1e3  # standard deviations of a fix that is left out
MOST_SEARCHED = 30  # frames in which exchanges are looked for
CLEAR = 0.05  # chance of the sign test below which freeing has helped, or not
FEWEST = 3  # other picks in a frame of which a predicted one counts, if there are such frames


@dataclass(frozen=True)
class Named:
    """Something that does not fit."""

    tests: LeftOut  # its test first, then those of what would explain the residuals as well
    # the picks whose labels are exchanged, if that is what is wrong
    exchanged: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class TestedFlight:
    """A flight tested by leaving out."""

    estimates: FlightEstimates  # of the flight without what is named
    tests: LeftOut  # all tests, those of what is named as they were when it was
    named: tuple[Named, ...]  # what does not fit, the worst first

    @property
    def flight(self) -> Flight:
        """The flight."""
        return self.estimates.flight

    @property
    def predicted_px(self) -> Floats:
        """The error of each pick from its prediction by all others (P,); NaN: there is none."""
        own = self.tests.pick >= 0
        out = np.full(len(self.flight.picks.frame), np.nan)
        out[self.tests.pick[own]] = np.hypot(*self.tests.off_px[own].T)
        out[_gone(self.named, self.flight)] = np.nan
        return out

    @property
    def predicts(self) -> Bools:
        """Picks whose predictions count (P,).

        In their frames `FEWEST` others are left, or, if there is no such frame, two.
        """
        return _counted(np.isfinite(self.predicted_px), self.flight)


def tested_flight(result: FlightResult) -> TestedFlight:
    """Test a flight by leaving out each landmark, frame, fix and pick in turn.

    All tests of a run together name something where nothing is wrong in `SIGNIFICANCE` of runs.

    Raises:
        VopdError: where no test is possible
    """
    flight, estimates = result.read, result.estimates
    used = estimates.solved.used
    out = gross_picks(solve(flight))[0] & used
    out &= out.sum() < MOST_GONE * used.sum()  # more are no gross picks: the flight misfits
    if estimates.joint is not None and estimates.joint.passes and not out.any():
        # blunders that are named turn their frames alone there: tests are of a least cost
        estimates = settled(flight, ~used, estimates.joint)
    named: list[Named] = []
    tests = None
    for _ in range(ROUNDS):
        if out.any() or named:
            try:
                without = _without_fixes(flight, named)
                # not from what the blunders have spoiled: it may be another minimum
                estimates = settled(without, out | ~used)
            except VopdError:  # without what is named too little is left
                break
        assert estimates.joint is not None and estimates.reading is not None
        if not len(estimates.joint.model.pick):
            break
        named = [_as_time(one, estimates.joint) for one in named]
        tests = leave_out(estimates.joint, estimates.reading, out)
        more = _significant(tests, named, estimates)
        if (_gone([*named, *more], flight) & used).sum() > MOST_GONE * used.sum():
            break
        named += more
        gone = _gone(named, flight)
        if not more and not (out & ~gone).any():
            break
        out = gone | (out & bool(more))  # gross picks that are not named fit after all
    if tests is None or not len(tests.kind):
        few = np.bincount(flight.picks.frame[used], minlength=1).max() < 3  # one predicts none
        advice = (
            "pick three landmarks or more in a frame" if few
            else "state [picks] sigma_px, as the residuals do not tell how good a pick is"
        )  # fmt: skip
        message = f"no pick is left over that the others predict: {advice}"
        raise VopdError(f"{flight.source}: {message}")
    rest = tests.take(~_explained(tests, named, flight))
    rest = _solved_without(estimates, rest, len(tests.kind))
    every = LeftOut.concat([*(one.tests.take(slice(1)) for one in named), rest])
    return TestedFlight(estimates, every, tuple(named))


def _solved_without(estimates: FlightEstimates, tests: LeftOut, every: int) -> LeftOut:
    """Solve without those picks by which a frame turns so far that an update is not enough.

    Args:
        estimates: of the flight
        tests: by updating
        every: how many tests there are
    """
    joint, reading, flight = estimates.joint, estimates.reading, estimates.flight
    assert joint is not None and reading is not None
    model = joint.model
    far = np.flatnonzero((norm(tests.moved_rad) > FAR_RAD) & (tests.pick >= 0))
    far = far[np.argsort(-tests.evidence[far], kind="stable")[:MOST_SOLVED]]
    if not len(far):
        return tests
    used = model.used
    variance = (reading.test_sigma / model.flight.picks.one_sigma_px) ** 2
    found = tests.take(far)
    for k, pick in enumerate(found.pick.tolist()):
        start = joint.state if joint.passes else None
        without = used & (np.arange(len(used)) != pick)
        try:
            one = solve_jointly(model.flight, model.priors, without, start, model.readout)
        except VopdError:
            found.chance[k] = np.nan
            continue
        found.gain[k] = max(joint.normal.cost - one.normal.cost, 0.0) / variance
        turn = rotation_vectors(one.state.rotation @ joint.state.rotation.swapaxes(1, 2))
        solved = np.isfinite(one.solved.attitudes.rotation[:, 0, 0])
        turn = np.where(solved[:, None], turn, 0.0)
        largest = int((turn**2).sum(axis=1).argmax())
        found.moved_frame[k], found.moved_rad[k] = largest, turn[largest]
        found.mean_moved_rad[k] = turn.sum(axis=0) / solved.sum()
        for rows in model.rows(one.state):
            here = model.pick[rows.picks] == pick
            if here.any():
                found.off_px[k] = rows.residual[here][0] * model.flight.picks.sigma_px[pick]
        if np.isfinite(found.rms_px[k]):
            left = one.normal.residual / one.model.scale[:, None]
            found.rms_px[k] = np.sqrt((left**2).mean())
    known = np.isfinite(found.chance)
    found, far = found.take(known), far[known]
    judge(found, reading, flight.picks.least_sigma_px, every)
    rest = np.ones(len(tests.kind), bool)
    rest[far] = False
    return LeftOut.concat([tests.take(rest), found])


# What is named


def _significant(tests: LeftOut, named: Sequence[Named], estimates: FlightEstimates) -> list[Named]:
    """Choose what is named of all tests: a landmark or a fix alone, of several frames the worst.

    Args:
        tests: of the flight without what is named already
        named: that
        estimates: of the flight, without
    """
    flight = estimates.flight
    left = (tests.chance_of_all < SIGNIFICANCE) & ~_explained(tests, named, flight)
    evidence = np.where(left, tests.evidence, -np.inf)
    if not left.any():
        return []
    best = int(evidence.argmax())
    if tests.kind[best] in (LANDMARK, FIX):
        return [Named(tests.take(_alike(tests, evidence, best, flight)))]
    common = (tests.kind == LANDMARK) | (tests.kind == FIX)
    least = evidence[common].max(initial=-np.inf)
    found: list[Named] = []
    frames = dict.fromkeys(tests.frame[np.argsort(-evidence, kind="stable")].tolist())
    searched = np.zeros(len(flight.frame), bool)
    for frame in frames:
        own = int(np.where(tests.frame == frame, evidence, -np.inf).argmax())
        if frame < 0 or not evidence[own] > least:
            continue
        found.append(Named(tests.take(_alike(tests, evidence, own, flight))))
        searched[frame] = len(found) <= MOST_SEARCHED
    every = exchanges(estimates, searched, ~estimates.solved.used).picks
    exchanged = {int(flight.picks.frame[picks[0]]): tuple(picks.tolist()) for picks in every}
    return [replace(one, exchanged=exchanged.get(int(one.tests.frame[0]), ())) for one in found]


def _alike(tests: LeftOut, evidence: Floats, best: int, flight: Flight) -> Ints:
    """List the best test, and those of what it touches that explain the residuals as well."""
    near = evidence > evidence[best] - ALIKE
    frame = tests.frame[best]
    if frame >= 0:
        near &= (tests.frame == frame) | _fix_of(tests, frame, flight)
    else:
        near &= tests.frame < 0
    if tests.kind[best] == FIX:
        # one of a single frame may be that frame's time: its test is decided by the next solve
        alone = _frame_alone(int(tests.fix[best]), flight)
        near |= (tests.kind == TIME) & (tests.frame == alone) & (alone >= 0)
    near[best] = False
    others = np.flatnonzero(near)
    return np.concatenate([[best], others[np.argsort(-evidence[others], kind="stable")]])


def _fix_of(tests: LeftOut, frame: int, flight: Flight) -> Bools:
    """Mark the tests of the fixes that a frame depends on, (T,)."""
    fixes = flight.path.fixes
    if fixes is None:
        return np.zeros(len(tests.kind), bool)
    slot = tests.fix - fixes.first[frame]
    inside = (tests.kind == FIX) & (slot >= 0) & (slot < fixes.weight.shape[1])
    own = fixes.weight[frame][np.clip(slot, 0, fixes.weight.shape[1] - 1)]
    return np.asarray(inside & (own > 0.0))


def _frame_alone(fix: int, flight: Flight) -> int:
    """Find the frame that depends on a fix and on no other, if it is the only one; else -1."""
    fixes = flight.path.fixes
    assert fixes is not None
    own = fixes.frames_of(fix)
    alone = len(own) == 1 and (fixes.weight[own[0]] > 0.0).sum() == 1
    return int(own[0]) if alone else -1


def _as_time(one: Named, joint: JointSolution) -> Named:
    """Take a fix that is left out for the time of its frame, if it is off along the track alone.

    Args:
        one: something named
        joint: the solution without it
    """
    tests, model = one.tests, joint.model
    late = np.flatnonzero(tests.kind == TIME)
    if tests.kind[0] != FIX or not len(late) or model.priors.fixes is None:
        return one
    fix, own = int(tests.fix[0]), int(late[0])
    frame, path = int(tests.frame[own]), model.flight.path
    speed, off_m = model.velocity_m_s[frame], joint.state.fix_m[fix]
    stated_m2 = np.square(model.fix_sigma_m[fix] / NO_PRIOR)
    velocity_m_s = np.zeros(3)
    if path.velocity_sigma_m_s is not None:
        velocity_m_s = np.nan_to_num(path.velocity_sigma_m_s[frame])[[1, 0, 2]]

    def weight_at(late_s: float) -> Floats:
        """Weigh the fix's error, of which the velocity's own is the larger the later it is."""
        of_velocity = np.diag(stated_m2 + (velocity_m_s * late_s) ** 2)
        return np.asarray(np.linalg.inv(fix_covariances(joint.factored)[fix] + of_velocity))

    def left_at(late_s: float, weight: Floats) -> float:
        across = off_m - speed * late_s
        return float(across @ weight @ across)

    tried_s = float(speed @ off_m / (speed @ speed)) * np.linspace(0.0, 2.0, 41)
    weight = weight_at(min(tried_s.tolist(), key=lambda one: left_at(one, weight_at(one))))
    time_s = float(speed @ weight @ off_m / (speed @ weight @ speed))
    left = left_at(time_s, weight)
    if not chdtrc(2.0, left) > SIGNIFICANCE:
        others = np.flatnonzero(tests.kind != TIME)
        return replace(one, tests=tests.take(others))
    order = np.concatenate([[own], np.flatnonzero(np.arange(len(tests.kind)) != own)])
    found = tests.take(order)
    found.error[0, 0] = time_s
    return replace(one, tests=found)


def _picks_of(one: Named, flight: Flight) -> Bools:
    """Mark the picks that are left out for what is named, (P,)."""
    tests, picks = one.tests, flight.picks
    out = np.zeros(len(picks.frame), bool)
    if one.exchanged:
        out[list(one.exchanged)] = True
    elif tests.kind[0] == PICK:
        out[tests.pick[0]] = True
    elif tests.kind[0] == LANDMARK:
        out = picks.landmark == tests.landmark[0]
    elif tests.kind[0] != FIX:
        out = picks.frame == tests.frame[0]
    return out


def _gone(named: Sequence[Named], flight: Flight) -> Bools:
    """Mark the picks that are left out for all that is named, (P,)."""
    out = np.zeros(len(flight.picks.frame), bool)
    for one in named:
        out |= _picks_of(one, flight)
    return out


def _explained(tests: LeftOut, named: Sequence[Named], flight: Flight) -> Bools:
    """Mark the tests of what is named, and of picks that are left out for it, (T,)."""
    gone = _gone(named, flight)
    known = (tests.pick >= 0) & gone[tests.pick]
    for one in named:
        own = one.tests
        same = (tests.kind == own.kind[0]) & (tests.frame == own.frame[0])
        known |= same & (tests.landmark == own.landmark[0]) & (tests.fix == own.fix[0])
        if one.exchanged:
            known |= (tests.pick < 0) & (tests.frame == own.frame[0]) & (own.frame[0] >= 0)
    return known


def _without_fixes(flight: Flight, named: Sequence[Named]) -> Flight:
    """Leave out the fixes that are named."""
    fixes = flight.path.fixes
    gone = [int(one.tests.fix[0]) for one in named if one.tests.kind[0] == FIX]
    if fixes is None or not gone:
        return flight
    sigma_m = fixes.sigma_m.copy()
    sigma_m[gone] *= NO_PRIOR
    return replace(flight, path=replace(flight.path, fixes=replace(fixes, sigma_m=sigma_m)))


# Prediction


class Prediction(NamedTuple):
    """How well picks are predicted by all others, of the same flight solved in two ways."""

    picks: int
    median_px: tuple[float, float]  # as stated, and with the freed parameters
    rms_px: tuple[float, float]
    better: int  # frames whose picks are predicted better with the freed parameters
    frames: int

    @property
    def chance(self) -> float:
        """Probability of so many frames, or so few, if neither way is better: the sign test."""
        few = min(self.better, self.frames - self.better)
        return min(2.0 * float(bdtr(few, self.frames, 0.5)), 1.0)

    @property
    def helps(self) -> bool | None:
        """Whether freeing helps the prediction; None: the frames do not tell."""
        if self.chance < CLEAR:
            return 2 * self.better > self.frames
        return None


def predicted(stated: TestedFlight, freed: TestedFlight) -> Prediction:
    """Compare how well picks are predicted by all others.

    Args:
        stated: the flight with all parameters as stated
        freed: the same with some of them free
    """
    one, other = stated.predicted_px, freed.predicted_px
    picks = freed.flight.picks
    known = _counted(np.isfinite(one) & np.isfinite(other), freed.flight)
    pair = one[known], other[known]
    frame, at = np.unique(picks.frame[known], return_inverse=True)
    squares = [np.bincount(at, values**2) for values in pair]
    median, rms = (
        tuple(float(f(values)) if len(values) else float("nan") for values in pair)
        for f in (np.median, lambda values: np.sqrt((values**2).mean()))
    )
    return Prediction(
        int(known.sum()), (median[0], median[1]), (rms[0], rms[1]),
        int((squares[1] < squares[0]).sum()), len(frame),
    )  # fmt: skip


def _counted(known: Bools, flight: Flight) -> Bools:
    """Choose the picks whose predictions count of those that have one, (P,)."""
    count = np.bincount(flight.picks.frame[known], minlength=len(flight.frame))
    many = known & (count > FEWEST)[flight.picks.frame]
    return many if many.any() else known
