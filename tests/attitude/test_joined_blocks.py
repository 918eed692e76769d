"""What is put together of the blocks of a job: order, empty elements, and jumps between blocks."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.kit.estimates import POINTS, estimate
from vopd.arrays import Ints
from vopd.attitude.long_history import _jumps, frame_landmarks, history_of_blocks
from vopd.attitude.sigmas import Sigmas
from vopd.estimate import Estimate, EstimateBlock
from vopd.landmark_layout import LandmarkLayout

ANGLES = np.array([[140.0 + k, -60.0, 20.0] for k in range(5)])
OF_THREE, OF_FOUR = np.array([0, 3]), np.array([1, 2, 4])


def block(frames: Ints, count: int, **changes: Any) -> EstimateBlock:
    """These frames with so many landmarks; residuals are ten times the frame's index, and more."""
    residual = 1e-3 * (10.0 * frames[:, None] + np.arange(2.0 * count))
    one = estimate(
        ANGLES[frames], POINTS[:count], residual=residual, frame=frames + 1,
        time_s=frames.astype(float), frame_names=tuple(f"{k}.jpg" for k in frames), **changes,
    )  # fmt: skip
    return EstimateBlock(frames, one)


def test_arrays_of_blocks_with_other_numbers_of_landmarks() -> None:
    """A frame of three landmarks has 0 in an axis of image coordinates, x and then y, NaN in one
    of landmarks, and false.
    """
    blocks = [block(OF_FOUR, 4), block(OF_THREE, 3)]
    whole = history_of_blocks(blocks, sigmas=Sigmas(reading=1.0))
    e = whole.estimate
    assert e.frame.tolist() == [1, 2, 3, 4, 5] and e.time_s.tolist() == [0, 1, 2, 3, 4]
    assert e.frame_names == tuple(f"{k}.jpg" for k in range(5))
    assert np.array_equal(e.camera_deg, ANGLES)
    assert e.used.sum(axis=1).tolist() == whole.landmarks.tolist() == [3, 4, 4, 3, 4]
    assert e.landmark[[0, 1]].tolist() == [[7, 8, 9, 0], [7, 8, 9, 10]]
    assert np.isnan(e.image[[0, 3], 3]).all() and np.isnan(e.direction[[0, 3], 3]).all()
    assert np.array_equal(e.image[1], POINTS)
    x, y = np.arange(3.0), np.arange(3.0, 6.0)
    for k in OF_THREE:
        expected = 1e-3 * np.array([*(10.0 * k + x), 0.0, *(10.0 * k + y), 0.0])
        assert np.array_equal(e.residual[k], expected)
        for array in (e.partials[k], e.responses.landmark[k], e.gain[k].T, e.body_gain[k].T):
            assert np.array_equal(array[[3, 7]], np.zeros((2, 3)))
            assert array[[0, 1, 2, 4, 5, 6]].any(axis=1).all()
        assert e.responses.time[k].tolist() == [2, 2, 2, 0, 2, 2, 2, 0]
    for k in OF_FOUR:
        assert np.array_equal(e.residual[k], 1e-3 * (10.0 * k + np.arange(8.0)))
    assert np.isnan(whole.geometry.ahead[[0, 3], 3]).all() and not whole.flags.outlier[:, 3].any()


def test_landmarks_of_all_frames_in_the_order_of_the_frames() -> None:
    ignored = np.zeros((3, 4), bool)
    used = np.ones((3, 4), bool)
    used[0, 0], ignored[0, 0] = False, True  # of frame 1
    used[2, 1] = False  # of frame 4: neither takes part nor was left out
    blocks = [block(OF_FOUR, 4, used=used, ignored=ignored), block(OF_THREE, 3)]
    found = frame_landmarks(history_of_blocks(blocks, sigmas=Sigmas(reading=1.0)))
    assert found.frame.tolist() == [0] * 3 + [1] * 4 + [2] * 4 + [3] * 3 + [4] * 3
    assert found.landmark.tolist() == [7, 8, 9, *[7, 8, 9, 10] * 2, 7, 8, 9, 7, 9, 10]
    left = np.flatnonzero(found.ignored)
    assert left.tolist() == np.flatnonzero(~found.used).tolist() == [3]
    assert np.isnan(found.residual[3]).all() and np.array_equal(found.image[3], POINTS[0])
    assert found.residual[4].tolist() == [0.011, 0.015]


@pytest.mark.parametrize("turns", ["vehicle", "camera"])
def test_jumps_of_a_long_job_are_the_vehicle_s(turns: str) -> None:
    """Frame 2 is turned by 50 degrees against both neighbours."""
    turned = ANGLES.copy()
    turned[2, 0] += 50.0
    vehicle, camera = (turned, ANGLES) if turns == "vehicle" else (ANGLES, turned)

    def of(frames: Ints) -> Estimate:
        return estimate(camera[frames], vehicle_deg=vehicle[frames], time_s=frames.astype(float))

    layout = LandmarkLayout(np.full(5, 4))
    expected = [2] if turns == "vehicle" else []
    assert np.flatnonzero(_jumps(layout, of, 10.0)).tolist() == expected
    assert not _jumps(layout, of, 60.0).any() and not _jumps(layout, of, None).any()


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

    def of(frames: Ints) -> Estimate:
        return estimate(angles[frames], time_s=frames.astype(float))

    found = _jumps(LandmarkLayout(np.full(len(yaws), 4)), of, 10.0)
    assert np.flatnonzero(found).tolist() == jump


def test_the_times_of_a_long_job_stay_with_their_frames() -> None:
    """12 degrees in 3 seconds back, and in 1: only the last frame is above 10 a second."""
    times = np.array([3.0, 0.0, 1.0])
    angles = np.array([[yaw, 0.0, 0.0] for yaw in (0.0, 12.0, 0.0)])

    def of(frames: Ints) -> Estimate:
        return estimate(angles[frames], time_s=times[frames])

    assert np.flatnonzero(_jumps(LandmarkLayout(np.full(3, 4)), of, 10.0)).tolist() == [2]
