"""Picks that do not fit: which are blunders, what is said, and how often they are dropped."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.kit.flight_project import MARK, three_frames
from vopd.findings import Finding, VopdError
from vopd.flight import result as solve_project
from vopd.flight.flight import Flight
from vopd.flight.result import _Blunders, _blunders, _enough, _told, solve_flight, solve_flight_read
from vopd.flight.solve import FlightBlocks

PICKS = 3 * MARK
SIGMA_PX = [0.5, 1.0, 2.0, 4.0]  # of the four picks of each frame


def blunders(
    flight: Flight, off_px: dict[int, float], monkeypatch: pytest.MonkeyPatch
) -> tuple[list[int], list[float], list[Any]]:
    """Those of picks that fail the test for outliers and are off so far; what is solved for it."""
    misfit = np.isin(np.arange(PICKS), list(off_px))
    used = np.arange(PICKS) % MARK < 3
    estimates: Any = SimpleNamespace(
        outliers=lambda: misfit, blocks=FlightBlocks(flight), solved=SimpleNamespace(used=used)
    )
    given: list[Any] = []

    def solve(part: Flight, left_out: Any) -> Any:
        given.append((part.frame.tolist(), left_out.tolist()))
        frames = np.searchsorted(flight.frame, part.frame)
        picks = (frames[:, None] * MARK + np.arange(MARK)).ravel()
        return [off_px.get(k, 1e9) for k in picks.tolist()]

    monkeypatch.setattr(solve_project, "solve", solve)
    monkeypatch.setattr(solve_project, "_off_px", np.array)
    found = _blunders(flight, estimates)
    return found.pick.tolist(), found.off_px.tolist(), given


def test_a_blunder_is_off_by_more_than_four_of_its_own_sigmas(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Pick 5 has 1 px, pick 10 has 2 px; one without an attitude by the others is a blunder."""
    flight = three_frames()
    at, beyond = {5: 4.0, 10: 8.0}, {5: 4.001, 10: 8.001}
    assert blunders(flight, at, monkeypatch)[0] == []
    assert blunders(flight, beyond, monkeypatch)[:2] == ([5, 10], [4.001, 8.001])
    assert blunders(flight, {5: 3.9, 10: 9.0}, monkeypatch)[:2] == ([10], [9.0])
    pick, off, _ = blunders(flight, {10: float("nan")}, monkeypatch)
    assert pick == [10] and np.isnan(off).all()


def test_frames_are_solved_without_their_misfits_and_check_landmarks(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    flight = three_frames()
    _, _, given = blunders(flight, {5: 9.0}, monkeypatch)
    assert given == [([9], [False, True, False, True])]
    assert blunders(flight, {}, monkeypatch) == ([], [], [])


@pytest.mark.parametrize(
    ("dropped", "end"),
    [(True, "it is left out"), (False, 'it is used; [solve] blunders = "drop" leaves it out')],
)
def test_what_is_said_of_a_blunder(dropped: bool, end: str) -> None:
    found = _Blunders(np.array([5, 10]), np.array([4.26, 123.44]))
    told = _told(three_frames(), found, dropped)
    assert told == [
        Finding(f"{label} does not fit the others, it is {off} px off; {end}", "flight.toml",
                severity="warning")
        for label, off in (("b.jpg: mast", "4.3"), ("c.jpg: bridge", "123.4"))
    ]  # fmt: skip
    numbered = replace(three_frames(), image_name=())
    assert _told(numbered, found, dropped)[1].message.startswith("frame 12: bridge does not")


def rounds(
    drop: bool, blunders_of: list[list[int]], monkeypatch: pytest.MonkeyPatch
) -> tuple[list[str], list[Any]]:
    """What is said, and which picks are left out of each solve, where so many are found."""
    base = three_frames()
    flight = replace(
        base,
        options=replace(base.options, drop_blunders=drop),
        findings=(Finding("of a file", "flight.toml", severity="warning"),),
    )
    left = iter(blunders_of)
    solves: list[Any] = []
    real = solve_project.solve

    def solve(one: Flight, out: Any = None, before: Any = None) -> Any:
        picks = None if out is None else np.flatnonzero(out).tolist()
        solves.append((picks, before is None))
        return real(one, out, before=before)

    def found(*_: Any) -> _Blunders:
        pick = np.array(next(left), dtype=np.int64)
        return _Blunders(pick, np.full(len(pick), 9.0))

    monkeypatch.setattr(solve_project, "solve", solve)
    monkeypatch.setattr(solve_project, "_blunders", found)
    told = solve_flight_read(flight).findings
    return [one.message for one in told], solves


LEFT = "does not fit the others, it is 9.0 px off; it is left out"
USED = 'does not fit the others, it is 9.0 px off; it is used; [solve] blunders = "drop"'


def test_blunders_are_dropped_three_times_and_then_named(monkeypatch: pytest.MonkeyPatch) -> None:
    said, solves = rounds(True, [[4], [5], [8, 9], [6]], monkeypatch)
    assert solves == [(None, True), ([4], False), ([4, 5], False), ([4, 5, 8, 9], False)]
    assert said[0] == "of a file"
    assert said[1:5] == [
        f"b.jpg: church {LEFT}", f"b.jpg: mast {LEFT}",
        f"c.jpg: church {LEFT}", f"c.jpg: mast {LEFT}",
    ]  # fmt: skip
    assert said[5].startswith(f"b.jpg: bridge {USED}")
    assert [one.partition(":")[2] for one in said[6:]] == [
        " its landmarks lie on one line of sight, or too few can be used"
    ]


def test_no_more_is_solved_where_nothing_is_left_to_drop(monkeypatch: pytest.MonkeyPatch) -> None:
    assert rounds(True, [[4], []], monkeypatch)[1] == [(None, True), ([4], False)]
    said, solves = rounds(False, [[4]], monkeypatch)
    assert solves == [(None, True)] and said[1].startswith(f"b.jpg: church {USED}")


def test_a_project_is_read_where_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[Any] = []
    monkeypatch.setattr(solve_project, "read_flight", lambda *a: given.append(a))
    monkeypatch.setattr(solve_project, "solve_flight_read", lambda flight: flight)
    solve_flight("a.toml")
    solve_flight("b.toml", "/elsewhere/c.toml")
    assert given == [("a.toml", None), ("b.toml", "/elsewhere/c.toml")]


def test_findings_are_of_files_and_then_of_picks_and_then_of_frames(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(solve_project, "_set_aside", lambda *_: ["set aside"])
    monkeypatch.setattr(solve_project, "_unsolved", lambda *_: ["unsolved"])
    monkeypatch.setattr(solve_project, "_told", lambda *_: ["blunder"])
    of_file: Any = "of a file"
    flight = replace(three_frames(), findings=(of_file,))
    assert solve_flight_read(flight).findings == ("of a file", "blunder", "set aside", "unsolved")


@pytest.mark.parametrize(("frames", "enough"), [([0, 0, 1], True), ([0, 1, 2], False)])
def test_a_flight_is_refused_where_no_frame_has_two_landmarks_that_are_used(
    frames: list[int], enough: bool
) -> None:
    """The last pick of each is of a check landmark, and does not count."""
    base = three_frames()
    frame, mark = np.array([*frames, 0, 1, 2]), np.array([0, 1, 2, 3, 3, 3])
    picks = replace(
        base.picks, frame=frame, landmark=mark, pixel=np.ones((6, 2)), sigma_px=np.ones(6)
    )
    flight = replace(base, picks=picks)
    if enough:
        _enough(flight)
        return
    with pytest.raises(VopdError) as refused:
        _enough(flight)
    assert str(refused.value) == (
        "flight.toml: no frame has two landmarks (frames: 3, one at most in each). One landmark "
        "gives the direction of its line of sight alone: the turn about it stays free, so that of "
        "three angles two are tied together and none is known by itself. Pick a second landmark "
        "in each image, the farther from the first the better."
    )
