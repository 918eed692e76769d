"""What a piece of work makes of its sources: one that fails costs no other."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tests.kit.batch import history, settings, sources
from vopd.attitude.history import HistoryOptions
from vopd.attitude.sigmas import Sigmas
from vopd.batch import run as made
from vopd.batch import run as runs
from vopd.batch import run as solving
from vopd.batch.folder import FAILED, SOLVED, SourceRecord, failed_record, unchanged
from vopd.batch.run import SolvedSource
from vopd.batch.sources import BatchSettings, BatchSource
from vopd.files import OutputError
from vopd.findings import VopdError
from vopd.pipeline import SolveOptions

DIGEST = hashlib.sha256(b"table").hexdigest()


def test_one_source_that_raises_costs_no_other(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """All are solved together, then each by itself; a known error is told plainly."""
    calls: list[tuple[list[str], int]] = []

    def solve(waiting: Any, given: Any, locations: Any) -> list[SourceRecord]:
        calls.append(([one.source.name for one in waiting], sum(len(o.findings) for o in waiting)))
        waiting[0].findings.append("half done")
        for one in waiting:
            if one.source.name in ("1", "2"):
                raise VopdError("no room") if one.source.name == "1" else KeyError("x")
        return [SourceRecord(o.source.name, o.source.path, SOLVED, "", "", "", "") for o in waiting]

    monkeypatch.setattr(solving, "_solve", solve)
    monkeypatch.setattr(solving, "input_sha256", lambda path: f"hash of {path}")
    given = settings(tmp_path)
    found = solving.solve_chunk(sources(1, 1, 1, 1), given, {})
    assert [one.error for one in found] == [
        "", "1.dat: no room", "2.dat: error in the program: KeyError: 'x'", "",
    ]  # fmt: skip
    assert found[1] == failed_record(sources(1, 1)[1], given, "1.dat: no room", "hash of 1.dat")
    assert found[1].input_sha256 == "hash of 1.dat" and found[1].status == FAILED
    assert calls == [(["0", "1", "2", "3"], 0), *(([name], 0) for name in "0123")]
    two = solving.solve_chunk(sources(1, 1), given, {})
    assert [one.error for one in two] == ["", "1.dat: no room"]

    def no_space(*_: Any) -> list[SourceRecord]:
        raise OutputError("no space")

    monkeypatch.setattr(solving, "_solve", no_space)
    with pytest.raises(OutputError, match=r"^no space$"):
        solving.solve_chunk(sources(1, 1), given, {})


def test_sources_that_are_unchanged_are_left_and_old_outputs_removed(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    given = settings(tmp_path)
    some = sources(1, 1, 1)
    old = {
        one.name: SourceRecord(one.name, one.path, SOLVED, "old", "", "", "", outputs={"x.npz": ""})
        for one in some
    }
    monkeypatch.setattr(solving, "unchanged", lambda *_: [old["1"]])
    asked: list[str] = []
    monkeypatch.setattr(solving, "input_sha256", lambda path: asked.append(path) or "digest")

    def solve(waiting: Any, now: Any, locations: Any) -> list[SourceRecord]:
        assert locations == {"0.dat": "elsewhere/0.dat"}
        (tmp_path / "x.npz").write_text("")
        return [
            SourceRecord(o.source.name, "", SOLVED, "new", o.input_sha256, "", "") for o in waiting
        ]

    monkeypatch.setattr(solving, "_solve", solve)
    found = solving.solve_chunk(some, given, old, {"0.dat": "elsewhere/0.dat"})
    assert [(one.source, one.error) for one in found] == [("0", "new"), ("1", "old"), ("2", "new")]
    assert asked == ["elsewhere/0.dat", "2.dat"] and not (tmp_path / "x.npz").exists()


def test_tables_are_made_of_sources_with_an_attitude(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the options of the batch, the epoch of the flight, and warnings to the source."""
    asked: list[Any] = []
    job: Any = SimpleNamespace(results="results")
    histories = [history(2, 1), history(2, 0)]

    def histories_of_run(jobs: Any, options: Any) -> Any:
        assert jobs == [job, job]
        asked.append(options)
        return histories

    def render(files: Any) -> list[bytes]:
        for one in files:
            one.report("a table's warning")
            asked.append((one.histories, one.request.epoch))
        return [b"table" for _ in files]

    monkeypatch.setattr(made, "histories_of_run", histories_of_run)
    monkeypatch.setattr(made, "pages_of_jobs", lambda results: [[b"a", b"b"] for _ in results])
    monkeypatch.setattr(made, "misfit_findings", lambda h: ["misfit"])
    monkeypatch.setattr(made, "own_epoch", lambda h: "epoch")
    monkeypatch.setattr(made, "FORMATS", {"csv": SimpleNamespace(render_files=render)})
    given = replace(
        BatchSettings("o", "w", SolveOptions(), HistoryOptions(Sigmas(wind=2.0), 40.0)),
        formats=("csv",),
    )
    one, none = (SolvedSource(one, "", jobs=[job]) for one in sources(1, 1))
    made.make_outputs([one, none], given)
    assert asked == [given.history, ([histories[0]], "epoch")]
    assert one.pages == [b"ab"] and one.histories == [histories[0]]
    assert one.tables == {"csv": b"table"} and none.tables == {}
    assert one.findings == ["misfit", "a table's warning"] and none.findings == ["misfit"]


@pytest.mark.parametrize("spoiled", [None, "a.lst", "a.csv", "gone"])
def test_one_output_that_is_not_as_it_was_makes_a_source_be_solved_again(
    spoiled: str | None, tmp_path: Path
) -> None:
    given = settings(tmp_path / "out")
    (tmp_path / "a.dat").write_text("deck")
    for name in ("a.lst", "a.csv"):
        (tmp_path / "out" / name).write_text("table")
    deck = BatchSource(str(tmp_path / "a.dat"), "a", 4)
    record = replace(
        failed_record(deck, given, "", hashlib.sha256(b"deck").hexdigest()), status=SOLVED,
        outputs={"a.lst": DIGEST, "a.csv": DIGEST},
    )  # fmt: skip
    if spoiled == "gone":
        (tmp_path / "out" / "a.lst").unlink()
    elif spoiled is not None:
        (tmp_path / "out" / spoiled).write_text("table ")
    assert unchanged([deck], given, {"a": record}) == ([record] if spoiled is None else [])


@pytest.mark.parametrize(("jobs", "expected"), [(1, 4_000_000.0), (2, 1000.0)])
def test_pieces_for_processes_with_what_is_known_of_their_sources(
    jobs: int, expected: float, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A piece is taken apart with all earlier records; one that is given up names its source."""
    given, decks = settings(tmp_path), sources(*[1000] * 8)
    earlier = {one.name: failed_record(one, given, "before") for one in decks[1:4]}
    cut: list[float] = []

    def put_together(some: Any, chunk_bytes: float) -> Any:
        cut.append(chunk_bytes)
        return iter([[*some][:3], [*some][3:]])

    def in_processes(work: Any, plan: Any, count: int, split: Any, given_up: Any) -> Any:
        assert count == 2
        first, second = plan
        assert split(first) == [([one], {"1": earlier["1"], "2": earlier["2"]}) for one in first[0]]
        yield given_up(first)
        yield work(second)

    def solve(chunk: Any, now: Any, known: Any) -> list[SourceRecord]:
        assert now == given and known == {k: v for k, v in earlier.items() if k in names(chunk)}
        return [failed_record(one, given, "solved") for one in chunk]

    def names(chunk: Any) -> list[str]:
        return [one.name for one in chunk]

    monkeypatch.setattr(runs, "chunks", put_together)
    monkeypatch.setattr(runs, "in_processes", in_processes)
    monkeypatch.setattr(runs, "solve_chunk", solve)
    found = [*runs._solved(decks, given, earlier, jobs)]
    killed = "its process was killed each time that it was solved; is there enough memory?"
    first = [f"{k}.dat: {killed}" for k in range(3)] if jobs == 2 else ["solved"] * 3
    assert [[one.error for one in some] for some in found] == [first, ["solved"] * 5]
    assert cut == [expected]


def test_each_source_has_the_jobs_warnings_and_the_error_that_belong_to_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What is solved comes in the order of the sources, with an end after each."""

    class Piece:
        def __init__(self, *findings: str, error: Any = None) -> None:
            self.findings = findings
            self.error = error

    class Job(Piece):
        pass

    class Flight(Piece):
        pass

    class End(Piece):
        pass

    error = VopdError("odd")
    jobs, flight = [Job("a"), Job("b", "c"), Job()], Flight("d")
    coming: list[Any] = [jobs[0], jobs[1], End("e"), End(error=error)]
    coming += [flight, End(), jobs[2], End(error=error)]

    def solve(paths: list[str], options: Any, locations: Any) -> Any:
        assert paths == ["0.dat", "1.dat", "2.dat", "3.dat"]
        assert options == SolveOptions(compare_initial=True) and locations == {"0.dat": "x"}
        return iter(coming)

    monkeypatch.setattr(solving, "solve_sources", solve)
    monkeypatch.setattr(solving, "SolvedJob", Job)
    monkeypatch.setattr(solving, "FlightResult", Flight)
    some = [SolvedSource(one, "") for one in sources(1, 1, 1, 1)]
    given = BatchSettings("o", "w", SolveOptions(compare_initial=True), HistoryOptions())
    solving._put_together(some, given, {"0.dat": "x"})
    found: list[Any] = [(one.jobs, one.flight, one.findings, one.error) for one in some]
    assert found == [
        (jobs[:2], None, ["a", "b", "c", "e"], None), ([], None, [], error),
        ([], flight, ["d"], None), (jobs[2:], None, [], error),
    ]  # fmt: skip
