"""The fix `earth`: compute positions on an ellipsoid instead of the program's sphere.

It replaces TGTCAM and A 168 to A 199. Earth-centred axes are those of
`vopd.geometry.earth`; lengths are kilometres, angles radians.
"""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.earth import earth_centred, east_north_up, geodetic_latitude
from vopd.geometry.ellipsoids import Ellipsoid
from vopd.program.constants import ftpkm
from vopd.program.geocentric import Geocentric
from vopd.program.tgtcam import Dircos

SEA_LEVEL_KFT = 20925.698  # RZ of a point at sea level, as the decks of Appendix H have it


def ellipsoidal(
    ellipsoid: Ellipsoid, longitude_deg: Floats, latitude_deg: Floats, altitude_ft: Floats
) -> Geocentric:
    """Geocentric latitude and radius of landmarks on an ellipsoid.

    Args:
        ellipsoid: the Earth.
        longitude_deg: positive east, (...), degrees.
        latitude_deg: geodetic, (...), degrees.
        altitude_ft: above the ellipsoid, (...), feet.
    """
    longitude, latitude = np.radians(longitude_deg), np.radians(latitude_deg)
    x, y, z = earth_centred(ellipsoid, latitude, longitude, altitude_ft / ftpkm)
    across = np.hypot(x, y)
    return Geocentric(latitude_deg=np.degrees(np.arctan2(z, across)), radius_km=np.hypot(across, z))


def ellipsoidal_position(
    ellipsoid: Ellipsoid,
    latitude_deg: Floats | float,
    longitude_deg: Floats | float,
    radius_kft: Floats | float,
    xyz: Floats,
) -> Floats:
    """Position of the camera in Earth-centred axes, (3, F) km.

    Args:
        ellipsoid: the Earth.
        latitude_deg: geodetic, of the trajectory's origin, or of that of every frame (F,).
        longitude_deg: east, of the same.
        radius_kft: its distance from the Earth's centre on group 8, thousands of feet.
        xyz: east, north, up of the origin (3, F), km; up is along the origin's geodetic vertical.
    """
    height = np.atleast_1d((radius_kft - SEA_LEVEL_KFT) * 1000.0 / ftpkm)
    longitude = np.radians(np.atleast_1d(longitude_deg))
    latitude = np.radians(np.atleast_1d(latitude_deg))
    camera = earth_centred(ellipsoid, latitude, longitude, height)
    for axis, along in zip(east_north_up(latitude, longitude), xyz, strict=True):
        camera = camera + axis * along
    return camera


def ellipsoidal_directions(
    ellipsoid: Ellipsoid,
    latitude_deg: Floats | float,
    longitude_deg: Floats | float,
    radius_kft: Floats | float,
    xyz: Floats,
    thj: Floats,
    phij: Floats,
    rj: Floats,
) -> Dircos:
    """Direction cosines of the landmarks along east, north, up at the camera, (..., F).

    Up is the geodetic vertical at the camera.

    Args:
        ellipsoid: the Earth.
        latitude_deg, longitude_deg, radius_kft: as `ellipsoidal_position` takes them.
        xyz: the camera, east, north, up of the origin (3, F), km; up is along the origin's
            geodetic vertical.
        thj: longitude of the landmarks (..., F), degrees.
        phij: their geocentric latitude (..., F), degrees.
        rj: their distance from the Earth's centre (..., F), km.
    """
    camera = ellipsoidal_position(ellipsoid, latitude_deg, longitude_deg, radius_kft, xyz)
    axes = east_north_up(geodetic_latitude(ellipsoid, camera), np.arctan2(camera[1], camera[0]))
    theta, phi = np.radians(thj), np.radians(phij)
    marks = rj * np.stack([np.cos(phi) * np.cos(theta), np.cos(phi) * np.sin(theta), np.sin(phi)])
    apart = 3, *(1,) * (np.ndim(thj) - 1), -1  # frames along the last axis
    away = marks - camera.reshape(apart)
    away = away / np.sqrt((away**2).sum(axis=0))
    xlam, xmu, xnu = ((axis.reshape(apart) * away).sum(axis=0) for axis in axes)
    return Dircos(xlam, xmu, xnu)
