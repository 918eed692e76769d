"""Read several small decks at once: like fields of all their cards are read in one go.

Each deck is read as it would be by itself, with its own findings and its own error.
"""

from __future__ import annotations

import math
import os
import stat
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack
from typing import BinaryIO, NamedTuple

from vopd.cards.card_values import CardsToRead, CardValues, read_cards
from vopd.cards.reader import job_steps, next_step, open_deck
from vopd.findings import Finding, VopdError, raising
from vopd.job import Job

SMALL_BYTES = 1 << 18  # of a deck that is read with others
TOGETHER_BYTES = 1 << 21
TOGETHER_DECKS = 64  # files that are open at the same time


class DeckFile(NamedTuple):
    """A deck: its name in findings, and its file."""

    name: str
    path: str


class JobRead(NamedTuple):
    """A job of a deck, and the warnings since the one before it."""

    job: Job
    findings: tuple[Finding, ...]


class DeckRead:
    """A deck that has been read as far as it can be, or is being read.

    Args:
        name: the deck's name, for findings
        limits_1974: whether a deck that exceeds the original's array sizes is an error

    Attributes:
        jobs: its jobs in order
        error: what ended it early
        findings: the warnings after the last job
    """

    def __init__(self, name: str, limits_1974: bool) -> None:
        self.jobs: list[JobRead] = []
        self.error: VopdError | None = None
        self.findings: list[Finding] = []
        self._name = name
        self._limits_1974 = limits_1974

    def begun(self, file: BinaryIO) -> CardsToRead | None:
        """Begin to read; gives the first cards whose values are needed.

        Args:
            file: the deck, open for reading bytes
        """
        report = raising(self.findings.append)
        self._steps = job_steps(file, self._name, report, limits_1974=self._limits_1974)
        return self.sent(None)

    def sent(self, values: CardValues | None) -> CardsToRead | None:
        """Read on with the values of some cards; gives the next cards, None at the end.

        Args:
            values: of the cards that were given last
        """
        try:
            step = next_step(self._steps, values)
            while isinstance(step, Job):
                self.jobs.append(JobRead(step, tuple(self.findings)))
                self.findings.clear()
                step = next_step(self._steps)
        except VopdError as error:
            self.error = error
            return None
        return step


def read_together(decks: Sequence[DeckFile], limits_1974: bool = False) -> list[DeckRead]:
    """Read all jobs of some decks.

    Args:
        decks: the decks
        limits_1974: whether a deck that exceeds the original's array sizes is an error
    """
    with ExitStack() as files:
        found = []
        steps: list[tuple[DeckRead, CardsToRead | None]] = []
        for name, path in decks:
            deck = DeckRead(name, limits_1974)
            found.append(deck)
            try:
                file = files.enter_context(open_deck(path))
            except VopdError as error:
                deck.error = error
                continue
            steps.append((deck, deck.begun(file)))
        while steps:
            steps = _next_steps(steps)
    return found


def _next_steps(
    steps: Sequence[tuple[DeckRead, CardsToRead | None]],
) -> list[tuple[DeckRead, CardsToRead | None]]:
    """Read the cards that all decks ask for, those of each group together."""
    by_group: dict[int, list[tuple[DeckRead, CardsToRead]]] = {}
    for deck, asked in steps:
        if asked is not None:
            by_group.setdefault(asked.group.number, []).append((deck, asked))
    after = []
    for some in by_group.values():
        values = read_cards([asked.cards for _, asked in some], some[0][1].group)
        after += [(deck, deck.sent(own)) for (deck, _), own in zip(some, values, strict=True)]
    return after


def groups_of_decks(decks: Iterable[DeckFile]) -> Iterator[list[DeckFile]]:
    """Decks in order, in groups that are worth reading together.

    Args:
        decks: the decks; one that is not a small file, as a pipe, is a group by itself
    """
    some: list[DeckFile] = []
    total = 0.0
    for deck in decks:
        size = _file_size(deck.path)
        full = total + size > TOGETHER_BYTES or len(some) == TOGETHER_DECKS
        if some and (full or size > SMALL_BYTES):
            yield some
            some, total = [], 0.0
        if size > SMALL_BYTES:
            yield [deck]
        else:
            some.append(deck)
            total += size
    if some:
        yield some


def _file_size(path: str) -> float:
    """The bytes of a file; infinite for standard input, a pipe, or where there is no file."""
    if path == "-":
        return math.inf
    try:
        status = os.stat(path)  # noqa: PTH116
    except (OSError, ValueError):
        return math.inf
    return status.st_size if stat.S_ISREG(status.st_mode) else math.inf
