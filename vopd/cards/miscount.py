"""A group of control cards with a card too few or too many, or a count that is wrong.

Program VOPD takes as many cards for a group as the counts say. After one card too few or too
many, every later card is read under the FORMAT of another group, and the first number that
makes no sense there is far from the cause. So each group is tried with every other number of
cards: with the right one, the cards after it fit the FORMATs of their own groups again.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.cards.deck import BLANK, Bytes, CardBlock
from vopd.cards.format import BASIC_DATA, GROUPS, CardGroup, FormatItem, format_items
from vopd.cards.numbers import read_field
from vopd.cards.text import COLUMNS
from vopd.findings import Finding, InputError, count_text

LENS_CARDS = 25
FIDUCIAL_CARDS = 12
_LANDMARK, _X, _Y, _FRAME = format_items(BASIC_DATA.format)
COUNTED_BY = {4: (3, "IWV"), 6: (5, "NTFR"), 7: (3, "III"), 9: (5, "NT"), 11: (10, "NOUT")}
"""The group whose card counts the cards of a group, and the field that does."""
FEWER, MORE = 300, 100  # cards than counted that a group is tried with; and up to FEWER cards
CLEARLY = 2.0  # fields that fit better: less is no proof of a wrong number of cards
CLEARLY_EXTRA = 1.0  # the same where the card too many is blank, or repeats the one before it
MOST_ODD = 4.0  # fields that fit nowhere, with the right number of cards


class Miscount(InputError):
    """A group has a card too few or too many; the cards after it were read as other groups'."""

    def before(self, findings: list[Finding]) -> list[Finding]:
        """Keep the findings about cards before the cause: those after it were read wrongly."""
        first = self.finding.card or 0
        return [one for one in findings if one.card is None or one.card < first]


def find_miscount(text: Bytes, first_card: int, start: int, name: str) -> Finding | None:
    """Find the group that has a card too few or too many, if that explains the cards.

    Args:
        text: control cards and at least twelve cards of basic data (cards, at most 80)
        first_card: number of the first of them in the deck
        start: the group it belongs to, 1 or 2
        name: the deck's name, for the finding
    """
    cards = _Cards(text, start)
    as_counted = cards.deal()
    trials = [
        cards.deal(group, number)
        for group in range(start, 13)
        for number in _other_numbers(as_counted.counted.get(group, 0))
    ]
    best = min(trials, key=lambda one: one.odd)
    extra = cards.extra(best)
    clearly = CLEARLY_EXTRA if len(extra) == 1 else CLEARLY
    if best.odd > MOST_ODD or as_counted.odd - best.odd < clearly:
        return None
    return _finding(cards, best, first_card, name)


def looks_like_basic_data(text: Bytes) -> Bools:
    """Mark cards (cards, at most 80) that hold a reading of the film (cards,)."""
    text = _padded(text)
    number, x, y, frame = (text[:, i.first - 1 : i.last] for i in (_LANDMARK, _X, _Y, _FRAME))
    whole = FormatItem("I", 1, 4)
    real = FormatItem("F", 1, 7, 3)
    unpunched = (number == BLANK).all(axis=1)
    return np.asarray(
        (_well_formed(number, whole) > 0) & ~unpunched
        & (_well_formed(x, real) > 0) & (_well_formed(y, real) > 0)
        & (_well_formed(frame, whole) > 0)
    )  # fmt: skip


class _Deal(NamedTuple):
    """The control cards dealt to the groups, one of which may differ from its count."""

    odd: float  # how many fields do not fit
    group: int  # the group with another number of cards than counted; 0 for none
    number: int  # how many cards it has
    first: dict[int, int]  # index of the first card of each group
    counted: dict[int, int]  # how many cards of each group are counted


class _Cards:
    """Control cards, and how badly each would fit every group."""

    def __init__(self, text: Bytes, start: int) -> None:
        self.text = _padded(text)
        self.start = start
        film = looks_like_basic_data(self.text)
        blank = (self.text == BLANK).all(axis=1)
        self.blank = blank
        self.odd = {}
        for number, group in GROUPS.items():
            odd = np.where(blank, np.minimum(1.0, _odd(self.text, group)), _odd(self.text, group))
            self.odd[number] = odd + 2.0 * film
        self._total = {n: np.append(0.0, np.cumsum(odd)) for n, odd in self.odd.items()}
        self._not_film = np.append(0, np.cumsum(~film))
        self._values: dict[tuple[int, str], list[int]] = {}

    def deal(self, group: int = 0, number: int = 0) -> _Deal:
        """Deal the cards by their counts, but so many to one group."""
        at, odd = 0, 0.0
        first: dict[int, int] = {}
        counted: dict[int, int] = {}
        for one in range(self.start, 13):
            first[one] = at
            counted[one] = self._counted(one, at, first, group, number)
            end = at + (number if one == group else counted[one])
            if end > len(self.text):
                return _Deal(np.inf, group, number, first, counted)
            odd += self._total[one][end] - self._total[one][at]
            odd += self._first_card(one, at) if end > at else 0.0
            at = end
        after = min(at + FIDUCIAL_CARDS, len(self.text))
        odd += self._not_film[after] - self._not_film[at] + FIDUCIAL_CARDS - (after - at)
        return _Deal(odd, group, number, first, counted)

    def _counted(self, group: int, at: int, first: dict[int, int], dealt: int, number: int) -> int:
        """Count the cards of a group by the card that counts them; if it is absent, by looks.

        Args:
            group: whose cards are counted
            at: its first card
            first: the first cards of the groups before it
            dealt: the group that is dealt another number of cards
            number: that number
        """
        absent = dealt if number == 0 else 0
        landmarks = number if dealt == 9 else self.value(5, "NT", first[5]) if group > 9 else 0
        if group == 1:
            return LENS_CARDS
        if group in COUNTED_BY:
            by, name = COUNTED_BY[group]
            if by != absent:
                return self.value(by, name, first[by])
            like = int(np.argmax(np.append(self.odd[group][at:] > 0, 1)))
            film = int(np.argmax(np.append(np.diff(self._not_film[at:]) == 0, 1)))
            return max(0, min(like, film + (1 + landmarks) // -16)) if group == 11 else like
        if group == 5:
            return -(-(3 + self.value(5, "NFR", at)) // 16)
        if group == 12 and absent != 5:
            return -(-(1 + landmarks) // 16)
        return 1

    def value(self, group: int, name: str, row: int) -> int:
        """Read the whole number of a count; 0 where it is none."""
        if (group, name) not in self._values:  # of all cards: many deals ask for the same ones
            names = [field.name for field in GROUPS[group].fields]
            item = format_items(GROUPS[group].format)[names.index(name)]
            read = read_field(self.text[:, item.first - 1 : item.last], item)
            number = np.where(read.unreadable, 0.0, np.clip(read.value, 0.0, 1e6))
            self._values[group, name] = number.astype(int).tolist()
        values = self._values[group, name]
        return values[row] if row < len(values) else 0

    def extra(self, deal: _Deal) -> list[int]:
        """List the cards too many of a group, if they are blank or repeat those before them."""
        many = deal.number - deal.counted.get(deal.group, 0)
        rows = range(deal.first.get(deal.group, 0), deal.first.get(deal.group, 0) + deal.number)
        blank = [row for row in rows if self.blank[row]]
        twice = [row for row in rows[1:] if (self.text[row] == self.text[row - 1]).all()]
        return next((found for found in (blank, twice) if len(found) == many > 0), [])

    def _first_card(self, group: int, row: int) -> float:
        """Count odd fields of the first card of a list, which its further cards do not have."""
        if group == 5:
            return sum(self.value(5, name, row) < 1 for name in ("NT", "NFR", "NTFR"))
        return float(group == 12 and not 1 <= self.value(12, "NGO", row) <= 13)


def _other_numbers(counted: int) -> list[int]:
    near = range(max(0, counted - FEWER), counted + MORE + 1)
    return [n for n in (*range(min(near.start, FEWER)), *near) if n != counted]


def _padded(text: Bytes) -> Bytes:
    padded = np.full((len(text), COLUMNS), BLANK, np.uint8)
    padded[:, : text.shape[1]] = text
    return padded


def _odd(text: Bytes, group: CardGroup) -> Floats:
    """Count the fields of each card that do not fit a group; a doubtful one counts in part."""
    if group is GROUPS[2]:
        letter = ((text & 0xDF) >= ord("A")) & ((text & 0xDF) <= ord("Z"))
        return np.asarray(np.where(letter.any(axis=1), 0.0, 1.0))
    odd = np.zeros(len(text))
    free = np.arange(COLUMNS) < 72  # sequence numbers stand beyond
    for k, (field, item) in enumerate(group.layout):
        if group is GROUPS[10] and k:
            break
        free[item.first - 1 : item.last] = False
        part = text[:, item.first - 1 : item.last]
        blank = (part == BLANK).all(axis=1)
        if not field.name:  # where group 7, of the same FORMAT, has an altitude
            odd += np.where(blank, 0.0, 0.5)
            continue
        fills = group.is_list or k >= len(group.fields)  # a list of numbers may end before its card
        odd += np.where(blank, 0.0 if fills else 0.25, 1.0 - _well_formed(part, item))
    return np.asarray(odd + (text[:, free] != BLANK).any(axis=1))


def _well_formed(part: Bytes, item: FormatItem) -> Floats:
    """Rate fields that are not blank: 1 for a number as usually punched, 0 for anything else.

    A whole number ends in the last column. A real number has a point; without one it counts
    half, because it may be a whole number of another group.
    """
    digit = (part >= ord("0")) & (part <= ord("9"))
    sign = (part == ord("-")) | (part == ord("+"))
    point = part == ord(".")
    blank = part == BLANK
    starts = ~blank & np.concatenate([np.ones((len(part), 1), bool), blank[:, :-1]], axis=1)
    one = (starts.sum(axis=1) == 1) & digit.any(axis=1) & ~(sign & ~starts).any(axis=1)
    one &= (digit | sign | blank | point).all(axis=1)
    points = point.sum(axis=1)
    whole = one & (points == 0) & digit[:, -1]
    if item.kind == "I":
        return np.asarray(whole, float)
    return np.asarray(np.where(one & (points == 1), 1.0, np.where(whole, 0.5, 0.0)))


def _finding(cards: _Cards, best: _Deal, first_card: int, name: str) -> Finding:
    """Name the group, the card and the count that do not agree, and the remedy."""
    group, number, counted = best.group, best.number, best.counted[best.group]
    at = best.first[group]

    def finding(row: int, message: str) -> Finding:
        return Finding(message, name, first_card + row, group=group)

    count = f"{count_text(counted, 'card is', 'cards are')} needed"
    if by := COUNTED_BY.get(group):
        count = f"{by[1]} of group {by[0]} (card {first_card + best.first[by[0]]}) counts {counted}"
    if number > counted:
        if extra := cards.extra(best):
            blank = "a blank card; take it out" if cards.blank[extra[0]] else ""
            return finding(extra[0], blank or _repeats(first_card + extra[0] - 1))
        message = f"{count_text(number - counted, 'card')} too many: {count}, and card "
        message += f"{first_card + at + counted} looks like this group too; "
        out = "take out what is too many"
        return finding(at + counted, message + (f"count {number}, or {out}" if by else out))
    later = (n for n in range(group + 1, 13) if n != 11 or best.counted[11])
    after = next(later, 0)
    like = f"group {after}, {GROUPS[after].title}" if after else "a reading of the film"
    row = at + number
    if number == 0 and not by:
        message = f"the card of this group ({GROUPS[group].title}) seems to be missing before "
        return finding(row, f"{message}this one, which looks like {like}; put it in")
    message = f"{count_text(counted - number, 'card')} short: {count}, and card "
    message += f"{first_card + row} looks like {like}; put in what is missing"
    return finding(row, message + (f", or count {number}" if by else ""))


def _repeats(card: int) -> str:
    return f"this card repeats card {card}; take it out"


# The readings of the film: a card too few or too many in one frame

READINGS = 3  # of a point
ONE_POINT_IN = 1.0  # inches between readings: fiducials are farther apart, and readings nearer


def _odd_fiducial(x_in: Floats, y_in: Floats) -> tuple[int, int, int] | None:
    """Find which of four fiducials has not three readings.

    Args:
        x_in: of the readings of a frame's fiducials, in order
        y_in: likewise

    Returns:
        Its number, its readings, and where its cards end, counted from the frame's first; None
        where the places do not tell.
    """
    steps = np.hypot(np.diff(x_in), np.diff(y_in))
    ends = [*(np.flatnonzero(steps > ONE_POINT_IN) + 1).tolist(), len(x_in)]
    readings = np.diff([0, *ends]).tolist()
    odd = [k for k, count in enumerate(readings) if count != READINGS]
    if len(ends) != FIDUCIAL_CARDS // READINGS or len(odd) != 1:
        return None
    return odd[0] + 1, readings[odd[0]], ends[odd[0]]


def find_odd_reading(cards: CardBlock, landmarks_per_frame: Ints) -> Finding | None:
    """Find the blank, repeated or missing card after which the frames of a film are out of step.

    A frame with three cards too few or too many has a landmark that is not counted, which is no
    matter of one card.

    Args:
        cards: the basic data, from the first card of a frame on
        landmarks_per_frame: how many landmarks group 5 counts in each frame (F,)
    """
    if not len(cards):
        return None
    text = cards.columns(1, COLUMNS)
    field = ("landmark number", (_LANDMARK.first, _LANDMARK.last))
    for row in np.flatnonzero((text == BLANK).all(axis=1)).tolist():
        return cards.finding(row, "a blank card; take it out", "", (1, COLUMNS))
    number, x, y, frame = (
        read_field(text[:, i.first - 1 : i.last], i).value for i in (_LANDMARK, _X, _Y, _FRAME)
    )
    ends = np.append(np.flatnonzero(np.diff(frame)) + 1, len(frame))
    at = 0
    for count, end in zip(landmarks_per_frame.tolist(), ends.tolist(), strict=False):
        size, have = FIDUCIAL_CARDS + 3 * count, end - at
        ahead = slice(end, end + FIDUCIAL_CARDS - 1)
        of_next = (number[ahead] == 0) & (frame[ahead] == frame[min(end, len(frame) - 1)])
        if have != size and (abs(have - size) > 2 or not of_next.all()):
            return None
        if end == len(frame) and have < size and len(set(number[at:end][-3:])) > 1:
            return None  # the deck ends in the readings of a landmark
        breaks = at + np.append(0, np.flatnonzero(np.diff(number[at:end])) + 1)
        for first, last in zip(breaks.tolist(), [*breaks[1:].tolist(), end], strict=True):
            readings, usual = last - first, 3 if number[first] else FIDUCIAL_CARDS
            if readings % usual == 1:
                for one in range(first + 1, last):
                    if (text[one] == text[one - 1]).all():
                        return cards.finding(one, _repeats(cards.first + one - 1), *field)
            if readings % usual and have != size:
                of = f"landmark {number[first]:.0f} has" if number[first] else "the fiducials have"
                point = _odd_fiducial(x[first:last], y[first:last]) if not number[first] else None
                if point is not None:
                    fiducial, readings, behind = point
                    of, usual, last = f"fiducial {fiducial} has", READINGS, first + behind
                message = f"{of} {count_text(readings, 'reading')} in frame {frame[at]:.0f}, not "
                return cards.finding(last - 1, f"{message}{usual}", *field)
        at = end
    return None
