"""Progress of long work: a line on standard error where that is a terminal, nothing elsewhere."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import click

PATIENCE_S = 1.0  # work that ends sooner says nothing
EVERY_S = 0.2


class Progress:
    """Counts printed pages on their way to a file."""

    def __init__(
        self, write: Callable[[bytes], object], clock: Callable[[], float] = time.monotonic
    ):
        self._write = write
        self._clock = clock
        self._next = clock() + PATIENCE_S
        self._pages = 0
        self._shown = False

    def __call__(self, text: bytes) -> None:
        """Write some pages, and say how many there are by now."""
        self._write(text)
        self._pages += text.count(b"STANDARD DEVIATION")
        if self._clock() >= self._next and sys.stderr.isatty():
            self._next = self._clock() + EVERY_S
            self._shown = True
            click.echo(f"\r{self._pages} pages", nl=False, err=True)

    def close(self) -> None:
        """Wipe the line."""
        if self._shown:
            click.echo("\r" + " " * 20 + "\r", nl=False, err=True)
