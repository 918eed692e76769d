"""Flights in blocks of frames: the same results, memory by the picks, estimates that are kept."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import refused
from tests.kit.command import peak
from tests.kit.estimates import assert_same_landmarks
from tests.kit.flight_project import NOISE_PX, three_frames, uneven_flight
from tests.tolerances import assert_close, within
from vopd.attitude import long_history
from vopd.attitude.history import History, HistoryOptions
from vopd.attitude.long_history import frame_landmarks
from vopd.attitude.mistakes import NOT_SEARCHED
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.table import table
from vopd.export import FORMATS, FileRequest
from vopd.findings import VopdError
from vopd.flight import estimate as estimate_module
from vopd.flight.estimate import FlightEstimates, flight_estimate
from vopd.flight.flight import Flight
from vopd.flight.formats.files import InputFile
from vopd.flight.formats.picks import read_csv_picks as read_picks
from vopd.flight.formats.tables import read_csv
from vopd.flight.misfits.mistakes import some_frames
from vopd.flight.result import FlightResult
from vopd.flight.solve import rotations as solve_module
from vopd.flight.solve.rotations import solve

COUNTS = [4, 3, 5, 2, 1] * 5 + [12] + [6, 4, 0, 3, 5] * 5


@pytest.fixture(autouse=True)
def arm_solved_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """The lever arm is applied once and not four times: it must only be that of its frame."""
    monkeypatch.setattr(solve_module, "LEVER_PASSES", 1)


def result_of(flight: Flight) -> FlightResult:
    return FlightResult(FlightEstimates(solve_module.solve(flight)), ())


def history(flight: Flight) -> History:
    return result_of(flight).history(max_rate_deg_s=3.0)


def in_blocks(monkeypatch: pytest.MonkeyPatch, picks: int, sample: int = 10**6) -> None:
    monkeypatch.setattr(solve_module, "AT_ONCE", picks)
    monkeypatch.setattr(long_history, "AT_ONCE", picks)
    monkeypatch.setattr(long_history, "SAMPLE", sample)


def same(one: np.ndarray, other: np.ndarray) -> None:
    if one.dtype.kind == "f":
        size = np.maximum(np.abs(other), 1.0)
        assert_close("relative, in blocks or not", one / size, other / size)
    else:
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("counts", [COUNTS, [6] * 24])
def test_blocks_give_what_one_block_gives(
    monkeypatch: pytest.MonkeyPatch, counts: list[int]
) -> None:
    flight = uneven_flight(counts)
    monkeypatch.setattr("vopd.landmark_layout.FEW", 10**6)
    whole = history(flight)
    in_blocks(monkeypatch, 30)
    parts = history(flight)
    tables = [table([one]) for one in (parts, whole)]
    assert "outlier" in parts.flags.raised and list(tables[0]) == list(tables[1])
    for name, column in tables[1].items():
        same(tables[0][name], column)
    ((_, one),) = whole.estimates()
    for frames, block in parts.estimates():
        assert_same_landmarks(block, one.take(frames))
    for ours, theirs in zip(*map(frame_landmarks, (parts, whole)), strict=True):
        same(ours, theirs)
    assert parts.about == whole.about and parts.estimate.frame_names == whole.estimate.frame_names


def test_the_reading_sigma_of_a_long_flight_is_that_of_frames_spread_over_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    flight = uneven_flight([6] * 600)
    in_blocks(monkeypatch, 300, sample=900)
    told = history(flight).uncertainty.reading
    assert 9.0 * 140.0 < told.freedom < 9.0 * 160.0  # of one frame in four, 9 each
    assert abs(told.sigma / NOISE_PX - 1.0) < 4.0 / np.sqrt(2.0 * told.freedom)
    assert np.isfinite(told.chance).all() and told.misfit.sum() <= 6  # .6 are expected


@pytest.mark.parametrize("counts", [[1, 6], [6, 1], [1, 1, 1, 6]])
def test_frames_of_one_landmark_do_not_keep_a_long_flight_from_its_reading_sigma(
    monkeypatch: pytest.MonkeyPatch, counts: list[int]
) -> None:
    """Every second picture of a survey may show one landmark alone."""
    flight = uneven_flight(counts * (600 // len(counts)))
    in_blocks(monkeypatch, 300, sample=flight.picks.frame.size // 2)
    told = history(flight).uncertainty.reading
    assert told.source == "sample"
    assert abs(told.sigma / NOISE_PX - 1.0) < 4.0 / np.sqrt(2.0 * told.freedom)


def test_the_reading_sigma_of_a_long_flight_is_that_of_good_and_poor_frames(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """In every second frame the picks are 3 times as noisy: the mean variance is 5 times one."""
    flight = uneven_flight([6] * 600)
    noise = np.random.default_rng(5).normal(0.0, NOISE_PX * 8.0**0.5, (1800, 2))
    flight.picks.pixel[flight.picks.frame % 2 == 0] += noise
    in_blocks(monkeypatch, 300, sample=1800)
    sampled = history(flight).uncertainty.reading
    in_blocks(monkeypatch, 300)
    ratio = sampled.sigma / history(flight).uncertainty.reading.sigma
    assert abs(ratio - 1.0) < 4.0 / np.sqrt(2.0 * sampled.freedom)


def test_searches_for_what_explains_a_misfit_are_as_many_in_blocks(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    flight = uneven_flight([6] * 60)
    wrong = np.arange(0, 60, 5)
    flight.picks.pixel[6 * wrong + 3] += np.array([30.0, 0.0])
    monkeypatch.setattr(long_history, "MOST_FRAMES", 7)
    in_blocks(monkeypatch, 60)
    one = history(flight)
    assert one.flags.raised["misfit"][wrong].all()
    texts = one.flags.detail["misfit"]
    assert [k for k, text in enumerate(texts) if text] == wrong.tolist()
    assert [k for k, text in enumerate(texts) if text == NOT_SEARCHED] == wrong[7:].tolist()


@pytest.mark.parametrize("counts", [COUNTS, [6] * 40])
def test_a_table_written_part_by_part_is_the_table_made_whole(
    monkeypatch: pytest.MonkeyPatch, counts: list[int]
) -> None:
    flight = uneven_flight(counts)
    flight.picks.pixel[::17] += np.array([25.0, 0.0])
    in_blocks(monkeypatch, 30)
    solved, how = result_of(flight), (Sigmas(), 3.0, "geocentric")
    before = FORMATS["csv"].render([solved.history(*how)], FileRequest())
    for module in (long_history, solve_module):
        monkeypatch.setattr(module, "TOGETHER", 75)
    whole = solved.history(*how)
    # of all digits, which jsonl has, the last depends on the blocks
    # of a job in parts the header has the sizes of errors in one frame, not their medians
    assert _sizeless(FORMATS["csv"].render([whole], FileRequest())) == _sizeless(before)
    parts = solved.history_parts(HistoryOptions(*how))
    made = [len(part.estimate.frame) for part in parts]
    assert len(made) > 2 and sum(made) == parts.frames == len(counts)
    for form in ("csv", "jsonl"):
        told_frames: list[int] = []
        watched = parts.watched(told_frames.append)
        pages = b"".join(FORMATS[form].pages([watched], FileRequest()))
        assert pages == FORMATS[form].render([whole], FileRequest())
        assert told_frames == made
    flags = whole.flags
    assert parts.summary.flagged == flags.any().sum() > 0
    told = zip(flags.raised["misfit"], flags.detail["misfit"], strict=True)
    assert [text for _, text in parts.summary.misfits] == [text for raised, text in told if raised]


def _sizeless(table: bytes) -> list[bytes]:
    return [line for line in table.splitlines() if not line.startswith(b"# sigmas_")]


def test_memory_of_a_table_written_part_by_part_is_that_of_a_part(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    solved = result_of(uneven_flight([4] * 800))
    in_blocks(monkeypatch, 200, sample=200)

    def write() -> None:
        for _ in FORMATS["csv"].pages([solved.history_parts(HistoryOptions())], FileRequest()):
            pass

    once = peak(write)
    for module in (long_history, solve_module):
        monkeypatch.setattr(module, "TOGETHER", 400)
    assert peak(write) < once / 3


def test_memory_follows_the_picks_and_not_the_longest_frame() -> None:
    """700 picks in one frame of 101, which would be 70,700 if every frame had as many."""
    wide, narrow = [4] * 50 + [700] + [4] * 50, [9] * 122 + [2]
    assert sum(wide) == sum(narrow)

    def table_of(counts: list[int]) -> Callable[[], object]:
        flight = uneven_flight(counts)
        return lambda: FORMATS["csv"].render([history(flight)], FileRequest())

    assert peak(table_of(wide)) < 2 * peak(table_of(narrow), begun=True)


def test_memory_of_a_long_flight_is_less_than_its_landmarks_would_take(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    flight = uneven_flight([8] * 300)
    once = peak(lambda: history(flight))
    in_blocks(monkeypatch, 200, sample=200)
    assert peak(lambda: history(flight), begun=True) < once / 3


def file(text: str) -> InputFile:
    return InputFile("picks.csv", Path("picks.csv"), text)


HEAD = "frame,landmark,u_px,v_px\n# the camera's\n\n"
ROW = "7,mast,100.125,200.25\n"


def test_rows_of_many_blocks_keep_their_lines() -> None:
    rows = 2 * 2_000 + 5
    picks = read_picks(file(HEAD + ROW * rows))
    assert len(picks.pixel) == rows and (picks.frame == np.full(rows, 7)).all()
    line = read_csv(file(HEAD + ROW * rows)).line
    assert line[0] == 4 and line[rows - 1] == rows + 3
    assert (picks.pixel == [100.125, 200.25]).all() and set(picks.landmark) == {"mast"}


@pytest.mark.parametrize(
    "row",
    [
        "7,mast,1,x\n",
        "7,mast,1\n",
        "7,,1,2\n",
        '7,"mast,1,2\n',
        f"7,{'m' * 200_000},1,2\n",
    ],
)
def test_errors_in_a_late_block_have_their_line(row: str) -> None:
    text = HEAD + ROW * (2 * 2_000 + 5) + row + ROW * 3
    with refused(VopdError):
        read_picks(file(text))


def test_cells_take_the_memory_of_their_text() -> None:
    text = HEAD + ROW * 25_000
    assert peak(lambda: read_csv(file(text))) < 8 * len(text)


def test_a_frame_with_more_digits_than_a_number_holds_is_refused() -> None:
    with refused(VopdError):
        read_picks(file(HEAD + "9" * 19 + ",mast,1,2\n"))


def test_a_frame_is_the_same_alone_or_in_its_flight() -> None:
    flight = uneven_flight([6] * 20)
    part = solve_module.FlightBlocks(flight).part(np.array([4, 9]))
    alone, among = result_of(part.flight), result_of(flight)
    off = alone.vehicle_deg - among.vehicle_deg[[4, 9]]
    assert np.abs(off).max() < within("flight angle")
    assert alone.flight.image_name == ("4.jpg", "9.jpg")
    assert (alone.flight.path.gimbal_deg == flight.path.gimbal_deg[[4, 9]]).all()  # type: ignore[index]


def test_mistakes_are_tried_without_the_longest_frame() -> None:
    few = some_frames(uneven_flight([4] * 6 + [300] + [5] * 6))
    assert np.bincount(few.picks.frame).tolist() == [4] * 6 + [5] * 6
    flight = uneven_flight([4, 1, 5, 1])
    assert some_frames(flight) is flight


def test_frames_with_the_same_picks_are_not_solved_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """One frame loses a pick: it is as if all were solved anew, and the others are untouched."""
    in_blocks(monkeypatch, 20)
    flight = uneven_flight(COUNTS)
    left_out = np.zeros(len(flight.picks.frame), bool)
    left_out[np.flatnonzero(flight.picks.frame == 0)[0]] = True
    before = solve_module.solve(flight)
    before.attitudes.rotation[1] = -1.0  # which nothing but the solve would change
    again = solve_module.solve(flight, left_out, before=before)
    anew = solve_module.solve(flight, left_out)
    same(again.attitudes.rotation[0], anew.attitudes.rotation[0])
    assert not np.array_equal(anew.attitudes.rotation[0], before.attitudes.rotation[0])
    assert (again.attitudes.rotation[1] == -1.0).all()
    for one, other in zip(again.attitudes[3:], anew.attitudes[3:], strict=True):
        same(one, other)


# Which estimates of a flight are kept, and what a result hands on and gives


def test_estimates_of_few_picks_are_kept_and_of_many_made_anew(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert estimate_module.MOST_KEPT == 100_000
    estimates = FlightEstimates(solve(uneven_flight([4, 3, 5])))
    pairs = np.array([0, 2]), np.array([0, 1])
    first, other = (estimates.of(frames) for frames in pairs)
    assert estimates.of(pairs[0].copy()) is first and estimates.of(pairs[1]) is other
    assert first.frame.tolist() == [0, 2] and other.frame.tolist() == [0, 1]
    assert estimates.whole() is estimates.of(np.arange(3))
    for most, same in ((12, True), (11, False)):
        monkeypatch.setattr(estimate_module, "MOST_KEPT", most)
        anew = FlightEstimates(estimates.solved)
        assert (anew.of(pairs[0]) is anew.of(pairs[0])) == same


def test_what_is_said_of_the_whole_flight_is_in_each_part() -> None:
    """Places are counted from the first position of the flight, not of the part."""
    solved = solve(three_frames())
    part, whole = FlightEstimates(solved).of(np.array([2])), flight_estimate(solved)
    assert part.about.words == whole.about.words
    assert np.array_equal(part.displacement, whole.displacement[2:])
    assert np.abs(part.displacement).max() > 1.0


def test_a_history_is_asked_for_with_all_that_is_given(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[Any] = []

    def asked(layout: Any, estimate_of: Any, options: HistoryOptions, *more: Any) -> Any:
        given.append((estimate_of(np.array([1])).frame.tolist(), options))
        return type("Parts", (), {"whole": "the history"})

    monkeypatch.setattr(long_history, "history_of_long_job", asked)
    monkeypatch.setattr("vopd.export.tables.dataframe", lambda histories: histories)
    result = FlightResult(FlightEstimates(solve(three_frames())), ())
    sigmas = Sigmas(mount_deg=0.7)
    assert result.history(sigmas, 5.0, "geocentric") == "the history"
    assert result.to_dataframe(sigmas, 5.0, "geocentric") == ["the history"]
    result.history_parts(HistoryOptions(sigmas, 5.0, "geocentric"))
    assert given == [([9], HistoryOptions(sigmas, 5.0, "geocentric"))] * 3
    given.clear()
    result.history()
    assert given == [([9], HistoryOptions())]


@pytest.mark.parametrize(("sigma_m_s", "counts"), [(0.1, True), (0.0, False)])
def test_a_part_beyond_the_track_has_the_components_of_the_others(
    sigma_m_s: float, counts: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Velocities are not known there; those that are exact are no component anywhere."""
    flight = uneven_flight(COUNTS)
    sigma = np.full((len(COUNTS), 3), sigma_m_s)
    sigma[-20:] = np.nan
    flight = replace(flight, path=replace(flight.path, velocity_sigma_m_s=sigma))
    in_blocks(monkeypatch, 20)
    made = history(flight)
    assert ("velocity" in made.uncertainty.components) == counts
    assert len(made.status) == len(COUNTS)


def test_what_a_result_gives_of_its_flight() -> None:
    flight = replace(three_frames(), about=("a lens", "a track"))
    result = FlightResult(FlightEstimates(solve(flight)), ())
    assert result.flight is flight and result.about == ("a lens", "a track")
    assert result.frame.tolist() == [7, 9, 12] and result.image_name == ("a.jpg", "b.jpg", "c.jpg")
    assert result.time_s.tolist() == flight.time_s.tolist()
    assert result.solved.tolist() == [False, True, True]
    assert len(result.estimate.frame) == 3 and result.estimate is result.estimate
    assert repr(result) == "FlightResult(flight.toml, 3 frames)"
