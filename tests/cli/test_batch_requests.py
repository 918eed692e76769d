"""Statuses of a batch, where it is solved, and which batches are refused."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tests.kit.command import CASE_1, handed, vopd
from vopd.attitude.history import HistoryOptions
from vopd.batch import workers as runs
from vopd.cli import batch as solve_batch
from vopd.cli.options import SharedOptions
from vopd.pipeline import SolveOptions

USUAL = SharedOptions(SolveOptions(), HistoryOptions(), strict=False, quiet=False)
STRICT = replace(USUAL, strict=True)
Said = pytest.CaptureFixture[str]


def record(status: str, flagged: int = 0, error: str = "") -> Any:
    return SimpleNamespace(status=status, flagged=flagged, error=error)


GOOD, FLAGGED, LOST = record("solved"), record("solved", 1), record("not converged", 1)
FAILED = record("failed", error="a: wrong")
MORE = "{} more sources failed; summary.jsonl says why"
BATCHES: list[tuple[list[Any], bool, int, list[str]]] = [
    ([], False, 0, []),
    ([], True, 0, []),
    ([GOOD], True, 0, []),
    ([FLAGGED, GOOD], False, 0, []),
    ([FLAGGED, GOOD], True, 3, []),
    ([GOOD, LOST], False, 3, []),
    ([GOOD, FAILED], False, 3, ["a: wrong"]),
    ([LOST, FAILED], False, 3, ["a: wrong"]),
    ([FAILED], False, 1, ["a: wrong"]),
    ([FAILED] * 20, False, 1, ["a: wrong"] * 20),
    ([FAILED] * 21, True, 1, ["a: wrong"] * 20 + [MORE.format(1)]),
    ([GOOD, *[FAILED] * 45], False, 3, ["a: wrong"] * 20 + [MORE.format(25)]),
]


@pytest.mark.parametrize(("records", "strict", "status", "said"), BATCHES)
def test_the_status_of_a_batch(
    records: list[Any], strict: bool, status: int, said: list[str], capsys: Said
) -> None:
    assert solve_batch._status(records, STRICT if strict else USUAL) == status
    ended = capsys.readouterr()
    assert (ended.out, ended.err.splitlines()) == ("", said)


PLACES: list[tuple[str, tuple[int, str | None, bool]]] = [
    ("", (1, None, False)),
    ("--jobs 2", (2, None, False)),
    ("--dask tcp://a:1 --jobs 1", (1, "tcp://a:1", False)),
    ("--dask tcp://a:1 --shared-filesystem", (1, "tcp://a:1", True)),
]


@pytest.mark.parametrize(("options", "place"), PLACES)
def test_where_a_batch_is_solved(
    options: str,
    place: tuple[int, str | None, bool],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    capsys: Said,
) -> None:
    """In processes, or on a cluster, whose messages go to standard error."""
    monkeypatch.setattr("vopd.batch.workers.load_ahead", lambda: None)
    words = ("batch", CASE_1, "-d", tmp_path / "out", *options.split())
    *_, jobs, dask, shared, warn = handed(monkeypatch, runs, "run_batch", *words)
    assert (jobs, dask, shared) == place
    warn("a worker is refused")
    assert capsys.readouterr() == ("", "a worker is refused\n")


def test_a_quiet_part_of_a_batch_says_nothing(tmp_path: Path) -> None:
    ran = vopd("batch", CASE_1, "-d", tmp_path / "out", "--shard", "1/2", "-q")
    assert (ran.status, ran.stderr) == (0, "")


REFUSED = [
    ("-d out", "Error: name a SOURCE, or a --manifest."),
    ("a.dat -d=", "Error: --directory needs the name of a folder; . is this one."),
    ("a.dat -d out --dask tcp://a:1 --jobs 2",
     "Error: --jobs is for this machine, --dask for a cluster: give one."),
    ("a.dat -d out --shared-filesystem", "Error: --shared-filesystem is for --dask."),
    ("a.dat", "Error: Missing option '-d' / '--directory'."),
    ("a.dat -d out --shard 0/3", "'0/3' is not I/N with I from 1 to N, for instance 2/10."),
    ("a.dat -d out --jobs 0", "0 is not in the range 1<=x<=1024."),
    ("a.dat -d out --format aem", "'aem' is not one of 'csv', 'jsonl', 'npz', 'parquet', 'kml',"),
]  # fmt: skip


@pytest.mark.parametrize(("options", "said"), REFUSED)
def test_batches_that_are_refused(options: str, said: str, tmp_path: Path) -> None:
    words = ["--directory=" if word == "-d=" else word for word in options.split()]
    ran = vopd("batch", *words)
    assert (ran.status, ran.stdout) == (2, "") and said in ran.stderr.splitlines()[-1]


@pytest.mark.parametrize("options", ["--format csv --format parquet", "--report"])
def test_packages_of_a_batch_are_looked_for_first(
    options: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("pyarrow", "jinja2"):
        monkeypatch.setitem(sys.modules, name, None)
    ran = vopd("batch", "a.dat", "-d", "out", *options.split())
    assert ran.status == 1 and "is not installed: pip install" in ran.stderr
