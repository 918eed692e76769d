"""Landmarks as a CSV: the header's names with their units say what the columns are."""

from __future__ import annotations

import numpy as np

from vopd.flight.files import InputFile
from vopd.flight.landmark_formats.landmark_rows import LandmarkRows
from vopd.flight.read_csv import has_columns, read_csv


def recognises(file: InputFile) -> bool:
    """Whether the header names landmarks, or coordinates."""
    return has_columns(file, ("landmark",), ("lat_deg", "lon_deg"), ("x_m", "y_m"))


def read(file: InputFile) -> LandmarkRows:
    """The landmarks of a CSV."""
    table = read_csv(file)
    geodetic = table.has("lat_deg") or not (table.has("x_m") or table.has("y_m"))
    columns = ("lon_deg", "lat_deg", "h_m") if geodetic else ("x_m", "y_m", "z_m")
    names = table.column("landmark")
    coordinate = np.stack([table.numbers(column) for column in columns], axis=1)
    if geodetic:
        for row, latitude in enumerate(coordinate[:, 1]):
            if abs(latitude) > 90.0:
                message = f"{latitude:g} is no latitude: are lat_deg and lon_deg exchanged?"
                raise table.error(message, row, "lat_deg")
    sigma = table.sigmas("sigma_m")
    return LandmarkRows(names, coordinate, geodetic, None, sigma, table.line, "CSV")
