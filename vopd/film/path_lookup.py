"""What the tables of a job say at the times of its frames, a little later and a little earlier."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.program.angles import WIND_ALTITUDES
from vopd.program.ftlup import TableOutOfOrder, ftlup
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
def path_lookup(results: Results) -> PathLookup:
    """Look up everything in two calls: for a short job each costs more than what it computes.

    Args:
        results: the job as it was solved
    """
    path, wind = results.job.trajectory, results.job.wind
    frames, shifts = len(results.frame), len(FASTER_FT_S)
    faster = (path.velocity_ft_s[:, None] + FASTER_FT_S).reshape(-1, 3 * shifts)
    columns = np.column_stack([path.altitude_ft, path.position_ft, faster])
    time_s = results.time_s[:, None] + TIMES_S
    try:
        found = ftlup(time_s, 1, path.time_s, columns, TRAJECTORY_TIMES)
    except TableOutOfOrder:  # the run stopped there
        found = np.full((*time_s.shape, columns.shape[1]), np.nan)
    altitude = np.ascontiguousarray(found[..., 0])
    try:
        wind_ft_s = ftlup(altitude, 1, wind.altitude_ft, wind.velocity_ft_s, WIND_ALTITUDES)
    except TableOutOfOrder:
        wind_ft_s = np.full((*time_s.shape, 2), np.nan)
    return PathLookup(
        altitude_ft=altitude[:, AT_TIME],
        travelled_ft=found[..., 1:4] - results.vehicle_ft[:, None],
        velocity_ft_s=found[..., 4:].reshape(frames, len(TIMES_S), shifts, 3),
        wind_ft_s=wind_ft_s,
    )
