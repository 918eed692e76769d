"""Put the results of the stages of a run together into `Results`."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from vopd.arrays import Ints
from vopd.errata import Fixes
from vopd.job import Job
from vopd.program.ftlup import TableOutOfOrder
from vopd.program.ignored import Kept
from vopd.results import Outcome, Results, Stage, Stop, array_shapes


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
        arrays: single fields of `Results`.
    """
    readings = job.readings
    known = {
        "frame": readings.frame,
        "outcome": outcome,
        "landmark": readings.landmark,
        "used": kept.used,
        "ignored": readings.present & ~kept.used & ~kept.dropped[:, None],
        **arrays,
    }
    for stage in stages:
        known |= stage._asdict()
    frames, landmarks = readings.landmark.shape
    size = {"F": frames, "L": landmarks, "2": 2, "3": 3}
    for name, (kind, axes) in array_shapes().items():
        if name not in known:
            empty = np.nan if kind is np.float64 else 0
            known[name] = np.full([size[axis] for axis in axes], empty, kind)
    return Results(job=job, fixes=fixes, **known)


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
    whole = assemble(job, fixes, kept, outcome, *stages, **arrays)
    cut = {name: getattr(whole, name)[: at + 1].copy() for name in array_shapes()}
    cut["outcome"][at] = Outcome.STOPPED
    assert error.table is not None  # every look-up of a run is named
    group, variable = error.table
    stop = Stop(at, stage, group, variable, error.position, error.vari, error.vard)
    return Results(job=job, fixes=fixes, stop=stop, **cut)
