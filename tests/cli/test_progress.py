"""Progress is for people at a terminal, and for work that takes longer than a second."""

from __future__ import annotations

import sys

import pytest
from vopd.cli.progress import Progress

PAGE = b"0        STANDARD DEVIATION OF RESIDUALS       .11718\n"


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
    terminal, times, written = Terminal(is_terminal), iter(seconds), []
    monkeypatch.setattr(sys, "stderr", terminal)
    progress = Progress(written.append, clock=lambda: next(times))
    for _ in range(2):
        progress(PAGE * 500)
    progress.close()
    assert written == [PAGE * 500] * 2
    return terminal.text


def test_a_long_run_at_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    """Begun at 0, 500 pages at .5 s are not told, 1000 at 1.5 s are, and the line is wiped."""
    told = run(monkeypatch, True, [0.0, 0.5, 1.5, 1.5])
    assert told == "\r1000 pages\r" + " " * 20 + "\r"


def test_silence(monkeypatch: pytest.MonkeyPatch) -> None:
    assert run(monkeypatch, True, [0.0, 0.5, 0.9]) == ""
    assert run(monkeypatch, False, [0.0, 1.5, 2.5]) == ""
