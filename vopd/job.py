"""The input of one job of program VOPD, as dataclasses of arrays with units in their names.

Axes are east, north, up unless a name says otherwise. The frame axis comes
first, the landmark axis second with a mask, a pair x, y last.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from operator import attrgetter
from typing import Any, overload

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.findings import Finding, VopdError, count_text, refuse_masked
from vopd.landmark_layout import LandmarkLayout
from vopd.records import ByLandmark, FrameRecord, Record, Rows

GOES_ON = "the deck goes on after the job that stops the run"
"""Said where cards behind the last job are not read."""


def goes_on(findings: Iterable[Finding]) -> bool:
    """Tell whether findings say that cards behind the last job are not read."""
    return any(one.message.startswith(GOES_ON) for one in findings)


@dataclass(frozen=True, eq=False, repr=False)
class Camera(Record):
    """The camera (groups 1, 3 and 8): lens, mounting in the vehicle, and first estimate.

    Vehicle yaw, pitch, roll are `multiplier * camera angle + offset_deg`, angle by angle.

    Attributes:
        focal_length_mm: CC
        lens_radius_mm: distances from the frame's centre, strictly increasing where they are
            used (25,)
        lens_distortion_um: outward there (25,)
        multiplier: of yaw, pitch, roll: S1M, S2M, S3M (3,)
        offset_deg: of the same: S1A, S2A, S3A (3,)
        initial_deg: first estimate of the camera's yaw, pitch, roll (3,)
    """

    focal_length_mm: float
    lens_radius_mm: Floats
    lens_distortion_um: Floats
    multiplier: Floats
    offset_deg: Floats
    initial_deg: Floats


@dataclass(frozen=True, eq=False, repr=False)
class Trajectory(Record):
    """The vehicle's path about an origin on the ground (groups 7 and 8).

    Position east, north, up of the origin; velocity north, east and *down*.

    Attributes:
        time_s: seconds of flight (n,)
        position_ft: east, north, up (n, 3)
        velocity_ft_s: north, east, down (n, 3)
        altitude_ft: above mean sea level, for the wind (n,)
        origin_latitude_deg: geodetic
        origin_longitude_deg: positive east
        origin_radius_kft: from the Earth's centre, thousands of feet
    """

    time_s: Floats
    position_ft: Floats
    velocity_ft_s: Floats
    altitude_ft: Floats
    origin_latitude_deg: float
    origin_longitude_deg: float
    origin_radius_kft: float


@dataclass(frozen=True, eq=False, repr=False)
class Wind(Record):
    """The wind by altitude (group 4).

    Attributes:
        altitude_ft: above mean sea level (n,)
        velocity_ft_s: toward north, toward east (n, 2)
    """

    altitude_ft: Floats
    velocity_ft_s: Floats


@dataclass(frozen=True, eq=False, repr=False)
class Clock(Record):
    """Flight time by frame number (group 6), linear between them.

    Attributes:
        frame: frame numbers (n,)
        time_s: seconds of flight (n,)
    """

    frame: Ints
    time_s: Floats


@dataclass(frozen=True, eq=False, repr=False)
class Landmarks(Rows):
    """Points on the ground (group 9), in degrees and minutes as on the cards.

    A number given twice counts as it was given last.

    Attributes:
        number: of each landmark (n,)
        longitude_deg: whole degrees, positive east (n,)
        longitude_min: minutes added to them, with the same sign (n,)
        latitude_deg: whole degrees, geodetic (n,)
        latitude_min: minutes added to them, with the same sign (n,)
        altitude_ft: above mean sea level (n,)
    """

    number: Ints
    longitude_deg: Floats
    longitude_min: Floats
    latitude_deg: Floats
    latitude_min: Floats
    altitude_ft: Floats


@dataclass(frozen=True, eq=False, repr=False)
class Ignored(Record):
    """Frames and landmarks to leave out (groups 10 to 12).

    A card of group 11 whose first landmark is 100 drops the whole frame; 0 is no landmark.

    Attributes:
        frame: frame number of each card of group 11 (n,)
        landmark: landmarks to ignore in that frame (n, 6)
        everywhere: landmarks to ignore in all frames (m,)
    """

    frame: Ints
    landmark: Ints
    everywhere: Ints


@dataclass(frozen=True, eq=False, repr=False)
class LandmarkReadings(Rows):
    """The readings of the landmarks of all frames, N of them, frame after frame."""

    landmark: Ints  # (N,) landmark number
    landmark_in: Floats  # (N, 3, 2) reading, x y


@dataclass(frozen=True, eq=False, repr=False)
class Readings(FrameRecord[LandmarkReadings]):
    """The basic data: three readings of every point of a frame, in inches on the film reader.

    F frames, L columns for landmarks: as many as the frame with the most has. A frame with
    fewer fills its columns from the left. The arrays with an axis L are made when they are
    asked for; `points` has them without the columns that hold no landmark, (N, ...), and
    `layout` says which of its elements belong to a frame.
    """

    frame: Ints  # (F,) frame number
    fiducial_in: Floats  # (F, 4, 3, 2) fiducial, reading, x y
    first_card: Mapping[int, Finding] = field(default_factory=dict, compare=False)
    """For each landmark number that group 9 did not define, a finding with its first card."""

    landmark = ByLandmark[Ints]()  # (F, L)
    landmark_in = ByLandmark[Floats]()  # (F, L, 3, 2)

    @property
    def present(self) -> Bools:
        """Which of the L columns hold a landmark (F, L)."""
        return self.layout.present

    @staticmethod
    def of(
        frame: Ints, fiducial_in: Floats, landmark: Ints, present: Bools, landmark_in: Floats
    ) -> Readings:
        """Make readings of arrays by frame and landmark.

        Args:
            frame: frame numbers (F,)
            fiducial_in: fiducial, reading, x y (F, 4, 3, 2)
            landmark: landmark numbers (F, L)
            present: which of the L columns hold a landmark (F, L); columns between may be free
            landmark_in: landmark, reading, x y (F, L, 3, 2)
        """
        points = LandmarkReadings(landmark[present], landmark_in[present])
        return Readings(LandmarkLayout(present.sum(axis=1)), points, frame, fiducial_in)


MOST_COPIED = 0.5  # of the points: if more are copies, the readings were not made three times


def copied_readings_text(readings: Readings) -> str:
    """Warn of readings that are copies of each other; empty if they are not.

    Three readings of a point that agree in all digits happen by chance, but not in most
    points of a film. Where they are copies, their spread does not show how well the
    points were read.
    """
    points = np.concatenate([
        readings.fiducial_in.reshape(-1, 3, 2),
        readings.points.landmark_in,
    ])  # fmt: skip
    copied = int((points == points[:, :1]).all(axis=(1, 2)).sum())
    if copied <= MOST_COPIED * len(points):
        return ""
    return (
        f"all three readings are the same in {copied} of {len(points)} points: their spread says "
        "nothing about how well the points were read"
    )


@dataclass(frozen=True, eq=False, repr=False)
class Job(Record):
    """One job of a deck: everything that is needed to solve its frames.

    Attributes:
        title: 80 columns; the first is the printer's carriage control
        camera: lens, mounting and first estimate: groups 1, 3 and 8
        trajectory: groups 7 and 8
        wind: group 4
        clock: group 6
        landmarks: group 9
        ignored: groups 10 to 12
        readings: the basic data
        return_group: NGO, 1 to 13: where reading goes on after this job
    """

    title: str
    camera: Camera
    trajectory: Trajectory
    wind: Wind
    clock: Clock
    landmarks: Landmarks
    ignored: Ignored
    readings: Readings
    return_group: int


SHAPES: Mapping[str, tuple[int | str, ...]] = {
    "camera.focal_length_mm": (), "camera.lens_radius_mm": (25,),
    "camera.lens_distortion_um": (25,), "camera.multiplier": (3,), "camera.offset_deg": (3,),
    "camera.initial_deg": (3,),
    "trajectory.time_s": ("rows",), "trajectory.position_ft": ("rows", 3),
    "trajectory.velocity_ft_s": ("rows", 3), "trajectory.altitude_ft": ("rows",),
    "trajectory.origin_latitude_deg": (), "trajectory.origin_longitude_deg": (),
    "trajectory.origin_radius_kft": (),
    "wind.altitude_ft": ("rows",), "wind.velocity_ft_s": ("rows", 2),
    "clock.frame": ("rows",), "clock.time_s": ("rows",),
    "landmarks.number": ("rows",), "landmarks.longitude_deg": ("rows",),
    "landmarks.longitude_min": ("rows",), "landmarks.latitude_deg": ("rows",),
    "landmarks.latitude_min": ("rows",), "landmarks.altitude_ft": ("rows",),
    "ignored.frame": ("rows",), "ignored.landmark": ("rows", 6), "ignored.everywhere": ("others",),
    "readings.frame": ("rows",), "readings.fiducial_in": ("rows", 4, 3, 2),
    "readings.points.landmark": ("points",), "readings.points.landmark_in": ("points", 3, 2),
}  # fmt: skip
"""The fields of a job's parts: the lengths of their axes, one of a part's rows by its word."""
WHOLE = {
    "clock.frame", "landmarks.number", "ignored.frame", "ignored.landmark", "ignored.everywhere",
    "readings.frame", "readings.points.landmark",
}  # fmt: skip
"""Those of whole numbers."""
EXACT = 2.0**53  # below it each whole number is a float
TITLE = 80  # columns of the title
PARTS: Mapping[str, type] = {
    "camera": Camera, "trajectory": Trajectory, "wind": Wind, "clock": Clock,
    "landmarks": Landmarks, "ignored": Ignored, "readings": Readings,
    "readings.layout": LandmarkLayout, "readings.points": LandmarkReadings,
}  # fmt: skip


def checked_fields(job: Job) -> Job:
    """Refuse a job one of whose fields is of another kind or shape, as `replace` can make it.

    Returns:
        The job, all of its numbers in eight bytes, as the program computes with them, and its
        title with the blanks of a card.

    Raises:
        VopdError: naming the field
    """
    if not isinstance(job.title, str):
        raise VopdError(f"job.title is {type(job.title).__name__}, not a text")
    if len(job.title) > TITLE or not (job.title.isascii() and job.title.isprintable()):
        raise VopdError(f"job.title is not one card of {TITLE} printable ASCII characters at most")
    group = job.return_group
    if isinstance(group, bool) or not isinstance(group, int | np.integer) or not 1 <= group <= 13:
        raise VopdError(f"job.return_group is {group!r}, not a whole number from 1 to 13")
    job = replace(job, title=job.title.ljust(TITLE))
    for part, kind in PARTS.items():
        found = attrgetter(part)(job)
        if not isinstance(found, kind):
            raise VopdError(f"job.{part} is {type(found).__name__}, not vopd's {kind.__name__}")
    layout = job.readings.layout
    rows: dict[tuple[str, int | str], int] = {
        ("readings", "rows"): len(layout.count),
        ("readings.points", "points"): layout.total,
    }
    for name, shape in SHAPES.items():
        part, _, own_name = name.rpartition(".")
        value = getattr(attrgetter(part)(job), own_name)
        plain, found = _plain(value, name), np.shape(value)
        if len(found) == len(shape):
            for length, one in zip(found, shape, strict=True):
                if isinstance(one, str):
                    rows.setdefault((part, one), length)
        wanted = tuple(rows.get((part, one), 0) if isinstance(one, str) else one for one in shape)
        if found != wanted:
            raise VopdError(f"job.{name} has the shape {found}, not {wanted}")
        if plain is not value:
            job = _changed(job, name, plain)
    return job


def _plain(value: object, name: str) -> Floats | Ints | float:
    """Write the numbers of a field in eight bytes; the field itself where they are.

    Raises:
        VopdError: where they are none
    """
    is_number = isinstance(value, np.ndarray | np.number | int | float)
    array = np.asarray(value if is_number else None)
    if array.dtype.kind not in "iuf":
        what = "an array of numbers" if SHAPES[name] else "a number"
        raise VopdError(f"job.{name} is {type(value).__name__}, not {what}")
    refuse_masked(value, f"job.{name}")
    if name not in WHOLE:
        if SHAPES[name] or array.ndim:
            return array.astype(np.float64, copy=False)
        return value if isinstance(value, float) else float(array)
    if array.dtype.kind == "f":
        whole = (np.abs(array) < EXACT) & (array == np.floor(array))
        if not whole.all():
            raise VopdError(f"job.{name} has numbers that are not whole")
    return array.astype(np.int64, copy=False)


def _changed(record: Any, name: str, value: object) -> Any:
    """Change a field of a part of a record, by its dotted name."""
    own, _, rest = name.partition(".")
    return replace(record, **{own: _changed(getattr(record, own), rest, value) if rest else value})


@dataclass(frozen=True, repr=False)
class Deck(Sequence[Job]):
    """The jobs of a deck in order, with its name and the warnings about its cards.

    Attributes:
        jobs: the jobs in order; the deck itself is a sequence of them
        name: name of the file
        findings: warnings about its cards
    """

    jobs: tuple[Job, ...]
    name: str = ""
    findings: tuple[Finding, ...] = ()

    def __repr__(self) -> str:
        named = f"{self.name}, " if self.name else ""
        return f"Deck({named}{count_text(len(self), 'job')})"

    def __len__(self) -> int:
        return len(self.jobs)

    @overload
    def __getitem__(self, index: int) -> Job: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Job]: ...
    def __getitem__(self, index: int | slice) -> Job | Sequence[Job]:
        try:
            return self.jobs[index]
        except (TypeError, IndexError) as error:
            has = f"{self.name or 'a deck'} of {count_text(len(self), 'job')} has no job {index!r}"
            raise type(error)(f"{has}: they are counted from 0") from None

    def chosen(self, number: int | None) -> Job:
        """Take one job.

        Args:
            number: from 1; None: the only one

        Raises:
            VopdError: where there is none, or several and no number
        """
        if not self.jobs:
            raise VopdError(
                f"{self.name}: the deck has no job; `vopd check {self.name}` explains its cards"
            )
        if number is None and len(self) > 1:
            raise VopdError(f"{self.name}: {len(self)} jobs; choose one with --job")
        if number is not None and number not in range(1, len(self) + 1):
            raise VopdError(f"{self.name}: there is no job {number}; the deck has {len(self)}")
        return self.jobs[(number or 1) - 1]
