"""Counts of group 5 against the cards, and the lists of groups 5 and 12."""

from __future__ import annotations

import io
import tracemalloc
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

import vopd
from tests.approved.texts import assert_approved
from tests.kit.cards import CardLines, edited, landmarks_again, punch, punch_all, said, two_frames
from tests.kit.command import CASE_1, CASE_4
from vopd.cards.deck import CardBlock
from vopd.cards.read import read_jobs
from vopd.cards.write import write_deck
from vopd.check import check_deck
from vopd.findings import BASIC_DATA, Finding, InputError
from vopd.job import Job, Readings
from vopd.synthetic import Plan
from vopd.synthetic.flight import make

FRAMES, LANDMARKS = 600, 4
CARDS = 12 + 3 * LANDMARKS


@pytest.fixture(scope="module")
def flight() -> CardLines:
    return write_deck(make(Plan(frames=FRAMES, landmarks=LANDMARKS))[0]).splitlines()


def group_5(cards: CardLines) -> int:
    """Number of the first card of group 5, from 1."""
    return next(k for k, card in enumerate(cards, 1) if card[5:10] == f"{FRAMES:5d}")


def first_of_film(cards: CardLines) -> int:
    return len(cards) - FRAMES * CARDS + 1


def refusal(cards: CardLines) -> Finding:
    with pytest.raises(InputError) as error:
        list(read_jobs(io.BytesIO("\n".join(cards).encode()), "deck"))
    return error.value.finding


@pytest.mark.parametrize("punched", ["2    ", "4    ", "99999", "    5"])
def test_a_count_that_is_too_large(flight: CardLines, punched: str) -> None:
    """The first card of frame 2 contradicts it, however large the count is."""
    cards = list(flight)
    punch(group_5(cards), 16, punched)(cards)
    found = refusal(cards)
    assert found.card == first_of_film(cards) + CARDS
    assert (found.group, found.columns) == (BASIC_DATA, (64, 67))
    count = int(punched.replace(" ", "0")) if punched[0] != " " else 5
    assert_approved(found.message, parts=["frame 2", count, "frame 1"])


def test_a_count_that_is_too_small(flight: CardLines) -> None:
    """Frame 14 has its count first on the second card: 3 counts and 13 frames fill the first."""
    cards = list(flight)
    punch(group_5(cards) + 1, 1, "    3")(cards)
    found = refusal(cards)
    assert found.card == first_of_film(cards) + 14 * CARDS - 3
    assert_approved(found.message, parts=["frame 14", "3 landmarks"])


def test_the_check_ends_there_too(flight: CardLines) -> None:
    cards = list(flight)
    punch(group_5(cards), 16, "    5")(cards)
    found = check_deck(io.BytesIO("\n".join(cards).encode()), "deck")
    assert [finding.severity for finding in found] == ["error"]


@pytest.mark.parametrize("first_count", ["2    ", "99999"])
def test_memory_follows_the_cards_and_not_the_counts(flight: CardLines, first_count: str) -> None:
    """As arrays of frames by the largest count the readings would take 576 MB and more."""
    cards = list(flight)
    punch(group_5(cards), 16, first_count)(cards)
    deck = io.BytesIO("\n".join(cards).encode())
    tracemalloc.start()
    try:
        check_deck(deck, "deck")
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 30 * len(deck.getvalue())


def test_a_large_count_that_is_right_is_read() -> None:
    (job,), _ = make(Plan(frames=3, landmarks=60, swing_deg=5.0))
    (back,) = read_jobs(io.BytesIO(write_deck([job]).encode()), "deck")
    assert back == job


def test_all_digits_are_no_film() -> None:
    """Cards of one digit count 11111 of everything; the deck ends in the first frame."""
    cards = ("1" * 80 + "\n") * 60_000
    found = check_deck(io.BytesIO(cards.encode()), "deck")
    errors = [finding for finding in found if finding.severity == "error"]
    assert_approved(errors)


# Numbers of frames and landmarks on the cards of the film


def frames(cards: CardLines) -> Iterator[tuple[int | None, str, str]]:
    """What is said about frame numbers: card, severity, message."""
    for one in said(cards):
        if one.field == "frame number" and one.group == 0:
            assert one.columns == (64, 67)
            yield one.card, one.severity, one.message


def assert_frame_error(cards: CardLines, card: int) -> None:
    """One error is said about frame numbers, of that card."""
    ((number, severity, message),) = frames(cards)
    assert (number, severity) == (card, "error")
    assert_approved(message)


def test_three_readings_of_three_landmarks() -> None:
    (found,) = said(edited((56, 9, "66"), (57, 9, "67")))
    assert (found.card, found.severity) == (58, "error")
    assert_approved(found.message, parts=["66, 67, 65"])


def test_the_third_of_three_readings_has_the_number_that_counts() -> None:
    """Where reading goes on after the error; what is not defined is found at the first reading."""
    cards = edited((58, 9, "67"), (62, 9, "68"))
    (job,) = read_jobs(io.BytesIO("\n".join(cards).encode()), "a.dat", lambda _: None)
    assert job.readings.landmark[0].tolist() == [67, 66, 67]
    assert [(n, one.card) for n, one in job.readings.first_card.items()] == [(68, 62)]


def test_two_odd_cards_are_mispunched_and_three_are_another_frame() -> None:
    """Of the first frame the 5th and the 6th card, and then the 7th too."""
    two = edited((48, 64, "0713"), (49, 64, "0713"))
    assert_frame_error(two, 48)
    assert_frame_error(edited((48, 64, "0713"), (49, 64, "0713"), (50, 64, "0713")), 48)


@pytest.mark.parametrize("last", [70, 84])
def test_an_odd_card_is_not_questioned_where_the_deck_ends_early(last: int) -> None:
    """A count may be wrong, so that the card is of another frame; three odd ones show that."""
    (found,) = said(edited((48, 64, "0713"), (49, 64, "0713"))[:last])
    assert found.card == last + 1
    assert_approved(found.message, parts=[42, last - 43])
    assert_frame_error(edited((48, 64, "0713"), (49, 64, "0713"), (50, 64, "0713"))[:last], 48)


def test_one_landmark_is_counted_and_there_is_none() -> None:
    """Twelve cards of frame 730, and then those of 731."""
    cards = edited((31, 16, "    1"))
    assert_frame_error([*cards[:55], *cards[64:]], 56)


def test_fewer_landmarks_are_counted_than_there_are() -> None:
    assert_frame_error(edited((31, 16, "    2")), 62)
    assert_frame_error(edited((31, 21, "    2")), 83)


@pytest.mark.parametrize(
    ("card", "spoiled", "named"),
    [(59, (), 60), (60, (), 61), (61, (), 62), (61, (59, 60), 62), (44, (), 45), (50, (), 51),
     (55, (), 56)],
)  # fmt: skip
def test_a_reading_that_is_there_twice_is_named(
    card: int, spoiled: tuple[int, ...], named: int
) -> None:
    """Of landmark 66, and of the fiducials; the copy follows its card, wherever that stands."""
    cards = edited(*((one, 41, f"0102{one}") for one in spoiled))
    cards.insert(card, cards[card - 1])
    found = [one for one in said(cards) if one.severity == "error"]
    assert [one.card for one in found] == [named]
    assert_approved(found[0].message, parts=[f"card {card};"])


def test_readings_that_are_equal_by_chance_are_no_copy() -> None:
    """Two of landmark 67, of which there are three; a card of landmark 66 is there twice."""
    cards = two_frames()
    cards[56] = cards[55]
    cards.insert(60, cards[59])
    found = [one for one in said(cards) if one.severity == "error"]
    assert [one.card for one in found] == [61]
    assert_approved(found[0].message, parts=["card 60;"])


def test_a_stray_card_among_the_fiducials_is_of_no_fiducial() -> None:
    """It is read far from all four: which of them it belongs to cannot be told."""
    cards = two_frames()
    cards.insert(49, cards[48])
    punch(50, 41, "99.5000")(cards)
    found = [one for one in said(cards) if one.severity == "error"]
    assert [one.card for one in found] == [56]
    assert_approved(found[0].message, parts=["13 readings", "730", "12"])


MORE = {  # what is punched into a further card of landmark 67: whether it is one
    "as it is": ((1, " "), True),
    "a fiducial": ((9, "00"), False),
    "another frame": ((64, "0732"), False),
    "no frame": ((64, "    "), False),
    "no x": ((41, "       "), False),
    "no y": ((51, "       "), False),
    "an x that is no number": ((41, "  1.x  "), False),
    "a landmark that is no number": ((9, "6x"), False),
    "a frame that is no number": ((64, "07x1"), False),
}


@pytest.mark.parametrize("name", MORE)
def test_when_a_card_behind_the_last_frame_is_one_more_of_it(name: str) -> None:
    edit, one_more = MORE[name]
    cards = two_frames()
    cards.append(cards[-1])
    punch(86, *edit)(cards)
    if one_more:
        assert_frame_error(cards, 86)
    else:
        assert [*frames(cards)] == []


STORED = {  # group 5 of a second job, card 86: the column of an error; None where it is taken
    "as before": ("    2    2    2    3    3", None),
    "fewer frames": ("    2    1    2    3", None),
    "more frames": ("    2    3    2    3    3    3", 6),
    "another count": ("    2    2    2    2    3", 16),
    "a larger count": ("    2    2    2    3    4", 21),
}


@pytest.mark.parametrize("name", STORED)
def test_the_counts_of_a_later_job(name: str) -> None:
    """The readings stay stored; frames may be left out at the end."""
    text, column = STORED[name]
    cards = landmarks_again(two_frames())
    cards[85] = text
    found = said(cards)
    assert [(one.card, one.group, one.columns, one.image) for one in found] == (
        [(86, 5, (column, column + 4), text.ljust(80))] if column is not None else []
    )
    if found:
        assert_approved([found[0].field, found[0]])


def test_a_later_job_with_fewer_frames_has_the_first_ones() -> None:
    cards = landmarks_again(two_frames())
    punch_all(range(65, 86), 64, "0750")(cards)
    cards[85] = "    2    1    2    3"
    first, second = read_jobs(io.BytesIO("\n".join(cards).encode()), "a.dat")
    assert first.readings.frame.tolist() == [730, 750]
    assert second.readings.frame.tolist() == [730]
    assert second.readings.layout.count.tolist() == [3]


COUNTED = {2: 62, 4: 65}
"""Of frame 730, which has 3: the card at which an error is said."""


@pytest.mark.parametrize("count", COUNTED)
def test_nothing_else_is_said_where_a_count_is_wrong(count: int) -> None:
    """Landmarks stand on cards that would be of fiducials, and numbers differ, for that alone."""
    cards = edited((31, 16, f"{count:5d}"), (62, 9, "65"), (64, 9, "66"))
    found = said([*cards, *cards[-3:]])
    assert [one.card for one in found] == [COUNTED[count]]
    assert_approved(found)


# Lists, sixteen numbers to a card


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


@pytest.mark.parametrize(("after", "group"), [(37, "group 7"), (38, "group 8"), (40, "group 9")])
def test_a_blank_card_is_of_the_group_that_is_not_full(after: int, group: str) -> None:
    cards = CASE_1.read_text().splitlines()
    cards.insert(after, "")
    found = check_deck(io.BytesIO("\n".join(cards).encode()), "deck")
    (error,) = (one for one in found if one.severity == "error")
    assert error.card == after + 1
    assert_approved(str(error), parts=[after + 1, group])


@pytest.mark.parametrize(
    ("number", "change"),
    [
        (33, "twice"), (36, "twice"), (37, "twice"), (40, "twice"), (44, "twice"),
        (39, "out"), (40, "out"), (44, "out"), (38, "blank"), (29, "blank"),
        (30, "    2"), (30, "    4"), (30, "3    "), (30, "99999"),
    ],
)  # fmt: skip
def test_a_card_too_many_or_too_few_in_a_deck_with_group_11(number: int, change: str) -> None:
    """Landmarks ignored in one frame stand behind the card that is wrong; its count is card 30."""
    cards = CASE_4.read_text().splitlines()
    card = cards[number - 1]
    changed = {"twice": [card, card], "out": [], "blank": ["", card]}
    cards[number - 1 : number] = changed.get(change, [change + card[5:]])
    found = check_deck(io.BytesIO("\n".join(cards).encode()), "deck")
    (error,) = (one for one in found if one.severity == "error")
    assert error.card == number + (change == "twice") or change not in changed or number == 39
    assert_approved(str(error))
