"""A track as a CSV: times, images or both, positions, and perhaps velocities and sigmas."""

from __future__ import annotations

import numpy as np

from vopd.flight.files import InputFile
from vopd.flight.read_csv import has_columns, read_csv
from vopd.flight.track_formats.track_rows import TrackRows

VELOCITY = ("vn_m_s", "ve_m_s", "vd_m_s")


def recognises(file: InputFile) -> bool:
    """Whether the header names a time or coordinates."""
    return has_columns(
        file, ("t_s",), ("t_utc",), ("image",), ("lat_deg", "lon_deg"), ("x_m", "y_m")
    )


def read(file: InputFile) -> TrackRows:
    """The track of a CSV."""
    table = read_csv(file)
    geodetic = table.has("lat_deg") or not (table.has("x_m") or table.has("y_m"))
    columns = ("lon_deg", "lat_deg", "h_m") if geodetic else ("x_m", "y_m", "z_m")
    coordinate = np.stack([table.numbers(column) for column in columns], axis=1)
    velocity = None
    if any(table.has(name) for name in VELOCITY):
        velocity = np.stack([table.numbers(name) for name in VELOCITY], axis=1)
    utc = table.has("t_utc")
    timeless = table.has("image") and not (table.has("t_s") or utc)
    time_s = None if timeless else (table.times("t_utc") if utc else table.numbers("t_s"))
    sigma = None
    if table.has("sigma_m"):
        sigma = np.tile(table.sigmas("sigma_m")[:, None], 3)
    if geodetic:
        for row, latitude in enumerate(coordinate[:, 1]):
            if abs(latitude) > 90.0:
                raise table.error(f"{latitude:g} is no latitude", row, "lat_deg")
    return TrackRows(
        coordinate,
        geodetic,
        None,
        None if timeless else ("utc-column" if utc else "seconds"),
        time_s,
        f"CSV, {len(coordinate)} positions",
        table.column("image") if table.has("image") else [],
        velocity,
        table.line,
        sigma_m=sigma,
    )
