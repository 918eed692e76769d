"""Tables with a header line: their columns as numbers, times and texts, read whole or in blocks."""

from __future__ import annotations

import csv
import re
from array import array
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, tzinfo
from itertools import chain

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.files import names_stars, reason
from vopd.findings import (
    LONG_WORD,
    MANY_NAMED,
    VopdError,
    count_text,
    did_you_mean,
    first_of,
    nearest_word,
    shown,
)
from vopd.flight.coordinates import M_PER_FT
from vopd.flight.formats.columns import (
    CLOCK,
    COORDINATES,
    DATES,
    DEGREES,
    FEET,
    FROM_GROUND,
    HEIGHTS,
    HEIGHTS_FT,
    IN_FEET,
    IN_METRES,
    MILLISECONDS,
    OF_STARS,
    PLANE,
    SYNONYMS,
    TIME,
    mapped,
    other_sense,
    other_unit,
    own_names,
    plain_name,
)
from vopd.flight.formats.files import InputFile
from vopd.inputs import (
    LATE_S,
    LEAST_SIGMA,
    LONGEST_LINE,
    LONGEST_NAME,
    MOST_COLUMNS,
    MOST_NUMBER,
    MOST_SIGMA,
    beyond_sigmas,
    date_alone,
    is_number,
    leap_second,
    plain_digits,
    plain_number,
    read_moment,
)

MANY_UNUSED = 12  # columns that are listed
LIKE_HEIGHT = re.compile(r"(^|_)(h|z|alt\w*|elev\w*|height|high)(_|$)")
OTHER_SPEED = re.compile(r"(?:km_?h|kmph|kph|mph)$")
ONE_OF = TIME[::-1], ("image", "frame")
"""Columns of which the first that is there is read."""
DATE = re.compile(r"\d{1,4}[-/.]\d{1,2}[-/.]\d{1,4}")
TIME_OF_DAY = re.compile(r"\d{1,2}:\d\d")
SEXAGESIMAL = re.compile(r"\d\s*[°º:'′NSEWnsew]|[NSEWnsew]\s*\d|\d\s+\d")  # noqa: RUF001
"""In degrees with minutes, or with a letter for their sign."""
COMMENTS = "a line that begins with # is a comment: write a name that begins so in quotes"
QUOTED = re.compile(r'[",#\s]').search
DIGITS = 16  # from there on it is not the number of a frame
EXACT = "exact"
NO_WORDS: Mapping[str, float] = {}
UNKNOWN: Mapping[str, float] = {"": np.nan}
UNKNOWN_OR_EXACT: Mapping[str, float] = {"": np.nan, EXACT: 0.0}
"""Cells of standard deviations that are no numbers."""


def _instead(words: Mapping[str, float]) -> str:
    """Name the words that may stand in the place of a number."""
    exact = f", or write {EXACT}" if EXACT in words else ""
    return f"; leave the cell empty where it is not known{exact}" if words else ""


def name_cell(name: str) -> str:
    """Write a name as a cell that is read as this name, also where it begins with #."""
    return f'"{name.replace(chr(34), 2 * chr(34))}"' if QUOTED(name) else name


WORDS = ("NORTH", "SOUTH", "EAST", "WEST")  # for the letters that they begin with


def _letter(cell: str) -> str:
    """Write the sign of a degree as a letter; any other text in capitals."""
    text = cell.upper()
    return text[0] if text in WORDS else text


Cells = str | tuple[str, ...]
"""The texts of some cells; as one text, a line feed between two, they take less memory."""


@dataclass(frozen=True, eq=False)
class CsvTable:
    """The rows below a header line, or some of them."""

    file: InputFile
    header: list[str]  # names as they are here
    columns: list[list[Cells]]  # blocks of rows, for each name in the header
    line: Sequence[int]  # of each row, from 1
    own: Sequence[str] = ()  # names as they are in the file; empty for the same
    known: Sequence[str] = ()  # names that columns may have here

    @property
    def read_as(self) -> str:
        """Say which columns have other names here; empty if none has."""
        there = [k for k, own in enumerate(self.own) if own != self.header[k] != ""]
        own, here = (", ".join(names[k] for k in there) for names in (self.own, self.header))
        unit = ", the time in milliseconds" if self.in_ms(TIME[0]) else ""
        unit += ", the height in feet" if any(map(self.in_feet, HEIGHTS)) else ""
        said = [f"{own} read as {here}{unit}"] if there else []
        said += [f"not used: {first_of(unused, MANY_UNUSED)}"] if (unused := self._unused()) else []
        return f" ({'; '.join(said)})" if said else ""

    def _unused(self) -> list[str]:
        """List the columns that the file names and that are not read, by its own names."""
        if isinstance(self.file.columns, list):
            return []  # the project names them, each of which it knows
        read = {*self.known}
        for some in ONE_OF:
            read -= {*[name for name in some if name in read and self.has(name)][1:]}
        if self.has("lat_deg"):
            read -= {*PLANE}
        read |= {self.header[k] for k in self._date("t_utc")}
        pairs = zip(self.own, self.header, strict=True)
        return [own for own, name in pairs if own and name not in read]

    def check_signs(self, degrees: Floats) -> None:
        """Refuse a south or west that stands beside the number in a column of its own, (n, 2).

        Raises:
            VopdError: naming its row
        """
        for name in self._unused():
            header = self.header[self.own.index(name)]
            if not {*map(_letter, next(self.blocks(header), []))} <= {*"NSEWO", ""}:
                continue  # no signs, as its first rows tell
            letters = [*map(_letter, self.column(header))]
            if "O" in letters:  # Ost or Ouest, as the other letter tells
                other = "W" if "E" in letters else "E"
                letters = [other if one == "O" else one for one in letters]
            for axis, (plus, minus) in enumerate((("E", "W"), ("N", "S"))):
                if minus in letters and {*letters} <= {plus, minus, ""}:
                    below = [one == minus for one in letters] & (degrees[:, axis] > 0.0)
                    for row in np.flatnonzero(below)[:1].tolist():
                        message = f"{minus} is the sign of {degrees[row, axis]:g}, which is not"
                        what = "latitudes in the south" if axis else "longitudes in the west"
                        message += f" read: write {what} below 0, and remove the column"
                        raise self.error(message, row, name)

    def check_degrees(self, degrees: Floats) -> None:
        """Refuse a longitude or latitude that is none, (n, 2).

        Raises:
            VopdError: naming its row
        """
        size = np.abs(degrees)
        for row in np.flatnonzero(size[:, 1] > 90.0)[:1].tolist():
            turned = size[row, 0] <= 90.0 and size[row, 1] <= 360.0
            hint = "are lat_deg and lon_deg exchanged?" if turned else "it is -90 to 90"
            raise self.error(f"{degrees[row, 1]:g} is no latitude: {hint}", row, "lat_deg")
        for row in np.flatnonzero(size[:, 0] > 360.0)[:1].tolist():
            message = f"{degrees[row, 0]:g} is no longitude: it is -180 to 360"
            raise self.error(message, row, "lon_deg")

    def has(self, name: str) -> bool:
        """Tell whether there is such a column."""
        return name in self.header

    def column(self, name: str) -> list[str]:
        """Read the texts of a column.

        Raises:
            VopdError: where there is none
        """
        return [text for block in self.blocks(name) for text in block]

    def blocks(self, name: str) -> Iterator[list[str]]:
        """Read the texts of a column, block by block.

        Raises:
            VopdError: where there is none
        """
        if name not in self.header:
            raise self.file.error(f"no column {name}{self._instead_of(name)}", 1)
        for block in self.columns[self.header.index(name)]:
            yield [*map(str.strip, block.split("\n") if isinstance(block, str) else block)]

    def take(self, rows: Bools) -> CsvTable:
        """Take some of the rows, by a mark for each."""
        kept, columns = np.flatnonzero(rows).tolist(), list[list[Cells]]()
        for blocks in self.columns:
            each = [one.split("\n") if isinstance(one, str) else one for one in blocks]
            texts = [*chain.from_iterable(each)]
            columns.append([tuple(texts[k] for k in kept)])
        return replace(self, columns=columns, line=[self.line[k] for k in kept])

    def _instead_of(self, name: str) -> str:
        """Say which column may be one that is missing: those that have no other use here."""
        if names_stars(self.header):
            return OF_STARS
        free = self._free()
        near = nearest_word(name, free)
        if not self.known:
            return did_you_mean(name, self.header)
        if not free:  # each has its own use
            return f"; it has {', '.join([*filter(None, self.header)][:MANY_NAMED])}"
        feet = [one for one in free if IN_FEET.search(plain_name(one))]
        if name in COORDINATES and name not in HEIGHTS and feet:
            return f": {feet[0]} seems to be in feet; multiply by 0.3048 and call it {name}"
        speeds = [one for one in near or free if OTHER_SPEED.search(plain_name(one))]
        if name == "speed_m_s" and speeds:
            unit = OTHER_SPEED.search(plain_name(speeds[0]))
            assert unit is not None
            factor = 0.44704 if unit[0].startswith("mp") else 1.0 / 3.6
            how = f"multiply by {factor:.5g} and call it {name}"
            return f": {speeds[0]} seems to be in {unit[0].replace('_', '/')}; {how}"
        if other := [*filter(None, (other_sense(one, name) for one in free))]:
            return f": {other[0]}"
        if units := [*filter(None, (other_unit(one, name) for one in free))]:
            return f": {units[0]}"
        if name in HEIGHTS:
            free = [one for one in free if LIKE_HEIGHT.search(plain_name(one))] or free
        only = near or free[: len(free) == 1]
        if name == "t_s" and only and any(map(DATE.match, self.column(only[0])[:1])):
            name = "t_utc"
        which = only[0] if only else f"one of {', '.join(free[:MANY_NAMED])}"
        that = " if it is that" if only and not near else ""
        if name == "speed_m_s":
            that = " if it is in m/s, to speed_kt if it is in knots"
        line = f", or map it, {mapped(name, only[0] if only else '...')}"
        return f": rename {which} to {name}{that}{line * self.file.mappable}"

    def require(self, names: Sequence[str]) -> None:
        """Refuse a table that lacks several columns, all of them at once.

        Args:
            names: of columns that it needs

        Raises:
            VopdError: where two or more are missing; of one alone reading it says so
        """
        lacking = [name for name in names if name not in self.header]
        free = self._free() if len(lacking) > 1 else []
        if free and names_stars(self.header):
            raise self.file.error(f"no columns {', '.join(lacking)}{OF_STARS}", 1)
        feet = [one for one in free if IN_FEET.search(plain_name(one))]
        if len(feet) > 1 and {"x_m", "lat_deg"} & {*lacking}:
            has = f"no columns {', '.join(lacking)}: {', '.join(feet[:MANY_NAMED])} are feet"
            do = "state a grid that counts in feet as crs, such as EPSG:2229, or multiply by 0.3048"
            raise self.file.error(f"{has}: {do} and call them x_m, y_m", 1)
        pairs_of = ((one, name) for name in lacking for one in free)
        if others := [*filter(None, (other_unit(*one) or other_sense(*one) for one in pairs_of))]:
            raise self.file.error(f"no columns {', '.join(lacking)}: {'; '.join(others)}", 1)
        if free:
            near = {name: nearest_word(name, free) for name in lacking}
            pairs = ", ".join(f'{name} = "{(near[name] or ["..."])[0]}"' for name in lacking)
            message = f"no columns {', '.join(lacking)}: rename {', '.join(free[:MANY_NAMED])}"
            line = f", or map them, columns = {{ {pairs} }}" * self.file.mappable
            raise self.file.error(f"{message}{line}", 1)

    def _free(self) -> list[str]:
        """List the columns that have no other use here."""
        used = {*self.known, *SYNONYMS, *TIME, ""}
        return [one for one in self.header if one not in used and not is_number(one)]

    def numbers(self, name: str, words: Mapping[str, float] = NO_WORDS) -> Floats:
        """Read the numbers of a column.

        Args:
            name: the column's
            words: what an empty cell, or one with a word in it, stands for

        Raises:
            VopdError: where one is not a finite number
        """
        found = np.empty(len(self.line))
        row = 0
        for texts in self.blocks(name):
            found[row : row + len(texts)] = self._numbers(name, row, texts, words)
            row += len(texts)
        return found * M_PER_FT if self.in_feet(name) else found

    def sigmas(self, name: str, words: Mapping[str, float] = UNKNOWN) -> Floats:
        """Read the standard deviations of a column; NaN for an empty cell, or without the column.

        Args:
            name: the column's
            words: what an empty cell, or one with a word in it, stands for

        Raises:
            VopdError: where one is not a number above 0
        """
        if not self.has(name):
            return np.full(len(self.line), np.nan)
        found = self.numbers(name, words)
        wrong = np.flatnonzero((found < LEAST_SIGMA) | (found > MOST_SIGMA))
        texts = self.column(name) if len(wrong) else []
        for row in [k for k in wrong.tolist() if texts[k] not in words][:1]:
            message = f"{found[row]:g} is not a standard deviation, which is above 0"
            raise self.error((beyond_sigmas([found[row]]) or message) + _instead(words), row, name)
        return found

    def sigmas_of_axes(self, axes: tuple[str, ...], all_axes: str | None = None) -> Floats | None:
        """Read standard deviations along three axes (n, 3); NaN for empty cells, 0 for `exact`.

        Args:
            axes: the columns with one for each
            all_axes: the column with one for the three

        Returns:
            None if the table has neither.

        Raises:
            VopdError: where it has both, or not all three, or a number is not above 0
        """
        three = [name for name in axes if self.has(name)]
        if not three:
            if all_axes is None or not self.has(all_axes):
                return None
            return np.tile(self.sigmas(all_axes, UNKNOWN_OR_EXACT)[:, None], len(axes))
        if all_axes is not None and self.has(all_axes):
            raise self.file.error(f"columns {all_axes} and {three[0]}: give one or the other", 1)
        lacking = [name for name in axes if name not in three]
        if lacking:
            raise self.file.error(f"no column {lacking[0]} beside {three[0]}", 1)
        return np.stack([self.sigmas(name, UNKNOWN_OR_EXACT) for name in axes], axis=1)

    def _numbers(self, name: str, row: int, texts: list[str], words: Mapping[str, float]) -> Floats:
        try:
            if plain_digits(texts):
                found = np.array(texts, dtype=np.float64)
                if (np.abs(found) <= self._most(name)).all():
                    return found
        except ValueError:
            pass
        return np.array([self._number(name, k, text, words) for k, text in enumerate(texts, row)])

    def _number(self, name: str, row: int, text: str, words: Mapping[str, float]) -> float:
        if text in words:
            return words[text]
        hint = _instead(words)
        if not text:
            raise self.error("the cell is empty: fill it, or remove the line", row, name)
        try:
            value = plain_number(text)
        except ValueError as error:
            hint = "; decimals take a point" if "," in text else hint
            if name in DEGREES and SEXAGESIMAL.search(text):
                hint = ": write decimal degrees, below 0 in the south and west"
            raise self.error(f"{shown(text)} is not a number{hint}", row, name) from error
        if not np.isfinite(value):
            raise self.error(f"{text[:LONG_WORD]} is not a finite number{hint}", row, name)
        if abs(value) > self._most(name):
            message = f"{text[:LONG_WORD]} is too large: {self._most(name):.0e} at most"
            if name in TIME and 1e3 * LATE_S < value < 1e13:
                message += "; milliseconds since 1970? then name the column t_unix_ms"
            raise self.error(message, row, name)
        return value

    def _most(self, name: str) -> float:
        """Choose the largest number of a column: of milliseconds as many seconds as elsewhere."""
        return MOST_NUMBER * (1e3 if name == "t_unix_ms" or self.in_ms(name) else 1.0)

    def clock(self, order: Sequence[str]) -> tuple[Floats, bool]:
        """Read the times, and whether they are seconds since 1970 and not of the flight.

        Args:
            order: the names of `TIME`, of which the first that is there counts
        """
        name = next(filter(self.has, order), TIME[0])
        if name == "t_utc":
            return self.times(name), True
        unit = 1e-3 if name == "t_unix_ms" or self.in_ms(name) else 1.0
        found = self.numbers(name)
        if name == TIME[0] and self._own_name(name) not in ("", name):
            self._refuse_times_of_day(name, found)
        return found * unit, name != TIME[0]

    def _refuse_times_of_day(self, name: str, numbers: Floats) -> None:
        """Refuse hhmmss, as receivers write it, which goes from 115959 on to 120000.

        Minutes and seconds of all are below 60, and all that is skipped is the rest up to 100.

        Raises:
            VopdError: naming the row after it
        """
        known, row = np.unique(numbers, return_index=True)
        seconds, minutes, hours = known % 100.0, known // 100.0 % 100.0, known // 10_000.0
        if not len(known) or known[0] < 0.0 or max(seconds.max(), minutes.max()) >= 60.0:
            return
        step, own = np.diff(known), np.diff(3600.0 * hours + 60.0 * minutes + seconds)
        over = step - own > 1.0
        if not over.any() or over.all():
            return
        usual = 2.0 * step[~over].max()
        if hours[-1] < 24.0 and own[over].max() <= usual < step[over].min():
            k = int(np.argmax(over))
            pair = f"{known[k]:.10g} and then {known[k + 1]:.10g}"
            message = f"{pair} seem to be times of day, hhmmss: write dates and times in a column"
            how = "t_utc, as 2026-05-01T11:58:42.25Z; if they are seconds, call the column t_s"
            raise self.error(f"{message} {how}", int(row[k + 1]), name)

    def in_ms(self, name: str) -> bool:
        """Tell whether the file's own name of a column of seconds says milliseconds."""
        return name == TIME[0] and bool(MILLISECONDS.search(self._own_name(name)))

    def in_feet(self, name: str) -> bool:
        """Tell whether a column of heights is in feet, by its own name or by the project."""
        mapped = self.file.columns if isinstance(self.file.columns, dict) else {}
        by_project = name in {HEIGHTS_FT.get(one) for one in mapped}
        return by_project or (name in HEIGHTS and bool(IN_FEET.search(self._own_name(name))))

    def unit_said(self, name: str) -> str:
        """Look up the unit of a coordinate by its own name, or by the project: m, ft or none."""
        mapped = self.file.columns if isinstance(self.file.columns, dict) else {}
        by_project = [one for one in mapped if FEET.get(one, one) == name]
        own = by_project[0] if by_project else self._own_name(name)
        return "ft" if IN_FEET.search(own) else "m" if IN_METRES.search(own) else ""

    @property
    def from_ground(self) -> str:
        """The column of heights from the ground, as the file names it; empty if there is none."""
        return self.heights if FROM_GROUND.search(plain_name(self.heights)) else ""

    @property
    def heights(self) -> str:
        """The column of heights, as the file names it; empty if there is none."""
        there = [name for name in HEIGHTS if self.own and self.has(name)]
        return self.own[self.header.index(there[0])] if there else ""

    def _own_name(self, name: str) -> str:
        own = self.own[self.header.index(name)] if self.own and self.has(name) else ""
        return plain_name(own)

    def _date(self, name: str) -> list[int]:
        """Find the column of dates beside times of day in a column, by its index; or none."""
        first = next(self.blocks(name), []) if self.has(name) else []
        if not first or not TIME_OF_DAY.match(first[0]):
            return []
        date = [k for k, one in enumerate(self.header) if plain_name(one) in DATES]
        if CLOCK.search(self._own_name(name)):  # of dates, too, one may be of that clock
            date.sort(key=lambda k: not CLOCK.search(plain_name(self.header[k])))
        return date[:1]

    def times(self, name: str) -> Floats:
        """Read seconds since 1970-01-01, UTC, of dates and times with Z or an offset.

        Those of GPS time, which has no zones, need none.
        """
        texts, names = self.column(name), self.own or self.header
        own = names[self.header.index(name)]
        date = self._date(name)
        if date:
            own = f"{names[date[0]]} {own}"
            pairs = zip(self.column(self.header[date[0]]), texts, strict=True)
            texts = [
                f"{day.replace('/', '-')}T{'0' * (text[1:2] == ':')}{text}" for day, text in pairs
            ]
        own = "" if own == name else own  # a column of this package states the zone in each row
        zone = None
        if self.file.clock == "gps" or "utc" in plain_name(own):  # as loggers write no zone
            zone = UTC
        return np.array([self._time(name, k, text, own, zone) for k, text in enumerate(texts)])

    def _time(self, name: str, row: int, text: str, columns: str, zone: tzinfo | None) -> float:
        try:
            moment = read_moment(text)
            message, known = date_alone(text), moment.tzinfo or zone
            if known is not None and not message:
                return moment.replace(tzinfo=known).astimezone(UTC).timestamp()
        except (ValueError, OverflowError) as error:
            example = "2026-05-01T11:58:42.25Z"
            message = leap_second(text) or f"{shown(text)} is not a date and time as {example}"
            raise self.error(message, row, name) from error
        rename = f", or rename a column: {columns.split()[-1]}_utc" if columns else ""
        message = message or f"{text} does not say its zone: add Z for UTC{rename}"
        raise self.error(message, row, name)

    def error(self, message: str, row: int, column: str = "") -> VopdError:
        """Make an error about a row, by its index."""
        if column in self.header and self.own:
            column = self.own[self.header.index(column)]
        return self.file.error(message, self.line[row], column)


def frames_of_column(table: CsvTable) -> Ints | list[str]:
    """Read numbers of frames from a column `frame`, or names of images if no cell is a number.

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
        message = no_frame(cells[row])
    raise table.error(message, row, "frame")


def frame_names(table: CsvTable, by_image: bool) -> list[str]:
    """Read the names of images, or the numbers of frames as texts.

    Args:
        table: with a column `image` or `frame`; a column `frame` of images has names
        by_image: whether the frames are images
    """
    other = by_image and (table.has("image") or not table.has("frame"))
    found = None if other else frames_of_column(table)
    if found is None or (by_image and not isinstance(found, list)):
        return table.column("image")  # an error where there is none
    return [*map(str, found)]


def no_frame(text: str) -> str:
    """Say that a text is not the number of a frame; empty if it is one."""
    if _is_whole(text):
        return ""
    own = text if is_number(text) else shown(text)
    most = f" of {DIGITS - 1} digits at most" if _is_whole(text, len(text) + 1) else ""
    return f"{own} is not the number of a frame, a whole number from 0{most}"


def whole_numbers(table: CsvTable, column: str) -> Ints | None:
    """Read the whole numbers from 0 of a column; None if a cell is no such number.

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


# Tables read whole or in blocks of rows


def read_csv(file: InputFile, known: Sequence[str] = ()) -> CsvTable:
    """Read the table of a file whose columns are separated by commas, semicolons or tabs.

    Lines that begin with # are comments.

    Args:
        file: the file
        known: names of columns, for which others of `SYNONYMS` may stand

    Raises:
        VopdError: where there is no header, or a row has not as many cells
    """
    columns, lines = [], array("q")
    for block in csv_blocks(file, known):
        if block.line:
            columns.append(["\n".join(cells) for (cells,) in block.columns])
            lines.extend(block.line)
    by_name = [list(one) for one in zip(*columns, strict=True)] or [[] for _ in block.header]
    return replace(block, columns=by_name, line=lines)


def csv_blocks(file: InputFile, known: Sequence[str] = ()) -> Iterator[CsvTable]:
    """Read the same table in blocks of rows, as the file is read.

    Args:
        file: the file
        known: as for `read_csv`

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
            raise file.error(
                reason(error), numbers[min(reader.line_num, len(lines)) - 1]
            ) from error
        if rows.pop() or len(rows) != len(lines):
            line = next(
                n for n, line in zip(numbers, lines, strict=True) if _is_open(line, between)
            )
            raise file.error("a quoted cell goes over the end of the line", line)
        if first:
            own = _header(file, rows, numbers[0])
            numbers = numbers[len(numbers) - len(rows) :]
            header = own_names(file, own, known, rows[0] if rows else ())
        if {*map(len, rows)} - {len(header)}:
            k = next(k for k, row in enumerate(rows) if len(row) != len(header))
            hint = "; decimals take a point" if len(rows[k]) > len(header) else ""
            message = f"{len(rows[k])} cells, the header has {len(header)}{hint}"
            raise file.error(message, numbers[k])
        if rows or first:
            cells = zip(*rows, strict=True) if rows else [()] * len(header)
            yield CsvTable(file, header, [[one] for one in cells], numbers, own, known)
    if not header:
        file.refuse_folder()
        raise file.error("the file is empty")


def _is_open(line: str, between: str) -> bool:
    """Tell whether a line ends in a quoted cell."""
    return len(list(csv.reader((line, ""), delimiter=between))) < 2


def _header(file: InputFile, rows: list[list[str]], line: int) -> list[str]:
    """Take the header from the first rows, or from the project where the file has none."""
    given = file.columns if isinstance(file.columns, list) else ()
    header = [name.strip() for name in given or rows.pop(0)]
    if len(header) > MOST_COLUMNS:
        raise file.error(f"{count_text(len(header), 'column')}, {MOST_COLUMNS} at most", line)
    doubled = {name for name, count in Counter(header).items() if count > 1}
    if doubled:
        raise file.error(f"two columns are called {', '.join(sorted(doubled))}", line)
    return header


def _lines(file: InputFile) -> Iterator[tuple[Sequence[int], list[str]]]:
    """Number the lines that are neither empty nor a comment, chunk by chunk."""
    before = 0
    for chunk in file.chunks():
        lines = chunk.splitlines()
        if len(chunk) > LONGEST_LINE and not chunk.endswith("\n"):
            message = f"the line has more than {LONGEST_LINE} characters"
            raise file.error(message, before + len(lines))
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


LONGEST_COMMENT = 2 * LONGEST_NAME  # that may be a row: Python's csv takes no cell of any length


def commented_names(
    file: InputFile, known: Sequence[str], columns: Sequence[str]
) -> dict[str, str]:
    """Find comments that may be rows whose name begins with #: as many cells, and no blank behind.

    Args:
        file: the table
        known: as for `read_csv`
        columns: those of names, of which the first column must be one

    Returns:
        Where each name is first, file and line.
    """
    header, found = own_names(file, header_names(file), known), dict[str, str]()
    if header[:1] and header[0] not in columns:
        return {}
    between, before = separator(_first_line(file)), 0
    for chunk in file.chunks():
        lines = chunk.splitlines()
        if "#" in chunk:
            for line, text in enumerate(lines, before + 1):
                if text[:1] == "#" and text[1:2].strip("# \t") and len(text) < LONGEST_COMMENT:
                    cells = next(csv.reader([text], delimiter=between), [])
                    if len(cells) == len(header):
                        found.setdefault(cells[0].strip(), f"{file.name}: line {line}")
        before += len(lines)
    return found


def _first_line(file: InputFile) -> str:
    return next((lines[0] for _, lines in _lines(file)), "")


def is_nested(file: InputFile) -> bool:
    """Tell whether a file begins as JSON or XML does, and no table."""
    return file.head.lstrip()[:1] in ("{", "[", "<")


def header_names(file: InputFile) -> list[str]:
    """Read the names in the first line that is no comment; empty for an empty file.

    JSON or XML that is all in one long line has none.
    """
    if isinstance(file.columns, list):
        return file.columns
    try:
        line = _first_line(file)
    except VopdError:
        if is_nested(file):
            return []
        raise
    cells = line.split(separator(line), MOST_COLUMNS) if line else []  # more are refused
    return [name.strip().strip('"').strip() for name in cells]


def separator(line: str) -> str:
    """Find the character that separates the columns of a line."""
    return max(",;\t", key=line.count)


def has_columns(file: InputFile, known: Sequence[str], *ways: Sequence[str]) -> bool:
    """Tell whether the header has all columns of one of the ways.

    Args:
        file: the table
        known: names of columns, for which others of `SYNONYMS` may stand
        ways: names of columns that are there together
    """
    try:
        names = {*own_names(file, header_names(file), known)}
    except VopdError:  # reading it says what is wrong
        return True
    return any({*way} <= names for way in ways)
