"""What makes a batch solve a source again: its options, its input, and what its record says."""

from __future__ import annotations

import hashlib
import json
import multiprocessing
import os
import sys
from collections.abc import Iterable, Iterator
from dataclasses import fields, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.kit.batch import sources
from tests.kit.command import CASE_1
from tests.tolerances import assert_close
from vopd.attitude.history import HistoryOptions
from vopd.attitude.sigmas import Sigmas
from vopd.batch import solve
from vopd.batch import workers as pieces
from vopd.batch.folder import (
    FAILED,
    SOLVED,
    UNCONVERGED,
    BatchFolder,
    SourceRecord,
    read_record,
    remove_others,
    unchanged,
    write_summary,
)
from vopd.batch.solve import SolvedSource, write_source
from vopd.batch.sources import (
    BatchSettings,
    BatchSource,
    file_sha256,
    input_sha256,
    table_suffix,
)
from vopd.batch.workers import (
    CHUNK_BYTES,
    CHUNK_PAGES,
    CHUNK_SOURCES,
    chunks,
    even_chunk_bytes,
)
from vopd.errata import fixes
from vopd.export import FORMATS
from vopd.findings import Finding, VopdError
from vopd.flight.project.named import named_files
from vopd.pipeline import SolveOptions
from vopd.version import __version__

USUAL = BatchSettings("out", "out/.w", SolveOptions(), HistoryOptions())
CHANGED: dict[str, tuple[dict[str, Any], Any]] = {
    "fix": ({"solve": SolveOptions(fixes("restart"))}, "restart"),
    "initial": ({"solve": SolveOptions(initial="closed-form")}, "closed-form"),
    "compare_initial": ({"solve": SolveOptions(compare_initial=True)}, True),
    "limits_1974": ({"solve": SolveOptions(limits_1974=True)}, True),
    "sigmas": ({"history": HistoryOptions(Sigmas(wind=2.0))}, {"wind": 2.0}),
    "max_rate_deg_s": ({"history": HistoryOptions(max_rate_deg_s=40.0)}, 40.0),
    "vertical": ({"history": HistoryOptions(vertical="geocentric")}, "geocentric"),
    "formats": ({"formats": ("csv", "npz")}, ["csv", "npz"]),
    "report": ({"report": "all"}, "all"),
}


@pytest.mark.parametrize("name", CHANGED)
def test_an_option_stands_in_the_record_where_it_is_not_the_usual(name: str) -> None:
    changes, stands = CHANGED[name]
    options = json.loads(replace(USUAL, **changes).options)
    assert options == {"formats": ["csv"]} | {name: stands}


def test_every_setting_but_the_folders_is_an_option() -> None:
    assert json.loads(USUAL.options) == {"formats": ["csv"]}
    assert json.loads(replace(USUAL, folder="x", working="y").options) == {"formats": ["csv"]}
    of_solve = {field.name for field in fields(SolveOptions)} - {"fixes"} | {"fix"}
    of_batch = {field.name for field in fields(BatchSettings)} - {
        "folder",
        "working",
        "solve",
        "history",
    }
    of_history = {field.name for field in fields(HistoryOptions)}
    assert of_solve | of_history | of_batch == set(CHANGED)


@pytest.mark.parametrize("field", [field.name for field in fields(Sigmas)])
def test_every_standard_deviation_is_an_option(field: str) -> None:
    options = json.loads(replace(USUAL, history=HistoryOptions(Sigmas(**{field: 0.5}))).options)
    assert options["sigmas"] == {field: 0.5}


@pytest.mark.parametrize("field", ["reading", "fiducial"])
def test_a_standard_deviation_of_0_is_not_the_estimated_one(field: str) -> None:
    options = json.loads(replace(USUAL, history=HistoryOptions(Sigmas(**{field: 0.0}))).options)
    assert options["sigmas"] == {field: 0.0}


def test_suffixes_of_tables() -> None:
    expected = {
        "csv": ".csv", "jsonl": ".jsonl", "npz": ".npz", "parquet": ".parquet", "aem": ".aem",
        "acm": ".acm", "czml": ".czml", "kml": ".kml", "odm": ".geo.txt",
        "colmap": ".images.txt", "opk": ".opk.csv",
    }  # fmt: skip
    assert {form: table_suffix(form) for form in FORMATS} == expected
    page = replace(USUAL, formats=("npz", "odm"), report="flagged")
    assert page.suffixes == (".lst", ".npz", ".geo.txt", ".html")
    assert USUAL.suffixes == (".lst", ".csv")


# The hash of the input


def test_the_hash_of_a_deck_is_that_of_its_bytes(tmp_path: Path) -> None:
    assert input_sha256(str(CASE_1)) == hashlib.sha256(CASE_1.read_bytes()).hexdigest()
    assert input_sha256(str(tmp_path / "none.dat")) == ""
    assert file_sha256(tmp_path) == file_sha256(tmp_path / "none") == ""


PROJECT = """\
title = "no file"
[picks]
file = "labels"
grid = { file = "deep.csv", more = ["listed.csv", 3] }
[track]
file = "../beside.csv"
"""


def project(folder: Path) -> Path:
    """A project that names a folder, files in a table and in a list, and one beside its folder."""
    home = folder / "p"
    (home / "labels" / "inner").mkdir(parents=True)
    for name in ("labels/b.json", "labels/a.json", "deep.csv", "listed.csv", "../beside.csv",
                 "labels/inner/c.json", "not named.csv"):  # fmt: skip
        (home / name).write_text(name)
    (home / "flight.toml").write_text(PROJECT)
    return home / "flight.toml"


def test_files_that_a_project_names(tmp_path: Path) -> None:
    path = project(tmp_path)
    found = [name for name, _ in named_files(path.read_bytes(), path.parent)]
    assert found == ["../beside.csv", "deep.csv", "labels/a.json", "labels/b.json", "listed.csv"]
    assert [*named_files(b"not toml =", path.parent)] == []


@pytest.mark.parametrize(
    ("change", "differs"),
    [
        ("flight.toml", True), ("deep.csv", True), ("listed.csv", True), ("labels/a.json", True),
        ("../beside.csv", True), ("not named.csv", False), ("labels/inner/c.json", False),
    ],
)  # fmt: skip
def test_the_hash_changes_with_every_file_that_is_named(
    change: str, differs: bool, tmp_path: Path
) -> None:
    path = project(tmp_path)
    before = input_sha256(str(path))
    with (path.parent / change).open("a") as file:
        file.write("\n")
    assert (input_sha256(str(path)) != before) is differs


def test_the_hash_changes_with_the_name_of_a_file_in_a_folder(tmp_path: Path) -> None:
    """An image's name is its frame's."""
    path = project(tmp_path)
    before = input_sha256(str(path))
    (path.parent / "labels" / "a.json").rename(path.parent / "labels" / "aa.json")
    assert input_sha256(str(path)) != before


# Records


RECORD = SourceRecord("a", "a.dat", SOLVED, "", "digest", "1", "options")


def test_a_record_is_read_as_it_was_written() -> None:
    full = replace(
        RECORD, source="Zürich (a+b) \udcff", error="line\nline", jobs=2, frames=3, attitudes=4,
        flagged=5, not_converged=6, warnings=7, messages=["a\nb", "ü"], flags={"jump": 8},
        seconds=0.25, outputs={"Zürich (a+b) \udcff.csv": "x"},
    )  # fmt: skip
    line = full.line()
    assert line.endswith(b"}\n") and line.count(b"\n") == 1
    again = read_record(line.decode("utf-8"))
    assert again == full
    assert set(full.row()) == {field.name for field in fields(SourceRecord)} - {"seconds"}
    for other in (
        "",
        "{",
        line.decode()[:-20],
        "[]",
        "3",
        '{"source": "a"}',
        '{"no": 1}',
        "[" * 9999,
    ):
        assert read_record(other) is None


@pytest.mark.parametrize(
    "changes",
    [
        {"source": None}, {"path": 7}, {"status": "x"}, {"status": []}, {"version": 9},
        {"options": {}}, {"frames": "x"}, {"frames": -1}, {"jobs": True}, {"jobs": 10**400},
        {"flagged": None}, {"errata": {}}, {"seconds": "x"}, {"seconds": float("nan")},
        {"messages": "x"}, {"messages": [7]}, {"messages": None}, {"messages": {"x": 1}},
        {"flags": []}, {"flags": None}, {"flags": {"jump": "x"}}, {"outputs": {"a.csv": None}},
        {"outputs": ["a.csv"]}, {"outputs": {"a.csv\0": "x"}},
        {"outputs": {"../a.csv": "x"}}, {"outputs": {"/a.csv": "x"}},
        {"outputs": {"a./../../b": "x"}}, {"outputs": {"b.csv": "x"}},
    ],
)  # fmt: skip
def test_a_record_that_no_batch_writes_is_none(changes: dict[str, Any]) -> None:
    """They ended `--resume` with a traceback; an output may not be a file of another folder."""
    assert read_record(RECORD.line().decode()) == RECORD
    assert read_record(json.dumps(vars(RECORD) | changes)) is None


@pytest.mark.parametrize(
    ("changes", "holds"),
    [
        ({}, True), ({"status": UNCONVERGED}, True), ({"status": FAILED}, False),
        ({"version": "0"}, False), ({"options": "{}"}, False), ({"input_sha256": "0"}, False),
        ({"path": "a.dat"}, False), ({"outputs": {"a.csv": "0"}}, False),
        ({"outputs": {"none.csv": "0"}}, False),
    ],
)  # fmt: skip
def test_when_an_earlier_record_still_holds(
    changes: dict[str, Any], holds: bool, tmp_path: Path
) -> None:
    settings = replace(USUAL, folder=str(tmp_path))
    (tmp_path / "a.dat").write_text("deck")
    (tmp_path / "a.csv").write_text("table")
    digest, table = (hashlib.sha256(text).hexdigest() for text in (b"deck", b"table"))
    record = replace(
        RECORD, version=__version__, options=settings.options, input_sha256=digest,
        path=str(tmp_path / "a.dat"), outputs={"a.csv": table},
    )  # fmt: skip
    record = replace(record, **changes)
    source = BatchSource(str(tmp_path / "a.dat"), "a", 4)
    assert unchanged([source], settings, {"a": record}) == ([record] if holds else [])
    assert unchanged([source._replace(name="b")], settings, {"a": record}) == []


def test_outputs_that_are_not_written_again_are_removed(tmp_path: Path) -> None:
    for name in ("a.lst", "a.csv", "other.csv"):
        (tmp_path / name).write_text(name)
    before = replace(RECORD, outputs={"a.lst": "", "a.csv": "", "gone.npz": ""})
    remove_others(
        before, replace(RECORD, outputs={"a.lst": ""}), replace(USUAL, folder=str(tmp_path))
    )
    remove_others(None, RECORD, replace(USUAL, folder=str(tmp_path)))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.lst", "other.csv"]


@pytest.mark.parametrize("before", ["", "flagged"])
@pytest.mark.parametrize("now", ["", "all"])
def test_the_page_of_all_goes_with_the_pages(before: str, now: str, tmp_path: Path) -> None:
    """One that no batch has written stays."""
    page = tmp_path / "index.html"
    page.write_text("")
    earlier = replace(RECORD, options=replace(USUAL, report=before).options)
    settings = replace(USUAL, folder=str(tmp_path), report=now)
    remove_others(earlier, RECORD, settings)
    assert page.exists() == (now == "all" or not before)


def test_parquet_of_an_earlier_run_does_not_contradict_this_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without pyarrow the table of an earlier run would stay beside the other files."""
    pytest.importorskip("pyarrow")
    (tmp_path / "working").mkdir()
    settings = replace(USUAL, folder=str(tmp_path), working=str(tmp_path / "working"))
    write_summary(settings, [RECORD])
    assert (tmp_path / "summary.parquet").exists()
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    write_summary(settings, [RECORD])
    assert sorted(one.name for one in tmp_path.glob("*.*")) == ["summary.jsonl", "times.jsonl"]


@pytest.mark.parametrize("content", [b"", b"PAR1", b"mine", b"PAR1\x01\0\0\0PAR1", b"\xff" * 9])
def test_a_parquet_file_that_no_batch_has_written_stays(
    content: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "summary.parquet").write_bytes(content)
    (tmp_path / "working").mkdir()
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    settings = replace(USUAL, folder=str(tmp_path), working=str(tmp_path / "working"))
    write_summary(settings, [RECORD])
    assert (tmp_path / "summary.parquet").read_bytes() == content


def test_another_table_of_the_package_under_that_name_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("pyarrow")
    from vopd.export.tables import table_file

    mine = table_file({"a": np.ones(2)}, {"table": "mine"}, {"a": {"unit": "", "meaning": ""}})
    (tmp_path / "summary.parquet").write_bytes(mine)
    (tmp_path / "working").mkdir()
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    settings = replace(USUAL, folder=str(tmp_path), working=str(tmp_path / "working"))
    write_summary(settings, [RECORD])
    assert (tmp_path / "summary.parquet").read_bytes() == mine


# What earlier runs have left; the size of chunks

ONE_FRAME = SourceRecord("a", "a.dat", SOLVED, "", "", __version__, "{}", frames=1)
SETTINGS = BatchSettings("out", "out/w", SolveOptions(), HistoryOptions())


def journal(folder: Path, shard: str, age_s: int, *records: SourceRecord) -> None:
    path = folder / ".vopd-batch" / f"{shard}.jsonl"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(b"".join(one.line() for one in records))
    os.utime(path, (1e9 - age_s, 1e9 - age_s))


def records(folder: Path) -> dict[str, SourceRecord]:
    with BatchFolder(str(folder)).begun(True, "{}") as found:
        return dict(found)


@pytest.mark.parametrize("newest", ["1-of-2", "2-of-2"])
def test_of_several_records_of_a_source_the_newest_journal_s_holds(
    newest: str, tmp_path: Path
) -> None:
    """A journal comes after the summary; within a journal the last line holds."""
    (tmp_path / "summary.jsonl").write_bytes(
        b"".join(replace(ONE_FRAME, source=name, frames=9).line() for name in "ab")
    )
    for shard, frames in (("1-of-2", 1), ("2-of-2", 2)):
        age = 0 if shard == newest else 100
        both = replace(ONE_FRAME, frames=7), replace(ONE_FRAME, frames=frames)
        journal(tmp_path, shard, age, *both)
    found = records(tmp_path)
    assert found["a"].frames == int(newest[0]) and found["b"].frames == 9


def test_times_of_an_earlier_run_are_kept(tmp_path: Path) -> None:
    """The summary has none; a record that has one keeps its own."""
    rows = [replace(ONE_FRAME, source=name).row() for name in "abc"]
    (tmp_path / "summary.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
    times = [{"source": "a", "seconds": 1.5}, {"source": "b", "seconds": 2.5}]
    (tmp_path / "times.jsonl").write_text("".join(json.dumps(row) + "\n" for row in times))
    journal(tmp_path, "1-of-1", 0, replace(ONE_FRAME, source="b", seconds=0.5))
    assert {name: one.seconds for name, one in records(tmp_path).items()} == {
        "a": 1.5, "b": 0.5, "c": 0.0,
    }  # fmt: skip


def test_the_time_of_a_chunk_is_shared_by_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 12 s, sources of 1, 0 and 4 frames have 2, 2 and 8: one without frames counts as one."""
    clock: Iterator[float] = iter([100.0, 112.0])
    monkeypatch.setattr(solve, "time", SimpleNamespace(perf_counter=lambda: next(clock)))
    monkeypatch.setattr(solve, "solve_sources", lambda *_: [])
    monkeypatch.setattr(solve, "make_outputs", lambda *_: None)
    monkeypatch.setattr(
        solve, "write_source", lambda one, _: replace(ONE_FRAME, frames=one.source.size)
    )
    found = solve.solve_chunk(decks_of([1, 0, 4]), SETTINGS)
    assert [one.seconds for one in found] == [2.0, 2.0, 8.0]


def history(converged: list[int], outlier: list[int], jump: list[int]) -> Any:
    """A history of four frames, of which 2 to 4 have an attitude, with these frames flagged."""
    raised = {
        name: np.isin(np.arange(4), frames)
        for name, frames in (("not_converged", converged), ("outlier", outlier), ("jump", jump))
    }
    flags = SimpleNamespace(raised=raised, any=lambda: np.any([*raised.values()], axis=0))
    return SimpleNamespace(
        flags=flags, has_attitude=np.arange(4) > 0, estimate=SimpleNamespace(frame=np.arange(4))
    )


def test_a_record_counts_frames_of_all_jobs() -> None:
    """A frame with two flags is one flagged frame."""
    source = BatchSource("in/a.dat", "a", 0)
    jobs = [history([1], [1, 2], []), history([], [1, 3], [3])]
    found = [Finding("one"), Finding("two")]
    now = SolvedSource(source, "digest", findings=found, histories=jobs)
    assert write_source(now, SETTINGS) == SourceRecord(
        "a", "in/a.dat", "not converged", "", "digest", __version__, SETTINGS.options, jobs=2,
        frames=8, attitudes=6, not_converged=1, flagged=4, warnings=2, messages=["one", "two"],
        flags={"not_converged": 1, "outlier": 4, "jump": 1},
    )  # fmt: skip
    none = SolvedSource(source, "digest", histories=[history([], [], [])])
    clean = write_source(none, SETTINGS)
    assert (clean.status, clean.flagged, clean.flags) == ("solved", 0, {})
    now.error, now.tables = VopdError("a"), {"csv": VopdError("b")}
    failed = write_source(now, SETTINGS)
    assert (failed.status, failed.error) == ("failed", "a\nin/a.dat: csv: b")


@pytest.mark.parametrize(
    ("sizes", "expected"),
    [
        ([1] * CHUNK_SOURCES, [CHUNK_SOURCES]),
        ([1] * (CHUNK_SOURCES + 1), [CHUNK_SOURCES, 1]),
        ([CHUNK_BYTES // 2, CHUNK_BYTES // 2, 1], [2, 1]),
        ([CHUNK_BYTES // 2, CHUNK_BYTES + 2, 1], [1, 2]),  # the middle of a deck decides
        ([CHUNK_BYTES // 2, CHUNK_BYTES - 2, 1], [2, 1]),
        ([CHUNK_BYTES + 1, 1], [1, 1]),
        ([], []),
    ],
)
def test_decks_are_solved_together_up_to_a_number_and_a_size(
    sizes: list[int], expected: list[int]
) -> None:
    sources = decks_of(sizes)
    found = [*chunks(sources)]
    assert [len(chunk) for chunk in found] == expected
    assert [one for chunk in found for one in chunk] == sources


@pytest.mark.parametrize("jobs", [1, 2])
@pytest.mark.parametrize(("report", "most"), [("", None), ("flagged", CHUNK_PAGES)])
def test_a_kill_costs_few_pages(
    report: Any, most: int | None, jobs: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    sources = decks_of([1] * 190)
    planned: list[list[BatchSource]] = []

    def plan(work: object, plan: Iterable[list[BatchSource]], *_: object) -> Iterator[list[Any]]:
        planned.extend(plan)
        yield from ([] for _ in planned)

    monkeypatch.setattr(pieces, "in_processes", plan)
    monkeypatch.setattr(
        "vopd.batch.solve.solve_chunk", lambda chunk, settings: planned.append(chunk)
    )
    assert [*pieces._solved_here(sources, replace(USUAL, report=report), jobs)]
    assert [one for chunk in planned for one in chunk] == sources
    assert max(map(len, planned)) == (most or {1: 190, 2: 24}[jobs])


def decks_of(sizes: list[int]) -> list[BatchSource]:
    return [BatchSource(f"{k}.dat", str(k), size) for k, size in enumerate(sizes)]


@pytest.mark.parametrize(
    ("sizes", "processes", "expected"),
    [
        ([10] * 40, 2, [5] * 8),  # four for each process, where they are few
        ([10] * 3, 2, [1] * 3),
        ([40_000] * 44, 2, [5, 6, 5, 6, 5, 6, 5, 6]),
        ([39_000] * 2200, 2, [100] * 22),  # and not 21 of 102 and a small one
        ([100] * 2000, 3, [167, 166, 167, 167, 166, 167] * 2),  # by number: at least ten chunks
        ([10, 30, 10, 30, 10, 30, 10, 30], 1, [2] * 4),
        ([10, 10, 10, 970], 1, [3, 1]),
    ],
)
def test_processes_have_chunks_of_one_size(
    sizes: list[int], processes: int, expected: list[int]
) -> None:
    sources = decks_of(sizes)
    flight = BatchSource("flight.toml", "flight", CHUNK_BYTES)
    assert even_chunk_bytes([*sources, flight], processes) == even_chunk_bytes(sources, processes)
    found = [*chunks(sources, even_chunk_bytes(sources, processes))]
    assert [len(chunk) for chunk in found] == expected


def test_a_flight_is_a_chunk_by_itself() -> None:
    names = ["a.dat", "b.dat", "c.toml", "d.dat", "e.toml", "f.toml", "g.dat"]
    found = [*chunks([BatchSource(name, name, 1) for name in names])]
    assert [[one.name[0] for one in chunk] for chunk in found] == [
        ["a", "b"], ["c"], ["d"], ["e"], ["f"], ["g"],
    ]  # fmt: skip


# Sizes of chunks, and hashes


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


def test_a_source_that_cannot_be_read_has_no_hash(tmp_path: Path) -> None:
    """None that is not there, a folder, and a loop of links: solving it says what is wrong."""
    (tmp_path / "loop.dat").symlink_to(tmp_path / "loop.dat")
    (tmp_path / "folder.dat").mkdir()
    for name in ("loop.dat", "folder.dat", "missing.dat"):
        assert input_sha256(str(tmp_path / name)) == file_sha256(tmp_path / name) == ""


def test_a_file_of_a_project_that_is_not_there_is_none_of_its_hash(tmp_path: Path) -> None:
    project = tmp_path / "p.toml"
    project.write_text('[picks]\nfile = "a.csv"\n')
    without = input_sha256(str(project))
    (tmp_path / "a.csv").write_text("1")
    assert input_sha256(str(project)) != without != ""
    (tmp_path / "a.csv").unlink()
    assert input_sha256(str(project)) == without


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


def test_a_long_video_is_hashed_by_its_size_and_ends(tmp_path: Path) -> None:
    """A byte in the middle of 40 MB is not seen; one in the first or last 16 MB, or one more, is.

    In the middle of a table of as many it is, too.
    """
    project = tmp_path / "flight.toml"
    project.write_text('[picks]\nvideo = ["a.mp4"]\n')
    video, middle, early, late = tmp_path / "a.mp4", 20_000_000, 1_000_000, 39_000_000

    def hash_with(
        *changed: int, size: int = 40_000_000, begins: bytes = b"\0\0\0\x18ftypmp41"
    ) -> str:
        with video.open("wb") as file:
            file.write(begins)
            file.truncate(size)
            for at in changed:
                file.seek(at)
                file.write(b"x")
        return input_sha256(str(project))

    first = hash_with()
    assert hash_with(middle) == first
    changed = [hash_with(early), hash_with(late), hash_with(size=40_000_001)]
    assert len({first, *changed}) == 4
    table = b"t_s,lat_deg,lon_deg,h_m\n"
    assert hash_with(middle, begins=table) != hash_with(begins=table)


@pytest.mark.parametrize("ways", [["spawn"], ["fork", "spawn", "forkserver"]])
def test_processes_start_as_copies_where_the_system_has_them(
    ways: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Windows has none."""

    def started(way: str) -> Any:
        return SimpleNamespace(way=way, set_forkserver_preload=lambda names: None)

    monkeypatch.setattr(multiprocessing, "get_all_start_methods", lambda: ways)
    monkeypatch.setattr(multiprocessing, "get_context", started)
    found: Any = pieces._context()
    assert found.way == ways[-1]
