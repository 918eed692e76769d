"""Solve a flight: rotations of all frames from their picks, with the lever arm iterated."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.flight.flight import Flight
from vopd.flight.flight_blocks import FlightBlocks, FlightPart
from vopd.flight.sight_lines import SightLines, sight_lines
from vopd.flight.solve import PASSES, Attitudes, no_attitudes, solve_rotations

IMAGE_FROM_CAMERA = np.diag([-1.0, -1.0, 1.0])
"""An estimate's image axes, left, up and forward, from right, down and forward."""
LEVER_PASSES = 4  # an arm of a metre at 20 m range converges by a factor of 20 each


@dataclass(frozen=True, eq=False)
class SolvedFlight:
    """A flight's rotations, or those of some of its frames."""

    flight: Flight
    camera_m: Floats  # (F, 3) Earth-centred, the lever arm applied
    attitudes: Attitudes
    used: Bools  # (P,) picks that were to take part
    raised_most_rad: float  # by refraction, of all lines of sight; NaN where there is none

    @cached_property
    def lines(self) -> SightLines:
        """The lines of sight that the rotations were solved from."""
        return _lines(self.flight, self.camera_m)

    def part(self, part: FlightPart) -> SolvedFlight:
        """The same for some of the frames."""
        if part.flight is self.flight:
            return self
        attitudes, frames, picks = self.attitudes, part.frames, part.picks
        return SolvedFlight(
            part.flight,
            self.camera_m[frames],
            Attitudes(
                attitudes.rotation[frames],
                attitudes.correction_rad[frames],
                attitudes.converged[frames],
                attitudes.weight[picks],
                attitudes.set_aside[picks],
            ),
            self.used[picks],
            self.raised_most_rad,
        )


def solve(
    flight: Flight,
    left_out: Bools | None = None,
    passes: int = PASSES,
    before: SolvedFlight | None = None,
) -> SolvedFlight:
    """Solve all frames of a flight.

    Args:
        flight: the flight
        left_out: picks that take no part besides those of check landmarks, (P,)
        passes: after how many a frame is left as it is
        before: the flight solved with other picks left out; frames with the same picks are not
            solved again
    """
    takes_part = np.array(flight.landmarks.used or (True,) * len(flight.landmarks.name))
    used = takes_part[flight.picks.landmark]
    if left_out is not None:
        used &= ~left_out
    changed = np.ones(len(flight.frame), bool)
    if before is None:
        camera_m = flight.path.position_m.copy()
        attitudes, raised = no_attitudes(len(flight.frame), len(used)), np.nan
    else:
        camera_m, raised = before.camera_m.copy(), before.raised_most_rad
        attitudes = deepcopy(before.attitudes)
        changed[:] = False
        changed[flight.picks.frame[used != before.used]] = True
    for part in FlightBlocks(flight).parts(changed):
        at, found, lines = _solve_part(part.flight, used[part.picks], passes, len(used))
        camera_m[part.frames] = at
        attitudes.put(part.frames, part.picks, found)
        raised = np.fmax(raised, np.fmax.reduce(lines.raised_rad, initial=np.nan))
    return SolvedFlight(flight, camera_m, attitudes, used, float(raised))


def _solve_part(
    flight: Flight, used: Bools, passes: int, picks: int
) -> tuple[Floats, Attitudes, SightLines]:
    """Position, attitudes and lines of sight of some frames of a flight of so many picks."""
    camera_m = flight.path.position_m
    arm = np.zeros(3) if flight.path.lever_arm_m is None else flight.path.lever_arm_m
    for left in range(LEVER_PASSES * bool(arm.any()), -1, -1):
        lines = _lines(flight, camera_m)
        attitudes = solve_rotations(
            flight.lens,
            len(flight.frame),
            flight.picks.frame,
            flight.picks.pixel,
            flight.picks.sigma_px,
            lines.direction,
            used,
            flight.options.loss,
            passes,
            picks,
        )
        if left:
            to_local = attitudes.rotation.swapaxes(1, 2) @ flight.mount.T
            away = np.einsum("fji,fjk,k->fi", lines.axes, to_local, arm)
            camera_m = flight.path.position_m + away
    return camera_m, attitudes, lines


def _lines(flight: Flight, camera_m: Floats) -> SightLines:
    marks, picks = flight.landmarks.position_m, flight.picks
    return sight_lines(camera_m, marks, picks.frame, picks.landmark, flight.refraction)
