"""Makes the input of a failure small: fewer commands, options and lines, with the same failure."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import TypeVar

from trial import Trial, failures_of, kind

T = TypeVar("T")
TRIES = 150
PATIENCE_S = 60.0


def minimise(trial: Trial, wanted: str) -> Trial:
    """A smaller trial that still has a failure of the kind `wanted`."""
    tries = 0
    until = time.monotonic() + PATIENCE_S

    def fails(files: dict[str, bytes], commands: list[list[str]]) -> bool:
        nonlocal tries
        tries += 1
        found = (
            tries <= TRIES
            and time.monotonic() < until
            and failures_of(Trial(files, commands, trial.jobs))
        )
        return any(kind(failure) == wanted for failure in found or ())

    files = dict(trial.files)
    commands = list(smaller(trial.commands, lambda some: fails(files, list(some))))
    for name, data in trial.files.items():

        def holds(lines: Sequence[bytes], name: str = name) -> bool:
            return fails(files | {name: b"\n".join(lines)}, commands)

        files[name] = b"\n".join(smaller(data.split(b"\n"), holds))
    return Trial(files, commands, trial.jobs)


def smaller(items: Sequence[T], fails: Callable[[Sequence[T]], bool]) -> Sequence[T]:
    """Leave out as many items as can be, in halves, quarters and so on down to single ones."""
    size = len(items) // 2
    while size:
        at = 0
        while at < len(items):
            fewer = [*items[:at], *items[at + size :]]
            if fewer and fails(fewer):
                items = fewer
            else:
                at += size
        size //= 2
    return items
