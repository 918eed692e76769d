"""Flights of clicks and tracks with drawn errors, and their least squares by one dense matrix.

An error is drawn once for each click, and one for each landmark in each frame: matches there are
off by it from whichever click, and the click there takes its patch from that frame, so that all its
matches elsewhere are off by as much the other way. Rendered videos are so (docs/track.md). Geodesy,
camera and the least squares are of numpy and scipy alone, a reading a row.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from tests.kit.joint_flights import LensTruth, Scene, axes, drone, flight_of, turned_out
from vopd.arrays import Floats, Ints
from vopd.flight.flight import Flight
from vopd.flight.formats.picks import Names, PickRows
from vopd.flight.formats.tracked import CLICKED, TRACKED, TrackedRows
from vopd.flight.project.tracked_picks import join_tracks
from vopd.flight.solve.equations import Priors


class ClickedFlight(NamedTuple):
    """A flight of clicks and tracks, its truth, and its rows."""

    flight: Flight
    scene: Scene
    rows: TrackedRows
    click_px: Floats  # (C, 2) the errors drawn, by landmark and frame of the click


def clicked_flight(
    rng: np.random.Generator, frames: int = 60, landmarks: int = 6, *,
    every: int = 30, apart: int = 3, reach: int = 45, click_px: float = 0.5, match_px: float = 0.08,
    stated_px: float | None = None, landmark_m: float = 0.0,
) -> ClickedFlight:  # fmt: skip
    """A drone whose landmarks are clicked in every n-th frame, and tracked from each click.

    Args:
        rng: the source of what is random
        frames: how many there are
        landmarks: how many there are
        every: frames between clicks of one landmark
        apart: frames between those of one landmark and of the next
        reach: frames over which a click is tracked
        click_px: standard deviation of a click
        match_px: of a landmark's matches in a frame
        stated_px: of a match, as the rows have it; None: as it is
        landmark_m: of the landmarks' positions
    """
    scene = drone(rng, frames, landmarks, spacing_m=0.5)
    marks = np.full((landmarks, 3), landmark_m) if landmark_m else None
    flight = flight_of(rng, scene, 0.0, Priors(landmark_m=marks))
    pixel = np.full((frames, landmarks, 2), np.nan)
    pixel[scene.frame, scene.landmark] = flight.picks.pixel
    noise = rng.spawn(1)[0].normal(0.0, match_px, (frames, landmarks, 2))
    rows, errors = [], []
    for mark in range(landmarks):
        for source in range(min(mark * apart, frames - 1), frames, every):
            error = rng.normal(0.0, click_px, 2)
            errors.append(error)
            for frame in range(max(source - reach, 0), min(source + reach + 1, frames)):
                age = (frame - source) / reach
                turn, grow = 0.4 * age, 1.0 + 0.2 * age
                by = grow * np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
                # of the click itself nothing but its own error
                shift = by @ (error - noise[source, mark]) + noise[frame, mark]
                rows.append((frame, mark, source, pixel[frame, mark] + shift, by))
    frame, mark, source = (np.array([row[k] for row in rows]) for k in range(3))
    clicked = frame == source
    sigma_px = np.where(clicked, click_px, match_px if stated_px is None else stated_px)
    tracks = TrackedRows(
        frame, Names(f"P{k}" for k in mark), np.array([row[3] for row in rows]), sigma_px, source,
        np.array([row[4] for row in rows]), np.ones(len(rows)),
        np.where(clicked, CLICKED, TRACKED),
    )  # fmt: skip
    return ClickedFlight(with_rows(flight, tracks), scene, tracks, np.array(errors))


def with_rows(flight: Flight, rows: TrackedRows) -> Flight:
    """Give a flight the picks of tracked rows."""
    read = PickRows(
        rows.frame, rows.landmark, rows.pixel, rows.sigma_px, "centre", None, "", tracks=rows
    )
    picks, _ = join_tracks(read, flight.frame, flight.landmarks.name, flight.source)
    return replace(flight, picks=picks)


class DenseSolution(NamedTuple):
    """The least squares of all unknowns, by one matrix."""

    rotation: Floats  # (F, 3, 3)
    turn: Floats  # (3F, 3F) covariance of the turns
    click_px: Floats  # (C, 2) errors of the clicks, by landmark and frame of the click


def dense_solution(one: ClickedFlight, start: Floats, match_px: float) -> DenseSolution:
    """Solve a flight of clicks and tracks with a row for each reading.

    Args:
        one: the flight
        start: rotations to begin with, (F, 3, 3)
        match_px: standard deviation of the matches of a landmark in a frame
    """
    rows, flight = one.rows, one.flight
    marks = np.array([flight.landmarks.name.index(name) for name in rows.landmark])
    click, which = _clicks(rows, marks)
    clicked = rows.status == CLICKED
    sigma_px = rows.sigma_px[clicked][np.argsort(which[clicked])]
    _, point, times = np.unique(
        np.stack([marks, rows.frame]), axis=1, return_inverse=True, return_counts=True
    )
    own_px = match_px * np.sqrt(times[point])  # those of one point are together as good as one
    frames, size_m = len(start), flight.landmarks.sigma_m
    own, mark_axes = axes(flight.path.position_m), axes(flight.landmarks.position_m)
    free = np.flatnonzero(size_m.any(axis=1))
    cuts = np.cumsum([3 * frames, 2 * click])

    def residual(step: Floats) -> Floats:
        turn, error, moved = np.split(step, cuts)
        error, moved = error.reshape(-1, 2), moved.reshape(-1, 3)
        rotation = Rotation.from_rotvec(turn.reshape(-1, 3)).as_matrix() @ start
        position = flight.landmarks.position_m.copy()
        position[free] += turned_out(mark_axes[free], moved)
        away = position[marks] - flight.path.position_m[rows.frame]
        ray = np.einsum("pij,pjk,pk->pi", rotation[rows.frame], own[rows.frame], away)
        shift = np.einsum("pij,pj->pi", rows.by_click, error[which])
        off = (rows.pixel - LensTruth().image(ray) - shift) / own_px[:, None]
        prior = error / sigma_px[:, None]
        return np.concatenate([off.ravel(), prior.ravel(), (moved / size_m[free]).ravel()])

    scale = np.concatenate(
        [np.full(3 * frames, 1e-4), np.full(2 * click, 0.1), np.full(3 * len(free), 0.01)]
    )
    step = np.zeros(len(scale))
    for _ in range(6):
        by = [residual(step + e) - residual(step - e) for e in np.diag(scale)]
        slopes = np.stack(by, axis=1) / (2.0 * scale)
        step = step - np.linalg.lstsq(slopes, residual(step), rcond=None)[0]
    covariance = np.linalg.inv(slopes.T @ slopes)
    turn = Rotation.from_rotvec(step[: cuts[0]].reshape(-1, 3)).as_matrix()
    error = step[cuts[0] : cuts[1]].reshape(-1, 2)
    return DenseSolution(turn @ start, covariance[: cuts[0], : cuts[0]], error)


def _clicks(rows: TrackedRows, marks: Ints) -> tuple[int, Ints]:
    """Number the clicks by landmark and frame."""
    keys, which = np.unique(np.stack([marks, rows.from_frame]), axis=1, return_inverse=True)
    return keys.shape[1], which
