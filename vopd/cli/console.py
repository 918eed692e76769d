"""Remarks on standard error: errors end the deck, warnings are printed, many alike are counted."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

import click

from vopd.findings import DeckError, Finding

ALIKE = 3  # so many warnings of one kind are shown


class Remarks:
    """A `Report` that prints warnings and raises errors."""

    def __init__(
        self, quiet: bool = False, heard: Callable[[str], object] = lambda _: None
    ) -> None:
        self._quiet = quiet
        self._heard = heard
        self._seen: Counter[tuple[str, int | None, int | None, str]] = Counter()

    def __call__(self, finding: Finding) -> None:
        if finding.severity == "error":
            raise DeckError(finding)
        self._heard(str(finding))
        kind = finding.deck, finding.job, finding.group, finding.field
        self._seen[kind] += 1
        if not self._quiet and self._seen[kind] <= ALIKE:
            click.echo(f"warning: {finding}", err=True)

    def close(self) -> None:
        """Say how many warnings were not shown."""
        for (deck, job, group, field), count in self._seen.items():
            if count > ALIKE and not self._quiet:
                more = f"{count - ALIKE} more warnings like these"
                alike = Finding(more, deck, job=job, group=group, field=field)
                click.echo(f"warning: {alike}", err=True)
        self._seen.clear()
