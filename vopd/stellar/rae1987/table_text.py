"""Tables of the report as text: each computed row above the printed one."""

from __future__ import annotations

from collections.abc import Sequence

from vopd.stellar.rae1987.report_table import ReportTable


def as_text(table: ReportTable) -> str:
    """The title, the rows with their differences marked, and what the marks mean."""
    texts = [text for row in table.rows for text in (*row.computed, *row.printed)]
    width = max(len(text) for text in (*table.columns, *texts))
    labels = max(len(row.label) for row in table.rows)
    compared = any(row.printed for row in table.rows)
    margin = labels + (10 if compared else 1)
    lines = [table.title, " " * margin + _cells(table.columns, (), width)]
    for row in table.rows:
        for label, source, cells, marks in (
            (row.label, "computed", row.computed, ()),
            ("", "printed", row.printed, row.marks),
        ):
            head = f"{label:<{labels}}  {source:<8}" if compared else f"{label:<{margin}}"
            if cells:
                lines.append(head + _cells(cells, marks, width))
    return "\n".join(line.rstrip() for line in (*lines, *table.notes)) + "\n"


def _cells(texts: Sequence[str], marks: Sequence[str], width: int) -> str:
    marks = marks or [""] * len(texts)
    return "".join(
        f" {text:>{width}}{mark or ' '}" for text, mark in zip(texts, marks, strict=True)
    )
