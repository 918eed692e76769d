"""CSV: the conventions as comments, a header, a row a frame; and the table's numbers as text."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence

from vopd.attitude.history import History
from vopd.attitude.table_columns import columns_of, table
from vopd.export.request import Request, statements
from vopd.findings import Report


def table_text(histories: Sequence[History]) -> dict[str, list[str]]:
    """The columns as text: numbers with their column's decimals, nothing where there is none."""
    values = table(histories)
    text = {}
    for column in columns_of(histories):
        these = values[column.name]
        form = "%s"
        if these.dtype.kind == "f":
            form = "%.6e" if column.decimals is None else f"%.{column.decimals}f"
        text[column.name] = ["" if value != value else form % value for value in these.tolist()]
    return text


def render(histories: Sequence[History], request: Request, report: Report) -> bytes:
    """The file: comment lines begin with a `#`; UTF-8, lines end with a line feed."""
    columns = table_text(histories)
    page = io.StringIO()
    for name, sentence in statements(histories, request).items():
        page.write(f"# {name}: {sentence}\n")
    rows = csv.writer(page, lineterminator="\n")
    rows.writerow(columns)
    rows.writerows(zip(*columns.values(), strict=True))
    return page.getvalue().encode()
