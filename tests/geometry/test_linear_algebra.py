"""Stacks of matrices of which some have no inverse: these give NaN and affect no other."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.geometry import linear as linear_algebra
from vopd.geometry.linear import eigenvectors, inverse, pseudo_inverse, singular_values
from vopd.geometry.rotations import nearest_rotation

NAN = np.full((3, 3), np.nan)
GOOD = np.array([[2.0, 1.0, 0.0], [0.0, 3.0, 0.0], [1.0, 0.0, 4.0]])
INVERSE = np.array([[12.0, -4.0, 0.0], [0.0, 8.0, 0.0], [-3.0, 1.0, 6.0]]) / 24.0
FLAT = np.diag([1.0, 2.0, 0.0])


def test_a_singular_matrix_costs_no_other_its_inverse() -> None:
    found = inverse(np.array([GOOD, FLAT, NAN, 2.0 * GOOD]))
    assert_close("table value", found[0], INVERSE)
    assert_close("table value", found[3], INVERSE / 2.0)
    assert np.isnan(found[1:3]).all()
    pairs = inverse(np.array([[GOOD, FLAT], [NAN, GOOD]]))
    assert np.isnan(pairs[0, 1]).all() and np.isnan(pairs[1, 0]).all()
    assert_close("table value", pairs[[0, 1], [0, 1]], [INVERSE, INVERSE])


def test_a_few_singular_matrices_among_many_stay_where_they_are() -> None:
    many = np.tile(GOOD, (25, 40, 1, 1)) * np.arange(1.0, 1001.0).reshape(25, 40, 1, 1)
    flat = ([0, 0, 12, 24], [0, 39, 7, 39])
    many[flat] = FLAT
    found = inverse(many)
    assert np.isnan(found[flat]).all() and np.isnan(found).sum() == 4 * 9
    assert_close("table value", found[12, 8], INVERSE / 489.0)
    assert np.isnan(inverse(FLAT)).all() and inverse(FLAT).shape == (3, 3)


@pytest.mark.parametrize("weak", [1e-3, 1e-8, 1e-12, 0.0])
@pytest.mark.parametrize("shape", ["square", "tall", "wide"])
def test_pseudo_inverses_of_every_shape_near_and_far_from_singular(shape: str, weak: float) -> None:
    """By numpy's singular values; beside a good one and one that is not known."""
    turn, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(5, 5)))
    rows = {"square": 3, "tall": 5, "wide": 3}[shape]
    one = turn[:rows, :3] @ np.diag([1.0, 0.5, weak]) @ turn[:3, :3]
    good = turn[:rows, :3] + 2.0 * np.eye(rows, 3)
    if shape == "wide":
        one, good = one[:2], good[:2]
    found = pseudo_inverse(np.array([good, one, np.full(one.shape, np.nan)]))
    assert_close("inverse element", found[0], np.linalg.pinv(good))
    scale = max(1.0, 1.0 / weak if weak > 1e-14 else 1.0)
    assert_close("condition by turned rays", found[1] / scale, np.linalg.pinv(one) / scale)
    assert np.isnan(found[2]).all()


def test_a_nearly_singular_matrix_is_not_only_inverted() -> None:
    """A singular value of 1E-17 of the largest is none: numpy's limit is 1E-15."""
    found = pseudo_inverse(np.array([np.diag([1.0, 1.0, 1e-17]), np.diag([1.0, 1.0, 1e-7])]))
    assert_close("table value", found[0], np.diag([1.0, 1.0, 0.0]))
    assert_close("table value", found[1] / 1e7, np.diag([1e-7, 1e-7, 1.0]))
    assert_close("table value", pseudo_inverse(FLAT[None])[0], np.diag([1.0, 0.5, 0.0]))
    tall = np.zeros((1, 4, 2))
    tall[0, :2] = np.diag([1.0, 1e-5])  # its normal equations have a condition of 1E10
    assert_close("table value", pseudo_inverse(tall)[0, 1, 1] / 1e5, 1.0)


def test_many_singular_matrices_cost_no_call_each(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sums of one product are singular but for rounding, and numpy finds a zero in part of them."""
    ray = np.random.default_rng(3).normal(size=(2000, 2, 3))
    ray[::5] = 0.0
    stack = ray.swapaxes(1, 2) @ ray
    stack[1::5] += np.eye(3)
    real, calls = np.linalg.inv, list[int]()

    def counted(a: Floats) -> Floats:
        calls.append(1)
        return real(a)

    monkeypatch.setattr(np.linalg, "inv", counted)
    found = inverse(stack)
    assert len(calls) < 10
    each = np.concatenate([inverse(one[None]) for one in stack])
    assert np.array_equal(found, each, equal_nan=True)
    assert np.isnan(found[::5]).all() and np.isfinite(found[1::5]).all()


def test_from_which_condition_on_an_inverse_is_doubted() -> None:
    assert (linear_algebra.FAR_FROM_SINGULAR, linear_algebra.WELL_DETERMINED) == (1e6, 1e4)


def test_singular_values_are_largest_first_with_their_axes_as_rows() -> None:
    sizes, axes = singular_values(np.array([np.diag([1.0, 3.0, 2.0]), NAN, FLAT]))
    assert_close("table value", sizes[[0, 2]], [[3, 2, 1], [2, 1, 0]])
    assert_close("table value", np.abs(axes[0]), [[0, 1, 0], [0, 0, 1], [1, 0, 0]])
    assert np.isnan(sizes[1]).all() and np.isnan(axes[1]).all()
    _, slanted = singular_values(np.array([[0.0, 2.0, 0.0], [0.0, 0.0, 1.0]]))
    assert_close("table value", np.abs(slanted), [[0, 1, 0], [0, 0, 1]])


def test_eigenvectors_are_columns_of_the_smallest_first() -> None:
    found = eigenvectors(np.array([np.diag([5.0, 1.0, 3.0]), NAN]))
    assert_close("table value", np.abs(found[0]), [[0, 0, 1], [1, 0, 0], [0, 1, 0]])
    assert np.isnan(found[1]).all()


def raising(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """numpy's function raises for a stack with a matrix whose first element is 7."""
    real: Callable[..., Floats] = getattr(np.linalg, name)

    def function(a: Floats, **more: bool) -> Floats:
        if (np.asarray(a)[..., 0, 0] == 7.0).any():
            raise np.linalg.LinAlgError("did not converge")
        return real(a, **more)

    monkeypatch.setattr(np.linalg, name, function)


def test_what_does_not_converge_is_nan_and_no_other(monkeypatch: pytest.MonkeyPatch) -> None:
    odd = np.diag([7.0, 1.0, 1.0])
    raising("svd", monkeypatch)
    raising("eigh", monkeypatch)
    for stack in (np.array([FLAT, odd]), np.array([FLAT, odd, NAN])):
        sizes, axes = singular_values(stack)
        assert_close("table value", sizes[0], [2.0, 1.0, 0.0])
        assert np.isnan(sizes[1:]).all() and np.isnan(axes[1:]).all()
        assert np.isnan(eigenvectors(stack)[1:]).all()


def test_the_nearest_rotation_its_sizes_and_what_is_not_known() -> None:
    """A mirror image is no rotation: the third axis is turned over, and its size counts less."""
    rotation, sizes = nearest_rotation(
        np.array([np.diag([3.0, 2.0, 1.0]), np.diag([3.0, 2.0, -1.0]), NAN])
    )
    assert_close("unit rotation", rotation[:2], [np.eye(3)] * 2)
    assert np.isnan(rotation[2]).all()
    assert_close("table value", sizes[:2], [[3.0, 2.0, 1.0], [3.0, 2.0, -1.0]])
    turn = np.array([[0.0, -1.0, 0.0], [0.6, 0.0, -0.8], [0.8, 0.0, 0.6]])
    for sign in (1.0, -1.0):
        rotation, sizes = nearest_rotation(turn @ np.diag([5.0, 4.0, sign]))
        assert_close("unit rotation", rotation, turn)
        assert_close("table value", sizes, [5.0, 4.0, sign])
