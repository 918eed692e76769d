"""Write CSV: conventions as comments, a header, and one row for each frame.

A spreadsheet takes a cell that begins with = + - or @ for a formula. File names and
titles come from others, so such a text is preceded by an apostrophe.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vopd.attitude.history import History
from vopd.attitude.history_parts import HistoryParts
from vopd.attitude.known_columns import TableColumn
from vopd.attitude.table_columns import columns_of
from vopd.attitude.table_values import TableArrays, row_blocks, table, table_blocks, table_values
from vopd.export.file_request import FileRequest, TableFile, statements
from vopd.export.number_text import (
    Characters,
    number_text,
    repeated,
    whole_number_text,
    without_gaps,
    word_text,
)
from vopd.findings import Report

TableText = dict[str, list[str]]
"""The columns of a table as text."""


def table_text(histories: Sequence[History]) -> TableText:
    """The columns as text: numbers with the decimals of their column; empty where there is none.

    Args:
        histories: one or more jobs, of one kind of source
    """
    return as_text(table(histories), columns_of(histories))


def as_text(values: TableArrays, columns: Sequence[TableColumn]) -> TableText:
    """The values of columns as `table_text` has them.

    Args:
        values: an array for each column, by name
        columns: the columns
    """
    numbers = _numbers(values, columns)
    return {
        one.name: _lines_of(numbers[one.name]) if one.name in numbers else _words(values[one.name])
        for one in columns
    }


def _words(values: NDArray[Any]) -> list[str]:
    return list(map(str, values.tolist()))


def _lines_of(text: Characters) -> list[str]:
    """The texts of numbers, which have no line feed."""
    lines = np.concatenate([text, repeated("\n", len(text))], axis=1)
    return without_gaps(lines).decode().split("\n")[:-1]


def _numbers(values: TableArrays, columns: Sequence[TableColumn]) -> dict[str, Characters]:
    """The texts of the columns that hold numbers; those with like decimals are made together."""
    alike: dict[int | None, list[str]] = {}
    text = {}
    for column in columns:
        kind = values[column.name].dtype.kind
        if kind == "f":
            alike.setdefault(column.decimals, []).append(column.name)
        elif kind in "iu":
            text[column.name] = whole_number_text(values[column.name])
    for decimals, names in alike.items():
        several = number_text(np.stack([values[name] for name in names], axis=1), decimals)
        text |= zip(names, several.swapaxes(0, 1), strict=True)
    return text


def not_a_formula(text: str) -> str:
    """The text with an apostrophe before it, if a spreadsheet would take it for a formula."""
    return "'" + text if len(text) > 1 and text[0] in "=+-@" else text


def pages(jobs: Sequence[HistoryParts], request: FileRequest, report: Report) -> Iterator[bytes]:
    """Make the file page by page, as the parts of the jobs are made, in UTF-8.

    Comment lines begin with `#`, lines end with a line feed.

    Args:
        jobs: one or more, of one kind of source
        request: has the epoch, if it is to be stated
        report: is not used
    """
    heads = [job.head for job in jobs]
    columns = columns_of(heads)
    yield _comments(heads, request) + _names(columns)
    for values in table_blocks(jobs, columns):
        yield without_gaps(_rows(values, columns))


def render_files(files: Sequence[TableFile]) -> list[bytes]:
    """Make many files; rows of small ones are made together, which is faster.

    Args:
        files: their jobs, each of one kind of source
    """
    columns = [columns_of(file.histories) for file in files]
    alike: dict[tuple[str, ...], list[int]] = {}
    for k, own in enumerate(columns):
        alike.setdefault(tuple(column.name for column in own), []).append(k)
    made: dict[int, bytes] = {}
    for indices in alike.values():
        own = columns[indices[0]]
        names = _names(own)
        histories = [one for k in indices for one in files[k].histories]
        rows = (_rows(values, own) for values in row_blocks(table_values(own, histories)))
        counts = [sum(len(one.estimate.frame) for one in files[k].histories) for k in indices]
        for k, content in zip(indices, _divided(rows, counts), strict=True):
            made[k] = _comments(files[k].histories, files[k].request) + names + content
    return [made[k] for k in range(len(files))]


def _divided(blocks: Iterator[Characters], counts: Sequence[int]) -> Iterator[bytes]:
    """The contents of files that have so many rows, by the rows of all of them."""
    left = repeated("\n", 0)
    for count in counts:
        pieces = []
        while count:
            if not len(left):
                left = next(blocks)
            taken, left = left[:count], left[count:]
            pieces.append(without_gaps(taken))
            count -= len(taken)
        yield b"".join(pieces)


def _comments(histories: Sequence[History], request: FileRequest) -> bytes:
    """The comment lines."""
    return "".join([_comment(*one) for one in statements(histories, request).items()]).encode()


@lru_cache(maxsize=100)  # most are the same in many files
def _comment(name: str, sentence: str) -> str:
    safe = _AFTER_COMMA.sub(r"\1'", sentence)
    return f"# {name}: {safe}\n"


def _names(columns: Sequence[TableColumn]) -> bytes:
    """The line of the columns' names."""
    return _lines([[column.name for column in columns]]).encode()


_AFTER_COMMA = re.compile(r"([,;]\s*)(?=[=+@-])")
"""Where a spreadsheet begins a cell of a comment with what it takes for a formula."""


def _rows(values: TableArrays, columns: Sequence[TableColumn]) -> Characters:
    """The rows of a block as lines of the file; numbers need no quotes."""
    numbers = _numbers(values, columns)
    pieces = []
    for name, own in values.items():
        text = numbers[name] if name in numbers else word_text(_cells(_words(own)))
        pieces += [text, repeated(",", len(own))]
    pieces[-1] = repeated("\n", len(own))
    return np.concatenate(pieces, axis=1)


def _cells(words: list[str]) -> list[str]:
    """Words as cells that are no formulas, in quotes where CSV needs them."""
    safe = {word: _quoted(not_a_formula(word)) for word in set(words)}
    return [safe[word] for word in words]


def _quoted(cell: str) -> str:
    """A cell in quotes where CSV needs them."""
    return _lines([[cell, ""]]).removesuffix(",\n")


def _lines(rows: Iterable[Iterable[str]]) -> str:
    page = io.StringIO()
    csv.writer(page, lineterminator="\n").writerows(rows)
    return page.getvalue()
