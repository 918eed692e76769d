"""Fields to numbers and back: by hand, by exact decimals, and by fortranformat."""

from __future__ import annotations

import re
from decimal import Decimal

import numpy as np
import pytest
from fortranformat import FortranRecordReader
from hypothesis import example, given
from hypothesis import strategies as st

from vopd.cards.formats import FORMATS, Item, items
from vopd.cards.numbers import read_column, write_number

F7_3, F5_0, F10_1, I5 = Item("F", 1, 7, 3), Item("F", 1, 5), Item("F", 1, 10, 1), Item("I", 1, 5)
FIELDS = [F7_3, F5_0, F10_1, Item("F", 1, 10, 3), Item("F", 1, 10, 2), I5, Item("I", 1, 2)]


def read(text: str, item: Item) -> tuple[float, bool, bool]:
    """Value, unreadable, doubtful of one field."""
    column = read_column(np.frombuffer(text.ljust(item.width).encode(), np.uint8)[None], item)
    return float(column.value[0]), bool(column.bad[0]), bool(column.doubtful[0])


HAND = [  # text, field, value, doubtful
    (" 010178", F7_3, 10.178, False),  # the report's cards: the point is implied
    ("-000004", F7_3, -0.004, False),
    ("10.1785", F7_3, 10.1785, False),  # a point that is punched counts
    ("", F7_3, 0.0, False),  # blanks are zeros
    ("  -12", F7_3, -1.2, True),  # -1200 thousandths
    ("-210.", F5_0, -210.0, False),
    ("1 2.5", F5_0, 102.5, True),  # a blank between digits is a zero
    ("- 5.", F5_0, -5.0, False),  # zeros before a number change nothing
    (" .5", F5_0, 0.5, False),  # nor do zeros behind the point
    ("   12", I5, 12, False),
    ("12", I5, 12000, True),  # ten per blank
    ("1 2", I5, 10200, True),
    ("   +7", I5, 7, False),
    ("    1.5E+2", F10_1, 150.0, False),
    ("     15E+2", F10_1, 150.0, False),  # 1.5E2: the implied point is the mantissa's
    ("    1.5D+2", F10_1, 150.0, False),
    ("     1.5-2", F10_1, 0.015, False),  # an exponent may do with its sign
    ("   1.04E1 ", F10_1, 1.04e10, True),
]


@pytest.mark.parametrize(("text", "item", "value", "doubtful"), HAND)
def test_by_hand(text: str, item: Item, value: float, doubtful: bool) -> None:
    assert read(text, item) == (value, False, doubtful)


@pytest.mark.parametrize("text", ["5O.3", "1.2.3", "1-", "--1", "E5", "1_000", "1D"])
def test_what_is_no_number(text: str) -> None:
    assert read(text.rjust(10), F10_1)[1]


@pytest.mark.parametrize("text", ["  1.2", "    -", "  1E2", "0x1F"])
def test_what_is_no_whole_number(text: str) -> None:
    assert read(text, I5)[1]


punched = st.text(alphabet=" 0123456789.-+ED", min_size=1, max_size=10)
digits = st.text(alphabet=" 0123456789.-", min_size=1, max_size=10)


@given(punched | digits, st.sampled_from(FIELDS))
@example("9279 3E261", F10_1)
def test_as_fortranformat_reads_it(text: str, item: Item) -> None:
    """fortranformat, blanks made zeros by hand, is the authority on what a field holds.

    Named exceptions: it rounds an implied point together with an exponent a
    bit off, and takes infinity, and an exponent without digits, for a number.
    """
    text = text[: item.width].rjust(item.width)
    value, bad, _ = read(text, item)
    number = text.lstrip()
    zeros = " " * (len(text) - len(number)) + number.replace(" ", "0")
    try:
        known = FortranRecordReader(f"({item.descriptor})").read(zeros)[0] or 0
    except (ValueError, OverflowError):
        assert bad
        return
    if np.isinf(float(known)) or not number.strip("+-") or re.search(r"[ED+-]$", zeros):
        return
    assert not bad or not re.search(r"\d", number)
    if not bad:
        slack = 4e-16 * abs(known) if re.search(r"[ED]|\d[+-]", zeros) else 0.0
        assert abs(value - known) <= slack


@given(st.from_regex(r"[ -]?[0-9]{1,9}", fullmatch=True), st.sampled_from([F7_3, F10_1]))
def test_implied_points_are_rounded_correctly(text: str, item: Item) -> None:
    text = text[: item.width].strip() or "0"
    if text == "-":
        text = "-0"
    exact = Decimal(text).scaleb(-item.decimals)
    assert read(text.rjust(item.width), item)[0] == float(exact)


@given(punched, st.sampled_from(FIELDS))
def test_what_is_read_can_be_written_and_reads_the_same(text: str, item: Item) -> None:
    value, bad, _ = read(text[: item.width].rjust(item.width), item)
    if not bad:
        written = write_number(value, item)
        assert written is not None and len(written) == item.width
        again, unreadable, doubtful = read(written, item)
        assert not unreadable and not doubtful
        assert again.hex() == value.hex() or (item.kind == "I" and again == value)


def test_what_does_not_fit_is_not_written() -> None:
    assert write_number(-123456.789, F10_1) is None
    assert write_number(100000, I5) is None
    assert write_number(0.1, F10_1) == "        .1"


@given(st.lists(punched, min_size=2, max_size=30), st.sampled_from(FIELDS))
def test_many_cards_are_each_read_alone(texts: list[str], item: Item) -> None:
    texts = [text[: item.width].rjust(item.width) for text in texts]
    block = np.frombuffer("".join(texts).encode(), np.uint8).reshape(len(texts), item.width)
    columns = read_column(block, item)
    for k, text in enumerate(texts):
        value, bad, doubtful = read(text, item)
        assert (columns.bad[k], columns.doubtful[k]) == (bad, doubtful)
        assert np.array_equal(columns.value[k], value, equal_nan=True)


def test_columns_of_the_formats() -> None:
    """Appendix E: landmark 9 to 10, x 41 to 47, y 51 to 57, frame 64 to 67."""
    assert [(i.kind, i.first, i.last) for i in items(86)] == [
        ("I", 9, 10), ("F", 41, 47), ("F", 51, 57), ("I", 64, 67)
    ]  # fmt: skip
    assert [len(items(n)) for n in FORMATS] == [2, 80, 8, 3, 16, 2, 8, 6, 7, 4]
