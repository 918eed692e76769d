"""The flight of `tests.kit.flight_project` in every format that a flight project can name.

Each table below has one entry for a format: the keys of its section of `flight.toml`, and its
files.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np
import pyproj

from tests.kit.flight_project import FRAMES, MARKS, camera_m, marks_m, pixels
from vopd.arrays import Floats
from vopd.geometry.earth import geodetic

# Lenses


SIZE = "1920, 1080"
BROWN = (-0.1, 0.02, 1e-3, -2e-3, 3e-3)
K = ", ".join(map(str, BROWN))


class Part(NamedTuple):
    """A section of a project: its keys, its files, and how it tells frames from each other."""

    keys: str
    files: Mapping[str, str] = {}
    frames_by: str = ""


def _lens(text: str, more: str = "") -> Part:
    return Part(f'lens = "lens"\nimage_size_px = [{SIZE}]{more}', {"lens": text})


_MATRIX = "1500.0, 0.0, 962.3, 0.0, 1490.0, 534.8, 0.0, 0.0, 1.0"
_INLINE = 'image_size_px = [1920, 1080]\npixel_grid = "centre"\nlens = { %s }'
LENSES = {
    "inline": Part(
        _INLINE % f'model = "brown", fx_px = 1500.0, fy_px = 1490.0, cx_px = 962.3, '
        f"cy_px = 534.8, k = [{K}]"
    ),
    "OpenCV yml": _lens(
        "%YAML:1.0\n---\nimage_width: 1920\nimage_height: 1080\ncamera_matrix: !!opencv-matrix\n"
        f"   rows: 3\n   cols: 3\n   dt: d\n   data: [ {_MATRIX} ]\ndistortion_coefficients: "
        f"!!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n   data: [ {K} ]\n"
    ),
    "OpenCV xml": _lens(
        '<?xml version="1.0"?>\n<opencv_storage>\n<image_width>1920</image_width>\n'
        '<image_height>1080</image_height>\n<camera_matrix type_id="opencv-matrix"><rows>3</rows>'
        f"<cols>3</cols><dt>d</dt>\n<data>{_MATRIX.replace(',', '')}</data></camera_matrix>\n"
        '<distortion_coefficients type_id="opencv-matrix"><rows>1</rows><cols>5</cols><dt>d</dt>\n'
        f"<data>{K.replace(',', '')}</data></distortion_coefficients>\n</opencv_storage>\n"
    ),
    "OpenCV json": _lens(
        '{"image_width": 1920, "image_height": 1080,\n"camera_matrix": {"type_id": "opencv-matrix",'
        f' "rows": 3, "cols": 3, "dt": "d",\n"data": [{_MATRIX}]}},\n"distortion_coefficients": '
        f'{{"type_id": "opencv-matrix", "rows": 1, "cols": 5, "dt": "d",\n"data": [{K}]}}}}\n'
    ),
    "ROS": _lens(
        "image_width: 1920\nimage_height: 1080\ncamera_name: a\ndistortion_model: plumb_bob\n"
        f"camera_matrix: {{rows: 3, cols: 3, data: [{_MATRIX}]}}\n"
        f"distortion_coefficients: {{rows: 1, cols: 5, data: [{K}]}}\n"
    ),
    "COLMAP": _lens(
        "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n1 FULL_OPENCV 1920 1080 1500 1490 962.8 "
        "535.3 -0.1 0.02 1e-3 -2e-3 3e-3 0 0 0\n2 PINHOLE 1920 1080 1500 1500 960 540\n",
        '\ncamera = "1"',
    ),
    "OpenSfM": _lens(
        '{"v2 cam": {"projection_type": "brown", "width": 1920, "height": 1080,\n'
        f'"focal_x": {1500 / 1920!r}, "focal_y": {1490 / 1920!r},\n'
        f'"c_x": {(962.3 - 959.5) / 1920!r}, "c_y": {(534.8 - 539.5) / 1920!r},\n'
        '"k1": -0.1, "k2": 0.02, "p1": 1e-3, "p2": -2e-3, "k3": 3e-3}}\n'
    ),
    "Metashape": _lens(
        '<?xml version="1.0"?>\n<calibration>\n<projection>frame</projection>\n<width>1920</width>'
        "<height>1080</height>\n<f>1490</f><b1>10</b1><cx>2.8</cx><cy>-4.7</cy>\n<k1>-0.1</k1>"
        "<k2>0.02</k2>\n<k3>3e-3</k3><p1>-2e-3</p1><p2>1e-3</p2>\n</calibration>\n"
    ),
    "mrcal": _lens(
        "{ 'lensmodel': 'LENSMODEL_OPENCV5', # a comment\n"
        f" 'intrinsics': [1500.0, 1490.0, 962.3, 534.8, {K},],\n 'imagersize': [1920, 1080],\n}}\n"
    ),
}
"""The lens of the flight, by its format."""
OTHER_LENSES = {  # the picks were not made with them
    "sensor": Part(_INLINE % 'model = "brown", focal_mm = 28.0, sensor_mm = [35.84, 20.16]'),
    "fisheye": Part(_INLINE % 'model = "fisheye", fx_px = 1500.0, k = [0.03, 0.01, -0.02, 0.004]'),
    "radial table": Part(
        _INLINE % 'model = "radial-table", fx_px = 1500.0, '
        "table_px = [[100.0, -0.5], [500.0, 3.0], [1200.0, 20.0]]"
    ),
    "fisheye file": _lens(
        "image_width: 1920\nimage_height: 1080\ndistortion_model: equidistant\n"
        f"camera_matrix: {{rows: 3, cols: 3, data: [{_MATRIX}]}}\n"
        "distortion_coefficients: {rows: 1, cols: 4, data: [0.03, 0.01, -0.02, 0.004]}\n"
    ),
}


# Images, picks, landmarks, tracks, winds


IMAGES = [f"F{k}.JPG" for k in range(FRAMES)]
FRAME_S = 2.0 + np.arange(FRAMES) / 10.0
TRACK_S = np.array([1.0, 2.0, 3.0, 4.0])


def project(
    lens: Part, picks: Part, landmarks: Part, track: Part, wind: Part | None = None, more: str = ""
) -> dict[str, str]:
    """All files of a project, by name; `more` is what else stands in `flight.toml`."""
    times: dict[str, str] = {}
    picks_keys = picks.keys
    if picks.frames_by == "image" and track.frames_by == "time":
        picks_keys += '\ntimes = "times.csv"'
        times["times.csv"] = _csv("image,t_s", zip(IMAGES, FRAME_S, strict=True))
    where = "track" if track.files else "position"
    sections = {
        "flight": 'name = "F12"\nepoch = 2026-05-01T11:58:42Z',
        "camera": lens.keys,
        "picks": picks_keys,
        "landmarks": landmarks.keys,
        where: track.keys,
    }
    if wind is not None:
        sections["wind"] = wind.keys
    text = "".join(f"[{name}]\n{keys}\n" for name, keys in sections.items()) + more
    parts = (lens, picks, landmarks, track, wind or Part(""))
    files = {name: text for part in parts for name, text in part.files.items()}
    return {"flight.toml": text, **files, **times}


def _csv(header: str, rows: Iterator[tuple[object, ...]]) -> str:
    return "\n".join([header, *(",".join(map(str, row)) for row in rows), ""])


def _seen() -> Iterator[tuple[int, str, float, float]]:
    for frame, seen in enumerate(pixels()):
        for name, (u, v) in zip(MARKS, seen, strict=True):
            yield frame, name, round(float(u), 9), round(float(v), 9)


def _gcp_list() -> Part:
    x, y, z = _projected(marks_m()).T
    rows = [
        f"{x[m]:.6f} {y[m]:.6f} {z[m]:.6f} {u} {v} {IMAGES[frame]} {MARKS[m]}"
        for frame, name, u, v in _seen()
        for m in [MARKS.index(name)]
    ]
    return Part('file = "gcp_list.txt"', {"gcp_list.txt": "\n".join(["EPSG:32633", *rows, ""])})


def _projected(position_m: Floats) -> Floats:
    """Easting, northing and height in UTM zone 33, (N, 3)."""
    latitude, longitude, height = geodetic(position_m)
    to_utm = pyproj.Transformer.from_crs("EPSG:4326", "EPSG:32633", always_xy=True)
    return np.stack([*to_utm.transform(longitude, latitude), height], axis=1)


def _cvat_images() -> str:
    points = [f'<points label="{name}" points="{u + 0.5},{v + 0.5}"/>' for _, name, u, v in _seen()]
    per = len(MARKS)
    images = [
        f'<image id="{k}" name="{name}" width="1920" height="1080">\n'
        + "\n".join(points[k * per : (k + 1) * per]) + "\n</image>"
        for k, name in enumerate(IMAGES)
    ]  # fmt: skip
    head = '<?xml version="1.0"?>\n<annotations><version>1.1</version>'
    return "\n".join([head, *images, "</annotations>", ""])


def _cvat_video() -> str:
    tracks = [
        f'<track id="{k}" label="{mark}">\n'
        + "\n".join(
            f'<points frame="{frame}" outside="0" keyframe="1" points="{u + 0.5},{v + 0.5}"/>'
            for frame, name, u, v in _seen()
            if name == mark
        )
        + "\n</track>"
        for k, mark in enumerate(MARKS)
    ]
    size = "<original_size><width>1920</width><height>1080</height></original_size>"
    head = f"<annotations><meta><task>{size}</task></meta>"
    return "\n".join([head, *tracks, "</annotations>", ""])


def _labelme() -> dict[str, str]:
    return {
        f"labels/{image}.json": json.dumps(
            {
                "imagePath": f"..\\{image}",
                "imageWidth": 1920,
                "imageHeight": 1080,
                "shapes": [
                    {"label": name, "points": [[u + 0.5, v + 0.5]], "shape_type": "point"}
                    for frame, name, u, v in _seen()
                    if frame == k
                ],
            },
            indent=1,
        )
        for k, image in enumerate(IMAGES)
    }


_TIMED = "\nframe_rate_hz = 10.0\nfirst_frame_t_s = 2.0"
PICKS = {
    "CSV of frames": Part(
        'file = "picks.csv"\npixel_grid = "centre"' + _TIMED,
        {"picks.csv": _csv("frame,landmark,u_px,v_px", _seen())}, "number",
    ),
    "CSV of images": Part(
        'file = "picks.csv"\npixel_grid = "corner"\nv = "up"\nsigma_px = 0.5',
        {
            "picks.csv": _csv(
                "image;landmark;u_px;v_px;sigma_px".replace(";", ","),
                ((IMAGES[f], n, u + 0.5, 1080 - (v + 0.5), s)
                 for (f, n, u, v), s in zip(_seen(), [0.7, ""] * 15, strict=True)),
            )
        }, "image",
    ),
    "gcp_list.txt": _gcp_list()._replace(frames_by="image"),
    "CVAT images": Part('file = "picks.xml"', {"picks.xml": _cvat_images()}, "image"),
    "CVAT video": Part('file = "picks.xml"' + _TIMED, {"picks.xml": _cvat_video()}, "number"),
    "LabelMe folder": Part('file = "labels"', _labelme(), "image"),
}  # fmt: skip


def _geojson() -> str:
    latitude, longitude, height = geodetic(marks_m())
    features = [
        {
            "type": "Feature",
            "geometry": {"type": "Point", "coordinates": [longitude[k], latitude[k], height[k]]},
            "properties": {"name": name},
        }
        for k, name in enumerate(MARKS)
    ]
    return json.dumps({"type": "FeatureCollection", "features": features}, indent=1)


LANDMARKS = {
    "CSV, geodetic": Part(
        'file = "landmarks.csv"\nheight = "ellipsoid"\nsigma_m = 0.3',
        {
            "landmarks.csv": _csv(
                "landmark,lat_deg,lon_deg,h_m", zip(MARKS, *geodetic(marks_m()), strict=True)
            )
        },
    ),
    "CSV, projected": Part(
        'file = "landmarks.csv"\ncrs = "EPSG:32633"\nheight = { undulation_m = 0.0 }\n'
        "sigma_m = [0.1, 0.2, 0.3]",
        {
            "landmarks.csv": _csv(
                "landmark,x_m,y_m,z_m,sigma_m",
                ((n, *row, "") for n, row in zip(MARKS, _projected(marks_m()), strict=True)),
            )
        },
    ),
    "GeoJSON": Part(
        'file = "landmarks.json"\nheight = "ellipsoid"\nsigma_m = "exact"',
        {"landmarks.json": _geojson()},
    ),
    "gcp_list.txt": _gcp_list()._replace(
        keys='file = "gcp_list.txt"\nheight = "ellipsoid"\nsigma_m = "exact"'
    ),
}


def _camera(time_s: Floats) -> Iterator[tuple[float, ...]]:
    latitude, longitude, height = geodetic(camera_m(time_s))
    return zip(latitude.tolist(), longitude.tolist(), height.tolist(), strict=True)


def _utc(t_s: float) -> str:
    return f"2026-05-01T11:58:{42 + t_s:06.3f}Z"


def _gpx() -> str:
    points = [
        f'<trkpt lat="{a}" lon="{b}"><ele>{h}</ele><time>{_utc(t)}</time></trkpt>'
        for t, (a, b, h) in zip(TRACK_S.tolist(), _camera(TRACK_S), strict=True)
    ]
    head = '<?xml version="1.0"?>\n<gpx version="1.1" creator="x" xmlns='
    head += '"http://www.topografix.com/GPX/1/1"><trk><trkseg>'
    return "\n".join([head, *points, "</trkseg></trk></gpx>", ""])


def _pos() -> str:
    """A solution of RTKLIB, whose GPS time is 18 s ahead of UTC."""
    head = "% (lat/lon/height=WGS84/ellipsoidal,Q=1:fix,2:float,5:single,ns=# of satellites)\n"
    head += "%  GPST   latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)\n"
    rows = [
        f"2026/05/01 11:59:{t:06.3f} {' '.join(map(str, p))} 1 9 0.0100 0.0200 0.0300\n"
        for t, p in zip(TRACK_S.tolist(), _camera(TRACK_S), strict=True)
    ]
    return head + "".join(rows)


def _geo_txt() -> str:
    rows = zip(IMAGES, _projected(camera_m(FRAME_S)), strict=True)
    lines = [" ".join([image, *map(str, xyz), "0", "0", "0"]) for image, xyz in rows]
    return "\n".join(["EPSG:32633", *lines, ""])


_HEIGHT = '\nheight = "ellipsoid"'
_EXACT = '\nsigma_m = "exact"'
_EXACT_TIME = '\nsigma_t_s = "exact"'
TRACKS = {
    "CSV by seconds": Part(
        'file = "track.csv"\ninterpolate = "cubic"\nsigma_m = 0.5\nvelocity_sigma_m_s = "exact"'
        + _HEIGHT + _EXACT_TIME,
        {"track.csv": _csv("t_s,lat_deg,lon_deg,h_m,vn_m_s,ve_m_s,vd_m_s",
                           ((t, *p, 20.0, 5.0, -2.0)
                            for t, p in zip(TRACK_S, _camera(TRACK_S), strict=True)))}, "time",
    ),
    "CSV by dates": Part(
        'file = "track.csv"\nclock = "utc"\noffset_s = 0.0\nsigma_t_s = 0.01\n'
        "lever_arm_m = [0.0, 0.0, 0.0]" + _HEIGHT + _EXACT,
        {"track.csv": _csv("t_utc,lat_deg,lon_deg,h_m",
                           ((_utc(t), *p)
                            for t, p in zip(TRACK_S, _camera(TRACK_S), strict=True)))}, "time",
    ),
    "CSV by image": Part(
        'file = "track.csv"' + _HEIGHT + _EXACT,
        {"track.csv": _csv("image,lat_deg,lon_deg,h_m",
                           ((i, *p) for i, p in zip(IMAGES, _camera(FRAME_S), strict=True)))},
        "image",
    ),
    "GPX": Part(
        'file = "track.gpx"' + _HEIGHT + _EXACT + _EXACT_TIME, {"track.gpx": _gpx()}, "time"
    ),
    "RTKLIB": Part('file = "track.pos"' + _EXACT_TIME, {"track.pos": _pos()}, "time"),
    "geo.txt": Part('file = "geo.txt"' + _HEIGHT + _EXACT, {"geo.txt": _geo_txt()}, "image"),
}  # fmt: skip
POSITION = Part("lat_deg = 47.6435\nlon_deg = 16.4759\nh_m = 540.0" + _HEIGHT + _EXACT)
"""In the place of a track: a camera that does not move, as this one does."""

WINDS = {
    "CSV": Part('file = "wind.csv"', {"wind.csv": "h_m,from_deg,speed_kt\n0,270,10\n1000,0,10\n"}),
    "Wyoming list": Part(
        'file = "wind.txt"',
        {
            "wind.txt": "72402 WAL Wallops Island Observations at 12Z 01 May 2026\n"
            "-----------------------------------------------------------------------------\n"
            "   PRES   HGHT   TEMP   DWPT   RELH   MIXR   DRCT   SKNT   THTA   THTE   THTV\n"
            "    hPa     m      C      C      %    g/kg    deg   knot     K      K      K\n"
            "-----------------------------------------------------------------------------\n"
            " 1000.0    100\n"
            "  850.0   1500    5.0   -2.0     60   3.90     90     20  291.0  303.0  291.7\n"
            "  700.0   3000   -5.0  -12.0     58   2.10    180     40  297.0  303.9  297.4\n"
            "Station information and sounding indices\n"
        },
    ),
    "Wyoming CSV": Part(
        'file = "wind.csv"',
        {
            "wind.csv": "time,geopotential height_m,wind direction_degree,wind speed_m/s\n"
            "x,100,90,10\nx,3000,,\nx,5000,180,20\n"
        },
    ),
}
