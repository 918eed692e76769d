"""Apache Parquet: the table at full precision, conventions and units in the metadata."""

from __future__ import annotations

import io
import json
from collections.abc import Sequence

from vopd.attitude.history import History
from vopd.attitude.table_columns import table
from vopd.export.file_request import FileRequest, statements
from vopd.export.json_lines import Described, Values, described
from vopd.findings import Report


def render(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """Make the file: missing numbers are null; each field's metadata has `unit` and `meaning`.

    Args:
        histories: the jobs
        request: has the epoch, if it is to be stated
        report: is not used
    """
    return table_file(table(histories), statements(histories, request), described(histories))


def table_file(values: Values, stated: dict[str, str], columns: Described) -> bytes:
    """Make the file of any table; arguments as `vopd.export.json_lines.json_lines`."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    arrays = {name: pa.array(column, from_pandas=True) for name, column in values.items()}
    fields = [pa.field(name, arrays[name].type, metadata=about) for name, about in columns.items()]
    text = json.dumps(stated, ensure_ascii=False)
    schema = pa.schema(fields, metadata={"conventions": text})
    file = io.BytesIO()
    pq.write_table(pa.Table.from_arrays(list(arrays.values()), schema=schema), file)
    return file.getvalue()
