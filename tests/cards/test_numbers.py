"""Fields to numbers and back: by hand, by exact decimals, and by fortranformat."""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import replace
from decimal import Decimal
from pathlib import Path
from random import Random

import numpy as np
import pytest
from fortranformat import FortranRecordReader
from hypothesis import example, given
from hypothesis import strategies as st

import vopd
from tests.approved.texts import refused
from tests.kit.command import CASE_1
from tests.kit.jobs import reread
from tests.tolerances import assert_close
from vopd.cards.deck import byte_matrix
from vopd.cards.format import FORMATS, FormatItem, format_items
from vopd.cards.numbers import nearest_that_fits, read_few, read_field, rounded_to_fit, write_number
from vopd.cards.write import basic_data_cards
from vopd.findings import VopdError

F7_3, F5_0, F10_1, I5 = (
    FormatItem("F", 1, 7, 3),
    FormatItem("F", 1, 5),
    FormatItem("F", 1, 10, 1),
    FormatItem("I", 1, 5),
)
FIELDS = [
    F7_3,
    F5_0,
    F10_1,
    FormatItem("F", 1, 10, 3),
    FormatItem("F", 1, 10, 2),
    I5,
    FormatItem("I", 1, 2),
]


def read(text: str, item: FormatItem) -> tuple[float, bool, bool]:
    """Value, unreadable, doubtful of one field."""
    column = read_field(np.frombuffer(text.ljust(item.width).encode(), np.uint8)[None], item)
    return float(column.value[0]), bool(column.unreadable[0]), bool(column.doubtful[0])


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
    ("955462E -8", F10_1, 0.000955462, True),  # blanks behind the letter are skipped: 95546.2E-8
    ("955462E  8", F10_1, 9.55462e12, True),
    ("   1 2.5E1", F10_1, 1025.0, True),  # and so are those of its mantissa: 102.5E1
    ("      1 E2", F10_1, 100.0, True),  # 1.0E2
    ("   1.5 E+2", F10_1, 150.0, True),  # blanks in front of it are zeros: 1.50E+2
    ("    1.5E+ ", F10_1, 1.5, True),  # so are those behind a sign: E+0
    (".", F10_1, 0.0, True),  # no digit at all is zero
    ("    -", F5_0, 0.0, True),
    ("   E5", F5_0, 0.0, True),
    ("--1", F5_0, 0.0, True),  # zero, with an exponent of -1
]


@pytest.mark.parametrize("text", ["-0", "-0.", "-.0", "-000000000", "-0E5", "  -0"])
@pytest.mark.parametrize("cards", [1, 500])
def test_minus_zero_keeps_its_sign(text: str, cards: int) -> None:
    """As gfortran reads it, however many cards are read together; and blanks have none."""
    fields = [text.rjust(F10_1.width), " " * F10_1.width] * cards
    columns = np.frombuffer("".join(fields).encode(), np.uint8).reshape(-1, F10_1.width)
    values = read_field(columns, F10_1).value
    assert (values == 0.0).all() and np.signbit(values).tolist() == [True, False] * cards


@pytest.mark.parametrize(("text", "item", "value", "doubtful"), HAND)
def test_by_hand(text: str, item: FormatItem, value: float, doubtful: bool) -> None:
    assert read(text, item) == (value, False, doubtful)


@pytest.mark.parametrize(
    "text", ["5O.3", "1.2.3", "1-", "1_000", "1D", "1E+", "INF", "NAN", "1E+999"]
)
def test_what_is_no_number(text: str) -> None:
    assert read(text.rjust(10), F10_1)[1]


IMPLIED = {76: 12.345, 78: 12345.0, 79: 1234.5, 81: 1234.5, 82: 1234.5, 83: 123.45, 86: 12.345}
"""12345 without a point, in the real fields of each FORMAT of A 459 to A 470."""


@pytest.mark.parametrize("number", IMPLIED)
def test_the_decimals_that_a_format_implies(number: int) -> None:
    fields = [item for item in format_items(number) if item.kind == "F"]
    assert fields and IMPLIED.keys() == FORMATS.keys() - {77, 80, 84}
    for item in fields:
        assert read("12345".rjust(item.width), item) == (IMPLIED[number], False, False)


@pytest.mark.parametrize("text", ["  1.2", "    -", "  1E2", "0x1F"])
def test_what_is_no_whole_number(text: str) -> None:
    assert read(text, I5)[1]


punched = st.text(alphabet=" 0123456789.-+ED", min_size=1, max_size=10)
digits = st.text(alphabet=" 0123456789.-", min_size=1, max_size=10)


@given(punched | digits, st.sampled_from(FIELDS))
@example("9279 3E261", F10_1)
@example("0D ", F7_3)  # which gfortran refuses
def test_as_fortranformat_reads_it(text: str, item: FormatItem) -> None:
    """fortranformat, blanks made zeros by hand, is the authority on what a field holds.

    Named exceptions: it rounds an implied point together with an exponent a
    bit off, takes infinity, and an exponent without digits or of blanks alone, for
    a number, and refuses blanks behind an exponent's letter and numbers without digits;
    `test_as_gfortran_reads_it` has those.
    """
    text = text[: item.width].rjust(item.width)
    value, bad, _ = read(text, item)
    number = text.lstrip()
    zeros = " " * (len(text) - len(number)) + number.replace(" ", "0")
    try:
        known = FortranRecordReader(f"({item.descriptor})").read(zeros)[0] or 0
    except (ValueError, OverflowError):
        assert bad or re.search(r"[ED] +[-+\d]|^[ +-]*\.? *([ED]|[-+]|$)", text)
        return
    if np.isinf(float(known)) or not number.strip("+-") or re.search(r"[ED+-]$|[ED] +$", text):
        return
    huge_exponent = re.search(r"[ED+-][ \d]{5,}$", text)  # gfortran takes up to 9999
    assert not bad or not re.search(r"\d", number) or huge_exponent
    if not bad:
        by_a_power = known and re.search(r"[ED]|\d[+-]", zeros)
        if by_a_power:
            assert_close("number by a power of ten", value / known, 1.0)
        else:
            assert value == known


PROGRAM = """
program read_fields
character(10) :: field
real(8) :: value
integer :: status
do
  read(*, '(A10)', end=9) field
  value = 0
  read(field, '(F10.1)', iostat=status, blank='zero') value
  print '(I8,ES30.20E3)', status, value
end do
9 continue
end program
"""


@pytest.mark.skipif(shutil.which("gfortran") is None, reason="no gfortran here")
def test_as_gfortran_reads_it(tmp_path: Path) -> None:
    """Every kind of field, to the last bit; only what is too large for a number is refused."""
    source, program = tmp_path / "read_fields.f90", tmp_path / "read_fields"
    source.write_text(PROGRAM, encoding="ascii")
    subprocess.run(["gfortran", "-std=legacy", str(source), "-o", str(program)], check=True)
    random = Random(1974)
    alphabets = [" 0123456789.-+ED", " 0123456789.-", "  15E+-. ", "  5D-.", "0123456789. "]
    texts = []
    for _ in range(30_000):
        width = random.randint(1, 10)
        text = "".join(random.choices(random.choice(alphabets), k=width))
        texts.append(text.rjust(10) if random.random() < 0.5 else text.ljust(10))
    done = subprocess.run(
        [str(program)], input="\n".join(texts) + "\n", capture_output=True, text=True, check=True
    )
    block = np.frombuffer("".join(texts).encode(), np.uint8).reshape(-1, 10)
    read_here = read_field(block, F10_1)
    different = []
    for text, line, value, bad in zip(
        texts, done.stdout.splitlines(), read_here.value, read_here.unreadable, strict=True
    ):
        refused, known = int(line[:8]) != 0 or np.isinf(float(line[8:])), float(line[8:])
        if bad != refused or not (bad or known.hex() == float(value).hex()):
            different.append((text, line, value))
    assert not different
    assert 0.1 < read_here.unreadable.mean() < 0.9


@given(
    st.sampled_from(["", " ", "-"]),
    st.text("0123456789", min_size=1, max_size=9),
    st.sampled_from([F7_3, F10_1]),
)
def test_implied_points_are_rounded_correctly(sign: str, digits: str, item: FormatItem) -> None:
    text = (sign + digits)[: item.width].strip() or "0"
    if text == "-":
        text = "-0"
    exact = Decimal(text).scaleb(-item.decimals)
    assert read(text.rjust(item.width), item)[0] == float(exact)


@given(punched, st.sampled_from(FIELDS))
def test_what_is_read_can_be_written_and_reads_the_same(text: str, item: FormatItem) -> None:
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
def test_many_cards_are_each_read_alone(texts: list[str], item: FormatItem) -> None:
    texts = [text[: item.width].rjust(item.width) for text in texts]
    block = np.frombuffer("".join(texts).encode(), np.uint8).reshape(len(texts), item.width)
    columns = read_field(block, item)
    for k, text in enumerate(texts):
        value, bad, doubtful = read(text, item)
        assert (columns.unreadable[k], columns.doubtful[k]) == (bad, doubtful)
        assert np.array_equal(columns.value[k], value, equal_nan=True)


def test_columns_of_the_formats() -> None:
    """Appendix E: landmark 9 to 10, x 41 to 47, y 51 to 57, frame 64 to 67."""
    assert [(i.kind, i.first, i.last) for i in format_items(86)] == [
        ("I", 9, 10), ("F", 41, 47), ("F", 51, 57), ("I", 64, 67)
    ]  # fmt: skip
    assert [len(format_items(n)) for n in FORMATS] == [2, 80, 8, 3, 16, 2, 8, 6, 7, 4]


F10_3 = FormatItem("F", 1, 10, 3)


@pytest.mark.parametrize(
    ("value", "item", "words"),
    [
        (1 / 3, F10_1, "rounded to 9 decimals, 0.333333333"),
        (-1 / 3, F10_1, "rounded to 8 decimals, -0.33333333"),
        (123.456789012, F10_3, "rounded to 6 decimals, 123.456789"),
        (10.12345, F7_3, "rounded to 4 decimals, 10.1235"),  # in binary a little above the tie
        (1 / 3e9, F10_1, "rounded to 7 significant digits, 3.333333e-10"),
        (123456789012.0, F10_1, "rounded to 8 significant digits, 1.2345679e+11"),
        (9.99999999999, F7_3, "rounded to 11 significant digits, 10"),
    ],
)
def test_the_nearest_number_that_fits(value: float, item: FormatItem, words: str) -> None:
    """As many digits as the field has columns for, less those of the point and the exponent."""
    assert write_number(value, item) is None
    assert nearest_that_fits(value, item) == words
    rounded = float(words.split()[-1])
    assert write_number(rounded, item) is not None


def test_nothing_helps_a_whole_number_that_is_too_long() -> None:
    assert nearest_that_fits(123456.0, I5) == ""
    assert nearest_that_fits(float("inf"), F10_1) == ""
    assert nearest_that_fits(-123456.0, FormatItem("F", 1, 2, 0)) == ""


# Exponents


F10, INTEGER = FormatItem("F", 1, 10, 3), FormatItem("I", 1, 5)

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
    read = read_field(block, F10)
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
def test_what_is_no_whole_number_of_exponent(text: str) -> None:
    assert read_few([text.encode()], [INTEGER]).unreadable.tolist() == [True]


# Numbers as they are punched


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
    with refused(VopdError):
        basic_data_cards(replace(JOB, readings=reread(JOB.readings, landmark_in=landmark)))


F5 = FormatItem("F", 1, 5)
ROUNDED = [  # the number of decimals in words: one is singular, and whole numbers have digits
    (12.34, FormatItem("F", 1, 4), "rounded to 1 decimal, 12.3"),
    (1.234, FormatItem("F", 1, 4), "rounded to 2 decimals, 1.23"),
    (-1.26, FormatItem("F", 1, 4), "rounded to 1 decimal, -1.3"),
    (1 / 3, F5, "rounded to 4 decimals, 0.3333"),
    (123456.0, F5, "rounded to 3 significant digits, 1.23e+05"),  # 123E3
    (float("nan"), F5, ""),
    (float("inf"), F5, ""),
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
    assert write_number(value, F5) is None and write_number(value, FormatItem("I", 1, 5)) is None
    wind = replace(JOB.wind, altitude_ft=np.array([0.0, value, 2.0]))
    with refused(VopdError):
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
    "number",
    [
        100,
        -1,
    ],
)
def test_a_landmark_that_has_no_room(number: int) -> None:
    landmark = JOB.readings.landmark.copy()
    landmark[0, 1] = number
    with refused(VopdError):
        basic_data_cards(replace(JOB, readings=reread(JOB.readings, landmark=landmark)))
    for most in (0, 99):
        landmark[0, 1] = most
        basic_data_cards(replace(JOB, readings=reread(JOB.readings, landmark=landmark)))
