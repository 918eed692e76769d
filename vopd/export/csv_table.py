"""Write CSV: conventions as comments, a header, and one row for each frame.

A spreadsheet takes a cell that begins with = + - or @ for a formula. File names and
titles come from others, so such a text is preceded by an apostrophe.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vopd.attitude.history import History
from vopd.attitude.table_columns import TableColumn, columns_of, row_blocks, table
from vopd.export.file_request import FileRequest, statements
from vopd.findings import Report

TableText = dict[str, list[str]]
"""The columns of a table as text."""


def table_text(histories: Sequence[History]) -> TableText:
    """The columns as text: numbers with the decimals of their column; empty where there is none.

    Args:
        histories: one or more jobs, of one kind of source
    """
    return as_text(table(histories), columns_of(histories))


def as_text(values: dict[str, NDArray[Any]], columns: Sequence[TableColumn]) -> TableText:
    """The values of columns as `table_text` has them.

    Args:
        values: an array for each column, by name
        columns: the columns
    """
    return {one.name: _text(values[one.name], one) for one in columns}


def _text(values: NDArray[Any], column: TableColumn) -> list[str]:
    if values.dtype.kind != "f" or not len(values):
        return list(map(str, values.tolist()))
    form = "%.6e" if column.decimals is None else f"%.{column.decimals}f"
    # one format for all is twice as fast as one a number
    text = ("\n".join([form] * len(values)) % tuple(values.tolist())).split("\n")
    if np.isnan(values).any():
        text = ["" if missing else one for one, missing in zip(text, np.isnan(values), strict=True)]
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
    page = io.BytesIO()
    for name, sentence in statements(histories, request).items():
        safe = re.sub(r"([,;]\s*)(?=[=+@-])", r"\1'", sentence)  # the cells of a spreadsheet
        page.write(f"# {name}: {safe}\n".encode())
    columns = columns_of(histories)
    page.write(_csv([[column.name for column in columns]]))
    for some in row_blocks(table(histories)):
        text = as_text(some, columns)
        for name, values in some.items():
            if values.dtype.kind == "U":
                text[name] = [not_a_formula(one) for one in text[name]]
        page.write(_csv(zip(*text.values(), strict=True)))
    return page.getvalue()


def _csv(rows: Iterable[Iterable[str]]) -> bytes:
    page = io.StringIO()
    csv.writer(page, lineterminator="\n").writerows(rows)
    return page.getvalue().encode()
