"""Tables in text with a header line: columns by name, errors with line and column."""

from __future__ import annotations

import csv
from array import array
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import islice

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.findings import VopdError
from vopd.flight.input_file import InputFile, did_you_mean

ROWS_AT_ONCE = 2_000
TEXT_AT_ONCE = 250_000  # characters
DIGITS = 16  # from there on it is not the number of a frame


@dataclass(frozen=True, eq=False)
class CsvTable:
    """The rows below a header line.

    A cell takes as much memory as it has characters: each column is kept as texts of
    `ROWS_AT_ONCE` cells, a line feed between two of them.
    """

    file: InputFile
    header: list[str]
    columns: list[list[str]]  # as many as names in the header
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
        """The texts of a column, `ROWS_AT_ONCE` at a time.

        Raises:
            VopdError: where there is none
        """
        if name not in self.header:
            raise self.file.error(f"no column {name}{did_you_mean(name, self.header)}", 1)
        for block in self.columns[self.header.index(name)]:
            yield [text.strip() for text in block.split("\n")]

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

    def _numbers(self, name: str, row: int, texts: list[str], empty: float | None) -> Floats:
        try:
            found = np.array(texts, dtype=np.float64)
            if np.isfinite(found).all():
                return found
        except ValueError:
            pass
        return np.array([self._number(name, k, text, empty) for k, text in enumerate(texts, row)])

    def _number(self, name: str, row: int, text: str, empty: float | None) -> float:
        if not text or text.lower() == "nan":
            if empty is None:
                raise self.error("the cell is empty", row, name)
            return empty
        try:
            value = float(text)
        except ValueError as error:
            hint = "; decimals take a point" if "," in text else ""
            raise self.error(f"{text!r} is not a number{hint}", row, name) from error
        if not np.isfinite(value):
            raise self.error(f"{text} is not a finite number", row, name)
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
    numbers = array("q")
    rows = csv.reader(_told_lines(file.text, numbers), delimiter=separator(_first_line(file.text)))
    header = [name.strip() for name in next(rows, [])]
    if not header:
        raise file.error("the file is empty")
    columns: list[list[str]] = [[] for _ in header]
    count = 1
    while block := list(islice(rows, ROWS_AT_ONCE)):
        if rows.line_num != count + len(block):
            raise file.error("a quoted cell goes over the end of a line")
        if {*map(len, block)} != {len(header)}:
            k = next(k for k, row in enumerate(block) if len(row) != len(header))
            hint = "; decimals take a point" if len(block[k]) > len(header) else ""
            message = f"{len(block[k])} cells, the header has {len(header)}{hint}"
            raise file.error(message, numbers[count + k])
        count += len(block)
        for column, cells in zip(columns, zip(*block, strict=True), strict=True):
            column.append("\n".join(cells))
    doubled = {name for name in header if header.count(name) > 1}
    if doubled:
        raise file.error(f"two columns are called {', '.join(sorted(doubled))}", numbers[0])
    return CsvTable(file, header, columns, numbers[1:])


def _lines(text: str) -> Iterator[tuple[int, str]]:
    """Number and text of the lines that are neither empty nor a comment."""
    before = start = 0
    while start < len(text):
        end = text.find("\n", start + TEXT_AT_ONCE) + 1 or len(text)
        lines = text[start:end].splitlines()
        for number, line in enumerate(lines, before + 1):
            if line.strip() and not line.lstrip().startswith("#"):
                yield number, line
        before += len(lines)
        start = end


def _told_lines(text: str, numbers: array[int]) -> Iterator[str]:
    """These lines, their numbers being written down."""
    for number, line in _lines(text):
        numbers.append(number)
        yield line


def _first_line(text: str) -> str:
    return next((line for _, line in _lines(text)), "")


def frames_of_column(table: CsvTable) -> Ints | list[str]:
    """The numbers of frames in a column `frame`, or names of images where no cell is a number.

    Args:
        table: the table

    Raises:
        VopdError: where a number is not whole, is below 0, or stands among names
    """
    numbers = [_whole_numbers(block) for block in table.blocks("frame")]
    found = [block for block in numbers if block is not None]
    if len(found) == len(numbers):
        return np.concatenate([np.zeros(0, np.int64), *found])
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


def _whole_numbers(texts: list[str]) -> Ints | None:
    return np.array(texts, dtype=np.int64) if all(map(_is_whole, texts)) else None


def _is_whole(text: str) -> bool:
    return text.isascii() and text.isdigit() and len(text) < DIGITS


def header_names(file: InputFile) -> list[str]:
    """The names in the first line that is no comment; empty for an empty file."""
    line = _first_line(file.text)
    return [name.strip() for name in line.split(separator(line))] if line else []


def separator(line: str) -> str:
    """What separates the columns of a line."""
    return max(",;\t", key=line.count)


def has_columns(file: InputFile, *ways: Sequence[str]) -> bool:
    """Whether the header has all columns of one of the ways."""
    names = set(header_names(file))
    return any(set(way) <= names for way in ways)
