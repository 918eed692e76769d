"""Read the jobs that are stacked in a deck. Source: A 25 to A 118."""

from __future__ import annotations

import sys
from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, BinaryIO

from vopd.cards.basic_data import read_basic_data
from vopd.cards.card_block import CardBlock
from vopd.cards.card_values import CardsToRead, CardValues, read_cards
from vopd.cards.deck import CardDeck
from vopd.cards.file_kind import refuse_other_file
from vopd.cards.read import LIMITS_1974, ControlCards
from vopd.findings import DeckError, Finding, Report, VopdError, raising, strict
from vopd.job import Deck, Job, Readings

if TYPE_CHECKING:  # pathlib takes 3 ms to import
    from pathlib import Path

STOP = 13


def read_deck(path: str | Path, *, limits_1974: bool = False) -> Deck:
    """Read all jobs of a card deck.

    Args:
        path: the deck's file; `-` is standard input
        limits_1974: whether a deck that exceeds the original's array sizes is an error

    Returns:
        The jobs in the order of the deck, with the warnings about its cards.

    Raises:
        DeckError: at the first card that cannot be read; its `finding` says which.
        VopdError: where the file cannot be opened, is empty or is not a deck.

    Source: TM X-3050, Appendix F.
    """
    warnings: list[Finding] = []
    with open_deck(path) as file:
        jobs = tuple(read_jobs(file, str(path), raising(warnings.append), limits_1974=limits_1974))
    return Deck(jobs, str(path), tuple(warnings))


@contextmanager
def open_deck(path: str | Path) -> Iterator[BinaryIO]:
    """Open a deck for reading.

    Args:
        path: the deck's file; `-` is standard input

    Raises:
        VopdError: where the file cannot be opened.
    """
    if str(path) == "-":
        yield sys.stdin.buffer  # not ours to close
        return
    try:
        file = open(path, "rb")  # noqa: PTH123, SIM115 (closed below; only opening may fail so)
    except OSError as error:
        raise VopdError(f"{path}: {error.strerror}") from error
    with file:
        yield file


def read_jobs(
    file: BinaryIO,
    name: str,
    report: Report = strict,
    *,
    limits_1974: bool = False,
    on_cards: Callable[[CardBlock], object] = lambda _: None,
) -> Iterator[Job]:
    """Read the jobs of a deck one by one, each when it is asked for.

    What is wrong with a later job is found only when that job is read, so that
    the pages of the jobs before it can be printed first.

    Args:
        file: the deck, open for reading bytes
        name: the deck's name, for findings
        report: is given every finding; by default errors are raised and warnings are dropped
        limits_1974: whether a deck that exceeds the original's array sizes is an error
        on_cards: is called with every block of cards that is read

    Yields:
        The jobs in the order of the deck.

    Raises:
        DeckError: where a card cannot be read, or reading cannot go on.
        VopdError: where the file is empty or is not a deck.
    """
    steps = job_steps(file, name, report, limits_1974=limits_1974, on_cards=on_cards)
    step = next_step(steps)
    while step is not None:
        values = None
        if isinstance(step, Job):
            yield step
        else:
            (values,) = read_cards([step.cards], step.group)
        step = next_step(steps, values)


JobSteps = Generator[CardsToRead | Job, CardValues | None, None]
"""The reading of a deck: yields cards, and is sent their values, and the jobs as they are read."""


def next_step(steps: JobSteps, values: CardValues | None = None) -> CardsToRead | Job | None:
    """Continue reading a deck up to the next cards whose values it needs, or the next job.

    Args:
        steps: the reading of a deck
        values: of the cards that it has yielded last; None at the beginning and after a job

    Returns:
        Cards to read, or a job; None at the end of the deck.

    Raises:
        VopdError: as `read_jobs` does
    """
    try:
        return steps.send(values)
    except StopIteration:
        return None


def job_steps(
    file: BinaryIO,
    name: str,
    report: Report,
    *,
    limits_1974: bool = False,
    on_cards: Callable[[CardBlock], object] = lambda _: None,
) -> JobSteps:
    """Read the jobs of a deck; the fields of its cards are read by whoever drives this.

    Args:
        file, name, report, limits_1974, on_cards: as `read_jobs` has them

    Yields:
        Cards, whose values must be sent; and jobs in the order of the deck.
    """
    deck = CardDeck(file, name, report, on_cards)
    if deck.at_end():
        raise VopdError(f"{name}: the deck is empty")
    refuse_other_file(deck.next_bytes(), name)
    control = ControlCards(deck, report, LIMITS_1974 if limits_1974 else {})
    stored: Readings | None = None
    group = 1
    while group != STOP:
        if group <= 2:
            stored = None
        for number in range(group, 13):
            if number == 2 and deck.at_end():
                return
            yield from control.read(number)
            if number == 5 and stored is not None:
                _check_stored(stored, control, report)
        if stored is None:
            counts, defined = control.frame_counts, control.landmarks.number
            stored = yield from read_basic_data(deck, counts, defined, report)
        yield _job(control, stored)
        group = control.return_group
        if not 1 <= group <= STOP:
            raise DeckError(control.bad_return())
    if not deck.at_end():
        message = f"the deck goes on after the job that stops the run (return group {STOP})"
        report(Finding(message, name, deck.taken + 1, severity="warning"))


def _job(control: ControlCards, stored: Readings) -> Job:
    """The job that the cards in force describe."""
    return Job(
        title=control.title,
        camera=control.camera,
        trajectory=control.trajectory,
        wind=control.wind,
        clock=control.clock,
        landmarks=control.landmarks,
        ignored=control.ignored,
        readings=_first_frames(stored, len(control.frame_counts)),
        return_group=control.return_group,
    )


def _check_stored(stored: Readings, control: ControlCards, report: Report) -> None:
    """Check group 5 of a later job, which may only leave out frames at the end.

    Raises `DeckError` for more frames than are stored, or other numbers of landmarks.
    """
    counts = control.frame_counts
    if len(counts) > len(stored.frame):
        message = f"{len(counts)} frames, but only {len(stored.frame)} have been read"
        finding = control.count_finding(1, message)
        report(finding)
        raise DeckError(finding)
    for k in (counts != stored.layout.count[: len(counts)]).nonzero()[0]:
        have = int(stored.layout.count[k])
        message = f"{counts[k]} landmarks in frame {stored.frame[k]}, but {have} have been read"
        finding = control.count_finding(3 + int(k), message)
        report(finding)
        raise DeckError(finding)


def _first_frames(stored: Readings, count: int) -> Readings:
    """The frames of this job; the other readings stay stored for the jobs after it."""
    return stored if count == len(stored.frame) else stored.take(slice(count))
