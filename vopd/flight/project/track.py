"""The camera's position in each frame: a fixed place, or a track by time or by image."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from datetime import UTC, datetime
from math import comb
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.findings import count_text, first_of, size_text
from vopd.flight.coordinates import (
    GEOIDS,
    HeightDatum,
    crs_name,
    doubt_of_heights,
    earth_centred_positions,
    units_of_crs,
)
from vopd.flight.flight import LEAPS, CameraPath, TrackFixes, TrackSlopes
from vopd.flight.formats.columns import (
    FROM_ELLIPSOID,
    FROM_GROUND,
    FROM_SEA,
    coordinate_columns,
    plain_name,
)
from vopd.flight.formats.tables import COMMENTS
from vopd.flight.formats.track import TRACK_FORMATS, VELOCITY_SIGMAS, TrackRows, row_out_of_order
from vopd.flight.project.keys import Project, Section, toml_numbers
from vopd.flight.project.stated import (
    Notes,
    RowSigmas,
    doubts_of_own_sigmas,
    doubts_of_rounding,
    key_sigma,
    row_sigmas,
)
from vopd.flight.project.times import (
    FrameTimes,
    first_whole_second,
    refuse_seconds,
    refuse_since_1970,
)
from vopd.flight.project.unused import unused_by_image
from vopd.flight.project.velocity import (
    Roughness,
    doubts_of_velocities,
    gap_curvature,
    gap_twist,
    hidden_weave,
    off_chord,
    off_line,
    path_slopes,
    roughness,
    track_velocity,
    velocities_alone,
    with_gaps,
)
from vopd.geometry.earth import NED_FROM_ENU, local_axes
from vopd.inputs import GPS_ZERO_S, LAST_S, LATE_S, gps_ahead_s, gps_second, is_gps_second
from vopd.video import find_images, twins_text

# Clocks of tracks: UTC, GPS time, or seconds of the flight


def track_on_clock(section: Section, rows: TrackRows, times: FrameTimes) -> Floats:
    """Convert the track's times to the clock of the frames."""
    found = track_clock(section, rows)
    if rows.clock == "seconds":
        return found
    if times.epoch is None:
        message = "is needed: the track is in UTC, and the frames are in seconds"
        raise Section(section.project, "flight", {}).error("epoch", message)
    return found - times.epoch.timestamp()


def track_clock(section: Section, rows: TrackRows) -> Floats:
    """Convert the track's times to UTC since 1970; seconds stay as they are."""
    assert rows.time_s is not None
    own = rows.clock
    if own == "utc-column":
        own = section.text("clock", ("utc", "gps"))
    elif section.has("clock"):
        own = section.text("clock")
        if own != rows.clock and "seconds" in (own, rows.clock):
            raise section.error("clock", f"the file's times are {rows.clock}")
    if own != "gps":
        return rows.time_s
    ahead = gps_ahead_s(float(rows.time_s[0]))
    if not np.isfinite(ahead):
        raise section.error("clock", "GPS time before 2006 is not known: give UTC")
    return rows.time_s - ahead


# Standard deviations of a track's positions and velocities


def track_sigma(section: Section, rows: TrackRows, notes: Notes) -> Floats:
    """Choose the standard deviations of a track's positions, east, north, up, (T, 3); 0: exact."""
    return row_sigmas(section, "sigma_m", _row_sigmas(section, rows, rows.sigma_m), notes)


def track_bias(section: Section) -> Floats:
    """Read sigmas east, north, up of the error that all positions have in common, (3,)."""
    return np.array(section.sigma("sigma_bias_m") or (0.0,) * 3)


def velocity_sigma(section: Section, rows: TrackRows, notes: Notes) -> Floats | None:
    """Choose the standard deviations of a track's velocities (T, 3); None if not stated.

    They are needed of velocities that the track has itself.
    """
    if rows.velocity_m_s is None and not section.has("velocity_sigma_m_s"):
        return None
    own = _row_sigmas(section, rows, rows.velocity_sigma_m_s)
    own = own._replace(by=f"columns {', '.join(VELOCITY_SIGMAS)}", usual=None)
    return row_sigmas(section, "velocity_sigma_m_s", own, notes)


def _row_sigmas(section: Section, rows: TrackRows, own: Floats | None) -> RowSigmas:
    count = len(rows.coordinate)
    return RowSigmas(
        str(section.values.get("file")), own, count, rows.line, rows.sigma_by, rows.usual_sigma_m
    )


def lever_arm(section: Section) -> Floats | None:
    """Read the arm from the antenna to the camera in the body's axes, if it is given."""
    return np.array(section.numbers("lever_arm_m")) if section.has("lever_arm_m") else None


# Tracks by image


def times_of_track(
    section: Section, rows: TrackRows, times: FrameTimes
) -> tuple[FrameTimes, Floats | None]:
    """Find the frames' times, by the track where nothing else has them, and the track's (T,)."""
    if rows.time_s is None:
        return times, None
    time_s = track_clock(section, rows) + section.number("offset_s")
    timed = bool(np.isfinite(times.time_s).any())
    if rows.clock != "seconds":
        zero = times.epoch or first_whole_second(time_s, section, "file")
        time_s = time_s - zero.timestamp()
        if not timed:  # the date of their zero, where frames have times of their own, is not known
            times = times._replace(epoch=zero)
    row = rows_of_images(section, rows, times.image)
    if timed and rows.clock != "seconds" and times.epoch is not None:
        doubts = doubts_of_times(times, np.where(row >= 0, time_s[row], np.nan))
        times = times._replace(doubts=(*times.doubts, *doubts))
    if not timed:
        times = times._replace(time_s=np.where(row >= 0, time_s[row], np.nan))
        times = refuse_since_1970(section.project, times) if rows.clock == "seconds" else times
    return times, time_s


APART_S = 2.0  # between times of one image: tags have whole seconds, and clocks are set by hand


def doubts_of_times(times: FrameTimes, own_s: Floats) -> list[str]:
    """Warn of times of images that are not those that the track has for them.

    Args:
        times: of the frames, by something else than the track
        own_s: those of the track on the same clock, (F,); NaN where it has none
    """
    apart_s = times.time_s - own_s
    known = np.flatnonzero(np.isfinite(apart_s))
    if not len(known) or np.abs(apart_s[known]).max() <= APART_S:
        return []
    most = int(known[np.abs(apart_s[known]).argmax()])
    by = f"{size_text(abs(apart_s[most]))} s {'later' if apart_s[most] > 0.0 else 'earlier'}"
    return [
        f"[picks] times: {times.image[most]} is {by} than the track has it, and frames have these "
        "times: is the camera's clock wrong, or utc_offset_h, or [track] clock or offset_s?"
    ]


def rows_of_images(section: Section, rows: TrackRows, image: tuple[str, ...]) -> Ints:
    """Look up each image's row, -1 where there is none."""
    if not image:
        raise section.error("file", "has positions by image, and the picks have frame numbers")
    doubled = next((name for name, count in Counter(rows.image).items() if count > 1), None)
    if doubled is not None:
        raise section.error("file", f"{doubled} has two positions")
    return find_images(rows.image, map(rows.image_key, image))


def order_of_times(time_s: Floats | None, whole_seconds: bool) -> Ints:
    """List the positions that have a time, in the order of time.

    Args:
        time_s: of all positions, (T,); None: there is none
        whole_seconds: whether these are rounded, which tells no velocity

    Returns:
        Their indices; none where times do not tell two positions apart.
    """
    if time_s is None or whole_seconds:
        return np.zeros(0, np.int64)
    order = np.argsort(time_s, kind="stable")[: np.isfinite(time_s).sum()]
    return order if len(order) > 1 and (np.diff(time_s[order]) > 0.0).all() else order[:0]


def path_by_image(
    section: Section,
    rows: TrackRows,
    position: Floats,
    times: FrameTimes,
    time_s: Floats | None,
    notes: Notes,
) -> CameraPath:
    """Find the camera's path at the images that were picked.

    Args:
        section: `[track]`
        rows: the track
        position: its positions, Earth-centred, (T, 3)
        times: of the frames, with the names of their images
        time_s: of the track's positions from any zero, (T,), where it has times
        notes: added to
    """
    found = rows_of_images(section, rows, times.image)
    missing = (found < 0)[:, None]
    here = np.where(missing, np.nan, position[found])
    sigma_m, sigma_m_s = track_sigma(section, rows, notes), velocity_sigma(section, rows, notes)
    velocity, acceleration, weave = rows.velocity_m_s, None, None
    order = order_of_times(time_s, rows.whole_seconds)
    if time_s is not None and len(order):
        at_s, at_m = time_s[order], position[order]
        own, own_sigma = (None if one is None else one[order] for one in (velocity, sigma_m_s))
        rough = track_roughness(at_s, at_m, sigma_m[order])
        *by_time, weave = path_velocity(at_s, at_m, at_s, at_m, rough, own, own_sigma, notes)
        of_rows = np.full((3, *position.shape), np.nan)
        for every, one in zip(of_rows, by_time, strict=True):
            every[order] = np.nan if one is None else one
        velocity, acceleration = of_rows[:2]
        sigma_m_s = None if by_time[2] is None else of_rows[2]
    elif velocity is None and time_s is not None:
        why = "the images' times are whole seconds, or too few, or alike"
        notes.said.append(f"no velocity: {why}")
    gimbal = None
    if rows.gimbal_deg is not None:
        gimbal = np.where(missing, np.nan, rows.gimbal_deg[found])

    def of_images(values: Floats | None) -> Floats | None:
        return None if values is None else np.where(missing, np.nan, values[found])

    fixes = TrackFixes(np.maximum(found, 0), np.where(missing, 0.0, 1.0), sigma_m)
    return CameraPath(
        here,
        fixes if sigma_m.any() else None,
        track_bias(section),
        velocity_m_s=of_images(velocity),
        velocity_sigma_m_s=of_images(sigma_m_s),
        acceleration_m_s2=of_images(acceleration),
        lever_arm_m=lever_arm(section),
        gimbal_deg=gimbal,
        weave=weave,
    )


# Velocity by the positions of a track


def track_roughness(time_s: Floats, position: Floats, sigma_m: Floats) -> Roughness:
    """Estimate the noise of a track's positions and the curvature of its path.

    Args:
        time_s: of the track, ascending, (T,)
        position: Earth-centred, (T, 3)
        sigma_m: stated standard deviations, east, north, up, (T, 3)
    """
    return roughness(time_s, east_north_up(position), sigma_m)


def east_north_up(position: Floats) -> Floats:
    """Convert a track's positions to metres east, north, up of its first, by its middle's axes."""
    return np.asarray((position - position[0]) @ local_axes(position[len(position) // 2]).T)


def velocity_by_fit(
    at: Floats, here: Floats, time_s: Floats, position: Floats, rough: Roughness, notes: Notes
) -> tuple[Floats, Floats, Floats | None]:
    """Fit the velocity at some moments.

    Args:
        at: the moments, (F,)
        here: positions there, Earth-centred, (F, 3)
        time_s: of the track, (T,)
        position: of the track, Earth-centred, (T, 3)
        rough: its noise and curvature
        notes: added to

    Returns:
        Velocity, acceleration and standard deviations of the velocity, north, east, down, (F, 3);
        no standard deviations where the track has too few positions to show its curvature.
    """
    velocity, acceleration, by_noise, by_curvature, fixes = track_velocity(
        at, time_s, position, rough
    )
    for k in range(0, len(at), FRAMES_AT_ONCE):
        some = slice(k, k + FRAMES_AT_ONCE)
        to_ned = NED_FROM_ENU @ local_axes(here[some])
        velocity[some] = np.einsum("fij,fj->fi", to_ned, velocity[some])
        acceleration[some] = np.einsum("fij,fj->fi", to_ned, acceleration[some])
    variance = (by_noise + by_curvature) @ np.abs(NED_FROM_ENU).T
    low, high = int(fixes.min()), int(fixes.max())
    through = f"{low}" if low == high else f"{low} to {high}"
    noise = np.median(rough.noise_m, axis=0)
    said = f"velocity by polynomials through {through} of the track's positions"
    if np.isnan(variance).all():
        notes.said.append(f"{said}, which are too few to show how uncertain it is")
        return velocity, acceleration, None
    sizes = "{}, {} and {} m east, north and up".format(*map(size_text, noise))
    sizes = sizes if noise.max() >= LEAST_TOLD_M else "less than 1 mm"
    notes.said.append(f"{said}, whose noise is {sizes}")
    return velocity, acceleration, np.sqrt(variance)


def path_velocity(
    at: Floats, here: Floats, time_s: Floats, position: Floats, rough: Roughness,
    velocity_m_s: Floats | None, sigma_m_s: Floats | None, notes: Notes,
) -> tuple[Floats, Floats, Floats | None, tuple[float, float] | None]:  # fmt: skip
    """Find the velocity at some moments: between those that the track has itself, or by a fit.

    The first five arguments are those of `velocity_by_fit`.

    Args:
        velocity_m_s: of the track, north, east, down, (T, 3); None: it has none
        sigma_m_s: stated standard deviations, (T, 3); None: none are
        notes: added to

    Returns:
        What `velocity_by_fit` returns, and the weave that a fit misses; None where there is no
        fit, or its standard deviation is stated.
    """
    weave = None
    if velocity_m_s is None:
        velocity, acceleration, sigma = velocity_by_fit(at, here, time_s, position, rough, notes)
        weave = hidden_weave(time_s, rough) if sigma_m_s is None else None
    else:
        velocity, sigma = _columns_at(at, time_s, velocity_m_s), None
        acceleration = _columns_at(at, time_s, np.gradient(velocity_m_s, time_s, axis=0))
        notes.said.append("velocity as the track has it")
    if sigma_m_s is not None:
        sigma = _columns_at(at, time_s, sigma_m_s)
        if velocity_m_s is not None:  # those that are called exact stay so
            off_m_s = off_line(at, time_s, velocity_m_s, sigma_m_s)
            sigma = np.where(sigma > 0.0, np.hypot(sigma, off_m_s), 0.0)
    return velocity, acceleration, sigma, weave


# The camera's path: a fixed position, or a track by time or by image

FRAMES_AT_ONCE = 20_000
LEAST_BENT = 0.01  # of a position's sigma: a path that bends less between positions is straight
LEAST_TWISTED = 0.1  # likewise, of a path whose curvature changes within a gap
LEAST_TOLD_M = 1e-3  # of noise: less is not told in numbers; of an exact track: less is straight


ONE_LEVEL = "ground_m or undulation_m: leave one out"
NO_LEVEL = (
    "ground_m counts as the landmarks' heights do, whose height is not given beside their crs: "
    "give undulation_m, the ground's height above the ellipsoid"
)


class PathRead(NamedTuple):
    """A camera's path, and sentences about what was read and what is doubtful.

    `missing` are standard deviations that neither project nor track have.
    """

    path: CameraPath
    said: list[str]
    times: FrameTimes  # of the frames, those of a track by image included
    doubts: list[str]
    missing: dict[tuple[str, str], str]
    rows: TrackRows | None = None  # of a track, as they stand in its file


def height_datum(section: Section, landmarks: Section | None = None) -> HeightDatum | None:
    """Read what a section says of its heights; None if it says nothing.

    Args:
        section: of landmarks, or of the camera
        landmarks: theirs, as whose heights that of the ground counts, for the camera's
    """
    if not section.has("height"):
        return None
    if isinstance(section.values["height"], dict):
        inside = section.section("height")
        if not inside.has("ground_m"):
            return HeightDatum("undulation", inside.number("undulation_m"))
        datum = height_datum(landmarks) if landmarks is not None else None
        if datum is None or inside.has("undulation_m"):
            raise section.error("height", ONE_LEVEL if datum is not None else NO_LEVEL)
        return replace(datum, ground_m=inside.number("ground_m"))
    return HeightDatum(section.text("height"))


LEVELS = (
    (FROM_GROUND, "the ground", ("ground_m", "undulation_m", "same"), "{ ground_m = ... }"),
    (FROM_ELLIPSOID, "the ellipsoid", ("ellipsoid", "same"), '"ellipsoid"'),
    (FROM_SEA, "the sea", ("undulation_m", *GEOIDS, "same"), '{ undulation_m = ... } or "egm2008"'),
)
"""Words of a height's name, what they say, which `height` agrees with them, and what to write."""


def level_said(heights: str) -> str:
    """Say what heights count from by the name of their column; empty if it does not say it."""
    name = plain_name(heights)
    return next((said for words, said, *_ in LEVELS if words.search(name)), "")


def refuse_other_level(section: Section, heights: str) -> None:
    """Refuse a `height` that is not the level that the column of heights has in its name.

    Args:
        section: of the file
        heights: the column, as the file names it; empty if there is none
    """
    given = section.values.get("height")
    kinds = [*given] if isinstance(given, dict) else [given]
    for _, said, agree, write in LEVELS:
        if given is not None and level_said(heights) == said and not {*kinds} & {*agree}:
            if section.name == "landmarks" and "ground_m" in agree:
                write = "{ undulation_m = ... } with the ground's height above the ellipsoid"
            raise section.error(
                "height",
                f"column {heights} of {section.text('file')} counts from {said} by its name: "
                f"write {write}, or rename the column if its name is wrong",
            )


def read_path(project: Project, times: FrameTimes) -> PathRead:
    """Read the camera's position in each frame.

    Raises:
        VopdError: where the track has nothing for any frame, or cannot be read
    """
    landmarks = project.section("landmarks")
    if project.has("position"):
        return fixed_path(project.section("position"), times, landmarks)
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
    level = track_height(section, rows, landmarks)
    position = earth_centred_positions(rows.coordinate, rows.geodetic, crs, level, where)
    notes = Notes([f"{file.name}: {rows.said}{_above_ground(section)}"], {})
    doubts = [*rows.doubts, *doubt_of_heights("track", rows.names_units, crs)]
    doubts += _doubt_of_level(rows, level, file.name)
    doubts += doubts_of_own_sigmas(section, file.name, rows.sigma_by, rows.sigma_m)
    if rows.image and (times.image or rows.time_s is None):
        times, time_s = times_of_track(section, rows, times)
        path = path_by_image(section, rows, position, times, time_s, notes)
        doubts += unused_by_image(project, rows)
        doubts += doubts_of_leaps(rows, position, path.fixes, file.name)
    else:
        if rows.clock == "seconds":
            refuse_seconds(project, times, "the track has")
        path = path_by_time(section, rows, position, times, notes, file.name)
        doubts += doubts_of_rounded_times(section, times, path)
        doubts += doubts_of_holes(times.time_s, path.row_s, file.name)
        doubts += doubts_of_leaps(rows, position, path.fixes, file.name)
        doubts += doubts_of_scatter(rows, position, path.fixes, file.name)
    doubts += doubts_of_own_velocities(rows, position, path, file.name)
    if path.fixes is not None and not path.fixes.exact:
        doubts += doubts_of_rounding(
            "track", file.name, rows.coordinate, rows.geodetic, crs, path.fixes.of_positions_m
        )
    if not np.isfinite(path.position_m[:, 0]).any():
        raise section.error("file", why_nowhere(section, rows, times))
    return PathRead(path, notes.said, times, doubts, notes.missing, rows)


GEOID_APART_M = 2.0  # of one geoid by a receiver's own table and by another


def _doubt_of_level(rows: TrackRows, level: HeightDatum | None, name: str) -> list[str]:
    """Warn of a level of heights that is not the geoid of the track's own file.

    Args:
        rows: the track
        level: from which its heights count, as the project says
        name: of the file
    """
    own = {"ellipsoid": 0.0, "undulation": level.undulation_m if level else 0.0}
    if rows.geoid_m is None or level is None or level.name not in own or level.ground_m:
        return []
    if abs(own[level.name] - rows.geoid_m) <= GEOID_APART_M:
        return []
    return [
        f"[track] height: {name} has a geoidheight of {rows.geoid_m:g} m, beside which ele counts "
        f"from the sea: that is {{ undulation_m = {rows.geoid_m:g} }}, and it counts as "
        f"{level.said}; compare it with a height that you know"
    ]


def track_height(
    section: Section, rows: TrackRows, landmarks: Section | None = None
) -> HeightDatum | None:
    """Choose the datum of a track's heights, by its format or by the project."""
    given = height_datum(section, landmarks)
    refuse_other_level(section, rows.heights)
    if given is None and rows.from_ground and not section.has("crs"):
        raise section.error("height", f"is needed: {rows.asks_ground}")
    if rows.height is None:
        return given
    if given is not None and (given.name not in (rows.height, "same") or given.ground_m):
        raise section.error("height", f"the file has heights above the {rows.height}: leave it out")
    return HeightDatum(rows.height)


def _above_ground(section: Section) -> str:
    """Say from where a track's heights count, where that is the ground; else nothing."""
    height = section.values.get("height")
    if not isinstance(height, dict) or "ground_m" not in height:
        return ""
    return f"; heights from the ground at {height['ground_m']:g} m, counted as the landmarks'"


def not_in_metres(crs: str | None, where: str) -> str:
    """Say that a CRS does not count in metres, as a fixed position does; empty if it does.

    Args:
        crs: a grid, or of latitude and longitude, which may have heights of its own
        where: file or section, for errors
    """
    grid, heights = units_of_crs(crs, where)
    what, write = f"the grid {crs} counts", "write lat_deg, lon_deg and h_m, or a grid in metres"
    if not grid:
        what = f"{crs} counts heights"
        write = "take one without heights, and say with height what they count from"
    other = [one.name for one in (*grid, *heights) if not one.is_metre]
    return f"is metres, and {what} in {other[0]}: {write}" if other else ""


def fixed_path(section: Section, times: FrameTimes, landmarks: Section | None = None) -> PathRead:
    """Read the path of a camera that does not move from `[position]`."""
    geodetic = section.has("lat_deg") or section.has("lon_deg")
    keys = coordinate_columns(geodetic)
    for key in [one for one in coordinate_columns(not geodetic) if section.has(one)]:
        raise section.error(key, f"{keys[0]} is there too: give degrees or metres of a grid")
    coordinate = np.array([[section.number(key) for key in keys]])
    crs = section.text("crs") if section.has("crs") else None
    if crs is None and not geodetic:
        raise section.error("crs", "is needed with x_m and y_m")
    where = f"{section.project}: [position]"
    if wrong := not_in_metres(crs, where):
        raise section.error("h_m" if geodetic else "x_m", wrong)
    datum = height_datum(section, landmarks)
    position = earth_centred_positions(coordinate, geodetic, crs, datum, where)
    notes = Notes(["one fixed position"], {})
    path = CameraPath(
        np.tile(position, (len(times.time_s), 1)),
        bias_sigma_m=np.array(key_sigma(section, "sigma_m", "", notes)),
        lever_arm_m=lever_arm(section),
        of_position=True,
    )
    return PathRead(path, notes.said, times, [], notes.missing)


def path_by_time(
    section: Section,
    rows: TrackRows,
    position: Floats,
    times: FrameTimes,
    notes: Notes,
    name: str,
) -> CameraPath:
    """Interpolate a track at the times of the frames."""
    assert rows.time_s is not None
    time_s = track_on_clock(section, rows, times) + section.number("offset_s")
    if wrong := row_out_of_order(rows):
        raise section.error("file", f"{name}: {wrong}")
    if len(time_s) < 2:
        few = "one position is no track: give it as [position]"
        raise section.error("file", f"{name}: {few}")
    if not np.isfinite(times.time_s).any():
        why = "; ".join(times.doubts) or times.bring
        raise section.error("file", f"is by time, and the frames have none: {why}")
    way = section.text("interpolate")
    notes.said.append(f"positions between those of the track: {way}")
    sigma_m, sigma_m_s = track_sigma(section, rows, notes), velocity_sigma(section, rows, notes)
    velocity_m_s, near = rows.velocity_m_s, _near(times.time_s, time_s)
    time_s, position, sigma_m = time_s[near], position[near], sigma_m[near]
    sigma_m_s = None if sigma_m_s is None else sigma_m_s[near]
    inside: Bools = (times.time_s >= time_s[0]) & (times.time_s <= time_s[-1])
    at = np.where(inside, times.time_s, time_s[0])
    here = _interpolated(way, time_s, position, at)
    rough = track_roughness(time_s, position, sigma_m)
    velocity_m_s = None if velocity_m_s is None else velocity_m_s[near]
    velocity, acceleration, of_frames, weave = path_velocity(
        at, here, time_s, position, rough, velocity_m_s, sigma_m_s, notes
    )
    unknown = ~inside[:, None]
    key_sigma(section, "sigma_t_s", "", notes)
    fixes = path_errors(at, inside, time_s, position, sigma_m, rough, way)
    if velocity_m_s is None and fixes is not None and not fixes.exact:
        fixes = with_slopes(fixes, at, here, time_s, position, rough)
    return CameraPath(
        np.where(unknown, np.nan, here),
        fixes,
        track_bias(section),
        np.where(unknown, np.nan, velocity),
        None if of_frames is None else np.where(unknown, np.nan, of_frames),
        np.where(unknown, np.nan, acceleration),
        lever_arm_m=lever_arm(section),
        row_s=time_s,
        weave=weave,
    )


NEAR_ROWS = 30_000  # before and after the frames: those farther away are not looked at


def _near(at_s: Floats, time_s: Floats) -> slice:
    """Select the rows of a long track about the frames."""
    first, behind = np.searchsorted(time_s, [np.nanmin(at_s), np.nanmax(at_s)])
    return slice(max(int(first) - NEAR_ROWS, 0), int(behind) + NEAR_ROWS)


def with_slopes(
    fixes: TrackFixes, at: Floats, here: Floats, time_s: Floats, position: Floats, rough: Roughness
) -> TrackFixes:
    """Add the fixes' parts in the frames' velocities to the errors of a short track.

    Args:
        fixes: the errors of the track
        at: the frames' times, within the track, (F,)
        here: positions there, Earth-centred, (F, 3)
        time_s: of the track, (T,)
        position: of the track, Earth-centred, (T, 3)
        rough: its noise and curvature
    """
    if len(time_s) > MOST_SLOPED or np.isnan(rough.jerk).any():
        return fixes
    found = path_slopes(at, time_s, position, rough)
    # the shape of the path in each gap stands between two fixes
    each = 1 if fixes.between is None else int(np.flatnonzero(~fixes.between)[1])
    slots = each * found.by_velocity.shape[1]
    width = max(slots - each + 1, fixes.weight.shape[1])
    if len(at) * width**2 > MOST_PARTS:
        return fixes
    by_velocity, by_acceleration = np.zeros((2, len(at), width))
    by_velocity[:, :slots:each] = found.by_velocity
    by_acceleration[:, :slots:each] = found.by_acceleration
    to_ned = NED_FROM_ENU @ local_axes(here)
    slopes = TrackSlopes(
        each * found.first,
        by_velocity,
        by_acceleration,
        np.einsum("fij,fj->fi", to_ned, found.velocity_m_s),
        np.einsum("fij,fj->fi", to_ned, found.acceleration_m_s2),
        found.late_s,
    )
    return replace(fixes, slopes=slopes)


MOST_SLOPED = 300  # of a longer track the ends, where a fit is uncertain, are a small part
MOST_PARTS = 2_000_000  # frames times squares of fixes: some hundredths of a second each pass


def path_errors(
    at: Floats, inside: Bools, time_s: Floats, position: Floats, sigma_m: Floats,
    rough: Roughness, way: str,
) -> TrackFixes | None:  # fmt: skip
    """Find the errors of interpolated positions: those of the fixes, and of the path between them.

    Args:
        at: the frames' times, within the track, (F,)
        inside: frames that the track covers, (F,)
        time_s: of the track, (T,)
        position: of the track, Earth-centred, (T, 3)
        sigma_m: of its fixes, east, north, up, (T, 3); 0: exact
        rough: noise and curvature of the track
        way: of interpolation

    Returns:
        None where the positions are exact, and the path between them nearly straight.
    """
    before = np.clip(np.searchsorted(time_s, at, side="right") - 1, 0, len(time_s) - 2)
    step_s = np.diff(time_s)[before]
    part = (at - time_s[before]) / step_s
    exact = not sigma_m.any()
    if exact and not (inside & (part > 0.0) & (part < 1.0)).any():
        return None
    weight = np.where(inside[:, None], np.stack([1.0 - part, part], axis=1), 0.0)
    # between two rows the errors are mixed linearly, also where positions are not
    fixes = TrackFixes(before, weight, sigma_m)
    if exact:  # what is left over is the path's, but for the decimals of the file
        rough = track_roughness(time_s, position, np.full_like(sigma_m, LEAST_TOLD_M))
    local_m = east_north_up(position)
    off = np.abs(off_chord(part, step_s)) * inside[:, None]
    least_m = np.where(sigma_m > 0.0, sigma_m, LEAST_TOLD_M / LEAST_BENT)[before]
    bend = gap_curvature(time_s, local_m, rough, way)
    if not (off[:, :1] * bend[before] > LEAST_BENT * least_m).any():
        return None if exact else fixes
    twist = gap_twist(time_s, local_m, rough)
    if way == "linear" and (off[:, 1:] * twist[before] > LEAST_TWISTED * least_m).any():
        return with_gaps(fixes, time_s, bend, twist)
    return with_gaps(fixes, time_s, bend)


def doubts_of_rounded_times(section: Section, times: FrameTimes, path: CameraPath) -> list[str]:
    """Warn of times in whole seconds, if the project does not allow for it."""
    allowed = any(section.sigma("sigma_t_s") or ())
    if not times.whole_seconds or allowed or path.velocity_m_s is None:
        return []
    speed = np.nanmax(np.linalg.norm(path.velocity_m_s, axis=1), initial=0.0)
    return [
        f"the images' times are whole seconds, in which the camera moves {speed:.1f} m: "
        "give [track] sigma_t_s, .3 for times that are cut off so"
    ]


HOLE, LEAST_HOLE_S = 10.0, 5.0  # of the usual time between positions, and as much


def doubts_of_holes(frame_s: Floats, row_s: Floats | None, name: str) -> list[str]:
    """Warn of frames where a track has no positions: how it bends there nothing shows.

    Args:
        frame_s: times of frames, (F,)
        row_s: times of positions, (T,); None where they are not by time
        name: of its file
    """
    if row_s is None:
        return []
    step_s = np.diff(row_s)
    usual_s = float(np.median(step_s))
    between = frame_s[(frame_s > row_s[0]) & (frame_s < row_s[-1]) & ~np.isin(frame_s, row_s)]
    gap, count = np.unique(np.searchsorted(row_s, between) - 1, return_counts=True)
    wide = step_s[gap] > max(HOLE * usual_s, LEAST_HOLE_S)
    told = [
        f"{row_s[k]:.10g} to {row_s[k + 1]:.10g} s, with {count_text(n, 'frame')}"
        for k, n in zip(gap[wide].tolist(), count[wide].tolist(), strict=True)
    ]
    if not told:
        return []
    return [
        f"{name}: no position from {first_of(told, MANY)}; they are {usual_s:.3g} s apart as a "
        "rule: frames there are placed between the two by interpolation; leave out those where "
        "the camera may have gone another way"
    ]


MOST_BENT_M_S2, LEAST_LEAP_M = 100.0, 10.0  # beyond both a path is no vehicle's
MANY = 5  # of which more are counted
NOISY_LEAP = 12.0  # standard deviations of a fix: five of the leaps that their errors make


def doubts_of_leaps(
    rows: TrackRows, position: Floats, fixes: TrackFixes | None, name: str
) -> list[str]:
    """Warn of positions to and from which no vehicle moves.

    Such a path, taken for one that bends so between its positions, would be uncertain by as much.

    Args:
        rows: of a track
        position: its positions, Earth-centred, (T, 3)
        fixes: their errors; None where they are exact
        name: of its file
    """
    order = order_of_times(rows.time_s, rows.whole_seconds)
    if rows.time_s is None or not len(order):
        return []
    least_m = LEAST_LEAP_M
    if fixes is not None:
        least_m += NOISY_LEAP * float(np.linalg.norm(fixes.of_positions_m, axis=1).max())
    step_s = np.diff(rows.time_s[order])[:, None]
    turned = np.linalg.norm(np.diff(np.diff(position[order], axis=0) / step_s, axis=0), axis=1)
    before_s, after_s = step_s[:-1, 0], step_s[1:, 0]
    leap = turned * np.minimum(before_s, after_s) > least_m
    bent = np.where(leap, 2.0 * turned / (before_s + after_s), 0.0)
    most = bent.max(initial=0.0)
    if not most > MOST_BENT_M_S2:
        return []
    # a position that is off bends the path half as much at those before and behind it
    about = np.pad(bent, 1)
    far = (bent > MOST_BENT_M_S2) & (bent >= about[:-2]) & (bent >= about[2:])
    labels = [rows.label(row) for row in order[np.flatnonzero(far) + 1].tolist()]
    bend = f"{'up to ' * (len(labels) > 1)}{most:.3g} m/s^2"
    return [f"{name}: {first_of(labels, MANY)}: the path bends by {bend} there: {LEAPS}"]


ALONE_TEXT = "from what the positions before and behind it show: is it right?"


def doubts_of_own_velocities(
    rows: TrackRows, position: Floats, path: CameraPath, name: str
) -> list[str]:
    """Warn of velocities of a track that contradict its positions.

    Args:
        rows: of a track
        position: its positions, Earth-centred, (T, 3)
        path: the camera's, with the errors of positions and velocities
        name: of its file
    """
    order = order_of_times(rows.time_s, rows.whole_seconds)
    if rows.time_s is None or rows.velocity_m_s is None or not len(order):
        return []
    time_s = rows.time_s[order]
    variance = 0.0
    of_frames = path.velocity_sigma_m_s
    if of_frames is not None and (known := np.isfinite(of_frames[:, 0])).any():
        variance += float((np.median(of_frames[known], axis=0) ** 2).sum()) / 2.0  # of a mean
    if path.fixes is not None:  # of a difference
        usual_s = float(np.median(np.diff(time_s)))
        of_fix_m = np.median(path.fixes.of_positions_m, axis=0)
        variance += 2.0 * float((of_fix_m**2).sum()) / usual_s**2
    at_m, own_m_s = position[order], rows.velocity_m_s[order]
    alone, off_m_s = velocities_alone(time_s, at_m, own_m_s, variance**0.5)
    time_s, at_m, own_m_s = (np.delete(one, alone, axis=0) for one in (time_s, at_m, own_m_s))
    doubts = doubts_of_velocities(name, time_s, at_m, own_m_s, variance**0.5)
    if len(alone):
        labels = [rows.label(row) for row in order[alone].tolist()]
        by = f"{'up to ' * (len(labels) > 1)}{size_text(off_m_s.max())} m/s"
        doubts.append(f"{name}: {first_of(labels, MANY)}: the velocity is {by} {ALONE_TEXT}")
    return doubts


ORDERS = (3, 4, 5, 6)  # of differences: those of a smooth path become less from one to the next
FEWEST_ROWS = 120  # of which the scatter is known to a sixth
SCATTER, LEAST_SCATTER_M = 1.75, 0.5  # times what is stated, and as much, from where on it is told
NORMAL_MEDIAN = 0.6745  # median size of a normal error of standard deviation 1
EVEN = 0.1  # of the usual step between positions, to which most steps are that


def doubts_of_scatter(
    rows: TrackRows, position: Floats, fixes: TrackFixes | None, name: str
) -> list[str]:
    """Warn of positions that scatter about a smooth path by more than is stated.

    Args:
        rows: of a track by time
        position: its positions, Earth-centred, (T, 3)
        fixes: their errors; None where they are exact
        name: of its file
    """
    assert rows.time_s is not None
    if fixes is None or fixes.exact or (scatter_m := scatter_of(rows.time_s, position)) is None:
        return []
    sigma_m = np.median(fixes.of_positions_m, axis=0)
    if not ((scatter_m > SCATTER * sigma_m) & (scatter_m > LEAST_SCATTER_M)).any():
        return []
    found, said = ("{}, {} and {} m".format(*map(size_text, one)) for one in (scatter_m, sigma_m))
    stated = toml_numbers(*(float(f"{one:.2g}") for one in scatter_m))
    return [
        f"{name}: positions scatter by {found} east, north and up about a smooth path, and {said} "
        f"are stated for each by itself: the angles are less certain than is said; [track] sigma_m "
        f"= {stated} says so"
    ]


def scatter_of(time_s: Floats, position: Floats) -> Floats | None:
    """Estimate by how much positions scatter about a smooth path, east, north, up (3,), metres.

    Args:
        time_s: of the positions, (T,)
        position: Earth-centred, (T, 3), metres

    Returns:
        The standard deviations; None where positions are few, or at uneven times.
    """
    if len(position) < FEWEST_ROWS:
        return None
    step_s = np.diff(time_s)
    usual_s = np.median(step_s)
    if np.quantile(np.abs(step_s - usual_s), 0.9) > EVEN * usual_s:
        return None
    place_m, each = east_north_up(position), []
    for order in ORDERS:
        usual_m = np.median(np.abs(np.diff(place_m, order, axis=0)), axis=0)
        each.append(usual_m / (NORMAL_MEDIAN * np.sqrt(comb(2 * order, order))))
    return np.asarray(np.min(each, axis=0))


def _interpolated(way: str, time_s: Floats, position: Floats, at: Floats) -> Floats:
    """Interpolate positions (F, 3), Earth-centred, at times (F,)."""
    if way == "cubic":
        from scipy.interpolate import CubicSpline  # takes a tenth of a second to load

        return np.asarray(CubicSpline(time_s, position)(at))
    return _columns_at(at, time_s, position)


def _columns_at(at: Floats, time_s: Floats, values: Floats) -> Floats:
    return np.stack([np.interp(at, time_s, column) for column in values.T], axis=1)


def why_nowhere(section: Section, rows: TrackRows, times: FrameTimes) -> str:
    """Explain why a track has no position for any frame."""
    if rows.image and times.image:
        picked = times.image[0]
        near = [one for one in rows.image if one.lower() == picked.lower()]
        other = f"{near[0]}: letters must be of one case" if near else f"{rows.image[0]} for one"
        hint = f"; {COMMENTS}" * picked.startswith("#") or twins_text(times.image)
        return f"has none of the images that were picked ({picked} for one); it has {other}{hint}"
    own = track_on_clock(section, rows, times) + section.number("offset_s")
    first, last = float(np.nanmin(times.time_s)), float(np.nanmax(times.time_s))
    gap = max(first - own[-1], own[0] - last)  # of the frame next to the track
    apart = f"{gap:.3g} s apart{covering_text(own, times.time_s, section.number('offset_s'))}"
    assert rows.time_s is not None
    if times.epoch is not None and is_gps_second(float(rows.time_s[0]), times.epoch):
        apart = f"apart: the track's times are {GPS_SECONDS}: "
        if rows.clock != "seconds":
            apart += "call the column t_s, leave [track] clock out, and "
        apart += f"write [track] offset_s = {-gps_second(times.epoch):.14g}"
    elif rows.clock == "seconds" and LAST_S >= rows.time_s[0] >= LATE_S > last:
        apart = "apart: the track's t_s are seconds since 1970, call the column t_unix_s"
        if times.epoch is None:
            by_1970, by_gps = (
                f"{datetime.fromtimestamp(rows.time_s[0] + zero_s, UTC):%Y-%m-%d}"
                for zero_s in (0.0, GPS_ZERO_S)
            )
            apart += (
                f" (from {by_1970} on), or GPS seconds (from {by_gps} on): then [track] offset_s "
                "is that of t = 0, with a minus"
            )
    elif gap < 0.0:
        apart = "before and behind it"
    elif hours := round(gap / 3600.0):
        apart = f"{gap / 3600.0:.2f} h apart" + ", a time zone?" * (hours <= 14)
    return (
        f"does not cover any frame: the track is from {own[0]:.7g} to {own[-1]:.7g} s, the "
        f"frames from {first:.7g} to {last:.7g} s, {apart}; "
        "look at the clocks, [flight] epoch and [track] offset_s"
    )


GPS_SECONDS = "GPS seconds (since 1980-01-06)"
NEARLY_S = 0.1
"""Frames that are no farther beyond a track are told which offset of its clock covers them."""


def covering_text(own_s: Floats, time_s: Floats, offset_s: float) -> str:
    """Say by how little frames lie beyond a track, and the offset that covers them; or nothing.

    Args:
        own_s: the track's times on the frames' clock, (T,)
        time_s: those of the frames, (F,)
        offset_s: by which the track's times are moved already
    """
    early_s, late_s = own_s[0] - np.nanmin(time_s), np.nanmax(time_s) - own_s[-1]
    gap_s = float(max(early_s, late_s))
    by_s = (np.floor(gap_s * 1e4 + 1e-6) + 1.0) / 1e4
    if not 0.0 < gap_s <= NEARLY_S or min(early_s, late_s) + by_s > 0.0:
        return ""
    how, needed_s = "begins {} s later", offset_s - by_s
    if late_s > 0.0:
        how, needed_s = "ends {} s earlier", offset_s + by_s
    return (
        f": it {how.format(size_text(gap_s))}; if its clock may be off by that, "
        f"[track] offset_s = {needed_s:.10g} covers all frames"
    )
