"""Every value of a CZML and a KML file of two frames, whose attitudes are worked out by hand."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from tests.kit.estimates import ABOUT, HALF, REQUEST, level_flight, text_of
from tests.tolerances import assert_close

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
