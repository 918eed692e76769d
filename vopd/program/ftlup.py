"""FTLUP, table look-up (TM X-3050, Appendix D)."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from vopd.arrays import Bools, Floats, Ints
from vopd.findings import VopdError

TableName = tuple[int, str]
"""A table in messages: the group of its cards, and what it is looked up by, such as 'times'."""


class TableOutOfOrder(VopdError):
    """The table of an FTLUP call is not in order; the original prints it and stops.

    `position` counts from 1; `vari` and `vard` are the table as FTLUP was given it.
    """

    def __init__(
        self, position: int, vari: Floats, vard: Floats, table: TableName | None = None
    ) -> None:
        super().__init__(f"table out of order for FTLUP at position {position}")
        self.position = position
        self.vari = vari
        self.vard = vard
        self.table = table


class TableNotANumber(VopdError):
    """The table of an FTLUP call holds a NaN.

    Cards cannot hold one, but arrays that a caller passes can.
    """

    def __init__(self, position: int, table: TableName | None) -> None:
        name = "a table" if table is None else f"the table of {table[1]} (group {table[0]})"
        super().__init__(f"{name} holds NaN at position {position}")
        self.position = position
        self.table = table


def ftlup(x: ArrayLike, vari: ArrayLike, vard: ArrayLike, table: TableName | None = None) -> Floats:
    """Interpolate in a table; outside the table, extrapolate from its first or last interval.

    That is FTLUP with M = 1, as the program calls it everywhere.

    Args:
        x: where to interpolate, any shape.
        vari: the table's independent variable, strictly increasing (n,); with one point, y is
            `vard[0]`.
        vard: its dependent variable (n,), or (n, k) for k tables at once.
        table: what an error calls the table.

    Returns:
        y, in the shape of `x`, then k.

    Raises:
        TableOutOfOrder: if the table is neither of length 1 nor in order.
        TableNotANumber: if the table holds a NaN anywhere.

    Source: TM X-3050, Appendix D.
    """
    x, vari, vard = (np.asarray(a, dtype=np.float64) for a in (x, vari, vard))
    y = ftlup_each(x.ravel(), np.zeros(x.size, np.int64), Tables.of(table, [(vari, vard)]))
    return y.reshape(x.shape + vard.shape[1:])


class Tables(NamedTuple):
    """The tables of several jobs that are looked up by the same variable, one after the other."""

    name: TableName | None
    size: Ints  # (T,) points of each table, one or more
    vari: Floats  # (n,) the independent variable of all of them
    vard: Floats  # (n,) the dependent one, or (n, k)

    @staticmethod
    def of(name: TableName | None, tables: Iterable[tuple[Floats | Ints, Floats]]) -> Tables:
        """Put the tables of some jobs one after the other.

        Args:
            name: what an error calls them.
            tables: of each job its independent and its dependent variable.
        """
        vari, vard = zip(*tables, strict=True)
        size = np.array([len(one) for one in vari])
        return Tables(name, size, np.concatenate(vari).astype(np.float64), np.concatenate(vard))

    @property
    def first(self) -> Ints:
        """Index of the first point of each table (T,)."""
        return np.asarray(np.cumsum(self.size) - self.size)

    def refused(self) -> Bools:
        """Mark tables (T,) that are out of order or hold a NaN, which FTLUP does not take."""
        first = self.first
        bad = np.isnan(self.vari) | np.isnan(self.vard).reshape(len(self.vari), -1).any(axis=1)
        falls = ~(np.diff(self.vari) > 0)
        falls[first[1:] - 1] = False  # from one table to the next
        bad[1:] |= falls
        return np.logical_or.reduceat(bad, first)


def ftlup_each(x: Floats, which: Ints, tables: Tables) -> Floats:
    """Interpolate in several tables at once, to first order, as `ftlup` does in each.

    Args:
        x: where to interpolate (F, ...).
        which: the index of the table of each row of `x`, in ascending order (F,).
        tables: the tables.

    Returns:
        y, in the shape of `x`, then k.

    Raises:
        TableOutOfOrder: if the first table that is not right is not in order.
        TableNotANumber: if it holds a NaN.
    """
    size, first, vari, vard = tables.size, tables.first, tables.vari, tables.vard
    refused = tables.refused()
    if refused.any():
        own = slice(first[k := int(refused.argmax())], first[k] + size[k])
        _check_numbers(vari[own], vard[own], tables.name)
        check_order(vari[own], vard[own] if vard.ndim == 1 else vard[own, 0], tables.name)
    ends = np.searchsorted(which, np.arange(len(size) + 1)).tolist()
    rows = [slice(*some) for some in pairwise(ends)]
    points = zip(rows, first.tolist(), (first + size).tolist(), strict=True)
    parts = [np.searchsorted(vari[a:b], x[some], side="right") for some, a, b in points]
    each = which.reshape(-1, *(1,) * (x.ndim - 1))
    i = first[each] + np.clip(np.concatenate(parts) - 1, 0, np.maximum(size - 2, 0)[each])
    xs = x.reshape(x.shape + (1,) * (vard.ndim - 1))
    several = size > 1
    if several.all():
        return _line(xs, i, i + 1, vari, vard)
    with np.errstate(invalid="ignore"):  # nothing lies between a single point and itself
        y = _line(xs, i, i + several[each], vari, vard)
    return np.where(_at(several, each, y), y, vard[i])


def outside(x: Floats, which: Ints, tables: Tables) -> Bools:
    """Mark values outside their table, where FTLUP extrapolates; a single point has no outside.

    Args:
        x: values (F,).
        which: the index of the table of each (F,).
        tables: the tables.
    """
    first = tables.first
    least, most = tables.vari[first], tables.vari[first + tables.size - 1]
    beyond: Bools = (x < least[which]) | (x > most[which])
    return np.asarray(beyond & (tables.size > 1)[which])


def check_order(vari: Floats, vard: Floats, table: TableName | None = None) -> None:
    """Raise `TableOutOfOrder` at the first pair of points that is not in order.

    Args:
        vari: the table's independent variable (n,), which must increase.
        vard: its dependent variable (n,), for the error.
        table: what the error calls the table.

    Raises:
        TableOutOfOrder: at a point that is not beyond the one before it.
    """
    in_order = np.diff(vari) > 0
    if not in_order.all():
        raise TableOutOfOrder(int(in_order.argmin()) + 2, vari, vard, table)


def _check_numbers(vari: Floats, vard: Floats, table: TableName | None) -> None:
    """Raise `TableNotANumber` at the first point of a table that holds a NaN."""
    missing = np.isnan(vari) | np.isnan(vard).reshape(len(vari), -1).any(axis=1)
    if missing.any():
        raise TableNotANumber(int(missing.argmax()) + 1, table)


def _at(values: Floats | Bools, i: np.ndarray, x: Floats) -> Any:
    """Take the table's values at rows `i`, with axes added to match `x`."""
    return np.reshape(values[i], i.shape + (1,) * (x.ndim - i.ndim))


def _line(x: Floats, i: np.ndarray, j: np.ndarray, vari: Floats, vard: Floats) -> Floats:
    """Evaluate the straight line through points `i` and `j` at `x`."""
    x1, x2 = _at(vari, i, x), _at(vari, j, x)
    y1, y2 = vard[i], vard[j]
    y: Floats = y1 + (x - x1) * (y2 - y1) / (x2 - x1)
    return y
