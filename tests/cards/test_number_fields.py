"""Fields to numbers and back: by hand, by exact decimals, and by fortranformat."""

from __future__ import annotations

import re
import shutil
import subprocess
from decimal import Decimal
from pathlib import Path
from random import Random

import numpy as np
import pytest
from fortranformat import FortranRecordReader
from hypothesis import example, given
from hypothesis import strategies as st

from tests.tolerances import assert_close
from vopd.cards.format import FORMATS, FormatItem, format_items
from vopd.cards.numbers import nearest_that_fits, read_field, write_number

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
