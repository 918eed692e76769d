"""Print many pages with the same lines at once: one text for all, with the numbers filled in.

Numbers below one have no zero before the point, as the 1974 printer left it;
rounding is that of C's printf, which rounds the exact value of a number.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import groupby
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vopd.arrays import Bools, Floats, Ints
from vopd.listing.digit_groups import Codes, code_type, padded_groups, signed_groups, widths
from vopd.listing.line_formats import LINES, Field
from vopd.listing.one_number import fixed, line_without_numbers

Bytes = NDArray[np.uint8]
FEW_PAGES = 2  # whose numbers are edited one by one, without a table of digits


class _Alike(NamedTuple):
    """The fields of a page that are edited alike."""

    field: Field  # of one of them
    which: Ints  # their indices among the fields of the page
    starts: Ints  # where they begin in the page's text


class PageTemplate:
    """The text of the lines of a page, and where the numbers go in it.

    Args:
        names: the kinds of the lines in order, keys of `LINES`.
    """

    def __init__(self, names: tuple[str, ...]) -> None:
        text: list[str] = []
        alike: dict[tuple[str, int, int], tuple[Field, list[tuple[Ints, Ints]]]] = {}
        length = fields = 0
        for name, several in groupby(names):
            line, count = LINES[name], len(list(several))
            one, row = line_without_numbers(line), np.arange(count)
            for k, field in enumerate(line.fields):
                kind = field.descriptor, field.width, field.decimals
                starts = length + line.blank_lines + field.first - 1 + row * len(one)
                _, parts = alike.setdefault(kind, (field, []))
                parts.append((fields + k + row * len(line.fields), starts))
            text.append(one * count)
            length += count * len(one)
            fields += count * len(line.fields)
        self.text = np.frombuffer("".join(text).encode("ascii"), np.uint8).copy()
        self._alike: list[_Alike] = []
        for (descriptor, width, decimals), (field, parts) in alike.items():
            which, starts = (np.concatenate(part) for part in zip(*parts, strict=True))
            self._alike.append(_Alike(field, which, starts))
            if descriptor == "F":
                self.text[starts + width - 1 - decimals] = ord(".")

    @np.errstate(all="ignore")  # infinities and NaN are edited one by one
    def fill(self, values: Floats, heads: Bytes | None = None) -> list[bytes]:
        """Make the pages, one for each row of values.

        Args:
            values: the numbers of each page (pages, fields), in the order of the fields.
            heads: the text in front of each page's lines (pages, characters).
        """
        count, head = len(values), 0 if heads is None else heads.shape[1]
        size = head + len(self.text)
        pages = np.empty((count, size), np.uint8)
        if heads is not None:
            pages[:, :head] = heads
        pages[:, head:] = self.text
        for field, which, begins in self._alike:
            numbers = np.ascontiguousarray(values[:, which].T)
            starts = head + begins
            few = count <= FEW_PAGES
            alone = np.ndindex(numbers.shape) if few else _write(pages, starts, numbers, field)
            for k, row in alone:
                text = fixed(float(numbers[k, row]), field).encode("ascii")
                pages[row, starts[k] : starts[k] + field.width] = np.frombuffer(text, np.uint8)
        whole = pages.tobytes()
        return [whole[first : first + size] for first in range(0, count * size, size)]


@lru_cache(maxsize=64)
def page_template(names: tuple[str, ...]) -> PageTemplate:
    """The template of a page; one that was made before is used again.

    Args:
        names: the kinds of the lines in order, keys of `LINES`.
    """
    return PageTemplate(names)


def _write(pages: Bytes, starts: Ints, values: Floats, field: Field) -> NDArray[np.intp]:
    """Write `values` (fields, pages) into fields that are edited alike and begin at `starts`.

    Returns the indices (n, 2) of numbers that must be edited one by one: those that do not
    fit, are NaN, or lie so near a tie that their exact value decides.
    """
    fixed_point = field.descriptor == "F"
    decimals = field.decimals if fixed_point else 0
    columns = field.width - (decimals + 1 if fixed_point else 0)  # before the point
    negative = np.signbit(values)
    scaled = np.abs(values) * 10.0**decimals
    rounded = np.rint(scaled)
    odd = _odd(negative, scaled, rounded, columns, decimals)
    any_odd = odd.any()
    if any_odd:
        rounded[odd] = 0.0
    whole = rounded.astype(np.int64 if rounded.max(initial=0.0) >= 2**31 else np.int32)
    before = whole // 10**decimals
    _put(pages, starts, signed_groups(before, negative, columns, not fixed_point), columns)
    if decimals:
        behind = starts + columns + 1
        _put(pages, behind, padded_groups(whole - before * 10**decimals, decimals), decimals)
    return np.argwhere(odd) if any_odd else np.empty((0, 2), np.intp)


def _put(pages: Bytes, starts: Ints, groups: Sequence[Codes | None], columns: int) -> None:
    """Write groups of characters, one after the other, at each of the `starts`."""
    count, size = pages.shape
    for width, group in zip(widths(columns), groups, strict=True):
        if group is not None:
            for start, codes in zip(starts.tolist(), group, strict=True):
                np.ndarray((count,), code_type(width), pages, start, (size,))[:] = codes
        starts = starts + width


def _odd(negative: Bools, scaled: Floats, rounded: Floats, columns: int, decimals: int) -> Bools:
    """Which numbers do not fit into the columns before the point, or lie near a tie."""
    room = np.where(negative, 10.0 ** (columns - 1 + decimals), 10.0 ** (columns + decimals))
    slack = scaled * 4e-16 + 1e-9  # of the product's last bit, generously
    near_tie = np.abs(scaled - rounded) > 0.5 - slack
    odd: Bools = ~((rounded < room) & (scaled < 2.0**53)) | near_tie
    return odd
