"""The computation of one job before the solve of the angles, and after it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.errata import Fix, Fixes
from vopd.job import Job
from vopd.program.angles import air_angles, attitude, residual_deviation
from vopd.program.assemble import assemble, assemble_stopped
from vopd.program.average import FilmCoordinates, film_coordinates
from vopd.program.frames import FilmOrientation
from vopd.program.ftlup import TableOutOfOrder
from vopd.program.ignored import Kept, kept
from vopd.program.lens_correction import LensCorrection, lens_correction
from vopd.program.orient import PASSES
from vopd.program.positions import (
    LandmarkPositions,
    TimeAndPosition,
    directions,
    landmark_positions,
    origin_of,
    time_and_position,
)
from vopd.program.sight import FilmSight, sight
from vopd.results import Outcome, Results, Stage


class BeforeSolve(NamedTuple):
    """Everything that is computed of a job before its angles are solved."""

    job: Job
    fixes: Fixes
    kept: Kept
    times: TimeAndPosition
    landmarks: LandmarkPositions
    direction: Floats
    film: FilmCoordinates
    lens: LensCorrection
    sight: FilmSight


def before_solve(job: Job, fixes: Fixes) -> BeforeSolve | Results:
    """Prepare a job for the solve.

    Args:
        job: the job.
        fixes: the errata to correct.

    Returns:
        The prepared job; or its results, if there is nothing to solve, because all its
        frames are dropped or a table out of order stops the run before the solve.

    Raises:
        UndefinedLandmark: if a landmark takes part that group 9 does not define.
    """
    taken = kept(job.readings, job.ignored)
    dropped, used = taken
    outcome = np.where(dropped, Outcome.DROPPED, Outcome.SOLVED)
    begun = job, fixes, taken, outcome
    try:
        times = time_and_position(job)
    except TableOutOfOrder as error:
        return assemble_stopped(*begun, at=0, stage=Stage.TIME, error=error)
    marks = landmark_positions(job, used, fixes)
    direction = directions(
        origin_of(job), fixes, times.vehicle_ft[job.readings.layout.frame],
        marks.longitude_deg, marks.geocentric_latitude_deg, marks.radius_km,
    )  # fmt: skip
    film = film_coordinates(job.readings, fixes)
    if dropped.all():
        return assemble(*begun, times, marks, film, direction=direction)
    try:
        lens = lens_correction(job.camera, film, used, job.readings.layout)
    except TableOutOfOrder as error:
        first = int(np.flatnonzero(~dropped)[0])
        return assemble_stopped(
            *begun, times, marks, film,
            direction=direction, at=first, stage=Stage.LENS, error=error,
        )  # fmt: skip
    focal_length_mm = np.full(len(dropped), job.camera.focal_length_mm)
    seen = sight(film, lens, direction, used, focal_length_mm, fixes, job.readings.layout)
    return BeforeSolve(job, fixes, taken, times, marks, direction, film, lens, seen)


def after_solve(before: BeforeSolve, done: FilmOrientation, start: Floats) -> Results:
    """Make the results of a job from its solve.

    Args:
        before: the job as it was prepared.
        done: the solve of its frames.
        start: the angles from which they were solved (3, F), degrees.
    """
    job, fixes, (dropped, used) = before.job, before.fixes, before.kept
    early = (done.last_pass > 0) & (done.last_pass < PASSES)
    outcome = np.where(early, Outcome.EXACT, Outcome.SOLVED)
    outcome = np.where(done.last_pass == PASSES, Outcome.EXACT_LATE, outcome)
    outcome = np.where(dropped, Outcome.DROPPED, outcome)
    found = attitude(job.camera, done, start, dropped, used)
    reached = (
        job, fixes, before.kept, outcome,
        before.times, before.landmarks, before.film, before.lens, found,
    )  # fmt: skip
    try:
        air = air_angles(job, before.times.time_s, found.vehicle_deg)
    except TableOutOfOrder as error:
        asked = np.flatnonzero(~dropped & ~early)
        if not len(asked):  # no frame got as far as the wind
            return assemble(*reached, direction=before.direction)
        return assemble_stopped(
            *reached,
            direction=before.direction, at=int(asked[0]), stage=Stage.WIND, error=error,
        )  # fmt: skip
    fitted = 3 if Fix.STANDARD_DEVIATION in fixes else 0
    deviation = residual_deviation(found.residual_mm, used, fitted, job.readings.layout)
    return assemble(*reached, air, direction=before.direction, residual_deviation_mm=deviation)
