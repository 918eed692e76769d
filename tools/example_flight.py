"""Make the example that `vopd new` copies: a rendered video, six clicks, track, lens, truth.

    python tools/example_flight.py

A drone flies over fields; the landmarks are corners of what is on the ground. The frames are
rendered with the lens's distortion and compressed as H.264; the clicks, all in frame 0, have errors
of half a pixel. Needs PyAV. Another version of it may write other bytes of the video.
"""

from __future__ import annotations

import json
from datetime import UTC, datetime, timedelta
from functools import cache
from pathlib import Path
from typing import Any

import av
import numpy as np
from scipy.ndimage import map_coordinates
from scipy.spatial.transform import Rotation

from vopd.arrays import Floats
from vopd.flight.flight import Refraction
from vopd.flight.formats.picks import CLICKS
from vopd.flight.solve.lines_of_sight import sight_lines
from vopd.geometry.earth import earth_centred_m, geodetic, local_axes
from vopd.geometry.lenses import Lens, LensKind, project, ray_of_pixel

EXAMPLE = Path(__file__).resolve().parent.parent / "vopd" / "flight" / "example"
SIZE = (640, 360)
K = [-0.12, 0.03, 0.0005, -0.0003, 0.0]
LENS = Lens(
    LensKind.BROWN, SIZE, np.array([520.0, 520.0]), np.array([317.4, 181.2]),
    np.array(K + [0.0] * 7),
)  # fmt: skip
GROUND = 48.21, 15.62, 310.0  # latitude, longitude, ellipsoidal height of the origin
EPOCH = datetime(2026, 5, 1, 9, 30, 0, 240000, tzinfo=UTC)
RATE_HZ, FRAMES = 25, 51
START, VELOCITY = np.array([-40.0, -60.0, 115.0]), np.array([5.0, 13.0, 0.8])
MARKS = {  # east and north of a corner; how far it reaches, and its turn from east, degrees; colour
    "pond": (30.0, 40.0, 24.0, 15.0, 20.0, (48, 74, 96)),
    "court": (105.0, 120.0, 24.0, 12.0, -15.0, (172, 92, 66)),
    "barn": (5.0, 165.0, 14.0, 20.0, 40.0, (158, 60, 52)),
    "yard": (95.0, 215.0, 20.0, 26.0, 5.0, (214, 212, 204)),
    "lawn": (185.0, 165.0, 40.0, 26.0, -35.0, (70, 140, 58)),
    "hall": (-20.0, 95.0, 12.0, 22.0, 65.0, (226, 226, 232)),
}
FIELDS = [(123, 148, 84), (152, 166, 96), (186, 172, 112), (104, 131, 78), (141, 120, 86)]
WEST_EAST_M, SOUTH_NORTH_M, CELL_M = (-220.0, 480.0), (-40.0, 560.0), 0.25  # what is drawn
FINER = 3  # rays a pixel, each way
QUALITY = 22  # constant rate factor of x264


def angles_deg(time_s: Floats) -> Floats:
    """True yaw, pitch, roll, (F, 3)."""
    t = np.asarray(time_s)
    yaw = 28.0 + 7.0 * np.sin(1.6 * t)
    return np.stack([yaw, -38.0 + 2.0 * np.sin(2.3 * t + 1.0), 5.0 * np.sin(1.1 * t + 0.4)], axis=1)


def origin_m() -> Floats:
    """The origin on the ground, Earth-centred."""
    return earth_centred_m(*GROUND)


def camera_m(time_s: Floats) -> Floats:
    """The camera, Earth-centred, (F, 3)."""
    way = START + np.outer(time_s, VELOCITY)
    return np.asarray(origin_m() + way @ local_axes(origin_m()))


def rotations(angles: Floats) -> Floats:
    """From local east, north, up to camera axes, (F, 3, 3)."""
    body = Rotation.from_euler("ZYX", angles, degrees=True).as_matrix()
    ned_from_enu = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]])
    camera_from_body = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]])
    return np.asarray(camera_from_body @ body.swapaxes(1, 2) @ ned_from_enu)


def seen_px(time_s: Floats, points: Floats) -> Floats:
    """Where points, east, north, up of the origin, are seen at times, (F, N, 2)."""
    frame, mark = np.divmod(np.arange(len(time_s) * len(points)), len(points))
    earth = origin_m() + points @ local_axes(origin_m())
    lines = sight_lines(camera_m(time_s), earth, frame, mark, Refraction())
    turn = rotations(angles_deg(time_s))
    ray = np.einsum("pij,pj->pi", turn[frame], lines.direction)
    return project(LENS, ray).pixel.reshape(len(time_s), len(points), 2)


def rough(rng: np.random.Generator, east: Floats, north: Floats) -> Floats:
    """Draw smooth noise of several sizes, grey levels, (N,)."""
    out = np.zeros(len(east))
    for size_m, strength in ((40.0, 9.0), (14.0, 8.0), (5.0, 7.0)):
        grid = rng.normal(0.0, strength, (128, 128))
        i, j = east / size_m + 64.0, north / size_m + 32.0
        i0, j0 = np.floor(i).astype(int), np.floor(j).astype(int)
        a, b = i - i0, j - j0
        for di, dj, part in ((0, 0, (1 - a) * (1 - b)), (1, 0, a * (1 - b)), (0, 1, (1 - a) * b),
                             (1, 1, a * b)):  # fmt: skip
            out += part * grid[(i0 + di) % 128, (j0 + dj) % 128]
    return out


@cache
def ground() -> Floats:
    """Draw the ground: fields with furrows, roads, trees, and the landmarks, (north, east, 3)."""
    rng = np.random.default_rng(3)
    sides = [np.arange(low, high, CELL_M) for low, high in (WEST_EAST_M, SOUTH_NORTH_M)]
    east, north = (one.ravel() for one in np.meshgrid(*sides))
    along, across = 0.94 * east + 0.34 * north, -0.34 * east + 0.94 * north
    cell = (np.floor(along / 70.0) * 7 + np.floor(across / 45.0) * 3).astype(int) % len(FIELDS)
    colour = np.array(FIELDS, dtype=float)[cell] + rough(rng, east, north)[:, None]
    colour[(cell % 2 == 0) & (along % 9.0 < 4.5)] -= 10.0
    road = (np.abs(across % 180.0 - 20.0) < 3.0) | (np.abs(along % 130.0 - 30.0) < 2.5)
    colour[road] = (196, 192, 184)
    for _ in range(130):
        x, y, radius = rng.uniform(*WEST_EAST_M), rng.uniform(*SOUTH_NORTH_M), rng.uniform(2.0, 4.5)
        colour[np.hypot(east - x, north - y) < radius] = (58, 84, 50)
    for x, y, wide, deep, turn_deg, own in MARKS.values():
        c, s = np.cos(np.radians(turn_deg)), np.sin(np.radians(turn_deg))
        a, b = c * (east - x) + s * (north - y), c * (north - y) - s * (east - x)
        colour[(a > -6.0) & (a < wide + 6.0) & (b > -6.0) & (b < deep + 6.0)] = (112, 138, 78)
        colour[(a > 0.0) & (a < wide) & (b > 0.0) & (b < deep)] = own
    return colour.reshape(len(sides[1]), len(sides[0]), 3)


@cache
def rays() -> Floats:
    """Undistort FINER by FINER rays a pixel, (N, 3)."""
    step = 1.0 / FINER
    u = np.arange(SIZE[0] * FINER) * step - 0.5 + step / 2.0
    v = np.arange(SIZE[1] * FINER) * step - 0.5 + step / 2.0
    pixel = np.stack(np.meshgrid(u, v), axis=-1)
    return np.nan_to_num(ray_of_pixel(LENS, pixel.reshape(-1, 2)))


def rendered(time_s: float) -> Any:
    """Render one frame, (V, U, 3) uint8."""
    ray = rays() @ rotations(angles_deg(np.array([time_s])))[0]
    camera = START + time_s * VELOCITY
    reach = camera[2] / -ray[:, 2]  # all rays go down
    east, north = (camera[:2] + ray[:, :2] * reach[:, None]).T
    at = (north - SOUTH_NORTH_M[0]) / CELL_M, (east - WEST_EAST_M[0]) / CELL_M
    colour = [
        map_coordinates(one, at, order=1, mode="nearest") for one in np.moveaxis(ground(), 2, 0)
    ]
    haze = np.clip(reach / 2500.0, 0.0, 0.85)
    light = np.stack(colour, axis=1) * (1.0 - haze)[:, None] + 205.0 * haze[:, None]
    mean = light.reshape(SIZE[1], FINER, SIZE[0], FINER, 3).mean(axis=(1, 3))
    return np.clip(mean, 0.0, 255.0).round().astype(np.uint8)


def compress(path: Path) -> None:
    """Render all frames and write them as H.264."""
    with av.open(str(path), "w", options={"movflags": "+faststart"}) as container:
        stream: Any = container.add_stream("libx264", rate=RATE_HZ)
        stream.width, stream.height, stream.pix_fmt = *SIZE, "yuv420p"
        stream.codec_context.thread_count = 1
        stream.options = {"preset": "veryslow", "crf": str(QUALITY), "g": str(FRAMES)}
        for k in range(FRAMES):
            container.mux(stream.encode(av.VideoFrame.from_ndarray(rendered(k / RATE_HZ), "rgb24")))
        container.mux(stream.encode())


def table(header: str, rows: list[str]) -> str:
    """The text of a CSV file."""
    return "\n".join([header, *rows, ""])


def files() -> dict[str, str]:
    """The texts of the example by the names of their files."""
    time_s = np.arange(FRAMES) / RATE_HZ
    points = np.array([[*one[:2], 0.0] for one in MARKS.values()])
    noise = np.random.default_rng(7).normal(0.0, 0.5, (len(MARKS), 2))
    picks = [
        f"0,{name},{u:.1f},{v:.1f}"
        for name, (u, v) in zip(MARKS, seen_px(time_s[:1], points)[0] + noise, strict=True)
    ]
    where = geodetic(origin_m() + points @ local_axes(origin_m()))
    marks = [f"{n},{a:.8f},{b:.8f},{h:.3f}" for n, a, b, h in zip(MARKS, *where, strict=True)]
    fix_s = np.arange(-1.24, 4.0)  # whole seconds of UTC
    here = geodetic(camera_m(fix_s))
    track = [
        f"{(EPOCH + timedelta(seconds=float(t))).strftime('%Y-%m-%dT%H:%M:%SZ')},"
        f"{a:.8f},{b:.8f},{h:.3f}"
        for t, a, b, h in zip(fix_s, *here, strict=True)
    ]
    lens = {
        "image_width": SIZE[0],
        "image_height": SIZE[1],
        "camera_matrix": {
            "type_id": "opencv-matrix", "rows": 3, "cols": 3, "dt": "d",
            "data": [520.0, 0.0, 317.4, 0.0, 520.0, 181.2, 0.0, 0.0, 1.0],
        },
        "distortion_coefficients": {
            "type_id": "opencv-matrix", "rows": 1, "cols": 5, "dt": "d", "data": K,
        },
    }  # fmt: skip
    return {
        "clicks.csv": table(f"{CLICKS}\nframe,landmark,u_px,v_px", picks),
        "landmarks.csv": table("landmark,lat_deg,lon_deg,h_m", marks),
        "track.csv": table("t_utc,lat_deg,lon_deg,h_m", track),
        "lens.json": json.dumps(lens, indent=1) + "\n",
        "wind.csv": table("h_m,from_deg,speed_m_s", ["300,240,3.0", "500,255,6.5"]),
        "truth.csv": table(
            "frame,t_s,yaw_deg,pitch_deg,roll_deg",
            [
                f"{n},{t:.2f},{y % 360.0:.4f},{p:.4f},{r % 360.0:.4f}"
                for n, (t, (y, p, r)) in enumerate(zip(time_s, angles_deg(time_s), strict=True))
            ],
        ),
    }


def main() -> None:
    """Write all files."""
    EXAMPLE.mkdir(exist_ok=True)
    for name, text in files().items():
        (EXAMPLE / name).write_text(text, encoding="utf-8", newline="\n")
    compress(EXAMPLE / "flight.mp4")


if __name__ == "__main__":
    main()
