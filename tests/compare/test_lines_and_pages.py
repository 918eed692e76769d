"""Pages and lines of a listing, their kinds and pairs, and files that are read as listings."""

from __future__ import annotations

import io
import sys
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vopd.findings import VopdError
from vopd.listing import lines as module
from vopd.listing.compare import read_listing
from vopd.listing.formats import LINES
from vopd.listing.lines import (
    BLANK_LINE,
    OTHER_KIND,
    ListingLine,
    ListingPage,
    Pairs,
    align,
    could_be,
    frames_of_lines,
    is_listing,
    line_cost,
    page_cost,
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


# Pairs of pages and lines


# Alignment against a plain recursive reference, and its promises on any two sequences


class Thing(NamedTuple):
    text: int
    key: int | None
    place: int = 0


def things(values: list[int], keyed: bool) -> list[Thing]:
    """Numbers; the key of a number, if it has one, is its tens."""
    return [Thing(v, v // 10 if keyed else None, place) for place, v in enumerate(values)]


def cost(one: Thing, other: Thing) -> float:
    return min(abs(one.text - other.text) / 4, 2.25)  # exact in binary


def total(pairs: Pairs[Thing]) -> float:
    return sum(cost(one, other) if one and other else 1.0 for one, other in pairs)


def least(expected: list[Thing], actual: list[Thing]) -> float:
    """The least total there is, by trying everything."""

    @cache
    def rest(i: int, j: int) -> float:
        if i == len(expected) or j == len(actual):
            return len(expected) - i + len(actual) - j
        both = cost(expected[i], actual[j]) + rest(i + 1, j + 1)
        return min(both, 1 + rest(i + 1, j), 1 + rest(i, j + 1))

    return rest(0, 0)


def check_order(pairs: Pairs[Thing], expected: list[Thing], actual: list[Thing]) -> None:
    assert [one for one, _ in pairs if one is not None] == expected
    assert [other for _, other in pairs if other is not None] == actual
    assert (None, None) not in pairs


VALUES = st.lists(st.integers(0, 60), max_size=12)


@settings(max_examples=150)
@given(VALUES, VALUES, st.booleans())
def test_order_is_kept_and_nothing_is_lost(one: list[int], two: list[int], keyed: bool) -> None:
    expected, actual = things(one, keyed), things(two, keyed)
    check_order(align(expected, actual, cost), expected, actual)


@settings(max_examples=150)
@given(VALUES, VALUES)
def test_pairs_are_the_cheapest(one: list[int], two: list[int]) -> None:
    # every number twice, so that none is an anchor; another at either end, so that nothing is cut
    expected = things([100, *one, *one, 100], keyed=False)
    actual = things([200, *two, *two, 200, 200], keyed=False)
    assert total(align(expected, actual, cost)) == least(expected, actual)


@pytest.mark.parametrize("limit", [400, 100_000])
@pytest.mark.parametrize("lost", [1, 3, 30])
def test_long_sequences_are_searched_near_the_diagonal(
    limit: int, lost: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "SEARCH_LIMIT", limit)
    values = [k % 7 * 10 for k in range(200)]
    expected = things(values, keyed=False)
    actual = [Thing(v + 1, None) for v in values[:50] + values[50 + lost :]]
    pairs = align(expected, actual, cost)
    check_order(pairs, expected, actual)
    if limit == 400 and lost == 30:  # too far apart to search: in order, what is alike
        assert pairs[:50] == list(zip(expected[:50], actual[:50], strict=True))
        assert all(cost(one, other) <= 2 for one, other in pairs if one and other)
        assert pairs[-1] == (expected[-1], None)
        return
    assert total(pairs) == lost + (200 - lost) * 0.25


@pytest.mark.parametrize("marks", ["text", "key"])
def test_what_bears_a_mark_alone_needs_no_search(
    marks: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "SEARCH_LIMIT", 1)
    # either whole things are alone and keys repeat, or the other way round, with all else changed
    expected = [Thing(10 * k, k if marks == "key" else k % 3) for k in range(200)]
    change = 1 if marks == "key" else 0
    actual = [Thing(thing.text + change, thing.key) for thing in expected[40:150]]
    pairs = align(expected, actual, cost)
    assert pairs[:40] == [(thing, None) for thing in expected[:40]]
    assert pairs[40:150] == list(zip(expected[40:150], actual, strict=True))
    assert pairs[150:] == [(thing, None) for thing in expected[150:]]


def test_equal_keys_stand_side_by_side_whatever_they_cost() -> None:
    expected, actual = things([10, 20, 30], True), things([19, 29, 39], True)
    assert align(expected, actual, cost) == list(zip(expected, actual, strict=True))


@pytest.mark.parametrize("lost", range(5))
def test_keys_alone_pair_before_and_behind_equal_texts(lost: int) -> None:
    """What stands between two texts that are found once each is paired by its key, at any cost."""
    texts, keys = [0, 20, 40, 60, 80], [1, 2, 3, 4, 5]
    expected = [Thing(t, k) for t, k in zip(texts, keys, strict=True)]
    actual = [Thing(t if k == 3 else t + 500, k) for t, k in zip(texts, keys, strict=True)]
    del actual[lost]
    partners = [one for one in actual if one.key != 3]
    assert all(cost(one, two) > 2 for one, two in zip(expected, partners, strict=False))
    pairs = align(expected, actual, cost)
    paired = {one.key: other.key for one, other in pairs if one and other}
    assert paired == {key: key for key in keys if key != keys[lost]}


def test_of_equal_choices_pairs_come_first() -> None:
    expected, actual = things([1], False), things([1, 1], False)
    assert align(expected, actual, cost) == [(expected[0], actual[0]), (None, actual[1])]
    expected, actual = things([1], False), things([2, 2], False)
    assert align(expected, actual, cost) == [(expected[0], actual[0]), (None, actual[1])]


def test_of_equal_elements_the_first_are_paired_from_both_ends() -> None:
    """Those that are left over stand behind, but before what is equal at the end."""
    expected, actual = things([1, 1], False), things([1], False)
    assert align(expected, actual, cost) == [(expected[0], actual[0]), (expected[1], None)]
    expected, actual = things([2, 2], False), things([1], False)
    assert align(expected, actual, cost) == [(expected[0], actual[0]), (expected[1], None)]
    expected, actual = things([5, 1], False), things([7, 1, 1], False)
    assert align(expected, actual, cost) == [
        (expected[0], actual[0]), (None, actual[1]), (expected[1], actual[2])
    ]  # fmt: skip


def test_equal_runs_of_keys_that_repeat_stand_side_by_side() -> None:
    expected, actual = [Thing(0, 1), Thing(9, 1)], [Thing(500, 1), Thing(900, 1)]
    assert align(expected, actual, cost) == list(zip(expected, actual, strict=True))


def test_what_is_too_much_to_search_is_paired_in_order(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the cost is 2 or less; the one of EXPECTED first where it is not."""
    monkeypatch.setattr(module, "SEARCH_LIMIT", 0)
    expected, actual = things([0, 0, 100], False), things([8, 9, 99, 97], False)
    costs = [cost(one, other) for one, other in zip(expected, actual, strict=False)]
    assert costs == [2.0, 2.25, 0.25]
    assert align(expected, actual, cost) == [
        (expected[0], actual[0]), (expected[1], None), (None, actual[1]), (expected[2], actual[2]),
        (None, actual[3]),
    ]  # fmt: skip


def test_two_hundred_elements_are_searched_throughout() -> None:
    """Thirty are lost at the start and 29 added at the end."""
    values = [10 * int(digit) for digit in str(2**800)]
    expected = things(values[:200], keyed=False)
    actual = [Thing(v + 1, None) for v in values[30:229]]
    assert total(align(expected, actual, cost)) <= 30 + 29 + 170 * 0.25


def test_an_equal_text_goes_before_an_equal_key() -> None:
    expected = [Thing(100, None), Thing(1, 1), Thing(2, 2), Thing(300, None)]
    actual = [Thing(200, None), Thing(2, 1), Thing(400, None)]
    assert (expected[2], actual[1]) in align(expected, actual, cost)


# What pairing two pages or two lines costs: which are the same thing, and which are two


ATTITUDE = LINES["attitude heading"].text
ALONE = 2.0
"""What two elements cost that are left without a partner: pairing must cost less to be chosen."""


def page(frame: int | None, *texts: str) -> ListingPage:
    """A page with these lines of its own, and the line of its frame where it has a number."""
    row = [] if frame is None else [ATTITUDE, f"{frame:5d}   75.000"]
    return ListingPage(1, 1, [*texts, *row])


PAGES = {  # two pages: the share of distinctive lines that differ, and the cost by it
    "equal": (page(7, "A", "B"), page(7, "A", "B"), 0.0),
    "one frame, half of its lines": (page(7, "A"), page(7, "B"), 0.3 / 2),
    "one frame, of 3 lines 1": (page(7, "A", "B"), page(7, "A", "C"), 0.3 / 3),
    "two frames, nothing in common": (page(7, "A"), page(8, "B"), 0.5 + 1.7),
    "two frames, of 2 lines 1": (page(7, "A"), page(8, "A"), 0.5 + 1.7 / 2),
    "two frames, of 10 lines 9": (page(7, *"ABCDEFGHI"), page(8, *"ABCDEFGHI"), 0.5 + 0.17),
    "no frame, nothing in common": (page(None, "A"), page(None, "B"), 0.2 + 1.7),
    "no frame, half in common": (page(None, "A", "B"), page(None, "A", "C"), 0.2 + 1.7 / 2),
    "a frame and none": (page(7, "A"), page(None, "A"), 0.2 + 1.7 / 2),
    "illegible, as long": (page(None, "?", "?"), page(None, "A", "B"), 0.2),
    "illegible, half as long": (page(None, "?", ""), page(7, "A", "B"), 0.2 + 0.8),
}


@pytest.mark.parametrize("name", PAGES)
def test_two_pages(name: str) -> None:
    one, other, cost = PAGES[name]
    assert round(page_cost(one, other), 12) == round(cost, 12)


def test_which_pages_are_paired() -> None:
    """Another frame is another page, unless it shares an eighth of its lines or more."""
    assert page_cost(page(7, "A", *"STUVWX"), page(8, *"ABCDEFG")) < ALONE
    assert page_cost(page(7, "A", *"STUVWXY"), page(8, *"ABCDEFGH")) > ALONE
    assert page_cost(page(7, "A"), page(7, "B")) < page_cost(page(7, "A"), page(8, "A"))


def line(text: str, above: str = "film heading") -> ListingLine:
    """A line under a heading."""
    heading = LINES[above].text
    (_, kind) = recognise_lines([heading, text])
    return ListingLine(text, kind, 2)


FILM = "  65        2.52977        1.71440        3.05597        -.04424"
OTHER = FILM.replace("2.52977", "2.52978")
NAMED = FILM.replace(" 65 ", " 66 ")
ALL = "  66        1.11111        1.22222        1.33333        -.14444"
COSTS = {
    "the same": (line(FILM), line(FILM), 0.0),
    "illegible": (ListingLine("?", None, 2), line(FILM), 0.1),
    "a blank line": (line(FILM), ListingLine("", None, 2), BLANK_LINE),
    "one of five fields": (line(FILM), line(OTHER), 0.2 + 0.6 / 5),
    "a number in another column": (
        line(FILM),
        line(FILM.replace(" 2.52977", "2.52977 ")),
        0.2 + 0.6 / 5,
    ),
    "the landmark alone": (line(FILM), line(NAMED), 0.3),
    "all fields": (line(FILM), line(ALL), 0.3 + 2.2 * 4 / 5),
    "an illegible field": (line(FILM.replace("2.52977", "???????")), line(OTHER), 0.2),
    "another kind": (line(FILM), ListingLine(ATTITUDE, LINES["attitude heading"], 2), OTHER_KIND),
}


@pytest.mark.parametrize("name", COSTS)
def test_two_lines(name: str) -> None:
    one, other, cost = COSTS[name]
    assert round(line_cost(one, other), 12) == round(cost, 12)


def test_another_landmark_with_all_other_numbers_is_another_line() -> None:
    assert line_cost(line(FILM), line(ALL)) > ALONE > line_cost(line(FILM), line(NAMED))
    assert OTHER_KIND < BLANK_LINE < ALONE


# Files


END = b" END OF CASE\r\n~ !\n"
REFUSED = {
    b"": "empty, not a listing",
    b"text\n": "not a listing: it has none of a listing's headings "
    "(vopd run prints the listing of a deck)",
    b"a\tb": "not a listing: line 1 has the byte 0x09, which is not a printable ASCII character",
    END + b"\x7f": "not a listing: line 3 has the byte 0x7F, which is not a printable ASCII "
    "character",
    END + b"a\xe9\xff": "not a listing: line 3 has the byte 0xE9, which is not a printable ASCII "
    "character",
    b"\n" * 70_000 + b"\x1f": "not a listing: line 70001 has the byte 0x1F, which is not a "
    "printable ASCII character",
}


@pytest.mark.parametrize("name", ["-", "a.lst"])
@pytest.mark.parametrize("content", REFUSED, ids=range(len(REFUSED)))
def test_what_is_no_listing(
    content: bytes, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By the name of the file, or standard input."""
    monkeypatch.chdir(tmp_path)
    Path("a.lst").write_bytes(content)
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(content)))
    with pytest.raises(VopdError) as refused:
        read_listing(name)
    where = "standard input" if name == "-" else name
    assert str(refused.value) == f"{where}: {REFUSED[content]}"


def test_a_listing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Longer than a piece that is read at a time; carriage returns are kept."""
    content = END + b"x" * 200_000
    file = tmp_path / "a.lst"
    file.write_bytes(content)
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(END)))
    assert read_listing(str(file)) == content.decode()
    assert read_listing("-") == END.decode()


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    for path, reason in ((tmp_path / "no.lst", "no such file"), (tmp_path, "is a folder")):
        with pytest.raises(VopdError) as refused:
            read_listing(str(path))
        assert str(refused.value).startswith(f"{path}: {reason}")
