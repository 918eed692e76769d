"""One disagreement of two listings, and how it is told."""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal
from typing import Literal

Kind = Literal["field", "line", "missing line", "extra line", "missing page", "extra page"]


@dataclass(frozen=True, slots=True)
class Difference:
    """One disagreement; pages count from 1, lines from 1 in their file.

    `page` is EXPECTED's, or ACTUAL's where EXPECTED has none. `frame`,
    `landmark` and `field` are as printed, blank where there is none; `expected`
    and `actual` are a field, a line, or the lines of a page. `off_by` is how far
    two numbers are apart, in units of the last printed digit.
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

    def __str__(self) -> str:
        if self.kind == "field":
            apart = "" if self.off_by is None else f" (off by {self.off_by.normalize():f})"
            expected, actual = self.expected or "(blank)", self.actual or "(blank)"
            return f"{self.place()}: expected {expected}, actual {actual}{apart}"
        if self.kind == "line":
            return "\n".join(
                (
                    f"{self.place()}: other text",
                    f"    expected |{self.expected}",
                    f"    actual   |{self.actual}",
                )
            )
        change, _, what = self.kind.partition(" ")
        whose = f"{what} missing from ACTUAL" if change == "missing" else f"{what} only in ACTUAL"
        if what == "page":
            lines = (self.expected or self.actual).count("\n") + 1
            return f"{self.place()}: {whose} ({lines} lines)"
        return (
            f"{self.place()}: {whose}\n    {'-+'[change == 'extra']}|{self.expected or self.actual}"
        )

    def place(self) -> str:
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
