"""What can go wrong, said so that the reader knows what to do next.

A `Finding` is one remark about an input: where it is and what is wrong with it.
Errors carry one; warnings are one. Nothing here knows the command line.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

BASIC_DATA = 0
"""The number that stands for the basic data where a group's number is asked for."""

RULER_TENS = "".join(f"{tens:10d}" for tens in range(1, 9))
RULER_ONES = "1234567890" * 8


@dataclass(frozen=True)
class Finding:
    """One statement about an input, with the place in it as exactly as it is known.

    `deck` is the file's name; `job`, `card` and `columns` count from 1. `group` is
    the number of a control group, 1 to 12, or `BASIC_DATA`. `columns` names the
    first and the last column of the field. `image` is the card's text, which is
    shown under a ruler when columns are known.
    """

    message: str
    deck: str = ""
    card: int | None = None
    job: int | None = None
    group: int | None = None
    field: str = ""
    columns: tuple[int, int] | None = None
    image: str | None = None
    severity: Literal["error", "warning"] = "error"

    def __str__(self) -> str:
        return "\n".join([self.headline(), *self._ruler()])

    def headline(self) -> str:
        """The finding on one line: deck, card, job, group, field, columns, message."""
        columns = ""
        if self.columns is not None:
            first, last = self.columns
            columns = f" (columns {first}-{last})" if last > first else f" (column {first})"
        card = "" if self.card is None else f"card {self.card}"
        job = "" if self.job is None else f"job {self.job}"
        group = "" if self.group is None else group_text(self.group)
        field = (self.field + columns).strip()
        where = ", ".join(part for part in (card, job, group, field) if part)
        return ": ".join(part for part in (self.deck, where, self.message) if part)

    def _ruler(self) -> list[str]:
        if self.image is None or self.columns is None:
            return []
        first, last = self.columns
        marks = " " * (first - 1) + "^" * (last - first + 1)
        return ["    " + line for line in (RULER_TENS, RULER_ONES, self.image.rstrip(), marks)]

    def warned(self) -> Finding:
        """The same remark as a warning."""
        return replace(self, severity="warning")


def group_text(number: int) -> str:
    """What a reader calls a group: `group 9`, or `basic data`."""
    return "basic data" if number == BASIC_DATA else f"group {number}"


Report = Callable[[Finding], None]
"""Takes a remark: keeps it, prints it, or raises it."""


class VopdError(Exception):
    """Anything the user can mend; its text is for the user."""


class DeckError(VopdError):
    """A deck that cannot be read or run as it stands."""

    def __init__(self, finding: Finding) -> None:
        super().__init__(finding)
        self.finding = finding


def strict(finding: Finding) -> None:
    """Raise errors and let warnings pass: the report of a caller who only wants results."""
    if finding.severity == "error":
        raise DeckError(finding)


def raising(keep: Report) -> Report:
    """A report that raises errors and hands warnings to `keep`."""

    def report(finding: Finding) -> None:
        strict(finding)
        keep(finding)

    return report
