"""What is put together of the blocks of a job: order, empty elements, and jumps between blocks."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.kit.estimates import POINTS, estimate
from vopd.arrays import Ints
from vopd.attitude import long_history
from vopd.attitude.history import History, HistoryOptions
from vopd.attitude.long_history import (
    frame_landmarks,
    histories_of_jobs,
    history_of_long_job,
)
from vopd.attitude.sigmas import Sigmas
from vopd.estimate import Block, Estimate
from vopd.landmark_layout import LandmarkLayout

ANGLES = np.array([[140.0 + k, -60.0, 20.0] for k in range(5)])
OF_THREE, OF_FOUR = np.array([0, 3]), np.array([1, 2, 4])


def block(frames: Ints, count: int, **changes: Any) -> Block:
    """These frames with so many landmarks; residuals are ten times the frame's index, and more."""
    residual = 1e-3 * (10.0 * frames[:, None] + np.arange(2.0 * count))
    one = estimate(
        ANGLES[frames], POINTS[:count], residual=residual, frame=frames + 1,
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
    assert np.array_equal(e.camera_deg, ANGLES)
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
    turned = ANGLES.copy()
    turned[2, 0] += 50.0
    vehicle, camera = (turned, ANGLES) if turns == "vehicle" else (ANGLES, turned)
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
    """12 degrees in 3 seconds back, and in 1: only the last frame is above 10 a second."""
    angles = np.array([[yaw, 0.0, 0.0] for yaw in (0.0, 12.0, 0.0)])
    times = np.array([3.0, 0.0, 1.0])
    assert jumps_of(10.0, camera_deg=angles, vehicle_deg=angles, time_s=times) == [2]
