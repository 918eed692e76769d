"""Reads a deck by plain string slices, independently of `vopd.cards`."""

from __future__ import annotations

from typing import NamedTuple

LENS_CARDS = 25


class Text(NamedTuple):
    """Some groups of a deck of one job, number by number as punched, and its basic data."""

    cards: int
    wind: list[list[float]]
    clock: list[list[float]]
    trajectory: list[list[float]]
    origin: list[float]  # group 8
    landmarks: dict[int, list[float]]
    basic_data: list[str]


def numbers(card: str, *widths: int) -> list[float]:
    """The fields of a card, all with their points punched or whole."""
    card, found = card.ljust(80), []
    for width in widths:
        found.append(float(card[:width]))
        card = card[width:]
    return found


def cut(deck: str) -> Text:
    """Appendix F, group after group; group 11 has no cards in these decks."""
    cards = deck.split("\n")
    assert cards.pop() == ""
    count = len(cards)
    left = iter(cards)
    for _ in range(LENS_CARDS):
        numbers(next(left), 10, 10)
    next(left)  # title
    rows, winds = map(int, numbers(next(left), 5, 5))
    wind = [numbers(next(left), 10, 10, 10) for _ in range(winds)]
    first = next(left)
    marks, frames, times = map(int, numbers(first, 5, 5, 5))
    for _ in range((frames + 3 - 1) // 16):
        next(left)
    clock = [numbers(next(left), 5, 10) for _ in range(times)]
    trajectory = [numbers(next(left), *[10] * 8) for _ in range(rows)]
    origin = numbers(next(left), *[10] * 7)
    landmarks = {}
    for _ in range(marks):
        number, *where = numbers(next(left), *[10] * 6)
        landmarks[int(number)] = where
    assert numbers(next(left), 5) == [0]
    for _ in range(marks // 16 + 1):
        next(left)
    return Text(count, wind, clock, trajectory, origin, landmarks, list(left))
