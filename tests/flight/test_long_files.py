"""Files of every format: longer than what is read of one at once, cut off, and empty of numbers."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.flight_project import text_told
from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.flight.formats.by_content import InputFormat, read_by_content
from vopd.flight.formats.files import TEXT_AT_ONCE, open_input
from vopd.flight.formats.image_lenses import IMAGE_LENS_FORMATS
from vopd.flight.formats.landmarks import LANDMARK_FORMATS
from vopd.flight.formats.lens import LENS_FORMATS, LensQuestion
from vopd.flight.formats.picks import PICK_FORMATS
from vopd.flight.formats.track import TRACK_FORMATS
from vopd.flight.formats.tracked import COLUMNS, HEAD, read_tracked
from vopd.flight.formats.wind import WIND_FORMATS

ROWS = 2000
EVERY = range(ROWS)
NO_TEXT = {
    "a folder of images", "a video with GoPro's GPMF", "MATLAB file of CIRN's clicks",
    "MATLAB file of Caltech or CIRN",
}  # fmt: skip
XML = '<?xml version="1.0"?>\n'
FORMATS: dict[str, tuple[InputFormat[Any], ...]] = {
    "track": TRACK_FORMATS, "landmarks": LANDMARK_FORMATS, "picks": PICK_FORMATS,
    "wind": WIND_FORMATS, "lenses": IMAGE_LENS_FORMATS, "lens": LENS_FORMATS,
}  # fmt: skip


def north(k: int) -> float:
    """The latitude of a row; its longitude is 8 and its height 500 m."""
    return round(40.0 + 0.001 * k, 3)


def spread(values: Any) -> str:
    """Write JSON of a line a value; `indent` takes twenty times as long."""
    return json.dumps(values).replace(", ", ",\n")


def each(text: Callable[[int], str]) -> str:
    return "".join(text(k) for k in EVERY)


def second(k: int) -> str:
    return f"{k // 3600:02d}:{k // 60 % 60:02d}:{k % 60:02d}"


def geojson(properties: Callable[[int], dict[str, Any]]) -> str:
    features = [
        {
            "type": "Feature",
            "properties": properties(k),
            "geometry": {"type": "Point", "coordinates": [8.0, north(k), 500.0]},
        }
        for k in EVERY
    ]
    return spread({"type": "FeatureCollection", "features": features})


def control() -> str:
    """Points with a place and a pick each."""
    points = [
        {
            "id": f"P{k}",
            "position": {"latitude": north(k), "longitude": 8.0, "altitude": 500.0},
            "observations": [{"shot_id": f"{k}.jpg", "projection": [0.001 * k, 0.25]}],
        }
        for k in EVERY
    ]
    return spread({"points": points})


def markers() -> str:
    """Markers with a place and a pick each."""
    return (
        f"{XML}<document><chunk><cameras>"
        + each(lambda k: f'<camera id="{k}" label="{k}.jpg"/>\n')
        + "</cameras><markers>"
        + each(
            lambda k: (
                f'<marker id="{k}" label="P{k}"><reference x="8" y="{north(k)}" z="500"/>'
                "</marker>\n"
            )
        )
        + "</markers><frames><frame><markers>"
        + each(
            lambda k: (
                f'<marker marker_id="{k}"><location camera_id="{k}" pinned="true" x="{k}" '
                'y="0.25"/></marker>\n'
            )
        )
        + "</markers></frame></frames></chunk></document>\n"
    )


def reconstruction() -> str:
    """Shots on the ellipsoid's normal of the reference, a metre higher each."""
    shots = {
        f"{k}.jpg": {"camera": f"c{k % 2}", "rotation": [0, 0, 0], "translation": [0, 0, -k]}
        for k in EVERY
    }
    reference = {"latitude": 40.0, "longitude": 8.0, "altitude": 500.0}
    cameras = {f"c{k}": {} for k in range(2)}
    one = {"reference_lla": reference, "cameras": cameras, "shots": shots}
    return spread([one])


def gcp_list() -> str:
    return "EPSG:4326\n" + each(lambda k: f"8.0 {north(k)} 500.0 {k} 0.25 {k}.jpg P{k}\n")


MARK = "{k}\t{k}.5\t[2300]\t0,N\t0,E\t0,V\t{lat},Lat\t8.0,Lon\t500.0,Ellh\t1.0, 1.0, 1.0\t50,Q\n"
BY_LATITUDE = {
    ("track", "GPX"): '<gpx version="1.1" creator="x"><trk><trkseg>\n'
    + each(
        lambda k: (
            f'<trkpt lat="{north(k)}" lon="8"><ele>500</ele>'
            f"<time>2026-05-01T{second(k)}Z</time></trkpt>\n"
        )
    )
    + "</trkseg></trk></gpx>\n",
    ("track", "ODM geo.txt"): "EPSG:4326\n" + each(lambda k: f"{k}.jpg 8.0 {north(k)} 500.0\n"),
    ("track", "CSV (t_s or t_utc or image, lat_deg,lon_deg,h_m or x_m,y_m,z_m)"): (
        "t_s,lat_deg,lon_deg,h_m\n" + each(lambda k: f"{k},{north(k)},8.0,500.0\n")
    ),
    ("track", "MRK of a drone"): each(lambda k: MARK.format(k=k, lat=north(k))),
    (
        "track",
        "RTKLIB .pos",
    ): "%  GPST  latitude(deg) longitude(deg) height(m) Q sdn(m) sde(m) sdu(m)\n"
    + each(lambda k: f"2026/05/01 {second(k)}.000 {north(k)} 8.0 500.0 1 0.01 0.02 0.03\n"),
    ("track", "ODM shots.geojson"): geojson(
        lambda k: {"filename": f"{k}.jpg", "rotation": [0, 0, 0]}
    ),
    ("track", "SRT of a DJI drone"): each(
        lambda k: (
            f"{k + 1}\n{second(k)},000 --> {second(k)},500\n[latitude: {north(k)}] "
            "[longitude: 8.0] [abs_alt: 500.0]\n\n"
        )
    ),
    ("landmarks", "GPX waypoints"): '<gpx version="1.1" creator="x">\n'
    + each(lambda k: f'<wpt lat="{north(k)}" lon="8"><ele>500</ele><name>P{k}</name></wpt>\n')
    + "</gpx>\n",
    ("landmarks", "KML placemarks"): (
        f'{XML}<kml xmlns="http://www.opengis.net/kml/2.2"><Document>\n'
        + each(
            lambda k: (
                f"<Placemark><name>P{k}</name><Point><coordinates>8.0,{north(k)},500.0"
                "</coordinates></Point></Placemark>\n"
            )
        )
        + "</Document></kml>\n"
    ),
    ("landmarks", "GeoJSON"): geojson(lambda k: {"name": f"P{k}"}),
    ("landmarks", "gcp_list.txt"): gcp_list(),
    ("landmarks", "OpenSfM ground_control_points.json"): control(),
    ("landmarks", "Metashape XML of markers"): markers(),
    ("landmarks", "CIRN's list (number,x,y,z)"): each(
        lambda k: f"{k}.000000,8.000000,{north(k):.6f},500.000000\n"
    ),
    ("landmarks", "CSV (landmark,lat_deg,lon_deg,h_m or landmark,x_m,y_m,z_m)"): (
        "landmark,lat_deg,lon_deg,h_m\n" + each(lambda k: f"P{k},{north(k)},8.0,500.0\n")
    ),
}
"""Rows whose second coordinate is `north`."""
BY_PIXEL = {
    ("picks", "CVAT XML"): f"{XML}<annotations>\n"
    + each(
        lambda k: (
            f'<image id="{k}" name="{k}.jpg" width="9000" height="9000">'
            f'<points label="P{k}" points="{k},0.25"/></image>\n'
        )
    )
    + "</annotations>\n",
    ("picks", "LabelMe JSON or a folder of it"): spread(
        {
            "imagePath": "0.jpg", "imageWidth": 9000, "imageHeight": 9000,
            "flags": [*EVERY, *EVERY],
            "shapes": [
                {"label": f"P{k}", "shape_type": "point", "points": [[k, 0.25]]} for k in EVERY
            ],
        }
    ),
    ("picks", "gcp_list.txt"): gcp_list(),
    ("picks", "OpenSfM ground_control_points.json"): control(),
    ("picks", "Metashape XML of markers"): markers(),
    ("picks", "CSV (frame,landmark,u_px,v_px)"): (
        "image,landmark,u_px,v_px\n" + each(lambda k: f"{k}.jpg,P{k},{k},0.25\n")
    ),
}  # fmt: skip
"""Rows whose u is their number, and v .25."""
WYOMING = (
    "   PRES   HGHT   TEMP   DWPT   RELH   MIXR   DRCT   SKNT   THTA   THTE   THTV\n"
    "    hPa     m      C      C      %    g/kg    deg   knot     K      K      K\n"
    "-----------------------------------------------------------------------------\n"
)
WINDS = {
    ("wind", "Wyoming CSV"): "time,geopotential height_m,wind direction_degree,wind speed_m/s\n"
    + each(lambda k: f"x,{10 * k},270,{0.01 * k}\n"),
    ("wind", "Wyoming text list"): f"{WYOMING}"
    + each(
        lambda k: (
            f"  850.0 {10 * k:6d}    5.0   -2.0     60   3.90    270 {k % 50:6d}  291.0  303.0"
            "  291.7\n"
        )
    ),
    ("wind", "CSV (h_m,from_deg,speed_m_s)"): "h_m,from_deg,speed_m_s\n"
    + each(lambda k: f"{10 * k},270,{0.01 * k}\n"),
}
"""Levels every 10 m."""
OF_IMAGES = {
    ("lenses", "OpenSfM reconstruction.json"): reconstruction(),
    ("lenses", "a CSV with image (or frame) and lens (or camera)"): "image,camera\n"
    + each(lambda k: f"{k}.jpg,c{k % 2}\n"),
}
"""The lens of each image, the first and the second in turn."""
PINHOLE = [1000, 0, 44.5, 0, 900, 34.5, 0, 0, 1]
NUMBERS = [90, 70, 45.5, 35.5, 1000, 900, 0, 0, 0, 0, 0]  # from (1, 1)
LENSES = {
    ("lens", "mrcal"): each(lambda k: f"# line {k} of the notes\n")
    + "{'lensmodel': 'LENSMODEL_PINHOLE',\n'intrinsics': [1000, 900, 44.5, 34.5],\n"
    "'imagersize': [90, 70]}\n",
    ("lens", "Metashape XML"): f"{XML}<calibration><projection>frame</projection>\n"
    + each(lambda k: f"<!-- line {k} of the notes -->\n")
    + "<width>90</width><height>70</height><f>900</f><b1>100</b1></calibration>\n",
    ("lens", "OpenSfM or ODM cameras.json"): spread(
        {
            f"c{k}": {
                "width": 90, "height": 70, "projection_type": "brown", "focal_x": 100 / 9,
                "focal_y": 10 + (k != ROWS - 1),
            }
            for k in EVERY
        }
    ),
    ("lens", "JSON of CIRN's intrinsics"): spread(
        {"intrinsics": NUMBERS, "notes": [*EVERY] * 4}
    ),
    ("lens", "OpenCV yml, xml or json"): "%YAML:1.0\n---\n"
    + each(lambda k: f"# line {k} of the notes\n")
    + "image_width: 90\nimage_height: 70\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n"
    f"   dt: d\n   data: {PINHOLE}\ndistortion_coefficients: !!opencv-matrix\n"
    "   rows: 1\n   cols: 4\n   dt: d\n   data: [0., 0., 0., 0.]\n",
    ("lens", "Kalibr camchain.yaml"): each(lambda k: f"# line {k} of the notes\n")
    + "cam0:\n  camera_model: pinhole\n  distortion_model: radtan\n"
    "  distortion_coeffs: [0, 0, 0, 0]\n  intrinsics: [1000, 900, 44.5, 34.5]\n"
    "  resolution: [90, 70]\n",
    ("lens", "COLMAP cameras.txt"): each(lambda k: f"{k} PINHOLE 90 70 999 999 45 35\n")
    + f"{ROWS} PINHOLE 90 70 1000 900 45 35\n",
}  # fmt: skip
"""A pinhole of 1000 and 900 px; of several cameras the last."""
LAST = {"OpenSfM or ODM cameras.json": f"c{ROWS - 1}", "COLMAP cameras.txt": str(ROWS)}
OPENCV = {
    "xml": f"{XML}<opencv_storage>\n"
    + each(lambda k: f"<!-- line {k} of the notes -->\n")
    + "<image_width>90</image_width><image_height>70</image_height>\n"
    '<camera_matrix type_id="opencv-matrix"><rows>3</rows><cols>3</cols><dt>d</dt>\n'
    f"<data>{' '.join(map(str, PINHOLE))}</data></camera_matrix>\n"
    '<distortion_coefficients type_id="opencv-matrix"><rows>1</rows><cols>4</cols><dt>d</dt>\n'
    "<data>0. 0. 0. 0.</data></distortion_coefficients></opencv_storage>\n",
    "json": spread(
        {
            "notes": [*EVERY] * 4, "image_width": 90, "image_height": 70,
            "camera_matrix": {"rows": 3, "cols": 3, "dt": "d", "data": PINHOLE},
            "distortion_coefficients": {"rows": 1, "cols": 4, "dt": "d", "data": [0, 0, 0, 0]},
        }
    ),
}  # fmt: skip


def read(folder: Path, text: str, key: tuple[str, str], *more: Any) -> Any:
    """Read a long file by the format that recognises it, which is the one that is meant."""
    assert len(text) > TEXT_AT_ONCE + 1000 and text.count("\n") > 1000
    (folder / "long").write_text(text, encoding="utf-8")
    file = open_input("long", folder)
    kind, name = key
    first = next(one for one in FORMATS[kind] if one.recognises(file))
    assert first.name == name
    return first.read(file, *more)


def test_every_format_has_a_long_file() -> None:
    every = {(kind, one.name) for kind, formats in FORMATS.items() for one in formats}
    shots = {("track", "OpenSfM reconstruction.json")}
    given = {*BY_LATITUDE, *BY_PIXEL, *WINDS, *OF_IMAGES, *LENSES, *shots}
    assert {key for key in every if key[1] not in NO_TEXT} == given


@pytest.mark.parametrize("key", BY_LATITUDE, ids=" of ".join)
def test_all_places_of_a_long_file_are_read(key: tuple[str, str], tmp_path: Path) -> None:
    rows = read(tmp_path, BY_LATITUDE[key], key)
    expected = [[8.0, north(k), 500.0] for k in EVERY]
    assert_close("place or time as a file has it", rows.coordinate, expected)
    if key[0] == "landmarks":
        begin = "" if "CIRN" in key[1] else "P"
        assert rows.name == [f"{begin}{k}" for k in EVERY]


def test_all_shots_of_a_long_reconstruction_are_read(tmp_path: Path) -> None:
    rows = read(tmp_path, reconstruction(), ("track", "OpenSfM reconstruction.json"))
    assert rows.image == [f"{k}.jpg" for k in EVERY]
    assert_close("moved position", rows.coordinate[:, 2], 500.0 + np.arange(ROWS))


@pytest.mark.parametrize("key", BY_PIXEL, ids=" of ".join)
def test_all_picks_of_a_long_file_are_read(key: tuple[str, str], tmp_path: Path) -> None:
    rows = read(tmp_path, BY_PIXEL[key], key)
    scale = 0.001 if rows.by_size else 1.0
    expected = [[scale * k, 0.25] for k in EVERY]
    assert_close("place or time as a file has it", rows.pixel, expected)
    assert [*rows.landmark] == [f"P{k}" for k in EVERY]


@pytest.mark.parametrize("key", WINDS, ids=" of ".join)
def test_all_levels_of_a_long_sounding_are_read(key: tuple[str, str], tmp_path: Path) -> None:
    rows = read(tmp_path, WINDS[key], key)
    assert len(rows.height_m) == ROWS
    knots = 1852.0 / 3600.0 * (np.arange(ROWS) % 50)
    expected = knots if "text" in key[1] else 0.01 * np.arange(ROWS)
    assert_close("ratio", rows.toward_m_s[:, 1], expected)


@pytest.mark.parametrize("key", OF_IMAGES, ids=" of ".join)
def test_all_lenses_of_images_of_a_long_file_are_read(key: tuple[str, str], tmp_path: Path) -> None:
    rows = read(tmp_path, OF_IMAGES[key], key)
    assert rows.image == [f"{k}.jpg" for k in EVERY]
    assert rows.camera == [f"c{k % 2}" for k in EVERY]


@pytest.mark.parametrize("key", LENSES, ids=" of ".join)
def test_the_lens_at_the_end_of_a_long_file_is_read(key: tuple[str, str], tmp_path: Path) -> None:
    found = read(tmp_path, LENSES[key], key, LensQuestion(camera=LAST.get(key[1]), model="brown"))
    assert_close("ratio", found.lens.focal_px, [1000.0, 900.0])
    assert found.lens.size_px == (90, 70)


@pytest.mark.parametrize("text", OPENCV.values(), ids=list(OPENCV))
def test_long_files_of_opencv_are_read(text: str, tmp_path: Path) -> None:
    found = read(tmp_path, text, ("lens", "OpenCV yml, xml or json"), LensQuestion(model="brown"))
    assert found.lens.focal_px.tolist() == [1000.0, 900.0]


def test_all_rows_of_a_long_tracked_file_are_read(tmp_path: Path) -> None:
    first = "0,mast,100.5,200.25,0.5,0,1,0,0,1,1,clicked\n"
    others = each(lambda k: f"{k + 1},mast,{k},201.25,0.08,0,1,0,0,1,0.95,tracked\n")
    text = "\n".join([HEAD, ",".join(COLUMNS), first + others])
    (tmp_path / "tracked.csv").write_text(text)
    assert len(text) > TEXT_AT_ONCE
    rows = read_tracked(open_input("tracked.csv", tmp_path))
    assert rows.pixel[1:, 0].tolist() == [*EVERY] and rows.frame.tolist() == [*range(ROWS + 1)]


# Files that end before their end, and files that have nothing of what they are for

CUT = {
    **BY_LATITUDE, **BY_PIXEL, **OF_IMAGES, **LENSES,
    ("track", "OpenSfM reconstruction.json"): reconstruction(),
}  # fmt: skip


@pytest.mark.parametrize(
    "key", [key for key, text in CUT.items() if text.lstrip()[0] in "<[{"], ids=" of ".join
)
def test_json_and_xml_that_are_cut_off_are_refused(key: tuple[str, str], tmp_path: Path) -> None:
    text = CUT[key][: -len(CUT[key]) // 10]
    words = f"not valid {'GPX' if 'GPX' in key[1] else 'XML' if text[0] == '<' else 'JSON'}:"
    if "LabelMe" in key[1]:
        words = "not a LabelMe file:"
    more = [LensQuestion()] if key[0] == "lens" else []
    with refused(VopdError, others_after=words):
        read(tmp_path, text, key, *more)


def kml(height: str, latitude: str = "47") -> str:
    """A placemark, by its height and latitude."""
    place = f"<Point><coordinates>8,{latitude},{height}</coordinates></Point>"
    return f"<kml><Placemark><name>a</name>{place}</Placemark></kml>"


def subtitle(latitude: str, height: str = "3.0") -> str:
    place = f"[latitude: {latitude}] [longitude: 15.1] [abs_alt: {height}]"
    return f"1\n00:00:00,000 --> 00:00:01,000\n{place}\n\n"


MATRIX_OF_101 = json.dumps({"camera_matrix": {"data": [1.0] * 101}, "image_width": 90})


@pytest.mark.parametrize(
    ("kind", "text"),
    [
        ("landmarks", "<gpx></gpx>"), ("landmarks", "<kml></kml>"),
        ("landmarks", '{"points": [], "observations": []}'),
        ("landmarks", '<document><marker label=""/></document>'),
        ("landmarks", kml("5", "95")), ("landmarks", kml("inf")), ("landmarks", kml("x")),
        ("lens", "1 PINHOLES 90 70 9 8 4 3\n"), ("lens", MATRIX_OF_101),
        ("track", subtitle("95.5")), ("track", subtitle("47.5", "9" * 400)),
        ("track", subtitle("47.5") + subtitle("-95.5")), ("track", subtitle("4.7.5")),
        ("track", '{"type": "FeatureCollection", "features": [], "filename": 0, "rotation": 0}'),
    ],
)  # fmt: skip
def test_files_without_a_number_that_they_are_for_are_refused(kind: str, text: str) -> None:
    more = [LensQuestion(size_px=(90, 70), model="brown")] if kind == "lens" else []
    assert_approved(text_told(FORMATS[kind], "file", text, *more))


def test_a_point_of_labelme_without_a_label_is_refused(tmp_path: Path) -> None:
    shape = {"label": "", "shape_type": "point", "points": [[1, 2]]}
    image = {"imagePath": "0.jpg", "imageWidth": 9, "imageHeight": 9, "shapes": [shape]}
    (tmp_path / "a.json").write_text(json.dumps(image))
    with refused(VopdError):
        read_by_content(PICK_FORMATS, open_input("a.json", tmp_path))
