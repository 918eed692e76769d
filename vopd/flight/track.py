"""Where the camera was in each frame: a fixed position, or a track by time or by image."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.flight.coordinates import HEIGHTS, HeightDatum, crs_name, earth_centred_positions
from vopd.flight.flight import CameraPath
from vopd.flight.frame_times import FrameTimes
from vopd.flight.path_by_image import path_by_image, times_of_track
from vopd.flight.path_keys import lever_arm, path_sigma
from vopd.flight.project import Project, Section
from vopd.flight.track_clock import track_on_clock
from vopd.flight.track_formats import TRACK_FORMATS
from vopd.flight.track_formats.track_rows import TrackRows
from vopd.geometry.earth import local_axes
from vopd.geometry.local_axes import NED_FROM_ENU

FRAMES_AT_ONCE = 20_000


class PathRead(NamedTuple):
    """A camera's path, and sentences about what was read and what is doubtful."""

    path: CameraPath
    said: list[str]
    times: FrameTimes  # of the frames, those of a track by image included
    doubts: list[str]


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
        return _fixed(project.section("position"), times)
    section = project.section("track")
    file = project.open("track")
    rows = project.read("track", file, TRACK_FORMATS)
    given = section.text("crs") if section.has("crs") else None
    if rows.crs is not None and given is not None and crs_name(given) != crs_name(rows.crs):
        raise section.error("crs", f"the file says {rows.crs}: leave the key out")
    crs = rows.crs or given
    if crs is None and not rows.geodetic:
        raise section.error("crs", "is needed: the file has x and y")
    where = f"{project.name}: [track]"
    position = earth_centred_positions(
        rows.coordinate, rows.geodetic, crs, _track_height(section, rows), where
    )
    said = [f"{file.name}: {rows.said}"]
    doubts = []
    if rows.image and (times.image or rows.time_s is None):
        times, time_s = times_of_track(section, rows, times)
        path = path_by_image(section, rows, position, times, time_s, said)
    else:
        path = _by_time(section, rows, position, times, said, file.name)
        doubts = _rounded_times(section, times, path)
    if not np.isfinite(path.position_m[:, 0]).any():
        raise section.error("file", _nowhere(section, rows, times))
    return PathRead(path, said, times, doubts)


def _track_height(section: Section, rows: TrackRows) -> HeightDatum | None:
    """What a track's heights are counted from, by its format or by the project."""
    given = height_datum(section)
    if rows.height is None:
        return given
    if given is not None and given.name not in (rows.height, "same"):
        raise section.error("height", f"the file has heights above the {rows.height}: leave it out")
    return HeightDatum(rows.height)


def _fixed(section: Section, times: FrameTimes) -> PathRead:
    geodetic = section.has("lat_deg")
    keys = ("lon_deg", "lat_deg", "h_m") if geodetic else ("x_m", "y_m", "z_m")
    coordinate = np.array([[section.number(key) for key in keys]])
    crs = section.text("crs") if section.has("crs") else None
    if crs is None and not geodetic:
        raise section.error("crs", "is needed with x_m and y_m")
    where = f"{section.project}: [position]"
    position = earth_centred_positions(coordinate, geodetic, crs, height_datum(section), where)
    path = CameraPath(
        np.tile(position, (len(times.time_s), 1)),
        path_sigma(section),
        lever_arm_m=lever_arm(section),
    )
    return PathRead(path, ["one fixed position"], times, [])


def _by_time(
    section: Section,
    rows: TrackRows,
    position: Floats,
    times: FrameTimes,
    said: list[str],
    name: str,
) -> CameraPath:
    assert rows.time_s is not None
    time_s = track_on_clock(section, rows, times) + section.number("offset_s", 0.0)
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
    interpolated = _interpolation(way, time_s, position)
    here, velocity, acceleration = (np.empty((len(at), 3)) for _ in range(3))
    for k in range(0, len(at), FRAMES_AT_ONCE):
        some = slice(k, k + FRAMES_AT_ONCE)
        here[some], speed, change = interpolated(at[some])
        to_ned = NED_FROM_ENU @ local_axes(here[some])
        velocity[some] = np.einsum("fij,fj->fi", to_ned, speed)
        acceleration[some] = np.einsum("fij,fj->fi", to_ned, change)
    if rows.velocity_m_s is not None:
        velocity = _columns_at(at, time_s, rows.velocity_m_s)
        said.append("velocity as the track has it")
    else:
        said.append("velocity by the differences of the track's positions")
    unknown = ~inside[:, None]
    return CameraPath(
        np.where(unknown, np.nan, here),
        path_sigma(section, rows),
        (section.sigma("sigma_t_s") or (0.0,))[0],
        np.where(unknown, np.nan, velocity),
        np.where(unknown, np.nan, acceleration),
        lever_arm_m=lever_arm(section),
    )


NO_TIMES = (
    "is by time, and the frames have none: give [picks] frame_rate_hz and first_frame_t_s, or "
    "times, a CSV or the folder of the images"
)


def _rounded_times(section: Section, times: FrameTimes, path: CameraPath) -> list[str]:
    """A doubt where a camera's clock has whole seconds, and the project does not allow for it."""
    if not times.whole_seconds or section.has("sigma_t_s") or path.velocity_m_s is None:
        return []
    speed = np.nanmax(np.linalg.norm(path.velocity_m_s, axis=1), initial=0.0)
    return [
        f"the images' times are whole seconds, in which the camera moves {speed:.1f} m: "
        "give [track] sigma_t_s, .3 for times that are cut off so"
    ]


def _interpolation(
    way: str, time_s: Floats, position: Floats
) -> Callable[[Floats], tuple[Floats, Floats, Floats]]:
    """What gives position, velocity and acceleration (F, 3), Earth-centred, at times (F,)."""
    if way == "cubic":
        from scipy.interpolate import CubicSpline  # takes a tenth of a second to load

        spline = CubicSpline(time_s, position)
        return lambda at: (spline(at), spline(at, 1), spline(at, 2))
    speed = np.gradient(position, time_s, axis=0)
    change = np.gradient(speed, time_s, axis=0)
    return lambda at: (
        _columns_at(at, time_s, position),
        _columns_at(at, time_s, speed),
        _columns_at(at, time_s, change),
    )


def _columns_at(at: Floats, time_s: Floats, values: Floats) -> Floats:
    return np.stack([np.interp(at, time_s, column) for column in values.T], axis=1)


def _nowhere(section: Section, rows: TrackRows, times: FrameTimes) -> str:
    if rows.image and times.image:
        picked = times.image[0]
        near = [one for one in rows.image if one.lower() == picked.lower()]
        other = f"{near[0]}: letters must be of one case" if near else f"{rows.image[0]} for one"
        return f"has none of the images that were picked ({picked} for one); it has {other}"
    own = track_on_clock(section, rows, times) + section.number("offset_s", 0.0)
    return (
        f"does not cover any frame: the track is from {own[0]:.7g} to {own[-1]:.7g} s, the "
        f"frames from {np.nanmin(times.time_s):.7g} to {np.nanmax(times.time_s):.7g} s; "
        "look at the clocks, [flight] epoch and [track] offset_s"
    )
