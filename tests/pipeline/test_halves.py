"""A film in two halves comes out as in one piece, or is run in one piece."""

from __future__ import annotations

import os
from dataclasses import replace

import numpy as np
import pytest

from tests.program.jobs import without
from vopd.batch import halves
from vopd.batch.halves import run_and_print
from vopd.errata import NO_FIXES, fixes
from vopd.job import Job
from vopd.listing.pages import frame_pages
from vopd.program.positions import UndefinedLandmark
from vopd.program.vopd import run
from vopd.results import Results
from vopd.synthetic.plan import Plan
from vopd.synthetic.scene import make

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="processes cannot be split here")


@pytest.fixture(autouse=True)
def short_films(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(halves, "LONG", 2)
    monkeypatch.setattr(halves, "EARLY", 12)
    monkeypatch.setattr(halves, "_processors", lambda: 2)


def film(frames: int, seed: int) -> Job:
    """A flight whose yaw goes on from frame to frame where it is a few degrees."""
    return make(Plan(frames=frames, landmarks=3, seed=seed))[0][0]


def whole(job: Job) -> tuple[Results, bytes]:
    results = run(job)
    return results, b"".join(frame_pages(results))


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("frames", [2, 3, 41, 90])
def test_the_same_results_and_pages(frames: int, seed: int) -> None:
    job = film(frames, seed)
    if seed % 2:
        job = without(job, *job.readings.frame[[0, frames // 2]])
    results, pages = run_and_print(job, NO_FIXES)
    assert (results, b"".join(pages)) == whole(job)


def carried(count: int = 3) -> list[Job]:
    """Films with a start that goes on across the middle."""
    films = (film(40, seed) for seed in range(200))
    found = (job for job in films if goes_on(job, 40 * 11 // 20))
    return [next(found) for _ in range(count)]


def goes_on(job: Job, frame: int) -> bool:
    return not np.array_equal(run(job).start_deg[frame], job.camera.initial_deg)


def test_both_halves_are_used() -> None:
    for job in [*carried(), film(40, 1)]:
        found = halves._in_halves(job, NO_FIXES)
        assert found is not None
        assert (found[0], b"".join(found[1])) == whole(job)


def test_another_start_in_the_middle_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The second half without the frames before it starts from group 8."""
    monkeypatch.setattr(halves, "EARLY", 0)
    for job in carried():
        assert halves._in_halves(job, NO_FIXES) is None
        results, pages = run_and_print(job, NO_FIXES)
        assert (results, b"".join(pages)) == whole(job)


def test_fixes_reach_both_halves() -> None:
    job = film(20, 3)
    results, _ = run_and_print(job, fixes("all"))
    assert results == run(job, fixes("all"))


def test_a_half_that_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    """In either process."""
    here = os.getpid()
    job = film(40, 1)
    for fails_here in (False, True):

        def failing(*given: object, fails_here: bool = fails_here) -> Results:
            if (os.getpid() == here) == fails_here and len(given[0].readings.frame) < 40:  # type: ignore[attr-defined]
                raise MemoryError
            return run(*given)  # type: ignore[arg-type]

        monkeypatch.setattr(halves, "run", failing)
        assert halves._in_halves(job, NO_FIXES) is None
        results, pages = run_and_print(job, NO_FIXES)
        assert (results, b"".join(pages)) == whole(job)


def test_what_is_wrong_is_told_as_of_the_whole() -> None:
    job = film(20, 1)
    marks = replace(job.landmarks, number=job.landmarks.number + 50)
    with pytest.raises(UndefinedLandmark, match="frame 1:"):
        run_and_print(replace(job, landmarks=marks), NO_FIXES)
    times = job.trajectory.time_s.copy()
    times[1] = times[0]
    job = replace(job, trajectory=replace(job.trajectory, time_s=times))
    results, pages = run_and_print(job, NO_FIXES)
    assert results.stop is not None and (results, b"".join(pages)) == whole(job)


def test_one_processor_or_a_short_film_is_one_process(monkeypatch: pytest.MonkeyPatch) -> None:
    def none(_: object) -> None:
        raise AssertionError("a process was split")

    monkeypatch.setattr(halves, "_Child", none)
    monkeypatch.setattr(halves, "LONG", 30)
    run_and_print(film(20, 1), NO_FIXES)
    monkeypatch.setattr(halves, "LONG", 2)
    monkeypatch.setattr(halves, "_processors", lambda: 1)
    run_and_print(film(20, 1), NO_FIXES)
