"""How far clicks leave the turn of a rendered flight, whatever follows them through its frames.

    python -m tools.click_limit [--seeds 7 27] [--six] [--match-px .06]

Nothing is rendered, and nothing of the package takes part: movement, lens, landmarks and clicks are
those of `python -m tools.render_video FOLDER --seed N`. Each landmark that is seen in a frame is
matched with its clicks within 70 frames, or with the nearest; a match has the click's error as
positions and ground carry it into the frame, and a normal error of its own, the same for all clicks
of the landmark but a fifth. Frames' turns and clicks' errors are solved together by least squares
with these true sigmas, to first order: no estimator without a bias has less.

Each row is a flight, its clicks and matches drawn so many times: the median of its turns' root
mean squares, degree, and how often this, and how often one of its frames, is beyond; then the same
turns with the clicks that the rendered flight has. The last row says how many flights of the lot
are beyond on average, and how often none is.
"""

from __future__ import annotations

import argparse
from typing import Any, NamedTuple

import numpy as np

from tools.render_video import (
    TICKS,
    Camera,
    Floats,
    Motion,
    Settings,
    clicked,
    frame_times,
    new_camera,
    new_hills,
    new_marks,
    new_motion,
    pixels,
    turns,
)

REACH = 70  # frames, as `vopd track` has it
OWN = 0.2  # of a match's sigma, between clicks of a landmark
BEYOND_DEG = 0.035
HEAD = (
    "| flight | clicks | median | beyond, rms | beyond, a frame | its own clicks: rms | a frame |"
)


class Drawn(NamedTuple):
    """What is known of a rendered flight without its video."""

    seen: Any  # (F, L)
    by_ground: Floats  # change of pixels by metres east and north, (F, L, 2, 2)
    by_turn: Floats  # by radians about the camera's axes, (F, L, 2, 3)
    click: list[tuple[int, int]]  # frame and landmark
    error_px: Floats  # of the clicks, u and v one after the other, (2 C,)


def drawn(settings: Settings) -> Drawn:
    """Draw a flight as `tools.render_video.make` does, to its clicks."""
    rng = np.random.default_rng(settings.seed)
    camera, motion = new_camera(settings.size), new_motion(rng)
    hills, time_s = new_hills(rng, settings.hills_m), frame_times(settings) / TICKS
    mark, _ = new_marks(rng, settings, camera, motion, hills, time_s)
    pixel = pixels(camera, motion, mark, time_s)
    rng.normal(size=3)  # the track's
    rows = [
        row.split(",")
        for row in clicked(settings, camera, pixel, np.zeros(pixel.shape[:2], bool), rng)
    ]
    click = [(int(frame), int(name[1:]) - 1) for frame, name, _, _ in rows]
    at = np.array([[float(u), float(v)] for _, _, u, v in rows])
    error = at - np.array([pixel[one] for one in click])
    changes = _changes(camera, motion, mark, time_s)
    return Drawn(camera.sees(pixel), *changes, click, error.ravel())


def _changes(camera: Camera, motion: Motion, mark: Floats, time_s: Floats) -> tuple[Floats, Floats]:
    """Differentiate pixels by places on the ground and by turns, by small steps."""
    turn, way = motion.turn(time_s), mark - motion.place_m(time_s)[:, None]
    step_m, step = 0.1, 1e-5

    def pixel(turn: Floats, way: Floats) -> Floats:
        return camera.pixel(np.einsum("fij,fli->flj", turn, way))

    ground = [pixel(turn, way + one) - pixel(turn, way - one) for one in step_m * np.eye(3)[:2]]
    about = [
        pixel(turn @ turns(one), way) - pixel(turn @ turns(-one), way) for one in step * np.eye(3)
    ]
    return np.stack(ground, -1) / (2.0 * step_m), np.stack(about, -1) / (2.0 * step)


def turns_deg(one: Drawn, error_px: Floats, match_px: float, rng: np.random.Generator) -> Floats:
    """Solve the flight with errors of the clicks, (D, 2 C), and drawn errors of the matches.

    Returns:
        The whole turn of each frame with two landmarks from the truth, degrees (D, F).
    """
    size = len(one.click)
    normal, right = np.eye(2 * size) / 0.25, np.zeros((len(error_px), 2 * size))
    frames: list[tuple[Floats, Floats, Floats]] = []
    for f in range(len(one.seen)):
        own = [k for mark in np.flatnonzero(one.seen[f]) for k in _matched(one.click, f, int(mark))]
        which = np.array([one.click[k][1] for k in own])
        if len(set(which)) < 2:
            continue
        carried = np.zeros((len(own), 2, 2 * size))
        for row, k in enumerate(own):
            at = one.click[k]
            by_click = one.by_ground[f, at[1]] @ np.linalg.inv(one.by_ground[at])
            carried[row, :, 2 * k : 2 * k + 2] = by_click
        a, j = carried.reshape(-1, 2 * size), one.by_turn[f, which].reshape(-1, 3)
        common = (which[:, None] == which) + OWN**2 * np.eye(len(own))
        root = np.linalg.cholesky(match_px**2 * np.kron(common, np.eye(2)))
        y = error_px @ a.T + rng.normal(size=(len(error_px), len(a))) @ root.T
        weight = np.linalg.inv(root @ root.T)
        solve = np.linalg.solve(j.T @ weight @ j, j.T @ weight)  # the turn of a residual
        free = weight - weight @ j @ solve
        normal += a.T @ free @ a
        right += y @ free @ a
        frames.append((solve, a, y))
    found = np.linalg.solve(normal, right.T).T
    off = [((y - found @ a.T) @ solve.T) ** 2 for solve, a, y in frames]
    return np.asarray(np.degrees(np.sqrt(np.stack(off, axis=1).sum(axis=-1))))


def _matched(click: list[tuple[int, int]], frame: int, mark: int) -> list[int]:
    """Choose the clicks that a landmark of a frame is matched with."""
    of = [k for k, (_, other) in enumerate(click) if other == mark]
    near = [k for k in of if abs(click[k][0] - frame) <= REACH]
    return near or sorted(of, key=lambda k: abs(click[k][0] - frame))[:1]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seeds", type=int, nargs=2, default=(7, 27), metavar=("FIRST", "END"))
    parser.add_argument("--six", action="store_true", help="only the clicks of the first frame")
    parser.add_argument("--match-px", type=float, default=0.06, help="error of a match, each axis")
    parser.add_argument("--draws", type=int, default=1000, metavar="N")
    given = parser.parse_args()
    print(HEAD + "\n" + "|---" * HEAD.count(" | ") + "|---|", flush=True)
    beyond = []
    for seed in range(*given.seeds):
        one = drawn(Settings(seed=seed, clicks=6 if given.six else 27))
        rng = np.random.default_rng([seed, 2])
        clicks = rng.normal(0.0, 0.5, (given.draws, len(one.error_px)))
        turn, own = (
            turns_deg(one, error, given.match_px, rng)
            for error in (clicks, np.tile(one.error_px, (20, 1)))
        )
        rms = np.sqrt((turn**2).mean(axis=1))
        beyond.append([(far > BEYOND_DEG).mean() for far in (rms, turn.max(axis=1))])
        print(
            f"| {seed} | {len(one.click)} | {np.median(rms):.4f} | {beyond[-1][0]:.2%} | "
            f"{beyond[-1][1]:.2%} | {np.sqrt((own**2).mean()):.4f} | "
            f"{np.median(own.max(axis=1)):.4f} |",
            flush=True,
        )
    share = np.array(beyond)
    mean, none = share.sum(axis=0), (1.0 - share).prod(axis=0)
    print(
        f"| all {len(share)} | | | {mean[0]:.2f} flights, none {none[0]:.0%} | "
        f"{mean[1]:.2f} flights, none {none[1]:.0%} | | |"
    )


if __name__ == "__main__":
    main()
