"""Histories of long jobs: ways to a history, blocks, parts, the sample of the reading sigma."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit.estimates import ABOUT, POINTS, estimate
from tests.tolerances import assert_close
from vopd.arrays import Ints
from vopd.attitude import long_history
from vopd.attitude.findings import summary_of
from vopd.attitude.history import History, HistoryOptions, history
from vopd.attitude.long_history import (
    HistoryParts,
    frame_landmarks,
    histories_of_jobs,
    history_of_long_job,
    one_part,
    sampled_reading_sigma,
)
from vopd.attitude.reading_sigma import JobReadingSigma
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.table import TableArrays, table
from vopd.attitude.uncertainty import block_reading_sigma
from vopd.attitude.vertical import with_vertical
from vopd.estimate import Block, Estimate, StatedSigmas
from vopd.findings import VopdError
from vopd.landmark_layout import AT_ONCE, TOGETHER, LandmarkLayout

ANGLES = np.array([[140.0 + 3.0 * (k == 5), -60.0, 20.0] for k in range(9)])
RATE = 1.2
OPTIONS: dict[str, dict[str, Any]] = {
    "given": {
        "sigmas": Sigmas(reading=0.25, position=3.0, mount_deg=0.1),
        "max_rate_deg_s": RATE,
    },
    "estimated": {"sigmas": Sigmas(landmark=0.2, wind=1.0)},
    "other vertical": {"sigmas": Sigmas(reading=0.25), "vertical": "geocentric"},
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
    given = HistoryOptions(**OPTIONS[options])
    turned = with_vertical(job(), given.vertical)
    one = history(turned, sigmas=given.sigmas, max_rate_deg_s=given.max_rate_deg_s)
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
    [("estimated", 1000, 12), ("given", 15, 1000), ("given", 25, 8), ("other vertical", 15, 1000)],
)
def test_parts_of_a_long_job_are_those_of_the_whole(
    options: str, together: int, at_once: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One run of several blocks, several runs of one block, several of several."""
    monkeypatch.setattr(long_history, "TOGETHER", together)
    monkeypatch.setattr(long_history, "AT_ONCE", at_once)
    given, e = OPTIONS[options], job()
    layout = LandmarkLayout(np.full(9, 4))
    parts = history_of_long_job(layout, e.take, HistoryOptions(**given))
    plain, expected = alone(options)
    assert parts.frames == 9 and parts.about == plain.estimate.about
    made = [*parts]
    if together == 1000:
        assert len(made) == 1
    else:
        assert len(made) > 1 and len(parts.head.estimate.frame) == 1
    first = 0
    for one in made:
        for name, values in table([one]).items():
            same(name, values, expected[name][first : first + len(values)])
        for frames, block in one.estimates():
            assert block == with_vertical(e.take(first + frames), given.get("vertical"))
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
    monkeypatch.setattr(long_history, "SAMPLE", sample)
    e, given = job(), Sigmas(position=3.0, fiducial=0.2)
    layout = Mixed(np.full(9, 4))
    parts = history_of_long_job(layout, e.take, HistoryOptions(given, RATE))
    scale = long_history.sampled_reading_sigma(layout, e.take, given)
    assert scale.source == ("sample" if sample < 36 else "residuals")
    whole = block_reading_sigma(e, given, scale).chance if sample < 36 else scale.chance
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


# What is put together of the blocks of a job: order, empty elements, and jumps between blocks


BLOCK_ANGLES = np.array([[140.0 + k, -60.0, 20.0] for k in range(5)])
OF_THREE, OF_FOUR = np.array([0, 3]), np.array([1, 2, 4])


def block(frames: Ints, count: int, **changes: Any) -> Block:
    """These frames with so many landmarks; residuals are ten times the frame's index, and more."""
    residual = 1e-3 * (10.0 * frames[:, None] + np.arange(2.0 * count))
    one = estimate(
        BLOCK_ANGLES[frames], POINTS[:count], residual=residual, frame=frames + 1,
        time_s=frames.astype(float), frame_names=[f"{k}.jpg" for k in frames], **changes,
    )  # fmt: skip
    return frames, one


def whole_of(*blocks: Block) -> History:
    (whole,) = histories_of_jobs([blocks], HistoryOptions(Sigmas(reading=1.0)))
    return whole


def test_frames_of_blocks_with_other_numbers_of_landmarks() -> None:
    """The frames are in their order, and each block still has its landmarks."""
    blocks = [block(OF_FOUR, 4), block(OF_THREE, 3)]
    whole = whole_of(*blocks)
    e = whole.estimate
    assert e.frame.tolist() == [1, 2, 3, 4, 5] and e.time_s.tolist() == [0, 1, 2, 3, 4]
    assert e.frame_names == [f"{k}.jpg" for k in range(5)]
    assert np.array_equal(e.camera_deg, BLOCK_ANGLES)
    assert whole.landmarks.tolist() == [3, 4, 4, 3, 4]
    for (frames, one), (own, other) in zip(whole.estimates(), blocks, strict=True):
        assert frames is own and one is other


def test_landmarks_of_all_frames_in_the_order_of_the_frames() -> None:
    ignored = np.zeros((3, 4), bool)
    used = np.ones((3, 4), bool)
    used[0, 0], ignored[0, 0] = False, True  # of frame 1
    used[2, 1] = False  # of frame 4: neither takes part nor was left out
    blocks = [block(OF_FOUR, 4, used=used, ignored=ignored), block(OF_THREE, 3)]
    found = frame_landmarks(whole_of(*blocks))
    assert found.frame.tolist() == [0] * 3 + [1] * 4 + [2] * 4 + [3] * 3 + [4] * 3
    assert found.landmark.tolist() == [7, 8, 9, *[7, 8, 9, 10] * 2, 7, 8, 9, 7, 9, 10]
    left = np.flatnonzero(found.ignored)
    assert left.tolist() == np.flatnonzero(~found.used).tolist() == [3]
    assert np.isnan(found.residual[3]).all() and np.array_equal(found.image[3], POINTS[0])
    assert found.residual[4].tolist() == [0.011, 0.015]


@pytest.fixture
def in_pairs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make parts of two frames of four landmarks."""
    monkeypatch.setattr(long_history, "TOGETHER", 10)
    monkeypatch.setattr(long_history, "AT_ONCE", 8)


def jumps_of(rate: float | None, **arrays: Any) -> list[int]:
    """The frames of a long job of four landmarks a frame that turn too fast."""
    count = len(arrays["time_s"])

    def of(frames: Ints) -> Estimate:
        some = {name: values[frames] for name, values in arrays.items()}
        return estimate(some.pop("camera_deg"), **some)

    layout = LandmarkLayout(np.full(count, 4))
    job = history_of_long_job(layout, of, HistoryOptions(Sigmas(reading=1.0), rate))
    parts = [part.flags.raised["jump"] for part in job]
    assert len(parts) > 1
    assert np.array_equal(np.concatenate(parts), job.whole.flags.raised["jump"])
    return np.flatnonzero(np.concatenate(parts)).tolist()


@pytest.mark.usefixtures("in_pairs")
@pytest.mark.parametrize("turns", ["vehicle", "camera"])
def test_jumps_of_a_long_job_are_the_vehicle_s(turns: str) -> None:
    """Frame 2 is turned by 50 degrees against both neighbours."""
    turned = BLOCK_ANGLES.copy()
    turned[2, 0] += 50.0
    vehicle, camera = (turned, BLOCK_ANGLES) if turns == "vehicle" else (BLOCK_ANGLES, turned)
    arrays = {"camera_deg": camera, "vehicle_deg": vehicle, "time_s": np.arange(5.0)}
    assert jumps_of(10.0, **arrays) == ([2] if turns == "vehicle" else [])
    assert jumps_of(60.0, **arrays) == jumps_of(None, **arrays) == []


@pytest.mark.usefixtures("in_pairs")
@pytest.mark.parametrize(
    ("yaws", "jump"),
    [
        ([0, 1, 2, 3], []), ([0, 20, 40, 60], [0, 1, 2, 3]), ([0, 1, 40, 3, 4], [2]),
        ([50, 1, 2, 3], [0]), ([0, 1, 2, 50], [3]), ([0, 1, 41, 42], [1, 2]),
    ],
)  # fmt: skip
def test_which_frames_of_a_jump_are_named(yaws: list[float], jump: list[int]) -> None:
    """Those that differ from both neighbours; of the first and the last one; both of a step."""
    angles = np.array([[yaw, 0.0, 0.0] for yaw in yaws])
    assert (
        jumps_of(10.0, camera_deg=angles, vehicle_deg=angles, time_s=np.arange(len(yaws))) == jump
    )


@pytest.mark.usefixtures("in_pairs")
def test_the_times_of_a_long_job_stay_with_their_frames() -> None:
    """In time 12 degrees in the first second, then none: only the first is above 10 a second."""
    angles = np.array([[yaw, 0.0, 0.0] for yaw in (0.0, 12.0, 0.0)])
    times = np.array([3.0, 0.0, 1.0])
    assert jumps_of(10.0, camera_deg=angles, vehicle_deg=angles, time_s=times) == [1]


# A history in parts: what is made when, how often, and under which words


LOST = np.full((2, 3), np.nan)


@cache
def some(known: tuple[bool, bool]) -> History:
    """Two frames, of which some have no attitude, and the first has not converged."""
    angles = np.where(np.array(known)[:, None], [140.0, -60.0, 20.0], np.nan)
    e = estimate(np.tile([140.0, -60.0, 20.0], (2, 1)), converged=np.array([False, True]))
    one = history(e, sigmas=Sigmas(reading=1.0))
    return replace(one, estimate=replace(one.estimate, camera_deg=angles, vehicle_deg=angles))


NEITHER, ONE, BOTH = (False, False), (False, True), (True, True)


class Job:
    """A history in parts that counts what is made."""

    def __init__(self, *known: tuple[bool, bool]) -> None:
        self.made: list[str] = []
        self.known = known
        self.parts = HistoryParts(some(known[0]), 2 * len(known), self.make, self.whole)

    def make(self) -> Iterator[History]:
        for k, known in enumerate(self.known):
            self.made.append(f"part {k}")
            yield some(known)

    def whole(self) -> History:
        self.made.append("whole")
        return some(self.known[-1])


@pytest.mark.parametrize(
    ("known", "has", "made"),
    [
        ([NEITHER, NEITHER], False, 2), ([NEITHER, ONE, BOTH], True, 2), ([BOTH, BOTH], True, 1),
        ([ONE], True, 1), ([NEITHER, NEITHER, ONE], True, 3),
    ],
)  # fmt: skip
def test_parts_are_made_up_to_the_first_attitude(
    known: list[tuple[bool, bool]], has: bool, made: int
) -> None:
    job = Job(*known)
    assert job.parts.has_attitude() is has
    assert job.made == [f"part {k}" for k in range(made)]
    assert job.parts.frames == 2 * len(known)


def test_parts_are_made_anew_and_the_whole_once() -> None:
    job = Job(NEITHER, ONE)
    assert [*job.parts] == [some(NEITHER), some(ONE)] and job.parts.counted
    assert job.parts.summary is job.parts.summary
    assert job.made == ["part 0", "part 1"]  # the summary is of the same pass
    assert len([*job.parts]) == 2 and job.made == ["part 0", "part 1"] * 2
    assert job.parts.whole is job.parts.whole is some(ONE)
    assert job.made[4:] == ["whole"]
    assert [*job.parts] == [some(ONE)] and job.made[5:] == []  # it is there already


def test_a_pass_that_is_broken_off_is_no_summary() -> None:
    job = Job(NEITHER, ONE)
    next(iter(job.parts))
    assert not job.parts.counted
    assert job.parts.summary == summary_of([some(NEITHER), some(ONE)]) and job.parts.counted
    assert Job(NEITHER).parts.counted is False
    later = Job(ONE)
    assert later.parts.whole and later.parts.counted


def test_a_second_pass_counts_no_frame_twice() -> None:
    job = Job(NEITHER, ONE)
    flagged = int(some(NEITHER).flags.any().sum() + some(ONE).flags.any().sum())
    for _ in range(3):
        assert len([*job.parts]) == 2
        assert (job.parts.summary.unconverged, job.parts.summary.flagged) == (2, flagged)


def test_other_words_reach_head_parts_and_whole() -> None:
    about = ABOUT._replace(source="other.toml", job=5)
    job = Job(NEITHER, ONE)
    renamed = job.parts.with_about(about)
    assert renamed.about == renamed.head.about == about and renamed.frames == 4
    assert [one.about for one in renamed] == [about] * 2
    assert renamed.whole.about == about
    assert job.parts.about == job.parts.head.about == job.parts.whole.about == ABOUT


def test_who_watches_is_told_of_every_part_before_it_is_used() -> None:
    job = Job(NEITHER, ONE, BOTH)
    seen: list[int] = []
    watched = job.parts.watched(seen.append)
    assert watched.frames == 6 and watched.about == ABOUT and watched.head is job.parts.head
    for k, _ in enumerate(watched, 1):
        assert seen == [2] * k
    assert watched.counted and job.parts.counted
    assert watched.whole is job.parts.whole and job.made.count("whole") == 1


def test_one_part_is_made_already() -> None:
    one = one_part(some(BOTH))
    assert one.counted and one.frames == 2 and one.head is one.whole is some(BOTH)
    assert [*one] == [some(BOTH)] and one.has_attitude()


def test_what_a_summary_counts() -> None:
    """Frames, not flags; labels of frames that misfit with what explains them, part by part."""
    base = some(BOTH)
    numbered = replace(base.estimate, frame=np.array([41, 52]), frame_names=())

    def part(lost: list[int], misfit: list[int], text: list[str]) -> History:
        raised = {name: np.zeros(2, bool) for name in base.flags.raised}
        for name, frames in (("not_converged", lost), ("misfit", misfit), ("jump", misfit)):
            raised[name] = np.isin([0, 1], frames)
        detail = base.flags.detail | {"misfit": text}
        return replace(
            base, estimate=numbered, flags=replace(base.flags, raised=raised, detail=detail)
        )

    found = summary_of([part([0], [0, 1], ["a", "b"]), part([0, 1], [1], ["", "c"])])
    assert (found.unconverged, found.flagged) == (3, 4)
    assert found.misfits == [("41", "a"), ("52", "b"), ("52", "c")]
    empty = summary_of([])
    assert (empty.unconverged, empty.flagged, empty.misfits) == (0, 0, [])
    assert summary_of([part([], [], ["", ""])]) == replace(empty, frames=2)


# The reading sigma of a long job: from which frames, of how many landmarks, and their tests


GIVEN = Sigmas(position=3.0)


class Sampled:
    """What is estimated from the frames that are taken, instead of an estimate."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, source: str = "residuals") -> None:
        self.frames: list[list[int]] = []
        self.source = source
        monkeypatch.setattr(long_history, "job_reading_sigmas", self.scales)

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
    assert long_history.SAMPLE == 25_000
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
    monkeypatch.setattr(long_history, "SAMPLE", 20)
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
    monkeypatch.setattr(long_history, "SAMPLE", 80)
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
    monkeypatch.setattr(long_history, "SAMPLE", 399)
    assert len(sampled.of(counts)[1]) == 50  # one landmark too many: every second frame
    monkeypatch.setattr(long_history, "SAMPLE", 400)
    scale, frames = sampled.of(counts)
    assert len(frames) == 100 and scale.source == source
