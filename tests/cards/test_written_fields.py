"""Numbers as they are punched, by hand: readings of the film reader, and words about rounding."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import vopd
from tests.kit.command import CASE_1
from tests.kit.jobs import reread
from vopd.cards.format import FormatItem
from vopd.cards.numbers import nearest_that_fits, rounded_to_fit, write_number
from vopd.cards.write import basic_data_cards
from vopd.findings import VopdError

(JOB,) = vopd.read_deck(CASE_1)

READINGS = [  # columns 41 to 47, F7.3: a sign and six digits, the last three behind the point
    (0.0, " 000000"),
    (-0.0, "-000000"),
    (0.001, " 000001"),
    (-0.001, "-000001"),
    (14.476, " 014476"),
    (999.999, " 999999"),
    (-999.999, "-999999"),
    (1000.0, "  1000."),
    (-1000.0, " -1000."),
    (1000.001, "1000001"),
    (99999.0, " 99999."),
    (0.0005, "  .0005"),
    (1.2345, " 1.2345"),
]


@pytest.mark.parametrize(("value", "text"), READINGS)
def test_a_reading_of_the_film_reader(value: float, text: str) -> None:
    """With a point only where thousandths do not do; x has columns 41 to 47 and y 51 to 57."""
    landmark = JOB.readings.landmark_in.copy()
    landmark[0, 2, 1] = [value, 3.25]
    other = replace(JOB, readings=reread(JOB.readings, landmark_in=landmark))
    card = basic_data_cards(other)[12 + 3 * 2 + 1]
    assert (card[40:47], card[50:57]) == (text, " 003250")
    assert len(card) == 67 and card[63:67] == "0730" and card[8:10] == "67"


@pytest.mark.parametrize("value", [1234.5678, -1e-7 / 3])
def test_a_reading_that_has_no_room(value: float) -> None:
    landmark = JOB.readings.landmark_in.copy()
    landmark[0, 0, 0, 0] = value
    with pytest.raises(VopdError, match=r"^basic data, reading: \S+ does not fit in 7 columns; "):
        basic_data_cards(replace(JOB, readings=reread(JOB.readings, landmark_in=landmark)))


F5_0 = FormatItem("F", 1, 5)
ROUNDED = [  # the number of decimals in words: one is singular, and whole numbers have digits
    (12.34, FormatItem("F", 1, 4), "rounded to 1 decimal, 12.3"),
    (1.234, FormatItem("F", 1, 4), "rounded to 2 decimals, 1.23"),
    (-1.26, FormatItem("F", 1, 4), "rounded to 1 decimal, -1.3"),
    (1 / 3, F5_0, "rounded to 4 decimals, 0.3333"),
    (123456.0, F5_0, "rounded to 3 significant digits, 1.23e+05"),  # 123E3
    (float("nan"), F5_0, ""),
    (float("inf"), F5_0, ""),
    (123456, FormatItem("I", 1, 5), ""),
]


@pytest.mark.parametrize(("value", "item", "words"), ROUNDED)
def test_words_about_rounding(value: float, item: FormatItem, words: str) -> None:
    assert nearest_that_fits(value, item) == words


def test_rounded_to_the_columns_of_a_format() -> None:
    """FORMAT 86, x: 7 columns; FORMAT 82: 10."""
    assert rounded_to_fit(1 / 3, 86, 1) == 0.333333
    assert rounded_to_fit(-1 / 3, 86, 1) == -0.33333
    assert rounded_to_fit(100 / 3, 82, 0) == 33.3333333
    assert rounded_to_fit(2.5, 86, 2) == 2.5


@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
def test_what_is_no_finite_number_is_not_written(value: float) -> None:
    assert write_number(value, F5_0) is None and write_number(value, FormatItem("I", 1, 5)) is None
    wind = replace(JOB.wind, altitude_ft=np.array([0.0, value, 2.0]))
    words = rf"^group 4, altitude above sea level: {value} does not fit in 10 columns$"
    with pytest.raises(VopdError, match=words):
        vopd.write_deck([replace(JOB, wind=wind)])


LARGEST = 1.7976931348623157e308


def test_a_number_that_is_infinite_when_it_is_rounded() -> None:
    """With 16 digits or with 1 the largest number of all is beyond itself; 179769 is with E304."""
    assert rounded_to_fit(LARGEST, 82, 0) == 1.79769e308
    words = "rounded to 6 significant digits, 1.79769e+308"
    assert nearest_that_fits(LARGEST, FormatItem("F", 1, 10, 1)) == words
    assert rounded_to_fit(float("nan"), 82, 0) != rounded_to_fit(float("nan"), 82, 0)


WRITTEN: list[tuple[float, str | None]] = [  # of an F6.2 field, the plainest text
    (0.0, "    0."),
    (-0.0, "   -0."),
    (1.0, "    1."),
    (-12.5, " -12.5"),
    (0.25, "   .25"),
    (-0.25, "  -.25"),
    (1234.5, "1234.5"),
    (12345.0, "12345."),
    (1234.56, "123456"),
    (123400.0, "1234E4"),
    (1e15, " 1.E15"),
    (1e-7, " 1.E-7"),
    (1.5e-7, "15.E-8"),
    (-1.5e30, "-15E31"),
    (1.23e40, "123E40"),
    (0.001, "  .001"),
    (1234567.0, None),
    (100000.0, "  1.E5"),
]


@pytest.mark.parametrize(("value", "text"), WRITTEN)
def test_the_plainest_text_of_a_number(value: float, text: str | None) -> None:
    assert write_number(value, FormatItem("F", 1, 6, 2)) == text


def test_cards_have_no_blanks_at_their_end_and_the_deck_one_newline() -> None:
    text = vopd.write_deck([replace(JOB, title="1 A TITLE".ljust(80))])
    assert text.endswith("0730\n") and not text.endswith("\n\n")
    cards = text.splitlines()
    assert len(cards) == 64 and cards[25] == "1 A TITLE"
    assert [card for card in cards if card != card.rstrip()] == []


def test_the_cards_of_the_film_reader() -> None:
    """Kind 1 a fiducial and 4 a landmark; its number, the reading and the point; 67 columns."""
    cards = basic_data_cards(JOB)
    heads = [card[:40].rstrip() for card in cards]
    expected = [f"10000 1 001 {r:02d}{p:05d}" for p in range(1, 5) for r in (1, 2, 3)]
    marks = enumerate(JOB.readings.landmark[0].tolist(), 5)
    expected += [f"40000 1 {n:02d}1 {r:02d}{p:05d}" for p, n in marks for r in (1, 2, 3)]
    assert heads == expected
    assert {card[63:] for card in cards} == {"0730"} and {len(card) for card in cards} == {67}


FRAMES = {0: "0000", 7: "0007", 9999: "9999", -1: "  -1", -999: "-999"}


@pytest.mark.parametrize("number", FRAMES)
def test_the_number_of_a_frame(number: int) -> None:
    job = replace(JOB, readings=reread(JOB.readings, frame=np.array([number])))
    assert {card[63:] for card in basic_data_cards(job)} == {FRAMES[number]}


@pytest.mark.parametrize(
    ("number", "words"),
    [
        (100, "landmark number: 100 does not fit in 2 columns"),
        (-1, "landmark number: -1 does not fit in 2 columns"),
    ],
)
def test_a_landmark_that_has_no_room(number: int, words: str) -> None:
    landmark = JOB.readings.landmark.copy()
    landmark[0, 1] = number
    with pytest.raises(VopdError, match=f"^basic data, {words}$"):
        basic_data_cards(replace(JOB, readings=reread(JOB.readings, landmark=landmark)))
    for most in (0, 99):
        landmark[0, 1] = most
        basic_data_cards(replace(JOB, readings=reread(JOB.readings, landmark=landmark)))
