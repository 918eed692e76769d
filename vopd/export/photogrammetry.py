"""Camera orientations for photogrammetry: COLMAP, OpenDroneMap, and omega, phi, kappa."""

from __future__ import annotations

import io
from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.conventions import doubts_text
from vopd.attitude.history import History
from vopd.estimate import Words
from vopd.export import FileRequest, printable
from vopd.export.tables import cell_csv
from vopd.findings import Finding, Report, VopdError, count_text
from vopd.geometry.earth import NED_FROM_ENU, earth_centred_m, local_axes
from vopd.geometry.linear import inverse
from vopd.geometry.rotations import (
    IMAGE_FROM_CAMERA,
    PHOTOGRAPH_FROM_CAMERA,
    body_axes,
    camera_axes,
    from_axes,
)
from vopd.version import __version__

# The camera's attitude in the conventions of photogrammetry.
#
# Rx, Ry, Rz are right-handed turns of a vector about x, y, z, and angles are in degrees.


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
    """Find the poses of the camera in one job."""
    e = history.estimate
    here = e.position
    height_m = here.altitude * e.units.metres_per_length
    where = np.stack([here.longitude_deg, here.latitude_deg, height_m], axis=1)
    known: Bools = np.isfinite(np.hstack([where, e.camera_deg])).all(axis=1)
    frames = np.flatnonzero(known)
    if len(frames) < len(known):
        message = count_text(
            int((~known).sum()),
            "frame has no attitude or position and is left out",
            "frames have no attitude or position and are left out",
        )
        report(history.about.warning(message))
    camera = (IMAGE_FROM_CAMERA @ camera_axes(np.radians(e.camera_deg[frames]))).swapaxes(1, 2)
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
    """Name the program and the sources, and those that their residuals contradict, as comments."""
    sources = ", ".join(dict.fromkeys(h.about.source for h in histories))
    lines = [f"vopd {__version__}, {histories[0].about.words.source} {sources}"]
    lines += [f"doubtful: {one}" for one in doubts_text(histories)]
    return "\n# ".join(map(printable, lines))


def poses_of(histories: Sequence[History], report: Report) -> list[CameraPoses]:
    """Collect the poses of the jobs that have a frame.

    Raises:
        VopdError: where none has, or their heights are not above one level, as those of a file are
    """
    found = [one for one in (camera_poses(h, report) for h in histories) if len(one.frames)]
    if not found:
        raise VopdError("no frame has an attitude and a position")
    if len({one.history.about.words.altitude for one in found}) > 1:
        raise VopdError("the sources have heights above different levels: write a file for each")
    count = Counter(name for one in found for name in one.name)
    if twins := [name for name, times in count.items() if times > 1]:
        stand = count_text(len(twins), "name stands", "names stand")
        message = f"{stand} twice, as {twins[0]}, and readers go by the name: write a file for "
        message += "each source"
        report(Finding(message, histories[0].about.source, severity="warning"))
    return found


def yaw_pitch_roll_deg(local_from_camera: Floats) -> Floats:
    """Convert to yaw, pitch, roll of Pix4D, Metashape and ODM, (T, 3).

    With I the image axes as columns in east, north, up: I = Rz(-yaw) Rx(pitch) Ry(roll).
    They are the angles of an aircraft whose camera looks down, with the top of the
    picture forward. At pitch 90, a level view, yaw and roll are one turn.

    Args:
        local_from_camera: right, down, forward as columns in east, north, up, (T, 3, 3)
    """
    i = local_from_camera @ PHOTOGRAPH_FROM_CAMERA
    yaw = np.arctan2(i[:, 0, 1], i[:, 1, 1])
    pitch = np.arcsin(np.clip(i[:, 2, 1], -1.0, 1.0))
    roll = np.arctan2(-i[:, 2, 0], i[:, 2, 2])
    level = np.hypot(i[:, 0, 1], i[:, 1, 1]) < 1e-9
    yaw = np.where(level, np.arctan2(-i[:, 1, 0], i[:, 0, 0]), yaw)
    angles = np.stack([yaw, pitch, np.where(level, 0.0, roll)], axis=1)
    return np.asarray(np.degrees(angles))


def omega_phi_kappa_deg(grid_from_camera: Floats) -> Floats:
    """Convert to omega, phi, kappa of PATB and Pix4D, (T, 3): I = Rx(omega) Ry(phi) Rz(kappa).

    Args:
        grid_from_camera: right, down, forward as columns in grid east, grid north, up,
            (T, 3, 3)
    """
    i = grid_from_camera @ PHOTOGRAPH_FROM_CAMERA
    omega = np.arctan2(-i[:, 1, 2], i[:, 2, 2])
    phi = np.arcsin(np.clip(i[:, 0, 2], -1.0, 1.0))
    kappa = np.arctan2(-i[:, 0, 1], i[:, 0, 0])
    return np.asarray(np.degrees(np.stack([omega, phi, kappa], axis=1)))


@np.errstate(all="ignore")
def omega_phi_kappa_sigma_deg(poses: CameraPoses, grid: Floats) -> Floats:
    """Propagate the covariance of the camera's turn to omega, phi, kappa, (T, 3).

    A turn w, in grid east, north, up, is domega ex + dphi Rx ey + dkappa Rx Ry ez. The vehicle
    turns with the camera but for its mount, which has no part in these angles.

    Args:
        poses: of a flight; of a deck, whose vehicle need not turn as its camera, all are NaN
        grid: true east, north, up to grid east, grid north, up, (T, 3, 3)
    """
    one, k = poses.history, poses.frames
    turn = one.uncertainty.covariance_deg2[k] - one.uncertainty.sigmas.mount_deg**2 * np.eye(3)
    body = body_axes(np.radians(one.estimate.vehicle_deg[k]))
    axes = grid @ NED_FROM_ENU.T @ body  # forward, right, down of the vehicle in the grid
    omega, phi, _ = np.radians(omega_phi_kappa_deg(grid @ poses.local_from_camera)).T
    of_angles = np.zeros((len(k), 3, 3))
    of_angles[:, 0, 0] = 1.0
    of_angles[:, 1:, 1] = np.stack([np.cos(omega), np.sin(omega)], axis=1)
    of_angles[:, :, 2] = np.stack(
        [np.sin(phi), -np.sin(omega) * np.cos(phi), np.cos(omega) * np.cos(phi)], axis=1
    )
    by_turn = inverse(of_angles) @ axes
    sigma = np.sqrt(np.einsum("tij,tjk,tik->ti", by_turn, turn, by_turn))
    unknown = one.flags.raised["misfit"][k] | (one.about.words.source == "deck")
    return np.where(unknown[:, None], np.nan, sigma)


def grid_from_local(convergence_deg: Floats) -> Floats:
    """Rotate true east, north, up to grid east, grid north, up, (T, 3, 3).

    Args:
        convergence_deg: true azimuth less grid azimuth, (T,)
    """
    c, s = np.cos(np.radians(convergence_deg)), np.sin(np.radians(convergence_deg))
    turn = np.zeros((len(c), 3, 3))
    turn[:, 0, 0], turn[:, 0, 1], turn[:, 1, 0], turn[:, 1, 1], turn[:, 2, 2] = c, -s, s, c, 1.0
    return turn


def pose_in_site(poses: CameraPoses, origin_m: Floats) -> tuple[Floats, Floats]:
    """Place poses in a site: rotations (T, 3, 3) from its axes to the camera, positions (T, 3)."""
    site = local_axes(origin_m)
    to_camera = poses.local_from_camera.swapaxes(1, 2) @ poses.local_axes @ site.T
    return to_camera, (poses.position_m - origin_m) @ site.T


# COLMAP's images.txt: the rotation from a site's axes to the camera, and a translation.
#
# The site's axes are east, north, up at the first frame's position, in metres.

HEAD_COLMAP = """\
# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME
# POINTS2D[] as (X, Y, POINT3D_ID): none, so that every second line is empty
# {source}
# Q: Hamilton, scalar first, from site axes to camera axes (right, down, forward)
# T: metres; the camera is at -R' T. Site axes: east, north, up on WGS 84 at
# latitude {latitude:.9f}, longitude {longitude:.9f}, height {height:.4f} m {altitude}
{cameras}# Number of images: {count}
"""
CAMERAS = (
    "# CAMERA_ID: 1 to {}, a number for each lens, source by source: in a deck each focal length,\n"
    "# in a flight in the order in which the table that [camera] of_images names has them first\n"
)


def camera_numbers(found: Sequence[CameraPoses]) -> list[list[int]]:
    """Number the cameras of jobs, from 1: a number for each lens or focal length of a source.

    Args:
        found: the jobs, each with a frame or more

    Returns:
        Of each job the number of each frame's camera.
    """
    first: dict[tuple[str, float], int] = {}
    most = 0
    numbers = []
    for poses in found:
        e = poses.history.estimate
        own = first.setdefault((e.about.source, float(e.focal_length)), most + 1)
        which = np.zeros(len(poses.frames), np.int64) if e.lens is None else e.lens[poses.frames]
        numbers.append((own + which).tolist())
        most = max(most, *numbers[-1])
    return numbers


def render_colmap(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """Make the file, two lines for each frame that has an attitude."""
    found = poses_of(histories, report)
    camera = camera_numbers(found)
    origin = found[0].position_m[0]
    longitude, latitude, height = found[0].geodetic[0]
    lines: list[str] = []
    blanks = 0
    for poses, cameras in zip(found, camera, strict=True):
        rotation, position = pose_in_site(poses, origin)
        quaternion = from_axes(rotation.swapaxes(1, 2))
        translation = -(rotation @ position[..., None])[..., 0]
        for q, t, of, name in zip(quaternion, translation, cameras, poses.name, strict=True):
            numbers = " ".join(f"{x:.12g}" for x in np.concatenate([np.round(q, 12), t]) + 0.0)
            lines += [f"{len(lines) // 2 + 1} {numbers} {of} {printable(name)}", ""]
            blanks += len(name.split()) > 1
    if blanks:
        have = count_text(blanks, "name has", "names have")
        message = f"{have} a blank, and COLMAP reads a name to its first blank: rename the images"
        report(Finding(message, histories[0].about.source, severity="warning"))
    most = max(max(cameras) for cameras in camera)
    head = HEAD_COLMAP.format(
        cameras=CAMERAS.format(most) if most > 1 else "",
        source=source_text(histories),
        latitude=latitude,
        longitude=longitude,
        height=height,
        altitude=histories[0].about.words.altitude,
        count=len(lines) // 2,
    )
    return (head + "\n".join(lines) + "\n").encode()


# OpenDroneMap's geo.txt: image, longitude, latitude, height, yaw, pitch, roll of the camera.

HEAD_ODM_GEO = """\
EPSG:4326
# {source}
# image x y z yaw pitch roll: x longitude, y latitude, degrees, z metres {altitude}
# yaw, pitch, roll: of an aircraft whose camera looks down with the top of the picture forward,
# degrees, yaw from true north: image axes (right, up, backward) in east, north, up are
# Rz(-yaw) Rx(pitch) Ry(roll). Looking straight down they are 0 0 0 with the top to the north.
# Down is {down}.
# A level view has pitch 90, where yaw and roll are one turn: another format is better there.
"""
NEAR_LEVEL_DEG = 85.0


def render_odm_geo(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """Make the file, a line for each frame that has an attitude."""
    lines = []
    level = 0
    for poses in poses_of(histories, report):
        angles = yaw_pitch_roll_deg(poses.local_from_camera)
        level += int((np.abs(angles[:, 1]) > NEAR_LEVEL_DEG).sum())
        for name, where, angle in zip(poses.name, poses.geodetic, angles, strict=True):
            if len(name.split()) != 1 or name.startswith("#"):
                message = f"{name}: a name in geo.txt has no blank, and no # in front: the frame "
                message += "is left out"
                report(Finding(message, poses.history.about.source, severity="warning"))
                continue
            position = "{:.9f} {:.9f} {:.4f}".format(*where)
            turns = "{:.6f} {:.6f} {:.6f}".format(*(np.round(angle, 6) + 0.0))
            lines.append(f"{name} {position} {turns}")
    if level:
        looks = count_text(level, "frame looks", "frames look")
        message = f"{looks} nearly level or upward, where yaw and roll are ill defined"
        report(Finding(message, histories[0].about.source, severity="warning"))
    about = histories[0].about
    head = HEAD_ODM_GEO.format(
        source=source_text(histories), down=about.down, altitude=about.words.altitude
    )
    return (head + "\n".join(lines) + "\n").encode()


# Omega, phi, kappa of the camera against the map grid, CSV, with grid and true azimuth.
#
# Without a projected coordinate system the angles are against true east, north, up.

COLUMNS = (
    "image", "x", "y", "h_m", "omega_deg", "phi_deg", "kappa_deg", "azimuth_true_deg",
    "azimuth_grid_deg", "convergence_deg", "longitude_deg", "latitude_deg", "sigma_omega_deg",
    "sigma_phi_deg", "sigma_kappa_deg",
)  # fmt: skip
HEAD_OMEGA_PHI_KAPPA = """\
# {source}
# omega, phi, kappa: image axes (right, up in the picture, backward) in {axes} are
# Rx(omega) Ry(phi) Rz(kappa), right-handed turns of a vector, degrees. Looking straight down
# they are 0 0 0 with the top of the picture to the north.
# Down is {down}.
# x, y: {where}; h_m: metres {altitude}
# azimuth of the optical axis, clockwise; grid azimuth is the true one less the convergence
# sigma: one standard deviation, without Student's factor; empty where it is not known
"""


def render_omega_phi_kappa(
    histories: Sequence[History], request: FileRequest, report: Report
) -> bytes:
    """Make the file, a row for each frame that has an attitude.

    Raises:
        VopdError: where the jobs have different grids
    """
    found = poses_of(histories, report)
    grids = [one.history.estimate.grid for one in found]
    systems = {("", "") if one is None else (one.crs, one.counted) for one in grids}
    if len(systems) > 1:
        raise VopdError("the sources have different coordinate systems: write a file for each")
    crs, counted = systems.pop()
    altitude = histories[0].about.words.altitude
    page = io.StringIO()
    page.write(
        HEAD_OMEGA_PHI_KAPPA.format(
            down=histories[0].about.down,
            altitude=altitude + " of WGS 84" * (altitude == Words.altitude),
            source=source_text(histories),
            axes=f"grid east, grid north, up of {crs}" if crs else "true east, north, up",
            where=f"{counted}, {crs}" if crs else "longitude and latitude, degrees",
        )
    )
    page.write(",".join(COLUMNS) + "\n")
    for poses in found:
        page.writelines(",".join(row) + "\n" for row in _rows(poses))
    return page.getvalue().encode()


def _rows(poses: CameraPoses) -> list[list[str]]:
    estimate, k = poses.history.estimate, poses.frames
    longitude, latitude, height = poses.geodetic.T
    x, y, convergence = longitude, latitude, np.zeros(len(k))
    form = "%.9f"
    if estimate.grid is not None:
        x, y = estimate.grid.easting[k], estimate.grid.northing[k]
        convergence = estimate.grid.convergence_deg[k]
        form = "%.4f"
    grid = grid_from_local(convergence)
    angles = omega_phi_kappa_deg(grid @ poses.local_from_camera)
    sigmas = omega_phi_kappa_sigma_deg(poses, grid)
    yaw, pitch = estimate.camera_deg[k, :2].T
    azimuth = np.where(np.cos(np.radians(pitch)) < 0.0, yaw + 180.0, yaw)  # of the axis
    true_deg, grid_deg = np.round([azimuth, azimuth - convergence], 6) % 360.0
    columns: list[tuple[str, Floats]] = [
        (form, x), (form, y), ("%.4f", height),
        *(("%.6f", np.round(one, 6) + 0.0) for one in angles.T),
        ("%.6f", true_deg), ("%.6f", grid_deg), ("%.6f", np.round(convergence, 6) + 0.0),
        ("%.9f", longitude), ("%.9f", latitude), *(("%.6f", one) for one in sigmas.T),
    ]  # fmt: skip
    texts = [
        [text % value if np.isfinite(value) else "" for value in values.tolist()]
        for text, values in columns
    ]
    names = [cell_csv(printable(name)) for name in poses.name]
    return [[name, *row] for name, *row in zip(names, *texts, strict=True)]
