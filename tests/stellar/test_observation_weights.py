"""Weights of residuals and directions: each rule by hand, both sides of each limit."""

from __future__ import annotations

from math import log, sqrt

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.stellar import StarField, church
from vopd.stellar.methods.weights import (
    church_formula_weights,
    direction_weights,
    huber,
    listed,
    ray_partials,
    residual_weights,
    star_weights,
)

FOCAL = np.array([100.0])


def field(used: object = True, errors: object = None) -> StarField:
    images = [[3.0, 4.0], [-60.0, 0.0], [0.0, 80.0], [10.0, -20.0]]
    rays = np.column_stack([images, [-100.0] * 4])
    return StarField.of(rays, images, 100.0, used, errors)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("residual", "weight"),
    [
        (0.0, 0.0), (0.99e-7, 0.0), (1e-7, 3.0), (1.01e-7, 3.0), (0.00099, 3.0), (0.000999, 3.0),
        (0.001001, 0.000009 / 0.001001**2), (0.0012, 6.25), (0.003, 1.0), (0.03, 0.01), (3.0, 1e-6),
    ],
)  # fmt: skip
def test_reswts(residual: float, weight: float) -> None:
    """(.003 / residual)**2, 3 above 9, which is at .001 mm, and 0 below 1E-7 mm; either sign."""
    found = listed(np.array([[residual, -residual], [-residual, 0.0]]))
    assert_close("rae element", found, [[weight, weight], [weight, 0.0]])


def by_hand(lengths: list[float], sigma: float) -> list[float]:
    """Huber's weights: 1 up to two sigmas, from there two sigmas over the length."""
    return [min(1.0, 2.0 * sigma / one) if one else 1.0 for one in lengths]


LENGTHS = [0.01, 0.05, 0.02, 0.5, 0.04]


def residuals(lengths: list[float]) -> np.ndarray:
    """Residuals of these lengths, by 3 and 4 of 5 to either side."""
    signs = np.array([[0.6, -0.8], [-0.8, 0.6], [0.8, 0.6], [-0.6, -0.8], [0.0, 1.0]])
    return np.array(lengths)[:, None] * signs[: len(lengths)]


@pytest.mark.parametrize("sigma", [0.001, 0.01, 0.02, 0.025, 0.1, 1.0])
def test_hubers_weights_with_a_reading_sigma(sigma: float) -> None:
    found = huber(residuals(LENGTHS), np.ones(5, bool), FOCAL, sigma)
    expected = by_hand(LENGTHS, sigma)
    assert_close("rae element", found, np.column_stack([expected, expected]))


@pytest.mark.parametrize(
    ("used", "median"),
    [([1, 1, 1, 1, 1], 0.04), ([1, 1, 1, 1, 0], 0.035), ([1, 1, 1, 0, 0], 0.02),
     ([1, 1, 0, 0, 0], 0.03), ([1, 0, 0, 0, 0], 0.01)],
)  # fmt: skip
def test_hubers_weights_with_the_sigma_of_the_median(used: list[int], median: float) -> None:
    """A plane vector's median is sqrt(2 ln 2) sigmas; 2 n coordinates have 2 n - 3 of freedom."""
    n = sum(used)
    sigma = median / sqrt(2.0 * log(2.0)) * sqrt(2.0 * n / max(2.0 * n - 3.0, 1.0))
    found = huber(residuals(LENGTHS), np.array(used, bool), FOCAL)
    expected = by_hand(LENGTHS, sigma)
    assert_close("rae element", found, np.column_stack([expected, expected]))
    if n == 5:
        assert min(expected) < 0.5 and sorted(expected)[1] == 1.0


def test_rounding_is_not_weighed() -> None:
    """The bend is a billionth of the principal distance at least: 1E-7 of 100 mm."""
    exact = residuals([1e-9, 0.5e-7, 0.99e-7, 2e-7, 0.0])
    found = huber(exact, np.ones(5, bool), FOCAL, 1e-12)[:, 0]
    assert_close("rae element", found, [1.0, 1.0, 1.0, 0.5, 1.0])
    assert (huber(0.0 * exact, np.ones(5, bool), FOCAL) == 1.0).all()


def test_the_three_rules() -> None:
    """A star that is not used has weight 0 by each; the sigma counts for the robust rule alone."""
    off = residuals([0.01, 0.002, 0.02, 0.5])
    one = field([True, True, False, True])
    assert residual_weights("uniform", off, one, 0.01).tolist() == [[1, 1], [1, 1], [0, 0], [1, 1]]
    expected = listed(off)
    expected[2] = 0.0
    assert residual_weights("listed", off, one, 0.01).tolist() == expected.tolist()
    found = residual_weights("robust", off, one, 0.1)
    assert_close("rae element", found, [[1.0, 1.0], [1.0, 1.0], [0.0, 0.0], [0.4, 0.4]])
    median = residual_weights("robust", off, one, None)  # of .002, .01 and .5
    sigma = 0.01 / sqrt(2.0 * log(2.0)) * sqrt(6.0 / 3.0)
    assert_close("rae element", median[3], [4.0 * sigma] * 2)


def cosines(x: float, y: float) -> np.ndarray:
    return np.array([x, y, -100.0]) / sqrt(x * x + y * y + 1e4)


def partials(x: float, y: float) -> np.ndarray:
    """dP, dQ, dR by x and y, (3, 2), by differences of 2E-4 mm."""
    h = 1e-4
    by_x = (cosines(x + h, y) - cosines(x - h, y)) / (2.0 * h)
    by_y = (cosines(x, y + h) - cosines(x, y - h)) / (2.0 * h)
    return np.column_stack([by_x, by_y])


IMAGES = [(3.0, 4.0), (-60.0, 20.0), (10.0, 80.0), (10.0, -20.0)]


def test_formula_weights_are_those_of_the_cosines_variances() -> None:
    """1 / (dP/dx**2 + dP/dy**2) and so on; near the point sigma**2 stands beside r**2."""
    found = church_formula_weights(np.array(IMAGES), FOCAL)
    for k, (x, y) in enumerate(IMAGES):
        expected = 1.0 / (partials(x, y) ** 2).sum(axis=1)
        assert_close("rae weight by differences", found[:, k] / expected, 1.0)
    bounded = church_formula_weights(np.array([[3.0, 4.0], [0.0, 0.0]]), FOCAL, 0.5)
    assert_close("ratio", bounded[:2, 0] / found[:2, 0], 1.0)
    assert_close("ratio", bounded[2, 0] / found[2, 0], 25.0 / 25.25)
    assert_close("rae element", bounded[2, 1] / 4e8, 1.0)  # 100**6 / (100**2 / 4)
    assert np.isinf(church_formula_weights(np.zeros((1, 2)), FOCAL)[2, 0])


COVARIANCES = np.array(
    [[[4.0, 1.0], [1.0, 2.0]], [[1.0, 0.0], [0.0, 9.0]], [[0.25, 0.0], [0.0, 0.25]], [[3.0, -1.0],
     [-1.0, 1.0]]]
)  # fmt: skip


def test_weights_of_stars_with_errors() -> None:
    """The inverse of the mean of the variances of x and y; without errors 1, not used 0."""
    used = np.array([True, True, False, True])
    assert star_weights(field(used)).tolist() == [1.0, 1.0, 0.0, 1.0]
    found = star_weights(field(used, COVARIANCES))
    assert_close("rae element", found, [1.0 / 3.0, 0.2, 0.0, 0.5])
    assert_close("rae element", star_weights(field(True, COVARIANCES))[2], 4.0)


def test_weights_of_directions_with_errors() -> None:
    rays = np.column_stack([IMAGES, [-100.0] * 4])
    used = np.array([True, True, False, True])
    one = StarField.of(rays, IMAGES, 100.0, used, COVARIANCES)
    slopes, weights = ray_partials(one), direction_weights(one, None)
    bounded = direction_weights(one, 0.5)
    for k in (0, 1, 3):
        x, y = IMAGES[k]
        by = partials(x, y)
        assert_close("rae angle", slopes[k], by)
        variance = np.diag(by @ COVARIANCES[k] @ by.T)
        assert_close("rae weight by differences", weights[:, k] * variance, 1.0)
        mean = np.trace(COVARIANCES[k]) / 2.0  # f**2 (mean sigma)**2 / d**6 is added to R's
        more = 100.0**2 * (mean * 0.5) ** 2 / (x * x + y * y + 1e4) ** 3
        assert_close("rae weight by differences", bounded[2, k] * (variance[2] + more), 1.0)
        assert_close("ratio", bounded[:2, k] / weights[:2, k], 1.0)
    assert (slopes[2] == 0.0).all() and np.isinf(weights[:, 2]).all()
    plain = direction_weights(StarField.of(rays, IMAGES, 100.0), 0.5)
    formula = church_formula_weights(np.array(IMAGES), FOCAL, 0.5)
    assert_close("ratio", plain[:2] / formula[:2], 1.0)


@pytest.mark.parametrize("rule", ["uniform", "formula", "formula-r"])
@pytest.mark.parametrize("sigma", [None, 0.5])
def test_church_weighs_stars_and_cosines_by_their_errors(rule: str, sigma: float | None) -> None:
    """Each row of M by numpy: by the mean variance of x and y, or by that of P, Q, R."""
    images = np.array([*IMAGES, (-30.0, -45.0), (50.0, 15.0)])
    errors = np.concatenate([COVARIANCES, COVARIANCES[:2] * 0.3])
    off = np.array([[0.2, -0.1], [0.1, 0.3], [-0.3, 0.1], [0.0, -0.2], [0.2, 0.2], [-0.1, 0.0]])
    stars = np.array([cosines(x, y) for x, y in images])
    read = images + off
    solved = church(StarField.of(stars, read, 100.0, True, errors), weights=rule,
                    reading_sigma_mm=sigma)  # type: ignore[arg-type]  # fmt: skip
    mean = np.trace(errors, axis1=1, axis2=2) / 2.0
    photo = np.array([cosines(x, y) for x, y in read])
    for row in range(3):
        weight = 1.0 / mean
        if rule == "formula" or (rule == "formula-r" and row == 2):
            by = np.array([partials(x, y)[row] for x, y in read])
            variance = np.einsum("ni,nij,nj->n", by, errors, by)
            if row == 2 and sigma is not None:
                square = (read**2).sum(axis=1) + 1e4
                variance += 1e4 * (mean * sigma) ** 2 / square**3
            weight = 1.0 / variance
        root = np.sqrt(weight)
        expected = np.linalg.lstsq(root[:, None] * stars, root * photo[:, row], rcond=None)[0]
        assert_close("rae rotation", solved.matrix[row], expected)
