"""Blunders: picks of a frame that do not fit the others, one, two or three at once.

With W the weights of a frame's residuals r once its attitude is fitted (`ResidualWeights`: the
errors of readings, position, landmarks and all that the frame's picks share), a set S of picks
is displaced against all the others by W_SS^-1 (W r)_S, with the covariance W_SS^-1; without it
the weighted sum of squares r' W r is smaller by (W r)_S' W_SS^-1 (W r)_S. So every set is tested
without a further fit. The test is Baarda's (Statistical concepts in geodesy, 1967, and A testing
procedure for use in geodetic networks, 1968) where the reading sigma is stated, and Pope's
(The statistics of residuals and the detection of outliers, NOAA NOS 65 NGS 1, 1976), with the
sigma of all but the set, where it is estimated.
"""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np
from scipy.special import binom, chdtrc, fdtrc

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.residuals import SIGNIFICANCE, Pool, ResidualEquations, ResidualWeights
from vopd.geometry.linear import inverse

LEAST_LEFT = 3  # landmarks of a frame
AT_ONCE = 3  # picks tested together, so that two or three do not hide each other
SHARE = np.array([[0.0, 1.0, 0.0, 0.0], [0.0, 0.8, 0.2, 0.0], [0.0, 0.8, 0.1, 0.1]])
"""Of the significance, by how many picks may be left out, 1 to 3, and by the number at once."""
MOST_CANDIDATES = 10  # picks of a frame that are tested in twos and threes, the worst
DOUBTFUL = 0.05  # chance of a frame's residuals: above it twos and threes are not tried
STAGES = 40  # sets of a frame, one after the other
HIDDEN = 1e6  # variance of a displacement, in those of the pick: more, and the others show nothing
UNCLEAR = 6.0  # in chi-square: sets that gain as much less than the best may be the blunder too
SETS_TOGETHER = 30_000  # tested in one stack


@np.errstate(all="ignore")
def blunders_of_frames(
    equations: ResidualEquations,
    pool: Pool,
    least: float = 0.0,
    known: Bools | None = None,
    significance: float = SIGNIFICANCE,
) -> tuple[Bools, Bools]:
    """Find the picks of each frame that do not fit the others.

    Three landmarks at least, and half of the frame's picks, are left.

    Args:
        equations: of the frames, with the picks of earlier blunders
        pool: the reading sigma in force
        least: the least reading sigma that is believed, image units
        known: earlier blunders, (F, L): each stays one if it does not fit the others
        significance: the probability of a false alarm in a frame

    Returns:
        The blunders (F, L), and picks of which some are blunders, too, but nothing tells
        which, (F, L).
    """
    used = _used(equations)
    count = used.sum(axis=1)
    most = np.minimum(count // 2, count - LEAST_LEFT)
    found = np.zeros_like(used) if known is None else known & used
    found &= (found.sum(axis=1) <= most)[:, None]
    unclear = np.zeros_like(used)
    going = np.flatnonzero(found.sum(axis=1) < most)
    for _ in range(STAGES):
        if not len(going):
            break
        left = (most - found.sum(axis=1))[going]
        some = without_picks(equations.take(going), found[going])
        more, unclear[going] = _worst_set(some, _pool_of(pool, going), least, left, significance)
        found[going] |= more
        going = going[more.any(axis=1)]
        going = going[found[going].sum(axis=1) < most[going]]
    doubted = np.flatnonzero(found.any(axis=1))
    if len(doubted):
        found[doubted] = _confirmed(
            equations.take(doubted), _pool_of(pool, doubted), least, found[doubted], significance
        )
    return found, unclear


def _used(equations: ResidualEquations) -> Bools:
    return np.asarray(equations.variance[:, : equations.variance.shape[1] // 2] > 0.0)


def without_picks(equations: ResidualEquations, out: Bools) -> ResidualEquations:
    """Leave picks out of the equations of frames.

    Args:
        equations: of the frames
        out: picks to leave out, (F, L)
    """
    if not out.any():
        return equations
    kept = ~np.tile(out, 2)
    e, columns = equations, kept[..., None]
    return ResidualEquations(
        np.where(kept, e.residual, 0.0),
        np.where(columns, e.partials, 0.0),
        np.where(kept, e.variance, 0.0),
        np.where(columns, e.shared, 0.0),
        np.where(columns, e.own, 0.0),
    )


def _pool_of(pool: Pool, frames: Ints) -> Pool:
    """Select the reading sigma of some frames."""

    def some(values: Floats | float) -> Floats | float:
        return np.asarray(values)[frames] if np.ndim(values) else values

    taken = None if pool.frames is None else pool.frames[frames]
    return Pool(some(pool.sigma), some(pool.freedom), taken)


class _Squares(NamedTuple):
    """Weighted sums of squares of frames, in reading sigmas, by which sets of picks are judged."""

    total: Floats  # (F,) r' W r
    freedom: Floats  # (F,)
    part: Floats  # (F,) of the variance of the residuals, that the readings have
    others: Floats  # (F,) of the other frames of the pool
    others_freedom: Floats  # (F,) infinite where the reading sigma was not estimated
    least: Floats  # (F,) variance of the readings that is believed

    def chance(self, gain: Floats, picks: int, gone: int) -> Floats:
        """Calculate the chance that leaving out some picks gains so much or more, (F, ...).

        Args:
            gain: decrease of the sum of squares, (F, ...)
            picks: how many picks make it
            gone: how many are left out then, those that were left out before among them
        """
        shape = (-1,) + (1,) * (gain.ndim - 1)
        total, freedom, part, others, others_freedom, least = (x.reshape(shape) for x in self)
        left = np.maximum(others_freedom + freedom - 2.0 * gone, 0.0)
        variance = np.maximum((others + total - gain) / left, least)
        ratio = gain / (2.0 * picks) / (1.0 - part + part * variance)
        chance = fdtrc(2.0 * picks, left / part**2, ratio)
        chance = np.where(np.isinf(others_freedom), chdtrc(2.0 * picks, gain), chance)
        return np.where(left > 0.5, chance, 1.0)

    @property
    def doubtful(self) -> Bools:
        """Frames whose residuals are large, or cannot be judged by the others, (F,)."""
        scale = 1.0 - self.part + self.part * self.others / self.others_freedom
        mean = self.total / self.freedom
        chance = fdtrc(self.freedom, self.others_freedom / self.part**2, mean / scale)
        stated = np.isinf(self.others_freedom)
        chance = np.where(stated, chdtrc(self.freedom, self.total), chance)
        return np.asarray(~(chance > DOUBTFUL) | (self.others_freedom < 1.0))


def _squares(
    equations: ResidualEquations,
    weights: ResidualWeights,
    weighted: Floats,
    pool: Pool,
    least: float,
) -> _Squares:
    total, freedom = (equations.residual * weighted).sum(axis=1), equations.freedom
    sigma = np.broadcast_to(pool.sigma, total.shape)
    pooled = np.broadcast_to(pool.freedom, total.shape)
    part = np.clip(sigma**2 * weights.trace / freedom, 1e-6, 1.0)
    own = np.zeros_like(part) if pool.frames is None else np.where(pool.frames, part, 0.0)
    others_freedom = np.maximum(pooled - own * freedom, 0.0)
    others = np.where(others_freedom > 0.0, np.maximum(pooled - own * total, 0.0), 0.0)
    return _Squares(total, freedom, part, others, others_freedom, (least / sigma) ** 2)


def _worst_set(
    equations: ResidualEquations, pool: Pool, least: float, most: Ints, significance: float
) -> tuple[Bools, Bools]:
    """Find the one, two or three picks of each frame that fit least; none if all fit.

    Two are taken for one, and three for two, only if they gain significantly more.

    Args:
        equations: of the frames
        pool: the reading sigma in force
        least: the least reading sigma that is believed
        most: how many of the frame's picks may be left out (F,)
        significance: the probability of a false alarm in a frame

    Returns:
        Picks that are in every set that gains nearly as much as the best, (F, L), and picks
        that are in some of them, (F, L).
    """
    weights = ResidualWeights(equations, pool.sigma)
    weighted = weights.of(equations.residual[..., None])[..., 0]
    squares = _squares(equations, weights, weighted, pool, least)
    count = _used(equations).sum(axis=1)
    single = _gains_of_picks(weights, weighted)
    chosen = np.zeros(len(count), np.int64)
    gained = np.zeros(len(count))
    found, unclear = np.zeros(single.shape, bool), np.zeros(single.shape, bool)
    for size in range(1, AT_ONCE + 1):
        if size == 1:
            frames = np.arange(len(count))
            best = single.max(axis=1)
            near = single > best[:, None] - UNCLEAR
            blamed, clear = near, near & (near.sum(axis=1) == 1)[:, None]
        else:
            frames = np.flatnonzero(squares.doubtful & (most >= size))
            if not len(frames):
                break
            best, blamed, clear = _best_sets(
                equations.take(frames), _pool_of(pool, frames).sigma, weighted[frames],
                single[frames], size,
            )  # fmt: skip
        here = _Squares(*(one[frames] for one in squares))
        for before in range(size):
            more = best - gained[frames]
            # the sum of squares without the set has `size` picks fewer, whatever it had before
            chance = here._replace(total=here.total - gained[frames]).chance(
                more, size - before, size
            )
            share = SHARE[np.clip(most[frames], 1, AT_ONCE) - 1, size - before]
            limit = significance * share / binom(count[frames], size - before)
            better = (chosen[frames] == before) & (chance < limit)
            rows = frames[better]
            found[rows], unclear[rows] = clear[better], blamed[better] & ~clear[better]
            chosen[rows], gained[rows] = size, best[better]
    return found, unclear


def _gains_of_picks(weights: ResidualWeights, weighted: Floats) -> Floats:
    """Calculate the decrease of the weighted sum of squares without each pick, (F, L)."""
    xx, xy, yy = weights.blocks
    x, y = np.split(weighted, 2, axis=1)
    determinant = xx * yy - xy**2
    own_xx, own_xy, own_yy = weights.own_blocks
    seen = determinant * HIDDEN > own_xx * own_yy - own_xy**2
    gain = (yy * x**2 - 2.0 * xy * x * y + xx * y**2) / determinant
    return np.where(seen, gain, 0.0)


def _best_sets(
    equations: ResidualEquations, sigma: Floats | float, weighted: Floats, single: Floats, size: int
) -> tuple[Floats, Bools, Bools]:
    """Find the sets of picks of each frame that gain most.

    Args:
        equations: of the frames
        sigma: the reading sigma in force
        weighted: residuals by their weights, (F, 2L)
        single: gain of each pick by itself, (F, L)
        size: how many picks a set has

    Returns:
        The gain of the best set (F,); picks that are in one of the sets that gain nearly as
        much, (F, L), and picks that are in all of them, (F, L).
    """
    candidates = np.argsort(-single, axis=1, kind="stable")[:, :MOST_CANDIDATES]
    width = candidates.shape[1]
    sets = np.array(list(combinations(range(width), size)))
    both = np.hstack([candidates, candidates + single.shape[1]])
    member = (sets[:, :, None] == np.arange(width)).any(axis=1)
    step = max(SETS_TOGETHER // len(sets), 1)
    best = np.zeros(len(single))
    blamed, clear = np.zeros(single.shape, bool), np.zeros(single.shape, bool)
    for start in range(0, len(single), step):
        some = slice(start, start + step)
        part = equations.take(some)
        weights = ResidualWeights(part, sigma[some] if isinstance(sigma, np.ndarray) else sigma)
        rows = np.arange(len(both[some]))[:, None]
        columns = np.zeros((*part.residual.shape, 2 * width))
        columns[rows, both[some], np.arange(2 * width)] = 1.0
        block = weights.of(columns)[rows, both[some]]
        scale = np.sqrt(np.hstack(weights.own_blocks[::2])[rows, both[some]])
        scale = np.where(scale > 0.0, scale, np.nan)
        block = block / (scale[:, :, None] * scale[:, None, :])
        right = np.take_along_axis(weighted[some], both[some], axis=1) / scale
        of_sets = np.hstack([sets, sets + width])
        inner = inverse(block[:, of_sets[:, :, None], of_sets[:, None, :]])
        right = right[:, of_sets]
        gains = np.einsum("fsi,fsij,fsj->fs", right, inner, right)
        seen = np.abs(inner).max(axis=(2, 3)) < HIDDEN
        gains = np.where(seen & np.isfinite(gains), gains, 0.0)
        best[some] = gains.max(axis=1)
        near = gains > best[some, None] - UNCLEAR
        np.put_along_axis(blamed[some], candidates[some], near @ member, axis=1)
        np.put_along_axis(clear[some], candidates[some], ~(near @ ~member), axis=1)
    return best, blamed, clear


def _confirmed(
    equations: ResidualEquations, pool: Pool, least: float, found: Bools, significance: float
) -> Bools:
    """Keep the blunders that do not fit the picks of their frame that are none, (F, L)."""
    kept = found.copy()
    order = np.argsort(~found, axis=1, kind="stable")
    for rank in range(int(found.sum(axis=1).max())):
        pick = order[:, rank]
        rows = np.flatnonzero(found[np.arange(len(pick)), pick])
        others = found[rows]
        others[np.arange(len(rows)), pick[rows]] = False
        some = without_picks(equations.take(rows), others)
        own = _pool_of(pool, rows)
        weights = ResidualWeights(some, own.sigma)
        weighted = weights.of(some.residual[..., None])[..., 0]
        squares = _squares(some, weights, weighted, own, least)
        gain = _gains_of_picks(weights, weighted)[np.arange(len(rows)), pick[rows]]
        kept[rows, pick[rows]] = squares.chance(gain, 1, 1) < significance
    return kept
