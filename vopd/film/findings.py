"""Conditions that the original did not report: what to doubt in the results of a job."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools
from vopd.copied_readings import copied_readings_text
from vopd.findings import BASIC_DATA, Finding, frames_text
from vopd.geometry.body_angles import LARGEST_DEG
from vopd.geometry.camera_axes import ahead, camera_axes
from vopd.results import Outcome, Results


class Condition(NamedTuple):
    """A condition to warn of: the frames that have it, the group concerned, and the message."""

    frames: Bools
    group: int | None
    message: str


def solve_findings(results: Results, deck: str, job: int) -> list[Finding]:
    """The warnings about the readings and the results of one job.

    Args:
        results: the job as it was solved
        deck: the deck's name
        job: the job's number in its deck, from 1
    """
    copied = copied_readings_text(results.job.readings)
    found = [Finding(copied, deck, job=job, group=BASIC_DATA).warned()] if copied else []
    return found + [
        frame_finding(results, one, deck, job) for one in _conditions(results) if one.frames.any()
    ]


def frame_finding(results: Results, condition: Condition, deck: str, job: int) -> Finding:
    """Make a warning about some frames of a job.

    Args:
        results: the job as it was solved
        condition: the frames, the group and the message
        deck: the deck's name
        job: the job's number in its deck, from 1
    """
    frames = frames_text([str(number) for number in results.frame[condition.frames]])
    message = f"{frames}: {condition.message}"
    return Finding(message, deck, job=job, group=condition.group, severity="warning")


def _conditions(results: Results) -> Iterator[Condition]:
    r = results
    flying = (r.outcome != Outcome.DROPPED) & (r.outcome != Outcome.STOPPED)
    few = flying & (r.used_count < 2)
    single = flying & (r.layout.distinct(r.points.landmark, r.points.used) < 2) & ~few
    behind, beyond, centred = (
        r.layout.counted(marked) > 0
        for marked in (_behind_camera(r), _beyond_lens(r), r.points.at_centre)
    )
    extrapolated = "values are extrapolated"
    yield from (
        Condition(r.outside_clock & flying, 6, f"outside the time table; {extrapolated}"),
        Condition(
            r.outside_trajectory & flying, 7, f"outside the trajectory table; {extrapolated}"
        ),
        Condition(r.outside_wind & r.solved & flying, 4, f"outside the wind table; {extrapolated}"),
        Condition(few, BASIC_DATA, "fewer than two landmarks; the angles are rounding noise"),
        Condition(single, BASIC_DATA, "one landmark, read twice; the angles are rounding noise"),
        Condition(
            r.singular & ~few & ~single & flying,
            BASIC_DATA,
            "the normal matrix is singular; the angles are meaningless",
        ),
        Condition(behind & flying, 8, "landmarks lie behind the camera; try --initial closed-form"),
        Condition(beyond & flying, 1, f"landmarks lie beyond the lens table; {extrapolated}"),
        Condition(
            centred & flying,
            BASIC_DATA,
            "a landmark lies at the frame's centre; its distortion is not corrected",
        ),
        Condition(
            ~r.converged,
            None,
            "not converged: the 22nd correction exceeds 1e-6 rad or is not a number",
        ),
        Condition(
            _out_of_range(r) & r.solved & r.converged,
            None,
            "an angle of camera or vehicle is beyond a full circle, although the solve converged; "
            "the listing may have asterisks",
        ),
    )


def _out_of_range(results: Results) -> Bools:
    """Frames with an angle that was not brought back into a full circle (F,)."""
    angles = np.hstack([results.camera_deg, results.vehicle_deg])
    return np.asarray((np.abs(angles) > LARGEST_DEG).any(axis=1))


@np.errstate(invalid="ignore")
def _behind_camera(results: Results) -> Bools:
    """Landmarks that the camera, as solved, looks away from, (N,)."""
    frame, points = results.layout.frame, results.points
    axes = camera_axes(np.radians(results.camera_deg))[frame]
    cosine = ahead(axes, points.direction[:, None])[:, 0]
    return np.asarray(points.used & results.solved[frame] & (cosine < 0))


@np.errstate(invalid="ignore")
def _beyond_lens(results: Results) -> Bools:
    """Landmarks that are imaged outside the lens table, (N,)."""
    table, radius = results.job.camera.lens_radius_mm, results.points.radius_mm
    return np.asarray(results.points.used & ((radius > table.max()) | (radius < table.min())))
