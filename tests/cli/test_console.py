"""The console: progress, messages about many findings, standard streams, completion by shells."""

from __future__ import annotations

import io
import os
import select
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import click
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.command import CASE_1, ROOT, vopd
from vopd.cli import COMMANDS, cli
from vopd.cli.console import Messages, Progress, _Messages, _standard_output, prepare_streams
from vopd.findings import Finding, VopdError


class Terminal:
    """A standard error that says whether it is a terminal, and keeps what it is told."""

    encoding = "utf-8"

    def __init__(self, is_terminal: bool) -> None:
        self.is_terminal, self.text = is_terminal, ""

    def isatty(self) -> bool:
        return self.is_terminal

    def write(self, text: str) -> int:
        self.text += text
        return len(text)

    def flush(self) -> None:
        pass


def run(monkeypatch: pytest.MonkeyPatch, is_terminal: bool, seconds: list[float]) -> str:
    terminal, times = Terminal(is_terminal), iter(seconds)
    monkeypatch.setattr(sys, "stderr", terminal)
    progress = Progress("frames", clock=lambda: next(times))
    for _ in range(2):
        progress.add(500)
    progress.close()
    return terminal.text


def test_a_long_run_at_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    """Begun at 0, 500 frames at .5 s are not told, 1000 at 1.5 s are, and the line is wiped."""
    told = run(monkeypatch, True, [0.0, 0.5, 1.5, 1.5])
    assert told == "\r1000 frames\r" + " " * 20 + "\r"


def test_the_time_that_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 1000 a tenth is done after 10 s, and nine tenths after 100: 90 and 11 s are left."""
    terminal, times = Terminal(True), iter([0.0, 10.0, 100.0])
    monkeypatch.setattr(sys, "stderr", terminal)
    progress = Progress("frames", clock=lambda: next(times), total=1000)
    progress.add(100)
    progress.add(800)
    last = "900 of 1000 frames, about 0 min 11 s left"
    assert terminal.text == f"\r100 of 1000 frames, about 1 min 30 s left\r{last}"
    terminal.text = ""
    progress.close()
    assert terminal.text == "\r" + " " * len(last) + "\r"


def test_a_line_that_is_shorter_than_the_one_before_is_filled_up(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Ten hours are left, and then three seconds."""
    terminal, times = Terminal(True), iter([0.0, 3600.0, 7200.0])
    monkeypatch.setattr(sys, "stderr", terminal)
    progress = Progress("frames", clock=lambda: next(times), total=11_000)
    progress.add(1000)
    progress.add(9995)
    long, short = (
        "1000 of 11000 frames, about 600 min 00 s left",
        "10995 of 11000 frames, about 0 min 03 s left",
    )
    assert terminal.text == f"\r{long}\r{short.ljust(len(long))}" and len(short) < len(long)


def test_the_line_is_drawn_anew_five_times_a_second(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal, times = Terminal(True), iter([0.0, 0.99, 1.0, 1.1, 1.19, 1.21, 1.3, 1.42])
    monkeypatch.setattr(sys, "stderr", terminal)
    progress = Progress("frames", clock=lambda: next(times))
    for _ in range(7):
        progress.add(1)
    assert terminal.text == "\r2 frames\r5 frames\r7 frames"


def test_silence(monkeypatch: pytest.MonkeyPatch) -> None:
    assert run(monkeypatch, True, [0.0, 0.5, 0.9]) == ""
    assert run(monkeypatch, False, [0.0, 1.5, 2.5]) == ""


def test_warnings_of_one_kind_are_counted(capsys: pytest.CaptureFixture[str]) -> None:
    """Five of one kind: three are shown and two are counted; another kind has its own count."""
    on_message: list[str] = []
    messages = Messages(on_message=on_message.append)
    for card in range(1, 6):
        messages(Finding("odd", "a.dat", card=card, group=9, severity="warning"))
    messages(Finding("odd", "a.dat", card=7, group=8, severity="warning"))
    messages.error("a.dat: the end")
    assert_approved(capsys.readouterr().err.splitlines(), parts=[*(card for card in (1, 2, 3))])
    assert len(on_message) == 7 and messages.warnings == 6


@pytest.mark.parametrize("command", ["run", "attitude"])
def test_the_line_is_wiped_before_anything_else_is_said(
    command: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And at the end of every deck."""
    events: list[str] = []

    class Noted(Progress):
        def add(self, count: int) -> None:
            events.append(f"{count} more")

        def close(self) -> None:
            events.append("wiped")

    for module in ("run", "histories"):
        monkeypatch.setattr(f"vopd.cli.{module}.Progress", Noted)
    vopd(command, CASE_1, "none.dat", CASE_1)
    events = [event for event in events if event != "0 more"]  # a page without a frame
    assert events == ["1 more", "wiped", "wiped", "1 more", "wiped"]


# Messages about many findings, and the line of progress

ODD = Finding("odd", "a.dat", 7, 2, 9, "longitude", (11, 20), "  card", severity="warning")
Said = pytest.CaptureFixture[str]


def told(count: int, capsys: Said, **options: bool) -> list[str]:
    """What is printed of so many findings of one kind, without rulers, and at the end."""
    messages = Messages(**options)
    for card in range(1, count + 1):
        messages(replace(ODD, card=card, image=None))
    messages.close()
    messages.close()
    assert messages.warnings == count
    return capsys.readouterr().err.splitlines()


@pytest.mark.parametrize("count", [0, 1, 2, 3, 4, 5, 23])
def test_three_of_a_kind_are_shown_and_the_others_counted_once(count: int, capsys: Said) -> None:
    """The count is of their deck, job, group and field, and of no card or column."""
    assert_approved(told(count, capsys), parts=[*(card for card in range(1, min(count, 3) + 1))])
    assert told(count, capsys, quiet=True) == []


def test_after_the_end_of_a_deck_three_are_shown_again(capsys: Said) -> None:
    messages = Messages()
    for _ in range(2):
        for _ in range(4):
            messages(Finding("odd", "a", severity="warning"))
        messages.close()
    assert_approved(capsys.readouterr().err.splitlines())


@pytest.mark.parametrize("quiet", [False, True])
def test_everything_is_heard_also_what_is_not_printed(quiet: bool, capsys: Said) -> None:
    """With its place and ruler; an error is printed after the counts of what was not shown."""
    on_message: list[str] = []
    messages = Messages(quiet, on_message.append)
    for _ in range(4):
        messages(ODD)
    messages.error("a.dat: wrong")
    assert on_message == [str(ODD)] * 4 + ["a.dat: wrong"]
    lines = capsys.readouterr().err.splitlines()
    assert lines[-1] == "a.dat: wrong"
    assert len(lines) == (1 if quiet else 3 * 5 + 2)
    with refused(VopdError):
        messages(replace(ODD, severity="error"))
    assert len(on_message) == 5 and messages.warnings == 4


@pytest.mark.parametrize(
    ("done", "seconds", "total", "text"),
    [
        (50, 10.0, None, "50 frames"),
        (50, 10.0, 100, "50 of 100 frames, about 0 min 10 s left"),
        (1, 2.0, 31, "1 of 31 frames, about 1 min 00 s left"),
        (1, 2.0, 62, "1 of 62 frames, about 2 min 02 s left"),
        (3, 1.0, 4, "3 of 4 frames, about 0 min 00 s left"),
        (100, 9.0, 100, "100 of 100 frames, about 0 min 00 s left"),
        (0, 5.0, 3, "0 of 3 frames, about 0 min 15 s left"),
    ],
)
def test_the_time_that_is_left_many(
    done: int, seconds: float, total: int | None, text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As much for each frame as those that are done took."""
    stream = io.StringIO()
    monkeypatch.setattr(stream, "isatty", lambda: True)
    monkeypatch.setattr(sys, "stderr", stream)
    times = iter([100.0, 100.0 + seconds])
    progress = Progress("frames", lambda: next(times), total)
    progress.add(done)
    assert stream.getvalue() == f"\r{text}"
    progress.close()
    progress.close()
    assert stream.getvalue() == f"\r{text}\r{' ' * max(len(text), 20)}\r"


def test_after_a_long_wait_the_line_is_drawn_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """And then .2 s later, as always."""
    stream = io.StringIO()
    monkeypatch.setattr(stream, "isatty", lambda: True)
    monkeypatch.setattr(sys, "stderr", stream)
    times = iter([0.0, 9.0, 9.1, 9.19, 9.2, 9.3])
    progress = Progress("frames", lambda: next(times))
    for _ in range(5):
        progress.add(1)
    assert stream.getvalue() == "\r1 frame\r4 frames"


# Streams of a process


@pytest.mark.parametrize("stream", [None, SimpleNamespace(buffer=io.BytesIO(), encoding="ascii")])
def test_a_standard_output_without_a_buffer_is_given_one(stream: Any) -> None:
    """Lines are written when they end; a character that the encoding lacks is escaped."""
    made = _standard_output(stream)
    try:
        assert made.line_buffering and isinstance(made.buffer, io.BufferedWriter)
        assert made.encoding == ("utf-8" if stream is None else "ascii")
        assert made.errors == "backslashreplace"
    finally:
        made.detach().detach()  # type: ignore[attr-defined]


def test_a_standard_output_with_a_buffer_stays() -> None:
    stream = io.TextIOWrapper(io.BufferedWriter(io.BytesIO()), encoding="ascii")  # type: ignore[arg-type]
    made = _standard_output(stream)
    assert made is stream and made.errors == "backslashreplace"
    made.write("ü")
    made.flush()
    assert stream.buffer.raw.getvalue() == b"\\xfc"  # type: ignore[attr-defined]


def test_messages_that_standard_error_cannot_take_are_lost() -> None:
    """As if they had been written: a pipe that is full, one that nobody reads, a closed one."""
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    messages = _Messages(writer, "wb", closefd=False)
    assert messages.write(b"four") == 4 and os.read(reader, 9) == b"four"
    while messages.write(b"x" * 65536) == 65536 and len(select.select([], [writer], [], 0)[1]):
        pass
    assert messages.write(b"more") == 4
    os.close(reader)
    assert messages.write(b"nobody") == 6
    os.close(writer)
    assert messages.write(b"closed") == 6


@pytest.mark.parametrize("encoding", ["ascii", "utf-8", "latin-1"])
def test_standard_error_takes_every_character(
    encoding: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the encoding that it has, each line at once."""
    output = io.TextIOWrapper(io.BufferedWriter(io.BytesIO()))  # type: ignore[arg-type]
    monkeypatch.setattr(sys, "stdout", output)
    monkeypatch.setattr(sys, "stderr", SimpleNamespace(encoding=encoding))
    prepare_streams()
    made: Any = sys.stderr
    assert (made.encoding, made.errors, made.line_buffering) == (encoding, "backslashreplace", True)
    assert sys.stdout.errors == "backslashreplace"


def test_the_command_line_leaves_exceptions_to_its_own_boundary(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It is called vopd, whatever the script is, and ends with the status of the command."""
    given: list[Any] = []
    monkeypatch.setattr(click.Group, "main", lambda _, *one, **named: given.append(named) or 5)
    with pytest.raises(SystemExit) as ended:
        cli.main(["run"])
    assert ended.value.code == 5
    assert given == [{"prog_name": "vopd", "standalone_mode": False}]


# Completion by shells


def offered(monkeypatch: pytest.MonkeyPatch, line: str) -> list[str]:
    """What a shell is offered for the last word of a line, as kind and text."""
    words = line.split(" ")
    monkeypatch.setenv("_VOPD_COMPLETE", "bash_complete")
    monkeypatch.setenv("COMP_WORDS", line)
    monkeypatch.setenv("COMP_CWORD", str(len(words) - 1))
    ran = vopd()
    assert (ran.status, ran.stderr) == (0, "")
    return ran.stdout.split()


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("vopd r", ["plain,run", "plain,report"]),
        ("vopd ", [f"plain,{command}" for command in COMMANDS]),
        ("vopd --v", ["plain,--version"]),
        ("vopd errata --format ", ["plain,text", "plain,json"]),
        ("vopd errata --form", ["plain,--format"]),
        ("vopd stars so", ["plain,solve"]),
        ("vopd diff deck", ["file,deck"]),
        ("vopd diff -o out", ["file,out"]),
        ("vopd run --fix earth deck", ["file,deck"]),
        ("vopd report deck.dat -o ", ["file,"]),
        ("vopd stars solve --focal 76 st", ["file,st"]),
        ("vopd rum deck", []),
        ("vopd diff --tolerances --und", ["plain,--undetermined"]),
    ],
)
def test_what_is_offered(monkeypatch: pytest.MonkeyPatch, line: str, expected: list[str]) -> None:
    assert offered(monkeypatch, line) == expected


def test_a_shell_that_shows_what_a_command_does_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = {"_VOPD_COMPLETE": "zsh_complete", "COMP_WORDS": "vopd ", "COMP_CWORD": "1"}
    for name, value in asked.items():
        monkeypatch.setenv(name, value)
    lines = vopd().stdout.splitlines()
    assert {*zip(lines[1::3], lines[2::3], strict=True)} >= {*COMMANDS.items()}


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_shell_accepts_its_script(shell: str, tmp_path: Path) -> None:
    environment = os.environ | {"_VOPD_COMPLETE": f"{shell}_source", "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "vopd"]
    made = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert (made.returncode, made.stderr) == (0, "")
    assert "_VOPD_COMPLETE" in made.stdout
    if shutil.which(shell):
        script = tmp_path / "script"
        script.write_text(made.stdout, encoding="utf-8")
        subprocess.run([shell, "-n", script], check=True)


# Pages of the documentation


def test_a_page_of_the_documentation_is_shown_as_it_stands(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """By its name, by its file, or by a command; its name is completed by the Tab key."""
    for name, page in (
        ("adjust", "adjust"),
        ("docs/adjust.md", "adjust"),
        ("punch", "flight-project"),
    ):
        own = (ROOT / "docs" / f"{page}.md").read_text(encoding="utf-8")
        ran = vopd("help", name)
        assert (ran.status, ran.stdout) == (0, own + "\n"), name
    shown: list[str] = []
    monkeypatch.setattr(click, "echo_via_pager", shown.append)
    assert vopd("help", "adjust", terminal=True).stdout == ""
    assert shown == [(ROOT / "docs" / "adjust.md").read_text(encoding="utf-8")]
    ran = vopd("help", "xyz")
    assert ran.status == 2
    assert_approved(ran.stderr.splitlines()[-1])
    assert offered(monkeypatch, "vopd help cho") == ["plain,choosing"]
