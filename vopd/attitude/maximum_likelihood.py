"""The most likely reading sigma of a job, by the residuals of its frames."""

from __future__ import annotations

import numpy as np
from scipy.special import chdtri

from vopd.arrays import Bools
from vopd.attitude.common_errors import CommonErrors
from vopd.attitude.residual_covariance import ResidualEquations, ResidualWeights
from vopd.geometry.linear_algebra import inverse, pseudo_inverse

PASSES = 6
SETTLED = 1e-4  # relative change of the variance that is none


def typical_sigma(equations: list[ResidualEquations]) -> float:
    """A first reading sigma by the median over frames; wrong readings in a few do not move it.

    Args:
        equations: blocks of frames
    """
    ratios = []
    for one in equations:
        scale = np.where(one.variance > 0.0, one.variance, np.inf) ** -0.5
        residual, partials = one.residual * scale, one.partials * scale[..., None]
        fitted = partials @ (pseudo_inverse(partials) @ residual[..., None])
        squares = ((residual - fitted[..., 0]) ** 2).sum(axis=1)
        ratios.append(squares / chdtri(one.freedom, 0.5))
    return float(np.sqrt(np.nanmedian(np.concatenate(ratios))))


def some_frames(equations: ResidualEquations, frames: Bools) -> ResidualEquations:
    """The equations of some frames."""
    return ResidualEquations(*(part[frames] for part in equations))


def most_likely(
    parts: list[tuple[ResidualEquations, CommonErrors]], start: float, least: float
) -> tuple[float, float]:
    """The reading sigma by restricted maximum likelihood, and its degrees of freedom.

    With W as in `ResidualWeights`, and less what the common errors explain, its variance
    is such that r' W S W r equals the trace of W S.

    Args:
        parts: blocks of frames, and the errors that are the same in all frames
        start: a first value, image units
        least: a value below which the result does not matter
    """
    sigma, freedom = start, float(sum(equations.freedom.sum() for equations, _ in parts))
    for _ in range(PASSES):  # where the readings are most of the residuals two or three will do
        squares, trace = _score(parts, sigma)
        if abs(squares / trace - 1.0) < SETTLED:
            return sigma, _freedom(sigma, trace, freedom)
        sigma *= float(np.sqrt(squares / trace))

    from scipy.optimize import brentq  # a third of a second, seldom needed

    def excess(log_sigma: float) -> float:
        squares, trace = _score(parts, float(np.exp(log_sigma)))
        return float(np.log(squares / trace))

    low, high = float(np.log(least)), float(np.log(max(start, sigma, least) * 2.0))
    if not excess(low) > 0.0:
        return least / 2.0, np.inf
    while excess(high) > 0.0:
        high += 1.0
    sigma = float(np.exp(brentq(excess, low, high, xtol=SETTLED / 10.0)))
    _, trace = _score(parts, sigma)
    return sigma, _freedom(sigma, trace, freedom)


def _freedom(sigma: float, trace: float, of_residuals: float) -> float:
    """Degrees of freedom of the reading sigma."""
    known = sigma * sigma * trace  # a power would raise OverflowError
    return known * known / of_residuals


def _score(
    parts: list[tuple[ResidualEquations, CommonErrors]], sigma: float
) -> tuple[float, float]:
    """r' W S W r and the trace of W S for all frames, the common errors solved for."""
    causes = parts[0][1].causes
    weighted, columns, trace = [], [], 0.0
    by_cause, products = np.eye(causes), np.zeros(causes)
    for equations, common in parts:
        weights = ResidualWeights(equations, sigma)
        weighted.append(weights.of(equations.residual[..., None])[..., 0])
        columns.append(weights.of(common.columns))
        by_cause += common.summed(common.columns.swapaxes(1, 2) @ columns[-1])
        products += common.summed_products(weighted[-1])
        trace += float(weights.trace.sum())
    inner = inverse(by_cause)
    squares = 0.0
    for (equations, common), one, column in zip(parts, weighted, columns, strict=True):
        left = one - (column @ (inner @ products)[common.cause][..., None])[..., 0]
        squares += float((equations.variance * left**2).sum())
        of_causes = column.swapaxes(1, 2) @ (column * equations.variance[..., None])
        trace -= float((inner * common.summed(of_causes)).sum())
    return squares, trace
