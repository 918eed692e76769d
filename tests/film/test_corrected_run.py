"""How the run with all errata corrected is made, and what is taken from it: angle by angle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.kit.jobs import film, turned
from tests.tolerances import within
from vopd import film as estimates
from vopd.errata import NO_FIXES, Fix, Fixes, fixes
from vopd.film import slip_effects_deg
from vopd.job import Job
from vopd.program.positions import UndefinedLandmark
from vopd.program.vopd import run
from vopd.results import Results

ALL = np.ones(3, bool)
ANGLES = (
    "camera yaw", "camera pitch", "camera roll", "vehicle yaw", "vehicle pitch", "vehicle roll",
    "alpha", "beta", "eta",
)  # fmt: skip


def mounted(offset_deg: Sequence[float]) -> Job:
    """A film of three frames whose camera turns, with the vehicle's angles apart from its own."""
    truth = np.array([[140.0, -70.0, 60.0], [141.0, -69.0, 62.0], [142.0, -71.0, 61.0]])
    job = turned(truth, truth[0])
    camera = replace(
        job.camera, multiplier=np.array([1.0, -0.5, 1.0]), offset_deg=np.array(offset_deg)
    )
    return replace(job, camera=camera)


def nine(results: Results) -> np.ndarray:
    attack = [results.alpha_deg, results.beta_deg, results.eta_deg]
    return np.column_stack([results.camera_deg, results.vehicle_deg, *attack])


def test_each_angle_is_corrected_minus_run() -> None:
    results = run(mounted([10.0, -20.0, 30.0]), fixes("restart"))
    corrected = run(results.job, fixes("all"), results.camera_deg)
    (effect,) = slip_effects_deg([results], [ALL])
    assert effect is not None
    expected = nine(corrected) - nine(results)
    assert not expected.round().any() and (expected != 0.0).all()
    for column, name in enumerate(ANGLES):
        apart = np.abs(effect[:, column] - expected[:, column])
        assert (apart < within("wrapped angle")).all(), name


@pytest.mark.parametrize("side", [1e-9, -1e-9])
def test_an_angle_that_passes_a_full_circle_changes_little(side: float) -> None:
    """The vehicle's yaw, pitch and roll of frame 1 are at the ends of their circles."""
    before = run(mounted([0.0, 0.0, 0.0])).vehicle_deg[0]
    ends = np.array([0.0, 180.0, 360.0]) + side - before
    results = run(mounted(ends))
    (effect,) = slip_effects_deg([results], [ALL])
    corrected = run(results.job, fixes("all"), results.camera_deg)
    assert effect is not None and not effect.round().any()
    apart = np.abs(nine(corrected) - nine(results)).round()
    assert (apart == 360.0).any()


Calls = list[tuple[Sequence[Job], Fixes, Sequence[np.ndarray]]]


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> Calls:
    """The arguments of every run that is made."""
    made: Calls = []
    real = estimates.run_jobs

    def run_jobs(jobs: Any, chosen: Any, starts: Any) -> Any:
        made.append((jobs, chosen, starts))
        return real(jobs, chosen, starts)

    monkeypatch.setattr(estimates, "run_jobs", run_jobs)
    return made


@pytest.mark.parametrize("ellipsoid", ["wgs84", "clarke1866"])
def test_all_errata_and_the_ellipsoid_of_the_run(ellipsoid: str, calls: Calls) -> None:
    chosen = fixes("earth", ellipsoid=ellipsoid)
    slip_effects_deg([run(film(3), chosen)], [ALL])
    ((_, used, _),) = calls
    assert used.chosen == frozenset(Fix) and used.ellipsoid == chosen.ellipsoid


def test_where_each_frame_starts(calls: Calls) -> None:
    """From its solution; from group 8 if it is not determined, or the run did not come to it."""
    results = run(film(4)).take(slice(3))
    slip_effects_deg([results, results], [np.array([True, False, True]), ALL])
    ((jobs, _, (first, second)),) = calls
    assert [job is results.job for job in jobs] == [True, True]
    group_8 = [140.0, -80.0, 60.0]
    solved = results.camera_deg.tolist()
    assert first.tolist() == [solved[0], group_8, solved[2], group_8]
    assert second.tolist() == [*solved, group_8]


def test_nothing_is_run_again_where_nothing_is_left_to_correct(calls: Calls) -> None:
    assert slip_effects_deg([], []) == []
    both = [run(film(3), fixes("all")), run(film(3), fixes("all"))]
    assert slip_effects_deg(both, [ALL, ALL]) == [None, None] and calls == []
    all_but_one = Fixes(frozenset(Fix) - {Fix.SIN_6PHI})
    assert slip_effects_deg([run(film(3), all_but_one)], [ALL])[0] is not None


def test_an_error_of_the_corrected_run_is_raised_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    error = UndefinedLandmark(2, 66)
    monkeypatch.setattr(estimates, "run_jobs", lambda *_: [error])
    with pytest.raises(UndefinedLandmark) as caught:
        slip_effects_deg([run(film(3), NO_FIXES)], [ALL])
    assert caught.value is error
