"""Tables in text with a header line: columns by name, errors with line and column."""

from __future__ import annotations

import csv
from array import array
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import chain

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.findings import VopdError
from vopd.flight.input_file import InputFile, did_you_mean

NOT_KNOWN = "; leave the cell empty where it is not known"
DIGITS = 16  # from there on it is not the number of a frame


Cells = str | tuple[str, ...]
"""The texts of some cells; as one text, a line feed between two, they take less memory."""


@dataclass(frozen=True, eq=False)
class CsvTable:
    """The rows below a header line, or some of them."""

    file: InputFile
    header: list[str]
    columns: list[list[Cells]]  # blocks of rows, for each name in the header
    line: Sequence[int]  # of each row, from 1

    def has(self, name: str) -> bool:
        """Whether there is such a column."""
        return name in self.header

    def column(self, name: str) -> list[str]:
        """The texts of a column.

        Raises:
            VopdError: where there is none
        """
        return [text for block in self.blocks(name) for text in block]

    def blocks(self, name: str) -> Iterator[list[str]]:
        """The texts of a column, block by block.

        Raises:
            VopdError: where there is none
        """
        if name not in self.header:
            raise self.file.error(f"no column {name}{did_you_mean(name, self.header)}", 1)
        for block in self.columns[self.header.index(name)]:
            yield [*map(str.strip, block.split("\n") if isinstance(block, str) else block)]

    def numbers(self, name: str, empty: float | None = None) -> Floats:
        """The numbers of a column.

        Args:
            name: the column's
            empty: what an empty cell means; None where it must not be empty

        Raises:
            VopdError: where one is not a finite number
        """
        found = np.empty(len(self.line))
        row = 0
        for texts in self.blocks(name):
            found[row : row + len(texts)] = self._numbers(name, row, texts, empty)
            row += len(texts)
        return found

    def sigmas(self, name: str) -> Floats:
        """The standard deviations of a column; NaN where a cell is empty, or there is no column.

        Raises:
            VopdError: where one is not a number above 0
        """
        if not self.has(name):
            return np.full(len(self.line), np.nan)
        found = self.numbers(name, empty=np.nan)
        for row in np.flatnonzero(found <= 0.0)[:1].tolist():
            message = f"{found[row]:g} is not a standard deviation, which is above 0{NOT_KNOWN}"
            raise self.error(message, row, name)
        return found

    def _numbers(self, name: str, row: int, texts: list[str], empty: float | None) -> Floats:
        try:
            found = np.array(texts, dtype=np.float64)
            if np.isfinite(found).all():
                return found
        except ValueError:
            pass
        return np.array([self._number(name, k, text, empty) for k, text in enumerate(texts, row)])

    def _number(self, name: str, row: int, text: str, empty: float | None) -> float:
        if not text and empty is not None:
            return empty
        hint = "" if empty is None else NOT_KNOWN
        if not text:
            raise self.error("the cell is empty", row, name)
        try:
            value = float(text)
        except ValueError as error:
            hint = "; decimals take a point" if "," in text else hint
            raise self.error(f"{text!r} is not a number{hint}", row, name) from error
        if not np.isfinite(value):
            raise self.error(f"{text} is not a finite number{hint}", row, name)
        return value

    def times(self, name: str) -> Floats:
        """Seconds since 1970-01-01, UTC, of dates and times with Z or an offset."""
        return np.array([self._time(name, k, text) for k, text in enumerate(self.column(name))])

    def _time(self, name: str, row: int, text: str) -> float:
        try:
            moment = datetime.fromisoformat(text)
        except ValueError as error:
            example = "2026-05-01T11:58:42.25Z"
            raise self.error(f"{text!r} is not a date and time as {example}", row, name) from error
        if moment.tzinfo is None:
            raise self.error(f"{text} does not say its zone: add Z for UTC", row, name)
        return moment.astimezone(UTC).timestamp()

    def error(self, message: str, row: int, column: str = "") -> VopdError:
        """An error in a row, by its index."""
        return self.file.error(message, self.line[row], column)


def read_csv(file: InputFile) -> CsvTable:
    """The table of a file whose columns are separated by commas, semicolons or tabs.

    Lines that begin with # are comments.

    Raises:
        VopdError: where there is no header, or a row has not as many cells
    """
    header, columns, lines = header_names(file), [], array("q")
    for block in csv_blocks(file):
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


def frames_of_column(table: CsvTable) -> Ints | list[str]:
    """The numbers of frames in a column `frame`, or names of images where no cell is a number.

    Args:
        table: the table

    Raises:
        VopdError: where a number is not whole, is below 0, or stands among names
    """
    found = whole_numbers(table, "frame")
    if found is not None:
        return found
    cells = table.column("frame")
    whole = [_is_whole(text) for text in cells]
    row = whole.index(False)
    try:
        float(cells[row])
    except ValueError:
        if not any(whole):
            return cells
        message = f"{cells[row]!r} is not the number of a frame, and other rows have numbers"
    else:
        message = f"{cells[row]} is not the number of a frame, a whole number from 0"
    raise table.error(message, row, "frame")


def whole_numbers(table: CsvTable, column: str) -> Ints | None:
    """The whole numbers from 0 of a column; None where a cell is no such number.

    Args:
        table: the table
        column: its name
    """
    numbers = [_whole_numbers(block) for block in table.blocks(column)]
    found = [block for block in numbers if block is not None]
    if len(found) < len(numbers):
        return None
    return np.concatenate([np.zeros(0, np.int64), *found])


def _whole_numbers(texts: list[str]) -> Ints | None:
    if not texts:
        return np.zeros(0, np.int64)
    whole = all(texts) and _is_whole("".join(texts), DIGITS * len(texts))
    if not whole or max(map(len, texts)) >= DIGITS:
        return None
    return np.array(texts, dtype=np.int64)


def _is_whole(text: str, digits: int = DIGITS) -> bool:
    return text.isascii() and text.isdigit() and len(text) < digits


def header_names(file: InputFile) -> list[str]:
    """The names in the first line that is no comment; empty for an empty file."""
    line = _first_line(file)
    return [name.strip() for name in line.split(separator(line))] if line else []


def separator(line: str) -> str:
    """What separates the columns of a line."""
    return max(",;\t", key=line.count)


def has_columns(file: InputFile, *ways: Sequence[str]) -> bool:
    """Whether the header has all columns of one of the ways."""
    names = set(header_names(file))
    return any(set(way) <= names for way in ways)
