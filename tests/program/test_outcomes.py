"""How each frame is said to have ended, by the pass in which its residuals vanished."""

from __future__ import annotations

import numpy as np

from tests.kit.jobs import film, without
from vopd.program.frames import orient_frames
from vopd.program.stages import BeforeSolve, after_solve
from vopd.program.vopd import prepare_jobs
from vopd.results import Outcome


def test_outcomes_by_the_last_pass() -> None:
    """Of 22 passes; the corrections go on to the last one, and a dropped frame is just that."""
    (before,) = prepare_jobs([without(film(7), 6, 7)])
    assert isinstance(before, BeforeSolve)
    initial = np.array([[140.0], [-80.0], [60.0]])
    done, start = orient_frames(initial, before.sight, before.kept.dropped)
    done = done._replace(last_pass=np.array([0, 1, 2, 21, 22, 0, 22]))
    with np.errstate(invalid="ignore"):  # nothing takes part in a dropped frame
        (results,) = after_solve(before, done, start)
    assert results.outcome.tolist() == [
        Outcome.SOLVED, Outcome.EXACT, Outcome.EXACT, Outcome.EXACT, Outcome.EXACT_LATE,
        Outcome.DROPPED, Outcome.DROPPED,
    ]  # fmt: skip
    assert results.last_pass.tolist() == [0, 1, 2, 21, 22, 0, 22]
    assert (
        not results.ignored.any() and results.used.any(axis=1).tolist() == [True] * 5 + [False] * 2
    )
