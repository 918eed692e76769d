"""Apache Parquet: the table at full precision, conventions and units in the metadata."""

from __future__ import annotations

import io
import json
from collections.abc import Sequence

from vopd.attitude.history import History
from vopd.attitude.table_values import TableArrays, matrices, table
from vopd.export.arrow_columns import arrow_column
from vopd.export.file_request import FileRequest, statements
from vopd.export.json_lines import Described, described
from vopd.findings import Report


def render(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """Make the file: missing numbers are null; each field's metadata has `unit` and `meaning`.

    A matrix is a list of its rows, each a list of three numbers; null where the frame has none.

    Args:
        histories: the jobs
        request: has the epoch, if it is to be stated
        report: is not used
    """
    arrays = table(histories) | matrices(histories)
    return table_file(arrays, statements(histories, request), described(histories))


def table_file(values: TableArrays, stated: dict[str, str], columns: Described) -> bytes:
    """Make the file of any table; arguments as `vopd.export.json_lines.json_lines`."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    arrays = {name: arrow_column(column) for name, column in values.items()}
    fields = [pa.field(name, arrays[name].type, metadata=about) for name, about in columns.items()]
    text = json.dumps(stated, ensure_ascii=False)
    schema = pa.schema(fields, metadata={"conventions": text})
    file = io.BytesIO()
    pq.write_table(pa.Table.from_arrays(list(arrays.values()), schema=schema), file)
    return file.getvalue()
