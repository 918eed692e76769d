"""Read the fields of cards of one group, of one deck or of many decks at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.cards.card_block import COLUMNS, CardBlock
from vopd.cards.format import CardGroup
from vopd.cards.formats import format_items
from vopd.cards.numbers import FEW, FieldValues, read_few, read_field


class CardsToRead(NamedTuple):
    """Cards of a group whose fields are to be read."""

    cards: CardBlock
    group: CardGroup


class CardValues(NamedTuple):
    """The values of all fields of all cards of a block.

    Attributes:
        value: the numbers (cards, fields); NaN where a field is not a number
        unreadable: whether a field is not a number (cards, fields)
        questionable: card and index of each field that is not a number, or is one that
            may not be the one that was meant
    """

    value: Floats
    unreadable: Bools
    questionable: list[list[int]]


def read_cards(blocks: Sequence[CardBlock], group: CardGroup) -> list[CardValues]:
    """Read every field of every card of some blocks.

    Args:
        blocks: cards of the group, of one deck or several
        group: which group

    Returns:
        The values of each block.
    """
    read = _read(blocks[0] if len(blocks) == 1 else _joined(blocks), group)
    marked = read.unreadable | read.doubtful
    any_marked = marked.any()
    values, first = [], 0
    for cards in blocks:
        rows = slice(first, first + len(cards))
        questionable = np.argwhere(marked[rows]).tolist() if any_marked else []
        values.append(CardValues(read.value[rows], read.unreadable[rows], questionable))
        first = rows.stop
    return values


def _joined(blocks: Sequence[CardBlock]) -> CardBlock:
    """The cards of several blocks, for their fields only: they are not cards of one deck."""
    width = max(cards.text.shape[1] for cards in blocks)
    return CardBlock(
        np.concatenate([cards.columns(1, width) for cards in blocks]), 1, blocks[0].where
    )


def _read(cards: CardBlock, group: CardGroup) -> FieldValues:
    """The values of all fields of all cards (cards, fields); like fields are read in one go."""
    items = format_items(group.format)
    shape = len(cards), len(items)
    if len(cards) * len(items) <= FEW:
        rows = [row.tobytes().ljust(COLUMNS) for row in cards.text]
        fields = [row[item.first - 1 : item.last] for row in rows for item in items]
        value, unreadable, doubtful = read_few(fields, items * len(rows))
        return FieldValues(value.reshape(shape), unreadable.reshape(shape), doubtful.reshape(shape))
    read = FieldValues(np.zeros(shape), np.zeros(shape, bool), np.zeros(shape, bool))
    for which in group.alike:
        text = [cards.columns(items[k].first, items[k].last) for k in which]
        part = read_field(np.concatenate(text), items[which[0]])
        for all_fields, these in zip(read, part, strict=True):
            all_fields[:, list(which)] = these.reshape(len(which), len(cards)).T
    return read
