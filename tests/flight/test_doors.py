"""Files of other programs: OpenSfM, ODM, Metashape, MATLAB of Caltech and CIRN."""

from __future__ import annotations

import json
import re
import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat

from tests.approved.texts import assert_approved, refused
from tests.kit.flight_project import read_text, text_told
from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.flight.formats.by_content import read_by_content
from vopd.flight.formats.files import open_input
from vopd.flight.formats.image_lenses import IMAGE_LENS_FORMATS
from vopd.flight.formats.landmarks import LANDMARK_FORMATS
from vopd.flight.formats.lens import LENS_FORMATS, LensQuestion, LensRead, make_lens
from vopd.flight.formats.matlab import read_variables
from vopd.flight.formats.picks import PICK_FORMATS
from vopd.flight.formats.track import TRACK_FORMATS
from vopd.flight.project.camera import CameraLens
from vopd.flight.project.keys import Project, Section
from vopd.flight.project.read import read_pick_rows
from vopd.geometry.earth import earth_centred_m, local_axes

PLACE = {"latitude": 48.0, "longitude": 15.0, "altitude": 300.0}
CONTROL = {
    "points": [
        {
            "id": "1",
            "position": PLACE,
            "observations": [{"shot_id": "a", "projection": [0.1, -0.2]}],
        },
        {"id": "2", "position": PLACE | {"latitude": 48.5}, "observations": []},
    ]
}
SHOTS = [
    {
        "cameras": {},
        "reference_lla": PLACE,
        "shots": {
            "a.jpg": {
                "camera": "x",
                "rotation": [0.0, 0.0, np.pi / 2],
                "translation": [1.0, 2.0, 3.0],
            },
            "b.jpg": {"camera": "y", "rotation": [0.0, 0.0, 0.0], "translation": [0.0, 0.0, 0.0]},
        },
    }
]


def feature(name: str, *place: float) -> dict[str, Any]:
    keys = {"filename": name, "camera": "x", "translation": [1, 2, 3], "rotation": [0, 0, 0]}
    return {
        "type": "Feature",
        "properties": keys,
        "geometry": {"type": "Point", "coordinates": place},
    }


SHOTS_GEOJSON = {"type": "FeatureCollection", "features": [feature("a.jpg", 15.0, 48.0, 300.0)]}
MARKERS = """<document version="1.2.0"><chunk><cameras><camera id="4" label="A.JPG"/></cameras>
<markers><marker id="0" label="church"><reference x="512345.5" y="5312345.25" z="310.5"/></marker>
<marker id="3" label="mast"/></markers>
<frames><frame id="0"><markers>
<marker marker_id="0"><location camera_id="4" pinned="true" x="100.5" y="50.25"/></marker>
<marker marker_id="3"><location camera_id="4" pinned="true" x="10.5" y="5.5"/></marker>
<marker marker_id="3"><location camera_id="4" pinned="false" x="1" y="2"/></marker>
</markers></frame></frames>
<reference>PROJCS["x",GEOGCS["y",AUTHORITY["EPSG","4326"]],AUTHORITY["EPSG","32633"]]</reference>
</chunk></document>"""


FRAME = MARKERS[MARKERS.index("<frame id") : MARKERS.index("</frames>")]
KML = """<kml xmlns="http://www.opengis.net/kml/2.2"><Placemark><name>A</name><Point>
<altitudeMode>%s</altitudeMode><coordinates>15,48,300</coordinates></Point></Placemark></kml>"""


def test_ground_control_of_opensfm(tmp_path: Path) -> None:
    """By the longer side from the middle: .1 of 64 px right of 31.5, .2 above 23.5."""
    text = json.dumps(CONTROL)
    marks = read_text(LANDMARK_FORMATS, "m", text)
    assert (marks.name, marks.geodetic) == (["1", "2"], True)
    assert marks.coordinate.tolist() == [[15.0, 48.0, 300.0], [15.0, 48.5, 300.0]]
    (tmp_path / "p").write_text(text)
    project = Project("p.toml", tmp_path, {"picks": Section("p.toml", "picks", {"file": "p"})})
    lens = make_lens("brown", (64, 48), (50.0, 50.0), (31.5, 23.5))
    rows = read_pick_rows(project, CameraLens(LensRead(lens, "")))
    assert ([*rows.frame], [*rows.landmark], rows.grid) == (["a"], ["1"], "centre")
    assert_close("ratio", rows.pixel, [[31.5 + 6.4, 23.5 - 12.8]])


def test_places_of_opensfm_and_odm() -> None:
    """-R't: a quarter turn about z brings (1, 2, 3) to (2, -1, 3), and so (-2, 1, -3)."""
    text = json.dumps(SHOTS)
    track = read_text(TRACK_FORMATS, "t", text)
    origin = earth_centred_m(48.0, 15.0, 300.0)
    longitude, latitude, height = track.coordinate.T
    away = (earth_centred_m(latitude, longitude, height) - origin) @ local_axes(origin).T
    assert_close("place of a solve", away, [[-2.0, 1.0, -3.0], [0.0, 0.0, 0.0]])
    assert track.image == ["a.jpg", "b.jpg"] and track.time_s is None
    lenses = read_text(IMAGE_LENS_FORMATS, "r.json", text)
    assert (lenses.image, lenses.file, lenses.camera) == (track.image, ["r.json"] * 2, ["x", "y"])
    shots = read_text(TRACK_FORMATS, "t", json.dumps(SHOTS_GEOJSON))
    assert (shots.image, shots.coordinate.tolist()) == (["a.jpg"], [[15.0, 48.0, 300.0]])
    crs = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32633"}}
    plane = SHOTS_GEOJSON | {"crs": crs, "features": [feature("a.jpg", 5e5, 5.3e6, 300.0)]}
    shots = read_text(TRACK_FORMATS, "t", json.dumps(plane))
    assert (shots.crs, shots.geodetic) == ("EPSG:32633", False)


@pytest.mark.parametrize("wrong", [np.nan, True, "4_8", 360.1, 10**400])
@pytest.mark.parametrize("key", PLACE)
def test_a_reference_that_is_no_place_is_refused(wrong: object, key: str) -> None:
    """NaN was images without a position, true was 1 m, and 360 degrees of latitude were taken."""
    if (key, wrong) != ("altitude", 360.1):
        text = json.dumps([SHOTS[0] | {"reference_lla": PLACE | {key: wrong}}])
        assert "reference_lla: " in text_told(TRACK_FORMATS, "t", text)


@pytest.mark.parametrize("projection", [[0.1], [0.1, 0, 2], "12", [True, 0.1]])
def test_a_projection_is_two_numbers(projection: object) -> None:
    """A decimal comma makes one number of two."""
    seen = [{"shot_id": "a", "projection": projection}]
    text = json.dumps({"points": [CONTROL["points"][0] | {"observations": seen}]})
    assert_approved(text_told(PICK_FORMATS, "p", text))


def test_ground_control_in_pixels_is_refused() -> None:
    """All picks were in no image, and the message asked for a second landmark in each."""
    text = json.dumps(CONTROL).replace("0.1, ", "320.5, ")
    assert "320.5" in text
    with refused(VopdError):
        read_text(PICK_FORMATS, "m", text)


def test_markers_of_two_coordinate_systems_are_refused() -> None:
    """All were taken for those of the first."""
    other = '<reference>PROJCS["x",AUTHORITY["EPSG","32632"]]</reference>'
    text = MARKERS.replace("</document>", f"<chunk>{other}</chunk></document>")
    with refused(VopdError):
        read_text(LANDMARK_FORMATS, "m", text)


def test_markers_of_metashape() -> None:
    marks, picks = (read_text(one, "m", MARKERS) for one in (LANDMARK_FORMATS, PICK_FORMATS))
    assert (marks.name, marks.crs, marks.geodetic) == (["church"], "EPSG:32633", False)
    assert marks.coordinate.tolist() == [[512345.5, 5312345.25, 310.5]]
    assert ([*picks.frame], [*picks.landmark], picks.grid) == (
        ["A.JPG"] * 2,
        ["church", "mast"],
        "corner",
    )
    assert picks.pixel.tolist() == [[100.5, 50.25], [10.5, 5.5]]
    only = read_text(PICK_FORMATS, "m", MARKERS.replace('pinned="false"', 'pinned="true"'))
    assert_approved([picks.said, only.said])


@pytest.mark.parametrize("no", ["false", "0"])
def test_markers_of_metashape_that_are_switched_off_are_left_out(no: str) -> None:
    """A marker that is no reference, or lacks a coordinate; a projection that is not valid."""
    more = f"""<marker id="5" label="post"><reference x="1" y="2" z="3" enabled="{no}"/></marker>
<marker id="6" label="edge"><reference x="1" y="2"/></marker>
<marker id="7" label="well"><reference x="4" y="5" z="6" enabled="true"/></marker>
"""
    marks = read_text(LANDMARK_FORMATS, "m", MARKERS.replace("<marker id", f"{more}<marker id", 1))
    assert (marks.name, marks.coordinate[0].tolist()) == (["well", "church"], [4.0, 5.0, 6.0])
    for key in ("valid", "pinned"):
        wrong = MARKERS.replace('pinned="true" x="100.5"', f'{key}="{no}" x="100.5"')
        assert [*read_text(PICK_FORMATS, "m", wrong).landmark] == ["mast"]


def test_files_of_cirn_and_caltech(tmp_path: Path) -> None:
    """d3 is third in CIRN's intrinsics and fifth in Caltech's kc; cc from (1, 1) and (0, 0)."""
    calib = {"fc": [9.0, 8.0], "cc": [5.0, 4.0], "kc": [0.1, 0.2, 0.3, 0.4, 0.5], "nx": 11, "ny": 9}
    savemat(tmp_path / "c.mat", calib | {"alpha_c": 0.5})
    savemat(tmp_path / "i.mat", {"intrinsics": [11, 9, 5, 4, 9, 8, 0.1, 0.2, 0.5, 0.3, 0.4]})
    (tmp_path / "i.json").write_text('{"intrinsics": [11, 9, 5, 4, 9, 8, 0.1, 0.2, 0.5, 0.3, 0.4]}')
    for name, centre, skew in (
        ("c.mat", [5.0, 4.0], 4.5), ("i.mat", [4.0, 3.0], 0.0), ("i.json", [4.0, 3.0], 0.0),
    ):  # fmt: skip
        lens = read_by_content(LENS_FORMATS, open_input(name, tmp_path), LensQuestion()).lens
        assert (lens.size_px, lens.focal_px.tolist()) == ((11, 9), [9.0, 8.0])
        assert lens.skew_px == skew  # alpha_c times the first focal length
        assert lens.centre_px.tolist() == centre and lens.k[:5].tolist() == [
            0.1,
            0.2,
            0.3,
            0.4,
            0.5,
        ]
    clicks = [{"UVd": [5.5, 6.5], "num": 1.0, "imagePath": ".\\x\\a.tif"},
              {"UVd": [7.5, 8.5], "num": 2.0, "imagePath": ".\\x\\a.tif"}]  # fmt: skip
    savemat(tmp_path / "g.mat", {"gcp": clicks})
    picks = read_by_content(PICK_FORMATS, open_input("g.mat", tmp_path))
    assert ([*picks.frame], [*picks.landmark], picks.grid) == (
        ["a.tif"] * 2,
        ["1", "2"],
        "one-based",
    )
    assert picks.pixel.tolist() == [[5.5, 6.5], [7.5, 8.5]]
    marks = read_text(LANDMARK_FORMATS, "m", "1.000000,902062.638,274683.639,7.432\n2.000000,1,2,3")
    assert marks.name == ["1", "2"] and marks.coordinate[1].tolist() == [1.0, 2.0, 3.0]


@pytest.mark.parametrize(
    ("formats", "text"),
    [
        (LANDMARK_FORMATS, json.dumps(CONTROL).replace('"altitude"', '"height"')),
        (PICK_FORMATS, '{"points": [{"id": "1", "observations": []}]}'),
        (TRACK_FORMATS, json.dumps(SHOTS).replace("reference_lla", "reference")),
        (TRACK_FORMATS, json.dumps(SHOTS).replace("[0.0, 0.0, 0.0]", "[0.0]")),
        (TRACK_FORMATS, json.dumps(SHOTS_GEOJSON).replace("300.0", "null")),
        (LANDMARK_FORMATS, MARKERS.replace("<reference x", "<place x")),
        (PICK_FORMATS, MARKERS.replace('"true"', '"false"')),
        (PICK_FORMATS, MARKERS.replace('id="4"', 'id="5"', 1)),
        (PICK_FORMATS, MARKERS.replace('label="mast"', 'label="church"')),
        (LANDMARK_FORMATS, "1.000000,2,3,4\n2.5,3,4,5\n"),
        (LANDMARK_FORMATS, json.dumps(CONTROL).replace('"latitude"', '"lat"')),
        (LANDMARK_FORMATS, json.dumps(CONTROL).replace('"longitude"', '"lon"')),
        (LANDMARK_FORMATS, KML % "relativeToGround"),
        (LANDMARK_FORMATS, KML % "relativeToSeaFloor"),
        (TRACK_FORMATS, json.dumps([SHOTS[0] | {"shots": {}}])),
        (TRACK_FORMATS, '[{"shots": []}]'),
        (TRACK_FORMATS, json.dumps(SHOTS_GEOJSON).replace("48.0", "148.0")),
        (LANDMARK_FORMATS, MARKERS.replace("512345.5", "1e999")),
        (LANDMARK_FORMATS, MARKERS.replace("label", "name")),
        (LANDMARK_FORMATS, re.sub('"latitude": [0-9.]+', '"latitude": true', json.dumps(CONTROL))),
        (PICK_FORMATS, MARKERS.replace("</cameras>", '<camera id="4" label="B.JPG"/></cameras>')),
        (PICK_FORMATS, re.sub(r'tion": \[[^]]*', 'tion": [true, 0.1', json.dumps(CONTROL))),
        (PICK_FORMATS, re.sub(r'tion": \[[^]]*', 'tion": [1, 2, 3', json.dumps(CONTROL))),
        (PICK_FORMATS, MARKERS.replace("<frames>", f"<frames>{FRAME}")),
    ],
)  # fmt: skip
def test_files_that_are_refused(formats: Any, text: str) -> None:
    with refused(VopdError):
        read_text(formats, "file", text)


INTRINSICS = [11, 9, 5, 4, 9, 8, 0.1, 0.2, 0.5, 0.3, 0.4]


@pytest.mark.parametrize(
    "intrinsics", [["11", *INTRINSICS[1:]], INTRINSICS[:-1], "none"], ids=["text", "ten", "word"]
)
def test_intrinsics_that_are_refused(intrinsics: Any) -> None:
    with refused(VopdError):
        read_text(LENS_FORMATS, "i.json", json.dumps({"intrinsics": intrinsics}), LensQuestion())


@pytest.mark.parametrize("kind", ["i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8"])
def test_numbers_of_every_type_of_matlab(kind: str, tmp_path: Path) -> None:
    """As MATLAB itself stores numbers: in the smallest type that holds them."""
    values = np.array([[1, 2, 3], [100, 5, 7]], kind)
    savemat(tmp_path / "a.mat", {"x": values})
    found = read_variables((tmp_path / "a.mat").read_bytes(), ["x"])["x"]
    assert found.dtype == np.float64 and found.tolist() == values.tolist()


def test_files_of_matlab_that_are_refused(tmp_path: Path) -> None:
    savemat(tmp_path / "a.mat", {"other": 1})
    (tmp_path / "b.mat").write_bytes(b"MATLAB 5.0 MAT-file")
    (tmp_path / "c.mat").write_bytes(
        b"MATLAB 7.3 MAT-file, Platform".ljust(124) + b"\0\2IM" + b"\0" * 64
    )
    for name in "abc":
        with refused(VopdError):
            read_by_content(PICK_FORMATS, open_input(f"{name}.mat", tmp_path))
    with refused(VopdError):
        read_by_content(LENS_FORMATS, open_input("a.mat", tmp_path), LensQuestion())
    savemat(tmp_path / "d.mat", {"fc": [9, 8, 7], "cc": [5, 4], "kc": [0] * 5, "nx": 9, "ny": 9})
    with refused(VopdError):
        read_by_content(LENS_FORMATS, open_input("d.mat", tmp_path), LensQuestion())


def element(kind: int, content: bytes) -> bytes:
    """An element of a file of MATLAB's: its type, its size, and its bytes to whole eights."""
    return struct.pack("<2I", kind, len(content)) + content + b"\0" * (-len(content) % 8)


def variable(kind: int, shape: tuple[int, ...], *parts: bytes) -> bytes:
    """A variable x of a class of arrays, in which these parts are."""
    size = struct.pack(f"<{len(shape)}i", *shape)
    head = element(6, struct.pack("<2I", kind, 0)), element(5, size), element(1, b"x")
    return element(14, b"".join([*head, *parts]))


def cells(depth: int) -> bytes:
    """Cells that stand in each other."""
    return variable(1, (1, 1), *([cells(depth - 1)] if depth else [NUMBER]))


HEAD = b"MATLAB 5.0 MAT-file".ljust(124) + b"\0\1IM"
NUMBER = variable(6, (1, 1), element(9, struct.pack("<d", 7.0)))
DAMAGED = {
    "cut short": element(15, zlib.compress(b"four")),
    "longer": struct.pack("<2I", 14, 9),
    "complex": variable(0x806, (1, 1), element(9, struct.pack("<d", 7.0))),
    "deep": cells(20),
    "size below 0": variable(6, (-1, -1), element(9, struct.pack("<d", 7.0))),
    "two numbers": variable(6, (1, 2), element(9, struct.pack("<d", 7.0))),
    "object": variable(3, (1, 1), NUMBER),
    "two cells": variable(1, (1, 2), NUMBER),
    "cell of a text": variable(1, (1, 1), element(16, b"7")),
    "many": element(1, b"") * 20_001,
}


@pytest.mark.parametrize("name", DAMAGED)
def test_damaged_variables_of_matlab(name: str) -> None:
    with refused(ValueError):
        read_variables(HEAD + DAMAGED[name], ["x"])


@pytest.mark.parametrize(
    ("content", "found"),
    [
        (element(14, b""), []),
        (variable(4, (1, 2), element(4, "h\u00fc".encode("utf-16-le"))), "h\u00fc"),
        (variable(4, (1, 2), element(16, "\u00fc".encode())), "\u00fc"),
    ],
    ids=["empty", "text of codes", "text in UTF-8"],
)
def test_cells_of_matlab_that_are_empty_or_texts(content: bytes, found: object) -> None:
    """An older MATLAB writes the codes of letters, and an empty cell has no parts at all."""
    (cell,) = read_variables(HEAD + variable(1, (1, 1), content), ["x"])["x"]
    assert (cell if isinstance(cell, str) else cell.tolist()) == found


def test_cells_of_matlab_stand_in_each_other_twenty_deep() -> None:
    found = read_variables(HEAD + cells(19), ["x"])["x"]
    for _ in range(20):
        (found,) = found
    assert found == 7.0
