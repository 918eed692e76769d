"""Turn the solved camera angles into the printed angles (A 296 to A 312, A 444 to A 448)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.job import Camera, Job
from vopd.landmark_layout import LandmarkLayout
from vopd.program.alpbet import Alpbet, alpbet
from vopd.program.frames import FilmOrientation
from vopd.program.ftlup import TableName, ftlup
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
    camera: Camera, done: FilmOrientation, start: Floats, dropped: Bools, used: Bools
) -> Attitude:
    """Camera and vehicle angles and residuals of every frame (A 296 to A 304).

    Args:
        camera: gives the vehicle's angles from the camera's.
        done: the solve.
        start: the angles it started from (3, F), degrees.
        dropped: frames that group 11 drops (F,); their angles are NaN.
        used: which landmarks take part (N,); the residuals of the others are NaN.
    """
    camera_deg = np.where(dropped, np.nan, done.angles).T
    return Attitude(
        start_deg=start.T,
        camera_deg=camera_deg,
        vehicle_deg=_vehicle_angles(camera, camera_deg),
        residual_mm=np.where(used[:, None], done.eps, np.nan),
        correction_rad=done.correction.T,
        last_pass=done.last_pass,
        singular=done.singular,
    )


def _vehicle_angles(camera: Camera, camera_deg: Floats) -> Floats:
    """The vehicle's yaw, pitch, roll (F, 3), wrapped once (pitch to -180..180, others 0..360)."""
    low, high = np.array([0.0, -180.0, 0.0]), np.array([360.0, 180.0, 360.0])
    vehicle = camera.multiplier * camera_deg + camera.offset_deg
    vehicle = np.where(vehicle < low, vehicle + 360.0, vehicle)
    return np.where(vehicle > high, vehicle - 360.0, vehicle)


class AirAngles(NamedTuple):
    """Angles of attack and airspeed of the vehicle: fields of `Results`."""

    alpha_deg: Floats
    beta_deg: Floats
    eta_deg: Floats
    airspeed_ft_s: Floats
    outside_wind: Bools


def air_angles(job: Job, time_s: Floats, vehicle_deg: Floats) -> AirAngles:
    """Compute the angles of attack of every frame, and mark frames outside the wind table.

    Args:
        job: gives the trajectory and the wind.
        time_s: flight time (F,), seconds.
        vehicle_deg: the vehicle's yaw, pitch, roll (F, 3), degrees.
    """
    z, attack = attack_angles(job, time_s, vehicle_deg)
    return AirAngles(*attack, outside_wind=outside(z, job.wind.altitude_ft))


def attack_angles(job: Job, time_s: Floats, vehicle_deg: Floats) -> tuple[Floats, Alpbet]:
    """Look up altitude, velocity and wind at some times, and compute the angles of attack.

    Args:
        job: gives the trajectory and the wind.
        time_s: flight time (F,), seconds.
        vehicle_deg: the vehicle's yaw, pitch, roll (F, 3), degrees.

    Returns:
        The altitude (F,), ft, and the results of ALPBET.

    Source: TM X-3050, C 6 to C 38.
    """
    path = job.trajectory
    z = ftlup(time_s, 1, path.time_s, path.altitude_ft, TRAJECTORY_TIMES)
    wind = ftlup(z, 1, job.wind.altitude_ft, job.wind.velocity_ft_s, WIND_ALTITUDES)
    v1 = ftlup(time_s, 1, path.time_s, path.velocity_ft_s, TRAJECTORY_TIMES)
    yaw, pitch, roll = vehicle_deg.T
    return z, alpbet(v1, wind, theta=pitch, psi=yaw, phi=roll)


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
