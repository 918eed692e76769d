"""What is written of each source, and what its record says."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.batch import history, settings, sources
from vopd.attitude.history import HistoryOptions
from vopd.batch import folder as outputs
from vopd.batch import solve as solving
from vopd.batch.folder import FAILED, SOLVED, UNCONVERGED, SourceRecord, failed_record, unchanged
from vopd.batch.solve import SolvedSource, write_source
from vopd.batch.sources import BatchSource
from vopd.files import OutputError, whole_file
from vopd.findings import Finding, VopdError
from vopd.version import __version__

MISTAKEN: Any = SimpleNamespace(misfits=False, mistaken=True)
MISFITS: Any = SimpleNamespace(misfits=True, mistaken=False)


def source(**more: Any) -> SolvedSource:
    given: dict[str, Any] = {
        "jobs": ["job"], "listing": b"pages", "histories": [history()],
        "tables": {"csv": b"table", "npz": b"npz"}, **more,
    }  # fmt: skip
    return SolvedSource(BatchSource("in/deep/a.dat", "deep/a", 9), "digest", **given)


@pytest.fixture
def write(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Any:
    """Writes a source; its page holds what it was made of."""

    def page(histories: Any, messages: list[str], rate: Any, failed: bool) -> bytes:
        return repr((len(histories), messages, rate, failed)).encode()

    monkeypatch.setattr("vopd.report.report", page)

    def written(now: SolvedSource, **more: Any) -> tuple[SourceRecord, dict[str, bytes]]:
        record = write_source(now, settings(tmp_path / "out", **more))
        found = (tmp_path / "out").rglob("*.*")
        texts = {path.relative_to(tmp_path / "out").as_posix(): path.read_bytes() for path in found}
        return record, texts

    return written


def test_all_outputs_of_a_deck(write: Any) -> None:
    found = [Finding("warning 1"), Finding("warning 2")]
    record, texts = write(
        source(findings=found), report="all", history=HistoryOptions(max_rate_deg_s=40.0)
    )
    assert texts == {
        "deep/a.lst": b"pages", "deep/a.csv": b"table", "deep/a.npz": b"npz",
        "deep/a.html": b"(1, ['warning 1', 'warning 2'], 40.0, False)",
    }  # fmt: skip
    assert record.outputs == {
        name: hashlib.sha256(text).hexdigest() for name, text in texts.items()
    }
    assert (record.source, record.path) == ("deep/a", "in/deep/a.dat")
    assert (record.status, record.error, record.warnings) == (SOLVED, "", 2)
    assert record.messages == ["warning 1", "warning 2"]
    many, _ = write(source(findings=[Finding(f"{k}") for k in range(21)]))
    assert many.warnings == 21 and many.messages == [f"{k}" for k in range(20)]
    assert (record.input_sha256, record.version) == ("digest", __version__)


def test_only_what_is_doubtful_has_a_page_unless_all_are_asked_for(write: Any) -> None:
    sound = source(histories=[history(4, 3, jump=[], outlier=[])])
    flagged = source(histories=[history(4, 3, jump=[1], outlier=[])])
    mistaken = source(histories=[history(4, 3, jump=[])], flight=MISTAKEN)
    for now, asked, pages in (
        (sound, "", 0), (sound, "flagged", 0), (sound, "all", 1), (flagged, "flagged", 1),
        (source(error=VopdError("broken")), "flagged", 1), (mistaken, "flagged", 1),
    ):  # fmt: skip
        assert sum(name.endswith(".html") for name in write(now, report=asked)[0].outputs) == pages
    strays = [history(4, 3, not_converged=[1])]  # which counts before that it misfits
    assert write(source(flight=MISFITS, histories=strays))[0].status == UNCONVERGED
    plain = write(source(flight=MISFITS, histories=[history(4, 3)]), report="flagged")[0]
    assert plain.status == "misfits" and len(plain.outputs) == 4


def test_the_page_of_a_deck_that_broke_off_says_why(write: Any) -> None:
    record, texts = write(source(error=VopdError("a.dat: breaks off")), report="all")
    assert texts["deep/a.html"] == b"(1, ['a.dat: breaks off'], None, True)"
    assert (record.status, record.error) == (FAILED, "a.dat: breaks off")


def test_a_table_that_cannot_be_made_fails_the_source_alone(write: Any) -> None:
    now = source(tables={"csv": b"table", "npz": VopdError("no epoch")})
    record, texts = write(now)
    assert sorted(texts) == ["deep/a.csv", "deep/a.lst"]
    assert (record.status, record.error) == (FAILED, "in/deep/a.dat: npz: no epoch")
    both = source(tables={"npz": VopdError("no epoch")}, error=VopdError("broken"))
    assert write(both)[0].error == "broken\nin/deep/a.dat: npz: no epoch"


def test_an_output_whose_name_no_file_can_have_fails_the_source_alone(write: Any) -> None:
    """In bytes and without folders: x.csv has 255 of them, x.jsonl 257; it ended the batch."""
    name = "deep/" + "é" * 125 + "x"
    long = BatchSource(f"in/{name}.dat", name, 9)
    now = replace(source(tables={"csv": b"table", "jsonl": b"table"}), source=long)
    record, texts = write(now)
    assert sorted(texts) == sorted(record.outputs) == [f"{name}.csv", f"{name}.lst"]
    assert record.status == FAILED
    assert_approved(record.error)


def test_a_source_without_any_attitude_has_a_listing_only(write: Any) -> None:
    now = source(histories=[history(3, 0)], tables={})
    record, texts = write(now, report="all")
    assert [*texts] == ["deep/a.lst"]
    assert record.status == FAILED
    assert_approved(record.error)
    said = source(histories=[], jobs=[], tables={}, error=VopdError("broken"))
    record, _ = write(said, report="all")
    assert (record.error, record.outputs) == ("broken", {})
    flight = source(jobs=[])
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
    with pytest.raises(OutputError) as refusal:
        outputs.write_output(given, "deep/er/a.lst", b"")
    path = tmp_path / "out" / "deep" / "er" / "a.lst"
    assert_approved(str(refusal.value), parts=[path])
    asked: list[tuple[str, str]] = []

    def spied(path: str, working: str) -> Any:
        asked.append((path, working))
        return whole_file(path, working)

    monkeypatch.setattr(outputs, "whole_file", spied)
    outputs.write_output(given, "a.lst", b"text")
    assert asked == [(str(tmp_path / "out" / "a.lst"), str(tmp_path / "out" / "w"))]
    assert (tmp_path / "out" / "a.lst").read_bytes() == b"text"
    assert [*(tmp_path / "out" / "w").iterdir()] == []


# One that fails costs no other

DIGEST = hashlib.sha256(b"table").hexdigest()


def test_one_source_that_raises_costs_no_other(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """All are solved together, then each by itself; a known error is told plainly."""
    calls: list[list[str]] = []
    given_locations: list[Any] = []

    def solve(some: Any, digests: Any, given: Any, locations: Any) -> list[SourceRecord]:
        calls.append([one.name for one in some])
        given_locations.append(locations)
        for one in some:
            if one.name in ("1", "2"):
                raise VopdError("no room") if one.name == "1" else KeyError("x")
        return [SourceRecord(one.name, one.path, SOLVED, "", "", "", "") for one in some]

    monkeypatch.setattr(solving, "_solve", solve)
    monkeypatch.setattr(solving, "input_sha256", lambda path: f"hash of {path}")
    given = settings(tmp_path)
    found = solving.solve_chunk(sources(1, 1, 1, 1), given)
    assert_approved([one.error for one in found])
    assert found[1] == failed_record(sources(1, 1)[1], given, "1.dat: no room", "hash of 1.dat")
    assert found[1].input_sha256 == "hash of 1.dat" and found[1].status == FAILED
    assert calls == [["0", "1", "2", "3"], ["0"], ["1"], ["2"], ["3"]]
    two = solving.solve_chunk(sources(1, 1), given)
    assert [one.error for one in two] == ["", "1.dat: no room"]

    there = {one.path: f"elsewhere/{one.path}" for one in sources(1, 1)}
    moved = solving.solve_chunk(sources(1, 1), given, there)
    assert [one.input_sha256 for one in moved][1] == "hash of elsewhere/1.dat"
    assert given_locations[-3:] == [there] * 3

    def no_space(*_: Any) -> list[SourceRecord]:
        raise OutputError("no space")

    monkeypatch.setattr(solving, "_solve", no_space)
    with refused(OutputError):
        solving.solve_chunk(sources(1, 1), given)


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
