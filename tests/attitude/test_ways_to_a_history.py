"""One job, its blocks, long jobs: each way to a history takes every option and finds
the same.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit.estimates import ABOUT, estimate
from tests.tolerances import assert_close
from vopd.arrays import Ints
from vopd.attitude import long_history as long_job
from vopd.attitude.history import History, HistoryOptions, history
from vopd.attitude.long_history import (
    frame_landmarks,
    histories_of_jobs,
    history_of_long_job,
)
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.table import TableArrays, table
from vopd.attitude.uncertainty import block_reading_scale
from vopd.estimate import Block, Estimate, StatedSigmas
from vopd.findings import VopdError
from vopd.landmark_layout import LandmarkLayout

ANGLES = np.array([[140.0 + 3.0 * (k == 5), -60.0, 20.0] for k in range(9)])
RATE = 1.2
OPTIONS: dict[str, dict[str, Any]] = {
    "given": {
        "sigmas": Sigmas(reading=0.25, position=3.0, mount_deg=0.1),
        "max_rate_deg_s": RATE,
    },
    "estimated": {"sigmas": Sigmas(landmark=0.2, wind=1.0)},
}


def job(**changes: Any) -> Estimate:
    """Nine frames of four landmarks, one of which turns by 3 degrees; frame 3 misfits."""
    residual = np.random.default_rng(5).normal(0.0, 0.4, (9, 8))
    residual[2] *= 12.0
    e = estimate(ANGLES, residual=residual, about=ABOUT._replace(job=2), **changes)
    return replace(e, stated=StatedSigmas(time_s=0.01), slip_effect_deg=np.full((9, 9), 0.25))


def blocks(e: Estimate, *parts: list[int]) -> list[Block]:
    return [(np.array(part), e.take(np.array(part))) for part in parts]


ALL = list(range(9))
HALVES = ([1, 3, 5, 7, 8], [0, 2, 4, 6])


def long_way(e: Estimate, **options: Any) -> History:
    whole: History = history_of_long_job(
        LandmarkLayout(e.used.sum(axis=1)),
        e.take,
        HistoryOptions(**options),
    ).whole
    return whole


WAYS: dict[str, Callable[..., History]] = {
    "a block": lambda e, **o: histories_of_jobs([blocks(e, ALL)], HistoryOptions(**o))[0],
    "two blocks": lambda e, **o: histories_of_jobs([blocks(e, *HALVES)], HistoryOptions(**o))[0],
    "jobs of both kinds": lambda e, **o: histories_of_jobs(
        [blocks(e, *HALVES), blocks(e, ALL), blocks(e, *HALVES)], HistoryOptions(**o)
    )[1],
    "a long job": long_way,
}


@cache
def alone(options: str) -> tuple[History, TableArrays]:
    """The history by itself, and its table."""
    one = history(job(), **OPTIONS[options])
    return one, table([one])


def same(name: str, values: Any, expected: Any) -> None:
    """One column of a table, words and numbers, of which some are missing or infinite."""
    if expected.dtype.kind != "f":
        assert values.tolist() == expected.tolist(), name
        return
    known = np.isfinite(expected)
    np.testing.assert_array_equal(values[~known], expected[~known], err_msg=name)
    size = np.maximum(np.abs(expected[known]), 1.0)
    assert_close("relative, in blocks or not", values[known] / size, expected[known] / size)


def check(one: History, options: str) -> None:
    """The table, what is known of the whole job, and its landmarks."""
    plain, expected = alone(options)
    for name, values in table([one]).items():
        same(name, values, expected[name])
    for name in ("about", "units", "stated", "landmark_names", "frame_names", "focal_length"):
        assert getattr(one.estimate, name) == getattr(plain.estimate, name), name
    for ours, theirs in zip(frame_landmarks(one), frame_landmarks(plain), strict=True):
        np.testing.assert_array_equal(ours, theirs)
    assert one.uncertainty.reading.source == plain.uncertainty.reading.source


@pytest.mark.parametrize("options", [*OPTIONS])
@pytest.mark.parametrize("way", [*WAYS])
def test_every_way_takes_every_option(way: str, options: str) -> None:
    check(WAYS[way](job(), **OPTIONS[options]), options)


@pytest.mark.parametrize(
    ("options", "together", "at_once"),
    [("estimated", 1000, 12), ("given", 15, 1000), ("given", 25, 8)],
)
def test_parts_of_a_long_job_are_those_of_the_whole(
    options: str, together: int, at_once: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One run of several blocks, several runs of one block, several of several."""
    monkeypatch.setattr(long_job, "TOGETHER", together)
    monkeypatch.setattr(long_job, "AT_ONCE", at_once)
    given, e = OPTIONS[options], job()
    layout = LandmarkLayout(np.full(9, 4))
    parts = history_of_long_job(layout, e.take, HistoryOptions(**given))
    assert parts.frames == 9 and parts.about == e.about
    _, expected = alone(options)
    made = [*parts]
    if together == 1000:
        assert len(made) == 1
    else:
        assert len(made) > 1 and parts.head.estimate.frame.tolist() == [1]
    first = 0
    for one in made:
        for name, values in table([one]).items():
            same(name, values, expected[name][first : first + len(values)])
        for frames, block in one.estimates():
            assert block == e.take(first + frames)
        landmarks = frame_landmarks(one)
        assert np.array_equal(landmarks.frame, np.repeat(np.arange(len(one.estimate.frame)), 4))
        first += len(one.estimate.frame)
    assert first == 9
    check(parts.whole, options)


class Mixed(LandmarkLayout):
    """Runs whose blocks do not follow each other."""

    def runs(self, together: int, most: int) -> list[list[Ints]]:
        del together, most
        return [[np.array([1, 3, 4]), np.array([0, 2])], [np.array([6, 8]), np.array([5, 7])]]


@pytest.mark.parametrize("sample", [35, 36])
def test_a_run_of_mixed_blocks_has_its_frames_in_order_and_all_are_tested(
    sample: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """There are 36 landmarks: where only some tell the reading sigma, the tests of the others are
    made by it, with the errors that are given.
    """
    monkeypatch.setattr(long_job, "SAMPLE", sample)
    e, given = job(), Sigmas(position=3.0, fiducial=0.2)
    layout = Mixed(np.full(9, 4))
    parts = history_of_long_job(layout, e.take, HistoryOptions(given, RATE))
    scale = long_job.sampled_reading_sigma(layout, e.take, given)
    assert scale.source == ("sample" if sample < 36 else "residuals")
    whole = block_reading_scale(e, given, scale).chance if sample < 36 else scale.chance
    assert np.isfinite(whole).all()
    for one in (*parts, parts.whole):
        frames = one.estimate.frame - 1
        assert frames.tolist() in ([0, 1, 2, 3, 4], [5, 6, 7, 8], ALL)
        reading = one.uncertainty.reading
        assert reading == replace(scale, chance=reading.chance)
        assert_close("relative, in blocks or not", reading.chance, whole[frames])
        assert all(block == e.take(frames[some]) for some, block in one.estimates())
        assert np.array_equal(one.estimate.camera_deg, ANGLES[frames])
        assert "position" in one.uncertainty.components
        jump = [k for k in (4, 5, 6) if k in frames]
        assert (np.flatnonzero(one.flags.raised["jump"]) + frames[0]).tolist() == [
            k for k in jump if k == 5
        ]


def test_what_the_blocks_have_in_common_is_no_array_of_frames() -> None:
    """Two blocks of three frames: three numbers for east, north, up are not one for a frame."""
    e = job().take(np.arange(6))
    e = replace(e, stated=StatedSigmas((1.0, 2.0, 3.0), (4.0, 5.0, 6.0)))
    options = HistoryOptions(Sigmas(reading=0.25))
    (whole,) = histories_of_jobs([blocks(e, [0, 2, 4], [1, 3, 5])], options)
    assert whole.estimate.stated == e.stated and whole.estimate.units == e.units
    assert whole.uncertainty.sigmas.landmark.tolist() == [1.0, 2.0, 3.0]
    assert whole.uncertainty.sigmas.position.tolist() == [4.0, 5.0, 6.0]


@pytest.mark.parametrize("rate", [0.0, -1.0, np.nan])
def test_every_way_refuses_a_rate_that_is_none(rate: float) -> None:
    for way in (*WAYS.values(), history):
        with pytest.raises(VopdError) as raised:
            way(job(), max_rate_deg_s=rate)
        assert_approved(str(raised.value), parts=[f"{rate:g}"])
