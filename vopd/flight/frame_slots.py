"""Picks in a row, and the same in one row a frame: the two shapes of what is known of a pick."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vopd.arrays import Floats, Ints


class FrameSlots(NamedTuple):
    """Where each of P picks stands in arrays of F frames and L columns."""

    frame: Ints  # (P,)
    slot: Ints  # (P,) 0 for the first pick of a frame
    frames: int
    slots: int

    @classmethod
    def of(cls, frame: Ints, frames: int) -> FrameSlots:
        """The slots of picks, in their own order within each frame."""
        count = np.bincount(frame, minlength=frames)
        order = np.argsort(frame, kind="stable")
        first = np.repeat(np.cumsum(count) - count, count)
        slot = np.empty(len(frame), np.int64)
        slot[order] = np.arange(len(frame)) - first
        return cls(frame, slot, frames, int(count.max(initial=1)))

    def spread(self, values: NDArray[Any]) -> NDArray[Any]:
        """Values (P, ...) as (F, L, ...); 0 or false where a frame has fewer picks."""
        out = np.zeros((self.frames, self.slots, *values.shape[1:]), dtype=values.dtype)
        out[self.frame, self.slot] = values
        return out

    def coordinates(self, values: Floats) -> Floats:
        """Two values a pick, (P, 2, ...), as (F, 2L, ...): the first of all, then the second."""
        pairs = np.moveaxis(self.spread(values), 2, 1)
        return pairs.reshape(self.frames, 2 * self.slots, *values.shape[2:])
