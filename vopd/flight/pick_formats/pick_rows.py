"""What every reader of picks returns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from vopd.arrays import Floats, Ints


@dataclass(frozen=True, eq=False)
class PickRows:
    """The picks of a file as they stand in it, P of them."""

    frame: Ints | list[int] | list[str]  # numbers of frames, or names of images
    landmark: list[str]
    pixel: Floats  # (P, 2) u, v on the file's grid
    sigma_px: Floats  # (P,) NaN where not given
    line: Sequence[int]  # of each pick, from 1; 0 where lines mean nothing
    grid: str | None  # the grid, where the format fixes it
    size_px: tuple[int, int] | None  # of the images, where the file says
    said: str  # the format, for a sentence
