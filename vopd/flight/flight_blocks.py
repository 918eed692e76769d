"""A flight in blocks of frames: work arrays grow neither with it nor with one long frame."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, replace
from typing import Any, NamedTuple

import numpy as np

from vopd.arrays import Bools, Ints
from vopd.flight.flight import CameraPath, Flight
from vopd.landmark_layout import AT_ONCE, TOGETHER, LandmarkLayout


class FlightPart(NamedTuple):
    """Some frames of a flight as a flight of their own."""

    frames: Ints  # their indices (B,)
    picks: Ints  # the indices of their picks
    flight: Flight


class FlightBlocks:
    """The frames of a flight in blocks that have like numbers of picks.

    Attributes:
        flight: the flight
        layout: how many picks each frame has
    """

    def __init__(self, flight: Flight) -> None:
        self.flight = flight
        self.layout = LandmarkLayout(
            np.bincount(flight.picks.frame, minlength=len(flight.frame)).astype(np.int64)
        )
        frame = flight.picks.frame
        in_order = bool((frame[1:] >= frame[:-1]).all())
        self._order = None if in_order else np.argsort(frame, kind="stable")

    def __iter__(self) -> Iterator[FlightPart]:
        runs = self.layout.runs(TOGETHER, AT_ONCE)
        return (self.part(frames) for blocks in runs for frames in blocks)

    def parts(self, chosen: Bools) -> Iterator[FlightPart]:
        """The blocks with the chosen frames alone, without those that have none.

        Args:
            chosen: (F,)
        """
        for frames in self.layout.blocks(AT_ONCE):
            if chosen[frames].any():
                yield self.part(frames[chosen[frames]])

    def part(self, frames: Ints) -> FlightPart:
        """Some of the frames.

        Args:
            frames: their indices, each once
        """
        flight = self.flight
        rows = self.layout.rows(frames)
        if self._order is not None:
            rows = self._order[rows]
        if len(frames) == len(flight.frame):
            return FlightPart(frames, np.arange(len(flight.picks.frame)), flight)
        grid = flight.grid
        if grid is not None:
            grid = grid._replace(
                easting=grid.easting[frames],
                northing=grid.northing[frames],
                convergence_deg=grid.convergence_deg[frames],
            )
        picks = replace(
            flight.picks,
            frame=np.repeat(np.arange(len(frames)), self.layout.count[frames]),
            landmark=flight.picks.landmark[rows],
            pixel=flight.picks.pixel[rows],
            sigma_px=flight.picks.sigma_px[rows],
        )
        part = replace(
            flight,
            frame=flight.frame[frames],
            image_name=tuple(flight.image_name[k] for k in frames) if flight.image_name else (),
            time_s=flight.time_s[frames],
            picks=picks,
            path=_path_part(flight.path, frames),
            grid=grid,
        )
        return FlightPart(frames, rows, part)


def _path_part(path: CameraPath, frames: Ints) -> CameraPath:
    """The path in some frames: its arrays with two axes are by frame."""
    values: dict[str, Any] = {field.name: getattr(path, field.name) for field in fields(path)}
    by_frame = {name: v[frames] for name, v in values.items() if np.ndim(v) == 2}
    return replace(path, **by_frame)
