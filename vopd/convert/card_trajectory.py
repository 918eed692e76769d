"""Where the camera was, as cards say it: trajectory and wind in feet about an origin."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.cards.write_number import rounded_to_fit
from vopd.flight.flight import Flight
from vopd.flight.solved_flight import SolvedFlight
from vopd.geometry.earth import earth_centred_m, geodetic, local_axes
from vopd.job import Trajectory, Wind
from vopd.program.constants import ftpkm
from vopd.program.earth import SEA_LEVEL_KFT

FT_PER_M = ftpkm / 1000.0


def card_trajectory(
    solved: SolvedFlight, flight: Flight, frames: Ints, time_s: Floats
) -> Trajectory:
    """A row for each frame, about an origin on the ellipsoid below the first frame."""
    where = geodetic(solved.camera_m[frames])
    latitude = rounded_to_fit(float(where.latitude_deg[0]), 82, 1)
    longitude = rounded_to_fit(float(where.longitude_deg[0]), 82, 2)
    origin = earth_centred_m(latitude, longitude, 0.0)
    position = (solved.camera_m[frames] - origin) @ local_axes(origin).T * FT_PER_M
    velocity = np.zeros((len(frames), 3))
    if flight.path.velocity_m_s is not None:
        velocity = flight.path.velocity_m_s[frames] * FT_PER_M
    return Trajectory(
        time_s=time_s,
        position_ft=to_ten_columns(position),
        velocity_ft_s=to_ten_columns(velocity),
        altitude_ft=to_ten_columns(where.height_m * FT_PER_M),
        origin_latitude_deg=latitude,
        origin_longitude_deg=longitude,
        origin_radius_kft=SEA_LEVEL_KFT,
    )


def card_wind(flight: Flight, trajectory: Trajectory, frames: Ints) -> Wind:
    """The wind at the altitudes of the frames, upward; none is given as calm."""
    if flight.path.wind_m_s is None:
        return Wind(np.array([0.0]), np.zeros((1, 2)))
    altitude, first = np.unique(trajectory.altitude_ft, return_index=True)
    return Wind(altitude, to_ten_columns(flight.path.wind_m_s[frames][first] * FT_PER_M))


def to_ten_columns(values: Floats) -> Floats:
    """Numbers to what ten columns hold with their sign and point: eight digits at most."""
    digits = np.floor(np.log10(np.maximum(np.abs(values), 1.0))) + 1
    decimals = np.where(values < 0.0, 8, 9) - digits
    return np.array(
        [
            round(v, max(int(d), 0)) + 0.0
            for v, d in zip(values.ravel(), decimals.ravel(), strict=True)
        ]
    ).reshape(values.shape)
