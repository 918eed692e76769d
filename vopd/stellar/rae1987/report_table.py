"""A table of the report as data: rows of computed numbers with the printed ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from vopd.stellar.rae1987 import printed_tables


@dataclass(frozen=True)
class ReportRow:
    """One row of a table: what was computed and, where that is legible, what was printed.

    Attributes:
        label: what the row is about
        computed: its numbers as text
        printed: what the report printed; empty where that is lost
        marks: after each printed number "", "*" for a misprint, or "+" for a difference
    """

    label: str
    computed: Sequence[str]
    printed: Sequence[str] = ()
    marks: Sequence[str] = ()


@dataclass(frozen=True)
class ReportTable:
    """A table of the report, recomputed.

    Attributes:
        title: its number and heading
        columns: heads of the columns
        rows: its rows
        notes: lines below it that explain the marks
    """

    title: str
    columns: Sequence[str]
    rows: Sequence[ReportRow]
    notes: Sequence[str] = ()


def compared_row(
    table: str,
    key: str,
    label: str,
    numbers: Sequence[float],
    columns: Sequence[str],
    digits: int,
    texts: Sequence[str],
) -> ReportRow:
    """A row whose printed numbers are marked where the computed ones differ.

    Args:
        table: the table's number, `6.2`
        key: the row's name among the misprints
        label: what the row is about
        numbers: computed
        columns: heads of the columns
        digits: decimals to show of the computed numbers
        texts: printed numbers
    """
    marks = []
    for number, column, text in zip(numbers, columns, texts, strict=True):
        places = len(text.partition(".")[2])
        agrees = f"{number:.{places}f}" == text
        misprint = (table, key, column) in printed_tables.MISPRINTS
        marks.append("" if agrees else "*" if misprint else "+")
    return ReportRow(label, [f"{number:.{digits}f}" for number in numbers], texts, marks)


def misprint_notes(table: str) -> list[str]:
    """The lines below a table that explain its misprints."""
    return [
        f"* misprint ({why}): should be {right}"
        for (where, _, _), (right, why) in printed_tables.MISPRINTS.items()
        if where == table
    ]
