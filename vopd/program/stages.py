"""The computation of some jobs before the solve of the angles, and after it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.errata import Fix, Fixes
from vopd.findings import VopdError
from vopd.job import Job
from vopd.program.angles import AirLookup, air_angles, air_lookup, attitude, residual_deviation
from vopd.program.assemble import assemble, assemble_stopped
from vopd.program.average import FilmCoordinates, film_coordinates
from vopd.program.film_jobs import FilmJobs, film_jobs
from vopd.program.frames import FilmOrientation
from vopd.program.ftlup import TableOutOfOrder
from vopd.program.ignored import Kept, kept_of_film
from vopd.program.lens_correction import LensCorrection, lens_correction
from vopd.program.orient import PASSES
from vopd.program.positions import (
    LandmarkPositions,
    Origin,
    TimeAndPosition,
    directions,
    landmark_positions,
    origin_of,
    time_and_position,
)
from vopd.program.sight import FilmSight, sight
from vopd.results import Outcome, Results, Stage


class BeforeSolve(NamedTuple):
    """Everything that is computed of jobs before their angles are solved."""

    jobs: FilmJobs
    fixes: Fixes
    kept: Kept
    times: TimeAndPosition
    landmarks: LandmarkPositions
    direction: Floats
    film: FilmCoordinates
    lens: LensCorrection
    air: AirLookup | VopdError  # the error is raised where the wind is used
    sight: FilmSight


def before_solve(jobs: Sequence[Job], fixes: Fixes) -> BeforeSolve | Results:
    """Prepare jobs for the solve.

    Args:
        jobs: one or more.
        fixes: the errata to correct.

    Returns:
        The prepared jobs; or the results of a single job, if there is nothing to solve, because
        all its frames are dropped or a table out of order stops the run before the solve.

    Raises:
        UndefinedLandmark: if a landmark takes part that group 9 does not define.
        VopdError: if any of several jobs would not be prepared to the end.
    """
    film = film_jobs(jobs)
    taken = kept_of_film(film)
    dropped, used = taken
    outcome = np.where(dropped, Outcome.DROPPED, Outcome.SOLVED)
    begun = film, fixes, taken, outcome
    single, layout = len(jobs) == 1, film.readings.layout
    try:
        times = time_and_position(film)
    except TableOutOfOrder as error:
        if single:
            return assemble_stopped(*begun, at=0, stage=Stage.TIME, error=error)
        raise
    marks = landmark_positions(film, used, fixes)
    origins = zip(*(origin_of(job) for job in jobs), strict=True)
    direction = directions(
        Origin(*(film.by_frame(part)[layout.frame] for part in origins)), fixes,
        times.vehicle_ft[layout.frame],
        marks.longitude_deg, marks.geocentric_latitude_deg, marks.radius_km,
    )  # fmt: skip
    points = film_coordinates(film.readings, fixes)
    if any(dropped[frames].all() for frames in film.frames):
        if single:
            return assemble(*begun, times, marks, points, direction=direction)[0]
        raise VopdError("one of the jobs has no frame to solve")
    try:
        lens = lens_correction(film, points, used)
    except TableOutOfOrder as error:
        if single:
            first = int(np.flatnonzero(~dropped)[0])
            return assemble_stopped(
                *begun, times, marks, points,
                direction=direction, at=first, stage=Stage.LENS, error=error,
            )  # fmt: skip
        raise
    focal_length_mm = film.by_frame([job.camera.focal_length_mm for job in jobs])
    seen = sight(points, lens, direction, used, focal_length_mm, fixes, layout)
    air: AirLookup | VopdError
    try:
        air = air_lookup(film, times.time_s)
    except VopdError as error:
        if not single:
            raise
        air = error
    return BeforeSolve(film, fixes, taken, times, marks, direction, points, lens, air, seen)


def after_solve(before: BeforeSolve, done: FilmOrientation, start: Floats) -> list[Results]:
    """Make the results of each job from the solve of all.

    Args:
        before: the jobs as they were prepared.
        done: the solve of their frames.
        start: the angles from which they were solved (3, F), degrees.
    """
    film, fixes, (dropped, used) = before.jobs, before.fixes, before.kept
    early = (done.last_pass > 0) & (done.last_pass < PASSES)
    outcome = np.where(early, Outcome.EXACT, Outcome.SOLVED)
    outcome = np.where(done.last_pass == PASSES, Outcome.EXACT_LATE, outcome)
    outcome = np.where(dropped, Outcome.DROPPED, outcome)
    found = attitude(film, done, start, dropped, used)
    reached = (
        film, fixes, before.kept, outcome,
        before.times, before.landmarks, before.film, before.lens, found,
    )  # fmt: skip
    if isinstance(before.air, TableOutOfOrder):
        asked = np.flatnonzero(~dropped & ~early)
        if not len(asked):  # no frame got as far as the wind
            return assemble(*reached, direction=before.direction)
        stopped = assemble_stopped(
            *reached,
            direction=before.direction, at=int(asked[0]), stage=Stage.WIND, error=before.air,
        )  # fmt: skip
        return [stopped]
    if isinstance(before.air, VopdError):
        raise before.air
    air = air_angles(before.air, found.vehicle_deg)
    fitted = 3 if Fix.STANDARD_DEVIATION in fixes else 0
    deviation = residual_deviation(found.residual_mm, used, fitted, film.readings.layout)
    return assemble(*reached, air, direction=before.direction, residual_deviation_mm=deviation)
