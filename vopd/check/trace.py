"""Where each group's cards stand in the deck, for remarks about what they say together."""

from __future__ import annotations

from dataclasses import replace

from vopd.cards.card import Cards
from vopd.cards.groups import group_of
from vopd.findings import Finding


class Trace:
    """The cards in force, group by group; a group that is read again takes the old one's place."""

    def __init__(self) -> None:
        self._cards: dict[int, list[Cards]] = {}
        self._fresh: set[int] = set()

    def __call__(self, cards: Cards) -> None:
        number = cards.where.group or 0
        if number not in self._fresh:
            self._cards[number] = []
            self._fresh.add(number)
        self._cards[number].append(cards)

    def next_job(self) -> None:
        """What is read from now on belongs to the next job."""
        self._fresh.clear()

    def read_again(self, number: int) -> bool:
        """Whether this group was read for the present job."""
        return number in self._fresh

    def remark(self, number: int, row: int, field: str, message: str) -> Finding:
        """A warning about a field, by its FORTRAN name, of the group's card `row`, from 0."""
        group = group_of(number)
        for cards in self._cards[number]:
            if row < len(cards):
                place = next((p for p in group.layout() if p[0].name == field), None)
                if place is None:
                    where = cards.where
                    return replace(where, message=message, card=cards.first + row).warned()
                columns = (place[1].first, place[1].last)
                return cards.finding(row, message, place[0].meaning, columns).warned()
            row -= len(cards)
        return Finding(message, group=number).warned()
