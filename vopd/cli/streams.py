"""Prepare the standard input, output and error of a process."""

from __future__ import annotations

import io
import os
import sys
from typing import Any


def prepare_streams() -> None:
    """Make the standard streams behave the same, whoever started the process.

    A closed descriptor is taken, so that no other file gets its number: reading
    standard input or writing standard output is then an error of that stream.
    Messages that standard error cannot take are lost and stop nothing. No
    character is an error, whatever the encoding.
    """
    for descriptor in (0, 1, 2):
        try:
            os.fstat(descriptor)
        except OSError:  # opened the wrong way round, to fail when it is used
            os.open(os.devnull, os.O_WRONLY if descriptor != 1 else os.O_RDONLY)
    sys.stdin = sys.stdin or open(0, encoding="utf-8", closefd=False)  # noqa: SIM115
    sys.stdout = _standard_output(sys.stdout)
    encoding = "utf-8" if sys.stderr is None else sys.stderr.encoding
    messages = io.BufferedWriter(_Messages(2, "wb", closefd=False))
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


class _Messages(io.FileIO):
    """Standard error: what it cannot take is lost."""

    def write(self, data: Any, /) -> int:
        try:
            return super().write(data) or len(data)
        except OSError:
            return len(data)
