"""Cards with changes in them, and decks cut by columns."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

import vopd
from tests.kit.command import CASE_1
from tests.kit.jobs import reread
from vopd.cards.read import read_jobs
from vopd.findings import Finding, InputError
from vopd.job import Job

CardLines = list[str]
CardEdit = Callable[[CardLines], None]


def two_frames() -> CardLines:
    """Case 1 as two frames, 730 and 731, without anything that a check questions.

    The readings of landmark 66 are drawn together, and altitudes agree with positions.
    Cards: 1-25 group 1, 26 title, 27 group 3, 28-30 group 4, 31 group 5, 32-33 group 6,
    34-37 group 7, 38 group 8, 39-41 group 9, 42 group 10, 43 group 12, 44-64 frame 730,
    65-85 frame 731.
    """
    (job,) = vopd.read_deck(CASE_1)
    readings = job.readings
    calm = readings.landmark_in.copy()
    calm[0, 1] = [11.137, 2.979]
    two: Job = replace(
        job,
        readings=reread(
            readings,
            frame=np.array([730, 731]),
            fiducial_in=np.repeat(readings.fiducial_in, 2, axis=0),
            landmark=np.repeat(readings.landmark, 2, axis=0),
            present=np.repeat(readings.present, 2, axis=0),
            landmark_in=np.repeat(calm, 2, axis=0),
        ),
        trajectory=replace(job.trajectory, altitude_ft=_round_earth_altitude_ft(job)),
    )
    return vopd.write_deck([two]).splitlines()


def _round_earth_altitude_ft(job: Job) -> np.ndarray:
    """Z and the round Earth's drop: 20 ft at 30000 ft, so the report's own H but for row 65."""
    x, y, z = job.trajectory.position_ft.T
    return np.round(z + (x**2 + y**2) / (2 * 20925698.0), 1)


def landmarks_again(cards: CardLines) -> CardLines:
    """The deck as two jobs: the second, from return group 5, gives the first two landmarks again.

    Group 5 says so, and the third landmark stays as the first job has it.
    """
    first = [*cards[:42], "    5" + cards[42][5:], *cards[43:]]
    counts = "    2" + cards[30][5:]
    return [*first, counts, *cards[31:40], *cards[41:42], "   13    0    0"]


def punch(card: int, first: int, text: str) -> CardEdit:
    """Punch `text` into a card, from column `first`, both counted from 1."""

    def edit(cards: CardLines) -> None:
        line = cards[card - 1].ljust(80)
        cards[card - 1] = line[: first - 1] + text + line[first - 1 + len(text) :]

    return edit


def punch_all(cards_of: range, first: int, text: str) -> CardEdit:
    """Punch the same text into several cards."""

    def edit(cards: CardLines) -> None:
        for card in cards_of:
            punch(card, first, text)(cards)

    return edit


# The reader's sentences


def said(cards: CardLines, encoding: str = "ascii") -> list[Finding]:
    """Everything that is reported, and the error that ends the deck, each once."""
    found: list[Finding] = []
    try:
        list(read_jobs(io.BytesIO("\n".join(cards).encode(encoding)), "a.dat", found.append))
    except InputError as error:
        found.append(error.finding)
    return list(dict.fromkeys(found))


def edited(*edits: tuple[int, int, str]) -> CardLines:
    """The clean deck of frames 730 and 731 with texts punched into cards at columns."""
    cards = two_frames()
    for edit in edits:
        punch(*edit)(cards)
    return cards


# A deck cut by columns


LENS_CARDS = 25


class Text(NamedTuple):
    """Some groups of a deck of one job, number by number as punched, and its basic data."""

    cards: int
    wind: list[list[float]]
    clock: list[list[float]]
    trajectory: list[list[float]]
    origin: list[float]  # group 8
    landmarks: dict[int, list[float]]
    basic_data: list[str]


def numbers(card: str, *widths: int) -> list[float]:
    """The fields of a card, all with their points punched or whole."""
    card, found = card.ljust(80), []
    for width in widths:
        found.append(float(card[:width]))
        card = card[width:]
    return found


def cut(deck: str) -> Text:
    """Appendix F, group after group; group 11 has no cards in these decks."""
    cards = deck.split("\n")
    assert cards.pop() == ""
    count = len(cards)
    left = iter(cards)
    for _ in range(LENS_CARDS):
        numbers(next(left), 10, 10)
    next(left)  # title
    rows, winds = map(int, numbers(next(left), 5, 5))
    wind = [numbers(next(left), 10, 10, 10) for _ in range(winds)]
    first = next(left)
    marks, frames, times = map(int, numbers(first, 5, 5, 5))
    for _ in range((frames + 3 - 1) // 16):
        next(left)
    clock = [numbers(next(left), 5, 10) for _ in range(times)]
    trajectory = [numbers(next(left), *[10] * 8) for _ in range(rows)]
    origin = numbers(next(left), *[10] * 7)
    landmarks = {}
    for _ in range(marks):
        number, *where = numbers(next(left), *[10] * 6)
        landmarks[int(number)] = where
    assert numbers(next(left), 5) == [0]
    for _ in range(marks // 16 + 1):
        next(left)
    return Text(count, wind, clock, trajectory, origin, landmarks, list(left))
