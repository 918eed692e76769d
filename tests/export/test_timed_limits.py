"""Which frames a file with dates has: both sides of every limit, the order, and what is said."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import refused
from tests.kit.estimates import estimate
from vopd.attitude.history import History, history
from vopd.export.ccsds import continuous, timed_attitudes
from vopd.findings import Finding, VopdError

ZERO = datetime(2026, 5, 1, tzinfo=UTC)
FRAMES = 4


def flight(**changes: Any) -> History:
    """Four frames, at 0, 1, 2 and 3 s."""
    return history(estimate(np.tile([140.0, -60.0, 20.0], (FRAMES, 1)), **changes))


PLAIN = flight()


def kept(one: History, epoch: datetime | None = ZERO) -> tuple[list[int], list[str]]:
    said: list[Finding] = []
    (found,) = timed_attitudes([one], epoch, said.append)
    assert {one.severity for one in said} <= {"warning"}
    return found.frames.tolist(), [str(one) for one in said]


def moved(time_s: list[float]) -> History:
    return replace(PLAIN, estimate=replace(PLAIN.estimate, time_s=np.array(time_s)))


def put(**changes: Any) -> History:
    here = replace(PLAIN.estimate.position, **changes)
    return replace(PLAIN, estimate=replace(PLAIN.estimate, position=here))


GONE = "hand.toml: job 1: frame DJI_000{}.JPG, row {}, is left out: {}"


@pytest.mark.parametrize(
    ("time_s", "frames", "twice"),
    [
        ([0.0, 1.0, 2.0, 3.0], [0, 1, 2, 3], []),
        ([3.0, 2.0, 1.0, 0.0], [3, 2, 1, 0], []),
        ([5.0, 5.0, 5.0, 1.0], [3, 0], [(1, 2, 1), (2, 3, 1)]),
        ([2.0, 1.0, 2.0000004, 1.0000006], [1, 3, 0], [(2, 3, 1)]),
        ([1.0000005, 1.0000015, 9.0, 8.0], [0, 1, 3, 2], []),
        ([-1.0, -1.0000004, 0.0, -0.0], [1, 2], [(0, 1, 2), (3, 4, 3)]),
    ],
)
def test_frames_are_in_order_and_each_microsecond_stands_once(
    time_s: list[float], frames: list[int], twice: list[tuple[int, int, int]]
) -> None:
    told = [GONE.format(k, row, f"it has the time of row {first}") for k, row, first in twice]
    assert kept(moved(time_s)) == (frames, told)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("time_s", "epoch", "there"),
    [(1e12, None, True), (1.001e12, None, False), (1e12, ZERO, False), (5e10, ZERO, True)],
)
def test_times_that_have_no_date(
    time_s: float, epoch: datetime | None, there: bool, sign: float
) -> None:
    """Without an epoch up to a million million seconds; with one the years 1 to 9999."""
    frames, said = kept(moved([0.0, sign * time_s, 2.0, 3.0]), epoch)
    assert (1 in frames, len(frames)) == (there, 3 + there)
    why = f"its time of {sign * time_s:g} s is outside the years 1 to 9999"
    assert said == ([] if there else [GONE.format(1, 2, why)])


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_leaves_a_frame_out(value: float) -> None:
    """A time, an angle, each part of a position, an axis, a part of the quaternion."""
    e = PLAIN.estimate
    for name in ("longitude_deg", "latitude_deg", "altitude"):
        spoiled = getattr(e.position, name).copy()
        spoiled[2] = value
        assert kept(put(**{name: spoiled})) == ([0, 1, 3], []), name
    axes = e.position.north_east_down.copy()
    axes[2, 1, 2] = value
    assert kept(put(north_east_down=axes)) == ([0, 1, 3], [])
    for part in range(4):
        turn = PLAIN.quaternion.copy()
        turn[2, part] = value
        assert kept(replace(PLAIN, quaternion=turn)) == ([0, 1, 3], [])
    angles = e.vehicle_deg.copy()
    angles[2, 1] = value
    assert kept(replace(PLAIN, estimate=replace(e, vehicle_deg=angles))) == ([0, 1, 3], [])
    assert kept(moved([0.0, 1.0, value, 3.0])) == ([0, 1, 3], [])


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_positions_farther_than_1e15_m_are_left_out(sign: float) -> None:
    for altitude, there in ((0.999e15, True), (1e15, False)):
        high = put(altitude=np.array([0.0, 0.0, sign * altitude, 0.0]))
        assert (2 in kept(high)[0]) == there


def test_positions_are_longitude_latitude_and_metres() -> None:
    """Of a source in feet too; jobs without a frame are left out, and where all are, said."""
    feet = replace(PLAIN.estimate, units=PLAIN.estimate.units._replace(metres_per_length=0.25))
    none = moved([np.nan] * FRAMES)
    found = timed_attitudes([none, replace(PLAIN, estimate=feet), PLAIN], ZERO, print)
    assert len(found) == 2
    assert np.round(found[0].position[1], 9).tolist() == [7.441, 46.95, 300.0]
    assert np.round(found[1].position[3], 9).tolist() == [7.443, 46.95, 1200.0]
    assert found[0].microseconds == [0, 1_000_000, 2_000_000, 3_000_000]
    assert found[0].quaternion.tolist() == PLAIN.quaternion.tolist()
    for jobs in ([], [none]):
        with refused(VopdError):
            timed_attitudes(jobs, ZERO, print)


@pytest.mark.parametrize(
    ("given", "signs"),
    [
        ([1, 1, 1], [1, 1, 1]), ([1, -1, 1], [1, -1, 1]), ([-1, 1, 1], [1, -1, -1]),
        ([1, -1, -1], [1, -1, -1]), ([1], [1]), ([], []),
    ],
)  # fmt: skip
def test_signs_that_make_neighbours_near(given: list[int], signs: list[int]) -> None:
    """The first keeps its sign; quaternions at right angles keep theirs."""
    q = np.array(given, float)[:, None] * np.array([[0.5, 0.5, -0.5, 0.5]])
    assert continuous(q).tolist() == (q * np.array(signs, float)[:, None]).tolist()
    across = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, -1.0, 0.0, 0.0]])
    assert continuous(across)[1].tolist() == [0.0, 1.0, 0.0, 0.0]
