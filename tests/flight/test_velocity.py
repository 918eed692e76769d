"""Velocity along a track: noise and curvature of its fixes, and parabolas through them."""

from __future__ import annotations

from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import CubicSpline
from scipy.stats import multivariate_normal

from tests.tolerances import assert_close, within
from vopd.arrays import Floats
from vopd.flight.angles import angles_of_attack
from vopd.flight.flight import TrackFixes
from vopd.flight.project import velocity
from vopd.flight.project.stated import Notes
from vopd.flight.project.track import velocity_by_fit
from vopd.flight.project.velocity import (
    Roughness,
    gap_curvature,
    gap_twist,
    hidden_weave,
    missed_curvature,
    off_chord,
    path_slopes,
    polynomial_weights,
    roughness,
    with_gaps,
)
from vopd.geometry.earth import NED_FROM_ENU, earth_centred_m


def track_velocity(*given: Any) -> Any:
    names = "velocity_m_s", "acceleration_m_s2", "noise", "curvature", "fixes"
    found = velocity.track_velocity(*given)
    return SimpleNamespace(**dict(zip(names, found, strict=True)))


def test_weights_of_three_and_five_fixes() -> None:
    """(p3 - p1) / 2, p1 - 2 p2 + p3; of five fixes 1 s apart sum of t p over sum of t^2."""
    three = polynomial_weights(np.array([[-1.0, 0.0, 1.0]]), np.ones((1, 3)))
    assert_close("table value", three[0], [[0.0, 1.0, 0.0], [-0.5, 0.0, 0.5], [1.0, -2.0, 1.0]])
    five = polynomial_weights(np.arange(-2.0, 3.0)[None], np.ones((1, 5)))
    assert_close("table value", five[0, 1], [-0.2, -0.1, 0.0, 0.1, 0.2])
    two = polynomial_weights(np.array([[-0.5, 1.5]]), np.ones((1, 2)))
    assert_close("table value", two[0], [[0.75, 0.25], [-0.5, 0.5], [0.0, 0.0]])
    four = polynomial_weights(np.array([[-3.0, -1.0, 1.0, 3.0]]), np.ones((1, 4)), 3)
    assert_close("table value", four[0, 0] * 16.0, [-1.0, 9.0, 9.0, -1.0])


def test_a_fix_without_worth_takes_no_part() -> None:
    """Of five fixes one with a variance of 1E12: a parabola through the other four."""
    variance = np.array([[1.0, 1.0, 1e12, 1.0, 1.0]])
    found = polynomial_weights(np.arange(-2.0, 3.0)[None], variance)
    four = polynomial_weights(np.array([[-2.0, -1.0, 1.0, 2.0]]), np.ones((1, 4)))
    assert_close("inverse element", np.delete(found, 2, axis=2), four)


def test_missed_curvature_of_three_fixes() -> None:
    """The kernel of (p(h) - p(-h)) / 2h is (h - |s|)^2 / 4h: its square's integral is h^3 / 40."""
    tau, weight = np.array([[-2.0, 0.0, 2.0]]), np.array([[-0.25, 0.0, 0.25]])
    assert_close("table value", missed_curvature(tau, weight), [8.0 / 40.0])


def test_missed_curvature_by_quadrature() -> None:
    """Fixes at uneven times: Peano's kernel is what a path with one kink of its jerk gives."""
    tau = np.array([-1.3, -0.4, 0.9, 1.1, 2.0])
    weight = polynomial_weights(tau[None], np.array([[1.0, 2.0, 0.5, 1.0, 3.0]]))[:, 1]

    def kernel(s: float) -> float:
        side = np.sign(s)
        beyond = np.maximum(side * (tau - s), 0.0)
        return float((weight[0] * side * beyond**2 / 2.0).sum())

    knots = np.sort(np.append(tau, 0.0))
    pieces = pairwise(knots.tolist())
    expected = sum(quad(lambda s: kernel(s) ** 2, a, b)[0] for a, b in pieces)
    assert_close("inverse element", missed_curvature(tau[None], weight), [expected])


def test_covariances_of_third_differences_an_equal_time_apart() -> None:
    """By binomials: 20, -15, 6, -1 for noise; 66, 26, 1 over 120 for white third derivatives."""
    time_s, sigma = 0.5 * np.arange(9.0), np.full(9, 3.0)
    weight = velocity._third_differences(time_s, sigma)
    assert_close("table value", weight * 3.0, np.tile([-1, 3, -3, 1], (6, 1)) / np.sqrt(20.0))
    by_noise, by_jerk = velocity._covariances(time_s, weight, sigma)
    assert_close("table value", by_noise[:, 0], np.array([20.0, -15.0, 6.0, -1.0]) / 20.0)
    spline = np.array([66.0, 26.0, 1.0, 0.0]) / 120.0
    assert_close("table value", by_jerk[:, 0], spline * 0.5**5 / 20.0 / 9.0)


def test_likelihood_of_third_differences_by_dense_matrices() -> None:
    rng = np.random.default_rng(5)
    time_s, sigma = np.cumsum(rng.uniform(0.2, 2.0, 12)), rng.uniform(0.5, 2.0, 12)
    weight = velocity._third_differences(time_s, sigma)
    by_noise, by_jerk = velocity._covariances(time_s, weight, sigma)
    z = rng.normal(size=9)
    squares, logs = velocity._innovations(z, by_noise, by_jerk)

    def dense(band: Floats) -> Floats:
        low = sum(np.diag(row[: 9 - k], -k) for k, row in enumerate(band))
        return np.asarray(low + np.tril(low, -1).T)

    spread = np.zeros((9, 12))
    for k in range(9):
        spread[k, k : k + 4] = weight[k] * sigma[k : k + 4]
    assert_close("table value", dense(by_noise), spread @ spread.T)
    for k, ratio in enumerate(velocity.RATIOS):
        total = dense(by_noise + ratio * by_jerk)
        likelihood = multivariate_normal(np.zeros(9), total).logpdf(z)
        found = -0.5 * (squares[k] + logs[k]).sum() - 4.5 * np.log(2.0 * np.pi)
        assert abs(found / likelihood - 1.0) < within("inverse element")


@pytest.mark.parametrize(("stated", "found"), [(3.0, 0.1), (0.02, 0.02), (None, 0.1), (0.0, 0.1)])
def test_noise_is_of_the_track_and_never_above_the_stated(
    stated: float | None, found: float
) -> None:
    """Of noise of .1 m stated as 3 m, .02 m or not at all; the path is straight."""
    rng = np.random.default_rng(1)
    time_s = 0.2 * np.arange(400.0)
    position = time_s[:, None] * [10.0, -5.0, 1.0] + rng.normal(0.0, 0.1, (400, 3))
    sigma = None if stated is None else np.full((400, 3), stated)
    rough = roughness(time_s, position, sigma)
    assert np.abs(rough.noise_m / found - 1.0).max() < within("noise of 400 fixes")


def test_noise_keeps_the_proportions_of_the_rows() -> None:
    """Every other fix ten times as noisy, all stated three times too large."""
    rng = np.random.default_rng(2)
    each = np.where(np.arange(400) % 2, 0.02, 0.2)[:, None] * np.ones(3)
    position = np.arange(400.0)[:, None] * [10.0, 0.0, 0.0] + rng.normal(size=(400, 3)) * each
    rough = roughness(np.arange(400.0), position, 3.0 * each)
    assert_close("table value", rough.noise_m[1] * 10.0, rough.noise_m[0])
    assert np.abs(rough.noise_m / each - 1.0).max() < within("noise of 400 fixes")


@pytest.mark.parametrize("apart_s", [1e-6, 1e-9])
def test_two_fixes_of_nearly_one_time(apart_s: float) -> None:
    """Their third differences have no covariance that can be factored; the noise is known."""
    rng = np.random.default_rng(1)
    time_s = np.insert(np.arange(60.0), 31, 30.0 + apart_s)
    position = time_s[:, None] * [10.0, -5.0, 1.0] + rng.normal(0.0, 0.1, (61, 3))
    position[31] = position[30]
    rough = roughness(time_s, position, np.full((61, 3), 0.1))
    assert (rough.jerk > 0.0).all() and (rough.noise_m < 0.11).all()
    assert (rough.noise_m > 0.05).all()
    found = track_velocity(np.array([10.5]), time_s, position, rough)
    assert_close("velocity of noisy fixes", found.velocity_m_s, [[10.0, -5.0, 1.0]])


@pytest.mark.parametrize("fixes", [2, 3])
def test_few_fixes_say_nothing_of_curvature(fixes: int) -> None:
    position = np.arange(fixes)[:, None] * [1.0, 2.0, 3.0]
    rough = roughness(np.arange(float(fixes)), position, np.full((fixes, 3), 0.5))
    assert np.isnan(rough.jerk).all() and (rough.noise_m == 0.5).all()
    found = track_velocity(np.array([0.5]), np.arange(float(fixes)), position, rough)
    assert_close("table value", found.velocity_m_s, [[1.0, 2.0, 3.0]])
    assert np.isnan(found.curvature).all()
    unknown = roughness(np.arange(float(fixes)), position, None)
    found = track_velocity(np.array([0.5]), np.arange(float(fixes)), position, unknown)
    assert_close("table value", found.velocity_m_s, [[1.0, 2.0, 3.0]])
    assert np.isnan(unknown.noise_m).all() and np.isnan(found.noise).all()


def rough_as(fixes: int, noise_m: float, jerk: float) -> Roughness:
    return Roughness(np.full((fixes, 3), noise_m), np.full((fixes, 3), jerk))


def test_velocity_and_acceleration_of_a_parabola_are_exact() -> None:
    time_s = np.array([0.0, 1.0, 1.5, 3.0, 4.0, 6.0])
    position = np.stack([3.0 * time_s - time_s**2, 5.0 + 0.0 * time_s, 0.5 * time_s**2], axis=1)
    at_s = np.array([0.0, 0.7, 3.0, 5.9])
    found = track_velocity(at_s, time_s, position, rough_as(6, 0.1, 1e-6))
    expected = np.stack([3.0 - 2.0 * at_s, 0.0 * at_s, at_s], axis=1)
    assert_close("table value", found.velocity_m_s, expected)
    assert_close("inverse element", found.acceleration_m_s2, np.tile([-2.0, 0.0, 1.0], (4, 1)))


def test_variance_of_nine_fixes() -> None:
    """Slope of nine fixes 1 s apart: sigma^2 over 2 (1 + 4 + 9 + 16), .04 / 60 at the middle."""
    found = track_velocity(np.array([4.0]), np.arange(9.0), np.zeros((9, 3)), rough_as(9, 0.2, 0.0))
    assert found.fixes.tolist() == [9]
    assert_close("table value", found.noise[0], np.full(3, 0.04 / 60.0))


def test_sigmas_of_a_fit_are_north_east_down() -> None:
    """Nine fixes that are .2 m off eastward, .4 m northward and .6 m upward, as above."""
    time_s = np.arange(9.0)
    position = np.tile(earth_centred_m(47.0, 16.0, 500.0), (9, 1))
    rough = Roughness(np.tile([0.2, 0.4, 0.6], (9, 1)), np.zeros((9, 3)))
    at_s = np.array([4.0])
    *_, sigma_m_s = velocity_by_fit(at_s, position[:1], time_s, position, rough, Notes([], {}))
    assert sigma_m_s is not None
    assert_close("table value", sigma_m_s[0], np.array([0.4, 0.2, 0.6]) / np.sqrt(60.0))


def test_slopes_are_sums_over_fixes() -> None:
    """A parabola's are exact, and a fix that is moved moves those of the moments it counts for."""
    time_s = np.array([0.0, 1.0, 1.5, 3.0, 4.0, 6.0])
    position = np.stack([3.0 * time_s - time_s**2, 5.0 + 0.0 * time_s, 0.5 * time_s**2], axis=1)
    at_s, rough = np.array([0.0, 0.7, 3.0, 5.9]), rough_as(6, 0.1, 1e-6)
    found = path_slopes(at_s, time_s, position, rough)
    expected = np.stack([3.0 - 2.0 * at_s, 0.0 * at_s, at_s], axis=1)
    assert_close("table value", found.velocity_m_s, expected)
    assert_close("inverse element", found.acceleration_m_s2, np.tile([-2.0, 0.0, 1.0], (4, 1)))
    for fix in range(6):
        moved = path_slopes(at_s, time_s, position + (np.arange(6) == fix)[:, None], rough)
        slot = fix - found.first
        inside = (slot >= 0) & (slot < found.by_velocity.shape[1])
        rows = np.flatnonzero(inside), slot[inside]
        for name, weight in (("velocity_m_s", found.by_velocity),
                             ("acceleration_m_s2", found.by_acceleration)):  # fmt: skip
            own = np.zeros(4)
            own[inside] = weight[rows]
            away = getattr(moved, name) - getattr(found, name)
            assert_close("inverse element", away, np.tile(own[:, None], (1, 3)))


def test_slopes_miss_less_curvature_than_noise() -> None:
    """At the end of the track a window with the least of both misses about as much as its noise."""
    rng, time_s = np.random.default_rng(7), np.arange(40) / 4.0
    position = np.zeros((40, 3)) + 0.2 * rng.normal(size=(40, 3))
    rough, at_s = rough_as(40, 0.2, 0.5), time_s[:1]
    plain = track_velocity(at_s, time_s, position, rough)
    short = path_slopes(at_s, time_s, position, rough)
    used = np.flatnonzero(short.by_velocity[0])
    missed = missed_curvature(time_s[used][None] - at_s, short.by_velocity[:, used]) * 0.5
    noise = 0.04 * (short.by_velocity**2).sum()
    assert plain.curvature[0, 0] > 0.2 * plain.noise[0, 0]
    assert missed[0] < 0.1 * noise


def test_much_curvature_takes_a_cubic() -> None:
    """A quarter after the second of four: the slope of the cubic through all of them.

    By Lagrange at x = 1/4 from fixes at -1, 0, 1, 2: (-3 x^2 + 6 x - 2) / 6, (3 x^2 - 4 x - 1) / 2,
    (-3 x^2 + 2 x + 2) / 2, (3 x^2 - 1) / 6.
    """
    found = track_velocity(
        np.array([1.25]), np.arange(4.0), np.zeros((4, 3)), rough_as(4, 0.02, 10.0)
    )
    assert found.fixes.tolist() == [4]
    slope = np.array([-0.6875 / 6.0, -1.8125 / 2.0, 2.3125 / 2.0, -0.8125 / 6.0])
    assert_close("table value", found.noise[0], np.full(3, 0.0004 * (slope**2).sum()))


def test_a_cubic_path_is_followed_exactly() -> None:
    time_s = np.cumsum(np.linspace(0.8, 1.2, 20))
    powers = time_s[:, None] ** np.arange(4)
    by = np.array([[0.0, 3.0, 1.0], [10.0, 0.0, 1.0], [0.3, -0.2, 0.1], [0.01, 0.02, -0.03]])
    at_s = np.linspace(time_s[0], time_s[-1], 50)
    rough = roughness(time_s, powers @ by, None)
    found = track_velocity(at_s, time_s, powers @ by, rough)
    expected = by[1] + 2.0 * by[2] * at_s[:, None] + 3.0 * by[3] * at_s[:, None] ** 2
    assert_close("flight speed", found.velocity_m_s, expected)


def test_a_window_ends_at_a_gap_that_the_curvature_does_not_bridge() -> None:
    """Ten fixes, a minute without, ten fixes that begin elsewhere with another velocity."""
    time_s = np.concatenate([np.arange(10.0), 70.0 + np.arange(10.0)])
    position = np.where(time_s[:, None] < 60.0, time_s[:, None] * [5.0, 0.0, 0.0], 0.0)
    position[10:] += (time_s[10:, None] - 70.0) * [0.0, 5.0, 0.0] + [400.0, 90.0, 0.0]
    found = track_velocity(np.array([8.0, 71.0]), time_s, position, rough_as(20, 0.1, 1e-4))
    assert_close("inverse element", found.velocity_m_s, [[5.0, 0.0, 0.0], [0.0, 5.0, 0.0]])
    inside = track_velocity(np.array([40.0]), time_s, position, rough_as(20, 0.1, 1e-4))
    assert inside.curvature.min() > 100.0 * found.curvature.max()


def test_a_manoeuvre_is_not_smoothed_away() -> None:
    """To the side and back by 1.35 m/s within 4 s, 5 fixes a second of .1 m stated as 3 m."""
    rng = np.random.default_rng(3)
    time_s = 0.2 * np.arange(200.0)
    late = np.clip((time_s - 18.0) / 4.0, 0.0, 1.0)
    side = 1.35 * 4.0 * (late / 2.0 - np.sin(2.0 * np.pi * late) / (4.0 * np.pi))
    position = np.stack([10.0 * time_s, side, 0.0 * time_s], axis=1)
    position += rng.normal(0.0, 0.1, position.shape)
    rough = roughness(time_s, position, np.full((200, 3), 3.0))
    found = track_velocity(time_s, time_s, position, rough)
    true = np.stack([0.0 * time_s + 10.0, 1.35 * np.sin(np.pi * late) ** 2, 0.0 * time_s], axis=1)
    off = found.velocity_m_s - true
    plain = np.gradient(position, time_s, axis=0) - true
    assert 3.0 * np.abs(off[:, 1]).max() < np.abs(plain[:, 1]).max()
    assert np.abs(off[90:110, 1]).max() < within("velocity of a manoeuvre")
    assert (np.abs(off) < 1.96 * np.sqrt(found.noise + found.curvature)).mean() > 0.93


def test_curvature_of_gaps_by_hand() -> None:
    """On t^2 four fixes show 2 m/s^2, with noise of .5 m root 3.75; a line none.

    Weights 1, -1, -1, 1 over 2: the noise has 4 x 1/4 of .5^2.
    """
    time_s = np.arange(6.0)
    position = np.stack([time_s**2, 2.0 * time_s, 0.0 * time_s], axis=1)
    found = gap_curvature(time_s, position, rough_as(6, 0.5, 0.0), "linear")
    assert_close("table value", found, np.tile([np.sqrt(4.0 - 0.25), 0.0, 0.0], (5, 1)))
    found = gap_curvature(2.0 * time_s, position, rough_as(6, 0.5, 0.0), "linear")
    assert_close("table value", found[:, 0], np.full(5, np.sqrt(0.25 - 0.25 / 16.0)))


def test_curvature_that_three_fixes_and_two_show() -> None:
    time_s, position = np.arange(3.0), np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [4.0, 0.0, 0.0]])
    rough = roughness(time_s, position, np.full((3, 3), 0.1))
    found = gap_curvature(time_s, position, rough, "linear")
    assert_close("table value", found[:, 0], np.full(2, np.sqrt(4.0 - 6.0 * 0.01)))
    rough = roughness(time_s[:2], position[:2], np.full((2, 3), 0.1))
    assert not gap_curvature(time_s[:2], position[:2], rough, "linear").any()


def test_cubic_interpolation_misses_white_jerk_and_follows_noise() -> None:
    """Four fixes: (9 (1/2 - s)^2 - (3/2 - s)^2) / 32 is the kernel at s from 0 on; and .256 x .25.

    The weights of a spline's middle are .600, .600, -.127, -.127, .034, .034 ...: their squares
    add up to .756, those of a chord's to .5.
    """
    found = gap_curvature(np.arange(4.0), np.zeros((4, 3)), rough_as(4, 0.5, 2.0), "cubic")

    def kernel(s: float) -> float:
        return float((9.0 * max(0.5 - s, 0.0) ** 2 - (1.5 - s) ** 2) / 32.0)

    missed = 2.0 * sum(quad(lambda s: kernel(s) ** 2, *ends)[0] for ends in ((0, 0.5), (0.5, 1.5)))
    expected = 8.0 * np.sqrt(2.0 * missed + 0.256 * 0.25)
    assert_close("table value", found[1], np.full(3, expected))
    spline = CubicSpline(np.arange(40.0), np.eye(40))(19.5)
    assert_close("four decimals", (spline**2).sum() - 0.5, 0.2561)


def test_a_frame_between_fixes_has_a_part_of_the_gap() -> None:
    """A quarter into a gap of 2 s: -3/16 x 4 / 2 of its curvature; at a fix none."""
    fixes = TrackFixes(
        np.array([0, 1, 2]), np.array([[0.75, 0.25], [1.0, 0.0], [1.0, 0.0]]), np.full((3, 3), 0.1)
    )
    curvature = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    found = with_gaps(fixes, np.array([0.0, 2.0, 3.0]), curvature)
    assert found.first.tolist() == [0, 2, 4]
    assert_close("table value", found.weight, [[0.75, -0.375, 0.25], [1, 0, 0], [1, 0, 0]])
    assert_close("table value", found.sigma_m[1::2], curvature)
    assert_close("table value", found.sigma_m[::2], fixes.sigma_m)
    assert found.between is not None and found.between.tolist() == [False, True] * 2 + [False]
    errors = np.arange(15.0).reshape(5, 3)
    moved = found.at_frames(errors[..., None])[..., 0]
    assert_close("table value", moved[0], 0.75 * errors[0] - 0.375 * errors[1] + 0.25 * errors[2])
    assert_close("table value", moved[1:], errors[[2, 4]])


def test_a_cubic_path_between_fixes_is_its_chord_curvature_and_change() -> None:
    """4 t^3 in a gap from 1 to 3 s: at 1.5 s 13.5; its chord 30, its curvature in the middle 48."""
    time_s = np.array([1.0, 3.0])
    off = off_chord(np.array([0.25]), np.diff(time_s))
    assert_close("table value", off, [[-0.375, 0.0625]])
    assert_close("table value", 0.75 * 4.0 + 0.25 * 108.0 + off @ [48.0, 24.0], [13.5])
    time_s = np.arange(6.0)
    position = np.stack([time_s**3, time_s**2, 0.0 * time_s], axis=1)
    found = gap_twist(time_s, position, rough_as(6, 0.5, 0.0))
    assert_close("table value", found, np.tile([np.sqrt(2.0 * (36.0 - 20.0 * 0.25)), 0, 0], (5, 1)))
    assert not gap_twist(time_s[:3], position[:3], rough_as(3, 0.5, 0.0)).any()
    fixes = TrackFixes(np.array([1]), np.array([[0.75, 0.25]]), np.full((3, 3), 0.1))
    shapes = np.ones((2, 3)), np.full((2, 3), 2.0)
    both = with_gaps(fixes, np.array([0.0, 1.0, 3.0]), *shapes)
    assert both.first.tolist() == [3]
    assert_close("table value", both.weight, [[0.75, -0.375, 0.0625, 0.25]])
    assert_close("table value", both.sigma_m[:, 0], [0.1, 1.0, 2.0, 0.1, 1.0, 2.0, 0.1])


PATHS = {  # metres a radian a second, seconds between fixes, sigma, stated sigma
    "straight, RTK": (0.0, 0.0, 0.2, 0.02, 0.02),
    "weaving, RTK": (1.0, 0.5, 0.2, 0.02, 0.02),
    "weaving, once a second": (1.0, 0.5, 1.0, 0.02, 0.02),
    "noise far below the stated": (3.0, 0.3, 1.0, 0.1, 3.0),
    "no sigma": (1.0, 0.5, 0.2, 0.02, 0.0),
}


@pytest.mark.parametrize("name", PATHS)
def test_intervals_of_the_velocity_hold(name: str) -> None:
    """40 tracks of 60 fixes, 20 moments of each; 200 tracks have shares within .006 of theirs.

    Intervals a quarter too narrow fail in three of the five cases (in two with 200 tracks).
    """
    reach, rate, step_s, sigma, stated = PATHS[name]
    rng = np.random.default_rng(4)
    inside = []
    for _ in range(40):
        time_s, phase = step_s * np.arange(60.0), rng.uniform(0.0, 6.3, 3)
        angular = rate * np.array([1.0, 1.3, 0.7])
        position = reach * np.sin(angular * time_s[:, None] + phase)
        position = position + rng.normal(0.0, sigma, position.shape)
        at_s = rng.uniform(0.0, time_s[-1], 20)
        rough = roughness(time_s, position, np.full((60, 3), stated))
        found = track_velocity(at_s, time_s, position, rough)
        off = found.velocity_m_s - reach * angular * np.cos(angular * at_s[:, None] + phase)
        inside.append(np.abs(off) < 1.96 * np.sqrt(found.noise + found.curvature))
    assert 0.93 < np.mean(inside) < 0.99


@pytest.mark.parametrize(("step_s", "reach"), [(0.2, 0.0), (0.2, 1.0), (1.0, 1.0)])
def test_intervals_of_alpha_and_beta_hold(step_s: float, reach: float) -> None:
    """40 flights at 12 m/s, RTK positions of .02 m, the attitude known: 20 frames of each."""
    rng = np.random.default_rng(6)
    inside, off_deg, plain_deg = [], [], []
    for _ in range(40):
        time_s, phase = step_s * np.arange(60.0), rng.uniform(0.0, 6.3, 3)
        angular, along = np.array([0.5, 0.65, 0.35]), np.array([0.0, 12.0, 0.0])  # east, north, up
        at_s = rng.uniform(0.0, time_s[-1], 20)
        position = along * time_s[:, None] + reach * np.sin(angular * time_s[:, None] + phase)
        position += rng.normal(0.0, 0.02, position.shape)
        rough = roughness(time_s, position, np.full((60, 3), 0.02))
        found = track_velocity(at_s, time_s, position, rough)
        true = along + reach * angular * np.cos(angular * at_s[:, None] + phase)
        before = np.searchsorted(time_s, at_s) - 1
        plain = np.diff(position, axis=0)[before] / step_s
        level = np.tile(np.eye(3), (20, 1, 1))  # forward north, right east
        expected, by_fit, by_difference = (
            angles_of_attack(level, one @ NED_FROM_ENU.T, np.zeros((20, 3)))
            for one in (true, found.velocity_m_s, plain)
        )
        variance = (found.noise + found.curvature) @ np.abs(NED_FROM_ENU).T
        sigma = np.degrees(np.sqrt((by_fit.by_velocity**2 * variance[:, None]).sum(axis=2)))
        off = (by_fit.angle_deg - expected.angle_deg)[:, :2]
        inside.append(np.abs(off) < 1.96 * sigma[:, :2])
        off_deg.append(off)
        plain_deg.append((by_difference.angle_deg - expected.angle_deg)[:, :2])
    assert 0.93 < np.mean(inside) < 0.995
    assert 2.0 * np.std(off_deg) < np.std(plain_deg)


@pytest.mark.parametrize("times", [1.0, 3.0])
def test_a_weave_as_wide_as_the_noise_is_hidden_if_it_is_quick(times: float) -> None:
    """20 tracks of 60 fixes, at twelve steps to a period, which is hidden, and at 36, which is not.

    With 200 tracks .36 and .95 of the intervals hold.
    """
    rng, time_s = np.random.default_rng(8), 0.5 * np.arange(60.0)
    inside = []
    for _ in range(20):
        noise = rng.normal(0.0, 0.3, (60, 3))
        amplitude_m, period_s = hidden_weave(
            time_s, roughness(time_s, noise, np.full((60, 3), 0.3))
        )
        assert_close("velocity of noisy fixes", amplitude_m, 0.3)
        assert period_s == 6.0
        angular, phase = 2.0 * np.pi / (times * period_s), rng.uniform(0.0, 6.3, 3)
        position = 0.3 * np.sin(angular * time_s[:, None] + phase) + noise
        at_s = rng.uniform(2.0, 27.5, 20)
        rough = roughness(time_s, position, np.full((60, 3), 0.3))
        found = track_velocity(at_s, time_s, position, rough)
        off = found.velocity_m_s - 0.3 * angular * np.cos(angular * at_s[:, None] + phase)
        inside.append(np.abs(off) < 1.96 * np.sqrt(found.noise + found.curvature))
    assert (np.mean(inside) > 0.9) == (times == 3.0)
