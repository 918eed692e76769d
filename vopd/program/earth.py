"""The fix `earth`: compute positions on an ellipsoid instead of the program's sphere.

It replaces A 49 to A 61, A 186 to A 199 and TGTCAM. Earth-centred axes are those of
`vopd.geometry.earth`; lengths are kilometres, angles radians.
"""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.earth import earth_centred, east_north_up, geodetic_latitude
from vopd.geometry.ellipsoids import Ellipsoid
from vopd.program.constants import ftpkm

SEA_LEVEL_KFT = 20925.698  # RZ of a point at sea level, as the decks of Appendix H have it


def ellipsoidal(
    ellipsoid: Ellipsoid, longitude_deg: Floats, latitude_deg: Floats, altitude_ft: Floats
) -> tuple[Floats, Floats]:
    """Place landmarks on an ellipsoid.

    Args:
        ellipsoid: the Earth.
        longitude_deg: positive east, (...), degrees.
        latitude_deg: geodetic, (...), degrees.
        altitude_ft: above the ellipsoid, (...), feet.

    Returns:
        Geocentric latitude, degrees, and distance from the Earth's centre, kilometres.
    """
    longitude, latitude = np.radians(longitude_deg), np.radians(latitude_deg)
    x, y, z = earth_centred(ellipsoid, latitude, longitude, altitude_ft / ftpkm)
    across = np.hypot(x, y)
    return np.degrees(np.arctan2(z, across)), np.hypot(across, z)


def ellipsoidal_position(
    ellipsoid: Ellipsoid,
    origin: Floats,
    xyz: Floats,
) -> Floats:
    """Place the camera in Earth-centred axes, (3, F) km.

    Args:
        ellipsoid: the Earth.
        origin: of the trajectory by group 8, (3,), or (3, F) of every frame: geodetic latitude and
            longitude east, degrees, and distance from the Earth's centre, thousands of feet.
        xyz: east, north, up of the origin (3, F), km; up is along the origin's geodetic vertical.
    """
    latitude_deg, longitude_deg, radius_kft = origin
    height = np.atleast_1d((radius_kft - SEA_LEVEL_KFT) * 1000.0 / ftpkm)
    longitude = np.radians(np.atleast_1d(longitude_deg))
    latitude = np.radians(np.atleast_1d(latitude_deg))
    camera = earth_centred(ellipsoid, latitude, longitude, height)
    for axis, along in zip(east_north_up(latitude, longitude), xyz, strict=True):
        camera = camera + axis * along
    return camera


def ellipsoidal_directions(
    ellipsoid: Ellipsoid,
    origin: Floats,
    xyz: Floats,
    thj: Floats,
    phij: Floats,
    rj: Floats,
) -> tuple[Floats, Floats, Floats]:
    """Resolve the directions of landmarks into cosines along east, north, up at the camera.

    Up is the geodetic vertical at the camera.

    Args:
        ellipsoid: the Earth.
        origin: as `ellipsoidal_position` takes it.
        xyz: the camera, east, north, up of the origin (3, F), km; up is along the origin's
            geodetic vertical.
        thj: longitude of the landmarks (..., F), degrees.
        phij: their geocentric latitude (..., F), degrees.
        rj: their distance from the Earth's centre (..., F), km.

    Returns:
        XLAM, XMU, XNU (..., F).
    """
    camera = ellipsoidal_position(ellipsoid, origin, xyz)
    axes = east_north_up(geodetic_latitude(ellipsoid, camera), np.arctan2(camera[1], camera[0]))
    theta, phi = np.radians(thj), np.radians(phij)
    marks = rj * np.stack([np.cos(phi) * np.cos(theta), np.cos(phi) * np.sin(theta), np.sin(phi)])
    apart = 3, *(1,) * (np.ndim(thj) - 1), -1  # frames along the last axis
    away = marks - camera.reshape(apart)
    away = away / np.sqrt((away**2).sum(axis=0))
    xlam, xmu, xnu = ((axis.reshape(apart) * away).sum(axis=0) for axis in axes)
    return xlam, xmu, xnu
