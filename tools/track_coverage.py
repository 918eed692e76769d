"""How good tracked flights are, and how true their sigmas, over rendered videos with truth.

    python -m tools.render_video FOLDER --seed N ...      # for each flight
    python -m tools.track_coverage FOLDER ... [--six] [--again N]

Each folder is tracked, unless it has its `tracked.csv`, solved, and compared with its truth. A row
is a flight: "track" is the error of matches less that of their clicks, all of them and those 10 and
60 frames from their click, and the largest of all; "turn" the error of the whole attitude, and the
largest of a frame without a flag; a flight is doubtful if it misfits, or its residuals speak
for an error of its inputs. The last line is all of them.

With --six only the clicks of the first frame are taken (`tracked_six.csv`). With --again the errors
of the clicks are drawn anew so many times: the places tracked from a click move with it, by the
matrix of the tracked file, and the errors of the matches stay.
"""

from __future__ import annotations

import argparse
import csv
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation
from scipy.special import fdtri

from vopd.flight.flight import Flight
from vopd.flight.formats.tracked import CLICKED, TRACKED, TrackedRows, read_tracked
from vopd.flight.project.keys import Project, read_project
from vopd.flight.result import FlightResult, solve_flight
from vopd.flight.solve.joint import covariance_of_sums
from vopd.tracking.follow import TrackOptions, follow

AGES = (10, 60)  # frames from the click, and a tenth of it more or less
BEYOND_DEG = 0.035
HEAD = (
    "| flight | track, px | age 10 / 60 | largest | turn, rms / largest unflagged, deg | stated "
    "| NEES/3 | mean | frames | doubtful |"
)


class Turned(NamedTuple):
    """A solved flight beside its truth."""

    turn_deg: Any  # (F,); NaN without an attitude
    stated_deg2: float  # mean variance of the whole attitude
    squares: float  # of turns by their stated covariance, over 3
    inside: bool  # whether the mean turn is in its 95 % region

    @property
    def rms_deg(self) -> float:
        """Root mean square of the turns."""
        return float(np.sqrt(np.nanmean(self.turn_deg**2)))


class Counted(NamedTuple):
    """A tracked flight beside its truth."""

    track_px: dict[int, list[float]]  # squares of u and v, by ages; 0: all
    turned: Turned
    unflagged_deg: float  # the largest turn of a frame without a flag
    frames: tuple[int, int]  # with an attitude, and all
    doubtful: bool
    again: list[Turned]  # with other errors of the clicks


def _rows(path: Path) -> list[dict[str, str]]:
    lines = path.read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def _truth(folder: Path) -> dict[tuple[int, str], Any]:
    """Read true pixels by frame and landmark."""
    return {
        (int(row["frame"]), row["landmark"]): np.array([float(row["u_px"]), float(row["v_px"])])
        for row in _rows(folder / "truth_picks.csv")
    }


def _click_errors(
    rows: TrackedRows, true: dict[tuple[int, str], Any]
) -> dict[tuple[int, str], Any]:
    """Find the errors of the clicks, by frame and landmark."""
    names = list(rows.landmark)
    own = ((int(rows.frame[k]), names[k], k) for k in np.flatnonzero(rows.status == CLICKED))
    return {(frame, name): rows.pixel[k] - true[frame, name] for frame, name, k in own}


def track_errors(folder: Path, rows: TrackedRows) -> dict[int, list[float]]:
    """Compare the tracked places of a flight with the truth, their clicks' errors taken off."""
    true, names = _truth(folder), list(rows.landmark)
    error = _click_errors(rows, true)
    squares: dict[int, list[float]] = {age: [] for age in (0, *AGES)}
    for k in np.flatnonzero(rows.status == TRACKED).tolist():
        frame, source = int(rows.frame[k]), int(rows.from_frame[k])
        if (frame, names[k]) not in true:
            continue
        off = rows.pixel[k] - true[frame, names[k]] - rows.by_click[k] @ error[source, names[k]]
        for one, own in squares.items():
            if abs(abs(frame - source) - one) <= one / 10 or not one:
                own.extend((off**2).tolist())
    return squares


def drawn_anew(folder: Path, rows: TrackedRows, rng: np.random.Generator) -> TrackedRows:
    """Draw the errors of the clicks anew, and move the places tracked from them."""
    clicks, names, pixel = (
        _click_errors(rows, _truth(folder)),
        list(rows.landmark),
        rows.pixel.copy(),
    )
    sigma_px = float(np.median(rows.sigma_px[rows.status == CLICKED]))
    moved = {at: rng.normal(0.0, sigma_px, 2) - error for at, error in clicks.items()}
    for k in np.flatnonzero(np.isin(rows.status, (CLICKED, TRACKED))).tolist():
        pixel[k] += rows.by_click[k] @ moved[int(rows.from_frame[k]), names[k]]
    return replace(rows, pixel=pixel)


def turned(folder: Path, result: FlightResult) -> Turned:
    """Compare a solved flight with its truth."""
    joint, reading = result.estimates.joint, result.estimates.reading
    assert joint is not None and reading is not None
    solved = joint.solved.attitudes.rotation
    known = np.flatnonzero(np.isfinite(solved[:, 0, 0]))
    of_known = _true_rotations(folder, result.flight)[known]
    turn = Rotation.from_matrix(solved[known] @ of_known.swapaxes(1, 2)).as_rotvec()
    covariance = joint.covariance.turn[known]
    squares = np.einsum("fi,fi->f", turn, np.linalg.solve(covariance, turn[..., None])[..., 0])
    weight = np.zeros((len(solved), 3, 3))
    weight[known] = np.eye(3) / len(known)
    of_mean, _ = covariance_of_sums(joint, weight)
    mean = turn.mean(axis=0)
    inside = mean @ np.linalg.solve(of_mean, mean) < 3.0 * fdtri(3.0, reading.freedom, 0.95)
    off_deg = np.full(len(solved), np.nan)
    off_deg[known] = np.degrees(np.sqrt((turn**2).sum(axis=1)))
    stated_deg2 = float(np.degrees(1.0) ** 2 * np.einsum("fii->f", covariance).mean())
    return Turned(off_deg, stated_deg2, float(squares.mean() / 3.0), bool(inside))


def _true_rotations(folder: Path, flight: Flight) -> Any:
    """Read true rotations from east, north, up to the camera's axes, (F, 3, 3)."""
    names = [f"quaternion_{axis}" for axis in "xyzw"]
    true = [[float(row[name]) for name in names] for row in _rows(folder / "truth.csv")]
    body_from_ned = Rotation.from_quat(true).as_matrix().swapaxes(1, 2)
    return (body_from_ned[:, [1, 2, 0]][:, :, [1, 0, 2]] * [1.0, 1.0, -1.0])[flight.frame]


def _project(folder: Path, six: bool) -> Project:
    """Name the clicks and the tracked file; with `six` the clicks of the first frame."""
    project, name = read_project(str(folder / "flight.toml")), "tracked.csv"
    if six:
        lines = (folder / "clicks.csv").read_text(encoding="utf-8").splitlines()
        lines = [line for line in lines if not line[:1].isdigit() or line.startswith("0,")]
        (folder / "six.csv").write_text("\n".join([*lines, ""]), encoding="utf-8")
        project, name = project.changed("picks", "file", "six.csv"), "tracked_six.csv"
    return project.changed("picks", "tracked", name)


def count(folder: Path, six: bool = False, again: int = 0) -> Counted:
    """Track, solve and compare a flight.

    Args:
        folder: as `tools.render_video` makes it
        six: whether only the clicks of the first frame are taken
        again: how often the errors of the clicks are drawn anew
    """
    project = _project(folder, six)
    if not (folder / project.section("picks").text("tracked")).exists():
        follow(project, TrackOptions())
    file = project.open("picks", "tracked")
    rows, rng = read_tracked(file), np.random.default_rng(1)
    result, others = solve_flight(project), list[Turned]()
    for _ in range(again):
        project.held["tracked", file.name] = drawn_anew(folder, rows, rng)
        others.append(turned(folder, solve_flight(project)))
    one = turned(folder, result)
    flagged = (result.to_dataframe()["flags"] != "").to_numpy()
    known = np.isfinite(one.turn_deg)
    return Counted(
        track_errors(folder, rows), one,
        float(one.turn_deg[known & ~flagged].max()), (int(known.sum()), len(known)),
        result.misfits or result.mistaken, others,
    )  # fmt: skip


def main() -> None:
    """Count all folders."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("folder", type=Path, nargs="+")
    parser.add_argument("--six", action="store_true", help="only the clicks of the first frame")
    parser.add_argument("--again", type=int, default=0, metavar="N", help="clicks drawn anew")
    given = parser.parse_args()
    print(HEAD + "\n" + "|---" * HEAD.count(" | ") + "|---|")
    every = []
    for folder in given.folder:
        one = count(folder, given.six, given.again)
        every.append(one)
        print(
            f"| {folder.name} | {_track_text(one.track_px)} | {one.turned.rms_deg:.4f} / "
            f"{one.unflagged_deg:.3f} | {np.sqrt(one.turned.stated_deg2):.4f} | "
            f"{one.turned.squares:.2f} | {'inside' if one.turned.inside else 'outside'} | "
            f"{one.frames[0]} of {one.frames[1]} | {'yes' if one.doubtful else 'no'} |",
            flush=True,
        )
    joined = {age: [v for one in every for v in one.track_px[age]] for age in (0, *AGES)}
    largest, doubtful = max(one.unflagged_deg for one in every), sum(one.doubtful for one in every)
    print(
        f"| all {len(every)} | {_track_text(joined)} | "
        f"{_all_text([one.turned for one in every], f' / {largest:.3f}')} | | {doubtful} |"
    )
    if given.again:
        others = [one for counted in every for one in counted.again]
        print(f"| {len(others)} with other clicks | | | | {_all_text(others)} | | |")


def _all_text(flights: list[Turned], largest: str = "") -> str:
    """Write median and worst turn, error over stated, NEES/3, and how many means are inside."""
    each = np.array([one.rms_deg for one in flights])
    ratio = np.sqrt((each**2).mean() / np.mean([one.stated_deg2 for one in flights]))
    return (
        f"median {np.median(each):.4f}, worst {each.max():.4f}{largest} "
        f"({(each > BEYOND_DEG).sum()} beyond {BEYOND_DEG}) | error over stated {ratio:.2f} | "
        f"{np.mean([one.squares for one in flights]):.2f} | "
        f"{sum(one.inside for one in flights)} inside"
    )


def _track_text(squares: dict[int, list[float]]) -> str:
    """Write root mean squares of all ages and of those that are told, and the largest error."""
    every, ten, sixty = (np.sqrt(np.mean(one)) if one else np.nan for one in squares.values())
    return f"{every:.3f} | {ten:.3f} / {sixty:.3f} | {np.sqrt(max(squares[0])):.2f}"


if __name__ == "__main__":
    main()
