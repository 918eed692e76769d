"""Derivatives of residuals and angles of attack with respect to what a deck states.

These are the landmarks, the position, the focal length and the time. The derivatives
are central differences of the run's own equations, so they hold for its Earth and its
vertical.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from vopd.arrays import Floats
from vopd.estimate import Responses
from vopd.film.image_axis import flat
from vopd.film.joined_jobs import JoinedJobs
from vopd.film.path_lookup import AT_TIME, EARLIER, LATER, STEP_FT_S, STEP_S
from vopd.program.alpbet import alpbet
from vopd.program.constants import ftpkm
from vopd.program.orient import Sight, equations
from vopd.program.positions import directions
from vopd.program.tgtcam import Dircos

STEP_FT, STEP_MM, STEP_DEG = 1.0, 1e-3, 1e-3


@np.errstate(all="ignore")
def responses(joined: JoinedJobs, seen: Sight, radians: Floats) -> Responses:
    """Compute the derivatives of some jobs at the angles they were solved to.

    Args:
        joined: the jobs
        seen: what their solve was given
        radians: camera yaw, pitch, roll, (F, 3)
    """

    def residual(direction: Floats) -> Floats:
        dircos = Dircos(*(np.ascontiguousarray(direction[..., k].T) for k in range(3)))
        return flat(equations(radians.T, seen._replace(dircos=dircos))[0])

    def by_landmark(axis: Floats) -> Floats:
        return _central(lambda s: residual(_moved_landmarks(joined, s * axis)), STEP_FT)

    def by_position(axis: Floats) -> Floats:
        return _central(lambda s: residual(_moved_vehicle(joined, s * axis)), STEP_FT)

    def by_focal_length(step: float) -> Floats:
        return flat(equations(radians.T, seen._replace(cc=seen.cc + step * STEP_MM))[0])

    def by_time(step: float) -> Floats:
        at = LATER if step > 0.0 else EARLIER
        return residual(_moved_vehicle(joined, joined.path.travelled_ft[:, at]))

    steps = np.eye(3) * STEP_FT
    return Responses(
        landmark=np.stack([by_landmark(axis) for axis in steps], axis=-1),
        position=np.stack([by_position(axis) for axis in steps], axis=-1),
        focal_length=_central(by_focal_length, STEP_MM),
        time=_central(by_time, STEP_S),
        attack_by_camera=_attack_by_camera(joined),
        attack_by_time=_attack_by_time(joined),
        attack_by_velocity=_attack_by_velocity(joined),
    )


def _moved_vehicle(joined: JoinedJobs, shift_ft: Floats) -> Floats:
    """Directions (F, L, 3) with the vehicle moved east, north, up by (F, 3) or (3,)."""
    r = joined.results
    marks = r.longitude_deg, r.geocentric_latitude_deg, r.radius_km
    return directions(joined.origin, r.fixes, r.vehicle_ft + shift_ft, *marks)


def _moved_landmarks(joined: JoinedJobs, shift_ft: Floats) -> Floats:
    """Directions (F, L, 3) with every landmark moved east, north, up by (3,)."""
    east, north, up = shift_ft / ftpkm
    r = joined.results
    latitude = np.radians(r.geocentric_latitude_deg)
    return directions(
        joined.origin,
        r.fixes,
        r.vehicle_ft,
        r.longitude_deg + np.degrees(east / (r.radius_km * np.cos(latitude))),
        r.geocentric_latitude_deg + np.degrees(north / r.radius_km),
        r.radius_km + up,
    )


def _attack_by_camera(joined: JoinedJobs) -> Floats:
    columns = []
    for k, multiplier in enumerate(joined.multiplier.T):
        turn = np.zeros_like(joined.multiplier)
        turn[:, k] = STEP_DEG * multiplier
        change = _attack_deg(joined, turn_deg=turn) - _attack_deg(joined, turn_deg=-turn)
        columns.append(_short_way(change) / (2.0 * STEP_DEG))
    return np.stack(columns, axis=-1)


def _attack_by_time(joined: JoinedJobs) -> Floats:
    change = _attack_deg(joined, LATER) - _attack_deg(joined, EARLIER)
    return np.radians(_short_way(change)) / (2.0 * STEP_S)


def _attack_by_velocity(joined: JoinedJobs) -> Floats:
    columns = []
    for k in (1, 2, 3):  # indices in FASTER_FT_S; the opposite is three farther on
        change = _attack_deg(joined, faster=k) - _attack_deg(joined, faster=k + 3)
        columns.append(np.radians(_short_way(change)) / (2.0 * STEP_FT_S))
    return np.stack(columns, axis=-1)


def _attack_deg(
    joined: JoinedJobs, time: int = AT_TIME, faster: int = 0, turn_deg: Floats | float = 0.0
) -> Floats:
    """Alpha, beta, eta (F, 3) at a time and a velocity of `PathLookup`, and a shifted attitude."""
    path = joined.path
    yaw, pitch, roll = (joined.results.vehicle_deg + turn_deg).T
    velocity, wind = path.velocity_ft_s[:, time, faster], path.wind_ft_s[:, time]
    air = alpbet(velocity, wind, theta=pitch, psi=yaw, phi=roll)
    return np.stack([air.alphad, air.betad, air.etad], axis=1)


def _short_way(change_deg: Floats) -> Floats:
    return np.asarray((change_deg + 180.0) % 360.0 - 180.0)


def _central(at: Callable[[float], Floats], step: float) -> Floats:
    return np.asarray((at(1.0) - at(-1.0)) / (2.0 * step))
