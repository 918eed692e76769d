"""The cards of one group as columns of numbers, with a finding for every doubtful field."""

from __future__ import annotations

from collections.abc import Generator
from typing import TypeVar

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.cards.card_block import CardBlock
from vopd.cards.card_values import CardsToRead, CardValues
from vopd.cards.format import CardField, CardGroup
from vopd.cards.formats import FormatItem, format_items
from vopd.findings import DeckError, Finding, Report

T = TypeVar("T")

Reading = Generator[CardsToRead, CardValues, T]
"""A function that yields cards and is sent their values, so that many decks are read at once."""


class GroupTable:
    """The values of a group's cards by the names of the fields."""

    def __init__(self, values: Floats, group: CardGroup) -> None:
        self._values = values
        self._columns = group.columns

    def __getitem__(self, name: str) -> Floats:
        """The values of a field (cards,); of one that repeats on a card, (cards, repeats)."""
        return np.asarray(self._values[:, self._columns[name]])


def read_table(cards: CardBlock, group: CardGroup, report: Report) -> Reading[GroupTable]:
    """Read every field of every card of a group.

    Args:
        cards: the group's cards
        group: which group
        report: is given the findings in the order of the deck

    Returns:
        The group's columns; NaN where a field is not a number.

    Raises:
        DeckError: for what ended the block of cards early.
    """
    values = yield CardsToRead(cards, group)
    for row, k in values.questionable:
        field, item = group.layout[k]
        if field.name:
            report(_finding(cards, values, row, k, field, item))
    if cards.stopped_by is not None:
        raise DeckError(cards.stopped_by)
    return GroupTable(values.value, group)


def read_list(
    cards: CardBlock, group: CardGroup, count: int, report: Report, skip: int = 0
) -> Reading[Ints]:
    """Read the whole numbers of a group that goes on from card to card.

    Args:
        cards: the group's cards
        group: which group
        count: how many numbers the list has
        report: is given the findings in the order of the deck
        skip: how many numbers at the start are left out

    Returns:
        Numbers `skip` to `count` of the list (count - skip,); 0 where one is not a number.

    Raises:
        DeckError: for what ended the block of cards early.
    """
    items = format_items(group.format)
    values = yield CardsToRead(cards, group)
    for row, k in values.questionable:
        index = row * len(items) + k
        if skip <= index < count:
            field = group.fields[min(index, len(group.fields) - 1)]
            report(_finding(cards, values, row, k, field, items[k]))
    if cards.stopped_by is not None:
        raise DeckError(cards.stopped_by)
    return whole(values.value.ravel()[skip:count])


def whole(values: Floats) -> Ints:
    """Values as whole numbers; NaN becomes 0, as it has been reported before.

    Args:
        values: numbers, any shape
    """
    return np.where(np.isnan(values), 0.0, values).astype(np.int64)


def _finding(
    cards: CardBlock, values: CardValues, row: int, k: int, field: CardField, item: FormatItem
) -> Finding:
    """What is wrong with a field that is unreadable, or doubtful about one that can be read."""
    punched = cards.image(row)[item.first - 1 : item.last]
    columns = item.first, item.last
    if values.unreadable[row, k]:
        kind = "a whole number" if item.kind == "I" else "a number"
        message = f"not {kind}: {punched.strip()!r}"
        return cards.finding(row, message, field.meaning, columns)
    if any(map(str.isdigit, punched)):
        message = f"blanks read as zeros: {punched!r} is {values.value[row, k]:.12g}"
    else:
        message = f"a number without digits: {punched.strip()!r} is {values.value[row, k]:.12g}"
    return cards.finding(row, message, field.meaning, columns).warned()
