"""MATINV: matrix inversion and linear equations by Jordan's method (TM X-3050, Appendix C)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from vopd.arrays import Bools, Floats, Ints

Rows = list[list[Floats]]  # a stack of matrices: rows of elements, each an array over the stack


def matinv(a: ArrayLike, b: ArrayLike) -> tuple[Floats, Floats, Floats, Ints]:
    """Invert matrices and solve a x = b, each matrix by itself.

    It is MATINV as it is called; `vopd` solves its normal equations by `reduce` alone.

    Complete pivoting: each step takes the largest element left (the first by rows on
    a tie). The arguments are not changed.

    Args:
        a: matrices (..., n, n).
        b: right-hand sides (..., n, m).

    Returns:
        A, the inverse (..., n, n); B, the solution (..., n, m); and DETERM and ISCALE (...), by
        which the determinant is `determ * 1e100 ** iscale`. For a singular matrix these two are
        0, and A and B are left as far as they were reduced.

    Source: TM X-3050, Appendix C.
    """
    a, b = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    n, m = a.shape[-1], b.shape[-1]
    stack = a.shape[:-2]
    rows = np.concatenate([a, np.broadcast_to(b, (*stack, n, m))], axis=-1)
    columns = np.ascontiguousarray(np.moveaxis(rows.reshape(-1, n, n + m), 0, -1))
    reduced = [list(row) for row in columns]
    pivots, regular = reduce(reduced, n)
    determ, iscale = np.ones(len(regular)), np.zeros(len(regular), np.int64)
    for pivot in pivots:
        determ, iscale = _product(determ, iscale, pivot)
    determ, iscale = np.where(regular, determ, 0.0), np.where(regular, iscale, 0)
    rows = np.moveaxis(np.array(reduced), -1, 0).reshape(*stack, n, n + m)
    return rows[..., :n], rows[..., n:], determ.reshape(stack), iscale.reshape(stack)


@np.errstate(all="ignore")  # of matrices that are done again
def reduce(rows: Rows, n: int, inverse: bool = True) -> tuple[list[Floats], Bools]:
    """Apply MATINV to a stack of matrices [A B] whose elements are arrays over the stack.

    Most matrices of a film have their pivots at the same rows and columns. So all are
    reduced with the pivots of the first matrix, and those that need other pivots are
    then reduced by themselves.

    Args:
        rows: n lists of n + m arrays (k,); replaced by the reduced ones.
        n: the order of A.
        inverse: whether A is to become the inverse; without it only B counts.

    Returns:
        The pivots with the determinant's sign, n arrays (k,), and which matrices are
        not singular (k,).
    """
    given = [list(row) for row in rows]
    pivots, regular, alike = _as_the_first(rows, n, inverse)
    if not alike.all():
        rest = np.flatnonzero(~alike)
        others = [[element[rest] for element in row] for row in given]
        others_pivots, regular[rest] = reduce(others, n, inverse)
        for mine, theirs in zip([*rows, pivots], [*others, others_pivots], strict=True):
            for column, element in enumerate(theirs):
                mine[column] = mine[column].copy()
                mine[column][rest] = element
    return pivots, regular


def _as_the_first(rows: Rows, n: int, inverse: bool) -> tuple[list[Floats], Bools, Bools]:
    """Reduce all matrices with the pivots of the first one.

    Returns the pivots, which matrices are not singular, and for which these pivots are right.
    """
    k = len(rows[0][0])
    unlike = np.zeros(k, bool)
    free, indices = list(range(n)), []
    pivots = [np.ones(k) for _ in range(n)]
    for step in range(n):
        index = _index_of_pivot(rows, free, unlike)
        if index is None:
            return pivots, np.zeros(k, bool), ~unlike
        irow, icolum = index
        pivots[step] = rows[irow][icolum] if irow == icolum else -rows[irow][icolum]
        _jordan(rows, irow, icolum, free, inverse)
        free.remove(icolum)
        indices.append(index)
    for irow, icolum in reversed(indices):
        for row in rows:
            row[irow], row[icolum] = row[icolum], row[irow]
    return pivots, np.ones(k, bool), ~unlike


def _index_of_pivot(rows: Rows, free: list[int], unlike: Bools) -> tuple[int, int] | None:
    """Find row and column of the first matrix's largest element; the first by rows on a tie.

    None where no element exceeds zero. Matrices for which another element would be the
    pivot are marked as `unlike`. No comparison finds a NaN.
    """
    sizes = {(i, j): np.abs(rows[i][j]) for i in free for j in free}
    largest, index = 0.0, None
    for at, size in sizes.items():
        if size[0] > largest:
            largest, index = size[0], at
    if index is None:
        for size in sizes.values():
            unlike |= size > 0.0
        return None
    chosen = sizes[index]
    unlike |= ~(chosen > 0.0)
    for at, size in sizes.items():
        if at != index:
            unlike |= size >= chosen if at < index else size > chosen
    return index


def _jordan(rows: Rows, irow: int, icolum: int, free: list[int], inverse: bool) -> None:
    """Take one step: move the pivot to the diagonal, divide its row, reduce the other rows.

    Without the inverse only the free columns of A are computed, and B.
    """
    n = len(rows)
    columns = range(n) if inverse else free
    rows[irow], rows[icolum] = rows[icolum], rows[irow]
    row = rows[icolum]
    pivot = row[icolum]
    needed = [*(column for column in columns if column != icolum), *range(n, len(row))]
    for column in needed:
        row[column] = row[column] / pivot
    others = [rows[line] for line in range(n) if line != icolum]
    for other in others:
        for column in needed:
            other[column] = other[column] - row[column] * other[icolum]
    if inverse:
        row[icolum] = 1.0 / pivot
        for other in others:
            other[icolum] = 0.0 - row[icolum] * other[icolum]


def _product(determ: Floats, iscale: Ints, pivot: Floats) -> tuple[Floats, Ints]:
    """Multiply the determinant by a pivot, between 1e-100 and 1e100 by counting 1e100s."""
    pivot, first = _scale(pivot, 1e200)  # or the product would overflow
    determ, then = _scale(determ * pivot, 1e100)
    return determ, iscale + first + then


@np.errstate(over="ignore")  # of the product that is not taken
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
