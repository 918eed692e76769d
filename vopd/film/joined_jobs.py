"""Frames of several jobs put one after the other, so that they can be computed together."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.film.path_lookup import PathLookup, path_lookup
from vopd.program.positions import Origin, origin_of
from vopd.results import Results


class JoinedJobs(NamedTuple):
    """The results of jobs with the same fixes and the same largest number of landmarks.

    What belongs to a job as a whole is here for every one of its frames.
    """

    results: Results  # the arrays of all jobs; its `job` is that of the first
    frames: list[slice]  # of each job
    origin: Origin  # (F,) each
    focal_length_mm: Floats  # (F,)
    multiplier: Floats  # (F, 3) of vehicle yaw, pitch, roll by those of the camera
    path: PathLookup


def joined_jobs(jobs: Sequence[Results]) -> JoinedJobs:
    """Put the frames of jobs one after the other.

    Args:
        jobs: one or more, all with the same fixes and the same largest number of landmarks
    """
    count = [len(one.frame) for one in jobs]
    end = np.cumsum(count).tolist()
    cameras = [one.job.camera for one in jobs]
    origins = zip(*(origin_of(one.job) for one in jobs), strict=True)
    results = Results.joined(jobs)
    frames = [slice(last - n, last) for n, last in zip(count, end, strict=True)]
    return JoinedJobs(
        results=results,
        frames=frames,
        origin=Origin(*(np.repeat(part, count) for part in origins)),
        focal_length_mm=np.repeat([one.focal_length_mm for one in cameras], count),
        multiplier=np.repeat([one.multiplier for one in cameras], count, axis=0),
        path=path_lookup([one.job for one in jobs], results, frames),
    )
