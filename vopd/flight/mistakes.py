"""Mistakes with a size: a level, a clock or a focal length that would fit a flight better."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from vopd.arrays import Floats
from vopd.estimate import Estimate
from vopd.findings import VopdError
from vopd.flight.flight import Flight
from vopd.flight.project import Project
from vopd.flight.read import flight_of
from vopd.flight.trial_residuals import MistakeTrial, solved_trial, some_frames, typical_px
from vopd.geometry.earth import local_axes

LEAST_HEIGHT_M, MOST_HEIGHT_M = 5.0, 130.0  # of a geoid above the ellipsoid, and some metres
MOST_OFFSET_S, MOST_ZOOM = 3600.0, 4.0  # clocks and focal lengths that are tried
CLOSER = 4  # times a level, a clock or a focal length is solved for anew


def another_level(flight: Flight, estimate: Estimate) -> Iterator[MistakeTrial]:
    """All landmarks higher or lower, as those of another height datum are."""
    marks = flight.landmarks
    up = local_axes(marks.position_m)[:, 2]

    def raised(height_m: float) -> Flight:
        position = marks.position_m + height_m * up
        return replace(flight, landmarks=replace(marks, position_m=position))

    responses = partial(_response, "landmark", 2)
    height_m, typical = _fitted(estimate, responses, raised, (-MOST_HEIGHT_M, MOST_HEIGHT_M))
    if LEAST_HEIGHT_M < abs(height_m) < MOST_HEIGHT_M:
        yield MistakeTrial(
            typical,
            f"with all landmarks {height_m:+.0f} m: are the heights of camera and landmarks "
            "counted from the same level? A geoid is up to 100 m from the ellipsoid",
        )


def another_offset(project: Project, flight: Flight, estimate: Estimate) -> Iterator[MistakeTrial]:
    """A constant difference between the clocks of the track and of the frames."""
    if not project.has("track") or flight.path.acceleration_m_s2 is None:
        return  # positions that belong to images do not depend on a clock
    given = project.section("track").number("offset_s", 0.0)

    def later(time_s: float) -> Flight:  # frames that are later see the track earlier
        return some_frames(flight_of(project.changed("track", "offset_s", given - time_s)))

    limits = (-MOST_OFFSET_S, MOST_OFFSET_S)
    time_s, typical = _fitted(estimate, partial(_response, "time", None), later, limits)
    yield MistakeTrial(
        typical,
        f"with the track {-time_s:+.2f} s: do the clocks differ? Then give [track] "
        f"offset_s = {given - time_s:.2f}",
    )


def another_focal_length(flight: Flight, estimate: Estimate) -> Iterator[MistakeTrial]:
    """Another focal length, of another zoom, another camera or another size of the image."""
    before = float(flight.lens.focal_px.mean())

    def longer(px: float) -> Flight:
        focal_px = flight.lens.focal_px * (1.0 + px / before)
        return replace(flight, lens=replace(flight.lens, focal_px=focal_px))

    limits = (before / MOST_ZOOM - before, before * MOST_ZOOM - before)
    px, typical = _fitted(estimate, partial(_response, "focal_length", None), longer, limits)
    yield MistakeTrial(
        typical,
        f"with a focal length of {before + px:.0f} px in the place of {before:.0f}: is the lens "
        "that of this camera, at this zoom and image size?",
    )


def _response(what: str, axis: int | None, estimate: Estimate) -> Floats:
    """Residuals (F, 2L) by a unit of one input, the angles held fixed."""
    found: Floats = getattr(estimate.responses, what)
    return found if axis is None else found[..., axis]


def _fitted(
    estimate: Estimate,
    responses: Callable[[Estimate], Floats],
    changed: Callable[[float], Flight],
    limits: tuple[float, float],
) -> tuple[float, float]:
    """The change of one input that fits all residuals best, and the residuals with it.

    Args:
        estimate: of the flight as it is
        responses: of residuals to the input, (F, 2L)
        changed: the flight with the input changed by a number
        limits: of that number

    Returns:
        The number, and the residuals of a typical frame; infinite where it cannot be read so.
    """
    total, typical = 0.0, np.inf
    for _ in range(CLOSER):
        total = float(np.clip(total + _common(estimate, responses(estimate)), *limits))
        try:
            flight = changed(total)
        except VopdError:
            return total, np.inf
        estimate = solved_trial(flight)
        typical = typical_px(flight, estimate)
    return total, typical


def _common(estimate: Estimate, responses: Floats) -> float:
    """The one shift of an input that takes most of all residuals away, to first order.

    Args:
        estimate: the flight
        responses: of the residuals to the input, the angles held fixed, (F, 2L)
    """
    left = np.isfinite(estimate.gain).all(axis=(1, 2))
    partials, gain = estimate.partials[left], estimate.gain[left]
    response = responses[left] - (partials @ (gain @ responses[left][..., None]))[..., 0]
    shift = -(response * estimate.residual[left]).sum() / (response**2).sum()
    return float(shift) if np.isfinite(shift) else 0.0
