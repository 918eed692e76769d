"""How sources are put together, what is written of each, and what its record says."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.attitude.input_sigmas import Sigmas
from vopd.batch import chunks as pieces
from vopd.batch import run_batch as runs
from vopd.batch import solve_chunk as solving
from vopd.batch import solved_source as made
from vopd.batch import source_outputs as outputs
from vopd.batch.chunks import chunks, even_chunk_bytes, taken_apart
from vopd.batch.earlier_records import unchanged
from vopd.batch.input_hash import input_sha256, named_files
from vopd.batch.settings import BatchSettings
from vopd.batch.solved_source import SolvedSource
from vopd.batch.source_record import FAILED, SOLVED, UNCONVERGED, SourceRecord, failed_record
from vopd.batch.sources import BatchSource
from vopd.film.solve import SolveOptions
from vopd.findings import VopdError
from vopd.version import __version__
from vopd.whole_file import OutputError, whole_file

DIGEST = hashlib.sha256(b"table").hexdigest()


def settings(folder: Path, **more: Any) -> BatchSettings:
    (folder / "w").mkdir(parents=True, exist_ok=True)
    given = {"formats": ("csv", "npz"), **more}
    return BatchSettings(str(folder), str(folder / "w"), SolveOptions(), Sigmas(), **given)


def sources(*sizes: int | str) -> list[BatchSource]:
    """Decks of these sizes; a text is the size of a flight."""
    return [
        BatchSource(f"{k}.{'toml' if isinstance(one, str) else 'dat'}", str(k), int(one))
        for k, one in enumerate(sizes)
    ]


def test_the_largest_pieces() -> None:
    assert (pieces.CHUNK_BYTES, pieces.CHUNK_SOURCES, pieces.LEAST_CHUNKS) == (4_000_000, 200, 4)


@pytest.mark.parametrize(
    ("sizes", "processes", "expected"),
    [
        ([1000] * 8, 1, 2000.0),  # four pieces for each process
        ([1000] * 8, 2, 1000.0),
        ([1000] * 8 + ["9999"], 2, 1000.0),  # flights are pieces by themselves
        ([40_000_000], 1, 4_000_000.0),
        ([40_000_001], 1, 40_000_001 / 11),
        ([40_000_000], 2, 4_000_000.0),  # five for each
        ([40_000_001], 2, 40_000_001 / 12),
        ([10] * 1001, 1, 10_010 / 6),  # 200 decks at most
        ([10] * 1001, 2, 10_010 / 8),
        ([], 3, 1 / 12),
        ([0, 0], 3, 1 / 12),
        (["500"], 3, 1 / 12),
    ],
)
def test_bytes_of_even_pieces_by_hand(
    sizes: list[int | str], processes: int, expected: float
) -> None:
    assert_close("ratio", even_chunk_bytes(sources(*sizes), processes) / expected, 1.0)


@pytest.mark.parametrize(
    ("sizes", "expected"),
    [
        ([10, 10, 10, 10], ["01", "23"]),
        ([10, 10, "10", 10, 10], ["01", "2", "34"]),
        (["10", 10, 10, 10], ["0", "12", "3"]),  # a flight does not count
        ([10, "999", 10, 10], ["0", "1", "2", "3"]),
        (["1", "1"], ["0", "1"]),
        ([30, 10], ["0", "1"]),
        ([10, 30, 10], ["0", "1", "2"]),
        ([39], ["0"]),
        ([0, 0, 0], ["012"]),
    ],
)  # fmt: skip
def test_pieces_of_twenty_bytes(sizes: list[int | str], expected: list[str]) -> None:
    found = [*chunks(sources(*sizes), 20.0)]
    assert ["".join(one.name for one in chunk) for chunk in found] == expected
    assert taken_apart(sources(1, 2)) == [[one] for one in sources(1, 2)]


# Hashes


def hash_of(folder: Path, text: bytes, **files: str) -> str:
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        (folder / name).write_text(content)
    (folder / "flight.toml").write_bytes(text)
    return input_sha256(str(folder / "flight.toml"))


def test_the_hash_of_a_project_by_hand(tmp_path: Path) -> None:
    """Its bytes, then the name of each file between zeros and the hash of it, by names."""
    text = b'\xef\xbb\xbfb = "two"\na = ["one", "one", "", "none", "bad\\u0000name"]\n'
    expected = hashlib.sha256(text)
    for name in ("one", "two"):
        expected.update(f"\0{name}\0".encode())
        expected.update(hashlib.sha256(name.encode()).hexdigest().encode())
    assert hash_of(tmp_path / "a", text, one="one", two="two") == expected.hexdigest()
    assert hash_of(tmp_path / "b", text, one="one", two="two") == expected.hexdigest()
    assert hash_of(tmp_path / "c", text, one="two", two="one") != expected.hexdigest()


def test_a_name_that_cannot_be_a_path_hides_no_other(tmp_path: Path) -> None:
    (tmp_path / "z").write_text("")
    text = ('a = "bad\\u0000name"\nb = "%s"\nc = "z"\nd = ""\n' % ("x" * 5000)).encode()
    assert [name for name, _ in named_files(text, tmp_path)] == ["z"]
    inner = tmp_path / "inner"
    inner.mkdir()
    for name in "dbca":
        (inner / name).write_text("")
    found = named_files(b'a = "inner"', tmp_path)
    assert [name for name, _ in found] == ["inner/a", "inner/b", "inner/c", "inner/d"]


# What is written of a source


def history(frames: int = 3, attitudes: int = 3, **flags: list[int]) -> Any:
    raised = {name: np.isin(np.arange(frames), at) for name, at in flags.items()}
    some = np.any([*raised.values(), np.zeros(frames, bool)], axis=0)
    return SimpleNamespace(
        flags=SimpleNamespace(raised=raised, any=lambda: some),
        has_attitude=np.arange(frames) < attitudes,
        estimate=SimpleNamespace(frame=np.arange(frames)),
    )


def source(**more: Any) -> SolvedSource:
    given: dict[str, Any] = {
        "jobs": ["job"], "pages": [b"page 1\n", b"page 2\n"], "histories": [history()],
        "tables": {"csv": b"table", "npz": b"npz"}, **more,
    }  # fmt: skip
    return SolvedSource(BatchSource("in/deep/a.dat", "deep/a", 9), "digest", **given)


@pytest.fixture
def write(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Any:
    """Writes a source; its page holds what it was made of."""
    monkeypatch.setattr(outputs, "end_of_case", lambda: b"end\n")

    def page(histories: Any, messages: list[str], rate: Any, failed: bool) -> bytes:
        return repr((len(histories), messages, rate, failed)).encode()

    monkeypatch.setattr("vopd.report.report", page)

    def written(now: SolvedSource, **more: Any) -> tuple[SourceRecord, dict[str, bytes]]:
        record = outputs.write_source(now, settings(tmp_path / "out", **more))
        found = (tmp_path / "out").rglob("*.*")
        texts = {path.relative_to(tmp_path / "out").as_posix(): path.read_bytes() for path in found}
        return record, texts

    return written


def test_all_outputs_of_a_deck(write: Any) -> None:
    found: Any = ["warning 1", "warning 2"]
    record, texts = write(source(findings=found), report=True, max_rate_deg_s=40.0)
    assert texts == {
        "deep/a.lst": b"page 1\npage 2\nend\n", "deep/a.csv": b"table", "deep/a.npz": b"npz",
        "deep/a.html": b"(1, ['warning 1', 'warning 2'], 40.0, False)",
    }  # fmt: skip
    assert record.outputs == {
        name: hashlib.sha256(text).hexdigest() for name, text in texts.items()
    }
    assert (record.source, record.path) == ("deep/a", "in/deep/a.dat")
    assert (record.status, record.error, record.warnings) == (SOLVED, "", 2)
    assert (record.input_sha256, record.version) == ("digest", __version__)


def test_a_deck_that_broke_off_has_no_end_and_its_page_says_why(write: Any) -> None:
    record, texts = write(source(error=VopdError("a.dat: breaks off")), report=True)
    assert texts["deep/a.lst"] == b"page 1\npage 2\n"
    assert texts["deep/a.html"] == b"(1, ['a.dat: breaks off'], None, True)"
    assert (record.status, record.error) == (FAILED, "a.dat: breaks off")


def test_a_table_that_cannot_be_made_fails_the_source_alone(write: Any) -> None:
    now = source(tables={"csv": b"table", "npz": VopdError("no epoch")})
    record, texts = write(now)
    assert sorted(texts) == ["deep/a.csv", "deep/a.lst"]
    assert (record.status, record.error) == (FAILED, "in/deep/a.dat: npz: no epoch")
    both = source(tables={"npz": VopdError("no epoch")}, error=VopdError("broken"))
    assert write(both)[0].error == "broken\nin/deep/a.dat: npz: no epoch"


def test_a_source_without_any_attitude_has_a_listing_only(write: Any) -> None:
    now = source(histories=[history(3, 0)], tables={})
    record, texts = write(now, report=True)
    assert [*texts] == ["deep/a.lst"] and texts["deep/a.lst"].endswith(b"end\n")
    assert (record.status, record.error) == (FAILED, "in/deep/a.dat: no frame has an attitude")
    said = source(histories=[], jobs=[], pages=[], tables={}, error=VopdError("broken"))
    record, _ = write(said, report=True)
    assert (record.error, record.outputs) == ("broken", {})
    flight = source(jobs=[], pages=[])
    assert sorted(write(flight)[0].outputs) == ["deep/a.csv", "deep/a.npz"]


def test_counts_of_all_jobs(write: Any) -> None:
    jobs = [history(4, 3, jump=[0, 1]), history(2, 1, jump=[1], not_converged=[1], quiet=[])]
    record, _ = write(source(histories=jobs))
    assert (record.jobs, record.frames, record.attitudes, record.flagged) == (2, 6, 4, 3)
    assert (record.status, record.not_converged) == (UNCONVERGED, 1)
    assert record.flags == {"jump": 3, "not_converged": 1}
    assert source(histories=jobs).has_attitude
    assert source(histories=[history(2, 0), history(2, 1)]).has_attitude
    assert not source(histories=[history(2, 0)]).has_attitude


def test_an_output_is_written_whole_and_a_folder_that_cannot_be_made_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    given = settings(tmp_path / "out")
    (tmp_path / "out" / "deep").write_text("")
    with pytest.raises(OutputError) as refused:
        outputs.write_output(given, "deep/er/a.lst", b"")
    path = tmp_path / "out" / "deep" / "er" / "a.lst"
    assert str(refused.value) == f"{path}: its folder cannot be made: Not a directory"
    asked: list[tuple[str, str]] = []

    def spied(path: str, working: str) -> Any:
        asked.append((path, working))
        return whole_file(path, working)

    monkeypatch.setattr(outputs, "whole_file", spied)
    outputs.write_output(given, "a.lst", b"text")
    assert asked == [(str(tmp_path / "out" / "a.lst"), str(tmp_path / "out" / "w"))]
    assert (tmp_path / "out" / "a.lst").read_bytes() == b"text"
    assert [*(tmp_path / "out" / "w").iterdir()] == []


# Solving


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

    class Jobs:
        def __init__(self, jobs: Any) -> None:
            assert jobs == [job, job]

        def histories(self, *given: Any) -> Any:
            asked.append(given)
            return histories

    def render(files: Any) -> list[bytes]:
        for one in files:
            one.report("a table's warning")
            asked.append((one.histories, one.request.epoch))
        return [b"table" for _ in files]

    monkeypatch.setattr(made, "Run", Jobs)
    monkeypatch.setattr(made, "pages_of_jobs", lambda results: [[b"a", b"b"] for _ in results])
    monkeypatch.setattr(made, "misfit_findings", lambda h: ["misfit"])
    monkeypatch.setattr(made, "own_epoch", lambda h: "epoch")
    monkeypatch.setattr(made, "FORMATS", {"csv": SimpleNamespace(render_files=render)})
    given = replace(
        BatchSettings("o", "w", SolveOptions(), Sigmas(wind=2.0)), max_rate_deg_s=40.0,
        vertical="geocentric", formats=("csv",),
    )  # fmt: skip
    one, none = (SolvedSource(one, "", jobs=[job]) for one in sources(1, 1))
    made.make_outputs([one, none], given)
    assert asked == [(Sigmas(wind=2.0), 40.0, "geocentric"), ([histories[0]], "epoch")]
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
    given = BatchSettings("o", "w", SolveOptions(compare_initial=True), Sigmas())
    solving._put_together(some, given, {"0.dat": "x"})
    found: list[Any] = [(one.jobs, one.flight, one.findings, one.error) for one in some]
    assert found == [
        (jobs[:2], None, ["a", "b", "c", "e"], None), ([], None, [], error),
        ([], flight, ["d"], None), (jobs[2:], None, [], error),
    ]  # fmt: skip
