"""A field that cannot be read is reported with its group, its card and its columns: every group."""

from __future__ import annotations

import io

import pytest

from tests.kit.cards import CardLines, punch
from vopd.cards.read import read_jobs
from vopd.cards.write import write_deck
from vopd.findings import BASIC_DATA, Finding, InputError
from vopd.synthetic import Plan
from vopd.synthetic.flight import make

FRAMES = LANDMARKS = 20
"""With them the lists of groups 5 and 12, of 16 numbers a card, go on to a second card."""


@pytest.fixture(scope="module")
def deck() -> CardLines:
    """Cards: 1-25 group 1, 26 title, 27 group 3, 28-37 group 4, 38-39 group 5, 40-41 group 6,

    42-91 group 7, 92 group 8, 93-114 group 9, 115 group 10, 116 group 11, 117-118 group 12.
    """
    cards = write_deck(make(Plan(frames=FRAMES, landmarks=LANDMARKS))[0]).splitlines()
    return [*cards[:114], "    1", "    1    1", *cards[115:]]


def refusal(cards: CardLines) -> Finding:
    with pytest.raises(InputError) as error:
        list(read_jobs(io.BytesIO("\n".join(cards).encode()), "deck"))
    return error.value.finding


def test_the_deck_itself_is_read(deck: CardLines) -> None:
    (job,) = read_jobs(io.BytesIO("\n".join(deck).encode()), "deck")
    assert job.readings.layout.count.tolist() == FRAMES * [LANDMARKS]


@pytest.mark.parametrize(
    ("card", "columns", "group"),
    [
        (1, (1, 10), 1),
        (25, (11, 20), 1),
        (27, (1, 5), 3),
        (37, (11, 20), 4),
        (38, (6, 10), 5),
        (38, (76, 80), 5),
        (39, (31, 35), 5),
        (41, (6, 15), 6),
        (91, (71, 80), 7),
        (92, (1, 10), 8),
        (93, (1, 10), 9),
        (114, (51, 60), 9),
        (115, (1, 5), 10),
        (116, (1, 5), 11),
        (116, (6, 10), 11),
        (117, (1, 5), 12),
        (118, (21, 25), 12),
        (119, (41, 47), BASIC_DATA),
        (190, (51, 57), BASIC_DATA),
    ],
)
def test_an_unreadable_field(
    deck: CardLines, card: int, columns: tuple[int, int], group: int
) -> None:
    cards = list(deck)
    punch(card, columns[1] - 1, "xx")(cards)
    found = refusal(cards)
    assert (found.group, found.card, found.columns) == (group, card, columns)


@pytest.mark.parametrize(("card", "column"), [(38, 16), (38, 76), (39, 1), (39, 31)])
def test_a_count_that_is_refused_on_either_card_of_group_5(
    deck: CardLines, card: int, column: int
) -> None:
    """The counts of 13 frames stand on the first card, behind three others; 7 on the second."""
    cards = list(deck)
    punch(card, column, "    0")(cards)
    found = refusal(cards)
    assert (found.group, found.card, found.columns) == (5, card, (column, column + 4))
    assert found.field == "number of landmarks in a frame"
    assert found.message == "0: at least 1 is needed"
    assert found.image is not None and found.image[column - 1 : column + 4] == "    0"


def test_a_return_group_that_there_is_not(deck: CardLines) -> None:
    cards = list(deck)
    punch(117, 1, "   14")(cards)
    found = refusal(cards)
    assert (found.group, found.card, found.columns) == (12, 117, (1, 5))


@pytest.mark.parametrize("character", ["\x01", "\t", "\x1f", "\x7f", "\xe9"])
@pytest.mark.parametrize("card", [60, 130])
def test_characters_that_are_not_printable_ascii_among_clean_cards(
    deck: CardLines, card: int, character: str
) -> None:
    """Many clean cards of one length are read at once; the one that is not clean is named."""
    cards = [line.ljust(80) for line in deck]
    punch(card, 3, character)(cards)
    with pytest.raises(InputError) as error:
        list(read_jobs(io.BytesIO("\n".join(cards).encode("latin-1")), "deck"))
    assert error.value.finding.card == card
    assert error.value.finding.columns == (3, 3)
