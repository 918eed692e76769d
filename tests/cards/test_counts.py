"""Counts of group 5 that the cards contradict: refused at the first card that does, at low cost."""

from __future__ import annotations

import io
import tracemalloc

import pytest

from tests.kit.cards import CardLines, punch
from vopd.cards.read import read_jobs
from vopd.cards.write import write_deck
from vopd.check import check_deck
from vopd.findings import BASIC_DATA, Finding, InputError
from vopd.synthetic import Plan
from vopd.synthetic.flight import make

FRAMES, LANDMARKS = 600, 4
CARDS = 12 + 3 * LANDMARKS


@pytest.fixture(scope="module")
def flight() -> CardLines:
    return write_deck(make(Plan(frames=FRAMES, landmarks=LANDMARKS))[0]).splitlines()


def group_5(cards: CardLines) -> int:
    """Number of the first card of group 5, from 1."""
    return next(k for k, card in enumerate(cards, 1) if card[5:10] == f"{FRAMES:5d}")


def first_of_film(cards: CardLines) -> int:
    return len(cards) - FRAMES * CARDS + 1


def refusal(cards: CardLines) -> Finding:
    with pytest.raises(InputError) as error:
        list(read_jobs(io.BytesIO("\n".join(cards).encode()), "deck"))
    return error.value.finding


@pytest.mark.parametrize("punched", ["2    ", "4    ", "99999", "    5"])
def test_a_count_that_is_too_large(flight: CardLines, punched: str) -> None:
    """The first card of frame 2 contradicts it, however large the count is."""
    cards = list(flight)
    punch(group_5(cards), 16, punched)(cards)
    found = refusal(cards)
    assert found.card == first_of_film(cards) + CARDS
    assert (found.group, found.columns) == (BASIC_DATA, (64, 67))
    count = int(punched.replace(" ", "0")) if punched[0] != " " else 5
    assert found.message == f"a card of frame 2, where group 5 counts {count} landmarks for frame 1"


def test_a_count_that_is_too_small(flight: CardLines) -> None:
    """Frame 14 has its count first on the second card: 3 counts and 13 frames fill the first."""
    cards = list(flight)
    punch(group_5(cards) + 1, 1, "    3")(cards)
    found = refusal(cards)
    assert found.card == first_of_film(cards) + 14 * CARDS - 3
    assert found.message == (
        "a further card of frame 14, for which group 5 counts 3 landmarks"
    )  # fmt: skip


def test_the_check_ends_there_too(flight: CardLines) -> None:
    cards = list(flight)
    punch(group_5(cards), 16, "    5")(cards)
    found = check_deck(io.BytesIO("\n".join(cards).encode()), "deck")
    assert [finding.severity for finding in found] == ["error"]


@pytest.mark.parametrize("first_count", ["2    ", "99999"])
def test_memory_follows_the_cards_and_not_the_counts(flight: CardLines, first_count: str) -> None:
    """As arrays of frames by the largest count the readings would take 576 MB and more."""
    cards = list(flight)
    punch(group_5(cards), 16, first_count)(cards)
    deck = io.BytesIO("\n".join(cards).encode())
    tracemalloc.start()
    try:
        check_deck(deck, "deck")
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 30 * len(deck.getvalue())


def test_a_large_count_that_is_right_is_read() -> None:
    (job,), _ = make(Plan(frames=3, landmarks=60, swing_deg=5.0))
    (back,) = read_jobs(io.BytesIO(write_deck([job]).encode()), "deck")
    assert back == job


def test_all_digits_are_no_film() -> None:
    """Cards of one digit count 11111 of everything; the deck ends in the first frame."""
    cards = ("1" * 80 + "\n") * 60_000
    found = check_deck(io.BytesIO(cards.encode()), "deck")
    errors = [finding for finding in found if finding.severity == "error"]
    assert len(errors) == 1 and "the deck ends here" in errors[0].message
