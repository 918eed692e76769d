"""Time `vopd track`, and compare it with OpenCV's Lucas-Kanade from frame to frame.

    python -m tools.benchmark_track FOLDER... [--six]

A FOLDER is what `python -m tools.render_video` makes: a video, clicks, and the truth. Each row is a
flight and a method: processor time a frame and the largest memory of a process of its own, with
the decoding of the video; distances of all tracked picks from the truth, with the clicks' errors in
them; the whole turn of each frame from the truth, by `vopd attitude` from the same known positions.

Lucas-Kanade is that of OpenCV: windows of 21 pixels, three levels above the picture, 30 iterations.
It starts at each click, goes on from frame to frame, and starts again at the landmark's next click;
`checked` leaves picks out that it does not find back to within a pixel. Needs OpenCV and PyAV.
"""

from __future__ import annotations

import argparse
import csv
import os
import resource
import subprocess
import sys
import tempfile
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

import vopd
from vopd.flight.project.keys import Project, read_project
from vopd.tracking.follow import TrackOptions, follow
from vopd.video import open_frames

METHODS = ("vopd track", "Lucas-Kanade", "Lucas-Kanade, checked")
HEAD = "| flight | clicks | method | ms a frame | MB | found | px | over 3 px | degree | largest |"
WINDOW, LEVELS = (21, 21), 3
CRITERIA = 3, 30, 0.01  # iterations and change
BACK_PX = 1.0
FIRST, BEYOND_PX = 6, 3.0


def rows_of(path: Path) -> list[dict[str, str]]:
    """Read a CSV, without the lines that begin with #."""
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def project_of(folder: Path, clicks: Path, tracked: Path) -> Project:
    """Name the clicks and the tracked file in a rendered project."""
    project = read_project(str(folder / "flight.toml")).changed("picks", "file", str(clicks))
    return project.changed("picks", "tracked", str(tracked))


def lucas_kanade(folder: Path, clicks: Path, output: Path, checked: bool) -> None:
    """Track the clicks of a flight from frame to frame, and write picks."""
    cv2: Any = import_module("cv2")  # whose memory is not that of the others
    by_frame: dict[int, dict[str, np.ndarray[Any, Any]]] = {}
    for row in rows_of(clicks):
        at = np.array([float(row["u_px"]), float(row["v_px"])], np.float32)
        by_frame.setdefault(int(row["frame"]), {})[row["landmark"]] = at
    frames = open_frames([str(folder / "video.mp4")])
    options: dict[str, Any] = {"winSize": WINDOW, "maxLevel": LEVELS, "criteria": CRITERIA}
    places: dict[str, np.ndarray[Any, Any]] = {}
    before: Any = None
    lines = ["frame,landmark,u_px,v_px"]
    for k, grey in frames.decoded(0, len(frames) - 1, grey=True):
        if places:
            points = np.array([*places.values()])[:, None]
            found, good, _ = cv2.calcOpticalFlowPyrLK(before, grey, points, None, **options)
            kept = good.ravel() > 0
            if checked:
                back, again, _ = cv2.calcOpticalFlowPyrLK(grey, before, found, None, **options)
                kept &= (again.ravel() > 0) & (np.hypot(*(back - points)[:, 0].T) < BACK_PX)
            inside = (found[:, 0] > 0.0) & (found[:, 0] < np.array(grey.shape[::-1]) - 1.0)
            kept &= inside.all(axis=1)
            names = [*places]
            places = {names[n]: found[n, 0] for n in np.flatnonzero(kept)}
        places |= by_frame.get(k, {})
        lines += [f"{k},{name},{u:.4f},{v:.4f}" for name, (u, v) in places.items()]
        before = grey
    output.write_text("\n".join([*lines, ""]), encoding="utf-8")


def run(folder: Path, clicks: Path, method: str, output: Path) -> None:
    """Track a flight; what a process of its own does."""
    if method == METHODS[0]:
        follow(project_of(folder, clicks, output), TrackOptions())
    else:
        lucas_kanade(folder, clicks, output, checked=method == METHODS[2])
    print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0)


def turns_deg(found: vopd.FlightResult, truth: list[dict[str, str]]) -> Any:
    """Angle of the whole turn from each frame's true attitude, degrees (F,)."""
    names = [f"quaternion_{letter}" for letter in "wxyz"]
    known = {int(row["frame"]): [float(row[name]) for name in names] for row in truth}
    own = found.to_dataframe()
    true = np.array([known[int(frame)] for frame in own["frame"]])
    same = np.abs((own[names].to_numpy(float) * true).sum(axis=1))
    return np.degrees(2.0 * np.arccos(np.minimum(same, 1.0)))


def measure(folder: Path, clicks: Path, method: str) -> str:
    """Track a flight in a process of its own, and write a row of the table."""
    with tempfile.TemporaryDirectory() as place:
        output = Path(place) / "tracked.csv"
        command = [sys.executable, "-m", "tools.benchmark_track", str(folder), "--run", method]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        one_core = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
        done = subprocess.run(
            [*command, "--clicks", str(clicks), "-o", str(output)], check=True,
            stdout=subprocess.PIPE, env=os.environ | one_core,
        )  # fmt: skip
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        used_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        truth = rows_of(folder / "truth.csv")
        known = {
            (row["frame"], row["landmark"]): (float(row["u_px"]), float(row["v_px"]))
            for row in rows_of(folder / "truth_picks.csv")
        }
        project = project_of(folder, clicks, output)
        best: dict[tuple[str, str], tuple[int, tuple[float, float]]] = {}
        for row in rows_of(output):
            if row["u_px"] and row.get("status") != "clicked":
                key = row["frame"], row["landmark"]
                age = abs(int(row["frame"]) - int(row.get("from_frame") or 0))
                at = float(row["u_px"]), float(row["v_px"])
                if key not in best or age < best[key][0]:  # of several clicks the nearest
                    best[key] = age, at
        if method != METHODS[0]:
            project = project.changed("picks", "tracked_from", "unknown")
        seen = [(at, known[key]) for key, (_, at) in best.items() if key in known]
        off = np.array([np.subtract(*pair) for pair in seen])
        far = np.hypot(*off.T)
        turn = turns_deg(vopd.solve_flight(project), truth)
    rms = np.sqrt(np.nanmean(off**2))
    return (
        f"| {folder.name} | {len(rows_of(clicks))} | {method} | {1000.0 * used_s / len(truth):.0f} "
        f"| {float(done.stdout.split()[-1]):.0f} | {len(off) / len(known):.0%} | {rms:.2f} "
        f"| {(far > BEYOND_PX).mean():.1%} | {np.sqrt(np.nanmean(turn**2)):.3f} "
        f"| {np.nanmax(turn):.2f} |"
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--six", action="store_true", help="only the clicks of the first frame")
    parser.add_argument("--run", choices=METHODS, help=argparse.SUPPRESS)
    parser.add_argument("--clicks", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("-o", type=Path, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.run:
        run(given.folders[0], given.clicks, given.run, given.o)
        return
    print(HEAD + "\n" + "|---" * HEAD.count(" | ") + "|---|", flush=True)
    for folder in given.folders:
        with tempfile.TemporaryDirectory() as place:
            clicks = Path(place) / "clicks.csv"
            text = (folder / "clicks.csv").read_text(encoding="utf-8")
            lines = text.splitlines()
            if given.six:
                lines = [line for line in lines if line[:2] in ("# ", "fr", "0,")][: 2 + FIRST]
            clicks.write_text("\n".join([*lines, ""]), encoding="utf-8")
            for method in METHODS:
                print(measure(folder.resolve(), clicks, method), flush=True)


if __name__ == "__main__":
    main()
