"""The film reader's cards: three readings of every point of every frame.

A frame is twelve cards of fiducials (four, each read three times) and three
of each landmark (TM X-3050, Appendix E; listing A 84 to A 104).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vopd.arrays import Ints
from vopd.cards.card import CardDeck, Cards
from vopd.cards.formats import items
from vopd.cards.groups import BASIC_DATA
from vopd.cards.numbers import read_column
from vopd.cards.table import read_table, whole
from vopd.findings import Finding, Report
from vopd.job import Readings

FIDUCIAL_CARDS = 12
CHUNK = 24_000  # cards read at a time
_LANDMARK, _X, _Y, _FRAME = items(BASIC_DATA.format)
_HINT = "does group 5 count this frame's landmarks rightly?"


def read_basic_data(
    deck: CardDeck, landmarks_per_frame: Ints, defined: Ints, report: Report
) -> Readings:
    """Read the basic data of frames that have so many landmarks each.

    `defined` are the landmark numbers that group 9 has given so far.
    """
    parts: list[Readings] = []
    width = int(landmarks_per_frame.max())
    for counts in _chunks(landmarks_per_frame):
        cards = deck.take(int((FIDUCIAL_CARDS + 3 * counts).sum()), BASIC_DATA.number)
        parts.append(_read_frames(cards, counts, width, defined, report))
    _look_for_more(deck, int(parts[-1].frame[-1]), int(landmarks_per_frame[-1]), report)
    first_card: dict[int, Finding] = {}
    for part in reversed(parts):
        first_card |= part.first_card
    return Readings(
        frame=np.concatenate([part.frame for part in parts]),
        fiducial_in=np.concatenate([part.fiducial_in for part in parts]),
        landmark=np.concatenate([part.landmark for part in parts]),
        present=np.concatenate([part.present for part in parts]),
        landmark_in=np.concatenate([part.landmark_in for part in parts]),
        first_card=first_card,
    )


def _chunks(counts: Ints) -> list[Ints]:
    """Frames in runs of about `CHUNK` cards."""
    run = np.cumsum(FIDUCIAL_CARDS + 3 * counts) // CHUNK
    return np.split(counts, np.flatnonzero(np.diff(run)) + 1)


def _read_frames(cards: Cards, counts: Ints, width: int, defined: Ints, report: Report) -> Readings:
    table = read_table(cards, BASIC_DATA, report)
    number, frame = whole(table["ISAVE"]), whole(table["IFRAM"])
    xy = np.stack([table["XSAVE"], table["YSAVE"]], axis=1)
    sizes = FIDUCIAL_CARDS + 3 * counts
    ends = np.cumsum(sizes)
    starts = ends - sizes
    fiducial_rows = starts[:, None] + np.arange(FIDUCIAL_CARDS)
    is_fiducial = np.zeros(len(cards), bool)
    is_fiducial[fiducial_rows] = True
    readings = np.flatnonzero(~is_fiducial).reshape(-1, 3)  # (landmark, reading), in order

    _check_frames(cards, frame, starts, sizes, report)
    _check_numbers(cards, number, fiducial_rows.ravel(), readings, report)

    present = np.arange(width) < counts[:, None]
    landmark = np.zeros((len(counts), width), np.int64)
    landmark[present] = number[readings[:, 2]]  # the third reading names it
    landmark_in = np.zeros((len(counts), width, 3, 2))
    landmark_in[present] = xy[readings]
    return Readings(
        frame=frame[ends - 1],
        fiducial_in=xy[fiducial_rows].reshape(-1, 4, 3, 2),
        landmark=landmark,
        present=present,
        landmark_in=landmark_in,
        first_card=_first_cards(cards, number[readings[:, 0]], readings[:, 0], defined),
    )


def _check_frames(cards: Cards, frame: Ints, starts: Ints, sizes: Ints, report: Report) -> None:
    """All cards of a frame must name it; the odd one out is told."""
    whose = np.repeat(frame[starts + sizes - 1], sizes)
    wrong = np.flatnonzero(frame != whose)
    for k in sorted({int(k) for k in np.searchsorted(starts, wrong, side="right") - 1}):
        own = frame[starts[k] : starts[k] + sizes[k]]
        usual = _usual(own.tolist())
        row = int(starts[k] + (own != usual).argmax())
        message = f"frame {frame[row]} among the cards of frame {usual}; {_HINT}"
        report(cards.finding(row, message, "frame number", (_FRAME.first, _FRAME.last)))


def _usual(numbers: list[int]) -> int:
    """The most frequent of some numbers, the least of several."""
    return min(numbers, key=lambda number: (-numbers.count(number), number))


def _check_numbers(
    cards: Cards, number: Ints, fiducials: Ints, readings: Ints, report: Report
) -> None:
    """The three readings of a landmark must agree on its number; fiducials should have 0."""
    place = "landmark number", (_LANDMARK.first, _LANDMARK.last)
    for row in fiducials[number[fiducials] != 0]:
        message = f"landmark {number[row]} where a fiducial is expected; {_HINT}"
        report(cards.finding(int(row), message, *place).warned())
    three = number[readings]
    for rows in readings[(three != three[:, 2:]).any(axis=1)]:
        first, second, third = number[rows]
        odd = rows[0] if second == third else rows[1] if first == third else rows[2]
        message = f"three readings of one landmark are numbered {first}, {second}, {third}; {_HINT}"
        report(cards.finding(int(odd), message, *place))


def _first_cards(cards: Cards, number: Ints, rows: Ints, defined: Ints) -> dict[int, Finding]:
    """Where each landmark that group 9 has not defined is first read."""
    undefined = np.flatnonzero(~np.isin(number, defined))
    first = {int(number[k]): k for k in reversed(undefined)}
    return {
        n: cards.finding(
            int(rows[k]),
            f"landmark {n} is not defined in group 9",
            "landmark number",
            (_LANDMARK.first, _LANDMARK.last),
        )
        for n, k in sorted(first.items())
    }


def _look_for_more(deck: CardDeck, frame: int, count: int, report: Report) -> None:
    """A further landmark card of the last frame: group 5 counted too few."""
    card = deck.next_card(BASIC_DATA.number)
    if not len(card):
        return
    fields = [read_column(card.columns(i.first, i.last), i) for i in items(BASIC_DATA.format)]
    punched = [card.columns(i.first, i.last) for i in (_X, _Y, _FRAME)]
    if any(field.bad[0] for field in fields) or any((text == 32).all() for text in punched):
        return
    if fields[3].value[0] == frame and fields[0].value[0] != 0:
        message = f"group 5 counts {count} landmarks for frame {frame}, and here is one more"
        finding = card.finding(0, message, "frame number", (_FRAME.first, _FRAME.last))
        report(replace(finding, severity="error"))
