"""The files of a summary: every column, the times, the page, and where they are written."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.approved.texts import assert_approved
from tests.kit.command import vopd
from vopd.attitude.flags import MEANING
from vopd.attitude.history import HistoryOptions
from vopd.batch import folder as summary
from vopd.batch.folder import (
    FAILED,
    MISFITS,
    SOLVED,
    UNCONVERGED,
    SourceRecord,
    failed_record,
    summary_text,
    totals,
    worst_first,
)
from vopd.batch.sources import BatchSettings, BatchSource
from vopd.findings import VopdError
from vopd.pipeline import SolveOptions
from vopd.version import __version__

FULL = SourceRecord(
    "deep/ü", "in/ü.dat", UNCONVERGED, "", "hash", "9.9", "{}", jobs=1, frames=2, attitudes=3,
    not_converged=4, flagged=5, warnings=6, messages=["ü 1", "2"], mistaken=1, errata=2, unread=1,
    flags={"jump": 7, "outlier": 8},
    outputs={"deep/ü.lst": "x", "deep/ü.html": "y"}, seconds=1.23456789,
)  # fmt: skip
BROKEN = SourceRecord("b", "b.dat", FAILED, "b.dat: breaks off", "", "9.9", "{}", seconds=0.5)
GOOD = replace(FULL, source="c", status=SOLVED, not_converged=0, flagged=0, flags={}, outputs={})

COLUMNS = [
    "source",
    "path",
    "status",
    "error",
    "input_sha256",
    "version",
    "options",
    "jobs",
    "frames",
    "attitudes",
    "not_converged",
    "flagged",
    "warnings",
    "messages",
    "mistaken",
    "errata",
    "unread",
]


def settings(folder: Path, report: str = "") -> BatchSettings:
    (folder / "w").mkdir(parents=True)
    given = SolveOptions(), HistoryOptions()
    return BatchSettings(str(folder), str(folder / "w"), *given, report=report)


def test_words_and_order_of_how_sources_end() -> None:
    assert (SOLVED, MISFITS, UNCONVERGED) == ("solved", "misfits", "not converged")
    assert summary.WORST_FIRST == (FAILED, "not converged", "misfits", "solved")
    one = replace(FULL, source="one", not_converged=1, flagged=9)
    two = replace(FULL, source="two", not_converged=2, flagged=1)
    three = replace(FULL, source="three", not_converged=2, flagged=2)
    assert summary.worst_first([one, two, three]) == [three, two, one]


def test_the_lines_of_the_summary_and_of_the_times(tmp_path: Path) -> None:
    """The summary has no seconds, so that two runs write the same; letters stand as they are."""
    summary.write_summary(settings(tmp_path / "out"), [FULL, BROKEN])
    lines = (tmp_path / "out" / "summary.jsonl").read_text(encoding="utf-8").splitlines()
    assert lines[0] == (
        '{"source": "deep/ü", "path": "in/ü.dat", "status": "not converged", "error": "", '
        '"input_sha256": "hash", "version": "9.9", "options": "{}", "jobs": 1, "frames": 2, '
        '"attitudes": 3, "not_converged": 4, "flagged": 5, "warnings": 6, '
        '"messages": ["ü 1", "2"], "mistaken": 1, "errata": 2, "unread": 1, '
        '"flags": {"jump": 7, "outlier": 8}, "outputs": {"deep/ü.lst": "x", "deep/ü.html": "y"}}'
    )
    assert json.loads(lines[1])["error"] == "b.dat: breaks off" and len(lines) == 2
    assert (tmp_path / "out" / "times.jsonl").read_text(encoding="utf-8") == (
        '{"source": "deep/ü", "seconds": 1.234568}\n{"source": "b", "seconds": 0.5}\n'
    )
    assert not (tmp_path / "out" / "index.html").exists()
    assert [*(tmp_path / "out" / "w").iterdir()] == []


def test_files_are_made_in_the_folder_of_temporary_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[tuple[str, str]] = []
    usual = summary.whole_file

    def spied(path: str, working: str) -> Any:
        asked.append((Path(path).name, working))
        return usual(path, working)

    monkeypatch.setattr(summary, "whole_file", spied)
    given = settings(tmp_path / "out")
    summary.write_summary(given, [FULL])
    assert {name for name, _ in asked} == {"summary.jsonl", "times.jsonl", "summary.parquet"}
    assert {working for _, working in asked} == {given.working}


def test_every_column_of_the_parquet_file(tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    summary.write_summary(settings(tmp_path / "out"), [FULL, BROKEN])
    table = parquet.read_table(tmp_path / "out" / "summary.parquet")
    names = [*COLUMNS, *(f"flag_{name}" for name in MEANING)]
    assert table.column_names == names
    first, second = table.to_pylist()
    assert (first.pop("messages"), second.pop("messages")) == ("ü 1\n2", "")
    for name in [one for one in COLUMNS if one != "messages"]:
        assert (first[name], second[name]) == (getattr(FULL, name), getattr(BROKEN, name))
    flags = {name: first[f"flag_{name}"] for name in MEANING if first[f"flag_{name}"]}
    assert flags == {"jump": 7, "outlier": 8}
    assert all(second[f"flag_{name}"] == 0 for name in MEANING)
    for name in names:
        meta = {key.decode(): text.decode() for key, text in table.field(name).metadata.items()}
        assert meta["unit"] == ""
        assert_approved(f"{name}: {meta['meaning']}")
    stated = json.loads(table.schema.metadata[b"conventions"])
    assert_approved(stated)


def test_without_pyarrow_there_is_no_parquet_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from vopd.export import FORMATS

    def missing() -> None:
        raise VopdError("pyarrow is not installed")

    monkeypatch.setattr(type(FORMATS["parquet"]), "ready", lambda self: missing())
    summary.write_summary(settings(tmp_path / "out"), [FULL])
    written = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert written == ["summary.jsonl", "times.jsonl", "w"]


def test_the_page_has_the_worst_first_and_links_to_pages_that_there_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    heads: list[Any] = []

    def page(rows: Any, totals: str, failed: int) -> bytes:
        heads.append((rows, totals, failed))
        return b"<html>"

    monkeypatch.setattr("vopd.report.batch_page", page)
    summary.write_summary(settings(tmp_path / "out", report="all"), [GOOD, FULL, BROKEN])
    assert_approved(heads)
    assert (tmp_path / "out" / "index.html").read_bytes() == b"<html>"


def test_the_record_of_a_source_that_failed() -> None:
    given = BatchSettings("o", "w", SolveOptions(), HistoryOptions())
    source = BatchSource("in/a.dat", "a", 1)
    assert failed_record(source, given, "in/a.dat: why", "digest") == SourceRecord(
        source="a", path="in/a.dat", status="failed", error="in/a.dat: why",
        input_sha256="digest", version=__version__, options='{"formats": ["csv"]}',
    )  # fmt: skip
    failed = failed_record(source, given, "why")
    assert failed.input_sha256 == ""
    counts = [value for value in vars(failed).values() if isinstance(value, int | float)]
    assert len(counts) > 8 and not any(counts)
    assert (given.history, given.report) == (HistoryOptions(), "")


# For people

CLEAN = SourceRecord("a", "a.dat", SOLVED, "", "", "", "", jobs=1, frames=5, attitudes=4)
DOUBTFUL = replace(
    CLEAN, source="b/long\nname", flagged=3, warnings=2, flags={"outlier": 1, "two_landmarks": 2}
)
LOST = replace(CLEAN, source="c", status=UNCONVERGED, not_converged=1, flagged=1)
MORE_LOST = replace(LOST, source="d", not_converged=2)
FAILS = SourceRecord("e", "e.dat", FAILED, "e.dat: breaks off", "", "", "")


def test_the_worst_come_first() -> None:
    """Failed, then by frames that did not converge, then by flags; alike ones stay in order."""
    alike = replace(CLEAN, source="z")
    records = [alike, CLEAN, DOUBTFUL, LOST, MORE_LOST, FAILS]
    order = [one.source for one in worst_first(records)]
    assert order == ["e", "d", "c", "b/long\nname", "z", "a"]


def test_the_table_and_its_totals() -> None:
    assert_approved(summary_text([CLEAN, DOUBTFUL, FAILS]))
    assert_approved(totals([LOST]))


def test_twenty_sources_are_shown() -> None:
    records = [replace(CLEAN, source=f"deck {k}") for k in range(22)]
    for count in (20, 22):
        lines = summary_text(records[:count]).splitlines()
        assert [line.split("  ")[0] for line in lines[1:21]] == [f"deck {k}" for k in range(20)]
        assert_approved(lines[21:-1])


def test_twenty_failures_are_told(tmp_path: Path) -> None:
    missing = [tmp_path / f"no-{k:02d}.dat" for k in range(22)]
    for count in (20, 22):
        ran = vopd("batch", *missing[:count], "-d", tmp_path / f"out{count}")
        lines = ran.stderr.splitlines()
        assert ran.status == 1
        assert_approved(lines[20:])
        told = [f"{path}: No such file or directory" for path in missing[:20]]
        assert lines[:20] == told


# Totals


def test_totals_are_of_all_sources_and_not_only_of_those_shown() -> None:
    """Of 23 sources 20 are shown; the three that are not are solved ones."""
    good = SourceRecord("a", "a.dat", SOLVED, "", "", "", "", jobs=1, frames=5, attitudes=4)
    records = [replace(good, source=f"s{k}") for k in range(21)]
    records += [replace(good, source="lost", status=UNCONVERGED, not_converged=1)]
    records += [SourceRecord("bad", "bad.dat", FAILED, "bad.dat: breaks off", "", "", "")]
    more, totals = summary_text(records).splitlines()[-2:]
    assert_approved(more)
    assert_approved(totals)
