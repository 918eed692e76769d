"""Arrays and options of a run of several jobs, and what the package offers."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import vopd
from vopd.attitude.sigmas import Sigmas
from vopd.findings import Finding, VopdError
from vopd.results import SolvedJob
from vopd.solved import Run


def stub(count: int, findings: tuple[Finding, ...] = (), landmarks: int = 2) -> SolvedJob:
    results: Any = SimpleNamespace(
        frame=np.arange(count), time_s=np.arange(float(count)),
        landmark=np.arange(count * landmarks).reshape(count, landmarks) + 1,
        residual_mm=np.ones((count, landmarks, 2)), used=np.ones((count, landmarks), bool),
    )  # fmt: skip
    return SolvedJob("a", 1, results, findings)


def test_arrays_of_a_run_of_jobs_with_other_numbers_of_landmarks() -> None:
    first, second = Finding("1"), Finding("2")
    run = Run([stub(2, (first,)), stub(1, (second, first), 3)])
    assert run.findings == (first, second, first)
    assert len(run) == 2 and repr(run) == "Run(2 jobs, 3 frames)" and repr(Run([])) == (
        "Run(0 jobs, 0 frames)"
    )  # fmt: skip
    assert run[0] is run.jobs[0].results and run[0:2] == tuple(job.results for job in run.jobs)
    assert run.time_s.tolist() == [0.0, 1.0, 0.0]
    assert run.landmark.tolist() == [[1, 2, 0], [3, 4, 0], [1, 2, 3]]
    assert run.used.tolist() == [[True, True, False]] * 2 + [[True] * 3]
    assert np.isnan(run.residual_mm[:2, 2]).all() and np.isfinite(run.residual_mm[2]).all()
    for name in ("focal_length_mm", "solved", "converged", *("frame", "eta_deg", "at_centre")):
        assert name in dir(run)
    with pytest.raises(AttributeError) as raised:
        run.yaw  # noqa: B018
    assert "has no attribute 'yaw'" in str(raised.value)
    with pytest.raises(VopdError, match=r"^the run has no job$"):
        Run([]).time_s  # noqa: B018


def test_options_of_a_run_reach_its_table(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[tuple[Any, ...]] = []

    class Told(Run):
        def histories(self, *given: Any) -> list[Any]:
            told.append(given)
            return []

    monkeypatch.setattr("vopd.export.tables.dataframe", lambda _: None)
    Told([]).to_dataframe(Sigmas(0.5), 2.0, "geodetic")
    Told([]).to_dataframe()
    assert told == [(Sigmas(0.5), 2.0, "geodetic"), (None, None, None)]


def test_what_the_package_offers() -> None:
    names = [
        "Deck", "DeckError", "Finding", "FlightResult", "InputError", "Job", "Results", "Run",
        "Sigmas", "VopdError", "__version__", "listing_text", "read_deck", "run", "solve_flight",
        "write_deck",
    ]  # fmt: skip
    assert vopd.__all__ == dir(vopd) == names
    for name in names:
        found = getattr(vopd, name)
        assert name in ("__version__", "DeckError") or found.__name__ == name
    assert vopd.DeckError is vopd.InputError
    with pytest.raises(AttributeError, match=r"^module 'vopd' has no attribute 'solve'$"):
        vopd.solve  # noqa: B018
