"""Every field of files of landmarks: gcp_list.txt, GeoJSON, and tables."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pyproj
import pytest

import vopd
from tests.approved.texts import assert_approved, refused
from tests.kit.command import vopd as run
from tests.kit.flight_project import TOML, read_text, text_told, write_project
from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.flight.coordinates import HeightDatum, earth_centred_positions
from vopd.flight.formats.by_content import read_by_content
from vopd.flight.formats.files import InputFile
from vopd.flight.formats.landmarks import LANDMARK_FORMATS, read_cirn
from vopd.flight.formats.picks import PICK_FORMATS
from vopd.geometry.earth import earth_centred_m

ABOVE = HeightDatum("ellipsoid")


def read(text: str) -> Any:
    return read_text(LANDMARK_FORMATS, "m", text)


def told(text: str) -> str:
    return text_told(LANDMARK_FORMATS, "m", text)


# gcp_list.txt, which has landmarks and picks


GCP = (
    "EPSG:4326\n  \n  # x y z u v image\n16.5 47.5 300.0 5 6.5 a.jpg Mast\n"
    "16.25 47.25 200 7 8 a.jpg\n16.5 47.50 300 9 1 x/B.jpg Mast more\n"
)


def test_lines_of_a_gcp_list() -> None:
    marks = read(GCP)
    assert marks.name == ["Mast", "16.25 47.25 200"] and [*marks.line] == [4, 5]
    assert marks.coordinate.tolist() == [[16.5, 47.5, 300.0], [16.25, 47.25, 200.0]]
    assert (marks.geodetic, marks.crs) == (False, "EPSG:4326")
    assert marks.sigma_m is None
    assert_approved(marks.said)
    picks = read_text(PICK_FORMATS, "p", GCP)
    assert [*picks.landmark] == ["Mast", "16.25 47.25 200", "Mast"]
    assert [*picks.frame] == ["a.jpg", "a.jpg", "x/B.jpg"]
    assert picks.pixel.tolist() == [[5.0, 6.5], [7.0, 8.0], [9.0, 1.0]]
    assert np.isnan(picks.sigma_px).all() and picks.sigma_px.shape == (3,)
    assert (picks.grid, picks.size_px, picks.said) == ("centre", None, "gcp_list.txt")


@pytest.mark.parametrize(
    "crs",
    [
        "EPSG:32633", "epsg:4979", "EPSG:4326+5773", "+proj=utm +zone=33", "'+proj=longlat +x'",
        '"+proj=longlat +x"', "WGS84 UTM 16N", "wgs 84", "WGS84",
    ],
)  # fmt: skip
def test_coordinate_systems_of_a_gcp_list(crs: str) -> None:
    for before in ("", "\n ", " " * 300):
        marks = read(f"{before}{crs} \n1 2 3 4 5 a.jpg m\n")
        assert (marks.crs, marks.name) == (crs.strip("'\""), ["m"])


@pytest.mark.parametrize(
    "text",
    [
        "EPSG:4326\n", "EPSG:4326\n# 1 2 3 4 5 a.jpg\n", "EPSG:4326\n1 2 3 4 5\n",
        "EPSG:4326\n1 2 3 4 x a.jpg\n", "EPSG:4326\n1 2 x 4 5 a.jpg\n", "EPSG\n1 2 3 4 5 a.jpg\n",
        "EPSG:4326 x\n1 2 3 4 5 a.jpg\n", "1 2 3 4 5 a.jpg\nEPSG:4326\n",
        "proj=utm\n1 2 3 4 5 a.jpg\n",
    ],
)  # fmt: skip
def test_what_is_no_gcp_list(text: str) -> None:
    assert told(text).startswith("m: the format is not recognised")


@pytest.mark.parametrize(
    "line",
    [
        "1 2 3 4 5",
        "1 2 3",
        *[" ".join("x" if k == odd else "1" for k in range(5)) + " a.jpg m" for odd in range(5)],
        *[" ".join("nan" if k == odd else "1" for k in range(5)) + " a.jpg m" for odd in range(5)],
        "16.5 47.5 301 1 2 c.jpg Mast",
        "16.5 47.25 300 1 2 c.jpg Mast",
        "16.25 47.5 300 1 2 c.jpg Mast",
        "16.5 47.5 300 1 2 IMG 1.JPG Mast",
    ],
)  # fmt: skip
def test_lines_of_a_gcp_list_that_are_refused(line: str) -> None:
    assert_approved(told(f"{GCP}\n# c\n{line}\n"))


# GeoJSON


def feature(*values: Any, kind: str = "Point", **rest: Any) -> dict[str, Any]:
    geometry = {"type": kind, "coordinates": [*values]}
    return {"type": "Feature", "geometry": geometry, "properties": {"name": "A"}} | rest


def collection(*features: dict[str, Any]) -> str:
    return json.dumps({"type": "FeatureCollection", "features": [*features]})


@pytest.mark.parametrize(
    "second",
    [
        feature(1, 2),
        feature(1, 2, 3, 4),
        feature(),
        feature(1, 2, "3"),
        feature("1", 2, 3),
        feature(1, 2, None),
        feature(float("nan"), 2, 3),
        feature(1, float("nan"), 3),
        feature(1, 2, float("inf")),
        feature(5, 90.5, 3),
        feature(5, -90.5, 3),
        feature(1, 2, 3, properties=None),
        feature(1, 2, 3, properties={"title": "x"}),
        feature(5, 45, 10**400),
    ],
)  # fmt: skip
def test_features_that_are_refused(second: dict[str, Any]) -> None:
    line = feature(kind="LineString", properties=None)
    said = told(collection(feature(1, 2, 3), line, second))
    assert_approved(said)


def test_features_that_are_no_points_are_passed_over() -> None:
    assert_approved(told(collection()))
    for kind in ("MultiPoint", "LineString", "Polygon", "point"):
        assert_approved(told(collection(feature(1, 2, 3, kind=kind))))
    assert_approved(told(collection(feature(geometry=None))))
    text = collection(feature(1, 2, 3))
    assert_approved(told(text[:-1]))
    assert_approved(told(f"[{text}]"))


def test_a_multipoint_of_one_point_is_a_point() -> None:
    """Layers of QGIS are of many points a feature, also where each has one."""
    marks = read(collection(feature([16.5, 47.5, 300.0], kind="MultiPoint")))
    assert marks.name == ["A"] and marks.coordinate.tolist() == [[16.5, 47.5, 300.0]]
    two = feature([16.5, 47.5, 300.0], [16.5, 47.5, 301.0], kind="MultiPoint")
    assert read(collection(two, feature(1, 2, 3, properties={"name": "B"}))).name == ["B"]
    assert_approved(told(collection(feature([16.5, 47.5], kind="MultiPoint"))))


def test_points_of_geojson() -> None:
    points = [feature(361, 90, -3, properties={"NAME": 5}), feature(1.5, -90, 3, id="own")]
    marks = read("\n" + collection(*points).replace('"type": ', '"type"  :\n'))
    assert marks.coordinate.tolist() == [[361.0, 90.0, -3.0], [1.5, -90.0, 3.0]]
    assert marks.name == ["5", "A"] and [*marks.line] == [0, 0]
    assert (marks.geodetic, marks.crs, marks.said) == (True, "EPSG:4326", "GeoJSON")
    assert marks.sigma_m is None
    assert read(json.dumps(points[1])).name == ["A"]
    assert_approved(told(collection(feature(True, 2.0, 3.0))))


def test_the_first_of_a_feature_s_names_counts() -> None:
    names = ("landmark", "name", "Name", "NAME", "label", "id")
    for first in range(6):
        given = {name: name for name in reversed(names[first:])}
        one = feature(1, 2, 3, properties=given, id="own")
        assert read(collection(one)).name == [names[first]]
    assert read(collection(feature(1, 2, 3, properties={}, id=0))).name == ["0"]


def by_name(name: object) -> dict[str, Any]:
    return {"type": "name", "properties": {"name": name}}


def with_crs(crs: object, *features: dict[str, Any]) -> str:
    """Write GeoJSON of 2008, as ogr2ogr and QGIS write it."""
    return json.dumps(json.loads(collection(*features)) | {"crs": crs})


@pytest.mark.parametrize(
    ("name", "code", "place"),
    [
        ("urn:ogc:def:crs:EPSG::4312", "EPSG:4312", (15.0, 47.0, 300.0)),
        ("EPSG:4312", "EPSG:4312", (15.0, 47.0, 300.0)),
        ("urn:ogc:def:crs:EPSG:8.9:32633", "EPSG:32633", (500_100.0, 5_205_000.0, 300.0)),
        ("urn:ogc:def:crs:EPSG::31467", "EPSG:31467", (3_500_100.0, 5_205_000.0, 300.0)),
    ],
)  # fmt: skip
def test_the_coordinate_system_of_geojson(name: str, code: str, place: tuple[float, ...]) -> None:
    """x stands first, also where the axes of the system are north and east (EPSG:31467)."""
    wanted = pyproj.Transformer.from_crs(code, "EPSG:4979", always_xy=True, only_best=True)
    longitude, latitude, _ = wanted.transform(*place)
    here = earth_centred_m([latitude], [longitude], place[2:])
    for text in (
        with_crs(by_name(name), feature(*place)),
        json.dumps(feature(*place, crs=by_name(name))),
        with_crs(None, feature(*place, crs=by_name(name))),
    ):
        marks = read(text)
        assert (marks.crs, marks.geodetic) == (code, code == "EPSG:4312")
        found = earth_centred_positions(marks.coordinate, marks.geodetic, marks.crs, ABOVE, "m")
        assert_close("flight position", found, here)
    if marks.geodetic:
        away_m = np.linalg.norm(found - earth_centred_m([47.0], [15.0], [300.0]))
        assert 50.0 < away_m < 150.0


@pytest.mark.parametrize(
    "name", ["urn:ogc:def:crs:OGC:1.3:CRS84", "urn:ogc:def:crs:OGC::CRS84", "OGC:CRS84"]
)
def test_geojson_that_says_wgs_84(name: str) -> None:
    marks = read(with_crs(by_name(name), feature(15, 47, 300)))
    assert (marks.crs, marks.geodetic) == ("EPSG:4326", True)


@pytest.mark.parametrize(
    "crs",
    [
        None,
        {"type": "link", "properties": {"href": "http://a.org/4312", "type": "proj4"}},
        {"type": "EPSG", "properties": {"code": 4312}},
        by_name(4312),
        by_name("bogus"),
        "EPSG:4312",
    ],
)  # fmt: skip
def test_coordinate_systems_of_geojson_that_are_refused(crs: object) -> None:
    assert_approved(told(with_crs(crs, feature(15, 47, 300))))


def test_two_coordinate_systems_in_one_geojson() -> None:
    other = feature(15, 47, 300, crs=by_name("EPSG:4312"))
    assert_approved(told(collection(feature(15, 47, 300), other)))


# Tables


def test_latitudes_of_a_table_are_looked_at_in_their_row() -> None:
    text = "lat_deg,lon_deg,h_m,landmark,sigma_m\n90,360,3,a,0.5\n-90,-360,3,b c,\n"
    marks = read(text)
    assert marks.coordinate.tolist() == [[360.0, 90.0, 3.0], [-360.0, -90.0, 3.0]]
    assert marks.name == ["a", "b c"] and [*marks.line] == [2, 3] and marks.geodetic
    assert marks.sigma_m[0].tolist() == [0.5] * 3 and np.isnan(marks.sigma_m[1]).all()
    assert marks.sigma_by == "column sigma_m"
    assert (marks.crs, marks.said) == (None, "CSV")
    for wrong in ("90.5", "-90.5", "-120"):
        assert_approved(told(f"{text}\n{wrong},2,3,c,\n91,2,3,d,\n"), parts=[wrong])
    for wrong in ("360.5", "-360.5"):
        assert_approved(told(f"{text}\n2,{wrong},3,c,\n2,361,3,d,\n"), parts=[wrong])
    assert_approved(told("lat_deg,lon_deg,h_m,landmark\n4700,33,3,a\n"))
    plane = read("landmark,x_m,y_m,z_m\na,100,200,300\n")
    assert plane.coordinate.tolist() == [[100.0, 200.0, 300.0]] and not plane.geodetic
    assert plane.sigma_m is None


@pytest.mark.parametrize(
    ("header", "message"),
    [
        ("landmark", "no column lon_deg"), ("landmark,lat_deg,h_m", "no column lon_deg"),
        ("lat_deg,lon_deg", "no column landmark"), ("x_m,y_m", "no column landmark"),
        ("lat_deg,lon_deg,h_m", "no column landmark"), ("x_m,y_m,z_m", "no column landmark"),
        ("landmark,y_m,z_m", "no column x_m"), ("landmark,x_m,z_m", "no column y_m"),
        ("landmark,lat_deg,x_m,y_m,z_m", "no column lon_deg"),
    ],
)  # fmt: skip
def test_a_table_that_has_part_of_landmarks(header: str, message: str) -> None:
    cells = ",".join("1" * (header.count(",") + 1))
    assert told(f"{header}\n{cells}\n").startswith(f"m: line 1: {message}")
    for other in ("lat_deg,h_m", "x_m,z_m", "nom"):
        assert told(f"{other}\n1,2\n").startswith("m: the format is not recognised")


# KML, and heights of 0


def test_one_placemark_at_height_0_is_a_height() -> None:
    """Files without heights have 0 in all of them."""
    place = "<Placemark><name>{}</name><Point><coordinates>16.5,47.5,{}</coordinates></Point>"
    place += "</Placemark>"
    head, end = '<kml xmlns="http://www.opengis.net/kml/2.2"><Document>', "</Document></kml>"
    marks = read(head + place.format("pier", 0) + place.format("mast", 30) + end)
    assert [*marks.coordinate[:, 2]] == [0.0, 30.0] and marks.name == ["pier", "mast"]
    heights = {"mast": 30, "pier": 0, "quay": "0.0", "buoy": "-0"}
    more = read(head + "".join(place.format(*one) for one in heights.items()) + end)
    assert_approved([*marks.doubts, *more.doubts])
    assert read(head + place.format("pier", 0.01) + place.format("mast", 30) + end).doubts == ()
    assert_approved(told(head + place.format("pier", 0) + place.format("mast", 0) + end))


def waypoints(*heights: float) -> str:
    """GPX with a waypoint at each height, called A, B and so on."""
    point = '<wpt lat="47.5" lon="16.5"><ele>{}</ele><name>{}</name></wpt>'
    text = "".join(point.format(h, name) for h, name in zip(heights, "ABC", strict=False))
    return f'<gpx version="1.1" creator="x">{text}</gpx>'


def test_blanks_around_a_name_of_gpx_are_none_of_it() -> None:
    """No pick had that name."""
    assert read(waypoints(30.0).replace(">A<", ">\n  A\n<")).name == ["A"]


@pytest.mark.parametrize("form", ["GPX", "GeoJSON"])
def test_a_height_of_0_beside_others_is_doubted(form: str) -> None:
    """Not one near 0, nor where all are 0, as on a plane of the user's own."""

    def doubts(*heights: float) -> list[str]:
        if form == "GPX":
            return [*read(waypoints(*heights)).doubts]
        return [*read(collection(*(feature(1, 2, one) for one in heights))).doubts]

    assert_approved(doubts(30.0, 0.0) + doubts(0.0, 30.0, 0.0))
    assert doubts(0.01, 30.0) == doubts(0.0, 0.0) == doubts(-0.5, 30.0) == []


def test_a_doubtful_height_is_a_warning_of_the_flight_and_told_of_a_new_project(
    tmp_path: Path,
) -> None:
    """The landmarks as placemarks, and one more at a height of 0, which no pick names."""
    place = "<Placemark><name>{}</name><Point><coordinates>{},{},{}</coordinates></Point>"
    place += "</Placemark>"
    project = write_project(tmp_path, TOML.replace("landmarks.csv", "marks.kml"))
    rows = list(csv.DictReader((tmp_path / "landmarks.csv").read_text().splitlines()))
    marks = [(one["landmark"], one["lon_deg"], one["lat_deg"], one["h_m"]) for one in rows]
    marks.append(("pier", *marks[0][1:3], "0"))
    text = "".join(place.format(*one) for one in marks)
    (tmp_path / "marks.kml").write_text(f"<kml><Document>{text}</Document></kml>")
    doubt = "marks.kml: pier: the height is 0"
    assert [doubt in one.message for one in vopd.solve_flight(project).findings] == [True]
    ran = run("new", tmp_path / "new", "--landmarks", tmp_path / "marks.kml")
    assert doubt in ran.stdout + ran.stderr


def test_what_stands_twice_in_a_placemark_is_refused() -> None:
    """The first name, or place, counted in silence."""
    point = "<Point><coordinates>1,2,3</coordinates>{}</Point>"
    for text in (
        "<name>a</name><name>b</name>" + point.format(""),
        "<name>a</name>" + point.format("<coordinates>4,5,6</coordinates>"),
    ):
        for kml in ("<kml>{}</kml>", '<kml xmlns="http://www.opengis.net/kml/2.2">{}</kml>'):
            assert_approved(told(kml.format(f"<Placemark>{text}</Placemark>")))


def test_waypoints_without_a_fix_are_no_landmarks() -> None:
    """As points of a track; the height of a fix of two dimensions is of an earlier one."""
    point = '<wpt lat="2" lon="1"><ele>3</ele><name>{}</name><fix>{}</fix></wpt>'
    every = "".join(point.format(one, one) for one in ("none", "2d", "3d", "dgps"))
    head = '<gpx version="1.1" xmlns="http://www.topografix.com/GPX/1/1">'
    rows = read(f"{head}{every}</gpx>")
    assert rows.name == ["3d", "dgps"]
    assert_approved(rows.said)


def test_a_height_above_the_sea_floor_is_one_whichever_mode_says_so() -> None:
    """Google's own stands beside KML's, which was looked at alone."""
    modes = (
        "<altitudeMode>absolute</altitudeMode><g:altitudeMode>relativeToSeaFloor</g:altitudeMode>"
    )
    text = f"<Point>{modes}<coordinates>16.5,47.5,30</coordinates></Point>"
    assert_approved(told(f'<kml xmlns:g="g"><Placemark><name>a</name>{text}</Placemark></kml>'))


@pytest.mark.parametrize(
    "place",
    [
        "<Point><coordinates>16.5,47.5,30</coordinates></Point>",
        "<name> </name><Point><coordinates>16.5,47.5,30</coordinates></Point>",
        "<name>a</name><Point></Point>",
        "<name>a</name><Point><coordinates>16.5,97.5,30</coordinates></Point>",
        "<name>a</name><Point><coordinates>16.5,47.5,30,5</coordinates></Point>",
    ],
)
def test_a_placemark_without_a_name_or_a_place_is_refused(place: str) -> None:
    assert_approved(told(f"<kml><Placemark>{place}</Placemark></kml>"))


# Tables on a grid that counts in feet

FEET, BOTH_FEET = "EPSG:2229", "EPSG:2229+6360"  # of California; with heights in feet


def on_grid(crs: str, header: str, columns: Any = None) -> Any:
    text = f"{header}\na,6480000,1840000,1000\n"
    file = InputFile("m", Path("nowhere"), text, columns, crs)
    return read_by_content(LANDMARK_FORMATS, file)


@pytest.mark.parametrize(
    ("crs", "names", "height"),
    [
        (FEET, "x_ft,y_ft,z_m", 1000.0), (FEET, "x,y,z_ft", 304.8),
        (FEET, "Easting (ft),Northing (ft),Elevation (ft)", 304.8),
        (FEET, "Easting,Northing,Elev (m)", 1000.0),
        (BOTH_FEET, "x,y,z", 1000.0), (BOTH_FEET, "x_ft,y_ft,z_ft", 1000.0),
        ("EPSG:32611", "x,y,z", 1000.0), ("EPSG:32611", "x_m,y_m,z_ft", 304.8),
    ],
)  # fmt: skip
def test_a_grid_in_feet(crs: str, names: str, height: float) -> None:
    """Of columns in feet x and y stay in those of the grid; heights are metres but for its own."""
    found = on_grid(crs, f"landmark,{names}")
    assert found.coordinate[0, :2].tolist() == [6480000.0, 1840000.0]
    assert_close("flight position", found.coordinate[0, 2], height)


def test_degrees_beside_a_system_in_grads_are_refused() -> None:
    """52 degrees were read as 52 grads, which are 46.8 degrees; as x and y they are what it has."""
    row = "a,2.5,52.0,100\n"
    of_file = InputFile("m", Path("nowhere"), f"landmark,lon,lat,h\n{row}", None, "EPSG:4807")
    with refused(VopdError):
        read_by_content(LANDMARK_FORMATS, of_file)
    for crs in ("EPSG:4258", "EPSG:4326", None):
        of_file = InputFile("m", Path("nowhere"), f"landmark,lon,lat,h\n{row}", None, crs)
        assert read_by_content(LANDMARK_FORMATS, of_file).coordinate[0, 1] == 52.0
    grads = f"landmark,x_m,y_m,z_m\n{row}"
    of_file = InputFile("m", Path("nowhere"), grads, None, "EPSG:4807")
    assert read_by_content(LANDMARK_FORMATS, of_file).coordinate[0, 1] == 52.0


@pytest.mark.parametrize(
    "names", ["lat,lon,height", "lat_deg,lon_deg,h_ft", "y,x,z_ft", "lat_deg,lon_deg,h_m"]
)
def test_heights_of_their_own_in_feet_beside_degrees(names: str) -> None:
    """Feet by their name were read in metres, and these taken for feet, as those of h_m were."""
    text = f"landmark,{names}\na,34.0,-118.0,1000\n"
    of_file = InputFile("m", Path("nowhere"), text, None, "EPSG:4269+6360")
    if names.endswith("_m"):
        with refused(VopdError):
            read_by_content(LANDMARK_FORMATS, of_file)
        return
    found = read_by_content(LANDMARK_FORMATS, of_file).coordinate
    assert_close("flight position", found, [[-118.0, 34.0, 1000.0]])


def test_a_table_without_a_header_names_its_feet() -> None:
    text = "a,6480000,1840000,1000\n"
    file = InputFile("m", Path("nowhere"), text, ["landmark", "x_ft", "y_ft", "z_ft"], FEET)
    found = read_by_content(LANDMARK_FORMATS, file)
    assert found.coordinate[0, 1] == 1840000.0
    assert_close("flight position", found.coordinate[0, 2], 304.8)


@pytest.mark.parametrize(
    ("crs", "names"),
    [
        (FEET, "x_m,y_m,z_m"), (FEET, "x,Northing (m),z_m"), (FEET, "Easting,Northing,Elevation"),
        (BOTH_FEET, "x,y,z_m"), ("EPSG:32611", "x_ft,y_ft,z_m"),
    ],
)  # fmt: skip
def test_a_unit_that_is_not_the_grid_s_is_refused(crs: str, names: str) -> None:
    """x_m counted in feet, and a height without a unit in metres."""
    with refused(VopdError):
        on_grid(crs, f"landmark,{names}")


def test_feet_without_a_grid_in_feet_are_asked_for_it() -> None:
    """To map them as metres was the advice."""
    with refused(VopdError):
        file = InputFile("m", Path("nowhere"), "landmark,E (ft),N (ft),Elev (ft)\na,1,2,3\n")
        read_by_content(LANDMARK_FORMATS, file)


def test_a_mapped_column_says_its_unit() -> None:
    mapped = {"x_ft": "a", "y_ft": "b", "z_ft": "c"}
    found = on_grid(FEET, "landmark,a,b,c", mapped)
    assert found.coordinate[0, 0] == 6480000.0
    assert_close("flight position", found.coordinate[0, 2], 304.8)
    for crs, columns in ((FEET, {"x_m": "a", "y_m": "b", "z_m": "c"}), ("EPSG:32611", mapped)):
        with refused(VopdError):
            on_grid(crs, "landmark,a,b,c", columns)


# Patches, and the rows of CIRN


def test_sides_of_patches() -> None:
    """An empty cell leaves the side to the tracker."""
    rows = read("landmark,lat_deg,lon_deg,h_m,patch_px\na,1,2,3,7\nb,1,2,3,\nc,1,2,3,101\n")
    assert np.array_equal(rows.patch_px, [7.0, np.nan, 101.0], equal_nan=True)
    assert read("landmark,lat_deg,lon_deg,h_m\na,1,2,3\n").patch_px is None


@pytest.mark.parametrize("side", ["6", "102", "9.5"])
def test_sides_of_patches_that_are_refused(side: str) -> None:
    assert_approved(told(f"landmark,lat_deg,lon_deg,h_m,patch_px\na,1,2,3,\nb,1,2,3,{side}\n"))


@pytest.mark.parametrize("row", ["2,3,4", "2,3,4,5,6", "2,3,inf,5", "2.5,3,4,5"])
def test_a_row_of_cirn_is_a_number_and_a_place(row: str) -> None:
    """A file of which the first row is one, and the second not."""
    file = InputFile("gcp.txt", Path("nowhere"), f"1,2,3,4\n{row}\n", None, "EPSG:32633")
    with refused(VopdError):
        read_cirn(file)


def test_rows_of_cirn_may_have_blank_lines_between() -> None:
    rows = read("1.000000,9.5,8.5,7.5\n\n \n12.000000,1,2,3\n")
    assert rows.name == ["1", "12"] and [*rows.line] == [1, 4]
    assert rows.coordinate.tolist() == [[9.5, 8.5, 7.5], [1.0, 2.0, 3.0]]
    assert_approved(told("1.000000,9.5,8.5,7.5\n\n12.500000,1,2,3\n"))
