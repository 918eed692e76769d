"""What a run leaves: one record of arrays for all frames of a job.

Frame axis first, landmark axis second in the order of reading, x y or
x y z last. What a frame has not reached, and what is masked, is NaN.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, IntEnum

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.errata import Fixes
from vopd.job import Job, Record


class Outcome(IntEnum):
    """How a frame ended."""

    SOLVED = 0
    DROPPED = 1  # by group 11
    EXACT = 2  # all residuals exactly zero before pass 22: no groups 4 to 7, no tape record
    EXACT_LATE = 3  # ... in pass 22: no group 7
    STOPPED = 4  # a table out of order ended the run here


class Stage(Enum):
    """How far the page of a stopped frame goes: what FTLUP was asked for then."""

    TIME = "before group 1"
    LENS = "after group 3"
    WIND = "after group 4"


@dataclass(frozen=True, eq=False, repr=False)
class Stop(Record):
    """A table out of order, which ended the run: in what frame, and what FTLUP printed."""

    frame_index: int
    stage: Stage
    group: int  # of the table's cards: 6, 7, 1 or 4
    table: str  # 'times'
    position: int  # from 1
    vari: Floats
    vard: Floats


@dataclass(frozen=True, eq=False, repr=False)
class Results(Record):
    """Everything that the listing prints, and some that it does not. F frames, L landmarks.

    Camera angles are yaw, pitch, roll (sigma 1, 2, 3) of the camera axes against
    east, north and the geocentric vertical at the camera (Appendix A); vehicle
    angles are yaw, pitch, roll (psi, theta, phi) by group 3.
    """

    job: Job
    fixes: Fixes  # which slips were corrected: none in a faithful run
    frame: Ints  # (F,)
    outcome: Ints  # (F,) of Outcome
    time_s: Floats  # (F,)
    vehicle_ft: Floats  # (F, 3) east, north, up of the origin
    landmark: Ints  # (F, L)
    used: Bools  # (F, L) takes part
    ignored: Bools  # (F, L) left out by the user
    longitude_deg: Floats  # (F, L)
    latitude_deg: Floats  # (F, L) geodetic
    geocentric_latitude_deg: Floats  # (F, L)
    altitude_ft: Floats  # (F, L)
    radius_km: Floats  # (F, L) from the Earth's centre
    radius_kft: Floats  # (F, L) the same in thousands of feet
    direction: Floats  # (F, L, 3) cosines along east, north, up at the camera
    centre_in: Floats  # (F, 2) on the reader
    point_in: Floats  # (F, L, 2) on the reader
    centre_mm: Floats  # (F, 2) on the film
    point_mm: Floats  # (F, L, 2) on the film
    radius_mm: Floats  # (F, L) from the centre, on the film
    distortion_mm: Floats  # (F, L) minus the lens table
    start_deg: Floats  # (F, 3) what the solve started from
    camera_deg: Floats  # (F, 3) yaw 0..360, pitch -180..180, roll 0..360
    vehicle_deg: Floats  # (F, 3) yaw, pitch, roll
    alpha_deg: Floats  # (F,) angle of attack in pitch
    beta_deg: Floats  # (F,) in yaw
    eta_deg: Floats  # (F,) total, 0..180
    airspeed_ft_s: Floats  # (F,)
    residual_mm: Floats  # (F, L, 2) measured minus computed, on the film
    residual_deviation_mm: Floats  # (F,) the "standard deviation" of the listing
    correction_rad: Floats  # (F, 3) the 22nd, which is not printed
    last_pass: Ints  # (F,) the pass whose residuals all vanished, 0 where none
    singular: Bools  # (F,) the normal matrix had no inverse
    at_centre: Bools  # (F, L) landmarks exactly at the frame's centre
    outside_clock: Bools  # (F,) frame number outside the time table
    outside_trajectory: Bools  # (F,) time outside the trajectory table
    outside_wind: Bools  # (F,) altitude outside the wind table
    stop: Stop | None = None

    @property
    def focal_length_mm(self) -> Floats:
        """The camera's focal length, for every frame (F,)."""
        return np.full(len(self.frame), self.job.camera.focal_length_mm)

    @property
    def solved(self) -> Bools:
        """Frames that have angles of pass 22, which are those on the tape (F,)."""
        return np.isin(self.outcome, (Outcome.SOLVED, Outcome.EXACT_LATE))

    @property
    def converged(self) -> Bools:
        """Solved frames whose 22nd correction is 1e-6 rad at most in every angle (F,)."""
        small = np.abs(self.correction_rad) <= 1e-6
        return np.asarray(np.all(small, axis=1) | ~self.solved)
