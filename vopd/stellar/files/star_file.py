"""Read star files: CSV with a header and one star or ground point a line."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.findings import DeckError, Finding, Report, strict
from vopd.geometry.sexagesimal import parse_angle_deg, parse_number
from vopd.geometry.vectors import norm
from vopd.stellar.directions import ground_directions, star_directions

IMAGE = ("x_mm", "y_mm")
KINDS = {
    "ra_deg,dec_deg": ("ra_deg", "dec_deg"),
    "ra_hours,dec_deg": ("ra_hours", "dec_deg"),
    "u,v,w": ("u", "v", "w"),
    "x_m,y_m,z_m": ("x_m", "y_m", "z_m"),
}
"""Columns that tell where a star or point is; a file has one of these sets."""


def _right_ascension_of_hours(text: str) -> float:
    """Degrees of a right ascension in hours: `5.2008`, `5 12 3` or `5h12m3s`."""
    marked = "h" in text.lower()
    degrees = parse_angle_deg(text, hours=True) * (1.0 if marked else 15.0)
    if abs(degrees) > 360.0:
        raise ValueError(f"{text.strip()} is beyond +-24 hours")
    return degrees


READERS: dict[str, Callable[[str], float]] = {
    "ra_deg": partial(parse_angle_deg, hours=True),
    "ra_hours": _right_ascension_of_hours,
    "dec_deg": parse_angle_deg,
}
"""How a column is read that is not a plain number."""

LIMITS = {"ra_deg": 360.0, "dec_deg": 90.0}
LIMIT = 1e12
"""Largest size of any other number: nothing measured is larger, and no square overflows."""

MOST_STARS = 5000
"""How many stars or ground points a file may have: it is one photograph."""

NOT_QUITE_UNIT = 1e-6
"""Error of length up to which direction cosines count as rounded and are taken as given."""


@dataclass(frozen=True)
class StarFile:
    """The contents of a star file: n stars or ground points.

    Attributes:
        deck: the file's name in messages
        lines: the stars' lines in the file, counted from 1
        names: their names; empty texts where there are none
        image_mm: x, y of their images, (n, 2), mm
        kind: a key of KINDS, or "" for a file of images alone
        positions: right ascension and declination, (n, 2), degrees; direction
            cosines, (n, 3); or coordinates, (n, 3), metres
    """

    deck: str
    lines: tuple[int, ...]
    names: tuple[str, ...]
    image_mm: Floats
    kind: str
    positions: Floats

    def error(self, message: str, *stars: int) -> DeckError:
        """Make an error about some stars (counted from 0) that names their lines."""
        return DeckError(self.finding(message, *stars))

    def finding(self, message: str, *stars: int) -> Finding:
        """Make a finding about some stars (counted from 0) that names their lines."""
        where = _lines_text([self.lines[k] for k in stars])
        return Finding(f"{where}: {message}" if where else message, deck=self.deck)


def read_star_file(text: str, deck: str = "", *, images_only: bool = False) -> StarFile:
    """Read a star file: CSV with a header; blank lines and lines that begin with # are skipped.

    Args:
        text: the file's text
        deck: its name in messages
        images_only: read `x_mm,y_mm` and ignore all other columns; otherwise the
            header names these, one set of KINDS, and possibly `name`

    Returns:
        The stars, one at least.

    Raises:
        DeckError: the text is no star file, or has no star; it names the line.
    """
    rows = _rows(text, deck)
    if not rows:
        raise DeckError(Finding("the file has no header: x_mm,y_mm,ra_deg,dec_deg", deck=deck))
    number, header = rows[0]
    columns = [name.strip().lower() for name in header]
    kind = _kind(columns, number, deck, images_only)
    wanted = (*IMAGE, *KINDS.get(kind, ()))
    table: list[list[float]] = []
    names: list[str] = []
    for number, cells in rows[1:]:
        if len(cells) != len(columns):
            raise _error(
                f"{len(cells)} values, where the header names {len(columns)} columns", number, deck
            )
        star = dict(zip(columns, cells, strict=True))
        table.append([_value(star[name], name, number, deck) for name in wanted])
        names.append(star.get("name", "").strip())
    if not table:
        raise _error("no star follows the header", number, deck)
    values = np.array(table)
    lines = tuple(n for n, _ in rows[1:])
    return StarFile(deck, lines, tuple(names), values[:, :2], kind, values[:, 2:])


def file_directions(
    stars: StarFile, camera_m: Floats | None = None, report: Report = strict
) -> Floats:
    """Unit vectors U, V, W of a file's stars or ground points.

    Direction cosines of length 1 to a millionth are taken as given, as the
    listings take them; others are divided by their length, with a warning.

    Args:
        stars: the file
        camera_m: the camera's position, (3,), metres; needed for ground points
        report: takes the warnings

    Returns:
        Unit vectors, (n, 3).

    Raises:
        DeckError: a vector has no length, or a point is at the camera.
    """
    if stars.kind in ("ra_deg,dec_deg", "ra_hours,dec_deg"):
        return star_directions(stars.positions[:, 0], stars.positions[:, 1])
    if stars.kind == "x_m,y_m,z_m":
        if camera_m is None:
            raise DeckError(Finding("ground points need the camera's position", deck=stars.deck))
        directions = ground_directions(stars.positions, camera_m)
        _refuse(stars, ~np.isfinite(directions).all(axis=-1), "the point is at the camera")
        return directions
    length = norm(stars.positions)
    _refuse(stars, length < np.finfo(float).tiny ** 0.5, "u, v, w have no direction")
    rounded = np.abs(length - 1.0) <= NOT_QUITE_UNIT
    for k in np.flatnonzero(~rounded):
        message = f"u, v, w have length {length[k]:.6g} and are taken as a direction"
        report(stars.finding(message, int(k)).warned())
    return stars.positions / np.where(rounded, 1.0, length)[:, None]


def _refuse(stars: StarFile, bad: Bools | np.bool_, message: str) -> None:
    """Raise an error about the first star for which something is wrong."""
    if bad.any():
        raise stars.error(message, int(np.argmax(bad)))


def _rows(text: str, deck: str) -> list[tuple[int, list[str]]]:
    """Number and cells of each line that is not blank and does not begin with #."""
    rows = []
    for number, line in enumerate(io.StringIO(text.removeprefix("\ufeff")), start=1):
        if line.strip() and not line.lstrip().startswith("#"):
            try:  # line by line: no cell of a star file spans two
                rows.append((number, next(csv.reader([line], strict=True))))
            except csv.Error as error:
                raise _error(f"not CSV: {error}", number, deck) from None
            if len(rows) > MOST_STARS + 1:
                message = f"more than {MOST_STARS} stars: one photograph is solved at a time"
                raise _error(message, number, deck)
    return rows


def _kind(columns: list[str], number: int, deck: str, images_only: bool) -> str:
    """Which set of KINDS the header names; raises DeckError where it names none or two."""
    known = {*IMAGE, "name", *(name for kind in KINDS.values() for name in kind)}
    twice = sorted({name for name in columns if columns.count(name) > 1})
    unknown = [name for name in columns if name not in known]
    if twice:
        raise _error(f"the header names a column twice: {', '.join(twice)}", number, deck)
    if len(columns) == 1 and {";", "\t"} & set(columns[0]):
        raise _error("the columns must be separated by commas", number, deck)
    if missing := [name for name in IMAGE if name not in columns]:
        raise _error(
            f"the header must name x_mm and y_mm: {', '.join(missing)} missing", number, deck
        )
    if images_only:
        return ""
    choices = ", ".join(f"`{kind}`" for kind in KINDS)
    if unknown:
        known_text = f"x_mm, y_mm, name and one of {choices}"
        raise _error(f"unknown column {unknown[0]!r}: a star file has {known_text}", number, deck)
    given = [kind for kind, names in KINDS.items() if any(name in columns for name in names)]
    if "ra_deg" in columns or "ra_hours" in columns:  # dec_deg stands in two sets
        given = [kind for kind in given if not kind.startswith("ra_") or KINDS[kind][0] in columns]
    elif "dec_deg" in columns and len(given) == 2:
        given = given[:1]
    if len(given) != 1:
        raise _error(f"the header must name one of {choices}", number, deck)
    if missing := [name for name in KINDS[given[0]] if name not in columns]:
        raise _error(f"the header lacks {', '.join(missing)}", number, deck)
    return given[0]


def _value(cell: str, name: str, number: int, deck: str) -> float:
    """The number in one cell; raises DeckError, naming line and column."""
    try:
        value = READERS.get(name, parse_number)(cell)
    except ValueError as error:
        raise _error(f"{name}: {error}", number, deck) from None
    limit = LIMITS.get(name, LIMIT)
    if abs(value) > limit:
        hint = " (are right ascension and declination exchanged?)" if name == "dec_deg" else ""
        raise _error(f"{name}: {cell.strip()} is beyond +-{limit:g}{hint}", number, deck)
    return value


def _error(message: str, number: int, deck: str) -> DeckError:
    return DeckError(Finding(f"line {number}: {message}", deck=deck))


def _lines_text(lines: list[int]) -> str:
    """Lines in words: `line 3`, `lines 3 and 4`, `lines 3 to 9`."""
    if len(lines) < 2:
        return "".join(f"line {n}" for n in lines)
    if len(lines) > 4 and lines == list(range(lines[0], lines[-1] + 1)):
        return f"lines {lines[0]} to {lines[-1]}"
    return f"lines {', '.join(map(str, lines[:-1]))} and {lines[-1]}"
