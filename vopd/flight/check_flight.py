"""A flight project looked over: what its files contradict, and mistakes that its solution shows."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations

import numpy as np

from vopd.arrays import Floats
from vopd.estimate import Estimate
from vopd.findings import Finding, VopdError
from vopd.flight.estimate import flight_estimate
from vopd.flight.flight import CameraPath, Flight, Picks
from vopd.flight.read_flight import read_flight
from vopd.flight.solve_project import frame_label, solve_flight
from vopd.flight.solved_flight import solve
from vopd.geometry.geodetic import earth_centred_m, geodetic

BETTER = 5.0  # a mistake is named where the residuals are so many times smaller without it
MISFIT = 5.0  # in standard deviations of a pick: from there on a frame is searched
FAR_M = 300e3
LEAST_HEIGHT_M = 5.0
SEARCHED = 50  # frames for exchanged landmarks
SEARCHED_PICKS = 100_000  # of all pairs together
TRIAL_PASSES = 20  # which are enough where a trial explains the residuals


@np.errstate(all="ignore")
def check_flight(name: str) -> list[Finding]:
    """All that is wrong or doubtful in a project: errors stop a solve, warnings do not.

    Args:
        name: the path of the project file
    """
    try:
        flight = read_flight(name)
    except VopdError as error:
        return [Finding(str(error).removeprefix(f"{name}: "), name)]
    found = [*flight.findings, *_files(flight)]
    try:
        result = solve_flight(name)
    except VopdError as error:
        return [*found, Finding(str(error).removeprefix(f"{name}: "), name)]
    found += [f for f in result.findings if f not in flight.findings]
    return [*found, *_warned(name, _by_solution(flight, result.estimate))]


def _warned(name: str, messages: Iterator[str]) -> list[Finding]:
    return [Finding(message, name, severity="warning") for message in messages]


def _files(flight: Flight) -> list[Finding]:
    return _warned(flight.source, _file_messages(flight))


def _file_messages(flight: Flight) -> Iterator[str]:
    """What the files say that can be told without a solve."""
    picks, names = flight.picks, flight.landmarks.name
    never = sorted(set(range(len(names))) - set(picks.landmark.tolist()))
    if never:
        yield f"never picked: {', '.join(names[k] for k in never[:10])}" + (
            f" and {len(never) - 10} more" if len(never) > 10 else ""
        )
    width, height = flight.lens.size_px
    u, v = picks.pixel.T
    outside = (u < -0.5) | (u > width - 0.5) | (v < -0.5) | (v > height - 0.5)
    if outside.any():
        first = int(np.flatnonzero(outside)[0])
        hint = '; does v point up? then give [picks] v = "up"' if (v < 0).mean() > 0.5 else ""
        yield (
            f"{outside.sum()} picks are outside the image of {width} x {height}, the first "
            f"{names[picks.landmark[first]]} in {frame_label(flight, int(picks.frame[first]))} "
            f"at {u[first]:g}, {v[first]:g}{hint}"
        )
    if _distance(flight, flight.landmarks.position_m) > FAR_M:
        where = geodetic(flight.landmarks.position_m)
        exchanged = "landmarks are more than 300 km from the camera"
        if (np.abs(where.longitude_deg) <= 90.0).all():
            other = earth_centred_m(where.longitude_deg, where.latitude_deg, where.height_m)
            if _distance(flight, other) < FAR_M:
                exchanged += "; with latitude and longitude exchanged they are not"
        yield exchanged


def _distance(flight: Flight, landmark_m: Floats) -> float:
    away = landmark_m[flight.picks.landmark] - flight.path.position_m[flight.picks.frame]
    return float(np.nanmedian(np.linalg.norm(away, axis=1)))


def _by_solution(flight: Flight, estimate: Estimate) -> Iterator[str]:
    """Mistakes that make the residuals large, by trying what they would be without."""
    sigma = float(np.median(flight.picks.sigma_px))
    before = _rms(estimate)
    if not before > MISFIT * sigma:
        return
    upward = flight.picks.pixel * [1.0, -1.0] + [0.0, flight.lens.size_px[1] - 1.0]
    flipped = replace(flight, picks=replace(flight.picks, pixel=upward))
    after = _rms(flight_estimate(flipped, solve(flipped, passes=TRIAL_PASSES)))
    if after < before / BETTER:
        yield (
            f"residuals are {before:.1f} px, and {after:.1f} px with v counted upward: "
            'give [picks] v = "up"?'
        )
        return
    height_m, after = _common_height(estimate)
    if abs(height_m) > LEAST_HEIGHT_M and after < before / BETTER:
        yield (
            f"residuals are {before:.1f} px, and {after:.1f} px with all landmarks "
            f"{height_m:+.0f} m: are the heights of camera and landmarks counted from the same "
            "level? A geoid is up to 100 m from the ellipsoid"
        )
        return
    yield from _exchanged(flight, estimate, MISFIT * sigma)


def _rms(estimate: Estimate) -> float:
    """Of all residuals of all frames; NaN where there are none."""
    count = 2.0 * estimate.used.sum()
    return float(np.sqrt((estimate.residual**2).sum() / count)) if count else float("nan")


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
        result = flight_estimate(trial, solve(trial, passes=TRIAL_PASSES))
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
