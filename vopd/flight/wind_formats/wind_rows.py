"""What every reader of wind soundings returns."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.flight.files import InputFile

M_S_PER_KNOT = 1852.0 / 3600.0
RADIUS_M = 6_356_766.0  # of the geopotential metre


class WindRows(NamedTuple):
    """A sounding, S levels upward."""

    height_m: Floats  # (S,) above sea level
    toward_m_s: Floats  # (S, 2) toward north, toward east
    said: str


def from_direction(direction_deg: Floats, speed_m_s: Floats) -> Floats:
    """Components toward north and east (S, 2) of wind from a direction, clockwise from north."""
    angle = np.radians(direction_deg)
    return np.stack([-speed_m_s * np.cos(angle), -speed_m_s * np.sin(angle)], axis=1)


def upward(file: InputFile, height_m: Floats, toward_m_s: Floats, said: str) -> WindRows:
    """The levels that are known, in the order of height.

    Raises:
        VopdError: where fewer than two are
    """
    known = np.isfinite(height_m) & np.isfinite(toward_m_s).all(axis=1)
    height, index = np.unique(height_m[known], return_index=True)
    if len(height) < 2:
        raise file.error("fewer than two levels have height and wind")
    return WindRows(height, toward_m_s[known][index], f"{file.name}: {said}, {len(height)} levels")


def geometric_m(geopotential_m: Floats) -> Floats:
    """Heights of geopotential metres."""
    return np.asarray(RADIUS_M * geopotential_m / (RADIUS_M - geopotential_m))
