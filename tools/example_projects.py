"""Make the small example projects of the documentation: a survey from the air, two fixed cameras.

    python tools/example_projects.py

Needs pyproj and Pillow. The first two lie in UTM zone 33, and their picks have errors of half a
pixel. The shore's picture is rendered without the package, and its picks have errors of .3 pixel.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pyproj
from PIL import Image, ImageDraw
from scipy.spatial.transform import Rotation

from vopd.arrays import Floats
from vopd.flight.flight import Refraction
from vopd.flight.solve.lines_of_sight import sight_lines
from vopd.geometry.earth import earth_centred_m
from vopd.geometry.lenses import Lens, LensKind, project

EXAMPLES = Path(__file__).resolve().parent.parent / "examples"
TO_UTM = pyproj.Transformer.from_crs("EPSG:4326", "EPSG:32633", always_xy=True)
NOISE_PX = 0.5


def seen_px(lens: Lens, camera: Floats, marks: Floats, angles_deg: Floats) -> Floats:
    """Where marks are seen, (F, N, 2).

    Args:
        lens: the camera's
        camera: latitude, longitude, ellipsoidal height, (F, 3)
        marks: the same of the marks, (N, 3)
        angles_deg: yaw, pitch, roll of the view, (F, 3)
    """
    frame, mark = np.divmod(np.arange(len(camera) * len(marks)), len(marks))
    lines = sight_lines(
        earth_centred_m(*camera.T), earth_centred_m(*marks.T), frame, mark, Refraction()
    )
    body = Rotation.from_euler("ZYX", angles_deg, degrees=True).as_matrix()
    ned_from_enu = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]])
    turn = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]]) @ body.swapaxes(1, 2) @ ned_from_enu
    seen = project(lens, np.einsum("pij,pj->pi", turn[frame], lines.direction)).pixel
    noise = np.random.default_rng(3).normal(0.0, NOISE_PX, seen.shape)
    return (seen + noise).reshape(len(camera), len(marks), 2)


def write(folder: Path, files: dict[str, str]) -> None:
    """Write the files of an example."""
    folder.mkdir(exist_ok=True)
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")


def survey() -> None:
    """Four photographs of a drone 60 m above six targets, as OpenDroneMap has them."""
    width, height, focal = 4000, 3000, 0.85
    centre = np.array([(width - 1) / 2 + 4.0, (height - 1) / 2 - 8.0])
    k = np.array([-0.02, 0.01] + [0.0] * 10)
    lens = Lens(LensKind.BROWN, (width, height), np.full(2, focal * width), centre, k)
    east = np.array([-18, 12, 25, -6, 20, -25]) / 74000.0
    north = np.array([14, 18, -4, -16, -18, -2]) / 111200.0
    marks = np.stack([48.3 + north, 14.9 + east, 342.0 + np.arange(6) * 0.7], axis=1)
    camera = np.stack(
        [48.3 + np.array([-5, 0, 5, 10]) / 111200.0, np.full(4, 14.9), np.full(4, 402.5)], axis=1
    )
    angles = np.array([[12, -84, 1.5], [10, -85, 0.8], [11, -83, -1.0], [9, -86, 2.2]], float)
    pixel = seen_px(lens, camera, marks, angles)
    rows = ["EPSG:32633"]
    for frame in range(4):
        for n, (mark, (u, v)) in enumerate(zip(marks, pixel[frame], strict=True), 1):
            if 0 <= u < width and 0 <= v < height:
                x, y = TO_UTM.transform(mark[1], mark[0])
                rows.append(
                    f"{x:.3f} {y:.3f} {mark[2]:.3f} {u:.1f} {v:.1f} DJI_{frame + 1:04d}.JPG T{n}"
                )
    model = {
        "projection_type": "brown", "width": width, "height": height, "focal_x": focal,
        "focal_y": focal, "c_x": 0.001, "c_y": -0.002, "k1": -0.02, "k2": 0.01, "p1": 0.0,
        "p2": 0.0, "k3": 0.0,
    }  # fmt: skip
    geo = [
        f"DJI_{n:04d}.JPG {longitude:.9f} {latitude:.9f} {h:.3f}"
        for n, (latitude, longitude, h) in enumerate(camera, 1)
    ]
    files = {
        "gcp_list.txt": "\n".join([*rows, ""]),
        "cameras.json": json.dumps({"v2 drone 4000 3000 brown 0.85": model}, indent=1) + "\n",
        "geo.txt": "\n".join(["EPSG:4326", *geo, ""]),
    }
    write(EXAMPLES / "survey", files)


def summits() -> None:
    """Three photographs of a camera on a post that sees five summits."""
    lens = Lens(
        LensKind.BROWN, (4000, 3000), np.full(2, 3900.0), np.array([1999.5, 1499.5]), np.zeros(12)
    )
    camera = np.array([[47.55, 13.62, 463.7]])
    away = np.array([[-2100, 6400], [-900, 7800], [300, 5900], [1700, 8600], [2500, 7000]])
    height = np.array([1420.3, 1811.0, 1105.6, 2034.7, 1388.2])
    marks = np.stack([47.55 + away[:, 1] / 111200.0, 13.62 + away[:, 0] / 75100.0, height], axis=1)
    angles = np.array([[2.5, 6.0, -0.7]])
    pixel = seen_px(lens, np.tile(camera, (3, 1)), marks, np.tile(angles, (3, 1)))
    names = ("Hochkogel", "Weissenstein", "Rotmoos", "Grossberg", "Schafkopf")
    grid = [TO_UTM.transform(m[1], m[0]) for m in marks]
    x, y = TO_UTM.transform(camera[0, 1], camera[0, 0])
    picks = [
        f"2026-05-0{day + 1}_0900.jpg,{name},{u:.1f},{v:.1f}"
        for day in range(3)
        for name, (u, v) in zip(names, pixel[day], strict=True)
    ]
    rows = [
        f"{n},{a:.1f},{b:.1f},{h:.1f}" for n, (a, b), h in zip(names, grid, height, strict=True)
    ]
    toml = f"""\
[flight]
name = "camera on the post"
[camera]
image_size_px = [4000, 3000]
lens = {{ model = "brown", focal_mm = 35.0, sensor_mm = [35.897436, 26.923077] }}
[picks]
file = "picks.csv"
pixel_grid = "centre"
[landmarks]
file = "summits.csv"
crs = "EPSG:32633"
height = "same"
sigma_m = 1.0
[position]
x_m = {x:.1f}
y_m = {y:.1f}
z_m = 463.7
crs = "EPSG:32633"
height = "same"
sigma_m = 0.5
[solve]
frames = "one"
"""
    files = {
        "picks.csv": "\n".join(["image,landmark,u_px,v_px", *picks, ""]),
        "summits.csv": "\n".join(["landmark,x_m,y_m,z_m", *rows, ""]),
        "flight.toml": toml,
    }
    write(EXAMPLES / "summits", files)


SHORE_CAMERA = (403210.0, 6052480.0, 32.0)  # east, north, height
SHORE_DEG = (250.0, -12.0, 0.5)  # azimuth from true north, elevation, right side down
INTRINSICS = (1280, 720, 644.2, 356.9, 1104.6, 1106.1, -0.112, 0.061, 0.0, 0.0004, -0.0002)
"""NU, NV, c0U, c0V from (1, 1), fx, fy, d1, d2, d3, t1, t2 of CIRN's toolbox."""
TARGETS = (  # metres away, degrees right of the view, height
    (92, -14, 1.84), (118, 9, 2.31), (171, -6, 3.02), (214, 17, 1.47), (305, -20, 2.66),
    (342, 3, 4.15),
)  # fmt: skip


def shore() -> None:
    """One photograph of six chequered targets on a beach, control points and intrinsics."""
    to_geodetic = pyproj.Transformer.from_crs("EPSG:25832", "EPSG:4258", always_xy=True)
    to_earth = pyproj.Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True)
    wide, high, c0u, c0v, fx, fy, d1, d2, d3, t1, t2 = INTRINSICS
    azimuth, elevation, roll = np.radians(SHORE_DEG)
    lon, lat = np.radians(to_geodetic.transform(*SHORE_CAMERA[:2]))
    east = np.array([-np.sin(lon), np.cos(lon), 0.0])
    up = np.array([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)])
    enu = np.stack([east, np.cross(up, east), up])
    level = np.array([np.cos(azimuth), -np.sin(azimuth), 0.0])
    forward = np.array([np.sin(azimuth), np.cos(azimuth), 0.0]) * np.cos(elevation)
    forward[2] = np.sin(elevation)
    below = np.cross(forward, level)
    right = np.cos(roll) * level + np.sin(roll) * below
    down = np.cos(roll) * below - np.sin(roll) * level

    def earth(place: Floats) -> Floats:
        lon_deg, lat_deg = to_geodetic.transform(*place[:2])
        return np.array(to_earth.transform(lon_deg, lat_deg, place[2]))

    def seen(place: Floats) -> tuple[float, float, float]:
        line = enu @ (earth(place) - earth(np.array(SHORE_CAMERA)))
        depth = float(line @ forward)
        x, y = line @ right / depth, line @ down / depth
        q = x * x + y * y
        g = 1 + d1 * q + d2 * q**2 + d3 * q**3
        u = fx * (x * g + 2 * t1 * x * y + t2 * (q + 2 * x * x)) + c0u - 1
        v = fy * (y * g + t1 * (q + 2 * y * y) + 2 * t2 * x * y) + c0v - 1
        return float(u), float(v), depth

    aside = azimuth + np.radians([one[1] for one in TARGETS])
    away = np.array([one[0] for one in TARGETS])
    places = np.array([[0.0, 0.0, one[2]] for one in TARGETS])
    places[:, 0] = (SHORE_CAMERA[0] + away * np.sin(aside)).round(3)
    places[:, 1] = (SHORE_CAMERA[1] + away * np.cos(aside)).round(3)
    found = [seen(one) for one in places]

    far = np.array([5000 * np.sin(azimuth), 5000 * np.cos(azimuth), -SHORE_CAMERA[2]])
    horizon = seen(SHORE_CAMERA + far)[1]
    v, u = np.mgrid[:high, :wide]
    sky = v < horizon - np.tan(roll) * (u - wide / 2)
    sea = ~sky & (u > 920 + 0.9 * (v - horizon) + 40 * np.sin(v / 60))
    colour = np.full((high, wide, 3), (206, 190, 150), dtype=np.uint8)
    colour[sky], colour[sea] = (168, 196, 222), (70, 110, 130)
    picture = Image.fromarray(colour).resize((2 * wide, 2 * high))
    draw = ImageDraw.Draw(picture)
    for u_px, v_px, depth in found:
        x, y, a = 2 * u_px + 1, 2 * v_px + 1, 2 * max(0.9 * fx / depth, 5)
        b = 0.62 * a
        draw.rectangle([x - a, y - b, x + a, y + b], fill=(20, 20, 20))
        draw.rectangle([x, y - b, x + a, y], fill=(245, 245, 245))
        draw.rectangle([x - a, y, x, y + b], fill=(245, 245, 245))
    noise = np.random.default_rng(28).normal(0.0, 0.3, (len(found), 2))
    picks = [
        f"shore.jpg,{k},{one[0] + e[0]:.1f},{one[1] + e[1]:.1f}"
        for k, (one, e) in enumerate(zip(found, noise, strict=True), 1)
    ]
    head = ["# pixels: u right, v down, (0, 0) the centre of the first pixel"]
    files = {
        "gcp.txt": "".join(
            f"{k:.6f},{x:.6f},{y:.6f},{z:.6f}\n" for k, (x, y, z) in enumerate(places, 1)
        ),
        "intrinsics.json": json.dumps({"intrinsics": INTRINSICS}) + "\n",
        "clicks.csv": "\n".join([*head, "image,landmark,u_px,v_px", *picks, ""]),
    }
    write(EXAMPLES / "shore", files)
    small = picture.resize((wide, high), Image.Resampling.LANCZOS)
    small.save(EXAMPLES / "shore" / "shore.jpg", quality=80)


if __name__ == "__main__":
    survey()
    summits()
    shore()
