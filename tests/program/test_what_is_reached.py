"""Which results a run has when it is stopped, and of frames that are dropped.

In the order of the program: time and position, landmarks and film (A 121 to A 254), lens and
solve (A 274 to A 443), angles of attack (C 1 to C 40). What is not reached is NaN.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.kit.jobs import RESULT_ARRAYS, film, reread, without
from tests.tolerances import assert_close
from vopd.errata import fixes
from vopd.job import Job
from vopd.program import vopd
from vopd.program.vopd import run
from vopd.results import Outcome, Results, Stage

WHERE = ["time_s", "vehicle_ft"]
MARKS = [
    "longitude_deg", "latitude_deg", "geocentric_latitude_deg", "altitude_ft", "radius_km",
    "radius_kft", "direction",
]  # fmt: skip
READ = ["centre_in", "point_in", "centre_mm", "point_mm"]
LENS = ["radius_mm", "distortion_mm"]
SOLVE = ["start_deg", "camera_deg", "vehicle_deg", "residual_mm", "correction_rad"]
ATTACK = ["alpha_deg", "beta_deg", "eta_deg", "airspeed_ft_s", "residual_deviation_mm"]
EVERYTHING = WHERE + MARKS + READ + LENS + SOLVE + ATTACK


def backward(part: str) -> Job:
    """Three frames, with one table in decreasing order."""
    name = {"clock": "frame", "camera": "lens_radius_mm", "wind": "altitude_ft"}.get(part, "time_s")
    job = film(3)
    table = getattr(job, part)
    return replace(job, **{part: replace(table, **{name: getattr(table, name)[::-1].copy()})})


STOPS = {  # the table: the stage, and what is known of the frame at which the run stops
    "clock": (Stage.TIME, []),
    "trajectory": (Stage.TIME, []),
    "camera": (Stage.LENS, WHERE + MARKS + READ),
    "wind": (Stage.WIND, WHERE + MARKS + READ + LENS + SOLVE),
}


def known(results: Results, frame: int) -> list[str]:
    """The arrays of numbers that hold no NaN in a frame."""
    return [name for name in EVERYTHING if not np.isnan(getattr(results, name)[frame]).any()]


def test_these_are_all_arrays_of_numbers() -> None:
    results = run(film(1))
    floats = [name for name in RESULT_ARRAYS if getattr(results, name).dtype == np.float64]
    assert sorted(EVERYTHING) == sorted(floats)


@pytest.mark.parametrize("part", STOPS)
@pytest.mark.parametrize("dropped", [0, 2])
def test_what_a_stopped_run_has(part: str, dropped: int) -> None:
    """Time and trajectory are looked up of dropped frames too; the others of the first solved."""
    stage, reached = STOPS[part]
    job = without(backward(part), *range(1, dropped + 1))
    results = run(job)
    at = 0 if stage == Stage.TIME else dropped
    assert results.stop is not None and results.stop.stage is stage
    assert results.frame.tolist() == list(range(1, at + 2))
    assert known(results, at) == ([] if at < dropped else reached)
    assert (results.outcome[:-1] == Outcome.DROPPED).all()
    assert results.outcome[-1] == Outcome.STOPPED
    for name in EVERYTHING:
        if name not in reached:
            assert np.isnan(getattr(results, name)[at]).all(), name
    if reached:
        whole = run(without(film(3), *range(1, dropped + 1)))
        for name in reached:
            np.testing.assert_array_equal(getattr(results, name)[at], getattr(whole, name)[at])


def test_what_frames_have_that_are_dropped() -> None:
    """Time, position and readings; and the start and correction of the solve, not its angles."""
    alone, among = run(without(film(2), 1, 2)), run(without(film(2), 1))
    assert known(alone, 0) == known(alone, 1) == WHERE + READ
    assert known(among, 0) == [*WHERE, *READ, "start_deg", "correction_rad"]
    assert known(among, 1) == EVERYTHING
    assert alone.outcome.tolist() == [Outcome.DROPPED] * 2 and alone.stop is None
    for results in (alone, among):
        assert not results.used[0].any() and not results.ignored[0].any()
        assert not results.singular[0] and not results.at_centre[0].any()


@pytest.mark.parametrize("names", [(), ("standard-deviation",), ("restart",), ("all",)])
@pytest.mark.parametrize("marks", [2, 3, 5])
def test_the_standard_deviation_of_a_frame(names: tuple[str, ...], marks: int) -> None:
    """The root of the sum of squares over 2N, or over 2N - 3 by its fix alone."""
    job = film(2)
    errors = np.random.default_rng(2).normal(0.0, 0.02, (2, 5, 1, 2))
    readings = reread(job.readings, landmark_in=job.readings.landmark_in + errors)
    everywhere = np.zeros(5, np.int64)
    everywhere[: 5 - marks] = np.arange(11, 16 - marks)
    ignored = replace(job.ignored, everywhere=everywhere)
    results = run(replace(job, readings=readings, ignored=ignored), fixes(*names))
    squares = np.nansum(results.residual_mm**2, axis=(1, 2))
    assert np.isfinite(results.residual_mm).sum(axis=(1, 2)).tolist() == [2 * marks] * 2
    fitted = 3 if names in (("standard-deviation",), ("all",)) else 0
    expected = np.sqrt(squares / (2 * marks - fitted))
    assert_close("residual", results.residual_deviation_mm, expected)


def test_when_all_residuals_vanished(monkeypatch: pytest.MonkeyPatch) -> None:
    """In pass 22 a frame is as good as solved; before it has no angles on tape 10."""
    real = vopd.orient_frames

    def orient_frames(*args: Any) -> Any:
        done, start = real(*args)
        done.last_pass[:] = [0, 1, 21, 22]
        return done, start

    monkeypatch.setattr(vopd, "orient_frames", orient_frames)
    results = run(film(4))
    names = [Outcome(one).name for one in results.outcome]
    assert names == ["SOLVED", "EXACT", "EXACT", "EXACT_LATE"]
    assert results.solved.tolist() == [True, False, False, True]
    assert results.last_pass.tolist() == [0, 1, 21, 22]
    wind = replace(film(4).wind, altitude_ft=film(4).wind.altitude_ft[::-1].copy())
    stopped = run(without(replace(film(4), wind=wind), 1))
    assert stopped.frame.tolist() == [1, 2, 3, 4]
    names = [Outcome(one).name for one in stopped.outcome]
    assert names == ["DROPPED", "EXACT", "EXACT", "STOPPED"]


@pytest.mark.parametrize("names", [(), ("all",)])
def test_a_film_without_any_landmark(names: tuple[str, ...]) -> None:
    """There is no residual, so all are zero in pass 1; jobs beside it are as they are alone."""
    job = film(2)
    present = np.zeros_like(job.readings.present)
    empty = replace(job, readings=reread(job.readings, present=present))
    first, found, last = vopd.run_jobs([film(1), empty, film(2)], fixes(*names))
    assert isinstance(found, Results) and found.outcome.tolist() == [Outcome.EXACT] * 2
    assert found.used.shape == (2, 0)
    assert [first, last] == [run(film(1), fixes(*names)), run(film(2), fixes(*names))]


def test_an_ignored_landmark_at_the_centre_is_not_marked() -> None:
    """All landmarks of a film are read at its centre; the first takes no part."""
    job = film(1)
    points = job.readings.fiducial_in.mean(axis=(1, 2))[:, None, None] + np.zeros((1, 5, 3, 2))
    everywhere = np.array([11, 0, 0, 0, 0])
    readings = reread(job.readings, landmark_in=points.round(6))
    corners = np.repeat(job.readings.fiducial_in.mean(axis=(1, 2))[:, None, None].round(6), 4, 1)
    readings = reread(readings, fiducial_in=np.repeat(corners, 3, 2))
    ignored = replace(job.ignored, everywhere=everywhere)
    results = run(replace(job, readings=readings, ignored=ignored))
    assert results.at_centre.tolist() == [[False, True, True, True, True]]
    assert np.isnan(results.radius_mm[0, 0]) and (results.radius_mm[0, 1:] == 0.0).all()
