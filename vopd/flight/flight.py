"""A flight: one camera's picks, landmarks, positions and lens, after all its files have been read.

All lengths are metres, all positions Earth-centred on WGS 84, all pixels on the grid
whose (0, 0) is the centre of the first pixel, u right, v down.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from datetime import datetime
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vopd.arrays import Array, Bools, Floats, Ints
from vopd.attitude.sigmas import Sigmas
from vopd.estimate import MapGrid
from vopd.findings import Finding
from vopd.geometry.earth import local_axes
from vopd.geometry.lenses import Lens


@dataclass(frozen=True, eq=False)
class Clicks:
    """A person's clicks, C of them, and R readings of picks that carry their errors.

    A reading is a pick's pixel as one click's track has it; a click is one in its own frame. A
    pick is the mean of its readings, each with the weight of its own variance. They have one error
    besides those of their clicks, that of the landmark in the frame: by how little they differ
    tells nothing of it.
    """

    frame: Ints  # (C,) index into the frames of the flight
    landmark: Ints  # (C,) index into its landmarks
    sigma_px: Floats  # (C,) standard deviation of u and of v
    pick: Ints  # (R,) index into the picks, ascending
    click: Ints  # (R,)
    off_px: Floats  # (R, 2) from the pick to the reading
    by_click: Floats  # (R, 2, 2) shift of the reading by a shift of the click
    own_px: Floats  # (R,) standard deviation of u and of v besides the click's error, as if alone
    lost: Ints  # numbers of frames in which fewer than two landmarks are found
    root: Floats | None = None
    """Times its transpose the covariance of u, v of all clicks, (2C, C'); None: by `sigma_px`."""
    hidden: frozenset[tuple[str, int]] = frozenset()
    """Frames, by number or image, and indices of landmarks that a person has marked as hidden."""
    wrong: Floats = field(default_factory=lambda: np.zeros((0, 4)))
    """Clicks that do not fit and are left out: index of frame, of landmark, u, v, (W, 4)."""

    @cached_property
    def part(self) -> Floats:
        """The part of each reading in its pick, (R,)."""
        weight = self.own_px**-2.0
        total = np.bincount(self.pick, weight, int(self.pick.max(initial=-1)) + 1)
        return np.asarray(weight / total[self.pick])

    def of_picks(self, picks: Ints) -> Clicks:
        """Take the readings of some of the picks, by their indices, each once."""
        order = np.argsort(self.pick, kind="stable")
        first, last = (np.searchsorted(self.pick[order], picks, side) for side in ("left", "right"))
        count = last - first
        start = np.repeat(first - (np.cumsum(count) - count), count)
        rows = order[start + np.arange(len(start))]
        return self.readings(rows, np.repeat(np.arange(len(picks)), count))

    def readings(self, rows: Ints, pick: Ints) -> Clicks:
        """Take some of the readings, and count their picks anew.

        Args:
            rows: their indices
            pick: the new index of each one's pick
        """
        return replace(
            self,
            pick=pick,
            click=self.click[rows],
            off_px=self.off_px[rows],
            by_click=self.by_click[rows],
            own_px=self.own_px[rows],
        )

    def variance_px2(self, picks: int) -> Floats:
        """Add up the covariances of picks by the errors of their clicks, (P, 2, 2)."""
        by = self.by_click * (self.part * self.sigma_px[self.click])[:, None, None]
        out = np.zeros((picks, 2, 2))
        np.add.at(out, self.pick, by @ by.swapaxes(1, 2))
        return out


@dataclass(frozen=True, eq=False)
class Picks:
    """Where landmarks were picked in images, P picks; several of one point are averaged already."""

    frame: Ints  # (P,) index into the frames of the flight
    landmark: Ints  # (P,) index into the landmarks of the flight
    pixel: Floats  # (P, 2) u, v
    sigma_px: Floats  # (P,) standard deviation of u and of v
    repeatability_px: float = float("nan")  # of one pick, from points picked several times
    one_sigma_px: float = 1.0  # usual standard deviation of one pick, as stated
    least_sigma_px: float = 0.3  # below this a smaller one is not believed: rounding to pixels
    stated: bool = False  # whether the standard deviations are those of the project or a file
    part: Floats | None = None  # (P,) `row_parts`, where pixels are shifted to their frames' times
    v_up: bool = False  # whether v was counted upward where they were read
    v_said: bool = False  # whether their file says that it counts down
    clicks: Clicks | None = None  # whose errors the picks carry, besides `sigma_px`
    followed: Bools | None = None  # (P,) by another program from frame to frame; None: not known
    unused: frozenset[int] = frozenset()  # landmarks that were picked, and no pick of them is used

    def with_sigma(self, one_sigma_px: float) -> Picks:
        """Scale all standard deviations to another usual one of a pick."""
        factor, clicks = one_sigma_px / self.one_sigma_px, self.clicks
        if clicks is not None:
            clicks = replace(clicks, own_px=clicks.own_px * factor)
        sigma_px = self.sigma_px * factor
        return replace(self, sigma_px=sigma_px, one_sigma_px=one_sigma_px, clicks=clicks)

    @property
    def with_clicks_as_own(self) -> Picks:
        """The picks as they are by themselves: with the variance that their clicks add."""
        if self.clicks is None:
            return self
        variance = np.trace(self.clicks.variance_px2(len(self.frame)), axis1=1, axis2=2) / 2.0
        sigma_px = np.sqrt(self.sigma_px**2 + variance)
        usual = float(np.median(sigma_px)) if len(sigma_px) else 1.0
        return replace(self, sigma_px=sigma_px, one_sigma_px=usual, clicks=None)

    @property
    def least_variance(self) -> float:
        """Rounding of the picks, in their usual variance: residuals tell no less."""
        return float((self.least_sigma_px / self.one_sigma_px) ** 2)


@dataclass(frozen=True, eq=False)
class LandmarkSet:
    """Points with known positions, N of them."""

    name: tuple[str, ...]
    position_m: Floats  # (N, 3) Earth-centred
    sigma_m: Floats  # (N, 3) east, north, up; 0: exact
    used: tuple[bool, ...] = ()  # false for check landmarks: predicted, not used; empty: all used
    patch_px: Floats | None = None  # (N,) side of the patch of `vopd track`; NaN: the usual one

    @property
    def takes_part(self) -> Bools:
        """Mark the landmarks that are no check landmarks, (N,)."""
        return np.array(self.used or (True,) * len(self.name), dtype=bool)

    @cached_property
    def axes(self) -> Floats:
        """East, north, up at each as rows, Earth-centred components (N, 3, 3)."""
        return local_axes(self.position_m)

    @cached_property
    def number(self) -> Ints:
        """A number for each (N,): its name where all names are whole numbers, else from 1."""
        if all(name.isascii() and name.isdigit() and len(name) < 18 for name in self.name):
            own = np.array([int(name) for name in self.name], dtype=np.int64)
            if len(set(own.tolist())) == len(own):
                return own
        return np.arange(1, len(self.name) + 1, dtype=np.int64)


@dataclass(frozen=True, eq=False)
class TrackSlopes:
    """Velocity and acceleration of F frames as sums over the fixes of a track.

    An error of a fix is one of the velocity as well, and with it of the place of a camera whose
    frames are later than they say.
    """

    first: Ints  # index of the first fix, (F,)
    by_velocity: Floats  # (F, W) weights of that fix and those after it, 1/s
    by_acceleration: Floats  # (F, W) likewise, 1/s^2
    velocity_m_s: Floats  # (F, 3) north, east, down
    acceleration_m_s2: Floats  # (F, 3) likewise
    late_s: Floats  # (F,) by which the stated positions are already later

    def of_frames(self, frames: Ints) -> TrackSlopes:
        """Take some of the frames, by their indices."""
        values = {one.name: getattr(self, one.name)[frames] for one in fields(self)}
        return TrackSlopes(**values)


@dataclass(frozen=True, eq=False)
class TrackFixes:
    """The errors of J fixes of a track, and the part that each of F frames has in them."""

    first: Ints  # index of the first fix that a frame depends on, (F,)
    # the frame's part in that fix and those after it, (F, W): 1 - a and a between two fixes, 1 at a
    # fix
    weight: Floats
    sigma_m: Floats  # prior standard deviations, east, north, up, (J, 3)
    # those that are no fix but the shape of the path between two, its curvature, m/s^2, or the
    # change of that, m/s^3, (J,); None: there is none
    between: Bools | None = None
    slopes: TrackSlopes | None = None  # of a short track without velocities; None: of any other

    @property
    def of_positions_m(self) -> Floats:
        """The standard deviations of the positions themselves, east, north, up, (K, 3)."""
        return self.sigma_m if self.between is None else self.sigma_m[~self.between]

    def later(self, late_s: Floats) -> TrackFixes:
        """Write the parts of frames that are later than the stated positions.

        Args:
            late_s: of each frame, (F,)
        """
        slopes = self.slopes
        if slopes is None:
            return self
        late = (slopes.late_s + late_s)[:, None]
        weight = slopes.by_velocity * late + slopes.by_acceleration * (late**2 / 2.0)
        slot = (self.first - slopes.first)[:, None] + np.arange(self.weight.shape[1])
        inside = slot < weight.shape[1]  # behind the last there are none
        weight[np.nonzero(inside)[0], slot[inside]] += self.weight[inside]
        return replace(self, first=slopes.first, weight=weight, slopes=None)

    def speeds(self, late_s: Floats) -> TrackFixes:
        """Differentiate the parts of frames by how late they are.

        Args:
            late_s: of each frame, (F,)
        """
        slopes = self.slopes
        assert slopes is not None
        late = (slopes.late_s + late_s)[:, None]
        weight = slopes.by_velocity + slopes.by_acceleration * late
        return replace(self, first=slopes.first, weight=weight, slopes=None)

    @property
    def exact(self) -> bool:
        """Whether the fixes have no errors, and only the path between them has."""
        return self.between is not None and not self.sigma_m[~self.between].any()

    def seen_by(self, frames: Ints) -> Ints:
        """List the fixes that frames depend on, both by their indices."""
        needed = np.zeros(len(self.sigma_m), bool)
        sources = [(self.first, self.weight)]
        if self.slopes is not None:
            sources.append((self.slopes.first, self.slopes.by_velocity))
        for first, weight in sources:
            index = first[frames, None] + np.arange(weight.shape[1])
            needed[index[index < len(needed)]] = True
        return np.flatnonzero(needed)

    def of_frames(self, frames: Ints) -> TrackFixes:
        """Take the parts that some of the frames have in the fixes, and the fixes they depend on.

        Args:
            frames: their indices
        """
        seen = self.seen_by(frames)
        first, slopes = np.searchsorted(seen, self.first[frames]), self.slopes
        if slopes is not None:
            slopes = slopes.of_frames(frames)
            slopes = replace(slopes, first=np.searchsorted(seen, slopes.first))
        between = None if self.between is None else self.between[seen]
        return TrackFixes(first, self.weight[frames], self.sigma_m[seen], between, slopes)

    def frames_of(self, fix: int) -> Ints:
        """List the frames that depend on a fix, by their indices."""
        slot = fix - self.first[:, None] == np.arange(self.weight.shape[1])
        return np.flatnonzero((slot & (self.weight > 0.0)).any(axis=1))

    @property
    def frame_sigma_m(self) -> Floats:
        """Standard deviations of the frames' positions, east, north, up, (F, 3)."""
        squared = replace(self, weight=self.weight**2)
        return np.asarray(np.sqrt(squared.at_frames(self.sigma_m[..., None] ** 2)[..., 0]))

    @property
    def together(self) -> int:
        """Count the fixes in a block: a frame depends on those of two blocks at most."""
        return max(int(self.weight.shape[1]) - 1, 1)

    @cached_property
    def block(self) -> Ints:
        """The first of the two blocks of each frame (F,)."""
        return np.asarray(self.first // self.together)

    @cached_property
    def by_block(self) -> Floats:
        """The part of each frame in the fixes of its two blocks, (F, 2 * together)."""
        frames, width = self.weight.shape
        wide = np.zeros((frames, 2 * self.together))
        slot = (self.first - self.block * self.together)[:, None] + np.arange(width)
        # a last fix that a frame has no part in may lie beyond the two blocks
        inside = slot < wide.shape[1]
        wide[np.nonzero(inside)[0], slot[inside]] = self.weight[inside]
        return wide

    def at_frames(self, each: Array) -> Array:
        """Interpolate values of fixes for all frames, (F, 3, k).

        Args:
            each: of the fixes, (J, 3, k)
        """
        index = np.minimum(self.first[:, None] + np.arange(self.weight.shape[1]), len(each) - 1)
        total = np.zeros((len(self.first), *each.shape[1:]), each.dtype)
        for slot, weight in enumerate(self.weight.T):
            total += weight[:, None, None] * each[index[:, slot]]
        return total

    @property
    def blocks(self) -> int:
        """The number of blocks; the last one is filled up with fixes that no frame has."""
        return max(-(-len(self.sigma_m) // self.together), int(self.block.max(initial=0)) + 2)


@dataclass(frozen=True, eq=False)
class CameraPath:
    """Where the camera was in each of F frames."""

    position_m: Floats  # (F, 3) Earth-centred; NaN where the track does not cover the frame
    fixes: TrackFixes | None = None  # errors of a track's rows, independent; None: exact
    bias_sigma_m: Floats = field(default_factory=lambda: np.zeros(3))
    # (3,) east, north, up, common to all frames: of a camera that stands, of a track's bias
    velocity_m_s: Floats | None = None  # (F, 3) north, east, down against the ground
    velocity_sigma_m_s: Floats | None = None  # (F, 3) likewise; 0: exact; None: not stated
    acceleration_m_s2: Floats | None = None  # (F, 3) north, east, down
    wind_m_s: Floats | None = None  # (F, 2) toward north, toward east
    wind_sigma_m_s: float = 0.0  # of both, common to all frames
    lever_arm_m: Floats | None = None  # (3,) antenna to camera in body axes forward, right, down
    gimbal_deg: Floats | None = None  # (F, 3) yaw, pitch, roll of the view, for comparison only
    turning_rad_s: Floats | None = None
    """(F, 3) how fast a camera with a rolling shutter turns about its own right, down, forward.

    NaN where no other frame is near enough; None before a first solve.
    """
    turning_rad_s2: Floats | None = (
        None  # (F, 3) how that changes, of tracked flights; 0: not known
    )
    row_s: Floats | None = None  # (T,) a track's times on the frames' clock; None: it has none
    of_position: bool = False  # whether `[position]` states it, and no track
    weave: tuple[float, float] | None = None
    """Amplitude, m, and period, s, of one that the velocity misses; None: it is no fitted one."""

    def later(self, late_s: Floats) -> CameraPath:
        """Take velocities of frames that are later than they say; the positions stay.

        Args:
            late_s: of each frame, (F,)
        """
        if not late_s.any():
            return self
        velocity, fixes = self.velocity_m_s, self.fixes
        if velocity is not None and self.acceleration_m_s2 is not None:
            velocity = velocity + self.acceleration_m_s2 * late_s[:, None]
        if fixes is not None and fixes.slopes is not None:
            slopes = replace(fixes.slopes, late_s=fixes.slopes.late_s + late_s)
            fixes = replace(fixes, slopes=slopes)
        return replace(self, velocity_m_s=velocity, fixes=fixes)

    @property
    def stands(self) -> bool:
        """Whether the camera does not move: it has one position and one error in all frames."""
        return self.fixes is None and bool((self.position_m == self.position_m[:1]).all())


@dataclass(frozen=True)
class Refraction:
    """Refraction along the line of sight.

    `k` is the coefficient at the ground; with `decays` it falls with height as
    exp(-z / 8 km). k = 0 is none.
    """

    k: float = 0.13
    decays: bool = True


@dataclass(frozen=True)
class Shutter:
    """A rolling shutter: rows, or columns, of an image are read one after the other."""

    readout_s: float  # from the first row to the last
    way: str  # in which rows are read: down, up; columns: right, left
    middle: bool  # a frame's time is that of its middle row, not of the first one

    def parts(self, pixel: Floats, size_px: Floats) -> Floats:
        """Find when rows of pixels (..., 2) are read after the frame's time, in readouts, (...)."""
        axis = int(self.way in ("down", "up"))
        part = pixel[..., axis] / np.maximum(size_px[..., axis] - 1.0, 1.0)  # of one row, too
        if self.way in ("up", "left"):
            part = 1.0 - part
        return np.asarray(part - 0.5 * self.middle)


class VehicleAttitudes(NamedTuple):
    """Attitudes of the vehicle that a file has, T of them, and the mount that they show."""

    name: str  # of the file
    by: str  # the column that says when: frame, image, one of times
    keys: tuple[str, ...]  # (T,) its texts
    time_s: Floats  # (T,) on the frames' clock; NaN: by frame or image
    body_to_ned: Floats  # (T, 3, 3)
    sigma_rad: Floats  # (T,) about each axis, each attitude by itself
    turned_deg: Floats | None = None  # (3,) of the mount, about the vehicle's forward, right, down
    covariance_deg2: Floats | None = None  # (3, 3) of that
    apart: tuple[float, float] = (0.0, 0.0)
    """Root mean square, about an axis, of what frames differ by from that mount, and what is
    expected of it, degrees."""
    of_gimbal: bool = False  # from the tags of the images


class NotHeld(NamedTuple):
    """A parameter that was to be solved for, and that the picks do not hold: it is kept."""

    name: str  # of `vopd.flight.solve.equations`
    sigma: float  # standard deviation that it would have after the solve
    trades_with: tuple[str, ...]  # what would make the same images
    spoiled_by: str = ""  # what is stated and not solved for, if it were held without its error


@dataclass(frozen=True, eq=False)
class HeldParameters:
    """What `vopd adjust` solved for before: it is held, and its errors have one covariance."""

    file: str  # the covariance file, as the project names it
    parameter: tuple[str, ...]  # names of `vopd.flight.solve.equations.COMPONENT`
    landmark: Ints  # indices of landmarks, (N,)
    # times its transpose it is the covariance of the parameters, then of east, north, up of each of
    # those landmarks, in their units, m and s, (K, C)
    root: Floats
    by_picks: int  # how many of its columns, the first ones, are errors of the picks
    sigma_px: float  # standard deviation of a pick with which all was solved
    reading_sigma_px: float  # the reading sigma in force then
    freedom: float  # its degrees of freedom; infinite where it was stated
    source: str  # one of `vopd.attitude.reading_sigma.SOURCES`
    unknowns: int  # how many of the parameters had no standard deviation before


@dataclass(frozen=True)
class FlightOptions:
    """How a flight is solved, and what is uncertain besides picks, landmarks and positions."""

    loss: str = "least-squares"  # `least-squares`, `huber` or `cauchy`
    drop_blunders: bool = False  # false names them and keeps them
    solve_position: bool = True  # false holds the positions, whatever their standard deviations
    # standard deviations of what is common to the flight: `focal`, `centre_u`, `centre_v`, px;
    # `k1`, `k2`, `p1`, `p2`; `clock`, `readout`, s; `clock_rate`, s/s; `refraction`, of the
    # coefficient k; 0: it is exact
    parameter_sigma: Mapping[str, float] = field(default_factory=dict)
    # components of the uncertainty that the project calls exact, as
    # `vopd.attitude.sigmas.COMPONENTS` names them; `bias` is what a track's fixes have in common
    exact: tuple[str, ...] = ()
    # standard deviations that the user gives in the place of stated ones, or besides them; 0, and
    # None of the readings, gives none
    given: Sigmas = field(default_factory=Sigmas)
    # parameters that are solved for, by the names of `vopd.flight.solve.free.FREE`
    free: tuple[str, ...] = ()
    kept: tuple[NotHeld, ...] = ()  # those of them that the picks do not hold
    # what was solved for by `vopd adjust` before; None: nothing was
    held: HeldParameters | None = None
    # whether its residuals are held against a usual pick's; not those of a deck, of which no
    # command says that it misfits
    may_misfit: bool = True


@dataclass(frozen=True, eq=False)
class Flight:
    """One camera over one flight, ready to be solved."""

    name: str
    source: str  # the project file
    lens: Lens
    frame: Ints  # (F,) frame numbers, from 0 where images have names only
    image_name: tuple[str, ...]  # (F,) file names of the images; empty where frames have numbers
    time_s: Floats  # (F,) since `epoch`, or on the picks' own clock; NaN where there is none
    epoch: datetime | None
    picks: Picks
    landmarks: LandmarkSet
    path: CameraPath
    mount: Floats  # (3, 3) from camera axes (x right, y down, z forward) to body axes
    refraction: Refraction = field(default_factory=Refraction)
    options: FlightOptions = field(default_factory=FlightOptions)
    shutter: Shutter | None = None  # None: all rows are of one time
    frame_rate_hz: float | None = None  # by which frames have times; None: their times are given
    offset_s: float = 0.0  # that the project adds to the track's times
    own_level: bool = False  # heights count from a level that is not known: height = "same"
    grid: MapGrid | None = None  # of the landmarks' CRS, if that is projected
    about: tuple[
        str, ...
    ] = ()  # what was read, a sentence each: "lens.yml: OpenCV, 5 coefficients"
    findings: tuple[Finding, ...] = ()
    mount_sigma_deg: float = 0.0  # about each of the vehicle's axes; 0: not stated
    vehicle: VehicleAttitudes | None = None  # known from elsewhere
    folder: Path | None = None  # of the project, where images are looked for
    video: tuple[Path, ...] = ()  # the files of the video that was picked in

    @property
    def pick_focal_px(self) -> Floats:
        """The focal length of each pick's lens, (P,): the mean of both axes."""
        return np.asarray(self.lens.of(self.picks.frame).by_rows("focal_px").mean(axis=-1))

    @property
    def pick_range_m(self) -> Floats:
        """How far from the camera the landmark of each pick is, (P,); NaN: no position."""
        picks, marks = self.picks, self.landmarks
        away_m = marks.position_m[picks.landmark] - self.path.position_m[picks.frame]
        return np.asarray(np.linalg.norm(away_m, axis=1))

    @property
    def since_middle_s(self) -> Floats:
        """Times of the frames since their mean, by which a clock's rate counts, (F,); or 0."""
        known = self.time_s[np.isfinite(self.time_s)]
        return np.nan_to_num(self.time_s - (known.mean() if len(known) else 0.0))

    @property
    def grid_convergence_deg(self) -> float:
        """True azimuth less grid azimuth at the first position; NaN without a projected CRS."""
        if self.grid is None:
            return float("nan")
        known = self.grid.convergence_deg[np.isfinite(self.grid.convergence_deg)]
        return float(known[0]) if len(known) else float("nan")


# Names of frames and picks in messages


def frame_label(flight: Flight, k: int) -> str:
    """Name a frame: by its image, or by its number."""
    return flight.image_name[k] if flight.image_name else f"frame {flight.frame[k]}"


def pick_label(flight: Flight, pick: int) -> str:
    """Name a pick: by its frame and its landmark."""
    name = flight.landmarks.name[flight.picks.landmark[pick]]
    return f"{frame_label(flight, int(flight.picks.frame[pick]))}: {name}"


# Picks in one row, and in one row a frame


class FrameSlots(NamedTuple):
    """Where each of P picks stands in arrays of F frames and L columns."""

    frame: Ints  # (P,)
    slot: Ints  # (P,) 0 for the first pick of a frame
    frames: int
    slots: int

    @classmethod
    def of(cls, frame: Ints, frames: int) -> FrameSlots:
        """Number the picks of each frame in their own order."""
        count = np.bincount(frame, minlength=frames)
        order = np.argsort(frame, kind="stable")
        first = np.repeat(np.cumsum(count) - count, count)
        slot = np.empty(len(frame), np.int64)
        slot[order] = np.arange(len(frame)) - first
        return cls(frame, slot, frames, int(count.max(initial=1)))

    def spread(self, values: NDArray[Any]) -> NDArray[Any]:
        """Spread values (P, ...) as (F, L, ...); 0 or false where a frame has fewer picks."""
        out = np.zeros((self.frames, self.slots, *values.shape[1:]), dtype=values.dtype)
        out[self.frame, self.slot] = values
        return out

    def coordinates(self, values: Floats) -> Floats:
        """Spread two values a pick (P, 2, ...) as (F, 2L, ...): all first ones, then the second."""
        pairs = np.moveaxis(self.spread(values), 2, 1)
        return pairs.reshape(self.frames, 2 * self.slots, *values.shape[2:])


LEAPS = "are position and time right?"  # the end of a finding about a path that bends too much
