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
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.errata import Fixes
from vopd.findings import Finding, VopdError
from vopd.job import Job
from vopd.records import ByLandmark, FrameRecord, Record, Rows

CONVERGED_RAD = 1e-6  # a frame has converged if its 22nd correction is at most this in every angle


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
class LandmarkResults(Rows):
    """The results of the landmarks of all frames, N of them, frame after frame."""

    landmark: Ints  # (N,)
    used: Bools  # (N,) takes part
    ignored: Bools  # (N,) left out by the user
    longitude_deg: Floats  # (N,)
    latitude_deg: Floats  # (N,) geodetic
    geocentric_latitude_deg: Floats  # (N,)
    altitude_ft: Floats  # (N,)
    radius_km: Floats  # (N,) from the Earth's centre
    radius_kft: Floats  # (N,) the same in thousands of feet
    direction: Floats  # (N, 3) cosines along east, north, up at the camera
    point_in: Floats  # (N, 2) on the reader
    point_mm: Floats  # (N, 2) on the film
    radius_mm: Floats  # (N,) from the centre, on the film
    distortion_mm: Floats  # (N,) minus the lens table
    residual_mm: Floats  # (N, 2) measured minus computed, on the film
    at_centre: Bools  # (N,) landmarks exactly at the frame's centre


@dataclass(frozen=True, eq=False, repr=False)
class Results(FrameRecord[LandmarkResults]):
    """The results of one job: everything that the listing prints, and more. F frames, L landmarks.

    Camera angles are yaw, pitch, roll (sigma 1, 2, 3) of the camera axes against
    east, north and the geocentric vertical at the camera (Appendix A); vehicle
    angles are yaw, pitch, roll (psi, theta, phi) by group 3.

    The arrays with an axis L are made when they are asked for; `points` has them without
    the columns that hold no landmark, (N, ...), by the `layout`. NaN, 0 or false stands where
    a frame has fewer landmarks than L.

    Attributes:
        job: what was solved
        fixes: which errata were corrected: none in a faithful run
        frame: frame numbers (F,)
        outcome: how each frame ended (F,), of `Outcome`
        time_s: seconds of flight (F,)
        vehicle_ft: east, north, up of the origin (F, 3)
        centre_in: of the frame on the reader (F, 2)
        centre_mm: the same on the film (F, 2)
        start_deg: camera angles that the solve started from (F, 3)
        camera_deg: yaw 0 to 360, pitch -180 to 180, roll 0 to 360 (F, 3)
        vehicle_deg: yaw, pitch, roll (F, 3)
        alpha_deg: angle of attack in pitch (F,)
        beta_deg: in yaw (F,)
        eta_deg: total, 0 to 180 (F,)
        airspeed_ft_s: (F,)
        residual_deviation_mm: the "standard deviation" of the listing (F,)
        correction_rad: the 22nd, which is not printed (F, 3)
        last_pass: the pass whose residuals all vanished, 0 where none (F,)
        singular: the normal matrix had no inverse (F,)
        outside_clock: frame number outside the time table (F,)
        outside_trajectory: time outside the trajectory table (F,)
        outside_wind: altitude outside the wind table (F,)
        stop: the table out of order that ended the run, if one did
        landmark: landmark numbers, in the order of reading (F, L)
        used: takes part (F, L)
        ignored: left out by the user (F, L)
        longitude_deg: (F, L)
        latitude_deg: geodetic (F, L)
        geocentric_latitude_deg: (F, L)
        altitude_ft: (F, L)
        radius_km: from the Earth's centre (F, L)
        radius_kft: the same in thousands of feet (F, L)
        direction: cosines along east, north, up at the camera (F, L, 3)
        point_in: mean of the three readings (F, L, 2)
        point_mm: the same on the film (F, L, 2)
        radius_mm: from the centre, on the film (F, L)
        distortion_mm: minus the lens table (F, L)
        residual_mm: measured minus computed, on the film (F, L, 2)
        at_centre: landmarks exactly at the frame's centre (F, L)
    """

    job: Job
    fixes: Fixes
    frame: Ints
    outcome: Ints
    time_s: Floats
    vehicle_ft: Floats
    centre_in: Floats
    centre_mm: Floats
    start_deg: Floats
    camera_deg: Floats
    vehicle_deg: Floats
    alpha_deg: Floats
    beta_deg: Floats
    eta_deg: Floats
    airspeed_ft_s: Floats
    residual_deviation_mm: Floats
    correction_rad: Floats
    last_pass: Ints
    singular: Bools
    outside_clock: Bools
    outside_trajectory: Bools
    outside_wind: Bools
    stop: Stop | None = None

    landmark = ByLandmark[Ints]()
    used = ByLandmark[Bools]()
    ignored = ByLandmark[Bools]()
    longitude_deg = ByLandmark[Floats](np.nan)
    latitude_deg = ByLandmark[Floats](np.nan)
    geocentric_latitude_deg = ByLandmark[Floats](np.nan)
    altitude_ft = ByLandmark[Floats](np.nan)
    radius_km = ByLandmark[Floats](np.nan)
    radius_kft = ByLandmark[Floats](np.nan)
    direction = ByLandmark[Floats](np.nan)
    point_in = ByLandmark[Floats](np.nan)
    point_mm = ByLandmark[Floats](np.nan)
    radius_mm = ByLandmark[Floats](np.nan)
    distortion_mm = ByLandmark[Floats](np.nan)
    residual_mm = ByLandmark[Floats](np.nan)
    at_centre = ByLandmark[Bools]()

    def as_job(self, frames: Ints) -> Results:
        """Take the results of some frames as those of a job that has no other frames."""
        job = replace(self.job, readings=self.job.readings.take(frames))
        return replace(self.take(frames), job=job)

    def divided(self, jobs: Sequence[Job]) -> list[Results]:
        """Divide the results among the jobs whose frames these are, one job after the other."""
        ends = np.cumsum([len(job.readings.frame) for job in jobs]).tolist()
        frames = (slice(*pair) for pair in pairwise([0, *ends]))
        return [replace(self.take(own), job=job) for own, job in zip(frames, jobs, strict=True)]

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

    source: str
    number: int
    results: Results
    findings: tuple[Finding, ...] = ()


class SourceEnd(NamedTuple):
    """The end of a deck or flight: the error that ended it early, if any, and the last warnings."""

    source: str
    error: VopdError | None = None
    findings: tuple[Finding, ...] = ()
