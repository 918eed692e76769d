"""What is written of each source, and what its record says."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import pytest

from tests.kit.batch import history, settings
from vopd.attitude.history import HistoryOptions
from vopd.batch import run as outputs
from vopd.batch.folder import FAILED, SOLVED, UNCONVERGED, SourceRecord
from vopd.batch.run import SolvedSource
from vopd.batch.sources import BatchSource
from vopd.files import OutputError, whole_file
from vopd.findings import VopdError
from vopd.version import __version__


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
    record, texts = write(
        source(findings=found), report=True, history=HistoryOptions(max_rate_deg_s=40.0)
    )
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
