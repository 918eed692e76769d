"""Runs of the tracker over drawn frames of a plain: wrong clicks, clicks anew, and losses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.kit.plain import EVERY, Plain
from tests.tolerances import within
from vopd.tracking import tracker as rooms
from vopd.tracking.tracker import (
    AMBIGUOUS,
    CLICKED,
    EDGE,
    FOUND,
    LOST,
    TRACKED,
    UNKNOWN,
    Beginning,
    Tracker,
)


@pytest.mark.parametrize(
    ("readout_s", "lever_m"), [(0.0, None), (0.08, None), (0.0, (1.0, 2.0, 3.0))]
)
def test_a_wrong_click_spoils_no_frame(
    readout_s: float, lever_m: tuple[float, float, float] | None
) -> None:
    """The fifth of the first frame is 47 px off; also of a camera beside its antenna."""
    plain = Plain(4, (0.003, -0.002, 0.01), readout_s, lever_m=lever_m)
    for last in (EVERY[4], (0, 4, 40.0, 25.0)):
        tracker = plain.run(*EVERY[:4], last)
        assert tracker.attitudes.known.tolist() == [TRACKED] * 4
        assert plain.off_px(tracker).max() < within("running attitude")


def test_clicks_that_agree_with_each_other_alone_begin_anew() -> None:
    """Those of frame 3 are all 30 px to the right; or each elsewhere, which tells nothing."""
    plain = Plain(5, (0.003, -0.002, 0.01))
    tracker = plain.run(*EVERY, *((3, mark, 30.0, 0.0) for mark in range(5)))
    assert tracker.beginnings == [Beginning(0, -1), Beginning(3, 3)]
    apart = [(30.0, 0.0), (-30.0, 5.0), (0.0, 30.0), (5.0, -30.0), (20.0, 20.0)]
    tracker = plain.run(*EVERY, *((3, mark, *off) for mark, off in enumerate(apart)))
    assert tracker.beginnings == [Beginning(0, -1)]
    assert plain.off_px(tracker).max() < within("running attitude")


def test_from_where_a_track_was_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    """Black frames are hidden, and no cut before there are too many; so is ground that changes."""
    plain = Plain(9, (0.003, -0.002, 0.01))
    again = [(8, mark, 0.0, 0.0) for mark in range(5)]
    tracker = plain.run(*EVERY, *again, black=(2, 3))
    assert tracker.beginnings == [Beginning(0, -1)]
    assert tracker.attitudes.known[[1, 2, 3, 4]].tolist() == [TRACKED, UNKNOWN, UNKNOWN, TRACKED]
    monkeypatch.setattr(rooms, "HIDDEN", 2)
    tracker = plain.run(*EVERY, *again, black=range(3, 8))
    assert tracker.beginnings == [Beginning(0, -1), Beginning(8, 3)]
    monkeypatch.setattr(rooms, "PREDICTED", 3)
    tracker = plain.run(*EVERY, *again, marks=range(2, 8))
    assert tracker.beginnings == [Beginning(0, -1), Beginning(8, 2)]


def test_a_camera_that_turns_faster_and_faster_is_followed() -> None:
    """By 2 to 19 degrees from a frame to the next, which turns as before and a little more.

    In frame 4 the ground around the landmarks is another: three that agree are enough.
    """
    plain = Plain(7, (0.0, 0.0, 0.03), power=2.0)
    for around in ((), (4,)):
        tracker = plain.run(*EVERY, around=around)
        assert tracker.attitudes.known.tolist() == [TRACKED] * 7
        assert plain.off_px(tracker).max() < within("running attitude")
    plain = Plain(6, (0.0, 0.0, 0.12))  # 7 degrees a frame, and 21 behind two that are black
    tracker = plain.run(*EVERY, black=(3, 4))
    assert tracker.attitudes.known[5] == TRACKED
    assert plain.off_px(tracker)[5] < within("running attitude")


def statuses(plain: Plain, tracker: Tracker, *frames: int) -> list[list[int]]:
    """Match some frames with all clicks: the statuses of their rows."""
    wanted = np.isin(np.arange(len(plain.time_s)), frames)
    pictures = ((k, plain.grey(k)) for k in range(len(plain.time_s)))
    return [block["status"].tolist() for block in tracker.second(pictures, wanted)]


def test_the_rows_of_a_frame() -> None:
    """One for each landmark; two that come within 12 px of the edge, one that is not clicked."""
    plain = Plain(10, (0.0, 0.0, 0.005))
    tracker = plain.run(*EVERY[:4])
    first, *others = statuses(plain, tracker, 0, 5, 9)
    assert first == [CLICKED] * 4 + [LOST]
    assert others == [[FOUND] * 4 + [LOST], [EDGE, FOUND, EDGE, FOUND, LOST]]


def test_patches_may_be_off_by_the_error_of_either_place() -> None:
    """The clicked frame was 15 m higher than is known: at its corners .9 px."""
    plain = Plain(2, (0.0, 0.0, 0.005))
    plain.scene.path.position_m[0, 0] -= 15.0
    for sigma_m, expected in ((None, {FOUND, AMBIGUOUS}), (np.array([15.0, 0.01]), {FOUND})):
        plain.scene = replace(plain.scene, place_sigma_m=sigma_m)
        assert {*statuses(plain, plain.run(*EVERY), 1)[0]} == expected
