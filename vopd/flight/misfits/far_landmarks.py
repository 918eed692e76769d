"""Landmarks that cannot be seen, and the mistake of coordinates that explains how far they are."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from vopd.arrays import Floats
from vopd.findings import VopdError
from vopd.flight.coordinates import (
    M_PER_FT,
    HeightDatum,
    earth_centred_positions,
    has_height_axis,
    map_grid,
    outside_area,
)
from vopd.flight.flight import Flight
from vopd.geometry.earth import earth_centred_m, geodetic

FAR_M = 300e3  # from the camera: beyond it no landmark is seen


def far_landmarks(flight: Flight) -> Iterator[str]:
    """Look for landmarks that cannot be seen, and for the mistake of coordinates that explains it.

    Of a mistake of the landmarks and one of the camera, that counts which puts both into the
    area of the landmarks' CRS.
    """
    marks, camera = flight.landmarks.position_m, flight.path.position_m
    if not _distance(flight, marks, camera) > FAR_M:
        return
    crs = None if flight.grid is None else flight.grid.crs
    camera_said = "the position" if flight.path.stands else "the camera"
    why = ""
    for said, change in COORDINATE_MISTAKES:
        both = (
            ("the landmarks", change(flight, marks), camera),
            (camera_said, marks, change(flight, camera)),
        )
        near = [one for one in both if _distance(flight, one[1], one[2]) < FAR_M]
        inside = [one for one in near if outside_area(crs, one[1]) is None]
        if near:
            whose = " or of ".join(what for what, *_ in inside or near)
            why = f"; {said.format(whose)}"
            break
    places = f"landmarks at {_place(marks)}, camera at {_place(camera)}"
    yield f"landmarks are more than 300 km from the camera{why} ({places})"


HIGH_KM = 100.0  # from where on a height is named: it may be what is wrong


def _place(position_m: Floats) -> str:
    """Name the first known position by tenths of a degree, and its height in kilometres if high."""
    known = position_m[np.isfinite(position_m).all(axis=1)][:1]
    where = geodetic(known)
    place = f"latitude {where.latitude_deg[0]:.1f}, longitude {where.longitude_deg[0]:.1f}"
    height_km = float(where.height_m[0]) / 1000.0
    return place + f", height {height_km:,.5g} km" * (abs(height_km) > HIGH_KM)


def _exchanged(flight: Flight, position_m: Floats) -> Floats:
    """Exchange latitude and longitude of positions; NaN if that is no latitude."""
    where = geodetic(position_m)
    latitude = np.where(np.abs(where.longitude_deg) <= 90.0, where.longitude_deg, np.nan)
    return earth_centred_m(latitude, where.latitude_deg, where.height_m)


def _grid_exchanged(flight: Flight, position_m: Floats) -> Floats:
    """Exchange easting and northing in the landmarks' CRS; NaN if that is no position."""
    return _on_grid(flight, position_m, lambda xyz: xyz[:, [1, 0, 2]])


def _from_feet(flight: Flight, position_m: Floats) -> Floats:
    """Take easting, northing and height for feet; NaN if that is no position."""
    return _on_grid(flight, position_m, lambda xyz: xyz * M_PER_FT)


def _on_grid(flight: Flight, position_m: Floats, change: Callable[[Floats], Floats]) -> Floats:
    """Change easting, northing and height in the landmarks' CRS; NaN if that is no position."""
    grid = None if flight.grid is None else map_grid(flight.grid.crs, position_m)
    if grid is None:
        return np.full_like(position_m, np.nan)
    height_m = geodetic(position_m).height_m
    coordinate = change(np.stack([grid.easting, grid.northing, height_m], axis=1))
    level = None if has_height_axis(grid.crs, "") else HeightDatum("same")
    try:
        return earth_centred_positions(coordinate, False, grid.crs, level, "")
    except VopdError:
        return np.full_like(position_m, np.nan)


def _other_longitude(flight: Flight, position_m: Floats) -> Floats:
    return np.asarray(position_m * np.array([1.0, -1.0, 1.0]))


def _other_latitude(flight: Flight, position_m: Floats) -> Floats:
    return np.asarray(position_m * np.array([1.0, 1.0, -1.0]))


def _as_radians(flight: Flight, position_m: Floats) -> Floats:
    """Read the numbers of latitude and longitude as radians; NaN if one is beyond a half turn."""
    where = geodetic(position_m)
    latitude, longitude = where.latitude_deg, where.longitude_deg
    if np.nanmax(np.abs(latitude)) > 1.6 or np.nanmax(np.abs(longitude)) > 3.2:
        return np.full_like(position_m, np.nan)
    return earth_centred_m(np.rad2deg(latitude), np.rad2deg(longitude), where.height_m)


COORDINATE_MISTAKES: tuple[tuple[str, Callable[[Flight, Floats], Floats]], ...] = (
    (
        "with x and y of {} exchanged they are not: x is the easting",
        _grid_exchanged,
    ),
    (
        "with x and y of {} in feet they are not: give metres (.3048 to a foot), or a crs in feet",
        _from_feet,
    ),
    ("with latitude and longitude of {} exchanged they are not", _exchanged),
    (
        "with the other sign of longitude of {} they are not: west of Greenwich it is below 0",
        _other_longitude,
    ),
    (
        "with the other sign of latitude of {} they are not: south of the equator it is below 0",
        _other_latitude,
    ),
    ("with latitude and longitude of {} in radians they are not: give degrees", _as_radians),
)
"""Words, and the positions as they would be without the mistake."""


def _distance(flight: Flight, landmark_m: Floats, camera_m: Floats) -> float:
    away = landmark_m[flight.picks.landmark] - camera_m[flight.picks.frame]
    distance = np.linalg.norm(away, axis=1)
    known = distance[np.isfinite(distance)]
    return float(np.median(known)) if len(known) else float("nan")
