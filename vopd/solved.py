"""All solved jobs of a deck as a run, from which the library makes histories and tables."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from vopd.findings import Finding, VopdError
from vopd.results import Results, SolvedJob

if TYPE_CHECKING:
    import pandas as pd

    from vopd.attitude.history import History
    from vopd.attitude.input_sigmas import Sigmas

_ARRAYS = {*Results.SHAPES, "focal_length_mm", "solved", "converged"}


class Run(Sequence[Results]):
    """All solved jobs of a deck: a sequence of `Results`, with the warnings in `findings`.

    Every array of `Results` is also an attribute of the run, with all jobs one after
    the other along the frame axis: `run.vehicle_deg` is (F, 3) with the frames of all
    jobs. Where jobs have different numbers of landmarks, the missing elements are NaN,
    0 or false. A single job gives a run of one job.
    """

    def __init__(self, jobs: Sequence[SolvedJob]) -> None:
        self.jobs = tuple(jobs)

    @property
    def findings(self) -> tuple[Finding, ...]:
        """The warnings about all jobs, in the order of the jobs."""
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
        return self.jobs[index].results

    def __getattr__(self, name: str) -> Any:
        if name not in _ARRAYS:
            raise AttributeError(f"a run has no {name!r}")
        if not self.jobs:
            raise VopdError("the run has no job")
        return _stacked([getattr(one, name) for one in self])

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *_ARRAYS})

    def __repr__(self) -> str:
        frames = sum(len(one.frame) for one in self)
        return f"Run({len(self)} job{'s'[: len(self) != 1]}, {frames} frames)"

    def histories(
        self,
        sigmas: Sigmas | None = None,
        max_rate_deg_s: float | None = None,
        vertical: str | None = None,
    ) -> list[History]:
        """Make the attitude history of every job, with uncertainty and flags.

        Args:
            sigmas: standard deviations of what the jobs were given; the default
                has those of the readings alone
            max_rate_deg_s: frames that turn faster against a neighbour are flagged
            vertical: "geodetic" or "geocentric" axes for angles and quaternion; None
                keeps those of the solve, which are geodetic only with the fix `earth`
        """
        from vopd.attitude.blocks import histories_of_jobs
        from vopd.attitude.input_sigmas import Sigmas
        from vopd.attitude.vertical import with_vertical
        from vopd.film import estimates_of_jobs

        jobs = [
            [one._replace(estimate=with_vertical(one.estimate, vertical)) for one in blocks]
            for blocks in estimates_of_jobs(self.jobs)
        ]
        return histories_of_jobs(jobs, sigmas=sigmas or Sigmas(), max_rate_deg_s=max_rate_deg_s)

    def to_dataframe(
        self,
        sigmas: Sigmas | None = None,
        max_rate_deg_s: float | None = None,
        vertical: str | None = None,
    ) -> pd.DataFrame:
        """The attitude table as a pandas DataFrame, one row for each frame.

        The columns are those of `vopd attitude`, with units in their names; the
        conventions are in `attrs`.

        Args:
            sigmas: as `histories` takes it
            max_rate_deg_s: as `histories` takes it
            vertical: as `histories` takes it

        Raises:
            VopdError: where pandas is not installed, or the run has no job
        """
        from vopd.export.dataframe import dataframe

        return dataframe(self.histories(sigmas, max_rate_deg_s, vertical))


def _stacked(parts: list[Any]) -> Any:
    """Arrays one after the other; landmark axes of different length are filled up."""
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
