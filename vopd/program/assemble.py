"""Put the results of the stages of a run together into `Results`."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from vopd.arrays import Ints
from vopd.errata import Fixes
from vopd.job import Job
from vopd.program.ftlup import TableOutOfOrder
from vopd.program.ignored import Kept
from vopd.results import Outcome, Results, Stage, Stop


def assemble(
    job: Job, fixes: Fixes, kept: Kept, outcome: Ints, *stages: NamedTuple, **arrays: Any
) -> Results:
    """Put the results of a job together.

    Arrays that no stage gives were not reached: they are NaN, false or zero.

    Args:
        job: the job.
        fixes: which errata were corrected.
        kept: its dropped frames and the landmarks that take part.
        outcome: how each frame ended (F,).
        stages: what was computed; the fields of each are fields of `Results`.
        arrays: single fields of `Results`; those by landmark without gaps (N, ...).
    """
    readings, layout = job.readings, job.readings.layout
    known = {
        "frame": readings.frame,
        "outcome": outcome,
        "landmark": readings.points.landmark,
        "used": kept.used,
        "ignored": ~kept.used & ~kept.dropped[layout.frame],
        "stop": None,
        **arrays,
    }
    for stage in stages:
        known |= stage._asdict()
    for name, (kind, axes) in Results.SHAPES.items():
        if name not in known:
            empty = np.nan if kind is np.float64 else 0
            axes = ("N", *axes[2:]) if axes[1:2] == ("L",) else axes
            size = {"F": len(outcome), "N": layout.total, "2": 2, "3": 3}
            known[name] = np.full([size[axis] for axis in axes], empty, kind)
    return Results.made(layout, job=job, fixes=fixes, **known)


def assemble_stopped(
    job: Job,
    fixes: Fixes,
    kept: Kept,
    outcome: Ints,
    *stages: NamedTuple,
    at: int,
    stage: Stage,
    error: TableOutOfOrder,
    **arrays: Any,
) -> Results:
    """The results up to the frame at which a table look-up stopped the run.

    Args:
        job, fixes, kept, outcome, stages, arrays: as `assemble` has them, for all frames.
        at: index of the frame.
        stage: which look-up it was.
        error: what FTLUP raised.
    """
    assert error.table is not None  # every look-up of a run is named
    group, variable = error.table
    stop = Stop(at, stage, group, variable, error.position, error.vari, error.vard)
    whole = assemble(job, fixes, kept, outcome, *stages, stop=stop, **arrays)
    until = whole.only(np.arange(at + 1))
    until.outcome[at] = Outcome.STOPPED
    return until
