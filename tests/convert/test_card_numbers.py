"""Numbers of landmarks and frames on cards, from both sides of what their columns hold."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from vopd.convert.flight_to_deck import frame_numbers, frame_times, landmark_numbers
from vopd.findings import VopdError
from vopd.flight.flight import LandmarkSet

NONE = np.zeros(0)


def marks(*names: str) -> Any:
    return SimpleNamespace(landmarks=LandmarkSet(names, NONE, NONE))


@pytest.mark.parametrize(
    ("names", "seen", "number", "kept"),
    [
        (("7", "99", "1"), [0, 1, 2], [7, 99, 1], True),
        (("7", "100", "1"), [0, 1, 2], [1, 2, 3], False),
        (("7", "100", "1"), [0, 2], [7, 0, 1], True),  # that of 100 is not seen
        (("7", "0", "1"), [0, 1, 2], [1, 2, 3], False),
        (("7", "b", "1"), [0, 2], [1, 0, 2], False),  # with b they have the numbers 1 and 3
        (("b", "c"), [1], [0, 1], False),
    ],
)
def test_landmarks_keep_numbers_from_1_to_99(
    names: tuple[str, ...], seen: list[int], number: list[int], kept: bool
) -> None:
    found, rows = landmark_numbers(marks(*names), np.array(seen))
    assert found.tolist() == number
    if kept:
        assert rows == []
    else:
        assert [tuple(row) for row in rows] == [("landmark", number[k], names[k]) for k in seen]


@pytest.mark.parametrize("count", [99, 100])
def test_99_landmarks_are_the_most(count: int) -> None:
    flight = marks(*(f"mark {k}" for k in range(150)))
    if count == 99:
        assert landmark_numbers(flight, np.arange(99))[0].tolist() == [*range(1, 100), *[0] * 51]
        return
    with pytest.raises(VopdError) as refused:
        landmark_numbers(flight, np.arange(100))
    assert str(refused.value) == "100 landmarks: cards have numbers for 99; punch a part of them"


@pytest.mark.parametrize(
    ("own", "images", "frames", "number", "names"),
    [
        ([5, 0, 9999], (), [0, 1, 2], [5, 0, 9999], None),
        ([5, 0, 10000], (), [0, 1, 2], [1, 2, 3], ["5", "0", "10000"]),
        ([5, 0, 10000], (), [1, 0], [0, 5], None),
        ([5, -1, 3], (), [1, 2], [1, 2], ["-1", "3"]),
        ([0, 1, 2], ("a.jpg", "b.jpg", "c.jpg"), [2, 0], [1, 2], ["c.jpg", "a.jpg"]),
    ],
)
def test_frames_keep_numbers_from_0_to_9999(
    own: list[int], images: Any, frames: list[int], number: list[int], names: Any
) -> None:
    flight: Any = SimpleNamespace(frame=np.array(own), image_name=images)
    found, rows = frame_numbers(flight, np.array(frames))
    assert found.tolist() == number
    expected = [("frame", n, name) for n, name in zip(number, names or [], strict=False)]
    assert [tuple(row) for row in rows] == expected


@pytest.mark.parametrize("count", [9999, 10000])
def test_9999_frames_are_the_most(count: int) -> None:
    flight: Any = SimpleNamespace(frame=np.arange(count), image_name=())
    if count == 9999:
        assert frame_numbers(flight, np.arange(count))[1] == []
        return
    with pytest.raises(VopdError) as refused:
        frame_numbers(flight, np.arange(count))
    assert str(refused.value) == "10000 frames: cards have numbers for 9999; punch a part of them"


@pytest.mark.parametrize(
    ("own", "time_s", "noted"),
    [
        ([2.0, 2.1, 7.5], [2.0, 2.1, 7.5], False),
        ([2.00000000049, 3.0], [2.0, 3.0], False),  # ten columns with sign and point
        ([2.0, 2.0, 3.0], [0.0, 1.0, 2.0], True),
        ([2.0, 1.0], [0.0, 1.0], True),
        ([2.0, np.nan], [0.0, 1.0], True),
        ([np.nan], [0.0], True),
        ([5.0], [5.0], False),
    ],
)
def test_times_that_increase_are_those_of_the_frames(
    own: list[float], time_s: list[float], noted: bool
) -> None:
    flight: Any = SimpleNamespace(time_s=np.array([-99.0, *own]))
    found, notes = frame_times(flight, np.arange(1, len(own) + 1))
    assert found.tolist() == time_s
    note = "the frames have no times that increase: on the cards they are a second apart"
    assert notes == [note] * noted
