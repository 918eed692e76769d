"""Which mistake is named: limits from both sides, the order of trials, and every sentence."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from vopd.findings import VopdError
from vopd.flight import mistakes as search
from vopd.flight.mistakes import MistakeTrial, _exchanged, other_clock, usual_mistakes

ANY: Any = None
UNEXPLAINED = (
    "px in a typical frame: no usual mistake explains them; look at the coordinates and names of "
    "the landmarks, at the lens (of this camera, at this image size?), and at what the frames' "
    "numbers and times mean"
)


def named(
    monkeypatch: pytest.MonkeyPatch,
    before: float,
    tried: list[tuple[float, str]],
    exchanged: tuple[str, ...] = (),
    sigma: tuple[float, ...] = (1.0,),
) -> list[str]:
    """What is said of a flight with these residuals, and with those of its trials."""
    limits: list[float] = []

    def searched(_: Any, limit: float) -> Any:
        limits.append(limit)
        return iter(exchanged)

    flight = SimpleNamespace(picks=SimpleNamespace(sigma_px=np.array(sigma)))
    monkeypatch.setattr(search, "some_frames", lambda one: one)
    monkeypatch.setattr(search, "typical_px", lambda *_: before)
    monkeypatch.setattr(search, "trials", lambda *_: (MistakeTrial(*one) for one in tried))
    monkeypatch.setattr(search, "_exchanged", searched)
    result: Any = SimpleNamespace(flight=flight, estimate=None)
    said = [*usual_mistakes(ANY, result)]
    assert limits in ([], [5.0 * float(np.median(sigma))])
    return said


@pytest.mark.parametrize(("before", "said"), [(1.99, False), (2.0, False), (2.01, True)])
def test_mistakes_are_tried_from_twice_the_usual_sigma_on(
    before: float, said: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    for scale, sigma in ((1.0, (1.0,)), (0.5, (0.4, 0.5, 9.0))):
        found = named(monkeypatch, before * scale, [(0.01, "with v upward")], sigma=sigma)
        text = f"residuals are {before * scale:.1f} px in a typical frame, and 0.0 px with v upward"
        assert found == [text] * said


@pytest.mark.parametrize(("left", "said"), [(1.99, True), (2.0, False), (2.01, False)])
def test_a_mistake_is_named_where_residuals_are_a_fifth_without_it(
    left: float, said: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = named(monkeypatch, 10.0, [(50.0, "this"), (left, "that")])
    expected = f"residuals are 10.0 px in a typical frame, and {left:.1f} px that"
    assert found == [expected if said else f"residuals are 10.0 {UNEXPLAINED}"]


@pytest.mark.parametrize(
    ("tried", "best"),
    [
        ([(1.29, "first"), (1.0, "second")], "first"),
        ([(1.31, "first"), (1.0, "second")], "second"),
        ([(1.0, "first"), (0.9, "second")], "first"),
        ([(9.0, "first"), (1.0, "second"), (0.99, "third")], "second"),
    ],
)
def test_the_first_of_those_that_fit_alike_is_named(
    tried: list[tuple[float, str]], best: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    (said,) = named(monkeypatch, 100.0, tried, ("not looked for",))
    assert said.endswith(f" px {best}")


@pytest.mark.parametrize(
    ("before", "exchanged", "said"),
    [
        (1.0, (), []),
        (4.9, (), []),
        (5.0, (), []),
        (5.1, (), [f"residuals are 5.1 {UNEXPLAINED}"]),
        (5.1, ("a and b",), ["a and b"]),
        (1.0, ("a and b", "c and d"), ["a and b", "c and d"]),
    ],
)
def test_residuals_are_unexplained_from_five_sigmas_on(
    before: float, exchanged: tuple[str, ...], said: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert named(monkeypatch, before, [], exchanged) == said
    assert named(monkeypatch, before, [(float("inf"), "x")], exchanged) == said


class Frames:
    """Estimates of frames that have each so many landmarks and one residual, in two blocks."""

    def __init__(self, counts: list[int], rms_px: list[float]) -> None:
        self.counts, self.rms_px = np.array(counts), np.array(rms_px)
        half = len(counts) // 2
        every = np.arange(len(counts))
        self.blocks = [SimpleNamespace(frames=every[half:]), SimpleNamespace(frames=every[:half])]

    def of(self, frames: Any) -> Any:
        most = max(int(self.counts[frames].max()), 1)
        used = np.arange(most) < self.counts[frames][:, None]
        pairs = np.concatenate([used, used], axis=1)
        return SimpleNamespace(
            used=used,
            residual=pairs * self.rms_px[frames][:, None],
            landmark=np.tile(np.arange(most) + 10, (len(frames), 1)),
            landmark_label=lambda number: f"mark {number}",
            frame=frames,
        )


def found(
    monkeypatch: pytest.MonkeyPatch, frames: Frames, after: float = 0.1
) -> tuple[list[str], list[int]]:
    tried: list[int] = []

    def best(estimate: Any, row: int) -> Any:
        tried.append(int(estimate.frame[0]))
        return (0, 2), after

    monkeypatch.setattr(search, "best_exchange", best)
    monkeypatch.setattr(search, "frame_label", lambda _, k: f"frame {k}")
    flight = SimpleNamespace(frame=np.arange(len(frames.counts)))
    result: Any = SimpleNamespace(flight=flight, estimates=frames)
    with np.errstate(all="ignore"):
        return [*_exchanged(result, 5.0)], tried


def test_frames_above_the_limit_are_searched_in_order(monkeypatch: pytest.MonkeyPatch) -> None:
    frames = Frames([4, 4, 3, 2, 0, 4], [5.0, 5.01, 20.0, 20.0, 0.0, 9.0])
    said, tried = found(monkeypatch, frames)
    assert tried == [1, 2, 5]  # two landmarks fit when they are exchanged, or not, and say nothing
    assert said == [
        f"frame {k}: mark 10 and mark 12 exchanged? Residuals are {px} px, and 0.1 px if they are"
        for k, px in ((1, "5.0"), (2, "20.0"), (5, "9.0"))
    ]


@pytest.mark.parametrize(("after", "said"), [(3.99, 1), (4.0, 0), (4.01, 0)])
def test_an_exchange_makes_residuals_a_fifth(
    after: float, said: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert len(found(monkeypatch, Frames([5, 0], [20.0, 0.0]), after)[0]) == said


def test_fifty_frames_are_searched(monkeypatch: pytest.MonkeyPatch) -> None:
    assert found(monkeypatch, Frames([3] * 60, [9.0] * 60))[1] == list(range(50))


def test_pairs_times_picks_of_all_frames_are_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    """20 landmarks are 190 pairs of 20 picks, 3,800; 26 frames 98,800, and a small one fits."""
    monkeypatch.setattr(search, "MOST_LANDMARKS", 20)
    counts = [20] * 26 + [3, 30, 3]
    assert found(monkeypatch, Frames(counts, [9.0] * 29))[1] == list(range(27))


@pytest.mark.parametrize(
    ("offset", "covers", "hint"),
    [(None, -18, "-18"), (2, -16, "-18"), (2.5, 20.5, "+18"), (2, 99, ""), ("2", -16, "")],
)
def test_a_clock_by_which_a_track_covers_frames(
    offset: Any, covers: float, hint: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whole numbers and others; an offset that is no number is told of elsewhere."""

    def flight_of(changed: Any) -> None:
        if changed != ("track", "offset_s", covers):
            raise VopdError("does not cover any frame")

    monkeypatch.setattr(search, "flight_of", flight_of)
    values = {} if offset is None else {"offset_s": offset}
    project: Any = SimpleNamespace(
        has=lambda name: name == "track",
        section=lambda name: SimpleNamespace(values=values),
        changed=lambda *what: what,
    )
    said = f"; with the track {hint} s, as GPS time is ahead of UTC, it does" if hint else ""
    assert other_clock(project) == said
    project.has = lambda name: False
    assert other_clock(project) == ""
