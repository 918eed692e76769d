"""Two Earths for simulated films, WGS 84 and the sphere of 1974, by geometry of their own.

Positions are Earth-centred metres with x, y, z last; nothing of the program is used.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from tests.kit.wgs84_film import FOOT_M, ecef, geodetic

Array = np.ndarray
SEA_LEVEL_KFT = 20925.698  # group 8's RZ at sea level
LANDMARK_RADIUS_KM = 6378.165


class Earth(NamedTuple):
    """How a deck's numbers become positions: what its maker and the truth take the Earth to be."""

    place: Callable[[Array, Array, Array], Array]  # latitude, longitude, deg, altitude, ft -> m
    origin: Callable[[Array, Array, Array], Array]  # the same for group 8, by RZ in kft
    origin_axes: Callable[[Array, Array], Array]  # rows east, north, up at the origin
    camera_axes: Callable[[Array], Array]  # rows east, north, up at a position
    label: Callable[[Array], Array]  # position -> latitude, longitude, deg, as a map has them
    foot_m: float = FOOT_M  # of the vehicle's path


def east_north_up(longitude: Array, latitude: Array) -> Array:
    """Rows east, north, up (..., 3, 3), radians."""
    (st, sp), (ct, cp) = (f(np.array([longitude, latitude])) for f in (np.sin, np.cos))
    east = np.stack([-st, ct, 0.0 * st], axis=-1)
    up = np.stack([cp * ct, cp * st, sp], axis=-1)
    return np.stack([east, np.cross(up, east), up], axis=-2)


def _on_ellipsoid(latitude: Array, longitude: Array, altitude_ft: Array) -> Array:
    return np.moveaxis(ecef(latitude, longitude, altitude_ft * FOOT_M), 0, -1)


def _label(position: Array) -> Array:
    longitude, latitude = geodetic(np.moveaxis(position, -1, 0))
    return np.degrees(np.stack([latitude, longitude], axis=-1))


def _normal_axes(position: Array) -> Array:
    return east_north_up(*geodetic(np.moveaxis(position, -1, 0)))


def _central_axes(position: Array) -> Array:
    x, y, z = np.moveaxis(position, -1, 0)
    return east_north_up(np.arctan2(y, x), np.arctan2(z, np.hypot(x, y)))


WGS84 = Earth(
    place=_on_ellipsoid,
    origin=lambda phi, theta, kft: _on_ellipsoid(phi, theta, (kft - SEA_LEVEL_KFT) * 1000.0),
    origin_axes=lambda phi, theta: east_north_up(np.radians(theta), np.radians(phi)),
    camera_axes=_normal_axes,
    label=_label,
)
"""The Earth, with the ellipsoid's normal as the vertical."""

WGS84_CENTRAL = WGS84._replace(
    origin_axes=lambda phi, theta: _central_axes(_on_ellipsoid(phi, theta, 0.0 * phi)),
    camera_axes=_central_axes,
)
"""The Earth, with the vertical of 1974: away from its centre."""


def _geocentric_deg(latitude: Array, four_phi: float) -> Array:
    """The series of the listing."""
    two = 2.0 * np.radians(latitude)
    series = -0.1932398611111 * np.sin(two) + four_phi * np.sin(2.0 * two)
    return np.asarray(latitude + series + 7.2222222222e-7 * np.sin(3.0 * two))


def _on_sphere(latitude: Array, longitude: Array, radius_m: Array, four_phi: float) -> Array:
    phi, theta = np.radians(_geocentric_deg(latitude, four_phi)), np.radians(longitude)
    return np.asarray(radius_m)[..., None] * east_north_up(theta, phi)[..., 2, :]


def _label_1974(position: Array) -> Array:
    x, y, z = np.moveaxis(position, -1, 0)
    central = np.degrees(np.arctan2(z, np.hypot(x, y)))
    latitude = central
    for _ in range(5):
        latitude = latitude + central - _geocentric_deg(latitude, 3.2586e-5)
    return np.stack([latitude, np.degrees(np.arctan2(y, x))], axis=-1)


SPHERE_1974 = Earth(
    place=lambda phi, theta, ft: _on_sphere(
        phi, theta, LANDMARK_RADIUS_KM * 1000.0 + ft * FOOT_M, 0.0000325861111111
    ),
    origin=lambda phi, theta, kft: _on_sphere(
        phi, theta, kft * 1000.0 * FOOT_M, 0.0003258611111111
    ),
    origin_axes=lambda phi, theta: east_north_up(
        np.radians(theta), np.radians(_geocentric_deg(phi, 0.0003258611111111))
    ),
    camera_axes=_central_axes,
    label=_label_1974,
    foot_m=0.3048006,
)
"""The program's own Earth, its errata included: a faithful run errs in nothing else."""
