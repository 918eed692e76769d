"""What is said of a card's fields: return groups, blanks, implied points, what is not read."""

from __future__ import annotations

import io

import pytest

from tests.kit.command import CASE_1
from vopd.cards.explain import explain_deck
from vopd.findings import InputError

CARDS = CASE_1.read_text().splitlines()


def explained(card: int, *edits: tuple[int, str]) -> list[str]:
    """The lines about one card of case 1, from its first field on, with texts put into columns."""
    line = CARDS[card - 1].ljust(80)
    for column, text in edits:
        line = line[: column - 1] + text + line[column - 1 + len(text) :]
    cards = [*CARDS[: card - 1], line, *CARDS[card:]]
    deck = io.BytesIO(("\n".join(cards) + "\n").encode())
    found = explain_deck(deck, "deck", lambda _, number: number == card)
    return next(found).splitlines()[2:]


RETURNS = {
    0: "(not a return group)",
    1: "(reading goes on at group 1; the basic data too)",
    2: "(reading goes on at group 2; the basic data too)",
    3: "(reading goes on at group 3; the basic data stay)",
    12: "(reading goes on at group 12; the basic data stay)",
    13: "(stop)",
    14: "(not a return group)",
}


@pytest.mark.parametrize("group", RETURNS)
def test_where_reading_goes_on(group: int) -> None:
    """Groups 1 and 2 come before the basic data, which are then read again (A 25 to A 118)."""
    (line, *_) = explained(43, (1, f"{group:5d}"))
    assert (
        line == f"   columns 1-5    NGO      {group:12d}             return group  {RETURNS[group]}"
    )


NOTES = {  # of X of the first card of group 7, columns 11 to 20, F10.1
    "   -26742.": ("-26742", ""),
    "          ": ("0", "  (blank: zero)"),
    "   -267429": ("-26742.9", "  (point implied, 1 decimals)"),
    "  -2 6742.": ("-206742", "  (blanks read as zeros)"),
    "         .": ("0", "  (a number without digits)"),
    "    -26x42": ("?", "  (not a number: '-26x42')"),
}


@pytest.mark.parametrize("text", NOTES)
def test_the_note_on_a_field(text: str) -> None:
    value, note = NOTES[text]
    line = explained(34, (11, text))[1]
    assert line == f"   columns 11-20  XXX      {value:>12} ft          vehicle X, + east{note}"


@pytest.mark.parametrize(("first", "last"), [(71, 71), (75, 80), (80, 80)])
def test_columns_that_hold_something_and_are_not_read(first: int, last: int) -> None:
    """Group 9 ends in column 60."""
    lines = explained(39, (first, "x" * (last - first + 1)))
    assert lines[-1] == f"   columns {first}-{last} hold something that is not read"
    assert len(lines) == 6 + 1


POINTS = {  # of a frame with four fiducials and three landmarks, from its first card, 44
    44: "fiducial 1, reading 1",
    46: "fiducial 1, reading 3",
    55: "fiducial 4, reading 3",
    56: "landmark 1 of 3, reading 1",
    64: "landmark 3 of 3, reading 3",
}


@pytest.mark.parametrize("card", POINTS)
def test_the_point_of_a_card_of_the_film_reader(card: int) -> None:
    deck = io.BytesIO(("\n".join(CARDS) + "\n").encode())
    (text,) = explain_deck(deck, "deck", lambda _, number: number == card)
    head = f"card {card}, basic data: readings of the film, frame 1 of the film, "
    assert text.splitlines()[0] == head + POINTS[card]


FIRSTS = {  # card of a list: name and meaning of its first number, and what follows
    31: ("NT", "number of landmarks (group 9)", ""),
    42: ("NOUT", "number of group 11 cards", ""),
    43: ("NGO", "return group", "  (not a return group)"),
}


@pytest.mark.parametrize("card", FIRSTS)
def test_a_list_whose_first_number_is_blank(card: int) -> None:
    """Only the numbers behind it may be blank because the list has ended."""
    name, meaning, more = FIRSTS[card]
    line = explained(card, (1, "     "))[0]
    assert line.split()[:4] == ["columns", "1-5", name, "0"]
    assert line.endswith(f"{meaning}  (blank: zero){more}")


def test_an_error_names_the_deck() -> None:
    """All cards before it are explained."""
    deck = io.BytesIO(("\n".join(CARDS[:30]) + "\n").encode())
    found = []
    with pytest.raises(InputError) as caught:
        for text in explain_deck(deck, "flight 7.dat", lambda *_: True):
            found.append(text.splitlines()[0].partition(",")[0])
    assert (caught.value.finding.deck, caught.value.finding.card) == ("flight 7.dat", 31)
    assert found == [f"card {k + 1}" for k in range(30)]
