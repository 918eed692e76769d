"""Where the camera was in each frame: a fixed position, or a track by time or by image."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any, NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.flight.coordinates import (
    HEIGHTS,
    HeightDatum,
    earth_centred_positions,
)
from vopd.flight.flight import CameraPath
from vopd.flight.input_file import read_by_content
from vopd.flight.project_file import Project, Section
from vopd.flight.track_formats import TRACK_FORMATS
from vopd.flight.track_formats.track_rows import TrackRows
from vopd.geometry.geodetic import local_axes
from vopd.geometry.local_axes import NED_FROM_ENU

GPS_AHEAD_S = (  # of UTC, from a date on
    (datetime(2017, 1, 1, tzinfo=UTC), 18.0),
    (datetime(2015, 7, 1, tzinfo=UTC), 17.0),
    (datetime(2012, 7, 1, tzinfo=UTC), 16.0),
    (datetime(2009, 1, 1, tzinfo=UTC), 15.0),
    (datetime(2006, 1, 1, tzinfo=UTC), 14.0),
)


class FrameTimes(NamedTuple):
    """When and of what each frame is: seconds on a clock, and its image's name."""

    time_s: Floats  # (F,) NaN where not known
    image: tuple[str, ...]  # (F,) or none
    epoch: datetime | None  # the date of zero, where it is known


class PathRead(NamedTuple):
    """A camera's path, and sentences about what was read."""

    path: CameraPath
    said: list[str]


def height_datum(section: Section) -> HeightDatum | None:
    """What a section says of its heights; None where it says nothing."""
    if not section.has("height"):
        return None
    if isinstance(section.values["height"], dict):
        inside = section.section("height", ("undulation_m",))
        return HeightDatum("undulation", inside.number("undulation_m"))
    return HeightDatum(section.text("height", HEIGHTS))


def read_path(project: Project, times: FrameTimes) -> PathRead:
    """The camera's position in each frame.

    Raises:
        VopdError: where the track has nothing for any frame, or cannot be read
    """
    if project.has("position"):
        return _fixed(project.section("position"), len(times.time_s))
    section = project.section("track")
    file = project.open("track")
    rows = read_by_content(TRACK_FORMATS, file)
    crs = rows.crs or (section.text("crs") if section.has("crs") else None)
    if crs is None and not rows.geodetic:
        raise section.error("crs", "is needed: the file has x and y")
    where = f"{project.name}: [track]"
    position = earth_centred_positions(
        rows.coordinate, rows.geodetic, crs, height_datum(section), where
    )
    said = [f"{file.name}: {rows.said}"]
    if rows.time_s is None:
        path = _by_image(section, rows, position, times)
    else:
        path = _by_time(section, rows, position, times, said, file.name)
    if not np.isfinite(path.position_m[:, 0]).any():
        raise section.error("file", _nowhere(rows, times))
    return PathRead(path, said)


def _fixed(section: Section, frames: int) -> PathRead:
    geodetic = section.has("lat_deg")
    keys = ("lon_deg", "lat_deg", "h_m") if geodetic else ("x_m", "y_m", "z_m")
    coordinate = np.array([[section.number(key) for key in keys]])
    crs = section.text("crs") if section.has("crs") else None
    if crs is None and not geodetic:
        raise section.error("crs", "is needed with x_m and y_m")
    where = f"{section.project}: [position]"
    position = earth_centred_positions(coordinate, geodetic, crs, height_datum(section), where)
    path = CameraPath(np.tile(position, (frames, 1)), _sigma(section), lever_arm_m=_arm(section))
    return PathRead(path, ["one fixed position"])


def _by_image(section: Section, rows: TrackRows, position: Floats, times: FrameTimes) -> CameraPath:
    if not times.image:
        raise section.error("file", "has positions by image, and the picks have frame numbers")
    index = {name: k for k, name in enumerate(rows.image)}
    if len(index) < len(rows.image):
        doubled = next(name for name in rows.image if rows.image.count(name) > 1)
        raise section.error("file", f"{doubled} has two positions")
    found = np.array([index.get(name, -1) for name in times.image])
    here = np.where((found >= 0)[:, None], position[found], np.nan)
    velocity = None if rows.velocity_m_s is None else rows.velocity_m_s[found]
    gimbal = None
    if rows.gimbal_deg is not None:
        gimbal = np.where((found >= 0)[:, None], rows.gimbal_deg[found], np.nan)
    return CameraPath(
        here,
        _sigma(section),
        velocity_m_s=velocity,
        lever_arm_m=_arm(section),
        gimbal_deg=gimbal,
    )


def _by_time(
    section: Section,
    rows: TrackRows,
    position: Floats,
    times: FrameTimes,
    said: list[str],
    name: str,
) -> CameraPath:
    assert rows.time_s is not None
    time_s = _on_clock(section, rows, times) + section.number("offset_s", 0.0)
    backward = np.flatnonzero(~(np.diff(time_s) > 0.0))
    if len(backward):
        row = int(backward[0]) + 1
        line = f"line {rows.line[row]}" if rows.line else f"position {row + 1}"
        raise section.error("file", f"{name}: {line}: its time is not after the one before")
    if len(time_s) < 2:
        raise section.error("file", f"{name}: one position is no track: give it as [position]")
    if not np.isfinite(times.time_s).any():
        raise section.error("file", NO_TIMES)
    way = section.text("interpolate", ("linear", "cubic"), "linear")
    said.append(f"positions between those of the track: {way}")
    inside: Bools = (times.time_s >= time_s[0]) & (times.time_s <= time_s[-1])
    at = np.where(inside, times.time_s, time_s[0])
    here, speed, change = _interpolated(way, time_s, position, at)
    to_ned = NED_FROM_ENU @ local_axes(here)
    velocity = np.einsum("fij,fj->fi", to_ned, speed)
    acceleration = np.einsum("fij,fj->fi", to_ned, change)
    if rows.velocity_m_s is not None:
        velocity = _columns_at(at, time_s, rows.velocity_m_s)
        said.append("velocity as the track has it")
    else:
        said.append("velocity by the differences of the track's positions")
    unknown = ~inside[:, None]
    return CameraPath(
        np.where(unknown, np.nan, here),
        _sigma(section),
        section.number("sigma_t_s", 0.0),
        np.where(unknown, np.nan, velocity),
        np.where(unknown, np.nan, acceleration),
        lever_arm_m=_arm(section),
    )


NO_TIMES = (
    "is by time, and the frames have none: give [picks] frame_rate_hz and first_frame_t_s, or times"
)


def _on_clock(section: Section, rows: TrackRows, times: FrameTimes) -> Floats:
    """The track's times on the clock of the frames."""
    assert rows.time_s is not None
    own = rows.clock
    if own == "utc-column":
        own = section.text("clock", ("utc", "gps"))
    elif section.has("clock"):
        own = section.text("clock", ("utc", "gps", "seconds"))
        if (own == "seconds") != (rows.clock == "seconds"):
            raise section.error("clock", f"the file's times are {rows.clock}")
    if own == "seconds":
        return rows.time_s
    if times.epoch is None:
        message = "is needed: the track is in UTC, and the frames are in seconds"
        raise Section(section.project, "flight", {}).error("epoch", message)
    ahead = 0.0
    if own == "gps":
        first = datetime.fromtimestamp(float(rows.time_s[0]), UTC)
        ahead = next((seconds for since, seconds in GPS_AHEAD_S if first >= since), float("nan"))
        if not np.isfinite(ahead):
            raise section.error("clock", "GPS time before 2006 is not known: give UTC")
    return rows.time_s - ahead - times.epoch.timestamp()


def _interpolated(
    way: str, time_s: Floats, position: Floats, at: Floats
) -> tuple[Floats, Floats, Floats]:
    """Position, velocity and acceleration (F, 3), Earth-centred."""
    if way == "cubic":
        from scipy.interpolate import CubicSpline  # takes a tenth of a second to load

        spline = CubicSpline(time_s, position)
        return spline(at), spline(at, 1), spline(at, 2)
    speed = np.gradient(position, time_s, axis=0)
    change = np.gradient(speed, time_s, axis=0)
    here, there, gone = (_columns_at(at, time_s, values) for values in (position, speed, change))
    return here, there, gone


def _columns_at(at: Floats, time_s: Floats, values: Floats) -> Floats:
    return np.stack([np.interp(at, time_s, column) for column in values.T], axis=1)


def _sigma(section: Section) -> Floats:
    """East, north, up; NaN where not given."""
    if not section.has("sigma_m"):
        return np.full(3, np.nan)
    value: Any = section.values["sigma_m"]
    if isinstance(value, int | float):
        return np.full(3, section.number("sigma_m"))
    return np.array(section.numbers("sigma_m", 3))


def _arm(section: Section) -> Floats | None:
    return np.array(section.numbers("lever_arm_m", 3)) if section.has("lever_arm_m") else None


def _nowhere(rows: TrackRows, times: FrameTimes) -> str:
    if rows.time_s is None:
        return f"has none of the images that were picked ({times.image[0]} for one)"
    return (
        "does not cover any frame: the frames' times are "
        f"{np.nanmin(times.time_s):.3f} to {np.nanmax(times.time_s):.3f} s; "
        "look at the clocks, [flight] epoch and [track] offset_s"
    )
