"""The attitude table as CSV, JSON Lines, npz, Parquet and a pandas DataFrame."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from itertools import chain, islice
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vopd.arrays import Bools, Floats
from vopd.attitude.conventions import conventions
from vopd.attitude.history import History
from vopd.attitude.long_history import HistoryParts
from vopd.attitude.mean import mean_statements, mean_table
from vopd.attitude.table import (
    MATRICES,
    TableArrays,
    TableColumn,
    chosen_columns,
    columns_of,
    matrices,
    row_blocks,
    table,
    table_blocks,
    table_values,
)
from vopd.export import FORMATS, FileRequest, statements
from vopd.files import ESCAPED, not_a_formula, optional_package
from vopd.findings import Report, VopdError

if TYPE_CHECKING:
    import pandas as pd


# Write CSV: conventions as comments, a header, and one row for each frame.
#
# A spreadsheet takes a cell that begins with = + - or @ for a formula. File names and
# titles come from others, so such a text is preceded by an apostrophe.

NO_TURN = re.compile(r"360(?=(?:\.0*)?$)")

TableText = dict[str, list[str]]  # the columns of a table as text


def as_text(values: TableArrays, columns: Sequence[TableColumn]) -> TableText:
    """Write the values of columns as text: numbers with their decimals, empty for NaN."""
    texts = {one.name: _texts_csv(values[one.name], one.decimals) for one in columns}
    for one in columns:
        if one.is_whole_turn:
            texts[one.name] = below_360(texts[one.name])
    return texts


def below_360(texts: list[str]) -> list[str]:
    """Write 0 for an angle that is rounded to 360."""
    return [NO_TURN.sub("0", text) if text.startswith("360") else text for text in texts]


def _texts_csv(values: NDArray[Any], decimals: int | None) -> list[str]:
    """Format the values of a column: six decimals and an exponent if it has no decimals."""
    if values.dtype.kind != "f":
        return list(map(str, values.tolist()))
    form = "%.6e" if decimals is None else f"%.{decimals}f"
    bits = values.view(f"i{values.itemsize}")
    alike = bool((bits == bits[:1]).all())  # as the standard deviation of what is exact
    some = values[:1] if alike else values
    texts = list(map(form.__mod__, some.tolist()))
    for row in np.flatnonzero(np.isnan(some)).tolist():
        texts[row] = ""
    return texts * len(values) if alike else texts


def pages_csv(
    jobs: Sequence[HistoryParts], request: FileRequest, report: Report
) -> Iterator[bytes]:
    """Make the file page by page, as the parts of the jobs are made, in UTF-8.

    Comment lines begin with `#`, lines end with a line feed.
    """
    heads = [job.head for job in jobs]
    columns = _columns(heads, request)
    yield _comments(_stated(heads, request)) + _names(columns)
    for values in table_blocks(jobs, columns):
        yield "".join(_rows_csv(values, columns)).encode()


def _columns(histories: Sequence[History], request: FileRequest) -> tuple[TableColumn, ...]:
    return chosen_columns(histories, request.columns, request.roll_180)


def _stated(histories: Sequence[History], request: FileRequest) -> dict[str, str]:
    """State the conventions, with the range of roll that the request asks for."""
    stated = statements(histories, request)
    if request.roll_180:
        stated["ranges"] = stated["ranges"].replace(
            "yaw and roll 0 to 360, pitch", "yaw 0 to 360, pitch and roll"
        )
    return stated


def _arrays(histories: Sequence[History], request: FileRequest) -> tuple[TableArrays, Described]:
    """Tabulate the chosen columns, and the matrices if all are; their units and meanings."""
    columns = _columns(histories, request) + _matrices_of(request)
    return table_values(columns, histories), _described(columns)


def _matrices_of(request: FileRequest) -> tuple[TableColumn, ...]:
    return MATRICES if request.columns == ("all",) else ()


def render_files(files: Sequence[tuple[Sequence[History], FileRequest]]) -> list[bytes]:
    """Make many files; rows of small ones are made together, which is faster."""
    columns = [columns_of(histories) for histories, _ in files]
    alike: dict[tuple[str, ...], list[int]] = {}
    for k, own in enumerate(columns):
        alike.setdefault(tuple(column.name for column in own), []).append(k)
    made: dict[int, bytes] = {}
    for indices in alike.values():
        own = columns[indices[0]]
        names = _names(own)
        blocks = row_blocks(table_values(own, [one for k in indices for one in files[k][0]]))
        rows = chain.from_iterable(_rows_csv(values, own) for values in blocks)
        for k in indices:
            histories, request = files[k]
            count = sum(len(one.estimate.frame) for one in histories)
            content = "".join(islice(rows, count)).encode()
            made[k] = _comments(statements(histories, request)) + names + content
    return [made[k] for k in range(len(files))]


def _comments(stated: dict[str, str]) -> bytes:
    """Write the comment lines."""
    return "".join([_comment(*one) for one in stated.items()]).encode()


@lru_cache(maxsize=100)  # most are the same in many files
def _comment(name: str, sentence: str) -> str:
    safe = _AFTER_COMMA.sub(r"\1'", sentence)
    return f"# {name}: {safe}\n"


def _names(columns: Sequence[TableColumn]) -> bytes:
    """Write the line of the columns' names."""
    return _lines([[column.name for column in columns]]).encode()


_AFTER_COMMA = re.compile(r"([,;]\s*)(?=[=+@-])")
"""Where a spreadsheet begins a cell of a comment with what it takes for a formula."""


def _rows_csv(values: TableArrays, columns: Sequence[TableColumn]) -> Iterator[str]:
    """Format the rows of a block as lines of the file; numbers need no quotes."""
    texts = as_text(values, columns)
    cells = [
        texts[name] if own.dtype.kind in "fiu" else _cells(texts[name])
        for name, own in values.items()
    ]
    return (",".join(row) + "\n" for row in zip(*cells, strict=True))


def _cells(words: list[str]) -> list[str]:
    """Write words as cells; many are the same."""
    safe = {word: cell_csv(word) for word in set(words)}
    return [safe[word] for word in words]


def cell_csv(word: str) -> str:
    """Write a word as a cell that is no formula, in quotes if CSV or a reader of comments needs it.

    Behind a # without quotes pandas takes the rest of the line for a comment.
    """
    cell = _lines([[not_a_formula(word), ""]]).removesuffix(",\n")
    return f'"{cell}"' if "#" in cell and not cell.startswith('"') else cell


def _lines(rows: Iterable[Iterable[str]]) -> str:
    page = io.StringIO()
    csv.writer(page, lineterminator="\n").writerows(rows)
    return page.getvalue()


# Write JSON Lines: conventions and columns in the first line, then one object for each frame.

Described = dict[str, dict[str, str]]  # unit and meaning of columns, by name


def _described(columns: Sequence[TableColumn]) -> Described:
    """Describe unit and meaning of every column, by name."""
    return {c.name: {"unit": c.unit, "meaning": c.meaning} for c in columns}


def pages_json_lines(
    jobs: Sequence[HistoryParts], request: FileRequest, report: Report
) -> Iterator[bytes]:
    """Make the file page by page, as the parts of the jobs are made.

    Numbers have all their digits; missing and infinite numbers are null. A matrix is a list of
    its rows, and null where the frame has none.
    """
    heads = [job.head for job in jobs]
    columns = _columns(heads, request) + _matrices_of(request)
    yield _first_line(_stated(heads, request), _described(columns))
    for values in table_blocks(jobs, columns):
        yield _rows_json_lines(values)


def json_lines(values: TableArrays, stated: dict[str, str], columns: Described) -> bytes:
    """Make the file of any table."""
    return _first_line(stated, columns) + b"".join(map(_rows_json_lines, row_blocks(values)))


def _first_line(stated: dict[str, str], columns: Described) -> bytes:
    return _line({"conventions": stated, "columns": columns})


def _rows_json_lines(values: TableArrays) -> bytes:
    rows = zip(*(column.tolist() for column in values.values()), strict=True)
    return b"".join(_line(dict(zip(values, map(_known, row), strict=True))) for row in rows)


def _known(value: Any) -> Any:
    if isinstance(value, list):
        missing = all(number != number for row in value for number in row)
        return None if missing else [[_known(number) for number in row] for row in value]
    return None if isinstance(value, float) and not isfinite(value) else value


def _line(item: dict[str, Any]) -> bytes:
    text = json.dumps(item, ensure_ascii=False, allow_nan=False) + "\n"
    return text.encode("utf-8", ESCAPED)


# Write a NumPy archive: one array for each column and matrix, and the conventions as text.


def render_npz(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """Make the file. `conventions` and `columns` are JSON in arrays of text; nothing is pickled."""
    arrays, columns = _arrays(histories, request)
    return archive(arrays, _stated(histories, request), columns)


def archive(values: TableArrays, stated: dict[str, str], columns: Described) -> bytes:
    """Make the file of any table; arguments as `vopd.export.tables.json_lines`."""
    texts = {"conventions": stated, "columns": columns}
    arrays: dict[str, Any] = {
        name: np.array(json.dumps(text, ensure_ascii=False)) for name, text in texts.items()
    }
    file = io.BytesIO()
    np.savez_compressed(file, **(arrays | values))
    return file.getvalue()


# Columns of an Arrow table, made of the buffers of numpy arrays.
#
# `pyarrow.array` would do, but it loads pandas wherever that is installed, a third of a second.


def arrow_column(values: NDArray[Any]) -> Any:
    """Make an Arrow array of one value, or one matrix, for each row; NaN is null.

    Args:
        values: numbers, truth values or texts (F,), or matrices (F, 3, 3)
    """
    import pyarrow as pa

    if values.ndim > 1:
        return _matrices(values)
    if values.dtype.kind == "U":
        return _texts_arrow_columns(values)
    missing = np.isnan(values) if values.dtype.kind == "f" else np.zeros(len(values), bool)
    truth = values.dtype.kind == "b"
    kind = pa.bool_() if truth else pa.from_numpy_dtype(values.dtype)
    content = _bits(values) if truth else _buffer(values)
    return pa.Array.from_buffers(kind, len(values), [_present(missing), content])


def _texts_arrow_columns(values: NDArray[np.str_]) -> Any:
    import pyarrow as pa

    texts = [text.encode("utf-8", "backslashreplace") for text in values.tolist()]
    content = [None, _offsets([len(text) for text in texts]), pa.py_buffer(b"".join(texts))]
    return pa.Array.from_buffers(pa.string(), len(texts), content)


def _matrices(values: Floats) -> Any:
    """Convert matrices to lists of rows; null where all elements are missing."""
    import pyarrow as pa

    missing: Bools = np.asarray(np.isnan(values).all(axis=(1, 2)))
    numbers = values[~missing].ravel()
    number = pa.Array.from_buffers(pa.float64(), len(numbers), [None, _buffer(numbers)])
    rows = len(numbers) // 3
    row = pa.Array.from_buffers(
        pa.list_(pa.float64()), rows, [None, _offsets([3] * rows)], children=[number]
    )
    content = [_present(missing), _offsets(np.where(missing, 0, 3))]
    return pa.Array.from_buffers(pa.list_(row.type), len(values), content, children=[row])


def _present(missing: Bools) -> Any:
    """Pack the marks of present values into a buffer; None if none is missing."""
    return _bits(~missing) if missing.any() else None


def _bits(marks: Bools) -> Any:
    return _buffer(np.packbits(marks, bitorder="little"))


def _offsets(lengths: Any) -> Any:
    """Sum lengths to a buffer of offsets: the beginning of each list or text, and the end."""
    return _buffer(np.concatenate([[0], np.cumsum(lengths)]).astype(np.int32))


def _buffer(values: NDArray[Any]) -> Any:
    import pyarrow as pa

    return pa.py_buffer(np.ascontiguousarray(values))


# Apache Parquet: the table at full precision, conventions and units in the metadata.


def render_parquet(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """Make the file: missing numbers are null; each field's metadata has `unit` and `meaning`.

    A matrix is a list of its rows, each a list of three numbers; null where the frame has none.
    """
    arrays, columns = _arrays(histories, request)
    return table_file(arrays, _stated(histories, request), columns)


def table_file(values: TableArrays, stated: dict[str, str], columns: Described) -> bytes:
    """Make the file of any table; arguments as `vopd.export.tables.json_lines`."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    arrays = {name: arrow_column(column) for name, column in values.items()}
    fields = [pa.field(name, arrays[name].type, metadata=about) for name, about in columns.items()]
    text = json.dumps(stated, ensure_ascii=False)
    schema = pa.schema(fields, metadata={"conventions": text})
    file = io.BytesIO()
    pq.write_table(pa.Table.from_arrays(list(arrays.values()), schema=schema), file)
    return file.getvalue()


# The attitude table as a pandas DataFrame.


def dataframe(histories: Sequence[History]) -> pd.DataFrame:
    """Make the attitude table of jobs, a row a frame, with the conventions in `attrs`.

    The columns of `matrices` hold an array of 3 x 3 in each row; `numpy.stack` makes one
    array of such a column.

    Raises:
        VopdError: where pandas is not installed, or there is no job
    """
    pandas = optional_package("pandas", "pandas")
    if not histories:
        raise VopdError("the run has no job")
    arrays = {name: list(frames) for name, frames in matrices(histories).items()}
    frame: pd.DataFrame = pandas.DataFrame(table(histories) | arrays)
    frame.attrs.update(conventions(histories))
    return frame


# Write the mean attitudes of jobs, a row each.


def render_means(form: str, histories: Sequence[History], request: FileRequest) -> bytes:
    """Make the file of the mean attitudes of jobs.

    Raises:
        VopdError: where a job has no mean, or an optional package is missing
    """
    means = [one.mean() for one in histories]
    columns, values = mean_table(histories, means)
    stated = mean_statements(statements(histories, request), histories, means)
    if form != "csv":
        about = {one.name: {"unit": one.unit, "meaning": one.meaning} for one in columns}
        return render_table(form, values, stated, about)
    columns = [one for one in columns if values[one.name].ndim == 1]
    values = {one.name: values[one.name] for one in columns}
    return _comments(stated) + _names(columns) + "".join(_rows_csv(values, columns)).encode()


# Write a table that is no attitude history, such as that of star photographs.

WRITERS = {"jsonl": json_lines, "npz": archive, "parquet": table_file}
"""The formats that hold any table, by their names in `vopd.export.FORMATS`."""


def render_table(
    form: str, values: TableArrays, stated: dict[str, str], columns: Described
) -> bytes:
    """Make the content of a file.

    Raises:
        VopdError: where a package that the format needs is not installed.
    """
    FORMATS[form].ready()
    return WRITERS[form](values, stated, columns)
