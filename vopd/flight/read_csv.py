"""Read tables in text with a header line, whole or in blocks of rows."""

from __future__ import annotations

import csv
from array import array
from collections.abc import Iterator, Sequence
from itertools import chain

from vopd.flight.csv_table import CsvTable
from vopd.flight.files import InputFile


def read_csv(file: InputFile) -> CsvTable:
    """The table of a file whose columns are separated by commas, semicolons or tabs.

    Lines that begin with # are comments.

    Raises:
        VopdError: where there is no header, or a row has not as many cells
    """
    header: list[str] = []
    columns, lines = [], array("q")
    for block in csv_blocks(file):
        header = block.header
        if block.line:
            columns.append(["\n".join(cells) for (cells,) in block.columns])
            lines.extend(block.line)
    by_name = [list(one) for one in zip(*columns, strict=True)] or [[] for _ in header]
    return CsvTable(file, header, by_name, lines)


def csv_blocks(file: InputFile) -> Iterator[CsvTable]:
    """The same table in blocks of rows, as the file is read.

    Raises:
        VopdError: as `read_csv`
    """
    between = separator(_first_line(file))
    header: list[str] = []
    for numbers, lines in _lines(file):
        first = not header
        # in an open quote the empty line that is added belongs to the last row
        reader = csv.reader(chain(lines, ("",)), delimiter=between)
        try:
            rows = list(reader)
        except csv.Error as error:  # a cell of more characters than Python's csv takes
            raise file.error(str(error), numbers[min(reader.line_num, len(lines)) - 1]) from error
        if rows.pop() or len(rows) != len(lines):
            line = next(
                n for n, line in zip(numbers, lines, strict=True) if _is_open(line, between)
            )
            raise file.error("a quoted cell goes over the end of the line", line)
        if first:
            header = _header(file, rows.pop(0), numbers[0])
            numbers = numbers[1:]
        if {*map(len, rows)} - {len(header)}:
            k = next(k for k, row in enumerate(rows) if len(row) != len(header))
            hint = "; decimals take a point" if len(rows[k]) > len(header) else ""
            message = f"{len(rows[k])} cells, the header has {len(header)}{hint}"
            raise file.error(message, numbers[k])
        if rows or first:
            cells = zip(*rows, strict=True) if rows else [()] * len(header)
            yield CsvTable(file, header, [[one] for one in cells], numbers)
    if not header:
        raise file.error("the file is empty")


def _is_open(line: str, between: str) -> bool:
    """Whether a line ends in a quoted cell."""
    return len(list(csv.reader((line, ""), delimiter=between))) < 2


def _header(file: InputFile, cells: list[str], line: int) -> list[str]:
    header = [name.strip() for name in cells]
    doubled = {name for name in header if header.count(name) > 1}
    if doubled:
        raise file.error(f"two columns are called {', '.join(sorted(doubled))}", line)
    return header


def _lines(file: InputFile) -> Iterator[tuple[Sequence[int], list[str]]]:
    """Numbers and texts of the lines that are neither empty nor a comment, chunk by chunk."""
    before = 0
    for chunk in file.chunks():
        lines = chunk.splitlines()
        numbers: Sequence[int] = range(before + 1, before + 1 + len(lines))
        before += len(lines)
        if "#" in chunk or not all(map(str.strip, lines)):
            kept = [
                (number, line)
                for number, line in zip(numbers, lines, strict=True)
                if line.strip() and not line.lstrip().startswith("#")
            ]
            numbers, lines = [number for number, _ in kept], [line for _, line in kept]
        if lines:
            yield numbers, lines


def _first_line(file: InputFile) -> str:
    return next((lines[0] for _, lines in _lines(file)), "")


def header_names(file: InputFile) -> list[str]:
    """The names in the first line that is no comment; empty for an empty file."""
    line = _first_line(file)
    return [name.strip().strip('"').strip() for name in line.split(separator(line))] if line else []


def separator(line: str) -> str:
    """What separates the columns of a line."""
    return max(",;\t", key=line.count)


def has_columns(file: InputFile, *ways: Sequence[str]) -> bool:
    """Whether the header has all columns of one of the ways."""
    names = set(header_names(file))
    return any(set(way) <= names for way in ways)
