"""From one frame to the next: where each solve starts (A 109 to A 111, A 449 to A 454)."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.program.constants import twopi
from vopd.program.orient import Orientation, Sight, orient


def orient_frames(
    initial: Floats, sight: Sight, dropped: Bools, turn: float = twopi
) -> tuple[Orientation, Floats]:
    """Solve a film from `initial` (3,) degrees; also returns every frame's start (3, F).

    Each frame starts from what the one before it left, as the program has it.
    Few results depend on their start to the last bit, so all frames are solved
    at once from group 8, and then those again whose start proves to be another,
    until none is: the same as one after the other. `turn` is the full circle
    with which the program compares angles in degrees: 2 pi, where 360 is meant.
    """
    frames = sight.used.shape[1]
    start = np.repeat(initial[:, None], frames, axis=1)
    done = orient(start, sight)
    while True:
        due = _starts(initial, done, dropped, turn)
        other = np.flatnonzero((due != start).any(axis=0))
        if not len(other):
            return done, start
        start[:, other] = due[:, other]
        done.put(other, orient(start[:, other], sight.only(other)))


def orient_from(start: Floats, sight: Sight) -> tuple[Orientation, Floats]:
    """Solve every frame from a start of its own (3, F) degrees, none from the one before."""
    return orient(start, sight), start


def _starts(initial: Floats, done: Orientation, dropped: Bools, turn: float) -> Floats:
    """The start of every frame, given how all frames ended.

    A frame that was dropped, or whose residuals vanished, leaves no angles and
    its successor starts where it did itself. Angles in degrees are compared
    with limits in radians, as listed, so each restarts from group 8 unless it
    lies in 0 to 6.283 degrees (pitch: -3.1416 to 3.1416). A frame that is not a
    number restarts its successor from group 8 altogether.
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
    left = np.where(stays, done.next, initial[:, None])
    return np.where(before >= 0, left[:, before], initial[:, None])


def _within(angle: Floats, low: float, high: float) -> Bools:
    inside: Bools = (angle >= low) & (angle <= high)
    return inside
