"""Test whether the residuals of a frame agree with the standard deviations in force."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc, fdtrc

from vopd.arrays import Bools, Floats, Ints, distinct_in_rows
from vopd.attitude.residuals import ResidualEquations, ResidualWeights
from vopd.attitude.sigmas import ErrorComponent
from vopd.estimate import Estimate

SIGNIFICANCE = 0.001  # the probability that a frame without a wrong reading is called a misfit


class Pool(NamedTuple):
    """A reading sigma, its degrees of freedom, and the frames that it was estimated from.

    Both are numbers, or arrays of one for each frame (F,), where frames are of several jobs.
    """

    sigma: Floats | float  # image units
    freedom: Floats | float  # infinite where it was not estimated
    frames: Bools | None  # (F,) None: no frame that is tested


def testable(estimate: Estimate) -> Bools:
    """Frames that have a solution, and so more residuals than angles (F,).

    Args:
        estimate: the job
    """
    e = estimate
    known = np.isfinite(e.gain).all(axis=(1, 2)) & np.isfinite(e.residual).all(axis=1)
    known &= np.isfinite(e.partials).all(axis=(1, 2)) & np.isfinite(e.camera_deg).all(axis=1)
    return np.asarray(e.solved & known & (distinct_in_rows(e.landmark, e.used) >= 2))


def equations_of(
    estimate: Estimate, components: list[ErrorComponent], frames: Ints
) -> ResidualEquations:
    """The residuals of some frames, and the errors that are given for them.

    Args:
        estimate: the job
        components: the errors, but for those of the readings
        frames: indices of frames
    """
    none = np.zeros((len(frames), estimate.residual.shape[1], 0))
    shared = [one.residual[frames] for one in components if not one.each_landmark]
    own = [one.residual[frames] for one in components if one.each_landmark]
    used = np.tile(estimate.used[frames], 2)
    variance = np.where(used, np.tile(estimate.relative_sigma[frames], 2) ** 2, 0.0)
    residual = np.where(used, estimate.residual[frames], 0.0)
    return ResidualEquations(
        residual,
        np.where(used[..., None], estimate.partials[frames], 0.0),
        variance,
        finite(np.concatenate([none, *shared], axis=2), used),
        finite(np.concatenate([none, *own], axis=2), used),
    )


def finite(columns: Floats, used: Bools) -> Floats:
    """Columns (F, 2L, K) with 0 where a coordinate is not used or not finite."""
    return np.where(used[..., None] & np.isfinite(columns), columns, 0.0)


@np.errstate(all="ignore")
def chance_of(equations: ResidualEquations, pool: Pool) -> Floats:
    """The chance of residuals as large as each frame's, or larger (F,).

    A chi-square test; where the reading sigma was estimated, an F test, and for a frame
    that took part in the estimate against that of the other frames. NaN where the reading
    sigma is known from this frame alone.

    Args:
        equations: of the frames
        pool: the reading sigma
    """
    weights = ResidualWeights(equations, pool.sigma)
    weighted = weights.of(equations.residual[..., None])[..., 0]
    statistic = (equations.residual * weighted).sum(axis=1)
    freedom = equations.freedom
    estimated = np.isfinite(pool.freedom)
    if not estimated.any():
        return np.asarray(chdtrc(freedom, statistic))
    readings = pool.sigma * weights.trace * pool.sigma / freedom
    part = np.clip(readings, 1e-6, 1.0)  # of the variance, that the readings have
    own = np.zeros_like(part) if pool.frames is None else np.where(pool.frames, part, 0.0)
    left = pool.freedom - own * freedom
    others = (pool.freedom - own * statistic) / left  # variance by the others, over the estimate
    ratio = statistic / freedom / (1.0 - part + part * others)
    chance = fdtrc(freedom, left / part**2, np.where(others > 0.0, ratio, np.inf))
    chance = np.where(left > 0.5, chance, np.nan)
    return chance if estimated.all() else np.where(estimated, chance, chdtrc(freedom, statistic))
