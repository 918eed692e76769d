"""What is tried for a frame that misfits, how much of it is told, and in which words."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.kit.estimates import NAMES, POINTS, estimate
from vopd.attitude import mistakes as label_search
from vopd.attitude.mistakes import (
    MOST_IN_A_FRAME,
    MOST_LANDMARKS,
    NOTHING,
    Repair,
    _fitted,
    misfit_text,
    trials,
)
from vopd.attitude.sigmas import Sigmas, in_force

ANGLES = np.tile([140.0, -60.0, 20.0], (4, 1))


def told(
    monkeypatch: pytest.MonkeyPatch, found: list[Repair], misfit: list[bool], **more: Any
) -> list[str]:
    """The text of four frames, where the search finds these repairs in each."""
    monkeypatch.setattr(label_search, "repairs", lambda *_: found)
    e = estimate(ANGLES)
    scale: Any = SimpleNamespace(misfit=np.array(misfit), test_sigma=1.0, freedom=np.inf)
    return misfit_text(e, scale, in_force(e, Sigmas(reading=1.0)), **more)


def test_three_repairs_of_a_frame_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """The likeliest come first; a landmark's name keeps no semicolon, which separates flags."""
    found = [
        Repair((0, 1), None, 0.416), Repair((), 3, 0.3), Repair((), 2, 0.204),
        Repair((2, 3), None, 0.1), Repair((), 0, 0.05),
    ]  # fmt: skip
    names = {k: NAMES[k + 7].replace(";", ",") for k in range(4)}
    texts = [
        f"exchange {names[0]}+{names[1]} (chance 0.42)",
        f"without {names[3]} (chance 0.30)",
        f"without {names[2]} (chance 0.20)",
    ]
    for count in (1, 2, 3, 5):
        text = told(monkeypatch, found[:count], [False, True, False, False])
        assert text == ["", " or ".join(texts[:count]), "", ""]


def test_that_nothing_explains_a_frame_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    assert told(monkeypatch, [], [True, False, False, True]) == [NOTHING, "", "", NOTHING]
    assert told(monkeypatch, [Repair((), 0, 0.5)], [False] * 4) == [""] * 4


@pytest.mark.parametrize("most", [0, 1, 2, 3, 4])
def test_only_so_many_frames_are_searched(most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    text = told(monkeypatch, [], [True, False, True, True], most=most)
    searched = (0, 2, 3)[:most]
    assert text == [NOTHING if k in searched else "" for k in range(4)]


@pytest.mark.parametrize(("count", "swaps", "drops"), [(1, 0, 0), (2, 0, 0), (3, 3, 3), (5, 10, 5)])
def test_every_pair_is_exchanged_and_every_landmark_left_out(
    count: int, swaps: int, drops: int
) -> None:
    """Of three landmarks or more: with two no exchange can be told, and one determines nothing."""
    used = np.arange(6) < count
    tried = trials(used, np.flatnonzero(used))
    assert len(tried.repair) == len(tried.label) == len(tried.used) == swaps + drops
    assert len({(one.exchanged, one.without) for one in tried.repair}) == swaps + drops
    for one, label, kept in zip(tried.repair, tried.label, tried.used, strict=True):
        expected, left = np.arange(6), used.copy()
        if one.without is None:
            a, b = one.exchanged
            expected[[a, b]] = b, a
        else:
            left[one.without] = False
        assert label.tolist() == expected.tolist() and kept.tolist() == left.tolist()


@np.errstate(all="ignore")
def test_of_many_landmarks_the_worst_are_searched() -> None:
    """Landmark k has a residual of k; only the last are tried."""
    points = np.tile(POINTS, (10, 1)) + np.arange(40)[:, None] / 100.0
    e = estimate(ANGLES[:1], points)
    fitted = _fitted(e, 0, np.tile(np.arange(40.0), 2))
    assert fitted is not None
    drops = [one.without for one in fitted.tried.repair if one.without is not None]
    assert drops == list(range(40 - MOST_LANDMARKS, 40))


@np.errstate(all="ignore")
@pytest.mark.parametrize("more", [0, 1])
def test_a_frame_of_very_many_landmarks_is_not_searched(more: int) -> None:
    count = MOST_IN_A_FRAME + more
    points = np.tile(POINTS, (51, 1))[:count] + np.arange(count)[:, None] / 100.0
    fitted = _fitted(estimate(ANGLES[:1], points), 0, np.arange(2.0 * count))
    assert (fitted is None) == bool(more)
