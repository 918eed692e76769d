"""`vopd cards`: explain a deck card by card."""

from __future__ import annotations

import click

from vopd.cards.explain import explain_deck
from vopd.cards.groups import BASIC_DATA
from vopd.cards.reader import open_deck
from vopd.cli.file_options import FILE_NAME

SHOWN = 21  # cards of basic data that are explained unasked: a frame of three landmarks


@click.command("cards")
@click.argument("deck", type=FILE_NAME, metavar="DECK")
@click.option(
    "--group", "groups", metavar="N", multiple=True, help="1 to 12, or basic; repeatable."
)
@click.option("--card", "cards", metavar="N", multiple=True, help="A card, or A-B; repeatable.")
def command(deck: str, groups: tuple[str, ...], cards: tuple[str, ...]) -> None:
    """Explain a deck card by card.

    Under each card stand its fields: columns, FORTRAN name, the value that the
    program reads, unit, meaning. Of the basic data only the first cards are
    explained unless --group basic or --card asks for others.

    \b
    Example:
        vopd cards decks/appendix_h/case1.dat --group 8
        vopd cards decks/appendix_h/case1.dat --card 39-41
    """
    chosen = Chosen(groups, cards)
    with open_deck(deck) as file:
        for text in explain_deck(file, deck, chosen):
            click.echo(text + "\n")
    if chosen.held_back:
        click.echo(
            f"{chosen.held_back} more cards of basic data: choose them by --card A-B, "
            "or all by --group basic"
        )


class Chosen:
    """What --group and --card ask for; raises `click.UsageError` for what is neither."""

    def __init__(self, groups: tuple[str, ...], cards: tuple[str, ...]) -> None:
        self._groups = {_group(group) for group in groups}
        self._ranges = [_range(card) for card in cards]
        self._shown = 0
        self.held_back = 0

    def __call__(self, number: int, card: int) -> bool:
        if self._groups and number not in self._groups:
            return False
        if self._ranges:
            return any(first <= card <= last for first, last in self._ranges)
        if number != BASIC_DATA.number or self._groups:
            return True
        self._shown += 1
        self.held_back += self._shown > SHOWN
        return self._shown <= SHOWN


def _group(group: str) -> int:
    if group == "basic":
        return BASIC_DATA.number
    if group.isascii() and group.isdigit() and 1 <= int(group) <= 12:
        return int(group)
    raise click.UsageError(f"--group {group}: 1 to 12, or basic.")


def _range(card: str) -> tuple[int, int]:
    first, dash, last = card.partition("-")
    parts = (first, last) if dash else (first, first)
    if not all(part.isascii() and part.isdigit() and int(part) > 0 for part in parts):
        raise click.UsageError(f"--card {card}: a card's number from 1, or A-B.")
    return int(parts[0]), int(parts[1])
