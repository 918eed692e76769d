"""Progress is for people at a terminal, and for work that takes longer than a second."""

from __future__ import annotations

import sys

import pytest

from tests.approved.texts import assert_approved
from tests.kit.command import CASE_1, vopd
from vopd.cli.console import Messages, Progress
from vopd.findings import Finding


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
    heard: list[str] = []
    messages = Messages(heard=heard.append)
    for card in range(1, 6):
        messages(Finding("odd", "a.dat", card=card, group=9, severity="warning"))
    messages(Finding("odd", "a.dat", card=7, group=8, severity="warning"))
    messages.error("a.dat: the end")
    assert_approved(capsys.readouterr().err.splitlines(), parts=[*(card for card in (1, 2, 3))])
    assert len(heard) == 7 and messages.warnings == 6


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
