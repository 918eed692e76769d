"""Where each group's cards stand in the deck, for remarks about what they say together."""

from __future__ import annotations

from dataclasses import replace

from vopd.cards.card import Cards
from vopd.cards.groups import BASIC_DATA, GROUPS
from vopd.findings import Finding


class Trace:
    """The cards in force, group by group; a group that is read again takes the old one's place."""

    def __init__(self) -> None:
        self._cards: dict[str, list[Cards]] = {}
        self._fresh: set[str] = set()

    def __call__(self, cards: Cards) -> None:
        label = cards.where.group
        if label not in self._fresh:
            self._cards[label] = []
            self._fresh.add(label)
        self._cards[label].append(cards)

    def next_job(self) -> None:
        """What is read from now on belongs to the next job."""
        self._fresh.clear()

    def read_again(self, label: str) -> bool:
        """Whether this group was read for the present job."""
        return label in self._fresh

    def remark(self, label: str, row: int, field: str, message: str) -> Finding:
        """A warning about a field, by its FORTRAN name, of the group's card `row`, from 0."""
        group = BASIC_DATA if label == BASIC_DATA.label else GROUPS[int(label.split()[1])]
        for cards in self._cards[label]:
            if row < len(cards):
                place = next((p for p in group.layout() if p[0].name == field), None)
                if place is None:
                    where = cards.where
                    return replace(where, message=message, card=cards.first + row).warned()
                columns = (place[1].first, place[1].last)
                return cards.finding(row, message, place[0].meaning, columns).warned()
            row -= len(cards)
        return Finding(message, group=label).warned()
