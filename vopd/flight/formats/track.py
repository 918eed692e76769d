"""Files of tracks: CSV, .MRK, GPX, geo.txt, OpenSfM, ODM, images, a video or its subtitles."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC
from math import isfinite
from pathlib import Path

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.files import reason
from vopd.findings import count_text, shown
from vopd.flight.coordinates import crs_is_geographic
from vopd.flight.formats.by_content import InputFormat
from vopd.flight.formats.columns import GEODETIC, PLANE, TIME, coordinate_columns
from vopd.flight.formats.files import InputFile
from vopd.flight.formats.image_lenses import read_shots, recognises_reconstruction
from vopd.flight.formats.image_tags import (
    DILUTION_SAID,
    NO_FIX,
    USUAL_SIGMA_M,
    ImageTags,
    doubts_of_places,
    images_in,
    tags_of,
)
from vopd.flight.formats.landmarks import (
    CRS,
    LATITUDE_FIRST,
    SIGMA,
    SIGMAS,
    coordinates_of,
    geojson_crs,
    has_latitudes,
    is_real_number,
    parse_gpx,
    recognises_geojson,
    recognises_gpx,
    sigma_columns,
    with_fix,
)
from vopd.flight.formats.tables import CsvTable, has_columns, read_csv
from vopd.geometry.earth import earth_centred_m, geodetic, local_axes
from vopd.geometry.rotations import rotation_matrices
from vopd.inputs import GPS_ZERO_S, LEAP_SECOND, leap_second, plain_number, whole_number

# Positions of a receiver, of which nothing better is known: 3 m, and upward 5 m, each times
# the dilution of precision if the file has it


def sigma_of_dilution_m(horizontal: Floats, vertical: Floats) -> Floats:
    """Estimate sigmas east, north, up (T, 3) from dilutions; NaN where they are not above 0."""
    every = np.stack([horizontal, horizontal, vertical], axis=-1) * np.array(USUAL_SIGMA_M)
    return np.where((every > 0.0) & (every < np.inf), every, np.nan)


# Tracks as read


@dataclass(frozen=True, eq=False)
class TrackRows:
    """The positions of a file as they stand in it, T of them, by time, by image, or both."""

    coordinate: Floats  # (T, 3) longitude, latitude, height; or x, y, z
    geodetic: bool  # longitude and latitude in degrees
    crs: str | None  # where the file says it
    clock: str | None  # utc, gps or seconds; utc-column where a column says only UTC; None: no time
    time_s: Floats | None  # (T,) seconds since 1970 or on a clock of the file's own
    said: str
    image: list[str] = field(default_factory=list)
    velocity_m_s: Floats | None = None  # (T, 3) north, east, down
    line: Sequence[int] = field(default_factory=list)
    gimbal_deg: Floats | None = None  # (T, 3) yaw, pitch, roll of the view, for comparison
    sigma_m: Floats | None = None  # (T, 3) east, north, up; NaN where not given
    sigma_by: str = ""  # where `sigma_m` comes from, for a sentence
    usual_sigma_m: tuple[float, float, float] | None = None  # where nothing else says it
    velocity_sigma_m_s: Floats | None = None  # (T, 3) north, east, down; NaN where not given
    height: str | None = None  # what heights are counted from, where the format says it
    from_ground: str = ""  # the heights, for a sentence, where they count from the ground
    whole_seconds: bool = False  # times without parts of a second, though a camera took them
    image_key: Callable[[str], str] = str  # what stands in `image` for the name of an image
    names_units: bool = False  # of heights, by their column
    heights: str = ""  # that column, as the file names it
    by_video: bool = False  # seconds after the first frame of the video that it came with
    doubts: Sequence[str] = ()  # sentences for warnings
    tags: Mapping[str, ImageTags] = field(default_factory=dict)  # of images, by their names
    geoid_m: float | None = None  # height of the geoid above the ellipsoid, where the file says it

    def label(self, row: int) -> str:
        """Name a row: by its line, its image, or its place in the file."""
        if self.line:
            return f"line {self.line[row]}"
        return self.image[row] if self.image else f"position {row + 1}"

    @property
    def asks_ground(self) -> str:
        """The question for the height of the ground, where heights count from it."""
        return (
            f"{self.from_ground} counts from the ground: {{ ground_m = 1390.0 }} if that is at "
            "1390 m, counted as the landmarks' heights are"
        )


def row_out_of_order(rows: TrackRows) -> str:
    """Name the first row whose time is not after the one before, and what to do; empty if none."""
    assert rows.time_s is not None
    backward = np.flatnonzero(~(np.diff(rows.time_s) > 0.0))
    if not len(backward):
        return ""
    row = int(backward[0]) + 1
    advice = "sort the rows by time"
    if rows.time_s[row] == rows.time_s[row - 1]:
        same = np.array_equal(rows.coordinate[row], rows.coordinate[row - 1])
        advice = "it repeats that one, remove it" if same else "remove one of the two"
    return f"{rows.label(row)}: its time is not after the one before; {advice}"


# A track as a CSV: times, images or both, positions, and perhaps velocities and sigmas

VELOCITY = ("vn_m_s", "ve_m_s", "vd_m_s")
VELOCITY_SIGMAS = ("sigma_vn_m_s", "sigma_ve_m_s", "sigma_vd_m_s")
COLUMNS = (*TIME, "image", *GEODETIC, *PLANE, *VELOCITY, SIGMA, *SIGMAS, *VELOCITY_SIGMAS)


def recognises_csv_track(file: InputFile) -> bool:
    """Tell whether the header names a time or coordinates."""
    ways = [(name,) for name in (*TIME, "image")]
    return has_columns(file, COLUMNS, *ways, ("lat_deg", "lon_deg"), ("x_m", "y_m"))


def read_csv_track(file: InputFile) -> TrackRows:
    """Read the track of a CSV."""
    table = read_csv(file, COLUMNS)
    geodetic = has_latitudes(table)
    table.require(coordinate_columns(geodetic))
    if not len(table.line):
        raise file.error("no position is in the file")
    table, without = _with_positions(table, coordinate_columns(geodetic))
    coordinate = coordinates_of(table, geodetic)
    velocity = velocity_sigma = None
    doubts = list[str]()
    if any(table.has(name) for name in VELOCITY):
        velocity = np.stack([table.numbers(name) for name in VELOCITY], axis=1)
        velocity_sigma = table.sigmas_of_axes(VELOCITY_SIGMAS)
    elif given := [name for name in VELOCITY_SIGMAS if table.has(name)]:
        doubts.append(
            f"{file.name}: {', '.join(given)}: not used, as the file has no velocities, "
            f"{', '.join(VELOCITY)}"
        )
    timeless = table.has("image") and not any(map(table.has, TIME))
    time_s, utc = (None, False) if timeless else table.clock(TIME[::-1])
    sigma = table.sigmas_of_axes(SIGMAS, SIGMA)
    if geodetic:
        no_fix = (coordinate[:, :2] == 0.0).all(axis=1)
        if no_fix.any() and not no_fix.all():
            raise table.error(no_fix_text(no_fix, "line"), int(np.argmax(no_fix)))
        table.check_degrees(coordinate)
        table.check_signs(coordinate)
    image = table.column("image") if table.has("image") else []
    new = np.ones(len(coordinate), bool) if image else new_positions(coordinate)
    said = f"CSV{table.read_as}, {count_text(int(new.sum()), 'position')}{without}"
    if not new.all():
        said += (
            f"; {count_text(int((~new).sum()), 'row')} that repeat a position are left out: the "
            "log is faster than its receiver, and a position has the time of its first row"
        )
    return TrackRows(
        coordinate[new],
        geodetic,
        None,
        None if timeless else ("utc-column" if utc else "seconds"),
        time_s if time_s is None else time_s[new],
        said,
        image,
        velocity if velocity is None else velocity[new],
        np.array(table.line)[new].tolist(),
        sigma_m=sigma if sigma is None else sigma[new],
        sigma_by=sigma_columns(table),
        velocity_sigma_m_s=velocity_sigma if velocity_sigma is None else velocity_sigma[new],
        from_ground=table.from_ground,
        names_units=True,
        heights=table.heights,
        doubts=doubts,
    )


def _with_positions(table: CsvTable, names: Sequence[str]) -> tuple[CsvTable, str]:
    """Leave out the rows of a log whose cells of the position are all empty.

    A flight computer writes its other sensors more often than a position.

    Returns:
        The others, and what is to be said of those; all, and nothing, of positions of images.
    """
    if table.has("image") or not all(map(table.has, names)):
        return table, ""
    empty = np.all([[not text for text in table.column(name)] for name in names], axis=0)
    if empty.all() or not empty.any():
        return table, ""
    said = f"; {count_text(int(empty.sum()), 'row')} without a position are left out"
    return table.take(~empty), said


LEAST_RUNS = 5  # of rows with one position: fewer are of a camera that has stood now and then


def new_positions(coordinate: Floats) -> Bools:
    """Mark the rows of a log that have a position of their own, (T,).

    A log that is written more often than its receiver finds a position repeats the last one, and
    the path would be a staircase: at 200 m/s and one position a second a hundred metres behind in
    the mean. Most rows are so then; of a run that is longer than usual, as of a camera that
    stands, there is one in each usual run; some rows more, where two clocks beat, are none.

    Args:
        coordinate: (T, 3)
    """
    first = np.flatnonzero((np.diff(coordinate, axis=0, prepend=np.nan) != 0.0).any(axis=1))
    length = np.diff(np.append(first, len(coordinate)))
    usual = int(np.median(length)) if len(length) >= LEAST_RUNS else 1
    own = np.repeat(np.maximum((2 * length + usual) // (2 * usual), 1), length)  # of each run
    after = np.arange(len(coordinate)) - np.repeat(first, length)
    return np.asarray((after % usual == 0) & (after // usual < own))


def no_fix_text(no_fix: Bools, noun: str) -> str:
    """Say what positions at latitude and longitude 0 are, and what to do.

    Args:
        no_fix: which of the positions are, (T,)
        noun: what a position is in the file
    """
    count = int(no_fix.sum())
    what = f"the {noun}" if count == 1 else f"all {count_text(count, f'such {noun}')}"
    return f"{NO_FIX}; remove {what}"


# The .MRK file of drones with an RTK receiver (DJI, Autel): GPS time and position of each photo
#
# A line has the number of the photo, GPS seconds of week, [GPS week], what the antenna is
# off from the camera in mm north, east, down, latitude, longitude, height above the
# ellipsoid, three standard deviations in m north, east, up, and the state of the receiver.
# DJI's manuals call latitude and longitude compensated, and the tags of the photos repeat
# them: positions are taken as they stand.

WEEK_S = 604_800.0
LABELS = {4: "N", 6: "E", 8: "V", 10: "Lat", 12: "Lon", 14: "Ellh", 19: "Q"}
LAYOUT = "a line is number, seconds, [week], N, E, V, Lat, Lon, Ellh, three sigmas and Q"
FIRST = re.compile(r"\s*\d+\s+[\d.]+\s+\[\d+\]\s")
FIXED, NO_POSITION = 50, 0  # states of the receiver


def recognises_mrk(file: InputFile) -> bool:
    """Tell whether the first line begins with a number, seconds and a week in brackets."""
    return bool(FIRST.match(file.head))


def read_mrk(file: InputFile) -> TrackRows:
    """Read the photos of a .MRK file, by their numbers; those without a position are left out."""
    photos, values, lines = [], [], []
    for line, text in enumerate(file.text.splitlines(), 1):
        fields = re.split(r"[\s,]+", text.strip())
        if fields == [""]:
            continue
        if len(fields) != 20 or any(fields[k] != label for k, label in LABELS.items()):
            raise file.error(LAYOUT, line)
        try:
            week = whole_number(fields[2].strip("[]"))
            row = [plain_number(fields[k]) for k in (1, 3, 5, 7, 9, 11, 13, 15, 16, 17, 18)]
            photo = whole_number(fields[0])
        except ValueError as error:
            raise file.error(reason(error), line) from error
        real = np.isfinite(row).all() and abs(row[4]) <= 90.0 and min(row[7:10]) >= 0.0
        if not real or not 0 < week < 10_000 or not 0.0 <= row[0] <= WEEK_S:
            raise file.error(
                "a number is not finite, or no latitude, GPS week, second of it or standard "
                "deviation", line,
            )  # fmt: skip
        if row[-1] != NO_POSITION:
            photos.append(str(photo))
            values.append([GPS_ZERO_S + week * WEEK_S + row[0], *row[1:]])
            lines.append(line)
    if not photos:
        raise file.error("no photo has a position")
    table = np.array(values)
    offset = np.linalg.norm(table[:, 1:4], axis=1).max() / 1000.0
    loose = int((table[:, 10] != FIXED).sum())
    said = f"MRK, {len(photos)} photos by number, GPS time, heights above the ellipsoid"
    said += f", {loose} without an RTK fix" if loose else ""
    return TrackRows(
        table[:, [5, 4, 6]],
        True,
        "EPSG:4326",
        "gps",
        table[:, 0],
        f"{said}; its antenna offsets of up to {offset:.2f} m are not added",
        photos,
        line=lines,
        sigma_m=np.where(table[:, [8, 7, 9]] > 0.0, table[:, [8, 7, 9]], np.nan),
        sigma_by="the receiver",
        height="ellipsoid",
        image_key=photo_number,
    )


def photo_number(name: str) -> str:
    """Find the number of a photo in its name: 29 of MAX_0029.JPG, DJI_20230101120000_0029_V.JPG.

    It has four digits in the names that drones give; what is behind them, as in DJI_0029-2.JPG, is
    of the program that has made a copy.
    """
    stem = name.rpartition("/")[2].rpartition(".")[0]
    found = re.search(r"(?a)_\d{14}_(\d{4})(?!\d)", stem)
    if found is None:
        of_four = list(re.finditer(r"(?a)(?<!\d)(\d{4})(?!\d)", stem))
        found = of_four[-1] if of_four else re.search(r"(?a)(\d+)(?:_\D*)?$", stem)
    return str(int(found[1])) if found else name


# GPX tracks: latitude, longitude, elevation and UTC. The schema leaves the height's datum open


def read_gpx(file: InputFile) -> TrackRows:
    """Read all points of all tracks of a GPX file that have a fix, in their order."""
    parsed = parse_gpx(file)
    every = [p for track in parsed.tracks for segment in track.segments for p in segment.points]
    points, without = with_fix(every)
    if not points:
        none = f"{count_text(len(every), 'track point')}, none with a fix of three dimensions"
        raise file.error(none if every else "no track point is in the file")
    for k, point in enumerate(points, 1):
        if point.time is None or point.elevation is None:
            leap = LEAP_SECOND.search(file.text) if point.time is None else None
            message = f"track point {k} has no {'ele' if point.time else 'time'}"
            raise file.error(f"{message}: {leap_second(leap[0])}" if leap else message)
    coordinate = np.array([[p.longitude, p.latitude, p.elevation] for p in points])
    wrong = np.flatnonzero(~np.isfinite(coordinate).all(axis=1) | (abs(coordinate[:, 1]) > 90.0))
    if len(wrong):
        raise file.error(f"track point {wrong[0] + 1} has a number that is no position")
    no_fix = (coordinate[:, :2] == 0.0).all(axis=1)
    if no_fix.any() and not no_fix.all():
        first = f"track point {np.argmax(no_fix) + 1}"
        raise file.error(f"{first}: {no_fix_text(no_fix, 'point')}")
    times = (p.time if p.time.tzinfo else p.time.replace(tzinfo=UTC) for p in points)  # as GPX says
    time_s = np.array([one.timestamp() for one in times])
    dilution: Floats = np.array(
        [
            [
                p.horizontal_dilution or p.position_dilution or np.nan,
                p.vertical_dilution or p.position_dilution or p.horizontal_dilution or np.nan,
            ]
            for p in points
        ],
        dtype=np.float64,
    )
    sigma = sigma_of_dilution_m(dilution[:, 0], dilution[:, 1])
    geoid_m = [p.geoid_height for p in points if p.geoid_height and isfinite(p.geoid_height)]
    return TrackRows(
        coordinate,
        True,
        "EPSG:4326",
        "utc",
        time_s,
        geoid_m=float(np.median(geoid_m)) if geoid_m else None,
        said=f"GPX, {count_text(len(points), 'position')}{without}, UTC",
        sigma_m=sigma if np.isfinite(sigma).any() else None,
        sigma_by=DILUTION_SAID,
    )


# ODM's geo.txt: a coordinate reference system, then image, x, y, z and more, a line each


def recognises_odm_geo(file: InputFile) -> bool:
    """Tell whether the first line is a coordinate reference system and others begin with a name."""
    lines = file.head.lstrip().split("\n", 1)
    return len(lines) > 1 and bool(CRS.match(lines[0].strip()))


def read_odm_geo(file: InputFile) -> TrackRows:
    """Read the positions of a geo.txt and their accuracies; its angles are not used."""
    images, values, sigmas, numbers = [], [], [], []
    lines = enumerate(file.text.splitlines(), 1)
    crs = next(line.strip() for _, line in lines if line.strip())
    for number, line in lines:
        fields = line.split()
        if not fields or fields[0].startswith("#"):
            continue
        if len(fields) < 4:
            raise file.error("a line needs image, x, y and z", number)
        try:
            values.append([plain_number(field) for field in fields[1:4]])
        except ValueError as error:
            raise file.error(reason(error), number) from error
        if not np.isfinite(values[-1]).all():
            raise file.error("a position is not finite", number)
        horizontal, vertical = _accuracies(file, number, fields)
        sigmas.append([horizontal, horizontal, vertical])
        images.append(fields[0])
        numbers.append(number)
    if not images:
        raise file.error("no position is in the file")
    return TrackRows(
        np.array(values), False, crs, None, None,
        f"ODM geo.txt, {count_text(len(images), 'image')}, x east or longitude; "
        "its angles are not used",
        images, None, numbers,
        sigma_m=np.array(sigmas) if np.isfinite(sigmas).any() else None,
        sigma_by="its accuracies",
    )  # fmt: skip


def _accuracies(file: InputFile, number: int, fields: list[str]) -> tuple[float, float]:
    """Read the horizontal and vertical accuracy after the angles of a line; NaN if not there."""
    if len(fields) < 9:
        return np.nan, np.nan
    try:
        found = plain_number(fields[7]), plain_number(fields[8])
    except ValueError:  # more of the user's own words
        return np.nan, np.nan
    if min(found) < 0.0:
        raise file.error(f"an accuracy of {min(found):g} m is below 0", number)
    horizontal, vertical = (one if 0.0 < one < np.inf else np.nan for one in found)
    return horizontal, vertical


# Places of images by a bundle adjustment: OpenSfM's reconstruction.json and ODM's shots.geojson

BUNDLE = "; the places are of a bundle adjustment"


def read_reconstruction(file: InputFile) -> TrackRows:
    """Read the places of shots: -R't east, north, up of `reference_lla`."""
    images, places = list[str](), []
    for part in read_shots(file):
        reference = part.get("reference_lla")
        if reference is None:
            raise file.error("it has no reference_lla, from which its metres count: give geo.txt")
        place = [reference[key] for key in LATITUDE_FIRST]
        if not all(map(is_real_number, place)) or abs(place[0]) > 90.0 or abs(place[1]) > 360.0:
            raise file.error(f"reference_lla: {shown(reference)} is no place on the Earth")
        origin = earth_centred_m(*place)
        for name, shot in part["shots"].items():
            turn, shift = (np.array(shot[key], float) for key in ("rotation", "translation"))
            if turn.shape != (3,) or shift.shape != (3,) or not np.isfinite([turn, shift]).all():
                raise file.error(f"{name}: rotation and translation are three numbers each")
            away = -rotation_matrices(turn[None])[0].T @ shift
            places.append(origin + away @ local_axes(origin))
            images.append(str(name))
    if not images:
        raise file.error("no shot is in the file")
    where = geodetic(np.array(places))
    coordinate = np.stack([where.longitude_deg, where.latitude_deg, where.height_m], axis=1)
    said = f"OpenSfM reconstruction, {count_text(len(images), 'shot')}{BUNDLE}"
    return TrackRows(coordinate, True, "EPSG:4326", None, None, said, images)


def recognises_shots(file: InputFile) -> bool:
    """Tell whether it is GeoJSON whose features name files of images and their rotation."""
    return recognises_geojson(file) and '"filename"' in file.text and '"rotation"' in file.text


def read_shots_geojson(file: InputFile) -> TrackRows:
    """Read the places of a shots.geojson: longitude, latitude, height, or x, y, z of a `crs`."""
    root = file.json()
    features = root["features"]
    images = [str(one["properties"]["filename"]) for one in features]
    places = [one["geometry"]["coordinates"] for one in features]
    for image, place in zip(images, places, strict=True):
        if not isinstance(place, list) or len(place) != 3 or not all(map(is_real_number, place)):
            message = f"a shot needs longitude, latitude and height, not {shown(place)}"
            raise file.error(f"{image}: {message}")
    coordinate = np.array(places, float)
    if not images:
        raise file.error("no shot is in the file")
    crs = geojson_crs(file, root, features)
    geodetic = crs_is_geographic(crs, file.name)
    if geodetic and (abs(coordinate[:, 1]) > 90.0).any():
        raise file.error("a shot has no latitude: longitude comes first")
    said = f"ODM shots, {count_text(len(images), 'shot')}{BUNDLE}"
    return TrackRows(coordinate, geodetic, crs, None, None, said, images)


# A folder of images as a track: the positions in their tags, and times where they say a zone


NO_ZONE = ", times without their zone"
"""Said of images whose times are used only where the project has their zone."""


def recognises_image_folder(file: InputFile) -> bool:
    """Tell whether it is a folder with images."""
    return bool(images_in(file.path))


def no_position_text(every: Mapping[Path, ImageTags], unread: Sequence[str]) -> str:
    """Say that images have no position in their tags; why, of the first that is damaged."""
    count = len(every) + len(unread)
    of_all = "the image has no" if count == 1 else f"none of the {count} images has a"
    return f"{of_all} position in its tags{damage_text(every, unread)}"


def damage_text(every: Mapping[Path, ImageTags], unread: Sequence[str]) -> str:
    """Name the first image that is damaged and has no position; empty if there is none."""
    damaged = [f"{p.name}: {t.damage}" for p, t in every.items() if t.damage and not t.is_placed]
    return "".join(f" ({one})" for one in [*unread, *damaged][:1])


def read_image_folder(file: InputFile) -> TrackRows:
    """Read the positions of the images of a folder that have one.

    Raises:
        VopdError: where no image has a position, or Pillow is not installed
    """
    paths = images_in(file.path)
    every, unread = tags_of(paths)
    named = [(path, one) for path, one in every.items() if one.is_placed]
    if not named:
        raise file.error(
            f"{no_position_text(every, unread)}; give a track, or the position of a camera that "
            "does not move"
        )
    tags = [one for _, one in named]
    gimbal: Floats = np.array([one.gimbal_deg for one in tags])
    time_s: Floats = np.array([one.clock_s - one.zone_s for one in tags])
    without = len(paths) - len(tags)
    zoneless = any(np.isfinite(one.clock_s) and np.isnan(one.zone_s) for one in tags)
    dated = int(np.isfinite(time_s).sum()) * (not zoneless)
    said = f"EXIF and XMP tags of {count_text(len(paths), 'image')}"
    said += f", {without} without position{damage_text(every, unread)}" if without else ""
    said += ", times with their zone" if dated else NO_ZONE * zoneless
    said += f", {len(tags) - dated} without time" if 0 < dated < len(tags) else ""
    sigma: Floats = np.array([one.sigma_m for one in tags])
    angles = np.isfinite(gimbal).any()
    return TrackRows(
        np.array([one.position for one in tags]),
        True,
        "EPSG:4326",
        "utc" if dated else None,
        time_s if dated else None,
        said + ("; gimbal angles for comparison only" if angles else ""),
        [path.name for path, _ in named],
        gimbal_deg=gimbal if angles else None,
        sigma_m=sigma if np.isfinite(sigma).any() else None,
        sigma_by=", ".join(dict.fromkeys(one.sigma_by for one in tags if one.sigma_by)),
        usual_sigma_m=USUAL_SIGMA_M,
        whole_seconds=any(one.whole_second for one in tags if np.isfinite(one.clock_s)),
        doubts=doubts_of_places(every, file.name),
        tags={path.name: one for path, one in named},
    )


# A video, or its subtitles: vopd/flight/formats/video_track.py

SUBTITLE = re.compile(r"\s*\d+[^\S\n]*\n\s*\d+:\d\d:\d\d[,.]\d{1,3}\s*-->")


def _read_gpmf(file: InputFile) -> TrackRows:
    from vopd.flight.formats.video_track import read_gpmf

    return read_gpmf(file)


def _read_srt(file: InputFile) -> TrackRows:
    from vopd.flight.formats.video_track import read_srt

    return read_srt(file)


# Solutions of RTKLIB: vopd/flight/formats/rtklib.py

POS_HEAD = re.compile(r"^% *(GPST|UTC|JST)([ \t,;]+(?:latitude|x-ecef|e-baseline)\(.*)$", re.M)


def _read_pos(file: InputFile) -> TrackRows:
    from vopd.flight.formats.rtklib import read_pos

    return read_pos(file)


# Formats of tracks, one row each; the next format is one more row

TRACK_FORMATS: tuple[InputFormat[TrackRows], ...] = (
    InputFormat("GPX", recognises_gpx, read_gpx),
    InputFormat("RTKLIB .pos", lambda file: bool(POS_HEAD.search(file.head)), _read_pos),
    InputFormat("ODM geo.txt", recognises_odm_geo, read_odm_geo),
    InputFormat(
        "CSV (t_s or t_utc or image, lat_deg,lon_deg,h_m or x_m,y_m,z_m)",
        recognises_csv_track,
        read_csv_track,
        has_columns=True,
    ),
    InputFormat("MRK of a drone", recognises_mrk, read_mrk),
    InputFormat("OpenSfM reconstruction.json", recognises_reconstruction, read_reconstruction),
    InputFormat("ODM shots.geojson", recognises_shots, read_shots_geojson),
    InputFormat("a folder of images", recognises_image_folder, read_image_folder),
    InputFormat("a video with GoPro's GPMF", lambda file: file.is_video, _read_gpmf),
    InputFormat("SRT of a DJI drone", lambda file: bool(SUBTITLE.match(file.head)), _read_srt),
)
