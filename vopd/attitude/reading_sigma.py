"""The reading sigma of a job, by restricted maximum likelihood from its residuals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.special import chdtri

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.residuals import (
    SIGNIFICANCE,
    Pool,
    ResidualEquations,
    ResidualWeights,
    chance_of,
    equations_of,
    finite,
    testable,
)
from vopd.attitude.sigmas import ErrorComponent
from vopd.estimate import Estimate
from vopd.geometry.linear import inverse, pseudo_inverse
from vopd.records import Rows

# Common errors of all frames, solved for with the reading sigma.

MOST_LANDMARKS = 100  # whose errors are solved for; of more, each frame has its own
MOST_IN_A_FRAME = 40  # landmarks; a frame with more has its own
MOST_NUMBERS = 20_000_000  # of the columns of all frames


def landmarks_solved_for(estimates: Sequence[Estimate]) -> Ints | None:
    """List the numbers of all landmarks of a job; None if each frame has errors of its own."""
    numbers = np.unique(np.concatenate([e.landmark[e.used] for e in estimates]))
    sizes = [(len(e.frame), e.used.shape[1]) for e in estimates]
    columns = sum(f * 6 * count**2 for f, count in sizes if count <= MOST_IN_A_FRAME)
    one_frame = sum(frames for frames, _ in sizes) == 1
    few = len(numbers) <= MOST_LANDMARKS and columns <= MOST_NUMBERS
    return None if one_frame or not few else numbers


def solved_for(component: ErrorComponent, numbers: Ints | None) -> bool:
    """Check whether the errors of a component are common to all frames and solved for.

    Args:
        component: one of the job's errors, in one block
        numbers: those of its landmarks whose errors are solved for
    """
    few = numbers is not None and component.residual.shape[1] <= 2 * MOST_IN_A_FRAME
    return component.common and (few or not component.each_landmark)


@dataclass(frozen=True, eq=False, repr=False)
class CommonErrors(Rows):
    """Errors that are the same in all frames, one standard deviation each."""

    columns: Floats  # (F, 2L, K) of the residuals
    cause: Ints  # (F, K) which of the job's causes each column is
    causes: int

    def summed(self, blocks: Floats) -> Floats:
        """Add up blocks (F, K, K) of frames by their causes."""
        index = self.cause[:, :, None] * self.causes + self.cause[:, None, :]
        total = np.bincount(index.ravel(), blocks.ravel(), self.causes**2)
        return np.asarray(total.reshape(self.causes, self.causes))

    def summed_products(self, weighted: Floats) -> Floats:
        """Multiply weighted residuals (F, 2L) by the columns, and add up by causes."""
        own = (self.columns.swapaxes(1, 2) @ weighted[..., None])[..., 0]
        return np.bincount(self.cause.ravel(), own.ravel(), self.causes).astype(np.float64)


def common_errors(
    estimate: Estimate, components: list[ErrorComponent], frames: Ints, numbers: Ints | None
) -> CommonErrors:
    """Collect the common errors of a job that are solved for.

    Args:
        estimate: the job, or a block of it
        components: its errors
        frames: indices of frames
        numbers: those of the job's landmarks whose errors are solved for
    """
    count = estimate.used.shape[1]
    columns, causes, number = [], [], 0
    for one in components:
        if not solved_for(one, numbers):
            if one.each_landmark and numbers is not None:
                number += 3 * len(numbers)
            continue
        change = one.residual[frames]
        if numbers is None or not one.each_landmark:
            columns.append(change)
            index = np.arange(change.shape[2])
            causes.append(np.broadcast_to(number + index, (len(frames), len(index))))
            number += len(index)
            continue
        own = np.zeros((len(frames), 2 * count, count, 3))
        at = np.arange(count)
        own[:, at, at], own[:, count + at, at] = change[:, :count], change[:, count:]
        columns.append(own.reshape(len(frames), 2 * count, 3 * count))
        which = np.minimum(np.searchsorted(numbers, estimate.landmark[frames]), len(numbers) - 1)
        index = number + 3 * which[..., None] + np.arange(3)
        causes.append(index.reshape(len(frames), 3 * count))
        number += 3 * len(numbers)
    none = np.zeros((len(frames), 2 * count, 0))
    used = np.tile(estimate.used[frames], 2)
    return CommonErrors(
        finite(np.concatenate([none, *columns], axis=2), used),
        np.concatenate([np.zeros((len(frames), 0), np.int64), *causes], axis=1),
        number,
    )


# Restricted maximum likelihood.

PASSES = 6
LEAST_SLOPE = -0.4  # of the excess by log sigma, so that no step is too long
SETTLED = 1e-4  # relative change of the variance that is none
NOTHING_LEFT = -1.0  # the excess where the other errors explain all residuals
LARGEST = 1e4  # reading sigmas; a common error that moves residuals by more counts as this


@dataclass(frozen=True, eq=False, repr=False)
class JobFrames(Rows):
    """Some frames with like numbers of landmarks, of one job or of several."""

    job: Ints  # (F,) index of each frame's job
    equations: ResidualEquations
    common: CommonErrors  # the same in all frames; there are some only where all are of one job

    def summed(self, values: Floats, jobs: int) -> Floats:
        """Add up values (F,) by job (J,), in the order of the frames."""
        return np.bincount(self.job, values, jobs).astype(np.float64)


def typical_sigma(parts: Sequence[JobFrames], jobs: int) -> Floats:
    """Estimate a first reading sigma from the median over frames, robust against a few wrong ones.

    Returns:
        The sigma of each job (J,), image units; NaN where it has no frame.
    """
    ratios = []
    for one in (part.equations for part in parts):
        scale = np.where(one.variance > 0.0, one.variance, np.inf) ** -0.5
        residual, partials = one.residual * scale, one.partials * scale[..., None]
        fitted = partials @ (pseudo_inverse(partials) @ residual[..., None])
        squares = ((residual - fitted[..., 0]) ** 2).sum(axis=1)
        ratios.append(squares / chdtri(one.freedom, 0.5))
    job = np.concatenate([part.job for part in parts])
    return np.sqrt(_medians(np.concatenate(ratios), job, jobs))


def _medians(values: Floats, job: Ints, jobs: int) -> Floats:
    """Find the median of each job's values that are numbers (J,); NaN if there are none."""
    known = ~np.isnan(values)
    values, job = values[known], job[known]
    ordered = values[np.lexsort((values, job))]
    count = np.bincount(job, minlength=jobs)
    some = count > 0
    first = (np.cumsum(count) - count)[some]
    low, high = first + (count[some] - 1) // 2, first + count[some] // 2
    medians = np.full(jobs, np.nan)
    medians[some] = np.where(low == high, ordered[low], (ordered[low] + ordered[high]) / 2.0)
    return medians


def most_likely(parts: Sequence[JobFrames], start: Floats, least: Floats) -> tuple[Floats, Floats]:
    """Estimate reading sigmas by restricted maximum likelihood, with degrees of freedom.

    With W as in `ResidualWeights`, and less what the common errors explain, its variance
    is such that r' W S W r equals the trace of W S.

    Args:
        parts: frames of all jobs
        start: first values (J,), image units
        least: values (J,) below which the result does not matter
    """
    jobs = len(start)
    freedom = np.sum([one.summed(one.equations.freedom, jobs) for one in parts], axis=0)
    sigma, found = start.copy(), np.full(jobs, np.nan)
    going = freedom > 0.0
    step = last = np.zeros(jobs)
    for _ in range(PASSES):  # where the readings are most of the residuals two or three will do
        squares, trace = _score(_some(parts, [going[one.job] for one in parts]), sigma)
        settled = going & (np.abs(squares / trace - 1.0) < SETTLED)
        found[settled] = ((sigma**2 * trace) ** 2 / freedom)[settled]
        going &= ~settled
        if not going.any():
            return sigma, found
        excess = np.log(squares / trace) / 2.0
        step, last = _step(excess, last, step), excess
        sigma[going] *= np.exp(step)[going]
    for job in np.flatnonzero(going):
        own = _some(parts, [one.job == job for one in parts])
        at = [replace(one, job=np.zeros_like(one.job)) for one in own]
        sigma[job], trace_there = _root(at, start[job], sigma[job], least[job])
        found[job] = (sigma[job] ** 2 * trace_there) ** 2 / freedom[job]
    return sigma, found


def _some(parts: Sequence[JobFrames], marks: Sequence[Bools]) -> list[JobFrames]:
    """Select frames of each part by their marks; where all are marked nothing is copied."""
    each = zip(parts, marks, strict=True)
    return [part if marked.all() else part.take(marked) for part, marked in each]


def _step(excess: Floats, last: Floats, taken: Floats) -> Floats:
    """Calculate the next step of log sigma (J,): the excess, or more if the excess falls slowly.

    Where the readings are a small part of the residuals, the excess hardly falls with sigma,
    and a line through its last two values leads to where it is 0.
    """
    slope = np.clip((excess - last) / taken, -1.0, LEAST_SLOPE)
    return np.where(np.isnan(slope) | (taken == 0.0), excess, -excess / slope)


def _root(
    parts: Sequence[JobFrames], start: float, reached: float, least: float
) -> tuple[float, float]:
    """Solve for the sigma of one job, and the trace of W S there, between limits."""
    from scipy.optimize import brentq  # a third of a second, seldom needed

    def excess(log_sigma: float) -> float:
        squares, trace = _score(parts, np.array([np.exp(log_sigma)]))
        if not (squares[0] > 0.0 and trace[0] > 0.0):  # rounding is all that is left of them
            return NOTHING_LEFT
        return float(np.log(squares[0] / trace[0]))

    low, high = float(np.log(least)), float(np.log(max(start, reached, least) * 2.0))
    if not excess(low) > 0.0:
        return least / 2.0, np.inf
    while excess(high) > 0.0:
        high += 1.0
    sigma = float(np.exp(brentq(excess, low, high, xtol=SETTLED / 10.0)))
    _, trace = _score(parts, np.array([sigma]))
    return sigma, float(trace[0])


def _score(parts: Sequence[JobFrames], sigma: Floats) -> tuple[Floats, Floats]:
    """Evaluate r' W S W r and the trace of W S of each job (J,), the common errors solved for."""
    jobs, causes = len(sigma), parts[0].common.causes
    weighted, columns, trace = [], [], np.zeros(jobs)
    by_cause, products = np.zeros((causes, causes)), np.zeros(causes)
    for one in parts:
        weights = ResidualWeights(one.equations, sigma[one.job])
        weighted.append(weights.of(one.equations.residual[..., None])[..., 0])
        columns.append(weights.of(one.common.columns))
        by_cause += one.common.summed(one.common.columns.swapaxes(1, 2) @ columns[-1])
        products += one.common.summed_products(weighted[-1])
        trace += one.summed(weights.trace, jobs)
    # the square of a far larger error plus 1 rounds to the square, and what is left is rounding
    scale = LARGEST / np.sqrt(np.maximum(np.diagonal(by_cause), LARGEST**2))
    both = scale[:, None] * scale
    inner = inverse(np.eye(causes) + both * by_cause) * both
    # the inverse is good to so many roundings as its largest eigenvalue; less is left by chance
    rounding = np.finfo(np.float64).eps * np.trace(both * by_cause) * trace
    squares = np.zeros(jobs)
    for one, whole, column in zip(parts, weighted, columns, strict=True):
        variance, common = one.equations.variance, one.common
        left = whole - (column @ (inner @ products)[common.cause][..., None])[..., 0]
        squares += one.summed((variance * left**2).sum(axis=1), jobs)
        of_causes = column.swapaxes(1, 2) @ (column * variance[..., None])
        trace -= (inner * common.summed(of_causes)).sum()
    return squares, np.maximum(trace, rounding) if causes else trace


# Frames that agree with the reading sigma.

STATED = 20.0  # times what stated errors of positions do: larger residuals are not of these
ROUNDS = 6  # of leaving out frames that do not agree


class FrameBlock(NamedTuple):
    """Frames with like numbers of landmarks that are tested."""

    frames: Ints  # their indices in the block's estimate
    marginal: ResidualEquations  # with all errors
    apart: JobFrames  # without those that are solved for
    plausible: Bools  # (F,) without a residual above the focal length, which no reading causes

    @property
    def job(self) -> Ints:
        """The index of each frame's job (F,)."""
        return self.apart.job


def estimated_sigmas(
    blocks: list[FrameBlock], least: Floats, repeated: Bools
) -> tuple[list[JobReadingSigma], list[Floats]]:
    """Estimate the reading sigma of each job without the frames that do not agree with it.

    Args:
        blocks: the frames of all jobs that are tested
        least: the least sigma of each job that is believed (J,)
        repeated: where that is by repeated readings (J,), otherwise by their resolution

    Returns:
        The reading sigma of each job, without chances, and the chances of each block's frames.
    """
    jobs, kept = len(least), [block.plausible for block in blocks]
    apart = [block.apart for block in blocks]
    parts = _some(apart, kept)
    start = np.maximum(typical_sigma(parts, jobs), least)
    freedom = np.sum([one.summed(one.equations.freedom, jobs) for one in parts], axis=0)
    sigma, going, tested = start, _any_of_job(blocks, kept, jobs), np.zeros(jobs, bool)
    chance = [np.full(len(block.frames), np.nan) for block in blocks]
    for turn in range(ROUNDS):
        pools = [Pool(sigma[b.job], freedom[b.job], k) for b, k in zip(blocks, kept, strict=True)]
        asked = [going[block.job] for block in blocks]
        chance = [
            np.where(some, chance_of_some(block, pool, some), known)
            for block, pool, some, known in zip(blocks, pools, asked, chance, strict=True)
        ]
        agree = [
            block.plausible & some & ~(known < SIGNIFICANCE)
            for block, some, known in zip(blocks, asked, chance, strict=True)
        ]
        going = going & _any_of_job(blocks, agree, jobs)
        if turn > 0:
            changed = [one != other for one, other in zip(agree, kept, strict=True)]
            tested |= going & ~_any_of_job(blocks, changed, jobs)
            going = going & ~tested
        if not going.any():
            break
        kept = [
            np.where(going[block.job], one, before)
            for block, one, before in zip(blocks, agree, kept, strict=True)
        ]
        taken = [k & going[b.job] for b, k in zip(blocks, kept, strict=True)]
        likely, of_likely = most_likely(_some(apart, taken), start, least)
        sigma, freedom = np.where(going, likely, sigma), np.where(going, of_likely, freedom)
    better = _any_of_job(blocks, kept, jobs) & (sigma >= least)
    sigma, freedom = np.where(better, sigma, least), np.where(better, freedom, np.inf)
    source = [
        "residuals" if own else "repeated" if again else "resolution"
        for own, again in zip(better, repeated, strict=True)
    ]
    pools = [
        Pool(sigma[block.job], freedom[block.job], one & better[block.job])
        for block, one in zip(blocks, kept, strict=True)
    ]
    tested &= better
    chance = [
        np.where(tested[block.job], known, chance_of_some(block, pool, ~tested[block.job]))
        for block, known, pool in zip(blocks, chance, pools, strict=True)
    ]
    return _of_jobs(sigma, freedom, source, sigma), chance


def chance_of_some(block: FrameBlock, pool: Pool, some: Bools) -> Floats:
    """Test the residuals of some frames of a block: their chance, (F,); NaN for the others.

    Args:
        block: the frames
        pool: the reading sigma of the job of each of them
        some: which are asked for, (F,)
    """
    if some.all():
        return chance_of(block.marginal, pool)
    chance = np.full(len(some), np.nan)
    if some.any():
        chance[some] = chance_of(
            block.marginal.take(some), Pool(*(np.asarray(part)[some] for part in pool))
        )
    return chance


def _any_of_job(blocks: list[FrameBlock], marks: list[Bools], jobs: int) -> Bools:
    """Find the jobs of which any frame has a mark (J,)."""
    found = np.zeros(jobs, bool)
    for block, marked in zip(blocks, marks, strict=True):
        found[block.job[marked]] = True
    return found


def _of_jobs(
    sigma: Floats, freedom: Floats, source: Sequence[str], test_sigma: Floats
) -> list[JobReadingSigma]:
    none = np.zeros(0)
    each = zip(sigma.tolist(), freedom.tolist(), source, test_sigma.tolist(), strict=True)
    return [JobReadingSigma(own, free, whence, none, test) for own, free, whence, test in each]


# Reading sigma of a job.
#
# Jobs whose frames have like numbers of landmarks are estimated together, each by its own
# frames. The estimate is by restricted maximum likelihood: it takes into account that three
# angles are fitted in every frame, and what the other errors that are given contribute
# to the residuals, also where they are the same in all frames. Frames whose residuals do
# not agree with the others are left out of it.


@dataclass(frozen=True, eq=False, repr=False)
class JobReadingSigma(Rows):
    """The reading sigma of a job, and how well each frame agrees with it."""

    sigma: float  # in force, image units
    freedom: float  # degrees of freedom of the estimate; infinite where it was not estimated
    source: str  # one of `SOURCES`
    chance: Floats  # (F,) that residuals are as large as the frame's, or larger; NaN: not tested
    test_sigma: float  # of the test, image units: as `sigma`, but never 0

    @property
    def misfit(self) -> Bools:
        """Frames whose residuals do not agree with the standard deviations in force (F,)."""
        return np.asarray(self.chance < SIGNIFICANCE)


SOURCES = {
    "given": "as given",
    "stated": "as stated in the project",
    "residuals": "from the residuals of all frames",
    "sample": "from the residuals of a sample of the frames",
    "repeated": "from repeated readings, which is more than the residuals show",
    "resolution": "from the resolution of the readings, which is more than the residuals show",
}


def least_sigmas(jobs: Sequence[Estimate]) -> tuple[Floats, Bools]:
    """Find the least reading sigma that is believed of each job.

    Returns:
        The sigma (J,), image units; and where it is by repeated readings (J,), otherwise by their
        resolution.
    """
    stated = [(one.reading_spread, one.reading_floor, one.focal_length) for one in jobs]
    spread, floor, focal_length = np.array(stated, dtype=np.float64).T
    spread, floor = np.nan_to_num(spread), np.nan_to_num(floor)
    least = np.maximum(np.maximum(spread, floor), 1e-9 * focal_length)
    return least, np.asarray(spread > floor)


@np.errstate(all="ignore")
def reading_sigmas(
    estimates: Sequence[Estimate], components: Sequence[list[ErrorComponent]], given: float | None
) -> list[JobReadingSigma]:
    """Estimate the reading sigma of a job, and test every frame's residuals against it.

    The sigma is never below the spread of repeated readings, nor below what the
    resolution of the readings leaves.

    Args:
        estimates: the blocks of the job, one or more
        components: the other errors that are given, for each block
        given: the reading sigma, image units, where it is not to be estimated; 0 leaves
            the readings' errors out of the uncertainty, and the test takes the least one

    Returns:
        For each block the same sigma, with the tests of its frames.
    """
    numbers = landmarks_solved_for(estimates)
    job = [np.zeros(len(estimate.frame), np.int64) for estimate in estimates]
    blocks = [_block(*one, numbers) for one in zip(estimates, components, job, strict=True)]
    (found,), chances = _in_force(blocks, estimates[:1], given)
    return [
        replace(found, chance=_by_frame(block, chance, len(estimate.frame)))
        for estimate, block, chance in zip(estimates, blocks, chances, strict=True)
    ]


@np.errstate(all="ignore")
def reading_sigmas_of_jobs(
    estimate: Estimate,
    components: list[ErrorComponent],
    given: float | None,
    jobs: Sequence[Estimate],
) -> list[JobReadingSigma]:
    """Estimate the reading sigmas of several jobs, as `reading_sigmas` does for one.

    Args:
        estimate: the frames of all jobs
        components: the errors that are given; none is the same in all frames, unless there
            is only one job
        given: as `reading_sigmas` takes it
        jobs: the estimate of each
    """
    counts = [len(one.frame) for one in jobs]
    numbers = landmarks_solved_for([estimate]) if len(jobs) == 1 else None
    block = _block(estimate, components, np.repeat(np.arange(len(jobs)), counts), numbers)
    found, (chance,) = _in_force([block], jobs, given)
    chances = np.split(_by_frame(block, chance, len(estimate.frame)), np.cumsum(counts)[:-1])
    return [replace(one, chance=own) for one, own in zip(found, chances, strict=True)]


def _by_frame(block: FrameBlock, chance: Floats, frames: int) -> Floats:
    """Spread the chances over all frames; NaN if a frame is not tested, (F,)."""
    every = np.full(frames, np.nan)
    every[block.frames] = chance
    return every


def _block(
    estimate: Estimate, components: list[ErrorComponent], job: Ints, numbers: Ints | None
) -> FrameBlock:
    frames = np.flatnonzero(testable(estimate))
    focal = np.broadcast_to(estimate.focal_length, len(estimate.frame))[frames]
    own = [one for one in components if not solved_for(one, numbers)]
    marginal = equations_of(estimate, components, frames)
    apart = equations_of(estimate, own, frames) if len(own) < len(components) else marginal
    # a place that is guessed to a hundred metres has as large residuals where it is stated
    stated = STATED * np.sqrt((marginal.shared**2).sum(axis=2)).max(axis=1, initial=0.0)
    return FrameBlock(
        frames,
        marginal,
        JobFrames(job[frames], apart, common_errors(estimate, components, frames, numbers)),
        np.asarray(np.abs(marginal.residual).max(axis=1, initial=0.0) <= np.maximum(focal, stated)),
    )


def _in_force(
    blocks: list[FrameBlock], jobs: Sequence[Estimate], given: float | None
) -> tuple[list[JobReadingSigma], list[Floats]]:
    """Find the reading sigma of each job, without chances, and the chances of each block's frames.

    Args:
        blocks: the frames of all jobs that are tested
        jobs: the estimates of the jobs, or that of one block of each
        given: the reading sigma, where it is not to be estimated
    """
    least, repeated = least_sigmas(jobs)
    if given is None:
        return estimated_sigmas(blocks, least, repeated)
    sigma, test = np.full(len(jobs), given), np.full(len(jobs), given) if given > 0.0 else least
    chance = [chance_of(block.marginal, Pool(test[block.job], np.inf, None)) for block in blocks]
    return _of_jobs(sigma, np.full(len(jobs), np.inf), ["given"] * len(jobs), test), chance
