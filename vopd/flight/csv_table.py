"""Tables in text with a header line: columns by name, errors with line and column."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np

from vopd.arrays import Floats
from vopd.findings import VopdError
from vopd.flight.input_file import InputFile, did_you_mean


@dataclass(frozen=True, eq=False)
class CsvTable:
    """The rows below a header line."""

    file: InputFile
    header: list[str]
    columns: list[tuple[str, ...]]  # as many as names in the header
    line: list[int]  # of each row, from 1

    def has(self, name: str) -> bool:
        """Whether there is such a column."""
        return name in self.header

    def column(self, name: str) -> list[str]:
        """The texts of a column.

        Raises:
            VopdError: where there is none
        """
        if name not in self.header:
            raise self.file.error(f"no column {name}{did_you_mean(name, self.header)}", 1)
        return [text.strip() for text in self.columns[self.header.index(name)]]

    def numbers(self, name: str, empty: float | None = None) -> Floats:
        """The numbers of a column.

        Args:
            name: the column's
            empty: what an empty cell means; None where it must not be empty

        Raises:
            VopdError: where one is not a finite number
        """
        texts = self.column(name)
        try:
            found = np.array(texts, dtype=np.float64)
            if np.isfinite(found).all():
                return found
        except ValueError:
            pass
        return np.array([self._number(name, k, text, empty) for k, text in enumerate(texts)])

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
    lines = [
        (number, line)
        for number, line in enumerate(file.text.splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not lines:
        raise file.error("the file is empty")
    between = separator(lines[0][1])
    parsed = list(csv.reader((line for _, line in lines), delimiter=between))
    header = [name.strip() for name in parsed[0]]
    numbers = [number for number, _ in lines]
    if len(parsed) != len(lines):
        raise file.error("a quoted cell goes over the end of a line")
    if {*map(len, parsed)} != {len(header)}:
        row, number = next(
            pair for pair in zip(parsed, numbers, strict=True) if len(pair[0]) != len(header)
        )
        hint = "; decimals take a point" if len(row) > len(header) else ""
        raise file.error(f"{len(row)} cells, the header has {len(header)}{hint}", number)
    doubled = {name for name in header if header.count(name) > 1}
    if doubled:
        raise file.error(f"two columns are called {', '.join(sorted(doubled))}", numbers[0])
    columns = list(zip(*parsed[1:], strict=True)) or [()] * len(header)
    return CsvTable(file, header, columns, numbers[1:])


def frames_of_cells(table: CsvTable, cells: list[str]) -> list[int] | list[str]:
    """The numbers of frames in a column `frame`, or names of images where no cell is a number.

    Raises:
        VopdError: where a number is not whole, is below 0, or stands among names
    """
    whole = [text.isascii() and text.isdigit() and len(text) < 16 for text in cells]
    if all(whole):
        return [int(text) for text in cells]
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


def header_names(file: InputFile) -> list[str]:
    """The names in the first line that is no comment; empty for an empty file."""
    for line in io.StringIO(file.text):
        if line.strip() and not line.lstrip().startswith("#"):
            return [name.strip() for name in line.split(separator(line))]
    return []


def separator(line: str) -> str:
    """What separates the columns of a line."""
    return max(",;\t", key=line.count)


def has_columns(file: InputFile, *ways: Sequence[str]) -> bool:
    """Whether the header has all columns of one of the ways."""
    names = set(header_names(file))
    return any(set(way) <= names for way in ways)
