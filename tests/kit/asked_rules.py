"""What a rule of `vopd check` says of a job by itself, without a deck."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from tests.kit.jobs import reread
from vopd.check import CardLocations
from vopd.findings import Finding
from vopd.job import Job

Rule = Callable[[Job, CardLocations, float | None], Iterator[Finding]]
Told = list[tuple[tuple[int, int, str], str]]


class Asked(CardLocations):
    """Keeps which card and field of a group a rule names."""

    def __init__(self) -> None:
        self.named: list[tuple[int, int, str]] = []

    def warning(self, group: int, row: int, field: str, message: str) -> Finding:
        self.named.append((group, row, field))
        return Finding(message).warned()


def told(rule: Rule, job: Job, limit: float | None = None) -> Told:
    """What a rule says of a job: group, index of the card, field; message."""
    asked = Asked()
    messages = [one.message for one in rule(job, asked, limit)]
    return list(zip(asked.named, messages, strict=True))


def changed(part: str, job: Job, **values: Any) -> Job:
    """The job with some arrays of one of its parts replaced."""
    change = reread if part == "readings" else replace
    return replace(job, **{part: change(getattr(job, part), **values)})
