"""The lens of `tests.kit.flight_project` in every format, and lenses of other kinds."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

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
