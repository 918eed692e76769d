"""Split a listing's text into pages and lines, and recognise the kind of each line.

The kinds are those of `vopd.listing.line_formats`.

A line that carries text is known by that text; a row of numbers by the heading
above it. Nothing is parsed here, and trailing blanks are dropped.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

from vopd.listing.line_formats import LINES, Field, Line

ILLEGIBLE = "?"
"""A line of a damaged listing that is this alone stands for any one line."""

HEADINGS = {line.text: line for line in LINES.values() if line.literals and not line.fields}
_ROWS = {line.under: line for line in LINES.values() if line.under}
_MARKED = [
    line for line in LINES.values() if line.fields and line.text and line is not LINES["title"]
]
_ABOVE_ZEROS = (LINES["reading"], LINES["residual"])  # blank lines below mean FORMAT 102
_WORD = re.compile(r"(?i)(?<![a-z])(?!infinity)[a-z]{4}")
_FRAME = LINES["attitude"].fields[0].columns


class Item(NamedTuple):
    """One line of a page: its text, its kind if known, and its place in the file, from 1."""

    raw: str
    kind: Line | None
    number: int

    @property
    def key(self) -> tuple[str, str] | None:
        """Equal for lines that should stand side by side; None for a blank line."""
        if self.kind is None:
            return ("", self.raw) if self.raw else None
        return self.kind.name, self.about

    @property
    def about(self) -> str:
        """The landmark or frame that the line names, as printed."""
        field = self.kind.identity if self.kind else None
        return self.raw[field.columns].strip() if field else ""

    @property
    def landmark(self) -> str:
        """The landmark that the line is about, as printed."""
        field = self.kind.identity if self.kind else None
        return self.about if field and field.name == "L-MARK" else ""


class Page:
    """The lines from one page eject to the next; pages and lines of the file count from 1."""

    def __init__(self, number: int, first: int, lines: list[str]) -> None:
        self.number, self.first, self.lines = number, first, lines

    @cached_property
    def raw(self) -> tuple[str, ...]:
        return tuple(self.lines)

    @cached_property
    def key(self) -> str | None:
        """The frame number printed in output group 5, where there is one to be read."""
        try:
            row = self.lines[self.lines.index(LINES["attitude heading"].text) + 1]
        except (ValueError, IndexError):
            return None
        frame = row[_FRAME].strip()
        return frame if frame.isdigit() else None

    @cached_property
    def content(self) -> frozenset[str]:
        """The lines that can tell one page from another."""
        return frozenset(self.lines).difference(HEADINGS, ("", ILLEGIBLE))

    def items(self, kinds: Sequence[Line | None]) -> list[Item]:
        """The page's lines with their kinds, as `recognise` finds them."""
        numbers = range(self.first, self.first + len(self.lines))
        return list(map(Item, self.lines, kinds, numbers))


def is_listing(text: str) -> bool:
    """Whether any line is one that only a listing has; a title alone could be anything."""
    return any(
        line.rstrip() in HEADINGS or any(_carries(kind, line) for kind in _MARKED)
        for line in text.split("\n")
    )


def split_pages(text: str) -> list[Page]:
    """Cut a listing at every line that starts with a 1; lines before the first are a page."""
    lines = [line.rstrip() for line in text.split("\n")]
    if not lines[-1]:
        lines.pop()  # what follows the end of the last line
    starts = [at for at, line in enumerate(lines) if at == 0 or line[:1] == "1"]
    return [
        Page(number, start + 1, lines[start:stop])
        for number, (start, stop) in enumerate(zip(starts, [*starts[1:], None], strict=True), 1)
    ]


def recognise(lines: Sequence[str], damaged: bool = False) -> list[Line | None]:
    """The kind of every line; None for a blank line and for text that no FORMAT prints.

    Unknown text, or in a `damaged` listing an illegible line, may have been a
    heading: the rows after it are of no known kind until the next heading.
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
            kind = next((line for line in _MARKED if _carries(line, text)), None)
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


def frames(lines: Sequence[str], kinds: Sequence[Line | None]) -> list[str]:
    """The frame that each line belongs to, as printed; blank where none is.

    A page holds one frame; should a title lack its page eject, it holds more,
    and each frame's lines begin at the heading of output group 1.
    """
    found = [""] * len(lines)
    start, frame = 0, ""
    for at, (text, kind) in enumerate(zip(lines, kinds, strict=True)):
        if kind is LINES["landmark heading"] and frame:
            start, frame = at, ""
        if kind is LINES["attitude"]:
            frame = text[_FRAME].strip()
            found[start:at] = [frame] * (at - start)
        ignored = kind is LINES["frame ignored"]
        found[at] = text[kind.fields[0].columns].strip() if kind and ignored else frame
    return found


def fits(kind: Line, text: str) -> bool:
    """Whether the text could be a line of that kind, its points where the FORMAT puts them."""
    if not kind.fields or text == ILLEGIBLE or not _carries(kind, text):
        return False
    entries = [(field, text[field.columns]) for field in kind.fields]
    return any(entry.strip() for _, entry in entries) and all(
        not entry.strip(" *?") or _plausible(field, entry) for field, entry in entries
    )


def _plausible(field: Field, entry: str) -> bool:
    if field.edit == "F":
        return entry.find(".") == field.width - field.decimals - 1
    return field.edit == "A" or not entry.strip(" +-.0123456789ED")


def _carries(kind: Line, text: str) -> bool:
    return all(text.startswith(literal, first - 1) for first, literal in kind.literals)
