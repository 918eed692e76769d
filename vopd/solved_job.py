"""What the pipeline gives back: solved jobs one by one, and the ends of decks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from vopd.findings import Finding, VopdError
from vopd.results import Results


@dataclass(frozen=True)
class SolvedJob:
    """A solved job: its deck, its number there from 1, its results, and the warnings."""

    deck: str
    number: int
    results: Results
    findings: tuple[Finding, ...] = ()


class DeckEnd(NamedTuple):
    """The end of a deck: the error that ended it early, if any, and the last warnings."""

    deck: str
    error: VopdError | None = None
    findings: tuple[Finding, ...] = ()
