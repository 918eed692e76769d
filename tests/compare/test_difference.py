"""A difference in words, of each kind, as a reader sees it."""

from __future__ import annotations

from dataclasses import replace
from decimal import Decimal

import pytest

from vopd.listing.compare import Difference

FIELD = Difference(
    "field", 3, "65", 12, 14, "-1.25", "", landmark="28", field="X RESIDUAL", off_by=Decimal("2.0")
)
WORDS = {
    "a field": (
        FIELD,
        "page 3, frame 65, line 12 (14 in ACTUAL), landmark 28, X RESIDUAL: expected -1.25, "
        "actual (blank) (off by 2)",
    ),
    "not determined": (
        replace(FIELD, determined=False, actual="7.5", landmark=""),
        "page 3, frame 65, line 12 (14 in ACTUAL), X RESIDUAL: expected -1.25, actual 7.5 "
        "(off by 2, not determined)",
    ),
    "numbers that are equal": (
        Difference("field", 1, "", 4, 4, ".000", "-.000", field="X", off_by=Decimal("0.000")),
        "page 1, line 4, X: expected .000, actual -.000 (off by 0)",
    ),
    "text of a field": (
        Difference("field", 1, "", 4, 4, "A", "B", field="TITLE"),
        "page 1, line 4, TITLE: expected A, actual B",
    ),
    "a line": (
        Difference("line", 1, "", 4, None, "A B", "A C"),
        "page 1, line 4: the text differs\n    expected |A B\n    actual   |A C",
    ),
    "a missing line": (
        Difference("missing line", 2, "7", 9, None, "TEXT", ""),
        "page 2, frame 7, line 9: line missing from ACTUAL\n    -|TEXT",
    ),
    "an extra line": (
        Difference("extra line", 2, "7", None, 9, "", "TEXT"),
        "page 2, frame 7, line 9 of ACTUAL: line only in ACTUAL\n    +|TEXT",
    ),
    "a missing page": (
        Difference("missing page", 2, "7", 9, None, "ONE\nTWO", ""),
        "page 2, frame 7, line 9: page missing from ACTUAL (2 lines)",
    ),
    "an extra page": (
        Difference("extra page", 2, "7", None, 9, "", "ONE\nTWO\nTHREE"),
        "page 2, frame 7, line 9 of ACTUAL: page only in ACTUAL (3 lines)",
    ),
}


@pytest.mark.parametrize("name", WORDS)
def test_in_words(name: str) -> None:
    difference, words = WORDS[name]
    assert str(difference) == words
