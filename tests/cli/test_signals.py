"""A signal ends the process at once, with status 128 + its number and nothing left behind."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.approved.texts import assert_approved
from tests.kit.command import PROCESSOR, ROOT

SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]
ENVIRONMENT = {"PATH": os.defpath, "PYTHONPATH": str(ROOT), "LANG": "C.UTF-8"} | PROCESSOR
WRITING = """
import sys, time
from vopd.__main__ import stop_at_signals
stop_at_signals()
from vopd.files import whole_file
with whole_file("out") as one, whole_file("other") as other:
    one.write(b"x" * 100_000)
    other.write(b"x")
    print("writing", flush=True)
    time.sleep(60)
"""


@pytest.fixture(autouse=True)
def noticed() -> Iterator[None]:
    """No signal is ignored here, also where the tests run in the background or under nohup."""
    kept = {number: signal.signal(number, signal.SIG_DFL) for number in SIGNALS}
    yield
    for number, handler in kept.items():
        signal.signal(number, handler)


def start(*arguments: str, place: Path) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, *arguments], cwd=place, env=ENVIRONMENT, text=True,
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip


@pytest.mark.parametrize("number", SIGNALS)
def test_temporary_files_are_removed(number: signal.Signals, tmp_path: Path) -> None:
    (tmp_path / "out").write_text("old\n")
    with start("-c", WRITING, place=tmp_path) as process:
        assert process.stdout is not None and process.stderr is not None
        assert process.stdout.readline() == "writing\n"
        assert len(list(tmp_path.iterdir())) == 3
        process.send_signal(number)
        assert (process.wait(30), process.stderr.read()) == (128 + number, "")
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
    assert (tmp_path / "out").read_text() == "old\n"


@pytest.mark.parametrize("number", SIGNALS)
def test_a_command_that_waits_for_cards(number: signal.Signals, tmp_path: Path) -> None:
    """The signal may come while modules are imported, or while standard input is read."""
    with start("-m", "vopd", "run", "-", "-o", "out", place=tmp_path) as process:
        assert process.stderr is not None
        until = time.monotonic() + 30
        while not handled(process.pid, number) and time.monotonic() < until:
            time.sleep(0.001)
        process.send_signal(number)
        assert (process.wait(30), process.stderr.read()) == (128 + number, "")
    assert list(tmp_path.iterdir()) == []


def handled(pid: int, number: int) -> bool:
    """Whether a process of Linux has a handler of its own for a signal.

    Python has one for SIGINT from its start; SIGTERM's comes with this program's.
    """
    mark = signal.SIGTERM if number == signal.SIGINT else number
    try:
        status = Path(f"/proc/{pid}/status").read_text()
    except FileNotFoundError:
        return True
    caught = next(line for line in status.splitlines() if line.startswith("SigCgt"))
    return bool(int(caught.split()[1], 16) >> (mark - 1) & 1)


def test_a_signal_that_the_caller_ignores_stays_ignored(tmp_path: Path) -> None:
    """As under nohup."""
    ignoring = "import signal; signal.signal(signal.SIGHUP, signal.SIG_IGN)"
    with start("-c", ignoring + WRITING, place=tmp_path) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "writing\n"
        process.send_signal(signal.SIGHUP)
        time.sleep(0.05)
        assert process.poll() is None
        process.send_signal(signal.SIGTERM)
        assert process.wait(30) == 128 + signal.SIGTERM
    assert list(tmp_path.iterdir()) == []


def test_signals_are_handled_before_anything_large_is_imported() -> None:
    program = (
        "import sys, vopd.__main__ as main\n"
        "main.signal.signal = lambda *_: (print(' '.join(sys.modules)), sys.exit())\n"
        "main.main()"
    )
    run = subprocess.run(
        [sys.executable, "-c", program], env=ENVIRONMENT, capture_output=True, text=True
    )
    assert run.returncode == 0 and run.stderr == ""
    assert "vopd.__main__" in run.stdout.split()
    assert not {"click", "numpy", "tempfile", "vopd.cli"} & set(run.stdout.split())


def test_a_machine_without_hangups(monkeypatch: pytest.MonkeyPatch) -> None:
    """Windows has no SIGHUP."""
    from vopd import __main__

    kept: dict[int, object] = {}
    monkeypatch.setattr(__main__.signal, "signal", kept.__setitem__)
    monkeypatch.delattr(__main__.signal, "SIGHUP")
    __main__.stop_at_signals()
    assert set(kept) == {signal.SIGINT, signal.SIGTERM}


INTERRUPTED = """
import os, signal
from vopd import __main__ as program
from vopd.cli import console
console.PATIENCE_S = -1.0  # as if the work had lasted
plain = console.Progress.add
def add(self, count):
    plain(self, count)
    if count:
        os.kill(os.getpid(), signal.SIGINT)
console.Progress.add = add
program.main()
"""


@pytest.mark.parametrize(
    "command", ["batch in -d out", "attitude in -o table.csv", "attitude in --format csv"]
)
def test_what_is_done_and_how_it_goes_on(command: str, tmp_path: Path) -> None:
    """The first part of the work is done when Ctrl-C is pressed."""
    for name in ("in", "in/later"):
        shutil.copytree(ROOT / "examples" / "hill", tmp_path / name)
    with start("-c", INTERRUPTED, *command.split(), place=tmp_path) as process:
        _, errors = process.communicate(timeout=60)
    assert process.returncode == 128 + signal.SIGINT
    assert_approved(errors)
    assert not (tmp_path / "table.csv").exists()
