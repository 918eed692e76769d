"""Star files: CSV with a header and one star or ground point a line."""

from __future__ import annotations

import csv
import io
import re
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import partial
from itertools import chain
from pathlib import Path

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.files import kind_by_first_bytes, reason
from vopd.findings import (
    Finding,
    InputError,
    Report,
    VopdError,
    count_text,
    input_error,
    listed,
    strict,
)
from vopd.geometry.linear import norm
from vopd.geometry.sexagesimal import parse_angle_deg, parse_number
from vopd.inputs import (
    MOST_COLUMNS,
    is_number,
    no_file,
    plain_digits,
    read_limited,
    utc_moment,
)
from vopd.stellar.field import ground_directions

# Columns, and their cells

UNITS = ("mm", "px")
"""Units of image coordinates; they stand in the names of the columns, `x_mm` or `x_px`."""

KINDS = {
    "ra_deg,dec_deg": ("ra_deg", "dec_deg"),
    "ra_hours,dec_deg": ("ra_hours", "dec_deg"),
    "u,v,w": ("u", "v", "w"),
    "x_m,y_m,z_m": ("x_m", "y_m", "z_m"),
}
"""Columns that tell where a star or point is; a file has one of these sets, or only names, or
nothing but images of stars that are yet to be identified."""

STATED = f"{', '.join(f'`{kind}`' for kind in KINDS)} or name"

POSITION = re.compile(r"(ra|dec|alpha|delta|hip|right|u|v|w|x_m|y_m|z_m|z)([^a-z]|$)")
"""How a column is called that seems to tell where a star or point is."""

SYNONYMS = {
    "ra_deg": ("ra",),
    "ra_hours": ("ra_h", "ra_hour", "ra_hr", "ra_hrs"),
    "dec_deg": ("dec",),
    "x_px": ("x", "xcentroid"),
    "y_px": ("y", "ycentroid"),
    "name": ("star", "star_name", "hip"),
}
"""Other names of columns that may stand where no column says otherwise; it is said which do."""

OF_CATALOGUES = {
    "ra": ("raj2000", "ra_icrs", "raicrs", "_raj2000", "_ra.icrs"),
    "dec": ("dej2000", "decj2000", "de_icrs", "deicrs", "_dej2000", "_de.icrs"),
}
"""How catalogues of VizieR name the columns `ra` and `dec`."""

SEXAGESIMAL = re.compile(r"\s*\+?\d+(:|\s+)\d")
"""A right ascension as catalogues write it, 5:12:3 or 5 12 3, which is hours."""

WORDS = ("name", "image", "utc")
"""Columns of text: the star's name, the photograph that it is in, and its date."""

NUMBERS = ("mag", "elongation")
"""Columns of numbers that may be empty: a star's magnitude, and its image's length over width."""


def _right_ascension_of_hours(text: str) -> float:
    """Read a right ascension in hours, `5.2008`, `5 12 3` or `5h12m3s`, as degrees."""
    degrees = parse_angle_deg(text, hours=True) * (1.0 if "h" in text else 15.0)
    if abs(degrees) > 360.0:
        raise ValueError(f"{text.strip()} is beyond +-24 hours (degrees go in column ra_deg)")
    return degrees


READERS: dict[str, Callable[[str], float]] = {
    "ra_deg": partial(parse_angle_deg, hours=True),
    "ra_hours": _right_ascension_of_hours,
    "dec_deg": parse_angle_deg,
}
"""How a column is read that is not a plain number."""

LIMITS = {"ra_deg": 360.0, "dec_deg": 90.0, "rho_xy": 0.999999}
LIMIT = 1e12
"""Largest size of any other number: nothing measured is larger, and no square overflows."""

SMALLEST_SIGMA, LARGEST_SIGMA = 1e-9, 1e6
"""Standard deviations of image coordinates: no weight made of them overflows."""


class ColumnError(ValueError):
    """A header or a cell that cannot be read; the text says why."""


@dataclass(frozen=True)
class StarColumns:
    """What the header of a star file says."""

    names: tuple[str, ...]  # all columns, in their order, as they are called here
    unit: str  # of the image coordinates, "mm" or "px"
    kind: str  # a key of KINDS, "name", or "" for images alone
    # the columns of standard deviations: none, one, or x, y and possibly rho_xy
    sigmas: tuple[str, ...]
    ignored: tuple[str, ...]  # columns that mean nothing here
    # which columns have other names in the file, as a sentence; empty if none has
    read_as: str = ""

    @property
    def image(self) -> tuple[str, str]:
        """The columns of the image coordinates."""
        return f"x_{self.unit}", f"y_{self.unit}"


def read_columns(
    names: tuple[str, ...], *, images_only: bool, first: Sequence[str] = ()
) -> StarColumns:
    """Find out what a header's columns are.

    Args:
        names: in lower case
        images_only: whether only the images are wanted
        first: the cells of the first star: sexagesimal ones of a column `ra` are hours

    Raises:
        ColumnError: a column stands twice or is missing, or two are of different kinds.
    """
    twice = sorted({name for name in names if name and names.count(name) > 1})
    if twice:
        raise ColumnError(f"the header names a column twice: {', '.join(twice)}")
    own, names = names, _renamed(names, first)
    changed = [k for k, name in enumerate(own) if name != names[k]]
    read_as = f"{', '.join(own[k] for k in changed)} read as {', '.join(names[k] for k in changed)}"
    if "x" in own and "x" not in names:
        read_as += "; if they are mm, name them x_mm, y_mm"
    if "ra" in own and "ra" not in names and "ra_hours" not in names:
        read_as += "; if ra is hours, name it ra_hours"
    given = [unit for unit in UNITS if f"x_{unit}" in names or f"y_{unit}" in names]
    if len(given) > 1:
        raise ColumnError("the header must name x_mm and y_mm, or x_px and y_px, not both")
    unit = given[0] if given else "mm"
    image = (f"x_{unit}", f"y_{unit}")
    if missing := [name for name in image if name not in names]:
        other = "" if given else " (or x_px and y_px)"
        raise ColumnError(
            f"the header must name {image[0]} and {image[1]}{other}: {', '.join(missing)} missing"
        )
    kind = "" if images_only else _kind(names)
    sigmas = () if images_only else _sigmas(names, unit)
    known = {*image, *KINDS.get(kind, ()), *WORDS, *NUMBERS, *sigmas}
    ignored = (
        () if images_only else tuple(filter(None, (name for name in names if name not in known)))
    )
    return StarColumns(names, unit, kind, sigmas, ignored, read_as if changed else "")


def _renamed(names: tuple[str, ...], first: Sequence[str]) -> tuple[str, ...]:
    """Call the columns of a header by the names of this module.

    `x` and `y` are pixels unless a column in mm or a `z` stands beside them; `ra` and `dec` are
    of no account beside positions of another kind.
    """
    for name, others in OF_CATALOGUES.items():
        there = [other for other in others if other in names]
        if there and not any(one in names for one in (name, f"{name}_deg", f"{name}_hours")):
            names = tuple(name if one == there[0] else one for one in names)
    pairs = zip(SYNONYMS["x_px"], SYNONYMS["y_px"], strict=True)
    images = any({*pair} <= {*names} for pair in pairs) and "z" not in names
    images = images and not any(name.endswith("_mm") or name in ("x_px", "y_px") for name in names)
    vectors = any(name in names for name in (*KINDS["u,v,w"], *KINDS["x_m,y_m,z_m"]))
    both = all(any(name.startswith(one) for name in names) for one in ("ra", "dec"))
    here = {}
    for name, others in SYNONYMS.items():
        fits = images if name.endswith("_px") else both and not vectors
        if name == "name":  # a column of numbers may only count the stars
            at = names.index("star") if "star" in names else len(first)
            fits = not any(map(is_number, first[at : at + 1]))
        there = [other for other in others if other in names]
        taken = name in names or (name.startswith("ra_") and {"ra_deg", "ra_hours"} & {*names})
        if fits and len(there) == 1 and not taken:
            here[there[0]] = name
    if here.get("ra") and any(map(SEXAGESIMAL.match, first[names.index("ra") :][:1])):
        here["ra"] = "ra_hours"
    return tuple(here.get(name, name) for name in names)


def read_cell(text: str, name: str) -> float:
    """Read the number in one cell.

    Raises:
        ColumnError: it is not a number, or too large.
    """
    if not text.strip():
        raise ColumnError(f"{name}: the cell is empty")
    try:
        value = READERS.get(name, parse_number)(text)
    except ValueError as error:
        hint = " (with a decimal point, not a comma)" if "," in text else ""
        raise ColumnError(f"{name}: {error}{hint}") from None
    limit = LIMITS.get(name, LIMIT)
    if abs(value) > limit:
        hint = " (are right ascension and declination exchanged?)" if name == "dec_deg" else ""
        raise ColumnError(f"{name}: {text.strip()} is beyond +-{limit:g}{hint}")
    if name.startswith("sigma") and not SMALLEST_SIGMA <= value <= LARGEST_SIGMA:
        raise ColumnError(
            f"{name}: {text.strip()} is not a standard deviation: "
            f"{SMALLEST_SIGMA:g} to {LARGEST_SIGMA:g}"
        )
    return value


OTHER_UNITS = (
    (re.compile("(ra|dec)_rad"), "multiply by 57.2957795131 and call them ra_deg, dec_deg"),
    (re.compile("[xyz]_(ft|feet)"), "multiply by 0.3048 and call them x_m, y_m, z_m"),
)
"""Columns of positions in units that are not read, and what to do."""


def _kind(names: tuple[str, ...]) -> str:
    """Find the set of KINDS that the header names."""
    choices = ", ".join(f"`{kind}`" for kind in KINDS)
    given = [kind for kind, columns in KINDS.items() if any(name in names for name in columns)]
    for units, how in OTHER_UNITS:
        if not given and (other := [name for name in names if units.fullmatch(name)]):
            raise ColumnError(f"{', '.join(other)}: {how}")
    if not given and "name" in names:
        return "name"
    if "ra_deg" in names or "ra_hours" in names:  # dec_deg stands in two sets
        given = [kind for kind in given if not kind.startswith("ra_") or KINDS[kind][0] in names]
    elif "dec_deg" in names and len(given) == 2:
        given = given[:1]
    if not given and not any(POSITION.match(name) for name in names):
        return ""
    if len(given) != 1:
        raise ColumnError(f"the header must name one of {choices}, or name")
    if missing := [name for name in KINDS[given[0]] if name not in names]:
        raise ColumnError(f"the header lacks {', '.join(missing)}")
    return given[0]


def _sigmas(names: tuple[str, ...], unit: str) -> tuple[str, ...]:
    """Find the columns of standard deviations: `sigma` or `sigma_mm`, or one each for x and y."""
    alone = [name for name in ("sigma", f"sigma_{unit}") if name in names]
    both = [name for name in (f"sigma_x_{unit}", f"sigma_y_{unit}") if name in names]
    for other in (one for one in UNITS if one != unit):
        wrong = [name for name in names if name.startswith("sigma") and name.endswith(f"_{other}")]
        if wrong:
            raise ColumnError(f"{wrong[0]}: the images are in {unit}, and so must be their sigmas")
    if len(alone) + bool(both) > 1:
        raise ColumnError(f"the header names two standard deviations: {', '.join(alone + both)}")
    if len(both) == 1:
        raise ColumnError(f"the header must name sigma_x_{unit} and sigma_y_{unit}, or neither")
    if "rho_xy" in names and not both:
        raise ColumnError(f"rho_xy goes with sigma_x_{unit} and sigma_y_{unit}")
    return (*alone, *both, *(["rho_xy"] if both and "rho_xy" in names else []))


# Lines as cells

SEPARATORS = (",", ";", "\t")


def read_rows(text: str, source: str) -> Iterator[tuple[int, list[str]]]:
    """Split each line that is not blank and does not begin with # into cells.

    Lines of separators alone are blank too: spreadsheets write them below a table.

    The separator is the one of comma, semicolon and tab that is most frequent in the header.

    Yields:
        The number of each line in the file, from 1, and its cells.

    Raises:
        InputError: a line is not CSV.
    """
    separator = ""
    lines = io.TextIOWrapper(io.BytesIO(text.removeprefix("\ufeff").encode()), "utf-8")
    for number, line in enumerate(lines, start=1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        separator = separator or max(SEPARATORS, key=line.count)
        try:  # line by line: no cell of a star file spans two
            cells = next(csv.reader([line], strict=True, delimiter=separator))
        except csv.Error as error:
            raise input_error(f"line {number}: not CSV: {reason(error)}", source) from None
        if any(cell.strip() for cell in cells):
            yield number, cells


# One photograph: its stars or ground points, and their images

MOST_STARS = 5000  # how many stars or ground points a photograph may have
NOT_QUITE_UNIT = 1e-6
"""Error of length up to which direction cosines count as rounded and are taken as given."""


@dataclass(frozen=True)
class PixelFormat:
    """What a file format says about its pixels."""

    # coordinate of the centre of the first pixel: 0, 1 in FITS, .5 in others
    first_centre: float = 0.0
    y_down: bool = False  # whether the format counts y downward, so that nobody need say so
    # horizontal field of view that the file states; None: none
    field_of_view_deg: float | None = None
    distortion: float = 0.0  # that of tetra3 at half the width, as a fraction, 0 for none


@dataclass(frozen=True)
class StarFile:
    """One photograph's n stars or ground points."""

    source: str  # the file's name in messages
    lines: tuple[int, ...]  # the stars' lines in the file, counted from 1
    names: tuple[str, ...]  # their names; empty texts where there are none
    image: Floats  # x, y of their images as the file has them, (n, 2)
    unit: str  # of the images, "mm" or "px"
    # a key of KINDS; "name" where stars are given by name alone, "" for images alone, and
    # "identified" for those whose stars were looked up in a catalogue
    kind: str
    # right ascension and declination, (n, 2), degrees; direction cosines, (n, 3); or coordinates,
    # (n, 3), metres
    positions: Floats
    photograph: str = ""  # its name, where the file has several; otherwise empty
    # standard deviations of x and y and their correlation, (n, 3); None: not stated
    sigmas: Floats | None = None
    magnitude: Floats | None = None  # of the stars, (n,), NaN where unknown; None: no column
    # length over width of the images, (n,), NaN where unknown; None: no column
    elongation: Floats | None = None
    utc: datetime | None = None  # when the photograph was taken; None: not stated
    pixels: PixelFormat = PixelFormat()  # what the format says about pixels
    line_word: str = "line"  # what a line is called in messages
    # which columns have other names in the file, as a sentence; empty if none has
    read_as: str = ""
    notes: tuple[Finding, ...] = ()  # warnings of how its stars were identified

    def error(self, message: str, *stars: int) -> InputError:
        """Make an error about some stars (counted from 0) that names their lines."""
        return InputError(self.finding(message, *stars))

    def finding(self, message: str, *stars: int) -> Finding:
        """Make a finding about some stars (counted from 0) that names their lines.

        A finding about none of them names the photograph, where the file has several.
        """
        where = lines_text([self.lines[k] for k in stars], self.line_word)
        if not where and self.photograph:
            where = f"photograph {self.photograph}"
        return Finding(f"{where}: {message}" if where else message, source=self.source)


def file_directions(
    stars: StarFile, camera_m: Sequence[float] | None = None, report: Report = strict
) -> Floats:
    """Find the unit vectors U, V, W of a file's direction cosines or ground points.

    Direction cosines of length 1 to a millionth are taken as given, as the
    listings take them; others are divided by their length, with a warning.

    Args:
        stars: the file
        camera_m: the camera's position, metres, of ground points; None for direction cosines
        report: takes the warnings

    Returns:
        Unit vectors, (n, 3).

    Raises:
        InputError: a vector has no length, or a point is at the camera.
    """
    if camera_m is not None:
        directions = ground_directions(stars.positions, np.array(camera_m))
        _refuse(stars, ~np.isfinite(directions).all(axis=-1), "the point is at the camera")
        return directions
    length = norm(stars.positions)
    _refuse(stars, length < np.finfo(float).tiny ** 0.5, "u, v, w have no direction")
    rounded = np.abs(length - 1.0) <= NOT_QUITE_UNIT
    for k in np.flatnonzero(~rounded):
        message = f"u, v, w have length {length[k]:.6g} and are taken as a direction"
        report(stars.finding(message, int(k)).warned())
    return stars.positions / np.where(rounded, 1.0, length)[:, None]


def lines_text(lines: list[int], word: str = "line") -> str:
    """Format line numbers in words: `line 3`, `lines 3 and 4`, `lines 3 to 9`."""
    if len(lines) < 2:
        return "".join(f"{word} {n}" for n in lines)
    plural = f"{word}es" if word.endswith("ch") else f"{word}s"
    if len(lines) > 4 and lines == list(range(lines[0], lines[-1] + 1)):
        return f"{plural} {lines[0]} to {lines[-1]}"
    return f"{plural} {listed([*map(str, lines)])}"


def _refuse(stars: StarFile, bad: Bools | np.bool_, message: str) -> None:
    """Refuse the first star for which something is wrong."""
    if bad.any():
        raise stars.error(message, int(np.argmax(bad)))


# Photographs of a CSV file


def read_star_csv(
    text: str, source: str = "", *, images_only: bool = False, report: Report = strict
) -> list[StarFile]:
    """Read a star file: CSV with a header; blank lines and lines that begin with # are skipped.

    Args:
        text: the file's text
        source: its name in messages
        images_only: read only the image coordinates and ignore all other columns
        report: takes a warning about columns that are ignored, and errors of one
            photograph of several

    Returns:
        The photographs, in the order in which column `image` first names them;
        without it one. Each has one star at least.

    Raises:
        InputError: the text is no star file, or has no star, or its one photograph
            cannot be read; it names the line.
    """
    rows = read_rows(text, source)
    header, cells = next(rows, (0, []))
    if not cells:
        raise input_error("the file has no header: x_mm,y_mm,ra_deg,dec_deg", source)
    if len(cells) > MOST_COLUMNS:
        message = f"line {header}: {count_text(len(cells), 'column')}, {MOST_COLUMNS} at most"
        raise input_error(message, source)
    names = tuple(name.strip().lower() for name in cells)
    try:
        first = next(rows, None)
        columns = read_columns(names, images_only=images_only, first=first[1] if first else ())
    except ColumnError as error:
        raise input_error(f"line {header}: {error}", source) from None
    own, names = names, columns.names
    pairs = enumerate(zip(own, names, strict=True))  # of a column ra, by the first star
    taken = next((k for k, (was, name) in pairs if name == "ra_deg" != was), -1)
    if columns.read_as:
        report(Finding(f"line {header}: {columns.read_as}", source=source, severity="warning"))
    several = "image" in names and not images_only
    groups: dict[str, list[Star]] = {}
    for number, cells in chain([first] if first else [], rows):
        if len(cells) != len(names):
            given, named = count_text(len(cells), "value"), count_text(len(names), "column")
            text = f"{given}, where the header names {named}"
            raise input_error(f"line {number}: {text}", source)
        if taken >= 0 and SEXAGESIMAL.match(cells[taken]):
            text = f"{own[taken]}: {cells[taken].strip()} is hours, and the first star has degrees"
            rename = "name the column ra_hours or ra_deg"
            raise input_error(f"line {number}: {text}: {rename}", source)
        star = dict(zip(names, cells, strict=True))
        name = star["image"].strip() if several else ""
        if several and not name:
            text = "image: the cell is empty: which photograph is the star in?"
            raise input_error(f"line {number}: {text}", source)
        group = groups.setdefault(name, [])
        if len(group) <= MOST_STARS:  # one more tells that there are too many
            group.append((number, star))
        elif not several:
            break
    if not groups:
        raise input_error(f"line {header}: no star follows the header", source)
    if columns.ignored:
        text = f"line {header}: columns that are ignored: {', '.join(columns.ignored)}"
        report(Finding(text, source=source, severity="warning"))
    found = []
    for name, group in groups.items():
        try:
            found.append(_photograph(name, group, columns, source))
        except InputError as error:
            if len(groups) == 1:
                raise
            report(error.finding)
    return found


def read_images_mm(text: str, source: str = "") -> Floats:
    """Read only the images of a star file, (n, 2), mm; arguments and errors as `read_star_csv`.

    Raises:
        InputError: also where they are in pixels.
    """
    (file,) = read_star_csv(text, source, images_only=True)
    if file.unit != "mm":
        raise input_error("the images must be in mm: x_mm,y_mm", source)
    return file.image


Star = tuple[int, dict[str, str]]
"""The number of a star's line, and its cells by the names of columns."""


def _photograph(name: str, stars: Sequence[Star], columns: StarColumns, source: str) -> StarFile:
    """Read the stars of one photograph."""

    def numbers(*names: str) -> Floats:
        """Read the numbers of some columns, (n, k)."""
        plain = [_plain_numbers(stars, name) for name in names]
        if plain and all(one is not None for one in plain):
            return np.array(plain).T.copy()
        rows = [[_number(star, name, source) for name in names] for star in stars]
        return np.array(rows, dtype=np.float64).reshape(len(stars), len(names))

    def known_numbers(name: str) -> Floats | None:
        """Read the numbers of a column that need not be there, NaN for empty cells, (n,)."""
        if name not in columns.names:
            return None
        known = (_number(star, name, source) if star[1][name].strip() else np.nan for star in stars)
        return np.array(list(known))

    if len(stars) > MOST_STARS:
        text = f"line {stars[MOST_STARS][0]}: more than {MOST_STARS} stars in one photograph"
        raise input_error(text, source)
    image, positions = numbers(*columns.image), numbers(*KINDS.get(columns.kind, ()))
    sigmas = numbers(*columns.sigmas) if columns.sigmas else None
    if sigmas is not None:
        both = sigmas[:, :2] if len(columns.sigmas) > 1 else np.repeat(sigmas, 2, axis=1)
        correlation = sigmas[:, 2:] if len(columns.sigmas) > 2 else np.zeros((len(stars), 1))
        sigmas = np.hstack([both, correlation])
    return StarFile(
        source,
        tuple(number for number, _ in stars),
        tuple(star.get("name", "").strip() for _, star in stars),
        image,
        columns.unit,
        columns.kind,
        positions,
        pixels=PixelFormat(y_down=columns.unit == "px"),
        photograph=name,
        sigmas=sigmas,
        magnitude=known_numbers("mag"),
        elongation=known_numbers("elongation"),
        utc=_moment(stars, source),
        read_as=columns.read_as,
    )


def _plain_numbers(stars: Sequence[Star], name: str) -> Floats | None:
    """Read a column of decimal numbers at once, (n,); None if each cell must be looked at."""
    texts = [cells[name] for _, cells in stars]
    if name == "ra_hours" or name.startswith("sigma") or not plain_digits(texts):
        return None
    try:
        found = np.array(texts, dtype=np.float64)
    except ValueError:
        return None
    return found if (np.abs(found) <= LIMITS.get(name, LIMIT)).all() else None


def _number(star: Star, name: str, source: str) -> float:
    """Read the number in one cell of a star's line."""
    number, cells = star
    try:
        return read_cell(cells[name], name)
    except ColumnError as error:
        raise input_error(f"line {number}: {error}", source) from None


def _moment(stars: Sequence[Star], source: str) -> datetime | None:
    """Read the date of the photograph: column utc in ISO 8601, the same in all its lines."""
    moment = None
    for number, cells in stars:
        text = cells.get("utc", "").strip()
        if not text:
            continue
        try:
            found = utc_moment(text, of_day=True)
        except VopdError as error:
            raise input_error(f"line {number}: utc: {error}", source) from None
        if moment not in (None, found):
            raise input_error(f"line {number}: utc: one photograph has two dates", source)
        moment = found
    return moment


# Input files as bytes and as text

STANDARD_INPUT = "standard input"


def read_bytes(name: str) -> tuple[bytes, str]:
    """Read an input file.

    Args:
        name: the file's name; `-` is standard input

    Returns:
        Its bytes, and what to call it in messages.

    Raises:
        InputError: it cannot be read.
    """
    source = STANDARD_INPUT if name == "-" else name
    try:
        if name == "-":
            return read_limited(sys.stdin.buffer), source
        if kind := no_file(name, pipes=True):
            raise ValueError(kind)
        with Path(name).open("rb") as file:
            return read_limited(file), source
    except (OSError, ValueError) as error:  # ValueError: a null in the name
        reason = str(getattr(error, "strerror", None) or error)
        raise input_error(f"cannot be read: {reason}", source) from None


def read_text(name: str) -> tuple[str, str]:
    """Read an input file as text; arguments, result and errors as `read_bytes` and `as_text`."""
    data, source = read_bytes(name)
    return decoded_text(data, source), source


def decoded_text(data: bytes, source: str) -> str:
    """Decode the text of a file.

    Raises:
        InputError: it is empty, or is not UTF-8 text.
    """
    kind = kind_by_first_bytes(data)
    if kind is not None:
        raise input_error(f"this is {kind}; {_advice(kind)}", source)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        text = f"not UTF-8 text (byte 0x{data[error.start]:02X}): save it as UTF-8"
        raise input_error(f"line {line}: {text}", source) from None
    if "\0" in text:
        line = text[: text.index("\0")].count("\n") + 1
        raise input_error(f"line {line}: not text: it holds a null byte", source)
    if not text.strip():
        raise input_error("line 1: the file is empty", source)
    return text


def _advice(kind: str) -> str:
    """Advise what to do with a file of another kind."""
    if kind.endswith("image"):
        return (
            "the stars in it must be found and identified first: give their image coordinates as "
            "CSV, or corr.fits of astrometry.net, or the JSON of tetra3"
        )
    if kind.endswith("archive"):
        return "unpack it first"
    return "save it as UTF-8 text" if kind.endswith("text") else "export it as CSV"
