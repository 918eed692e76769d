"""One standard deviation of the readings for all frames of a job, from all their residuals.

The estimate is by restricted maximum likelihood: it takes into account that three
angles are fitted in every frame, and what the other errors that are given contribute
to the residuals, also where they are the same in all frames. Frames whose residuals do
not agree with the others are left out of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.common_errors import (
    CommonErrors,
    common_errors,
    landmarks_solved_for,
    solved_for,
)
from vopd.attitude.error_components import ErrorComponent
from vopd.attitude.maximum_likelihood import most_likely, some_frames, typical_sigma
from vopd.attitude.residual_covariance import ResidualEquations
from vopd.attitude.residual_test import SIGNIFICANCE, Pool, chance_of, equations_of, testable
from vopd.estimate import Estimate

ROUNDS = 6  # of leaving out frames that do not agree


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


SOURCES = {
    "given": "as given",
    "residuals": "from the residuals of all frames",
    "repeated": "from repeated readings, which is more than the residuals show",
    "resolution": "from the resolution of the readings, which is more than the residuals show",
}


class _FrameBlock(NamedTuple):
    """Frames of a job with like numbers of landmarks that are tested."""

    frames: Ints  # their indices in the block's estimate
    marginal: ResidualEquations  # with all errors
    apart: ResidualEquations  # without those that are solved for
    common: CommonErrors
    plausible: Bools  # (F,) without a residual above the focal length, which no reading causes


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
    least, source = _least(estimates[0])
    numbers = landmarks_solved_for(estimates)
    blocks = [_block(e, own, numbers) for e, own in zip(estimates, components, strict=True)]
    pools = [Pool(least, np.inf, None)] * len(blocks)
    if given is None:
        found = _estimated([block for block in blocks if len(block.frames)], least)
        if found is not None and found.sigma >= least:
            pools, source = [found.of(block) for block in blocks], "residuals"
    elif given > 0.0:
        pools = [Pool(given, np.inf, None)] * len(blocks)
    scales = []
    for estimate, block, pool in zip(estimates, blocks, pools, strict=True):
        chance = np.full(len(estimate.frame), np.nan)
        chance[block.frames] = chance_of(block.marginal, pool)
        sigma, where = (pool.sigma, source) if given is None else (given, "given")
        scales.append(JobReadingSigma(sigma, pool.freedom, where, chance, pool.sigma))
    return scales


def _least(estimate: Estimate) -> tuple[float, str]:
    """The least reading sigma that is believed, and where it comes from."""
    spread, floor = np.nan_to_num([estimate.reading_spread, estimate.reading_floor])
    rounding = 1e-9 * estimate.focal_length
    return float(max(spread, floor, rounding)), "repeated" if spread > floor else "resolution"


def _block(
    estimate: Estimate, components: list[ErrorComponent], numbers: Ints | None
) -> _FrameBlock:
    frames = np.flatnonzero(testable(estimate))
    own = [one for one in components if not solved_for(one, numbers)]
    marginal = equations_of(estimate, components, frames)
    return _FrameBlock(
        frames,
        marginal,
        equations_of(estimate, own, frames) if len(own) < len(components) else marginal,
        common_errors(estimate, components, frames, numbers),
        np.asarray(np.abs(marginal.residual).max(axis=1, initial=0.0) <= estimate.focal_length),
    )


class _Estimated(NamedTuple):
    """A reading sigma, its degrees of freedom, and the frames of each block that it is from."""

    sigma: float
    freedom: float
    blocks: list[_FrameBlock]
    kept: list[Bools]

    def of(self, block: _FrameBlock) -> Pool:
        """What the frames of a block are tested with."""
        for one, kept in zip(self.blocks, self.kept, strict=True):
            if one is block:
                return Pool(self.sigma, self.freedom, kept)
        return Pool(self.sigma, self.freedom, None)


def _estimated(blocks: list[_FrameBlock], least: float) -> _Estimated | None:
    """The estimate without the frames that do not agree with it; None where there is no frame."""
    kept = [block.plausible for block in blocks]
    if not any(frames.any() for frames in kept):
        return None
    chosen = [some_frames(block.marginal, ok) for block, ok in zip(blocks, kept, strict=True)]
    start = max(typical_sigma(chosen), least)
    found = _Estimated(start, float(sum(one.freedom.sum() for one in chosen)), blocks, kept)
    for turn in range(ROUNDS):
        agree = [
            block.plausible & ~(chance_of(block.marginal, found.of(block)) < SIGNIFICANCE)
            for block in blocks
        ]
        if not any(frames.any() for frames in agree):
            break
        settled = turn > 0 and all(map(np.array_equal, agree, found.kept))
        found = _Estimated(*most_likely(_parts(blocks, agree), start, least), blocks, agree)
        if settled:
            break
    return found


def _parts(
    blocks: list[_FrameBlock], kept: list[Bools]
) -> list[tuple[ResidualEquations, CommonErrors]]:
    return [
        (some_frames(block.apart, ok), block.common.of(ok))
        for block, ok in zip(blocks, kept, strict=True)
    ]
