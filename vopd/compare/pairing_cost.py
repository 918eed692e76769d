"""How unlike two pages or two lines are, for `vopd.compare.align`: what pairing them costs.

Leaving both unpaired costs 2. So a pair that costs less is shown to the reader
as one thing that changed, a pair that costs more as one lost and one added.
"""

from __future__ import annotations

from vopd.compare.line_kinds import ILLEGIBLE, Item, Page, fits
from vopd.listing.line_formats import Line

CHANGED = 1.8
"""A line for a line of another kind: still one change."""
BLANK = 1.9
"""Text for a blank line: only where no other text can take its place."""


def page_cost(expected: Page, actual: Page) -> float:
    """Same frame: cheap. Another frame: only where nearly all else is the same."""
    if not expected.content:  # illegible throughout: its length is all that is known
        lengths = len(expected.lines), len(actual.lines)
        return 0.2 + 1.6 * (1 - min(lengths) / max(lengths))
    most = max(len(expected.content), len(actual.content), 1)
    unlike = 1 - len(expected.content & actual.content) / most
    if expected.key is None or actual.key is None:
        return 0.2 + 1.7 * unlike
    return 0.3 * unlike if expected.key == actual.key else 0.5 + 1.7 * unlike


def line_cost(expected: Item, actual: Item) -> float:
    """Same landmark: cheap. Another landmark: only where most else is the same."""
    if expected.raw == actual.raw:
        return 0.0
    if expected.raw == ILLEGIBLE:
        return 0.1
    if not expected.raw or not actual.raw:
        return BLANK
    kind = common_kind(expected, actual)
    if kind is None:
        return CHANGED
    unequal = [field for field in kind.fields if _unequal(expected, actual, field.columns)]
    named = kind.identity in unequal
    unlike = (len(unequal) - named) / len(kind.fields)
    return 0.3 + 2.2 * unlike if named else 0.2 + 0.6 * unlike


def _unequal(expected: Item, actual: Item, columns: slice) -> bool:
    one = expected.raw[columns]
    return one != actual.raw[columns] and one.strip(" ?") != ""


def common_kind(expected: Item, actual: Item) -> Line | None:
    """The kind by whose fields two lines can be compared.

    Each knows its own from the heading above it, which the other may have lost.
    """
    lines = (expected, actual)
    for kind in (expected.kind, actual.kind):
        if kind and kind.fields and all(one.kind is kind or fits(kind, one.raw) for one in lines):
            return kind
    return None
