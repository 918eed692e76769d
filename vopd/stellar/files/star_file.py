"""Star files: CSV with a header, one star or ground point a line."""

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
    "u,v,w": ("u", "v", "w"),
    "x_m,y_m,z_m": ("x_m", "y_m", "z_m"),
}
"""Ways to say where a star or point is; a file has one of them."""

READERS: dict[str, Callable[[str], float]] = {
    "ra_deg": partial(parse_angle_deg, hours=True),
    "dec_deg": parse_angle_deg,
}
"""How a column is read, where it is not a plain number."""

LIMITS = {"ra_deg": 360.0, "dec_deg": 90.0}
LIMIT = 1e12
"""Largest size of any other number: nothing measured is larger, and no square overflows."""

NOT_QUITE_UNIT = 1e-6
"""Length error up to which direction cosines count as rounded and are taken as given."""


@dataclass(frozen=True)
class StarFile:
    """What a file holds: n stars, `kind` a key of KINDS or "" for images alone.

    `lines` are the stars' lines in the file, from 1; `names` may be empty texts.
    """

    deck: str
    lines: tuple[int, ...]
    names: tuple[str, ...]
    image_mm: Floats  # (n, 2)
    kind: str
    places: Floats  # (n, 2) degrees, (n, 3) cosines or metres

    def error(self, message: str, *stars: int) -> DeckError:
        """An error about stars (from 0), named by their lines."""
        return DeckError(self.finding(message, *stars))

    def finding(self, message: str, *stars: int) -> Finding:
        """A remark about stars (from 0), named by their lines."""
        where = _lines_text([self.lines[k] for k in stars])
        return Finding(f"{where}: {message}" if where else message, deck=self.deck)


def read_star_file(text: str, deck: str = "", *, images_only: bool = False) -> StarFile:
    """Stars from CSV text; blank lines and lines that begin with # mean nothing.

    The header names `x_mm,y_mm` and one of the KINDS (none with `images_only`,
    where other columns are ignored), and may name `name`. Raises DeckError
    naming the line for all that is wrong, and where there is not one star.
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
    """U, V, W (n, 3) of a file's stars or points; these need the camera's position (3,).

    Direction cosines of length 1 to a millionth are taken as given, as the
    listings take them; others are made so, with a warning. Raises DeckError for
    a vector of no length and for a point at the camera.
    """
    if stars.kind == "ra_deg,dec_deg":
        return star_directions(stars.places[:, 0], stars.places[:, 1])
    if stars.kind == "x_m,y_m,z_m":
        if camera_m is None:
            raise DeckError(Finding("ground points need the camera's position", deck=stars.deck))
        directions = ground_directions(stars.places, camera_m)
        _refuse(stars, ~np.isfinite(directions).all(axis=-1), "the point is at the camera")
        return directions
    length = norm(stars.places)
    _refuse(stars, length < np.finfo(float).tiny ** 0.5, "u, v, w have no direction")
    rounded = np.abs(length - 1.0) <= NOT_QUITE_UNIT
    for k in np.flatnonzero(~rounded):
        message = f"u, v, w have length {length[k]:.6g} and are taken as a direction"
        report(stars.finding(message, int(k)).warned())
    return stars.places / np.where(rounded, 1.0, length)[:, None]


def _refuse(stars: StarFile, bad: Bools | np.bool_, message: str) -> None:
    if bad.any():
        raise stars.error(message, int(np.argmax(bad)))


def _rows(text: str, deck: str) -> list[tuple[int, list[str]]]:
    """Each line's number and cells, blank and # lines left out."""
    rows = []
    for number, line in enumerate(io.StringIO(text.removeprefix("\ufeff")), start=1):
        if line.strip() and not line.lstrip().startswith("#"):
            try:  # line by line: no cell of a star file spans two
                rows.append((number, next(csv.reader([line], strict=True))))
            except csv.Error as error:
                raise _error(f"not CSV: {error}", number, deck) from None
    return rows


def _kind(columns: list[str], number: int, deck: str, images_only: bool) -> str:
    known = {*IMAGE, "name", *(name for kind in KINDS.values() for name in kind)}
    twice = sorted({name for name in columns if columns.count(name) > 1})
    unknown = [name for name in columns if name not in known]
    if twice:
        raise _error(f"the header names a column twice: {', '.join(twice)}", number, deck)
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
    if len(given) != 1:
        raise _error(f"the header must name one of {choices}", number, deck)
    if missing := [name for name in KINDS[given[0]] if name not in columns]:
        raise _error(f"the header lacks {', '.join(missing)}", number, deck)
    return given[0]


def _value(cell: str, name: str, number: int, deck: str) -> float:
    try:
        value = READERS.get(name, parse_number)(cell)
    except ValueError as error:
        raise _error(f"{name}: {error}", number, deck) from None
    limit = LIMITS.get(name, LIMIT)
    if abs(value) > limit:
        raise _error(f"{name}: {cell.strip()} is beyond +-{limit:g}", number, deck)
    return value


def _error(message: str, number: int, deck: str) -> DeckError:
    return DeckError(Finding(f"line {number}: {message}", deck=deck))


def _lines_text(lines: list[int]) -> str:
    if len(lines) < 2:
        return "".join(f"line {n}" for n in lines)
    if len(lines) > 4 and lines == list(range(lines[0], lines[-1] + 1)):
        return f"lines {lines[0]} to {lines[-1]}"
    return f"lines {', '.join(map(str, lines[:-1]))} and {lines[-1]}"
