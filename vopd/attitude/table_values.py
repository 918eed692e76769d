"""The values of the attitude table: an array for each column, for one job or several."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vopd.attitude.history import History
from vopd.attitude.history_parts import HistoryParts
from vopd.attitude.table import MATRICES, TableColumn
from vopd.attitude.table_columns import columns_of
from vopd.attitude.uncertainty import ANGLES

TableArrays = dict[str, NDArray[Any]]
"""The columns of a table: names, and as many values each."""

MAY_BE_INFINITE = "uncertainty."
ROWS_AT_ONCE = 1000


def table_values(columns: Sequence[TableColumn], histories: Sequence[History]) -> TableArrays:
    """The values of columns, one for each frame, one job after the other; NaN where missing.

    Only what belongs to the uncertainty may be infinite: what nothing determines.

    Args:
        columns: of the table
        histories: one or more jobs
    """
    arrays: dict[str, NDArray[Any]] = {}
    table: TableArrays = {}
    for column in columns:
        attribute, indices = column.path
        if attribute not in arrays:
            found = _joined(attribute, len(indices), histories)
            if found.dtype.kind == "f" and not attribute.startswith(MAY_BE_INFINITE):
                found = np.where(np.isfinite(found), found, np.nan)
            arrays[attribute] = found
        values = arrays[attribute]
        for index in indices:
            values = values[..., index]
        table[column.name] = values
    return table


def _joined(attribute: str, axes: int, histories: Sequence[History]) -> NDArray[Any]:
    """An attribute of all jobs, one after the other; NaN for those that do not have it."""
    parts = [_attribute(history, attribute) for history in histories]
    have = [part for part in parts if part is not None]
    if len(have) == len(parts) == 1:
        return have[0]
    shape = have[0].shape[1:] if have else (len(ANGLES),) * axes
    return np.concatenate(
        [
            np.full((len(one.estimate.frame), *shape), np.nan) if part is None else part
            for one, part in zip(histories, parts, strict=True)
        ]
    )


def _attribute(history: History, attribute: str) -> NDArray[Any] | None:
    found: Any = history
    for step in attribute.split("."):
        found = found.get(step) if isinstance(found, dict) else getattr(found, step)
        if found is None:  # a job without what another job of the table has
            return None
    return np.asarray(found)


def table(histories: Sequence[History]) -> TableArrays:
    """The attitude table of all jobs as arrays, one for each column, with one row for each frame.

    Numbers that a frame does not have are NaN; words are arrays of str.

    Args:
        histories: one or more jobs
    """
    return table_values(columns_of(histories), histories)


def table_blocks(
    jobs: Sequence[HistoryParts], columns: Sequence[TableColumn]
) -> Iterator[TableArrays]:
    """The rows of `table`, a block at a time; no more than a part of a job is kept.

    Args:
        jobs: one or more jobs
        columns: their columns
    """
    for job in jobs:
        for part in job:
            yield from row_blocks(table_values(columns, [part]))


def row_blocks(values: TableArrays) -> Iterator[TableArrays]:
    """The columns of a table, `ROWS_AT_ONCE` rows at a time, to be made into text.

    Args:
        values: an array for each column
    """
    rows = len(next(iter(values.values())))
    for first in range(0, rows, ROWS_AT_ONCE):
        yield {name: column[first : first + ROWS_AT_ONCE] for name, column in values.items()}


def matrices(histories: Sequence[History]) -> TableArrays:
    """What the table has of each frame as a matrix: the covariances, (F, 3, 3) each.

    A frame without an attitude has a matrix of NaN. Formats that hold arrays have these
    besides the columns of `table`.

    Args:
        histories: one or more jobs
    """
    return table_values(MATRICES, histories)
