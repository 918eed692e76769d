"""The camera's attitude in the conventions of photogrammetry.

Camera axes are right, down, forward. The image axes of photogrammetry are right, up
in the picture, and backward. Rx, Ry, Rz are right-handed turns of a vector about
x, y, z, and angles are in degrees.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.history import History
from vopd.export.file_request import printable
from vopd.findings import Finding, Report, VopdError
from vopd.geometry.camera_axes import camera_axes
from vopd.geometry.earth import earth_centred_m, local_axes
from vopd.geometry.local_axes import NED_FROM_ENU
from vopd.version import __version__

IMAGE_FROM_CAMERA = np.diag([1.0, -1.0, -1.0])


class CameraPoses(NamedTuple):
    """The frames of a job that have an attitude and a position, T of them."""

    history: History
    frames: Ints  # (T,) their indices
    name: list[str]  # the image's name, or the frame's number
    local_from_camera: Floats  # (T, 3, 3) right, down, forward as columns in east, north, up
    local_axes: Floats  # (T, 3, 3) east, north, up as rows, Earth-centred
    position_m: Floats  # (T, 3) Earth-centred
    geodetic: Floats  # (T, 3) longitude, latitude, height above the ellipsoid in metres


def camera_poses(history: History, report: Report) -> CameraPoses:
    """The camera's poses of one job.

    Args:
        history: the job
        report: is given a warning about frames that are left out
    """
    e = history.estimate
    here = e.position
    height_m = here.altitude * e.units.metres_per_length
    where = np.stack([here.longitude_deg, here.latitude_deg, height_m], axis=1)
    known: Bools = np.isfinite(np.hstack([where, e.camera_deg])).all(axis=1)
    frames = np.flatnonzero(known)
    if len(frames) < len(known):
        message = f"{(~known).sum()} frames have no attitude or position and are left out"
        report(Finding(message, history.about.source, job=history.about.job, severity="warning"))
    axes = camera_axes(np.radians(e.camera_deg[frames]))  # left, up in the picture, forward
    camera = (axes * np.array([-1.0, -1.0, 1.0])[:, None]).swapaxes(1, 2)
    longitude, latitude, height = where[frames].T
    return CameraPoses(
        history,
        frames,
        [e.frame_label(k) for k in frames.tolist()],
        camera,
        NED_FROM_ENU @ here.north_east_down[frames],
        earth_centred_m(latitude, longitude, height),
        where[frames],
    )


def source_text(histories: Sequence[History]) -> str:
    """The program and the sources, for the beginning of a file."""
    sources = printable(", ".join(dict.fromkeys(h.about.source for h in histories)))
    return f"vopd {__version__}, {histories[0].about.words.source} {sources}"


def some(poses: list[CameraPoses]) -> list[CameraPoses]:
    """The jobs that have a frame.

    Raises:
        VopdError: where none has
    """
    left = [one for one in poses if len(one.frames)]
    if not left:
        raise VopdError("no frame has an attitude and a position")
    return left


def yaw_pitch_roll_deg(local_from_camera: Floats) -> Floats:
    """Yaw, pitch, roll of Pix4D, Metashape and ODM, (T, 3).

    With I the image axes as columns in east, north, up: I = Rz(-yaw) Rx(pitch) Ry(roll).
    They are the angles of an aircraft whose camera looks down, with the top of the
    picture forward. At pitch 90, a level view, yaw and roll are one turn.

    Args:
        local_from_camera: right, down, forward as columns in east, north, up, (T, 3, 3)
    """
    i = local_from_camera @ IMAGE_FROM_CAMERA
    yaw = np.arctan2(i[:, 0, 1], i[:, 1, 1])
    pitch = np.arcsin(np.clip(i[:, 2, 1], -1.0, 1.0))
    roll = np.arctan2(-i[:, 2, 0], i[:, 2, 2])
    level = np.hypot(i[:, 0, 1], i[:, 1, 1]) < 1e-9
    yaw = np.where(level, np.arctan2(-i[:, 1, 0], i[:, 0, 0]), yaw)
    angles = np.stack([yaw, pitch, np.where(level, 0.0, roll)], axis=1)
    return np.asarray(np.degrees(angles))


def omega_phi_kappa_deg(grid_from_camera: Floats) -> Floats:
    """Omega, phi, kappa of PATB and Pix4D, (T, 3): I = Rx(omega) Ry(phi) Rz(kappa).

    Args:
        grid_from_camera: right, down, forward as columns in grid east, grid north, up,
            (T, 3, 3)
    """
    i = grid_from_camera @ IMAGE_FROM_CAMERA
    omega = np.arctan2(-i[:, 1, 2], i[:, 2, 2])
    phi = np.arcsin(np.clip(i[:, 0, 2], -1.0, 1.0))
    kappa = np.arctan2(-i[:, 0, 1], i[:, 0, 0])
    return np.asarray(np.degrees(np.stack([omega, phi, kappa], axis=1)))


def grid_from_local(convergence_deg: Floats) -> Floats:
    """From true east, north, up to grid east, grid north, up, (T, 3, 3).

    Args:
        convergence_deg: true azimuth less grid azimuth, (T,)
    """
    c, s = np.cos(np.radians(convergence_deg)), np.sin(np.radians(convergence_deg))
    turn = np.zeros((len(c), 3, 3))
    turn[:, 0, 0], turn[:, 0, 1], turn[:, 1, 0], turn[:, 1, 1], turn[:, 2, 2] = c, -s, s, c, 1.0
    return turn


def pose_in_site(poses: CameraPoses, origin_m: Floats) -> tuple[Floats, Floats]:
    """Rotations (T, 3, 3) from a site's east, north, up to the camera, and positions (T, 3) there.

    Args:
        poses: the camera's
        origin_m: the site's origin, Earth-centred
    """
    site = local_axes(origin_m)
    to_camera = poses.local_from_camera.swapaxes(1, 2) @ poses.local_axes @ site.T
    return to_camera, (poses.position_m - origin_m) @ site.T
