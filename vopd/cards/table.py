"""The cards of one group to columns of numbers, every doubtful or unreadable field named."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.cards.card import Cards
from vopd.cards.formats import Item, items
from vopd.cards.groups import Field, Group
from vopd.cards.numbers import read_column
from vopd.findings import DeckError, Finding, Report

Table = dict[str, Floats]
"""Field name to its column; a field that repeats on a card has shape (n, repeats)."""


def read_table(cards: Cards, group: Group, report: Report) -> Table:
    """Read every field of every card; remarks go to `report` in the order of the deck."""
    remarks: list[tuple[int, int, Finding]] = []
    columns: dict[str, list[Floats]] = {}
    for field, item in group.layout():
        if field.name:
            columns.setdefault(field.name, []).append(_column(cards, field, item, remarks))
    _tell(remarks, cards, report)
    return {
        name: parts[0] if len(parts) == 1 else np.stack(parts, axis=1)
        for name, parts in columns.items()
    }


def read_list(cards: Cards, group: Group, count: int, report: Report, skip: int = 0) -> Ints:
    """The whole numbers `skip` to `count` of a group that goes on from card to card."""
    places = items(group.format)
    values = np.zeros((len(cards), len(places)))
    remarks: list[tuple[int, int, Finding]] = []
    for place, item in enumerate(places):
        start = 1 if place < skip else 0
        stop = min(len(cards), -(-(count - place) // len(places)))
        if start >= stop:
            continue
        part = Cards(cards.text[start:stop], cards.first + start, cards.where)
        field = group.fields[-1 if start else min(place, len(group.fields) - 1)]
        values[start:stop, place] = _column(part, field, item, remarks, later=group.fields[-1])
    _tell(remarks, cards, report)
    return whole(values.ravel()[skip:count])


def whole(values: Floats) -> Ints:
    """Whole numbers; what was unreadable, and has been reported, counts as zero."""
    return np.nan_to_num(values).astype(np.int64)


def _column(
    cards: Cards,
    field: Field,
    item: Item,
    remarks: list[tuple[int, int, Finding]],
    later: Field | None = None,
) -> Floats:
    text = cards.columns(item.first, item.last)
    value, bad, doubtful = read_column(text, item)
    for row in np.flatnonzero(bad | doubtful):
        punched = text[row].tobytes().decode("ascii")
        if bad[row]:
            kind = "a whole number" if item.kind == "I" else "a number"
            message = f"not {kind}: {punched.strip()!r}"
        else:
            message = f"blanks read as zeros: {punched!r} is {value[row]:.12g}"
        meaning = (later if later and row else field).meaning
        finding = cards.finding(int(row), message, meaning, (item.first, item.last))
        finding = finding if bad[row] else finding.warned()
        remarks.append((cards.first + int(row), item.first, finding))
    return value


def _tell(remarks: list[tuple[int, int, Finding]], cards: Cards, report: Report) -> None:
    for _, _, finding in sorted(remarks, key=lambda remark: remark[:2]):
        report(finding)
    if cards.trouble is not None:
        raise DeckError(cards.trouble)
