"""A flight project in a folder, made from a known truth, that tests can bend as they like."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from vopd.arrays import Floats
from vopd.flight.flight import Refraction
from vopd.flight.solve import sight_lines
from vopd.geometry.earth import earth_centred_m, geodetic, local_axes
from vopd.geometry.lenses import Lens, LensKind, project

SIZE = (1920, 1080)
K = np.array([-0.1, 0.02, 1e-3, -2e-3, 3e-3, 0, 0, 0, 0, 0, 0, 0])
LENS = Lens(
    LensKind.BROWN, SIZE, np.array([1500.0, 1490.0]), np.array([962.3, 534.8]), K
)  # fmt: skip
LATITUDE, LONGITUDE, HEIGHT = 47.6435, 16.4759, 460.0
MARKS = ("church", "mast", "bridge", "corner", "tower", "well")
EAST_NORTH_UP = np.array(
    [[-150, 420, 5], [60, 380, 30], [180, 500, -5], [-40, 300, 2], [20, 610, 60], [110, 330, 0]],
    dtype=np.float64,
)
FRAMES = 5
YAW, PITCH, ROLL = 5.0, -12.0, 2.0  # of the first frame; yaw grows by a degree a frame

TOML = """\
[flight]
name = "F12"
epoch = 2026-05-01T11:58:42Z
[camera]
image_size_px = [1920, 1080]
pixel_grid = "centre"
lens = { model = "brown", fx_px = 1500.0, fy_px = 1490.0, cx_px = 962.3, cy_px = 534.8, \
k = [-0.1, 0.02, 1e-3, -2e-3, 3e-3] }
[picks]
file = "picks.csv"
pixel_grid = "centre"
frame_rate_hz = 10.0
first_frame_t_s = 2.0
[landmarks]
file = "landmarks.csv"
height = "ellipsoid"
[track]
file = "track.csv"
height = "ellipsoid"
"""


def truth_deg() -> Floats:
    """Yaw, pitch and roll of the camera in each frame, (F, 3)."""
    angles = np.tile([YAW, PITCH, ROLL], (FRAMES, 1))
    angles[:, 0] += np.arange(FRAMES)
    return angles


def camera_m(time_s: Floats) -> Floats:
    """The camera's position at these times: 20 m/s north, 5 m/s east, climbing at 2 m/s."""
    start = earth_centred_m(LATITUDE, LONGITUDE, HEIGHT + 80.0)
    way = np.outer(np.asarray(time_s) - 2.0, [5.0, 20.0, 2.0])
    return np.asarray(start + way @ local_axes(start))


def marks_m() -> Floats:
    """Where the landmarks are, Earth-centred."""
    origin = earth_centred_m(LATITUDE, LONGITUDE, HEIGHT)
    return np.asarray(origin + EAST_NORTH_UP @ local_axes(origin))


def pixels(noise_px: float = 0.0, seed: int = 1) -> Floats:
    """Where each landmark is seen in each frame, (F, N, 2)."""
    frames, marks = np.divmod(np.arange(FRAMES * len(MARKS)), len(MARKS))
    lines = sight_lines(camera_m(2.0 + np.arange(FRAMES) / 10.0), marks_m(), frames, marks,
                        Refraction())  # fmt: skip
    rotations = [local_to_camera(angles) for angles in truth_deg()]
    ray = np.einsum("pij,pj->pi", np.array(rotations)[frames], lines.direction)
    noise = np.random.default_rng(seed).normal(0.0, noise_px, (len(frames), 2))
    return (project(LENS, ray).pixel + noise).reshape(FRAMES, len(MARKS), 2)


def local_to_camera(angles_deg: Floats) -> Floats:
    """East, north, up to right, down, forward, by yaw, pitch, roll of the forward body."""
    body = Rotation.from_euler("ZYX", angles_deg, degrees=True).as_matrix()  # columns in NED
    ned_from_enu = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]])
    camera_from_body = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]])
    return np.asarray(camera_from_body @ body.T @ ned_from_enu)


def write_project(folder: Path, toml: str = TOML, noise_px: float = 0.0) -> Path:
    """Write flight.toml and its three tables; the path of flight.toml."""
    folder.mkdir(exist_ok=True)
    seen = pixels(noise_px)
    rows = [
        f"{frame},{name},{u:.9f},{v:.9f}"
        for frame in range(FRAMES)
        for name, (u, v) in zip(MARKS, seen[frame], strict=True)
    ]
    (folder / "picks.csv").write_text("\n".join(["frame,landmark,u_px,v_px", *rows, ""]))
    where = geodetic(marks_m())
    rows = [
        f"{name},{a:.12f},{b:.12f},{h:.6f}" for name, a, b, h in zip(MARKS, *where, strict=True)
    ]
    (folder / "landmarks.csv").write_text("\n".join(["landmark,lat_deg,lon_deg,h_m", *rows, ""]))
    time_s = np.array([1.0, 2.0, 3.0, 4.0])
    where = geodetic(camera_m(time_s))
    rows = [f"{t},{a:.12f},{b:.12f},{h:.6f}" for t, a, b, h in zip(time_s, *where, strict=True)]
    (folder / "track.csv").write_text("\n".join(["t_s,lat_deg,lon_deg,h_m", *rows, ""]))
    path = folder / "flight.toml"
    path.write_text(toml)
    return path
