"""MATINV, inverse and solution by Jordan's method (TM X-3050, Appendix C)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vopd.job import Bools, Floats, Ints


class Matinv(NamedTuple):
    """What MATINV leaves: in A the inverse, in B the solution, and the determinant.

    The determinant is `determ * 1e100 ** iscale`. For a singular matrix `determ`
    and `iscale` are 0, and `a` and `b` are left as far as they were reduced.
    """

    a: Floats  # (..., n, n)
    b: Floats  # (..., n, m)
    determ: Floats  # (...)
    iscale: Ints  # (...)


def matinv(a: ArrayLike, b: ArrayLike) -> Matinv:
    """Invert `a` (..., n, n) and solve a x = b for `b` (..., n, m), each matrix by itself.

    Complete pivoting: each step takes the largest element left (the first by
    rows on a tie). The arguments are not changed.
    """
    a, b = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    n, m = a.shape[-1], b.shape[-1]
    stack = a.shape[:-2]
    rows = np.concatenate([a, np.broadcast_to(b, (*stack, n, m))], axis=-1)
    rows = np.ascontiguousarray(np.moveaxis(rows.reshape(-1, n, n + m), 0, -1))
    rows, pivots, regular = reduce(rows, n)
    determ, iscale = np.ones(len(regular)), np.zeros(len(regular), np.int64)
    for pivot in pivots:
        determ, iscale = _product(determ, iscale, pivot)
    determ, iscale = np.where(regular, determ, 0.0), np.where(regular, iscale, 0)
    rows = np.moveaxis(rows, -1, 0).reshape(*stack, n, n + m)
    return Matinv(rows[..., :n], rows[..., n:], determ.reshape(stack), iscale.reshape(stack))


def reduce(rows: Floats, n: int) -> tuple[Floats, list[Floats], Bools]:
    """MATINV on [A B] with the stack last: `rows` is (n, n + m, k), not to be used after.

    Returns the rows reduced, the pivots with the determinant's sign (k,), and
    which matrices are not singular (k,).
    """
    k = rows.shape[-1]
    taken = np.zeros((n, n, k), bool)
    places, pivots = [], []
    regular = np.ones(k, bool)
    for step in range(n):
        irow, icolum, amax = _pivot(rows[:, :n], taken if step else None)
        regular &= amax > 0
        places.append((irow, icolum))
        if regular.all():
            pivot = _jordan(rows, irow, icolum)
        else:
            pivot = np.ones(k)
            part = rows[:, :, regular]
            pivot[regular] = _jordan(part, irow[regular], icolum[regular])
            rows[:, :, regular] = part
        pivots.append(np.where(irow == icolum, pivot, -pivot))
        for line in range(n):
            taken[line] |= icolum == line
            taken[:, line] |= icolum == line
    for irow, icolum in reversed(places):
        _swap(rows, np.where(regular, irow, icolum), icolum, axis=1)
    return rows, pivots, regular


def _pivot(a: Floats, taken: Bools | None) -> tuple[NDArray[np.intp], ...]:
    """Row, column and size of the largest element in rows and columns not yet taken."""
    n, k = len(a), a.shape[-1]
    size = np.abs(a)
    if taken is not None:
        size[taken] = -1.0
    place = size.reshape(n * n, k).argmax(axis=0)
    amax = size.reshape(n * n, k)[place, np.arange(k)]
    if np.isnan(amax).any():  # no comparison finds what is not a number
        size[np.isnan(size)] = -1.0
        place = size.reshape(n * n, k).argmax(axis=0)
        amax = size.reshape(n * n, k)[place, np.arange(k)]
    return place // n, place % n, amax


def _swap(rows: Floats, one: NDArray[np.intp], other: NDArray[np.intp], axis: int) -> None:
    """Exchange two rows (axis 0) or columns (axis 1) in place, for each matrix its own two."""
    each = np.flatnonzero(one != other)
    if len(each):
        one, other = one[each], other[each]
        lines = rows if axis == 0 else rows.swapaxes(0, 1)  # a view: `rows` is what changes
        lines[one, :, each], lines[other, :, each] = lines[other, :, each], lines[one, :, each]


def _jordan(rows: Floats, irow: NDArray[np.intp], icolum: NDArray[np.intp]) -> Floats:
    """One step in place: the pivot to the diagonal, its row divided, the other rows reduced."""
    _swap(rows, irow, icolum, axis=0)
    mine = [icolum == line for line in range(len(rows))]
    row, t = rows[0].copy(), rows[:, 0].copy()
    for line in range(1, len(rows)):
        np.copyto(row, rows[line], where=mine[line])
        np.copyto(t, rows[:, line], where=mine[line])
    pivot = t[0].copy()
    for line, here in enumerate(mine):
        np.copyto(pivot, t[line], where=here)
        np.copyto(row[line], 1.0, where=here)
        np.copyto(rows[:, line], 0.0, where=here)
    row /= pivot
    rows -= row * t[:, None]
    for line, here in enumerate(mine):
        np.copyto(rows[line], row, where=here)
    return np.asarray(pivot)


def _product(determ: Floats, iscale: Ints, pivot: Floats) -> tuple[Floats, Ints]:
    """The determinant times a pivot, kept between 1e-100 and 1e100 by counting 1e100s."""
    pivot, first = _scale(pivot, 1e200)  # or the product would overflow
    determ, then = _scale(determ * pivot, 1e100)
    return determ, iscale + first + then


def _scale(number: Floats, limit: float) -> tuple[Floats, Ints | int]:
    size = np.abs(number)
    if ((size < limit) & (size > 1 / limit)).all():
        return number, 0
    shift = np.zeros(number.shape, np.int64)
    for _ in range(3):
        large, small = np.abs(number) >= limit, (np.abs(number) <= 1 / limit) & (number != 0)
        number = np.where(large, number / 1e100, np.where(small, number * 1e100, number))
        shift = shift + large - small
    return number, shift
