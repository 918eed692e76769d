"""Prepare the standard input, output and error of a process."""

from __future__ import annotations

import codecs
import io
import os
import re
import sys
from typing import Any

CONTROL = r"(?!\r\n|\A\r|\r\Z)[\x00-\x08\x0b-\x1f\x7f-\x9f]"
"""Control characters, but for tabs, ends of lines, and the return of a line of progress."""


def prepare_streams() -> None:
    """Make the standard streams behave the same, whoever started the process.

    A closed descriptor is taken, so that no other file gets its number: reading
    standard input or writing standard output is then an error of that stream.
    Messages that standard error cannot take are lost and stop nothing. No
    character is an error, whatever the encoding. A terminal gets no control
    character of a name or a file, which could move its cursor, hide text or
    change its settings; files and pipes get the bytes as they are.
    """
    for descriptor in (0, 1, 2):
        try:
            os.fstat(descriptor)
        except OSError:  # opened the wrong way round, to fail when it is used
            os.open(os.devnull, os.O_WRONLY if descriptor != 1 else os.O_RDONLY)
    sys.stdin = sys.stdin or open(0, encoding="utf-8", closefd=False)  # noqa: SIM115
    sys.stdout = _standard_output(sys.stdout)
    if sys.stdout.isatty():
        encoding = sys.stdout.encoding
        sys.stdout = _shown_on(sys.stdout.detach(), encoding)
    encoding = "utf-8" if sys.stderr is None else sys.stderr.encoding
    messages = io.BufferedWriter(_Messages(2, "wb", closefd=False))
    if messages.isatty():
        sys.stderr = _shown_on(messages, encoding)
        return
    sys.stderr = io.TextIOWrapper(
        messages, encoding=encoding, errors="backslashreplace", line_buffering=True
    )


def _standard_output(stream: Any) -> io.TextIOWrapper:
    """A stream that writes all it is given; one without a buffer may write a part and say so."""
    encoding = "utf-8" if stream is None else stream.encoding
    if stream is None or not isinstance(stream.buffer, io.BufferedWriter):
        raw = io.FileIO(1, "wb", closefd=False)
        stream = io.TextIOWrapper(io.BufferedWriter(raw), encoding=encoding, line_buffering=True)
    stream.reconfigure(errors="backslashreplace")
    assert isinstance(stream, io.TextIOWrapper)
    return stream


def _shown_on(terminal: Any, encoding: str) -> io.TextIOWrapper:
    """A stream whose text and bytes reach a terminal without control characters."""
    return io.TextIOWrapper(
        io.BufferedWriter(_Terminal(terminal, encoding)),
        encoding=encoding,
        errors="backslashreplace",
        line_buffering=True,
    )


class _Terminal(io.RawIOBase):
    """Writes to a terminal; a control character, or a byte that is no text, as \\x1b."""

    def __init__(self, terminal: Any, encoding: str) -> None:
        self._terminal = terminal
        self._encoding = encoding
        self._text = codecs.getincrementaldecoder(encoding)("backslashreplace")

    def writable(self) -> bool:
        return True

    def isatty(self) -> bool:
        return True

    def fileno(self) -> int:
        return int(self._terminal.fileno())

    def write(self, data: Any, /) -> int:
        text = re.sub(CONTROL, lambda one: f"\\x{ord(one[0]):02x}", self._text.decode(bytes(data)))
        self._terminal.write(text.encode(self._encoding, "backslashreplace"))
        self._terminal.flush()
        return len(data)


class _Messages(io.FileIO):
    """Standard error: what it cannot take is lost."""

    def write(self, data: Any, /) -> int:
        try:
            return super().write(data) or len(data)
        except OSError:
            return len(data)
