"""Standard deviations of the inputs of a job: those that the user gives, or the source states."""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import isfinite
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.estimate import Estimate
from vopd.findings import VopdError


@dataclass(frozen=True)
class Sigmas:
    """Standard deviations of the inputs of a job; 0 leaves a component out.

    Lengths are in feet for a card deck and in metres for a flight project; image
    coordinates in millimetres on the film for a deck and in pixels for a flight.

    Args:
        reading: of each image coordinate of a landmark (on film, the mean of its three
            readings); None estimates it from the residuals of all frames of the job
        fiducial: of each film coordinate of a fiducial, the mean of its three readings;
            None estimates it from the fiducials of the job
        landmark: of each landmark's position, along east, north and up; the same error
            in all frames
        position: of the camera's position, along east, north and up, frame by frame
        focal_length: of the focal length, the same error in all frames
        time_s: of the times of the frames, the same error in all frames, seconds
        velocity: of the velocity along north, east and down, length units a second,
            frame by frame
        wind: of the wind along north and east, length units a second, frame by frame
        mount_deg: of the camera's mounting in the vehicle, a turn about each of the
            vehicle's axes, the same in all frames, degrees

    Raises:
        VopdError: where one is negative or not a number
    """

    reading: float | None = None
    fiducial: float | None = None
    landmark: float = 0.0
    position: float = 0.0
    focal_length: float = 0.0
    time_s: float = 0.0
    velocity: float = 0.0
    wind: float = 0.0
    mount_deg: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if value is not None and not (isfinite(value) and value >= 0.0):
                name = field.name.removesuffix("_s").removesuffix("_deg").replace("_", " ")
                raise VopdError(f"{name} sigma: {value:g} is not a standard deviation: 0 or more")


class SigmasInForce(NamedTuple):
    """The standard deviations of one job, in the units of its estimate; 0: left out."""

    reading: float | None  # None: to be estimated from the residuals
    centre: float  # of x and y of the centre of each frame, by its fiducials
    principal_point: tuple[float, float]
    landmark: Floats  # (3,) east, north, up
    position: Floats  # (3,) east, north, up
    focal_length: float
    time_s: float
    velocity: float
    wind: float
    mount_deg: float


FIDUCIALS = 4.0  # of a frame; their mean is its centre


def in_force(estimate: Estimate, given: Sigmas) -> SigmasInForce:
    """The standard deviations of a job: what is given, else what its source states.

    Args:
        estimate: the job
        given: the user's
    """
    stated = estimate.stated
    fiducial = estimate.fiducial_sigma if given.fiducial is None else given.fiducial
    return SigmasInForce(
        reading=given.reading,
        centre=float(np.nan_to_num(fiducial)) / np.sqrt(FIDUCIALS),
        principal_point=stated.principal_point,
        landmark=np.array([given.landmark] * 3 if given.landmark > 0.0 else stated.landmark),
        position=np.array([given.position] * 3 if given.position > 0.0 else stated.position),
        focal_length=given.focal_length or stated.focal_length,
        time_s=given.time_s or stated.time_s,
        velocity=given.velocity,
        wind=given.wind,
        mount_deg=given.mount_deg,
    )
