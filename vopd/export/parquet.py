"""Apache Parquet: the table at full precision, conventions and units in the metadata."""

from __future__ import annotations

import io
import json
from collections.abc import Sequence

import numpy as np

from vopd.attitude.history import History
from vopd.attitude.table_columns import matrices, table
from vopd.export.file_request import FileRequest, statements
from vopd.export.json_lines import described
from vopd.findings import Report


def render(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """Make the file: missing numbers are null; each field's metadata has `unit` and `meaning`.

    A matrix is a list of its rows, each a list of three numbers; null where the frame has none.

    Args:
        histories: the jobs
        request: has the epoch, if it is to be stated
        report: is not used
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    arrays = {name: pa.array(column, from_pandas=True) for name, column in table(histories).items()}
    for name, frames in matrices(histories).items():
        rows = [None if np.isnan(one).all() else one.tolist() for one in frames]
        arrays[name] = pa.array(rows, pa.list_(pa.list_(pa.float64())))
    fields = [
        pa.field(name, arrays[name].type, metadata=about)
        for name, about in described(histories).items()
    ]
    stated = json.dumps(statements(histories, request), ensure_ascii=False)
    schema = pa.schema(fields, metadata={"conventions": stated})
    file = io.BytesIO()
    pq.write_table(pa.Table.from_arrays(list(arrays.values()), schema=schema), file)
    return file.getvalue()
