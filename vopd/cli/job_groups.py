"""Solved jobs in groups, because what is made of many short jobs together takes less time."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeVar

from vopd.results import DeckEnd, SolvedJob

TOGETHER = 2000  # frames

Solved = TypeVar("Solved")


def in_groups(sources: Iterator[Solved]) -> Iterator[list[Solved]]:
    """Jobs of decks in groups of about `TOGETHER` frames.

    What comes between them is in the groups too, in its order; a flight is the last of its group.

    Args:
        sources: jobs of decks, flights, and ends of decks
    """
    group: list[Solved] = []
    frames = 0
    for one in sources:
        group.append(one)
        frames += len(one.results.frame) if isinstance(one, SolvedJob) else 0
        if frames >= TOGETHER or not isinstance(one, SolvedJob | DeckEnd):
            yield group
            group, frames = [], 0
    if group:
        yield group
