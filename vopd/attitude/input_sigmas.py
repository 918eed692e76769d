"""What is uncertain, and by how much: what the user says, and what the readings say."""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import isfinite

import numpy as np

from vopd.findings import VopdError
from vopd.job import Job
from vopd.program.constants import factor


@dataclass(frozen=True)
class Sigmas:
    """Standard deviations of what a job is given; 0 leaves a share out.

    `reading_mm` of each film coordinate of a landmark, the mean of its three
    readings; None takes it from the job's own readings. `landmark_ft` of each
    landmark, `position_ft` of the vehicle, each along east, north and up;
    `focal_mm` of the focal length; `time_s` of a frame's time. Raises
    `VopdError` where one is negative or not a number.
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


def reading_sigma_mm(job: Job) -> float:
    """The standard deviation of a landmark's film coordinate, mm, by its three readings.

    The spread of three readings has two degrees of freedom; all landmarks and
    both coordinates of the job are pooled, and the mean of three has a third of
    their variance. NaN where there is no landmark.
    """
    readings = job.readings.landmark_in[job.readings.present]
    if not len(readings):
        return float("nan")
    variance = readings.var(axis=1, ddof=1).mean()
    return float(factor * np.sqrt(variance / 3.0))
