"""Read star files: CSV with a header and one star or ground point a line."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime

import numpy as np

from vopd.arrays import Floats
from vopd.findings import DeckError, Finding, Report, strict
from vopd.stellar.files.star_columns import KINDS, ColumnError, StarColumns, read_cell, read_columns
from vopd.stellar.files.star_file import MOST_STARS, StarFile
from vopd.stellar.files.star_rows import NumberedRow, read_rows


def read_star_csv(
    text: str, deck: str = "", *, images_only: bool = False, report: Report = strict
) -> list[StarFile]:
    """Read a star file: CSV with a header; blank lines and lines that begin with # are skipped.

    Args:
        text: the file's text
        deck: its name in messages
        images_only: read only the image coordinates and ignore all other columns
        report: takes a warning about columns that are ignored, and errors of one
            photograph of several

    Returns:
        The photographs, in the order in which column `image` first names them;
        without it one. Each has one star at least.

    Raises:
        DeckError: the text is no star file, or has no star, or its one photograph
            cannot be read; it names the line.
    """
    rows = read_rows(text, deck)
    if not rows:
        raise DeckError(Finding("the file has no header: x_mm,y_mm,ra_deg,dec_deg", deck=deck))
    names = tuple(name.strip().lower() for name in rows[0].cells)
    try:
        columns = read_columns(names, images_only=images_only)
    except ColumnError as error:
        raise _error(str(error), rows[0].number, deck) from None
    for row in rows[1:]:
        if len(row.cells) != len(names):
            raise _error(
                f"{len(row.cells)} values, where the header names {len(names)} columns",
                row.number,
                deck,
            )
    if images_only and len(rows) > MOST_STARS + 1:
        message = f"more than {MOST_STARS} stars in one photograph"
        raise _error(message, rows[MOST_STARS + 1].number, deck)
    if len(rows) < 2:
        raise _error("no star follows the header", rows[0].number, deck)
    if columns.ignored:
        text = f"line {rows[0].number}: columns that are ignored: {', '.join(columns.ignored)}"
        report(Finding(text, deck=deck, severity="warning"))
    return _photographs(rows[1:], columns, deck, report)


def read_images_mm(text: str, deck: str = "") -> Floats:
    """Read only the images of a star file, (n, 2), mm; arguments and errors as `read_star_csv`.

    Raises:
        DeckError: also where they are in pixels.
    """
    (file,) = read_star_csv(text, deck, images_only=True)
    if file.unit != "mm":
        raise DeckError(Finding("the images must be in mm: x_mm,y_mm", deck=deck))
    return file.image


def _photographs(
    rows: Sequence[NumberedRow], columns: StarColumns, deck: str, report: Report
) -> list[StarFile]:
    """The stars of each photograph; the errors of one of several cost the others nothing."""
    groups: dict[str, list[NumberedRow]] = {}
    for row in rows:
        name = "" if not columns.kind else _word(row, "image", columns)
        if not name and columns.kind and "image" in columns.names:
            raise _error(
                "image: the cell is empty: which photograph is the star in?", row.number, deck
            )
        groups.setdefault(name, []).append(row)
    found = []
    for name, group in groups.items():
        try:
            found.append(_photograph(name, group, columns, deck))
        except DeckError as error:
            if len(groups) == 1:
                raise
            report(error.finding)
    return found


def _photograph(
    name: str, rows: Sequence[NumberedRow], columns: StarColumns, deck: str
) -> StarFile:
    """The stars of one photograph."""
    return StarFile(
        deck,
        tuple(row.number for row in rows),
        tuple(_word(row, "name", columns) for row in rows),
        _numbers(rows, columns.image, columns, deck),
        columns.unit,
        columns.kind,
        _numbers(rows, KINDS.get(columns.kind, ()), columns, deck),
        photograph=name,
        sigmas=_reading_sigmas(rows, columns, deck),
        magnitude=_optional(rows, "mag", columns, deck),
        elongation=_optional(rows, "elongation", columns, deck),
        utc=_moment(rows, columns, deck),
    )


def _moment(rows: Sequence[NumberedRow], columns: StarColumns, deck: str) -> datetime | None:
    """When the photograph was taken: column utc in ISO 8601, the same in all its lines."""
    moment = None
    for row in rows:
        text = _word(row, "utc", columns)
        if not text:
            continue
        try:
            found = datetime.fromisoformat(text)
            found = found.replace(tzinfo=found.tzinfo or UTC).astimezone(UTC)
        except (ValueError, OverflowError):
            message = f"utc: {text!r} is not an ISO 8601 date and time"
            raise _error(message, row.number, deck) from None
        if moment not in (None, found):
            raise _error("utc: one photograph has two dates", row.number, deck)
        moment = found
    return moment


def _reading_sigmas(rows: Sequence[NumberedRow], columns: StarColumns, deck: str) -> Floats | None:
    """Standard deviations of x and y and their correlation, (n, 3)."""
    if not columns.sigmas:
        return None
    given = _numbers(rows, columns.sigmas, columns, deck)
    both = given[:, :2] if len(columns.sigmas) > 1 else np.repeat(given, 2, axis=1)
    correlation = given[:, 2:] if len(columns.sigmas) > 2 else np.zeros((len(rows), 1))
    return np.hstack([both, correlation])


def _numbers(
    rows: Sequence[NumberedRow], names: Sequence[str], columns: StarColumns, deck: str
) -> Floats:
    """The numbers of some columns, (n, k)."""
    index = [columns.names.index(name) for name in names]
    table = [
        [_number(row, row.cells[k], name, deck) for k, name in zip(index, names, strict=True)]
        for row in rows
    ]
    return np.array(table, dtype=np.float64).reshape(len(rows), len(names))


def _optional(
    rows: Sequence[NumberedRow], name: str, columns: StarColumns, deck: str
) -> Floats | None:
    """The numbers of a column that need not be there, NaN for empty cells, (n,)."""
    if name not in columns.names:
        return None
    k = columns.names.index(name)
    cells = [row.cells[k].strip() for row in rows]
    values = [
        _number(row, cell, name, deck) if cell else np.nan
        for row, cell in zip(rows, cells, strict=True)
    ]
    return np.array(values)


def _number(row: NumberedRow, cell: str, name: str, deck: str) -> float:
    try:
        return read_cell(cell, name)
    except ColumnError as error:
        raise _error(str(error), row.number, deck) from None


def _word(row: NumberedRow, name: str, columns: StarColumns) -> str:
    return row.cells[columns.names.index(name)].strip() if name in columns.names else ""


def _error(message: str, number: int, deck: str) -> DeckError:
    return DeckError(Finding(f"line {number}: {message}", deck=deck))
