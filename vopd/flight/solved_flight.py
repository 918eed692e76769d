"""Solve a flight: rotations of all frames from their picks, with the lever arm iterated."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.flight.flight import Flight
from vopd.flight.sight_lines import SightLines, sight_lines
from vopd.flight.solve import PASSES, Attitudes, solve_rotations

IMAGE_FROM_CAMERA = np.diag([-1.0, -1.0, 1.0])
"""An estimate's image axes, left, up and forward, from right, down and forward."""
LEVER_PASSES = 4  # an arm of a metre at 20 m range converges by a factor of 20 each


class SolvedFlight(NamedTuple):
    """A flight's rotations, with the lines of sight that they were solved from."""

    camera_m: Floats  # (F, 3) Earth-centred, the lever arm applied
    lines: SightLines
    attitudes: Attitudes
    used: Bools  # (P,) picks that were to take part


def solve(flight: Flight, left_out: Bools | None = None, passes: int = PASSES) -> SolvedFlight:
    """Solve all frames of a flight at once.

    Args:
        flight: the flight
        left_out: picks that take no part besides those of check landmarks, (P,)
        passes: after how many a frame is left as it is
    """
    takes_part = np.array(flight.landmarks.used or (True,) * len(flight.landmarks.name))
    used = takes_part[flight.picks.landmark]
    if left_out is not None:
        used &= ~left_out
    arm = flight.path.lever_arm_m
    solved = _solve_at(flight, flight.path.position_m, used, passes)
    if arm is None or not np.any(arm):
        return solved
    for _ in range(LEVER_PASSES):
        to_local = solved.attitudes.rotation.swapaxes(1, 2) @ flight.mount.T
        away = np.einsum("fji,fjk,k->fi", solved.lines.axes, to_local, arm)
        solved = _solve_at(flight, flight.path.position_m + away, used, passes)
    return solved


def _solve_at(flight: Flight, camera_m: Floats, used: Bools, passes: int) -> SolvedFlight:
    picks = flight.picks
    lines = sight_lines(
        camera_m, flight.landmarks.position_m, picks.frame, picks.landmark, flight.refraction
    )
    attitudes = solve_rotations(
        flight.lens,
        len(flight.frame),
        picks.frame,
        picks.pixel,
        picks.sigma_px,
        lines.direction,
        used,
        flight.options.loss,
        passes,
    )
    return SolvedFlight(camera_m, lines, attitudes, used)
