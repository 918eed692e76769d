"""One standard deviation of the readings for all frames of a job, from all their residuals.

Jobs whose frames have like numbers of landmarks are estimated together, each by its own
frames. The estimate is by restricted maximum likelihood: it takes into account that three
angles are fitted in every frame, and what the other errors that are given contribute
to the residuals, also where they are the same in all frames. Frames whose residuals do
not agree with the others are left out of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.common_errors import common_errors, landmarks_solved_for, solved_for
from vopd.attitude.maximum_likelihood import JobFrames
from vopd.attitude.reading_sigma_estimate import FrameBlock, chance_of_some, estimated_sigmas
from vopd.attitude.residual_test import SIGNIFICANCE, Pool, chance_of, equations_of, testable
from vopd.attitude.sigmas import ErrorComponent
from vopd.estimate import Estimate


class JobReadingSigma(NamedTuple):
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


class ReadingSigmas(NamedTuple):
    """The reading sigma of the job of every frame, where frames are of one job or of several."""

    sigma: Floats  # (F,) in force, image units
    freedom: Floats  # (F,) degrees of freedom of the estimate
    misfit: Bools  # (F,) frames whose residuals do not agree with the standard deviations in force


SOURCES = {
    "given": "as given",
    "residuals": "from the residuals of all frames",
    "sample": "from the residuals of a sample of the frames",
    "repeated": "from repeated readings, which is more than the residuals show",
    "resolution": "from the resolution of the readings, which is more than the residuals show",
}


class Least(NamedTuple):
    """The least reading sigma that is believed of each of J jobs, and where it comes from."""

    sigma: Floats  # (J,) image units
    repeated: Bools  # (J,) by repeated readings, otherwise by their resolution


def least_sigmas(jobs: Sequence[Estimate]) -> Least:
    """The least reading sigma that is believed of each job.

    Args:
        jobs: their estimates, or that of one block of each
    """
    stated = [(one.reading_spread, one.reading_floor, one.focal_length) for one in jobs]
    spread, floor, focal_length = np.array(stated, dtype=np.float64).T
    spread, floor = np.nan_to_num(spread), np.nan_to_num(floor)
    least = np.maximum(np.maximum(spread, floor), 1e-9 * focal_length)
    return Least(least, np.asarray(spread > floor))


@np.errstate(all="ignore")
def reading_scales(
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
    found = _in_force(blocks, least_sigmas(estimates[:1]), given)
    return [
        found.of_job(0, _by_frame(block, chance, len(estimate.frame)))
        for estimate, block, chance in zip(estimates, blocks, found.chance, strict=True)
    ]


@np.errstate(all="ignore")
def reading_scales_of_jobs(
    estimate: Estimate,
    components: list[ErrorComponent],
    given: float | None,
    frames: Sequence[slice],
    least: Least,
) -> list[JobReadingSigma]:
    """Estimate the reading sigmas of several jobs, as `reading_scales` does for one.

    Args:
        estimate: the frames of all jobs
        components: the errors that are given; none is the same in all frames, unless there
            is only one job
        given: as `reading_scales` takes it
        frames: the frames of each job
        least: the least sigma of each job
    """
    counts = [one.stop - one.start for one in frames]
    numbers = landmarks_solved_for([estimate]) if len(frames) == 1 else None
    block = _block(estimate, components, np.repeat(np.arange(len(frames)), counts), numbers)
    found = _in_force([block], least, given)
    chance = _by_frame(block, found.chance[0], len(estimate.frame))
    return [found.of_job(k, chance[own]) for k, own in enumerate(frames)]


def _by_frame(block: FrameBlock, chance: Floats, frames: int) -> Floats:
    """The chance of every frame; NaN where it is not tested, (F,)."""
    every = np.full(frames, np.nan)
    every[block.frames] = chance
    return every


def _block(
    estimate: Estimate, components: list[ErrorComponent], job: Ints, numbers: Ints | None
) -> FrameBlock:
    frames = np.flatnonzero(testable(estimate))
    own = [one for one in components if not solved_for(one, numbers)]
    marginal = equations_of(estimate, components, frames)
    apart = equations_of(estimate, own, frames) if len(own) < len(components) else marginal
    return FrameBlock(
        frames,
        marginal,
        JobFrames(job[frames], apart, common_errors(estimate, components, frames, numbers)),
        np.asarray(np.abs(marginal.residual).max(axis=1, initial=0.0) <= estimate.focal_length),
    )


class _InForce(NamedTuple):
    """The reading sigma of each of J jobs, and the chances of the frames of each block by it."""

    sigma: Floats
    freedom: Floats
    source: list[str]
    test_sigma: Floats
    chance: list[Floats]

    def of_job(self, job: int, chance: Floats) -> JobReadingSigma:
        """The record of a job."""
        sigma, freedom, test = (float(v[job]) for v in (self.sigma, self.freedom, self.test_sigma))
        return JobReadingSigma(sigma, freedom, self.source[job], chance, test)


def _in_force(blocks: list[FrameBlock], least: Least, given: float | None) -> _InForce:
    jobs = len(least.sigma)
    if given is not None:
        test = np.full(jobs, given) if given > 0.0 else least.sigma
        chance = [
            chance_of(block.marginal, Pool(test[block.job], np.inf, None)) for block in blocks
        ]
        endless = np.full(jobs, np.inf)
        return _InForce(np.full(jobs, given), endless, ["given"] * jobs, test, chance)
    found = estimated_sigmas(blocks, least.sigma)
    better = found.sigma >= least.sigma
    sigma = np.where(better, found.sigma, least.sigma)
    freedom = np.where(better, found.freedom, np.inf)
    pools = [
        Pool(sigma[block.job], freedom[block.job], kept & better[block.job])
        for block, kept in zip(blocks, found.kept, strict=True)
    ]
    source = [
        "residuals" if own else "repeated" if repeated else "resolution"
        for own, repeated in zip(better, least.repeated, strict=True)
    ]
    tested = better & found.tested
    chance = [
        np.where(tested[block.job], known, chance_of_some(block, pool, ~tested[block.job]))
        for block, known, pool in zip(blocks, found.chance, pools, strict=True)
    ]
    return _InForce(sigma, freedom, source, sigma, chance)
