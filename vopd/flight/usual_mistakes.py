"""Mistakes that make the residuals of a flight large, found by solving it without them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from vopd.arrays import Floats
from vopd.attitude.mistakes import MOST_LANDMARKS, best_exchange
from vopd.estimate import Estimate
from vopd.findings import VopdError
from vopd.flight.mistake_trials import GPS_AHEAD_S, trials
from vopd.flight.project import Project
from vopd.flight.read import flight_of
from vopd.flight.result import FlightResult
from vopd.flight.solve_project import frame_label
from vopd.flight.trial_residuals import solved_trial, some_frames, typical_px

DOUBTED = 2.0  # in standard deviations of a pick: from there on mistakes are tried
BETTER = 5.0  # a mistake is named where the residuals are so many times smaller without it
ALIKE = 1.3  # residuals of trials that explain a flight as well
MISFIT = 5.0  # in standard deviations of a pick: from there on a frame is searched
SEARCHED = 50  # frames for exchanged landmarks
SEARCHED_PICKS = 100_000  # of all pairs together


def usual_mistakes(project: Project, result: FlightResult) -> Iterator[str]:
    """What explains large residuals: of all mistakes that are tried the one that fits best.

    Args:
        project: the project, which is read anew with another clock
        result: its solution
    """
    sigma = float(np.median(result.flight.picks.sigma_px))
    flight = some_frames(result.flight)
    estimate = result.estimate if flight is result.flight else solved_trial(flight)
    before = typical_px(flight, estimate)
    if before > DOUBTED * sigma:
        tried = list(trials(project, flight, estimate))
        least = min((one.typical_px for one in tried), default=np.inf)
        if least < before / BETTER:
            # a number that is fitted never fits worse than the mistake that has its value
            best = next(one for one in tried if one.typical_px <= ALIKE * least)
            yield (
                f"residuals are {before:.1f} px in a typical frame, and {best.typical_px:.1f} px "
                f"{best.message}"
            )
            return
    exchanged = list(_exchanged(result, MISFIT * sigma))
    yield from exchanged
    if not exchanged and before > MISFIT * sigma:
        yield f"residuals are {before:.1f} px in a typical frame: {UNEXPLAINED}"


UNEXPLAINED = (
    "no usual mistake explains them; look at the coordinates and names of the landmarks, at the "
    "lens (of this camera, at this image size?), and at what the frames' numbers and times mean"
)


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


def _rms_of_frames(estimate: Estimate) -> Floats:
    """Root mean square of each frame's residuals (F,); NaN for a frame without any."""
    count = estimate.used.sum(axis=1)
    return np.asarray(np.sqrt((estimate.residual**2).sum(axis=1) / (2.0 * count)))


def _exchanged(result: FlightResult, misfit_px: float) -> Iterator[str]:
    """Frames in which two landmarks were taken for each other."""
    rms = np.full(len(result.flight.frame), np.nan)
    for part in result.estimates.blocks:
        rms[part.frames] = _rms_of_frames(result.estimates.of(part.frames))
    tried = 0
    for frame in np.flatnonzero(rms > misfit_px)[:SEARCHED]:
        estimate = result.estimates.of(np.array([frame]))
        count = int(estimate.used.sum())
        searched = min(count, MOST_LANDMARKS)
        tried += count * searched * (searched - 1) // 2
        if count < 3 or tried > SEARCHED_PICKS:
            continue
        pair, after = best_exchange(estimate, 0)
        if after < rms[frame] / BETTER:
            one, other = (estimate.landmark_label(estimate.landmark[0, k]) for k in pair)
            label = frame_label(result.flight, int(frame))
            yield (
                f"{label}: {one} and {other} exchanged? Residuals are "
                f"{rms[frame]:.1f} px, and {after:.1f} px if they are"
            )
