"""Stacks of matrices in which some have no result: those are NaN and the others are numpy's."""

from __future__ import annotations

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.geometry.linear import eigenvectors, inverse, pseudo_inverse, singular_values

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
