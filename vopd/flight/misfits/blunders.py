"""Blunders of a flight: picks that do not fit their frame, and landmarks with wrong coordinates.

A frame's picks are tested with their marginal covariance, so that an error of the position is not
blamed on a landmark (`vopd.attitude.blunders`). A landmark is tested over all its frames: wrong
coordinates are named once, not as a blunder of each frame.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc, fdtrc

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.blunders import LEAST_LEFT, UNCLEAR, blunders_of_frames, without_picks
from vopd.attitude.reading_sigma import JobReadingSigma, least_sigmas
from vopd.attitude.residuals import (
    SIGNIFICANCE,
    Pool,
    ResidualEquations,
    ResidualWeights,
    equations_of,
    finite,
    testable,
)
from vopd.attitude.sigmas import Sigmas, given_components, in_force
from vopd.attitude.uncertainty import HALF_WIDTH
from vopd.estimate import Estimate
from vopd.findings import Finding, count_text, first_of, listed
from vopd.flight.estimate import FlightEstimates
from vopd.flight.flight import Flight, FrameSlots, frame_label, pick_label
from vopd.flight.solve.errors import priors_of
from vopd.flight.solve.joint import solve_jointly, widened
from vopd.flight.solve.rotations import FlightBlocks, SolvedFlight, pick_distances_px, solve
from vopd.geometry.linear import norm

ROUNDS = 7  # of solving without the blunders and testing all picks again
USUAL = 0.25  # quantile of the frames' largest residuals that is free of gross picks
ENLARGED = 3.0  # times that: a frame may have some
WRONG_IN = 0.5  # of a landmark's frames in which it is a blunder: its coordinates are wrong
FEW = 0.01  # of the picks that are found anew: fewer, and only their frames are tested again
FEWEST_FRAMES = 3  # of a landmark with wrong coordinates
LANDMARK_SIGNIFICANCE = 0.0005  # the probability of a false alarm in a flight, by all landmarks
DETERMINED = 5.0  # standard deviations of a shift that is told
LEAST_TOLD = 1.0  # degrees of freedom that tell how good readings are
SHOWN_BY = 0.5  # of a landmark's shift, by the median of its frames
AWAY = 3.0  # times as far from all landmarks as usual: a position may be wrong
LARGE = 0.1  # of the focal length: what wrong positions and lenses may do in an image
NOT_ZERO = 1e-300  # a chance: 0 stands for a pick that is not exchanged
SHOWN = 1e-6  # of the best direction of a shift: what is known less is not known


class Exchanges(NamedTuple):
    """Labels that are exchanged, of two picks of a frame or more."""

    picks: tuple[Ints, ...]  # E times those of one frame
    label: tuple[Ints, ...]  # and the landmarks that they rather are
    before_px: Floats  # (E,) root mean square of the frame's residuals; NaN: one has no image
    after_px: Floats  # (E,) with the labels exchanged
    chance: Floats  # (E,) of these; NaN: not known
    not_searched: int = 0  # frames that do not fit, as all of them have too many picks

    def chances(self, count: int) -> Floats:
        """Spread the chances over the picks, as `Estimate.exchanged` has them, (P,)."""
        chance = np.zeros(count)
        known = np.nan_to_num(np.maximum(self.chance, NOT_ZERO), nan=-1.0)
        for picks, one in zip(self.picks, known.tolist(), strict=True):
            chance[picks] = one
        return chance

    def marked(self, count: int) -> Bools:
        """Mark the picks of all exchanges, (P,)."""
        marks = np.zeros(count, bool)
        for picks in self.picks:
            marks[picks] = True
        return marks


NO_EXCHANGE = Exchanges((), (), *np.zeros((3, 0)))


class Blunders(NamedTuple):
    """Picks and landmarks of a flight that do not fit."""

    pick: Bools  # (P,) does not fit the others of its frame
    unclear: Bools  # (P,) some of these of its frame do not fit; nothing tells which
    landmark: Bools  # (N,) its coordinates do not fit the other landmarks
    unclear_landmark: Bools  # (N,) those of one of these do not fit; nothing tells which
    shift_m: Floats  # (N, 3) east, north, up, by which it fits; NaN where that is not determined
    left_out: Bools  # (P,) picks to be left out for both
    off_px: Floats  # (P,) from the landmark's image in the solution without what is left out


def find_blunders(
    estimates: FlightEstimates,
    gross: Bools,
    solve_without: Callable[[Bools, FlightEstimates], FlightEstimates],
    exchanged: Bools | None = None,
) -> tuple[Blunders, FlightEstimates | None]:
    """Find the blunders of a flight: test its picks, solve it without them, and so on.

    Where few are found, only their frames are solved again.

    Args:
        estimates: of the flight, solved without gross picks
        gross: these, (P,)
        solve_without: solves it without some picks (P,), given a solution before
        exchanged: picks that take no part and are not tested, as their labels are exchanged, (P,)

    Returns:
        The blunders, and the flight solved without them; None if all of it was not.
    """
    if exchanged is None:
        exchanged = np.zeros_like(gross)
    gross = gross & ~exchanged
    used, out = estimates.solved.used | gross, gross
    none = _none(estimates)._replace(pick=gross, left_out=gross)
    found = _test_flight(_with_every_pick(estimates, used), none)
    for _ in range(ROUNDS):
        before, stale = found, found.left_out != out
        if stale.sum() > FEW * used.sum():
            settled = _settles(estimates)
            estimates = solve_without(found.left_out | exchanged, estimates)
            out = found.left_out
            if not (settled or _settles(estimates)):
                break  # tests of such a solution tell nothing
            found = _test_flight(_with_every_pick(estimates, used), before)
        elif stale.any():
            found = _test_again(estimates, before, _frames_of(stale, estimates), used)
        if np.array_equal(found.left_out, before.left_out):
            break
    return found, estimates if np.array_equal(found.left_out, out) else None


def _none(estimates: FlightEstimates) -> Blunders:
    flight = estimates.flight
    picks, marks = np.zeros(len(flight.picks.frame), bool), len(flight.landmarks.name)
    none = np.zeros(marks, bool)
    away = np.full(len(picks), np.nan)
    return Blunders(picks, picks, none, none, np.full((marks, 3), np.nan), picks, away)


def _settles(estimates: FlightEstimates) -> bool:
    return estimates.joint is None or estimates.joint.settles


def _frames_of(picks: Bools, estimates: FlightEstimates) -> Bools:
    """Mark the frames of picks, (F,)."""
    marked = np.zeros(len(estimates.flight.frame), bool)
    marked[estimates.flight.picks.frame[picks]] = True
    return marked


@np.errstate(all="ignore")
def suspected_frames(solved: SolvedFlight) -> Bools:
    """Mark frames with residuals far larger than most frames have, (F,).

    Args:
        solved: the flight, solved with all picks at its stated places
    """
    flight = solved.flight
    off_px = np.where(solved.used, pick_distances_px(solved), 0.0)
    size = np.zeros(len(flight.frame))
    np.maximum.at(size, flight.picks.frame, np.nan_to_num(off_px / flight.picks.sigma_px))
    usual = np.quantile(size[size > 0.0], USUAL) if (size > 0.0).any() else 0.0
    far = off_px > LARGE * flight.pick_focal_px
    suspected = size > ENLARGED * max(usual, 1.0)
    suspected[flight.picks.frame[far]] = True
    return suspected


@np.errstate(all="ignore")
def gross_picks(solved: SolvedFlight, suspected: Bools | None = None) -> tuple[Bools, Bools]:
    """Find picks, and whole frames, so far off that a flight solved with them tells nothing.

    Suspected frames are solved by a robust loss, each by itself, and tested by their own residuals
    alone.

    Args:
        solved: the flight, solved with all picks at its stated places
        suspected: `suspected_frames`, if they are known, (F,)

    Returns:
        The picks, (P,), and the frames of which hardly a pick fits, as their position is far
        away, (F,).
    """
    flight = solved.flight
    found, lost = np.zeros(len(flight.picks.frame), bool), np.zeros(len(flight.frame), bool)
    frames = np.flatnonzero(suspected_frames(solved) if suspected is None else suspected)
    if not len(frames):
        return found, lost
    part = FlightBlocks(flight).part(frames)
    robust = replace(part.flight, options=replace(flight.options, loss="cauchy"))
    alone = solve(widened(robust, priors_of(robust)))
    estimates = FlightEstimates(replace(alone, flight=part.flight))
    sigma = max(flight.picks.one_sigma_px, flight.picks.least_sigma_px)
    none = np.zeros(len(frames))
    reading = JobReadingSigma(sigma, np.inf, "residuals", none, sigma)
    landmarks = np.zeros(len(flight.landmarks.name), bool)
    known = np.zeros(len(part.picks), bool)
    found[part.picks], _ = _test_picks(estimates, reading, landmarks, known, alone=True)
    lost[frames] = _frames_far_off(alone, float(np.nanmedian(flight.pick_range_m)))
    return found, lost


def _frames_far_off(alone: SolvedFlight, usual_m: float) -> Bools:
    """Mark frames far from all landmarks, of which half the picks or more are far off, (F,).

    Args:
        alone: these frames, each solved by itself with a robust loss
        usual_m: how far landmarks usually are
    """
    flight, used = alone.flight, alone.used
    fits = pick_distances_px(alone) < LARGE * flight.pick_focal_px
    near = flight.pick_range_m < AWAY * usual_m
    count, good, here = (
        np.bincount(flight.picks.frame[some], minlength=len(flight.frame))
        for some in (used, used & fits, used & near)
    )
    return np.asarray((count > 2) & (2 * good <= count) & (here == 0))


def _reading(estimates: FlightEstimates) -> JobReadingSigma:
    assert estimates.reading is not None  # that of a flight is settled before its picks are tested
    return estimates.reading


def _solved_part(
    estimates: FlightEstimates, frames: Ints, out: Bools, used: Bools, loss: str | None = None
) -> tuple[FlightEstimates, Ints]:
    """Solve some frames without some picks, and estimate them with the residuals of all.

    Args:
        estimates: of the flight
        frames: their indices
        out: picks that take no part, (P,)
        used: picks that are tested, (P,)
        loss: another one than the flight's

    Returns:
        The estimates of these frames, and the indices of their picks.
    """
    part = estimates.blocks.part(frames)
    one, options = part.flight, part.flight.options
    scaled = replace(
        one,
        picks=one.picks.with_sigma(_reading(estimates).test_sigma),
        options=replace(options, loss=loss or options.loss),
    )
    joint = solve_jointly(scaled, priors_of(one), (used & ~out)[part.picks])
    solved = FlightEstimates(replace(joint.solved, flight=one), joint)
    return _with_every_pick(solved, used[part.picks]), part.picks


def _with_every_pick(estimates: FlightEstimates, used: Bools) -> FlightEstimates:
    """Estimate a flight solved without some picks, with the residuals of all."""
    solved = estimates.solved
    if np.array_equal(used, solved.used):
        return estimates
    weight = np.where(used & ~solved.used, 1.0, solved.attitudes.weight)
    attitudes = solved.attitudes._replace(weight=weight)
    every = replace(solved, used=used, attitudes=attitudes)
    return FlightEstimates(every, estimates.joint, estimates.reading)


class _Block(NamedTuple):
    """Frames with like numbers of picks that are tested."""

    frames: Ints  # (F,) their indices in the flight
    pick: Ints  # (F, L) indices of their picks; -1: there is none
    equations: ResidualEquations
    by_landmark: Floats  # (F, 2L, 3) of the residuals by metres of each landmark east, north, up
    usual: Floats  # (F, 2L, 5) by the position, the focal length and k1, each of `LARGE`

    def marked(self, picks: Bools) -> Bools:
        """Spread marks of the flight's picks, (F, L)."""
        return np.asarray(picks[self.pick] & (self.pick >= 0))


def _blocks(estimates: FlightEstimates) -> Iterator[_Block]:
    """Iterate over blocks of frames."""
    for part in estimates.blocks:
        estimate = estimates.of(part.frames)
        frames = np.flatnonzero(testable(estimate))
        slots = FrameSlots.of(part.flight.picks.frame, len(part.frames))
        components = given_components(estimate, in_force(estimate, Sigmas()))
        equations = equations_of(estimate, components, frames)
        used = estimate.used[frames]
        moved = finite(estimate.responses.landmark[frames], np.tile(used, 2))
        pick = slots.spread(part.picks + 1)[frames] - 1
        usual = finite(_usual_mistakes(estimate)[frames], np.tile(used, 2))
        yield _Block(part.frames[frames], pick, equations, moved, usual)


def _usual_mistakes(estimate: Estimate) -> Floats:
    """Change the residuals by wrong positions, focal length and distortion, (F, 2L, 5)."""
    radius2 = (estimate.image**2).sum(axis=2, keepdims=True)
    radial = (estimate.image * radius2).swapaxes(1, 2).reshape(len(radius2), -1)
    focal = estimate.responses.focal_length
    columns = np.concatenate(
        [estimate.responses.position, focal[..., None], radial[..., None]], axis=2
    )
    most = np.abs(columns).max(axis=1, keepdims=True, initial=0.0)
    return np.asarray(columns * (LARGE * estimate.focal_length / np.where(most > 0.0, most, 1.0)))


def _test_flight(estimates: FlightEstimates, before: Blunders) -> Blunders:
    """Test all picks and landmarks of a flight that was solved without earlier blunders.

    Args:
        estimates: of the flight, with every pick
        before: the earlier blunders
    """
    landmark = estimates.flight.picks.landmark
    reading, wrong = _reading(estimates), before.landmark
    sums = _Displacements(estimates, reading)
    pick, unclear = _test_picks(estimates, reading, wrong, before.pick, sums=sums)
    more, unclear_landmark = _wrong_in_most_frames(estimates, pick) & ~wrong, np.zeros_like(wrong)
    if more.sum() > 1:  # mistakes of another kind displace several
        more = _each_confirmed(estimates, reading, more, pick)
    if not more.any():
        more, unclear_landmark = _wrong_landmark(estimates, reading, wrong, pick, sums)
    named = int((wrong | more).sum())
    if more.any() and named <= min(len(wrong) // 2, len(wrong) - LEAST_LEFT):
        wrong = wrong | more
        pick, unclear = _test_picks(estimates, reading, wrong, pick & ~wrong[landmark])
    gone = _left_out(estimates, wrong, pick)
    shift_m = np.full((len(wrong), 3), np.nan)
    for k in np.flatnonzero(wrong):
        sums = _summed(estimates, reading, pick | (gone & (landmark != k)))
        if sums.is_determined()[k]:
            shift_m[k] = sums.shift_m()[k]
    off_px = pick_distances_px(estimates.solved)
    return Blunders(pick, unclear, wrong, unclear_landmark, shift_m, pick | gone, off_px)


def _test_again(
    estimates: FlightEstimates, before: Blunders, chosen: Bools, used: Bools
) -> Blunders:
    """Test the picks of some frames once more, solved without the blunders.

    Args:
        estimates: of the flight
        before: its blunders
        chosen: the frames, (F,)
        used: picks that are tested, (P,)
    """
    frames = np.flatnonzero(chosen)
    part, picks = _solved_part(estimates, frames, before.left_out, used)
    reading = _reading(estimates).take(frames)
    pick, unclear = before.pick.copy(), before.unclear.copy()
    off_px, out = before.off_px.copy(), before.left_out.copy()
    pick[picks], unclear[picks] = _test_picks(part, reading, before.landmark, before.pick[picks])
    off_px[picks] = pick_distances_px(part.solved)
    out[picks] = pick[picks] | _left_out(part, before.landmark, pick[picks])
    return before._replace(pick=pick, unclear=unclear, off_px=off_px, left_out=out)


def _least_sigma(estimates: FlightEstimates) -> float:
    """Find the least reading sigma of the flight that is believed, pixels."""
    least, _ = least_sigmas([estimates.of(np.zeros(1, np.int64))])
    return float(least[0])


def _test_picks(
    estimates: FlightEstimates,
    reading: JobReadingSigma,
    wrong: Bools,
    known: Bools,
    alone: bool = False,
    sums: _Displacements | None = None,
) -> tuple[Bools, Bools]:
    """Test the picks of frames, those of wrong landmarks left out.

    Args:
        estimates: of the flight, with every pick
        reading: the reading sigma in force
        wrong: landmarks with wrong coordinates, (N,)
        known: blunders found before, (P,)
        alone: whether each frame is tested by its own residuals, whatever the reading sigma
        sums: displacements of landmarks, to which those of the other picks are added

    Returns:
        Blunders, and picks of which some are, (P,).
    """
    least = _least_sigma(estimates)
    out = _left_out(estimates, wrong, known)
    pooled = (reading.chance >= SIGNIFICANCE) | np.isnan(reading.chance).all()
    pooled &= np.isfinite(reading.freedom)  # a frame that is the only one has no chance
    found, unclear = np.zeros(len(known), bool), np.zeros(len(known), bool)
    for block in _blocks(estimates):
        equations = without_picks(block.equations, block.marked(out))
        before = block.marked(known)
        pool = Pool(reading.test_sigma, reading.freedom, pooled[block.frames] & ~before.any(axis=1))
        if alone:
            every = np.ones(len(block.frames), bool)
            pool = Pool(reading.test_sigma, equations.freedom, every)
        own, doubted = blunders_of_frames(equations, pool, least, before)
        found[block.pick[own]], unclear[block.pick[doubted]] = True, True
        if sums is not None:
            sums.add(block, without_picks(equations, own))
    return found, unclear


def _left_out(estimates: FlightEstimates, wrong: Bools, blunder: Bools) -> Bools:
    """Choose the picks of wrong landmarks that are left out: three or more stay, and half, (P,)."""
    picks, used = estimates.flight.picks, estimates.solved.used
    out = used & wrong[picks.landmark] & ~blunder
    count, gone = (
        np.bincount(picks.frame[one], minlength=len(estimates.flight.frame))
        for one in (used, out | (blunder & used))
    )
    enough = (count - gone >= LEAST_LEFT) & (2 * gone <= count)
    return np.asarray(out & enough[picks.frame])


def _wrong_in_most_frames(estimates: FlightEstimates, blunder: Bools) -> Bools:
    """Find the landmarks that are blunders in most of the frames that can show it, (N,)."""
    picks, marks = estimates.flight.picks, len(estimates.flight.landmarks.name)
    used = estimates.solved.used
    count = np.bincount(picks.frame[used], minlength=len(estimates.flight.frame))
    shown = used & (count > LEAST_LEFT)[picks.frame]
    seen, found = (
        np.bincount(picks.landmark[one], minlength=marks) for one in (shown, shown & blunder)
    )
    return np.asarray((found >= FEWEST_FRAMES) & (found > WRONG_IN * seen))


def _each_confirmed(
    estimates: FlightEstimates, reading: JobReadingSigma, wrong: Bools, blunder: Bools
) -> Bools:
    """Keep the landmarks that do not fit while the others of them are left out, (N,)."""
    landmark = estimates.flight.picks.landmark
    kept = wrong.copy()
    for k in np.flatnonzero(wrong):
        out = blunder & (landmark != k)
        sums = _summed(estimates, reading, out)
        kept[k] = _variance_without(estimates, reading, sums, int(k), out, len(wrong)) is not None
    return kept


def _wrong_landmark(
    estimates: FlightEstimates,
    reading: JobReadingSigma,
    wrong: Bools,
    blunder: Bools,
    sums: _Displacements,
) -> tuple[Bools, Bools]:
    """Test the coordinates of each landmark over all its frames.

    Args:
        estimates: of the flight, with every pick
        reading: the reading sigma in force
        wrong: landmarks whose coordinates are known to be wrong, (N,)
        blunder: picks that are blunders, (P,)
        sums: the displacements of the other picks

    Returns:
        The landmark that does not fit the others, if one does not, (N,); and landmarks of which
        one does not, where nothing tells which, (N,).
    """
    none = np.zeros(len(wrong), bool)
    tested = (sums.frames >= FEWEST_FRAMES) & ~wrong
    gain = np.where(tested, sums.gain()[0], 0.0)
    best = int(gain.argmax())
    out = blunder | _left_out(estimates, wrong, blunder)
    variance = _variance_without(estimates, reading, sums, best, out, int(tested.sum()))
    if not gain[best] > 0.0 or variance is None:
        return none, none
    near = gain > gain[best] - UNCLEAR * variance
    return (near, none) if near.sum() == 1 else (none, near)


def _variance_without(
    estimates: FlightEstimates,
    reading: JobReadingSigma,
    sums: _Displacements,
    landmark: int,
    out: Bools,
    tested: int,
) -> float | None:
    """Estimate the variance of the readings without a landmark whose coordinates are wrong.

    Args:
        estimates: of the flight, with every pick
        reading: the reading sigma in force
        sums: displacements of the picks that are not left out
        landmark: its index
        out: picks that are left out, (P,)
        tested: how many landmarks are

    Returns:
        The variance over that in force; None if the coordinates are not significantly wrong.
    """
    gains, directions = sums.gain()
    gain, free = float(gains[landmark]), int(directions[landmark])
    left = reading.freedom - free
    if not (gain > 0.0 and left > 0.0):
        return None
    chance, variance = chdtrc(free, gain), 1.0
    if np.isfinite(reading.freedom):  # which the landmark has enlarged
        least = (_least_sigma(estimates) / reading.test_sigma) ** 2
        if estimates.flight.picks.clicks is not None:  # squares are not those of the matches alone
            least = 1.0
        variance = max((1.0 - gain / sums.squares) * reading.freedom / left, least)
        told, tested_by = min(sums.freedom, reading.freedom) - free, max(variance, 1.0)
        if told > LEAST_TOLD:  # else the errors that frames may share explain all that is left
            left, tested_by = told, max((sums.squares - gain) / told, variance)
        chance = fdtrc(free, left, gain / free / tested_by)
    if not chance < LANDMARK_SIGNIFICANCE / max(tested, 1):
        return None
    sigma, shift_m = reading.test_sigma * np.sqrt(variance), sums.shift_m()[landmark]
    return variance if _shift_counts(estimates, sigma, out, landmark, shift_m) else None


class _Displacements:
    """Displacements of N landmarks against the others of their frames, summed up.

    Errors that frames may share (of positions, landmarks, lens, clock) may be the same in all F
    frames of a landmark: they count root F times, which is never too little. Wrong positions
    and clocks, a wrong focal length and distortion are no landmark's: all frames are free of them.
    """

    def __init__(self, estimates: FlightEstimates, reading: JobReadingSigma) -> None:
        marks = len(estimates.flight.landmarks.name)
        self._landmark = estimates.flight.picks.landmark
        self._sigma = reading.test_sigma
        self.frames = np.zeros(marks, np.int64)
        seen = np.bincount(self._landmark[estimates.solved.used], minlength=marks)
        self._alike = float(np.sqrt(seen.max()))
        self.normal, self.right = np.zeros((marks, 3, 3)), np.zeros((marks, 3))
        self.squares = 0.0  # weighted, of all residuals
        self.freedom = 0.0  # what they are in the mean by the readings alone

    def add(self, block: _Block, equations: ResidualEquations) -> None:
        """Add the displacements of picks in some frames.

        Args:
            block: the frames
            equations: of the frames, without what is left out
        """
        usual = np.where(equations.variance[..., None] > 0.0, block.usual, 0.0)
        shared = np.concatenate([equations.shared * self._alike, usual], axis=2)
        one = replace(equations, shared=shared, own=equations.own * self._alike)
        weights = ResidualWeights(one, self._sigma)
        left = weights.of(one.residual[..., None])[..., 0]
        self.squares += float(np.nansum(one.residual * left))
        self.freedom += float(np.nansum(weights.trace)) * self._sigma**2
        count = block.pick.shape[1]
        x, y = block.by_landmark[:, :count], block.by_landmark[:, count:]
        moved = x * left[:, :count, None] + y * left[:, count:, None]
        known = _between(weights.blocks, x, y)
        here = (one.variance[:, :count] > 0.0) & np.isfinite(moved).all(axis=2)
        here &= np.isfinite(known).all(axis=(2, 3))
        landmark = self._landmark[block.pick[here]]
        np.add.at(self.frames, landmark, 1)
        np.add.at(self.normal, landmark, known[here])
        np.add.at(self.right, landmark, moved[here])

    def gain(self) -> tuple[Floats, Ints]:
        """Calculate the decrease of the weighted sum of squares by a shift, and its directions."""
        gain, directions = np.zeros(len(self.frames)), np.zeros(len(self.frames), np.int64)
        seen = np.flatnonzero(self.frames)  # of a long list most landmarks are never picked
        size, axes = np.linalg.eigh(self.normal[seen])
        along = np.einsum("nij,ni->nj", axes, self.right[seen])
        shown = size > SHOWN * size[:, -1:]
        gain[seen] = np.where(shown, along**2 / np.where(shown, size, 1.0), 0.0).sum(axis=1)
        directions[seen] = shown.sum(axis=1)
        return gain, directions

    def shift_m(self) -> Floats:
        """Estimate the shifts that make the landmarks fit, east, north, up, (N, 3)."""
        inverses = np.linalg.pinv(self.normal, SHOWN, hermitian=True)
        return np.asarray(-np.einsum("nij,nj->ni", inverses, self.right))

    def is_determined(self) -> Bools:
        """Mark landmarks whose shift is far larger than its largest standard deviation, (N,)."""
        size, _ = np.linalg.eigh(self.normal)
        least = np.where(size[:, 0] > SHOWN * size[:, 2], size[:, 0], 0.0)
        return np.asarray(norm(self.shift_m()) * np.sqrt(least) > DETERMINED)


def _summed(estimates: FlightEstimates, reading: JobReadingSigma, out: Bools) -> _Displacements:
    """Sum up the displacements of all picks that are not left out."""
    sums = _Displacements(estimates, reading)
    for block in _blocks(estimates):
        sums.add(block, without_picks(block.equations, block.marked(out)))
    return sums


def _between(blocks: tuple[Floats, Floats, Floats], x: Floats, y: Floats) -> Floats:
    """Multiply blocks xx, xy, yy (F, L) by rows x and y (F, L, 3) from both sides, (F, L, 3, 3)."""
    xx, xy, yy = (one[..., None] for one in blocks)
    by_x, by_y = xx * x + xy * y, xy * x + yy * y
    return np.asarray(by_x[..., :, None] * x[..., None, :] + by_y[..., :, None] * y[..., None, :])


def _shift_counts(
    estimates: FlightEstimates,
    sigma: float,
    out: Bools,
    landmark: int,
    shift_m: Floats,
) -> bool:
    """Check a shift of a landmark: most frames show it, and it moves angles.

    A gross pick in one frame shifts the sum of all; angles must move by more than their 95 %
    half-widths.

    Args:
        estimates: of the flight, with every pick
        sigma: the reading sigma without the landmark
        out: picks that are left out, (P,)
        landmark: its index
        shift_m: east, north, up, (3,)
    """
    squares, shown = [], []
    for block in _blocks(estimates):
        one = without_picks(block.equations, block.marked(out))
        weights = ResidualWeights(one, sigma)
        left = np.split(weights.of(one.residual[..., None])[..., 0], 2, axis=1)
        x, y = np.split(block.by_landmark @ shift_m, 2, axis=1)
        # V^-1 - W is the part that turns take up: squares of turns in their standard deviations
        of_pick, weight = (
            xx * x**2 + 2.0 * xy * x * y + yy * y**2
            for xx, xy, yy in (weights.unfitted_blocks, weights.blocks)
        )
        here = (block.pick >= 0) & (estimates.flight.picks.landmark[block.pick] == landmark)
        here &= (weight > 0.0) & np.isfinite(of_pick)
        squares.append((of_pick - weight)[here])
        shown.append((-(x * left[0] + y * left[1]) / weight)[here])
    if not sum(map(len, shown)):
        return False
    of_shift = np.median(np.concatenate(shown))  # 1 if the frames agree, 0 if one alone shows it
    return bool(of_shift > SHOWN_BY and np.median(np.concatenate(squares)) > HALF_WIDTH**2)


# What is said of them

WRONG = "does not fit the other landmarks"
ARE_EXCHANGED = "are exchanged"
MOST_NAMED = 3  # picks and landmarks of a flight that misfits
KEPT = '[solve] blunders = "drop" leaves it out'


def blunder_findings(
    found: Blunders, flight: Flight, misfits: bool = False, explained: bool = False
) -> list[Finding]:
    """Describe the blunders of a flight; those of one that misfits together.

    Args:
        found: its blunders
        flight: the flight
        misfits: whether the flight does: many of them may come of that
        explained: whether an error that is not theirs explains that
    """
    off_px = found.off_px
    picks, name = flight.picks, flight.landmarks.name
    where = [name[k] for k in np.flatnonzero(found.landmark | found.unclear_landmark)]
    where = where if explained else []
    where += [pick_label(flight, int(k)) for k in np.flatnonzero(found.pick)]
    unclear = np.unique(picks.frame[found.unclear]).tolist()
    where += [f"some of {frame_label(flight, frame)}" for frame in unclear]
    many = len(where) > MOST_NAMED
    together = bool(where) and ((misfits and (explained or many)) or (explained and many))
    tell = []
    for k in np.flatnonzero(found.landmark & (not (explained and together))):
        own = picks.landmark == k
        known = off_px[own & np.isfinite(off_px)]
        seen, gone = len(known), int((own & found.left_out).sum())
        fits = ""
        if np.isfinite(found.shift_m[k]).all():
            east, north, up = found.shift_m[k]
            fits = f" (it would fit {east:.1f} m east, {north:.1f} m north, {up:.1f} m up of there)"
        done = f"it is used; {KEPT}"
        if flight.options.drop_blunders:
            done = "it is left out" + f" in {gone} of {seen} frames" * (gone < seen)
        off = ", and would have no image where it is"
        if seen:
            off = f" over its {seen} frames, it is {np.median(known):.1f} px off"
        tell.append(f"{name[k]} {WRONG}{off}: look at its coordinates{fits}; {done}")
    if found.unclear_landmark.any() and not (explained and together):
        labels = [name[k] for k in np.flatnonzero(found.unclear_landmark)]
        tell.append(
            f"the coordinates of {listed(labels, 'or')} do not fit the other landmarks, and "
            "nothing tells which; all are used"
        )
    if together:
        tell.append(_together(where, flight, misfits))
    for k in np.flatnonzero(found.pick & (not together)):
        done = "it is left out" if flight.options.drop_blunders else f"it is used; {KEPT}"
        tell.append(
            f"{pick_label(flight, int(k))} does not fit the others, it is {off_px[k]:.1f} px "
            f"off; {done}"
        )
    for frame in np.unique(picks.frame[found.unclear & (not together)]):
        own = np.flatnonzero(found.unclear & (picks.frame == frame))
        labels = [name[k] for k in picks.landmark[own]]
        tell.append(
            f"{frame_label(flight, int(frame))}: {listed(labels, 'or')} does not fit the others, "
            "and nothing tells which; all are used"
        )
    return [Finding(one, flight.source, severity="warning") for one in tell]


def _together(labels: list[str], flight: Flight, misfits: bool) -> str:
    """Describe the picks and landmarks that do not fit where an error of all explains more."""
    done = f"used; {KEPT}"
    if flight.options.drop_blunders:
        done = 'left out by [solve] blunders = "drop", if it is clear which'
    return (
        f"not fitting the others, which may come of {'the misfit' if misfits else 'that error'} "
        f"(mend that first): {first_of(labels, MOST_NAMED)}; {done}"
    )


def exchange_findings(found: Exchanges, flight: Flight, left_out: Bools) -> list[Finding]:
    """Describe exchanged labels.

    Args:
        found: the exchanges
        flight: the flight
        left_out: picks that are left out, (P,)
    """
    tell = []
    for picks, label, before_px, after_px in zip(*found[:4], strict=True):
        name = [flight.landmarks.name[k] for k in flight.picks.landmark[picks]]
        rather = [flight.landmarks.name[k] for k in label]
        frame = frame_label(flight, int(flight.picks.frame[picks[0]]))
        was = "one has no image" if np.isnan(before_px) else f"residuals are {before_px:.1f} px"
        every, with_ = "both", "each other's label"
        if len(name) > 2:
            pairs = [f"{one} to {other}" for one, other in zip(name, rather, strict=True)]
            every, with_ = "all", f"{listed(pairs)} renamed"
        done = f'{every} are used; [solve] blunders = "drop" leaves them out'
        if flight.options.drop_blunders:
            done = f"{every} are left out"
            if not left_out[picks].all():
                done = f"{every} are used: without them fewer than two landmarks are left"
        tell.append(
            f"{frame}: {listed(name)} {ARE_EXCHANGED}: {was}, and {after_px:.1f} px with {with_}; "
            f"{done}"
        )
    if found.not_searched:
        count = count_text(found.not_searched, "frame")
        tell.append(f"{count} with picks that do not fit: not searched for exchanged labels")
    return [Finding(one, flight.source, severity="warning") for one in tell]
