"""Write JSON Lines: conventions and columns in the first line, then one object for each frame."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from math import isfinite
from typing import Any

from vopd.attitude.history import History
from vopd.attitude.history_parts import HistoryParts
from vopd.attitude.table import MATRICES
from vopd.attitude.table_columns import columns_of
from vopd.attitude.table_values import TableArrays, row_blocks, table_blocks
from vopd.export.file_request import FileRequest, statements
from vopd.findings import Report

Described = dict[str, dict[str, str]]
"""Unit and meaning of columns, by name."""


def described(histories: Sequence[History]) -> Described:
    """Unit and meaning of every column of the table, and of the matrices, by name."""
    columns = (*columns_of(histories), *MATRICES)
    return {c.name: {"unit": c.unit, "meaning": c.meaning} for c in columns}


def pages(jobs: Sequence[HistoryParts], request: FileRequest, report: Report) -> Iterator[bytes]:
    """Make the file page by page, as the parts of the jobs are made.

    Numbers have all their digits; missing and infinite numbers are null. A matrix is a list of
    its rows, and null where the frame has none.

    Args:
        jobs: one or more, of one kind of source
        request: has the epoch, if it is to be stated
        report: is not used
    """
    heads = [job.head for job in jobs]
    columns = columns_of(heads)
    yield _first_line(statements(heads, request), described(heads))
    for values in table_blocks(jobs, (*columns, *MATRICES)):
        yield _rows(values)


def json_lines(values: TableArrays, stated: dict[str, str], columns: Described) -> bytes:
    """Make the file of any table.

    Args:
        values: an array for each column
        stated: the conventions
        columns: unit and meaning of each column
    """
    return _first_line(stated, columns) + b"".join(map(_rows, row_blocks(values)))


def _first_line(stated: dict[str, str], columns: Described) -> bytes:
    return _line({"conventions": stated, "columns": columns})


def _rows(values: TableArrays) -> bytes:
    rows = zip(*(column.tolist() for column in values.values()), strict=True)
    return b"".join(_line(dict(zip(values, map(_known, row), strict=True))) for row in rows)


def _known(value: Any) -> Any:
    if isinstance(value, list):
        missing = all(number != number for row in value for number in row)
        return None if missing else [[_known(number) for number in row] for row in value]
    return None if isinstance(value, float) and not isfinite(value) else value


def _line(item: dict[str, Any]) -> bytes:
    return (json.dumps(item, ensure_ascii=False, allow_nan=False) + "\n").encode()
