"""A deck in words: every card with its group, and beneath it each field's columns and value."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import BinaryIO

import numpy as np

from vopd.cards.basic_data import FIDUCIAL_CARDS
from vopd.cards.card import BLANK, COLUMNS, Cards
from vopd.cards.formats import Item, items
from vopd.cards.groups import BASIC_DATA, GROUPS, Field, Group, group_of
from vopd.cards.numbers import read_column
from vopd.cards.reader import read_jobs
from vopd.findings import DeckError

Wanted = Callable[[int, int], bool]
"""Says of a group's label and a card's number whether that card is to be explained."""


def explain_deck(file: BinaryIO, name: str, wanted: Wanted) -> Iterator[str]:
    """The wanted cards of a deck, one text a card, in the order of reading.

    Fields that cannot be read are shown and said so. Raises `DeckError` where
    the deck cannot be read on, after the cards before.
    """
    taken: list[Cards] = []
    words = _Words()
    jobs = read_jobs(file, name, lambda _: None, trace=taken.append)
    error: DeckError | None = None
    while error is None:
        try:
            job = next(jobs, None)
        except DeckError as caught:
            job, error = None, caught
        for cards in taken:
            yield from words.explain(cards, wanted)
        taken.clear()
        if job is None:
            break
    if error is not None:
        raise error


class _Words:
    """What the cards before say about those that follow: counts, and how far a list has come."""

    def __init__(self) -> None:
        self._counts: dict[str, int] = {}
        self._per_frame: list[int] = []
        self._group = -1
        self._row = 0

    def explain(self, cards: Cards, wanted: Wanted) -> Iterator[str]:
        number = cards.where.group or 0
        if number != self._group or self._is_over(number):
            self._group, self._row = number, 0
        group = group_of(number)
        for row in range(len(cards)):
            shown = wanted(number, cards.first + row)
            if shown or group.is_list:  # a list says how many cards follow
                lines = self._card(cards, row, group)
                if shown:
                    yield "\n".join(lines)
            self._row += 1

    def _is_over(self, group: int) -> bool:
        """Whether the list that has been read is complete, so that a new one begins."""
        counts = {5: 3 + self._counts.get("NFR", 0), 12: 1 + self._counts["NT"]}
        return group in counts and self._row * 16 >= counts[group]

    def _card(self, cards: Cards, row: int, group: Group) -> list[str]:
        image = cards.image(row)
        where = f"card {cards.first + row}, {group.label}: {group.title}"
        if group is BASIC_DATA:
            where += f", {self._point()}"
        lines = [where, "  |" + image.rstrip()]
        if group is GROUPS[2]:
            return [*lines, "   columns 1-80  TITLE   printed at the top of every page"]
        used = np.zeros(COLUMNS, bool)
        for place, (field, item) in enumerate(group.layout()):
            text = image[item.first - 1 : item.last]
            if group.is_list and place and not text.strip():
                continue
            used[item.first - 1 : item.last] = True
            if field.name:
                lines.append(self._field(group, place, field, item, text))
        return lines + _left_over(image, used, group)

    def _field(self, group: Group, place: int, field: Field, item: Item, text: str) -> str:
        value, note = _read(text, item)
        name, meaning = field.name, field.meaning
        if group.is_list:
            at = self._row * len(items(group.format)) + place
            field = group.fields[min(at, len(group.fields) - 1)]
            name, meaning = field.name, field.meaning
            if at >= len(group.fields) - 1 and len(group.fields) > 1:
                which = at - len(group.fields) + 2
                name = f"{name}({which})"
                if group is GROUPS[5]:
                    meaning = f"landmarks in frame {which} of the film"
            self._keep(group, at, field.name, value)
        elif group is GROUPS[11] and place:
            name = f"{name}({place})"
        if name == "NGO" and value is not None:
            note = f"{note}  {_return_words(int(value))}"
        shown = "?" if value is None else f"{value:.12g}"
        columns = f"columns {item.first}-{item.last}"
        return f"   {columns:13}  {name:8} {shown:>12} {field.unit:10}  {meaning}{note}".rstrip()

    def _keep(self, group: Group, at: int, name: str, value: float | None) -> None:
        number = int(value or 0)
        if group is GROUPS[5] and at >= 3:
            self._per_frame[at - 3 :] = [number]
        else:
            self._counts[name] = number

    def _point(self) -> str:
        """What this card of the basic data reads: which point, which time."""
        row = self._row
        for frame, count in enumerate(self._per_frame, 1):
            size = FIDUCIAL_CARDS + 3 * count
            if row < size:
                point, reading = row // 3 + 1, row % 3 + 1
                what = f"fiducial {point}" if point <= 4 else f"landmark {point - 4} of {count}"
                return f"frame {frame} of the film, {what}, reading {reading}"
            row -= size
        return "beyond the frames that group 5 counts"


def _read(text: str, item: Item) -> tuple[float | None, str]:
    """The value of a field as the program reads it, and what to know about it."""
    column = read_column(np.frombuffer(text.encode("ascii"), np.uint8)[None], item)
    if column.bad[0]:
        return None, f"  (not a number: {text.strip()!r})"
    value = float(column.value[0])
    if column.doubtful[0]:
        return value, "  (blanks read as zeros)"
    if not text.strip():
        return value, "  (blank: zero)"
    implied = item.kind == "F" and item.decimals and "." not in text
    return value, f"  (point implied, {item.decimals} decimals)" if implied else ""


def _left_over(image: str, used: np.ndarray, group: Group) -> list[str]:
    """Columns that hold something and belong to no field; on the reader's cards that is usual."""
    punched = np.frombuffer(image.encode("ascii"), np.uint8) != BLANK
    if group is BASIC_DATA or not (punched & ~used).any():
        return []
    columns = np.flatnonzero(punched & ~used) + 1
    return [f"   columns {columns[0]}-{columns[-1]} hold something that is not read"]


def _return_words(ngo: int) -> str:
    if ngo == 13:
        return "(stop)"
    if not 1 <= ngo <= 12:
        return "(no return group)"
    again = "the basic data too" if ngo <= 2 else "the basic data stay"
    return f"(reading goes on at group {ngo}; {again})"
