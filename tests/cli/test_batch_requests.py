"""What a batch is asked for, option by option, and which batches are refused."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest

from tests.kit.command import vopd
from tests.kit.handed_over import handed
from vopd.cli import batch as solve_batch

BATCHES: list[tuple[str, dict[str, Any]]] = [
    ("", {}),
    ("--manifest m.txt", {"manifest": "m.txt"}),
    ("--format kml --format csv --format kml", {"formats": ("kml", "csv")}),
    ("--report", {"report": True}),
    ("--jobs 2", {"jobs": 2}),
    ("--shard 2/10", {"shard": (2, 10)}),
    ("--dask tcp://a:1", {"dask": "tcp://a:1"}),
    ("--dask tcp://a:1 --shared-filesystem", {"dask": "tcp://a:1", "shared": True}),
    ("--resume", {"resume": True}),
]


@pytest.mark.parametrize(("options", "changes"), BATCHES)
def test_every_option_of_a_batch(
    options: str, changes: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("vopd.batch.run.load_ahead", lambda: None)
    words = ("batch", "b.dat", "a.dat", "-d", "out", *options.split())
    request = handed(monkeypatch, solve_batch, "solve_batch", *words)[0]
    usual = solve_batch.BatchRequest(
        sources=("b.dat", "a.dat"), manifest=None, folder="out", shard=(1, 1), jobs=1,
        formats=("csv",), report=False, dask=None, shared=False, resume=False,
    )  # fmt: skip
    assert request == usual._replace(**changes)


@pytest.mark.parametrize("status", [0, 1, 3])
def test_the_status_of_a_batch_is_that_of_the_process(
    status: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(solve_batch, "solve_batch", lambda *_: status)
    assert vopd("batch", "a.dat", "-d", "out").status == status


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


@pytest.mark.parametrize("options", ["--manifest m", "a.dat --dask tcp://a:1 --jobs 1"])
def test_batches_that_are_taken(options: str, monkeypatch: pytest.MonkeyPatch) -> None:
    handed(monkeypatch, solve_batch, "solve_batch", "batch", "-d", "out", *options.split())


@pytest.mark.parametrize("options", ["--format csv --format parquet", "--report"])
def test_packages_of_a_batch_are_looked_for_first(
    options: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("pyarrow", "jinja2"):
        monkeypatch.setitem(sys.modules, name, None)
    ran = vopd("batch", "a.dat", "-d", "out", *options.split())
    assert ran.status == 1 and "is not installed: pip install" in ran.stderr
