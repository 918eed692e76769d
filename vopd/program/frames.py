"""Where the solve of each frame starts: the restart rule (A 109 to A 111, A 449 to A 454)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.program.constants import twopi
from vopd.program.orient import orient
from vopd.program.sight import FilmSight
from vopd.results import CONVERGED_RAD

SAME_START_DEG = 1e-10
"""A converged frame is not solved again for a start that differs by this much or less."""
AT_A_TIME = 12_000
"""Landmarks of the frames that are solved at a time: fewer calls, and still in the cache."""


class FilmOrientation(NamedTuple):
    """The solve of a film: what `Orientation` is for some frames, the residuals without gaps.

    `angles`, `next` and `correction` are (3, F), `eps` (N, 2), `last_pass` and `singular` (F,).
    """

    angles: Floats
    eps: Floats
    next: Floats
    correction: Floats
    last_pass: Ints
    singular: Bools

    def only(self, frames: slice, landmarks: slice) -> FilmOrientation:
        """The results of some consecutive frames.

        Args:
            frames: the indices of the frames.
            landmarks: those of their landmarks.
        """
        return FilmOrientation(
            self.angles[:, frames],
            self.eps[landmarks],
            self.next[:, frames],
            self.correction[:, frames],
            self.last_pass[frames],
            self.singular[frames],
        )


def orient_frames(
    initial: Floats, sight: FilmSight, dropped: Bools, turn: float = twopi, first: Ints | int = 0
) -> tuple[FilmOrientation, Floats]:
    """Solve the frames of one or more films; each frame starts from the angles of the one before.

    The result is the same, bit for bit, as if the frames were solved one after the
    other; but frames are solved together, because few results depend on their start
    to the last bit. First every frame is solved from `initial`. Then the start that
    each frame should have had is known, and the frames that were solved from a
    different one are solved again, until there are none. A frame that converged is
    not solved again if its start differs by at most `SAME_START_DEG`; any other
    frame is solved again for a difference in the last bit.

    Args:
        initial: first estimates (3, 1) or (3, F) of the camera's yaw, pitch, roll, degrees:
            where a film starts, and where an angle starts that is not carried on.
        sight: what the solve is given.
        dropped: frames that leave no angles to the next (F,).
        turn: the full circle with which carried angles, in degrees, are compared:
            2 pi in the program, where 360 is meant.
        first: index of the first frame of each frame's film (F,), or of all.

    Returns:
        The solve, and the start (3, F) that each frame was solved from.

    Source: TM X-3050, A 109 to A 111 and A 449 to A 454.
    """
    frames = len(sight.cc)
    initial = np.broadcast_to(initial, (3, frames))
    start = initial.copy()
    done = FilmOrientation(
        angles=np.zeros((3, frames)),
        eps=np.zeros((sight.layout.total, 2)),
        next=np.zeros((3, frames)),
        correction=np.zeros((3, frames)),
        last_pass=np.zeros(frames, np.int64),
        singular=np.zeros(frames, bool),
    )
    enough = sight.layout.counted(sight.used) >= 2
    again = np.arange(frames)
    while len(again):
        _solve(again, start, sight, done)
        due = _starts(initial, done, dropped, turn, first)
        again = np.flatnonzero(_differs(due, start) & ~_kept(due, start, done, enough))
        start[:, again] = due[:, again]
    return done, start


def _solve(frames: Ints, start: Floats, sight: FilmSight, done: FilmOrientation) -> None:
    """Solve some frames of a film, those with like numbers of landmarks together."""
    for block in sight.layout.only(frames).blocks(AT_A_TIME):
        which = frames[block]
        part = orient(start[:, which], sight.of(which))
        rows, layout = sight.layout.rows(which), sight.layout.only(which)
        done.eps[rows] = layout.flat(part.eps.T)
        for mine, theirs in zip(done, part, strict=True):
            if mine is not done.eps:
                mine[..., which] = theirs


def _differs(due: Floats, start: Floats) -> Bools:
    """Frames that were not solved from the start they should have, to the last bit (F,)."""
    same = (due == start) | (np.isnan(due) & np.isnan(start))
    return ~np.asarray(same.all(axis=0))


def _kept(due: Floats, start: Floats, done: FilmOrientation, enough: Bools) -> Bools:
    """Frames whose result stands although their start differs in its last digits (F,).

    Frames without an answer of their own are never kept: those with fewer than two
    landmarks or a singular matrix, and those whose residuals vanished, which pass
    on their start as it is.
    """
    converged = (np.abs(done.correction) <= CONVERGED_RAD).all(axis=0)
    converged &= (done.last_pass == 0) & ~done.singular & enough
    return np.asarray(converged & (np.abs(due - start) <= SAME_START_DEG).all(axis=0))


def _starts(
    initial: Floats, done: FilmOrientation, dropped: Bools, turn: float, first: Ints | int
) -> Floats:
    """The start (3, F) that each frame should have, given how all frames ended.

    A frame that was dropped, or whose residuals vanished, passes no angles on: the
    next frame starts where that frame did. Carried angles are in degrees and the
    limits in radians, as in the listing: each angle starts from `initial` unless it
    lies in 0 to 6.283 degrees (pitch: -3.1416 to 3.1416). If a frame's angles are
    NaN, the next frame starts from `initial` in all three.
    """
    leaves = ~dropped & (done.last_pass == 0)
    frames = np.arange(len(leaves))
    before = np.maximum.accumulate(np.where(leaves, frames, -1))
    before = np.concatenate([[-1], before[:-1]])
    alpha, omega, xkap = done.next
    stays = np.stack(
        [_within(alpha, 0.0, turn), _within(omega, -turn / 2, turn / 2), _within(xkap, 0.0, turn)]
    )
    stays &= ~np.isnan(done.next).any(axis=0)
    carried = (before >= first) & stays[:, before]
    return np.where(carried, done.next[:, before], initial)


def _within(angle: Floats, low: float, high: float) -> Bools:
    """Which angles lie between these limits, the limits included."""
    inside: Bools = (angle >= low) & (angle <= high)
    return inside
