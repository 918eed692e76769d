"""Positions on WGS 84 in metres and degrees, and the local axes there."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from vopd.arrays import Floats
from vopd.geometry.earth_sizes import WGS84
from vopd.geometry.ellipsoid import earth_centred, geodetic_latitude
from vopd.geometry.local_axes import east_north_up

M_PER_KM = 1000.0


class Geodetic(NamedTuple):
    """Latitude and longitude in degrees, longitude -180 to 180, height above WGS 84 in metres."""

    latitude_deg: Floats
    longitude_deg: Floats
    height_m: Floats


def earth_centred_m(
    latitude_deg: ArrayLike, longitude_deg: ArrayLike, height_m: ArrayLike
) -> Floats:
    """Earth-centred positions (..., 3), metres, of points given by WGS 84 coordinates.

    Args:
        latitude_deg: geodetic, (...)
        longitude_deg: positive east, (...)
        height_m: above the ellipsoid, (...)
    """
    latitude, longitude = np.radians(latitude_deg), np.radians(longitude_deg)
    height = np.asarray(height_m, dtype=np.float64) / M_PER_KM
    position = earth_centred(WGS84, *np.broadcast_arrays(latitude, longitude, height))
    return np.moveaxis(position, 0, -1) * M_PER_KM


def geodetic(position_m: Floats) -> Geodetic:
    """Latitude, longitude and height on WGS 84 of Earth-centred positions.

    Args:
        position_m: Earth-centred x, y, z, (..., 3), metres
    """
    x, y, z = np.moveaxis(position_m, -1, 0)
    latitude = geodetic_latitude(WGS84, np.stack([x, y, z]) / M_PER_KM)
    sine, cosine = np.sin(latitude), np.cos(latitude)
    e2 = WGS84.flattening * (2.0 - WGS84.flattening)
    radius = WGS84.radius_km * M_PER_KM
    # the component along the normal, less that of the ellipsoid's own point
    height = np.hypot(x, y) * cosine + z * sine - radius * np.sqrt(1.0 - e2 * sine**2)
    return Geodetic(np.degrees(latitude), np.degrees(np.arctan2(y, x)), height)


def local_axes(position_m: Floats) -> Floats:
    """Unit vectors east, north, up as rows, (..., 3, 3), in Earth-centred axes.

    Args:
        position_m: Earth-centred x, y, z of the points, (..., 3), metres
    """
    return axes_at(geodetic(position_m))


def axes_at(where: Geodetic) -> Floats:
    """Unit vectors east, north, up as rows, (..., 3, 3), in Earth-centred axes.

    Args:
        where: the points
    """
    axes = east_north_up(np.radians(where.latitude_deg), np.radians(where.longitude_deg))
    return np.moveaxis(axes, (0, 1), (-2, -1))
