"""Flights for tools/benchmark.py: a long project, and the solve against scipy's least squares.

    python -m tools.flight_timing project FOLDER FRAMES
    python -m tools.flight_timing solve FRAMES
    python -m tools.flight_timing alone FRAMES TIMES
    python -m tools.flight_timing library PROJECT TIMES

The second prints the processor's seconds of the solve of all frames at once, and of scipy's
`least_squares` called for each frame with the same partials and the same start; the third
those of the equations alone, one of so many; the fourth those of a project that is read,
solved and given an uncertainty by the library.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from tests.kit.flight_project import LENS, MARKS, TOML, camera_m, marks_m, write_project
from vopd.arrays import Floats, Ints
from vopd.flight.first_attitude import first_attitude
from vopd.flight.flight import Refraction
from vopd.flight.sight_lines import sight_lines
from vopd.flight.solve import solve_rotations
from vopd.flight.solve_project import solve_flight
from vopd.geometry.geodetic import geodetic
from vopd.geometry.lens_model import project, ray_of_pixel

LONGEST_S, NOISE_PX = 10.0, 0.5  # after which landmarks would leave the image


def rate_hz(frames: int) -> float:
    """Frames a second."""
    return max(1000.0, frames / LONGEST_S)


def picks(frames: int) -> tuple[Ints, Ints, Floats, Floats]:
    """Frame and landmark of each pick, its direction and its pixel, of a camera that swings."""
    time_s = 2.0 + np.arange(frames) / rate_hz(frames)
    swing = [5 + 4 * np.sin(time_s), -12 + np.cos(2 * time_s), 2 + 3 * np.sin(3 * time_s)]
    body = Rotation.from_euler("ZYX", np.stack(swing, axis=1), degrees=True).as_matrix()
    ned_from_enu = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]])
    turn = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]]) @ body.swapaxes(1, 2) @ ned_from_enu
    frame, mark = np.divmod(np.arange(frames * len(MARKS)), len(MARKS))
    lines = sight_lines(camera_m(time_s), marks_m(), frame, mark, Refraction())
    seen = project(LENS, np.einsum("pij,pj->pi", turn[frame], lines.direction)).pixel
    noise = np.random.default_rng(1).normal(0.0, NOISE_PX, seen.shape)
    return frame, mark, lines.direction, seen + noise


def write_long_project(folder: Path, frames: int) -> None:
    """A project of so many frames of six landmarks."""
    toml = TOML.replace("frame_rate_hz = 10.0", f"frame_rate_hz = {rate_hz(frames)}")
    write_project(folder, toml)
    frame, mark, _, pixel = picks(frames)
    rows = [
        f"{n},{MARKS[m]},{u:.3f},{v:.3f}" for n, m, (u, v) in zip(frame, mark, pixel, strict=True)
    ]
    (folder / "picks.csv").write_text("\n".join(["frame,landmark,u_px,v_px", *rows, ""]))
    time_s = np.arange(1.0, frames / rate_hz(frames) + 4.0)
    where = geodetic(camera_m(time_s))
    rows = [f"{t},{a:.12f},{b:.12f},{h:.6f}" for t, a, b, h in zip(time_s, *where, strict=True)]
    (folder / "track.csv").write_text("\n".join(["t_s,lat_deg,lon_deg,h_m", *rows, ""]))


def by_scipy(direction: Floats, pixel: Floats) -> Floats:
    """The rotation of one frame, (3, 3)."""
    ray = ray_of_pixel(LENS, pixel)
    start = first_attitude(ray[None], direction[None], np.ones((1, len(ray)))).rotation[0]

    def seen(vector: Floats) -> Floats:
        turned = Rotation.from_rotvec(vector).as_matrix() @ start
        return direction @ turned.T

    found = least_squares(
        lambda vector: (project(LENS, seen(vector)).pixel - pixel).ravel(),
        np.zeros(3),
        jac=lambda vector: project(LENS, seen(vector)).by_turns.reshape(-1, 3),
    )
    return np.asarray(Rotation.from_rotvec(found.x).as_matrix() @ start)


def time_the_solve(frames: int) -> None:
    """Print both times, and the largest difference."""
    frame, _, direction, pixel = picks(frames)
    each, every = np.ones(len(frame)), np.ones(len(frame), bool)
    start = time.process_time()
    ours = solve_rotations(LENS, frames, frame, pixel, each, direction, every).rotation
    middle = time.process_time()
    shape = (frames, len(MARKS), -1)
    pairs = zip(direction.reshape(shape), pixel.reshape(shape), strict=True)
    other = np.array([by_scipy(*pair) for pair in pairs])
    end = time.process_time()
    apart = Rotation.from_matrix(ours @ other.swapaxes(1, 2)).magnitude().max()
    print(middle - start, end - middle, np.degrees(apart))


def time_it_alone(frames: int, times: int) -> None:
    """Print the time of one of so many solves."""
    frame, _, direction, pixel = picks(frames)
    each, every = np.ones(len(frame)), np.ones(len(frame), bool)
    start = time.process_time()
    for _ in range(times):
        solve_rotations(LENS, frames, frame, pixel, each, direction, every)
    print((time.process_time() - start) / times)


def time_the_library(project: Path, times: int) -> None:
    """Print the time of one of so many solves of a project, from its files to its history."""
    start = time.process_time()
    for _ in range(times):
        solve_flight(project).history()
    print((time.process_time() - start) / times)


if __name__ == "__main__":
    if sys.argv[1] == "project":
        write_long_project(Path(sys.argv[2]), int(sys.argv[3]))
    elif sys.argv[1] == "alone":
        time_it_alone(int(sys.argv[2]), int(sys.argv[3]))
    elif sys.argv[1] == "library":
        time_the_library(Path(sys.argv[2]), int(sys.argv[3]))
    else:
        time_the_solve(int(sys.argv[2]))
