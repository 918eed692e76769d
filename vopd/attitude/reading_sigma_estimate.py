"""Estimate the reading sigmas of jobs by the frames that agree with them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.maximum_likelihood import JobFrames, most_likely, typical_sigma
from vopd.attitude.residual_test import SIGNIFICANCE, Pool, chance_of
from vopd.attitude.residuals import ResidualEquations

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


class EstimatedSigmas(NamedTuple):
    """The reading sigma of each of J jobs by the frames that agree with it."""

    sigma: Floats  # NaN where the job has no frame
    freedom: Floats
    kept: list[Bools]  # of each block the frames that it is from
    chance: list[Floats]  # of the residuals of each block's frames
    tested: Bools  # (J,) jobs whose chances are by this sigma and these frames


def estimated_sigmas(blocks: list[FrameBlock], least: Floats) -> EstimatedSigmas:
    """Estimate the reading sigma of each job without the frames that do not agree with it.

    Args:
        blocks: the frames of all jobs that are tested
        least: the least sigma of each job that is believed (J,)
    """
    jobs, kept = len(least), [block.plausible for block in blocks]
    parts = _parts(blocks, kept)
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
        likely, of_likely = most_likely(_parts(blocks, taken), start, least)
        sigma, freedom = np.where(going, likely, sigma), np.where(going, of_likely, freedom)
    sigma = np.where(_any_of_job(blocks, kept, jobs), sigma, np.nan)
    return EstimatedSigmas(sigma, freedom, kept, chance, tested)


def chance_of_some(block: FrameBlock, pool: Pool, some: Bools) -> Floats:
    """The chance of the residuals of some frames of a block, (F,); NaN for the others.

    Args:
        block: the frames
        pool: the reading sigma of the job of each of them
        some: which are asked for, (F,)
    """
    if some.all():
        return chance_of(block.marginal, pool)
    chance = np.full(len(some), np.nan)
    if some.any():
        equations = ResidualEquations(*(part[some] for part in block.marginal))
        chance[some] = chance_of(equations, Pool(*(np.asarray(part)[some] for part in pool)))
    return chance


def _any_of_job(blocks: list[FrameBlock], marks: list[Bools], jobs: int) -> Bools:
    """The jobs of which any frame has a mark (J,)."""
    found = np.zeros(jobs, bool)
    for block, marked in zip(blocks, marks, strict=True):
        found[block.job[marked]] = True
    return found


def _parts(blocks: list[FrameBlock], kept: list[Bools]) -> list[JobFrames]:
    return [block.apart.only(ok) for block, ok in zip(blocks, kept, strict=True)]
