"""Time of each frame, and positions of vehicle, camera and landmarks (A 121 to A 217)."""

from __future__ import annotations

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

FRAME_NUMBERS: TableName = (6, "frame numbers")
TRAJECTORY_TIMES: TableName = (7, "times")


class UndefinedLandmark(VopdError):
    """A landmark takes part in a frame, but no card of group 9 defines it."""

    def __init__(self, frame: int, landmark: int) -> None:
        super().__init__(f"frame {frame}: landmark {landmark} is not defined in group 9")
        self.frame = frame
        self.landmark = landmark


def time_and_position(job: Job) -> tuple[Floats, Floats]:
    """Look up the time of every frame of a job (F,), and where the vehicle is then (F, 3), feet.

    Checks and conversions ask it; `vopd` looks up the frames of all jobs at once.

    Raises:
        TableOutOfOrder: if one of its tables is not in order.
        TableNotANumber: if one of them holds a NaN.

    Source: TM X-3050, A 121 to A 128.
    """
    clock, path = job.clock, job.trajectory
    time_s = ftlup(job.readings.frame, clock.frame, clock.time_s, FRAME_NUMBERS)
    return time_s, ftlup(time_s, path.time_s, path.position_ft, TRAJECTORY_TIMES)


def group_9(landmarks: Landmarks, fixes: Fixes) -> tuple[Floats, Floats, Floats]:
    """Place the landmarks of group 9 on the sphere or, with the fix `earth`, on the ellipsoid.

    Args:
        landmarks: group 9.
        fixes: the errata to correct.

    Returns:
        THJ, longitude, degrees east; PHIJ, geocentric latitude, degrees; and RJ, distance from
        the Earth's centre, km; each (n,).

    Source: TM X-3050, A 174 to A 199. RJ is in feet on the card, in `altitude_ft` and before
    A 186; a line without a number behind the READ of group 9 multiplies it by 1000/FTPKM, which the
    printed altitudes show never to have run.
    """
    longitude_deg = landmarks.longitude_deg + landmarks.longitude_min / 60.0
    latitude_deg = geodetic_latitude_deg(landmarks)
    if Fix.EARTH in fixes:
        height = landmarks.altitude_ft
        phij, rj = ellipsoidal(fixes.ellipsoid, longitude_deg, latitude_deg, height)
    else:
        phij, rj = spherical(latitude_deg, landmarks.altitude_ft, fixes)
    return longitude_deg, phij, rj


def geodetic_latitude_deg(landmarks: Landmarks) -> Floats:
    """Add degrees and minutes of the landmarks' latitude in group 9, degrees (A 178)."""
    return landmarks.latitude_deg + landmarks.latitude_min / 60.0


def origin_of(job: Job) -> Floats:
    """Look up the origin of a job's trajectory in group 8 (3,).

    That is geodetic latitude and longitude east, degrees, and the distance from the Earth's
    centre, thousands of feet.
    """
    path = job.trajectory
    place = path.origin_latitude_deg, path.origin_longitude_deg, path.origin_radius_kft
    return np.array(place, dtype=np.float64)


def directions(
    origin: Floats,
    fixes: Fixes,
    vehicle_ft: Floats,
    thj: Floats,
    phij: Floats,
    rj: Floats,
    of: Ints | None = None,
) -> Floats:
    """Find direction cosines of landmarks along east, north, up at the camera (A 213 to A 217).

    Args:
        origin: of the trajectory, as `origin_of` has it: (3,), or (3, F) of every frame.
        fixes: which errata are corrected.
        vehicle_ft: the vehicle (F, 3), feet east, north, up of the origin.
        thj: longitudes of landmarks of each frame, (F, L) or (F,), degrees; or (N,) with `of`.
        phij: their geocentric latitudes, degrees.
        rj: their distances from the Earth's centre, kilometres.
        of: the frame of each landmark (N,).

    Returns:
        Cosines (F, L, 3), (F, 3) or (N, 3).
    """
    xyz = kilometres(fixes, vehicle_ft)
    thj, phij, rj = (np.ascontiguousarray(part.T) for part in (thj, phij, rj))
    if Fix.EARTH not in fixes:
        dircos = tgtcam(*_spherical(origin, fixes), xyz, thj, phij, rj, of)
    else:
        if of is not None:
            origin, xyz = origin[:, of] if origin.ndim > 1 else origin, xyz[:, of]
        dircos = ellipsoidal_directions(fixes.ellipsoid, origin, xyz, thj, phij, rj)
    return np.stack([part.T for part in dircos], axis=-1)


def landmarks_earth_fixed(thj: Floats, phij: Floats, rj: Floats) -> Floats:
    """Place landmarks as `group_9` has them in Earth-fixed axes, km (n, 3)."""
    theta, phi = np.radians(thj), np.radians(phij)
    unit = np.stack([np.cos(phi) * np.cos(theta), np.cos(phi) * np.sin(theta), np.sin(phi)], axis=1)
    return np.asarray(rj[:, None] * unit)


def earth_fixed(origin: Floats, fixes: Fixes, vehicle_ft: Floats) -> Floats:
    """Place the camera in Earth-fixed axes, km (F, 3).

    The Earth is the program's sphere, or the ellipsoid under the fix `earth`.

    Args:
        origin: of the trajectory, (3,) or (3, F).
        fixes: the errata to correct.
        vehicle_ft: the vehicle, feet (F, 3) along the axes of the trajectory.
    """
    xyz = kilometres(fixes, vehicle_ft)
    if Fix.EARTH in fixes:
        return ellipsoidal_position(fixes.ellipsoid, origin, xyz).T
    return np.stack(camera_position(*_spherical(origin, fixes), xyz), axis=-1)


def kilometres(fixes: Fixes, vehicle_ft: Floats) -> Floats:
    """Convert the vehicle's position to kilometres (3, F).

    Args:
        fixes: the errata to correct.
        vehicle_ft: the vehicle, feet (F, 3).

    Source: TM X-3050, A 214 to A 216.
    """
    feet = vftpkm if not {Fix.FEET_PER_KM, Fix.EARTH} & fixes.chosen else 1.0 / ftpkm
    return np.ascontiguousarray(vehicle_ft.T) * feet


def _spherical(origin: Floats, fixes: Fixes) -> tuple[Floats, Floats, Floats]:
    """Convert the origin to RZ, km, geocentric latitude PHIZ and longitude THZ, radians.

    Source: TM X-3050, A 49 to A 61, and the card before them, lost in the scan, by which RZ of
    group 8, thousands of feet, becomes km: RZ*1000/FTPKM.
    """
    latitude_deg, longitude_deg, radius_kft = origin
    phi = geocentric(latitude_deg, ORIGIN_FOUR_PHI, six_phi(fixes))
    return radius_kft * 1000.0 / ftpkm, phi / rad, longitude_deg / rad
