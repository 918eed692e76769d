"""What earlier runs have left in an output folder; chunks, and the time that each source took."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from vopd.attitude.history import HistoryOptions
from vopd.batch import run as solve_chunk
from vopd.batch.folder import SOLVED, BatchFolder, SourceRecord
from vopd.batch.run import (
    CHUNK_BYTES,
    CHUNK_SOURCES,
    SolvedSource,
    _record,
    chunks,
    even_chunk_bytes,
)
from vopd.batch.sources import BatchSettings, BatchSource
from vopd.pipeline import SolveOptions
from vopd.version import __version__

RECORD = SourceRecord("a", "a.dat", SOLVED, "", "", __version__, "{}", frames=1)
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
        b"".join(replace(RECORD, source=name, frames=9).line() for name in "ab")
    )
    for shard, frames in (("1-of-2", 1), ("2-of-2", 2)):
        age = 0 if shard == newest else 100
        journal(tmp_path, shard, age, replace(RECORD, frames=7), replace(RECORD, frames=frames))
    found = records(tmp_path)
    assert found["a"].frames == int(newest[0]) and found["b"].frames == 9


def test_times_of_an_earlier_run_are_kept(tmp_path: Path) -> None:
    """The summary has none; a record that has one keeps its own."""
    rows = [replace(RECORD, source=name).row() for name in "abc"]
    (tmp_path / "summary.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
    times = [{"source": "a", "seconds": 1.5}, {"source": "b", "seconds": 2.5}]
    (tmp_path / "times.jsonl").write_text("".join(json.dumps(row) + "\n" for row in times))
    journal(tmp_path, "1-of-1", 0, replace(RECORD, source="b", seconds=0.5))
    assert {name: one.seconds for name, one in records(tmp_path).items()} == {
        "a": 1.5, "b": 0.5, "c": 0.0,
    }  # fmt: skip


def test_the_time_of_a_chunk_is_shared_by_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 12 s, sources of 1, 0 and 4 frames have 2, 2 and 8: one without frames counts as one."""
    clock: Iterator[float] = iter([100.0, 112.0])
    monkeypatch.setattr(solve_chunk, "time", SimpleNamespace(perf_counter=lambda: next(clock)))
    monkeypatch.setattr(solve_chunk, "_put_together", lambda *_: None)
    monkeypatch.setattr(solve_chunk, "make_outputs", lambda *_: None)
    monkeypatch.setattr(solve_chunk, "write_source", lambda one, _: one)
    some: Any = [replace(RECORD, frames=frames) for frames in (1, 0, 4)]
    found = solve_chunk._solve(some, SETTINGS, {})
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
    found: Any = ["one", "two"]
    now = SolvedSource(source, "digest", findings=found, histories=jobs)
    assert _record(now, [], {"a.lst": "x"}, SETTINGS) == SourceRecord(
        "a", "in/a.dat", "not converged", "", "digest", __version__, SETTINGS.options, jobs=2,
        frames=8, attitudes=6, not_converged=1, flagged=4, warnings=2,
        flags={"not_converged": 1, "outlier": 4, "jump": 1}, outputs={"a.lst": "x"},
    )  # fmt: skip
    none = SolvedSource(source, "digest", histories=[history([], [], [])])
    clean = _record(none, [], {}, SETTINGS)
    assert (clean.status, clean.flagged, clean.flags) == ("solved", 0, {})
    failed = _record(now, ["a", "b"], {}, SETTINGS)
    assert (failed.status, failed.error) == ("failed", "a\nb")


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
