"""Cards of several jobs in one deck as they are explained, and of lists that fill their cards."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest

import vopd
from tests.kit.command import CASE_1
from vopd.cards.explain import explain_deck
from vopd.findings import InputError
from vopd.job import Job, Readings

(JOB,) = vopd.read_deck(CASE_1)


def stack(frames: int, landmarks: int, group: int, jobs: int = 2) -> list[str]:
    """A job of so many frames and landmarks, and again from a return group on, as cards."""
    r, marks = JOB.readings, JOB.landmarks
    more = landmarks - len(marks.number)
    columns = ("longitude_deg", "longitude_min", "latitude_deg", "latitude_min", "altitude_ft")
    films = (r.fiducial_in, r.landmark, r.present, r.landmark_in)
    job: Job = replace(
        JOB,
        readings=Readings.of(np.arange(frames) + 1, *(np.repeat(a, frames, axis=0) for a in films)),
        landmarks=replace(
            marks,
            number=np.append(marks.number, np.arange(1, more + 1)),
            **{name: np.append(getattr(marks, name), np.zeros(more)) for name in columns},
        ),
        ignored=replace(JOB.ignored, everywhere=np.zeros(landmarks, np.int64)),
    )
    again = replace(job, return_group=group)
    return vopd.write_deck([*[again] * (jobs - 1), job]).splitlines()


def explained(cards: list[str], *groups: int) -> list[list[str]]:
    """The lines about each card of some groups."""
    deck = io.BytesIO("\n".join(cards).encode())
    return [one.splitlines() for one in explain_deck(deck, "deck", lambda of, _: of in groups)]


def names(lines: list[str]) -> list[str]:
    return [line.split()[2] for line in lines[2:]]


@pytest.mark.parametrize("frames", [12, 13, 14, 29])
def test_the_counts_of_a_later_job_begin_anew(frames: int) -> None:
    """Three counts and one of each frame, sixteen a card; both jobs have as many."""
    expected = ["NT", "NFR", "NTFR", *(f"NPT({k + 1})" for k in range(frames))]
    cards = explained(stack(frames, 3, 5), 5)
    found = [name for card in cards for name in names(card)]
    assert found == 2 * expected
    assert [len(names(card)) for card in cards[: len(cards) // 2]] == [
        len(expected[k : k + 16]) for k in range(0, len(expected), 16)
    ]
    meanings = [line[52:] for card in cards for line in card[2:]]
    assert meanings[3 : 3 + frames] == [
        f"landmarks in frame {k + 1} of the film" for k in range(frames)
    ]


@pytest.mark.parametrize("group", [9, 12])
@pytest.mark.parametrize("landmarks", [14, 15, 16, 31])
def test_the_list_of_group_12_begins_anew(landmarks: int, group: int) -> None:
    """Where reading goes on at group 12, one list follows the other."""
    expected = ["NGO", *(f"IOUT({k + 1})" for k in range(landmarks))]
    cards = explained(stack(1, landmarks, group, 3), 12)
    assert [name for card in cards for name in names(card)] == 3 * expected
    assert f"(reading goes on at group {group}; the basic data stay)" in cards[0][2]
    assert [line[52:] for line in cards[-1][2:] if "IOUT" in line] == ["landmark to ignore"] * len(
        [name for name in names(cards[-1]) if name != "NGO"]
    )


def test_cards_of_the_film_of_a_later_job() -> None:
    """Two frames of 21 cards, read again: the frames are counted from 1 again."""
    heads = [card[0].partition("film, ")[2] for card in explained(stack(2, 3, 2), 0)]
    points = [f"fiducial {k}" for k in range(1, 5)] + [f"landmark {k} of 3" for k in (1, 2, 3)]
    once = [
        f"frame {frame} of the film, {point}, reading {reading}"
        for frame in (1, 2)
        for point in points
        for reading in (1, 2, 3)
    ]
    assert heads == 2 * once


def test_the_number_of_each_card_and_its_text() -> None:
    cards = stack(1, 3, 9)
    found = explained(cards, *range(13))
    assert [card[0].split(",")[0] for card in found] == [
        f"card {k}" for k in range(1, len(cards) + 1)
    ]
    assert [card[1] for card in found] == [f"  |{text}" for text in cards]


def test_what_could_be_read_is_explained_before_the_error() -> None:
    """Card 30 is not a number, and is explained; card 40 is missing, which ends the deck."""
    cards = stack(1, 3, 9)[:39]
    cards[29] = "        xx" + cards[29][10:]
    deck = io.BytesIO("\n".join(cards).encode())
    texts = explain_deck(deck, "deck", lambda _, card: card in (30, 38))
    first, second = next(texts).splitlines(), next(texts).splitlines()
    assert second[0] == "card 38, group 8: focal length, origin, first estimate"
    with pytest.raises(InputError, match="card 40, group 9: the deck ends here: 3 cards expected"):
        next(texts)
    assert first[0] == "card 30, group 4: wind"
    assert first[2] == (
        "   columns 1-10   ALT                 ? ft          altitude above sea level"
        "  (not a number: 'xx')"
    )


@pytest.mark.parametrize("frames", [13, 14, 16, 30])
def test_cards_of_the_film_whose_counts_take_several_cards(frames: int) -> None:
    """Twelve cards of fiducials and nine of landmarks a frame, the film at the end of the deck."""
    cards = stack(frames, 3, 13, jobs=1)
    heads = [one[0] for one in explained(cards, 0)]
    assert len(heads) == 21 * frames
    first = len(cards) - len(heads) + 1
    for frame in range(frames):
        for row, point in (
            (0, "fiducial 1, reading 1"),
            (11, "fiducial 4, reading 3"),
            (12, "landmark 1 of 3, reading 1"),
            (20, "landmark 3 of 3, reading 3"),
        ):
            number = 21 * frame + row
            assert heads[number] == (
                f"card {first + number}, basic data: readings of the film, "
                f"frame {frame + 1} of the film, {point}"
            )
