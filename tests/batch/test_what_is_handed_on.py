"""What a batch hands on: options to histories, all records to totals, counts, an address."""

from __future__ import annotations

import logging
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.kit.estimates import POINTS, estimate
from vopd.attitude.history import HistoryOptions, history
from vopd.attitude.sigmas import Sigmas
from vopd.batch import run as runs
from vopd.batch.dask import client_of
from vopd.batch.folder import FAILED, SOLVED, UNCONVERGED, SourceRecord
from vopd.batch.run import SolvedSource, make_outputs, summary_text
from vopd.batch.sources import BatchSettings, BatchSource, _entries
from vopd.findings import VopdError
from vopd.pipeline import SolveOptions

HISTORY = HistoryOptions(Sigmas(wind=2.0), 40.0, "geocentric")
SETTINGS = BatchSettings("out", "out/.w", SolveOptions(), HISTORY, ())


def test_the_history_of_a_flight_has_all_options_of_the_batch() -> None:
    asked: list[HistoryOptions] = []
    made = history(estimate(np.array([[140.0, -60.0, 20.0]]), POINTS))

    def of_flight(options: HistoryOptions) -> Any:
        asked.append(options)
        return SimpleNamespace(whole=made)

    flight: Any = SimpleNamespace(history_parts=of_flight)
    source = SolvedSource(BatchSource("a.toml", "a", 1), "", flight=flight)
    make_outputs([source], SETTINGS)
    assert asked == [HISTORY]
    assert source.histories == [made] and source.pages == []


def test_totals_are_of_all_sources_and_not_only_of_those_shown() -> None:
    """Of 23 sources 20 are shown; the three that are not are solved ones."""
    good = SourceRecord("a", "a.dat", SOLVED, "", "", "", "", jobs=1, frames=5, attitudes=4)
    records = [replace(good, source=f"s{k}") for k in range(21)]
    records += [replace(good, source="lost", status=UNCONVERGED, not_converged=1)]
    records += [SourceRecord("bad", "bad.dat", FAILED, "bad.dat: breaks off", "", "", "")]
    more, totals = summary_text(records).splitlines()[-2:]
    assert more == "... and 3 more, none worse than the last of these"
    expected = "23 sources: 1 failed, 1 not converged, 21 solved; 110 frames, 88 with an attitude"
    assert totals == expected


def test_every_source_is_counted_and_kept_once(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Records come in lists of any length, none too, in any order; they end in that of sources."""
    sources = [BatchSource(f"{name}.dat", name, 1) for name in "abcde"]
    by_name = {name: SourceRecord(name, f"{name}.dat", SOLVED, "", "", "", "") for name in "abcde"}
    lists = [[by_name["c"], by_name["a"], by_name["e"]], [], [by_name["d"], by_name["b"]]]
    monkeypatch.setattr(runs, "_solved", lambda *_: iter(lists))
    kept: list[Any] = []
    counts: list[int] = []
    folder: Any = SimpleNamespace(keep=kept.append)
    records = runs.run_batch(sources, SETTINGS, folder, {}, counts.append)
    assert counts == [3, 0, 2]
    assert kept == [lists[0], lists[2]]
    assert records == [by_name[name] for name in "abcde"]


@pytest.mark.parametrize(
    ("address", "answer"),
    [
        ("10.0.0.1:1", "no scheduler answers at this address"),
        ("10.0.0.1:65535", "no scheduler answers at this address"),
        ("tls://10.0.0.1:65535", "no scheduler answers at this address"),
        ("10.0.0.1:0", "not an address such as tcp://10.0.0.1:8786"),
        ("10.0.0.1:65536", "not an address such as tcp://10.0.0.1:8786"),
        ("ucx://10.0.0.1:8786", "not an address such as tcp://10.0.0.1:8786"),
        ("tcp://10.0.0.1:65536", "not an address such as tcp://10.0.0.1:8786"),
        ("10.0.0.1", "not an address such as tcp://10.0.0.1:8786"),
    ],
)
def test_ports_of_an_address_from_both_sides(
    address: str, answer: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A port is 1 to 65535; `distributed` is asked only for one of these."""
    asked: list[str] = []

    def client(given: str, **options: object) -> None:
        asked.append(given)
        assert options == {"timeout": 10, "set_as_default": False}
        raise OSError

    def host_port(whole: str, strict: bool) -> tuple[str, int]:
        assert strict and whole == (address if "://" in address else f"tcp://{address}")
        if whole.startswith("ucx"):
            raise NotImplementedError
        host, _, port = whole.partition("://")[2].partition(":")
        return host, int(port)

    modules = {"distributed": {"Client": client}, "distributed.comm": {}}
    modules["distributed.comm.addressing"] = {"get_address_host_port": host_port}
    for name, values in modules.items():
        module = ModuleType(name)
        vars(module).update(values, __file__=f"{name}.py")
        monkeypatch.setitem(sys.modules, name, module)
    silenced: list[int] = []
    monkeypatch.setattr(logging, "disable", silenced.append)
    with pytest.raises(VopdError) as error:
        client_of(address)
    assert str(error.value) == f"--dask {address}: {answer}"
    assert asked == ([address] if answer.startswith("no scheduler") else [])
    assert silenced == [logging.CRITICAL]


def test_without_distributed_its_name_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(VopdError) as error:
        client_of("tcp://10.0.0.1:8786")
    assert str(error.value) == "distributed is not installed: pip install 'vopd[dask]'"


@pytest.mark.parametrize(
    ("content", "found"),
    [
        (b"a.dat\nb/c.dat\n", ["a.dat", "b/c.dat"]),
        (b"\xef\xbb\xbfa.dat\r\n\r\n  b c.dat \r\n", ["a.dat", "b c.dat"]),
        (
            b"# all\n a.dat # not a comment\n#b.dat\n\xc3\xbc.dat",
            ["a.dat # not a comment", "ü.dat"],
        ),
        (b"", "the manifest is empty: write one source on each line"),
        (b"\xef\xbb\xbf", "the manifest is empty: write one source on each line"),
        (b"# a.dat\n \n", "the manifest is empty: write one source on each line"),
        (b"a.dat\n\xfc.dat\n", "not a text file in UTF-8, at byte 6"),
        (None, "No such file or directory"),
    ],
)
def test_lines_of_a_manifest(content: bytes | None, found: Any, tmp_path: Path) -> None:
    """Spreadsheets begin a text with the mark of its byte order, and end lines as Windows does."""
    path = tmp_path / "list"
    if content is not None:
        path.write_bytes(content)
    if isinstance(found, list):
        assert _entries(str(path)) == found
    else:
        with pytest.raises(VopdError) as refused:
            _entries(str(path))
        assert str(refused.value) == f"{path}: {found}"
