"""Numbers of frames and landmarks on the cards of the film, against what group 5 counts."""

from __future__ import annotations

import io
from collections.abc import Iterator

import pytest

from tests.kit.cards import CardLines, edited, landmarks_again, punch, punch_all, said, two_frames
from vopd.cards.read import read_jobs
from vopd.findings import Finding


def frames(cards: CardLines) -> Iterator[tuple[int | None, str, str]]:
    """What is said about frame numbers: card, severity, message."""
    for one in said(cards):
        if one.field == "frame number" and one.group == 0:
            assert one.columns == (64, 67)
            yield one.card, one.severity, one.message


def test_three_readings_of_three_landmarks() -> None:
    (found,) = said(edited((56, 9, "66"), (57, 9, "67")))
    assert (found.card, found.severity) == (58, "error")
    assert found.message == "three readings of one landmark are numbered 66, 67, 65"


def test_the_third_of_three_readings_has_the_number_that_counts() -> None:
    """Where reading goes on after the error; what is not defined is found at the first reading."""
    cards = edited((58, 9, "67"), (62, 9, "68"))
    (job,) = read_jobs(io.BytesIO("\n".join(cards).encode()), "a.dat", lambda _: None)
    assert job.readings.landmark[0].tolist() == [67, 66, 67]
    assert [(n, one.card) for n, one in job.readings.first_card.items()] == [(68, 62)]


def test_two_odd_cards_are_mispunched_and_three_are_another_frame() -> None:
    """Of the first frame the 5th and the 6th card, and then the 7th too."""
    two = edited((48, 64, "0713"), (49, 64, "0713"))
    assert [*frames(two)] == [(48, "error", "frame 713 among the cards of frame 730")]
    three = edited((48, 64, "0713"), (49, 64, "0713"), (50, 64, "0713"))
    message = "a card of frame 713, where group 5 counts 3 landmarks for frame 730"
    assert [*frames(three)] == [(48, "error", message)]


@pytest.mark.parametrize("last", [70, 84])
def test_an_odd_card_is_not_questioned_where_the_deck_ends_early(last: int) -> None:
    """A count may be wrong, so that the card is of another frame; three odd ones show that."""
    words = f"the deck ends here: 42 cards expected, {last - 43} found"
    (found,) = said(edited((48, 64, "0713"), (49, 64, "0713"))[:last])
    assert (found.card, found.message) == (last + 1, words)
    three = edited((48, 64, "0713"), (49, 64, "0713"), (50, 64, "0713"))[:last]
    message = "a card of frame 713, where group 5 counts 3 landmarks for frame 730"
    assert [*frames(three)] == [(48, "error", message)]


def test_one_landmark_is_counted_and_there_is_none() -> None:
    """Twelve cards of frame 730, and then those of 731."""
    cards = edited((31, 16, "    1"))
    message = "a card of frame 731, where group 5 counts 1 landmark for frame 730"
    assert [*frames([*cards[:55], *cards[64:]])] == [(56, "error", message)]


def test_fewer_landmarks_are_counted_than_there_are() -> None:
    message = "a further card of frame 730, for which group 5 counts 2 landmarks"
    assert [*frames(edited((31, 16, "    2")))] == [(62, "error", message)]
    message = "group 5 counts 2 landmarks for frame 731, and here is one more"
    assert [*frames(edited((31, 21, "    2")))] == [(83, "error", message)]


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
    message = "group 5 counts 3 landmarks for frame 731, and here is one more"
    assert [*frames(cards)] == ([(86, "error", message)] if one_more else [])


STORED = {  # group 5 of a second job, card 86: column, field, message; None where it is taken
    "as before": ("    2    2    2    3    3", None),
    "fewer frames": ("    2    1    2    3", None),
    "more frames": ("    2    3    2    3    3    3", (6, "number of frames",
                    "3 frames, but only 2 have been read")),
    "another count": ("    2    2    2    2    3", (16, "number of landmarks in a frame",
                      "2 landmarks in frame 730, but 3 have been read")),
    "a larger count": ("    2    2    2    3    4", (21, "number of landmarks in a frame",
                       "4 landmarks in frame 731, but 3 have been read")),
}  # fmt: skip


@pytest.mark.parametrize("name", STORED)
def test_the_counts_of_a_later_job(name: str) -> None:
    """The readings stay stored; frames may be left out at the end."""
    text, refused = STORED[name]
    cards = landmarks_again(two_frames())
    cards[85] = text
    expected = []
    if refused is not None:
        column, field, message = refused
        columns = (column, column + 4)
        expected = [Finding(message, "a.dat", 86, None, 5, field, columns, text.ljust(80))]
    assert said(cards) == expected


def test_a_later_job_with_fewer_frames_has_the_first_ones() -> None:
    cards = landmarks_again(two_frames())
    punch_all(range(65, 86), 64, "0750")(cards)
    cards[85] = "    2    1    2    3"
    first, second = read_jobs(io.BytesIO("\n".join(cards).encode()), "a.dat")
    assert first.readings.frame.tolist() == [730, 750]
    assert second.readings.frame.tolist() == [730]
    assert second.readings.layout.count.tolist() == [3]


COUNTED = {  # of frame 730, which has 3: what is said, and at which card
    2: (62, "a further card of frame 730, for which group 5 counts 2 landmarks"),
    4: (65, "a card of frame 731, where group 5 counts 4 landmarks for frame 730"),
}


@pytest.mark.parametrize("count", COUNTED)
def test_nothing_else_is_said_where_a_count_is_wrong(count: int) -> None:
    """Landmarks stand on cards that would be of fiducials, and numbers differ, for that alone."""
    cards = edited((31, 16, f"{count:5d}"), (62, 9, "65"), (64, 9, "66"))
    found = said([*cards, *cards[-3:]])
    assert [(one.card, one.message) for one in found] == [COUNTED[count]]
