"""Read the basic data: three readings of every point of every frame."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats, Ints, among
from vopd.cards.card_block import CardBlock
from vopd.cards.deck import CardDeck
from vopd.cards.format import BASIC_DATA
from vopd.cards.formats import format_items
from vopd.cards.group_table import Reading, read_table, whole
from vopd.cards.numbers import read_field
from vopd.findings import DeckError, Finding, Report
from vopd.job import LandmarkReadings, Readings
from vopd.landmark_layout import LandmarkLayout

FIDUCIAL_CARDS = 12
CARDS_AT_A_TIME = 24_000
POINT_CARDS = 3  # cards of another frame that show a wrong count, and not a mispunched number
_LANDMARK, _X, _Y, _FRAME = format_items(BASIC_DATA.format)
_LANDMARK_FIELD = "landmark number", (_LANDMARK.first, _LANDMARK.last)
_FRAME_FIELD = "frame number", (_FRAME.first, _FRAME.last)


class FramesRead(NamedTuple):
    """Some frames of the basic data, as read: F frames, N landmarks in the order of the deck.

    Only what the cards hold takes memory, not what group 5 counts.
    """

    frame: Ints  # (F,)
    fiducial_in: Floats  # (F, 4, 3, 2)
    landmark: Ints  # (N,)
    landmark_in: Floats  # (N, 3, 2)
    first_card: dict[int, Finding]  # where each undefined landmark is first read


def read_basic_data(
    deck: CardDeck, landmarks_per_frame: Ints, defined: Ints, report: Report
) -> Reading[Readings]:
    """Read the basic data of a deck.

    Args:
        deck: the deck, which has come to the first card of the basic data
        landmarks_per_frame: how many landmarks group 5 counts in each frame (F,)
        defined: the landmark numbers that group 9 has defined so far
        report: is given the findings

    Returns:
        The readings of all frames.

    Raises:
        DeckError: where the cards contradict the counts, so that the next frame cannot be found,
            or where the deck ends early.
    """
    parts: list[FramesRead] = []
    for counts in _portions(landmarks_per_frame):
        cards = deck.take(int((FIDUCIAL_CARDS + 3 * counts).sum()), BASIC_DATA.number)
        part = yield from _read_frames(cards, counts, defined, report)
        parts.append(part)
    _look_for_more(deck, int(parts[-1].frame[-1]), int(landmarks_per_frame[-1]), report)
    first_card: dict[int, Finding] = {}
    for part in reversed(parts):
        first_card |= part.first_card
    return Readings(
        LandmarkLayout(landmarks_per_frame),
        LandmarkReadings(
            landmark=np.concatenate([part.landmark for part in parts]),
            landmark_in=np.concatenate([part.landmark_in for part in parts]),
        ),
        frame=np.concatenate([part.frame for part in parts]),
        fiducial_in=np.concatenate([part.fiducial_in for part in parts]),
        first_card=first_card,
    )


def _portions(counts: Ints) -> list[Ints]:
    """The counts of as many frames at a time as have about `CARDS_AT_A_TIME` cards."""
    portion = np.cumsum(FIDUCIAL_CARDS + 3 * counts) // CARDS_AT_A_TIME
    return np.split(counts, np.flatnonzero(np.diff(portion)) + 1)


def _read_frames(
    cards: CardBlock, counts: Ints, defined: Ints, report: Report
) -> Reading[FramesRead]:
    """Read frames from their cards, as far as there are cards."""
    if cards.stopped_by is not None:
        _check_counts_so_far(cards, counts, report)
    table = yield from read_table(cards, BASIC_DATA, report)
    number, frame = whole(table["ISAVE"]), whole(table["IFRAM"])
    xy = np.stack([table["XSAVE"], table["YSAVE"]], axis=1)
    sizes = FIDUCIAL_CARDS + 3 * counts
    ends = np.cumsum(sizes)
    starts = ends - sizes
    fiducial_rows = starts[:, None] + np.arange(FIDUCIAL_CARDS)
    is_fiducial = np.zeros(len(cards), bool)
    is_fiducial[fiducial_rows] = True
    reading_rows = np.flatnonzero(~is_fiducial).reshape(-1, 3)  # (landmark, reading), in order

    _check_frames(cards, frame, starts, counts, report)
    _check_numbers(cards, number, fiducial_rows.ravel(), reading_rows, report)
    return FramesRead(
        frame=frame[ends - 1],
        fiducial_in=xy[fiducial_rows].reshape(-1, 4, 3, 2),
        landmark=number[reading_rows[:, 2]],  # the third reading counts
        landmark_in=xy[reading_rows],
        first_card=_first_cards(cards, number[reading_rows[:, 0]], reading_rows[:, 0], defined),
    )


def _check_counts_so_far(cards: CardBlock, counts: Ints, report: Report) -> None:
    """Where the deck ends too early, look for the frame whose count is the reason."""
    column = read_field(cards.columns(_FRAME.first, _FRAME.last), _FRAME)
    starts = np.cumsum(FIDUCIAL_CARDS + 3 * counts) - (FIDUCIAL_CARDS + 3 * counts)
    begun = starts < len(cards)
    _check_frames(cards, whole(column.value), starts[begun], counts[begun], report, odd_ones=False)


def _check_frames(
    cards: CardBlock,
    frame: Ints,
    starts: Ints,
    counts: Ints,
    report: Report,
    *,
    odd_ones: bool = True,
) -> None:
    """Compare the frame numbers of each frame's cards, which must all be the same.

    One or two odd cards are reported as mispunched, if `odd_ones` asks for it. Three make a
    point, so that a count must be wrong: reading cannot go on. Raises `DeckError` then.
    """
    ends = np.minimum(starts + FIDUCIAL_CARDS + 3 * counts, len(frame))
    whose = np.repeat(frame[ends - 1], ends - starts)
    different = np.flatnonzero(frame[: len(whose)] != whose)
    if not len(different):
        return
    for k in sorted(set((np.searchsorted(starts, different, side="right") - 1).tolist())):
        own = frame[starts[k] : ends[k]]
        usual = _most_frequent(own)
        if np.count_nonzero(own != usual) >= POINT_CARDS:
            before = int(frame[starts[k] - 1]) if k else None
            row, message = _wrong_count(own, int(counts[k]), before)
            if before == own[0]:
                message += f", for which group 5 counts {counts[k - 1]} landmarks"
            finding = cards.finding(int(starts[k]) + row, message, *_FRAME_FIELD)
            report(finding)
            raise DeckError(finding)
        if odd_ones:
            row = int((own != usual).argmax())
            message = f"frame {own[row]} among the cards of frame {usual}"
            report(cards.finding(int(starts[k]) + row, message, *_FRAME_FIELD))


def _wrong_count(own: Ints, count: int, before: int | None) -> tuple[int, str]:
    """Index of the first card that shows a wrong count of group 5, and what is wrong."""
    if own[0] == before:
        return 0, f"a further card of frame {before}"
    row = int((own != own[0]).argmax())
    landmarks = "1 landmark" if count == 1 else f"{count} landmarks"
    return row, f"a card of frame {own[row]}, where group 5 counts {landmarks} for frame {own[0]}"


def _most_frequent(numbers: Ints) -> int:
    """The most frequent of some numbers; the smallest of several."""
    values, times = np.unique(numbers, return_counts=True)
    return int(values[times.argmax()])


def _check_numbers(
    cards: CardBlock, number: Ints, fiducials: Ints, readings: Ints, report: Report
) -> None:
    """The three readings of a landmark must agree on its number; fiducials should have 0."""
    for row in fiducials[number[fiducials] != 0]:
        message = f"landmark {number[row]} on a card that should be a fiducial's (00)"
        report(cards.finding(int(row), message, *_LANDMARK_FIELD).warned())
    three = number[readings]
    for rows in readings[(three != three[:, 2:]).any(axis=1)]:
        first, second, third = number[rows]
        odd = rows[0] if second == third else rows[1] if first == third else rows[2]
        message = f"three readings of one landmark are numbered {first}, {second}, {third}"
        report(cards.finding(int(odd), message, *_LANDMARK_FIELD))


def _first_cards(cards: CardBlock, number: Ints, rows: Ints, defined: Ints) -> dict[int, Finding]:
    """Where each landmark that group 9 has not defined is first read."""
    undefined = np.flatnonzero(~among(number, defined))
    if not len(undefined):
        return {}
    found, at = np.unique(number[undefined], return_index=True)
    return {
        int(n): cards.finding(
            int(rows[undefined[k]]), f"landmark {n} is not defined in group 9", *_LANDMARK_FIELD
        )
        for n, k in zip(found, at, strict=True)
    }


def _look_for_more(deck: CardDeck, frame: int, count: int, report: Report) -> None:
    """Report a further landmark card of the last frame: group 5 counts too few landmarks."""
    card = deck.next_card(BASIC_DATA.number)
    if not len(card):
        return
    items = format_items(BASIC_DATA.format)
    fields = [read_field(card.columns(item.first, item.last), item) for item in items]
    punched = [card.columns(item.first, item.last) for item in (_X, _Y, _FRAME)]
    if any(field.unreadable[0] for field in fields) or any((text == 32).all() for text in punched):
        return
    if fields[3].value[0] == frame and fields[0].value[0] != 0:
        message = f"group 5 counts {count} landmarks for frame {frame}, and here is one more"
        report(replace(card.finding(0, message, *_FRAME_FIELD), severity="error"))
