"""The results of one job: arrays for all its frames.

The frame axis comes first, then the landmark axis in the order of reading, and
x y or x y z last. What a frame did not reach is NaN, and so is what belongs to a
landmark that takes no part.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum, IntEnum
from functools import cached_property
from typing import Annotated, NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.errata import Fixes
from vopd.findings import Finding, VopdError
from vopd.job import Job
from vopd.records import LandmarkRecord, Record

CONVERGED_RAD = 1e-6
"""A frame has converged if its 22nd correction is at most this in every angle."""


class Outcome(IntEnum):
    """How a frame ended."""

    SOLVED = 0
    DROPPED = 1  # by group 11
    EXACT = 2  # all residuals exactly zero before pass 22: no groups 4 to 7, no tape record
    EXACT_LATE = 3  # ... in pass 22: no group 7
    STOPPED = 4  # a table out of order ended the run here


class Stage(Enum):
    """The stage at which a table look-up stopped the run; the frame's page ends there."""

    TIME = "before group 1"
    LENS = "after group 3"
    WIND = "after group 4"


@dataclass(frozen=True, eq=False, repr=False)
class Stop(Record):
    """A table out of order that ended the run: the frame, and what FTLUP printed."""

    frame_index: int
    stage: Stage
    group: int  # of the table's cards: 6, 7, 1 or 4
    table: str  # 'times'
    position: int  # from 1
    vari: Floats
    vard: Floats


@dataclass(frozen=True, eq=False, repr=False)
class Results(LandmarkRecord):
    """The results of one job: everything that the listing prints, and more. F frames, L landmarks.

    Camera angles are yaw, pitch, roll (sigma 1, 2, 3) of the camera axes against
    east, north and the geocentric vertical at the camera (Appendix A); vehicle
    angles are yaw, pitch, roll (psi, theta, phi) by group 3.

    The arrays with an axis L are made when they are asked for; `points` has them without
    the columns that hold no landmark, (N, ...), by the `layout`.
    """

    job: Job
    fixes: Fixes  # which errata were corrected: none in a faithful run
    frame: Annotated[Ints, "F"]
    outcome: Annotated[Ints, "F"]  # of Outcome
    time_s: Annotated[Floats, "F"]
    vehicle_ft: Annotated[Floats, "F 3"]  # east, north, up of the origin
    landmark: Annotated[Ints, "F L"]
    used: Annotated[Bools, "F L"]  # takes part
    ignored: Annotated[Bools, "F L"]  # left out by the user
    longitude_deg: Annotated[Floats, "F L"]
    latitude_deg: Annotated[Floats, "F L"]  # geodetic
    geocentric_latitude_deg: Annotated[Floats, "F L"]
    altitude_ft: Annotated[Floats, "F L"]
    radius_km: Annotated[Floats, "F L"]  # from the Earth's centre
    radius_kft: Annotated[Floats, "F L"]  # the same in thousands of feet
    direction: Annotated[Floats, "F L 3"]  # cosines along east, north, up at the camera
    centre_in: Annotated[Floats, "F 2"]  # on the reader
    point_in: Annotated[Floats, "F L 2"]  # on the reader
    centre_mm: Annotated[Floats, "F 2"]  # on the film
    point_mm: Annotated[Floats, "F L 2"]  # on the film
    radius_mm: Annotated[Floats, "F L"]  # from the centre, on the film
    distortion_mm: Annotated[Floats, "F L"]  # minus the lens table
    start_deg: Annotated[Floats, "F 3"]  # what the solve started from
    camera_deg: Annotated[Floats, "F 3"]  # yaw 0..360, pitch -180..180, roll 0..360
    vehicle_deg: Annotated[Floats, "F 3"]  # yaw, pitch, roll
    alpha_deg: Annotated[Floats, "F"]  # angle of attack in pitch
    beta_deg: Annotated[Floats, "F"]  # in yaw
    eta_deg: Annotated[Floats, "F"]  # total, 0..180
    airspeed_ft_s: Annotated[Floats, "F"]
    residual_mm: Annotated[Floats, "F L 2"]  # measured minus computed, on the film
    residual_deviation_mm: Annotated[Floats, "F"]  # the "standard deviation" of the listing
    correction_rad: Annotated[Floats, "F 3"]  # the 22nd, which is not printed
    last_pass: Annotated[Ints, "F"]  # the pass whose residuals all vanished, 0 where none
    singular: Annotated[Bools, "F"]  # the normal matrix had no inverse
    at_centre: Annotated[Bools, "F L"]  # landmarks exactly at the frame's centre
    outside_clock: Annotated[Bools, "F"]  # frame number outside the time table
    outside_trajectory: Annotated[Bools, "F"]  # time outside the trajectory table
    outside_wind: Annotated[Bools, "F"]  # altitude outside the wind table
    stop: Stop | None = None

    def __post_init__(self) -> None:
        self.keep_flat(self.job.readings.layout.only(slice(len(self.frame))))

    def as_job(self, frames: Ints) -> Results:
        """The results of some frames as those of a job that has no other frames.

        Args:
            frames: their indices
        """
        some = self.only(frames)
        some.__dict__["job"] = replace(self.job, readings=self.job.readings.only(frames))
        return some

    def divided(self, jobs: Sequence[Job]) -> list[Results]:
        """The results of each of the jobs whose frames these are, one job after the other.

        Args:
            jobs: the jobs
        """
        parts, end = [], 0
        for job in jobs:
            start, end = end, end + len(job.readings.frame)
            parts.append(self.only(slice(start, end)))
            parts[-1].__dict__["job"] = job
        return parts

    @cached_property
    def used_count(self) -> Ints:
        """How many landmarks of each frame take part (F,)."""
        return self.layout.counted(self.points.used)

    @property
    def focal_length_mm(self) -> Floats:
        """The camera's focal length, for every frame (F,)."""
        return np.full(len(self.frame), self.job.camera.focal_length_mm)

    @property
    def solved(self) -> Bools:
        """Frames with angles of pass 22, which are the frames on tape 10 (F,)."""
        solved = self.outcome == Outcome.SOLVED
        return np.asarray(solved | (self.outcome == Outcome.EXACT_LATE))

    @property
    def converged(self) -> Bools:
        """Frames whose 22nd correction is at most `CONVERGED_RAD`, or that were not solved (F,)."""
        small = np.abs(self.correction_rad) <= CONVERGED_RAD
        return np.asarray(np.all(small, axis=1) | ~self.solved)


@dataclass(frozen=True)
class SolvedJob:
    """A solved job: its deck, its number there from 1, its results, and the warnings."""

    deck: str
    number: int
    results: Results
    findings: tuple[Finding, ...] = ()


class DeckEnd(NamedTuple):
    """The end of a deck: the error that ended it early, if any, and the last warnings."""

    deck: str
    error: VopdError | None = None
    findings: tuple[Finding, ...] = ()
