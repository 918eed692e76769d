"""Where the optical axis points on the sky, and the angles of the vehicle."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.body_angles import body_angles_deg
from vopd.geometry.camera_axes import camera_angles_deg
from vopd.geometry.local_axes import NED_FROM_ENU
from vopd.stellar.directions import right_ascension_declination_deg
from vopd.stellar.sky.apparent_places import SkyFrame

CAMERA_FROM_PHOTOGRAPH = np.diag([1.0, -1.0, -1.0])
"""From the report's camera axes (x right, y up, z backward) to x right, y down, z forward."""

LEFT_UP = np.diag([-1.0, 1.0, -1.0])
"""From the report's camera axes to image x left, image y up, and the optical axis."""


def sky_pointing(matrix: Floats, frame: SkyFrame | None, mount: Floats | None) -> dict[str, float]:
    """The pointing of a camera, by the names of columns.

    Args:
        matrix: rotation from ICRF axes (or those of the stars' coordinates) to camera axes, (3, 3)
        frame: the axes of the date and the place
        mount: from camera axes (x right, y down, z forward) to body axes, (3, 3)

    Returns:
        Right ascension (0 to 360 degrees, and hours) and declination; with a date also
        those of the true equator and equinox of date; with a place azimuth, elevation
        and roll of the camera; with a mount yaw, pitch and roll of the vehicle.
    """
    found = _equatorial(-matrix[2], "")
    if frame is None:
        return found
    found |= _equatorial(frame.of_date @ -matrix[2], "_of_date")
    if frame.local is None:
        return found
    to_local = frame.local @ matrix.T
    azimuth, elevation, roll = camera_angles_deg(LEFT_UP @ to_local.T).tolist()
    found |= {"azimuth_deg": azimuth, "elevation_deg": elevation, "camera_roll_deg": roll}
    if mount is not None:
        body = body_to_ned(matrix, frame.local, mount)
        names = ("vehicle_yaw_deg", "vehicle_pitch_deg", "vehicle_roll_deg")
        found |= dict(zip(names, body_angles_deg(body).tolist(), strict=True))
    return found


def body_to_ned(matrix: Floats, local: Floats, mount: Floats) -> Floats:
    """Forward, right and down of the vehicle as columns in north, east, down, (3, 3)."""
    camera = NED_FROM_ENU @ local @ matrix.T @ CAMERA_FROM_PHOTOGRAPH
    return np.asarray(camera @ mount.T)


def _equatorial(axis: Floats, suffix: str) -> dict[str, float]:
    ra, dec = right_ascension_declination_deg(axis)
    degrees = float(ra) % 360.0
    return {
        f"ra{suffix}_deg": degrees,
        f"ra{suffix}_hours": degrees / 15.0,
        f"dec{suffix}_deg": float(dec),
    }
