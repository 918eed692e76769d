"""What every reader of picks returns."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from vopd.arrays import Floats, Ints


class Names(Sequence[str]):
    """The names of P frames or landmarks, each of which is kept once.

    Attributes:
        known: the different names, in the order in which they come
        which: which of them each is, (P,)
    """

    def __init__(self, names: Iterable[str] = ()) -> None:
        self._number: dict[str, int] = {}
        self._blocks: list[Ints] = []
        self.extend(names)

    def extend(self, names: Iterable[str]) -> None:
        """Add names at the end."""
        number = self._number
        self._blocks.append(np.array([number.setdefault(n, len(number)) for n in names], np.int64))

    @property
    def known(self) -> list[str]:
        return list(self._number)

    @cached_property
    def which(self) -> Ints:
        return np.concatenate(self._blocks)

    def __len__(self) -> int:
        return len(self.which)

    def __getitem__(self, k: Any) -> Any:
        return self.known[self.which[k]]

    def __iter__(self) -> Iterator[str]:
        return map(self.known.__getitem__, self.which.tolist())


@dataclass(frozen=True, eq=False)
class PickRows:
    """The picks of a file as they stand in it, P of them."""

    frame: Ints | Names  # numbers of frames, or names of images
    landmark: Names
    pixel: Floats  # (P, 2) u, v on the file's grid
    sigma_px: Floats  # (P,) NaN where not given
    grid: str | None  # the grid, where the format fixes it
    size_px: tuple[int, int] | None  # of the images, where the file says
    said: str  # the format, for a sentence
