"""The input of the solve of a job, as program VOPD computes it from the cards."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vopd.arrays import Floats
from vopd.errata import NO_FIXES, Fixes
from vopd.job import Job
from vopd.program.orient import FilmSight
from vopd.program.vopd import run_jobs


def solve_input(jobs: Sequence[Job], fixes: Fixes = NO_FIXES) -> FilmSight:
    """The input of the solve of jobs that are solved together."""
    found: list[FilmSight] = []

    def no_estimate(seen: FilmSight) -> Floats:
        found.append(seen)
        return np.full((len(seen.nj), 3), np.nan)

    run_jobs(jobs, fixes, None, no_estimate)
    (seen,) = found
    return seen
