"""Decks with some cards changed, and everything that the reader says of them."""

from __future__ import annotations

import io

from tests.kit.card_edits import CardLines, punch, two_frames
from vopd.cards.read import read_jobs
from vopd.findings import Finding, InputError


def said(cards: CardLines, encoding: str = "ascii") -> list[Finding]:
    """Everything that is reported, and the error that ends the deck, each once."""
    found: list[Finding] = []
    try:
        list(read_jobs(io.BytesIO("\n".join(cards).encode(encoding)), "a.dat", found.append))
    except InputError as error:
        found.append(error.finding)
    return list(dict.fromkeys(found))


def edited(*edits: tuple[int, int, str]) -> CardLines:
    """The clean deck of frames 730 and 731 with texts punched into cards at columns."""
    cards = two_frames()
    for edit in edits:
        punch(*edit)(cards)
    return cards
