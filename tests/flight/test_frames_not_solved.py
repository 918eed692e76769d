"""Frames without an attitude by reason, picks that are set aside, and labels of frames."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from vopd.findings import Finding
from vopd.flight.result import _unsolved, frame_label

FEW = "fewer than two landmarks: two of three angles at most, no attitude"
LINE = "its landmarks lie on one line of sight, or too few can be used"


def told(
    picks: list[int], lost: list[bool], unknown: tuple[int, ...] = (), names: bool = False
) -> list[Finding]:
    """What is said of frames with so many picks, some without an attitude or a position."""
    frames = len(picks)
    rotation, position = np.ones((frames, 3, 3)), np.ones((frames, 3))
    rotation[lost] = np.nan
    position[list(unknown)] = np.nan
    flight: Any = SimpleNamespace(
        frame=10 + np.arange(frames),
        image_name=tuple(f"{k}.jpg" for k in range(frames)) if names else (),
        picks=SimpleNamespace(frame=np.repeat(np.arange(frames), picks)),
        path=SimpleNamespace(position_m=position),
        source="flight.toml",
    )
    solved: Any = SimpleNamespace(attitudes=SimpleNamespace(rotation=rotation))
    return _unsolved(flight, solved)


def warning(message: str) -> Finding:
    return Finding(message, "flight.toml", severity="warning")


@pytest.mark.parametrize(("picks", "why"), [(0, FEW), (1, FEW), (2, LINE), (3, LINE), (40, LINE)])
def test_fewer_than_two_picks_are_one_reason_and_others_are_the_other(picks: int, why: str) -> None:
    assert told([5, picks], [False, True]) == [warning(f"frame 11: {why}")]


def test_frames_with_an_attitude_or_without_a_position_are_not_named() -> None:
    assert told([3, 1, 0], [False] * 3) == []
    assert told([3, 1, 0], [True] * 3, unknown=(0, 1, 2)) == []
    assert told([3, 1, 2], [True] * 3, unknown=(0,)) == [
        warning(f"frame 11: {FEW}"), warning(f"frame 12: {LINE}")
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("count", "more"), [(4, ""), (5, ""), (6, " and 1 more"), (12, " and 7 more")]
)
@pytest.mark.parametrize("picks", [1, 2])
def test_five_frames_are_named(count: int, more: str, picks: int) -> None:
    named = ", ".join(f"{k}.jpg" for k in range(min(count, 5)))
    why = FEW if picks == 1 else LINE
    assert told([picks] * count, [True] * count, names=True) == [warning(f"{named}{more}: {why}")]


def test_a_frame_is_called_by_its_image_or_its_own_number() -> None:
    flight: Any = SimpleNamespace(frame=np.array([7, 5]), image_name=())
    assert [frame_label(flight, k) for k in (0, 1)] == ["frame 7", "frame 5"]
    flight.image_name = ("a.jpg", "b.jpg")
    assert [frame_label(flight, k) for k in (0, 1)] == ["a.jpg", "b.jpg"]
