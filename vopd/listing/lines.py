"""The pages and lines of a listing: recognise their kinds, and pair those of two listings."""

from __future__ import annotations

import re
from bisect import bisect_left
from collections import Counter
from collections.abc import Callable, Hashable, Sequence
from functools import cached_property
from itertools import zip_longest
from math import inf
from typing import NamedTuple, Protocol, TypeVar

from vopd.listing.formats import LINES, Field, Line

# Pages and lines of a listing's text, and the kind of each line
#
# The kinds are those of `vopd.listing.formats`. A line that has text of its own is known by that
# text, a row of numbers by the heading above it. No number is read here; blanks at the end of a
# line are dropped.

ILLEGIBLE = "?"  # a line of a damaged listing with this alone stands for any one line
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
        """Kind and landmark or frame, alike in lines that are compared; None for a blank line."""
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
        """List the page's lines with the kinds that `recognise_lines` found."""
        numbers = range(self.first_line, self.first_line + len(self.lines))
        return list(map(ListingLine, self.lines, kinds, numbers))


def is_listing(text: str) -> bool:
    """Recognise a listing by a line that only listings have."""
    return any(
        line.rstrip() in HEADINGS or any(_has_text_of(kind, line) for kind in _WITH_TEXT)
        for line in set(text.split("\n"))  # a million blank lines are one
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
    """Find the number of the frame that each line belongs to, as printed; blank if there is none.

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
    """Test a text for a kind of line: its decimal points are where the FORMAT has them."""
    if not kind.fields or text == ILLEGIBLE or not _has_text_of(kind, text):
        return False
    entries = [(field, text[field.columns]) for field in kind.fields]
    return any(entry.strip() for _, entry in entries) and all(
        not entry.strip(" *?") or _plausible(field, entry) for field, entry in entries
    )


def _plausible(field: Field, entry: str) -> bool:
    """Test a text for a field: its decimal point, or the characters of a number."""
    if field.descriptor == "F":
        return entry.find(".") == field.width - field.decimals - 1
    return field.descriptor == "A" or not entry.strip(" +-.0123456789ED")


def _has_text_of(kind: Line, text: str) -> bool:
    """Look for the text that every line of a kind has, in the same columns."""
    return all(text.startswith(literal, first - 1) for first, literal in kind.literals)


# Pairs of two sequences in their order: the pages of two listings, the lines of two pages
#
# Elements that are equal, or whose key occurs once in either sequence, are paired first. What lies
# between them is paired at the least total cost, where an element left without a partner costs 1.


class Alignable(Protocol):
    """An element that can be paired: its text, and a key that says what it is about.

    The key is equal for elements that should be paired, and None where nothing tells.
    """

    @property
    def text(self) -> Hashable: ...
    @property
    def key(self) -> Hashable: ...


T = TypeVar("T", bound=Alignable)
Pairs = list[tuple[T | None, T | None]]
"""The pairs in the order of both sequences; None where an element has no partner."""
Cost = Callable[[T, T], float]
"""What pairing two elements costs: 0 for equal ones, above 2 for those that must not be paired."""

SEARCH_LIMIT = 100_000
"""About how many pairs are weighed; of longer sequences only those near the diagonal are."""


def align(expected: Sequence[T], actual: Sequence[T], cost: Cost[T]) -> Pairs[T]:
    """Pair the elements of two sequences, keeping the order of both.

    Args:
        expected: the first sequence
        actual: the second sequence
        cost: what pairing an element of `expected` with one of `actual` costs

    Returns:
        Every element of both once, either with its partner or with None.
    """
    if [one.key for one in expected] == [other.key for other in actual]:
        return list(zip(expected, actual, strict=True))
    head = _equal_at_start(expected, actual)
    tail = _equal_at_start(expected[head:][::-1], actual[head:][::-1])
    expected_end, actual_end = len(expected) - tail, len(actual) - tail
    between = _align_between(
        expected[head:expected_end], actual[head:actual_end], cost, ("text", "key")
    )
    return [
        *zip(expected[:head], actual[:head], strict=True),
        *between,
        *zip(expected[expected_end:], actual[actual_end:], strict=True),
    ]


def _equal_at_start(expected: Sequence[T], actual: Sequence[T]) -> int:
    """Count the elements at the start that are equal in full."""
    count = 0
    for one, other in zip(expected, actual, strict=False):
        if one.text != other.text:
            break
        count += 1
    return count


def _align_between(
    expected: Sequence[T], actual: Sequence[T], cost: Cost[T], attributes: tuple[str, ...]
) -> Pairs[T]:
    """Pair elements that share a value found once in either sequence, then those between them."""
    if not attributes or not expected or not actual:
        return _cheapest(expected, actual, cost)
    pairs: Pairs[T] = []
    i = j = 0
    for p, q in _anchors(expected, actual, attributes[0]):
        pairs += _align_between(expected[i:p], actual[j:q], cost, attributes[1:])
        pairs.append((expected[p], actual[q]))
        i, j = p + 1, q + 1
    return pairs + _align_between(expected[i:], actual[j:], cost, attributes[1:])


def _anchors(expected: Sequence[T], actual: Sequence[T], attribute: str) -> list[tuple[int, int]]:
    """Find elements that share a value found once in either: indices of the longest rising run."""
    values = [[getattr(one, attribute) for one in side] for side in (expected, actual)]
    unique = [{value for value, n in Counter(side).items() if n == 1} for side in values]
    shared = (unique[0] & unique[1]) - {None}
    index = {value: q for q, value in enumerate(values[1]) if value in shared}
    candidates = [(p, index[value]) for p, value in enumerate(values[0]) if value in shared]
    lowest: list[int] = []  # the lowest end of a rising run, by the run's length
    lengths = []
    for _, q in candidates:
        length = bisect_left(lowest, q)
        lowest[length : length + 1] = [q]
        lengths.append(length)
    run: list[tuple[int, int]] = []  # from its end: of one length, the last has the lowest index
    for (p, q), length in zip(reversed(candidates), reversed(lengths), strict=True):
        if length == len(lowest) - len(run) - 1:
            run.append((p, q))
    return run[::-1]


def _cheapest(expected: Sequence[T], actual: Sequence[T], cost: Cost[T]) -> Pairs[T]:
    """Pair at the least total cost, by dynamic programming in a band about the diagonal."""
    n, m = len(expected), len(actual)
    reach = max(abs(n - m) + 1, SEARCH_LIMIT // (2 * n + 1))
    if not n or not m or n * min(m, 2 * reach + 1) > 20 * SEARCH_LIMIT:
        return _in_order(expected, actual, cost)  # nothing to weigh, or too little in common
    above: dict[int, float] = {}  # the row before, by column; outside the band all is infinite
    moves: list[dict[int, tuple[int, int]]] = []
    for i in range(n + 1):
        costs: dict[int, float] = {}
        steps: dict[int, tuple[int, int]] = {}
        for j in range(max(0, i - reach), min(m, i + reach) + 1):
            best, step = (0.0, (0, 0)) if i == j == 0 else (inf, (0, 0))
            if j - 1 in above and i:
                best, step = above[j - 1] + cost(expected[i - 1], actual[j - 1]), (1, 1)
            if above.get(j, inf) + 1 <= best and i:  # of equals, pairs come first and gaps last
                best, step = above[j] + 1, (1, 0)
            if costs.get(j - 1, inf) + 1 <= best and j:
                best, step = costs[j - 1] + 1, (0, 1)
            costs[j], steps[j] = best, step
        above = costs
        moves.append(steps)
    return _retrace(expected, actual, moves)


def _in_order(expected: Sequence[T], actual: Sequence[T], cost: Cost[T]) -> Pairs[T]:
    """Pair first with first, second with second, except where the cost forbids it."""
    pairs: Pairs[T] = []
    for one, other in zip_longest(expected, actual):
        if one is not None and other is not None and cost(one, other) > 2:
            pairs += [(one, None), (None, other)]
        else:
            pairs.append((one, other))
    return pairs


def _retrace(
    expected: Sequence[T], actual: Sequence[T], moves: list[dict[int, tuple[int, int]]]
) -> Pairs[T]:
    """Follow the chosen moves back from the end to the start."""
    i, j = len(expected), len(actual)
    pairs: Pairs[T] = []
    while i or j:
        down, along = moves[i][j]
        i, j = i - down, j - along
        pairs.append((expected[i] if down else None, actual[j] if along else None))
    return pairs[::-1]


# The cost of pairing two pages or two lines, less for similar ones
#
# To leave both without a partner costs 2. A pair that costs less is reported as one change, a pair
# that would cost more as one page or line missing and another added.

OTHER_KIND = 1.8  # pairing lines of two kinds: reported as one change
BLANK_LINE = 1.9  # pairing text with a blank line: only where no other text is left to pair it with


def page_cost(expected: ListingPage, actual: ListingPage) -> float:
    """Weigh the pairing of two pages: low for the same frame; high for two, unless nearly equal."""
    if not expected.distinctive_lines:  # illegible throughout: its length is all that is known
        lengths = len(expected.lines), len(actual.lines)
        return 0.2 + 1.6 * (1 - min(lengths) / max(lengths))
    most = max(len(expected.distinctive_lines), len(actual.distinctive_lines), 1)
    unlike = 1 - len(expected.distinctive_lines & actual.distinctive_lines) / most
    if expected.key is None or actual.key is None:
        return 0.2 + 1.7 * unlike
    return 0.3 * unlike if expected.key == actual.key else 0.5 + 1.7 * unlike


def line_cost(expected: ListingLine, actual: ListingLine) -> float:
    """Weigh the pairing of two lines: low for one landmark; high for two, unless nearly equal."""
    if expected.text == actual.text:
        return 0.0
    if expected.text == ILLEGIBLE:
        return 0.1
    if not expected.text or not actual.text:
        return BLANK_LINE
    kind = common_kind(expected, actual)
    if kind is None:
        return OTHER_KIND
    unequal = [field for field in kind.fields if _unequal(expected, actual, field.columns)]
    named = kind.identity in unequal
    unlike = (len(unequal) - named) / len(kind.fields)
    return 0.3 + 2.2 * unlike if named else 0.2 + 0.6 * unlike


def _unequal(expected: ListingLine, actual: ListingLine, columns: slice) -> bool:
    """Compare a field of two lines: true if it is legible and differs."""
    one = expected.text[columns]
    return one != actual.text[columns] and one.strip(" ?") != ""


def common_kind(expected: ListingLine, actual: ListingLine) -> Line | None:
    """Find the kind of line by whose fields two lines can be compared; None if there is none.

    Either line has its kind from the heading above it, which the other may have lost.
    """
    lines = (expected, actual)
    for kind in (expected.kind, actual.kind):
        if (
            kind
            and kind.fields
            and all(one.kind is kind or could_be(kind, one.text) for one in lines)
        ):
            return kind
    return None
