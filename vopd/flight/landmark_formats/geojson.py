"""Landmarks as GeoJSON: points with a name, longitude, latitude, height, WGS 84."""

from __future__ import annotations

import json
import re
from math import isfinite

import numpy as np

from vopd.flight.files import InputFile, reason
from vopd.flight.landmark_formats.landmark_rows import LandmarkRows

NAMES = ("landmark", "name", "Name", "NAME", "label", "id")


def recognises(file: InputFile) -> bool:
    """Whether it is JSON of features."""
    return bool(re.search(r'"type"\s*:\s*"Feature', file.text))


def read(file: InputFile) -> LandmarkRows:
    """The points of a GeoJSON file."""
    try:
        root = json.loads(file.text)
    except (ValueError, RecursionError) as error:
        raise file.error(f"not valid JSON: {reason(error, str(error))}") from error
    features = root.get("features", [root]) if isinstance(root, dict) else []
    names, coordinates = [], []
    for k, feature in enumerate(features):
        where = f"feature {k}"
        geometry, properties = feature.get("geometry") or {}, feature.get("properties") or {}
        if geometry.get("type") != "Point":
            continue
        name = next((properties[key] for key in NAMES if key in properties), feature.get("id"))
        if name is None:
            raise file.error(f"no name: a property {', '.join(NAMES[:2])} is needed", column=where)
        values = geometry.get("coordinates", [])
        if len(values) != 3 or not all(map(_is_number, values)):
            raise file.error("a landmark needs longitude, latitude and height", column=where)
        if abs(values[1]) > 90.0:
            raise file.error(f"{values[1]:g} is no latitude: longitude comes first", column=where)
        names.append(str(name))
        coordinates.append([float(x) for x in values])
    if not names:
        raise file.error("no point is in the file")
    return LandmarkRows(
        names, np.array(coordinates), True, "EPSG:4326", np.full(len(names), np.nan),
        [0] * len(names), "GeoJSON",
    )  # fmt: skip


def _is_number(value: object) -> bool:
    """Say if a value is a finite number; a whole one beyond 1e308 is none."""
    try:
        return isinstance(value, int | float) and isfinite(value)
    except OverflowError:
        return False
