"""Errors of positions and landmarks that are held where they are stated, and what they move.

With `[solve] position = "fixed"` neither is solved for. An error of a landmark turns all frames
that see it, one of a fix all frames beside it; both move parameters that are freed, and these
turn every frame.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.estimate import COMMON_PART
from vopd.flight.flight import TrackFixes
from vopd.flight.solve.equations import SHIFT
from vopd.flight.solve.joint import JointSolution, late_by_common, propagated, seen_by_sums
from vopd.flight.solve.normal import RightSide, handed

LANDMARK, POSITION = "landmark" + COMMON_PART, "position" + COMMON_PART
AT_ONCE = 8  # landmarks that are propagated together


class HeldPlaces:
    """Errors of the positions and landmarks that a flight holds, propagated to what is solved.

    Args:
        solution: of the flight
    """

    def __init__(self, solution: JointSolution) -> None:
        self._solution = solution

    @cached_property
    def _images(self) -> tuple[Floats, Floats]:
        """The derivatives of the images of P picks, in standard deviations of these, (P, 2, 3).

        By the camera's east, north, up, m, and by the landmark's own.
        """
        model = self._solution.model
        # with landmarks among the unknowns, their rows are along their own axes
        own_m = np.ones((len(model.flight.landmarks.name), 3))
        full = model.with_priors(replace(model.priors, landmark_m=own_m))
        by_place, by_landmark = np.zeros((2, len(model.pick), 2, 3))
        for rows in full.rows(self._solution.state):
            by_place[rows.picks], by_landmark[rows.picks] = rows.by_place, rows.by_landmark
        return by_place, by_landmark

    @cached_property
    def _bias_m(self) -> Floats:
        """The standard deviations of the place of all frames, where it is held, (3,)."""
        model = self._solution.model
        return np.where(np.isin(SHIFT, model.names), 0.0, model.flight.path.bias_sigma_m)

    def _moves(self, right: RightSide) -> tuple[Floats, Floats]:
        """Differentiate k sums of the unknowns by places, (F, 3, k), and landmarks, (N, 3, k).

        Args:
            right: what each unknown adds to the sums
        """
        model, by_sums = self._solution.model, seen_by_sums(self._solution, right)
        marks = len(model.flight.landmarks.name)
        moved = (
            np.zeros((model.frames, 3, by_sums.shape[2])),
            np.zeros((marks, 3, by_sums.shape[2])),
        )
        for by_image, index, out in zip(
            self._images, (model.flight.picks.frame[model.pick], model.landmark), moved, strict=True
        ):
            own = -np.einsum("pai,pak->pik", by_image, by_sums)
            order = np.argsort(index, kind="stable")
            here, first = np.unique(index[order], return_index=True)
            if len(here):
                out[here] = np.add.reduceat(own[order], first, axis=0)
        return moved

    @cached_property
    def _moves_of_common(self) -> tuple[Floats, Floats]:
        """The derivatives of what is common to the frames, (F, 3, K) and (N, 3, K)."""
        model, size = self._solution.model, self._solution.normal.size
        nothing, no_fixes = (np.zeros((n, 3, size)) for n in (model.frames, len(model.fix_sigma_m)))
        return self._moves(RightSide(nothing, nothing, no_fixes, np.eye(size)))

    def _added(self, by_frame: Floats, by_mark: Floats) -> dict[str, Floats]:
        """Estimate the covariances of k sums by errors of held places, by component, (k, k)."""
        flight, scaled = self._solution.model.flight, {}
        if flight.landmarks.sigma_m.any():
            scaled[LANDMARK] = by_mark * flight.landmarks.sigma_m[..., None]
        if self._bias_m.any():
            scaled[POSITION] = by_frame.sum(axis=0, keepdims=True) * self._bias_m[:, None]
        fixes = flight.path.fixes
        if fixes is not None:
            by_fix = handed(fixes, by_frame) * fixes.sigma_m[..., None]
            scaled |= {name: by_fix[own] for name, own in _kinds(fixes)}
        return {name: np.einsum("jik,jil->kl", one, one) for name, one in scaled.items()}

    def of_sums(self, right: RightSide) -> dict[str, Floats]:
        """Estimate what they add to the covariances of k sums, by component, (k, k).

        Args:
            right: what each unknown adds to the sums
        """
        return self._added(*self._moves(right))

    @cached_property
    def of_common(self) -> Floats:
        """What they add to the covariance of what is common to the frames, (K, K)."""
        size = self._solution.normal.size
        return sum(self._added(*self._moves_of_common).values(), np.zeros((size, size)))

    @cached_property
    def of_frames(self) -> tuple[dict[str, Floats], Floats]:
        """What they add to the covariances of frames, also through what is common to these.

        Of turns about the camera's axes and of the time, s, by component, (F, 4, 4); and of places,
        east, north, up, m^2, (F, 3, 3).

        A frame turns by L e, with e the error of its place, and by U c, with c what is common,
        which all places move by C.
        """
        solution = self._solution
        model, normal = solution.model, solution.normal
        flight, frames = model.flight, model.frames
        (by_place, _), fixes = self._images, flight.path.fixes
        late, place = late_by_common(model), model.place_by_common(np.arange(frames))
        turn: dict[str, Floats] = {}
        place_m2 = np.zeros((frames, 3, 3))
        for name, change, own_place in self._changes():
            turned, _, common = propagated(solution, change)
            columns = np.concatenate([turned, (late @ common)[:, None]], axis=1)
            turn[name] = turn.get(name, 0.0) + columns @ columns.swapaxes(1, 2)
            moved = place @ common + own_place
            place_m2 = place_m2 + moved @ moved.swapaxes(1, 2)
        kinds = _kinds(fixes)
        if kinds and fixes is not None:
            size = normal.size
            nothing = np.zeros((0, 3, size))
            right = normal.right_side(-by_place * normal.weight[:, None, None])
            local = solution.factored.turns(right.turn, nothing[..., :3], np.zeros((size, 3)))
            through = solution.factored.turns(None, nothing, np.eye(size))
            local = np.concatenate([local, np.zeros((frames, 1, 3))], axis=1)
            through = np.concatenate([through, late[:, None]], axis=1)
            by_fix = handed(fixes, self._moves_of_common[0])
            itself = np.tile(np.eye(3), (frames, 1, 1))
            for name, own in kinds:
                kind = replace(fixes, sigma_m=np.where(own[:, None], fixes.sigma_m, 0.0))
                turn[name] = _with_common(kind, by_fix, local, through)
                place_m2 = place_m2 + _with_common(kind, by_fix, itself, place)
        return turn, place_m2

    def _changes(self) -> Iterator[tuple[str, Floats, Floats]]:
        """Iterate over errors of landmarks, and of the place of all frames, of one deviation each.

        Yields:
            The component, the changes of the images, in standard deviations of the picks,
            (P, 2, C), and of the frames' places, m, (1, 3, C).
        """
        model, (by_place, by_landmark) = self._solution.model, self._images
        sigma_m = model.flight.landmarks.sigma_m
        marks = np.intersect1d(np.flatnonzero(sigma_m.any(axis=1)), model.landmark)
        for k in range(0, len(marks), AT_ONCE):
            some = marks[k : k + AT_ONCE]
            change = np.zeros((len(model.pick), 2, len(some), 3))
            for slot, mark in enumerate(some.tolist()):
                own = model.landmark == mark
                change[own, :, slot] = by_landmark[own] * sigma_m[mark]
            yield LANDMARK, change.reshape(len(change), 2, -1), np.zeros((1, 3, 1))
        if self._bias_m.any():
            yield POSITION, by_place * self._bias_m, np.diag(self._bias_m)[None]


def _kinds(fixes: TrackFixes | None) -> list[tuple[str, Bools]]:
    """Mark the fixes whose errors are of the same component, (J,)."""
    if fixes is None:
        return []
    gaps = np.zeros(len(fixes.sigma_m), bool) if fixes.between is None else fixes.between
    kinds = [("position", ~gaps), ("interpolation", gaps)]
    return [(name, own) for name, own in kinds if fixes.sigma_m[own].any()]


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
