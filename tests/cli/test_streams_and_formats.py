"""The streams of a process."""

from __future__ import annotations

import io
import os
import select
import sys
from types import SimpleNamespace
from typing import Any

import click
import pytest

from vopd.cli import cli
from vopd.cli.console import _Messages, _standard_output, prepare_streams


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
