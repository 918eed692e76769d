"""Write a NumPy archive: one array for each column and matrix, and the conventions as text."""

from __future__ import annotations

import io
import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from vopd.attitude.history import History
from vopd.attitude.table_columns import matrices, table
from vopd.export.file_request import FileRequest, statements
from vopd.export.json_lines import described
from vopd.findings import Report


def render(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """Make the file. `conventions` and `columns` are JSON in arrays of text; nothing is pickled.

    Args:
        histories: the jobs
        request: has the epoch, if it is to be stated
        report: is not used
    """
    stated = json.dumps(statements(histories, request), ensure_ascii=False)
    columns = json.dumps(described(histories), ensure_ascii=False)
    arrays: dict[str, Any] = {"conventions": np.array(stated), "columns": np.array(columns)}
    archive = io.BytesIO()
    np.savez_compressed(archive, **(arrays | table(histories) | matrices(histories)))
    return archive.getvalue()
