"""What the reader reports: message, group, card, field, columns, severity, image."""

from __future__ import annotations

import io
from dataclasses import replace
from typing import NamedTuple

import pytest

from tests.approved.texts import assert_approved
from tests.kit.cards import CardLines, edited, punch, said
from tests.kit.command import CASE_1
from vopd.cards.read import read_jobs
from vopd.cards.write import write_deck
from vopd.findings import BASIC_DATA, Finding, InputError
from vopd.synthetic import Plan
from vopd.synthetic.flight import make

CARDS = CASE_1.read_text().splitlines()
CONTROL, FRAME = 43, 21
"""Cards of groups 1 to 12 of case 1, and of its one frame with three landmarks."""


class Said(NamedTuple):
    """One finding: its card, group, columns, severity and message."""

    card: int | None
    group: int | None
    columns: tuple[int, int] | None
    severity: str
    message: str


def reported(cards: list[str], *, limits_1974: bool = False) -> list[Said]:
    """Everything that is reported while a deck is read, and the error that ends it."""
    found: list[Finding] = []
    deck = io.BytesIO(("\n".join(cards) + "\n").encode())
    try:
        list(read_jobs(deck, "deck", found.append, limits_1974=limits_1974))
    except InputError as error:
        found.append(error.finding)
    return list(dict.fromkeys(
        Said(one.card, one.group, one.columns, one.severity, one.message) for one in found
    ))  # fmt: skip


def put(card: int, column: int, text: str) -> list[str]:
    """Case 1 with a text in a card, both counted from 1."""
    line = CARDS[card - 1].ljust(80)
    changed = line[: column - 1] + text + line[column - 1 + len(text) :]
    return [*CARDS[: card - 1], changed, *CARDS[card:]]


ENDS = {  # cards that are left: where the deck ends, in which group; cards needed, cards there
    0 + 1: (2, 1, 25, 1),
    24: (25, 1, 25, 24),
    26: (27, 3, 1, 0),
    29: (30, 4, 3, 2),
    30: (31, 5, 1, 0),
    32: (33, 6, 2, 1),
    33: (34, 7, 4, 0),
    36: (37, 7, 4, 3),
    37: (38, 8, 1, 0),
    39: (40, 9, 3, 1),
    41: (42, 10, 1, 0),
    42: (43, 12, 1, 0),
    43: (44, 0, 21, 0),
    44: (45, 0, 21, 1),
    63: (64, 0, 21, 20),
}


@pytest.mark.parametrize("left", ENDS)
def test_a_deck_that_ends_early(left: int) -> None:
    """The card named is the first that is missing."""
    card, group, needed, there = ENDS[left]
    end = reported(CARDS[:left])[-1]
    assert end[:4] == (card, group, None, "error")
    assert_approved(end.message, parts=[needed, there or "none"])


def test_a_deck_of_one_card_of_group_1_ends_before_its_title() -> None:
    """After group 1 there may be no job, as in a deck of lens cards alone."""
    assert reported(CARDS[:25]) == []


@pytest.mark.parametrize("more", [1, 2, 30])
def test_a_deck_that_goes_on(more: int) -> None:
    """The card named is the first behind the job that stops the run."""
    (found,) = reported([*CARDS, *more * ["       1"]])
    assert found[:4] == (CONTROL + FRAME + 1, None, None, "warning")
    assert_approved(found.message)
    assert reported([*CARDS, *more * [" "]]) == []


@pytest.mark.parametrize("group", [1, 2, 12])
def test_the_return_groups_that_there_are(group: int) -> None:
    """Reading goes on there, and the deck has no card for it; it may end before a title."""
    found = reported(put(43, 1, f"{group:5d}"))
    if group == 2:
        assert found == []
    else:
        (end,) = found
        assert (end.card, end.group, end.severity) == (65, group, "error")


@pytest.mark.parametrize("group", [0, 14, -1, 99])
def test_a_return_group_that_there_is_not(group: int) -> None:
    (found,) = reported(put(43, 1, f"{group:5d}"))
    assert found[:4] == (43, 12, (1, 5), "error")
    assert_approved(found.message, parts=[group])


COUNTS = {  # card and column of each count, its group, and the least that is taken
    "III": (27, 1, 3, 1),
    "IWV": (27, 6, 3, 1),
    "NT": (31, 1, 5, 1),
    "NFR": (31, 6, 5, 1),
    "NTFR": (31, 11, 5, 1),
    "NPT": (31, 16, 5, 1),
    "NOUT": (42, 1, 10, 0),
}


@pytest.mark.parametrize("name", COUNTS)
def test_the_least_of_every_count(name: str) -> None:
    card, column, group, least = COUNTS[name]
    refused = Said(
        card, group, (column, column + 4), "error", f"{least - 1}: at least {least} is needed"
    )
    assert refused in reported(put(card, column, f"{least - 1:5d}"))
    taken = reported(put(card, column, f"{least:5d}"))
    assert not [one for one in taken if one.card == card and one.columns == (column, column + 4)]


ARRAYS = {  # TM X-3050, A 2 to A 18: the arrays that hold what these fields count
    "III": (27, 1, 50, "IX(50)"),
    "IWV": (27, 6, 50, "ALT(50)"),
    "NT": (31, 1, 100, "IOUT(100)"),
    "NFR": (31, 6, 200, "NPT(200)"),
    "NTFR": (31, 11, 100, "IFRM(100)"),
    "NPT": (31, 16, 6, "IDENT(6)"),
    "NOUT": (42, 1, 100, "IFM(100)"),
}


@pytest.mark.parametrize("name", ARRAYS)
def test_the_largest_of_every_count_in_1974(name: str) -> None:
    card, column, largest, array = ARRAYS[name]
    words = "the original's array"
    beyond = put(card, column, f"{largest + 1:5d}")
    (told,) = [one for one in reported(beyond, limits_1974=True) if words in one.message]
    assert told.message == f"{largest + 1}: {words} {array} takes {largest} at most"
    assert (told.card, told.columns, told.severity) == (card, (column, column + 4), "error")
    assert not [one for one in reported(beyond) if words in one.message]
    within = put(card, column, f"{largest:5d}")
    assert not [one for one in reported(within, limits_1974=True) if words in one.message]


@pytest.mark.parametrize(("number", "questioned"), [(90, False), (91, True)])
def test_the_largest_landmark_number_in_1974(number: int, questioned: bool) -> None:
    found = reported(put(41, 1, f"{number:10d}"), limits_1974=True)
    told = [one for one in found if "TTHJ(90)" in one.message]
    assert [(one.card, one.columns) for one in told] == ([(41, (1, 10))] if questioned else [])


# Every sentence about a card


FIELDS = {  # the edit, card by column; group, columns, severity
    "a whole number": ((31, 1, "  3.5"), 5, (1, 5), "error"),
    "a number": ((39, 41, "  5O.3    "), 9, (41, 50), "error"),
    "blanks": ((32, 6, "   48.07 3"), 6, (6, 15), "warning"),
    "blanks, many digits": ((28, 1, "1234567 9."), 4, (1, 10), "warning"),
    "no digits": ((27, 16, "  -. "), 3, (16, 20), "warning"),
    "a fiducial's landmark": ((50, 9, "07"), 0, (9, 10), "warning"),
    "a frame": ((70, 64, "0713"), 0, (64, 67), "error"),
    "the first card of a frame": ((44, 64, "0999"), 0, (64, 67), "error"),
    "the last card of a frame": ((85, 64, "0999"), 0, (64, 67), "error"),
    "the first of three readings": ((56, 9, "66"), 0, (9, 10), "error"),
    "the second of three readings": ((57, 9, "66"), 0, (9, 10), "error"),
    "the third of three readings": ((58, 9, "66"), 0, (9, 10), "error"),
}


@pytest.mark.parametrize("name", FIELDS)
def test_a_sentence_about_a_field(name: str) -> None:
    edit, group, columns, severity = FIELDS[name]
    cards = edited(edit)
    (found, *_) = said(cards)
    image = cards[edit[0] - 1].ljust(80)
    assert (found.source, found.card, found.group, found.columns, found.severity, found.image) == (
        "a.dat", edit[0], group, columns, severity, image,
    )  # fmt: skip
    assert_approved([found.field, found.message])


CHARACTERS = {  # a text put into card 28, at a column: the column named
    "a tab": (5, "\t", 5),
    "a control": (80, "\x01", 80),
    "a letter": (7, "\xe9", 7),
    "delete": (7, "\x7f", 7),
    "column 81": (81, "x", 81),
    "column 90": (81, "         x", 90),
    "a tab behind": (81, "         \t", 90),
    "column 82 and a tab": (81, " x\t", 82),
}


@pytest.mark.parametrize("name", CHARACTERS)
def test_a_line_that_is_no_card(name: str) -> None:
    """The image has a question mark for what is not printable, and 80 columns at most."""
    at, text, column = CHARACTERS[name]
    cards = edited((28, at, text))
    (found, *_) = said(cards, "latin-1")
    image = "".join(c if " " <= c <= "~" else "?" for c in cards[27].rstrip(" "))[:80]
    assert replace(found, message="") == Finding(
        "", "a.dat", 28, None, 4, "", (column, column), image
    )
    assert_approved(found.message)


@pytest.mark.parametrize("text", [" ", " \r", "\r"])
def test_blanks_behind_column_80_and_a_carriage_return_are_no_columns(text: str) -> None:
    assert said(edited((28, 81, text))) == []
    assert said(edited((28, 80, "~"))) == []


@pytest.mark.parametrize(
    ("column", "character"), [(1, "\t"), (2, "\x01"), (60, "\t"), (71, "\xe9")]
)
def test_what_is_not_printable_is_read_as_a_blank(column: int, character: str) -> None:
    """Nothing else is said of its field, in front of the number or behind the last field."""
    cards = edited((28, column, character))
    found = said(cards, "latin-1")
    assert [(one.card, one.columns, one.severity) for one in found] == [
        (28, (column, column), "error")
    ]


# Group, card and columns


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
    assert_approved([found.field, found.message])
    assert found.image is not None and found.image[column - 1 : column + 4] == "    0"


def test_a_return_group_that_there_is_not_of_group(deck: CardLines) -> None:
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
