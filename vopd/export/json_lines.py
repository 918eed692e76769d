"""Write JSON Lines: conventions and columns in the first line, then one object for each frame."""

from __future__ import annotations

import json
from collections.abc import Sequence
from io import BytesIO
from math import isfinite
from typing import Any

from numpy.typing import NDArray

from vopd.attitude.history import History
from vopd.attitude.table_columns import MATRICES, columns_of, matrices, row_blocks, table
from vopd.export.file_request import FileRequest, statements
from vopd.findings import Report

TableArrays = dict[str, NDArray[Any]]
"""The columns of a table: names, and as many values each."""

Described = dict[str, dict[str, str]]
"""Unit and meaning of columns, by name."""


def described(histories: Sequence[History]) -> Described:
    """Unit and meaning of every column of the table, and of the matrices, by name."""
    columns = (*columns_of(histories), *MATRICES)
    return {c.name: {"unit": c.unit, "meaning": c.meaning} for c in columns}


def render(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """Make the file: numbers have all their digits; missing and infinite numbers are null.

    A matrix is a list of its rows, and null where the frame has none.

    Args:
        histories: the jobs
        request: has the epoch, if it is to be stated
        report: is not used
    """
    arrays = table(histories) | matrices(histories)
    return json_lines(arrays, statements(histories, request), described(histories))


def json_lines(values: TableArrays, stated: dict[str, str], columns: Described) -> bytes:
    """Make the file of any table.

    Args:
        values: an array for each column
        stated: the conventions
        columns: unit and meaning of each column
    """
    page = BytesIO()
    page.write(_line({"conventions": stated, "columns": columns}))
    for some in row_blocks(values):
        for row in zip(*(column.tolist() for column in some.values()), strict=True):
            page.write(_line(dict(zip(some, map(_known, row), strict=True))))
    return page.getvalue()


def _known(value: Any) -> Any:
    if isinstance(value, list):
        missing = all(number != number for row in value for number in row)
        return None if missing else [[_known(number) for number in row] for row in value]
    return None if isinstance(value, float) and not isfinite(value) else value


def _line(item: dict[str, Any]) -> bytes:
    return (json.dumps(item, ensure_ascii=False, allow_nan=False) + "\n").encode()
