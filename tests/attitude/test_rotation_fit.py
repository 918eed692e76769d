"""Fits of rotations, and their linear algebra."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from tests.kit.estimates import FOCAL
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.geometry.linear import eigenvectors, inverse, pseudo_inverse, singular_values
from vopd.geometry.rotation_fit import SETTLED, Sights, closest_axes, fit_rotations

POINTS = np.array([[3.0, 2.0], [-4.0, 1.0], [1.0, -4.0], [2.0, 2.0], [-1.0, 3.0]])
TRIALS = 4


def sights(noise: float = 0.05) -> tuple[Sights, Floats]:
    """Cameras that look anywhere, with noise in the image; and their axes as rows.

    Landmark 2 of trial 1 takes no part: its direction and image are no numbers.
    """
    rng = np.random.default_rng(9)
    axes = Rotation.random(TRIALS, random_state=4).as_matrix()
    rays = np.hstack([POINTS, np.full((5, 1), FOCAL)])
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    direction = rays @ axes
    image = POINTS + rng.normal(0.0, noise, (TRIALS, 5, 2))
    used = np.ones((TRIALS, 5), bool)
    used[1, 2] = False
    direction[1, 2] = image[1, 2] = np.nan
    return Sights(direction, image, used, FOCAL), axes


def residual(turn: Floats, start: Floats, one: Sights, k: int) -> Floats:
    """Measured minus computed, x of every landmark that takes part and then y."""
    here = one.used[k]
    p, q, r = Rotation.from_rotvec(turn).as_matrix() @ start @ one.direction[k, here].T
    image = one.image[k, here]
    return np.concatenate([image[:, 0] - FOCAL * p / r, image[:, 1] - FOCAL * q / r])


def best(one: Sights, start: Floats, k: int) -> Floats:
    """The axes that fit best, by scipy."""
    found = least_squares(residual, np.zeros(3), args=(start, one, k), xtol=1e-15, ftol=1e-15,
                          gtol=1e-15)  # fmt: skip
    return np.asarray(Rotation.from_rotvec(found.x).as_matrix() @ start)


def apart(one: Floats, other: Floats) -> Floats:
    """The angles between axes, radians."""
    return np.array([
        Rotation.from_matrix(a @ b.T).magnitude() for a, b in zip(one, other, strict=True)
    ])  # fmt: skip


@np.errstate(all="ignore")
def test_axes_are_those_of_least_squares() -> None:
    """From starts that are off by more and by less; the starts stay what they were."""
    one, truth = sights()
    off = Rotation.from_rotvec([[0.3, -0.2, 0.4], [0.0, 0.1, 0.0], [-0.3, 0.3, 0.5], [0, 0, 1e-3]])
    start = off.as_matrix() @ truth
    before = start.copy()
    axes, turn = fit_rotations(one, start, 20)
    assert np.array_equal(start, before)
    expected = np.array([best(one, truth[k], k) for k in range(TRIALS)])
    assert_close("fit by scipy", apart(axes, expected), np.zeros(TRIALS))
    eye = axes @ axes.swapaxes(1, 2)
    assert_close("axes after passes", eye, np.tile(np.eye(3), (TRIALS, 1, 1)))
    assert (np.abs(turn).max(axis=1) < SETTLED).all() and SETTLED == 1e-8


@np.errstate(all="ignore")
def test_a_trial_that_settles_earlier_stays_and_the_others_go_on() -> None:
    """One that cannot be solved stays where it is, and is not a number in its turn."""
    one, truth = sights()
    start = truth.copy()
    start[3] = Rotation.from_rotvec([0.3, 0.3, 0.3]).as_matrix() @ truth[3]
    used = one.used.copy()
    used[0] = False
    broken = one._replace(used=used)
    axes, turn = fit_rotations(broken, start, 20)
    assert np.isnan(turn[0]).all() and np.array_equal(axes[0], start[0])
    for k in (1, 2, 3):
        alone = fit_rotations(broken.of(np.arange(TRIALS) == k), start[k : k + 1], 20)
        assert np.array_equal(axes[k], alone[0][0])
        assert np.array_equal(turn[k], alone[1][0])


@np.errstate(all="ignore")
@pytest.mark.parametrize("settled", [1e-1, 1e-3])
def test_passes_end_where_a_turn_is_small_enough(settled: float) -> None:
    one, truth = sights(0.0)
    start = Rotation.from_rotvec([0.02, 0.01, -0.02]).as_matrix() @ truth
    errors = [apart(fit_rotations(one, start, k)[0], truth) for k in range(4)]
    found = apart(fit_rotations(one, start, 20, settled)[0], truth)
    passes = 1 if settled > 0.05 else 2  # turns of .02, then of less than its square
    expected = errors[passes]
    assert_close("fit by scipy", found, expected)
    assert (errors[0] > errors[1]).all() and (errors[1] > errors[2]).all()
    assert np.array_equal(fit_rotations(one, start, 0)[0], start)


def test_the_closest_axes_are_those_of_kabsch() -> None:
    """Unit vectors of the rays, all alike; what takes no part is left out."""
    one, _ = sights(0.3)
    found = closest_axes(one)
    for k in range(TRIALS):
        here = one.used[k]
        rays = np.hstack([one.image[k, here], np.full((here.sum(), 1), FOCAL)])
        rays /= np.linalg.norm(rays, axis=1)[:, None]
        turn, _ = Rotation.align_vectors(rays, one.direction[k, here])
        assert_close("fit by scipy", apart(found[k : k + 1], turn.as_matrix()[None]), [0.0])


# Stacks of matrices in which some have no result: those are NaN and the others are numpy's


GOOD = np.array([[2.0, 1.0, 0.0], [1.0, 3.0, 1.0], [0.0, 1.0, 4.0]])
BAD = [np.full((3, 3), np.nan), np.diag([1.0, np.inf, 1.0]), np.diag([1.0, -np.inf, np.nan])]


@pytest.mark.parametrize("bad", BAD, ids=["nan", "inf", "both"])
def test_what_is_not_finite_costs_no_other(bad: np.ndarray) -> None:
    stack = np.stack([GOOD, bad, 2.0 * GOOD])
    for function in (inverse, pseudo_inverse, eigenvectors):
        found = function(stack)
        np.testing.assert_array_equal(found[0], function(GOOD[None])[0])
        assert np.isnan(found[1]).all() and np.isfinite(found[2]).all()
    sizes, axes = singular_values(stack)
    assert np.isnan(sizes[1]).all() and np.isnan(axes[1]).all()
    np.testing.assert_array_equal(sizes[0], np.linalg.svd(GOOD)[1])


def test_a_singular_matrix_has_no_inverse_and_costs_no_other() -> None:
    found = inverse(np.stack([GOOD, np.ones((3, 3)), np.zeros((3, 3)), np.eye(3)]))
    assert_close("unit element", found[0] @ GOOD, np.eye(3))
    assert np.isnan(found[1:3]).all()
    np.testing.assert_array_equal(found[3], np.eye(3))


def test_what_does_not_converge_costs_no_other(monkeypatch: pytest.MonkeyPatch) -> None:
    """As where LAPACK gives up on one matrix: numpy raises for the whole stack."""
    real = np.linalg.svd

    def gives_up(a: np.ndarray, **options: bool) -> object:
        if (a == 7.0).any():
            raise np.linalg.LinAlgError("SVD did not converge")
        return real(a, **options)

    monkeypatch.setattr(np.linalg, "svd", gives_up)
    tall = np.arange(12.0).reshape(4, 3) + 20.0
    sizes, axes = singular_values(np.stack([tall, np.full((4, 3), 7.0)]))
    np.testing.assert_array_equal(sizes[0], real(tall)[1])
    assert np.isnan(sizes[1]).all() and np.isnan(axes[1]).all()


def test_stacks_of_any_shape() -> None:
    assert pseudo_inverse(np.zeros((2, 5, 4, 3))).shape == (2, 5, 3, 4)
    assert inverse(np.zeros((0, 3, 3))).shape == (0, 3, 3)
    assert np.isnan(inverse(np.zeros((3, 3)))).all()


@pytest.mark.parametrize("size", [1e-160, 1e160])
def test_equations_of_any_size_have_a_pseudo_inverse(size: float) -> None:
    """Their normal equations are out of range, of which nothing is printed."""
    tall = np.array([[3.0, 0.0], [0.0, 2.0], [4.0, 0.0]])
    expected = np.array([[0.12, 0.0, 0.16], [0.0, 0.5, 0.0]])
    with np.errstate(all="raise"):
        found = pseudo_inverse(tall[None] * size)[0]
    assert_close("inverse element", found * size, expected)
