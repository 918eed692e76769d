"""Remember where the cards of each group are in the deck, for findings about several cards."""

from __future__ import annotations

from vopd.cards.card_block import CardBlock
from vopd.cards.format import group_of
from vopd.findings import Finding


class CardLocations:
    """The cards of each group; cards that are read again replace the old ones.

    `add` is what `read_jobs` calls with every block of cards.
    """

    def __init__(self) -> None:
        self._blocks: dict[int, list[CardBlock]] = {}
        self._read_for_this_job: set[int] = set()

    def add(self, cards: CardBlock) -> None:
        """Add a block of cards that has been read."""
        number = cards.where.group or 0
        if number not in self._read_for_this_job:
            self._blocks[number] = []
            self._read_for_this_job.add(number)
        self._blocks[number].append(cards)

    def next_job(self) -> None:
        """Note that the cards that follow belong to the next job."""
        self._read_for_this_job.clear()

    def was_read(self, group: int) -> bool:
        """Whether this group was read for the present job."""
        return group in self._read_for_this_job

    def warning(self, group: int, row: int, field: str, message: str) -> Finding:
        """Make a warning about one card of a group.

        Args:
            group: number of the group
            row: index of the card within the group, from 0
            field: FORTRAN name of the field; empty for the whole card
            message: what is to be said
        """
        for cards in self._blocks[group]:
            if row < len(cards):
                layout = group_of(group).layout
                found = next((pair for pair in layout if pair[0].name == field), None)
                if found is None:
                    where, card = cards.where, cards.first + row
                    return Finding(message, where.deck, card, group=group, severity="warning")
                card_field, item = found
                columns = (item.first, item.last)
                return cards.finding(row, message, card_field.meaning, columns, "warning")
            row -= len(cards)
        return Finding(message, group=group).warned()


def decimal_text(value: float, decimals: int) -> str:
    """A number as text with a fixed number of decimals; with an exponent if it is too large."""
    return f"{value:.{decimals}f}" if abs(value) < 1e8 else f"{value:.4g}"
