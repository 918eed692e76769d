"""Numbers with exponents by every letter, with signs and blanks, alone and many at a time."""

from __future__ import annotations

import numpy as np
import pytest

from vopd.cards.deck import byte_matrix
from vopd.cards.format import FormatItem
from vopd.cards.numbers import read_few, read_field

F10_3, I5 = FormatItem("F", 1, 10, 3), FormatItem("I", 1, 5)

NUMBERS = {  # of an F10.3 field: its value, or None; whether it may not be what was meant
    **{f"  1.5{letter}2": (150.0, False) for letter in "EeDdQq"},
    **{f" 1.5{letter}+2": (150.0, False) for letter in "EeDdQq"},
    **{f"1.5{letter} -2": (0.015, True) for letter in "EeDdQq"},
    "1.5+2": (150.0, False),
    "15E2": (1.5, False),  # 15 thousandths, by the FORMAT
    "15-1": (0.0015, False),
    "1.5X2": (None, False),
    "1.5E": (None, False),
    "1.5E2.": (None, False),
    "1.5.": (None, False),
    "+-1": (0.0, True),  # no digit before the exponent -1
    "1-": (None, False),
    "1 5X": (None, False),
    "1 .5.": (None, False),
    "++1.": (None, False),
    "- 1.": (-1.0, False),
    "-.": (0.0, True),
    "+": (0.0, True),
    "1.E308": (1e308, False),
    "1.E309": (None, False),
    "1.E-9999": (0.0, False),
    "1.E-10000": (None, False),
    "0.E9999": (0.0, False),
    "E5": (0.0, True),
    "1 2": (0.102, True),
    "1. 2": (1.02, True),
}


@pytest.mark.parametrize("text", NUMBERS)
@pytest.mark.parametrize("many", [1, 100])
def test_numbers_at_the_right_edge_of_their_field(text: str, many: int) -> None:
    """One field, and a hundred of them, which are read together."""
    value, doubtful = NUMBERS[text]
    block = byte_matrix([text.rjust(10).encode()] * many)
    read = read_field(block, F10_3)
    assert read.unreadable.tolist() == [value is None] * many
    assert read.doubtful.tolist() == [doubtful] * many
    if value is not None:
        assert read.value.tolist() == [value] * many
    else:
        assert np.isnan(read.value).all()


def test_a_minus_sign_of_zero_stays() -> None:
    """-0 and -0. are minus zero; a minus alone is a zero, as a blank field is."""
    texts = [b"   -0", b"  -0.", b"     "]
    for read in (read_few(texts, [FormatItem("F", 1, 5)] * 3),
                 read_field(byte_matrix(texts * 40), FormatItem("F", 1, 5))):  # fmt: skip
        assert np.signbit(read.value[:3]).tolist() == [True, True, False]


@pytest.mark.parametrize("text", ["  1.0", " +-1 ", "  1E2", "    +", "  1X "])
def test_what_is_no_whole_number(text: str) -> None:
    assert read_few([text.encode()], [I5]).unreadable.tolist() == [True]
