"""The result of a solve: the angles of every frame, and how they depend on the inputs.

`vopd.attitude` works on this record alone, whether a card deck or a flight was
solved. The parts that depend on the kind of source, such as units and wording, are in
`About`, `Units` and `Words`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from datetime import datetime
from enum import IntEnum, StrEnum
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.findings import Finding
from vopd.records import Rows

if TYPE_CHECKING:
    from vopd.scene import JobScene


class FrameStatus(IntEnum):
    """How a frame ended."""

    SOLVED = 0
    IGNORED = 1  # left out by the user
    EXACT = 2  # all residuals became exactly zero
    STOPPED = 3  # the run ended in this frame
    UNSOLVED = 4  # too few landmarks, or the camera's position is not known


class Vertical(StrEnum):
    """The direction that local axes take for down."""

    GEODETIC = "geodetic"  # along the ellipsoid's normal: a plumb line but for its deflection
    GEOCENTRIC = "geocentric"  # toward the Earth's centre


class Units(NamedTuple):
    """The units of an estimate, as they stand in the names of columns."""

    length: str = "ft"
    image: str = "mm"
    metres_per_length: float = 0.3048
    residual: str = "µm"  # of residuals in pictures and in the report
    residuals_per_image: float = 1000.0  # how many of them are an image unit


@dataclass(frozen=True)
class Words:
    """Wording of tables, files, pictures and the report that depends on the kind of source.

    The defaults suit any source; those of card decks are in `vopd.film`.
    """

    source: str = "source"  # what the source is: a column's name, and in sentences
    jobs: bool = True  # whether it has several
    no_fixes: str = ""  # what it means that no erratum is corrected; empty where there is none
    surface: str = "in the image"  # where image coordinates are measured
    centre: str = "principal point"  # what they are counted from
    landmark: str = "its name or number"  # what identifies a landmark
    reading: str = "a measured image coordinate"  # what the reading sigma belongs to
    vertical: str = ""  # what the source leaves open about the vertical
    own_position: str = ""  # from where `Position.to_own_m` leads: the end of a sentence
    altitude: str = "above the ellipsoid"  # what altitudes are counted from
    attack: bool = True  # whether alpha and beta are those of a vehicle, or of a camera in the air
    sigma_keys: Mapping[str, str] = field(default_factory=dict)
    """Where the source states the standard deviation of some components, by their names."""
    columns: Mapping[str, str] = field(default_factory=dict)
    """The meaning of some columns of the table, by name, in place of the general one."""
    flags: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    """The meaning of some flags and what to do, in place of the general ones."""
    conventions: Mapping[str, str] = field(default_factory=dict)
    """Some of the statements of every file, by name, in place of the general ones."""


class About(NamedTuple):
    """The source of an estimate, and how it was made, as text."""

    source: str  # the name of the file that it was made from
    job: int = 1  # the job's number in it, from 1
    title: str = ""
    fixes: str = ""  # the errata that are corrected; empty for the original's numbers
    down: str = "along the ellipsoid's normal"  # what the local vertical is
    words: Words = Words()
    epoch: datetime | None = None  # the date of time zero, if the source states it
    doubt: str = ""  # how its residuals contradict the source as a whole; empty: they do not

    @property
    def label(self) -> str:
        """Name of the source and number of the job, such as `flight.dat, job 2`."""
        return f"{self.source}, job {self.job}" if self.words.jobs else self.source

    def warning(self, message: str) -> Finding:
        """Make a warning about the source, or the job where it has jobs."""
        job = self.job if self.words.jobs else None
        return Finding(message, self.source, job=job, severity="warning")


@dataclass(frozen=True, eq=False, repr=False)
class Position(Rows):
    """Position of the camera in each of F frames, and the local axes there.

    Geodetic latitude and longitude in degrees, longitude -180 to 180; `altitude` in
    units of length. `north_east_down` (F, 3, 3): the local axes as rows, in Earth-fixed
    components; their down is that of `vertical`. `to_own_m` (F, 2): metres east and north
    from this position to where the source's own coordinates put the camera on WGS 84;
    None where both are the same by definition. `largest_lean_deg`: the largest angle between
    the geodetic and the geocentric vertical at the positions of all frames of the job, where
    these may be some of them; None elsewhere.
    """

    latitude_deg: Floats
    longitude_deg: Floats
    altitude: Floats
    north_east_down: Floats
    geocentric_latitude_deg: Floats
    vertical: Vertical = Vertical.GEODETIC
    to_own_m: Floats | None = None
    largest_lean_deg: float | None = None


@dataclass(frozen=True, eq=False, repr=False)
class MapGrid(Rows):
    """Where the camera is in each of F frames on the grid of a projected coordinate system.

    `convergence_deg` is true azimuth less grid azimuth. Easting and northing are x and y in the
    unit of the system, toward west or south where its axes count so, as `counted` says.
    """

    crs: str
    easting: Floats
    northing: Floats
    convergence_deg: Floats
    counted: str = "easting and northing"


@dataclass(frozen=True, eq=False, repr=False)
class Responses(Rows):
    """Derivatives of residuals and angles of attack with respect to the inputs of the solve.

    The camera's angles are held fixed. Image coordinates 2L as in `Estimate`.
    """

    landmark: Floats  # (F, 2L, 3) a unit of length of that landmark east, north, up
    position: Floats  # (F, 2L, 3) a unit of length of the camera east, north, up
    focal_length: Floats  # (F, 2L) an image unit of the focal length
    time: Floats  # (F, 2L) a second of the frame's time: the camera is elsewhere on its path
    attack_by_camera: Floats  # (F, 3, 3) alpha, beta, eta by camera yaw, pitch, roll
    attack_by_time: Floats  # (F, 3) alpha, beta, eta, radians a second of the frame's time
    attack_by_velocity: Floats
    """(F, 3, 3) alpha, beta, eta, radians by north, east, down of the velocity, length a second."""


COMMON_PART = ", common"
"""The end of the name of a part of a component whose errors are common to the frames."""


@dataclass(frozen=True, eq=False, repr=False)
class InputErrors(Rows):
    """Changes of the attitude by errors of one standard deviation in each of C causes, radians."""

    camera: Floats  # (F, 3, C) of camera yaw, pitch, roll
    body: Floats  # (F, 3, C) small turns of the vehicle about forward, right, down
    attack: Floats  # (F, 3, C) of alpha, beta, eta, besides those by the turns


class StatedSigmas(NamedTuple):
    """Standard deviations that a source states, in the units of the estimate; 0: not stated."""

    landmark: tuple[float, float, float] = (0.0, 0.0, 0.0)  # east, north, up, of every landmark
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)  # east, north, up, of each frame
    focal_length: float = 0.0
    time_s: float = 0.0
    principal_point: tuple[float, float] = (0.0, 0.0)  # x, y; the same error in all frames
    place: tuple[float, float, float] = (0.0, 0.0, 0.0)  # of the position, the same in all frames
    wind: float = 0.0  # along north and east, the same in all frames
    mount_deg: float = 0.0  # about each of the vehicle's axes, the same in all frames


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class FrameEstimate(Rows):
    """The attitude of every frame of one job, F frames; the frame axis comes first.

    Angles in `_deg` are degrees.
    """

    about: About
    units: Units
    frame: Ints  # (F,) frame numbers
    status: Ints  # (F,) of FrameStatus
    solved: Bools  # (F,) whether the solve went through all its passes
    converged: Bools  # (F,)
    correction_rad: Floats  # (F, 3) the last one
    time_s: Floats  # (F,)
    position: Position
    displacement: Floats  # (F, 3) east, north, up of the track's origin
    camera_deg: Floats  # (F, 3) yaw, pitch, roll
    vehicle_deg: Floats  # (F, 3) yaw, pitch, roll
    attack_deg: Floats  # (F, 3) alpha, beta, eta
    airspeed: Floats  # (F,) units of length a second
    focal_length: Floats | float  # (F,) where the frames are of several jobs
    reading_spread: float  # sigma of an image coordinate by repeated readings; NaN: there are none
    reading_floor: float  # the least sigma of an image coordinate that its resolution allows
    fiducial_sigma: float = 0.0  # of a fiducial's coordinate; 0 where the image has no fiducials
    landmark_names: Mapping[int, str] = field(default_factory=dict)  # by number; empty: none
    frame_names: list[str] = field(default_factory=list)  # F names of the images; empty: none
    stated: StatedSigmas = field(default_factory=StatedSigmas)
    slip_effect_deg: Floats | None = None
    """(F, 9) in the order of `vopd.attitude.uncertainty.ANGLES`: the angles with all errata
    corrected minus these, each relative to the vertical of its own Earth, -180 to 180.

    NaN where the attitude is not determined; None where no erratum is left to correct.
    """
    grid: MapGrid | None = None  # of the landmarks' coordinate system, if that is projected
    gimbal_deg: Floats | None = None  # (F, 3) the gimbal's yaw, pitch, roll; never used
    lens: Ints | None = None  # (F,) which of several lenses each frame has, from 0; None: one
    rate_unknown: Bools | None = None
    """(F,) with a rolling shutter: no other frame says how fast the camera turns in this one."""
    extrapolated: Mapping[str, Bools] = field(default_factory=dict)
    """(F,) frames that lie beyond each of the tables of a deck, by the table's name."""
    scene: Callable[[], JobScene] | None = field(default=None, repr=False, compare=False)
    """Makes the surroundings of all frames of the job, for figures."""
    moved: Floats | None = None  # (F, 3) east, north, up from the stated to the solved position
    position_sigma: Floats | None = None  # (F, 3) of the position as solved, east, north, up

    def landmark_label(self, number: int) -> str:
        """Name a landmark, or give its number if it has no name."""
        return self.landmark_names.get(int(number), str(int(number)))

    def frame_label(self, index: int) -> str:
        """Name the image of a frame, or give the frame's number if it has no name."""
        return self.frame_names[index] if self.frame_names else str(int(self.frame[index]))

    def frame_key(self, index: int) -> tuple[int, str]:
        """Identify a frame by its number and its image's name, which is empty if it has none."""
        return int(self.frame[index]), self.frame_names[index] if self.frame_names else ""

    def without_landmarks(self) -> FrameEstimate:
        """Leave out the arrays by landmark and the equations, which `Estimate` has besides."""
        return FrameEstimate(**{f.name: getattr(self, f.name) for f in fields(FrameEstimate)})


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Estimate(FrameEstimate):
    """The attitude of every frame of one job, with the equations it was solved from.

    F frames, L landmarks. The 2L image coordinates of a frame stand in one axis: x of every
    landmark, then y; those of landmarks that take no part are 0. They are those of Appendix A
    of the 1974 report: seen from behind the camera x grows to the left and y up. Partials are
    by radians.
    """

    landmark: Ints  # (F, L) landmark numbers
    used: Bools  # (F, L) which take part
    ignored: Bools  # (F, L) which the user left out
    direction: Floats  # (F, L, 3) unit vectors from the camera, east, north, up
    image: Floats  # (F, L, 2) measured image coordinates x, y, corrected for lens distortion
    residual: Floats  # (F, 2L) measured minus computed
    partials: Floats  # (F, 2L, 3) of computed coordinates by camera yaw, pitch, roll
    gain: Floats  # (F, 3, 2L) of the camera's angles by the residuals; NaN without solution
    body_gain: Floats
    """(F, 3, 2L) small turns of the vehicle about forward, right, down, by the residuals."""
    vehicle_by_camera: Floats  # (F, 3, 3) vehicle yaw, pitch, roll by those of the camera
    responses: Responses
    relative_sigma: Floats  # (F, L) of each landmark's coordinates, in reading sigmas; 1 is usual
    test_residual: Floats | None = None
    """(F, 2L) residuals at the stated positions, for tests with their marginal covariance.

    None where positions and landmarks are not solved for: those of `residual`.
    """
    fix_sigma: Floats | None = None
    """(F, 3) of each frame's position by itself, as stated, in place of `stated.position`."""
    landmark_sigma: Floats | None = None
    """(F, L, 3) of each landmark's position, as stated, in place of `stated.landmark`."""
    velocity_sigma: Floats | None = None
    """(F, 3) of each frame's velocity, north, east, down; NaN where it is not known."""
    late_s: Floats | None = None
    """(F, C) errors of the frames' times besides `stated.time_s`, of C causes in all frames."""
    further: Mapping[str, Floats] = field(default_factory=dict)
    """(F, 2L, C) changes of the residuals by further errors, common to the frames if in `COMMON`.

    By component, one standard deviation each.
    """
    errors: Mapping[str, InputErrors] | None = None
    """The effect of the errors that were solved for or propagated with all frames together.

    By component, those that are common to the frames with `COMMON_PART` at the end; None where
    each frame was solved by itself, and `gain` has the effect.
    """
    image_by_ray: Floats | None = None
    """(F, L, 2, 3) derivatives of image coordinates by unit vectors along image x, image y and the
    optical axis, where each landmark was picked, for a lens whose image is none of a plane.

    None where `image` is a plane's, at the focal length from the camera.
    """
    position_ratio: Floats | None = None
    """(F,) standard deviation of the position after the solve over that before, the largest in any
    direction; None where it was not solved for."""
    other_solution_deg: Floats | None = None
    """(F,) how far the attitude is turned at another position that fits as well; NaN: none."""
    outlier: Bools | None = None
    """(F, L) the landmark that does not fit the others, where the source has tested it already."""
    exchanged: Floats | None = None
    """(F, L) landmarks with each other's label, two of a frame: the chance of its residuals with
    these exchanged; negative: it is not known; 0: nothing is exchanged; None: not tested."""

    @property
    def residual_xy(self) -> Floats:
        """The residuals as pairs x, y, (F, L, 2); NaN where a landmark takes no part."""
        pairs = np.stack(np.split(self.residual, 2, axis=1), axis=-1)
        return np.where(self.used[..., None], pairs, np.nan)


Block = tuple[Ints, Estimate]
"""Indices of frames that have like numbers of landmarks, and the estimate of these frames."""
