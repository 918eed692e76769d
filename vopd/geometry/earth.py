"""The Earth: ellipsoids, geodetic and Earth-centred coordinates, local axes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from vopd.arrays import Floats
from vopd.geometry.ellipsoids import WGS84, Ellipsoid

# Ellipsoids

# Latitude, longitude and height to x, y, z, and back
#
# Earth-centred axes: x to the equator at Greenwich, y 90 degrees east of it, z to
# the north pole. Angles are radians, lengths kilometres.


def earth_centred(
    ellipsoid: Ellipsoid, latitude: Floats, longitude: Floats, height: Floats
) -> Floats:
    """Convert geodetic coordinates to Earth-centred positions, (3, ...) km.

    Args:
        ellipsoid: the Earth's size and shape
        latitude: geodetic, radians, (...)
        longitude: positive east, radians, (...)
        height: above the ellipsoid along its normal, km, (...)
    """
    e2 = ellipsoid.flattening * (2.0 - ellipsoid.flattening)
    n = ellipsoid.radius_km / np.sqrt(1.0 - e2 * np.sin(latitude) ** 2)
    across = (n + height) * np.cos(latitude)
    up = (n * (1.0 - e2) + height) * np.sin(latitude)
    return np.stack([across * np.cos(longitude), across * np.sin(longitude), up])


def geodetic_latitude(ellipsoid: Ellipsoid, position: Floats) -> Floats:
    """Find the geodetic latitude, radians (...), of Earth-centred positions.

    It is iterated until the last bits no longer change.

    Args:
        ellipsoid: the Earth
        position: Earth-centred x, y, z, (3, ...) km; not the Earth's centre
    """
    return _latitude(ellipsoid, np.hypot(position[0], position[1]), position[2])


def _latitude(ellipsoid: Ellipsoid, across: Floats, up: Floats) -> Floats:
    """Find the geodetic latitude by the distances from the axis and from the equator, km."""
    e2 = ellipsoid.flattening * (2.0 - ellipsoid.flattening)
    latitude = np.arctan2(up, across * (1.0 - e2))
    for _ in range(8):  # each step gains a factor of e2 at least
        before, sine = latitude, np.sin(latitude)
        n = ellipsoid.radius_km / np.sqrt(1.0 - e2 * sine**2)
        latitude = np.arctan2(up + e2 * n * sine, across)
        if (before == latitude).all():
            break
    return np.asarray(latitude)


# Local axes at a point on the Earth: unit vectors east, north and up

NED_FROM_ENU = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
"""Components north, east, down by those east, north, up; its own inverse."""


def east_north_up(latitude: Floats, longitude: Floats) -> Floats:
    """Resolve east, north and up in Earth-centred axes: unit vectors, (3, 3, ...).

    The first axis is the vector, the second its component.

    Args:
        latitude: radians, (...); geodetic for the ellipsoid's normal as the
            vertical, geocentric for the direction away from the Earth's centre
        longitude: positive east, radians, (...)
    """
    sinp, cosp, sint, cost = (
        np.sin(latitude), np.cos(latitude), np.sin(longitude), np.cos(longitude)
    )  # fmt: skip
    axes = np.empty((3, 3, *np.shape(sint)))
    axes[0, 0], axes[0, 1], axes[0, 2] = -sint, cost, 0.0
    axes[1, 0], axes[1, 1], axes[1, 2] = -sinp * cost, -sinp * sint, cosp
    axes[2, 0], axes[2, 1], axes[2, 2] = cosp * cost, cosp * sint, sinp
    return axes


# Positions on WGS 84 in metres and degrees, and the local axes there

M_PER_KM = 1000.0


class Geodetic(NamedTuple):
    """Latitude and longitude in degrees, longitude -180 to 180, height above WGS 84 in metres."""

    latitude_deg: Floats
    longitude_deg: Floats
    height_m: Floats


def earth_centred_m(
    latitude_deg: ArrayLike, longitude_deg: ArrayLike, height_m: ArrayLike
) -> Floats:
    """Convert WGS 84 coordinates to Earth-centred positions, (..., 3), metres.

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
    """Convert Earth-centred positions to latitude, longitude and height on WGS 84.

    Args:
        position_m: Earth-centred x, y, z, (..., 3), metres
    """
    x, y, z = (position_m[..., k] for k in range(3))
    latitude = _latitude(WGS84, np.hypot(x / M_PER_KM, y / M_PER_KM), z / M_PER_KM)
    sine, cosine = np.sin(latitude), np.cos(latitude)
    e2 = WGS84.flattening * (2.0 - WGS84.flattening)
    radius = WGS84.radius_km * M_PER_KM
    # the component along the normal, less that of the ellipsoid's own point
    height = np.hypot(x, y) * cosine + z * sine - radius * np.sqrt(1.0 - e2 * sine**2)
    return Geodetic(np.degrees(latitude), np.degrees(np.arctan2(y, x)), height)


def local_axes(position_m: Floats) -> Floats:
    """Resolve east, north, up at positions: unit vectors as rows, (..., 3, 3), Earth-centred.

    Args:
        position_m: Earth-centred x, y, z of the points, (..., 3), metres
    """
    return axes_at(geodetic(position_m))


def axes_at(where: Geodetic) -> Floats:
    """Resolve east, north, up at points: unit vectors as rows, (..., 3, 3), Earth-centred."""
    axes = east_north_up(np.radians(where.latitude_deg), np.radians(where.longitude_deg))
    return axes.transpose((*range(2, axes.ndim), 0, 1))
