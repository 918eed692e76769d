"""Checks of a flight project: errors in its files, and mistakes that its residuals reveal."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from vopd.attitude.findings import findings_of
from vopd.attitude.history import HistoryOptions
from vopd.findings import Finding, VopdError, finding_of, findings_in, first_of
from vopd.flight.flight import Flight
from vopd.flight.formats.photographs import missing_images, other_size
from vopd.flight.misfits.blunders import ARE_EXCHANGED, WRONG
from vopd.flight.misfits.far_landmarks import far_landmarks
from vopd.flight.misfits.input_errors import SPEAK_FOR
from vopd.flight.misfits.mistakes import other_clock, usual_mistakes
from vopd.flight.misfits.unsolved import picks_outside
from vopd.flight.project.keys import Project, read_project
from vopd.flight.project.read import flight_or_errors
from vopd.flight.project.terrain import read_terrain
from vopd.flight.result import solve_flight_read
from vopd.video import open_frames


@np.errstate(all="ignore")
def check_flight(name: str) -> list[Finding]:
    """Check a flight project: errors in its files, and mistakes its residuals reveal."""
    try:
        project = read_project(name)
    except VopdError as error:
        return findings_in(error, name)
    try:
        flight = flight_or_errors(project)
    except VopdError as error:
        first, *others = findings_in(error, name)
        return [replace(first, message=first.message + other_clock(project)), *others]
    far = list(far_landmarks(flight))
    found = [*flight.findings, *_warned(name, [*messages_of_files(flight), *far])]
    found += findings_of_terrain(project, flight)
    try:
        result = solve_flight_read(flight, project=None if far else lambda: project)
    except VopdError as error:
        return [*found, finding_of(error, name)]
    if not result.solved.any():
        found.append(Finding("no frame has an attitude", name))
    if far:
        return found  # a solution can tell no more
    found = [*dict.fromkeys([*found, *result.findings])]  # each once
    if result.solved.any():
        history = result.history_parts(HistoryOptions())
        told = history.summary.without_outlier  # by the finding on its pick
        rest = [one for one in history.summary.misfits if one[0] not in told]
        found += findings_of(history.about, replace(history.summary, misfits=rest))
    causes = SPEAK_FOR, WRONG, ARE_EXCHANGED
    named = any(words in one.message for one in result.findings for words in causes)
    more = [] if result.misfits else usual_mistakes(project, result.estimates, named)
    return [*found, *_warned(name, more)]


def _warned(name: str, messages: Iterable[str]) -> list[Finding]:
    return [Finding(message, name, severity="warning") for message in messages]


def findings_of_terrain(project: Project, flight: Flight) -> list[Finding]:
    """Read the terrain as `vopd track` does, which it may stop."""
    try:
        terrain = read_terrain(project)
        marks = np.unique(flight.picks.landmark)
        if terrain is None or not len(marks):
            return []
        return terrain.about(flight.landmarks, marks)[1]
    except VopdError as error:
        return [finding_of(error, project.name)]


def messages_of_files(flight: Flight) -> Iterator[str]:
    """Check landmarks, picks and a folder of numbered images without a solve."""
    if any(one.is_dir() for one in flight.video):
        try:
            frames = open_frames([str(one) for one in flight.video])
        except VopdError as error:
            yield str(error)
        else:
            if frames.missing:
                yield frames.about
    if lost := missing_images(flight):
        yield lost
    if other := other_size(flight):
        yield other
    picks, names = flight.picks, flight.landmarks.name
    never = sorted(set(range(len(names))) - set(picks.landmark.tolist()) - picks.unused)
    if never:
        yield f"never picked: {first_of([names[k] for k in never], 10)}"
    if picks.unused:
        unused = first_of([names[k] for k in sorted(picks.unused)], 10)
        yield f"picked, and none of its picks is used: {unused}"
    yield from (one.message for one in picks_outside(flight))
