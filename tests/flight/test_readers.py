"""Each reader on a small file of its format, and on what it must refuse."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.flight.formats.by_content import read_by_content
from vopd.flight.formats.files import open_input
from vopd.flight.formats.landmarks import LANDMARK_FORMATS, LandmarkRows
from vopd.flight.formats.lens import LENS_FORMATS, LensQuestion, LensRead
from vopd.flight.formats.picks import PICK_FORMATS, PickRows
from vopd.flight.formats.track import TRACK_FORMATS, TrackRows
from vopd.flight.formats.wind import WIND_FORMATS, WindRows
from vopd.geometry.lenses import LensKind, project

K5 = [-0.1, 0.02, 1e-3, -2e-3, 3e-3]
MATRIX = np.array([[1500.0, 0, 959.5], [0, 1490.0, 539.5], [0, 0, 1]])
RAY = np.random.default_rng(3).uniform([-0.5, -0.3, 1], [0.5, 0.3, 1], (50, 3))


def lens(folder: Path, text: str, question: LensQuestion | None = None) -> LensRead:
    (folder / "lens").write_text(text)
    file = open_input("lens", folder)
    return read_by_content(LENS_FORMATS, file, question or LensQuestion())


def opencv(k: list[float]) -> np.ndarray:
    return cv2.projectPoints(RAY, np.zeros(3), np.zeros(3), MATRIX, np.array(k))[0][:, 0]


@pytest.mark.parametrize("suffix", ["yml", "xml", "json"])
@pytest.mark.parametrize("count", [4, 5, 8, 12])
def test_a_lens_that_opencv_wrote(tmp_path: Path, suffix: str, count: int) -> None:
    k = [*K5, 0.01, 2e-3, 1e-4, 5e-4, 1e-4, -3e-4, 2e-4][:count]
    path = tmp_path / f"written.{suffix}"
    out = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    out.write("image_width", 1920)
    out.write("image_height", 1080)
    out.write("camera_matrix", MATRIX)
    out.write("distortion_coefficients", np.array([k]))
    out.release()
    found = lens(tmp_path, path.read_text(), LensQuestion(model="brown"))
    assert found.lens.size_px == (1920, 1080)
    assert_close("flight pixel", project(found.lens, RAY).pixel, opencv(k))
    assert found.said == f"lens: OpenCV, brown, {count} coefficients, centre grid"


ROS = """\
image_width: 1920
image_height: 1080
camera_matrix: {rows: 3, cols: 3, data: [1500, 0, 959.5, 0, 1490, 539.5, 0, 0, 1]}
distortion_model: %s
distortion_coefficients: {rows: 1, cols: %d, data: %s}
"""
COLMAP = "# Camera list\n1 %s 1920 1080 %s\n"
OPENSFM = """{"v2 cam": {"projection_type": "brown", "width": 1920, "height": 1080,
 "focal_x": 0.78125, "focal_y": 0.7760416666666666, "c_x": 0, "c_y": 0, "k3": 3e-3,
 "k1": -0.1, "k2": 0.02, "p1": 1e-3, "p2": -2e-3}}"""
METASHAPE = """<?xml version="1.0"?><calibration><projection>frame</projection>
<width>1920</width><height>1080</height><f>1490</f><b1>10</b1><k1>-0.1</k1><k2>0.02</k2>
<k3>3e-3</k3><p1>-2e-3</p1><p2>1e-3</p2></calibration>"""
MRCAL = """{ 'lensmodel': 'LENSMODEL_OPENCV5', # a comment
 'intrinsics': [1500.0, 1490.0, 959.5, 539.5, -0.1, 0.02, 1e-3, -2e-3, 3e-3,],
 'imagersize': [1920, 1080], }"""
SAME = {  # one lens, as every format has it
    "ROS": ROS % ("plumb_bob", 5, K5),
    "COLMAP": COLMAP % ("FULL_OPENCV", "1500 1490 960 540 -0.1 0.02 1e-3 -2e-3 3e-3 0 0 0"),
    "OpenSfM": OPENSFM,
    "Metashape": METASHAPE,
    "mrcal": MRCAL,
}


@pytest.mark.parametrize("name", list(SAME))
def test_one_lens_in_every_format(tmp_path: Path, name: str) -> None:
    found = lens(tmp_path, SAME[name])
    assert found.lens.size_px == (1920, 1080)
    assert ("OpenCV" if name == "ROS" else name) in found.said
    assert_close("flight pixel", project(found.lens, RAY).pixel, opencv(K5))


def test_skew_of_metashape(tmp_path: Path) -> None:
    found = lens(tmp_path, METASHAPE.replace("<b1>", "<b2>2.5</b2><b1>"))
    plain = lens(tmp_path, METASHAPE)
    by_skew = project(found.lens, RAY).pixel - project(plain.lens, RAY).pixel
    yd = (opencv(K5)[:, 1] - 539.5) / 1490.0
    assert_close("flight pixel", by_skew, np.stack([2.5 * yd, 0.0 * yd], axis=1))


def test_fisheyes(tmp_path: Path) -> None:
    k = [0.03, 0.01, -0.02, 0.004]
    texts = [
        ROS % ("equidistant", 4, k),
        COLMAP % ("OPENCV_FISHEYE", "1500 1490 960 540 0.03 0.01 -0.02 0.004"),
        OPENSFM.replace('"brown"', '"fisheye_opencv"').replace("-0.1", "0.03")
        .replace("0.02", "0.01").replace('1e-3, "p2": -2e-3', '0, "p2": 0')
        .replace("3e-3", '-0.02, "k4": 0.004'),
    ]  # fmt: skip
    expected, _ = cv2.fisheye.projectPoints(
        RAY[:, None], np.zeros(3), np.zeros(3), MATRIX, np.array(k)
    )
    for text in texts:
        found = lens(tmp_path, text)
        assert found.lens.kind is LensKind.FISHEYE
        assert_close("flight pixel", project(found.lens, RAY).pixel, expected[:, 0])


REFUSED_LENSES = {
    "four": ROS.replace("distortion_model: %s\n", "") % (4, K5[:4]),
    "six": ROS.replace("distortion_model: %s\n", "") % (6, [0.0] * 6),
    "omni": ROS % ("omni", 4, K5[:4]),
    "colmap model": COLMAP % ("FOV", "1 2 3 4 5"),
    "colmap count": COLMAP % ("PINHOLE", "1 2 3"),
    "two": COLMAP % ("PINHOLE", "1500 1500 960 540") + "2 PINHOLE 9 9 5 5 4 4\n",
    "spherical": OPENSFM.replace("brown", "spherical"),
    "k4": METASHAPE.replace("<b1>", "<k4>1</k4><b1>"),
    "absolute": METASHAPE.replace("<b1>", "<cx>960</cx><b1>"),
    "splined": MRCAL.replace("OPENCV5", "CAHVOR"),
    "not finite": MRCAL.replace("1500.0", "1e999"),
    "millimetres": MRCAL.replace("1500.0", "0.035"),
    "other": "hello",
}


@pytest.mark.parametrize("case", list(REFUSED_LENSES))
def test_lenses_that_are_refused(tmp_path: Path, case: str) -> None:
    text = REFUSED_LENSES[case]
    with pytest.raises(VopdError) as told:
        lens(tmp_path, text)
    assert str(told.value).startswith("lens: ")
    assert_approved(str(told.value))


def picks(folder: Path, text: str) -> PickRows:
    (folder / "picks").write_text(text)
    return read_by_content(PICK_FORMATS, open_input("picks", folder))


GCP = """\
EPSG:4326
# a comment
16.47592\t47.64350\t463.662\t2501.0\t2452.5\tA.JPG\tone extra
16.47619 47.64346 461.732 100.0 200.0 A.JPG two
16.47592 47.64350 463.662 7.0 8.0 B.JPG one
"""


def test_picks_of_a_gcp_list(tmp_path: Path) -> None:
    rows = picks(tmp_path, GCP)
    assert list(rows.frame) == ["A.JPG", "A.JPG", "B.JPG"]
    assert list(rows.landmark) == ["one", "two", "one"]
    assert rows.pixel.tolist() == [[2501.0, 2452.5], [100.0, 200.0], [7.0, 8.0]]
    assert rows.grid == "centre"


CVAT_IMAGES = """<?xml version="1.0"?><annotations><version>1.1</version>
<image id="0" name="a.png" width="1920" height="1080">
<points label="mast" points="10.5,20.5"/><points label="well" points="30,40;31,41"/></image>
</annotations>"""
CVAT_VIDEO = """<annotations><meta><task><original_size><width>1920</width><height>1080</height>
</original_size></task></meta><track id="0" label="mast">
<points frame="3" outside="0" keyframe="1" points="10.5,20.5"/>
<points frame="4" outside="1" keyframe="1" points="99,99"/></track></annotations>"""
LABELME = """{"shapes": [{"label": "mast", "points": [[10.5, 20.5]], "shape_type": "point"},
{"label": "roof", "points": [[1, 1], [2, 2]], "shape_type": "rectangle"}],
"imagePath": "..\\\\a.png", "imageHeight": 1080, "imageWidth": 1920}"""


def test_picks_of_annotation_tools(tmp_path: Path) -> None:
    images, video, label = (picks(tmp_path, t) for t in (CVAT_IMAGES, CVAT_VIDEO, LABELME))
    assert list(images.frame) == ["a.png"] * 3
    assert list(images.landmark) == ["mast", "well", "well"]
    assert images.pixel.tolist() == [[10.5, 20.5], [30.0, 40.0], [31.0, 41.0]]
    assert (list(video.frame), list(video.landmark)) == ([3], ["mast"])
    assert (list(label.frame), list(label.landmark)) == (["a.png"], ["mast"])
    for rows in (images, video, label):
        assert (rows.grid, rows.size_px) == ("corner", (1920, 1080))


def test_a_folder_of_labelme_files(tmp_path: Path) -> None:
    (tmp_path / "labels").mkdir()
    for name in ("a", "b"):
        (tmp_path / "labels" / f"{name}.json").write_text(LABELME.replace("a.png", f"{name}.png"))
    rows = read_by_content(PICK_FORMATS, open_input("labels", tmp_path))
    assert list(rows.frame) == ["a.png", "b.png"]


@pytest.mark.parametrize(
    "text",
    [
        GCP.replace("7.0 8.0 B.JPG one", "7.0"),
        GCP.replace("461.732", "nan"),
        CVAT_IMAGES.replace("points=", "p="),
        CVAT_IMAGES[:-8],
        LABELME.replace('"point"', '"line"'),
        LABELME[:-3],
    ],
)
def test_picks_that_are_refused(tmp_path: Path, text: str) -> None:
    with refused(VopdError):
        picks(tmp_path, text)


def landmarks(folder: Path, text: str) -> LandmarkRows:
    (folder / "marks").write_text(text)
    return read_by_content(LANDMARK_FORMATS, open_input("marks", folder))


GEOJSON = """{"type": "FeatureCollection", "features": [{"type": "Feature",
"geometry": {"type": "Point", "coordinates": [-75.4, 37.8, 12.0]}, "properties": {"name": "A"}}]}"""


def test_landmarks(tmp_path: Path) -> None:
    rows = landmarks(tmp_path, GCP)
    assert (rows.name, rows.crs, rows.geodetic) == (["one", "two"], "EPSG:4326", False)
    assert rows.coordinate[1].tolist() == [16.47619, 47.64346, 461.732]
    rows = landmarks(tmp_path, GEOJSON)
    assert (rows.name, rows.coordinate.tolist()) == (["A"], [[-75.4, 37.8, 12.0]])
    rows = landmarks(tmp_path, "\ufefflandmark;h_m;lon_deg;lat_deg;sigma_m\nA;1;2;3;.5\nB;4;5;6;\n")
    assert rows.coordinate.tolist() == [[2.0, 3.0, 1.0], [5.0, 6.0, 4.0]]
    assert rows.sigma_m[0].tolist() == [0.5] * 3 and np.isnan(rows.sigma_m[1]).all()


@pytest.mark.parametrize(
    "text",
    [
        GCP.replace("16.47592 47.64350", "16.5 47.6"),
        GEOJSON.replace(", 12.0", ""),
        GEOJSON.replace("-75.4, 37.8", "37.8, -175.4"),
        GEOJSON.replace('"name"', '"x"'),
        "landmark,lat_deg,lon_deg\nA,1,2\n",
    ],
)
def test_landmarks_that_are_refused(tmp_path: Path, text: str) -> None:
    with refused(VopdError):
        landmarks(tmp_path, text)


def track(folder: Path, text: str) -> TrackRows:
    (folder / "track").write_text(text)
    return read_by_content(TRACK_FORMATS, open_input("track", folder))


GPX = """<?xml version="1.0"?><gpx version="1.1" creator="x"
xmlns="http://www.topografix.com/GPX/1/1"><trk><trkseg>
<trkpt lat="47.5" lon="16.4"><ele>500</ele><time>2026-05-01T12:00:00Z</time></trkpt>
<trkpt lat="47.6" lon="16.5"><ele>501</ele><time>2026-05-01T12:00:01.5Z</time></trkpt>
</trkseg></trk></gpx>"""


def test_tracks(tmp_path: Path) -> None:
    rows = track(tmp_path, GPX)
    assert rows.coordinate.tolist() == [[16.4, 47.5, 500.0], [16.5, 47.6, 501.0]]
    assert rows.time_s is not None and rows.clock == "utc"
    assert rows.time_s.tolist() == [1777636800.0, 1777636801.5]
    rows = track(tmp_path, "EPSG:32633\nA.JPG 600000 5277000 500 nan nan nan\n")
    assert (rows.image, rows.crs, rows.time_s) == (["A.JPG"], "EPSG:32633", None)
    rows = track(tmp_path, "image,t_s,x_m,y_m,z_m,sigma_m\na.jpg,1,2,3,4,.5\n")
    assert (rows.image, rows.clock) == (["a.jpg"], "seconds")
    assert rows.sigma_m is not None and rows.sigma_m.tolist() == [[0.5, 0.5, 0.5]]
    rows = track(tmp_path, "t_s,x_m,y_m,z_m,vn_m_s,ve_m_s,vd_m_s\n1,2,3,4,5,6,7\n")
    assert rows.velocity_m_s is not None and rows.velocity_m_s.tolist() == [[5.0, 6.0, 7.0]]


@pytest.mark.parametrize(
    "text",
    [
        GPX.replace("<ele>501</ele>", ""),
        GPX[:-9],
        GPX.replace("<ele>501</ele>", "<ele>nan</ele>"),
        GPX.replace('lat="47.6"', 'lat="147.6"'),
        "EPSG:32633\nA.JPG 1 2\n",
        "t_utc,lat_deg,lon_deg,h_m\n2026-05-01T12:00:00,1,2,3\n",
    ],
)
def test_tracks_that_are_refused(tmp_path: Path, text: str) -> None:
    with refused(VopdError):
        track(tmp_path, text)


def wind(folder: Path, text: str) -> WindRows:
    (folder / "wind").write_text(text)
    return read_by_content(WIND_FORMATS, open_input("wind", folder))


LIST = """\
72402 WAL Wallops Island Observations at 12Z 01 May 2026
-----------------------------------------------------------------------------
   PRES   HGHT   TEMP   DWPT   RELH   MIXR   DRCT   SKNT   THTA   THTE   THTV
    hPa     m      C      C      %    g/kg    deg   knot     K      K      K
-----------------------------------------------------------------------------
 1000.0    100
  850.0   1500    5.0   -2.0     60   3.90     90     20  291.0  303.0  291.7
  700.0   3000   -5.0  -12.0     58   2.10    180     40  297.0  303.9  297.4
Station information and sounding indices
"""


def test_winds(tmp_path: Path) -> None:
    knot = 1852.0 / 3600.0
    rows = wind(tmp_path, LIST)
    # from the east: toward the west; from the south: toward the north; geopotential metres
    assert_close("flight speed", rows.toward_m_s, [[0.0, -20.0 * knot], [40.0 * knot, 0.0]])
    assert_close("flight height", rows.height_m, [1500.35, 3001.42])
    text = (
        "time,geopotential height_m,wind direction_degree,wind speed_m/s\nx,1500,90,10\n,3000,,\n"
    )
    text += "x,5000,180,20\n"
    rows = wind(tmp_path, text)
    assert_close("flight speed", rows.toward_m_s, [[0.0, -10.0], [20.0, 0.0]])
    rows = wind(tmp_path, "h_m,from_deg,speed_kt\n1000,0,10\n0,270,10\n")
    assert_close("flight speed", rows.toward_m_s, [[0.0, 10.0 * knot], [-10.0 * knot, 0.0]])
    assert rows.height_m.tolist() == [0.0, 1000.0]
    with refused(VopdError):
        wind(tmp_path, "h_m,from_deg,speed_kt\n1000,0,10\n")
    for row in ("0,270,-1", "0,361,1"):
        with refused(VopdError):
            wind(tmp_path, f"h_m,from_deg,speed_kt\n{row}\n1000,0,10\n")
    with refused(VopdError):
        wind(tmp_path, text.replace("m/s", "knot"))


def test_a_package_that_is_not_there_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "gpxpy", None)
    with refused(VopdError):
        track(tmp_path, GPX)


SIGMAS = {
    "picks.csv": "frame,landmark,u_px,v_px,sigma_px\n0,mast,1,2,\n0,well,1,2,{}\n",
    "landmarks.csv": "landmark,x_m,y_m,z_m,sigma_m\nmast,1,2,3,\nwell,1,2,3,{}\n",
    "track.csv": "t_s,x_m,y_m,z_m,sigma_m\n0,1,2,3,\n1,1,2,3,{}\n",
}


@pytest.mark.parametrize(
    "sigma",
    [
        "-0.5",
        "0",
        "nan",
        "inf",
        "small",
    ],
)
@pytest.mark.parametrize("name", SIGMAS)
def test_a_sigma_that_is_none_is_refused(tmp_path: Path, name: str, sigma: str) -> None:
    formats = {"p": PICK_FORMATS, "l": LANDMARK_FORMATS, "t": TRACK_FORMATS}[name[0]]
    (tmp_path / name).write_text(SIGMAS[name].format(sigma))
    column = "sigma_px" if name == "picks.csv" else "sigma_m"
    with refused(VopdError, parts=[name, column]):
        read_by_content(formats, open_input(name, tmp_path))
    (tmp_path / name).write_text(SIGMAS[name].format(0.25))
    read = read_by_content(formats, open_input(name, tmp_path))
    given = read.sigma_px if isinstance(read, PickRows) else read.sigma_m
    assert np.isnan(given[0]).all() and (given[1] == 0.25).all()
