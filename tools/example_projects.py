"""Make the small example projects of the documentation: a survey from the air, and a fixed camera.

    python tools/example_projects.py

Needs pyproj. Both lie in UTM zone 33; the picks have errors of half a pixel.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pyproj
from scipy.spatial.transform import Rotation

from vopd.arrays import Floats
from vopd.flight.flight import Refraction
from vopd.flight.lines_of_sight import sight_lines
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


if __name__ == "__main__":
    survey()
    summits()
