"""Standard deviations of what a job is given, as the user states them."""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import isfinite

from vopd.findings import VopdError


@dataclass(frozen=True)
class Sigmas:
    """Standard deviations of what a job is given; 0 leaves a component out.

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
                raise VopdError(f"{name}: {value:g} is no standard deviation: 0 or more")
