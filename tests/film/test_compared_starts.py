"""Warnings of frames that end in another attitude from the deck's first estimate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.kit.jobs import film, turned
from vopd.findings import Finding, VopdError
from vopd.pipeline import ReadJob, SolveOptions, solve_film
from vopd.program import vopd as program
from vopd.results import Outcome, Results, SolvedJob

BY_PAIR = SolveOptions(initial="closed-form")
COMPARED = SolveOptions(initial="closed-form", compare_initial=True)
BLANK = Finding("blanks read as zeros", "a.dat", card=3, severity="warning")


def solved(jobs: Sequence[ReadJob], options: SolveOptions = BY_PAIR) -> list[SolvedJob]:
    found = solve_film(jobs, options)
    assert all(isinstance(one, SolvedJob) for one in found)
    return [one for one in found if isinstance(one, SolvedJob)]


APART = {  # by how much an angle of frame 2 is another: which is said of
    "less than the last digit": ([0.0, 0.00099, 0.0], False),
    "more than the last digit": ([0.0, 0.00101, 0.0], True),
    "in yaw": ([-0.00101, 0.0, 0.0], True),
    "in roll": ([0.0, 0.0, -0.00101], True),
    "less, about a circle": ([-359.99901, 0.0, 360.0005], False),
    "more, about a circle": ([0.0, 0.0, 359.99899], True),
    "not a number": ([np.nan, 0.0, 0.0], True),
}


PAIRS, DECK = 1, 2


def change_solve(monkeypatch: pytest.MonkeyPatch, which: int, change: Any) -> None:
    """What the solve gives is changed: that by pairs, or that from the deck's first estimate."""
    real, calls = program.run_jobs, []

    def run_jobs(*args: Any) -> list[Results | VopdError]:
        calls.append(args)
        ended = real(*args)
        return [change(one) for one in ended] if len(calls) == which else ended

    monkeypatch.setattr(program, "run_jobs", run_jobs)


@pytest.mark.parametrize("name", APART)
def test_a_frame_that_ends_elsewhere_from_the_deck_s_estimate(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    by, said = APART[name]

    def change(one: Results) -> Results:
        other = one.camera_deg.copy()
        other[1] += by
        return replace(one, camera_deg=other)

    change_solve(monkeypatch, DECK, change)
    (one,) = solved([ReadJob("a.dat", 5, film(3), (BLANK,))], COMPARED)
    message = "frame 2: the deck's first estimate leads to another attitude"
    elsewhere = Finding(message, "a.dat", job=5, group=8, severity="warning")
    assert one.findings == ((BLANK, elsewhere) if said else (BLANK,))


@pytest.mark.parametrize("which", [DECK, PAIRS])
def test_only_frames_that_are_solved_both_times_are_compared(
    which: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The residuals of frame 1 vanish before pass 22: no angles of it are printed."""

    def change(one: Results) -> Results:
        ended = one.outcome.copy()
        ended[0] = Outcome.EXACT
        return replace(one, camera_deg=one.camera_deg + np.array([0.0, 1.0, 0.0]), outcome=ended)

    change_solve(monkeypatch, which, change)
    (one,) = solved([ReadJob("a.dat", 5, film(2))], COMPARED)
    assert [found.message.partition(":")[0] for found in one.findings] == ["frame 2"]


def test_without_the_comparison_nothing_is_compared() -> None:
    lost = turned(np.array([[140.0, -80.0, 60.0]]), np.array([320.0, 80.0, 240.0]))
    (one,), (other,) = (
        solved([ReadJob("a.dat", 1, lost)]),
        solved([ReadJob("a.dat", 1, lost)], COMPARED),
    )
    assert one.findings == () and len(other.findings) == 1
    assert (one.results.camera_deg == other.results.camera_deg).all()
