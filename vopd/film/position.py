"""Position of the camera in each frame of a deck, and local north, east and down there."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.errata import Fix, Fixes
from vopd.estimate import Position, Vertical
from vopd.film.joined_jobs import JoinedJobs
from vopd.geometry.earth_sizes import ELLIPSOIDS
from vopd.geometry.ellipsoid import earth_centred, geodetic_latitude
from vopd.geometry.geodetic import M_PER_KM, earth_centred_m, geodetic, local_axes
from vopd.geometry.local_axes import east_north_up
from vopd.program.positions import earth_fixed

KM_PER_FT = 0.3048e-3
OF_1974 = ELLIPSOIDS["international1924"]  # its flattening is that of the series of A 55 and A 195


def position(joined: JoinedJobs) -> Position:
    """Position of the camera in each frame, and the local axes there.

    The spherical Earth of 1974 gives the camera's direction from the Earth's centre
    correctly, but its distance wrongly away from the equator. Therefore the direction
    and the altitude of group 7 are used. The program's series from geodetic to
    geocentric latitude is that of a flattening of 1/297, and so is the way back. Down
    is what the run uses: toward the Earth's centre, or with the fix `earth` along the
    ellipsoid's normal.

    Args:
        joined: the jobs as they were solved
    """
    fixes = joined.results.fixes
    camera = earth_fixed(joined.origin, fixes, joined.results.vehicle_ft).T
    longitude = np.arctan2(camera[1], camera[0])
    geocentric = np.arctan2(camera[2], np.hypot(camera[0], camera[1]))
    altitude = joined.path.altitude_ft
    latitude = _geodetic(geocentric, altitude * KM_PER_FT)
    fixed = Fix.EARTH in fixes
    if fixed:
        latitude = geodetic_latitude(fixes.ellipsoid, camera)
    east, north, up = np.moveaxis(
        east_north_up(latitude if fixed else geocentric, longitude), 1, -1
    )
    return Position(
        latitude_deg=np.degrees(latitude),
        longitude_deg=np.degrees(longitude),
        altitude=altitude,
        north_east_down=np.stack([north, east, -up], axis=-2),
        geocentric_latitude_deg=np.degrees(geocentric),
        vertical=Vertical.GEODETIC if fixed else Vertical.GEOCENTRIC,
        to_own_m=_to_own_m(joined, np.degrees(latitude), np.degrees(longitude)),
    )


def _to_own_m(joined: JoinedJobs, latitude_deg: Floats, longitude_deg: Floats) -> Floats:
    """Metres east and north (F, 2) from a position to where the deck itself puts the camera.

    That is group 7's X, Y, Z along east, north and up of group 8's origin, on WGS 84.
    """
    on_wgs84 = Fixes(frozenset({Fix.EARTH}))
    own = earth_fixed(joined.origin, on_wgs84, joined.results.vehicle_ft) * M_PER_KM
    here = earth_centred_m(latitude_deg, longitude_deg, geodetic(own).height_m)
    apart = (own - here)[:, None]
    return np.asarray((local_axes(own)[:, :2] * apart).sum(axis=-1))


def _geodetic(geocentric: Floats, height_km: Floats) -> Floats:
    """Geodetic latitude, radians, of a geocentric one at a height."""
    latitude = np.array(geocentric)
    for _ in range(6):  # each step gains a factor of 1/300
        x, _, z = earth_centred(OF_1974, latitude, np.zeros_like(latitude), height_km)
        latitude = latitude + geocentric - np.arctan2(z, x)
    return latitude
