"""Jobs to results in one call, all jobs of a deck together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from vopd.arrays import Floats
from vopd.attitude.conventions import conventions
from vopd.attitude.history import History, history
from vopd.attitude.input_sigmas import Sigmas
from vopd.attitude.table_columns import table
from vopd.errata import NO_FIXES, Fixes
from vopd.findings import VopdError
from vopd.job import Job
from vopd.program.vopd import run as run_job
from vopd.results import Results

if TYPE_CHECKING:
    import pandas as pd

_ARRAYS = {f.name for f in fields(Results)} - {"job", "fixes", "stop"}


class Run(Sequence[Results]):
    """All jobs of a deck, solved: a sequence of `Results`, one a job.

    Every array of `Results` can also be asked of the run itself, all jobs one
    after the other along the frame axis: `run.vehicle_deg` is (F, 3) with the
    frames of all jobs. Where jobs have different numbers of landmarks the
    places that are missing are NaN, 0 or false.
    """

    def __init__(self, results: Sequence[Results], deck: str = "") -> None:
        self._results = tuple(results)
        self.deck = deck

    def __len__(self) -> int:
        return len(self._results)

    @overload
    def __getitem__(self, index: int) -> Results: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Results]: ...
    def __getitem__(self, index: int | slice) -> Results | Sequence[Results]:
        return self._results[index]

    def __getattr__(self, name: str) -> Any:
        if name not in _ARRAYS:
            raise AttributeError(f"a run has no {name!r}")
        if not self._results:
            raise VopdError("the deck has no job")
        return _stacked([getattr(one, name) for one in self._results])

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *_ARRAYS})

    def __repr__(self) -> str:
        frames = sum(len(one.frame) for one in self._results)
        return f"Run({len(self)} job{'s'[: len(self) != 1]}, {frames} frames)"

    def histories(
        self, sigmas: Sigmas | None = None, max_rate_deg_s: float | None = None
    ) -> list[History]:
        """Uncertainty and flags of every job; see `vopd.attitude.history.history`."""
        return [
            history(one, self.deck, k, sigmas=sigmas or Sigmas(), max_rate_deg_s=max_rate_deg_s)
            for k, one in enumerate(self._results, 1)
        ]

    def to_dataframe(
        self, sigmas: Sigmas | None = None, max_rate_deg_s: float | None = None
    ) -> pd.DataFrame:
        """The attitude table, a row a frame: the columns of `vopd attitude`, units in the names.

        The conventions are in `attrs`. Raises `VopdError` where pandas is not installed.
        """
        try:
            import pandas as pd
        except ImportError as error:
            raise VopdError("pandas is not installed: pip install 'vopd[pandas]'") from error
        histories = self.histories(sigmas, max_rate_deg_s)
        if not histories:
            raise VopdError("the deck has no job")
        frame = pd.DataFrame(table(histories))
        frame.attrs.update(conventions(histories))
        return frame


@overload
def run(jobs: Job, fixes: Fixes = NO_FIXES, start_deg: Floats | None = None) -> Results: ...
@overload
def run(jobs: Sequence[Job], fixes: Fixes = NO_FIXES, *, deck: str = "") -> Run: ...
def run(
    jobs: Job | Sequence[Job],
    fixes: Fixes = NO_FIXES,
    start_deg: Floats | None = None,
    *,
    deck: str = "",
) -> Results | Run:
    """Solve one job for all its frames at once, or all jobs of a deck.

    A job gives `Results`, the jobs of `read_deck` a `Run`. `fixes` are the slips
    to correct (`vopd.errata.fixes`), none for the original. `start_deg` (F, 3), for
    one job, are first estimates of the camera's yaw, pitch, roll of each frame, in
    the place of group 8 and of the frame before. `deck` is the name that tables
    and files show. A table that is out of order ends the run, as in 1974: the
    results go that far and say so in `stop`. Raises `VopdError` where a landmark
    is not defined.
    """
    if isinstance(jobs, Job):
        return run_job(jobs, fixes, start_deg)
    results: list[Results] = []
    for job in jobs:
        results.append(run_job(job, fixes))
        if results[-1].stop is not None:
            break
    return Run(results, deck)


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
