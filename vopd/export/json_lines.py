"""Write JSON Lines: conventions and columns in the first line, then one object for each frame."""

from __future__ import annotations

import json
from collections.abc import Sequence
from math import isfinite
from typing import Any

from vopd.attitude.history import History
from vopd.attitude.table_columns import columns_of, table
from vopd.export.file_request import FileRequest, statements
from vopd.findings import Report


def described(histories: Sequence[History]) -> dict[str, dict[str, str]]:
    """Unit and meaning of every column of the table, by name."""
    return {c.name: {"unit": c.unit, "meaning": c.meaning} for c in columns_of(histories)}


def render(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """Make the file: numbers have all their digits, and missing numbers are null.

    Args:
        histories: the jobs
        request: has the epoch, if it is to be stated
        report: is not used
    """
    values = {name: column.tolist() for name, column in table(histories).items()}
    head = {"conventions": statements(histories, request), "columns": described(histories)}
    lines = [_line(head)]
    for row in zip(*values.values(), strict=True):
        lines.append(_line(dict(zip(values, map(_known, row), strict=True))))
    return "".join(lines).encode()


def _known(value: Any) -> Any:
    return None if isinstance(value, float) and not isfinite(value) else value


def _line(item: dict[str, Any]) -> str:
    return json.dumps(item, ensure_ascii=False, allow_nan=False) + "\n"
