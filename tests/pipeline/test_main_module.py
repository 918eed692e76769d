"""The command line as a process: which signals end it, what is removed, and with which status."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from vopd import __main__ as main_module
from vopd.files import TEMPORARY

NUMBERS = {"SIGINT": 2, "SIGTERM": 15, "SIGHUP": 1}


@pytest.mark.parametrize("ignored", [None, "SIGINT", "SIGTERM", "SIGHUP"])
@pytest.mark.parametrize("missing", [None, "SIGHUP"])
def test_every_signal_that_is_not_ignored_ends_the_process(
    ignored: str | None, missing: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As nohup has SIGHUP ignored. Windows has none."""
    handlers: dict[int, object] = {}
    there = {name: number for name, number in NUMBERS.items() if name != missing}
    usual = dict.fromkeys(there.values(), signal.SIG_DFL)
    if ignored in there:
        usual[there[ignored]] = signal.SIG_IGN
    stub = SimpleNamespace(
        **there, SIG_IGN=signal.SIG_IGN, getsignal=usual.get, signal=handlers.__setitem__
    )
    monkeypatch.setattr(main_module, "signal", stub)
    main_module.stop_at_signals()
    expected = {number for name, number in there.items() if name != ignored}
    assert set(handlers) == expected
    assert set(handlers.values()) == {main_module.stop}


class Ended(Exception):
    """Instead of the end of the process."""


@pytest.mark.parametrize("number", [1, 2, 15])
def test_a_signal_removes_temporary_files_and_tells_its_number(
    number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One that is gone already does not keep the others from being removed."""
    statuses: list[int] = []

    def end(status: int) -> None:
        statuses.append(status)
        raise Ended

    monkeypatch.setattr(main_module.os, "_exit", end)
    files = [tmp_path / f"{k}" for k in range(3)]
    for path in files[::2]:
        path.write_bytes(b"")
    monkeypatch.setattr("vopd.files.TEMPORARY", [str(path) for path in files])
    with pytest.raises(Ended):
        main_module.stop(number, None)
    assert statuses == [128 + number] and not any(path.exists() for path in files)
    monkeypatch.delitem(sys.modules, "vopd.files")  # nothing was written so far
    with pytest.raises(Ended):
        main_module.stop(number, None)
    assert statuses == [128 + number] * 2 and not TEMPORARY


def test_signals_are_handled_before_anything_else_is_loaded(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    order: list[str] = []
    monkeypatch.setattr(main_module, "stop_at_signals", lambda: order.append("signals"))
    monkeypatch.setattr("vopd.cli.cli", lambda: order.append("command"))
    monkeypatch.setattr("vopd.cli.console.prepare_streams", lambda: order.append("streams"))
    main_module.main()
    assert order == ["signals", "streams", "command"]
    assert main_module.SIGNALS == ("SIGINT", "SIGTERM", "SIGHUP")


def test_freed_memory_is_kept_where_the_c_library_has_such_options(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """By the numbers of glibc's malloc.h; macOS and musl have none, Windows no such library."""
    told: list[tuple[int, int]] = []
    library = SimpleNamespace(mallopt=lambda option, value: told.append((option, value)))
    monkeypatch.setattr("ctypes.CDLL", lambda name: library)
    main_module.keep_freed_memory()
    assert told == [(-3, 33_554_432), (-1, 134_217_728)]
    monkeypatch.setattr("ctypes.CDLL", lambda name: SimpleNamespace())
    main_module.keep_freed_memory()
    monkeypatch.setattr("ctypes.CDLL", lambda name: len(name))
    main_module.keep_freed_memory()
    assert len(told) == 2


@pytest.mark.parametrize("own", [None, "3"])
def test_a_process_takes_one_thread_of_openblas_unless_told_otherwise(own: str | None) -> None:
    """Its threads wait in a loop: of a flight with free parameters two took four times as long."""
    name, program = "OPENBLAS_NUM_THREADS", "import os, sys, vopd.__main__ as process\n"
    program += "sys.argv = ['vopd', '--version']\ntry:\n    process.main()\n"
    program += f"except SystemExit:\n    print(os.environ[{name!r}])"
    others = {key: value for key, value in os.environ.items() if key != name}
    found = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True,
        env=others | ({} if own is None else {name: own}),
    )  # fmt: skip
    assert found.stdout.split()[-1] == (own or "1")
