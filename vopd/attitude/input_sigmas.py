"""Standard deviations of the inputs of a job, as the user states them."""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import isfinite
from typing import NamedTuple

from vopd.estimate import Units
from vopd.findings import VopdError

METRES_PER_FOOT = 0.3048


class SigmasInUnits(NamedTuple):
    """`Sigmas` in the units of an estimate: lengths, image units, seconds."""

    reading: float | None
    landmark: float
    position: float
    focal_length: float
    time_s: float


@dataclass(frozen=True)
class Sigmas:
    """Standard deviations of the inputs of a job; 0 leaves a component out.

    Args:
        reading_mm: of each film coordinate of a landmark, the mean of its three
            readings; None takes it from the spread of the job's own readings
        landmark_ft: of each landmark's position, along east, north and up
        position_ft: of the vehicle's position, along east, north and up
        focal_mm: of the focal length
        time_s: of a frame's time

    Raises:
        VopdError: where one is negative or not a number
    """

    reading_mm: float | None = None
    landmark_ft: float = 0.0
    position_ft: float = 0.0
    focal_mm: float = 0.0
    time_s: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if value is not None and not (isfinite(value) and value >= 0.0):
                name = field.name.replace("_", " sigma, ", 1)
                raise VopdError(f"{name}: {value:g} is not a standard deviation: 0 or more")

    def of(self, units: Units) -> SigmasInUnits:
        """Convert to the units of an estimate.

        Raises:
            VopdError: where one is in millimetres and the image is not
        """
        if units.image != "mm" and (self.reading_mm is not None or self.focal_mm > 0.0):
            raise VopdError(f"reading and focal sigma are in mm, the image is in {units.image}")
        lengths = METRES_PER_FOOT / units.metres_per_length
        return SigmasInUnits(
            self.reading_mm,
            self.landmark_ft * lengths,
            self.position_ft * lengths,
            self.focal_mm,
            self.time_s,
        )
