"""Explain a deck: each card with its group, and the columns, values and meaning of its fields."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterator
from typing import BinaryIO

import numpy as np

from vopd.cards.deck import BLANK, CardBlock
from vopd.cards.format import (
    BASIC_DATA,
    GROUPS,
    CardField,
    CardGroup,
    FormatItem,
    format_items,
    group_of,
)
from vopd.cards.miscount import FIDUCIAL_CARDS
from vopd.cards.read import read_cards, read_jobs
from vopd.findings import InputError

Wanted = Callable[[int, int], bool]
"""Given a group's number and a card's number, says whether that card is to be explained."""


def explain_deck(file: BinaryIO, name: str, wanted: Wanted) -> Iterator[str]:
    """Explain the wanted cards of a deck, one text for each, in the order of reading.

    A field that cannot be read is shown with a note.

    Raises:
        InputError: where the deck cannot be read on, after the cards before.
    """
    taken: list[CardBlock] = []
    explainer = _Explainer()
    jobs = read_jobs(file, name, lambda _: None, on_cards=taken.append)
    error: InputError | None = None
    while error is None:
        try:
            job = next(jobs, None)
        except InputError as caught:
            job, error = None, caught
        for cards in taken:
            yield from explainer.explain(cards, wanted)
        taken.clear()
        if job is None:
            break
    if error is not None:
        raise error


FieldRead = tuple[float, bool, bool]
"""The number in a field, whether it is none, and whether it is doubtful, as in `FieldValues`."""


class _Explainer:
    """Explains cards in order, with the counts of the cards before them."""

    def __init__(self) -> None:
        self._counts: dict[str, int] = {}
        self._per_frame: list[int] = []
        self._group = -1
        self._row = 0
        self._frame_ends: list[int] = []  # cards of the basic data up to the end of each frame

    def explain(self, cards: CardBlock, wanted: Wanted) -> Iterator[str]:
        """Explain the wanted cards of one block, which comes after the blocks before."""
        number = cards.where.group or 0
        if number != self._group or self._is_over(number):
            self._group, self._row = number, 0
            sizes = FIDUCIAL_CARDS + 3 * np.array(self._per_frame, int)
            self._frame_ends = np.cumsum(sizes).tolist()
        group = group_of(number)
        shown = [wanted(number, cards.first + row) for row in range(len(cards))]
        fields: list[list[FieldRead]] = [[] for _ in shown]
        if group is not GROUPS[2] and (any(shown) or group.is_list):
            read = (part.tolist() for part in read_cards(cards, group))
            fields = [[*zip(*card, strict=True)] for card in zip(*read, strict=True)]
        for row in range(len(cards)):
            if shown[row] or group.is_list:  # a list says how many cards follow
                lines = self._card(cards, row, group, fields[row])
                if shown[row]:
                    yield "\n".join(lines)
            self._row += 1

    def _is_over(self, group: int, index: int = 0) -> bool:
        """Tell whether a field of this card comes after the last number of a list."""
        last = {5: 3 + self._counts.get("NFR", 0), 10: 1, 12: 1 + self._counts.get("NT", 0)}
        return group in last and self._row * 16 + index >= last[group]

    def _card(
        self, cards: CardBlock, row: int, group: CardGroup, fields: list[FieldRead]
    ) -> list[str]:
        """Explain one card, in lines."""
        image = cards.image(row)
        where = f"card {cards.first + row}, {group.label}: {group.title}"
        if group is BASIC_DATA:
            where += f", {self._point()}"
        lines = [where, "  |" + image.rstrip()]
        if group is GROUPS[2]:
            return [*lines, "   columns 1-80  TITLE   printed at the top of every page"]
        used: list[FormatItem] = []
        for index, (field, item) in enumerate(group.layout):
            text = image[item.first - 1 : item.last]
            blank = group.is_list and index and not text.strip()
            if blank or self._is_over(group.number, index):
                continue
            used.append(item)
            if field.name:
                lines.append(self._field(group, index, field, item, text, fields[index]))
        return lines + _left_over(image, used, group)

    def _field(
        self,
        group: CardGroup,
        index: int,
        field: CardField,
        item: FormatItem,
        text: str,
        read: FieldRead,
    ) -> str:
        """Explain one field of a card, in one line."""
        value, note = _noted(text, item, read)
        name, meaning = field.name, field.meaning
        if group.is_list:
            at = self._row * len(format_items(group.format)) + index
            field = group.fields[min(at, len(group.fields) - 1)]
            name, meaning = _list_words(group, field, at)
            self._keep(group, at, field.name, value)
        elif group is GROUPS[11] and index:
            name = f"{name}({index})"
        if name == "NGO" and value is not None:
            note = f"{note}  {_return_words(int(value))}"
        shown = "?" if value is None else f"{value:.12g}"
        columns = f"columns {item.first}-{item.last}"
        return f"   {columns:13}  {name:8} {shown:>12} {field.unit:10}  {meaning}{note}".rstrip()

    def _keep(self, group: CardGroup, at: int, name: str, value: float | None) -> None:
        """Remember a count of a list, which says how many cards follow."""
        number = int(value or 0)
        if group is GROUPS[5] and at >= 3:
            self._per_frame[at - 3 :] = [number]
        else:
            self._counts[name] = number

    def _point(self) -> str:
        """Name the point on this card of the basic data, and which of its three readings it is."""
        frame = bisect_right(self._frame_ends, self._row)
        count = self._per_frame[frame]
        row = self._row - self._frame_ends[frame] + FIDUCIAL_CARDS + 3 * count
        point, reading = row // 3 + 1, row % 3 + 1
        what = f"fiducial {point}" if point <= 4 else f"landmark {point - 4} of {count}"
        return f"frame {frame + 1} of the film, {what}, reading {reading}"


def _list_words(group: CardGroup, field: CardField, at: int) -> tuple[str, str]:
    """Name and meaning of number `at`, from 0, of a group that is a list."""
    which = at - len(group.fields) + 2
    if which < 1 or len(group.fields) == 1:
        return field.name, field.meaning
    meaning = f"landmarks in frame {which} of the film" if group is GROUPS[5] else field.meaning
    return f"{field.name}({which})", meaning


def _noted(text: str, item: FormatItem, read: FieldRead) -> tuple[float | None, str]:
    """Add a note to the number in a field; None where it is none."""
    value, unreadable, doubtful = read
    if unreadable:
        return None, f"  (not a number: {text.strip()!r})"
    if doubtful:
        digits = any(map(str.isdigit, text))
        return value, "  (blanks read as zeros)" if digits else "  (a number without digits)"
    if not text.strip():
        return value, "  (blank: zero)"
    implied = item.kind == "F" and item.decimals and "." not in text
    return value, f"  (point implied, {item.decimals} decimals)" if implied else ""


def _left_over(image: str, used: list[FormatItem], group: CardGroup) -> list[str]:
    """Note columns that hold something and belong to no field; usual on the reader's cards."""
    if group is BASIC_DATA:
        return []
    free = np.frombuffer(image.encode("ascii"), np.uint8) != BLANK
    for item in used:
        free[item.first - 1 : item.last] = False
    columns = np.flatnonzero(free) + 1
    if not len(columns):
        return []
    return [f"   columns {columns[0]}-{columns[-1]} hold something that is not read"]


def _return_words(ngo: int) -> str:
    if ngo == 13:
        return "(stop)"
    if not 1 <= ngo <= 12:
        return "(not a return group)"
    again = "the basic data too" if ngo <= 2 else "the basic data stay"
    return f"(reading goes on at group {ngo}; {again})"
