"""The estimates of the frames of a solved flight, made when they are asked for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from vopd.arrays import Bools, Ints
from vopd.attitude.outliers import outliers
from vopd.estimate import Estimate
from vopd.flight.estimate import flight_estimate, whole_flight
from vopd.flight.flight import Flight
from vopd.flight.flight_blocks import FlightBlocks, FlightPart
from vopd.flight.frame_slots import FrameSlots
from vopd.flight.solved_flight import SolvedFlight
from vopd.landmark_layout import LandmarkLayout

MOST_KEPT = 100_000  # picks of a flight whose estimates are kept, about 500 bytes each


class FlightEstimates:
    """The estimates of a flight by its frames.

    Attributes:
        solved: the flight and its rotations
        blocks: its frames
    """

    def __init__(self, solved: SolvedFlight) -> None:
        self.solved = solved
        self.blocks = FlightBlocks(solved.flight)
        self._whole = whole_flight(solved)
        self._made: dict[bytes, Estimate] = {}
        self._outlier: Bools | None = None  # (P,)

    @property
    def flight(self) -> Flight:
        """What was given."""
        return self.solved.flight

    @property
    def layout(self) -> LandmarkLayout:
        """How many picks each frame has."""
        return self.blocks.layout

    def of(self, frames: Ints) -> Estimate:
        """The estimate of some frames.

        Args:
            frames: their indices
        """
        key = frames.tobytes()
        made = self._made.get(key)
        if made is None:
            part = self.blocks.part(frames)
            made = flight_estimate(self.solved.part(part), self._whole)
            if self._outlier is not None:
                slots = _slots(part)
                made = replace(made, outlier=slots.spread(self._outlier[part.picks]))
            if self.layout.total <= MOST_KEPT:
                self._made[key] = made
        return made

    def outliers(self) -> Bools:
        """The picks that do not fit the others of their frames, at most one in each, (P,).

        Estimates that are made later have them too.
        """
        found = np.zeros(len(self.flight.picks.frame), bool)
        for part in self.blocks:
            estimate, slots = self.of(part.frames), _slots(part)
            marked = outliers(estimate)
            found[part.picks] = marked[slots.frame, slots.slot]
            if part.frames.tobytes() in self._made:
                self._made[part.frames.tobytes()] = replace(estimate, outlier=marked)
        self._outlier = found
        return found

    def __iter__(self) -> Iterator[Estimate]:
        return (self.of(part.frames) for part in self.blocks)

    def whole(self) -> Estimate:
        """The estimate of all frames."""
        return self.of(np.arange(len(self.flight.frame)))


def _slots(part: FlightPart) -> FrameSlots:
    return FrameSlots.of(part.flight.picks.frame, len(part.frames))
