"""MATINV, inverse and solution by Jordan's method (TM X-3050, Appendix C)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vopd.job import Floats, Ints


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
    rows, determ, iscale = reduce(rows, n)
    rows = np.moveaxis(rows, -1, 0).reshape(*stack, n, n + m)
    return Matinv(rows[..., :n], rows[..., n:], determ.reshape(stack), iscale.reshape(stack))


def reduce(rows: Floats, n: int) -> tuple[Floats, Floats, Ints]:
    """MATINV on [A B] with the stack last: `rows` is (n, n + m, k), not to be used after."""
    k = rows.shape[-1]
    used = np.zeros((n, k), bool)
    index = []
    determ, iscale = np.ones(k), np.zeros(k, np.int64)
    alive = np.ones(k, bool)
    for _ in range(n):
        irow, icolum, amax = _pivot(rows[:, :n], used)
        alive &= amax > 0
        used |= np.arange(n)[:, None] == icolum
        index.append((irow, icolum))
        if alive.all():
            rows, pivot = _jordan(rows, irow, icolum)
        else:
            pivot = np.ones(k)
            reduced, pivot[alive] = _jordan(rows[:, :, alive], irow[alive], icolum[alive])
            rows[:, :, alive] = reduced
        determ, iscale = _product(np.where(irow == icolum, determ, -determ), iscale, pivot)
    for irow, icolum in reversed(index):
        rows = _swap(rows, np.where(alive, irow, icolum), icolum, axis=1)
    return rows, np.where(alive, determ, 0.0), np.where(alive, iscale, 0)


def _pivot(a: Floats, used: NDArray[np.bool_]) -> tuple[NDArray[np.intp], ...]:
    """Row, column and size of the largest element in rows and columns not yet used."""
    n, k = used.shape
    size = np.abs(a)
    size[np.isnan(size)] = -1.0
    if used.any():
        size[used[:, None] | used[None]] = -1.0
    size = size.reshape(n * n, k)
    place = size.argmax(axis=0)
    return place // n, place % n, size[place, np.arange(k)]


def _swap(rows: Floats, one: NDArray[np.intp], other: NDArray[np.intp], axis: int) -> Floats:
    """Exchange two rows (axis 0) or columns (axis 1) in place, for each matrix its own two."""
    each = np.flatnonzero(one != other)
    if len(each):
        one, other = one[each], other[each]
        lines = rows if axis == 0 else rows.swapaxes(0, 1)  # a view: `rows` is what changes
        lines[one, :, each], lines[other, :, each] = lines[other, :, each], lines[one, :, each]
    return rows


def _jordan(
    rows: Floats, irow: NDArray[np.intp], icolum: NDArray[np.intp]
) -> tuple[Floats, Floats]:
    """One step: the pivot to the diagonal, its row divided, the other rows reduced."""
    rows = _swap(rows, irow, icolum, axis=0)
    each = np.arange(rows.shape[-1])
    pivot = rows[icolum, icolum, each]
    t = rows[:, icolum, each]
    rows[:, icolum, each] = 0.0
    rows[icolum, icolum, each] = 1.0
    row = rows[icolum, :, each].T / pivot
    rows -= row * t[:, None]
    rows[icolum, :, each] = row.T
    return rows, pivot


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
