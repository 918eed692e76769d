"""Ellipsoids of revolution: convert latitude, longitude and height to x, y, z, and back.

Earth-centred axes: x to the equator at Greenwich, y 90 degrees east of it, z to
the north pole. Angles are radians, lengths kilometres.
"""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.earth_sizes import Ellipsoid


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
