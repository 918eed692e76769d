"""MATINV against hand work and numpy.linalg (Appendix C)."""

from __future__ import annotations

from itertools import product
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from tests.tolerances import assert_close
from vopd.program.matinv import matinv


class Inverted(NamedTuple):
    """What MATINV leaves in its arguments."""

    a: Any
    b: Any
    determ: Any
    iscale: Any


def inverted(a: Any, b: Any) -> Inverted:
    return Inverted(*matinv(a, b))


ELEMENTS = st.integers(-9, 9).map(float)


def test_two_by_two() -> None:
    """Determinant 4*6 - 7*2 = 10; inverse (6 -7, -2 4)/10; solution of (1, 5): (-2.9, 1.8)."""
    done = inverted([[4.0, 7.0], [2.0, 6.0]], [[1.0], [5.0]])
    assert_close("inverse element", done.a, [[0.6, -0.7], [-0.2, 0.4]])
    assert_close("inverse element", done.b, [[-2.9], [1.8]])
    assert_close("inverse element", done.determ, 10.0)
    assert done.iscale == 0


def test_exchanges_are_undone() -> None:
    """A cyclic permutation: every pivot is off the diagonal; two exchanges, determinant +1."""
    a = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    done = inverted(a, np.eye(3) * 2)
    np.testing.assert_array_equal(done.a, a.T)
    np.testing.assert_array_equal(done.b, a.T * 2)
    assert done.determ == 1.0
    assert inverted(a[[1, 0, 2]], np.eye(3)).determ == -1.0


def test_pivoting_is_complete() -> None:
    """The pivot is 1E17, not the first column's 1.

    Row 1 over 1E17: (1E-17, 1 | 1). Row 2 less that: (1, 0 | 2 - 1). So x1 = 1
    and x2 = 1 - 1E-17 = 1. A pivot from the first column leaves x1 = 1E17 -
    1E17*1 = 0, because 1 - 1E17 rounds to -1E17.
    """
    done = inverted([[1.0, 1e17], [1.0, 1.0]], [[1e17], [2.0]])
    np.testing.assert_array_equal(done.b, [[1.0], [1.0]])


def test_singular_is_left_partly_reduced() -> None:
    """Pivot 6, in row 1, column 2: the rows change places, (1 2 | 6) over (3 6 | 1).

    Row 2 over 6: (3/6, 1/6 | 1/6). Row 1 less twice that: (1 - 1, -2/6 | 6 - 2/6).
    What is left to choose from is 0, and there it stops; the columns stay.
    """
    done = inverted([[3.0, 6.0], [1.0, 2.0]], [[1.0], [6.0]])
    assert done.determ == 0
    assert done.iscale == 0
    assert_close("inverse element", done.a, [[0.0, -1 / 3], [0.5, 1 / 6]])
    assert_close("inverse element", done.b, [[17 / 3], [1 / 6]])


def test_nothing_to_pivot_on() -> None:
    done = inverted(np.zeros((3, 3)), [[1.0], [2.0], [3.0]])
    assert (done.determ, done.iscale) == (0, 0)
    np.testing.assert_array_equal(done.a, np.zeros((3, 3)))
    np.testing.assert_array_equal(done.b, [[1.0], [2.0], [3.0]])


def test_the_first_of_equals_by_rows() -> None:
    """Of four elements of size 1 the first is the pivot: row 2 becomes (-1, 0), and it stops.

    Row 1 over 1: (1, 1 | 4). Row 2 less once that: (0 - 1, 0 | 9 - 4). The second
    would be seen in row 1: 0, -1.
    """
    done = inverted([[1.0, 1.0], [1.0, 1.0]], [[4.0], [9.0]])
    np.testing.assert_array_equal(done.a, [[1.0, 1.0], [-1.0, 0.0]])
    np.testing.assert_array_equal(done.b, [[4.0], [5.0]])


def test_no_comparison_finds_what_is_no_number() -> None:
    """Pivot 2; row 2 becomes (0, .5 | 3). Then only the NaN is left, and it stops."""
    done = inverted([[np.nan, 0.0], [0.0, 2.0]], [[5.0], [6.0]])
    assert done.determ == 0
    np.testing.assert_array_equal(done.a, [[np.nan, 0.0], [0.0, 0.5]])
    np.testing.assert_array_equal(done.b, [[5.0], [3.0]])


@pytest.mark.parametrize(
    ("diagonal", "determ", "iscale"),
    [
        ((1e60, 1e60), 1e20, 1),  # 1E120
        ((1e-60, 1e-60), 1e-20, -1),
        ((1e100, 1.0), 1.0, 1),  # 1E100 is too large already
        ((1e-100, 1.0), 1.0, -1),
        ((-1e99, 1.0), -1e99, 0),
        ((1e60, 1e60, 1e-60), 1e-40, 1),  # 1E20*1E100, and then nothing asks to scale back
        ((1e90, 1e90, 1e90), 1e70, 2),  # 1E180, 1E270
        ((1e150, 1e-120), 1e-70, 1),  # the second pivot itself is not scaled
        ((1e308, 1.0), 1e8, 3),  # twice by the pivot, and once more by the product
        ((-1e-308, 1.0), -1e-8, -3),
        ((1e260, 1e260), 1e20, 5),
        ((1e-260, 1e-260), 1e-20, -5),
    ],
)
def test_determinant_with_scale(diagonal: tuple[float, ...], determ: float, iscale: int) -> None:
    done = inverted(np.diag(diagonal), np.ones((len(diagonal), 1)))
    assert done.iscale == iscale
    assert_close("unit element", done.determ / determ, 1.0)


@pytest.mark.parametrize("size", [np.nextafter(1e200, 0.0), np.nextafter(1e-200, 1.0)])
def test_a_determinant_stays_within_its_bounds(size: float) -> None:
    """A product that rounds to a bound is scaled once more."""
    done = inverted(np.diag([size, size]), np.ones((2, 1)))
    assert 1e-100 < done.determ < 1e100
    assert_close("unit element", np.log10(done.determ) + 100.0 * done.iscale, 2 * np.log10(size))


@pytest.mark.parametrize("pivot", [1e120, 1e-120, 7.0])
def test_a_singular_matrix_has_no_scale(pivot: float) -> None:
    """However large the pivots before it stopped were; and the others of a stack have theirs."""
    done = inverted([np.diag([pivot, 0.0]), np.diag([pivot, pivot])], np.ones((2, 2, 1)))
    assert done.determ[0] == 0.0 and done.iscale.tolist()[0] == 0
    assert_close("unit element", done.determ[1] * 1e100 ** done.iscale[1] / pivot**2, 1.0)


def test_no_zero_of_an_inverse_has_a_sign() -> None:
    """0 - 0*T is +0 (Appendix C); only a product below zero that vanishes leaves -0."""
    for matrix in (np.diag([2.0, 4.0, 8.0]), np.diag([2.0, -4.0, 8.0]), np.eye(3)[[1, 0, 2]]):
        done = inverted(matrix, np.eye(3))
        assert not np.signbit(done.a[done.a == 0.0]).any()


@given(arrays(float, (4, 4), elements=ELEMENTS), arrays(float, (4, 2), elements=ELEMENTS))
def test_against_linalg(a: np.ndarray, b: np.ndarray) -> None:
    assume(np.linalg.matrix_rank(a) == 4 and np.linalg.cond(a) < 1e3)
    done = inverted(a, b)
    assert_close("inverse element", done.a, np.linalg.inv(a))
    assert_close("inverse element", done.b, np.linalg.solve(a, b))
    assert_close("determinant", done.determ, np.linalg.det(a))
    assert done.iscale == 0


def test_no_right_hand_side() -> None:
    """M = 0 is inversion alone."""
    done = inverted([[2.0, 0.0], [0.0, 4.0]], np.zeros((2, 0)))
    assert done.b.shape == (2, 0)
    np.testing.assert_array_equal(done.a, [[0.5, 0.0], [0.0, 0.25]])


SCALES = st.sampled_from([0.0, 1e-70, 1.0, 3.0, 1e70])


@given(st.integers(1, 6), st.data())
def test_a_stack_is_its_elements(size: int, data: st.DataObject) -> None:
    """Singular ones, large determinants and NaN among them; bit for bit."""
    elements = st.one_of(ELEMENTS, SCALES, st.just(np.nan))
    a = data.draw(arrays(float, (2, size, 3, 3), elements=elements))
    b = data.draw(arrays(float, (2, size, 3, 2), elements=ELEMENTS))
    before = a.tobytes(), b.tobytes()
    with np.errstate(all="ignore"):
        whole = inverted(a, b)
        assert (a.tobytes(), b.tobytes()) == before
        for place in np.ndindex(2, size):
            alone = inverted(a[place], b[place])
            for ours, theirs in zip(whole, alone, strict=True):
                np.testing.assert_array_equal(ours[place], theirs, strict=True)


def test_singular_gives_zero() -> None:
    """All matrices of -1, 0, 1: pivots of 1 and 2 leave exact halves."""
    a = np.array(list(product((-1.0, 0.0, 1.0), repeat=9))).reshape(-1, 3, 3)
    by_columns = np.einsum("fi,fi->f", a[:, 0], np.cross(a[:, 1], a[:, 2]))
    np.testing.assert_array_equal(inverted(a, np.zeros((3, 1))).determ, by_columns)
