"""CZML and KML, read back by czml3 and fastkml, and value by value of frames worked by hand."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from czml3 import Document
from fastkml import KML
from fastkml.gx import Track
from fastkml.utils import find_all
from fastkml.validator import validate
from lxml import etree
from scipy.spatial.transform import Rotation

from tests.approved.texts import assert_approved
from tests.kit.attitude_files import (
    CASES_123,
    EPOCH,
    NAMES,
    VEHICLE,
    Array,
    apart_deg,
    body_axes,
    column,
    printed,
    write,
)
from tests.kit.command import DECKS, vopd
from tests.kit.estimates import ABOUT, HALF, REQUEST, estimate, level_flight, text_of
from tests.tolerances import assert_close
from vopd.attitude.history import history
from vopd.estimate import MapGrid
from vopd.export import FORMATS, FileRequest
from vopd.export.photogrammetry import COLUMNS
from vopd.findings import Finding
from vopd.pipeline import read_deck

ZERO = datetime(1974, 8, 27, 17, 30, tzinfo=UTC)
NAMESPACES = {"k": "http://www.opengis.net/kml/2.2", "gx": "http://www.google.com/kml/ext/2.2"}


def vehicle_km(name: str, folder: Path) -> Array:
    """The vehicle Earth-fixed by the formulas of docs/conventions.md, from the printed X, Y, Z."""
    trajectory = read_deck(folder / f"{name}.dat")[0].trajectory
    degrees = trajectory.origin_latitude_deg
    angles = np.radians([2 * degrees, 4 * degrees, 6 * degrees])
    shifts = np.array([-0.1932398611111, 0.0003258611111111, 7.2222222222e-07])
    latitude = np.radians(degrees + (shifts * np.sin(angles)).sum())
    longitude = np.radians(trajectory.origin_longitude_deg)
    up = np.array(
        [
            np.cos(latitude) * np.cos(longitude),
            np.cos(latitude) * np.sin(longitude),
            np.sin(latitude),
        ]
    )
    east = np.array([-np.sin(longitude), np.cos(longitude), 0.0])
    feet = column(printed(name), ["east", "north", "up"])
    origin = up * trajectory.origin_radius_kft * 1000.0 / 3280.8336
    return origin + feet * 0.0003048006 @ np.array([east, np.cross(up, east), up])


def local_axes(place: Array) -> Array:
    """North, east, down as rows (F, 3, 3) where down is toward the Earth's centre."""
    down = -place / np.linalg.norm(place, axis=1, keepdims=True)
    east = np.cross(down, [0.0, 0.0, 1.0])
    east /= np.linalg.norm(east, axis=1, keepdims=True)
    return np.stack([np.cross(east, down), east, down], axis=1)


def ellipsoid_km(longitude: Array, latitude: Array, height_m: Array) -> Array:
    a, f = 6378.388, 1 / 297  # that of the series of A 55, and so of the decks
    lon, lat = np.radians(longitude), np.radians(latitude)
    n = a / np.sqrt(1 - f * (2 - f) * np.sin(lat) ** 2)
    h = height_m / 1000.0
    across = (n + h) * np.cos(lat)
    return np.stack(
        [across * np.cos(lon), across * np.sin(lon), (n * (1 - f) ** 2 + h) * np.sin(lat)], axis=1
    )


def read_czml(path: Path) -> list[dict[str, Any]]:
    """The packets, once another project's model of CZML takes them; JSON has no NaN."""
    text = path.read_text()
    assert len(Document.model_validate_json(text).packets) == len(json.loads(text))

    def refuse(word: str) -> None:
        raise AssertionError(word)

    packets: list[dict[str, Any]] = json.loads(text, parse_constant=refuse)
    return packets


@pytest.mark.parametrize("name", NAMES)
def test_czml_places_and_turns_the_vehicle(name: str, tmp_path: Path) -> None:
    document, vehicle = read_czml(write(tmp_path, name, "a.czml", "--epoch", EPOCH))
    assert (document["id"], document["version"]) == ("document", "1.0")
    rows = printed(name)
    position = np.reshape(vehicle["position"]["cartographicDegrees"], (-1, 4))
    turn = np.reshape(vehicle["orientation"]["unitQuaternion"], (-1, 5))
    for sampled in (vehicle["position"], vehicle["orientation"]):
        assert datetime.fromisoformat(sampled["epoch"]) == ZERO
    times = column(rows, ["time_s"])[:, 0]
    assert_close("printed time", position[:, 0], times)
    assert (turn[:, 0] == position[:, 0]).all()
    ends = [datetime.fromisoformat(end) for end in vehicle["availability"].split("/")]
    flown = [(end - ZERO).total_seconds() for end in ends]
    assert_close("printed time", flown, [times[0], times[-1]])
    assert document["clock"]["interval"] == vehicle["availability"]

    there = vehicle_km(name, tmp_path)
    shown = ellipsoid_km(*position[:, 1:].T)
    directions = [v / np.linalg.norm(v, axis=1, keepdims=True) for v in (shown, there)]
    assert_close("direction by printed feet", *directions)
    axes = body_axes(column(rows, VEHICLE)) @ local_axes(there)
    shown_axes = np.moveaxis(Rotation.from_quat(turn[:, 1:]).as_matrix(), 1, 2)
    assert_close("axis by printed angles", shown_axes, axes)


def test_czml_of_case_4_by_hand(tmp_path: Path) -> None:
    """Frame 60: group 7 has H 120748.9 ft at -.697 s. Frame 55 is ignored and not there."""
    options = ("--epoch", EPOCH, "--object-name", "Viking <AV-4>")
    document, vehicle = read_czml(write(tmp_path, "case4", "a.czml", *options))
    time_s, _, _, height_m, *rest = vehicle["position"]["cartographicDegrees"]
    assert (time_s, height_m, len(rest)) == (-0.697, 36804.26472, 4)
    assert vehicle["availability"].startswith("1974-08-27T17:29:59.303000Z/")
    assert vehicle["name"] == vehicle["label"]["text"] == "Viking <AV-4>"
    assert "Viking &lt;AV-4&gt;" in vehicle["description"]
    assert {"path", "point", "label", "box"} <= set(vehicle)
    assert "Earth-fixed" in document["description"]


def test_czml_has_a_packet_a_job(tmp_path: Path) -> None:
    """Also of one deck given twice: the ids differ."""
    deck = str(CASES_123)
    path = tmp_path / "a.czml"
    result = vopd("attitude", deck, deck, "--epoch", EPOCH, "-o", str(path))
    assert result.status == 0
    document, *vehicles = read_czml(path)
    assert len({one["id"] for one in vehicles}) == 6
    times = [printed(f"case{k}")[0]["time_s"] for k in (1, 2, 3)]
    ends = [datetime.fromisoformat(end) for end in document["clock"]["interval"].split("/")]
    flown = [(end - ZERO).total_seconds() for end in ends]
    assert_close("printed time", flown, [min(times), max(times)])


@pytest.mark.parametrize("name", NAMES)
def test_kml_track(name: str, tmp_path: Path) -> None:
    path = write(tmp_path, name, "a.kml", "--epoch", EPOCH)
    assert validate(file_to_validate=path)
    (track,) = find_all(KML.parse(path), of_type=Track)
    rows = printed(name)
    items = track.track_items
    flown = [(item.when.dt - ZERO).total_seconds() for item in items]
    assert_close("printed time", flown, column(rows, ["time_s"])[:, 0])
    place = np.array([item.coord.coords[0] for item in items])
    shown = ellipsoid_km(*place.T)
    write(tmp_path, name, "b.czml", "--epoch", EPOCH)
    directions = [
        v / np.linalg.norm(v, axis=1, keepdims=True) for v in (shown, vehicle_km(name, tmp_path))
    ]
    assert_close("direction by printed feet", *directions)

    # A model's x is right, y forward, z up; all turns are clockwise seen from the axis' end:
    # roll about y first, then tilt about x, then heading about z.
    angles = -np.array([(i.angle.heading, i.angle.tilt, i.angle.roll) for i in items])
    turn = Rotation.from_euler("ZXY", angles, degrees=True).as_matrix()
    forward, right, down = turn[:, :, 1], turn[:, :, 0], -turn[:, :, 2]
    axes = np.stack([forward, right, down], axis=1)[..., [1, 0, 2]] * [1.0, 1.0, -1.0]
    assert_close("axis by printed angles", axes, body_axes(column(rows, VEHICLE)))


@pytest.mark.parametrize("name", NAMES)
def test_kml_path_and_frames(name: str, tmp_path: Path) -> None:
    path = write(tmp_path, name, "a.kml")
    assert validate(file_to_validate=path)
    tree = etree.parse(path)

    def texts(where: str) -> list[str]:
        return [element.text or "" for element in tree.iterfind(f".//{where}", NAMESPACES)]

    rows = printed(name)
    assert not texts("gx:Track") and not texts("k:when")
    lines = [text.split() for text in texts("k:LineString/k:coordinates")]
    assert [len(line) for line in lines] == ([len(rows)] if len(rows) > 1 else [])
    assert len(texts("k:Point/k:coordinates")) == len(rows)
    names = [f"k:Data[@name='{angle}']/k:value" for angle in VEHICLE]
    shown = np.array([[float(text) for text in texts(one)] for one in names]).T
    assert_close("printed angle", apart_deg(shown, column(rows, VEHICLE)), 0.0)
    assert texts("k:Data[@name='frame']/k:value") == [str(int(row["frame"])) for row in rows]


def test_path_and_vehicle_look_the_same_in_both() -> None:
    """Gold: red 255, green 196, blue 0. KML writes alpha, blue, green, red; the box is longest
    forward, and lowest downward."""
    dated = ["--epoch", EPOCH]
    ran = vopd("attitude", DECKS / "appendix_h/case4.dat", "--format", "kml", *dated)
    (colour,) = etree.fromstring(ran.output).findall(".//k:LineStyle/k:color", NAMESPACES)
    assert colour.text == "ff00c4ff"
    ran = vopd("attitude", DECKS / "appendix_h/case4.dat", "--format", "czml", *dated)
    vehicle = json.loads(ran.output)[1]
    for part in (vehicle["path"]["material"]["solidColor"], vehicle["point"]):
        assert part["color"]["rgba"] == [255, 196, 0, 255]
    assert vehicle["box"]["dimensions"]["cartesian"] == [300.0, 100.0, 30.0]


def test_kml_escapes_what_xml_would_take_for_itself(tmp_path: Path) -> None:
    path = write(tmp_path, "case4", "a.kml", "--object-name", "A & B <i>\x01")
    assert validate(file_to_validate=path)
    tree = etree.parse(path)
    assert tree.find("k:Document/k:name", NAMESPACES).text == "A & B <i>\\x01"
    description = tree.find("k:Document/k:description", NAMESPACES).text
    assert "<th>program</th><td>vopd " in description and "w &gt;= 0" in description


@pytest.mark.parametrize("epoch", [[], ["--epoch", EPOCH]], ids=["no dates", "dates"])
def test_kml_has_absolute_altitudes(epoch: list[str]) -> None:
    """The path or track, and the points of frames 60 and 65: none on the ground."""
    deck = DECKS / "appendix_h" / "case4.dat"
    text = vopd("attitude", deck, "-q", "--format", "kml", *epoch).output
    modes = etree.fromstring(text).findall(".//k:altitudeMode", NAMESPACES)
    assert [mode.text for mode in modes] == ["absolute"] * 3


# Every value of two frames

INTERVAL = "2026-05-01T09:00:10.000000Z/2026-05-01T09:00:12.500000Z"
GOLD = {"solidColor": {"color": {"rgba": [255, 196, 0, 255]}}}
SAMPLED = {
    "epoch": "2026-05-01T09:00:00.000000Z", "interpolationAlgorithm": "LINEAR",
    "interpolationDegree": 1,
}  # fmt: skip


def test_a_czml() -> None:
    """Turns by hand: 120 degrees about 1, -1, 1, and then 180 about 0, -1, 1."""
    text, said = text_of("czml")
    document, vehicle = json.loads(text)
    assert text.startswith('[\n{"id": "document"') and text.endswith("}\n]\n") and said == []
    about = document.pop("description")
    assert document == {
        "id": "document", "name": "The Kite", "version": "1.0",
        "clock": {
            "interval": INTERVAL, "currentTime": "2026-05-01T09:00:10.000000Z", "multiplier": 1,
            "range": "LOOP_STOP", "step": "SYSTEM_CLOCK_MULTIPLIER",
        },
    }  # fmt: skip
    assert vehicle.pop("description") == "<p>hand.toml, job 1: The Kite</p>" + about
    s = np.sqrt(0.5)
    turns = vehicle["orientation"].pop("unitQuaternion")
    assert_close("unit rotation", turns, [10.0, 0.5, -0.5, 0.5, 0.5, 12.5, 0.0, -s, s, 0.0])
    assert vehicle == {
        "id": "vehicle-1", "name": "The Kite", "availability": INTERVAL,
        "position": SAMPLED
        | {"cartographicDegrees": [10.0, 90.0, 0.0, 100.0, 12.5, 90.0, 0.0, 200.0]},
        "orientation": SAMPLED,
        "path": {"width": 2, "material": GOLD},
        "point": {"pixelSize": 6, "color": {"rgba": [255, 196, 0, 255]}},
        "label": {
            "text": "The Kite", "font": "14px sans-serif",
            "fillColor": {"rgba": [255, 255, 255, 255]}, "horizontalOrigin": "LEFT",
            "pixelOffset": {"cartesian2": [12, 0]},
        },
        "box": {"dimensions": {"cartesian": [300.0, 100.0, 30.0]}, "material": GOLD},
    }  # fmt: skip


def test_a_czml_of_several_jobs() -> None:
    """The clock goes from the first start to the last stop; a job without a name has its title."""
    titled = level_flight(2, 10.0, about=ABOUT._replace(job=2, title="<b> & so on"))
    request = replace(REQUEST, object_name=" ")
    text, _ = text_of("czml", level_flight(1, 50.0), titled, request=request)
    document, first, second = json.loads(text)
    start, stop = "2026-05-01T09:00:10.000000Z", "2026-05-01T09:00:52.500000Z"
    assert document["clock"]["interval"] == f"{start}/{stop}"
    assert document["clock"]["currentTime"] == start and document["name"] == "a flight by hand"
    assert (first["id"], second["id"]) == ("vehicle-1", "vehicle-2")
    assert second["name"] == second["label"]["text"] == "<b> & so on"
    assert second["description"].startswith("<p>hand.toml, job 2: &lt;b&gt; &amp; so on</p><table>")


def leaves(one: ET.Element, path: str = "") -> Iterator[tuple[str, str]]:
    """The path of every element that has a text, and the text."""
    name = one.tag.rpartition("}")[2] + "".join(f"[{value}]" for value in one.attrib.values())
    if not len(one):
        yield f"{path}/{name}", one.text or ""
    for inner in one:
        yield from leaves(inner, f"{path}/{name}")


SHOWN = {
    "frame": "DJI_0001.JPG", "status": "solved", "time_s": "12.500000",
    "camera_yaw_deg": "90.000000", "camera_pitch_deg": "-90.000000",
    "camera_roll_deg": "0.000000", "vehicle_yaw_deg": "90.000000",
    "vehicle_pitch_deg": "0.000000", "vehicle_roll_deg": "0.000000", "alpha_deg": "1.000000",
    "beta_deg": "2.000000", "eta_deg": "3.000000", "airspeed_m_s": "30.0000",
    "altitude_m": "200.0000", "quaternion_w": HALF, "quaternion_x": "0.0000000000",
    "quaternion_y": "0.0000000000", "quaternion_z": HALF, "landmarks": "4",
    "residual_rms_px": "0.00000000", "flags": None, "sigma_vehicle_yaw_deg": None,
    "sigma_vehicle_pitch_deg": None, "sigma_vehicle_roll_deg": None,
}  # fmt: skip
"""What a placemark shows of the second frame; None: another test holds it."""
WHEN = ("2026-05-01T09:00:10.000000Z", "2026-05-01T09:00:12.500000Z")
STYLES = [
    ("Style[path]/LineStyle/color", "ff00c4ff"), ("Style[path]/LineStyle/width", "2"),
    ("Style[frame]/IconStyle/scale", "0.4"), ("Style[frame]/LabelStyle/scale", "0"),
]  # fmt: skip
TRACK = [
    ("name", "attitude"), ("styleUrl", "#path"), ("Track/altitudeMode", "absolute"),
    ("Track/when", WHEN[0]), ("Track/when", WHEN[1]),
    ("Track/coord", "90.00000000 0.00000000 100.000"),
    ("Track/coord", "90.00000000 0.00000000 200.000"),
    ("Track/angles", "0.000000 0.000000 0.000000"),
    ("Track/angles", "90.000000 0.000000 0.000000"),
]  # fmt: skip
LINE = [
    ("name", "path"), ("styleUrl", "#path"), ("LineString/altitudeMode", "absolute"),
    ("LineString/coordinates", "90.00000000,0.00000000,100.000 90.00000000,0.00000000,200.000"),
]  # fmt: skip


@pytest.mark.parametrize("dated", [True, False])
def test_a_kml(dated: bool) -> None:
    """With an epoch a track with times, without one a line; and a placemark a frame."""
    text, said = text_of("kml", request=REQUEST if dated else replace(REQUEST, epoch=None))
    root = ET.fromstring(text)
    assert said == [] and text.endswith("</kml>\n")
    assert root.tag == "{http://www.opengis.net/kml/2.2}kml"
    assert "http://www.google.com/kml/ext/2.2" in text.splitlines()[1]
    for element, level in (("Document", 1), ("Style", 2), ("Folder", 2), ("Placemark", 3),
                           ("Placemark", 4), ("ExtendedData", 5), ("Point", 5)):  # fmt: skip
        assert f"\n{level * '  '}<{element}" in text
    found = [(path.removeprefix("/kml/Document/"), value) for path, value in leaves(root)]
    assert found[0] == ("name", "The Kite") and found[1][0] == "description"
    assert found[2:6] == STYLES
    folder = found[6:]
    assert folder[0] == ("Folder/name", "hand.toml, job 1: a flight by hand")
    path = TRACK if dated else LINE
    expected = [(f"Folder/Placemark/{name}", value) for name, value in path]
    assert folder[1 : 1 + len(path)] == expected
    frames = folder[1 + len(path) :]
    assert frames[0] == ("Folder/Folder/name", "frames") and len(frames) % 2 == 1
    second = frames[1 + len(frames) // 2 :]
    shown = [
        ("name", "DJI_0001.JPG"), *([("TimeStamp/when", WHEN[1])] if dated else []),
        ("styleUrl", "#frame"),
        *((f"ExtendedData/Data[{name}]/value", value) for name, value in SHOWN.items()),
        ("Point/altitudeMode", "absolute"),
        ("Point/coordinates", "90.00000000,0.00000000,200.000"),
    ]  # fmt: skip
    assert len(second) == len(shown)
    for (place, value), (name, wanted) in zip(second, shown, strict=True):
        assert place == f"Folder/Folder/Placemark/{name}"
        assert wanted is None or value == wanted
    first = {place.rpartition("Placemark/")[2]: value for place, value in frames[1 : -len(second)]}
    assert first["name"] == first["ExtendedData/Data[frame]/value"] == "DJI_0000.JPG"
    assert first["ExtendedData/Data[altitude_m]/value"] == "100.0000"
    assert first["Point/coordinates"] == "90.00000000,0.00000000,100.000"


@pytest.mark.parametrize("form", ["kml", "czml"])
@pytest.mark.parametrize(("off_m", "told"), [(0.5, False), (30.0, True)])
def test_positions_that_are_not_the_source_s_own_are_told(
    form: str, off_m: float, told: bool
) -> None:
    """Of each job by itself."""
    here = replace(level_flight().estimate.position, to_own_m=np.array([[0.0, 0.1], [off_m, 0.0]]))
    _, said = text_of(form, level_flight(1, 50.0), level_flight(2, position=here))
    assert [one.startswith("hand.toml: job 2: in this file ") for one in said] == [True] * told
    assert all("30" in one for one in said)


def test_placemarks_in_another_order_show_their_own_frames() -> None:
    """The second frame comes 2.5 s before the first."""
    text, _ = text_of("kml", level_flight(time_s=np.array([12.5, 10.0])))
    rows = [*leaves(ET.fromstring(text))]
    ends = ("[frame]/value", "[time_s]/value", "[altitude_m]/value", "Point/coordinates")
    assert [value for place, value in rows if place.endswith(ends)] == [
        "DJI_0001.JPG", "10.000000", "200.0000", "90.00000000,0.00000000,200.000",
        "DJI_0000.JPG", "12.500000", "100.0000", "90.00000000,0.00000000,100.000",
    ]  # fmt: skip


def test_a_control_character_of_an_image_s_name_is_written_out() -> None:
    """As in other formats: XML cannot hold it, and no reader took the file."""
    text, _ = text_of("kml", level_flight(frame_names=["a\x01.jpg", "b.jpg"]))
    assert "a\\x01.jpg" in {value for _, value in leaves(ET.fromstring(text))}


def test_what_viewers_are_told_of_turns() -> None:
    (document, _), kml = json.loads(text_of("czml")[0]), text_of("kml")[0]
    assert (
        "unitQuaternion x y z w, scalar last: rotating a vector&#x27;s components in the vehicle "
        "body by it gives its Earth-fixed components (WGS 84); neighbours have signs that make "
        "them near"
    ) in document["description"]
    assert (
        "heading, tilt, roll: vehicle yaw, minus pitch, minus roll, degrees, against the frame "
        "named above; a viewer takes them against the ellipsoid&amp;#x27;s normal, which differs "
        "by up to 0.2 from the direction to the Earth&amp;#x27;s centre"
    ) in kml


# Columns and ranges


def text_of_ranges(form: str, **changes: object) -> str:
    angles = [[0.5, -60.0, 20.0], [359.5, -30.0, 0.0], [180.0, 45.0, 200.0]]
    one = history(estimate(angles, **changes))
    return FORMATS[form].render([one], FileRequest()).decode()


GRID = MapGrid(
    "EPSG:32632",
    np.array([380100.5, 380177.25, 380253.0]),
    np.array([5201000.0, 5201001.5, 5201003.0]),
    np.array([1.5, -1.25, 200.0]),
)


def test_columns_of_angles_against_the_grid() -> None:
    """Grid azimuth 0.5 - 1.5 is 359; 359.5 + 1.25 is 0.75; 180 - 200 is 340."""
    lines = text_of_ranges("opk", grid=GRID).splitlines()
    assert "# x, y: easting and northing, EPSG:32632; h_m: metres above the ellipsoid" in lines[5]
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    assert [row["image"] for row in rows] == [f"DJI_{k:04}.JPG" for k in range(3)]
    for name, expected in {
        "x": GRID.easting, "y": GRID.northing, "h_m": [1200.0] * 3,
        "azimuth_true_deg": [0.5, 359.5, 180.0], "azimuth_grid_deg": [359.0, 0.75, 340.0],
        "convergence_deg": GRID.convergence_deg, "latitude_deg": [46.95] * 3,
        "longitude_deg": [7.44, 7.441, 7.442],
    }.items():  # fmt: skip
        assert_close("ratio", [float(row[name]) for row in rows], expected)
    straight = replace(GRID, convergence_deg=np.array([0.5 + 1e-9, -0.5 - 1e-9, -1e-9]))
    _, *rows = csv.reader(text_of_ranges("opk", grid=straight).splitlines()[8:])
    at = COLUMNS.index("azimuth_grid_deg")
    assert [row[at] for row in rows] == ["0.000000", "0.000000", "180.000000"]
    assert rows[2][at + 1] == "0.000000"
    counted = replace(GRID, crs="EPSG:2048", counted="westing and southing")
    assert "# x, y: westing and southing, EPSG:2048;" in text_of_ranges("opk", grid=counted)


def test_columns_of_angles_without_a_grid() -> None:
    lines = text_of_ranges("opk").splitlines()
    assert_approved(lines[5])
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    for row in rows:
        assert (row["x"], row["y"]) == (row["longitude_deg"], row["latitude_deg"])
        assert row["azimuth_true_deg"] == row["azimuth_grid_deg"]
        assert row["convergence_deg"] == "0.000000"


@pytest.mark.parametrize(
    ("vehicle", "shown"),
    [
        ((0.0, 0.0, 0.0), "0.000000 0.000000 0.000000"),
        ((350.0, 30.0, 170.0), "350.000000 -30.000000 -170.000000"),
        ((10.0, -30.0, 190.0), "10.000000 30.000000 170.000000"),
        ((10.0, -95.0, 350.0), "10.000000 95.000000 10.000000"),
        ((10.0, 0.0, 180.0), "10.000000 0.000000 -180.000000"),
        ((359.9999999, 0.0, 0.0), "0.000000 0.000000 0.000000"),
    ],
)
def test_kml_turns_are_heading_tilt_and_roll_of_a_half_circle(
    vehicle: tuple[float, float, float], shown: str
) -> None:
    """Tilt and roll turn the other way than pitch and roll, from -180 to 180 degrees."""
    one = history(estimate([[10.0, -60.0, 20.0]], vehicle_deg=np.array([vehicle])))
    request = FileRequest(epoch=datetime(2026, 5, 1, tzinfo=UTC))
    text = FORMATS["kml"].render([one], request).decode()
    assert re.findall("<gx:angles>(.*?)</gx:angles>", text) == [shown]


@pytest.mark.parametrize("blank", [" ", "\t", "\u00a0", "\n"])
def test_a_name_that_geo_txt_would_take_for_two_is_left_out(blank: str) -> None:
    names = ("a.jpg", f"b{blank}c.jpg", "d.jpg")
    angles = [[0.5, -60.0, 20.0], [359.5, -30.0, 0.0], [180.0, 45.0, 200.0]]
    said: list[Finding] = []
    one = history(estimate(angles, frame_names=names))
    text = FORMATS["odm"].render([one], FileRequest(), said.append).decode()
    rows = [line.split()[0] for line in text.splitlines()[1:] if not line.startswith("#")]
    assert rows == ["a.jpg", "d.jpg"]
    assert (said[0].source, said[0].severity) == ("hand.toml", "warning")
    assert_approved(said[0].message)
