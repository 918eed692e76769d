"""Where the vehicle, its camera and the landmarks are (A 121 to A 217)."""

from __future__ import annotations

from typing import Any

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.errata import Fix, Fixes
from vopd.findings import VopdError
from vopd.job import Job
from vopd.program.constants import ftpkm, rad, vftpkm
from vopd.program.earth import ellipsoidal, ellipsoidal_directions, ellipsoidal_place
from vopd.program.ftlup import ftlup
from vopd.program.geocentric import ORIGIN_FOUR_PHI, geocentric, six_phi, spherical
from vopd.program.tgtcam import camera_place, tgtcam


class UndefinedLandmark(VopdError):
    """A landmark takes part in a frame and no card of group 9 defines it."""

    def __init__(self, frame: int, landmark: int) -> None:
        super().__init__(f"frame {frame}: landmark {landmark} is not defined in group 9")
        self.frame = frame
        self.landmark = landmark


def where_and_when(job: Job) -> dict[str, Any]:
    """Time and position of every frame (A 121 to A 128)."""
    clock, path = job.clock, job.trajectory
    frame = job.readings.frame.astype(np.float64)
    ti = ftlup(frame, 1, clock.frame, clock.time_s)
    return {
        "time_s": ti,
        "vehicle_ft": ftlup(ti, 1, path.time_s, path.position_ft),
        "outside_clock": outside(frame, clock.frame),
        "outside_trajectory": outside(ti, path.time_s),
    }


def outside(x: Floats, table: Floats | Ints) -> Bools:
    """Where a table of more than one entry is left."""
    beyond: Bools = (x < table[0]) | (x > table[-1])
    return beyond & (len(table) > 1)


def landmarks(job: Job, used: Bools, fixes: Fixes) -> dict[str, Any]:
    """Where the landmarks of every frame are on the Earth (A 162 to A 199)."""
    marks, number = job.landmarks, job.readings.landmark
    order = np.argsort(marks.number, kind="stable")  # the last of a number counts
    place = np.searchsorted(marks.number[order], number, side="right") - 1
    rows = order[place] if len(order) else np.zeros(number.shape, np.intp)
    missing = used & (marks.number[rows] != number if len(order) else True)
    if missing.any():
        least = number[missing].min()
        frame = job.readings.frame[(missing & (number == least)).any(axis=1)][0]
        raise UndefinedLandmark(int(frame), int(least))
    table = {
        "longitude_deg": marks.longitude_deg + marks.longitude_min / 60.0,
        "latitude_deg": marks.latitude_deg + marks.latitude_min / 60.0,
        "altitude_ft": marks.altitude_ft,
    }
    table |= ellipsoidal(table, fixes) if Fix.EARTH in fixes else spherical(table, fixes)
    table["radius_kft"] = table["radius_km"] * ftpkm / 1000.0
    if not len(order):
        table = dict.fromkeys(table, np.full(1, np.nan))
    return {name: np.where(used, column[rows], np.nan) for name, column in table.items()}


def directions(
    job: Job, fixes: Fixes, vehicle_ft: Floats, thj: Floats, phij: Floats, rj: Floats
) -> Floats:
    """Direction cosines (F, L, 3) along east, north, up at the camera (A 213 to A 217).

    `vehicle_ft` (F, 3) east, north, up of the origin; the landmarks (F, L) by
    longitude and geocentric latitude, degrees, and radius, km.
    """
    xyz = _kilometres(fixes, vehicle_ft)
    marks = [np.ascontiguousarray(part.T) for part in (thj, phij, rj)]
    if Fix.EARTH in fixes:
        dircos = ellipsoidal_directions(fixes.ellipsoid, job.trajectory, xyz, *marks)
    else:
        dircos = tgtcam(*_origin(job, fixes), xyz, *marks)
    return np.stack([part.T for part in dircos], axis=-1)


def earth_fixed(job: Job, fixes: Fixes, vehicle_ft: Floats) -> Floats:
    """The camera in Earth-fixed axes, km (F, 3), by the Earth that is in force."""
    xyz = _kilometres(fixes, vehicle_ft)
    if Fix.EARTH in fixes:
        return ellipsoidal_place(fixes.ellipsoid, job.trajectory, xyz).T
    return np.stack(camera_place(*_origin(job, fixes), xyz), axis=-1)


def _kilometres(fixes: Fixes, vehicle_ft: Floats) -> Floats:
    feet = vftpkm if not {Fix.FEET_PER_KM, Fix.EARTH} & fixes.chosen else 1.0 / ftpkm
    return np.ascontiguousarray(vehicle_ft.T) * feet


def _origin(job: Job, fixes: Fixes) -> tuple[float, float, float]:
    """Radius, km, geocentric latitude and longitude, radians, of the trajectory's origin."""
    path = job.trajectory
    phi = geocentric(path.origin_latitude_deg, ORIGIN_FOUR_PHI, six_phi(fixes))
    rz = path.origin_radius_kft * 1000.0 / ftpkm
    return rz, float(phi) / rad, path.origin_longitude_deg / rad
