"""Statuses of a batch, where it is solved, and which batches are refused."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tests.approved.texts import assert_approved
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
BATCHES = [
    ([], False, 0),
    ([], True, 0),
    ([GOOD], True, 0),
    ([FLAGGED, GOOD], False, 0),
    ([FLAGGED, GOOD], True, 3),
    ([GOOD, LOST], False, 3),
    ([GOOD, FAILED], False, 3),
    ([LOST, FAILED], False, 3),
    ([FAILED], False, 1),
    ([FAILED] * 20, False, 1),
    ([FAILED] * 21, True, 1),
    ([GOOD, *[FAILED] * 45], False, 3),
]


@pytest.mark.parametrize(("records", "strict", "status"), BATCHES)
def test_the_status_of_a_batch(records: list[Any], strict: bool, status: int, capsys: Said) -> None:
    assert solve_batch._status(records, STRICT if strict else USUAL) == status
    ended = capsys.readouterr()
    assert ended.out == ""
    assert_approved(ended.err.splitlines())


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
    "-d out",
    "a.dat -d=",
    "a.dat -d out --dask tcp://a:1 --jobs 2",
    "a.dat -d out --shared-filesystem",
    "a.dat",
    "a.dat -d out --shard 0/3",
    "a.dat -d out --jobs 0",
    "a.dat -d out --format aem",
]  # fmt: skip


@pytest.mark.parametrize("options", REFUSED)
def test_batches_that_are_refused(options: str, tmp_path: Path) -> None:
    words = ["--directory=" if word == "-d=" else word for word in options.split()]
    ran = vopd("batch", *words)
    assert (ran.status, ran.stdout) == (2, "")
    assert_approved(ran.stderr.splitlines()[-1])


@pytest.mark.parametrize("options", ["--format csv --format parquet", "--report"])
def test_packages_of_a_batch_are_looked_for_first(
    options: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("pyarrow", "jinja2"):
        monkeypatch.setitem(sys.modules, name, None)
    ran = vopd("batch", "a.dat", "-d", "out", *options.split())
    assert ran.status == 1
    assert_approved(ran.stderr)
