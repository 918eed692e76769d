"""A flight without one usual mistake, for each mistake: the residuals that it would have."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from vopd.arrays import Floats
from vopd.estimate import Estimate
from vopd.findings import VopdError
from vopd.flight.flight import Flight
from vopd.flight.mistakes import another_focal_length, another_level, another_offset
from vopd.flight.project import Project
from vopd.flight.read import flight_of
from vopd.flight.track import height_datum
from vopd.flight.trial_residuals import MistakeTrial, freedom, solved_trial, some_frames, typical_px
from vopd.geometry.earth import earth_centred_m, geodetic

M_PER_FT = 0.3048
GPS_AHEAD_S = 18.0
LEAST_FREEDOM = 4  # more residuals than angles: with fewer, one number explains nearly all
TRIAL_PICKS = 100_000  # of all landmarks together that are left out one by one


def trials(project: Project, flight: Flight, estimate: Estimate) -> Iterator[MistakeTrial]:
    """The flight without each mistake, those that say most exactly what is wrong first.

    Args:
        project: the project, which is read anew with another clock
        flight: what it holds, some of its frames where there are many
        estimate: its solution
    """
    if freedom(estimate) < LEAST_FREEDOM:
        return
    yield from _upward(project, flight)
    yield from _feet(project, flight)
    yield from _clocks(project)
    yield from another_level(flight, estimate)
    yield from another_offset(project, flight, estimate)
    yield from another_focal_length(flight, estimate)
    yield from _landmarks(flight)


def _upward(project: Project, flight: Flight) -> Iterator[MistakeTrial]:
    """Pixels whose v counts the other way than the project says."""
    upward = flight.picks.pixel * [1.0, -1.0] + [0.0, flight.lens.size_px[1] - 1.0]
    flipped = replace(flight, picks=replace(flight.picks, pixel=upward))
    up = project.section("picks").text("v", default="down") == "up"
    way, key = ("downward", "down") if up else ("upward", "up")
    yield MistakeTrial(_typical_of(flipped), f'with v counted {way}: give [picks] v = "{key}"?')


def _feet(project: Project, flight: Flight) -> Iterator[MistakeTrial]:
    """Heights in feet that were taken for metres, of landmarks, of the camera, or of both."""
    where = "track" if project.has("track") else "position"
    marks = _from_feet(project, "landmarks", flight.landmarks.position_m)
    camera = _from_feet(project, where, flight.path.position_m)
    lower = replace(flight, landmarks=replace(flight.landmarks, position_m=marks))
    path = replace(flight.path, position_m=camera)
    for changed, whose in (
        (lower, "the landmarks'"),
        (replace(flight, path=path), "the camera's"),
        (replace(lower, path=path), "all"),
    ):
        yield MistakeTrial(
            _typical_of(changed), f"with {whose} heights taken for feet: are they in feet?"
        )


def _from_feet(project: Project, section: str, position_m: Floats) -> Floats:
    """Positions whose heights, as the file has them, are feet."""
    datum = height_datum(project.section(section))
    geoid = 0.0 if datum is None else datum.undulation_m
    where = geodetic(position_m)
    height = (where.height_m - geoid) * M_PER_FT + geoid
    return earth_centred_m(where.latitude_deg, where.longitude_deg, height)


def _clocks(project: Project) -> Iterator[MistakeTrial]:
    """GPS time that was taken for UTC, and the other way round."""
    if not project.has("track"):
        return
    offset = project.section("track").number("offset_s", 0.0)
    for shift, clock in ((-GPS_AHEAD_S, "GPS time"), (GPS_AHEAD_S, "UTC and not GPS time")):
        try:
            shifted = some_frames(flight_of(project.changed("track", "offset_s", offset + shift)))
        except VopdError:
            continue
        if shifted.path.velocity_m_s is None:
            return
        message = f"with the track {shift:+.0f} s: is its clock {clock}?"
        yield MistakeTrial(_typical_of(shifted), message)


def _landmarks(flight: Flight) -> Iterator[MistakeTrial]:
    """One landmark with wrong coordinates, or under the name of another, in all frames."""
    marks = flight.landmarks
    used = np.array(marks.used or (True,) * len(marks.name), dtype=bool)
    picked = np.bincount(flight.picks.landmark, minlength=len(used)) > 0
    several = np.flatnonzero(used & picked)
    if len(several) * len(flight.picks.frame) > TRIAL_PICKS:
        return
    for k in several:
        left = used & (np.arange(len(used)) != k)
        changed = replace(flight, landmarks=replace(marks, used=tuple(left.tolist())))
        estimate = solved_trial(changed)
        if freedom(estimate) >= LEAST_FREEDOM:
            name = marks.name[k]
            message = f"without {name}: are its coordinates and its name right?"
            yield MistakeTrial(typical_px(changed, estimate), message)


def _typical_of(flight: Flight) -> float:
    return typical_px(flight, solved_trial(flight))
