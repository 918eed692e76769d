"""Blunders of a frame: sets of picks against the others, by dense matrices."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from scipy.stats import binom, chi2, f

from tests.tolerances import assert_close
from vopd.arrays import Bools, Floats
from vopd.attitude.blunders import blunders_of_frames
from vopd.attitude.residuals import SIGNIFICANCE, Pool, ResidualEquations, ResidualWeights

FOCAL_PX, DEPTH_M = 3000.0, 100.0
ONE, TWO = 0.8 * SIGNIFICANCE, 0.1 * SIGNIFICANCE  # of all single picks, of all pairs


def frames_of(
    count: int,
    frames: int = 1,
    seed: int = 1,
    position_m: float = 0.0,
    sigma_px: Floats | float = 1.0,
) -> ResidualEquations:
    """Frames of a nadir camera 100 m up, with noise by the sigmas of readings and position."""
    rng = np.random.default_rng(seed)
    across = rng.uniform(-0.45, 0.45, (frames, count, 2)) * [4000.0, 3000.0] / FOCAL_PX
    z = DEPTH_M * rng.uniform(0.9, 1.1, (frames, count))
    x, y, zero = across[..., 0] * z, across[..., 1] * z, np.zeros_like(z)
    by_u = FOCAL_PX * np.stack([1 / z, zero, -x / z**2], axis=-1)
    by_v = FOCAL_PX * np.stack([zero, 1 / z, -y / z**2], axis=-1)
    by_point = np.concatenate([by_u, by_v], axis=1)
    point = np.tile(np.stack([x, y, z], axis=-1), (1, 2, 1))
    variance = np.broadcast_to(
        np.tile(np.broadcast_to(sigma_px, z.shape), 2) ** 2.0, (frames, 2 * count)
    )
    shared = by_point * position_m if position_m else np.zeros((frames, 2 * count, 0))
    residual = rng.normal(size=variance.shape) * np.sqrt(variance)
    residual += (shared @ rng.normal(size=(frames, shared.shape[2], 1)))[..., 0]
    none = np.zeros((frames, 2 * count, 0))
    return ResidualEquations(residual, np.cross(point, by_point), variance.copy(), shared, none)


def displaced(one: ResidualEquations, picks: list[int], by_px: Floats | float) -> ResidualEquations:
    """The same with picks of the first frame displaced, each in another direction."""
    residual, count = one.residual.copy(), one.variance.shape[1] // 2
    turn = 0.7 + 2.1 * np.arange(len(picks))
    residual[0, picks] += by_px * np.cos(turn)
    residual[0, np.array(picks) + count] += by_px * np.sin(turn)
    return replace(one, residual=residual)


def squares(one: ResidualEquations, without: tuple[int, ...] = (), sigma: float = 1.0) -> float:
    """The weighted sum of squares of the first frame without some picks, by least squares."""
    count = one.variance.shape[1] // 2
    rows = [k for k in range(2 * count) if k % count not in without and one.variance[0, k] > 0.0]
    covariance = sigma**2 * np.diag(one.variance[0, rows])
    covariance += one.shared[0, rows] @ one.shared[0, rows].T
    root = np.linalg.inv(np.linalg.cholesky(covariance))
    b, r = root @ one.partials[0, rows], root @ one.residual[0, rows]
    fit, *_ = np.linalg.lstsq(b, r, rcond=None)
    return float(((r - b @ fit) ** 2).sum())


def found(one: ResidualEquations, pool: Pool | None = None) -> list[int]:
    blunder, _ = blunders_of_frames(one, pool or Pool(1.0, np.inf, None))
    return np.flatnonzero(blunder[0]).tolist()


@pytest.mark.parametrize("position_m", [0.0, 3.0])
def test_blocks_are_those_of_the_weights(position_m: float) -> None:
    one = frames_of(6, frames=2, position_m=position_m)
    weights = ResidualWeights(one, 0.8)
    whole = weights.of(np.tile(np.eye(12), (2, 1, 1)))
    for element, (i, j) in zip(weights.blocks, ((0, 0), (0, 6), (6, 6)), strict=True):
        expected = [[whole[k, i + n, j + n] for n in range(6)] for k in range(2)]
        assert_close("dense algebra", element, expected)


def gains_of_picks(one: ResidualEquations) -> Floats:
    """How much less the sum of squares is without each pick."""
    count = one.variance.shape[1] // 2
    return np.array([squares(one) - squares(one, (k,)) for k in range(count)])


def least(one: ResidualEquations, size: int, sigma: float = 1.0) -> tuple[tuple[int, ...], float]:
    """The set of so many picks without which the sum of squares is least, and that."""
    count = one.variance.shape[1] // 2
    every = {s: squares(one, s, sigma) for s in combinations(range(count), size)}
    best = min(every, key=lambda s: every[s])
    return best, every[best]


@pytest.mark.parametrize("position_m", [0.0, 3.0])
@pytest.mark.parametrize("count", [6, 8])
def test_one_pick_is_a_blunder_below_half_a_thousandth_of_the_frame(
    count: int, position_m: float
) -> None:
    """Chi-square of two degrees, from both sides; 6 more than any other pick."""
    one = frames_of(count, position_m=position_m, seed=count)
    low, high = 0.0, 100.0
    for _ in range(30):
        size = (low + high) / 2.0
        moved = displaced(one, [2], size)
        gain = gains_of_picks(moved)
        clear = gain[2] > np.delete(gain, 2).max() + 6.0
        noticed = clear and chi2.sf(gain[2], 2) < ONE / count
        low, high = (low, size) if noticed else (size, high)
    assert found(displaced(one, [2], high * 1.001)) == [2]
    assert found(displaced(one, [2], low * 0.999)) == []


def test_with_an_estimated_sigma_it_is_an_f_test_without_the_pick() -> None:
    """Pool of 40 degrees without the frame, 9 of its own, two for the pick."""
    one = frames_of(6, seed=3)
    sigma, freedom, low, high = 1.3, 40.0, 0.0, 100.0
    for _ in range(30):
        size = (low + high) / 2.0
        moved = displaced(one, [1], size)
        best, left = least(moved, 1, sigma)
        variance = (freedom + left) / (freedom + 7.0)
        ratio = (squares(moved, sigma=sigma) - left) / 2.0 / variance
        noticed = best == (1,) and f.sf(ratio, 2, freedom + 7.0) < ONE / 6.0
        low, high = (low, size) if noticed else (size, high)
    pool = Pool(sigma, freedom, np.array([False]))
    assert found(displaced(one, [1], high * 1.001), pool) == [1]
    assert found(displaced(one, [1], low * 0.999), pool) == []


def test_a_frame_of_the_pool_is_tested_by_the_other_frames() -> None:
    """The pool has 49 degrees of freedom, 9 of them of this frame."""
    one = displaced(frames_of(6, seed=3), [1], 5.4)
    total = squares(one)
    inside = Pool(1.0, 49.0, np.array([True]))
    outside = Pool(1.0, 40.0, np.array([False]))
    for pool, others in ((inside, 49.0 - total), (outside, 40.0)):
        left = least(one, 1)[1]
        variance = (others + left) / 47.0
        noticed = f.sf((total - left) / 2.0 / variance, 2, 47.0) < ONE / 6.0
        assert found(one, pool) == ([1] if noticed else [])


@pytest.mark.parametrize("picks", [[1, 4], [0, 1], [0, 3, 5], [2, 3, 4]])
@pytest.mark.parametrize("position_m", [0.0, 3.0])
def test_two_and_three_gross_picks_of_eight_are_named(picks: list[int], position_m: float) -> None:
    one = displaced(frames_of(8, position_m=position_m, seed=5), picks, 200.0)
    assert found(one) == picks
    assert found(one, Pool(1.0, 13.0, np.array([True]))) == picks  # by this frame alone


def pair_that_hides(count: int) -> tuple[ResidualEquations, float]:
    """Residuals that the first two picks explain, and how many times the largest pick alone.

    The direction of many in which that is most; without the pair the squares are 1 less.
    """
    one = frames_of(count, seed=2)
    rng, rows, most = np.random.default_rng(1), [0, 1, count, count + 1], 0.0
    for _ in range(2000):
        residual = np.zeros((1, 2 * count))
        residual[0, rows] = rng.normal(size=4)
        tried = replace(one, residual=residual)
        gain = squares(tried) - squares(tried, (0, 1))
        if gain / gains_of_picks(tried).max() > most:
            most, worst = gain / gains_of_picks(tried).max(), residual / np.sqrt(gain)
    return replace(one, residual=worst), most


def test_two_that_hide_each_other_are_named_together() -> None:
    """No pick alone is significant, the pair is."""
    one, _ = pair_that_hides(6)
    for gain in (27.0, 30.0):
        moved = replace(one, residual=one.residual * np.sqrt(gain))
        assert chi2.sf(gains_of_picks(moved).max(), 2) > ONE / 6.0
        significant = chi2.sf(gain, 4) < TWO / 15.0
        blunder, unclear = blunders_of_frames(moved, Pool(1.0, np.inf, None))
        assert (blunder | unclear)[0, :2].tolist() == [significant] * 2


def test_two_of_five_that_hide_each_other_are_named_together() -> None:
    """As many as may be left out there; of each alone four times the limit's chance is left."""
    one, most = pair_that_hides(5)
    gain = most * chi2.isf(4.0 * ONE / 5.0, 2)
    assert chi2.sf(gain, 4) < TWO / 10.0 / 10.0  # of ten pairs, far below the limit
    moved = replace(one, residual=one.residual * np.sqrt(gain))
    blunder, unclear = blunders_of_frames(moved, Pool(1.0, np.inf, None))
    assert (blunder | unclear)[0, :2].all()


@pytest.mark.parametrize(
    ("count", "most"), [(3, 0), (4, 1), (5, 2), (6, 3), (7, 3), (8, 4), (9, 4)]
)
def test_three_picks_are_left_and_half(count: int, most: int) -> None:
    one = displaced(frames_of(count, seed=count), list(range(count)), 300.0)
    assert len(found(one)) <= most
    several = list(range(min(most, 3)))
    if several:
        assert found(displaced(frames_of(count, seed=count), several, 300.0)) == several


def test_more_than_three_of_many_are_found_one_set_after_the_other() -> None:
    picks = [0, 3, 4, 7, 11, 12, 19]
    assert found(displaced(frames_of(20, seed=4), picks, np.geomspace(20.0, 900.0, 7))) == picks


def test_each_pick_has_its_own_sigma() -> None:
    """25 px are a blunder of a pick of 1 px, and none of a pick of 10 px."""
    sigma = np.ones(8)
    sigma[3] = 10.0
    one = frames_of(8, sigma_px=sigma, seed=6)
    assert found(displaced(one, [3], 25.0)) == []
    assert found(displaced(one, [2], 25.0)) == [2]


def test_an_error_of_the_position_is_not_blamed_on_a_landmark() -> None:
    exact = frames_of(6, seed=7)
    shift = frames_of(6, seed=7, position_m=3.0).shared / 3.0 @ np.array([2.0, -3.0, 4.0])
    assert found(replace(exact, residual=exact.residual + shift))
    stated = replace(frames_of(6, seed=7, position_m=3.0), residual=exact.residual + shift)
    assert found(stated) == []


def test_picks_that_may_each_be_the_blunder_are_unclear() -> None:
    """Four landmarks and 3 m: each pick left out explains a gross one nearly as well."""
    one = displaced(frames_of(4, position_m=3.0, seed=8), [1], 12.0)
    gains = gains_of_picks(one)
    blunder, unclear = blunders_of_frames(one, Pool(1.0, np.inf, None))
    assert gains.max() > 25.0 and (gains > gains.max() - 6.0).sum() > 1
    assert not blunder.any()
    assert unclear[0].tolist() == (gains > gains.max() - 6.0).tolist()


def test_an_earlier_blunder_that_fits_is_none() -> None:
    one = displaced(frames_of(8, seed=5), [4], 60.0)
    known = np.zeros((1, 8), bool)
    known[0, [2, 4]] = True
    blunder, _ = blunders_of_frames(one, Pool(1.0, np.inf, None), known=known)
    assert np.flatnonzero(blunder[0]).tolist() == [4]


def test_nothing_below_the_least_reading_sigma_is_a_blunder() -> None:
    """Residuals of a millionth of a pixel, but for one of 1 px; the least sigma is .3 px."""
    one = frames_of(8, seed=9)
    tiny = replace(one, residual=one.residual * 1e-6)
    alone = Pool(0.3, 13.0, np.array([True]))
    for size, expected in ((1.0, []), (3.0, [2])):
        blunder, _ = blunders_of_frames(displaced(tiny, [2], size), alone, least=0.3)
        assert np.flatnonzero(blunder[0]).tolist() == expected


def clean_rate(blunder: Bools) -> tuple[int, int]:
    return int(blunder.any(axis=1).sum()), len(blunder)


@pytest.mark.parametrize("position_m", [0.0, 3.0])
def test_a_frame_in_a_thousand_has_a_false_alarm_with_sigmas_of_all_sizes(
    position_m: float,
) -> None:
    rng = np.random.default_rng(11)
    for count in (4, 6, 8):
        sigma = rng.choice([0.3, 1.0, 3.0, 10.0], (4000, count))
        one = frames_of(count, 4000, seed=count, position_m=position_m, sigma_px=sigma)
        blunder, _ = blunders_of_frames(one, Pool(1.0, np.inf, None))
        flagged, frames = clean_rate(blunder)
        assert binom.sf(flagged - 1, frames, 0.001) > 1e-4


def test_frames_without_equations_disturb_no_other() -> None:
    one = displaced(frames_of(8, frames=2, seed=5), [4], 60.0)
    lost = ResidualEquations(
        *(
            np.concatenate([part, np.full_like(part[:1], np.nan)])
            for part in (one.residual, one.partials)
        ),
        np.concatenate([one.variance, one.variance[:1]]),
        *(np.concatenate([part, part[:1]]) for part in (one.shared, one.own)),
    )
    blunder, _ = blunders_of_frames(lost, Pool(1.0, np.inf, None))
    assert blunder.any(axis=1).tolist() == [True, False, False]
