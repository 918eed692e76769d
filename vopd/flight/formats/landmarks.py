"""Files of landmarks: CSV, GeoJSON, GPX, KML, gcp_list.txt, OpenSfM, Metashape, CIRN."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isfinite
from typing import Any, NamedTuple
from xml.etree import ElementTree

import numpy as np

from vopd.arrays import Floats
from vopd.files import optional_package, reason
from vopd.findings import count_text, first_of
from vopd.flight.coordinates import (
    M_PER_FT,
    crs_is_geographic,
    crs_name,
    other_angle,
    other_system,
    units_of_crs,
)
from vopd.flight.formats.by_content import InputFormat
from vopd.flight.formats.columns import GEODETIC, HEIGHTS, PLANE, coordinate_columns
from vopd.flight.formats.files import UNEXPECTED, InputFile
from vopd.flight.formats.tables import UNKNOWN, CsvTable, has_columns, read_csv
from vopd.inputs import is_number, parse_xml, plain_number, twice

# Landmarks as read


@dataclass(frozen=True, eq=False)
class LandmarkRows:
    """The landmarks of a file as they stand in it, N of them."""

    name: list[str]
    coordinate: Floats  # (N, 3) longitude, latitude, height; or x, y, z
    geodetic: bool  # longitude and latitude in degrees
    crs: str | None  # where the file says it
    sigma_m: Floats | None  # (N, 3) east, north, up; NaN where not given
    line: Sequence[int]
    said: str
    sigma_by: str = ""  # the columns of `sigma_m`
    names_units: bool = False  # of heights, by their column
    heights: str = ""  # that column, as the file names it
    patch_px: Floats | None = None  # (N,) side of the patch of `vopd track`; NaN where not given
    doubts: Sequence[str] = ()  # sentences for warnings


# ODM's and OpenSfM's gcp_list.txt: landmarks and their picks in one file
#
# The first line is the coordinate reference system; each other line has x y z u v
# image and mostly a name. x is the easting or the longitude. A point without a name
# is known by its coordinates.

CRS = re.compile(r"^(EPSG:\d+(\+\d+)?|['\"]?\+proj=.*|WGS ?84.*)$", re.I)


IMAGE_END = re.compile(r"\.(jpe?g|png|tiff?|dng|heic|webp|bmp)\b", re.I)


class GcpList(NamedTuple):
    """The rows of a gcp_list.txt."""

    crs: str
    position: Floats  # (n, 3) x y z as they stand
    pixel: Floats  # (n, 2) u, v from the first pixel's centre
    image: list[str]
    name: list[str]
    line: list[int]


def is_gcp_list(file: InputFile) -> bool:
    """Tell whether the first line is a coordinate reference system and others have numbers."""
    if not CRS.match(file.head[:500].lstrip().partition("\n")[0].strip()):
        return False
    lines = _lines(file)
    if len(lines) < 2:
        return False
    fields = lines[1][1].split()
    return len(fields) >= 6 and all(is_number(field) for field in fields[:5])


def read_gcp_list(file: InputFile) -> GcpList:
    """Read the rows of a gcp_list.txt.

    Raises:
        VopdError: where a line is not as it should be
    """
    lines = _lines(file)
    numbers, images, names = [], [], []
    for number, line in lines[1:]:
        fields = line.split()
        if len(fields) < 6:
            raise file.error(
                f"{count_text(len(fields), 'field')}, not x y z u v image [name]", number
            )
        if IMAGE_END.search(" ".join(fields[6:])) and not IMAGE_END.search(fields[5]):
            message = "the name of an image has a blank, which ends it here: rename the image"
            raise file.error(message, number)
        try:
            values = [plain_number(field) for field in fields[:5]]
        except ValueError as error:
            raise file.error(reason(error), number) from error
        if not np.isfinite(values).all():
            raise file.error("a number is not finite: a landmark needs x, y and height", number)
        numbers.append(values)
        images.append(fields[5])
        names.append(fields[6] if len(fields) > 6 else " ".join(fields[:3]))
    table = np.array(numbers)
    return GcpList(
        lines[0][1].strip("'\""), table[:, :3], table[:, 3:], images, names,
        [number for number, _ in lines[1:]],
    )  # fmt: skip


def _lines(file: InputFile) -> list[tuple[int, str]]:
    return [
        (number, line.strip())
        for number, line in enumerate(file.text.splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]


# Landmarks as a CSV: the header's names with their units say what the columns are

SIGMA, SIGMAS = "sigma_m", ("sigma_e_m", "sigma_n_m", "sigma_u_m")
"""Columns of standard deviations of positions: one for all axes, and one for each."""
PATCH = "patch_px"
COLUMNS = ("landmark", *GEODETIC, *PLANE, SIGMA, *SIGMAS, PATCH)


def recognises_csv_landmarks(file: InputFile) -> bool:
    """Tell whether the header names landmarks, or coordinates."""
    return has_columns(file, COLUMNS, ("landmark",), ("lat_deg", "lon_deg"), ("x_m", "y_m"))


def has_latitudes(table: CsvTable) -> bool:
    """Tell whether a table has, or lacks, latitude and longitude, and not x and y of its CRS."""
    if table.has("lat_deg") or table.has("x_m") or table.has("y_m"):
        return table.has("lat_deg")
    crs = table.file.crs
    return crs is None or crs_is_geographic(crs_name(crs), table.file.name)


SYSTEM = re.compile(r"^\W*((geodetic|horizontal)[ _])?datum\W*$|^\W*(utm[ _-]?)?zone\W*$", re.I)
"""Names of columns that say the system of the coordinates."""


def coordinates_of(table: CsvTable, geodetic: bool) -> Floats:
    """Read longitude, latitude and height, or x, y and z of a grid, in the units of its axes.

    Raises:
        VopdError: where a column is of another unit, datum or zone than the grid
    """
    columns = coordinate_columns(geodetic)
    coordinate = np.stack([table.numbers(column) for column in columns], axis=1)
    for name in filter(SYSTEM.match, table.header if geodetic or table.file.crs else ()):
        cells = table.column(name)
        for cell in dict.fromkeys(cells):
            if other := other_system(table.file.crs, cell, table.file.name):
                raise table.error(other, cells.index(cell), name)
    if geodetic and (other := other_angle(table.file.crs, table.file.name)):
        raise table.file.error(
            f"{table.file.crs} counts in {other}, and columns lat_deg and lon_deg are degrees: "
            "convert them to a coordinate reference system in degrees, as EPSG:4326"
        )
    crs, file = table.file.crs, table.file.name
    grid, heights = units_of_crs(crs, file)
    names, counts = (
        (columns, f"the grid {crs} counts") if grid else (columns[2:], f"{crs} counts heights")
    )
    units = {} if geodetic and grid else dict(zip(names, [*grid, *heights], strict=False))
    for name, unit in units.items():
        said = table.unit_said(name)
        if said == "ft" and unit.is_foot and name in HEIGHTS:
            coordinate[:, 2] /= M_PER_FT  # the CRS takes feet
        by_name = not said or (unit.is_metre if said == "m" else unit.is_foot)
        if not by_name and not (name in HEIGHTS and unit.is_metre):
            call = name if unit.is_metre else name[0] + "_ft" * unit.is_foot
            raise table.file.error(
                f"{'metres' if said == 'm' else 'feet'} by its name, and "
                f"{counts} in {unit.name}: if it has those, call it {call}",
                column=table.own[table.header.index(name)],
            )
    if [*units] == ["x_m", "y_m"] and not grid[0].is_metre and not table.unit_said("z_m"):
        raise table.file.error(
            f"x and y are {grid[0].name}, by the grid {crs}, and heights may be feet "
            "or metres: call it z_ft or z_m",
            column=table.own[table.header.index("z_m")],
        )
    return coordinate


def read_csv_landmarks(file: InputFile) -> LandmarkRows:
    """Read the landmarks of a CSV."""
    table = read_csv(file, COLUMNS)
    geodetic = has_latitudes(table)
    table.require(("landmark", *coordinate_columns(geodetic)))
    names = table.column("landmark")
    coordinate = coordinates_of(table, geodetic)
    if geodetic:
        table.check_degrees(coordinate)
        table.check_signs(coordinate)
    sigma = table.sigmas_of_axes(SIGMAS, SIGMA)
    return LandmarkRows(
        names,
        coordinate,
        geodetic,
        None,
        sigma,
        table.line,
        f"CSV{table.read_as}",
        sigma_columns(table),
        names_units=True,
        heights=table.heights,
        patch_px=_patches(table),
    )


LEAST_PATCH, MOST_PATCH = 7.0, 101.0  # pixels


def _patches(table: CsvTable) -> Floats | None:
    """Read the sides of the patches that `vopd track` follows; an empty cell has none."""
    if not table.has(PATCH):
        return None
    found = table.numbers(PATCH, UNKNOWN)
    wrong = np.flatnonzero((found < LEAST_PATCH) | (found > MOST_PATCH) | (found % 1.0 != 0.0))
    wrong = wrong[~np.isnan(found[wrong])]
    if len(wrong):
        message = f"{found[wrong[0]]:g} is no side of a patch: 7 to 101, whole pixels"
        raise table.error(message, int(wrong[0]), PATCH)
    return found


def sigma_columns(table: CsvTable) -> str:
    """Name the columns with standard deviations of positions."""
    return f"column {SIGMA}" if table.has(SIGMA) else f"columns {', '.join(SIGMAS)}"


# Landmarks as GeoJSON: points with a name, longitude, latitude, height on WGS 84; x before y in
# a coordinate reference system that the file names, as ogr2ogr and QGIS write it

NAMES = ("landmark", "name", "Name", "NAME", "label", "id")


def recognises_geojson(file: InputFile) -> bool:
    """Tell whether it is JSON of features."""
    return bool(re.search(r'"type"\s*:\s*"Feature', file.text))


WGS84_CRS = {"type": "name", "properties": {"name": "EPSG:4326"}}


def geojson_crs(file: InputFile, root: dict[str, Any], features: list[Any]) -> str:
    """Name the coordinate reference system of GeoJSON: WGS 84 where it has no `crs`.

    A geometry may have its own, or else its feature, or else the file.

    Raises:
        VopdError: where it has no name, or there are two
    """
    usual = root.get("crs", WGS84_CRS)
    every = [(one.get("geometry") or {}).get("crs", one.get("crs", usual)) for one in features]
    names = dict[str, None]()
    for crs in every or [usual]:
        match crs:
            case {"type": "name", "properties": {"name": str(name)}}:
                names[crs_name(name)] = None
            case _:
                raise file.error(
                    f"it is not a name: write {json.dumps(WGS84_CRS)} with the code of the "
                    "coordinates, or leave crs out for longitude and latitude on WGS 84",
                    column="crs",
                )
    first, *others = names
    if others:
        raise file.error(f"{first} and {others[0]}: write all points in one", column="crs")
    return first


def read_geojson(file: InputFile) -> LandmarkRows:
    """Read the points of a GeoJSON file."""
    root = file.json()
    root = root if isinstance(root, dict) else {"features": []}
    features = root.get("features", [root])
    crs = geojson_crs(file, root, features)
    geodetic = crs_is_geographic(crs, file.name)
    names, coordinates = [], []
    for k, feature in enumerate(features):
        where = f"feature {k}"
        geometry, properties = feature.get("geometry") or {}, feature.get("properties") or {}
        values = geometry.get("coordinates", [])
        if geometry.get("type") == "MultiPoint" and isinstance(values, list) and len(values) == 1:
            values = values[0]  # as a layer of QGIS has them that may have several
        elif geometry.get("type") != "Point":
            continue
        name = next((properties[key] for key in NAMES if key in properties), feature.get("id"))
        if name is None:
            raise file.error(f"no name: a property {', '.join(NAMES[:2])} is needed", column=where)
        if len(values) != 3 or not all(map(is_real_number, values)):
            raise file.error("a landmark needs longitude, latitude and height", column=where)
        if geodetic and abs(values[1]) > 90.0:
            raise file.error(f"{values[1]:g} is no latitude: longitude comes first", column=where)
        names.append(str(name))
        coordinates.append([float(x) for x in values])
    if not names:
        raise file.error("no point is in the file")
    rows = LandmarkRows(
        names, np.array(coordinates), geodetic, crs, None, [0] * len(names), "GeoJSON",
    )  # fmt: skip
    return _with_doubts_of_level(file, rows, "GeoJSON")


def is_real_number(value: object) -> bool:
    """Say if a value is a finite number; a whole one beyond 1e308 is none."""
    try:
        return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)
    except OverflowError:
        return False


# Landmarks as GPX waypoints or KML placemarks, longitude and latitude on WGS 84. What the heights
# are counted from no schema says, or telephones do not keep to it


def recognises_gpx(file: InputFile) -> bool:
    """Tell whether it is GPX."""
    return "<gpx" in file.head


NUMBERS_OF_GPX = "ele", "hdop", "vdop", "pdop"
OF_GPX_POINT = (*NUMBERS_OF_GPX, "time", "name", "fix")
TIME_OF_GPX = re.compile("(?<=<time>)[^<]*")
NOT_READ = re.compile(r"(<!\[CDATA\[.*?\]\]>)|<!--.*?-->|<\?.*?\?>", re.DOTALL)
"""Comments and processing instructions, outside of text that is quoted. At one of them lxml, which
gpxpy prefers, ends a number; and by the declaration it takes our UTF-8 for another encoding."""


def _stripped(found: re.Match[str]) -> str:
    """Take off blanks, with which gpxpy reads no time."""
    return found[0].strip()


def parse_gpx(file: InputFile) -> Any:
    """Parse GPX, of a track or of waypoints."""
    gpxpy = optional_package("gpxpy", "gpx", f"{file.name}: GPX")
    try:
        root = parse_xml(file.text)  # its words are the same with and without gpxpy's lxml
        for one in root.iter():
            texts = [one.get("lat"), one.get("lon")]
            texts += [one.text] if one.tag.rpartition("}")[2] in NUMBERS_OF_GPX else []
            for text in filter(None, texts):
                plain_number(text)  # gpxpy takes 1_0 and those of other scripts
            within = [part.tag.rpartition("}")[2] for part in one if one.get("lat")]
            if message := twice(name for name in within if name in OF_GPX_POINT):
                raise ValueError(message)  # of two gpxpy takes the first
        text = NOT_READ.sub(lambda found: found[1] or "", file.text)
        return gpxpy.parse(TIME_OF_GPX.sub(_stripped, text))
    except (gpxpy.gpx.GPXException, ElementTree.ParseError, *UNEXPECTED) as error:
        raise file.error(f"not valid GPX: {reason(error)}") from error


def with_fix(points: Sequence[Any]) -> tuple[list[Any], str]:
    """Leave out the points of GPX without a fix in three dimensions.

    Returns:
        The others, and what is to be said of those; empty if there is none.
    """
    fixed = [point for point in points if point.type_of_gpx_fix not in ("none", "2d")]
    without = len(points) - len(fixed)
    return fixed, f", {without} without a fix left out" * bool(without)


def read_waypoints(file: InputFile) -> LandmarkRows:
    """Read the waypoints of a GPX file."""
    fixed, without = with_fix(parse_gpx(file).waypoints)
    points = [((p.name or "").strip(), p.longitude, p.latitude, p.elevation) for p in fixed]
    rows = _named_points(file, points, "waypoint", f"GPX waypoints{without}")
    return _with_doubts_of_level(file, rows, "GPX")


def recognises_kml(file: InputFile) -> bool:
    """Tell whether it is KML."""
    return "<kml" in file.head


def read_kml(file: InputFile) -> LandmarkRows:
    """Read the placemarks of a KML file that are points."""
    root = file.xml()
    points = []
    for place in root.iterfind(".//{*}Placemark"):
        points_of = place.findall(".//{*}Point")
        for parts in (place, *points_of):
            tags = (one.tag.rpartition("}")[2] for one in parts)
            if message := twice(tag for tag in tags if tag in ("name", "coordinates")):
                raise file.error(message)
        for point in points_of:
            name = (place.findtext("{*}name") or "").strip()
            for one in point.iterfind("{*}altitudeMode"):  # KML's own, and Google's beside it
                mode = (one.text or "").strip()
                if mode in ("relativeToGround", "relativeToSeaFloor"):
                    what = "the ground" if mode == "relativeToGround" else "the sea floor"
                    raise file.error(f"{name}: its height is above {what}: give heights in a CSV")
            values = [*map(plain_number, (point.findtext("{*}coordinates") or "").split(","))]
            if len(values) > 3:
                raise file.error(f"{name}: {len(values)} coordinates; decimals take a point")
            points.append((name, values[0], values[1], values[2] if len(values) > 2 else None))
    if points and not any(height for *_, height in points):
        raise file.error("all heights are 0 or missing: KML often has none; give them in a CSV")
    rows = _named_points(file, points, "placemark", "KML placemarks")
    return _with_doubts_of_level(file, rows, "KML")


MOST_NAMED = 1  # of landmarks whose height is doubted


def _with_doubts_of_level(file: InputFile, rows: LandmarkRows, what: str) -> LandmarkRows:
    """Doubt heights of exactly 0 beside others, in formats that often have none.

    Args:
        file: for the sentence
        rows: its landmarks
        what: the format
    """
    height = rows.coordinate[:, 2]
    level = [name for name, none in zip(rows.name, (height == 0.0).tolist(), strict=True) if none]
    if not level or not height.any():
        return rows
    doubt = (
        f"{file.name}: {first_of(level, MOST_NAMED)}: the height is 0, which in {what} often "
        "stands for none, and others have one: if it is not 0, give the heights in a CSV"
    )
    return replace(rows, doubts=(doubt,))


def _named_points(file: InputFile, points: list[Any], what: str, said: str) -> LandmarkRows:
    """Make landmarks of names, longitudes, latitudes and heights, all of which are needed."""
    if not points:
        raise file.error(f"no {what} is in the file")
    for k, (name, longitude, latitude, height) in enumerate(points, 1):
        if any(isinstance(one, bool) for one in (longitude, latitude, height)):
            raise file.error(f"{name}: a coordinate is true or false, and no number")
        if not name or height is None:
            raise file.error(f"{what} {k} has no {'height' if name else 'name'}")
        if not np.isfinite([longitude, height]).all() or not abs(latitude) <= 90.0:
            raise file.error(f"{name}: a number is not finite, or no latitude")
    return LandmarkRows(
        [one[0] for one in points], np.array([one[1:] for one in points], float), True,
        "EPSG:4326", None, [0] * len(points), said,
    )  # fmt: skip


# The landmarks in a gcp_list.txt

recognises_gcp_landmarks = is_gcp_list


def read_gcp_landmarks(file: InputFile) -> LandmarkRows:
    """Read each landmark of a gcp_list.txt once.

    Raises:
        VopdError: where one name has two positions
    """
    rows = read_gcp_list(file)
    first: dict[str, int] = {}
    for k, name in enumerate(rows.name):
        before = first.setdefault(name, k)
        if not np.array_equal(rows.position[k], rows.position[before]):
            raise file.error(
                f"{name} has another position than in line {rows.line[before]}", rows.line[k]
            )
    kept = list(first.values())
    return LandmarkRows(
        list(first), rows.position[kept], False, rows.crs, None,
        [rows.line[k] for k in kept], "gcp_list.txt, x east or longitude",
    )  # fmt: skip


# OpenSfM's ground_control_points.json: landmarks and their picks in one file


def recognises_control(file: InputFile) -> bool:
    """Tell whether it is JSON of points with observations."""
    text = file.text
    return text.lstrip().startswith("{") and '"points"' in text and '"observations"' in text


def control_points(file: InputFile) -> list[dict[str, Any]]:
    """Read the points of a ground_control_points.json.

    Raises:
        VopdError: where it is not such a file
    """
    found = file.json()["points"]
    if not found:
        raise file.error("no point is in the file")
    return list(found)


def read_control_landmarks(file: InputFile) -> LandmarkRows:
    """Read the landmarks: latitude, longitude and altitude on WGS 84."""
    points = [
        (str(one["id"]), *(one.get("position", {}).get(key) for key in LATITUDE_FIRST))
        for one in control_points(file)
    ]
    named = [(name, longitude, latitude, h) for name, latitude, longitude, h in points]
    for name, longitude, latitude, _ in named:
        if longitude is None or latitude is None:
            raise file.error(f"{name} has no latitude and longitude")
    return _named_points(file, named, "point", "OpenSfM ground control")


LATITUDE_FIRST = ("latitude", "longitude", "altitude")


# Metashape's XML of markers: landmarks and their picks in one file, a name for each by its id

FALSE = "false", "0"  # as newer and older versions write it
EPSG = re.compile(r'AUTHORITY\["EPSG","(\d+)"\]\]\s*$')


def recognises_markers(file: InputFile) -> bool:
    """Tell whether it is XML with markers."""
    return file.head.lstrip().startswith("<") and "<marker " in file.text


def marker_tree(file: InputFile) -> tuple[ElementTree.Element, dict[str, str]]:
    """Parse an XML of markers: its root, and the names of the markers by their ids.

    Raises:
        VopdError: where it is no XML, or has no marker
    """
    root = file.xml()
    every = root.findall(".//marker[@label]")
    names = {one.get("id", ""): one.get("label", "") for one in every}
    if not names:
        raise file.error("no marker has a label")
    if len({*names.values()}) < len(every):
        raise file.error("two markers have one label: it is the name of the landmark")
    return root, names


def read_marker_landmarks(file: InputFile) -> LandmarkRows:
    """Read the markers that have reference coordinates, x the easting or longitude."""
    root, _ = marker_tree(file)
    names, places = list[str](), []
    for one in root.findall(".//marker[@label]"):
        place = one.find("reference")
        texts = [] if place is None else [place.get("x"), place.get("y"), place.get("z")]
        if place is not None and all(texts) and place.get("enabled") not in FALSE:
            places.append([plain_number(text or "") for text in texts])
            names.append(one.get("label", ""))
    if not names:
        raise file.error("no marker has reference coordinates x, y, z: give landmarks in a CSV")
    coordinate = np.array(places)
    if not np.isfinite(coordinate).all():
        raise file.error("a coordinate of a marker is not finite")
    said = "Metashape markers, x east or longitude"
    systems = {one.text.strip() for one in root.iter("reference") if one.text and one.text.strip()}
    if len(systems) > 1:
        message = f"{len(systems)} coordinate reference systems are in the file"
        raise file.error(f"{message}: export one chunk")
    code = next(filter(None, map(EPSG.search, systems)), None)
    return LandmarkRows(
        names, coordinate, False, code and f"EPSG:{code[1]}", None, [0] * len(names), said,
    )  # fmt: skip


# The list of control points that CIRN's toolbox takes: number, x, y, z, without a header

CIRN_ROW = re.compile(r"\s*\d+\.0+\s*(,\s*[-+\d.eE]+\s*){3}$")


def recognises_cirn(file: InputFile) -> bool:
    """Tell whether a row is as MATLAB writes it: `1.000000,902062.638000,...`, four numbers."""
    return file.columns is None and bool(CIRN_ROW.match(file.head.split("\n", 1)[0].rstrip("\r")))


def read_cirn(file: InputFile) -> LandmarkRows:
    """Read the rows; a landmark's name is its number without decimals."""
    rows, lines = [], []
    for line, text in enumerate(file.text.splitlines(), 1):
        if not text.strip():
            continue
        values = [plain_number(cell) for cell in text.split(",")]
        if len(values) != 4 or not np.isfinite(values).all() or values[0] % 1:
            raise file.error("a row is number, x, y, z", line)
        rows.append(values)
        lines.append(line)
    names = [f"{one[0]:.0f}" for one in rows]
    coordinate = np.array([one[1:] for one in rows])
    return LandmarkRows(names, coordinate, False, None, None, lines, "CIRN's list, x before y")


# Formats of files of landmarks, one row each; the next format is one more row

LANDMARK_FORMATS: tuple[InputFormat[LandmarkRows], ...] = (
    InputFormat("GPX waypoints", recognises_gpx, read_waypoints),
    InputFormat("KML placemarks", recognises_kml, read_kml),
    InputFormat("GeoJSON", recognises_geojson, read_geojson),
    InputFormat("gcp_list.txt", recognises_gcp_landmarks, read_gcp_landmarks),
    InputFormat("OpenSfM ground_control_points.json", recognises_control, read_control_landmarks),
    InputFormat("Metashape XML of markers", recognises_markers, read_marker_landmarks),
    InputFormat("CIRN's list (number,x,y,z)", recognises_cirn, read_cirn),
    InputFormat(
        "CSV (landmark,lat_deg,lon_deg,h_m or landmark,x_m,y_m,z_m)",
        recognises_csv_landmarks,
        read_csv_landmarks,
        has_columns=True,
    ),
)
