"""Time of each frame, and positions of vehicle, camera and landmarks (A 121 to A 217)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.errata import Fix, Fixes
from vopd.findings import VopdError
from vopd.job import Job, Landmarks
from vopd.program.constants import ftpkm, rad, vftpkm
from vopd.program.earth import ellipsoidal, ellipsoidal_directions, ellipsoidal_position
from vopd.program.ftlup import TableName, ftlup
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


def time_and_position(job: Job) -> tuple[Floats, Floats]:
    """Look up the time of every frame of a job (F,), and where the vehicle is then (F, 3), feet.

    Args:
        job: the job.

    Raises:
        TableOutOfOrder: if one of its tables is not in order.
        TableNotANumber: if one of them holds a NaN.

    Source: TM X-3050, A 121 to A 128.
    """
    clock, path = job.clock, job.trajectory
    time_s = ftlup(job.readings.frame, 1, clock.frame, clock.time_s, FRAME_NUMBERS)
    return time_s, ftlup(time_s, 1, path.time_s, path.position_ft, TRAJECTORY_TIMES)


class LandmarkPositions(NamedTuple):
    """Landmarks by longitude, degrees, geocentric latitude, degrees, and radius, kilometres."""

    longitude_deg: Floats
    latitude_deg: Floats
    radius_km: Floats

    def take(self, rows: Ints) -> LandmarkPositions:
        """The landmarks at these indices."""
        return LandmarkPositions(*(part[rows] for part in self))


def group_9(landmarks: Landmarks, fixes: Fixes) -> LandmarkPositions:
    """Place the landmarks of group 9 on the sphere or, with the fix `earth`, on the ellipsoid.

    Args:
        landmarks: group 9.
        fixes: the errata to correct.

    Source: TM X-3050, A 174 to A 199.
    """
    longitude_deg = landmarks.longitude_deg + landmarks.longitude_min / 60.0
    latitude_deg = geodetic_latitude_deg(landmarks)
    if Fix.EARTH in fixes:
        height = landmarks.altitude_ft
        centred = ellipsoidal(fixes.ellipsoid, longitude_deg, latitude_deg, height)
    else:
        centred = spherical(latitude_deg, landmarks.altitude_ft, fixes)
    return LandmarkPositions(longitude_deg, *centred)


def geodetic_latitude_deg(landmarks: Landmarks) -> Floats:
    """Latitude of landmarks in degrees, from the degrees and minutes of group 9 (A 178)."""
    return landmarks.latitude_deg + landmarks.latitude_min / 60.0


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
    origin: Origin,
    fixes: Fixes,
    vehicle_ft: Floats,
    thj: Floats,
    phij: Floats,
    rj: Floats,
    of: Ints | None = None,
) -> Floats:
    """Direction cosines of the landmarks along east, north, up at the camera (A 213 to A 217).

    Args:
        origin: of the trajectory.
        fixes: which errata are corrected.
        vehicle_ft: the vehicle (F, 3), feet east, north, up of the origin.
        thj: longitudes of landmarks of each frame, (F, L) or (F,), degrees; or (N,) with `of`.
        phij: their geocentric latitudes, degrees.
        rj: their distances from the Earth's centre, kilometres.
        of: the frame of each landmark (N,).

    Returns:
        Cosines (F, L, 3), (F, 3) or (N, 3).
    """
    xyz = _kilometres(fixes, vehicle_ft)
    thj, phij, rj = (np.ascontiguousarray(part.T) for part in (thj, phij, rj))
    if Fix.EARTH not in fixes:
        dircos = tgtcam(*_spherical(origin, fixes), xyz, thj, phij, rj, of)
    else:
        if of is not None:
            origin, xyz = Origin(*(np.asarray(part)[of] for part in origin)), xyz[:, of]
        dircos = ellipsoidal_directions(fixes.ellipsoid, *origin, xyz, thj, phij, rj)
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
