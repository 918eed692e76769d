"""How good tracked flights are, and how true their sigmas, over rendered videos with truth.

    python -m tools.render_video FOLDER --seed N ...      # for each flight
    python -m tools.track_coverage FOLDER ...

Each folder is tracked, unless it has its `tracked.csv`, solved, and compared with its truth. A row
is a flight: "track" is the error of matches less that of their clicks, all of them and those 10 and
60 frames from their click; "turn" the error of the whole attitude. The last line is all of them.
"""

from __future__ import annotations

import argparse
import csv
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation
from scipy.special import fdtri

from vopd.flight.joint import covariance_of_sums
from vopd.flight.project import read_project
from vopd.flight.result import solve_flight
from vopd.tracking.follow import TrackOptions, follow

AGES = (10, 60)  # frames from the click, and a tenth of it more or less


class Counted(NamedTuple):
    """A flight beside its truth."""

    track_px: dict[int, list[float]]  # squares of u and v, by ages; 0: all
    turn_deg: Any  # (F,)
    stated_deg2: float  # mean variance of the whole attitude
    squares: float  # of turns by their stated covariance, over 3
    inside: bool  # whether the mean turn is in its 95 % region


def _rows(path: Path) -> list[dict[str, str]]:
    lines = path.read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def _pixel(row: dict[str, str]) -> Any:
    return np.array([float(row["u_px"]), float(row["v_px"])])


def track_errors(folder: Path) -> dict[int, list[float]]:
    """Compare the tracked places of a flight with the truth, their clicks' errors taken off."""
    true = {
        (row["frame"], row["landmark"]): _pixel(row) for row in _rows(folder / "truth_picks.csv")
    }
    found = _rows(folder / "tracked.csv")
    error = {
        (row["frame"], row["landmark"]): _pixel(row) - true[row["frame"], row["landmark"]]
        for row in found if row["status"] == "clicked"
    }  # fmt: skip
    squares: dict[int, list[float]] = {age: [] for age in (0, *AGES)}
    for row in found:
        at = row["frame"], row["landmark"]
        if row["status"] != "tracked" or at not in true:
            continue
        by = np.array([float(row[name]) for name in ("duu", "duv", "dvu", "dvv")]).reshape(2, 2)
        off = _pixel(row) - true[at] - by @ error[row["from_frame"], row["landmark"]]
        age = abs(int(row["frame"]) - int(row["from_frame"]))
        for one, own in squares.items():
            if abs(age - one) <= one / 10 or not one:
                own.extend((off**2).tolist())
    return squares


def count(folder: Path) -> Counted:
    """Track, solve and compare a flight."""
    path = folder / "flight.toml"
    text = path.read_text(encoding="utf-8")
    if "tracked =" not in text:
        path.write_text(text.replace("[picks]", '[picks]\ntracked = "tracked.csv"'), "utf-8")
    if not (folder / "tracked.csv").exists():
        follow(read_project(str(path)), TrackOptions())
    result = solve_flight(path)
    joint, reading = result.estimates.joint, result.estimates.reading
    assert joint is not None and reading is not None
    names = [f"quaternion_{axis}" for axis in "xyzw"]
    true = [[float(row[name]) for name in names] for row in _rows(folder / "truth.csv")]
    body_from_ned = Rotation.from_quat(true).as_matrix().swapaxes(1, 2)
    camera_from_enu = body_from_ned[:, [1, 2, 0]][:, :, [1, 0, 2]] * [1.0, 1.0, -1.0]
    solved = joint.solved.attitudes.rotation
    known = np.flatnonzero(np.isfinite(solved[:, 0, 0]))
    of_known = camera_from_enu[result.flight.frame[known]]
    turn = Rotation.from_matrix(solved[known] @ of_known.swapaxes(1, 2)).as_rotvec()
    covariance = joint.covariance.turn[known]
    squares = np.einsum("fi,fi->f", turn, np.linalg.solve(covariance, turn[..., None])[..., 0])
    weight = np.zeros((len(solved), 3, 3))
    weight[known] = np.eye(3) / len(known)
    of_mean, _ = covariance_of_sums(joint, weight)
    mean = turn.mean(axis=0)
    inside = mean @ np.linalg.solve(of_mean, mean) < 3.0 * fdtri(3.0, reading.freedom, 0.95)
    return Counted(
        track_errors(folder), np.degrees(np.sqrt((turn**2).sum(axis=1))),
        float(np.degrees(1.0) ** 2 * np.einsum("fii->f", covariance).mean()),
        float(squares.mean() / 3.0), bool(inside),
    )  # fmt: skip


def main() -> None:
    """Count all folders."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("folder", type=Path, nargs="+")
    folders = parser.parse_args().folder
    print(
        "| flight | track, px | age 10 / 60 | turn, rms / largest, deg | stated | NEES/3 | mean |"
    )
    print("|---|---|---|---|---|---|---|")
    every = []
    for folder in folders:
        one = count(folder)
        every.append(one)
        rms, largest = np.sqrt((one.turn_deg**2).mean()), one.turn_deg.max()
        print(
            f"| {folder.name} | {_track_text(one.track_px)} | {rms:.4f} / {largest:.3f} | "
            f"{np.sqrt(one.stated_deg2):.4f} | {one.squares:.2f} | "
            f"{'inside' if one.inside else 'outside'} |",
            flush=True,
        )
    joined = {age: [v for one in every for v in one.track_px[age]] for age in (0, *AGES)}
    each = np.array([np.sqrt((one.turn_deg**2).mean()) for one in every])
    largest = max(one.turn_deg.max() for one in every)
    ratio = np.sqrt((each**2).mean() / np.mean([one.stated_deg2 for one in every]))
    print(
        f"| all {len(every)} | {_track_text(joined)} | median {np.median(each):.4f}, "
        f"worst {each.max():.4f} / {largest:.3f} | error over stated {ratio:.2f} | "
        f"{np.mean([one.squares for one in every]):.2f} | "
        f"{sum(one.inside for one in every)} inside |"
    )


def _track_text(squares: dict[int, list[float]]) -> str:
    """Write the root mean squares of all ages, and of those that are told."""
    every, ten, sixty = (np.sqrt(np.mean(one)) if one else np.nan for one in squares.values())
    return f"{every:.3f} | {ten:.3f} / {sixty:.3f}"


if __name__ == "__main__":
    main()
