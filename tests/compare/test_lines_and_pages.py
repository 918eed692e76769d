"""How a listing is split into pages, which kind each line has, and what it is about."""

from __future__ import annotations

from pathlib import Path

import pytest

from vopd.listing.formats import LINES
from vopd.listing.lines import (
    ListingLine,
    ListingPage,
    could_be,
    frames_of_lines,
    is_listing,
    recognise_lines,
    split_pages,
)

PAGE = (Path(__file__).parents[1] / "listing" / "case1_page.lst").read_text(encoding="ascii")
TITLE, _, HEADING, *_ = PAGE.split("\n")
LANDMARK = PAGE.split("\n")[3]
IGNORED = "   70  IGNORED BY USERS DIRECTION"
DROPPED = "      FRAME 731IGNORED BY USERS DIRECTION"
ZEROS = "       7.00000000E-10       0.00000000E+00"


def names(*lines: str, damaged: bool = False) -> list[str]:
    """The names of the kinds of these lines."""
    return [kind.name if kind else "" for kind in recognise_lines(lines, damaged)]


def heading(name: str) -> str:
    return LINES[name].text


RECOGNISED: dict[str, tuple[list[str], list[str]]] = {
    "rows under their heading": (
        [heading("reading heading"), "  65  1.0", heading("film heading"), "  65  1.0"],
        ["reading heading", "reading", "film heading", "film"],
    ),
    "a row without a heading": (["  65  1.0", ""], ["", ""]),
    "a heading without rows of its own": (
        [heading("reading heading"), heading("end of job"), "  65  1.0"],
        ["reading heading", "end of job", ""],
    ),
    "an ignored landmark does not end its table": (
        [heading("landmark heading"), IGNORED, "  65  1.0"],
        ["landmark heading", "landmark ignored", "landmark"],
    ),
    "an ignored frame does": (
        [heading("landmark heading"), DROPPED, "  65  1.0"],
        ["landmark heading", "frame ignored", ""],
    ),
    "a title does": (
        [heading("landmark heading"), "1 title 5", "  65  1.0"],
        ["landmark heading", "title", ""],
    ),
    "any words do": (
        [heading("landmark heading"), "  some words", "  65  1.0"], ["landmark heading", "", ""]
    ),
    "also in capitals": (
        [heading("landmark heading"), "  WORDS", "  65  1.0"], ["landmark heading", "", ""]
    ),
    "three letters, an exponent, NaN and Infinity do not": (
        [heading("film heading"), "  NaN abc", "  Infinity 5", "  1.0E+05", "  INFINITY"],
        ["film heading", *["film"] * 4],
    ),
    "four letters behind one word": (
        [heading("film heading"), "  Infinity word", "  65"], ["film heading", "", ""]
    ),
    "blank lines before zeros, after group 3": (
        [heading("reading heading"), "  65  1.0", "", "", ZEROS, "", "", ZEROS],
        ["reading heading", "reading", "", "", "zero residual", "", "", "zero residual"],
    ),
    "and after group 6": (
        [heading("residual heading"), "  1.0", "", "", ZEROS],
        ["residual heading", "residual", "", "", "zero residual"],
    ),
    "not after another": (
        [heading("film heading"), "  65  1.0", "", "", ZEROS],
        ["film heading", "film", "", "", "film"],
    ),
    "a table out of order": (
        ["1TABLE BELOW OUT OF ORDER FOR FTLUP AT POSITION     2",
         " TABLE IS STORED IN LOCATION 000000", "", "   3.0000000"],
        ["table out of order", "table location", "", "table values"],
    ),
    "the standard deviation": (
        [heading("residual heading"), "0        STANDARD DEVIATION OF RESIDUALS       .5", "  65"],
        ["residual heading", "standard deviation", ""],
    ),
    "a question mark is text": (
        [heading("film heading"), "?", "  65  1.0"], ["film heading", "", "film"]
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", RECOGNISED)
def test_kinds_of_lines(name: str) -> None:
    lines, kinds = RECOGNISED[name]
    assert names(*lines) == kinds


def test_an_illegible_line_may_have_been_a_heading() -> None:
    lines = heading("film heading"), "  65  1.0", "?", "  65  1.0"
    assert names(*lines, damaged=True) == ["film heading", "film", "", ""]


def test_pages() -> None:
    """Each begins with a 1 in the first column, but the first with the first line."""
    text = "0 FIRST  \n\n1 SECOND\r\n line\n\n1\n"
    pages = split_pages(text.replace("\r", ""))
    assert [(one.number, one.first_line, one.lines) for one in pages] == [
        (1, 1, ["0 FIRST", ""]), (2, 3, ["1 SECOND", " line", ""]), (3, 6, ["1"])
    ]  # fmt: skip
    assert [one.lines for one in split_pages("1 A\n B")] == [["1 A", " B"]]
    assert [one.lines for one in split_pages("1 A\n\n\n")] == [["1 A", "", ""]]
    assert split_pages("") == []


def test_what_a_page_is_about() -> None:
    """The number in the row below the heading of group 5, if there is one."""
    above = heading("attitude heading")
    rows = {
        "  730  75.8": "730", "    7": "7", "*****  75.8": None, "  7?0  75.8": None, "": None,
        "  -12  75.8": None, "123456": "12345",
    }  # fmt: skip
    for row, key in rows.items():
        assert ListingPage(1, 1, ["1 A", above, row]).key == key
    assert ListingPage(1, 1, ["1 A", "  730  75.8"]).key is None
    assert ListingPage(1, 1, ["1 A", above]).key is None
    page = ListingPage(1, 5, ["1 A", above, "?", "", "  7", "1 A"])
    assert page.distinctive_lines == {"1 A", "  7"}
    assert page.text == ("1 A", above, "?", "", "  7", "1 A")
    lines = page.with_kinds(recognise_lines(page.lines))
    assert [one.number for one in lines] == [5, 6, 7, 8, 9, 10]


ABOUT = {  # kind, text: key, about, landmark
    ("film", "  65  1.0"): (("film", "65"), "65", "65"),
    ("residual", f"  1.0{65:39d}"): (("residual", "65"), "65", "65"),
    ("attitude", "  730  1.0"): (("attitude", "730"), "730", ""),
    ("landmark ignored", IGNORED): (("landmark ignored", "70"), "70", "70"),
    ("frame ignored", DROPPED): (("frame ignored", "731"), "731", ""),
    ("vehicle", "   1.0"): (("vehicle", ""), "", ""),
    ("", "text"): (("", "text"), "", ""),
    ("", ""): (None, "", ""),
}  # fmt: skip


@pytest.mark.parametrize(("kind", "text"), ABOUT)
def test_what_a_line_is_about(kind: str, text: str) -> None:
    line = ListingLine(text, LINES.get(kind), 1)
    assert (line.key, line.about, line.landmark) == ABOUT[kind, text]


def test_frames_of_lines() -> None:
    """All lines of a frame have its number, and so do those behind its row; those before
    the second heading of group 1 belong to the first."""
    group_5 = [heading("attitude heading"), "    7  1.0"]
    lines = [
        "1 A", HEADING, "  65", *group_5, " text", HEADING, "  65", "", DROPPED, HEADING, "  65",
        heading("attitude heading"), "    8  1.0", "  behind",
    ]  # fmt: skip
    found = frames_of_lines(lines, recognise_lines(lines))
    assert found == [*["7"] * 6, "", "", "", "731", *["8"] * 5]
    alone = ["1 A", "", DROPPED, "  65"]
    assert frames_of_lines(alone, recognise_lines(alone)) == ["", "", "731", ""]


@pytest.mark.parametrize(
    ("kind", "text", "may"),
    [
        ("reading", "  65     1.12345678     2.12345678", True),
        ("reading", "  65     1.12345678     *****", True),
        ("reading", "  65     1.12345678     ???????", True),
        ("reading", "  65     1.1234567      2.12345678", True),  # the point is where it should be
        ("reading", "  65    1.12345678      2.12345678", False),
        ("reading", "  6x     1.12345678     2.12345678", False),
        ("reading", "  65     1.12345678", True),
        ("reading", "", False),
        ("reading", "     ", False),
        ("reading", "?", False),
        ("reading heading", "0 L-MARK  XCO FINAL     YCO FINAL", False),  # it has no fields
        ("zero residual", ZEROS, True),
        ("zero residual", ZEROS.replace("E-10", "X-10"), False),
        ("title", "1 any text at all", True),
        ("title", " any text at all", False),
        ("frame ignored", DROPPED, True),
        ("frame ignored", " " + DROPPED, False),
        ("frame ignored", "      FRAME 731", False),
        ("frame ignored", DROPPED.replace("FRAME", "     "), False),
        ("frame ignored", DROPPED.replace("731", "   "), False),
    ],
)
def test_whether_a_text_can_be_a_line_of_a_kind(kind: str, text: str, may: bool) -> None:
    assert could_be(LINES[kind], text) is may


def test_what_a_listing_is() -> None:
    """A text with a line that only listings have, whatever stands around it."""
    for line in (HEADING, IGNORED, DROPPED, heading("end of case"), f"{HEADING}   "):
        assert is_listing(f"some text\n{line}\nmore")
    for text in (
        "",
        "some text\n1 a title\n  65  1.0",
        f"x{HEADING}",
        f"{HEADING}x",
        "      FRAME 731",
    ):
        assert not is_listing(text)
