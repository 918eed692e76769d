"""Many pages of one form at once: the text once, the numbers as columns of characters.

Numbers below one have no zero before the point, as the 1974 printer left it;
rounding is that of C's printf, which rounds the exact value of a number.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vopd.arrays import Bools, Floats
from vopd.listing.line_formats import LINES, Field
from vopd.listing.number_text import blank, fixed

Bytes = NDArray[np.uint8]
_ZERO, _BLANK, _MINUS, _POINT = (ord(char) for char in "0 -.")
_KINDS = "IF"  # fields that are edited here; the rest is text


class Form:
    """The text of some lines, one after the other, and where their numbers stand in it."""

    def __init__(self, names: tuple[str, ...], title: str | None = None) -> None:
        text = "" if title is None else title + "\n"
        self.fields: list[Field] = []
        self.starts: list[int] = []
        for name in names:
            line = LINES[name]
            start = len(text) + line.blank_lines
            self.fields += line.fields
            self.starts += [start + field.first - 1 for field in line.fields]
            text += blank(line)
        self.text = np.frombuffer(text.encode("ascii"), np.uint8)
        self._alike: dict[tuple[str, int, int], list[int]] = {}
        for place, field in enumerate(self.fields):
            self._alike.setdefault((field.edit, field.width, field.decimals), []).append(place)

    @np.errstate(all="ignore")  # infinities and NaN are edited one by one
    def fill(self, values: Floats) -> list[bytes]:
        """The pages for rows of values, one a page, in the order of the fields."""
        count = len(values)
        page = np.empty((len(self.text), count), np.uint8)  # a row for each character's place
        page[:] = self.text[:, None]
        for (kind, width, decimals), places in self._alike.items():
            starts = np.array([self.starts[place] for place in places])
            numbers = np.ascontiguousarray(values[:, places].T)
            for k, row in zip(*_digits(page, starts, numbers, kind, width, decimals), strict=True):
                field = self.fields[places[k]]
                text = fixed(float(numbers[k, row]), field).encode("ascii")
                page[starts[k] : starts[k] + width, row] = np.frombuffer(text, np.uint8)
        size, whole = len(self.text), page.T.tobytes()
        return [whole[first : first + size] for first in range(0, count * size, size)]


@lru_cache(maxsize=64)
def form(names: tuple[str, ...], title: str | None = None) -> Form:
    """The form of these lines, made once."""
    return Form(names, title)


def _digits(
    page: Bytes, starts: NDArray[np.intp], values: Floats, kind: str, width: int, decimals: int
) -> tuple[NDArray[np.intp], ...]:
    """Write `values` (fields, pages) into the page from their last digit to their first.

    Returns where a number must be edited by itself: it does not fit, it is no
    number, or it lies so near a tie that its exact value decides.
    """
    size = np.abs(values)
    scaled = size * 10.0**decimals
    rounded = np.rint(scaled)
    odd = _odd(values, scaled, rounded, width - (decimals + 1 if kind == "F" else 0), decimals)
    rounded[odd] = 0.0
    small = rounded.max(initial=0.0) < 2**32
    rest: NDArray[np.unsignedinteger] = rounded.astype(np.uint32 if small else np.uint64)
    minus = np.where(np.signbit(values), np.uint8(_MINUS), np.uint8(_BLANK))
    point = width - 1 - decimals if kind == "F" else width
    for place in range(width - 1, -1, -1):
        if place == point:
            page[starts + place] = _POINT
            continue
        if place < min(point, width - 1) and not (rest.any() or (minus == _MINUS).any()):
            break  # only blanks before, and they are there
        tens = rest // 10
        char = (rest - tens * 10).astype(np.uint8) + np.uint8(_ZERO)
        if place < min(point, width - 1):
            ended = rest == 0
            char = np.where(ended, minus, char)
            minus[ended] = _BLANK
        page[starts + place] = char
        rest = tens
    return np.nonzero(odd)


def _odd(values: Floats, scaled: Floats, rounded: Floats, digits: int, decimals: int) -> Bools:
    room = np.where(np.signbit(values), 10.0 ** (digits - 1), 10.0**digits)
    fits = (rounded < room * 10.0**decimals) & (scaled < 2.0**53)
    slack = scaled * 4e-16 + 1e-9  # of the product's last bit, generously
    near_tie = np.abs(scaled - rounded) > 0.5 - slack
    odd: Bools = ~fits | near_tie
    return odd
