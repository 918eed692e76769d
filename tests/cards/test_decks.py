"""Whole decks: lines to cards, cards to jobs, jobs to cards."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import vopd
from tests.kit.cards import landmarks_again, two_frames
from tests.kit.jobs import reread
from vopd.cards import read as basic_data
from vopd.cards.deck import byte_matrix
from vopd.cards.read import read_jobs
from vopd.findings import BASIC_DATA, Finding, VopdError
from vopd.job import Job, Readings

DECKS = sorted((Path(__file__).parents[2] / "decks").glob("*/*.dat"))
DECKS = [deck for deck in DECKS if deck.parent.name != "stars"]
CASE_1 = DECKS[0].parent.parent / "appendix_h" / "case1.dat"
(JOB,) = vopd.read_deck(CASE_1)


def jobs(text: str | bytes) -> list[Job]:
    data = text.encode() if isinstance(text, str) else text
    return list(read_jobs(io.BytesIO(data), "deck"))


@pytest.mark.parametrize("deck", DECKS, ids=lambda path: path.stem)
def test_read_write_read(deck: Path) -> None:
    first = list(vopd.read_deck(deck))
    written = vopd.write_deck(first)
    second = jobs(written)
    assert second == first
    assert vopd.write_deck(second) == written


SHAPES = {
    "CR LF": lambda text: text.replace("\n", "\r\n"),
    "full cards": lambda text: "\n".join(line.ljust(80) for line in text.splitlines()) + "\n",
    "one full card": lambda text: text.replace("CAMERA\n", "CAMERA".ljust(37) + "\n", 1),
    "trailing blanks": lambda text: text.replace("\n", " " * 90 + "\n"),
    "trailing blank lines": lambda text: text + "\n  \n\r\n",
    "no last end": lambda text: text.rstrip("\n"),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_harmless_shapes(shape: str) -> None:
    assert jobs(SHAPES[shape](CASE_1.read_text())) == [JOB]


def test_a_blank_card_is_a_card() -> None:
    """Group 10 left blank: NOUT is zero."""
    cards = CASE_1.read_text().splitlines()
    cards[41] = ""
    assert jobs("\n".join(cards)) == [JOB]


@pytest.mark.parametrize("card", [1, 2, 30, 36, 40])
def test_cards_of_any_length_begin_in_column_1(card: int) -> None:
    """Blanks at the end may be there or not, card by card of one group."""
    cards = CASE_1.read_text().splitlines()
    cards[card - 1] = cards[card - 1].ljust(80)
    assert jobs("\n".join(cards)) == [JOB]
    rows = byte_matrix([b"ab", b"", b"a", b"abcd"])
    assert [bytes(row) for row in rows] == [b"ab  ", b"    ", b"a   ", b"abcd"]


@pytest.mark.parametrize("at_a_time", [1, 40, 43, 100])
def test_a_film_read_in_portions_is_the_film_read_at_once(
    at_a_time: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where an undefined landmark is first read too: 99 in frames 3, 5 and 6, 98 in 4."""
    readings = JOB.readings
    film = replace(
        JOB,
        readings=Readings.of(
            np.arange(7) + 1,
            *(np.repeat(a, 7, axis=0) for a in (
                readings.fiducial_in, readings.landmark, readings.present, readings.landmark_in
            )),
        ),
    )  # fmt: skip
    film.readings.points.landmark[[8, 12, 16]] = 99
    film.readings.points.landmark[9] = 98
    deck = vopd.write_deck([film]).encode()
    (once,) = read_jobs(io.BytesIO(deck), "deck")
    monkeypatch.setattr(basic_data, "CARDS_AT_A_TIME", at_a_time)
    (portions,) = read_jobs(io.BytesIO(deck), "deck")
    assert portions == once == film
    first = {number: found.card for number, found in portions.readings.first_card.items()}
    assert first == {99: 43 + 2 * 21 + 12 + 6 + 1, 98: 43 + 3 * 21 + 12 + 1}
    assert portions.readings.first_card == once.readings.first_card


def test_group_5_and_12_go_on_over_cards() -> None:
    """3 counts and 15 frames are 18 numbers, two cards; NGO and 16 landmarks are 17, two cards."""
    readings = JOB.readings
    many = replace(
        JOB,
        readings=Readings.of(
            np.arange(15) + 100,
            *(np.repeat(a, 15, axis=0) for a in (
                readings.fiducial_in, readings.landmark, readings.present, readings.landmark_in
            )),
        ),
        landmarks=replace(
            JOB.landmarks,
            number=np.append(JOB.landmarks.number, np.arange(1, 14)),
            **{
                name: np.append(getattr(JOB.landmarks, name), np.zeros(13))
                for name in ("longitude_deg", "longitude_min", "latitude_deg", "latitude_min",
                             "altitude_ft")
            },
        ),
        ignored=replace(JOB.ignored, everywhere=np.array([0] * 15 + [66])),
    )  # fmt: skip
    cards = vopd.write_deck([many]).splitlines()
    assert cards[30] == "   16   15    2" + "    3" * 13
    assert cards[31] == "    3" * 2
    assert cards[56] == "   13" + "    0" * 15
    assert cards[57] == "   66"
    assert jobs("\n".join(cards)) == [many]


readings_in = st.integers(-99999, 99999).map(lambda n: n / 1000.0)


@st.composite
def films(draw: st.DrawFn) -> Job:
    """Case 1 with other frames: any number of landmarks in each, any readings."""
    frames = draw(st.integers(1, 5))
    counts = np.array(draw(st.lists(st.integers(1, 4), min_size=frames, max_size=frames)))
    width = int(counts.max())
    present = np.arange(width) < counts[:, None]
    landmark = draw(arrays(np.int64, (frames, width), elements=st.integers(0, 99)))
    points = draw(arrays(float, (frames, width, 3, 2), elements=readings_in))
    return replace(
        JOB,
        readings=Readings.of(
            frame=draw(arrays(np.int64, frames, elements=st.integers(0, 9999), unique=True)),
            fiducial_in=draw(arrays(float, (frames, 4, 3, 2), elements=readings_in)),
            landmark=np.where(present, landmark, 0),
            present=present,
            landmark_in=np.where(present[..., None, None], points, 0.0),
        ),
    )


@settings(max_examples=25)
@given(films())
def test_any_film_comes_back(job: Job) -> None:
    written = vopd.write_deck([job])
    (back,) = jobs(written)
    assert back == job
    assert vopd.write_deck([back]) == written


def test_a_stack_that_cannot_be_written() -> None:
    """Return group 9 does not read the wind again."""
    first = replace(JOB, return_group=9)
    calm = replace(JOB, wind=replace(JOB.wind, velocity_ft_s=np.zeros((3, 2))))
    with pytest.raises(VopdError, match=r"job 2: wind cannot be written .* after return group 9"):
        vopd.write_deck([first, calm])
    again = replace(JOB, return_group=4)
    assert jobs(vopd.write_deck([again, calm])) == [again, calm]


def test_values_that_do_not_fit() -> None:
    long = replace(JOB, clock=replace(JOB.clock, time_s=np.array([1 / 3, 2.0])))
    with pytest.raises(VopdError) as error:
        vopd.write_deck([long])
    assert str(error.value) == (
        "group 6, flight time: 0.3333333333333333 does not fit in 10 columns; "
        "rounded to 9 decimals, 0.333333333, it does"
    )
    vopd.write_deck([replace(JOB, clock=replace(JOB.clock, time_s=np.array([0.333333333, 2.0])))])
    far = replace(JOB, readings=reread(JOB.readings, frame=np.array([12345])))
    with pytest.raises(VopdError, match="frame number: 12345 does not fit in 4 columns"):
        vopd.write_deck([far])


def test_a_bad_field_among_very_many_cards_is_named() -> None:
    """Card 43 + 24 * 2100 + 7 is the seventh of frame 2101: a letter in its x."""
    readings = JOB.readings
    count = 3000
    film = replace(
        JOB,
        readings=Readings.of(
            np.arange(count) + 1,
            *(np.repeat(a, count, axis=0) for a in (
                readings.fiducial_in, readings.landmark, readings.present, readings.landmark_in
            )),
        ),
    )  # fmt: skip
    cards = vopd.write_deck([film]).splitlines()
    control = len(cards) - 21 * count
    at = control + 21 * 2100 + 7
    cards[at - 1] = cards[at - 1].replace("014476", "0144T6")
    cards[at + 500] = cards[at + 500][:5]  # a later error is not the one that is reported
    with pytest.raises(vopd.InputError) as caught:
        jobs("\n".join(cards))
    finding: Finding = caught.value.finding
    assert (finding.card, finding.columns, finding.group) == (at, (41, 47), BASIC_DATA)
    assert "0144T6" in finding.message


def test_landmarks_that_stay_from_the_job_before_are_not_written_again() -> None:
    """The second job gives two of three landmarks: its group 5 counts two, and so does group 12."""
    cards = landmarks_again(two_frames())
    read = jobs("\n".join(cards))
    assert vopd.write_deck(read).splitlines() == cards
    assert [len(one.landmarks.number) for one in read] == [3, 3]
    assert [len(one.ignored.everywhere) for one in read] == [3, 2]
