"""Which item of one sequence stands beside which of another: pages of listings, lines of pages.

Items that are equal in full, or that alone bear their key, are paired first;
what lies between is paired as cheaply as possible, where leaving an item alone
costs 1.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter
from collections.abc import Callable, Hashable, Sequence
from itertools import zip_longest
from math import inf
from typing import Protocol, TypeVar


class Alignable(Protocol):
    """`raw` is the whole item; `key` is what it is about, None when nothing tells."""

    @property
    def raw(self) -> Hashable: ...
    @property
    def key(self) -> Hashable: ...


T = TypeVar("T", bound=Alignable)
Pairs = list[tuple[T | None, T | None]]
"""In the order of both sequences; None where an item has no partner."""
Cost = Callable[[T, T], float]
"""What pairing two items costs: 0 for equal ones, over 2 for what must not be paired."""

CELLS = 100_000
"""About how many pairs are weighed before only those near the diagonal are."""


def align(expected: Sequence[T], actual: Sequence[T], cost: Cost[T]) -> Pairs[T]:
    """Pair the items of two sequences, keeping the order of both."""
    if [item.key for item in expected] == [item.key for item in actual]:
        return list(zip(expected, actual, strict=True))
    head = _common(expected, actual)
    tail = _common(expected[head:][::-1], actual[head:][::-1])
    end, stop = len(expected) - tail, len(actual) - tail
    return [
        *zip(expected[:head], actual[:head], strict=True),
        *_between(expected[head:end], actual[head:stop], cost, ("raw", "key")),
        *zip(expected[end:], actual[stop:], strict=True),
    ]


def _common(expected: Sequence[T], actual: Sequence[T]) -> int:
    """How many items at the start are equal in full."""
    count = 0
    for one, other in zip(expected, actual, strict=False):
        if one.raw != other.raw:
            break
        count += 1
    return count


def _between(
    expected: Sequence[T], actual: Sequence[T], cost: Cost[T], marks: tuple[str, ...]
) -> Pairs[T]:
    """Pair what bears a mark found once on either side, then what is left between."""
    if not marks or not expected or not actual:
        return _cheapest(expected, actual, cost)
    pairs: Pairs[T] = []
    i = j = 0
    for p, q in _anchors(expected, actual, marks[0]):
        pairs += _between(expected[i:p], actual[j:q], cost, marks[1:])
        pairs.append((expected[p], actual[q]))
        i, j = p + 1, q + 1
    return pairs + _between(expected[i:], actual[j:], cost, marks[1:])


def _anchors(expected: Sequence[T], actual: Sequence[T], mark: str) -> list[tuple[int, int]]:
    """The longest rising run of places of the marks that either side bears once."""
    sides = [[getattr(item, mark) for item in side] for side in (expected, actual)]
    once = [{value for value, n in Counter(side).items() if n == 1} for side in sides]
    shared = (once[0] & once[1]) - {None}
    place = {value: q for q, value in enumerate(sides[1]) if value in shared}
    places = [(p, place[value]) for p, value in enumerate(sides[0]) if value in shared]
    lowest: list[int] = []  # the lowest end of a rising run, by the run's length
    lengths = []
    for _, q in places:
        length = bisect_left(lowest, q)
        lowest[length : length + 1] = [q]
        lengths.append(length)
    run: list[tuple[int, int]] = []  # from its end: of one length, the last has the lowest place
    for (p, q), length in zip(reversed(places), reversed(lengths), strict=True):
        if length == len(lowest) - len(run) - 1:
            run.append((p, q))
    return run[::-1]


def _cheapest(expected: Sequence[T], actual: Sequence[T], cost: Cost[T]) -> Pairs[T]:
    """Least total cost, by dynamic programming in a band about the diagonal."""
    n, m = len(expected), len(actual)
    reach = max(abs(n - m) + 1, CELLS // (2 * n + 1))
    if not n or not m or n * min(m, 2 * reach + 1) > 20 * CELLS:
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
    i, j = len(expected), len(actual)
    pairs: Pairs[T] = []
    while i or j:
        down, along = moves[i][j]
        i, j = i - down, j - along
        pairs.append((expected[i] if down else None, actual[j] if along else None))
    return pairs[::-1]
