"""One standard deviation of the readings for all frames of a job, from all their residuals.

The estimate is by restricted maximum likelihood: it takes into account that three
angles are fitted in every frame, and what the other errors that are given contribute
to the residuals, also where they are the same in all frames. Frames whose residuals do
not agree with the others are left out of it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.special import chdtri

from vopd.arrays import Bools, Floats
from vopd.attitude.common_errors import CommonErrors, common_errors, solved_for
from vopd.attitude.error_components import ErrorComponent
from vopd.attitude.residual_covariance import ResidualEquations, ResidualWeights
from vopd.attitude.residual_test import SIGNIFICANCE, Pool, chance_of, equations_of, testable
from vopd.estimate import Estimate
from vopd.geometry.linear_algebra import pseudo_inverse

ROUNDS, PASSES = 6, 60
SETTLED = 1e-4  # relative change of the variance that ends the passes


class ReadingScale(NamedTuple):
    """The reading sigma of a job, and how well each frame agrees with it."""

    sigma: float  # in force, image units
    freedom: float  # degrees of freedom of the estimate; infinite where it was not estimated
    source: str  # one of `SOURCES`
    chance: Floats  # (F,) that residuals are as large as the frame's, or larger; NaN: not tested
    freedom_of_frame: Floats  # (F,) 2N - 3; NaN where not tested
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


@np.errstate(all="ignore")
def reading_scale(
    estimate: Estimate, components: list[ErrorComponent], given: float | None
) -> ReadingScale:
    """Estimate the reading sigma of a job, and test every frame's residuals against it.

    The sigma is never below the spread of repeated readings, nor below what the
    resolution of the readings leaves.

    Args:
        estimate: the job
        components: the other errors that are given
        given: the reading sigma, image units, where it is not to be estimated; 0 leaves
            the readings' errors out of the uncertainty, and the test takes the least one
    """
    least, source = _least(estimate)
    tested = testable(estimate)
    frames = np.flatnonzero(tested)
    equations = equations_of(estimate, components, frames)
    pool = Pool(least, np.inf, np.zeros(len(frames), bool))
    if given is None and len(frames):
        own = [one for one in components if not solved_for(estimate, one)]
        apart = equations_of(estimate, own, frames)
        # larger than the focal length, a residual is no reading's
        plausible = np.abs(equations.residual).max(axis=1) <= estimate.focal_length
        common = common_errors(estimate, components, frames)
        found = _estimated(equations, apart, common, least, plausible)
        if found.sigma >= least:
            pool, source = found, "residuals"
    if given:
        pool = pool._replace(sigma=given)
    chance, freedom = np.full((2, len(tested)), np.nan)
    chance[frames], freedom[frames] = chance_of(equations, pool), equations.freedom
    sigma, source = (pool.sigma, source) if given is None else (given, "given")
    return ReadingScale(sigma, pool.freedom, source, chance, freedom, pool.sigma)


def _least(estimate: Estimate) -> tuple[float, str]:
    """The least reading sigma that is believed, and where it comes from."""
    spread, floor = np.nan_to_num([estimate.reading_spread, estimate.reading_floor])
    rounding = 1e-9 * estimate.focal_length
    return float(max(spread, floor, rounding)), "repeated" if spread > floor else "resolution"


def _estimated(
    marginal: ResidualEquations,
    apart: ResidualEquations,
    common: CommonErrors,
    least: float,
    kept: Bools,
) -> Pool:
    """The estimate from frames that are to be kept, without those that do not agree with it."""
    if not kept.any():
        return Pool(0.0, np.inf, kept)
    start = max(_typical(_some(marginal, kept)), least)
    pool = Pool(start, float(marginal.freedom[kept].sum()), kept)
    for _ in range(ROUNDS):
        agree = kept & ~(chance_of(marginal, pool) < SIGNIFICANCE)
        if not agree.any():
            break
        found = _maximum_likelihood(_some(apart, agree), common.of(agree), start, least)
        settled = bool((agree == pool.frames).all())
        pool = Pool(*found, agree)
        if settled and pool.frames is not kept:
            break
    return pool


def _typical(equations: ResidualEquations) -> float:
    """A reading sigma that half of the frames may disagree with: by the median over frames."""
    scale = np.where(equations.variance > 0.0, equations.variance, np.inf) ** -0.5
    residual = equations.residual * scale
    partials = equations.partials * scale[..., None]
    fitted = partials @ (pseudo_inverse(partials) @ residual[..., None])
    squares = ((residual - fitted[..., 0]) ** 2).sum(axis=1)
    median = chdtri(equations.freedom, 0.5)
    return float(np.sqrt(np.nanmedian(squares / median)))


def _some(equations: ResidualEquations, frames: Bools) -> ResidualEquations:
    return ResidualEquations(*(part[frames] for part in equations))


def _maximum_likelihood(
    equations: ResidualEquations, common: CommonErrors, start: float, least: float
) -> tuple[float, float]:
    """The reading sigma by restricted maximum likelihood, and its degrees of freedom.

    With W as in `ResidualWeights`, and less what the common errors explain, its variance
    is such that r' W S W r equals the trace of W S.
    """
    sigma, freedom = start, float(equations.freedom.sum())
    trace = 0.0
    for _ in range(PASSES):
        weights = ResidualWeights(equations, sigma)
        weighted = weights.of(equations.residual[..., None])[..., 0]
        trace = float(weights.trace.sum())
        if common.causes:
            columns = weights.of(common.columns)
            by_cause = common.summed(common.columns.swapaxes(1, 2) @ columns)
            inner = np.linalg.inv(np.eye(common.causes) + by_cause)
            error = inner @ common.told_by(weighted)
            weighted = weighted - (columns @ error[common.cause][..., None])[..., 0]
            squares = columns.swapaxes(1, 2) @ (columns * equations.variance[..., None])
            trace -= float((inner * common.summed(squares)).sum())
        ratio = float((equations.variance * weighted**2).sum()) / trace
        sigma *= float(np.sqrt(ratio))
        if not sigma > least / 2.0 or abs(ratio - 1.0) < SETTLED:
            break
    return sigma, (sigma**2 * trace) ** 2 / freedom
