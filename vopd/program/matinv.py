"""MATINV, inverse and solution by Jordan's method (TM X-3050, Appendix C)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from vopd.arrays import Bools, Floats, Ints


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


@np.errstate(all="ignore")  # of matrices that are done again
def reduce(rows: Floats, n: int) -> tuple[Floats, list[Floats], Bools]:
    """MATINV on [A B] with the stack last: `rows` is (n, n + m, k), not to be used after.

    Returns the rows reduced, the pivots with the determinant's sign (k,), and
    which matrices are not singular (k,). Most matrices of a film have their
    pivots in the same places: all are taken as if they had those of the first,
    and those that have not are done again by themselves.
    """
    given = rows.copy()
    pivots, regular, alike = _as_the_first(rows, n)
    rest = np.flatnonzero(~alike)
    if len(rest):
        rows[:, :, rest], others, regular[rest] = reduce(given[:, :, rest], n)
        for pivot, other in zip(pivots, others, strict=True):
            pivot[rest] = other
    return rows, pivots, regular


def _as_the_first(rows: Floats, n: int) -> tuple[list[Floats], Bools, Bools]:
    """Reduce all matrices in place with the pivots' places of the first.

    Returns the pivots, which are not singular, and for which the places are right.
    """
    k = rows.shape[-1]
    alike = np.ones(k, bool)
    free, places = list(range(n)), []
    pivots = [np.ones(k) for _ in range(n)]
    for step in range(n):
        size = np.abs(rows[free][:, free] if step else rows[:, :n]).reshape(-1, k)
        amax = _largest(size)
        if not amax[0] > 0.0:
            return pivots, np.zeros(k, bool), alike & ~(amax > 0.0)
        at = int((size[:, 0] == amax[0]).argmax())
        alike &= (size[at] == amax) & (amax > 0.0)
        if at:  # the first by rows on a tie
            alike &= ~(size[:at] >= amax).any(axis=0)
        irow, icolum = (free[line] for line in divmod(at, len(free)))
        pivot = _jordan(rows, irow, icolum)
        pivots[step] = pivot if irow == icolum else -pivot
        free.remove(icolum)
        places.append((irow, icolum))
    for irow, icolum in reversed(places):
        if irow != icolum:
            rows[:, [irow, icolum]] = rows[:, [icolum, irow]]
    return pivots, np.ones(k, bool), alike


def _largest(size: Floats) -> Floats:
    """The largest of each column; no comparison finds what is not a number."""
    if len(size) == 1:
        return np.asarray(size[0])
    largest = size.max(axis=0)
    return np.asarray(np.fmax.reduce(size) if np.isnan(largest).any() else largest)


def _jordan(rows: Floats, irow: int, icolum: int) -> Floats:
    """One step in place: the pivot to the diagonal, its row divided, the other rows reduced."""
    if irow != icolum:
        rows[[irow, icolum]] = rows[[icolum, irow]]
    row = rows[icolum]
    pivot: Floats = row[icolum].copy()
    row[icolum] = 1.0
    row /= pivot
    for line in range(len(rows)):
        if line != icolum:
            t = rows[line, icolum].copy()
            rows[line, icolum] = 0.0
            rows[line] -= row * t
    return pivot


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
