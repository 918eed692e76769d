"""Convert many numbers to digits: up to four digits at a time are looked up in a table."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from vopd.arrays import Bools

GROUP = 4  # digits that are looked up together
_DTYPE = {1: "u1", 2: "<u2", 3: "V3", 4: "<u4"}  # a group of 1 to 4 characters as one element
_ZERO, _BLANK, _MINUS = (ord(char) for char in "0 -")

Codes = NDArray[np.generic]
"""Groups of characters, each one element of as many bytes."""
Whole = NDArray[np.integer]


def widths(digits: int) -> list[int]:
    """The widths of the groups into which a number of digits is split, from left to right.

    Args:
        digits: how many digits.
    """
    first = digits % GROUP
    return ([first] if first else []) + [GROUP] * (digits // GROUP)


def code_type(width: int) -> np.dtype[np.generic]:
    """The numpy type that holds a group of characters as one element.

    Args:
        width: how many characters, 1 to 4.
    """
    return np.dtype(_DTYPE[width])


@cache
def _table(width: int, shows_zero: bool) -> Codes:
    """Groups of the numbers below 10**width: without sign, then with a minus, then zero-padded.

    The first two are blank in front; a minus that has no room is left out. Zero is
    blank, as in front of a decimal point, unless it is to be shown.
    """
    numbers = np.arange(10**width)
    powers = 10 ** np.arange(width - 1, -1, -1)
    padded = (numbers[:, None] // powers % 10 + _ZERO).astype(np.uint8)
    begun = numbers[:, None] >= powers
    if shows_zero:
        begun[0, -1] = True
    plain = np.where(begun, padded, np.uint8(_BLANK))
    before_first = np.append(begun[:, 1:], np.ones((len(numbers), 1), bool), axis=1) & ~begun
    minus = np.where(before_first, np.uint8(_MINUS), plain)
    groups = np.ascontiguousarray(np.concatenate([plain, minus, padded]))
    return groups.view(code_type(width))[:, 0]


def padded_groups(numbers: Whole, digits: int) -> list[Codes]:
    """Numbers as text with leading zeros, in groups from left to right.

    Args:
        numbers: whole numbers, 0 or more, (n,).
        digits: how many digits each has.
    """
    groups: list[Codes] = []
    for width in reversed(widths(digits)):
        upper = numbers // 10**width
        low = numbers - upper * 10**width
        groups.append(_table(width, False).take(low + 2 * 10**width))
        numbers = upper
    return groups[::-1]


def signed_groups(
    numbers: Whole, negative: Bools, columns: int, shows_zero: bool
) -> list[Codes | None]:
    """Numbers as text, with blanks and a minus before them, in groups from left to right.

    Args:
        numbers: absolute values, which fit with their sign into the columns.
        negative: which have a minus.
        columns: how many characters.
        shows_zero: whether zero is a digit or blank.

    Returns:
        The groups, each (n,); None for a group that is blank in every number.
    """
    groups: list[Codes | None] = []
    sign = negative.astype(numbers.dtype)
    for width in reversed(widths(columns)):
        if groups and not (numbers.any() or sign.any()):
            groups.append(None)
            continue
        upper = numbers // 10**width
        low = numbers - upper * 10**width
        more = upper > 0
        kind = np.where(more, 2, sign) if more.any() else sign
        groups.append(_table(width, shows_zero and not groups).take(low + kind * 10**width))
        if sign.any():
            sign = sign * (more | (low >= 10 ** (width - 1)))
        numbers = upper
    return groups[::-1]
