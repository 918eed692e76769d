"""Progress of long work: a line on standard error where that is a terminal, nothing elsewhere."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import click

PATIENCE_S = 1.0  # work that ends sooner says nothing
EVERY_S = 0.2


class Progress:
    """Counts printed pages on their way to a file, or frames."""

    def __init__(
        self,
        write: Callable[[bytes], object] = lambda _: None,
        clock: Callable[[], float] = time.monotonic,
        unit: str = "pages",
    ):
        self._write = write
        self._clock = clock
        self._unit = unit
        self._next = clock() + PATIENCE_S
        self._count = 0
        self._shown = False

    def __call__(self, text: bytes) -> None:
        """Write some pages, and say how many there are by now."""
        self._write(text)
        self.add(text.count(b"STANDARD DEVIATION"))

    def add(self, count: int) -> None:
        """Say how many there are by now."""
        self._count += count
        if self._clock() >= self._next and sys.stderr.isatty():
            self._next = self._clock() + EVERY_S
            self._shown = True
            click.echo(f"\r{self._count} {self._unit}", nl=False, err=True)

    def close(self) -> None:
        """Wipe the line."""
        if self._shown:
            click.echo("\r" + " " * 20 + "\r", nl=False, err=True)
