"""Layout of the landmarks of frames in arrays without gaps: frame after frame, as they were read.

A frame with many landmarks among frames with few would make arrays of frames by landmarks
far larger than the readings, so that the package keeps (N, ...) arrays, one element for
each landmark of each frame, and makes (F, L, ...) arrays of some frames at a time.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from vopd.arrays import Bools, Ints, distinct_in_rows

FEW = 4096  # empty elements of an array: more, and frames are divided into blocks
AT_ONCE = 24_000  # landmarks of a block of a long job; a frame that has more is a block by itself
TOGETHER = 100_000  # landmarks and frames of a part of a long job; then the next part begins


class LandmarkLayout:
    """Where the landmarks of F frames stand in arrays of all N landmarks.

    Attributes:
        count: how many landmarks each frame has (F,)
        end: index behind the last landmark of each frame (F,)
        start: index of its first landmark (F,)
        total: N
        widest: L, the largest count
    """

    def __init__(self, count: Ints) -> None:
        self.count = count
        self.end = np.cumsum(count)
        self.start = self.end - count
        self.total = int(self.end[-1]) if len(count) else 0
        self.widest = int(count.max(initial=0))
        self.even = self.total == len(count) * self.widest

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, LandmarkLayout):
            return NotImplemented
        return np.array_equal(self.count, other.count)

    def __repr__(self) -> str:
        return f"LandmarkLayout({len(self.count)} frames, {self.total} landmarks)"

    @cached_property
    def frame(self) -> Ints:
        """The index of each landmark's frame (N,)."""
        return np.asarray(np.repeat(np.arange(len(self.count)), self.count))

    @property
    def present(self) -> Bools:
        """Which of L columns hold a landmark in each frame (F, L)."""
        return np.asarray(np.arange(self.widest) < self.count[:, None])

    def span(self, frame: int | np.integer) -> slice:
        """Locate the landmarks of one frame."""
        return slice(int(self.start[frame]), int(self.end[frame]))

    def only(self, frames: Ints | Bools | slice) -> LandmarkLayout:
        """Select some of the frames."""
        return LandmarkLayout(self.count[frames])

    def rows(self, frames: Ints) -> Ints:
        """Locate the landmarks of some frames, one frame after the other: their indices."""
        count = self.count[frames]
        before = np.cumsum(count) - count
        rows = np.arange(int(count.sum())) + np.repeat(self.start[frames] - before, count)
        return np.asarray(rows)

    def counted(self, mask: Bools) -> Ints:
        """Count the landmarks of each frame that are marked (F,).

        Args:
            mask: a mark for each landmark (N,)
        """
        if self.even:
            return np.asarray(mask.reshape(len(self.count), self.widest).sum(axis=1))
        return np.bincount(self.frame[mask], minlength=len(self.count))

    def distinct(self, values: Ints, used: Bools) -> Ints:
        """Count the different values in each frame (F,).

        Args:
            values: whole numbers, as landmark numbers (N,)
            used: which of them count (N,)
        """
        if self.even:
            shape = len(self.count), self.widest
            return distinct_in_rows(values.reshape(shape), used.reshape(shape))
        frame, value = self.frame[used], values[used]
        order = np.lexsort((value, frame))
        frame, value = frame[order], value[order]
        new = np.ones(len(frame), bool)
        new[1:] = (np.diff(frame) != 0) | (np.diff(value) != 0)
        return np.bincount(frame[new], minlength=len(self.count))

    def padded(self, values: Any, empty: float = 0) -> Any:
        """Arrange values by frame and landmark (F, L, ...).

        Where all frames have L landmarks, that is a view of `values`; elsewhere it is a
        new array that cannot be written to.

        Args:
            values: one for each landmark (N, ...)
            empty: stands where a frame has no landmark
        """
        shape = len(self.count), self.widest, *values.shape[1:]
        if self.even:
            return values.reshape(shape)
        arranged = np.full(shape, empty, values.dtype)
        arranged[self.present] = values
        arranged.flags.writeable = False
        return arranged

    def flat(self, arranged: Any) -> Any:
        """Flatten an array by frame and landmark (F, L, ...) to the values (N, ...)."""
        if self.even:
            return np.reshape(arranged, (self.total, *arranged.shape[2:]))
        return arranged[self.present]

    def blocks(self, most: int | None = None) -> list[Ints]:
        """Divide the frames into blocks that have like numbers of landmarks: their indices.

        An array of the frames of a block by the largest count of the block has at most twice
        as many elements as there are landmarks, or `FEW` more.

        Args:
            most: how many elements such an array may have; a frame is never divided
        """
        frames = np.arange(len(self.count))
        blocks = [frames]
        if len(frames) * self.widest > max(2 * self.total, self.total + FEW):
            size = np.frexp(self.count)[1]  # of counts from 2**(size - 1) to 2**size - 1
            blocks = [np.flatnonzero(size == one) for one in np.unique(size)]
        if most is None:
            return blocks
        parts = []
        for block in blocks:
            step = max(most // max(int(self.count[block].max(initial=0)), 1), 1)
            parts += [block[k : k + step] for k in range(0, len(block), step)]
        return parts

    def runs(self, together: int, most: int) -> list[list[Ints]]:
        """Divide the frames into runs of consecutive frames, and each run into `blocks`."""
        run = np.cumsum(self.count + 1) // together
        frames = np.arange(len(self.count))
        return [
            [some[block] for block in self.only(some).blocks(most)]
            for some in np.split(frames, np.flatnonzero(np.diff(run)) + 1)
        ]
