"""Where the vehicle is on the Earth, and its local north, east and down."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.errata import Fix
from vopd.geometry.ellipsoid import ELLIPSOIDS, earth_centred, geodetic_latitude
from vopd.program.ftlup import TableOutOfOrder, ftlup
from vopd.program.positions import earth_fixed
from vopd.results import Results

M_PER_FT = 0.3048
OF_1974 = ELLIPSOIDS["international1924"]  # its flattening is that of the series of A 55 and A 195


class Place(NamedTuple):
    """Where each frame was taken. F frames.

    Geodetic latitude and longitude in degrees, as the deck's own, longitude -180
    to 180; altitude above sea level from group 7. `north_east_down` (F, 3, 3): the local
    axes as rows, Earth-fixed. Down is what the run takes for it: toward the
    Earth's centre, or with the fix `earth` along the ellipsoid's normal.
    """

    latitude_deg: Floats
    longitude_deg: Floats
    altitude_ft: Floats
    north_east_down: Floats


def place(results: Results) -> Place:
    """Where each frame of a job was taken.

    The spherical Earth of 1974 has the camera in the right direction and, away
    from the equator, at a wrong distance from the centre: so the direction and
    the altitude of group 7 are what counts. Its series from geodetic to
    geocentric latitude is that of a flattening of 1/297, and so is the way back.
    """
    job = results.job
    camera = earth_fixed(job, results.fixes, results.vehicle_ft).T
    longitude = np.arctan2(camera[1], camera[0])
    geocentric = np.arctan2(camera[2], np.hypot(camera[0], camera[1]))
    try:
        altitude = ftlup(results.time_s, 1, job.trajectory.time_s, job.trajectory.altitude_ft)
    except TableOutOfOrder:  # the run stopped there
        altitude = np.full_like(results.time_s, np.nan)
    latitude = _geodetic(geocentric, altitude * M_PER_FT / 1000.0)
    vertical = geocentric
    if Fix.EARTH in results.fixes:
        vertical = latitude = geodetic_latitude(results.fixes.ellipsoid, camera)
    sinp, cosp, sint, cost = (
        np.sin(vertical), np.cos(vertical), np.sin(longitude), np.cos(longitude)
    )  # fmt: skip
    north = np.stack([-sinp * cost, -sinp * sint, cosp], axis=-1)
    east = np.stack([-sint, cost, np.zeros_like(sint)], axis=-1)
    down = np.stack([-cosp * cost, -cosp * sint, -sinp], axis=-1)
    return Place(
        np.degrees(latitude),
        np.degrees(longitude),
        altitude,
        np.stack([north, east, down], axis=-2),
    )


def _geodetic(geocentric: Floats, height_km: Floats) -> Floats:
    """Geodetic latitude, radians, of a geocentric one at a height."""
    latitude = np.array(geocentric)
    for _ in range(6):  # each step gains a factor of 1/300
        x, _, z = earth_centred(OF_1974, latitude, np.zeros_like(latitude), height_km)
        latitude = latitude + geocentric - np.arctan2(z, x)
    return latitude
