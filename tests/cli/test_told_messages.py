"""Messages about many findings, and the line of progress: every field, and both sides of limits."""

from __future__ import annotations

import io
import sys
from dataclasses import replace

import pytest

from tests.approved.texts import assert_approved, refused
from vopd.cli.console import Messages, Progress
from vopd.findings import Finding, VopdError

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
    heard: list[str] = []
    messages = Messages(quiet, heard.append)
    for _ in range(4):
        messages(ODD)
    messages.error("a.dat: wrong")
    assert heard == [str(ODD)] * 4 + ["a.dat: wrong"]
    lines = capsys.readouterr().err.splitlines()
    assert lines[-1] == "a.dat: wrong"
    assert len(lines) == (1 if quiet else 3 * 5 + 2)
    with refused(VopdError):
        messages(replace(ODD, severity="error"))
    assert len(heard) == 5 and messages.warnings == 4


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
def test_the_time_that_is_left(
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
    assert stream.getvalue() == "\r1 frames\r4 frames"
