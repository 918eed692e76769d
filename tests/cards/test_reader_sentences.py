"""Every sentence of the reader about a card: message, card, field, columns, severity, image."""

from __future__ import annotations

import pytest

from tests.kit.cards import edited, said
from vopd.findings import Finding

FIELDS = {  # the edit, card by column; group, field, columns, severity, message
    "a whole number": (
        (31, 1, "  3.5"), 5, "number of landmarks (group 9)", (1, 5), "error",
        "not a whole number: '3.5'",
    ),
    "a number": (
        (39, 41, "  5O.3    "), 9, "landmark latitude minutes", (41, 50), "error",
        "not a number: '5O.3'",
    ),
    "blanks": (
        (32, 6, "   48.07 3"), 6, "flight time", (6, 15), "warning",
        "blanks read as zeros: '   48.07 3' is 48.0703",
    ),
    "blanks, many digits": (
        (28, 1, "1234567 9."), 4, "altitude above sea level", (1, 10), "warning",
        "blanks read as zeros: '1234567 9.' is 123456709",
    ),
    "no digits": (
        (27, 16, "  -. "), 3, "yaw offset", (16, 20), "warning",
        "a number without digits: '-.' is -0",
    ),
    "a fiducial's landmark": (
        (50, 9, "07"), 0, "landmark number", (9, 10), "warning",
        "landmark 7 on a card that should be a fiducial's (00)",
    ),
    "a frame": (
        (70, 64, "0713"), 0, "frame number", (64, 67), "error",
        "frame 713 among the cards of frame 731",
    ),
    "the first card of a frame": (
        (44, 64, "0999"), 0, "frame number", (64, 67), "error",
        "frame 999 among the cards of frame 730",
    ),
    "the last card of a frame": (
        (85, 64, "0999"), 0, "frame number", (64, 67), "error",
        "frame 999 among the cards of frame 731",
    ),
    "the first of three readings": (
        (56, 9, "66"), 0, "landmark number", (9, 10), "error",
        "three readings of one landmark are numbered 66, 65, 65",
    ),
    "the second of three readings": (
        (57, 9, "66"), 0, "landmark number", (9, 10), "error",
        "three readings of one landmark are numbered 65, 66, 65",
    ),
    "the third of three readings": (
        (58, 9, "66"), 0, "landmark number", (9, 10), "error",
        "three readings of one landmark are numbered 65, 65, 66",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", FIELDS)
def test_a_sentence_about_a_field(name: str) -> None:
    edit, group, field, columns, severity, message = FIELDS[name]
    cards = edited(edit)
    (found, *_) = said(cards)
    image = cards[edit[0] - 1].ljust(80)
    assert found.severity == severity
    assert found == Finding(
        message, "a.dat", edit[0], None, group, field, columns, image, found.severity
    )


TAB = "a tab; cards have only blanks between their fields"
BYTE = "byte {} is not a printable ASCII character; is this a card deck?"
LONG = "a card has 80 columns, and this line is longer"
CHARACTERS = {  # a text put into card 28, at a column: the column named, and why
    "a tab": (5, "\t", 5, TAB),
    "a control": (80, "\x01", 80, BYTE.format("0x01")),
    "a letter": (7, "\xe9", 7, BYTE.format("0xe9")),
    "delete": (7, "\x7f", 7, BYTE.format("0x7f")),
    "column 81": (81, "x", 81, LONG),
    "column 90": (81, "         x", 90, LONG),
    "a tab behind": (81, "         \t", 90, TAB),
    "column 82 and a tab": (81, " x\t", 82, LONG),
}


@pytest.mark.parametrize("name", CHARACTERS)
def test_a_line_that_is_no_card(name: str) -> None:
    """The image has a question mark for what is not printable, and 80 columns at most."""
    at, text, column, message = CHARACTERS[name]
    cards = edited((28, at, text))
    (found, *_) = said(cards, "latin-1")
    image = "".join(c if " " <= c <= "~" else "?" for c in cards[27].rstrip(" "))[:80]
    assert found == Finding(message, "a.dat", 28, None, 4, "", (column, column), image)


@pytest.mark.parametrize("text", [" ", " \r", "\r"])
def test_blanks_behind_column_80_and_a_carriage_return_are_no_columns(text: str) -> None:
    assert said(edited((28, 81, text))) == []
    assert said(edited((28, 80, "~"))) == []


@pytest.mark.parametrize(
    ("column", "character"), [(1, "\t"), (2, "\x01"), (60, "\t"), (71, "\xe9")]
)
def test_what_is_not_printable_is_read_as_a_blank(column: int, character: str) -> None:
    """Nothing else is said of its field, in front of the number or behind the last field."""
    cards = edited((28, column, character))
    found = said(cards, "latin-1")
    assert [(one.card, one.columns, one.severity) for one in found] == [
        (28, (column, column), "error")
    ]
