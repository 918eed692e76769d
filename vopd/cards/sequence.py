"""Sequence numbers in columns 73 to 80, by which a dropped deck was put in order again."""

from __future__ import annotations

import re
from itertools import pairwise
from typing import NamedTuple

from vopd.cards.deck import Bytes, byte_matrix
from vopd.cards.miscount import LENS_CARDS
from vopd.cards.text import COLUMNS
from vopd.findings import VopdError

FIRST = 73
_NUMBER = re.compile(rb"([A-Za-z]*) *(\d+)")
IN_ORDER = 0.8  # of the cards of group 1
FARTHEST = 100  # steps to the next number, where cards are missing or have none


class Sequence(NamedTuple):
    """The sequence numbers of a deck."""

    letters: bytes  # letters before each number, such as an abbreviation of the deck's name
    step: int  # difference of two numbers
    example: str  # the first two, as they are punched


def sequence_of(text: Bytes) -> Sequence | None:
    """Recognise sequence numbers on the cards of group 1, whose FORMAT ends in column 20.

    Args:
        text: the cards (cards, at most 80)
    """
    if text.shape[1] < COLUMNS:
        return None
    punched = [one for row in text if (one := _number(row.tobytes())) is not None]
    found = [one for one in punched if one[0] == punched[0][0]]
    steps = [b[1] - a[1] for a, b in pairwise(found)]
    if len(steps) < IN_ORDER * (len(text) - 1) or not steps or min(steps) <= 0:
        return None
    first, second = (str(row[FIRST - 1 :].tobytes(), "ascii").strip() for row in text[:2])
    return Sequence(found[0][0], min(steps), f"{first}, {second}, ...")


def strip_sequence(text: bytes, name: str) -> tuple[bytes, set[int]]:
    """Blank the sequence numbers of a deck; other contents of columns 73 to 80 stay.

    Returns:
        The deck without trailing blanks, its lines ended as they were, and the cards that had a
        number, counted from 1.

    Raises:
        VopdError: if the cards of group 1 have no sequence numbers.
    """
    lines = text.split(b"\n")
    cards = [line.rstrip(b" \r") for line in lines]
    sequence = sequence_of(byte_matrix([card[:COLUMNS] for card in cards[:LENS_CARDS]]))
    if sequence is None:
        raise VopdError(f"{name}: group 1 has no sequence numbers in columns 73 to 80")
    last: int | None = None
    stripped: set[int] = set()
    for row, card in enumerate(cards):
        letters, number = _number(card) or (b"", -1)
        ahead = 1 if last is None else number - last
        if number >= 0 and letters == sequence.letters and 0 < ahead <= FARTHEST * sequence.step:
            last = number
            stripped.add(row + 1)
            cards[row] = card[: FIRST - 1].rstrip()
    ends = (line[-1:] == b"\r" for line in lines)
    return b"\n".join(one + b"\r" * end for one, end in zip(cards, ends, strict=True)), stripped


def _number(card: bytes) -> tuple[bytes, int] | None:
    """Read columns 73 to 80 as letters and a number that ends in column 80."""
    found = _NUMBER.fullmatch(card[FIRST - 1 : COLUMNS].lstrip())
    return (found[1], int(found[2])) if found and len(card) >= COLUMNS else None
