"""Derivatives of residuals and angles of attack with respect to what a deck states.

These are the landmarks, the position, the focal length and the time. The derivatives
are central differences of the run's own equations, so they hold for its Earth and its
vertical.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from vopd.arrays import Floats
from vopd.estimate import Responses
from vopd.film.image_axis import flat
from vopd.program.angles import attack_angles
from vopd.program.constants import ftpkm
from vopd.program.ftlup import TableOutOfOrder, ftlup
from vopd.program.orient import Sight, equations
from vopd.program.positions import directions
from vopd.program.tgtcam import Dircos
from vopd.results import Results

STEP_FT, STEP_MM, STEP_S, STEP_DEG, STEP_FT_S = 1.0, 1e-3, 1e-3, 1e-3, 1e-3


@np.errstate(all="ignore")
def responses(results: Results, seen: Sight, radians: Floats) -> Responses:
    """Compute the derivatives of one job at the angles it was solved to.

    Args:
        results: the job
        seen: what its solve was given
        radians: camera yaw, pitch, roll, (F, 3)
    """

    def residual(direction: Floats) -> Floats:
        dircos = Dircos(*(np.ascontiguousarray(direction[..., k].T) for k in range(3)))
        return flat(equations(radians.T, seen._replace(dircos=dircos))[0])

    def by_landmark(axis: Floats) -> Floats:
        return _central(lambda s: residual(_moved_landmarks(results, s * axis)), STEP_FT)

    def by_position(axis: Floats) -> Floats:
        return _central(lambda s: residual(_moved_vehicle(results, s * axis)), STEP_FT)

    def by_focal_length(step: float) -> Floats:
        return flat(equations(radians.T, seen._replace(cc=seen.cc + step * STEP_MM))[0])

    def by_time(step: float) -> Floats:
        return residual(_moved_vehicle(results, _travelled_ft(results, step * STEP_S)))

    steps = np.eye(3) * STEP_FT
    return Responses(
        landmark=np.stack([by_landmark(axis) for axis in steps], axis=-1),
        position=np.stack([by_position(axis) for axis in steps], axis=-1),
        focal_length=_central(by_focal_length, STEP_MM),
        time=_central(by_time, STEP_S),
        attack_by_camera=_attack_by_camera(results),
        attack_by_time=_attack_by_time(results),
        attack_by_velocity=_attack_by_velocity(results),
    )


def _moved_vehicle(results: Results, shift_ft: Floats) -> Floats:
    """Directions (F, L, 3) with the vehicle moved east, north, up by (F, 3) or (3,)."""
    marks = results.longitude_deg, results.geocentric_latitude_deg, results.radius_km
    return directions(results.job, results.fixes, results.vehicle_ft + shift_ft, *marks)


def _moved_landmarks(results: Results, shift_ft: Floats) -> Floats:
    """Directions (F, L, 3) with every landmark moved east, north, up by (3,)."""
    east, north, up = shift_ft / ftpkm
    latitude = np.radians(results.geocentric_latitude_deg)
    return directions(
        results.job,
        results.fixes,
        results.vehicle_ft,
        results.longitude_deg + np.degrees(east / (results.radius_km * np.cos(latitude))),
        results.geocentric_latitude_deg + np.degrees(north / results.radius_km),
        results.radius_km + up,
    )


def _travelled_ft(results: Results, later_s: float) -> Floats:
    """How far the vehicle moves within a time, (F, 3) east, north, up."""
    path = results.job.trajectory
    try:
        there = ftlup(results.time_s + later_s, 1, path.time_s, path.position_ft)
    except TableOutOfOrder:  # the run stopped there
        return np.full_like(results.vehicle_ft, np.nan)
    return there - results.vehicle_ft


def _attack_by_camera(results: Results) -> Floats:
    columns = []
    for k, multiplier in enumerate(results.job.camera.multiplier):
        turn = np.eye(3)[k] * STEP_DEG * multiplier
        change = _attack_deg(results, turn_deg=turn) - _attack_deg(results, turn_deg=-turn)
        columns.append(_short_way(change) / (2.0 * STEP_DEG))
    return np.stack(columns, axis=-1)


def _attack_by_time(results: Results) -> Floats:
    change = _attack_deg(results, STEP_S) - _attack_deg(results, -STEP_S)
    return np.radians(_short_way(change)) / (2.0 * STEP_S)


def _attack_by_velocity(results: Results) -> Floats:
    columns = []
    for axis in np.eye(3) * STEP_FT_S:
        change = _attack_deg(results, velocity=axis) - _attack_deg(results, velocity=-axis)
        columns.append(np.radians(_short_way(change)) / (2.0 * STEP_FT_S))
    return np.stack(columns, axis=-1)


def _attack_deg(
    results: Results,
    later_s: float = 0.0,
    turn_deg: Floats | float = 0.0,
    velocity: Floats | float = 0.0,
) -> Floats:
    """Alpha, beta, eta (F, 3) at a shifted time, attitude, and velocity north, east, down."""
    time_s, vehicle_deg = results.time_s + later_s, results.vehicle_deg + turn_deg
    path = results.job.trajectory
    faster = replace(path, velocity_ft_s=path.velocity_ft_s + velocity)
    try:
        _, air = attack_angles(replace(results.job, trajectory=faster), time_s, vehicle_deg)
    except TableOutOfOrder:  # the run stopped there
        return np.full((len(results.frame), 3), np.nan)
    return np.stack([air.alphad, air.betad, air.etad], axis=1)


def _short_way(change_deg: Floats) -> Floats:
    return np.asarray((change_deg + 180.0) % 360.0 - 180.0)


def _central(at: Callable[[float], Floats], step: float) -> Floats:
    return np.asarray((at(1.0) - at(-1.0)) / (2.0 * step))
