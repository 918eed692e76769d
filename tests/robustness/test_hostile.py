"""Every row of the table of hostile constants, on a pseudo-terminal, in a process of its own.

The process is a fork of this one, so that a row costs some hundredths of a second.
"""

from __future__ import annotations

import os
import resource
import shlex
import signal
import sys
import time
import warnings
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from tests.approved.texts import assert_approved
from tests.kit.hostile import LONGEST, TABLE, Hostile

pty = pytest.importorskip("pty", reason="no pseudo-terminals here")
LOADED = (
    "yaml", "gpxpy", "jinja2", "pyproj", "scipy.optimize", "PIL.JpegImagePlugin",
    "PIL.TiffImagePlugin",
    *(f"vopd.cli.{one}" for one in ("attitude", "batch", "cards", "check", "new", "pick", "punch")),
    "vopd.batch.workers", "vopd.check", "vopd.cli.run", "vopd.cli.stars.solve",
    "vopd.convert.flight_to_deck", "vopd.flight.check", "vopd.flight.project.new",
    "vopd.flight.result", "vopd.stellar.radec",
)  # fmt: skip
UNSEEN = "\u200b\u2028\u2029\u2060\ufeff"
UNSEEN += "\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"
PATIENCE_S = 20.0  # by the clock: what hangs is ended


class Shown(NamedTuple):
    """What a command showed on its terminal, and what it cost."""

    status: int
    text: str
    seconds: float
    megabytes: float


def shown(command: list[str]) -> Shown:
    """Run a command in the current folder."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    child, terminal = pty.fork()
    if child == 0:
        _run(command)
    parts, until = [], time.monotonic() + PATIENCE_S
    signal.signal(signal.SIGALRM, lambda *_: os.kill(child, signal.SIGKILL))
    signal.setitimer(signal.ITIMER_REAL, PATIENCE_S)
    try:
        while part := os.read(terminal, 1 << 16):
            parts.append(part)
    except OSError:  # Linux says so where a terminal has no more
        pass
    _, status, usage = os.wait4(child, 0)
    signal.setitimer(signal.ITIMER_REAL, 0.0)
    os.close(terminal)
    assert time.monotonic() < until, f"it hangs: {command}"
    grown = usage.ru_maxrss * 1024 - pages * resource.getpagesize()
    text = b"".join(parts).decode("utf-8", "replace").replace("\r\n", "\n")
    used = usage.ru_utime + usage.ru_stime
    return Shown(os.waitstatus_to_exitcode(status), text, used, grown / 1e6)


def _run(command: list[str]) -> None:
    """In the child, whose output goes to the terminal; nobody is there to answer a question."""
    status = 70
    try:
        resource.setrlimit(resource.RLIMIT_CPU, (10, 11))
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        sys.stdin = open(0, closefd=False)  # noqa: SIM115
        sys.stdout = open(1, "w", closefd=False, encoding="utf-8")  # noqa: SIM115
        sys.stderr = open(2, "w", closefd=False, encoding="utf-8")  # noqa: SIM115
        warnings.showwarning = _print_warning  # pytest keeps them
        warnings.resetwarnings()
        warnings.simplefilter("default")
        sys.argv = ["vopd", *command]
        from vopd.__main__ import main

        main()
    except SystemExit as ended:
        status = ended.code if isinstance(ended.code, int) else 0
    except BaseException:
        import traceback

        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)


def _print_warning(*parts: Any, **_: object) -> None:
    sys.stderr.write(warnings.formatwarning(*parts[:4]))


@pytest.fixture(scope="module", autouse=True)
def loaded() -> None:
    for name in LOADED:
        import_module(name)


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory is counted on Linux")
@pytest.mark.parametrize("row", TABLE, ids=lambda row: row.name)
def test_hostile_constants(row: Hostile, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, content in row.files.items():
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        if callable(content):
            content(path)
        else:
            path.write_bytes(content if isinstance(content, bytes) else content.encode())
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    said = []
    for command in row.commands:
        found = shown(shlex.split(command))
        raw = {one for one in found.text if ord(one) < 32 or 127 <= ord(one) < 160 or one in UNSEEN}
        raw -= set("\r\n\t")
        assert len(found.text) < LONGEST, found.text[:LONGEST]
        assert found.status in (0, 1, 2, 3) and not raw
        assert not any(word in found.text for word in ("Traceback", "Warning:", "enough memory"))
        assert found.seconds < row.seconds and found.megabytes < row.megabytes, found
        lines = (line.rpartition("\r")[2] for line in found.text.split("\n"))  # as a screen has it
        words, cut, _ = "\n".join(lines).partition(row.others_after or "\0")
        said.append(f"{ascii(command)[1:-1]}: {found.status}\n{words}{cut}".rstrip())
    assert_approved("\n".join(said))
