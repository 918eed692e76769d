"""How each frame is said to have ended, by the pass in which its residuals vanished."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.kit.jobs import film, without
from vopd.program import vopd
from vopd.results import Outcome


def test_outcomes_by_the_last_pass(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 22 passes; the corrections go on to the last one, and a dropped frame is just that."""
    real = vopd.orient_frames
    last_pass = np.array([0, 1, 2, 21, 22, 0, 22])

    def orient_frames(*args: Any) -> Any:
        done, start = real(*args)
        return done._replace(last_pass=last_pass), start

    monkeypatch.setattr(vopd, "orient_frames", orient_frames)
    results = vopd.run(without(film(7), 6, 7))
    assert results.outcome.tolist() == [
        Outcome.SOLVED, Outcome.EXACT, Outcome.EXACT, Outcome.EXACT, Outcome.EXACT_LATE,
        Outcome.DROPPED, Outcome.DROPPED,
    ]  # fmt: skip
    assert results.last_pass.tolist() == [0, 1, 2, 21, 22, 0, 22]
    assert (
        not results.ignored.any() and results.used.any(axis=1).tolist() == [True] * 5 + [False] * 2
    )
