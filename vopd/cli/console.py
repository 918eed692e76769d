"""Messages on standard error: warnings, errors, and the progress of long work."""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Callable, Hashable

import click

from vopd.finding_kinds import kind_of
from vopd.findings import Finding, strict

ALIKE = 3  # this many warnings of one kind are shown
PATIENCE_S = 1.0  # work that ends sooner shows no progress
EVERY_S = 0.2


class Messages:
    """Print the first warnings of each kind and count the others; raise findings that are errors.

    Args:
        quiet: print no warnings
        heard: is given the text of every warning and error, also of those not printed
    """

    def __init__(
        self, quiet: bool = False, heard: Callable[[str], object] = lambda _: None
    ) -> None:
        self._quiet = quiet
        self._heard = heard
        self._seen: Counter[Hashable] = Counter()
        self._example: dict[Hashable, Finding] = {}
        self.warnings = 0

    def __call__(self, finding: Finding) -> None:
        strict(finding)
        self._heard(str(finding))
        self.warnings += 1
        kind = kind_of(finding)
        self._seen[kind] += 1
        self._example[kind] = finding
        if not self._quiet and self._seen[kind] <= ALIKE:
            click.echo(f"warning: {finding}", err=True)

    def error(self, message: str) -> None:
        """Print an error, after the number of warnings that were not shown."""
        self.close()
        self._heard(message)
        click.echo(message, err=True)

    def close(self) -> None:
        """Print how many warnings were not shown."""
        for kind, count in self._seen.items():
            if count > ALIKE and not self._quiet:
                like = self._example[kind]
                more = f"{count - ALIKE} more warnings like these"
                alike = Finding(more, like.deck, job=like.job, group=like.group, field=like.field)
                click.echo(f"warning: {alike}", err=True)
        self._seen.clear()


class Progress:
    """A line on standard error that counts finished work; shown only on a terminal."""

    def __init__(self, unit: str, clock: Callable[[], float] = time.monotonic) -> None:
        self._unit = unit
        self._clock = clock
        self._next = clock() + PATIENCE_S
        self._count = 0
        self._shown = False

    def add(self, count: int) -> None:
        """Add to the count and show it."""
        self._count += count
        if self._clock() >= self._next and sys.stderr.isatty():
            self._next = self._clock() + EVERY_S
            self._shown = True
            click.echo(f"\r{self._count} {self._unit}", nl=False, err=True)

    def close(self) -> None:
        """Clear the line."""
        if self._shown:
            click.echo("\r" + " " * 20 + "\r", nl=False, err=True)
            self._shown = False
