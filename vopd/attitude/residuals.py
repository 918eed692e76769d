"""Covariance of the residuals of each frame, and least squares weighted by its inverse.

The covariance of a frame's 2L image coordinates is V = D + U U'. D holds what is
independent from landmark to landmark: 2 x 2 blocks of the readings and, where asked
for, of the landmark's own position. The columns of U are the other errors, one
standard deviation each, which all landmarks of the frame share. Nothing here
needs a matrix of 2L x 2L.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.linear import inverse


class ResidualEquations(NamedTuple):
    """Residuals of F frames that all have a solution; unused coordinates are 0 throughout."""

    residual: Floats  # (F, 2L)
    partials: Floats  # (F, 2L, 3) of the computed coordinates by three turns
    variance: Floats  # (F, 2L) of the readings, in squares of the reading sigma; 0 where unused
    shared: Floats  # (F, 2L, C) errors that the landmarks of a frame share
    own: Floats  # (F, 2L, 3) errors of each landmark's own position; or (F, 2L, 0)

    @property
    def freedom(self) -> Floats:
        """Degrees of freedom of every frame's residuals (F,)."""
        return np.asarray((self.variance > 0.0).sum(axis=1) - 3.0)


class ResidualWeights:
    """W = V^-1 - V^-1 B (B' V^-1 B)^-1 B' V^-1 of every frame, for its reading sigma.

    r' W r is the weighted sum of squares that remains when the attitude is fitted anew: where
    V is the covariance of the residuals it is chi-square with 2N - 3 degrees of freedom.
    The reading sigma is one for all frames, or one for each (F,).
    """

    def __init__(self, equations: ResidualEquations, sigma: Floats | float) -> None:
        self._equations = equations
        self._blocks = _inverse_blocks(equations, sigma)
        shared, partials = equations.shared, equations.partials
        self._has_shared = shared.shape[2] > 0
        if self._has_shared:
            self._by_shared = self._unshared(shared)
            inner = shared.swapaxes(1, 2) @ self._by_shared
            self._shared_inverse = inverse(np.eye(inner.shape[1]) + inner)
        self._by_partials = self._weighted(partials)
        self._fit = inverse(partials.swapaxes(1, 2) @ self._by_partials)

    def of(self, columns: Floats) -> Floats:
        """W times columns (F, 2L, K)."""
        fitted = self._fit @ (self._by_partials.swapaxes(1, 2) @ columns)
        return np.asarray(self._weighted(columns) - self._by_partials @ fitted)

    @property
    def trace(self) -> Floats:
        """The trace of W S, with S the variance of the readings in reading sigmas, (F,)."""
        variance = self._equations.variance
        xx, _, yy = self._blocks
        count = xx.shape[1]
        own = (variance[:, :count] * xx + variance[:, count:] * yy).sum(axis=1)
        if self._has_shared:
            own = own - _trace_within(self._by_shared, self._shared_inverse, variance)
        return np.asarray(own - _trace_within(self._by_partials, self._fit, variance))

    def _unshared(self, columns: Floats) -> Floats:
        """D^-1 times columns."""
        xx, xy, yy = (block[..., None] for block in self._blocks)
        count = xx.shape[1]
        x, y = columns[:, :count], columns[:, count:]
        return np.concatenate([xx * x + xy * y, xy * x + yy * y], axis=1)

    def _weighted(self, columns: Floats) -> Floats:
        """V^-1 times columns."""
        if not self._has_shared:
            return self._unshared(columns)
        inner = self._shared_inverse @ (self._by_shared.swapaxes(1, 2) @ columns)
        return np.asarray(self._unshared(columns) - self._by_shared @ inner)


def _inverse_blocks(
    equations: ResidualEquations, sigma: Floats | float
) -> tuple[Floats, Floats, Floats]:
    """The elements xx, xy, yy of the inverse of each landmark's block, (F, L) each; 0 if unused."""
    count = equations.variance.shape[1] // 2
    readings = equations.variance * np.reshape(sigma, (-1, 1)) ** 2
    own_x, own_y = equations.own[:, :count], equations.own[:, count:]
    xx = readings[:, :count] + (own_x**2).sum(axis=2)
    yy = readings[:, count:] + (own_y**2).sum(axis=2)
    xy = (own_x * own_y).sum(axis=2)
    used = equations.variance[:, :count] > 0.0
    determinant = np.where(used, xx * yy - xy**2, np.inf)
    return yy / determinant, -xy / determinant, xx / determinant


def _trace_within(columns: Floats, middle: Floats, variance: Floats) -> Floats:
    """The trace of columns * middle * columns' * diag(variance), (F,)."""
    return np.asarray(((columns @ middle) * columns * variance[..., None]).sum(axis=(1, 2)))
