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
from itertools import chain, islice
from typing import Any

from numpy.typing import NDArray

from vopd.attitude.history import History
from vopd.attitude.history_parts import HistoryParts
from vopd.attitude.table import TableColumn
from vopd.attitude.table_columns import columns_of
from vopd.attitude.table_values import TableArrays, row_blocks, table, table_blocks, table_values
from vopd.export.file_request import FileRequest, TableFile, statements
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
    return {one.name: _texts(values[one.name], one.decimals) for one in columns}


def _texts(values: NDArray[Any], decimals: int | None) -> list[str]:
    """Format the values of a column: six decimals and an exponent if it has no decimals."""
    if values.dtype.kind != "f":
        return list(map(str, values.tolist()))
    form = "%.6e" if decimals is None else f"%.{decimals}f"
    return ["" if one != one else form % one for one in values.tolist()]


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
        yield "".join(_rows(values, columns)).encode()


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
        blocks = row_blocks(table_values(own, histories))
        rows = chain.from_iterable(_rows(values, own) for values in blocks)
        for k in indices:
            count = sum(len(one.estimate.frame) for one in files[k].histories)
            content = "".join(islice(rows, count)).encode()
            made[k] = _comments(files[k].histories, files[k].request) + names + content
    return [made[k] for k in range(len(files))]


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


def _rows(values: TableArrays, columns: Sequence[TableColumn]) -> Iterator[str]:
    """Format the rows of a block as lines of the file; numbers need no quotes."""
    texts = as_text(values, columns)
    cells = [
        texts[name] if own.dtype.kind in "fiu" else _cells(texts[name])
        for name, own in values.items()
    ]
    return (",".join(row) + "\n" for row in zip(*cells, strict=True))


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
