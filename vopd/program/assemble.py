"""Put the results of the stages of a run together into `Results`."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from vopd.arrays import Ints
from vopd.errata import Fixes
from vopd.program.film_jobs import FilmJobs
from vopd.program.ftlup import TableOutOfOrder
from vopd.program.ignored import Kept
from vopd.results import Outcome, Results, Stage, Stop


def assemble(
    film: FilmJobs, fixes: Fixes, kept: Kept, outcome: Ints, *stages: NamedTuple, **arrays: Any
) -> list[Results]:
    """Put the results of each job of a film together.

    Arrays that no stage gives were not reached: they are NaN, false or zero.

    Args:
        film: the jobs.
        fixes: which errata were corrected.
        kept: the dropped frames and the landmarks that take part.
        outcome: how each frame ended (F,).
        stages: what was computed; the fields of each are fields of `Results`.
        arrays: single fields of `Results`; those by landmark without gaps (N, ...).
    """
    readings, layout = film.readings, film.readings.layout
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
    stop = known.pop("stop")
    return [
        Results.made(job.readings.layout, job=job, fixes=fixes, stop=stop, **_of_job(known, *own))
        for job, *own in zip(film.jobs, film.frames, film.points, strict=True)
    ]


def _of_job(known: dict[str, Any], frames: slice, points: slice) -> dict[str, Any]:
    """The arrays of one job."""
    return {
        name: array[points if name in Results.BY_LANDMARK else frames]
        for name, array in known.items()
    }


def assemble_stopped(
    film: FilmJobs,
    fixes: Fixes,
    kept: Kept,
    outcome: Ints,
    *stages: NamedTuple,
    at: int,
    stage: Stage,
    error: TableOutOfOrder,
    **arrays: Any,
) -> Results:
    """The results of the only job of a film, up to the frame at which a look-up stopped the run.

    Args:
        film, fixes, kept, outcome, stages, arrays: as `assemble` has them, for all frames.
        at: index of the frame.
        stage: which look-up it was.
        error: what FTLUP raised.
    """
    assert error.table is not None  # every look-up of a run is named
    group, variable = error.table
    stop = Stop(at, stage, group, variable, error.position, error.vari, error.vard)
    (whole,) = assemble(film, fixes, kept, outcome, *stages, stop=stop, **arrays)
    until = whole.only(np.arange(at + 1))
    until.outcome[at] = Outcome.STOPPED
    return until
