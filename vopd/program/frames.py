"""The frames of some jobs as program VOPD takes them: what the groups of cards give each frame.

A job's frames are put one after the other, and behind them those of the next job, so that
short jobs are solved together: for hundreds of them that is many times faster.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.job import Job, Landmarks, Readings
from vopd.program.ftlup import TableName, Tables
from vopd.program.ignored import kept
from vopd.program.positions import (
    FRAME_NUMBERS,
    TRAJECTORY_TIMES,
    UndefinedLandmark,
    origin_of,
)

LENS_RADII: TableName = (1, "radial distances")
WIND_ALTITUDES: TableName = (4, "altitudes")


class Frames(NamedTuple):
    """F frames, and of the landmarks that are read in them the N that take part.

    What a job has as a whole stands here for each of its frames.
    """

    readings: Readings
    dropped: Bools  # (F,) by group 11
    slot: Ints  # (N,) where each that takes part (INJ, A 162) stands among all that are read
    of: Ints  # (N,) its frame
    nj: Ints  # (F,) how many take part in each frame (A 201, A 202)
    card: Ints  # (N,) its card among all of group 9 (A 165 to A 169), -1 where there is none
    landmarks: Landmarks  # group 9
    table: Ints  # (F,) which of the tables below are the frame's
    clock: Tables  # group 6: XFRM, TIMX
    position: Tables  # group 7: TX, XXX, YYY, ZZZ
    velocity: Tables  # its TX, VVX, VVY, VVZ
    altitude: Tables  # its TX, H
    wind: Tables  # group 4: ALT, VXO, VYO
    lens: Tables  # group 1: XRR, RRR
    cc: Floats  # (F,) CC, the focal length
    multiplier: Floats  # (F, 3) S1M, S2M, S3M
    offset: Floats  # (F, 3) S1A, S2A, S3A
    origin: Floats  # (3, F) PHI, THZ, RZ of the trajectory
    initial: Floats  # (F, 3) ALPHAI, XOMEGI, XKAPI, or another start
    given: Bools  # (F,) whether each starts by itself from angles that the caller gave
    first: Ints  # (F,) the frame in which the angles begin that are carried on to this one


def frames_of(jobs: Sequence[Job], start_deg: Sequence[Floats | None] | None = None) -> Frames:
    """Put the frames of jobs one after the other.

    Args:
        jobs: one or more.
        start_deg: for each job angles (F, 3), degrees, from which to start each of its frames by
            itself, in place of group 8; or None.
    """
    readings = Readings.concat([job.readings for job in jobs])
    layout = readings.layout
    frames = [len(job.readings.frame) for job in jobs]
    end, last = np.cumsum(frames).tolist(), np.cumsum([j.readings.layout.total for j in jobs])
    table = np.repeat(np.arange(len(jobs)), frames)
    initial = np.array([job.camera.initial_deg for job in jobs])[table]
    first = np.asarray(np.repeat(np.array(end) - np.array(frames), frames))
    dropped, given = np.zeros((2, len(table)), bool)
    used = np.ones(layout.total, bool)
    for k, (job, start) in enumerate(zip(jobs, start_deg or [None] * len(jobs), strict=True)):
        own = slice(end[k] - frames[k], end[k])
        if start is not None:
            initial[own], first[own] = start, np.arange(own.start, own.stop)
            given[own] = True
        if len(job.ignored.frame) or job.ignored.everywhere.any():
            points = slice(last[k] - job.readings.layout.total, last[k])
            dropped[own], used[points] = kept(job.readings, job.ignored)
    slot = np.flatnonzero(used)
    of = layout.frame[slot]
    landmarks, card = _cards_of_group_9(jobs, readings.points.landmark[slot], table[of])
    cameras, winds = [job.camera for job in jobs], [job.wind for job in jobs]
    paths, clocks = [job.trajectory for job in jobs], [job.clock for job in jobs]
    origins = np.stack([origin_of(job) for job in jobs])[table]
    return Frames(
        readings=readings,
        dropped=dropped,
        slot=slot,
        of=of,
        nj=np.bincount(of, minlength=len(table)),
        card=card,
        landmarks=landmarks,
        table=table,
        clock=Tables.of(FRAME_NUMBERS, ((one.frame, one.time_s) for one in clocks)),
        position=Tables.of(TRAJECTORY_TIMES, ((one.time_s, one.position_ft) for one in paths)),
        velocity=Tables.of(TRAJECTORY_TIMES, ((one.time_s, one.velocity_ft_s) for one in paths)),
        altitude=Tables.of(TRAJECTORY_TIMES, ((one.time_s, one.altitude_ft) for one in paths)),
        wind=Tables.of(WIND_ALTITUDES, ((one.altitude_ft, one.velocity_ft_s) for one in winds)),
        lens=Tables.of(
            LENS_RADII, ((one.lens_radius_mm, one.lens_distortion_um) for one in cameras)
        ),
        cc=np.array([one.focal_length_mm for one in cameras], dtype=np.float64)[table],
        multiplier=np.array([one.multiplier for one in cameras])[table],
        offset=np.array([one.offset_deg for one in cameras])[table],
        origin=np.ascontiguousarray(origins.T),
        initial=initial,
        given=given,
        first=first,
    )


def _cards_of_group_9(jobs: Sequence[Job], number: Ints, which: Ints) -> tuple[Landmarks, Ints]:
    """Group 9 of all jobs, and in it the card of each landmark of its job; the last of a number.

    Args:
        jobs: the jobs.
        number: landmark numbers (N,).
        which: the index of the job of each (N,).
    """
    marks = [job.landmarks for job in jobs]
    together = Landmarks.concat(marks)
    numbers, place = np.unique(together.number, return_inverse=True)
    job = np.repeat(np.arange(len(jobs)), [len(one.number) for one in marks])
    cards = np.full((len(jobs), len(numbers) + 1), -1)  # TTHJ(ITGT) and so on, a row for each job
    cards[job, place] = np.arange(len(place))
    column = np.searchsorted(numbers, number)
    known = np.append(numbers, 0)[column] == number
    return together, np.where(known, cards[which, column], -1)


def check_landmarks(film: Frames) -> None:
    """Raise `UndefinedLandmark` for the least landmark number without a card of group 9."""
    missing = np.flatnonzero(film.card < 0)
    if len(missing):
        number = film.readings.points.landmark[film.slot[missing]]
        frame = film.readings.frame[film.of[missing[number.argmin()]]]
        raise UndefinedLandmark(int(frame), int(number.min()))


def stopping_jobs(film: Frames) -> Bools:
    """Mark jobs (J,) whose run ends early: a table is wrong, a landmark or all frames missing."""
    tables = film.clock, film.position, film.velocity, film.altitude, film.wind, film.lens
    stops = np.any([one.refused() for one in tables], axis=0)
    stops[film.table[film.of[film.card < 0]]] = True
    flying = np.bincount(film.table[~film.dropped], minlength=len(stops))
    return np.asarray(stops | (flying == 0))
