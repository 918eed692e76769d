"""Conditions that the original did not report: what to doubt in the results of a job."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools
from vopd.copied_readings import copied_readings_text
from vopd.findings import BASIC_DATA, Finding, frames_text
from vopd.geometry.body_angles import LARGEST_DEG
from vopd.geometry.camera_axes import ahead, camera_axes
from vopd.results import Outcome, Results
from vopd.solved_job import SolvedJob


class Condition(NamedTuple):
    """A condition to warn of: the frames that have it, the group concerned, and the message."""

    frames: Bools
    group: int | None
    message: str


def solve_findings(jobs: Sequence[SolvedJob]) -> list[list[Finding]]:
    """The warnings about the readings and the results of each of some jobs.

    Args:
        jobs: the jobs as they were solved
    """
    if not jobs:
        return []
    found = [_copied_readings(one) for one in jobs]
    frames = np.cumsum([0, *(len(one.results.frame) for one in jobs)])
    for condition in _conditions([one.results for one in jobs]):
        where = np.searchsorted(frames, np.flatnonzero(condition.frames), side="right") - 1
        for k in np.flatnonzero(np.bincount(where)).tolist():  # np.unique would load numpy.ma
            own = condition._replace(frames=condition.frames[frames[k] : frames[k + 1]])
            found[k].append(frame_finding(jobs[k], own))
    return found


def _copied_readings(one: SolvedJob) -> list[Finding]:
    text = copied_readings_text(one.results.job.readings)
    return [Finding(text, one.deck, job=one.number, group=BASIC_DATA).warned()] if text else []


def frame_finding(job: SolvedJob, condition: Condition) -> Finding:
    """Make a warning about some frames of a job.

    Args:
        job: the job
        condition: the frames, the group and the message
    """
    numbers = job.results.frame[condition.frames]
    message = f"{frames_text([str(number) for number in numbers])}: {condition.message}"
    return Finding(message, job.deck, job=job.number, group=condition.group, severity="warning")


def _conditions(jobs: Sequence[Results]) -> Iterator[Condition]:
    """The conditions of the frames of all jobs, one after the other."""
    r = Results.joined(jobs)
    flying = (r.outcome != Outcome.DROPPED) & (r.outcome != Outcome.STOPPED)
    few = flying & (r.used_count < 2)
    single = flying & (r.layout.distinct(r.points.landmark, r.points.used) < 2) & ~few
    behind, beyond, centred = (
        r.layout.counted(marked) > 0
        for marked in (_behind_camera(r), _beyond_lens(r, jobs), r.points.at_centre)
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
def _beyond_lens(results: Results, jobs: Sequence[Results]) -> Bools:
    """Landmarks that are imaged outside their job's lens table, (N,)."""
    radius, count = results.points.radius_mm, [one.layout.total for one in jobs]
    tables = [one.job.camera.lens_radius_mm for one in jobs]
    least, most = (np.repeat([end(table) for table in tables], count) for end in (np.min, np.max))
    return np.asarray(results.points.used & ((radius > most) | (radius < least)))
