"""The reading sigma of a long job: from which frames, of how many landmarks, and their tests."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from tests.kit.estimates import estimate
from vopd.arrays import Ints
from vopd.attitude import long_history as long_job
from vopd.attitude.long_history import sampled_reading_sigma
from vopd.attitude.reading_sigma import JobReadingSigma
from vopd.attitude.sigmas import Sigmas
from vopd.estimate import Estimate
from vopd.landmark_layout import AT_ONCE, TOGETHER, LandmarkLayout

GIVEN = Sigmas(position=3.0)


class Sampled:
    """What is estimated from the frames that are taken, instead of an estimate."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, source: str = "residuals") -> None:
        self.frames: list[list[int]] = []
        self.source = source
        monkeypatch.setattr(long_job, "job_reading_scales", self.scales)

    def estimate_of(self, frames: Ints) -> Estimate:
        one = estimate(np.tile([140.0, -60.0, 20.0], (1, 1)))
        self.frames.append(frames.tolist())
        return one

    def scales(self, estimates: Sequence[Estimate], sigmas: Sigmas) -> list[JobReadingSigma]:
        assert sigmas is GIVEN and len(estimates) == len(self.frames)
        return [
            JobReadingSigma(0.25, 7.0, self.source, np.array(frames) + 0.5, 0.5)
            for frames in self.frames
        ]

    def of(self, counts: list[int]) -> tuple[JobReadingSigma, list[int]]:
        self.frames.clear()
        found = sampled_reading_sigma(LandmarkLayout(np.array(counts)), self.estimate_of, GIVEN)
        return found, sorted(k for block in self.frames for k in block)


def test_of_how_many_landmarks() -> None:
    assert long_job.SAMPLE == 25_000
    assert (TOGETHER, AT_ONCE) == (100_000, 24_000)


@pytest.mark.parametrize(
    ("counts", "taken"),
    [
        ([2, 1, 0, 3, 1, 2], [0, 3, 5]),  # one landmark tells nothing
        ([1, 0, 1], [0, 1, 2]),  # none tells more
        ([10, 10], [0, 1]),
    ],
)
def test_all_frames_of_a_job_that_is_not_long(
    counts: list[int], taken: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(long_job, "SAMPLE", 20)
    scale, frames = Sampled(monkeypatch).of(counts)
    assert frames == taken
    assert (scale.sigma, scale.freedom, scale.source, scale.test_sigma) == (
        0.25, 7.0, "residuals", 0.5,
    )  # fmt: skip
    expected = [k + 0.5 if k in taken else np.nan for k in range(len(counts))]
    assert np.array_equal(scale.chance, expected, equal_nan=True)


@pytest.mark.parametrize(("source", "said"), [("residuals", "sample"), ("given", "given"),
                                              ("repeated", "repeated")])  # fmt: skip
def test_one_of_so_many_frames_of_a_long_job(
    source: str, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of 100 frames with 400 landmarks in steps of five, any one of each five; always the same."""
    monkeypatch.setattr(long_job, "SAMPLE", 80)
    sampled = Sampled(monkeypatch, source)
    counts = [4, 1] * 100
    scale, frames = sampled.of(counts)
    assert scale.source == said
    several = [frame // 2 for frame in frames]
    assert all(frame % 2 == 0 for frame in frames)
    assert [k // 5 for k in several] == list(range(20))
    assert len({k % 5 for k in several}) > 2  # every fifth may be a poor one
    assert sampled.of(counts)[1] == frames
    assert np.flatnonzero(np.isfinite(scale.chance)).tolist() == frames
    monkeypatch.setattr(long_job, "SAMPLE", 399)
    assert len(sampled.of(counts)[1]) == 50  # one landmark too many: every second frame
    monkeypatch.setattr(long_job, "SAMPLE", 400)
    scale, frames = sampled.of(counts)
    assert len(frames) == 100 and scale.source == source
