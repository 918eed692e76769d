"""Write CSV: conventions as comments, a header, and one row for each frame.

A spreadsheet takes a cell that begins with = + - or @ for a formula. File names and
titles come from others, so such a text is preceded by an apostrophe.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vopd.attitude.history import History
from vopd.attitude.history_parts import HistoryParts, one_part
from vopd.attitude.table_columns import TableColumn, columns_of
from vopd.attitude.table_values import TableArrays, row_blocks, table, table_blocks, table_values
from vopd.export.file_request import FileRequest, TableFile, statements
from vopd.findings import Report

TableText = dict[str, list[str]]
"""The columns of a table as text."""


def table_text(histories: Sequence[History]) -> TableText:
    """The columns as text: numbers with the decimals of their column; empty where there is none.

    Args:
        histories: one or more jobs, of one kind of source
    """
    return as_text(table(histories), columns_of(histories))


def as_text(values: TableArrays, columns: Sequence[TableColumn]) -> TableText:
    """The values of columns as `table_text` has them.

    Args:
        values: an array for each column, by name
        columns: the columns
    """
    return {one.name: _text(values[one.name], one) for one in columns}


def _text(values: NDArray[Any], column: TableColumn) -> list[str]:
    if values.dtype.kind != "f":
        return list(map(str, values.tolist()))
    missing = np.isnan(values)
    if missing.all():
        return [""] * len(values)
    form = "%.6e" if column.decimals is None else f"%.{column.decimals}f"
    bits = values.view(np.int64)  # -0.0 is not 0.0
    if (bits == bits[0]).all():
        return [form % values[0]] * len(values)
    # one format for all is twice as fast as one a number
    text = ("\n".join([form] * len(values)) % tuple(values.tolist())).split("\n")
    if missing.any():
        text = ["" if gone else one for one, gone in zip(text, missing.tolist(), strict=True)]
    return text


def not_a_formula(text: str) -> str:
    """The text with an apostrophe before it, if a spreadsheet would take it for a formula."""
    return "'" + text if len(text) > 1 and text[0] in "=+-@" else text


def render(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """Make the file, in UTF-8: comment lines begin with `#`, lines end with a line feed.

    Args:
        histories: the jobs
        request: has the epoch, if it is to be stated
        report: is not used
    """
    return b"".join(pages(list(map(one_part, histories)), request, report))


def pages(jobs: Sequence[HistoryParts], request: FileRequest, report: Report) -> Iterator[bytes]:
    """Make the file page by page, as the parts of the jobs are made; arguments as `render`."""
    heads = [job.head for job in jobs]
    columns = columns_of(heads)
    yield _head(heads, columns, request)
    for values in table_blocks(jobs, columns):
        yield _content(_rows(values, columns))


def render_files(files: Sequence[TableFile]) -> list[bytes]:
    """Make many files; rows of small ones are made together, which is faster.

    Args:
        files: their jobs, each of one kind of source
    """
    columns = [columns_of(file.histories) for file in files]
    alike: dict[tuple[str, ...], list[int]] = {}
    for k, own in enumerate(columns):
        alike.setdefault(tuple(column.name for column in own), []).append(k)
    made: dict[int, bytes] = {}
    for indices in alike.values():
        own = columns[indices[0]]
        histories = [one for k in indices for one in files[k].histories]
        blocks = row_blocks(table_values(own, histories))
        rows = (row for values in blocks for row in _rows(values, own))
        for k in indices:
            several, request = files[k].histories, files[k].request
            count = sum(len(one.estimate.frame) for one in several)
            made[k] = _head(several, columns[k], request) + _content(islice(rows, count))
    return [made[k] for k in range(len(files))]


def _head(
    histories: Sequence[History], columns: Sequence[TableColumn], request: FileRequest
) -> bytes:
    """The comment lines, and the line of the columns' names."""
    lines = []
    for name, sentence in statements(histories, request).items():
        safe = _AFTER_COMMA.sub(r"\1'", sentence)
        lines.append(f"# {name}: {safe}\n")
    return ("".join(lines) + _lines([[column.name for column in columns]])).encode()


_AFTER_COMMA = re.compile(r"([,;]\s*)(?=[=+@-])")
"""Where a spreadsheet begins a cell of a comment with what it takes for a formula."""


def _content(rows: Iterable[str]) -> bytes:
    """Rows as lines of the file."""
    return "".join([f"{row}\n" for row in rows]).encode()


def _rows(values: TableArrays, columns: Sequence[TableColumn]) -> Iterator[str]:
    """The rows of a block; numbers need no quotes."""
    text = as_text(values, columns)
    for name, cells in text.items():
        if values[name].dtype.kind == "U":
            safe = {cell: _quoted(not_a_formula(cell)) for cell in set(cells)}
            text[name] = [safe[cell] for cell in cells]
    return map(",".join, zip(*text.values(), strict=True))


def _quoted(cell: str) -> str:
    """A cell in quotes where CSV needs them."""
    return _lines([[cell, ""]]).removesuffix(",\n")


def _lines(rows: Iterable[Iterable[str]]) -> str:
    page = io.StringIO()
    csv.writer(page, lineterminator="\n").writerows(rows)
    return page.getvalue()
