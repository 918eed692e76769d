"""From a project file to an estimate, with what is doubtful in it: the way in for every command."""

from __future__ import annotations

from os import PathLike
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.findings import Finding, VopdError
from vopd.flight.flight import Flight
from vopd.flight.flight_estimates import FlightEstimates
from vopd.flight.read import read_flight
from vopd.flight.result import FlightResult
from vopd.flight.solved_flight import SolvedFlight, solve
from vopd.geometry.lenses import UNSEEN_MEANING, Unseen, project

BLUNDER = 4.0  # standard deviations of a pick, by the others: fewer are no blunder
DROP_PASSES = 3  # of a frame's landmarks, one after the other, with blunders = "drop"
KEPT = 'it is used; [solve] blunders = "drop" leaves it out'


def solve_flight(name: str | PathLike[str], location: str | None = None) -> FlightResult:
    """Find the attitude of every frame of a flight project.

    Nothing is printed: what is doubtful is in the `findings` of the result.

    Args:
        name: the path of the project file, `flight.toml` (docs/flight-project.md)
        location: where the file is, if not under its name

    Returns:
        The angles of all frames, what was read, and the findings; `to_dataframe()` has the
        table with uncertainty and flags.

    Raises:
        VopdError: where a file cannot be read, or no frame has two landmarks
    """
    return solve_flight_read(read_flight(str(name), location))


@np.errstate(all="ignore")
def solve_flight_read(flight: Flight) -> FlightResult:
    """Find the attitude of every frame of a flight whose project has been read.

    Args:
        flight: what the project holds

    Raises:
        VopdError: where no frame has two landmarks
    """
    _enough(flight)
    dropped = np.zeros(len(flight.picks.frame), bool)
    findings: list[Finding] = []
    solved = solve(flight)
    for left in range(DROP_PASSES * flight.options.drop_blunders, -1, -1):
        estimates = FlightEstimates(solved)
        blunders = _blunders(flight, estimates)
        findings += _told(flight, blunders, left > 0)
        if not left or not blunders.off_px.size:
            break
        dropped[blunders.pick] = True
        solved = solve(flight, dropped, before=solved)
    told = [*flight.findings, *findings, *_set_aside(flight, solved), *_unsolved(flight, solved)]
    return FlightResult(estimates, tuple(told))


def frame_label(flight: Flight, k: int) -> str:
    """What to call a frame: its image's name, or its number."""
    return flight.image_name[k] if flight.image_name else f"frame {flight.frame[k]}"


def _enough(flight: Flight) -> None:
    """Refuse a flight in which no frame has two landmarks."""
    used = np.array(flight.landmarks.used or (True,) * len(flight.landmarks.name), dtype=bool)
    takes_part = used[flight.picks.landmark]
    count = np.bincount(flight.picks.frame[takes_part], minlength=len(flight.frame))
    if count.max(initial=0) < 2:
        raise VopdError(
            f"{flight.source}: no frame has two landmarks (frames: {len(count)}, one at most in "
            "each). One landmark gives the direction of its line of sight alone: the turn about "
            "it stays free, so that of three angles two are tied together and none is known by "
            "itself. Pick a second landmark in each image, the farther from the first the better."
        )


class _Blunders(NamedTuple):
    """Picks that do not fit the others of their frames, one a frame at most."""

    pick: Ints  # (B,) indices
    off_px: Floats  # (B,) from where the others have their landmark


def _blunders(flight: Flight, estimates: FlightEstimates) -> _Blunders:
    """Picks that fail the test for outliers and are off by more than picks can be."""
    misfit = estimates.outliers()
    if not misfit.any():
        return _Blunders(np.flatnonzero(misfit), np.zeros(0))
    some = estimates.blocks.part(np.unique(flight.picks.frame[misfit]))
    these = misfit[some.picks]
    off = _off_px(solve(some.flight, these | ~estimates.solved.used[some.picks]))[these]
    pick = some.picks[these]
    far = ~(off <= BLUNDER * flight.picks.sigma_px[pick])
    return _Blunders(pick[far], off[far])


def _told(flight: Flight, blunders: _Blunders, dropped: bool) -> list[Finding]:
    """Each blunder with how far it is off."""
    tell = []
    for k, off in zip(blunders.pick, blunders.off_px, strict=True):
        name = flight.landmarks.name[flight.picks.landmark[k]]
        label = frame_label(flight, int(flight.picks.frame[k]))
        done = "it is left out" if dropped else KEPT
        message = f"{label}: {name} does not fit the others, it is {off:.1f} px off; {done}"
        tell.append(Finding(message, flight.source, severity="warning"))
    return tell


def _off_px(solved: SolvedFlight) -> Floats:
    """How far each pick is from its landmark's image, (P,)."""
    flight = solved.flight
    rotation = solved.attitudes.rotation[flight.picks.frame]
    ray = np.einsum("pij,pj->pi", rotation, solved.lines.direction)
    away = flight.picks.pixel - project(flight.lens, ray).pixel
    return np.asarray(np.hypot(*away.T))


def _set_aside(flight: Flight, solved: SolvedFlight) -> list[Finding]:
    tell = []
    for k in np.flatnonzero(solved.attitudes.set_aside):
        name = flight.landmarks.name[flight.picks.landmark[k]]
        label = frame_label(flight, int(flight.picks.frame[k]))
        why = UNSEEN_MEANING[Unseen(int(solved.attitudes.set_aside[k]))]
        message = f"{label}: {name} {why} as the others have it; its pick is not used"
        tell.append(Finding(message, flight.source, severity="warning"))
    return tell


def _unsolved(flight: Flight, solved: SolvedFlight) -> list[Finding]:
    """Frames without an attitude, by reason."""
    lost = np.isnan(solved.attitudes.rotation[:, 0, 0]) & np.isfinite(flight.path.position_m[:, 0])
    picked = np.bincount(flight.picks.frame, minlength=len(flight.frame))
    reasons = (
        (lost & (picked < 2), "fewer than two landmarks: two of three angles at most, no attitude"),
        (lost & (picked >= 2), "its landmarks lie on one line of sight, or too few can be used"),
    )
    tell = []
    for which, why in reasons:
        labels = [frame_label(flight, int(k)) for k in np.flatnonzero(which)]
        if labels:
            named = ", ".join(labels[:5]) + (f" and {len(labels) - 5} more" * (len(labels) > 5))
            tell.append(Finding(f"{named}: {why}", flight.source, severity="warning"))
    return tell
