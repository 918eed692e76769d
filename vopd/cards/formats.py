"""The program's input FORMATs as FORTRAN text, and the columns of their fields."""

from __future__ import annotations

import re
from functools import cache
from typing import NamedTuple

FORMATS = {
    76: "(2F10.3)",
    77: "(80A1)",  # the listing reads the title into a Hollerith field: (80H...)
    78: "(2I5,6F5.0)",
    79: "(3F10.1)",
    80: "(16I5)",
    81: "(I5,F10.1)",
    82: "(8F10.1)",
    83: "(I10,5F10.2)",
    84: "(7I5)",
    86: "(8X,I2,30X,F7.3,3X,F7.3,6X,I4)",
}
"""FORMAT by statement number. Source: A 459 to A 470, as the printed pages confirm them."""

_EDIT_DESCRIPTOR = re.compile(r"(\d*)([IFAX])(\d*)(?:\.(\d+))?")


class FormatItem(NamedTuple):
    """One field of a FORMAT.

    Attributes:
        kind: "I" for a whole number, "F" for a real number, "A" for text
        first: first column, from 1
        last: last column
        decimals: how many decimals a number without a punched point has
    """

    kind: str
    first: int
    last: int
    decimals: int = 0

    @property
    def width(self) -> int:
        """How many columns the field has."""
        return self.last - self.first + 1

    @property
    def implied(self) -> float:
        """What a number without a punched point is divided by."""
        return 10.0**self.decimals

    @property
    def descriptor(self) -> str:
        """The FORTRAN edit descriptor of this field alone, such as `F10.3`."""
        return f"I{self.width}" if self.kind == "I" else f"F{self.width}.{self.decimals}"


@cache
def format_items(number: int) -> tuple[FormatItem, ...]:
    """The fields of a FORMAT in order.

    Args:
        number: its statement number, a key of `FORMATS`
    """
    column, found = 1, []
    for repeat, kind, width, decimals in _EDIT_DESCRIPTOR.findall(FORMATS[number]):
        for _ in range(int(repeat or 1)):
            last = column + int(width or 1) - 1
            if kind != "X":
                found.append(FormatItem(kind, column, last, int(decimals or 0)))
            column = last + 1
    return tuple(found)
