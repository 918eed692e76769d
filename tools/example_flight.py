"""Make the example that `vopd new` copies: frames of a rendered video, picks, track, lens, truth.

    python tools/example_flight.py

A drone flies over fields with six landmarks on masts. The frames are rendered with the lens's
distortion; the picks have errors of half a pixel. Needs Pillow.
"""

from __future__ import annotations

import json
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw
from scipy.spatial.transform import Rotation

from vopd.arrays import Floats
from vopd.flight.flight import Refraction
from vopd.flight.lines_of_sight import sight_lines
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
RATE_HZ, EVERY, LAST = 25.0, 5, 100  # each fifth frame is picked
RENDERED = (0, 50, 100)
START, VELOCITY = np.array([-40.0, -60.0, 115.0]), np.array([5.0, 13.0, 0.8])
MARKS = {  # east, north, and height of the mast's top
    "chapel": (40.0, 330.0, 24.0), "silo": (150.0, 270.0, 18.0), "pylon": (330.0, 420.0, 35.0),
    "barn": (215.0, 180.0, 9.0), "bridge": (120.0, 520.0, 6.0), "mast": (260.0, 610.0, 48.0),
}  # fmt: skip
FIELDS = [(123, 148, 84), (152, 166, 96), (186, 172, 112), (104, 131, 78), (141, 120, 86)]
FINER = 3  # rays a pixel, each way


def angles_deg(time_s: Floats) -> Floats:
    """True yaw, pitch, roll, (F, 3)."""
    t = np.asarray(time_s)
    yaw = 28.0 + 7.0 * np.sin(1.6 * t)
    return np.stack([yaw, -16.0 + 2.0 * np.sin(2.3 * t + 1.0), 5.0 * np.sin(1.1 * t + 0.4)], axis=1)


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


def rendered(time_s: float) -> Image.Image:
    """One frame: fields, sky, and a mast with a white and red disc for each landmark."""
    step = 1.0 / FINER
    u = np.arange(SIZE[0] * FINER) * step - 0.5 + step / 2.0
    v = np.arange(SIZE[1] * FINER) * step - 0.5 + step / 2.0
    pixel = np.stack(np.meshgrid(u, v), axis=-1)
    turn = rotations(angles_deg(np.array([time_s])))[0]
    ray = np.nan_to_num(ray_of_pixel(LENS, pixel.reshape(-1, 2))) @ turn
    camera = START + time_s * VELOCITY
    down = ray[:, 2] < -1e-3
    reach = np.where(down, camera[2] / np.where(down, -ray[:, 2], 1.0), 0.0)
    east, north = (camera[:2] + ray[:, :2] * reach[:, None]).T
    along, across = 0.94 * east + 0.34 * north, -0.34 * east + 0.94 * north
    cell = (np.floor(along / 70.0) * 7 + np.floor(across / 45.0) * 3).astype(int) % len(FIELDS)
    ground = np.array(FIELDS, dtype=float)[cell]
    road = (np.abs(across % 180.0 - 20.0) < 3.0) | (np.abs(along % 260.0 - 30.0) < 2.5)
    ground[road] = (196, 192, 184)
    haze = np.clip(reach / 2500.0, 0.0, 0.85)[:, None]
    sky = np.array([196.0, 212.0, 230.0]) - 60.0 * np.clip(ray[:, 2:], 0.0, 1.0)
    colour = np.where(down[:, None], ground * (1 - haze) + 205.0 * haze, sky)
    shape = (SIZE[1], FINER, SIZE[0], FINER, 3)
    small = colour.reshape(shape).mean(axis=(1, 3)).round().astype(np.uint8)
    picture = Image.fromarray(small).resize((SIZE[0] * 8, SIZE[1] * 8), Image.Resampling.NEAREST)
    draw = ImageDraw.Draw(picture)
    for top in np.array(list(MARKS.values())):
        mast = top * [1.0, 1.0, 0.0] + np.outer(np.linspace(0, top[2], 9), [0.0, 0.0, 1.0])
        line = (seen_px(np.array([time_s]), mast)[0] + 0.5) * 8.0
        draw.line([tuple(one) for one in line], fill=(70, 66, 62), width=12)
        x, y = line[-1]
        for radius, fill in ((32, (200, 30, 30)), (18, (255, 255, 255))):
            draw.ellipse([x - radius, y - radius, x + radius, y + radius], fill=fill)
    return picture.resize(SIZE, Image.Resampling.BOX).quantize(64, dither=Image.Dither.NONE)


def table(header: str, rows: list[str]) -> str:
    """The text of a CSV file."""
    return "\n".join([header, *rows, ""])


def files() -> dict[str, str]:
    """The texts of the example by the names of their files."""
    frame = np.arange(0, LAST + 1, EVERY)
    time_s = frame / RATE_HZ
    truth = angles_deg(time_s)
    points = np.array(list(MARKS.values()))
    noise = np.random.default_rng(7).normal(0.0, 0.5, (len(frame), len(MARKS), 2))
    pixel = seen_px(time_s, points) + noise
    picks = [
        f"{n},{name},{u:.1f},{v:.1f}"
        for n, row in zip(frame, pixel, strict=True)
        for name, (u, v) in zip(MARKS, row, strict=True)
    ]
    where = geodetic(origin_m() + points @ local_axes(origin_m()))
    marks = [f"{n},{a:.8f},{b:.8f},{h:.3f}" for n, a, b, h in zip(MARKS, *where, strict=True)]
    fix_s = np.arange(-1.24, 6.0)  # whole seconds of UTC
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
        "picks.csv": table("frame,landmark,u_px,v_px", picks),
        "landmarks.csv": table("landmark,lat_deg,lon_deg,h_m", marks),
        "track.csv": table("t_utc,lat_deg,lon_deg,h_m", track),
        "lens.json": json.dumps(lens, indent=1) + "\n",
        "wind.csv": table("h_m,from_deg,speed_m_s", ["300,240,3.0", "500,255,6.5"]),
        "truth.csv": table(
            "frame,t_s,yaw_deg,pitch_deg,roll_deg",
            [
                f"{n},{t:.2f},{y % 360.0:.4f},{p:.4f},{r % 360.0:.4f}"
                for n, t, (y, p, r) in zip(frame, time_s, truth, strict=True)
            ],
        ),
    }


def main() -> None:
    """Write all files."""
    EXAMPLE.mkdir(exist_ok=True)
    for name, text in files().items():
        (EXAMPLE / name).write_text(text, encoding="utf-8", newline="\n")
    for number in RENDERED:
        rendered(number / RATE_HZ).save(EXAMPLE / f"frame_{number:03d}.png", optimize=True)


if __name__ == "__main__":
    main()
