"""The lines of a star file as cells, whatever character separates them."""

from __future__ import annotations

import csv
import io
from typing import NamedTuple

from vopd.findings import DeckError, Finding

SEPARATORS = (",", ";", "\t")


class NumberedRow(NamedTuple):
    """The cells of one line, and its number in the file, from 1."""

    number: int
    cells: list[str]


def read_rows(text: str, deck: str) -> list[NumberedRow]:
    """The cells of each line that is not blank and does not begin with #.

    Lines of separators alone are blank too: spreadsheets write them below a table.

    The separator is the one of comma, semicolon and tab that is most frequent in the header.

    Args:
        text: the file's text
        deck: its name in messages

    Raises:
        DeckError: a line is not CSV.
    """
    rows: list[NumberedRow] = []
    separator = ""
    for number, line in enumerate(io.StringIO(text.removeprefix("\ufeff"), newline=None), start=1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        separator = separator or max(SEPARATORS, key=line.count)
        try:  # line by line: no cell of a star file spans two
            cells = next(csv.reader([line], strict=True, delimiter=separator))
        except csv.Error as error:
            finding = Finding(f"line {number}: not CSV: {error}", deck=deck)
            raise DeckError(finding) from None
        if any(cell.strip() for cell in cells):
            rows.append(NumberedRow(number, cells))
    return rows
