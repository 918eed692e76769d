"""What every reader of landmarks returns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from vopd.arrays import Floats


@dataclass(frozen=True, eq=False)
class LandmarkRows:
    """The landmarks of a file as they stand in it, N of them."""

    name: list[str]
    coordinate: Floats  # (N, 3) longitude, latitude, height; or x, y, z
    geodetic: bool  # longitude and latitude in degrees
    crs: str | None  # where the file says it
    sigma_m: Floats  # (N,) NaN where not given
    line: Sequence[int]
    said: str
