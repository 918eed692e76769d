"""What the tables of a job say at the times of its frames, a little later and a little earlier."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.job import Job
from vopd.program.frames import WIND_ALTITUDES
from vopd.program.ftlup import Tables, ftlup_each
from vopd.program.positions import TRAJECTORY_TIMES
from vopd.results import Results

STEP_S, STEP_FT_S = 1e-3, 1e-3

TIMES_S = np.array([0.0, STEP_S, -STEP_S])
"""The times that are looked up, from that of each frame."""
AT_TIME, LATER, EARLIER = 0, 1, 2
"""Their indices."""
_AXES = np.eye(3) * STEP_FT_S
FASTER_FT_S = np.concatenate([np.zeros((1, 3)), _AXES, -_AXES])
"""What is added to the velocity along north, east, down: nothing, more of each, less of each."""


class PathLookup(NamedTuple):
    """The vehicle's path and the wind at each of `TIMES_S`; NaN where a table is out of order."""

    altitude_ft: Floats  # (F,) at the frame's time
    travelled_ft: Floats  # (F, 3, 3) east, north, up, by the time
    velocity_ft_s: Floats  # (F, 3, 7, 3) north, east, down, by the time and `FASTER_FT_S`
    wind_ft_s: Floats  # (F, 3, 2) north, east, by the time


@np.errstate(all="ignore")
def path_lookup(jobs: Sequence[Job], results: Results, frames: Sequence[slice]) -> PathLookup:
    """Look up everything in two calls.

    Args:
        jobs: the jobs
        results: of all of them, one after the other
        frames: of each job
    """
    paths, winds = [job.trajectory for job in jobs], [job.wind for job in jobs]
    position, velocity, altitude = (
        np.concatenate([getattr(one, name) for one in paths])
        for name in ("position_ft", "velocity_ft_s", "altitude_ft")
    )
    shifts = len(FASTER_FT_S)
    faster = (velocity[:, None] + FASTER_FT_S).reshape(-1, 3 * shifts)
    ends = np.cumsum([len(one.time_s) for one in paths])
    columns = np.split(np.column_stack([altitude, position, faster]), ends[:-1])
    by_time = [(one.time_s, own) for one, own in zip(paths, columns, strict=True)]
    which = np.repeat(np.arange(len(frames)), [some.stop - some.start for some in frames])
    tables = Tables.of(TRAJECTORY_TIMES, by_time)
    found = _look_up(results.time_s[:, None] + TIMES_S, which, tables)
    altitude_ft = np.ascontiguousarray(found[..., 0])
    by_height = [(one.altitude_ft, one.velocity_ft_s) for one in winds]
    return PathLookup(
        altitude_ft=altitude_ft[:, AT_TIME],
        travelled_ft=found[..., 1:4] - results.vehicle_ft[:, None],
        velocity_ft_s=found[..., 4:].reshape(len(found), len(TIMES_S), shifts, 3),
        wind_ft_s=_look_up(altitude_ft, which, Tables.of(WIND_ALTITUDES, by_height)),
    )


def _look_up(x: Floats, which: Ints, tables: Tables) -> Floats:
    """What `ftlup_each` finds; NaN for a job whose run stopped at its table."""
    stopped = tables.refused()
    if not stopped.any():
        return ftlup_each(x, which, tables)
    found = np.full((*x.shape, tables.vard.shape[1]), np.nan)
    for k in np.flatnonzero(~stopped):
        own = slice(tables.first[k], tables.first[k] + tables.size[k])
        one = Tables(tables.name, tables.size[[k]], tables.vari[own], tables.vard[own])
        rows = which == k
        found[rows] = ftlup_each(x[rows], np.zeros(int(rows.sum()), np.int64), one)
    return found
