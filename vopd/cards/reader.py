"""A deck to the jobs stacked in it, as the return group says (A 25 to A 118)."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, BinaryIO

from vopd.cards.basic_data import read_basic_data
from vopd.cards.card import CardDeck, Cards
from vopd.cards.control import LIMITS_1974, ControlCards
from vopd.findings import DeckError, Finding, Report, VopdError, raising, strict
from vopd.job import Deck, Job, Readings

if TYPE_CHECKING:  # pathlib takes 3 ms to import
    from pathlib import Path

STOP = 13


def read_deck(path: str | Path, *, limits_1974: bool = False) -> Deck:
    """All jobs of a deck, with the warnings about its cards.

    Args:
        path: a file of 80-column cards; - is standard input
        limits_1974: hold the deck to the original's array sizes

    Raises:
        DeckError: at the first card that cannot be read
        VopdError: where there is no such file

    Source: TM X-3050, Appendix F.
    """
    warnings: list[Finding] = []
    with open_deck(path) as file:
        jobs = tuple(read_jobs(file, str(path), raising(warnings.append), limits_1974=limits_1974))
    return Deck(jobs, str(path), tuple(warnings))


@contextmanager
def open_deck(path: str | Path) -> Iterator[BinaryIO]:
    """Open a deck for reading, `-` for standard input; raises `VopdError` where it cannot."""
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
    trace: Callable[[Cards], object] = lambda _: None,
) -> Iterator[Job]:
    """The jobs of a deck one by one, each as soon as its cards are read.

    What is wrong with a later job is raised only when that job is asked for, so
    that the pages of the jobs before it can be printed first. `trace` is shown
    the cards, run by run as they are taken for a group.
    """
    deck = CardDeck(file, name, report, trace)
    if deck.at_end():
        raise VopdError(f"{name}: the deck is empty")
    control = ControlCards(deck, report, LIMITS_1974 if limits_1974 else {})
    stored: Readings | None = None
    group = 1
    while group != STOP:
        if group <= 2:
            stored = None
        for number in range(group, 13):
            if number == 2 and deck.at_end():
                return
            control.read(number)
            if number == 5 and stored is not None:
                _check_stored(stored, control, report)
        if stored is None:
            counts, defined = control.frame_counts, control.landmarks.number
            stored = read_basic_data(deck, counts, defined, report)
        yield Job(
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
        group = control.return_group
        if not 1 <= group <= STOP:
            raise DeckError(control.bad_return())
    if not deck.at_end():
        message = f"the deck goes on after the job that stops the run (return group {STOP})"
        report(Finding(message, name, deck.taken + 1, severity="warning"))


def _check_stored(stored: Readings, control: ControlCards, report: Report) -> None:
    """Group 5 of a later job may drop frames at the end, and change nothing else."""
    counts = control.frame_counts
    if len(counts) > len(stored.frame):
        message = f"{len(counts)} frames, and only {len(stored.frame)} are stored"
        finding = control.count_finding(1, message)
        report(finding)
        raise DeckError(finding)
    for k in (counts != stored.present[: len(counts)].sum(axis=1)).nonzero()[0]:
        have = int(stored.present[k].sum())
        message = f"{counts[k]} landmarks in frame {stored.frame[k]}, and {have} are stored"
        finding = control.count_finding(3 + int(k), message)
        report(finding)
        raise DeckError(finding)


def _first_frames(stored: Readings, count: int) -> Readings:
    """The frames a job asks for; the readings stay stored for the jobs after it."""
    return replace(
        stored,
        **{
            name: getattr(stored, name)[:count]
            for name in ("frame", "fiducial_in", "landmark", "present", "landmark_in")
        },
    )
