"""Write a NumPy archive: one array for each column and matrix, and the conventions as text."""

from __future__ import annotations

import io
import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from vopd.attitude.history import History
from vopd.attitude.table_values import TableArrays, matrices, table
from vopd.export.file_request import FileRequest, statements
from vopd.export.json_lines import Described, described
from vopd.findings import Report


def render(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """Make the file. `conventions` and `columns` are JSON in arrays of text; nothing is pickled.

    Args:
        histories: the jobs
        request: has the epoch, if it is to be stated
        report: is not used
    """
    arrays = table(histories) | matrices(histories)
    return archive(arrays, statements(histories, request), described(histories))


def archive(values: TableArrays, stated: dict[str, str], columns: Described) -> bytes:
    """Make the file of any table; arguments as `vopd.export.json_lines.json_lines`."""
    texts = {"conventions": stated, "columns": columns}
    arrays: dict[str, Any] = {
        name: np.array(json.dumps(text, ensure_ascii=False)) for name, text in texts.items()
    }
    file = io.BytesIO()
    np.savez_compressed(file, **(arrays | values))
    return file.getvalue()
