"""Split a listing's text into pages and lines, and recognise the kind of each line.

The kinds are those of `vopd.listing.line_formats`. A line that has text of its own is known by that
text, a row of numbers by the heading above it. No number is read here; blanks at the end of a line
are dropped.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

from vopd.listing.line_formats import LINES, Field, Line

ILLEGIBLE = "?"
"""A line of a damaged listing with this alone stands for any one line."""

HEADINGS = {line.text: line for line in LINES.values() if line.literals and not line.fields}
_ROWS = {line.under: line for line in LINES.values() if line.under}
_WITH_TEXT = [
    line for line in LINES.values() if line.fields and line.text and line is not LINES["title"]
]
_ABOVE_ZEROS = (LINES["reading"], LINES["residual"])  # blank lines below mean FORMAT 102
_WORD = re.compile(r"(?i)(?<![a-z])(?!infinity)[a-z]{4}")
_FRAME = LINES["attitude"].fields[0].columns


class ListingLine(NamedTuple):
    """One line of a page: text, kind where that is known, and number in the file, from 1."""

    text: str
    kind: Line | None
    number: int

    @property
    def key(self) -> tuple[str, str] | None:
        """What lines must have in common to be compared with each other; None for a blank line."""
        if self.kind is None:
            return ("", self.text) if self.text else None
        return self.kind.name, self.about

    @property
    def about(self) -> str:
        """The number of the landmark or frame that the line is about, as printed."""
        field = self.kind.identity if self.kind else None
        return self.text[field.columns].strip() if field else ""

    @property
    def landmark(self) -> str:
        """The number of the landmark that the line is about, as printed."""
        field = self.kind.identity if self.kind else None
        return self.about if field and field.name == "L-MARK" else ""


class ListingPage:
    """The lines from one page eject to the next.

    Args:
        number: number of the page in the listing, from 1
        first_line: number of its first line in the file, from 1
        lines: its lines, without blanks at their ends
    """

    def __init__(self, number: int, first_line: int, lines: list[str]) -> None:
        self.number, self.first_line, self.lines = number, first_line, lines

    @cached_property
    def text(self) -> tuple[str, ...]:
        """The text of all lines."""
        return tuple(self.lines)

    @cached_property
    def key(self) -> str | None:
        """The frame number printed in output group 5; None where none can be read."""
        try:
            row = self.lines[self.lines.index(LINES["attitude heading"].text) + 1]
        except (ValueError, IndexError):
            return None
        frame = row[_FRAME].strip()
        return frame if frame.isdigit() else None

    @cached_property
    def distinctive_lines(self) -> frozenset[str]:
        """The lines that tell pages apart: all but headings and blank lines."""
        return frozenset(self.lines).difference(HEADINGS, ("", ILLEGIBLE))

    def with_kinds(self, kinds: Sequence[Line | None]) -> list[ListingLine]:
        """The page's lines with the kinds that `recognise_lines` found."""
        numbers = range(self.first_line, self.first_line + len(self.lines))
        return list(map(ListingLine, self.lines, kinds, numbers))


def is_listing(text: str) -> bool:
    """Whether a text is a listing: it has a line that only listings have."""
    return any(
        line.rstrip() in HEADINGS or any(_has_text_of(kind, line) for kind in _WITH_TEXT)
        for line in text.split("\n")
    )


def split_pages(text: str) -> list[ListingPage]:
    """Split a listing into pages: each begins with a line that has a 1 in its first column."""
    lines = [line.rstrip() for line in text.split("\n")]
    if not lines[-1]:
        lines.pop()  # what follows the end of the last line
    starts = [k for k, line in enumerate(lines) if k == 0 or line[:1] == "1"]
    return [
        ListingPage(number, start + 1, lines[start:stop])
        for number, (start, stop) in enumerate(zip(starts, [*starts[1:], None], strict=False), 1)
    ]


def recognise_lines(lines: Sequence[str], damaged: bool = False) -> list[Line | None]:
    """Find the kind of every line.

    Unknown text, or in a damaged listing an illegible line, may have been a heading: the rows after
    it are of no known kind until the next heading.

    Args:
        lines: lines of a page, without blanks at their ends
        damaged: whether a line of a single `?` stands for any one line

    Returns:
        A kind for each line; None for a blank line and for text that no FORMAT prints.
    """
    row: Line | None = None
    kinds: list[Line | None] = []
    for text in lines:
        kind = HEADINGS.get(text)
        if kind is not None:
            row = _ROWS.get(kind.name)
        elif not text:
            if row in _ABOVE_ZEROS:
                row = LINES["zero residual"]
        elif text == ILLEGIBLE:
            row = None if damaged else row
        elif text[0] == "1" or text.upper() != text.lower():
            kind = next((line for line in _WITH_TEXT if _has_text_of(line, text)), None)
            if kind is not None and kind is not LINES["landmark ignored"]:
                row = None
            elif text[0] == "1":
                kind, row = LINES["title"], None
            elif kind is None and _WORD.search(text):
                row = None  # it may be a heading misprinted
            elif kind is None:
                kind = row  # the letters are an exponent's, or NaN
        else:
            kind = row
        kinds.append(kind)
    return kinds


def frames_of_lines(lines: Sequence[str], kinds: Sequence[Line | None]) -> list[str]:
    """The number of the frame that each line belongs to, as printed; blank where there is none.

    A page has one frame. Where a title has lost its page eject the page has several, and each
    frame's lines begin at the heading of output group 1. Those of a frame whose residuals
    vanished have no number.
    """
    found = [""] * len(lines)
    start, frame, begun = 0, "", False
    for at, (text, kind) in enumerate(zip(lines, kinds, strict=True)):
        if kind is LINES["landmark heading"]:
            start, frame = (at, "") if begun else (start, frame)
            begun = True
        if kind is LINES["attitude"]:
            frame = text[_FRAME].strip()
            found[start:at] = [frame] * (at - start)
        ignored = kind is LINES["frame ignored"]
        found[at] = text[kind.fields[0].columns].strip() if kind and ignored else frame
    return found


def could_be(kind: Line, text: str) -> bool:
    """Whether a text can be a line of a kind: its decimal points are where the FORMAT has them."""
    if not kind.fields or text == ILLEGIBLE or not _has_text_of(kind, text):
        return False
    entries = [(field, text[field.columns]) for field in kind.fields]
    return any(entry.strip() for _, entry in entries) and all(
        not entry.strip(" *?") or _plausible(field, entry) for field, entry in entries
    )


def _plausible(field: Field, entry: str) -> bool:
    """Whether a text could stand in a field."""
    if field.descriptor == "F":
        return entry.find(".") == field.width - field.decimals - 1
    return field.descriptor == "A" or not entry.strip(" +-.0123456789ED")


def _has_text_of(kind: Line, text: str) -> bool:
    """Whether a line has the text that every line of a kind has, in the same columns."""
    return all(text.startswith(literal, first - 1) for first, literal in kind.literals)
