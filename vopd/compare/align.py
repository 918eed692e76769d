"""Pair the elements of two sequences in order: the pages of two listings, the lines of two pages.

Elements that are equal, or whose key occurs once in either sequence, are paired first. What lies
between them is paired at the least total cost, where an element left without a partner costs 1.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter
from collections.abc import Callable, Hashable, Sequence
from itertools import zip_longest
from math import inf
from typing import Protocol, TypeVar


class Alignable(Protocol):
    """An element that can be paired: its text, and a key that says what it is about.

    The key is equal for elements that should be paired, and None where nothing tells.
    """

    @property
    def text(self) -> Hashable: ...
    @property
    def key(self) -> Hashable: ...


T = TypeVar("T", bound=Alignable)
Pairs = list[tuple[T | None, T | None]]
"""The pairs in the order of both sequences; None where an element has no partner."""
Cost = Callable[[T, T], float]
"""What pairing two elements costs: 0 for equal ones, above 2 for those that must not be paired."""

SEARCH_LIMIT = 100_000
"""About how many pairs are weighed; of longer sequences only those near the diagonal are."""


def align(expected: Sequence[T], actual: Sequence[T], cost: Cost[T]) -> Pairs[T]:
    """Pair the elements of two sequences, keeping the order of both.

    Args:
        expected: the first sequence
        actual: the second sequence
        cost: what pairing an element of `expected` with one of `actual` costs

    Returns:
        Every element of both once, either with its partner or with None.
    """
    if [one.key for one in expected] == [other.key for other in actual]:
        return list(zip(expected, actual, strict=True))
    head = _equal_at_start(expected, actual)
    tail = _equal_at_start(expected[head:][::-1], actual[head:][::-1])
    expected_end, actual_end = len(expected) - tail, len(actual) - tail
    between = _align_between(
        expected[head:expected_end], actual[head:actual_end], cost, ("text", "key")
    )
    return [
        *zip(expected[:head], actual[:head], strict=True),
        *between,
        *zip(expected[expected_end:], actual[actual_end:], strict=True),
    ]


def _equal_at_start(expected: Sequence[T], actual: Sequence[T]) -> int:
    """How many elements at the start are equal in full."""
    count = 0
    for one, other in zip(expected, actual, strict=False):
        if one.text != other.text:
            break
        count += 1
    return count


def _align_between(
    expected: Sequence[T], actual: Sequence[T], cost: Cost[T], attributes: tuple[str, ...]
) -> Pairs[T]:
    """Pair elements that share a value found once in either sequence, then those between them."""
    if not attributes or not expected or not actual:
        return _cheapest(expected, actual, cost)
    pairs: Pairs[T] = []
    i = j = 0
    for p, q in _anchors(expected, actual, attributes[0]):
        pairs += _align_between(expected[i:p], actual[j:q], cost, attributes[1:])
        pairs.append((expected[p], actual[q]))
        i, j = p + 1, q + 1
    return pairs + _align_between(expected[i:], actual[j:], cost, attributes[1:])


def _anchors(expected: Sequence[T], actual: Sequence[T], attribute: str) -> list[tuple[int, int]]:
    """Indices of elements that share a value found once in either: the longest rising run."""
    values = [[getattr(one, attribute) for one in side] for side in (expected, actual)]
    unique = [{value for value, n in Counter(side).items() if n == 1} for side in values]
    shared = (unique[0] & unique[1]) - {None}
    index = {value: q for q, value in enumerate(values[1]) if value in shared}
    candidates = [(p, index[value]) for p, value in enumerate(values[0]) if value in shared]
    lowest: list[int] = []  # the lowest end of a rising run, by the run's length
    lengths = []
    for _, q in candidates:
        length = bisect_left(lowest, q)
        lowest[length : length + 1] = [q]
        lengths.append(length)
    run: list[tuple[int, int]] = []  # from its end: of one length, the last has the lowest index
    for (p, q), length in zip(reversed(candidates), reversed(lengths), strict=True):
        if length == len(lowest) - len(run) - 1:
            run.append((p, q))
    return run[::-1]


def _cheapest(expected: Sequence[T], actual: Sequence[T], cost: Cost[T]) -> Pairs[T]:
    """Pair at the least total cost, by dynamic programming in a band about the diagonal."""
    n, m = len(expected), len(actual)
    reach = max(abs(n - m) + 1, SEARCH_LIMIT // (2 * n + 1))
    if not n or not m or n * min(m, 2 * reach + 1) > 20 * SEARCH_LIMIT:
        return _in_order(expected, actual, cost)  # nothing to weigh, or too little in common
    above: dict[int, float] = {}  # the row before, by column; outside the band all is infinite
    moves: list[dict[int, tuple[int, int]]] = []
    for i in range(n + 1):
        costs: dict[int, float] = {}
        steps: dict[int, tuple[int, int]] = {}
        for j in range(max(0, i - reach), min(m, i + reach) + 1):
            best, step = (0.0, (0, 0)) if i == j == 0 else (inf, (0, 0))
            if j - 1 in above and i:
                best, step = above[j - 1] + cost(expected[i - 1], actual[j - 1]), (1, 1)
            if above.get(j, inf) + 1 <= best and i:  # of equals, pairs come first and gaps last
                best, step = above[j] + 1, (1, 0)
            if costs.get(j - 1, inf) + 1 <= best and j:
                best, step = costs[j - 1] + 1, (0, 1)
            costs[j], steps[j] = best, step
        above = costs
        moves.append(steps)
    return _retrace(expected, actual, moves)


def _in_order(expected: Sequence[T], actual: Sequence[T], cost: Cost[T]) -> Pairs[T]:
    """Pair first with first, second with second, except where the cost forbids it."""
    pairs: Pairs[T] = []
    for one, other in zip_longest(expected, actual):
        if one is not None and other is not None and cost(one, other) > 2:
            pairs += [(one, None), (None, other)]
        else:
            pairs.append((one, other))
    return pairs


def _retrace(
    expected: Sequence[T], actual: Sequence[T], moves: list[dict[int, tuple[int, int]]]
) -> Pairs[T]:
    """Follow the chosen moves back from the end to the start."""
    i, j = len(expected), len(actual)
    pairs: Pairs[T] = []
    while i or j:
        down, along = moves[i][j]
        i, j = i - down, j - along
        pairs.append((expected[i] if down else None, actual[j] if along else None))
    return pairs[::-1]
