"""CZML and KML, read back by czml3 and fastkml and held to geometry worked out apart."""

from __future__ import annotations

import json
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from czml3 import Document
from fastkml import KML
from fastkml.gx import Track
from fastkml.utils import find_all
from fastkml.validator import validate
from lxml import etree
from scipy.spatial.transform import Rotation

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
from tests.tolerances import assert_close
from vopd.cards.read import read_deck

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
