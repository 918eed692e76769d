"""From a project file to an estimate, with what is doubtful in it: the way in for every command."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.attitude.outliers import outliers
from vopd.estimate import Estimate
from vopd.findings import Finding, VopdError
from vopd.flight.estimate import flight_estimate
from vopd.flight.flight import Flight
from vopd.flight.frame_slots import FrameSlots
from vopd.flight.read_flight import read_flight
from vopd.flight.solved_flight import SolvedFlight, solve
from vopd.geometry.lens_model import UNSEEN_MEANING, Unseen, project

DROP_PASSES = 3  # of a frame's landmarks, one after the other, with blunders = "drop"
KEPT = 'it is used; [solve] blunders = "drop" leaves it out'


class FlightResult(NamedTuple):
    """A flight that has been solved."""

    flight: Flight
    estimate: Estimate
    findings: tuple[Finding, ...]


def solve_flight(name: str) -> FlightResult:
    """Read a project, solve all its frames, and say what is doubtful.

    Args:
        name: the path of the project file

    Raises:
        VopdError: where it cannot be read, or no frame has two landmarks
    """
    flight = read_flight(name)
    _enough(flight)
    dropped = np.zeros(len(flight.picks.frame), bool)
    solved = solve(flight)
    estimate = flight_estimate(flight, solved)
    misfit = _misfit(flight, estimate)
    findings = _blunders(flight, solved, misfit, flight.options.drop_blunders)
    for _ in range(DROP_PASSES * flight.options.drop_blunders):
        if not misfit.any():
            break
        dropped |= misfit
        solved = solve(flight, dropped)
        estimate = flight_estimate(flight, solved)
        misfit = _misfit(flight, estimate)
        findings += _blunders(flight, solved, misfit, True)
    told = [*flight.findings, *findings, *_set_aside(flight, solved), *_unsolved(flight, estimate)]
    return FlightResult(flight, estimate, tuple(told))


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
            f"{flight.source}: no frame has two landmarks ({len(count)} frames, one at most in "
            "each). One landmark gives the direction of its line of sight alone: the turn about "
            "it stays free, so that of three angles two are tied together and none is known by "
            "itself. Pick a second landmark in each image, the farther from the first the better."
        )


def _misfit(flight: Flight, estimate: Estimate) -> Bools:
    """The picks that do not fit the others of their frames, (P,), one a frame at most."""
    slots = FrameSlots.of(flight.picks.frame, len(flight.frame))
    return np.asarray(outliers(estimate)[slots.frame, slots.slot])


def _blunders(flight: Flight, solved: SolvedFlight, misfit: Bools, dropped: bool) -> list[Finding]:
    """Each pick that does not fit, with how far it is off in an attitude without it."""
    if not misfit.any():
        return []
    off = _off_px(flight, solve(flight, ~solved.used | misfit))
    tell = []
    for k in np.flatnonzero(misfit):
        name = flight.landmarks.name[flight.picks.landmark[k]]
        label = frame_label(flight, int(flight.picks.frame[k]))
        done = (
            "it is left out" if dropped else 'it is used; [solve] blunders = "drop" leaves it out'
        )
        message = f"{label}: {name} does not fit the others, it is {off[k]:.1f} px off; {done}"
        tell.append(Finding(message, flight.source, severity="warning"))
    return tell


def _off_px(flight: Flight, solved: SolvedFlight) -> Floats:
    """How far each pick is from its landmark's image, (P,)."""
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


def _unsolved(flight: Flight, estimate: Estimate) -> list[Finding]:
    """Frames without an attitude, by reason."""
    lost = np.isnan(estimate.camera_deg[:, 0]) & np.isfinite(flight.path.position_m[:, 0])
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
