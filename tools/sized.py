"""Inputs of any size for tools/benchmark.py and tools/growth.py.

python tools/sized.py photographs stars.csv 1000 30
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
FOCAL_MM = 76.0


def run(*command: str) -> None:
    """Run a command of Python that makes an input."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    subprocess.run([sys.executable, *command], check=True, cwd=ROOT, env=environment)


def made(what: str, path: Path, *sizes: int) -> Path:
    """Make an input in a process of its own, whose memory is not counted as a later one's.

    Args:
        what: one of the functions below
        path: the file, or the folder of a flight
        sizes: as that function takes them
    """
    run("tools/sized.py", what, str(path), *map(str, sizes))
    return path / "flight.toml" if what in ("flight", "misfit") else path


def deck(path: Path, frames: int, seed: int = 1) -> None:
    """Write a deck of `vopd demo` with six landmarks."""
    options = (f"--frames={frames}", "--landmarks=6", f"--seed={seed}")
    run("-m", "vopd", "demo", *options, "-o", str(path))


def jobs(path: Path, count: int) -> None:
    """Write a deck of jobs of one frame, each of which has all its cards."""
    own = [path.with_name(f"job{k}.dat") for k in range(9)]
    for k, one in enumerate(own):
        deck(one, 1, k)
    run("tools/uneven_deck.py", str(path), *(f"nothing:{own[k % 9]}" for k in range(count)))


def with_focal(deck: str, focal_mm: float) -> str:
    """Change the focal length of a deck of `vopd demo`, on the card behind the trajectory."""
    cards = deck.splitlines()
    (at,) = (k for k, card in enumerate(cards) if card.startswith("      10.4 "))
    cards[at] = f"{focal_mm:10.3f}{cards[at][10:]}"
    return "\n".join(cards) + "\n"


def flight(folder: Path, frames: int, landmarks: int = 0, track: int = 0) -> None:
    """Write a flight of six picks a frame, with more landmarks, or rows of track, than it needs."""
    run("-m", "tools.long_flight", str(folder), str(frames))
    marks, places = folder / "landmarks.csv", folder / "track.csv"
    place = marks.read_text().splitlines()[-1].partition(",")[2]
    marks.write_text(marks.read_text() + "".join(f"more{k},{place}\n" for k in range(landmarks)))
    if track:
        head, *rows = places.read_text().splitlines()
        known = np.array([row.split(",") for row in rows], dtype=np.float64)
        time_s = np.linspace(known[0, 0], known[-1, 0], track)
        values = [np.interp(time_s, known[:, 0], known[:, k]) for k in (1, 2, 3)]
        lines = (
            f"{t:.9f},{a:.12f},{b:.12f},{h:.6f}" for t, a, b, h in np.array([time_s, *values]).T
        )
        places.write_text("\n".join([head, *lines, ""]))


STATED = {
    'sigma_m = "exact"\n[track]': "sigma_m = 2.0\n[track]",
    'sigma_m = "exact"\nsigma_t_s = "exact"': "sigma_m = 3.0\nsigma_bias_m = 2.0\nsigma_t_s = 0.01",
    "first_frame_t_s = 2.0": "first_frame_t_s = 2.0\nsigma_px = 0.5",
}


def misfit(folder: Path, frames: int) -> None:
    """Write a flight of which two names are exchanged, and landmarks and positions uncertain."""
    flight(folder, frames)
    project, picks = folder / "flight.toml", folder / "picks.csv"
    text = project.read_text()
    for exact, stated in STATED.items():
        if exact not in text:
            raise ValueError(f"the project of tests/kit/flight_project.py has no {exact!r}")
        text = text.replace(exact, stated)
    project.write_text(text)
    other = {",mast,": ",tower,", ",tower,": ",mast,"}
    picks.write_text(re.sub("|".join(other), lambda name: other[name[0]], picks.read_text()))


def photographs(path: Path, count: int, stars: int) -> None:
    """Write photographs of stars that are read to .005 mm; a single one has no name."""
    rng = np.random.default_rng(1)
    lines = ["image,"[: 6 * (count > 1)] + "x_mm,y_mm,ra_deg,dec_deg"]
    for k in range(count):
        name = f"P{k}," if count > 1 else ""
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        image = rng.uniform(-30.0, 30.0, (stars, 2))
        rays = np.column_stack([image, np.full(stars, -FOCAL_MM)])
        u, v, w = (turn * np.linalg.det(turn)) @ (rays / np.linalg.norm(rays, axis=1)[:, None]).T
        ra, dec = np.degrees(np.arctan2(v, u)), np.degrees(np.arcsin(w))
        read = image + rng.normal(0.0, 0.005, image.shape)
        rows = zip(*read.T, ra, dec, strict=True)
        lines += [f"{name}{x:.5f},{y:.5f},{a:.8f},{d:.8f}" for x, y, a, d in rows]
    path.write_text("\n".join([*lines, ""]))


def numbers(path: Path, rows: int) -> None:
    """Write a text of numbers, which is no listing."""
    some = np.random.default_rng(2).integers(10**7, 10**8, rows)
    path.write_text("\n".join(map(str, some.tolist())) + "\n")


def listing(path: Path, frames: int) -> None:
    """Write the listing of a deck."""
    cards = path.with_suffix(".dat")
    deck(cards, frames)
    run("-m", "vopd", "run", "-q", str(cards), "-o", str(path))


if __name__ == "__main__":
    globals()[sys.argv[1]](Path(sys.argv[2]), *map(int, sys.argv[3:]))
