"""Write CSV: conventions as comments, a header, and one row for each frame.

A spreadsheet takes a cell that begins with = + - or @ for a formula. File names and
titles come from others, so such a text is preceded by an apostrophe.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Sequence

from vopd.attitude.history import History
from vopd.attitude.table_columns import columns_of, table
from vopd.export.file_request import FileRequest, statements
from vopd.findings import Report


def table_text(histories: Sequence[History]) -> dict[str, list[str]]:
    """The columns as text: numbers with the decimals of their column; empty where there is none.

    Args:
        histories: one or more jobs, of one kind of source
    """
    values = table(histories)
    text = {}
    for column in columns_of(histories):
        these = values[column.name]
        form = "%s"
        if these.dtype.kind == "f":
            form = "%.6e" if column.decimals is None else f"%.{column.decimals}f"
        text[column.name] = ["" if value != value else form % value for value in these.tolist()]
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
    columns = table_text(histories)
    for name, values in table(histories).items():
        if values.dtype.kind == "U":
            columns[name] = [not_a_formula(text) for text in columns[name]]
    page = io.StringIO()
    for name, sentence in statements(histories, request).items():
        safe = re.sub(r"([,;]\s*)(?=[=+@-])", r"\1'", sentence)  # the cells of a spreadsheet
        page.write(f"# {name}: {safe}\n")
    rows = csv.writer(page, lineterminator="\n")
    rows.writerow(columns)
    rows.writerows(zip(*columns.values(), strict=True))
    return page.getvalue().encode()
