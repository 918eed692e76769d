"""Turn the solved camera angles into the printed angles (A 296 to A 312, A 444 to A 448)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.landmark_layout import LandmarkLayout
from vopd.program.alpbet import alpbet
from vopd.program.film_jobs import FilmJobs
from vopd.program.frames import FilmOrientation
from vopd.program.ftlup import TableName, ftlup_each
from vopd.program.positions import TRAJECTORY_TIMES, outside

WIND_ALTITUDES = TableName(4, "altitudes")


class Attitude(NamedTuple):
    """Attitude of camera and vehicle, with the quality of the solve: fields of `Results`."""

    start_deg: Floats
    camera_deg: Floats
    vehicle_deg: Floats
    residual_mm: Floats
    correction_rad: Floats
    last_pass: Ints
    singular: Bools


def attitude(
    film: FilmJobs, done: FilmOrientation, start: Floats, dropped: Bools, used: Bools
) -> Attitude:
    """Camera and vehicle angles and residuals of every frame (A 296 to A 304).

    Args:
        film: gives the vehicle's angles from the camera's.
        done: the solve.
        start: the angles it started from (3, F), degrees.
        dropped: frames that group 11 drops (F,); their angles are NaN.
        used: which landmarks take part (N,); the residuals of the others are NaN.
    """
    camera_deg = np.where(dropped, np.nan, done.angles).T
    return Attitude(
        start_deg=start.T,
        camera_deg=camera_deg,
        vehicle_deg=_vehicle_angles(film, camera_deg),
        residual_mm=np.where(used[:, None], done.eps, np.nan),
        correction_rad=done.correction.T,
        last_pass=done.last_pass,
        singular=done.singular,
    )


def _vehicle_angles(film: FilmJobs, camera_deg: Floats) -> Floats:
    """The vehicle's yaw, pitch, roll (F, 3), wrapped once (pitch to -180..180, others 0..360)."""
    low, high = np.array([0.0, -180.0, 0.0]), np.array([360.0, 180.0, 360.0])
    multiplier = film.by_frame([job.camera.multiplier for job in film.jobs])
    offset_deg = film.by_frame([job.camera.offset_deg for job in film.jobs])
    vehicle = multiplier * camera_deg + offset_deg
    vehicle = np.where(vehicle < low, vehicle + 360.0, vehicle)
    return np.asarray(np.where(vehicle > high, vehicle - 360.0, vehicle))


class AirAngles(NamedTuple):
    """Angles of attack and airspeed of the vehicle: fields of `Results`."""

    alpha_deg: Floats
    beta_deg: Floats
    eta_deg: Floats
    airspeed_ft_s: Floats
    outside_wind: Bools


class AirLookup(NamedTuple):
    """What the trajectory and the wind are at the time of each frame."""

    velocity_ft_s: Floats  # (F, 3) of the vehicle, north, east, down
    wind_ft_s: Floats  # (F, 2) north, east
    outside_wind: Bools  # (F,)


def air_lookup(film: FilmJobs, time_s: Floats) -> AirLookup:
    """Look up velocity and wind of every frame, and mark frames outside the wind table.

    Args:
        film: gives the trajectories and the wind.
        time_s: flight time (F,), seconds.

    Raises:
        TableOutOfOrder: if a table is not in order.

    Source: TM X-3050, C 6 to C 38.
    """
    paths, winds = [job.trajectory for job in film.jobs], [job.wind for job in film.jobs]
    heights = [(one.time_s, one.altitude_ft) for one in paths]
    altitude_ft = ftlup_each(time_s, film.frames, heights, TRAJECTORY_TIMES)
    by_height = [(one.altitude_ft, one.velocity_ft_s) for one in winds]
    wind_ft_s = ftlup_each(altitude_ft, film.frames, by_height, WIND_ALTITUDES)
    velocities = [(one.time_s, one.velocity_ft_s) for one in paths]
    return AirLookup(
        velocity_ft_s=ftlup_each(time_s, film.frames, velocities, TRAJECTORY_TIMES),
        wind_ft_s=wind_ft_s,
        outside_wind=outside(film, altitude_ft, [one.altitude_ft for one in winds]),
    )


def air_angles(air: AirLookup, vehicle_deg: Floats) -> AirAngles:
    """Compute the angles of attack of every frame.

    Args:
        air: velocity and wind.
        vehicle_deg: the vehicle's yaw, pitch, roll (F, 3), degrees.

    Source: TM X-3050, C 6 to C 38.
    """
    yaw, pitch, roll = vehicle_deg.T
    attack = alpbet(air.velocity_ft_s, air.wind_ft_s, theta=pitch, psi=yaw, phi=roll)
    return AirAngles(*attack, outside_wind=air.outside_wind)


def residual_deviation(
    residual: Floats, used: Bools, fitted: int, layout: LandmarkLayout
) -> Floats:
    """Root mean square of the residuals of each frame, which the listing calls standard deviation.

    Args:
        residual: residuals (N, 2), mm; those of landmarks that take no part are NaN.
        used: which landmarks take part (N,).
        fitted: the number of unknowns taken off the count of residuals: 0, or 3 if that is fixed.
        layout: which landmarks each frame has.

    Returns:
        The deviation (F,), mm.

    Source: TM X-3050, A 444 to A 447.
    """
    squares = np.where(used[:, None], residual, 0.0) ** 2
    # adds one after the other, x and y by turns: the order of a sum is part of its result
    total = np.bincount(np.repeat(layout.frame, 2), squares.ravel(), len(layout.count))
    return np.asarray(np.sqrt(total / (2.0 * layout.counted(used) - fitted)))
