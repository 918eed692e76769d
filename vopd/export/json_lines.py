"""Write JSON Lines: conventions and columns in the first line, then one object for each frame."""

from __future__ import annotations

import json
from collections.abc import Sequence
from math import isfinite
from typing import Any

from vopd.attitude.history import History
from vopd.attitude.table_columns import MATRICES, columns_of, matrices, table
from vopd.export.file_request import FileRequest, statements
from vopd.findings import Report


def described(histories: Sequence[History]) -> dict[str, dict[str, str]]:
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
    values = {name: column.tolist() for name, column in arrays.items()}
    head = {"conventions": statements(histories, request), "columns": described(histories)}
    lines = [_line(head)]
    for row in zip(*values.values(), strict=True):
        lines.append(_line(dict(zip(values, map(_known, row), strict=True))))
    return "".join(lines).encode()


def _known(value: Any) -> Any:
    if isinstance(value, list):
        missing = all(number != number for row in value for number in row)
        return None if missing else [[_known(number) for number in row] for row in value]
    return None if isinstance(value, float) and not isfinite(value) else value


def _line(item: dict[str, Any]) -> str:
    return json.dumps(item, ensure_ascii=False, allow_nan=False) + "\n"
