"""How commands with attitude histories end: every combination of causes, and what is said."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import click
import pytest

from tests.approved.texts import refused
from vopd.attitude.findings import HistorySummary
from vopd.attitude.history import HistoryOptions
from vopd.attitude.sigmas import Sigmas
from vopd.cli import histories as collect_histories
from vopd.cli.console import Messages
from vopd.cli.histories import Collected
from vopd.cli.options import SharedOptions
from vopd.findings import Finding, VopdError
from vopd.pipeline import SolveOptions
from vopd.results import SourceEnd

USUAL = SharedOptions(SolveOptions(), HistoryOptions(), strict=False, quiet=False)
STRICT = replace(USUAL, strict=True)
QUIET = replace(STRICT, quiet=True)
ODD = Finding("odd", "a.dat", severity="warning")
Said = pytest.CaptureFixture[str]


def counted(*jobs: tuple[int, int]) -> list[Any]:
    """Jobs with so many frames that did not converge, and that are flagged."""
    return [SimpleNamespace(about=None, summary=HistorySummary(*one)) for one in jobs]


HISTORIES: list[tuple[list[Any], bool, SharedOptions, int, str]] = [
    (counted((0, 0)), False, USUAL, 0, ""),
    (counted((0, 0)), False, STRICT, 0, ""),
    (counted((0, 1)), False, USUAL, 0, ""),
    (counted((0, 1), (0, 0)), False, STRICT, 3, "--strict: 1 frame is flagged\n"),
    (counted((0, 1), (0, 1)), False, STRICT, 3, "--strict: 2 frames are flagged\n"),
    (counted((0, 2), (0, 3)), False, STRICT, 3, "--strict: 5 frames are flagged\n"),
    (counted((0, 2), (0, 3)), False, QUIET, 3, ""),
    (counted((0, 0), (1, 1)), False, USUAL, 3, ""),
    (counted((1, 1), (0, 0)), False, USUAL, 3, ""),
    (counted((1, 1)), True, USUAL, 1, ""),
    (counted((1, 1)), True, STRICT, 1, ""),
    (counted((0, 0)), True, QUIET, 1, ""),
]


@pytest.mark.parametrize(("jobs", "failed", "asked", "status", "said"), HISTORIES)
def test_the_status_of_attitude_histories(
    jobs: list[Any], failed: bool, asked: SharedOptions, status: int, said: str, capsys: Said
) -> None:
    assert Collected(jobs, [], failed).status(asked, Messages(asked.quiet)) == status
    assert capsys.readouterr().err == said


def test_misfits_of_long_jobs_are_told_at_the_end(
    monkeypatch: pytest.MonkeyPatch, capsys: Said
) -> None:
    """Of every job whose frames had not been counted, with the number that is not shown."""
    found = [replace(ODD, card=k) for k in range(1, 6)]
    monkeypatch.setattr(collect_histories, "findings_of", lambda about, summary: found)
    jobs = counted((0, 0), (0, 0))
    assert Collected(jobs, jobs[1:], False).status(USUAL, Messages()) == 0
    assert capsys.readouterr().err.splitlines() == [
        *(f"warning: a.dat: card {k}: odd" for k in (1, 2, 3)),
        "warning: a.dat: 2 more warnings like these",
    ]


class Job:
    """A flight that has been solved, or its history."""

    frames = 4

    def __init__(self, name: str, has: bool = True, is_counted: bool = True) -> None:
        self.findings = (Finding(f"{name} is odd", severity="warning"),)
        self.about, self.summary, self.has, self.counted = name, HistorySummary(), has, is_counted
        self.whole = f"whole {name}"

    def history_parts(self, options: HistoryOptions) -> Job:
        assert options == SOLVED.history
        return self

    def has_attitude(self) -> bool:
        return self.has


SOLVED = replace(USUAL, history=HistoryOptions(Sigmas(reading=2.0), 7.0, "geodetic"))


def collected(
    monkeypatch: pytest.MonkeyPatch, *sources: Any, by_parts: bool = True, **asked: Any
) -> tuple[Collected, list[str]]:
    heard: list[str] = []

    def solve(decks: tuple[str, ...], options: SolveOptions) -> Iterator[Any]:
        assert (decks, options) == (("a", "b"), asked.get("solve", SolveOptions()))
        return iter(sources)

    def misfits(about: str, _: object) -> list[Finding]:
        return [Finding(f"{about} misfits", severity="warning")]

    def one_part(whole: str) -> Any:
        return Job(f"part of {whole}")

    monkeypatch.setattr(collect_histories, "solve_sources", solve)
    monkeypatch.setattr(collect_histories, "findings_of", misfits)
    monkeypatch.setattr(collect_histories, "one_part", one_part)
    how = replace(SOLVED, **asked)
    return collect_histories.collect_jobs(("a", "b"), how, by_parts, heard.append), heard


def test_what_is_said_of_sources_in_their_order(
    monkeypatch: pytest.MonkeyPatch, capsys: Said
) -> None:
    """Warnings, then the misfits of what is counted; an error of one does not stop the next."""
    sources = (Job("a"), SourceEnd("a", None, (ODD,)), SourceEnd("b", VopdError("b: wrong")),
               Job("c", is_counted=False))  # fmt: skip
    found, heard = collected(monkeypatch, *sources)
    expected = ["a is odd", "a misfits", "a.dat: odd", "b: wrong", "c is odd"]
    assert heard == expected
    lines = [one if one.startswith("b") else f"warning: {one}" for one in expected]
    assert capsys.readouterr().err.splitlines() == lines
    assert [one.about for one in found.jobs] == ["a", "c"] and found.failed
    assert [one.about for one in found.untold] == ["c"]
    found, heard = collected(monkeypatch, *sources, quiet=True)
    assert heard == expected and capsys.readouterr().err == "b: wrong\n"


def test_where_parts_are_not_wanted_a_job_is_made_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    (job,) = collected(monkeypatch, Job("a", is_counted=False), by_parts=False)[0].jobs
    assert job.about == "part of whole a"  # type: ignore[comparison-overlap]


@pytest.mark.parametrize("quiet", [False, True])
def test_a_corrected_run_is_told(
    quiet: bool, monkeypatch: pytest.MonkeyPatch, capsys: Said
) -> None:
    from vopd.errata import fixes

    solve = SolveOptions(fixes("restart"))
    collected(monkeypatch, Job("a"), quiet=quiet, solve=solve)
    told = "corrected run, not the original: restart\n"
    shown = "warning: a is odd\nwarning: a misfits\n"
    assert capsys.readouterr().err == ("" if quiet else told + shown)


def test_the_warnings_of_each_deck_are_counted_by_themselves(
    monkeypatch: pytest.MonkeyPatch, capsys: Said
) -> None:
    ends = (SourceEnd("a", None, (ODD,) * 5), SourceEnd("b"), SourceEnd("c", None, (ODD,) * 4))
    collected(monkeypatch, Job("a"), *ends)
    odd, more = "warning: a.dat: odd", "warning: a.dat: {} more warnings like these"
    lines = capsys.readouterr().err.splitlines()[2:]
    assert lines == [*[odd] * 3, more.format(2), *[odd] * 3, more.format(1)]


def test_no_attitude_in_any_job(monkeypatch: pytest.MonkeyPatch) -> None:
    """One frame of one job suffices; what failed has been said already."""
    collected(monkeypatch, Job("a", has=False), Job("b"))
    with refused(VopdError):
        collected(monkeypatch, Job("a", has=False))
    with pytest.raises(click.exceptions.Exit) as ended:
        collected(monkeypatch, SourceEnd("a", VopdError("a: wrong")))
    assert ended.value.exit_code == 1


@pytest.mark.parametrize("quiet", [False, True])
def test_whole_histories_and_the_status_of_all(
    quiet: bool, monkeypatch: pytest.MonkeyPatch, capsys: Said
) -> None:
    """What is found at the end is heard too, and printed unless it is quiet."""
    heard: list[str] = []
    given: list[Any] = []
    asked = replace(USUAL, quiet=quiet)

    class Found:
        jobs = (SimpleNamespace(whole="one"), SimpleNamespace(whole="two"))

        def status(self, how: SharedOptions, messages: Messages) -> int:
            assert how == asked
            messages(ODD)
            return 3

    def collect(decks: Any, how: Any, by_parts: bool, heard: Any) -> Any:
        given.append((decks, how, by_parts, heard))
        return Found()

    monkeypatch.setattr(collect_histories, "collect_jobs", collect)
    found = collect_histories.collect_histories(("a", "b"), asked, heard.append)
    assert found == (["one", "two"], 3) and heard == ["a.dat: odd"]
    assert given[0][:3] == (("a", "b"), asked, False)
    given[0][3]("more")
    assert heard == ["a.dat: odd", "more"]
    assert capsys.readouterr().err == ("" if quiet else "warning: a.dat: odd\n")


def test_the_progress_counts_frames_and_is_wiped_at_the_end_of_a_deck(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    events: list[Any] = []
    line = SimpleNamespace(add=events.append, close=lambda: events.append("wiped"))
    monkeypatch.setattr(collect_histories, "Progress", lambda unit: events.append(unit) or line)
    collected(monkeypatch, Job("a"), Job("b"), SourceEnd("a"), Job("c"))
    assert events == ["frames", 4, 4, "wiped", 4]
