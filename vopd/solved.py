"""Run of a deck: its solved jobs, their histories and tables."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Generic, overload

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.findings import Finding, VopdError, count_text
from vopd.records import Array
from vopd.results import Results, SolvedJob
from vopd.shown import Shown

if TYPE_CHECKING:
    import pandas as pd

    from vopd.attitude.history import History, HistoryOptions
    from vopd.attitude.long_history import HistoryParts
    from vopd.attitude.sigmas import Sigmas


class OfAllJobs(Generic[Array]):
    """An array of `Results` as an attribute of a run: that of all its jobs, one after the other."""

    def __set_name__(self, owner: type[Run], name: str) -> None:
        self.name = name
        self.__doc__ = f"`Results.{name}` of all jobs, one after the other."

    @overload
    def __get__(self, run: None, owner: type[Run]) -> OfAllJobs[Array]: ...
    @overload
    def __get__(self, run: Run, owner: type[Run]) -> Array: ...
    def __get__(self, run: Run | None, owner: type[Run]) -> OfAllJobs[Array] | Array:
        if run is None:
            return self
        if not run.jobs:
            raise VopdError("the run has no job")
        parts: list[Array] = [getattr(one, self.name) for one in run]
        return _stacked(parts)


class Run(Shown, Sequence[Results]):
    """All solved jobs of a deck: a sequence of `Results`, with the warnings in `findings`.

    Every array of `Results` is also an attribute of the run, with all jobs one after
    the other along the frame axis: `run.vehicle_deg` is (F, 3) with the frames of all
    jobs. If jobs have different numbers of landmarks, the missing elements are NaN,
    0 or false. A single job gives a run of one job. `print` shows a short table, and so
    does a notebook.
    """

    frame = OfAllJobs[Ints]()
    outcome = OfAllJobs[Ints]()
    time_s = OfAllJobs[Floats]()
    vehicle_ft = OfAllJobs[Floats]()
    landmark = OfAllJobs[Ints]()
    used = OfAllJobs[Bools]()
    ignored = OfAllJobs[Bools]()
    longitude_deg = OfAllJobs[Floats]()
    latitude_deg = OfAllJobs[Floats]()
    geocentric_latitude_deg = OfAllJobs[Floats]()
    altitude_ft = OfAllJobs[Floats]()
    radius_km = OfAllJobs[Floats]()
    radius_kft = OfAllJobs[Floats]()
    direction = OfAllJobs[Floats]()
    centre_in = OfAllJobs[Floats]()
    point_in = OfAllJobs[Floats]()
    centre_mm = OfAllJobs[Floats]()
    point_mm = OfAllJobs[Floats]()
    radius_mm = OfAllJobs[Floats]()
    distortion_mm = OfAllJobs[Floats]()
    start_deg = OfAllJobs[Floats]()
    camera_deg = OfAllJobs[Floats]()
    vehicle_deg = OfAllJobs[Floats]()
    alpha_deg = OfAllJobs[Floats]()
    beta_deg = OfAllJobs[Floats]()
    eta_deg = OfAllJobs[Floats]()
    airspeed_ft_s = OfAllJobs[Floats]()
    residual_mm = OfAllJobs[Floats]()
    residual_deviation_mm = OfAllJobs[Floats]()
    correction_rad = OfAllJobs[Floats]()
    last_pass = OfAllJobs[Ints]()
    singular = OfAllJobs[Bools]()
    at_centre = OfAllJobs[Bools]()
    outside_clock = OfAllJobs[Bools]()
    outside_trajectory = OfAllJobs[Bools]()
    outside_wind = OfAllJobs[Bools]()
    focal_length_mm = OfAllJobs[Floats]()
    solved = OfAllJobs[Bools]()
    converged = OfAllJobs[Bools]()

    def __init__(self, jobs: Sequence[SolvedJob]) -> None:
        self.jobs = tuple(jobs)

    @property
    def findings(self) -> tuple[Finding, ...]:
        """List the warnings about all jobs, in the order of the jobs."""
        return tuple(finding for job in self.jobs for finding in job.findings)

    def __len__(self) -> int:
        return len(self.jobs)

    @overload
    def __getitem__(self, index: int) -> Results: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Results]: ...
    def __getitem__(self, index: int | slice) -> Results | Sequence[Results]:
        if isinstance(index, slice):
            return tuple(job.results for job in self.jobs[index])
        try:
            return self.jobs[index].results
        except (TypeError, IndexError) as error:
            has = f"a run of {count_text(len(self), 'job')} has no job {index!r}"
            raise type(error)(f"{has}: jobs are counted from 0") from None

    def __repr__(self) -> str:
        frames = sum(len(one.frame) for one in self)
        return f"Run({count_text(len(self), 'job')}, {count_text(frames, 'frame')})"

    def histories(
        self,
        sigmas: Sigmas | None = None,
        max_rate_deg_s: float | None = None,
        vertical: str | None = None,
    ) -> list[History]:
        """Make the attitude history of every job, with uncertainty and flags.

        Args:
            sigmas: standard deviations of the inputs; the default has those of
                the readings alone
            max_rate_deg_s: frames that turn faster against a neighbour get a flag
            vertical: "geodetic" or "geocentric" axes for angles and quaternion; None
                keeps those of the solve, which are geodetic only with the fix `earth`
        """
        from vopd.attitude.history import HistoryOptions
        from vopd.attitude.sigmas import Sigmas

        options = HistoryOptions(sigmas or Sigmas(), max_rate_deg_s, vertical)
        return histories_of_run(self.jobs, options)

    def _shown(self) -> tuple[list[HistoryParts], Sequence[Finding]]:
        from vopd.attitude.long_history import one_part

        return list(map(one_part, self.histories())), self.findings

    def to_dataframe(
        self,
        sigmas: Sigmas | None = None,
        max_rate_deg_s: float | None = None,
        vertical: str | None = None,
    ) -> pd.DataFrame:
        """Tabulate the attitude as a pandas DataFrame, one row for each frame.

        The columns are those of `vopd attitude`, with units in their names; the
        conventions are in `attrs`.

        Args:
            sigmas: as `histories` takes it
            max_rate_deg_s: as `histories` takes it
            vertical: as `histories` takes it

        Raises:
            VopdError: where pandas is not installed, or the run has no job
        """
        from vopd.export.tables import dataframe

        return dataframe(self.histories(sigmas, max_rate_deg_s, vertical))


def histories_of_run(jobs: Sequence[SolvedJob], options: HistoryOptions) -> list[History]:
    """Make the attitude history of every job, with uncertainty and flags."""
    from vopd.attitude.long_history import histories_of_jobs
    from vopd.film import estimates_of_jobs

    return histories_of_jobs(estimates_of_jobs(jobs), options)


def _stacked(parts: list[Array]) -> Array:
    """Concatenate arrays; landmark axes of different length are filled up."""
    if parts[0].ndim < 2 or len({part.shape[1] for part in parts}) == 1:
        return np.concatenate(parts)
    longest = max(part.shape[1] for part in parts)
    empty = np.nan if parts[0].dtype.kind == "f" else 0
    filled = []
    for part in parts:
        more = [(0, 0)] * part.ndim
        more[1] = (0, longest - part.shape[1])
        filled.append(np.pad(part, more, constant_values=empty))
    return np.concatenate(filled)
