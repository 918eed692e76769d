"""The cards of one group as columns of numbers, with a finding for every doubtful field."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.cards.card_block import COLUMNS, CardBlock
from vopd.cards.formats import FormatItem, format_items
from vopd.cards.groups import CardField, CardGroup
from vopd.cards.number_fields import FEW, FieldValues, read_few, read_field
from vopd.findings import DeckError, Finding, Report

GroupTable = dict[str, Floats]
"""Field name to its values (cards,); of a field that repeats on a card, (cards, repeats)."""


def read_table(cards: CardBlock, group: CardGroup, report: Report) -> GroupTable:
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
    layout = group.layout
    values = _read(cards, group)
    for row, k in _questionable(values):
        field, item = layout[k]
        if field.name:
            report(_finding(cards, values, row, k, field, item))
    if cards.stopped_by is not None:
        raise DeckError(cards.stopped_by)
    columns: dict[str, list[Floats]] = {}
    for k, (field, _) in enumerate(layout):
        columns.setdefault(field.name, []).append(values.value[:, k])
    return {
        name: parts[0] if len(parts) == 1 else np.stack(parts, axis=1)
        for name, parts in columns.items()
    }


def read_list(
    cards: CardBlock, group: CardGroup, count: int, report: Report, skip: int = 0
) -> Ints:
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
    values = _read(cards, group)
    for row, k in _questionable(values):
        index = row * len(items) + k
        if skip <= index < count:
            field = group.fields[min(index, len(group.fields) - 1)]
            report(_finding(cards, values, row, k, field, items[k]))
    if cards.stopped_by is not None:
        raise DeckError(cards.stopped_by)
    return whole(values.value.ravel()[skip:count])


def _questionable(values: FieldValues) -> list[list[int]]:
    """Card and index of each field that is unreadable or doubtful."""
    marked = values.unreadable | values.doubtful
    found: list[list[int]] = np.argwhere(marked).tolist() if marked.any() else []
    return found


def whole(values: Floats) -> Ints:
    """Values as whole numbers; NaN becomes 0, as it has been reported before.

    Args:
        values: numbers, any shape
    """
    return np.where(np.isnan(values), 0.0, values).astype(np.int64)


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


def _finding(
    cards: CardBlock, values: FieldValues, row: int, k: int, field: CardField, item: FormatItem
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
