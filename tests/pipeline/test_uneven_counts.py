"""Jobs with very unequal numbers of landmarks: the same results, and work by the readings."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import vopd
from tests.kit.command import peak
from tests.kit.estimates import assert_same_landmarks
from tests.kit.jobs import film
from tests.kit.spherical_film import uneven
from tests.tolerances import assert_close
from vopd.attitude.history import History, HistoryOptions, history
from vopd.attitude.long_history import frame_landmarks, histories_of_jobs
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.table import table
from vopd.export import FORMATS, FileRequest
from vopd.figures import draw
from vopd.film import estimates_of_jobs, film_estimate
from vopd.job import Landmarks
from vopd.landmark_layout import FEW, LandmarkLayout
from vopd.listing.pages import listing_text
from vopd.pipeline import ReadJob, SolveOptions, solve_jobs
from vopd.program.vopd import run as run_job
from vopd.report import landmark_table
from vopd.results import Results, SolvedJob, SourceEnd
from vopd.solved import Run

FEW_AND_MANY = [4, 3, 5, 2] * 40 + [200] + [4, 5, 6, 2] * 40 + [90]
WIDE, NARROW = [4] * 70 + [500] + [4] * 70, [9] * 117 + [7]  # 1,060 landmarks each
SIGMAS = Sigmas(landmark=30.0, position=10.0, focal_length=0.01, time_s=0.01)
MAX_RATE = 0.2


@pytest.fixture(scope="module")
def results() -> Results:
    return run_job(uneven(FEW_AND_MANY))


def test_every_frame_is_as_in_a_job_of_frames_like_it(results: Results) -> None:
    """Bit for bit, solved from the same starts."""
    counts = np.array(FEW_AND_MANY)
    for count in np.unique(counts):
        alike = np.flatnonzero(counts == count)
        job = results.as_job(alike).job
        assert run_job(job, start_deg=results.start_deg[alike]) == results.as_job(alike)


def test_arrays_by_frame_and_landmark(results: Results) -> None:
    assert results.residual_mm.shape == (322, 200, 2) and results.used.sum() == sum(FEW_AND_MANY)
    counts = np.array(FEW_AND_MANY)
    np.testing.assert_array_equal(results.used, np.arange(200) < counts[:, None])
    assert np.isfinite(results.residual_mm[160]).all()
    assert np.isnan(results.residual_mm[0, 4:]).all() and (results.landmark[0, 4:] == 0).all()


@pytest.fixture(scope="module")
def both(results: Results) -> tuple[History, History]:
    """The history in blocks, and that of arrays of all frames by the largest count.

    Without errors of the landmarks: those are solved for in blocks of few landmarks alone.
    """
    sigmas = replace(SIGMAS, landmark=0.0)
    (blocks,) = estimates_of_jobs([SolvedJob("film", 2, results)])
    assert len(blocks) > 2
    whole = history(film_estimate(results, "film", 2), sigmas=sigmas, max_rate_deg_s=MAX_RATE)
    return histories_of_jobs([blocks], HistoryOptions(sigmas, MAX_RATE))[0], whole


def same(one: Any, other: Any) -> None:
    if one.dtype.kind == "f":
        size = np.maximum(np.abs(other), 1.0)
        assert_close("relative, in blocks or not", one / size, other / size)
    else:
        np.testing.assert_array_equal(one, other)


def test_a_history_in_blocks_is_that_of_the_whole_job(both: tuple[History, History]) -> None:
    tables = [table([one]) for one in both]
    assert "jump" in " ".join(tables[0]["flags"].tolist())
    for name, column in tables[0].items():
        same(column, tables[1][name])
    for ours, theirs in zip(*map(frame_landmarks, both), strict=True):
        same(ours, theirs)
    assert landmark_table([both[0]]) == landmark_table([both[1]])


def test_every_block_has_the_landmarks_of_its_frames(both: tuple[History, History]) -> None:
    one, other = both
    ((_, whole),) = other.estimates()
    blocks = [*one.estimates()]
    assert len(blocks) > 2
    for frames, block in blocks:
        assert_same_landmarks(block, whole.take(frames))


def test_the_scene_of_blocks_is_that_of_the_whole_job(both: tuple[History, History]) -> None:
    assert both[0].estimate.scene is not None and both[1].estimate.scene is not None
    one, other = both[0].estimate.scene(), both[1].estimate.scene()
    frames = both[1].estimate.frame.tolist()
    same(one.camera_m, other.camera_m)
    assert [one.index(k, "") for k in frames] == [other.index(k, "") for k in frames]
    for k in frames[:: len(frames) // 7]:
        for ours, theirs in zip(one.sight(k, ""), other.sight(k, ""), strict=True):
            same(ours, theirs)
    some = np.arange(len(frames))[::-3]
    assert one.film is not None and other.film is not None
    for ours, theirs in zip(one.film(some), other.film(some), strict=True):
        same(ours, theirs)


def everything(job: vopd.Job) -> None:
    """All that the commands make of a job."""
    run: Run = vopd.run(job)
    listing_text(run[0])
    histories = run.histories(SIGMAS, max_rate_deg_s=MAX_RATE)
    FORMATS["csv"].render(histories, FileRequest())
    landmark_table(histories)
    for name in ("residuals", "image"):
        draw(name, histories)


def test_no_array_is_larger_than_the_readings_ask_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """500 landmarks in one frame of 141: 1,060 landmarks, and 70,500 elements if padded."""
    made: list[int] = []
    arrange: Callable[..., Any] = LandmarkLayout.padded

    def counted(self: LandmarkLayout, values: Any, empty: float = 0) -> Any:
        made.append(len(self.count) * self.widest)
        return arrange(self, values, empty)

    monkeypatch.setattr(LandmarkLayout, "padded", counted)
    everything(uneven(WIDE))
    assert made and max(made) <= sum(WIDE) + FEW


def test_memory_follows_the_readings() -> None:
    wide, narrow = uneven(WIDE), uneven(NARROW)
    assert wide.readings.layout.total == narrow.readings.layout.total

    def solve(job: vopd.Job) -> Callable[[], object]:
        return lambda: vopd.run(job).histories(SIGMAS)

    assert peak(solve(wide)) < 2 * peak(solve(narrow), begun=True)


def test_jobs_that_keep_the_landmarks_of_earlier_ones_are_solved_few_at_a_time() -> None:
    """80 jobs of 20,000 landmarks each would hold 77 MB of landmarks at once."""
    job = film(1)
    known, many = job.landmarks, np.arange(10_000, 30_000)

    def jobs() -> Iterator[ReadJob | SourceEnd]:
        for number in range(1, 81):
            ones = [np.append(column, np.ones(many.size)) for column in columns]
            landmarks = Landmarks(np.append(known.number, many), *ones)
            yield ReadJob("deck", number, replace(job, landmarks=landmarks))
        yield SourceEnd("deck")

    columns = (
        known.longitude_deg, known.longitude_min, known.latitude_deg, known.latitude_min,
        known.altitude_ft,
    )  # fmt: skip

    def solved() -> None:
        assert sum(isinstance(one, SolvedJob) for one in solve_jobs(jobs(), SolveOptions())) == 80

    assert peak(solved) < 30e6
