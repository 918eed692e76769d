"""Program VOPD: solve jobs (A 105 to A 455)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice

import numpy as np

from vopd.arrays import Floats
from vopd.errata import NO_FIXES, Fix, Fixes
from vopd.findings import VopdError
from vopd.job import Job
from vopd.program.constants import twopi
from vopd.program.frames import FilmOrientation, orient_frames
from vopd.program.sight import FilmSight
from vopd.program.stages import BeforeSolve, after_solve, before_solve
from vopd.results import Results


def run(job: Job, fixes: Fixes = NO_FIXES, start_deg: Floats | None = None) -> Results:
    """Solve a job for all its frames.

    Args:
        job: the job.
        fixes: errata to correct; none for the original.
        start_deg: first estimates (F, 3) of the camera's yaw, pitch, roll, degrees, to
            start each frame from, instead of group 8 and the frame before.

    Returns:
        The results. A table out of order ends the job at the frame that first uses
        it: the results go that far and say so in `stop`.

    Raises:
        UndefinedLandmark: if a landmark takes part that group 9 does not define.
        TableNotANumber: if a table that is used holds a NaN.

    Source: TM X-3050, A 105 to A 455.
    """
    (results,) = run_jobs([job], fixes, [start_deg])
    if isinstance(results, VopdError):
        raise results
    return results


def run_jobs(
    jobs: Sequence[Job],
    fixes: Fixes = NO_FIXES,
    start_deg: Sequence[Floats | None] | None = None,
) -> list[Results | VopdError]:
    """Solve many jobs at once; each result is the same, bit for bit, as that of the job alone.

    All jobs are solved as one film. For jobs of few frames that is many times faster
    than one after the other. Memory grows with the frames of all jobs together: a few
    thousand at a time are enough.

    Args:
        jobs: the jobs.
        fixes: errata to correct in all of them.
        start_deg: for each job what `run` takes under this name.

    Returns:
        For each job, in order, its results, or the error that `run` would raise.
    """
    return solve_prepared(prepare_jobs(jobs, fixes), start_deg or [None] * len(jobs))


@np.errstate(all="ignore")
def prepare_jobs(
    jobs: Sequence[Job], fixes: Fixes = NO_FIXES
) -> list[BeforeSolve | Results | VopdError]:
    """Compute everything of each job that comes before the solve.

    Jobs are prepared together; where one ends early, they are halved until it is alone.

    Args:
        jobs: the jobs.
        fixes: errata to correct in all of them.

    Returns:
        In order, what `solve_prepared` takes of one job or several; or the results of a job,
        if there is nothing to solve; or the error that `run` would raise.
    """
    try:
        return [before_solve(jobs, fixes)] if jobs else []
    except VopdError as error:
        if len(jobs) == 1:
            return [error]
    half = len(jobs) // 2
    return prepare_jobs(jobs[:half], fixes) + prepare_jobs(jobs[half:], fixes)


@np.errstate(all="ignore")
def solve_prepared(
    prepared: Sequence[BeforeSolve | Results | VopdError], start_deg: Sequence[Floats | None]
) -> list[Results | VopdError]:
    """Solve the jobs that `prepare_jobs` has prepared.

    Args:
        prepared: what `prepare_jobs` returned.
        start_deg: for each job its first estimates (F, 3), degrees, or None, as `run` takes them.

    Returns:
        For each job, in order, its results, or the error that `run` would raise.
    """
    starts = iter(start_deg)
    of_each = [list(islice(starts, _jobs_of(before))) for before in prepared]
    film = [
        (before, own)
        for before, own in zip(prepared, of_each, strict=True)
        if isinstance(before, BeforeSolve)
    ]
    solved = iter(_solve_film(*zip(*film, strict=True)) if film else [])
    ended: list[Results | VopdError] = []
    for before in prepared:
        if not isinstance(before, BeforeSolve):
            ended.append(before)
            continue
        try:
            ended += after_solve(before, *next(solved))
        except VopdError as error:
            ended.append(error)
    return ended


def _jobs_of(before: BeforeSolve | Results | VopdError) -> int:
    """How many jobs an element of what `prepare_jobs` returns has."""
    return len(before.jobs.jobs) if isinstance(before, BeforeSolve) else 1


def _solve_film(
    prepared: Sequence[BeforeSolve], starts: Sequence[Sequence[Floats | None]]
) -> list[tuple[FilmOrientation, Floats]]:
    """Solve prepared jobs as one film; for each element the solve and the starts (3, F)."""
    turn = 360.0 if Fix.RESTART in prepared[0].fixes else twopi
    counts = [len(before.kept.dropped) for before in prepared]
    ends = np.cumsum(counts)
    initial, first = [], []
    for before, own, count, end in zip(prepared, starts, counts, ends, strict=True):
        jobs = before.jobs
        angles = jobs.by_frame([job.camera.initial_deg for job in jobs.jobs])
        begin = jobs.by_frame([frames.start for frames in jobs.frames])
        for start, frames in zip(own, jobs.frames, strict=True):
            if start is not None:  # every frame by itself
                angles[frames] = start
                begin[frames] = np.arange(frames.start, frames.stop)
        initial.append(angles.T)
        first.append(begin + end - count)
    done, start_deg = orient_frames(
        np.concatenate(initial, axis=1),
        FilmSight.joined([before.sight for before in prepared]),
        np.concatenate([before.kept.dropped for before in prepared]),
        turn,
        np.concatenate(first),
    )
    totals = [before.sight.layout.total for before in prepared]
    behind = np.cumsum(totals)
    return [
        (done.only(slice(f - frames, f), slice(n - total, n)), start_deg[:, f - frames : f])
        for frames, f, total, n in zip(counts, ends, totals, behind, strict=True)
    ]
