"""What every reader of tracks returns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from vopd.arrays import Floats


@dataclass(frozen=True, eq=False)
class TrackRows:
    """The positions of a file as they stand in it, T of them, by time, by image, or both."""

    coordinate: Floats  # (T, 3) longitude, latitude, height; or x, y, z
    geodetic: bool  # longitude and latitude in degrees
    crs: str | None  # where the file says it
    clock: str | None  # utc, gps or seconds; utc-column where a column says only UTC; None: no time
    time_s: Floats | None  # (T,) seconds since 1970 or on a clock of the file's own
    said: str
    image: list[str] = field(default_factory=list)
    velocity_m_s: Floats | None = None  # (T, 3) north, east, down
    line: Sequence[int] = field(default_factory=list)
    gimbal_deg: Floats | None = None  # (T, 3) yaw, pitch, roll of the view, for comparison
    sigma_m: Floats | None = None  # (T, 3) east, north, up; NaN where not given
    height: str | None = None  # what heights are counted from, where the format says it
    whole_seconds: bool = False  # times without parts of a second, though a camera took them
    image_key: Callable[[str], str] = str  # what stands in `image` for the name of an image
