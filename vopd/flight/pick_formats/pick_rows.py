"""What every reader of picks returns."""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
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
        self._which = array("i")
        self.extend(names)

    def extend(self, names: Iterable[str]) -> None:
        """Add names at the end."""
        number = self._number
        self._which.extend([number.setdefault(name, len(number)) for name in names])

    @property
    def known(self) -> list[str]:
        return list(self._number)

    @property
    def which(self) -> Ints:
        return np.asarray(self._which)

    def __len__(self) -> int:
        return len(self._which)

    def __getitem__(self, k: Any) -> Any:
        return self.known[self._which[k]]

    def __iter__(self) -> Iterator[str]:
        return map(self.known.__getitem__, self._which)


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
