"""The most likely reading sigma of each job, by the residuals of its frames."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.special import chdtri

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.common_errors import CommonErrors
from vopd.attitude.residuals import ResidualEquations, ResidualWeights
from vopd.geometry.linear import inverse, pseudo_inverse

PASSES = 6
LEAST_SLOPE = -0.4  # of the excess by log sigma, so that no step is too long
SETTLED = 1e-4  # relative change of the variance that is none
NOTHING_LEFT = -1.0  # the excess where the other errors explain all residuals
LARGEST = 1e4  # reading sigmas; a common error that moves residuals by more counts as this


class JobFrames(NamedTuple):
    """Some frames with like numbers of landmarks, of one job or of several."""

    job: Ints  # (F,) index of each frame's job
    equations: ResidualEquations
    common: CommonErrors  # the same in all frames; there are some only where all are of one job

    def only(self, frames: Bools) -> JobFrames:
        """Some of the frames."""
        if frames.all():
            return self
        equations = ResidualEquations(*(part[frames] for part in self.equations))
        return JobFrames(self.job[frames], equations, self.common.of(frames))

    def summed(self, values: Floats, jobs: int) -> Floats:
        """Values (F,) added up by job (J,), in the order of the frames."""
        return np.bincount(self.job, values, jobs).astype(np.float64)


def typical_sigma(parts: Sequence[JobFrames], jobs: int) -> Floats:
    """A first reading sigma by the median over frames; wrong readings in a few do not move it.

    Args:
        parts: frames of all jobs
        jobs: how many jobs there are

    Returns:
        The sigma of each job (J,), image units; NaN where it has no frame.
    """
    ratios = []
    for _, one, _ in parts:
        scale = np.where(one.variance > 0.0, one.variance, np.inf) ** -0.5
        residual, partials = one.residual * scale, one.partials * scale[..., None]
        fitted = partials @ (pseudo_inverse(partials) @ residual[..., None])
        squares = ((residual - fitted[..., 0]) ** 2).sum(axis=1)
        ratios.append(squares / chdtri(one.freedom, 0.5))
    job = np.concatenate([part.job for part in parts])
    return np.sqrt(_medians(np.concatenate(ratios), job, jobs))


def _medians(values: Floats, job: Ints, jobs: int) -> Floats:
    """The median of each job's values that are numbers (J,); NaN where there are none."""
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
    """The reading sigma of each job by restricted maximum likelihood, and its degrees of freedom.

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
        squares, trace = _score([one.only(going[one.job]) for one in parts], sigma)
        settled = going & (np.abs(squares / trace - 1.0) < SETTLED)
        found[settled] = ((sigma**2 * trace) ** 2 / freedom)[settled]
        going &= ~settled
        if not going.any():
            return sigma, found
        excess = np.log(squares / trace) / 2.0
        step, last = _step(excess, last, step), excess
        sigma[going] *= np.exp(step)[going]
    for job in np.flatnonzero(going):
        own = [one.only(one.job == job) for one in parts]
        at = [one._replace(job=np.zeros_like(one.job)) for one in own]
        sigma[job], trace_there = _root(at, start[job], sigma[job], least[job])
        found[job] = (sigma[job] ** 2 * trace_there) ** 2 / freedom[job]
    return sigma, found


def _step(excess: Floats, last: Floats, taken: Floats) -> Floats:
    """The next change of log sigma (J,): the excess, or more where the excess falls slowly.

    Where the readings are a small part of the residuals, the excess hardly falls with sigma,
    and a line through its last two values leads to where it is 0.
    """
    slope = np.clip((excess - last) / taken, -1.0, LEAST_SLOPE)
    return np.where(np.isnan(slope) | (taken == 0.0), excess, -excess / slope)


def _root(
    parts: Sequence[JobFrames], start: float, reached: float, least: float
) -> tuple[float, float]:
    """The sigma of one job, and the trace of W S there, by a search between limits."""
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
    """r' W S W r and the trace of W S of each job (J,), the common errors solved for."""
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
