"""Velocity along a track: local polynomials through its fixes, with their noise and curvature.

The noise of the fixes and the curvature of the path are both taken from the track itself. A path
whose third derivative is white noise of density q (m^2/s^5) has third differences that grow with
their step, those of noisy fixes do not: the restricted likelihood of all third differences tells
the two apart (Wahba, Spline Models for Observational Data, 1990, chapter 1 and 4; Cleveland and
Loader, Smoothing by local regression, 1996, for the windows).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.findings import size_text
from vopd.flight.flight import TrackFixes, TrackSlopes
from vopd.geometry.earth import NED_FROM_ENU, local_axes
from vopd.geometry.linear import inverse

# Noise and curvature of a track by its third differences

RATIOS = 10.0 ** np.arange(-8.0, 7.5, 0.5)
"""Variances of third differences by curvature over those by noise, the ones that are tried."""
NEIGHBOURS = 15  # third differences to either side that decide how curved the path is at a fix
LEAST_NOISE_M = 1e-6  # of a fix: below are the rounding errors of files and of the arithmetic
MOST_NOISE = 1.5  # root mean squares of the third differences; the noise cannot be larger
NOISE_STEPS = 120
ALLOWED = 0.5  # of a logarithm of likelihood: one standard deviation
NOISE_RANGE = 1e-4
NUMBERS_AT_ONCE = 50_000  # likelihoods that are formed together: they fit a cache
PASSES = 30  # of the frequencies of the ratios
SAME = 1e-8  # of a variance, by which third differences differ of which another is as good as one
FIXES_AT_ONCE = 30_000  # of a long track, about 2 kB each
FEWEST_FIXES = 4  # three have no third difference
GAUSS = np.array([-np.sqrt(0.6), 0.0, np.sqrt(0.6)]) / 2.0 + 0.5
GAUSS_WEIGHT = np.array([5.0, 8.0, 5.0]) / 18.0
"""Gauss's three points between 0 and 1: exact for the squares of the quadratic kernels here."""


class Roughness(NamedTuple):
    """How noisy the fixes of a track are, and how curved its path, east, north, up."""

    noise_m: Floats  # (T, 3) standard deviation of each fix against its neighbours
    jerk: Floats  # (T, 3) density of the third derivative, m^2/s^5; NaN: too few fixes


def roughness(time_s: Floats, position_m: Floats, sigma_m: Floats | None) -> Roughness:
    """Estimate the noise of the fixes of a track and the curvature of its path.

    Noise that is the same in neighbouring fixes, as most of a usual receiver's, moves the track
    and does not bend it: it is not in the noise here, which may be far below the stated sigma.

    Args:
        time_s: of the fixes, ascending, (T,)
        position_m: east, north, up of any origin, (T, 3)
        sigma_m: stated standard deviations of the fixes, which the noise does not exceed, (T, 3);
            None or 0: none are stated
    """
    stated = sigma_m is not None and bool((sigma_m > 0.0).any())
    relative = np.ones_like(position_m)
    if sigma_m is not None and stated:
        relative = np.maximum(sigma_m, 1e-3 * sigma_m.max())
    noise, jerk = np.empty_like(position_m), np.empty_like(position_m)
    most = 1.0 if stated else np.inf
    for part in np.array_split(np.arange(len(time_s)), len(time_s) // FIXES_AT_ONCE + 1):
        for axis in range(3):
            own = relative[part, axis]
            factor, curved = _of_one_axis(time_s[part], position_m[part, axis], own, most)
            jerk[part, axis] = curved
            noise[part, axis] = np.maximum(factor * own, LEAST_NOISE_M)
    return Roughness(noise, jerk)


def _of_one_axis(
    time_s: Floats, position: Floats, sigma: Floats, most: float
) -> tuple[float, Floats]:
    """Estimate the noise in sigmas, and the density of the third derivative at each fix (T,)."""
    fixes = len(time_s)
    if fixes < FEWEST_FIXES:
        return (most if np.isfinite(most) else np.nan), np.full(fixes, np.nan)
    weight = _third_differences(time_s, sigma)
    z = (weight * np.stack([position[k : fixes - 3 + k] for k in range(4)], axis=1)).sum(axis=1)
    least = LEAST_NOISE_M / float(np.median(sigma))
    upper = max(min(most, MOST_NOISE * float(np.sqrt(np.mean(z**2)))), least)
    by_noise, by_jerk = _covariances(time_s, weight, sigma)
    unit = float(np.median(by_jerk[0]))
    if len(z) < 5:  # too few for a likelihood: all that the noise may be, and all that is left
        jerk = float(np.mean(z**2 / by_jerk[0]))
        return upper, np.full(fixes, max(jerk, least**2 / unit))
    squares, logs = _innovations(z, by_noise, by_jerk / unit)
    # local sums: how likely each ratio is about each third difference
    near_squares, near_logs, count = (_local_sums(one) for one in (squares, logs, np.ones(len(z))))
    grid = upper * NOISE_RANGE ** np.linspace(1.0, 0.0, NOISE_STEPS)
    blocks = slice(NEIGHBOURS, None, 2 * NEIGHBOURS + 1) if len(z) > 2 * NEIGHBOURS else slice(1)

    def likelihood(noise: Floats) -> Floats:
        squares, logs = near_squares[:, blocks], near_logs[:, blocks]
        noise = noise[..., None, None]
        return np.asarray(-0.5 * (squares / noise**2 + logs + 2.0 * np.log(noise) * count[blocks]))

    # the largest noise that the differences allow: what it cannot be told from is curvature
    parts = near_logs[:, blocks].size * NOISE_STEPS // NUMBERS_AT_ONCE + 1
    tried = (_log_mean(likelihood(some)).sum(axis=1) for some in np.array_split(grid, parts))
    each = np.concatenate(list(tried))
    noise = float(grid[np.flatnonzero(each >= each.max() - ALLOWED)[-1]])
    # ratios that the rest of the track has are likelier than others
    prior = np.full((len(RATIOS), 1), 1.0 / len(RATIOS))
    found = likelihood(np.array(noise))
    for _ in range(PASSES * (found.shape[1] > 1)):
        share = np.exp(found - found.max(axis=0)) * prior
        together = (share / share.sum(axis=0)).sum(axis=1, keepdims=True)
        prior = (together + 1.0 / len(RATIOS)) / (found.shape[1] + 1.0)
    each = -0.5 * (near_squares / noise**2 + near_logs)
    share = np.exp(each - each.max(axis=0)) * prior
    ratio = (RATIOS[:, None] * share).sum(axis=0) / share.sum(axis=0)
    jerk = np.interp(np.arange(fixes) - 1.5, np.arange(len(z)), ratio * noise**2 / unit)
    return noise, jerk


def _log_mean(each: Floats) -> Floats:
    """Average likelihoods (noises, ratios, blocks) over the ratios, as logarithms."""
    most = each.max(axis=1)
    return np.asarray(most + np.log(np.exp(each - most[:, None]).mean(axis=1)))


def _third_differences(time_s: Floats, sigma: Floats) -> Floats:
    """Weigh four fixes so that parabolas vanish and noise of one sigma has variance 1, (T-3, 4)."""
    t = np.stack([time_s[k : len(time_s) - 3 + k] for k in range(4)], axis=1)
    s = np.stack([sigma[k : len(sigma) - 3 + k] for k in range(4)], axis=1)
    apart = (t[:, :, None] - t[:, None, :]) / (t[:, -1] - t[:, 0])[:, None, None] + np.eye(4)
    weight = 1.0 / apart.prod(axis=2)
    return np.asarray(weight / np.sqrt((weight**2 * s**2).sum(axis=1))[:, None])


def _covariances(time_s: Floats, weight: Floats, sigma: Floats) -> tuple[Floats, Floats]:
    """Form the covariances of third differences, as lower bands, (4, T-3).

    Args:
        time_s: of the fixes, (T,)
        weight: of four fixes in each difference, (T-3, 4)
        sigma: of the fixes, (T,)

    Returns:
        Those by noise of one sigma, and those by a third derivative of density 1.
    """
    n = len(weight)
    scaled = weight * np.stack([sigma[k : k + n] for k in range(4)], axis=1)
    by_noise, by_jerk = np.zeros((4, n)), np.zeros((4, n))
    # the kernel of a difference in each of its three intervals, at Gauss's points
    step = np.stack([np.diff(time_s)[k : k + n] for k in range(3)], axis=1)
    t = np.stack([time_s[k : k + n] - time_s[:n] for k in range(4)], axis=1)
    at = t[:, :3, None] + step[..., None] * GAUSS
    kernel = np.zeros_like(at)
    for interval in range(3):
        for k in range(interval + 1, 4):
            late = t[:, k, None] - at[:, interval]
            kernel[:, interval] += weight[:, k, None] * late**2 / 2.0
    share = step[..., None] * GAUSS_WEIGHT
    for lag in range(min(4, n)):
        by_noise[lag, : n - lag] = (scaled[: n - lag, lag:] * scaled[lag:, : 4 - lag]).sum(axis=1)
        if lag < 3:
            both = kernel[: n - lag, lag:] * kernel[lag:, : 3 - lag] * share[lag:, : 3 - lag]
            by_jerk[lag, : n - lag] = both.sum(axis=(1, 2))
    return by_noise, by_jerk


def _innovations(z: Floats, by_noise: Floats, by_jerk: Floats) -> tuple[Floats, Floats]:
    """Factor the covariance for each of the ratios: squares and log variances (R, T-3).

    Their sums over any part of the track are the part's likelihood, given what is before it.
    """
    from scipy.linalg import cholesky_banded, lapack  # takes a tenth of a second to load

    squares, logs = np.empty((len(RATIOS), len(z))), np.empty((len(RATIOS), len(z)))
    for k, ratio in enumerate(RATIOS.tolist()):
        total = by_noise + ratio * by_jerk
        factor, fails = lapack.dpbtrf(total, lower=1)
        if fails:  # differences of fixes of nearly one time are the same
            total[0] *= 1.0 + SAME
            factor = cholesky_banded(total, lower=True)
        squares[k] = lapack.dtbtrs(factor, z[:, None], uplo="L")[0][:, 0] ** 2
        logs[k] = 2.0 * np.log(factor[0])
    return squares, logs


def _local_sums(each: Floats) -> Floats:
    """Add up the values about each place, in the last axis."""
    count = each.shape[-1]
    total = np.concatenate([np.zeros((*each.shape[:-1], 1)), np.cumsum(each, axis=-1)], axis=-1)
    # windows of one width, those at the ends pushed inside
    width = min(2 * NEIGHBOURS + 1, count)
    first = np.clip(np.arange(count) - NEIGHBOURS, 0, count - width)
    return np.asarray(total[..., first + width] - total[..., first])


HIDDEN_STEPS = 12  # between fixes: as quick a weave as wide as their noise is averaged away


def hidden_weave(time_s: Floats, rough: Roughness) -> tuple[float, float]:
    """Find the amplitude, m, and the period, s, of a weave that third differences do not show.

    Args:
        time_s: of the fixes, ascending, (T,)
        rough: noise of the track
    """
    noise_m = np.nan_to_num(np.median(rough.noise_m, axis=0)).max()
    return float(noise_m), float(HIDDEN_STEPS * np.median(np.diff(time_s)))


# Velocity by polynomials through the fixes about a time

FITS = (
    *((2, n) for n in (3, 4, 5, 7, 9, 13, 19, 27, 41)),
    *((3, n) for n in (4, 5, 7, 9, 13, 19)),
)
"""Degrees of a polynomial, and numbers of fixes that it is fitted to; the ones that are tried."""
WORSE = 2.0  # times the least error so far: more fixes are no longer tried
INSIDE = (0.1, 0.9)  # parts of a gap where the errors of a fit are compared with those of others
AT_ONCE = 4_000  # moments whose windows are formed together


def track_velocity(
    at_s: Floats, time_s: Floats, position_m: Floats, rough: Roughness
) -> tuple[Floats, Floats, Floats, Floats, Ints]:
    """Fit the velocity at some moments: parabolas and cubics through as many fixes as serve best.

    More fixes have less noise and miss more of the path's curvature: number and degree are those
    for which both together are smallest in the gap between two fixes. Fixes count by their
    variances. A gap is bridged as far as the curvature allows.

    Args:
        at_s: the moments, within the track, (F,)
        time_s: of the fixes, ascending, (T,)
        position_m: of the fixes, in any axes, (T, 3)
        rough: noise and curvature of the track

    Returns:
        Velocity and acceleration in the axes of the positions, (F, 3); variances of the velocity by
        the noise of the fixes, and by what the path bends otherwise than the polynomial, east,
        north, up, (F, 3); and to how many fixes it is fitted, (F,).
    """
    moments, fixes = len(at_s), len(time_s)
    last = np.clip(np.searchsorted(time_s, at_s, side="right") - 1, 0, fixes - 2)
    velocity, acceleration, noises, curvature = np.full((4, moments, 3), np.nan)
    count = np.zeros(moments, np.int64)
    for some, index, tau, weights in _fitted(at_s, last, time_s, rough):
        by_velocity, by_acceleration = weights[:, 1], weights[:, 2]
        away = position_m[index] - position_m[last[some, None]]
        velocity[some] = np.einsum("fw,fwi->fi", by_velocity, away)
        acceleration[some] = np.einsum("fw,fwi->fi", by_acceleration, away)
        noises[some] = (by_velocity[..., None] ** 2 * rough.noise_m[index] ** 2).sum(axis=1)
        missed = missed_curvature(tau, by_velocity)[:, None]
        curvature[some] = missed * rough.jerk[last[some]]
        count[some] = index.shape[1]
    return velocity, acceleration, noises, curvature, count


def _fitted(
    at_s: Floats, last: Ints, time_s: Floats, rough: Roughness, bent: float = 1.0
) -> Iterator[tuple[Ints, Ints, Floats, Floats]]:
    """Choose a fit for each moment, and weigh its fixes.

    Args:
        at_s: the moments, (F,)
        last: the fix before each, (F,)
        time_s: of the fixes, (T,)
        rough: noise and curvature of the track
        bent: times the variance by missed curvature beside that by noise

    Yields:
        Moments, by their indices (B,); their fixes, and the times of these after them, (B, n); the
        weights of `polynomial_weights`.
    """
    gaps, own = np.unique(last, return_inverse=True)
    every = len(gaps) // AT_ONCE + 1  # of very many gaps some are enough
    best = np.repeat(_best_fits(gaps[::every], time_s, rough, bent), every)[: len(gaps)]
    fit = best[own]
    for which in np.unique(best).tolist():
        (degree, n), these = _fits(len(time_s))[which], np.flatnonzero(fit == which)
        for k in range(0, len(these), AT_ONCE):
            some = these[k : k + AT_ONCE]
            index, tau = _window(n, at_s[some], time_s)
            weights = polynomial_weights(tau, (rough.noise_m[index] ** 2).mean(axis=2), degree)
            alike = np.isnan(weights).any(axis=(1, 2))
            weights[alike] = polynomial_weights(tau[alike], np.ones_like(tau[alike]), 1)
            yield some, index, tau, weights


FAITHFUL = 10.0  # times the variance by curvature, which is no unknown as the noise is


def path_slopes(at_s: Floats, time_s: Floats, position_m: Floats, rough: Roughness) -> TrackSlopes:
    """Weigh the fixes in velocity and acceleration at some moments.

    Where the errors of fixes are solved for, those of the velocity by the same fixes are as well,
    and the path's curvature is what is not known of it: windows are shorter than those of
    `track_velocity`.

    Args:
        at_s: the moments, within the track, (F,)
        time_s: of the fixes, ascending, (T,)
        position_m: of the fixes, in any axes, (T, 3)
        rough: noise and curvature of the track
    """
    moments, fixes = len(at_s), len(time_s)
    last = np.clip(np.searchsorted(time_s, at_s, side="right") - 1, 0, fixes - 2)
    found = list(_fitted(at_s, last, time_s, rough, FAITHFUL))
    first, behind = last.copy(), last + 2
    for some, index, _, _ in found:
        first[some] = np.minimum(first[some], index[:, 0])
        behind[some] = np.maximum(behind[some], index[:, -1] + 1)
    width = int((behind - first).max(initial=1))
    slopes = np.zeros((2, moments, width))
    for some, index, _, weights in found:
        slot = index - first[some, None]
        for which in (0, 1):
            slopes[which][some[:, None], slot] = weights[:, 1 + which]
    index = np.minimum(first[:, None] + np.arange(width), fixes - 1)
    away = position_m[index] - position_m[last, None]
    velocity, acceleration = np.einsum("kfw,fwi->kfi", slopes, away)
    on_time = np.zeros(moments)
    return TrackSlopes(first, slopes[0], slopes[1], velocity, acceleration, on_time)


def _window(count: int, at_s: Floats, time_s: Floats) -> tuple[Ints, Floats]:
    """Choose the fixes nearest to some moments: indices, and times after it, both (F, count).

    Args:
        count: of fixes in a window
        at_s: the moments, (F,)
        time_s: of the fixes, (T,)
    """
    first = np.searchsorted((time_s[:-count] + time_s[count:]) / 2.0, at_s)
    index = first[:, None] + np.arange(count)
    return index, time_s[index] - at_s[:, None]


def _fits(fixes: int) -> list[tuple[int, int]]:
    """List the degrees and numbers of fixes that a track of so many fixes allows."""
    return [one for one in FITS if one[1] <= fixes] or [(fixes - 1, fixes)]


def _best_fits(gaps: Ints, time_s: Floats, rough: Roughness, bent: float) -> Ints:
    """Find the fit for each gap, an index; the search for it ends where more is worse."""
    best, least = np.zeros(len(gaps), np.int64), np.full(len(gaps), np.inf)
    jerk = np.nan_to_num(rough.jerk[gaps])
    left, of_degree, before = np.arange(len(gaps)), least.copy(), 0
    for which, (degree, n) in enumerate(_fits(len(time_s))):
        if degree != before:
            left, of_degree, before = np.arange(len(gaps)), np.full(len(gaps), np.inf), degree
        first, behind = time_s[gaps[left]], time_s[gaps[left] + 1]
        at_s = np.concatenate([(1.0 - part) * first + part * behind for part in INSIDE])
        index, tau = _window(n, at_s, time_s)
        noise = rough.noise_m[index] ** 2
        weight = polynomial_weights(tau, noise.mean(axis=2), degree)[:, 1]
        missed = (
            bent * np.tile(jerk[left], (len(INSIDE), 1)) * missed_curvature(tau, weight)[:, None]
        )
        each = ((weight[..., None] ** 2 * noise).sum(axis=1) + missed).sum(axis=1)
        cost = each.reshape(len(INSIDE), -1).sum(axis=0)
        best[left] = np.where(cost < least[left], which, best[left])
        least[left] = np.minimum(cost, least[left])
        of_degree[left] = np.minimum(cost, of_degree[left])
        left = left[cost < WORSE * of_degree[left]]
    return best


def polynomial_weights(tau: Floats, variance: Floats, degree: int = 2) -> Floats:
    """Weigh fixes in the value, slope and second derivative of a polynomial at 0, (F, 3, n).

    NaN where the times of fixes are too near each other for it.

    Args:
        tau: times of the fixes after the moment, (F, n); two fixes make a line
        variance: of each fix, (F, n); NaN: not known, all count alike
        degree: of the polynomial
    """
    variance = np.where(np.isnan(variance), 1.0, variance)
    scale = np.abs(tau).max(axis=1)[:, None]
    powers = np.ones((*tau.shape, min(tau.shape[1] - 1, degree) + 1))
    powers[..., 1:] = (tau / scale)[..., None]
    powers = np.cumprod(powers, axis=2)
    weighted = powers / variance[..., None] * variance.mean(axis=1)[:, None, None]
    solved = inverse(powers.swapaxes(1, 2) @ weighted) @ weighted.swapaxes(1, 2)
    out = np.zeros((len(tau), 3, tau.shape[1]))
    out[:, : solved.shape[1]] = solved[:, :3]
    out[:, 1:] *= np.stack([1.0 / scale, 2.0 / scale**2], axis=1)
    return out


def missed_curvature(tau: Floats, weight: Floats) -> Floats:
    """Integrate the square of a fit's kernel: the variance by white jerk of density 1, (F,).

    Peano's kernel: the third derivative at s moves the fix at tau by (tau - s)^2 / 2 where s is
    between 0 and tau, and nothing else.

    Args:
        tau: times of the fixes after the moment, ascending, (F, n)
        weight: of each fix, for which parabolas give what they are to give, (F, n)
    """
    total = np.zeros(len(tau))
    for side in (1.0, -1.0):
        t, c = (tau, weight) if side > 0.0 else (-tau[:, ::-1], weight[:, ::-1])
        # sums over this and all later fixes, of c, c t and c t^2
        sums = [np.cumsum(one[:, ::-1], axis=1)[:, ::-1] for one in (c, c * t, c * t * t)]
        start = np.maximum(np.concatenate([np.full((len(t), 1), -np.inf), t[:, :-1]], axis=1), 0.0)
        length = np.maximum(t - start, 0.0)
        s = start[..., None] + length[..., None] * GAUSS
        kernel = (sums[2][..., None] - 2.0 * s * sums[1][..., None] + s**2 * sums[0][..., None]) / 2
        total += ((kernel**2 @ GAUSS_WEIGHT) * length).sum(axis=1)
    return total


# The path between fixes: how far it leaves its interpolation

SPLINE_NOISE = 0.256  # of a fix: in the middle of a gap a spline has so much more than its chord
NEAR_GAPS = 5  # gaps over which squares of curvatures are averaged


def gap_curvature(time_s: Floats, position_m: Floats, rough: Roughness, way: str) -> Floats:
    """Estimate how the path bends in each gap beyond its interpolation, m/s^2, (T-1, 3).

    A path that bends by a leaves the chord of a gap dt long by a dt^2 / 8 in its middle. From the
    curvature that the four nearest fixes show the part that is their noise is taken off, and what
    they do not show of it is added.

    Args:
        time_s: of the fixes, ascending, (T,)
        position_m: east, north, up of any origin, (T, 3)
        rough: noise and curvature of the track
        way: of interpolation, "linear" between two fixes, or "cubic", which follows the curvature
            that the fixes show, and their noise

    Returns:
        Standard deviations; 0 where two or three fixes cannot show any.
    """
    curvature = np.empty((len(time_s) - 1, 3))
    jerk = np.nan_to_num((rough.jerk[1:] + rough.jerk[:-1]) / 2.0)
    middle, step = (time_s[1:] + time_s[:-1]) / 2.0, np.diff(time_s)[:, None]
    shown = np.zeros_like(curvature)
    for k in range(0, len(middle), AT_ONCE):
        some = slice(k, k + AT_ONCE)
        index, tau = _window(min(4, len(time_s)), middle[some], time_s)
        if way == "cubic":
            by_place = polynomial_weights(tau, np.ones_like(tau), 3)[:, 0]
            off = jerk[some] * missed_curvature(tau, by_place)[:, None]
            off += SPLINE_NOISE * np.nan_to_num(rough.noise_m[index] ** 2).mean(axis=1)
            curvature[some] = off * (8.0 / step[some] ** 2) ** 2
            continue
        bend = polynomial_weights(tau, np.ones_like(tau))[:, 2]
        away = position_m[index] - position_m[index[:, :1]]
        noise = np.nan_to_num(rough.noise_m[index] ** 2)
        shown[some] = np.einsum("fw,fwi->fi", bend, away) ** 2
        shown[some] -= (bend[..., None] ** 2 * noise).sum(axis=1)
        curvature[some] = jerk[some] * missed_curvature(tau, bend)[:, None]
    return np.asarray(np.sqrt(np.nan_to_num(_near_gaps(shown) + curvature)))


def _near_gaps(squares: Floats) -> Floats:
    """Average squares over `NEAR_GAPS`; 0 where noise that was taken off leaves none, (T-1, 3)."""
    near = np.cumsum(np.concatenate([np.zeros((1, 3)), np.nan_to_num(squares)]), axis=0)
    width = min(NEAR_GAPS, len(squares))
    first = np.clip(np.arange(len(squares)) - width // 2, 0, len(squares) - width)
    return np.asarray(np.maximum(near[first + width] - near[first], 0.0) / width)


WITHIN = 2.0  # mean of a white third derivative: its variance in one gap over that in three


def gap_twist(time_s: Floats, position_m: Floats, rough: Roughness) -> Floats:
    """Estimate how the curvature of the path changes within each gap, m/s^3, (T-1, 3).

    That is the third derivative that the four nearest fixes show, their noise taken off.

    Args:
        time_s: of the fixes, ascending, (T,)
        position_m: east, north, up of any origin, (T, 3)
        rough: noise of the track

    Returns:
        Standard deviations; 0 where fewer than `FEWEST_FIXES` cannot show any.
    """
    shown = np.zeros((len(time_s) - 1, 3))
    middle = (time_s[1:] + time_s[:-1]) / 2.0
    for k in range(0, len(middle) if len(time_s) >= FEWEST_FIXES else 0, AT_ONCE):
        some = slice(k, k + AT_ONCE)
        index, tau = _window(4, middle[some], time_s)
        apart = tau[:, :, None] - tau[:, None, :] + np.eye(4)
        third = 6.0 / apart.prod(axis=2)
        away = position_m[index] - position_m[index[:, :1]]
        noise = np.nan_to_num(rough.noise_m[index] ** 2)
        shown[some] = np.einsum("fw,fwi->fi", third, away) ** 2
        shown[some] -= (third[..., None] ** 2 * noise).sum(axis=1)
    return np.asarray(np.sqrt(WITHIN * _near_gaps(shown)))


def off_chord(part: Floats, step_s: Floats) -> Floats:
    """Weigh curvature and its change in how far the path is off the chord of a gap, (F, 2).

    Args:
        part: a, of the gap that is over, (F,)
        step_s: length of the gap, (F,)

    Returns:
        -a (1 - a) dt^2 / 2 of the curvature in the middle, a (1 - a) (1 - 2 a) dt^3 / 12 of its
        change a second.
    """
    bend = part * (1.0 - part) * step_s**2 / 2.0
    return np.stack([-bend, bend * (1.0 - 2.0 * part) * step_s / 6.0], axis=1)


def with_gaps(fixes: TrackFixes, time_s: Floats, *shapes: Floats) -> TrackFixes:
    """Add the shape of the path in each gap to the errors of a track, between its two fixes.

    Args:
        fixes: errors of the fixes alone, of frames between two of them, (F, 2)
        time_s: of the fixes, (T,)
        shapes: prior standard deviations of curvature, m/s^2, and of its change, m/s^3, or of the
            curvature alone, east, north, up, (T-1, 3) each
    """
    before, a = fixes.weight.T
    step_s = np.append(np.diff(time_s), 0.0)[fixes.first]
    # frames that the track does not cover have no part in it
    off = np.where((before + a > 0.0)[:, None], off_chord(a, step_s), 0.0)[:, : len(shapes)]
    each = len(shapes) + 1
    sigma_m = np.empty((each * (len(time_s) - 1) + 1, 3))
    sigma_m[0::each] = fixes.sigma_m
    for k, sigma in enumerate(shapes, 1):
        sigma_m[k::each] = sigma
    weight = np.column_stack([before, off, a])
    return TrackFixes(each * fixes.first, weight, sigma_m, np.arange(len(sigma_m)) % each > 0)


# Velocities that a track has itself: between its rows, and against the differences of its positions


MOST_RATIO, LEAST_RATIO = 16.0, 2.0  # of a parabola, and of a velocity that walks at random
USUAL_RATIO = 8.0  # of a white second derivative, as that of the path's curvature is taken
FEWEST_OF_TWO_STEPS = 6  # second differences over two steps, that their ratio is known


def off_line(at_s: Floats, time_s: Floats, velocity_m_s: Floats, sigma_m_s: Floats) -> Floats:
    """Estimate how far velocities are from the line between those of two rows, (F, 3), rms.

    In the middle of a gap that is minus half of the second difference over half of the step. The
    rows have those over a step, and over two, whose squares are r times as large; half of the step
    has the r-th part. r is 16 where velocities bend slowly, and 2 where they change at random
    between the rows. The squares are those about the gap, less what their noise shows.

    Args:
        at_s: the moments, within the track, (F,)
        time_s: of the rows, ascending, (T,)
        velocity_m_s: (T, 3)
        sigma_m_s: standard deviations of these, (T, 3)
    """
    if len(time_s) < 3:
        return np.zeros((len(at_s), 3))
    square = _bends(time_s, velocity_m_s, sigma_m_s)
    of_two = [_bends(*(one[k::2] for one in (time_s, velocity_m_s, sigma_m_s))) for k in (0, 1)]
    two, ratio = np.concatenate(of_two), USUAL_RATIO
    if len(two) >= FEWEST_OF_TWO_STEPS and square.mean() > 0.0:
        ratio = float(np.clip(16.0 * two.mean() / square.mean(), LEAST_RATIO, MOST_RATIO))
    of_rows = np.pad(square, ((1, 1), (0, 0)), mode="edge")  # at the ends those of the next one
    bent = _near_gaps((of_rows[1:] + of_rows[:-1]) / 2.0)
    before = np.clip(np.searchsorted(time_s, at_s, side="right") - 1, 0, len(time_s) - 2)
    step_s = np.diff(time_s)[before]
    part = (at_s - time_s[before]) / step_s
    shape = np.maximum(4.0 * part * (1.0 - part), 0.0) ** min(2.0, (np.log2(ratio) + 1.0) / 2.0)
    return np.asarray(np.sqrt(bent[before] * (step_s**4 * shape / (4.0 * ratio))[:, None]))


def _bends(time_s: Floats, velocity_m_s: Floats, sigma_m_s: Floats) -> Floats:
    """Square the second derivatives at all rows but the ends, less what is noise, (T-2, 3)."""
    step_s = np.diff(time_s)[:, None]
    slope, both_s = np.diff(velocity_m_s, axis=0) / step_s, (step_s[1:] + step_s[:-1]) / 2.0
    noise = 1.0 / step_s[1:] ** 2 + 1.0 / step_s[:-1] ** 2
    noise = (noise + (1.0 / step_s[1:] + 1.0 / step_s[:-1]) ** 2) * sigma_m_s[1:-1] ** 2
    return np.asarray((np.diff(slope, axis=0) ** 2 - noise) / both_s**2)


FEWEST_STEPS = 4  # between positions: with fewer nothing is told
APART = 4.0  # standard deviations of a difference, in the median, from where on it is told
LEAST_APART_M_S = 0.3
BETTER = 3.0  # times smaller: a mistake is named without which the differences are so
CONTRADICTED = 0.5  # of the speed by positions: by so much they contradict it whatever the mistake
MISTAKEN = (
    ("vn_m_s and ve_m_s exchanged", np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])),
    (
        "vn_m_s, ve_m_s, vd_m_s taken for east, north, up",
        np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]),
    ),
    ("the other sign of vd_m_s, which is positive downward", np.diag([1.0, 1.0, -1.0])),
    ("the other sign of ve_m_s, which is positive to the east", np.diag([1.0, -1.0, 1.0])),
    ("the other sign of vn_m_s, which is positive to the north", np.diag([-1.0, 1.0, 1.0])),
    ("the other sign of all", -np.eye(3)),
    *(
        (f"them taken for {unit}: multiply by {factor:.5g}", factor * np.eye(3))
        for unit, factor in (
            ("knots", 1852.0 / 3600.0),
            ("mph", 0.44704),
            ("ft/s", 0.3048),
            ("km/h", 1.0 / 3.6),
            ("cm/s", 0.01),
            ("mm/s", 0.001),
        )
    ),
)
"""Mistakes in a track's velocities, and what makes north, east, down of those of a file."""


def _beside_steps(time_s: Floats, position: Floats, velocity_m_s: Floats) -> tuple[Floats, Floats]:
    """Compute the velocity over each step, and the mean of those at its two ends, (T-1, 3).

    Args:
        time_s: ascending, (T,)
        position: Earth-centred, (T, 3)
        velocity_m_s: north, east, down, (T, 3)
    """
    some = slice(FIXES_AT_ONCE)
    time_s, position, velocity_m_s = time_s[some], position[some], velocity_m_s[some]
    to_ned = NED_FROM_ENU @ local_axes(position[:-1])
    moved_m = np.einsum("tij,tj->ti", to_ned, np.diff(position, axis=0))
    return moved_m / np.diff(time_s)[:, None], (velocity_m_s[1:] + velocity_m_s[:-1]) / 2.0


FEWEST_BESIDE = 4  # positions, of which one step is beside no velocity that is off
ALONE = 8.0  # times what differences are in the median, and so many standard deviations of one
ALIKE = 0.25  # of their sum: by so much those before and behind one may be unlike, others be off


def velocities_alone(
    time_s: Floats, position: Floats, velocity_m_s: Floats, sigma_m_s: float
) -> tuple[Ints, Floats]:
    """Find single velocities that the positions before and behind them contradict.

    Half of the error of one is in the differences over both steps beside it; a position that is
    off, and a path that bends, are in both with opposite signs, or in all.

    Args:
        time_s: ascending, (T,)
        position: Earth-centred, (T, 3)
        velocity_m_s: north, east, down, (T, 3)
        sigma_m_s: as for `doubts_of_velocities`

    Returns:
        Their indices, and by how much each is off, (n,).
    """
    if len(time_s) < FEWEST_BESIDE:
        return np.zeros(0, np.int64), np.zeros(0)
    moved_m_s, stated_m_s = _beside_steps(time_s, position, velocity_m_s)
    apart = stated_m_s - moved_m_s
    usual = float(np.median(np.sort(np.linalg.norm(apart, axis=1))[:-2]))  # beside one that is off
    speed = float(np.median(np.linalg.norm(moved_m_s, axis=1)))
    off = np.linalg.norm(apart[1:] + apart[:-1], axis=1)
    alike = np.linalg.norm(apart[1:] - apart[:-1], axis=1) < ALIKE * off
    size = np.pad(np.linalg.norm(apart, axis=1), 1)
    others = np.maximum(size[:-3], size[3:])  # over the steps before and behind these two
    least = max(ALONE * usual, ALONE * sigma_m_s, LEAST_APART_M_S, CONTRADICTED * speed)
    alone = np.flatnonzero(alike & (others < ALIKE * off) & (off / 2.0 > least))
    return alone + 1, off[alone]


def doubts_of_velocities(
    name: str, time_s: Floats, position: Floats, velocity_m_s: Floats, sigma_m_s: float
) -> list[str]:
    """Warn of velocities that are not those of the positions beside them.

    The displacement over each step is held against the mean of the velocities at its two ends.

    Args:
        name: of the file
        time_s: ascending, (T,)
        position: Earth-centred, (T, 3)
        velocity_m_s: north, east, down, (T, 3)
        sigma_m_s: how far a difference over the usual step is off by the errors that are stated
    """
    if len(time_s) <= FEWEST_STEPS:
        return []
    moved_m_s, stated_m_s = _beside_steps(time_s, position, velocity_m_s)

    def apart(by: Floats) -> float:
        return float(np.median(np.linalg.norm(moved_m_s - stated_m_s @ by.T, axis=1)))

    off, speed = apart(np.eye(3)), apart(np.zeros((3, 3)))
    if not off > max(APART * sigma_m_s, LEAST_APART_M_S):
        return []
    without, what = min((apart(by), what) for what, by in MISTAKEN)
    differ = (
        f"{name}: its velocities differ from those by its positions by {size_text(off)} m/s in the "
        "median"
    )
    if without < off / BETTER:
        return [f"{differ}, and by {size_text(without)} with {what}"]
    if off < CONTRADICTED * speed:
        return []
    return [f"{differ}: are the columns vn_m_s, ve_m_s, vd_m_s north, east, down, in m/s?"]
