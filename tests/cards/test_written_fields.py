"""Numbers as they are punched, by hand: readings of the film reader, and words about rounding."""

from __future__ import annotations

from dataclasses import replace

import pytest

import vopd
from tests.kit.command import CASE_1
from vopd.cards.formats import FormatItem
from vopd.cards.write_number import nearest_that_fits, rounded_to_fit
from vopd.cards.writer import basic_data_cards
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
    other = replace(JOB, readings=replace(JOB.readings, landmark_in=landmark))
    card = basic_data_cards(other)[12 + 3 * 2 + 1]
    assert (card[40:47], card[50:57]) == (text, " 003250")
    assert len(card) == 67 and card[63:67] == "0730" and card[8:10] == "67"


@pytest.mark.parametrize("value", [1234.5678, -1e-7 / 3])
def test_a_reading_that_has_no_room(value: float) -> None:
    landmark = JOB.readings.landmark_in.copy()
    landmark[0, 0, 0, 0] = value
    with pytest.raises(VopdError, match=r"^basic data, reading: \S+ does not fit in 7 columns; "):
        basic_data_cards(replace(JOB, readings=replace(JOB.readings, landmark_in=landmark)))


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
