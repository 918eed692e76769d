"""`vopd cards`: explain a deck card by card."""

from __future__ import annotations

import io
from contextlib import suppress

import click

from vopd.cards import sequence
from vopd.cards.deck import CardBlock
from vopd.cards.explain import explain_deck
from vopd.cards.format import BASIC_DATA
from vopd.cards.read import open_deck, read_jobs
from vopd.cards.text import CardText
from vopd.cli.options import FILE_NAME, output_option
from vopd.cli.output import refuse_to_overwrite
from vopd.files import whole_file
from vopd.findings import VopdError, count_text, group_text, shortened
from vopd.inputs import whole_number

SHOWN = 21  # cards of basic data that are explained unasked: a frame of three landmarks


@click.command("cards")
@click.argument("deck", type=FILE_NAME, metavar="DECK")
@click.option(
    "--group", "groups", metavar="N", multiple=True, help="1 to 12, or basic; repeatable."
)
@click.option("--card", "cards", metavar="N", multiple=True, help="A card, or A-B; repeatable.")
@click.option(
    "--strip-sequence",
    is_flag=True,
    help="Write the deck itself, without the sequence numbers in columns 73 to 80.",
)
@output_option("Write the text to this file.")
def command(
    deck: str, groups: tuple[str, ...], cards: tuple[str, ...], strip_sequence: bool, output: str
) -> None:
    """Explain a deck card by card.

    Under each card are its fields: columns, FORTRAN name, the value that the
    program reads, unit, meaning. Of the basic data, only the first cards are
    explained; --group basic explains all, --card those that you name.

    DECK is a file of 80-column cards, - is standard input.

    \b
    Examples:
        vopd cards decks/appendix_h/case1.dat --group 8
        vopd cards decks/appendix_h/case1.dat --card 39-41
        vopd cards numbered.dat --strip-sequence -o flight.dat

    Exit status: 0 all well; 1 the deck could not be read, or has no such card;
    2 wrong usage.
    """
    choice = CardChoice(groups, cards)
    refuse_to_overwrite((deck,), output)
    if strip_sequence:
        if groups or cards:
            raise click.UsageError("--strip-sequence writes all cards: leave out --group, --card.")
        _strip_sequence(deck, output)
        return
    with open_deck(deck) as source, whole_file(output) as file:
        for text in explain_deck(source, deck, choice):
            file.write(f"{text}\n\n".encode())
    choice.check_all_found(deck)
    if choice.held_back:
        click.echo(
            f"{count_text(choice.held_back, 'more card')} of basic data: choose them by "
            "--card A-B, or all by --group basic",
            err=True,
        )


def _strip_sequence(deck: str, output: str) -> None:
    """Write a deck without its sequence numbers; refuse where they stand in place of altitudes."""
    with open_deck(deck) as source:
        text = CardText(source).all(deck)
    bare, stripped = sequence.strip_sequence(text, deck)
    of_group_7: set[int] = set()

    def keep(cards: CardBlock) -> None:
        if cards.where.group == 7:
            of_group_7.update(range(cards.first, cards.first + len(cards)))

    with suppress(VopdError):
        for _ in read_jobs(io.BytesIO(text), deck, lambda _: None, on_cards=keep):
            pass
    if lost := sorted(of_group_7 & stripped):
        raise VopdError(
            f"{deck}: group 7 has them in the place of the altitude, columns 71-80 "
            f"({count_text(len(lost), 'card')}, first card {lost[0]}): without it the vehicle "
            "would be at sea level; punch the altitudes again, and then take the numbers off"
        )
    with whole_file(output) as file:
        file.write(bare)
    click.echo(f"sequence numbers taken off {count_text(len(stripped), 'card')}", err=True)


class CardChoice:
    """The cards that the options --group and --card select.

    Args:
        groups: `1` to `12`, or `basic`; none stands for all groups
        cards: numbers of cards, or ranges such as `39-41`; none stands for all cards

    Raises:
        click.UsageError: for what is neither.
    """

    def __init__(self, groups: tuple[str, ...], cards: tuple[str, ...]) -> None:
        self._groups = {_group(group) for group in groups}
        self._ranges = [_range(card) for card in cards]
        self._read = 0
        self._shown = 0
        self._basic_data_cards = 0
        self.held_back = 0

    def __call__(self, group: int, card: int) -> bool:
        """Tell whether this card, of this group, is to be explained."""
        self._read = card
        wanted = self._wants(group, card)
        self._shown += wanted
        return wanted

    def _wants(self, group: int, card: int) -> bool:
        if self._groups and group not in self._groups:
            return False
        if self._ranges:
            return any(first <= card <= last for first, last in self._ranges)
        if group != BASIC_DATA.number or self._groups:
            return True
        self._basic_data_cards += 1
        self.held_back += self._basic_data_cards > SHOWN
        return self._basic_data_cards <= SHOWN

    def check_all_found(self, deck: str) -> None:
        """Raise `VopdError` if a selected card is not in the deck."""
        last = max((last for _, last in self._ranges), default=0)
        if last > self._read:
            raise VopdError(
                f"{deck}: there is no card {last}: the deck has {count_text(self._read, 'card')}"
            )
        if not self._shown:
            groups = " or ".join(group_text(group) for group in sorted(self._groups))
            where = "none of these cards" if self._ranges else "no card"
            raise VopdError(f"{deck}: {where} belongs to {groups}")


def _group(group: str) -> int:
    if group == "basic":
        return BASIC_DATA.number
    if group in map(str, range(1, 13)):
        return int(group)
    raise click.UsageError(f"--group {shortened(group)}: a group is 1 to 12, or basic.")


def _range(card: str) -> tuple[int, int]:
    first, dash, last = card.partition("-")
    parts = (first, last) if dash else (first, first)
    try:
        begin, end = map(whole_number, parts)
    except ValueError:
        begin = end = 0
    if begin < 1 or end < 1:
        raise click.UsageError(f"--card {shortened(card)}: give a card number from 1, or A-B.")
    if begin > end:
        raise click.UsageError(f"--card {card}: the first card comes after the last.")
    return begin, end
