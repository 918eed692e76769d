"""Every argument of the functions that read and solve reaches the solve, for decks and flights."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import vopd
from tests.kit.command import CASE_1, DECKS
from vopd import pipeline
from vopd.errata import fixes
from vopd.findings import VopdError
from vopd.job import Job
from vopd.pipeline import ReadJob, SolveOptions, check_project, solve_decks, solve_sources
from vopd.results import SolvedJob, SourceEnd

CASES = DECKS / "appendix_h" / "cases_1_2_3.dat"
ELSEWHERE = {"a": str(CASE_1), "b": str(CASES)}


def asked(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """What `solve_film` is given, instead of solving."""
    given: list[Any] = []

    def solve_film(jobs: list[ReadJob], options: SolveOptions) -> list[SolvedJob]:
        given.extend([*jobs, options])
        results: Any = SimpleNamespace(stop=None)
        return [SolvedJob(one.source, one.number, results) for one in jobs]

    monkeypatch.setattr(pipeline, "solve_film", solve_film)
    return given


def test_all_arguments_of_run(monkeypatch: pytest.MonkeyPatch) -> None:
    given = asked(monkeypatch)
    jobs = vopd.read_deck(CASES)
    start = np.arange(9.0).reshape(3, 3) / 3.0
    vopd.run(jobs, fixes("restart"), initial="closed-form", compare_initial=True, start_deg=start)
    *read, options = given
    assert options == SolveOptions(fixes("restart"), "closed-form", True)
    assert [(one.source, one.number) for one in read] == [(str(CASES), k) for k in (1, 2, 3)]
    for k, one in enumerate(read):
        assert one.job is jobs[k] and one.findings == ()
        assert one.start_deg.tolist() == start[k : k + 1].tolist()  # to the last bit
    given.clear()
    vopd.run(jobs[0])
    one, options = given
    assert options == SolveOptions() and one.start_deg is None
    assert (one.source, one.number) == ("", 1)


@pytest.mark.parametrize("shape", [(2, 3), (3, 2), (9,), (3, 3, 1), (4, 3)])
def test_starts_have_a_row_for_every_frame(shape: tuple[int, ...]) -> None:
    with pytest.raises(VopdError) as raised:
        vopd.run(vopd.read_deck(CASES), start_deg=np.zeros(shape))
    assert str(raised.value) == f"start_deg has the shape {shape}, not (3, 3)"


OPTIONS = SolveOptions(fixes("restart"), "closed-form", True)
Solve = Callable[..., Iterable[Any]]


@pytest.mark.parametrize("solve", [solve_decks, solve_sources])
def test_options_and_locations_of_decks(solve: Solve, monkeypatch: pytest.MonkeyPatch) -> None:
    given = asked(monkeypatch)
    found = [*solve(["a", "b", "a"], OPTIONS, ELSEWHERE)]
    jobs = [one for one in given if isinstance(one, ReadJob)]
    assert [(one.source, one.number) for one in jobs] == [
        ("a", 1), ("b", 1), ("b", 2), ("b", 3), ("a", 1),
    ]  # fmt: skip
    assert {str(one) for one in given if isinstance(one, SolveOptions)} == {str(OPTIONS)}
    assert [one.source for one in found if isinstance(one, SourceEnd)] == ["a", "b", "a"]
    assert [len(one.job.readings.frame) for one in jobs] == [1] * 5


@pytest.mark.parametrize("solve", [solve_decks, solve_sources])
@pytest.mark.parametrize("limits", [True, False])
def test_the_limits_of_1974_reach_the_reader(
    solve: Solve, limits: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By itself, and where several decks are read together."""
    told: list[bool] = []

    def read_jobs(*_: object, limits_1974: bool) -> Iterable[Job]:
        told.append(limits_1974)
        return []

    monkeypatch.setattr("vopd.cards.read.read_jobs", read_jobs)
    options = SolveOptions(limits_1974=limits)
    for names in (["a"], ["a", "b"]):
        told.clear()
        ends = [*solve(names, options, ELSEWHERE)]
        assert told == [limits] * len(names) and [one.source for one in ends] == names


def test_flights_among_decks_keep_their_order_and_locations(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked(monkeypatch)
    told: list[tuple[str, str | None]] = []

    def solve_flight(name: str, location: str | None = None) -> str:
        told.append((name, location))
        if name == "bad.toml":
            raise VopdError("no flight")
        return f"flight {name}"

    monkeypatch.setattr("vopd.flight.result.solve_flight", solve_flight)
    names = ["F.TOML", "a", "bad.toml", "g.toml", "b"]
    where = ELSEWHERE | {"F.TOML": "/other/f", "g.toml": "/other/g"}
    found = [*solve_sources(names, OPTIONS, where)]
    assert told == [("F.TOML", "/other/f"), ("bad.toml", None), ("g.toml", "/other/g")]
    outline = [one if isinstance(one, str) else (one.source, type(one).__name__) for one in found]
    assert outline == [
        "flight F.TOML", ("F.TOML", "SourceEnd"), ("a", "SolvedJob"), ("a", "SourceEnd"),
        ("bad.toml", "SourceEnd"), "flight g.toml", ("g.toml", "SourceEnd"),
        *[("b", "SolvedJob")] * 3,
        ("b", "SourceEnd"),
    ]  # fmt: skip
    errors = {
        one.source: one.error and str(one.error) for one in found if isinstance(one, SourceEnd)
    }
    assert errors == {"F.TOML": None, "a": None, "bad.toml": "no flight", "g.toml": None, "b": None}


def test_a_project_is_checked_under_its_name(tmp_path: Path) -> None:
    (found,) = check_project(str(tmp_path / "none.toml"))
    assert "none.toml" in str(found) and found.severity == "error"
