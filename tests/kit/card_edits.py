"""Card decks as lists of lines, and edits that punch something into one card."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

import vopd
from tests.kit.command import CASE_1
from tests.kit.readings import reread
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
