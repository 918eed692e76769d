"""Soundings of the University of Wyoming: its text list in knots, and its CSV in m/s."""

from __future__ import annotations

import re

import numpy as np

from vopd.arrays import Floats
from vopd.flight.files import InputFile
from vopd.flight.read_csv import header_names, read_csv
from vopd.flight.wind_formats.wind_rows import (
    M_S_PER_KNOT,
    WindRows,
    from_direction,
    geometric_m,
    upward,
)

WIDTH = 7  # columns of each field
HEAD = re.compile(r"^\s*PRES\s+HGHT\s+.*\bDRCT\s+(SKNT|SPED)\b", re.M)
KINDS = ("geopotential height", "wind direction", "wind speed")


def recognises_text(file: InputFile) -> bool:
    """Whether it has the list's heading."""
    return bool(HEAD.search(file.text))


def read_text(file: InputFile) -> WindRows:
    """The sounding of a text list: fixed columns, blank where nothing was measured."""
    found = HEAD.search(file.text)
    assert found is not None
    names = found.group(0).split()
    lines = file.text[found.end() :].splitlines()[1:]  # below the heading
    rows = []
    for line in lines:
        cells = [line[k * WIDTH : (k + 1) * WIDTH].strip() for k in range(len(names))]
        try:
            rows.append([float(cell) if cell else np.nan for cell in cells])
        except ValueError:
            if rows:
                break  # what follows the list
    table = np.array(rows).reshape(-1, len(names))
    knots = found.group(1) == "SKNT"
    speed = table[:, names.index(found.group(1))] * (M_S_PER_KNOT if knots else 1.0)
    toward = from_direction(table[:, names.index("DRCT")], speed)
    height = geometric_m(table[:, names.index("HGHT")])
    return upward(file, height, toward, f"Wyoming text, {'knots' if knots else 'm/s'}")


def recognises_csv(file: InputFile) -> bool:
    """Whether the header has a geopotential height and a wind, with their units."""
    return all(_named(header_names(file), kind) for kind in KINDS)


def read_csv_list(file: InputFile) -> WindRows:
    """The sounding of a CSV list; the units stand behind the names of its columns."""
    table = read_csv(file)
    columns: list[Floats] = []
    for kind, unit in zip(KINDS, ("m", "degree", "m/s"), strict=True):
        name = _named(table.header, kind)
        given = name.rpartition("_")[2]
        if given != unit:
            raise file.error(f"{kind} is in {given}, {unit} is known", 1)
        columns.append(table.numbers(name, empty=np.nan))
    height, direction, speed = columns
    return upward(file, geometric_m(height), from_direction(direction, speed), "Wyoming CSV, m/s")


def _named(header: list[str], kind: str) -> str:
    return next((name for name in header if name.rpartition("_")[0] == kind), "")
