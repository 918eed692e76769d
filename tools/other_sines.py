"""The same decks with sines that differ in their last bits, as those of another computer do.

`low_and_high` makes two listings of a deck, with every number as low and as high as other
sines make it. Digits in which the two differ are not determined.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar
from unittest.mock import patch

import numpy as np

from vopd.arrays import Floats
from vopd.listing.pages import end_of_case, pages
from vopd.pipeline import solve_decks
from vopd.records import Record
from vopd.results import Results, SolvedJob

FUNCTIONS = ("sin", "cos", "tan", "arcsin", "arctan", "arctan2", "hypot", "log10")
UNITS = 4
"""How many units in the last place a value is moved by, at most: numpy's bound for its sines."""
SEEDS = range(1, 9)


@contextmanager
def other_sines(seed: int, units: int = UNITS) -> Iterator[None]:
    """Within it, numpy's functions give values moved by up to so many units in the last place.

    The same argument gives the same value, and another seed another one.
    """
    with ExitStack() as stack:
        for name in FUNCTIONS:
            stack.enter_context(patch.object(np, name, _moved(getattr(np, name), seed, units)))
        yield


def _moved(function: Callable[..., Any], seed: int, units: int) -> Callable[..., Any]:
    multiplier = np.uint64((0x9E3779B97F4A7C15 * (2 * seed + 1)) % 2**64)

    @np.errstate(over="ignore")
    def moved(*arguments: Any) -> Any:
        value = np.asarray(function(*arguments), dtype=np.float64)
        mixed = np.zeros(value.shape, np.uint64)
        for one in (*arguments, value):
            bits = np.array(np.broadcast_to(one, value.shape), dtype=np.float64).view(np.uint64)
            mixed = (mixed ^ bits) * multiplier
            mixed ^= mixed >> np.uint64(29)
        away = (mixed >> np.uint64(16)) % np.uint64(2 * units + 1)
        exact = ~np.isfinite(value) | (value == 0.0) | (np.abs(value) == 1.0)
        near = value + (away.astype(np.float64) - units) * np.spacing(np.abs(value))
        return np.where(exact, value, near)[()]

    return moved


def low_and_high(deck: Path, seeds: Sequence[int] = SEEDS) -> tuple[bytes, bytes]:
    """Two listings of a deck between which its numbers lie, by all seeds and twice beyond.

    Raises:
        ValueError: where a frame ends in another way with other sines
    """
    own, last = results_of(deck)
    low, high = [], []
    others = []
    for seed in seeds:
        with other_sines(seed):
            others.append(results_of(deck)[0])
    for which, results in enumerate(own):
        both = _range(results, [other[which] for other in others])
        low.append(b"".join(pages(both[0])))
        high.append(b"".join(pages(both[1])))
    return b"".join(low) + last, b"".join(high) + last


def results_of(deck: Path) -> tuple[list[Results], bytes]:
    """The results of all jobs of a deck, and what its listing ends with."""
    results, last = [], b""
    for one in solve_decks([str(deck)]):
        if isinstance(one, SolvedJob):
            results.append(one.results)
        elif one.error is None:
            last = end_of_case()
    return results, last


One = TypeVar("One", bound=Record)


@np.errstate(all="ignore")
def _range(own: Results, others: Sequence[Results]) -> tuple[Results, Results]:
    """The results with all numbers as low, and as high, as they may be."""
    for other in others:
        if not np.array_equal(own.outcome, other.outcome):
            raise ValueError("a frame ends in another way with other sines")
    low, high = _limits(own, others)
    low_points, high_points = _limits(own.points, [other.points for other in others])
    return replace(low, points=low_points), replace(high, points=high_points)


def _limits(own: One, others: Sequence[One]) -> tuple[One, One]:
    """The record with all real numbers of its arrays as low, and as high, as they may be."""
    low: dict[str, Floats] = {}
    high: dict[str, Floats] = {}
    for name, array in vars(own).items():
        if isinstance(array, np.ndarray) and array.dtype == np.float64:
            values = np.stack([getattr(one, name) for one in (own, *others)])
            least, most = values.min(axis=0), values.max(axis=0)
            same = ~(least < most)  # NaN too
            low[name] = np.where(same, values[0], least - (most - least))
            high[name] = np.where(same, values[0], most + (most - least))
    return replace(own, **low), replace(own, **high)
