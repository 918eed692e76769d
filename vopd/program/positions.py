"""Time of each frame, and positions of vehicle, camera and landmarks (A 121 to A 217)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.errata import Fix, Fixes
from vopd.findings import VopdError
from vopd.job import Job, Landmarks
from vopd.program.constants import ftpkm, rad, vftpkm
from vopd.program.earth import ellipsoidal, ellipsoidal_directions, ellipsoidal_position
from vopd.program.film_jobs import FilmJobs
from vopd.program.ftlup import TableName, ftlup_each
from vopd.program.geocentric import ORIGIN_FOUR_PHI, geocentric, six_phi, spherical
from vopd.program.tgtcam import camera_position, tgtcam

FRAME_NUMBERS = TableName(6, "frame numbers")
TRAJECTORY_TIMES = TableName(7, "times")


class UndefinedLandmark(VopdError):
    """A landmark takes part in a frame, but no card of group 9 defines it."""

    def __init__(self, frame: int, landmark: int) -> None:
        super().__init__(f"frame {frame}: landmark {landmark} is not defined in group 9")
        self.frame = frame
        self.landmark = landmark


class TimeAndPosition(NamedTuple):
    """Time of each frame, and position of the vehicle: fields of `Results`."""

    time_s: Floats
    vehicle_ft: Floats
    outside_clock: Bools
    outside_trajectory: Bools


def time_and_position(film: FilmJobs) -> TimeAndPosition:
    """Look up the time of every frame, and the vehicle's position at that time.

    Args:
        film: gives the frames, the time tables and the trajectories.

    Raises:
        TableOutOfOrder: if one of the tables is not in order.

    Source: TM X-3050, A 121 to A 128.
    """
    clocks = [job.clock for job in film.jobs]
    paths = [job.trajectory for job in film.jobs]
    frame = film.readings.frame.astype(np.float64)
    numbers, times = [one.frame for one in clocks], [one.time_s for one in paths]
    by_frame = [(one.frame.astype(np.float64), one.time_s) for one in clocks]
    time_s = ftlup_each(frame, film.frames, by_frame, FRAME_NUMBERS)
    by_time = [(one.time_s, one.position_ft) for one in paths]
    return TimeAndPosition(
        time_s=time_s,
        vehicle_ft=ftlup_each(time_s, film.frames, by_time, TRAJECTORY_TIMES),
        outside_clock=outside(film, frame, numbers),
        outside_trajectory=outside(film, time_s, times),
    )


def outside(film: FilmJobs, x: Floats, tables: Sequence[Floats | Ints]) -> Bools:
    """Which values lie outside a table, so that FTLUP extrapolates.

    Args:
        film: the jobs.
        x: a value for each frame (F,).
        tables: the independent variable of the table of each job; one of one entry has
            no outside.
    """
    least, most = (film.by_frame([table[end] for table in tables]) for end in (0, -1))
    beyond: Bools = (x < least) | (x > most)
    return np.asarray(beyond & film.by_frame([len(table) > 1 for table in tables]))


class LandmarkPositions(NamedTuple):
    """Positions of the landmarks of each frame: fields of `Results`."""

    longitude_deg: Floats
    latitude_deg: Floats
    geocentric_latitude_deg: Floats
    altitude_ft: Floats
    radius_km: Floats
    radius_kft: Floats


def landmark_positions(film: FilmJobs, used: Bools, fixes: Fixes) -> LandmarkPositions:
    """Positions of the landmarks that take part in each frame, NaN for the others.

    Args:
        film: gives the landmarks of group 9.
        used: which landmarks take part (N,).
        fixes: the errata to correct.

    Raises:
        UndefinedLandmark: if one of them is not in group 9.

    Source: TM X-3050, A 162 to A 199.
    """
    table = _group_9([job.landmarks for job in film.jobs], fixes)
    rows = _rows_of_group_9(film, used)
    return LandmarkPositions(
        *(np.where(used, np.append(column, np.nan)[rows], np.nan) for column in table)
    )


def _rows_of_group_9(film: FilmJobs, used: Bools) -> Ints:
    """The row in the landmarks of all jobs for each landmark of each frame (N,)."""
    rows, before = [], 0
    for job, points in zip(film.jobs, film.points, strict=True):
        own = _rows_of_job(job, film.readings.points.landmark[points], used[points])
        rows.append(own + before)
        before += len(job.landmarks.number)
    return np.concatenate(rows)


def _rows_of_job(job: Job, number: Ints, used: Bools) -> Ints:
    """The row of `job.landmarks` for each landmark of each frame (N,); the last of a number."""
    defined = job.landmarks.number
    order = np.argsort(defined, kind="stable")
    index = np.searchsorted(defined[order], number, side="right") - 1
    rows = order[index] if len(order) else np.zeros(number.shape, np.intp)
    missing = used & (defined[rows] != number if len(order) else True)
    if missing.any():
        least = number[missing].min()
        frame = job.readings.frame[job.readings.layout.frame[missing & (number == least)][0]]
        raise UndefinedLandmark(int(frame), int(least))
    return rows


def _group_9(of_jobs: Sequence[Landmarks], fixes: Fixes) -> LandmarkPositions:
    """Every landmark of group 9, on the sphere or, under the fix `earth`, on the ellipsoid."""
    names = [f.name for f in fields(Landmarks)]
    marks = Landmarks(*(np.concatenate([getattr(m, name) for m in of_jobs]) for name in names))
    longitude_deg = marks.longitude_deg + marks.longitude_min / 60.0
    latitude_deg = marks.latitude_deg + marks.latitude_min / 60.0
    if Fix.EARTH in fixes:
        centred = ellipsoidal(fixes.ellipsoid, longitude_deg, latitude_deg, marks.altitude_ft)
    else:
        centred = spherical(latitude_deg, marks.altitude_ft, fixes)
    return LandmarkPositions(
        longitude_deg=longitude_deg,
        latitude_deg=latitude_deg,
        geocentric_latitude_deg=centred.latitude_deg,
        altitude_ft=marks.altitude_ft,
        radius_km=centred.radius_km,
        radius_kft=centred.radius_km * ftpkm / 1000.0,
    )


class Origin(NamedTuple):
    """The origin of a trajectory: one, or one for each of F frames of several jobs."""

    latitude_deg: Floats | float  # geodetic
    longitude_deg: Floats | float  # east
    radius_kft: Floats | float  # from the Earth's centre, thousands of feet


def origin_of(job: Job) -> Origin:
    """The origin of a job's trajectory, as group 8 has it.

    Args:
        job: the job.
    """
    path = job.trajectory
    return Origin(path.origin_latitude_deg, path.origin_longitude_deg, path.origin_radius_kft)


def directions(
    origin: Origin, fixes: Fixes, vehicle_ft: Floats, thj: Floats, phij: Floats, rj: Floats
) -> Floats:
    """Direction cosines of the landmarks along east, north, up at the camera (A 213 to A 217).

    Args:
        origin: of the trajectory.
        fixes: which errata are corrected.
        vehicle_ft: the vehicle (F, 3), feet east, north, up of the origin.
        thj: longitudes of landmarks of each frame, (F, L) or (F,), degrees.
        phij: their geocentric latitudes, degrees.
        rj: their distances from the Earth's centre, kilometres.

    Returns:
        Cosines (F, L, 3) or (F, 3).
    """
    xyz = _kilometres(fixes, vehicle_ft)
    marks = [np.ascontiguousarray(part.T) for part in (thj, phij, rj)]
    if Fix.EARTH in fixes:
        dircos = ellipsoidal_directions(fixes.ellipsoid, *origin, xyz, *marks)
    else:
        dircos = tgtcam(*_spherical(origin, fixes), xyz, *marks)
    return np.stack([part.T for part in dircos], axis=-1)


def earth_fixed(origin: Origin, fixes: Fixes, vehicle_ft: Floats) -> Floats:
    """Position of the camera in Earth-fixed axes, km (F, 3).

    The Earth is the program's sphere, or the ellipsoid under the fix `earth`.

    Args:
        origin: of the trajectory.
        fixes: the errata to correct.
        vehicle_ft: the vehicle, feet (F, 3) along the axes of the trajectory.
    """
    xyz = _kilometres(fixes, vehicle_ft)
    if Fix.EARTH in fixes:
        return ellipsoidal_position(fixes.ellipsoid, *origin, xyz).T
    return np.stack(camera_position(*_spherical(origin, fixes), xyz), axis=-1)


def _kilometres(fixes: Fixes, vehicle_ft: Floats) -> Floats:
    """The vehicle's position in kilometres (3, F)."""
    feet = vftpkm if not {Fix.FEET_PER_KM, Fix.EARTH} & fixes.chosen else 1.0 / ftpkm
    return np.ascontiguousarray(vehicle_ft.T) * feet


def _spherical(
    origin: Origin, fixes: Fixes
) -> tuple[Floats | float, Floats | float, Floats | float]:
    """Radius, km, geocentric latitude and longitude, radians, of the trajectory's origin."""
    phi = geocentric(origin.latitude_deg, ORIGIN_FOUR_PHI, six_phi(fixes))
    rz = origin.radius_kft * 1000.0 / ftpkm
    return rz, phi / rad, origin.longitude_deg / rad
