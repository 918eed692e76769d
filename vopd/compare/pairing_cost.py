"""The cost of pairing two pages or two lines, for `vopd.compare.align`; similar ones cost less.

To leave both without a partner costs 2. A pair that costs less is reported as one change, a pair
that would cost more as one page or line missing and another added.
"""

from __future__ import annotations

from vopd.listing.line_formats import Line
from vopd.listing.lines import ILLEGIBLE, ListingLine, ListingPage, could_be

OTHER_KIND = 1.8
"""Pairing lines of two kinds: reported as one change."""
BLANK_LINE = 1.9
"""Pairing text with a blank line: only where no other text is left to pair it with."""


def page_cost(expected: ListingPage, actual: ListingPage) -> float:
    """Cost of pairing two pages: low for the same frame; high for two, unless nearly equal."""
    if not expected.distinctive_lines:  # illegible throughout: its length is all that is known
        lengths = len(expected.lines), len(actual.lines)
        return 0.2 + 1.6 * (1 - min(lengths) / max(lengths))
    most = max(len(expected.distinctive_lines), len(actual.distinctive_lines), 1)
    unlike = 1 - len(expected.distinctive_lines & actual.distinctive_lines) / most
    if expected.key is None or actual.key is None:
        return 0.2 + 1.7 * unlike
    return 0.3 * unlike if expected.key == actual.key else 0.5 + 1.7 * unlike


def line_cost(expected: ListingLine, actual: ListingLine) -> float:
    """Cost of pairing two lines: low for the same landmark; high for two, unless nearly equal."""
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
    """Whether a field that is legible differs."""
    one = expected.text[columns]
    return one != actual.text[columns] and one.strip(" ?") != ""


def common_kind(expected: ListingLine, actual: ListingLine) -> Line | None:
    """The kind of line by whose fields two lines can be compared; None if there is none.

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
