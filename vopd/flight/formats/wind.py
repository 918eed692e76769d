"""Files of wind soundings: CSV, and the University of Wyoming's list."""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.flight.formats.by_content import InputFormat
from vopd.flight.formats.files import InputFile
from vopd.flight.formats.tables import UNKNOWN, has_columns, header_names, read_csv
from vopd.inputs import is_number, plain_number

# Soundings as read

M_S_PER_KNOT = 1852.0 / 3600.0
ROUNDED = 0.02  # of a speed that is given in two units
LOWEST_M = -500.0  # the lowest land is 430 m below the sea
CONTRARY_M_S = 2.0  # between winds at one height that are not of one sounding
RADIUS_M = 6_356_766.0  # of the geopotential metre


class WindRows(NamedTuple):
    """A sounding, S levels upward."""

    height_m: Floats  # (S,) above sea level
    toward_m_s: Floats  # (S, 2) toward north, toward east
    said: str


def from_direction(direction_deg: Floats, speed_m_s: Floats) -> Floats:
    """Resolve wind from a direction, clockwise from north, toward north and east (S, 2)."""
    angle = np.radians(direction_deg)
    return np.stack([-speed_m_s * np.cos(angle), -speed_m_s * np.sin(angle)], axis=1)


def of_list(file: InputFile, direction_deg: Floats, speed_m_s: Floats) -> Floats:
    """Resolve winds of a list, where those that were not measured are NaN.

    Raises:
        VopdError: where a direction or a speed is none, as the numbers that stand for no reading
    """
    for wrong, what in (
        (direction_deg[abs(direction_deg - 180.0) > 180.0], "direction of {:g}, which is 0 to 360"),
        (speed_m_s[speed_m_s < 0.0], "speed of {:.4g} m/s, which is not below 0"),
    ):
        if len(wrong):
            kept = "leave blank what was not measured"
            raise file.error(f"a level has a {what.format(wrong[0])}: {kept}")
    return from_direction(direction_deg, speed_m_s)


def upward(file: InputFile, height_m: Floats, toward_m_s: Floats, said: str) -> WindRows:
    """Sort the levels that are known by height; of several at one height the first is taken.

    Raises:
        VopdError: where fewer than two are, all are at one height, or two at one height contradict
            each other
    """
    known = np.isfinite(height_m) & np.isfinite(toward_m_s).all(axis=1)
    if (height_m[known] < LOWEST_M).any():
        message = f"a level is below {LOWEST_M:g} m, as -9999 that stands for no reading"
        raise file.error(f"{message}: leave out what was not measured")
    height, index, level = np.unique(height_m[known], return_index=True, return_inverse=True)
    if len(height) < 2:
        message = "fewer than two levels have height and wind"
        if known.sum() > 1:
            message = f"{known.sum()} levels are at one height, {height[0]:g} m: two are needed"
        raise file.error(message)
    apart = np.linalg.norm(toward_m_s[known] - toward_m_s[known][index][level], axis=1)
    if (apart > CONTRARY_M_S).any():
        row = int(np.argmax(apart > CONTRARY_M_S))
        raise file.error(
            f"two winds at {height_m[known][row]:g} m are {apart[row]:.3g} m/s apart: are two "
            "soundings in the file? leave one of them out"
        )
    return WindRows(height, toward_m_s[known][index], f"{file.name}: {said}, {len(height)} levels")


def geometric_m(geopotential_m: Floats) -> Floats:
    """Convert geopotential to geometric heights, metres."""
    return np.asarray(RADIUS_M * geopotential_m / (RADIUS_M - geopotential_m))


# Wind as a CSV: h_m, from_deg, and speed_m_s or speed_kt

COLUMNS = ("h_m", "from_deg", "speed_m_s", "speed_kt")


def recognises(file: InputFile) -> bool:
    """Tell whether the header has a height and a direction."""
    return has_columns(file, COLUMNS, ("h_m", "from_deg"))


def read(file: InputFile) -> WindRows:
    """Read the sounding of a CSV."""
    table = read_csv(file, COLUMNS)
    knots = table.has("speed_kt")
    speed = table.numbers("speed_kt") * M_S_PER_KNOT if knots else table.numbers("speed_m_s")
    direction = table.numbers("from_deg")
    for row in np.flatnonzero((speed < 0.0) | (abs(direction - 180.0) > 180.0)):
        column = "from_deg" if speed[row] >= 0.0 else "speed_kt" if knots else "speed_m_s"
        raise table.error("a direction is 0 to 360, and a speed not below 0", int(row), column)
    if knots and table.has("speed_m_s"):
        apart = np.abs(table.numbers("speed_m_s") - speed) > ROUNDED * speed + 1.0
        for row in np.flatnonzero(apart):
            raise table.error("the two speeds differ: leave out one column", int(row), "speed_m_s")
    if ground := table.from_ground:
        add = "add the ground's height, in {}, to all, and call it {}"
        how = add.format("feet", "h_ft") if table.in_feet("h_m") else add.format("metres", "h_m")
        raise file.error(f"counts from the ground: {how}", column=ground)
    toward = from_direction(direction, speed)
    said = f"CSV{table.read_as}, {'knots' if knots else 'm/s'}"
    return upward(file, table.numbers("h_m"), toward, said)


# Soundings of the University of Wyoming: its text list in knots, and its CSV in m/s

UNITS = {
    "HGHT": ("m", "ft", "feet", "km"), "DRCT": ("deg", "rad"),
    "SKNT": ("knot", "m/s", "mph", "km/h"), "SPED": ("m/s", "knot", "kt", "mph", "km/h"),
}  # fmt: skip
"""The unit of each column, and others that may stand below its name."""
WIDTH = 7  # columns of each field
NO_LEVEL = f"no level of the list: each number ends with its field of {WIDTH} columns"
LEVELS_FOLLOW = "are two soundings in the file? leave one out: the list ends here, and has a level"
HEAD = re.compile(r"^[ \t]*PRES[ \t]+HGHT[ \t]+.*\bDRCT[ \t]+(SKNT|SPED)\b", re.M)
KINDS = ("geopotential height", "wind direction", "wind speed")


def recognises_text(file: InputFile) -> bool:
    """Tell whether it has the list's heading."""
    return bool(HEAD.search(file.text))


def read_text(file: InputFile) -> WindRows:
    """Read the sounding of a text list: fixed columns, blank where nothing was measured."""
    found = HEAD.search(file.text)
    assert found is not None
    names = found.group(0).split()
    lines = file.text[found.end() :].splitlines()[1:]  # below the heading
    units = next((cells for cells in map(str.split, lines[:2]) if cells[:1] == ["hPa"]), [])
    for name, unit in zip(names, units, strict=False):
        known, *others = UNITS.get(name, ("",))
        if len(units) == len(names) and unit.lower() in others:
            raise file.error(f"{name} is in {unit}, {known} is known")
    first = file.text.count("\n", 0, found.end()) + 2
    rows, end = list[list[float]](), 0  # the line that ends the list
    for number, line in enumerate(lines, first):
        level = _level(line, len(names))
        if level is None and is_number(line[:WIDTH].strip()):
            raise file.error(NO_LEVEL, number)
        if level is None:
            end = end or number * bool(rows)
        elif not end:
            rows.append(level)
        elif not np.isnan(level).all():
            raise file.error(f"{LEVELS_FOLLOW} in line {number}", end)
    table = np.array(rows).reshape(-1, len(names))
    knots = found.group(1) == "SKNT"
    speed = table[:, names.index(found.group(1))] * (M_S_PER_KNOT if knots else 1.0)
    toward = of_list(file, table[:, names.index("DRCT")], speed)
    height = geometric_m(table[:, names.index("HGHT")])
    return upward(file, height, toward, f"Wyoming text, {'knots' if knots else 'm/s'}")


def _level(line: str, count: int) -> list[float] | None:
    """Read the numbers of a level, NaN for a blank field; None for another line.

    Args:
        line: of the list
        count: of its fields, each of which is justified to the right
    """
    fields = [line[k * WIDTH : (k + 1) * WIDTH] for k in range(count)]
    if any(one[-1:].isspace() and one.strip() for one in fields):
        return None
    try:
        return [plain_number(one) if one.strip() else np.nan for one in fields]
    except ValueError:
        return None


def recognises_csv(file: InputFile) -> bool:
    """Tell whether the header has a geopotential height and a wind, with their units."""
    return all(_named(header_names(file), kind) for kind in KINDS)


def read_csv_list(file: InputFile) -> WindRows:
    """Read the sounding of a CSV list; the units stand behind the names of its columns."""
    table = read_csv(file)
    columns: list[Floats] = []
    for kind, unit in zip(KINDS, ("m", "degree", "m/s"), strict=True):
        name = _named(table.header, kind)
        given = name.rpartition("_")[2]
        if given != unit:
            raise file.error(f"{kind} is in {given}, {unit} is known", 1)
        columns.append(table.numbers(name, UNKNOWN))
    height, direction, speed = columns
    return upward(file, geometric_m(height), of_list(file, direction, speed), "Wyoming CSV, m/s")


def _named(header: list[str], kind: str) -> str:
    return next((name for name in header if name.rpartition("_")[0] == kind), "")


# Formats of wind soundings, one row each; the next format is one more row

WIND_FORMATS: tuple[InputFormat[WindRows], ...] = (
    InputFormat("Wyoming CSV", recognises_csv, read_csv_list),
    InputFormat("Wyoming text list", recognises_text, read_text),
    InputFormat("CSV (h_m,from_deg,speed_m_s)", recognises, read, True),
)
