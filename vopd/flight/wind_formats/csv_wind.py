"""Wind as a CSV: h_m, from_deg, and speed_m_s or speed_kt."""

from __future__ import annotations

import numpy as np

from vopd.flight.files import InputFile
from vopd.flight.read_csv import has_columns, read_csv
from vopd.flight.wind_formats.wind_rows import M_S_PER_KNOT, WindRows, from_direction, upward


def recognises(file: InputFile) -> bool:
    """Whether the header has a height and a direction."""
    return has_columns(file, ("h_m", "from_deg"))


def read(file: InputFile) -> WindRows:
    """The sounding of a CSV."""
    table = read_csv(file)
    knots = table.has("speed_kt")
    speed = table.numbers("speed_kt") * M_S_PER_KNOT if knots else table.numbers("speed_m_s")
    direction = table.numbers("from_deg")
    for row in np.flatnonzero((speed < 0.0) | (abs(direction - 180.0) > 180.0)):
        column = "from_deg" if speed[row] >= 0.0 else "speed_kt" if knots else "speed_m_s"
        raise table.error("a direction is 0 to 360, and a speed not below 0", int(row), column)
    toward = from_direction(direction, speed)
    return upward(file, table.numbers("h_m"), toward, f"CSV, {'knots' if knots else 'm/s'}")
