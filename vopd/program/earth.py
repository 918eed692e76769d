"""The Earth as an ellipsoid: what the fix `earth` puts in the place of TGTCAM's sphere.

Earth-centred axes: x to the equator at Greenwich, y 90 degrees east of it, z to
the north pole; kilometres and radians.
"""

from __future__ import annotations

import numpy as np

from vopd.errata import ELLIPSOIDS, Fixes
from vopd.job import Floats, Trajectory
from vopd.program.constants import ftpkm
from vopd.program.tgtcam import Dircos

SEA_LEVEL_KFT = 20925.698  # RZ of a point at sea level, as the decks of Appendix H have it


def centred(ellipsoid: str, latitude: Floats, longitude: Floats, height: Floats) -> Floats:
    """Earth-centred (3, ...) of geodetic latitude, longitude and height above the ellipsoid."""
    _, radius, flattening = ELLIPSOIDS[ellipsoid]
    e2 = flattening * (2.0 - flattening)
    n = radius / np.sqrt(1.0 - e2 * np.sin(latitude) ** 2)
    across = (n + height) * np.cos(latitude)
    up = (n * (1.0 - e2) + height) * np.sin(latitude)
    return np.stack([across * np.cos(longitude), across * np.sin(longitude), up])


def geodetic_latitude(ellipsoid: str, place: Floats) -> Floats:
    """Geodetic latitude of Earth-centred places (3, ...), by iteration to the last bits."""
    _, radius, flattening = ELLIPSOIDS[ellipsoid]
    e2 = flattening * (2.0 - flattening)
    across, up = np.hypot(place[0], place[1]), place[2]
    latitude = np.arctan2(up, across * (1.0 - e2))
    for _ in range(8):  # each step gains a factor of e2 at least
        n = radius / np.sqrt(1.0 - e2 * np.sin(latitude) ** 2)
        latitude = np.arctan2(up + e2 * n * np.sin(latitude), across)
    return np.asarray(latitude)


def verticals(latitude: Floats, longitude: Floats) -> Floats:
    """Unit vectors east, north, up (3, 3, ...) in Earth-centred axes, by geodetic latitude."""
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


def ellipsoidal(table: dict[str, Floats], fixes: Fixes) -> dict[str, Floats]:
    """True geocentric latitude and radius of landmarks whose altitude is above the ellipsoid."""
    longitude, latitude = np.radians(table["longitude_deg"]), np.radians(table["latitude_deg"])
    x, y, z = centred(fixes.ellipsoid, latitude, longitude, table["altitude_ft"] / ftpkm)
    across = np.hypot(x, y)
    return {
        "geocentric_latitude_deg": np.degrees(np.arctan2(z, across)),
        "radius_km": np.hypot(across, z),
    }


def ellipsoidal_place(ellipsoid: str, path: Trajectory, xyz: Floats) -> Floats:
    """The camera, Earth-centred km (3, F), of `xyz` (3, F) km from the origin."""
    height = np.array([(path.origin_radius_kft - SEA_LEVEL_KFT) * 1000.0 / ftpkm])
    longitude = np.radians(np.array([path.origin_longitude_deg]))
    latitude = np.radians(np.array([path.origin_latitude_deg]))
    camera = centred(ellipsoid, latitude, longitude, height)
    for axis, along in zip(verticals(latitude, longitude), xyz, strict=True):
        camera = camera + axis * along
    return camera


def ellipsoidal_directions(
    ellipsoid: str, path: Trajectory, xyz: Floats, thj: Floats, phij: Floats, rj: Floats
) -> Dircos:
    """Direction cosines (L, F) along east, north, up by the camera's own geodetic vertical.

    `xyz` (3, F) km east, north, up of the origin, by its geodetic vertical;
    `thj`, `phij` degrees and `rj` km (L, F) the landmarks, geocentric.
    """
    camera = ellipsoidal_place(ellipsoid, path, xyz)
    axes = verticals(geodetic_latitude(ellipsoid, camera), np.arctan2(camera[1], camera[0]))
    theta, phi = np.radians(thj), np.radians(phij)
    marks = rj * np.stack([np.cos(phi) * np.cos(theta), np.cos(phi) * np.sin(theta), np.sin(phi)])
    away = marks - camera[:, None]
    away = away / np.sqrt((away**2).sum(axis=0))
    xlam, xmu, xnu = ((axis[:, None] * away).sum(axis=0) for axis in axes)
    return Dircos(xlam, xmu, xnu)
