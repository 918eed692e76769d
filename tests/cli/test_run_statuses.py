"""How a run ends, what each exception becomes, and which jobs are printed together."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import click
import numpy as np
import pytest

from tests.kit.command import vopd
from vopd.cli import console as boundary
from vopd.cli import run
from vopd.cli.console import ReaderGone, at_the_boundary
from vopd.errata import fixes
from vopd.findings import Finding, VopdError
from vopd.pipeline import SolveOptions, in_groups
from vopd.results import SolvedJob, SourceEnd

ODD = Finding("odd", "a.dat", severity="warning")
Said = pytest.CaptureFixture[str]


@pytest.mark.parametrize("strict", [False, True])
@pytest.mark.parametrize(
    ("converged", "error", "warned", "status"),
    [
        ([[True, True]], None, False, (0, 0)),
        ([[True, True]], None, True, (0, 3)),
        ([[True, False]], None, False, (3, 3)),
        ([[True, False], [True]], None, False, (3, 3)),
        ([[True], [False, True]], None, True, (3, 3)),
        ([[False]], VopdError("a: wrong"), False, (1, 1)),
        ([[True]], VopdError("a: wrong"), True, (1, 1)),
    ],
)
def test_the_status_of_a_run(
    converged: list[list[bool]], error: VopdError | None, warned: bool, status: tuple[int, int],
    strict: bool, monkeypatch: pytest.MonkeyPatch, capsys: Said,
) -> None:  # fmt: skip
    """And the end of the case is printed only where the deck came to its end."""
    results: list[Any] = [
        SimpleNamespace(frame=one, converged=np.array(one, bool)) for one in converged
    ]
    jobs = [SolvedJob("a", k, one) for k, one in enumerate(results, 1)]
    ends = SourceEnd("a", error, (ODD,) if warned else ())
    monkeypatch.setattr(run, "solve_decks", lambda *_: iter([*jobs, ends]))
    monkeypatch.setattr(run, "pages_of_jobs", lambda jobs: [[b"page\n"] for _ in jobs])
    monkeypatch.setattr(run, "end_of_case", lambda: b"end\n")
    ran = vopd("run", "a", *(["--strict"] if strict else []))
    assert ran.status == status[strict]
    assert ran.stdout == "page\n" * len(jobs) + ("" if error else "end\n")
    assert ran.stderr == "warning: a.dat: odd\n" * warned + ("a: wrong\n" if error else "")
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    ("error", "status", "said"),
    [
        (None, 0, ""),
        (BrokenPipeError(), 0, ""),
        (ReaderGone(), 0, ""),
        (OSError(28, "No space left on device"), 1, "standard output: No space left on device\n"),
        (OSError(28, "No space left on device", "a.lst"), 1, "a.lst: No space left on device\n"),
        (MemoryError(), 1, "there is not enough memory for this input\n"),
        (VopdError("a.dat: wrong"), 1, "a.dat: wrong\n"),
        (click.UsageError("no such option"), 2, "Error: no such option\n"),
        (click.ClickException("wrong"), 1, "Error: wrong\n"),
        (click.Abort(), 130, ""),
    ],
)
def test_what_each_exception_becomes(
    error: BaseException | None, status: int, said: str, monkeypatch: pytest.MonkeyPatch,
    capsys: Said,
) -> None:  # fmt: skip
    """Where nothing more can be written, the rest of standard output is thrown away."""
    thrown: list[str] = []
    monkeypatch.setattr(boundary, "discard_output", lambda: thrown.append("away"))

    def command() -> None:
        if error is not None:
            raise error

    assert at_the_boundary(command) == status
    ended = capsys.readouterr()
    assert (ended.out, ended.err) == ("", said)
    assert bool(thrown) == isinstance(error, OSError | ReaderGone)


@pytest.mark.parametrize(("returned", "status"), [(3, 3), (None, 0), ("text", 0), (0, 0)])
def test_the_status_is_what_a_command_returns(returned: object, status: int) -> None:
    assert at_the_boundary(lambda: returned) == status


def test_jobs_are_grouped_by_their_frames() -> None:
    """A group ends with the job that brings it to 2000 frames, or with a flight."""

    def solved(frames: int) -> SolvedJob:
        results: Any = SimpleNamespace(frame=range(frames))
        return SolvedJob("a", 1, results)

    end, flight = SourceEnd("a"), object()
    sources = [solved(1999), end, solved(1), solved(1999), flight, solved(1), flight, end]
    sources += [solved(2000), solved(1000), solved(999), end]
    assert [len(group) for group in in_groups(iter(sources))] == [3, 2, 2, 2, 3]
    assert [one for group in in_groups(iter(sources)) for one in group] == sources
    assert not [*in_groups(iter(()))]


@pytest.mark.parametrize("quiet", [False, True])
def test_what_a_run_says_and_writes(
    quiet: bool, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Warnings of jobs and decks; the fixes also if it is quiet; tape 10 beside a listing."""
    results: list[Any] = [
        SimpleNamespace(frame=[k], converged=np.array([True])) for k in (1, 2, 3, 4)
    ]
    jobs = [SolvedJob("a", k, one, (replace(ODD, card=k),)) for k, one in enumerate(results, 1)]
    ends = [SourceEnd("a", None, (replace(ODD, card=5),)), SourceEnd("b", None, (ODD,))]
    given: list[Any] = []
    events: list[Any] = []
    line = SimpleNamespace(add=events.append, close=lambda: events.append("wiped"))
    monkeypatch.setattr(run, "Progress", lambda unit: events.append(unit) or line)
    monkeypatch.setattr(run, "solve_decks", lambda *one: given.append(one) or iter([*jobs, *ends]))
    page = b"STANDARD DEVIATION " * 2
    monkeypatch.setattr(run, "pages_of_jobs", lambda jobs: [[page, b"page "] for _ in jobs])
    monkeypatch.setattr(run, "end_of_case", lambda: b"end\n")
    monkeypatch.setattr(run, "tape_records", lambda one: b"tape %d " % one.frame[0])
    tape = tmp_path / "tape"
    options = ["--fix", "restart", "--tape10", tape, *(["-q"] if quiet else [])]
    ran = vopd("run", "a", "b", *options)
    assert ran.status == 0 and tape.read_bytes() == b"tape 1 tape 2 tape 3 tape 4 "
    assert ran.output == (page + b"page ") * 4 + b"end\nend\n"
    fixed = ["corrected run, not the original: restart"]
    shown = [f"warning: a.dat: card {k}: odd" for k in (1, 2, 3)]
    more = ["warning: a.dat: 2 more warnings like these", "warning: a.dat: odd"]
    assert ran.stderr.splitlines() == (fixed if quiet else fixed + shown + more)
    ((decks, solve),) = given
    assert decks == ("a", "b") and solve == SolveOptions(fixes("restart"))
    assert events == ["frames", *[2, 0] * 4, "wiped", "wiped"]
    assert vopd("run", "a", "--tape10", tape, "-o", tape).status == 1


def test_no_deck_is_read_where_the_tape_cannot_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run, "solve_decks", None)
    for options in (("--tape10", tmp_path), ("-o", tmp_path), ("--tape10", "in"), ("-o", "in")):
        monkeypatch.chdir(tmp_path)
        Path("in").write_text("before")
        assert vopd("run", "in", *options).status == 1
        assert Path("in").read_text() == "before"
