"""Short jobs in a row: their estimates concatenated, and separated again."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from dataclasses import fields, replace
from typing import Any, NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.estimate import Estimate
from vopd.jobs_alike import alike_together

JOBS_TOGETHER = 4000  # frames


class JoinedEstimates(NamedTuple):
    """Jobs whose frames are computed together."""

    estimate: Estimate  # the frames of all jobs; what belongs to a whole job is that of the first
    jobs: list[Estimate]
    frames: list[slice]  # of each job

    def by_frame(self, values: Sequence[float]) -> Floats:
        """Repeat one value of each job for every one of its frames (F,)."""
        return np.repeat(np.array(values, dtype=np.float64), [len(one.frame) for one in self.jobs])


def joined_estimates(jobs: Sequence[Estimate]) -> JoinedEstimates:
    """Concatenate the frames of jobs.

    Args:
        jobs: one or more of those that `taken_together` gives
    """
    ends = np.cumsum([len(one.frame) for one in jobs]).tolist()
    frames = [slice(end - len(one.frame), end) for one, end in zip(jobs, ends, strict=True)]
    first = jobs[0]
    if len(jobs) == 1:
        return JoinedEstimates(first, [first], frames)
    arrays = {
        field.name: _joined([getattr(one, field.name) for one in jobs]) for field in fields(first)
    }
    return JoinedEstimates(replace(first, **arrays), list(jobs), frames)


def _joined(parts: list[Any]) -> Any:
    """Concatenate arrays, or the arrays of named tuples; of anything else take the first."""
    first = parts[0]
    if isinstance(first, np.ndarray):
        return np.concatenate(parts)
    if isinstance(first, tuple) and hasattr(first, "_fields"):
        return type(first)(*(_joined(list(part)) for part in zip(*parts, strict=True)))
    return first


def taken_together(estimates: Sequence[Estimate]) -> Iterator[list[int]]:
    """Group estimates that can be joined: indices, about `JOBS_TOGETHER` frames at a time.

    Args:
        estimates: of any jobs
    """
    kinds = ((_kind(one, k), len(one.frame)) for k, one in enumerate(estimates))
    return alike_together(kinds, JOBS_TOGETHER)


def _kind(one: Estimate, index: int) -> Hashable:
    """Identify the kind of a job, for joining; a flight has names and stays alone."""
    if one.landmark_names or one.frame_names or one.grid or one.gimbal_deg is not None:
        return index
    return (
        one.used.shape[1],
        float(one.focal_length),
        one.units,
        id(one.about.words),
        one.stated,
        one.fiducial_sigma > 0.0,
        one.slip_effect_deg is None,
        one.position.vertical,
        one.position.to_own_m is None,
    )
