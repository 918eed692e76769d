"""The control cards of a deck whose film is yet to be read."""

from __future__ import annotations

import io
from typing import NamedTuple

import numpy as np

from vopd.cards.deck import CardDeck, refuse_other_file
from vopd.cards.format import BASIC_DATA, GROUPS, format_items
from vopd.cards.miscount import looks_like_basic_data
from vopd.cards.numbers import read_few
from vopd.cards.read import ControlCards
from vopd.cards.text import CardText
from vopd.findings import VopdError, strict


class DeckHead(NamedTuple):
    """A deck around its group 5 and its basic data, which the page of picks writes."""

    name: str
    before: list[str]  # the cards of groups 1 to 4
    after: list[str]  # of groups 6 to 12
    behind: list[str]  # of further jobs
    counts: list[int]  # NT and NTFR
    landmarks: list[str]  # the numbers of group 9 that a film reader's card has columns for


def read_head(file: bytes, name: str) -> DeckHead:
    """Read groups 1 to 12 of a deck's first job, whose film may have been read or not.

    Where group 5 counts no frame yet, it has no further cards.

    Raises:
        VopdError: where a card cannot be read
    """
    refuse_other_file(file, name)
    lines = CardText(io.BytesIO(file)).all(name).decode("latin-1").splitlines()
    while lines and not lines[-1].strip():
        del lines[-1]
    control, deck = _control(lines, name)
    for number in range(1, 5):
        control.read(number)
    first = deck.taken
    if first >= len(lines):
        raise VopdError(f"{name}: the deck ends before group 5")
    items = format_items(GROUPS[5].format)[:3]
    card = lines[first].ljust(80)
    counts = read_few([card[one.first - 1 : one.last].encode() for one in items], items).value
    if not counts[1] > 0:  # to be read all the same: one frame
        lines[first] = f"{card[:5]}    1{card[10:15]}    1"
    control, deck = _control(lines, name)
    ends = list[int]()
    for number in range(1, 13):
        control.read(number)
        ends.append(deck.taken)
    behind = lines[ends[11] :]
    if looks_like_basic_data(deck.next_card(BASIC_DATA.number).text).any():  # the film was read
        behind = behind[int((12 + 3 * control.frame_counts).sum()) :]
    return DeckHead(
        name,
        lines[:first],
        lines[ends[4] : ends[11]],
        behind,
        [int(np.nan_to_num(counts[k])) for k in (0, 2)],
        [str(one) for one in dict.fromkeys(control.landmarks.number.tolist()) if 0 < one < 100],
    )


def _control(lines: list[str], name: str) -> tuple[ControlCards, CardDeck]:
    deck = CardDeck(io.BytesIO("\n".join([*lines, ""]).encode("latin-1")), name, strict)
    return ControlCards(deck, strict, {}), deck
