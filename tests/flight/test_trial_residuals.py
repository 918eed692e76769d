"""The typical residual of a trial, its freedom, and which frames are tried: by hand."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.kit.flight_project import uneven_flight
from tests.tolerances import assert_close
from vopd.flight import mistakes as trial_residuals
from vopd.flight.mistakes import freedom, solved_trial, some_frames, typical_px

NAN = float("nan")


def flight(frame: list[int], landmark: list[int], frames: int, **more: Any) -> Any:
    used = more.get("used", ())
    position = np.zeros((frames, 3))
    position[more.get("lost", [])] = NAN
    return SimpleNamespace(
        frame=np.arange(frames),
        picks=SimpleNamespace(frame=np.array(frame), landmark=np.array(landmark)),
        landmarks=SimpleNamespace(name=("a", "b", "c"), used=used),
        path=SimpleNamespace(position_m=position),
    )


def estimate(used: list[list[bool]], residual: list[list[float]]) -> Any:
    return SimpleNamespace(used=np.array(used), residual=np.array(residual))


def test_the_root_mean_square_of_the_median_frame() -> None:
    """3 and 4 px in u and v of two picks are 12.5 px2 a coordinate; other frames have 1 and 7."""
    one = flight([0, 0, 1, 1, 2, 2], [0, 1] * 3, 3)
    squares = [[3.0, 3.0, 4.0, 4.0], [1.0] * 4, [7.0, 7.0, 7.0, -7.0]]
    assert_close("ratio", typical_px(one, estimate([[True] * 2] * 3, squares)), np.sqrt(12.5))
    two = flight([0, 0, 1, 1], [0, 1] * 2, 2)
    found = typical_px(two, estimate([[True] * 2] * 2, squares[1:]))
    assert_close("ratio", found, 4.0)  # of two frames the mean


def test_a_pick_without_an_image_counts_a_thousand_pixels() -> None:
    """Once over both coordinates of two picks."""
    one = flight([0, 0], [0, 1], 1)
    found = typical_px(one, estimate([[True, False]], [[2.0, 0.0, 0.0, 0.0]]))
    assert_close("ratio", found, np.sqrt((1000.0**2 + 4.0) / 4))


def test_what_does_not_count() -> None:
    """A check landmark, a frame with one pick, and one without a position."""
    one = flight([0, 0, 0, 1, 2, 2], [0, 1, 2, 0, 0, 1], 3, used=(True, True, False), lost=[2])
    used = [[True, True, False], [False] * 3, [False] * 3]
    residual = [[1.0, 1.0, 0.0, 1.0, 1.0, 0.0], [0.0] * 6, [0.0] * 6]
    assert typical_px(one, estimate(used, residual)) == 1.0
    alone = flight([0, 1], [0, 0], 2)
    assert typical_px(alone, estimate([[False]] * 2, [[0.0] * 2] * 2)) == 1000.0


def test_freedom_is_of_frames_with_an_attitude() -> None:
    """Three picks and two: 6 - 3 and 4 - 3; the last frame has none."""
    given: Any = SimpleNamespace(
        used=np.array([[True, True, True], [True, True, False], [True, True, True]]),
        camera_deg=np.array([[1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [NAN] * 3]),
    )
    assert freedom(given) == 4


@pytest.mark.parametrize(
    ("tried", "frames", "chosen"),
    [
        (3, 7, [0, 3, 6]),
        (3, 6, [0, 2, 4]),
        (3, 4, [0, 2]),
        (3, 3, [0, 1, 2]),
        (500, 2, [0, 1]),
    ],
)
def test_frames_are_chosen_evenly(
    tried: int, frames: int, chosen: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert trial_residuals.FRAMES_TRIED == 500
    monkeypatch.setattr(trial_residuals, "FRAMES_TRIED", tried)
    assert some_frames(uneven_flight([2] * frames)).frame.tolist() == chosen


@pytest.mark.parametrize(
    ("counts", "kept"),
    [
        ([2, 2, 2, 8], [2, 2, 2, 8]),
        ([2, 2, 2, 9], [2, 2, 2]),
        ([1, 1, 1, 4, 4, 16], [1, 1, 1, 4, 4, 16]),  # those with one are not usual frames
        ([1, 1, 1], [1, 1, 1]),
        ([1, 0, 1], [1, 0, 1]),
    ],
)
def test_a_frame_with_more_than_four_times_the_usual_picks_is_left_out(
    counts: list[int], kept: list[int]
) -> None:
    flight = some_frames(uneven_flight(counts))
    assert np.bincount(flight.picks.frame, minlength=len(flight.frame)).tolist() == kept


def test_a_trial_takes_twenty_passes(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[Any] = []
    monkeypatch.setattr(trial_residuals, "solve", lambda *a, **k: given.append((a, k)) or "solved")
    monkeypatch.setattr(trial_residuals, "flight_estimate", lambda solved: f"of {solved}")
    one: Any = "flight"
    assert solved_trial(one) == "of solved"
    assert given == [(("flight",), {"passes": 20})]
