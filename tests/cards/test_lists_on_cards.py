"""The lists of groups 5 and 12, sixteen numbers to a card, at every number that fills a card."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest

import vopd
from tests.kit.command import CASE_1
from vopd.cards.deck import CardBlock
from vopd.cards.read import read_jobs
from vopd.findings import Finding, InputError
from vopd.job import Job, Readings

(JOB,) = vopd.read_deck(CASE_1)
GROUP_5, AFTER_GROUP_5 = 30, 12
"""Index of the first card of group 5, and how many cards groups 6 to 10 have after it."""


def stack(frames: int, landmarks: int) -> Job:
    """Case 1 with so many frames, and so many landmarks in group 9."""
    r, marks = JOB.readings, JOB.landmarks
    more = landmarks - len(marks.number)
    columns = ("longitude_deg", "longitude_min", "latitude_deg", "latitude_min", "altitude_ft")
    return replace(
        JOB,
        readings=Readings.of(
            np.arange(frames) + 1,
            *(
                np.repeat(a, frames, axis=0)
                for a in (r.fiducial_in, r.landmark, r.present, r.landmark_in)
            ),
        ),
        landmarks=replace(
            marks,
            number=np.append(marks.number, np.arange(1, more + 1)),
            **{name: np.append(getattr(marks, name), np.zeros(more)) for name in columns},
        ),
        ignored=replace(JOB.ignored, everywhere=np.zeros(landmarks, np.int64)),
    )


@pytest.mark.parametrize("landmarks", [14, 15, 16, 31, 32])
@pytest.mark.parametrize("frames", [12, 13, 14, 29, 30])
def test_a_list_takes_the_cards_that_it_fills(frames: int, landmarks: int) -> None:
    """Group 5 has three numbers and one for each frame, group 12 one and one for each landmark."""
    job = stack(frames, landmarks)
    cards = vopd.write_deck([job]).splitlines()
    of_5, of_12 = 1 + (frames + 2) // 16, 1 + landmarks // 16
    read: list[CardBlock] = []
    deck = io.BytesIO("\n".join(cards).encode())
    (back,) = read_jobs(deck, "deck", on_cards=read.append)
    assert back == job
    count = {group: sum(len(one) for one in read if one.where.group == group) for group in (5, 12)}
    assert count == {5: of_5, 12: of_12}
    assert len(cards) == GROUP_5 + of_5 + 2 + 4 + 1 + landmarks + 1 + of_12 + 21 * frames


@pytest.mark.parametrize(
    ("column", "questioned"), [(1, True), (16, True), (21, False), (26, False)]
)
def test_numbers_behind_the_end_of_a_list_are_not_questioned(column: int, questioned: bool) -> None:
    """Case 1 has three counts and one frame: the fourth number of group 5 is the last.

    Each is questioned once: three landmarks are defined, and the frame has three.
    """
    cards = CASE_1.read_text().splitlines()
    card = cards[GROUP_5].ljust(80)
    cards[GROUP_5] = card[: column - 1] + "  0 3" + card[column + 4 :]
    found: list[Finding] = []
    (back,) = read_jobs(io.BytesIO("\n".join(cards).encode()), "deck", found.append)
    assert back == JOB
    assert [(one.card, one.columns) for one in found] == (
        [(GROUP_5 + 1, (column, column + 4))] if questioned else []
    )


@pytest.mark.parametrize(("column", "questioned"), [(1, True), (16, True), (21, False)])
def test_the_list_of_group_12_too(column: int, questioned: bool) -> None:
    """A return group and three landmarks."""
    cards = CASE_1.read_text().splitlines()
    at = next(k for k, card in enumerate(cards) if card[:5] == "   13" and k > GROUP_5)
    card = cards[at].ljust(80)
    cards[at] = card[: column - 1] + ("0 013" if column == 1 else "  0 0") + card[column + 4 :]
    found: list[Finding] = []
    (back,) = read_jobs(io.BytesIO("\n".join(cards).encode()), "deck", found.append)
    assert back == JOB
    assert [(one.card, one.columns) for one in found] == (
        [(at + 1, (column, column + 4))] if questioned else []
    )


@pytest.mark.parametrize(
    ("group", "card", "field"),
    [
        (5, 0, "number of landmarks (group 9)"),
        (5, 1, "number of landmarks in a frame"),
        (12, 0, "return group"),
        (12, 1, "landmark to ignore"),
    ],
)
def test_the_first_number_of_each_card_of_a_list(group: int, card: int, field: str) -> None:
    """On its second card a list goes on with its last field."""
    cards = vopd.write_deck([stack(20, 20)]).splitlines()
    at = (GROUP_5 if group == 5 else len(cards) - 20 * 21 - 2) + card
    cards[at] = "   x1" + cards[at][5:]
    with pytest.raises(InputError) as caught:
        list(read_jobs(io.BytesIO("\n".join(cards).encode()), "deck"))
    found = caught.value.finding
    assert (found.card, found.group, found.columns, found.field) == (at + 1, group, (1, 5), field)
    assert found.message == "not a whole number: 'x1'"
