"""What the reader says about the end of a deck and of a job: message, card, severity."""

from __future__ import annotations

import io
from typing import NamedTuple

import pytest

from tests.kit.command import CASE_1
from vopd.cards.read import read_jobs
from vopd.findings import Finding, InputError

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


def said(cards: list[str], *, limits_1974: bool = False) -> list[Said]:
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


ENDS = {  # cards that are left: where the deck ends, in which group, and what was expected
    0 + 1: (2, 1, "25 cards expected, 1 found"),
    24: (25, 1, "25 cards expected, 24 found"),
    26: (27, 3, "1 card expected, none found"),
    29: (30, 4, "3 cards expected, 2 found"),
    30: (31, 5, "1 card expected, none found"),
    32: (33, 6, "2 cards expected, 1 found"),
    33: (34, 7, "4 cards expected, none found"),
    36: (37, 7, "4 cards expected, 3 found"),
    37: (38, 8, "1 card expected, none found"),
    39: (40, 9, "3 cards expected, 1 found"),
    41: (42, 10, "1 card expected, none found"),
    42: (43, 12, "1 card expected, none found"),
    43: (44, 0, "21 cards expected, none found"),
    44: (45, 0, "21 cards expected, 1 found"),
    63: (64, 0, "21 cards expected, 20 found"),
}


@pytest.mark.parametrize("left", ENDS)
def test_a_deck_that_ends_early(left: int) -> None:
    """The card named is the first that is missing."""
    card, group, words = ENDS[left]
    assert said(CARDS[:left])[-1] == (card, group, None, "error", f"the deck ends here: {words}")


def test_a_deck_of_one_card_of_group_1_ends_before_its_title() -> None:
    """After group 1 there may be no job, as in a deck of lens cards alone."""
    assert said(CARDS[:25]) == []


@pytest.mark.parametrize("more", [1, 2, 30])
def test_a_deck_that_goes_on(more: int) -> None:
    """The card named is the first behind the job that stops the run."""
    message = "the deck goes on after the job that stops the run (return group 13)"
    assert said([*CARDS, *more * ["       1"]]) == [
        Said(CONTROL + FRAME + 1, None, None, "warning", message)
    ]
    assert said([*CARDS, *more * [" "]]) == []


@pytest.mark.parametrize("group", [1, 2, 12])
def test_the_return_groups_that_there_are(group: int) -> None:
    """Reading goes on there, and the deck has no card for it; it may end before a title."""
    found = said(put(43, 1, f"{group:5d}"))
    if group == 2:
        assert found == []
    else:
        (end,) = found
        assert (end.card, end.group, end.severity) == (65, group, "error")


@pytest.mark.parametrize("group", [0, 14, -1, 99])
def test_a_return_group_that_there_is_not(group: int) -> None:
    message = f"{group} is not a return group (1 to 12, or 13 to stop)"
    assert said(put(43, 1, f"{group:5d}")) == [Said(43, 12, (1, 5), "error", message)]


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
    assert refused in said(put(card, column, f"{least - 1:5d}"))
    taken = said(put(card, column, f"{least:5d}"))
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
    (told,) = [one for one in said(beyond, limits_1974=True) if words in one.message]
    assert told.message == f"{largest + 1}: {words} {array} takes {largest} at most"
    assert (told.card, told.columns, told.severity) == (card, (column, column + 4), "error")
    assert not [one for one in said(beyond) if words in one.message]
    within = put(card, column, f"{largest:5d}")
    assert not [one for one in said(within, limits_1974=True) if words in one.message]


@pytest.mark.parametrize(("number", "questioned"), [(90, False), (91, True)])
def test_the_largest_landmark_number_in_1974(number: int, questioned: bool) -> None:
    found = said(put(41, 1, f"{number:10d}"), limits_1974=True)
    told = [one for one in found if "TTHJ(90)" in one.message]
    assert [(one.card, one.columns) for one in told] == ([(41, (1, 10))] if questioned else [])
