"""Ellipsoids of revolution: convert latitude, longitude and height to x, y, z, and back.

Earth-centred axes: x to the equator at Greenwich, y 90 degrees east of it, z to
the north pole. Angles are radians, lengths kilometres.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats


class Ellipsoid(NamedTuple):
    """The size and shape of an ellipsoid: equatorial radius in km, and flattening."""

    label: str
    radius_km: float
    flattening: float


ELLIPSOIDS = {
    "wgs84": Ellipsoid("WGS 84", 6378.137, 1 / 298.257223563),
    "international1924": Ellipsoid("International 1924", 6378.388, 1 / 297.0),
    "clarke1866": Ellipsoid("Clarke 1866", 6378.2064, 1 - 6356.5838 / 6378.2064),
}
"""The ellipsoids that a run can be given, by the names that the command line takes."""

WGS84 = ELLIPSOIDS["wgs84"]


def earth_centred(
    ellipsoid: Ellipsoid, latitude: Floats, longitude: Floats, height: Floats
) -> Floats:
    """Earth-centred position, (3, ...) km, of a point above the ellipsoid.

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
    """Geodetic latitude, radians (...), of Earth-centred positions.

    It is iterated until the last bits no longer change.

    Args:
        ellipsoid: the Earth
        position: Earth-centred x, y, z, (3, ...) km; not the Earth's centre
    """
    e2 = ellipsoid.flattening * (2.0 - ellipsoid.flattening)
    across, up = np.hypot(position[0], position[1]), position[2]
    latitude = np.arctan2(up, across * (1.0 - e2))
    for _ in range(8):  # each step gains a factor of e2 at least
        before, sine = latitude, np.sin(latitude)
        n = ellipsoid.radius_km / np.sqrt(1.0 - e2 * sine**2)
        latitude = np.arctan2(up + e2 * n * sine, across)
        if np.array_equal(before, latitude):
            break
    return np.asarray(latitude)
