"""Mistakes that make the residuals of a flight large, found by solving it without them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.estimate import Estimate
from vopd.findings import VopdError
from vopd.flight.camera_path import height_datum
from vopd.flight.estimate import flight_estimate
from vopd.flight.flight import CameraPath, Flight, Picks
from vopd.flight.flight_result import FlightResult
from vopd.flight.project_file import Project
from vopd.flight.read_flight import flight_of
from vopd.flight.solve_project import frame_label
from vopd.flight.solved_flight import solve
from vopd.geometry.geodetic import earth_centred_m, geodetic

BETTER = 5.0  # a mistake is named where the residuals are so many times smaller without it
MISFIT = 5.0  # in standard deviations of a pick: from there on a frame is searched
UNSEEN_PX = 1000.0  # what a pick counts whose landmark would have no image
LEAST_HEIGHT_M, MOST_HEIGHT_M = 5.0, 130.0  # of a geoid above the ellipsoid, and some metres
M_PER_FT = 0.3048
GPS_AHEAD_S = 18.0
SEARCHED = 50  # frames for exchanged landmarks
SEARCHED_PICKS = 100_000  # of all pairs together
TRIAL_PASSES = 20  # which are enough where a trial explains the residuals


class _Trial(NamedTuple):
    """A flight without one mistake: the residuals it would have, and what to say."""

    rms_px: float
    message: str


@np.errstate(all="ignore")
def usual_mistakes(project: Project, result: FlightResult) -> Iterator[str]:
    """What explains large residuals: of all mistakes that are tried the one that fits best.

    Args:
        project: the project, which is read anew with another clock
        result: its solution
    """
    flight, estimate = result.flight, result.estimate
    sigma = float(np.median(flight.picks.sigma_px))
    before = _rms(flight, estimate)
    if not before > MISFIT * sigma:
        return
    trials = [
        *_upward(flight),
        *_feet(project, flight),
        *_clocks(project),
        *_level(flight, estimate),
    ]
    best = min(trials, key=lambda one: one.rms_px)
    if best.rms_px < before / BETTER:
        yield f"residuals are {before:.1f} px, and {best.rms_px:.1f} px {best.message}"
        return
    yield from _exchanged(flight, estimate, MISFIT * sigma)


def _rms(flight: Flight, estimate: Estimate) -> float:
    """Of all picks that should take part, those without an image included.

    Frames without a position, or with one pick, have no attitude whatever is mistaken.
    """
    used = np.array(flight.landmarks.used or (True,) * len(flight.landmarks.name), dtype=bool)
    frame = flight.picks.frame
    here = used[flight.picks.landmark] & np.isfinite(flight.path.position_m[frame, 0])
    several = np.bincount(frame[here], minlength=len(flight.frame)) >= 2
    count = max(int((here & several[frame]).sum()), 1)
    missing = count - int(estimate.used.sum())
    squares = (estimate.residual**2).sum() + missing * UNSEEN_PX**2
    return float(np.sqrt(squares / (2.0 * count)))


def _rms_of(flight: Flight) -> float:
    return _rms(flight, flight_estimate(solve(flight, passes=TRIAL_PASSES)))


def _upward(flight: Flight) -> Iterator[_Trial]:
    upward = flight.picks.pixel * [1.0, -1.0] + [0.0, flight.lens.size_px[1] - 1.0]
    flipped = replace(flight, picks=replace(flight.picks, pixel=upward))
    yield _Trial(_rms_of(flipped), 'with v counted upward: give [picks] v = "up"?')


def _feet(project: Project, flight: Flight) -> Iterator[_Trial]:
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
        yield _Trial(_rms_of(changed), f"with {whose} heights taken for feet: are they in feet?")


def _from_feet(project: Project, section: str, position_m: Floats) -> Floats:
    """Positions whose heights, as the file has them, are feet."""
    datum = height_datum(project.section(section))
    geoid = 0.0 if datum is None else datum.undulation_m
    where = geodetic(position_m)
    height = (where.height_m - geoid) * M_PER_FT + geoid
    return earth_centred_m(where.latitude_deg, where.longitude_deg, height)


def _clocks(project: Project) -> Iterator[_Trial]:
    """GPS time that was taken for UTC, and the other way round."""
    if not project.has("track"):
        return
    offset = project.section("track").number("offset_s", 0.0)
    for shift, clock in ((-GPS_AHEAD_S, "GPS time"), (GPS_AHEAD_S, "UTC and not GPS time")):
        try:
            shifted = flight_of(project.changed("track", "offset_s", offset + shift))
        except VopdError:
            continue
        if shifted.path.velocity_m_s is None:
            return
        message = f"with the track {shift:+.0f} s: is its clock {clock}?"
        yield _Trial(_rms_of(shifted), message)


def other_clock(project: Project) -> str:
    """A hint for a track that covers no frame, if it does by another clock; else nothing."""
    if not project.has("track"):
        return ""
    offset = project.section("track").values.get("offset_s", 0.0)
    for shift in (-GPS_AHEAD_S, GPS_AHEAD_S):
        if isinstance(offset, int | float):
            try:
                flight_of(project.changed("track", "offset_s", offset + shift))
            except VopdError:
                continue
            return f"; with the track {shift:+.0f} s, as GPS time is ahead of UTC, it does"
    return ""


def _level(flight: Flight, estimate: Estimate) -> Iterator[_Trial]:
    """All landmarks higher or lower, as those of another height datum are."""
    height_m, after = _common_height(estimate)
    if LEAST_HEIGHT_M < abs(height_m) < MOST_HEIGHT_M:
        yield _Trial(
            after,
            f"with all landmarks {height_m:+.0f} m: are the heights of camera and landmarks "
            "counted from the same level? A geoid is up to 100 m from the ellipsoid",
        )


def _common_height(estimate: Estimate) -> tuple[float, float]:
    """The shift of all landmarks that fits best, metres, and the residuals with it."""
    up = estimate.responses.landmark[..., 2]
    left = np.isfinite(estimate.gain).all(axis=(1, 2))
    partials, gain = estimate.partials[left], estimate.gain[left]
    response = up[left] - (partials @ (gain @ up[left][..., None]))[..., 0]
    residual = estimate.residual[left]
    # residuals change by the response: the shift that takes most of them away
    shift = float(-(response * residual).sum() / (response**2).sum())
    remaining = residual + shift * response
    return shift, float(np.sqrt((remaining**2).sum() / (2.0 * estimate.used[left].sum())))


def _exchanged(flight: Flight, estimate: Estimate, misfit_px: float) -> Iterator[str]:
    """Frames in which two landmarks were taken for each other."""
    squares = (estimate.residual**2).sum(axis=1) / (2.0 * estimate.used.sum(axis=1))
    tried = 0
    for frame in np.flatnonzero(np.sqrt(squares) > misfit_px)[:SEARCHED]:
        rows = np.flatnonzero(flight.picks.frame == frame)
        tried += len(rows) ** 2 * (len(rows) - 1) // 2
        if len(rows) < 3 or tried > SEARCHED_PICKS:
            continue
        pairs = list(combinations(range(len(rows)), 2))
        trial = _trials(flight, rows, int(frame), pairs)
        result = flight_estimate(solve(trial, passes=TRIAL_PASSES))
        after = (result.residual**2).sum(axis=1) / (2.0 * result.used.sum(axis=1))
        after = np.where(np.isfinite(result.camera_deg[:, 0]), after, np.inf)
        best = int(after.argmin())
        if after[best] < squares[frame] / BETTER**2:
            one, other = (
                flight.landmarks.name[flight.picks.landmark[rows[k]]] for k in pairs[best]
            )
            yield (
                f"{frame_label(flight, int(frame))}: {one} and {other} exchanged? Residuals are "
                f"{np.sqrt(squares[frame]):.1f} px, and {np.sqrt(after[best]):.1f} px if they are"
            )


def _trials(flight: Flight, rows: np.ndarray, frame: int, pairs: list[tuple[int, int]]) -> Flight:
    """A flight with a frame for every pair of landmarks of one frame, the two exchanged."""
    count = len(pairs)
    landmark = np.tile(flight.picks.landmark[rows], (count, 1))
    for k, (one, other) in enumerate(pairs):
        landmark[k, [one, other]] = landmark[k, [other, one]]
    picks = Picks(
        np.repeat(np.arange(count), len(rows)),
        landmark.ravel(),
        np.tile(flight.picks.pixel[rows], (count, 1)),
        np.tile(flight.picks.sigma_px[rows], count),
    )
    return replace(
        flight,
        frame=np.arange(count),
        image_name=(),
        time_s=np.full(count, np.nan),
        picks=picks,
        path=CameraPath(np.tile(flight.path.position_m[frame], (count, 1)), flight.path.sigma_m),
    )
