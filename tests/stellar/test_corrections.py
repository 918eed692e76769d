"""Differential corrections and weights, against program STARS and the report's equations."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.kit import rae_listings as listings
from tests.tolerances import assert_close, within
from vopd.stellar import StarField, church, collinearity, orientation_matrix
from vopd.stellar.methods.weights import church_formula_weights as formula_weights
from vopd.stellar.methods.weights import huber, listed
from vopd.stellar.tables_1987 import DIRECTIONS, PERTURBED_MM, sample_field

STARS = [tuple(u) for u in DIRECTIONS.tolist()]
IMAGES = [tuple(xy) for xy in PERTURBED_MM.tolist()]
START = (150.0, -15.0, 50.0)


@pytest.mark.parametrize("rule", ["uniform", "listed"])
@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_each_correction_is_that_of_stars(rule: str, count: int) -> None:
    """PARSHL's partials by the angles, RESWTS's weights, INV3X3."""
    theirs = listings.stars_corrections(START, STARS, IMAGES, 76.0, count, rule == "listed")
    mine = collinearity(
        sample_field(),
        initial_deg=START,
        corrections=count,
        weights=rule,  # type: ignore[arg-type]
    )
    assert mine.iterations == count
    turned = orientation_matrix(np.array(theirs))  # angles may differ by whole turns
    assert np.abs(mine.matrix - turned).max() < within("rae rotation")


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_no_other_attitude_has_less_squares(axis: int) -> None:
    best = tuple(collinearity(sample_field()).omega_phi_kappa_deg.tolist())
    least = listings.sum_of_squares(best, STARS, IMAGES, 76.0)
    for step in (-1e-3, 1e-3):
        moved = [angle + step * (k == axis) for k, angle in enumerate(best)]
        assert listings.sum_of_squares(tuple(moved), STARS, IMAGES, 76.0) > least


@given(st.tuples(st.floats(-179, 179), st.floats(-80, 80), st.floats(-179, 179)))
def test_the_start_does_not_change_where_it_ends(start: tuple[float, float, float]) -> None:
    """A start either leads to the one attitude in front of the camera, or is reported."""
    solution = collinearity(sample_field(), initial_deg=start)
    if solution.converged:
        truth = [156.1262074559, -18.7687854195, 46.0656513621]  # the source notes
        assert_close("rae printed angle", solution.omega_phi_kappa_deg, truth)
    else:
        assert solution.failure != 0


@pytest.mark.parametrize(
    "size", [0.0, 0.9999e-7, 1.0001e-7, 1e-4, 0.9999e-3, 1.0001e-3, 0.003, 0.1, 5.0]
)
def test_listed_weights_are_those_of_reswts(size: float) -> None:
    for residual in (size, -size):
        weight = listed(np.array([[residual, 1.0]]))[0, 0]
        assert abs(weight - listings.reswts(residual)) < within("table value")


@given(st.lists(st.floats(1e-9, 1e3), min_size=2, max_size=20), st.floats(1e-4, 10.0))
def test_robust_weights_are_bounded_and_never_rise(sizes: list[float], sigma: float) -> None:
    length = np.sort(sizes)
    residual = np.column_stack([0.6 * length, -0.8 * length])
    for scale in (sigma, None):
        weight = huber(residual, np.ones(len(length), bool), np.array([76.0]), scale)[:, 0]
        assert (weight > 0.0).all() and (weight <= 1.0).all()
        assert (np.diff(weight) <= 0.0).all()
    assert (weight[length < 1e-9 * 76.0] == 1.0).all()


def test_robust_weights_bend_at_two_sigmas() -> None:
    """.05 mm is five sigmas of .01, 2.5 bends: weight .4."""
    residual = np.array([[0.03, 0.04], [0.012, 0.016], [0.0, 0.01]])
    weight = huber(residual, np.ones(3, bool), np.array([76.0]), 0.01)
    assert np.abs(weight - [[0.4, 0.4], [1.0, 1.0], [1.0, 1.0]]).max() < within("table value")


@pytest.mark.parametrize(
    ("corner", "printed"), [((12.0, 16.0), (6468, 6714)), ((16.0, 12.0), (6714, 6468))]
)
def test_formula_weights_have_the_numbers_of_eq_3_20(
    corner: tuple[float, float], printed: tuple[int, int]
) -> None:
    """wP and wQ at the corner of 24 x 32 mm (6714 is cut, not rounded); f squared at the centre."""
    w = formula_weights(np.array([corner, (0.0, 0.0)]), np.array([76.0]))
    assert np.abs(w[:2, 0] - printed).max() < within("rae weight")
    assert np.abs(w[:2, 1] - 5776.0).max() < within("rae rotation")


def test_the_text_s_frame_has_other_ratios() -> None:
    """24 x 36 mm: 1.131 and 1.201 (the source notes)."""
    w = formula_weights(np.array([[12.0, 18.0], [0.0, 0.0]]), np.array([76.0]))
    assert [f"{ratio:.3f}" for ratio in w[:2, 0] / w[:2, 1]] == ["1.131", "1.201"]


def test_formula_weight_of_the_third_cosine() -> None:
    """Eq. 3.20: 36.5 between 3 and 20 mm; infinite at 0; a reading sigma bounds it by f**4/s**2."""
    images = np.array([[3.0, 0.0], [0.0, 20.0], [0.0, 0.0]])
    w = formula_weights(images, np.array([76.0]))[2]
    assert (round(float(w[0])), round(float(w[1]))) == (3724263, 101961) and np.isinf(w[2])
    bounded = formula_weights(images, np.array([76.0]), 0.01)[2, 2]
    assert_close("ratio", bounded / (76.0**4 / 0.01**2), 1.0)


def test_formula_weights_are_inverse_variances() -> None:
    """Of P, Q, R under equal errors of x and y, by differences of the unit vector itself."""
    x, y, f, step = 17.0, -9.0, 76.0, 1e-4

    def ray(a: float, b: float) -> np.ndarray:
        return np.array([a, b, -f]) / np.sqrt(a * a + b * b + f * f)

    by_x = (ray(x + step, y) - ray(x - step, y)) / (2 * step)
    by_y = (ray(x, y + step) - ray(x, y - step)) / (2 * step)
    expected = 1.0 / (by_x**2 + by_y**2)
    w = formula_weights(np.array([[x, y]]), np.array([f]))[:, 0]
    assert_close("rae weight by differences", w / expected, 1.0)


def test_church_weighted_is_the_weighted_normal_equations() -> None:
    """Each row of M by itself, with the weights of the equations written out."""
    f2 = 76.0**2
    x2, y2 = PERTURBED_MM[:, 0] ** 2, PERTURBED_MM[:, 1] ** 2
    cube = (x2 + y2 + f2) ** 3
    rows: list[Callable[[], np.ndarray]] = [
        lambda: cube / ((y2 + f2) ** 2 + x2 * y2),
        lambda: cube / ((x2 + f2) ** 2 + x2 * y2),
        lambda: cube / (f2 * (x2 + y2)),
    ]
    rays = np.column_stack([PERTURBED_MM, np.full(4, -76.0)])
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    u = DIRECTIONS
    expected = [
        np.linalg.solve(u.T @ (w()[:, None] * u), u.T @ (w() * rays[:, k]))
        for k, w in enumerate(rows)
    ]
    field = StarField.of(u, PERTURBED_MM, 76.0)
    mine = church(field, weights="formula").matrix
    assert np.abs(mine - expected).max() < within("rae rotation")
    alone = church(field, weights="formula-r").matrix  # wR alone: the first two rows as they were
    assert np.abs(alone[:2] - church(field).matrix[:2]).max() < within("rae rotation")
    assert np.abs(alone[2] - expected[2]).max() < within("rae rotation")
