"""Errors of positions and landmarks that are held where they are stated, and what they move.

With `[solve] position = "fixed"` neither is solved for. An error of a landmark turns all frames
that see it, one of a fix all frames beside it; both move parameters that are freed, and these
turn every frame.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.estimate import COMMON_PART
from vopd.flight.flight import TrackFixes
from vopd.flight.solve.equations import SHIFT
from vopd.flight.solve.joint import JointSolution, late_by_common, propagated, seen_by_sums
from vopd.flight.solve.normal import RightSide, handed

LANDMARK, POSITION = "landmark" + COMMON_PART, "position" + COMMON_PART
AT_ONCE = 8  # landmarks that are propagated together


class _Images(NamedTuple):
    """What held places do to the images of P picks, in standard deviations of the picks."""

    by_place: Floats  # (P, 2, 3) by the camera's east, north, up, m
    by_landmark: Floats  # (P, 2, 3) by the landmark's own


def _images(solution: JointSolution) -> _Images:
    model = solution.model
    # with landmarks among the unknowns, their rows are along their own axes
    full = model.with_priors(
        replace(model.priors, landmark_m=np.ones((len(model.flight.landmarks.name), 3)))
    )
    by_place, by_landmark = np.zeros((2, len(model.pick), 2, 3))
    for rows in full.rows(solution.state):
        by_place[rows.picks], by_landmark[rows.picks] = rows.by_place, rows.by_landmark
    return _Images(by_place, by_landmark)


def _kinds(fixes: TrackFixes | None) -> list[tuple[str, Bools]]:
    """Mark the fixes whose errors are of the same component, (J,)."""
    if fixes is None:
        return []
    gaps = np.zeros(len(fixes.sigma_m), bool) if fixes.between is None else fixes.between
    kinds = [("position", ~gaps), ("interpolation", gaps)]
    return [(name, own) for name, own in kinds if fixes.sigma_m[own].any()]


def _bias_m(solution: JointSolution) -> Floats:
    """Look up the standard deviations of the place of all frames, where it is held, (3,)."""
    free = np.isin(SHIFT, solution.model.names)
    return np.where(free, 0.0, solution.model.flight.path.bias_sigma_m)


def _move(solution: JointSolution, images: _Images, by_sums: Floats) -> tuple[Floats, Floats]:
    """Differentiate k sums by places: of the frames (F, 3, k), and of the landmarks (N, 3, k).

    Args:
        solution: of the flight
        images: of held places
        by_sums: what the sums lose by the images of picks, as `seen_by_sums`, (P, 2, k)
    """
    model, k = solution.model, by_sums.shape[2]
    found = []
    for by_place, index, count in (
        (images.by_place, model.flight.picks.frame[model.pick], model.frames),
        (images.by_landmark, model.landmark, len(model.flight.landmarks.name)),
    ):
        own = -np.einsum("pai,pak->pik", by_place, by_sums)
        order = np.argsort(index, kind="stable")
        here, first = np.unique(index[order], return_index=True)
        out = np.zeros((count, 3, k))
        if len(here):
            out[here] = np.add.reduceat(own[order], first, axis=0)
        found.append(out)
    return found[0], found[1]


def sums_by_held_places(solution: JointSolution, by_sums: Floats) -> dict[str, Floats]:
    """Estimate what errors of held places add to the covariances of k sums, by component, (k, k).

    Args:
        solution: of a flight that holds its places
        by_sums: what the sums lose by the images of picks, as `seen_by_sums`, (P, 2, k)
    """
    flight = solution.model.flight
    by_frame, by_mark = _move(solution, _images(solution), by_sums)
    scaled = {}
    if flight.landmarks.sigma_m.any():
        scaled[LANDMARK] = by_mark * flight.landmarks.sigma_m[..., None]
    if (bias_m := _bias_m(solution)).any():
        scaled[POSITION] = by_frame.sum(axis=0, keepdims=True) * bias_m[:, None]
    fixes = flight.path.fixes
    if fixes is not None:
        by_fix = handed(fixes, by_frame) * fixes.sigma_m[..., None]
        scaled |= {name: by_fix[own] for name, own in _kinds(fixes)}
    return {name: np.einsum("jik,jil->kl", one, one) for name, one in scaled.items()}


def common_by_held_places(solution: JointSolution) -> Floats:
    """Estimate what errors of held places add to the covariance of what is common, (K, K)."""
    size = solution.normal.size
    by_sums = seen_by_sums(solution, _of_common(solution))
    return sum(sums_by_held_places(solution, by_sums).values(), np.zeros((size, size)))


def _of_common(solution: JointSolution) -> RightSide:
    """Take everything that is common as the sums."""
    model, size = solution.model, solution.normal.size
    nothing, no_fixes = (np.zeros((n, 3, size)) for n in (model.frames, len(model.fix_sigma_m)))
    return RightSide(nothing, nothing, no_fixes, np.eye(size))


class HeldPlaces(NamedTuple):
    """What errors of held places add to the covariances of frames, by component."""

    turn: dict[str, Floats]  # (F, 4, 4) of turns about the camera's axes, and of the time, s
    place_m2: Floats  # (F, 3, 3) east, north, up


def held_places(solution: JointSolution) -> HeldPlaces:
    """Propagate errors of held places to the frames, through what is common to these as well.

    A frame turns by L e, with e the error of its place, and by U c, with c what is common, which
    all places move by C.
    """
    model, normal = solution.model, solution.normal
    flight, frames = model.flight, model.frames
    images, fixes = _images(solution), flight.path.fixes
    late, place = late_by_common(model), model.place_by_common(np.arange(frames))
    turn: dict[str, Floats] = {}
    place_m2 = np.zeros((frames, 3, 3))

    def add(name: str, change: Floats, own_place: Floats) -> None:
        nonlocal place_m2
        turned, _, common = propagated(solution, change)
        columns = np.concatenate([turned, (late @ common)[:, None]], axis=1)
        turn[name] = turn.get(name, 0.0) + columns @ columns.swapaxes(1, 2)
        moved = place @ common + own_place
        place_m2 = place_m2 + moved @ moved.swapaxes(1, 2)

    sigma_m = flight.landmarks.sigma_m
    marks = np.intersect1d(np.flatnonzero(sigma_m.any(axis=1)), model.landmark)
    for k in range(0, len(marks), AT_ONCE):
        some = marks[k : k + AT_ONCE]
        change = np.zeros((len(model.pick), 2, len(some), 3))
        for slot, mark in enumerate(some.tolist()):
            own = model.landmark == mark
            change[own, :, slot] = images.by_landmark[own] * sigma_m[mark]
        add(LANDMARK, change.reshape(len(change), 2, -1), np.zeros((1, 3, 1)))
    if (bias_m := _bias_m(solution)).any():
        add(POSITION, images.by_place * bias_m, np.diag(bias_m)[None])
    kinds = _kinds(fixes)
    if kinds and fixes is not None:
        size = normal.size
        nothing = np.zeros((0, 3, size))
        right = normal.right_side(-images.by_place * normal.weight[:, None, None])
        local = solution.factored.turns(right.turn, nothing[..., :3], np.zeros((size, 3)))
        through = solution.factored.turns(None, nothing, np.eye(size))
        local = np.concatenate([local, np.zeros((frames, 1, 3))], axis=1)
        through = np.concatenate([through, late[:, None]], axis=1)
        by_frame, _ = _move(solution, images, seen_by_sums(solution, _of_common(solution)))
        by_fix, itself = handed(fixes, by_frame), np.tile(np.eye(3), (frames, 1, 1))
        for name, own in kinds:
            kind = replace(fixes, sigma_m=np.where(own[:, None], fixes.sigma_m, 0.0))
            turn[name] = _with_common(kind, by_fix, local, through)
            place_m2 = place_m2 + _with_common(kind, by_fix, itself, place)
    return HeldPlaces(turn, place_m2)


def _with_common(fixes: TrackFixes, by_fix: Floats, local: Floats, through: Floats) -> Floats:
    """Add up the covariances of what errors of fixes do to frames, (F, a, a).

    Args:
        fixes: with their standard deviations
        by_fix: of what is common, (J, 3, K)
        local: by the error of a frame's own place, (F, a, 3)
        through: by what is common, (F, a, K)
    """
    scaled = by_fix * fixes.sigma_m[..., None]
    mixed = fixes.at_frames(scaled * fixes.sigma_m[..., None])
    crossed = local @ mixed @ through.swapaxes(1, 2)
    common = np.einsum("jik,jil->kl", scaled, scaled)
    own = local * fixes.frame_sigma_m[:, None]
    return np.asarray(
        own @ own.swapaxes(1, 2)
        + crossed
        + crossed.swapaxes(1, 2)
        + through @ common @ through.swapaxes(1, 2)
    )
