"""One difference between two listings, and the text that describes it."""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal
from typing import Literal

Kind = Literal["field", "line", "missing line", "extra line", "missing page", "extra page"]


@dataclass(frozen=True, slots=True)
class Difference:
    """One difference between the listing EXPECTED and the listing ACTUAL.

    Args:
        kind: what differs: a field of a line, a whole line, or a line or page of one listing only
        page: number of the page in EXPECTED, from 1; in ACTUAL where EXPECTED has no such page
        frame: number of the frame as printed, blank where there is none
        expected_line: number of the line in EXPECTED, from 1; None where it has none
        actual_line: number of the line in ACTUAL, from 1; None where it has none
        expected: the field, the line, or the lines of the page in EXPECTED
        actual: the same in ACTUAL
        landmark: number of the landmark as printed, blank where there is none
        field: name of the field, as its heading prints it
        off_by: how far two numbers are apart, in units of the last printed digit; None for text
        determined: False for a field whose digits depend on the last bits of sines, where both
            numbers are among those that it may have
    """

    kind: Kind
    page: int
    frame: str
    expected_line: int | None
    actual_line: int | None
    expected: str
    actual: str
    landmark: str = ""
    field: str = ""
    off_by: Decimal | None = None
    determined: bool = True

    def __str__(self) -> str:
        """The difference for a reader: where it is, and what either listing has there."""
        if self.kind == "field":
            apart = "" if self.off_by is None else f"off by {self.off_by.normalize():f}"
            notes = ", ".join(filter(None, (apart, "" if self.determined else "not determined")))
            expected, actual = self.expected or "(blank)", self.actual or "(blank)"
            return f"{self.location()}: expected {expected}, actual {actual}" + (
                f" ({notes})" if notes else ""
            )
        if self.kind == "line":
            return (
                f"{self.location()}: the text differs\n"
                f"    expected |{self.expected}\n"
                f"    actual   |{self.actual}"
            )
        change, _, what = self.kind.partition(" ")
        whose = f"{what} missing from ACTUAL" if change == "missing" else f"{what} only in ACTUAL"
        text, sign = self.expected or self.actual, "-" if change == "missing" else "+"
        if what == "page":
            return f"{self.location()}: {whose} ({text.count(chr(10)) + 1} lines)"
        return f"{self.location()}: {whose}\n    {sign}|{text}"

    def location(self) -> str:
        """Page, frame, line, landmark and field, as far as they are known."""
        if self.expected_line is None:
            line = f"line {self.actual_line} of ACTUAL"
        elif self.actual_line in (None, self.expected_line):
            line = f"line {self.expected_line}"
        else:
            line = f"line {self.expected_line} ({self.actual_line} in ACTUAL)"
        named = (("frame", self.frame), ("landmark", self.landmark))
        frame, landmark = (f"{what} {name}" if name else "" for what, name in named)
        return ", ".join(filter(None, (f"page {self.page}", frame, line, landmark, self.field)))
