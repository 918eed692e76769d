"""Numbers as text, many at once: as Python's `%.6f` and `%.6e`, which round the exact value.

A number is scaled to a whole one, whose digits are looked up. The few whose exact value
decides, because they lie near a tie, are formatted by Python, one by one.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from vopd.arrays import Bools, Floats, Ints
from vopd.listing.digit_groups import Codes, padded_groups, signed_groups

Characters = NDArray[np.uint8]
"""Texts of equal length, (..., C): `NONE` where one has fewer characters than the longest."""

NONE = 0xFF
"""No character. It is no byte of UTF-8."""

DIGITS = 6  # behind the point of a number with an exponent
MOST_EXPONENT = 99  # beyond it has three digits
_POINT = np.array(ord("."), np.uint8)


def without_gaps(text: Characters) -> bytes:
    """All characters, one after the other.

    Args:
        text: any texts
    """
    return text.tobytes().translate(None, bytes([NONE]))


def word_text(words: Sequence[str]) -> Characters:
    """Words as texts in UTF-8, (N, C).

    Args:
        words: many may be the same
    """
    encoded = {word: word.encode() for word in set(words)}
    longest = max(map(len, encoded.values()), default=0)
    filled = {word: text.ljust(longest, bytes([NONE])) for word, text in encoded.items()}
    joined = b"".join([filled[word] for word in words])
    return np.frombuffer(joined, np.uint8).reshape(len(words), longest)


def repeated(character: str, rows: int) -> Characters:
    """The same character for every row, (N, 1)."""
    return np.full((rows, 1), ord(character), np.uint8)


def whole_number_text(values: Ints) -> Characters:
    """Whole numbers as texts, (..., C).

    Args:
        values: (...)
    """
    return _joined(_signed(np.abs(values), values < 0))


@np.errstate(all="ignore")
def number_text(values: Floats, decimals: int | None) -> Characters:
    """Numbers as texts, (..., C); NaN has no character.

    Args:
        values: (...)
        decimals: behind the point; None writes six, and an exponent
    """
    odd, groups = _exponential(values) if decimals is None else _fixed(values, decimals)
    text = _joined(groups)
    if odd.any():
        form = f"%.{DIGITS}e" if decimals is None else f"%.{decimals}f"
        texts = ["" if one != one else form % one for one in values[odd].tolist()]
        exact = word_text(texts)
        more = max(exact.shape[-1] - text.shape[-1], 0)
        text = np.pad(text, [(0, 0)] * values.ndim + [(0, more)], constant_values=NONE)
        text[odd] = NONE
        text[odd, : exact.shape[-1]] = exact
    return text


def _fixed(values: Floats, decimals: int) -> tuple[Bools, list[Codes]]:
    """Which numbers are to be formatted one by one, and the characters of the others."""
    odd, whole = _rounded(np.abs(values) * 10.0**decimals)
    before = whole // 10**decimals
    groups = _signed(before, np.signbit(values))
    if decimals:
        behind = padded_groups(whole - before * 10**decimals, decimals)
        groups += [_POINT, *behind]
    return odd, groups


def _exponential(values: Floats) -> tuple[Bools, list[Codes]]:
    """As `_fixed`, with one digit before the point, and an exponent."""
    size = np.abs(values)
    power = np.floor(np.log10(np.where(size > 0.0, size, 1.0)))
    many = ~(np.abs(power) <= MOST_EXPONENT)
    exponent = np.where(many, 0.0, power).astype(np.int64)
    odd, whole = _rounded(size * _powers_of_ten().take(DIGITS - exponent))
    # a logarithm is rounded, and what is rounded may have one digit more
    odd |= many | ((size > 0.0) & ((whole < 10**DIGITS) | (whole >= 10 ** (DIGITS + 1))))
    first = whole // 10**DIGITS
    return odd, [
        *_signed(first, np.signbit(values)),
        _POINT,
        *padded_groups(whole - first * 10**DIGITS, DIGITS),
        _exponents().take(exponent),
    ]


def _rounded(scaled: Floats) -> tuple[Bools, Ints]:
    """Which numbers are no whole ones, or near a tie; the others rounded, and 0 for these."""
    rounded = np.rint(scaled)
    slack = scaled * 1e-15 + 1e-9  # of the last bits of a power of ten and a product, generously
    odd: Bools = ~(np.abs(scaled - rounded) <= 0.5 - slack)
    rounded[odd] = 0.0
    return odd, rounded.astype(np.int64)


def _signed(size: Ints, negative: Bools) -> list[Codes]:
    """Whole numbers with a minus before those that are negative."""
    columns = len(str(size.max(initial=0))) + 1
    groups = signed_groups(size, negative, columns, shows_zero=True)
    return [one for one in groups if one is not None]


@cache
def _exponents() -> Codes:
    """The characters of the exponents from 0 to 99, then from -99 to -1."""
    exponents = [*range(MOST_EXPONENT + 1), *range(-MOST_EXPONENT, 0)]
    return np.frombuffer("".join(f"e{one:+03d}" for one in exponents).encode(), "<u4")


@cache
def _powers_of_ten() -> Floats:
    """The powers of ten from 0 to 199, then from -99 to -1."""
    exponents = [*range(2 * MOST_EXPONENT + 2), *range(-MOST_EXPONENT, 0)]
    return np.array([float(f"1e{one}") for one in exponents])


def _joined(groups: Sequence[Codes]) -> Characters:
    """Groups of characters (...) beside each other, with `NONE` for blanks."""
    shape = np.broadcast_shapes(*(one.shape for one in groups))
    fields = np.dtype([(f"group {k}", one.dtype) for k, one in enumerate(groups)])
    text = np.empty(shape, fields)
    for k, one in enumerate(groups):
        text[f"group {k}"] = one
    characters = text.view(np.uint8).reshape(*shape, fields.itemsize)
    return np.asarray(characters | ((characters == ord(" ")) * np.uint8(NONE)))
