"""Tables in text with a header line: columns by name, errors with line and column."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.findings import VopdError
from vopd.flight.files import InputFile, did_you_mean, shown

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
            raise self.error(f"{shown(text)} is not a number{hint}", row, name) from error
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
            raise self.error(
                f"{shown(text)} is not a date and time as {example}", row, name
            ) from error
        if moment.tzinfo is None:
            raise self.error(f"{text} does not say its zone: add Z for UTC", row, name)
        return moment.astimezone(UTC).timestamp()

    def error(self, message: str, row: int, column: str = "") -> VopdError:
        """An error in a row, by its index."""
        return self.file.error(message, self.line[row], column)


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
        message = f"{shown(cells[row])} is not the number of a frame, and other rows have numbers"
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
