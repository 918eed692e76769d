"""A flight project of any number of frames of six landmarks, for tools/benchmark.py.

python -m tools.long_flight FOLDER FRAMES
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from tests.kit.flight_project import LENS, MARKS, TOML, camera_m, marks_m, write_project
from vopd.flight.flight import Refraction
from vopd.flight.solve.lines_of_sight import sight_lines
from vopd.geometry.earth import geodetic
from vopd.geometry.lenses import project

LONGEST_S, NOISE_PX = 10.0, 0.5  # after which landmarks would leave the image


def write_long_project(folder: Path, frames: int) -> None:
    """Write the project: a camera that swings, and picks with random errors."""
    rate_hz = max(1000.0, frames / LONGEST_S)
    write_project(folder, TOML.replace("frame_rate_hz = 10.0", f"frame_rate_hz = {rate_hz}"))
    time_s = 2.0 + np.arange(frames) / rate_hz
    swing = [5 + 4 * np.sin(time_s), -12 + np.cos(2 * time_s), 2 + 3 * np.sin(3 * time_s)]
    body = Rotation.from_euler("ZYX", np.stack(swing, axis=1), degrees=True).as_matrix()
    ned_from_enu = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]])
    turn = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]]) @ body.swapaxes(1, 2) @ ned_from_enu
    frame, mark = np.divmod(np.arange(frames * len(MARKS)), len(MARKS))
    lines = sight_lines(camera_m(time_s), marks_m(), frame, mark, Refraction())
    seen = project(LENS, np.einsum("pij,pj->pi", turn[frame], lines.direction)).pixel
    seen += np.random.default_rng(1).normal(0.0, NOISE_PX, seen.shape)
    rows = [
        f"{n},{MARKS[m]},{u:.3f},{v:.3f}" for n, m, (u, v) in zip(frame, mark, seen, strict=True)
    ]
    (folder / "picks.csv").write_text("\n".join(["frame,landmark,u_px,v_px", *rows, ""]))
    time_s = np.arange(1.0, frames / rate_hz + 4.0)
    where = geodetic(camera_m(time_s))
    rows = [f"{t},{a:.12f},{b:.12f},{h:.6f}" for t, a, b, h in zip(time_s, *where, strict=True)]
    (folder / "track.csv").write_text("\n".join(["t_s,lat_deg,lon_deg,h_m", *rows, ""]))


if __name__ == "__main__":
    write_long_project(Path(sys.argv[1]), int(sys.argv[2]))
