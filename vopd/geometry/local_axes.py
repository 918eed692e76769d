"""Local axes at a point on the Earth: unit vectors east, north and up."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats

NED_FROM_ENU = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
"""Components north, east, down by those east, north, up; its own inverse."""


def east_north_up(latitude: Floats, longitude: Floats) -> Floats:
    """Unit vectors east, north and up in Earth-centred axes, (3, 3, ...).

    The first axis is the vector, the second its component.

    Args:
        latitude: radians, (...); geodetic for the ellipsoid's normal as the
            vertical, geocentric for the direction away from the Earth's centre
        longitude: positive east, radians, (...)
    """
    sinp, cosp, sint, cost = (
        np.sin(latitude), np.cos(latitude), np.sin(longitude), np.cos(longitude)
    )  # fmt: skip
    zero = np.zeros_like(sint)
    return np.stack(
        [
            np.stack([-sint, cost, zero]),
            np.stack([-sinp * cost, -sinp * sint, cosp]),
            np.stack([cosp * cost, cosp * sint, sinp]),
        ]
    )
