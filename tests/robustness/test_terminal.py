"""Control characters of names and files on a terminal, and in files and pipes."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.kit.command import CASE_1, ROOT
from tests.kit.flight_project import write_project

PROJECT = Path(__file__).parent / "inputs" / "flight_of_control_characters"
RAW, SHOWN = "chu\x1b[31mrch\x9b", r"chu\x1b[31mrch\x9b"
SAID = "is picked 2 times"


def on_terminal(*arguments: str, folder: Path = PROJECT, typed: str = "") -> str:
    """What both streams show on a terminal, which has its own line ends, and what is typed."""
    pty = pytest.importorskip("pty", reason="no pseudo-terminals here")
    ours, theirs = pty.openpty()
    command = [sys.executable, "-m", "vopd", *arguments]
    environment = os.environ | {"PYTHONPATH": str(ROOT), "LANG": "C.UTF-8"}
    with subprocess.Popen(
        command, stdin=theirs, stdout=theirs, stderr=theirs, cwd=folder, env=environment
    ):
        os.close(theirs)
        os.write(ours, typed.encode())
        shown = b""
        try:
            while chunk := os.read(ours, 10_000):
                shown += chunk
        except OSError:  # Linux says so where a terminal has no more
            pass
        os.close(ours)
    return shown.decode()


def controls(text: str) -> set[str]:
    return {one for one in text if ord(one) < 32 or 127 <= ord(one) < 160}


def test_a_terminal_gets_no_control_characters() -> None:
    """On standard error (attitude), on standard output (check), of a name of a file, of usage."""
    for arguments in (("attitude", "flight.toml"), ("check", "flight.toml")):
        shown = on_terminal(*arguments)
        assert SHOWN in shown and SAID in shown and controls(shown) <= {"\r", "\n"}
    for arguments in (("check", "no\x1b]0;title\x07"), ("run", "no\x9b"), ("check", "--no\x1b")):
        shown = on_terminal(*arguments)
        assert "\\x" in shown and controls(shown) <= {"\r", "\n"}


MARKS = (*range(0x202A, 0x202F), *range(0x2066, 0x206A), 0x200E, 0x200F, 0x061C)


def test_a_terminal_gets_no_marks_that_turn_the_direction_of_reading(tmp_path: Path) -> None:
    """Those of Unicode's bidirectional algorithm, each as its number."""
    shown = on_terminal("check", "a" + "".join(map(chr, MARKS)), folder=tmp_path)
    assert "a" + "".join(f"\\u{mark:04x}" for mark in MARKS) in shown
    assert shown.isascii()


def test_a_return_cannot_hide_what_a_line_says(tmp_path: Path) -> None:
    assert r"a\rb: No such" in on_terminal("check", "a\rb", folder=tmp_path)


def test_a_terminal_shows_what_a_pipe_gets() -> None:
    """The page of a deck: same text, and what is no text is shown as its bytes."""
    command = [sys.executable, "-m", "vopd", "run", "-q", str(CASE_1)]
    piped = subprocess.run(command, capture_output=True, cwd=ROOT, check=True).stdout
    assert on_terminal("run", "-q", str(CASE_1)).replace("\r\n", "\n").encode() == piped


def test_pipes_and_files_get_the_bytes_as_they_are(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "vopd", "check", "flight.toml"]
    environment = os.environ | {"PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8"}
    piped = subprocess.run(command, capture_output=True, cwd=PROJECT, env=environment, check=True)
    assert RAW.encode() in piped.stdout
    to_file = [*command, "-o", str(tmp_path / "found")]
    subprocess.run(to_file, cwd=PROJECT, env=environment, check=True)
    assert (tmp_path / "found").read_bytes() == piped.stdout


def test_what_was_answered_stays_where_answers_end(tmp_path: Path) -> None:
    """Ctrl-D at the third question: the project has the first two answers."""
    write_project(tmp_path)
    files = ("--picks", "picks.csv", "--landmarks", "landmarks.csv", "--track", "track.csv")
    on_terminal("new", "made", *files, folder=tmp_path, typed="1920,1080\ncentre\n\x04")
    made = (tmp_path / "made" / "flight.toml").read_text()
    assert "\nimage_size_px = [1920,1080]" in made and '\npixel_grid = "centre"' in made
    assert "\nheight" not in made
