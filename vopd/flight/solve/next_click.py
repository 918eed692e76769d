"""Where to click next: the frames and landmarks whose clicks would tell the most.

A click observes the image of a landmark in a frame. How much smaller it would make the stated
covariances follows from those that there are, without another solve: an update of rank two.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.findings import size_text
from vopd.flight.flight import Flight, Picks, frame_label
from vopd.flight.solve.equations import Model
from vopd.flight.solve.joint import JointSolution
from vopd.flight.solve.lines_of_sight import sight_lines
from vopd.flight.solve.normal import RightSide
from vopd.geometry.lenses import project

FRAMES_TRIED = 30
MOST_CLICKS = 160
MOST_NUMBERS = 8_000_000  # of the changes of all turns by these
LEAST_GAIN = 0.02  # of the sigma: less is not worth a click


class NextClick(NamedTuple):
    """A click that would tell much, and what the standard deviation would be with it."""

    frame: int  # index of the frame
    landmark: int  # index of the landmark
    pixel: Floats  # (2,) near which it is
    before_deg: float  # root mean square of the stated sigmas of all frames, about all axes
    after_deg: float  # with this click and those before it


def next_clicks(joint: JointSolution, count: int = 3) -> list[NextClick]:
    """Find the clicks that would lower the stated sigmas most, the best one first.

    Each is the best beside those before it, and of another landmark. Frames are tried that are
    spread over the flight, and in each the landmarks that would be in the picture and are not
    marked as hidden.

    Args:
        joint: the solution of a flight with clicks
        count: how many are wanted
    """
    clicks = joint.model.flight.picks.clicks
    if clicks is None or joint.model.solved == 0:
        return []
    tried = _candidates(joint, float(np.median(clicks.sigma_px)))
    if not len(tried.picks.frame):
        return []
    between, told = _covariances(joint, tried)
    total = float(np.nansum(np.einsum("fii->f", joint.covariance.turn)))
    scale = 3.0 * joint.model.solved
    found: list[NextClick] = []
    for _ in range(count):
        at = 2 * np.arange(len(told) // 2)[:, None, None] + np.arange(2)
        left = np.linalg.inv(np.eye(2) + between[at.swapaxes(1, 2), at])
        gain = np.einsum("nij,nji->n", left, told[at.swapaxes(1, 2), at])
        gain[np.isin(tried.picks.landmark, [one.landmark for one in found])] = 0.0
        best = int(gain.argmax())
        after = total - float(gain[best])
        before_deg, after_deg = np.degrees(np.sqrt(np.maximum([total, after], 0.0) / scale))
        if not after_deg < (1.0 - LEAST_GAIN) * before_deg:
            break
        picks, own = tried.picks, slice(2 * best, 2 * best + 2)
        found.append(
            NextClick(
                int(picks.frame[best]), int(picks.landmark[best]), picks.pixel[best],
                float(before_deg), float(after_deg),
            )
        )  # fmt: skip
        by = left[best] @ between[own]  # what the click takes off, by all others
        of_best = told[:, own]
        told = told - of_best @ by - by.T @ of_best.T + by.T @ told[own, own] @ by
        between = between - between[:, own] @ by
        total = after
    return found


def _candidates(joint: JointSolution, sigma_px: float) -> Flight:
    """List landmarks in frames that are spread over a flight, as picks that no click is of."""
    model, flight, solved = joint.model, joint.model.flight, joint.solved
    clicks = flight.picks.clicks
    assert clicks is not None
    known = np.flatnonzero(np.isfinite(solved.attitudes.rotation[:, 0, 0]))
    marks = np.unique(model.landmark)
    most = min(MOST_CLICKS, max(MOST_NUMBERS // (6 * model.frames), 1))
    wanted = max(min(FRAMES_TRIED, most // max(len(marks), 1)), 1)
    frames = known[np.unique(np.linspace(0, len(known) - 1, wanted).round().astype(int))]
    frame, mark = (one.ravel() for one in np.meshgrid(frames, marks, indexing="ij"))
    marks_m = flight.landmarks.position_m if solved.landmark_m is None else solved.landmark_m
    lines = sight_lines(solved.camera_m, marks_m, frame, mark, flight.refraction)
    ray = np.einsum("pij,pj->pi", solved.attitudes.rotation[frame], lines.direction)
    pixel = project(flight.lens, ray).pixel
    inside = np.isfinite(pixel).all(axis=1) & (ray[:, 2] > 0.0)
    inside &= ((pixel > 0.0) & (pixel < np.array(flight.lens.size_px) - 1.0)).all(axis=1)
    inside &= ~np.isin(frame * len(marks_m) + mark, clicks.frame * len(marks_m) + clicks.landmark)
    for k in np.flatnonzero(inside):
        inside[k] = (frame_name(flight, int(frame[k])), int(mark[k])) not in clicks.hidden
    some = np.flatnonzero(inside)[:most]
    picks = Picks(frame[some], mark[some], pixel[some], np.full(len(some), sigma_px))
    return replace(flight, picks=picks)


def _covariances(joint: JointSolution, tried: Flight) -> tuple[Floats, Floats]:
    """Estimate the covariances of n clicks' places, in their sigmas, (2n, 2n), and what they tell.

    Returns:
        Those, and the products of their covariances with all turns, summed over the frames.
    """
    model, count = joint.model, len(tried.picks.frame)
    priors = replace(model.priors, click_px=None)
    every = Model(
        tried, priors, np.ones(count, bool), np.ones(model.frames, bool), tried.picks.sigma_px,
        None if model.readout is None else model.readout._replace(part=np.zeros(count)),
    )  # fmt: skip
    every.since_s = model.since_s
    size, marks = len(model.common_sigma), len(model.names)
    turn, place = np.zeros((model.frames, 3, 2 * count)), np.zeros((model.frames, 3, 2 * count))
    common = np.zeros((size, 2 * count))
    for rows in every.rows(joint.state):
        for b, frame in enumerate(rows.frames.tolist()):
            for k, pick in enumerate(rows.picks[b].tolist()):
                own = every.pick[pick]
                at = slice(2 * own, 2 * own + 2)
                turn[frame, :, at] = rows.by_turn[b, k].T
                if model.priors.fixes is not None:
                    place[frame, :, at] = rows.by_place[b, k].T
                common[:marks, at] = rows.by_parameter[b, k].T
                free = np.flatnonzero(model.free == tried.picks.landmark[own])
                if len(free):
                    first = marks + 3 * int(free[0])
                    common[first : first + 3, at] = rows.by_landmark[b, k].T
    nothing = np.zeros((*model.fix_sigma_m.shape, 2 * count))
    right = RightSide(turn, place, nothing, common)
    turned, fix, moved = joint.factored.solve(right)
    between = common.T @ moved
    frame_of = np.repeat(tried.picks.frame, 2)
    own_turn = turn[frame_of, :, np.arange(2 * count)]
    between += np.einsum("ni,nik->nk", own_turn, turned[frame_of])
    if joint.normal.fixes is not None:
        at_frames = joint.normal.fixes.at_frames(fix)
        own_place = place[frame_of, :, np.arange(2 * count)]
        between += np.einsum("ni,nik->nk", own_place, at_frames[frame_of])
    flat = turned.reshape(-1, 2 * count)
    return (between + between.T) / 2.0, flat.T @ flat


def frame_name(flight: Flight, frame: int) -> str:
    """Name a frame by its index, as picks do: by its number or its image."""
    return flight.image_name[frame] if flight.image_name else str(flight.frame[frame])


class NextPlace(NamedTuple):
    """A frame in which to click next, and why."""

    frame: str  # its number, or its image
    landmark: str  # empty for any two of them
    text: str
    pixel: tuple[float, float] | None = None  # near which the landmark is


def next_places(joint: JointSolution, count: int = 3) -> list[NextPlace]:
    """Say where to click next: frames where landmarks are lost, then those that tell most.

    Args:
        joint: the solution of a flight with clicks
        count: how many places at most
    """
    flight, found = joint.model.flight, list[NextPlace]()
    clicks = flight.picks.clicks
    if clicks is None:
        return found
    for first, last in _runs(clicks.lost)[:count]:
        where = f"frames {first} to {last}" if last > first else f"frame {first}"
        middle = (first + last) // 2
        text = f"two landmarks in frame {middle}: fewer than two are found in {where}"
        found.append(NextPlace(str(middle), "", text))
    for one in next_clicks(joint, count - len(found)):
        u, v = one.pixel
        name = flight.landmarks.name[one.landmark]
        text = (
            f"{name} in {frame_label(flight, one.frame)}, near {u:.0f}, {v:.0f}: the sigma of a "
            f"typical frame falls from {size_text(one.before_deg, 3)} to "
            f"{size_text(one.after_deg, 3)} degree"
        )
        found.append(NextPlace(frame_name(flight, one.frame), name, text, (float(u), float(v))))
    return found


def next_click_texts(joint: JointSolution) -> list[str]:
    """Say where to click next, in one line; or that no click tells much; nothing without clicks.

    Args:
        joint: the solution of a flight with clicks
    """
    if joint.model.flight.picks.clicks is None:
        return []
    texts = [f"click next: {one.text}" for one in next_places(joint, 1)]
    return texts or [f"no further click lowers the stated sigma by {100.0 * LEAST_GAIN:g} %"]


def _runs(frames: Ints) -> list[tuple[int, int]]:
    """List first and last of the runs of following numbers, the longest first."""
    if not len(frames):
        return []
    starts = np.flatnonzero(np.append(True, np.diff(frames) > 1))
    ends = np.append(starts[1:], len(frames)) - 1
    runs = [(int(frames[a]), int(frames[b])) for a, b in zip(starts, ends, strict=True)]
    return sorted(runs, key=lambda run: (run[0] - run[1], run[0]))
