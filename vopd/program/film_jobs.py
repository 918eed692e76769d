"""The jobs of a film: jobs that are computed together, with their frames one after the other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from vopd.arrays import Ints
from vopd.job import Job, Readings


class FilmJobs(NamedTuple):
    """Some jobs, and the readings of all, F frames and N landmarks in the order of the jobs."""

    jobs: tuple[Job, ...]
    readings: Readings
    frames: list[slice]  # of each job
    points: list[slice]  # its landmarks
    job_of_frame: Ints  # (F,) indices of jobs

    def by_frame(self, values: Sequence[Any]) -> Any:
        """What each job has as a whole, for every one of its frames (F, ...).

        Args:
            values: one for each job
        """
        return np.asarray(values)[self.job_of_frame]


def film_jobs(jobs: Sequence[Job]) -> FilmJobs:
    """Put the frames of jobs one after the other.

    Args:
        jobs: one or more
    """
    counts = [len(job.readings.frame) for job in jobs]
    return FilmJobs(
        jobs=tuple(jobs),
        readings=Readings.joined([job.readings for job in jobs]),
        frames=_slices(counts),
        points=_slices([job.readings.layout.total for job in jobs]),
        job_of_frame=np.repeat(np.arange(len(jobs)), counts),
    )


def _slices(counts: Sequence[int]) -> list[slice]:
    """The slices of parts that follow one another."""
    end = np.cumsum(counts).tolist()
    return [slice(last - count, last) for count, last in zip(counts, end, strict=True)]
