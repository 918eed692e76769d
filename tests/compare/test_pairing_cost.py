"""What pairing two pages or two lines costs: which are the same thing, and which are two."""

from __future__ import annotations

import pytest

from vopd.listing.formats import LINES
from vopd.listing.lines import (
    BLANK_LINE,
    OTHER_KIND,
    ListingLine,
    ListingPage,
    line_cost,
    page_cost,
    recognise_lines,
)

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
