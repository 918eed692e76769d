"""Residuals of a frame: covariance, test, and outliers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc, fdtrc, fdtri

from vopd.arrays import Bools, Floats, Ints, distinct_in_rows
from vopd.attitude.sigmas import ErrorComponent
from vopd.estimate import Estimate
from vopd.geometry.linear import inverse, pseudo_inverse
from vopd.records import Rows

# Covariance of the residuals, and weighted least squares.
#
# The covariance of a frame's 2L image coordinates is V = D + U U'. D holds what is
# independent from landmark to landmark: 2 x 2 blocks of the readings and, where asked
# for, of the landmark's own position. The columns of U are the other errors, one
# standard deviation each, which all landmarks of the frame share. Nothing here
# needs a matrix of 2L x 2L.


@dataclass(frozen=True, eq=False, repr=False)
class ResidualEquations(Rows):
    """Residuals of F frames that all have a solution; unused coordinates are 0 throughout."""

    residual: Floats  # (F, 2L)
    partials: Floats  # (F, 2L, 3) of the computed coordinates by three turns, and what else is free
    variance: Floats  # (F, 2L) of the readings, in squares of the reading sigma; 0 where unused
    shared: Floats  # (F, 2L, C) errors that the landmarks of a frame share
    own: Floats  # (F, 2L, 3) errors of each landmark's own position; or (F, 2L, 0)

    @property
    def freedom(self) -> Floats:
        """Degrees of freedom of every frame's residuals (F,)."""
        return np.asarray((self.variance > 0.0).sum(axis=1) - float(self.partials.shape[2]))


class ResidualWeights:
    """W = V^-1 - V^-1 B (B' V^-1 B)^-1 B' V^-1 of every frame, for its reading sigma.

    r' W r is the weighted sum of squares that remains when the attitude is fitted anew: where
    V is the covariance of the residuals it is chi-square with 2N - 3 degrees of freedom.
    The reading sigma is one for all frames, or one for each (F,).
    """

    def __init__(self, equations: ResidualEquations, sigma: Floats | float) -> None:
        self._equations = equations
        self.own_blocks = _inverse_blocks(equations, sigma)
        shared, partials = equations.shared, equations.partials
        self._has_shared = shared.shape[2] > 0
        if self._has_shared:
            self._by_shared = self._unshared(shared)
            inner = shared.swapaxes(1, 2) @ self._by_shared
            self._shared_inverse = inverse(np.eye(inner.shape[1]) + inner)
        self._by_partials = self._weighted(partials)
        self._fit = inverse(partials.swapaxes(1, 2) @ self._by_partials)

    def of(self, columns: Floats) -> Floats:
        """Multiply W by columns (F, 2L, K)."""
        fitted = self._fit @ (self._by_partials.swapaxes(1, 2) @ columns)
        return np.asarray(self._weighted(columns) - self._by_partials @ fitted)

    @property
    def trace(self) -> Floats:
        """The trace of W S, with S the variance of the readings in reading sigmas, (F,)."""
        variance = self._equations.variance
        xx, _, yy = self.own_blocks
        count = xx.shape[1]
        own = (variance[:, :count] * xx + variance[:, count:] * yy).sum(axis=1)
        if self._has_shared:
            own = own - _trace_within(self._by_shared, self._shared_inverse, variance)
        return np.asarray(own - _trace_within(self._by_partials, self._fit, variance))

    @property
    def unfitted_blocks(self) -> tuple[Floats, Floats, Floats]:
        """The block of V^-1 of each landmark: elements xx, xy, yy, (F, L) each."""
        if not self._has_shared:
            return self.own_blocks
        return _less(self.own_blocks, self._by_shared, self._shared_inverse)

    @property
    def blocks(self) -> tuple[Floats, Floats, Floats]:
        """The block of W of each landmark: elements xx, xy, yy, (F, L) each."""
        return _less(self.unfitted_blocks, self._by_partials, self._fit)

    def _unshared(self, columns: Floats) -> Floats:
        """Multiply D^-1 by columns."""
        xx, xy, yy = (block[..., None] for block in self.own_blocks)
        count = xx.shape[1]
        x, y = columns[:, :count], columns[:, count:]
        return np.concatenate([xx * x + xy * y, xy * x + yy * y], axis=1)

    def _weighted(self, columns: Floats) -> Floats:
        """Multiply V^-1 by columns."""
        if not self._has_shared:
            return self._unshared(columns)
        inner = self._shared_inverse @ (self._by_shared.swapaxes(1, 2) @ columns)
        return np.asarray(self._unshared(columns) - self._by_shared @ inner)


def _inverse_blocks(
    equations: ResidualEquations, sigma: Floats | float
) -> tuple[Floats, Floats, Floats]:
    """Invert each landmark's block: elements xx, xy, yy, (F, L) each; 0 if unused."""
    count = equations.variance.shape[1] // 2
    readings = equations.variance * np.reshape(sigma, (-1, 1)) ** 2
    own_x, own_y = equations.own[:, :count], equations.own[:, count:]
    xx = readings[:, :count] + (own_x**2).sum(axis=2)
    yy = readings[:, count:] + (own_y**2).sum(axis=2)
    xy = (own_x * own_y).sum(axis=2)
    used = equations.variance[:, :count] > 0.0
    determinant = np.where(used, xx * yy - xy**2, np.inf)
    return yy / determinant, -xy / determinant, xx / determinant


def _less(
    blocks: tuple[Floats, Floats, Floats], columns: Floats, middle: Floats
) -> tuple[Floats, Floats, Floats]:
    """Subtract the blocks of columns * middle * columns' from the blocks of each landmark."""
    count = columns.shape[1] // 2
    (x, y), (left, right) = (
        (one[:, :count], one[:, count:]) for one in (columns @ middle, columns)
    )
    xx, xy, yy = blocks
    return (
        xx - (x * left).sum(axis=2),
        xy - (x * right).sum(axis=2),
        yy - (y * right).sum(axis=2),
    )


def _trace_within(columns: Floats, middle: Floats, variance: Floats) -> Floats:
    """Trace columns * middle * columns' * diag(variance), (F,)."""
    return np.asarray(((columns @ middle) * columns * variance[..., None]).sum(axis=(1, 2)))


# Test of a frame's residuals.

SIGNIFICANCE = 0.001  # the probability that a frame without a wrong reading is called a misfit
LEAST_CHANCE = 1e-6  # that is written: tails of the distributions are not known so far out


def chance_text(chance: float) -> str:
    """Write a chance in a sentence: `.012`, `2e-05`, `below 1e-6`.

    Args:
        chance: 0 to 1
    """
    if chance < LEAST_CHANCE:
        return "below 1e-6"
    return f"{chance:.2g}".replace("0.", ".", 1) if chance >= 0.001 else f"{chance:.0e}"


class Pool(NamedTuple):
    """A reading sigma, its degrees of freedom, and the frames that it was estimated from.

    Both are numbers, or arrays of one for each frame (F,), where frames are of several jobs.
    """

    sigma: Floats | float  # image units
    freedom: Floats | float  # infinite where it was not estimated
    frames: Bools | None  # (F,) None: no frame that is tested


def testable(estimate: Estimate) -> Bools:
    """Mark frames that have a solution, and so more residuals than angles (F,)."""
    e = estimate
    known = np.isfinite(e.gain).all(axis=(1, 2)) & np.isfinite(e.residual).all(axis=1)
    known &= np.isfinite(e.partials).all(axis=(1, 2)) & np.isfinite(e.camera_deg).all(axis=1)
    return np.asarray(e.solved & known & (distinct_in_rows(e.landmark, e.used) >= 2))


def equations_of(
    estimate: Estimate, components: list[ErrorComponent], frames: Ints
) -> ResidualEquations:
    """Form the residual equations of some frames, with the errors given for them."""
    none = np.zeros((len(frames), estimate.residual.shape[1], 0))
    shared = [one.residual[frames] for one in components if not one.each_landmark]
    own = [one.residual[frames] for one in components if one.each_landmark]
    used = np.tile(estimate.used[frames], 2)
    variance = np.where(used, np.tile(estimate.relative_sigma[frames], 2) ** 2, 0.0)
    measured = estimate.residual if estimate.test_residual is None else estimate.test_residual
    residual = np.where(used, measured[frames], 0.0)
    return ResidualEquations(
        residual,
        np.where(used[..., None], estimate.partials[frames], 0.0),
        variance,
        finite(np.concatenate([none, *shared], axis=2), used),
        finite(np.concatenate([none, *own], axis=2), used),
    )


def finite(columns: Floats, used: Bools) -> Floats:
    """Set columns (F, 2L, K) to 0 where a coordinate is not used or not finite."""
    return np.where(used[..., None] & np.isfinite(columns), columns, 0.0)


@np.errstate(all="ignore")
def chance_of(equations: ResidualEquations, pool: Pool) -> Floats:
    """Test the residuals of each frame: the chance of such large ones, or larger (F,).

    A chi-square test; where the reading sigma was estimated, an F test, and for a frame
    that took part in the estimate against that of the other frames. NaN where the reading
    sigma is known from this frame alone.
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


# Outliers: each landmark left out in turn.

OUTLIER_SIGNIFICANCE = 0.001  # the probability of a false alarm in a frame


@np.errstate(all="ignore")
def outliers(estimate: Estimate, significance: float = OUTLIER_SIGNIFICANCE) -> Bools:
    """Mark the landmark of each frame that does not fit the others, at most one, (F, L).

    The residuals are those of least squares: what the erratum `first-landmark` adds
    to them is taken away. Leaving out landmark i reduces their sum of squares by
    r' Q^-1 r, with r its two residuals and Q their block of I - B(B'B)^-1 B'. Half of
    that, over the remaining sum of squares per degree of freedom, is F-distributed with
    2 and 2N - 5 degrees: the largest of the frame is an outlier where its probability is
    below `significance` over N (Bonferroni). It takes four landmarks: of three that
    disagree, none can be named.

    Args:
        estimate: the job
        significance: the probability of a false alarm in a frame
    """
    count = estimate.used.sum(axis=1)
    residual, reduction = _reduction(estimate)
    freedom = 2.0 * count - 5.0
    total = (residual**2).sum(axis=1)
    with_it = np.where(estimate.used, reduction, 0.0)
    f = (with_it / 2.0) / ((total[:, None] - with_it) / freedom[:, None])
    limit = fdtri(2.0, freedom, 1.0 - significance / count)[:, None]
    largest = np.arange(f.shape[1]) == f.argmax(axis=1)[:, None]
    enough = (count >= 4)[:, None] & estimate.used & np.isfinite(f)
    # rounding noise is not a misfit
    noticed = (np.sqrt(total) > 1e-9 * estimate.focal_length)[:, None]
    return np.asarray(enough & noticed & largest & (f > limit))


def _reduction(estimate: Estimate) -> tuple[Floats, Floats]:
    """Fit residuals (F, 2L) by least squares; find each landmark's part of their squares."""
    b = np.where(np.isfinite(estimate.partials), estimate.partials, 0.0)
    count = estimate.used.shape[1]
    inverse = pseudo_inverse(b)
    fitted = b @ (inverse @ estimate.residual[..., None])
    residual = estimate.residual - fitted[..., 0]
    x, y = slice(0, count), slice(count, None)
    xx, xy, yy = (
        float(one == other) - (b[:, one] * inverse[:, :, other].swapaxes(1, 2)).sum(axis=2)
        for one, other in ((x, x), (x, y), (y, y))
    )
    rx, ry = residual[:, :count], residual[:, count:]
    reduction = (yy * rx**2 - 2.0 * xy * rx * ry + xx * ry**2) / (xx * yy - xy**2)
    return residual, reduction
