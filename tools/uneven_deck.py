"""Uneven decks for tools/benchmark.py: 2 to 6 landmarks a frame, some of them ignored.

python tools/uneven_deck.py OUT nothing:DECK frames:DECK ...

Each DECK is one job of `vopd demo --landmarks 6`; the word before it says what is ignored.
Several are stacked as jobs of one deck.
"""

from __future__ import annotations

import random
import sys
from collections.abc import Sequence
from pathlib import Path

LENS_CARDS, FIDUCIAL_CARDS, READINGS = 25, 12, 3
FRAMES_WITH_IGNORED = 300  # that have a card of group 11, every tenth of which drops the frame


def uneven_deck(deck: str, ignored: str, return_group: int) -> str:
    """Remove landmarks from the frames of a deck at random, and ignore some of the others.

    The cards are edited as text, by the FORMATs of the report, and padded to 80 columns.

    Args:
        deck: one job of `vopd demo --landmarks 6`
        ignored: "nothing"; landmarks of some "frames" (group 11); or one landmark of six
            "everywhere" (group 12)
        return_group: 13, or 1 if another job follows
    """
    rng = random.Random(1)
    cards = deck.splitlines()
    group3 = LENS_CARDS + 1
    group5 = group3 + 1 + int(cards[group3][5:10])
    marks, frames, times = (int(cards[group5][k : k + 5]) for k in (0, 5, 10))
    group6 = group5 + len(_sixteen_a_card([0] * (3 + frames)))
    group9 = group6 + times + int(cards[group3][:5]) + 1
    group10 = group9 + marks
    group12 = group10 + 1
    film = group12 + len(_sixteen_a_card([0] * (1 + marks)))
    each = (len(cards) - film) // frames
    counts, readings, asked = [], [], []
    for first in range(film, len(cards), each):
        begin = first + FIDUCIAL_CARDS
        points = [cards[k : k + READINGS] for k in range(begin, first + each, READINGS)]
        kept = sorted(rng.sample(range(len(points)), rng.randint(2, len(points))))
        counts.append(len(kept))
        readings += cards[first:begin] + [card for k in kept for card in points[k]]
        asked.append((int(cards[first][63:67]), [int(points[k][0][8:10]) for k in kept]))
    requests = []
    if ignored == "frames":
        for k, (frame, landmarks) in enumerate(rng.sample(asked, FRAMES_WITH_IGNORED)):
            left_out = [100] if k % 10 == 0 else landmarks[: 1 + k % 2]
            requests.append(f"{frame:5d}" + "".join(f"{one:5d}" for one in left_out))
    everywhere = [0] * marks
    if ignored == "everywhere":
        everywhere[: marks // 6] = range(1, 1 + marks // 6)
    uneven = [
        *cards[:group5],
        *_sixteen_a_card([marks, frames, times, *counts]),
        *cards[group6:group10],
        f"{len(requests):5d}",
        *requests,
        *_sixteen_a_card([return_group, *everywhere]),
        *readings,
    ]
    return "".join(f"{card:80}\n" for card in uneven)


def _sixteen_a_card(numbers: Sequence[int]) -> list[str]:
    return ["".join(f"{one:5d}" for one in numbers[k : k + 16]) for k in range(0, len(numbers), 16)]


def main(out: Path, jobs: Sequence[str]) -> None:
    """Write the uneven decks one after the other, each read anew from group 1."""
    with out.open("w", encoding="ascii") as file:
        for k, job in enumerate(jobs):
            ignored, deck = job.split(":", 1)
            return_group = 13 if k == len(jobs) - 1 else 1
            file.write(uneven_deck(Path(deck).read_text("ascii"), ignored, return_group))


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
