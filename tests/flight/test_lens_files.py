"""Lens files: focal lengths, centres and coefficients of each format, worked by hand."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.flight_project import lens_of, no_lens
from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.flight.formats.by_content import read_by_content
from vopd.flight.formats.files import open_input
from vopd.flight.formats.lens import (
    LENS_FORMATS,
    NOT_READ_COLMAP,
    LensQuestion,
    LensRead,
    coefficients_said,
)
from vopd.flight.project.camera import doubts_of_lens, read_lens
from vopd.flight.project.keys import Project, Section
from vopd.geometry.lenses import Lens, LensKind


def read(folder: Path, text: str, **question: Any) -> LensRead:
    (folder / "lens").write_text(text)
    return read_by_content(LENS_FORMATS, open_input("lens", folder), LensQuestion(**question))


def told(folder: Path, text: str, **question: Any) -> str:
    with pytest.raises(VopdError) as refusal:
        read(folder, text, **question)
    return str(refusal.value)


def numbers(found: LensRead) -> list[float]:
    """fx fy cx cy and the coefficients up to the last that is not 0."""
    k = np.trim_zeros(found.lens.k, "b").tolist()
    return [*found.lens.focal_px.tolist(), *found.lens.centre_px.tolist(), *k]


COLMAP = {
    "SIMPLE_PINHOLE 90 70 900 45 35": [900, 900, 44.5, 34.5],
    "PINHOLE 90 70 900 800 45 35": [900, 800, 44.5, 34.5],
    "SIMPLE_RADIAL 90 70 900 45 35 .1": [900, 900, 44.5, 34.5, 0.1],
    "RADIAL 90 70 900 45 35 .1 .2": [900, 900, 44.5, 34.5, 0.1, 0.2],
    "OPENCV 90 70 900 800 45 35 .1 .2 .3 .4": [900, 800, 44.5, 34.5, 0.1, 0.2, 0.3, 0.4],
    "FULL_OPENCV 90 70 900 800 45 35 .1 .2 .3 .4 .5 .6 .7 .8": [
        900, 800, 44.5, 34.5, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8
    ],
    "OPENCV_FISHEYE 90 70 900 800 45 35 .1 .2 .3 .4": [900, 800, 44.5, 34.5, 0.1, 0.2, 0.3, 0.4],
    "SIMPLE_RADIAL_FISHEYE 90 70 900 45 35 .1": [900, 900, 44.5, 34.5, 0.1],
    "RADIAL_FISHEYE 90 70 900 45 35 .1 .2": [900, 900, 44.5, 34.5, 0.1, 0.2],
    "SIMPLE_FISHEYE 90 70 900 45 35": [900, 900, 44.5, 34.5],
    "FISHEYE 90 70 900 800 45 35": [900, 800, 44.5, 34.5],
}  # fmt: skip


@pytest.mark.parametrize("line", COLMAP)
def test_every_model_of_colmap(line: str, tmp_path: Path) -> None:
    found = read(tmp_path, f"# cameras\n\n7 {line}\n")
    assert numbers(found) == COLMAP[line] and found.lens.size_px == (90, 70)
    assert (found.lens.kind is LensKind.FISHEYE) == ("FISHEYE" in line)
    name = line.split()[0]
    assert_approved(found.said, parts=[name])


def test_a_camera_of_colmap_by_its_number(tmp_path: Path) -> None:
    text = "12 PINHOLE 90 70 900 800 45 35\n2 PINHOLE 80 60 600 500 40 30\n"
    assert numbers(read(tmp_path, text, camera="2")) == [600, 500, 39.5, 29.5]
    assert numbers(read(tmp_path, text, camera="12")) == [900, 800, 44.5, 34.5]
    assert_approved(told(tmp_path, text, camera="1"))
    assert_approved(told(tmp_path, text.replace("800", "x"), camera="12"))
    assert_approved(told(tmp_path, text.replace(" 70 ", " 0 "), camera="12"))


def opensfm(**camera: Any) -> str:
    focal = {} if "focal_x" in camera else {"focal": 0.5}
    return json.dumps({"a": {"width": 400, "height": 300} | focal | camera})


@pytest.mark.parametrize(
    ("camera", "expected"),
    [
        ({}, [200, 200, 199.5, 149.5]),
        ({"width": 300, "height": 400}, [200, 200, 149.5, 199.5]),
        ({"c_x": 0.01, "c_y": -0.02}, [200, 200, 203.5, 141.5]),
        ({"width": 300, "height": 400, "c_x": 0.01, "c_y": -0.02}, [200, 200, 153.5, 191.5]),
        ({"focal_x": 0.75, "focal_y": 0.25}, [300, 100, 199.5, 149.5]),
        ({"k1": 0.1, "k2": 0.2, "k3": 0}, [200, 200, 199.5, 149.5, 0.1, 0.2]),
        ({"projection_type": "simple_radial", "k1": 0.1, "k2": 0}, [200, 200, 199.5, 149.5, 0.1]),
        ({"projection_type": "radial", "k1": 0.1, "k2": 0.2}, [200, 200, 199.5, 149.5, 0.1, 0.2]),
        (
            {"projection_type": "brown", "k1": 0.1, "k2": 0.2, "p1": 0.3, "p2": 0.4, "k3": 0.5},
            [200, 200, 199.5, 149.5, 0.1, 0.2, 0.3, 0.4, 0.5],
        ),
        ({"projection_type": "fisheye", "k1": 0.1, "k2": 0.2}, [200, 200, 199.5, 149.5, 0.1, 0.2]),
        (
            {"projection_type": "fisheye_opencv", "k1": 0.1, "k2": 0.2, "k3": 0.3, "k4": 0.4},
            [200, 200, 199.5, 149.5, 0.1, 0.2, 0.3, 0.4],
        ),
    ],
)  # fmt: skip
def test_lenses_of_opensfm_are_by_the_longer_side(
    camera: dict[str, Any], expected: list[float], tmp_path: Path
) -> None:
    found = read(tmp_path, opensfm(**camera))
    assert_close("ratio", numbers(found), expected)
    assert found.lens.size_px == (camera.get("width", 400), camera.get("height", 300))
    kind = camera.get("projection_type", "perspective")
    assert (found.lens.kind is LensKind.FISHEYE) == kind.startswith("fisheye")
    assert_approved(found.said, parts=[kind])


def test_a_camera_of_opensfm_by_its_name_and_in_a_reconstruction(tmp_path: Path) -> None:
    one, other = (json.loads(opensfm(focal=f))["a"] for f in (0.5, 0.75))
    text = json.dumps({"one": one, "other": other})
    assert numbers(read(tmp_path, text, camera="other"))[0] == 300.0
    assert_approved(told(tmp_path, text))
    assert_approved(told(tmp_path, text, camera="none"))
    text = json.dumps([{"cameras": {"other": other}, "shots": {}}])
    assert numbers(read(tmp_path, text))[0] == 300.0
    text = json.dumps([{"cameras": {"one": one, "other": other}, "shots": {}}])
    assert_approved(told(tmp_path, text))
    assert_approved(told(tmp_path, opensfm(focal="x")))


def metashape(inside: str, camera: str = "") -> str:
    return f"<?xml version='1.0'?><calibration {camera}>{inside}</calibration>"


SIZE = "<width>400</width><height>300</height>"


@pytest.mark.parametrize(
    ("inside", "expected"),
    [
        ("<f>200</f>", [200, 200, 199.5, 149.5]),
        ("<f>200</f><b1>5</b1>", [205, 200, 199.5, 149.5]),
        ("<f>200</f><cx>3</cx><cy>-4</cy>", [200, 200, 202.5, 145.5]),
        (
            "<f>200</f><k1>.1</k1><k2>.2</k2><k3>.5</k3><p1>.4</p1><p2>.3</p2>",
            [200, 200, 199.5, 149.5, 0.1, 0.2, 0.3, 0.4, 0.5],
        ),
    ],
)
def test_lenses_of_metashape(inside: str, expected: list[float], tmp_path: Path) -> None:
    assert numbers(read(tmp_path, metashape(SIZE + inside))) == expected


def test_the_adjusted_calibration_of_the_sensor_that_is_named(tmp_path: Path) -> None:
    """The size is the sensor's where the calibration has none."""
    sensors = "".join(
        f'<sensor id="{k}" label="cam {k}" type="frame"><resolution width="400" height="300"/>'
        f'<calibration type="frame" class="adjusted"><f>{200 + k}</f></calibration>'
        f'<calibration type="frame" class="initial"><f>{100 + k}</f></calibration></sensor>'
        for k in range(2)
    )
    text = f"<document><sensors>{sensors}</sensors></document>"
    for camera in ("1", "cam 1"):
        found = read(tmp_path, text, camera=camera)
        assert numbers(found) == [201, 201, 199.5, 149.5] and found.lens.size_px == (400, 300)
    assert_approved(told(tmp_path, text))
    assert_approved(told(tmp_path, text, camera="cam 2"))
    initial = text.replace('class="adjusted"', 'class="initial"')
    assert numbers(read(tmp_path, initial, camera="0"))[0] == 100.0
    assert_approved(told(tmp_path, metashape("<f>200</f>")))
    assert_approved(told(tmp_path, metashape(SIZE, 'type="fisheye"')))
    assert_approved(told(tmp_path, metashape(SIZE + "<f>x</f>")))


@pytest.mark.parametrize(
    ("cx", "far"), [(99.9, False), (100.1, True), (-99.9, False), (-101, True)]
)
def test_a_centre_a_quarter_of_the_width_away_is_from_the_corner(
    cx: float, far: bool, tmp_path: Path
) -> None:
    text = metashape(f"{SIZE}<f>200</f><cx>{cx}</cx>")
    if far:
        assert_approved(told(tmp_path, text))
    else:
        assert numbers(read(tmp_path, text))[2] == 199.5 + cx


OPENCV = {"camera_matrix": [[900, 0, 45], [0, 800, 35], [0, 0, 1]], "image_width": 90,
          "image_height": 70}  # fmt: skip


@pytest.mark.parametrize(
    ("keys", "question", "expected", "fisheye"),
    [
        ({}, {}, [900, 800, 45, 35], False),
        ({"width": 90, "height": 70, "focal_length_mm": 8.0}, {}, [900, 800, 45, 35], False),
        ({"dist_coeffs": [0.1, 0.2, 0.3, 0.4, 0.5]}, {},
         [900, 800, 45, 35, 0.1, 0.2, 0.3, 0.4, 0.5], False),
        ({"D": [0.1, 0.2, 0.3, 0.4]}, {"model": "fisheye"}, [900, 800, 45, 35, 0.1, 0.2, 0.3, 0.4],
         True),
        ({"d1": [0.1, 0.2, 0.3, 0.4]}, {"model": "brown"}, [900, 800, 45, 35, 0.1, 0.2, 0.3, 0.4],
         False),
        ({"distCoeffs": [[0.1], [0.2], [0.3], [0.4]], "fisheye_model": 1}, {},
         [900, 800, 45, 35, 0.1, 0.2, 0.3, 0.4], True),
        ({"dist_coeff": [0.1, 0.2, 0.3, 0.4], "fisheye_model": "0"}, {"model": "fisheye"},
         [900, 800, 45, 35, 0.1, 0.2, 0.3, 0.4], False),
    ],
)  # fmt: skip
def test_keys_and_models_of_opencv(
    keys: dict[str, Any], question: dict[str, Any], expected: list[float], fisheye: bool,
    tmp_path: Path,
) -> None:  # fmt: skip
    found = read(tmp_path, json.dumps(OPENCV | keys), **question)
    assert numbers(found) == expected and found.lens.size_px == (90, 70)
    assert (found.lens.kind is LensKind.FISHEYE) is fisheye


@pytest.mark.parametrize(
    ("names", "expected", "model"),
    [
        ("k3 k1 p2 k2 p1", [0.2, 0.4, 0.5, 0.3, 0.1], ""),
        ("K1 k2 p1 p2", [0.1, 0.2, 0.3, 0.4], ""), ("k2 k1", [0.2, 0.1], ""),
        ("k1 k2 k3 k4", [0.1, 0.2, 0, 0, 0.3, 0.4], "brown"),
        ("k4 k3 k2 k1", [0.4, 0.3, 0.2, 0.1], "fisheye"),
        ("k1 k6", [0.1, 0, 0, 0, 0, 0, 0, 0.2], ""),
    ],
)  # fmt: skip
def test_coefficients_of_opencv_by_their_names(
    names: str, expected: list[float], model: str, tmp_path: Path
) -> None:
    """The one that stands first is .1, the next .2."""
    own = {name: round(0.1 * k, 1) for k, name in enumerate(names.split(), 1)}
    found = read(tmp_path, json.dumps(OPENCV | {"dist": own}), model=model or "brown")
    assert numbers(found) == [900, 800, 45, 35, *expected]
    assert_approved(told(tmp_path, json.dumps(OPENCV | {"dist": own | {"b1": 0.1}})))


def test_a_focal_length_beside_a_matrix_is_said_to_be_of_no_use(tmp_path: Path) -> None:
    found = read(tmp_path, json.dumps(OPENCV | {"focal_length": 500.0}))
    assert numbers(found) == [900, 800, 45, 35]
    assert_approved(found.said)


def test_the_size_in_an_opencv_file_is_the_calibration_s(tmp_path: Path) -> None:
    """Where it has none, the project says it; where both are there, the file's is given back."""
    text = json.dumps(OPENCV)
    assert read(tmp_path, text, size_px=(45, 35)).lens.size_px == (90, 70)
    without = json.dumps({"camera_matrix": OPENCV["camera_matrix"]})
    assert read(tmp_path, without, size_px=(45, 35)).lens.size_px == (45, 35)
    assert_approved(told(tmp_path, without))
    mtx = {"mtx": OPENCV["camera_matrix"], "dist": [[0.1, 0.2, 0.3, 0.4, 0.5]]}
    assert numbers(read(tmp_path, json.dumps(mtx), size_px=(90, 70)))[4] == 0.1
    for name in ("cameraMatrix", "M1", "K", "intrinsic_matrix"):
        other = text.replace("camera_matrix", name) + " " * ("camera" not in name.lower())
        if "camera" in name.lower():
            assert numbers(read(tmp_path, other)) == [900, 800, 45, 35]


@pytest.mark.parametrize(
    "matrix",
    [
        [[900, 0, 0], [0, 800, 0], [45, 35, 1]],
        [[900, 0, 45], [0, 800, 35], [0, 0, 2]],
        [[900, 0, 45], [0, 800, 35], [0, 0, float("nan")]],
    ],
)
def test_a_matrix_that_is_no_camera_matrix(matrix: list[list[float]], tmp_path: Path) -> None:
    """The first is transposed, as MATLAB's older ones are."""
    assert_approved(told(tmp_path, json.dumps(OPENCV | {"camera_matrix": matrix})))


def test_numbers_of_an_opencv_file_that_no_model_has_are_not_ignored(tmp_path: Path) -> None:
    """A skew is read; coefficients of other names, a part of the picture and more are refused."""
    fx, fy = [900, 0.5, 45], [0, 800, 35]
    skewed = read(tmp_path, json.dumps(OPENCV | {"camera_matrix": [fx, fy, [0, 0, 1]]}))
    assert (skewed.lens.skew_px, numbers(skewed)) == (0.5, [900, 800, 45, 35])
    assert_approved(skewed.said)
    for more in (
        {"camera_matrix": [[900, 0, 45], [0.5, 800, 35], [0, 0, 1]]},
        {"distortion_coeffs": [0.1, 0, 0, 0, 0]}, {"k1": 0.1}, {"Dist_Coefs": [0.1]},
        {"RadialDistortion": [0.1]}, {"radial": [0.1, 0]}, {"coefficients": [0.1] * 5},
        {"lens_distortion": [0.1] * 5}, {"binning_y": 2}, {"binning_x": 2},
        {"roi": {"x_offset": 5, "y_offset": 0}}, {"roi": {"y_offset": 7}},
    ):  # fmt: skip
        assert_approved(told(tmp_path, json.dumps(OPENCV | more)))
    plain = {"D": [0.1] * 5, "distortion_model": "plumb_bob", "k1": 7, "distortion_type": "x",
             "binning_x": 0, "binning_y": 1, "roi": {"x_offset": 0, "y_offset": 0}}  # fmt: skip
    assert numbers(read(tmp_path, json.dumps(OPENCV | plain)))[4:] == [0.1] * 5


def test_cameras_of_files_that_have_one_or_two(tmp_path: Path) -> None:
    """M1 and M2 are those of a stereo calibration; a camera that a file cannot name is refused."""
    matrix = OPENCV["camera_matrix"]
    size = {"image_width": 90, "image_height": 70, "of": "camera_matrix"}
    one, other = {"M1": matrix, "D1": [0.1] * 5}, {"M2": [[700, 0, 1], [0, 600, 2], [0, 0, 1]]}
    stereo = size | one | other | {"D2": [0.2] * 5}
    assert numbers(read(tmp_path, json.dumps(stereo), camera="1")) == [900, 800, 45, 35, *[0.1] * 5]
    assert numbers(read(tmp_path, json.dumps(stereo), camera="2")) == [700, 600, 1, 2, *[0.2] * 5]
    for camera in (None, "3"):
        assert_approved(told(tmp_path, json.dumps(stereo), camera=camera))
    for text in (json.dumps(OPENCV), repr(MODEL), json.dumps({"intrinsics": [9.0] * 11})):
        assert_approved(told(tmp_path, text, camera="2"))


# A lens in the project itself


def inline(size: tuple[int, int] | None, lens: dict[str, Any], **camera: Any) -> LensRead:
    values = {"lens": lens, **camera} | ({"image_size_px": list(size)} if size else {})
    return read_lens(Project("p.toml", Path(), {"camera": Section("p.toml", "camera", values)}))


FX = {"model": "brown", "fx_px": 900.0}


@pytest.mark.parametrize(
    ("lens", "camera", "expected"),
    [
        (FX, {}, [900, 900, 199.5, 149.5]),
        (FX | {"fy_px": 800}, {}, [900, 800, 199.5, 149.5]),
        (
            {"model": "brown", "focal_mm": 35.0, "sensor_mm": [36.0, 24.0]},
            {},
            [35 * 400 / 36, 35 * 300 / 24, 199.5, 149.5],
        ),
        (
            FX | {"cx_px": 200, "cy_px": 150},
            {"pixel_grid": "centre"},
            [900, 900, 200, 150],
        ),
        (
            FX | {"cx_px": 200, "cy_px": 150},
            {"pixel_grid": "corner"},
            [900, 900, 199.5, 149.5],
        ),
        (
            FX | {"cx_px": 200, "cy_px": 150},
            {"pixel_grid": "one-based"},
            [900, 900, 199, 149],
        ),
        (
            FX | {"model": "fisheye", "k": [0.1, 0.2]},
            {},
            [900, 900, 199.5, 149.5, 0.1, 0.2],
        ),
        (
            FX | {"model": "fisheye", "k": [0.1]},
            {},
            [900, 900, 199.5, 149.5, 0.1],
        ),
    ],
)
def test_inline_lenses(lens: dict[str, Any], camera: dict[str, Any], expected: list[float]) -> None:
    found = inline((400, 300), lens, **camera)
    assert_close("ratio", numbers(found), expected)
    assert_approved(found.said)
    assert found.lens.size_px == (400, 300) and found.lens.skew_px == 0.0
    assert inline((400, 300), lens | {"skew_px": 1.5}, **camera).lens.skew_px == 1.5


def test_a_lens_of_brown_s_with_one_coefficient_is_refused() -> None:
    with refused(VopdError):
        inline((400, 300), FX | {"k": [0.1]})


TABLE = {"model": "radial-table", "fx_px": 900.0, "table_px": [[100, 1.0], [200, -2.0]]}
REFUSED = {
    "no size": (None, FX),
    "part of a pixel": ((400.5, 300), FX),
    "no pixel": ((0, 300), FX),
    "two focal lengths": ((4, 3), FX | {"focal_mm": 35, "sensor_mm": [36, 24]}),
    "no focal length": ((4, 3), {"model": "brown"}),
    "no sensor": ((4, 3), {"model": "brown", "focal_mm": 35}),
    "sensor of 0": ((4, 3), {"model": "brown", "focal_mm": 35, "sensor_mm": [0, 24]}),
    "focal length of 1": ((4, 3), FX | {"fx_px": 1.0}),
    "focal length in metres": (
        (400, 300),
        {"model": "brown", "focal_mm": 0.035, "sensor_mm": [36, 27]},
    ),
    "focal length of no camera": ((4, 3), FX | {"fx_px": 2e9}),
    "of the other side": ((4, 3), FX | {"fy_px": 1.0}),
    "one row": ((4, 3), TABLE | {"table_px": [[100, 1.0]]}),
    "not finite": ((4, 3), TABLE | {"table_px": [[1, 2], [2, float("inf")]]}),
    "at the centre": ((4, 3), TABLE | {"table_px": [[0, 1], [2, 3]]}),
    "falling": ((4, 3), TABLE | {"table_px": [[1, 1], [1, 3]]}),
    "folding": ((4, 3), TABLE | {"table_px": [[1, 1], [2, -0.1]]}),
    "two focal lengths of a table": ((4, 3), TABLE | {"fy_px": 800}),
}


@pytest.mark.parametrize("case", REFUSED)
def test_inline_lenses_that_are_refused(case: str) -> None:
    with refused(VopdError):
        inline(*REFUSED[case])


def test_a_radial_table_with_a_text_is_refused() -> None:
    with refused(VopdError, others_after="is not a number:"):
        inline((4, 3), TABLE | {"table_px": [[1, "x"], [2, 3]]})


def test_a_radial_table_begins_at_the_centre() -> None:
    for rows in ([[100, 1.0], [200, -2.0]], [[0, 0], [100, 1.0], [200, -2.0]]):
        table = inline((400, 300), TABLE | {"table_px": rows}).lens.table
        assert table is not None and table.tolist() == [[0, 0], [100, 1.0], [200, -2.0]]


@pytest.mark.parametrize("size", [[90, 70], [70, 90], [45, 35]])
def test_a_calibration_is_of_images_of_one_size(size: list[int], tmp_path: Path) -> None:
    (tmp_path / "lens").write_text(json.dumps(OPENCV))
    values = {"lens": "lens", "image_size_px": size}
    project = Project("p.toml", tmp_path, {"camera": Section("p.toml", "camera", values)})
    if size == [90, 70]:
        assert read_lens(project).lens.size_px == (90, 70)
    else:
        with refused(VopdError):
            read_lens(project)


OPENCV_XML = (
    '<?xml version="1.0"?><opencv_storage><calibration_time>today</calibration_time>'
    "<image_width>90</image_width><image_height>70</image_height>"
    '<camera_matrix type_id="opencv-matrix"><rows>3</rows><cols>3</cols><dt>d</dt>'
    "<data>900 0 45 0 800 35 0 0 1</data></camera_matrix></opencv_storage>"
)
OPENCV_YML = (
    '%YAML:1.0\n---\ncalibration_time: "today"\nimage_width: 90\nimage_height: 70\n'
    "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
    "   data: [ 900., 0., 45., 0., 800., 35., 0., 0., 1. ]\n"
)
KALIBR = """cam0:
  camera_model: pinhole
  distortion_coeffs: [-0.1, 0.02, 0.003, -0.004]
  distortion_model: radtan
  intrinsics: [900.0, 800.0, 45.0, 35.0]
  resolution: [90, 70]
cam1:
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, 0.1]
  - [0.0, 1.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  distortion_coeffs: [0.1, 0.2, 0.3, 0.4]
  distortion_model: equidistant
  intrinsics: [90, 80, 4, 3]
  resolution: [9, 7]
"""
RECOGNISED = {
    "kalibr": KALIBR.partition("cam1")[0],
    "colmap": "# x\n\n  7 PINHOLE 90 70 900 800 45 35\n",
    "opensfm": "\n " + opensfm(),
    "opensfm, x": opensfm(focal_x=0.5),
    "metashape": metashape(SIZE + "<f>200</f>"),
    "opencv json": json.dumps(OPENCV),
    "opencv xml": OPENCV_XML,
    "opencv yml": OPENCV_YML,
    "mrcal": (
        "# made by hand\n{'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': [900, 800, 45, 35],"
        "'imagersize': [90, 70]}"
    ),
}


@pytest.mark.parametrize("name", RECOGNISED)
def test_a_format_is_recognised_by_its_content(name: str, tmp_path: Path) -> None:
    """Also with words that another format has: OpenCV's files may have a time of calibration."""
    text = RECOGNISED[name]
    (tmp_path / "lens").write_text(text)
    file = open_input("lens", tmp_path)
    first = next(one for one in LENS_FORMATS if one.recognises(file))
    assert_approved(first.name)
    if name not in ("opensfm", "opensfm, x", "metashape"):
        assert numbers(read(tmp_path, text))[:2] == [900, 800]


# Variants of Metashape's, mrcal's, OpenSfM's and COLMAP's lens files, and what is said of them


# Metashape


def calibration(inside: str, attributes: str = "") -> str:
    return f"<calibration {attributes}><f>200</f>{inside}</calibration>"


OTHER_SIZE = '<resolution width="800" height="600"/>'
FRAME = "<projection>{}</projection>"


@pytest.mark.parametrize(
    ("projection", "own", "sensor", "unknown"),
    [
        ("", "", "", ""), (" frame ", "", "", ""), ("", " frame ", "", ""), ("", "", " frame ", ""),
        ("fisheye", "frame", "frame", "fisheye"), ("frame", "fisheye", "fisheye", ""),
        ("", "fisheye", "frame", "fisheye"), ("", "frame", "fisheye", ""),
        ("", "", " spherical ", "spherical"), ("equidistant", "", "", "equidistant"),
    ],
)  # fmt: skip
def test_a_projection_is_the_calibration_s_and_then_the_sensor_s(
    projection: str, own: str, sensor: str, unknown: str
) -> None:
    inside = SIZE + (FRAME.format(projection) if projection else "")
    text = calibration(inside, f'type="{own}"' if own else "")
    of = f'type="{sensor}"' if sensor else ""
    text = f'<document><sensor id="0" label="a" {of}>{text}</sensor></document>'
    if unknown:
        assert_approved(no_lens(text), parts=[unknown])
    else:
        assert_approved(lens_of(text).said)


@pytest.mark.parametrize(
    ("inside", "outside", "size"),
    [
        (SIZE, "", (400, 300)), (SIZE + OTHER_SIZE, "", None), (OTHER_SIZE, "", (800, 600)),
        (SIZE, OTHER_SIZE, None), ("", OTHER_SIZE, (800, 600)),
        (OTHER_SIZE, OTHER_SIZE, (800, 600)),
        (OTHER_SIZE, '<resolution width="9" height="9"/>', None),
        ("<width>400</width>", "", None), ("<height>300</height>", "", None),
        ("", '<resolution width="9"/>', None), ("", '<resolution height="9"/>', None),
    ],
)  # fmt: skip
def test_a_size_is_the_calibration_s_and_then_the_sensor_s(
    inside: str, outside: str, size: tuple[int, int] | None
) -> None:
    text = f"<a><sensor>{outside}{calibration(inside)}</sensor></a>"
    if size is None:
        assert_approved(no_lens(text))
    else:
        lens = lens_of(text).lens
        assert lens.size_px == size
        assert lens.centre_px.tolist() == [(size[0] - 1) / 2, (size[1] - 1) / 2]


def test_what_metashape_s_files_are_refused_for() -> None:
    for k4 in ("1e-9", "-1e-9"):
        assert_approved(no_lens(calibration(f"{SIZE}<k4>{k4}</k4>")))
    for name in ("p3", "p4"):
        assert_approved(no_lens(calibration(f"{SIZE}<p1>1e-3</p1><{name}>1e-9</{name}>")))
    zeros = f"{SIZE}<k4>0</k4><p3>0</p3><p4>0</p4>"
    assert lens_of(calibration(zeros)).lens.k.tolist() == [0.0] * 12
    for name in ("f", "cx", "cy", "k1", "k2", "k3", "k4", "p1", "p2", "b1", "b2", "width"):
        text = calibration(SIZE.replace("400", "x") if name == "width" else f"{SIZE}")
        text = text.replace(">200<", ">x<") if name == "f" else text
        if name not in ("width", "f"):
            text = calibration(f"{SIZE}<{name}>x</{name}>")
        assert_approved(no_lens(text), parts=[name])
    assert lens_of(calibration(SIZE + "<cx>100</cx>")).lens.centre_px.tolist() == [
        299.5,
        149.5,
    ]
    assert lens_of(calibration(SIZE + "<cx>-100</cx>")).lens.centre_px.tolist() == [
        99.5,
        149.5,
    ]
    for cx in ("100.5", "-100.5"):
        assert_approved(no_lens(calibration(f"{SIZE}<cx>{cx}</cx>")))
    assert lens_of(calibration(SIZE + "<cy>75</cy>")).lens.centre_px.tolist() == [199.5, 224.5]
    for cy in ("75.5", "-75.5"):
        assert_approved(no_lens(calibration(f"{SIZE}<cy>{cy}</cy>")))
    assert_approved(no_lens("<a><sensor/>" + "<calibration/>" + "</a>"))
    assert_approved(no_lens(calibration(SIZE)[:-1]), others_after="not valid XML:")
    covariance = "<covariance><params>f</params><coeffs>1e300</coeffs></covariance>"
    assert_approved(no_lens(calibration(SIZE + covariance)))
    assert_approved(no_lens(calibration(SIZE + "<k1>-0.1</k1><k1>0.1</k1>")))
    for foreign in ("<skew>2</skew>", "<K1>-0.1</K1>", "<fx>210</fx>"):
        assert_approved(no_lens(calibration(SIZE + foreign)))
    assert lens_of(calibration(f"{SIZE}<skew>0</skew><note>7 m</note>")).lens.skew_px == 0.0
    filled = f"\n <?xml version='1.0'?><!-- {'x' * 30_000}\n -->"
    assert lens_of(filled + calibration(SIZE)).lens.size_px == (400, 300)


# mrcal


MODEL = {"lensmodel": "LENSMODEL_PINHOLE", "intrinsics": [9, 8, 4, 3], "imagersize": [64, 48]}


def test_lens_keys_of_mrcal() -> None:
    """The name of the model has had three keys."""
    rest = {key: MODEL[key] for key in ("intrinsics", "imagersize")}
    for key, name in (
        ("lensmodel", "LENSMODEL_PINHOLE"), ("lens_model", "LENSMODEL_PINHOLE"),
        ("distortion_model", "DISTORTION_NONE # LENSMODEL_"),
    ):  # fmt: skip
        text = str(rest | {key: name.partition(" ")[0]}) + name[len(name.partition(" ")[0]) :]
        found = lens_of(text)
        assert found.lens.size_px == (64, 48) and found.lens.focal_px.tolist() == [9.0, 8.0]
        assert_approved(found.said)
    for count in (4, 5, 8, 12):
        k = [0.25 * one for one in range(1, count + 1)]
        model = {"lensmodel": f"LENSMODEL_OPENCV{count}", "intrinsics": [9, 8, 4, 3, *k]}
        found = lens_of(str(MODEL | model))
        assert found.lens.k[:count].tolist() == k
        assert_approved(found.said, parts=[count])
    assert_approved(no_lens(str(MODEL | {"lensmodel": "LENSMODEL_OPENCV14"})))
    assert_approved(no_lens(str(MODEL | {"distortion_model": "DISTORTION_OPENCV4"})))
    assert lens_of(str(MODEL | {"distortion_model": "DISTORTION_NONE"})).lens.size_px == (64, 48)


@pytest.mark.parametrize(
    "wrong",
    [
        "['LENSMODEL_PINHOLE']", "{'LENSMODEL_PINHOLE'", str(MODEL | {"imagersize": 64}),
        str(MODEL | {"imagersize": [64]}), str(MODEL | {"intrinsics": ["x"]}),
        str(MODEL).replace("'imagersize'", "'size'"), "LENSMODEL_PINHOLE",
    ],
)  # fmt: skip
def test_what_is_no_model_of_mrcal(wrong: str) -> None:
    assert_approved(no_lens(wrong), others_after="not a mrcal camera model:")


# OpenSfM


def test_what_opensfm_s_files_are_refused_for() -> None:
    assert_approved(no_lens(opensfm(projection_type="dual")))
    for key in ("width", "height", "focal", "k1", "c_x", "c_y"):
        for wrong in ("x", None, [1]):
            assert_approved(no_lens(opensfm(**{key: wrong})))
    assert_approved(no_lens(opensfm(focal=1500)))
    assert_approved(no_lens(opensfm(focal_x=0.75, focal_y=100.5)))
    assert_approved(no_lens(opensfm(focal=0.5, focal_x=0.75, focal_y=0.75)))
    assert_approved(no_lens(opensfm(c_x=200.0)))
    assert_approved(no_lens(opensfm(c_y=-1.01)))
    assert_approved(no_lens(opensfm(projection_type="perspective", p1=1e-3, p2=0.0, k3=1e-3)))
    assert_approved(no_lens(opensfm(projection_type="fisheye_opencv", k5=1e-3)))
    missing = json.dumps({"b": {"width": 400, "focal": 0.5}})
    assert_approved(no_lens(missing))
    assert_approved(no_lens(opensfm()[:-1]))
    assert_approved(no_lens(opensfm(), camera="b"))
    assert_approved(no_lens('[{"cameras": {}, "width": 1, "focal": 1}]'))


def test_a_reconstruction_of_opensfm_is_the_first() -> None:
    one, other = json.loads(opensfm()), json.loads(opensfm(focal=0.75))
    text = "\n" + json.dumps([{"cameras": one}, {"cameras": other}])
    for named in ({}, {"camera": "a"}):
        first = lens_of(text, **named)
        assert_close("ratio", first.lens.focal_px, [200.0, 200.0])
        assert_approved(first.said)
    alike = lens_of(json.dumps([{"cameras": one}, {"cameras": one}, 7, {"cameras": [1]}]))
    assert alike.said == lens_of(json.dumps([{"cameras": one}])).said
    assert_close("ratio", lens_of(opensfm(focal_x=0.75)).lens.focal_px, [300.0, 300.0])
    upright = lens_of(opensfm(width=300, height=400, focal=0.75, c_x=0.1, c_y=0.2)).lens
    assert_close("ratio", upright.focal_px, [300.0, 300.0])  # by the longer side
    assert_close("ratio", upright.centre_px, [149.5 + 40.0, 199.5 + 80.0])
    assert_approved(no_lens(opensfm(width=300, height=400, focal=150)), parts=["0.375"])
    text = opensfm(projection_type="radial").replace('"a"', '"mtx"')  # also a word of OpenCV's
    assert_approved(lens_of(text).said)
    brown = {"projection_type": "brown", "k1": 1, "k2": 2, "p1": 3, "p2": 4, "k3": 5}
    assert lens_of(opensfm(**brown)).lens.k[:6].tolist() == [1.0, 2.0, 3.0, 4.0, 5.0, 0.0]


# Kalibr


def test_cameras_of_kalibr_by_their_names(tmp_path: Path) -> None:
    """OpenCV's order of coefficients, and its grid."""
    first = read(tmp_path, KALIBR, camera="cam0")
    assert numbers(first) == [900, 800, 45, 35, -0.1, 0.02, 0.003, -0.004]
    assert first.lens.size_px == (90, 70) and first.lens.kind is LensKind.BROWN
    second = read(tmp_path, KALIBR, camera="cam1")
    assert numbers(second) == [90, 80, 4, 3, 0.1, 0.2, 0.3, 0.4]
    assert second.lens.kind is LensKind.FISHEYE
    assert_approved([first.said, second.said])
    without = KALIBR.partition("cam1")[0].replace("radtan", "none")
    assert numbers(read(tmp_path, without.replace("[-0.1, 0.02, 0.003, -0.004]", "[]"))) == [
        900, 800, 45, 35,
    ]  # fmt: skip


def test_what_kalibr_s_files_are_refused_for() -> None:
    one = KALIBR.partition("cam1")[0]
    assert_approved([no_lens(KALIBR), no_lens(KALIBR, camera="cam2")])
    for old, new in (
        ("pinhole", "omni"), ("radtan", "fov"), ("900.0, ", ""), (", -0.004", ""),
        ("radtan", "none"), ("resolution: [90, 70]", "rostopic: /cam0"),
        ("camera_model", "model"), ("[90, 70]", "wide"),
    ):  # fmt: skip
        assert_approved(no_lens(one.replace(old, new)))


# COLMAP


def test_what_colmap_s_files_are_refused_for() -> None:
    assert_approved(no_lens("# x\n1 FOV 90 70 1 2\n"))
    for number, text in (
        (1, "1 PINHOLE 90 70 9 8 x 3\n"),
        (3, "\n  # a\n1 RADIAL 90 70 9 8 3 1 y"),
    ):
        assert_approved(no_lens(text), parts=[number])
    assert_approved(no_lens("1 PINHOLE 90 70 9 8 3\n"))
    assert_approved(no_lens("1 RADIAL 90 70 9 8 3\n"))
    assert_approved(no_lens("1 PINHOLE 90 70 9 8 4 3\n2 PINHOLE 90.7 70 9 8 4 3\n", camera="2"))
    two = "1 PINHOLE 90 70 9 8 4 3\n2 PINHOLE 90 70 9 7 4 3\n"
    assert_approved(no_lens(two))
    assert_approved(no_lens(two, camera="3"))
    assert lens_of(two, camera="2").lens.focal_px.tolist() == [9.0, 7.0]
    assert lens_of("1 PINHOLE 90 70 9 8 4 3\n", camera="1").lens.size_px == (90, 70)


def test_models_of_colmap_that_are_not_read_name_the_one_to_calibrate() -> None:
    """By the projection that each bends: of a fisheye angles, of the others tangents."""
    assert NOT_READ_COLMAP.keys() == {
        "FOV", "THIN_PRISM_FISHEYE", "RAD_TAN_THIN_PRISM_FISHEYE", "SIMPLE_DIVISION", "DIVISION",
    }  # fmt: skip
    assert_approved([no_lens(f"1 {name} 90 70 9 8 4 3\n") for name in sorted(NOT_READ_COLMAP)])


# What a number of a lens must be, in every format; the keys and models that formats have


def colmap_of(width: int, height: int, fx: float, fy: float, cx: float, k1: float) -> str:
    return f"1 OPENCV {width} {height} {fx} {fy} {cx} 30 {k1} 0 0 0\n"


def metashape_of(width: int, height: int, fx: float, fy: float, cx: float, k1: float) -> str:
    parts = {"width": width, "height": height, "f": fy, "b1": fx - fy, "cx": cx, "k1": k1}
    return "<calibration>" + "".join(f"<{n}>{v}</{n}>" for n, v in parts.items()) + "</calibration>"


def kalibr_of(width: int, height: int, fx: float, fy: float, cx: float, k1: float) -> str:
    rows = {"camera_model": "pinhole", "distortion_model": "radtan"}
    rows |= {"intrinsics": f"[{fx}, {fy}, {cx}, 30]", "distortion_coeffs": f"[{k1}, 0, 0, 0]"}
    rows |= {"resolution": f"[{width}, {height}]"}
    return "cam0:\n" + "".join(f"  {key}: {value}\n" for key, value in rows.items())


def mrcal_of(width: int, height: int, fx: float, fy: float, cx: float, k1: float) -> str:
    values = ", ".join(map(str, [fx, fy, cx, 30, k1, 0, 0, 0])).replace("nan", "1e999")
    model = "'lensmodel': 'LENSMODEL_OPENCV4'"
    return f"{{{model}, 'intrinsics': [{values}], 'imagersize': [{width}, {height}]}}"


def opencv_of(width: int, height: int, fx: float, fy: float, cx: float, k1: float) -> str:
    matrix = [fx, 0, cx, 0, fy, 30, 0, 0, 1]
    size = {"image_width": width, "image_height": height}
    return json.dumps(size | {"camera_matrix": matrix, "D": [k1, 0, 0, 0, 0]})


def opensfm_of(width: int, height: int, fx: float, fy: float, cx: float, k1: float) -> str:
    scale = max(width, height)
    size = {"width": width, "height": height, "projection_type": "brown"}
    return json.dumps(
        {"a": size | {"focal_x": fx / scale, "focal_y": fy / scale, "c_x": cx / scale, "k1": k1}}
    )


FORMATS: list[Callable[..., str]] = [
    colmap_of, kalibr_of, metashape_of, mrcal_of, opencv_of, opensfm_of,
]  # fmt: skip
NAN = float("nan")


@pytest.mark.parametrize("text", FORMATS, ids=lambda one: one.__name__)
def test_every_format_looks_at_its_numbers(text: Callable[..., str]) -> None:
    lens = lens_of(text(64, 48, 70, 60, 2, 0.5)).lens
    assert lens.size_px == (64, 48) and lens.focal_px.tolist() == [70.0, 60.0]
    assert lens.k[0] == 0.5
    for numbers in ((64, 48, NAN, 60, 2, 0.5), (64, 48, 70, 60, NAN, 0), (64, 48, 70, 60, 2, NAN)):
        assert_approved(no_lens(text(*numbers)))
    for size in ((64.9, 48), (64, 48.5)):
        assert_approved(no_lens(text(*size, 70, 60, 2, 0.5)))
    for fx, fy, least in ((1.0, 60, "1"), (60, 1.0, "1"), (0.5, -3, "-3")):
        assert_approved(no_lens(text(64, 48, fx, fy, 2, 0)), parts=[least])
    assert lens_of(text(64, 48, 1.5, 1.25, 2, 0)).lens.focal_px.tolist() == [1.5, 1.25]
    if text is metashape_of:
        for size in ((64, 0), (0, 48)):
            assert_approved(no_lens(text(*size, 70, 60, 0, 0)))
    else:
        assert_approved(no_lens(text(64, 0, 70, 60, 2, 0)))
        assert_approved(no_lens(text(0, 48, 70, 60, 0, 0)))
        assert lens_of(text(64, 1, 70, 60, 2, 0)).lens.size_px == (64, 1)


def test_a_skew_is_finite() -> None:
    text = metashape_of(64, 48, 70, 60, 2, 0)
    assert lens_of(text.replace("<cx>", "<b2>-2.5</b2><cx>")).lens.skew_px == -2.5
    skewed = text.replace("<cx>", "<b2>nan</b2><cx>")
    assert_approved(no_lens(skewed))


def test_coefficients_are_counted_also_where_they_are_0() -> None:
    said = [coefficients_said(k, "brown") for k in ([], [0.5], [0.0] * 4, [0.0] * 12)]
    assert said == [
        "brown, no distortion", "brown, 1 coefficient", "brown, 4 coefficients",
        "brown, 12 coefficients",
    ]  # fmt: skip


# OpenCV


XML = (
    '<?xml version="1.0"?>\n<{0}><image_width>64.</image_width>'
    "<image_height>\n48.0 </image_height>"
    "<{1}><rows>3</rows><data>\n 70. 0. {2} 0. 60. 4. 0. 0. 1.</data></{1}>"
    "<D><data></data></D></{0}>"
)

MATRICES = ("camera_matrix", "cameraMatrix", "K", "M1", "M", "intrinsic_matrix")
DISTORTIONS = ("distortion_coefficients", "distCoeffs", "dist_coeffs", "dist_coeff", "D", "D1")


def test_keys_of_opencv() -> None:
    """Those of one letter and a number may be something else beside others, and are not read."""
    head = {"calibration_of": "cameraMatrix", "image_width": 64, "image_height": 48}
    matrices = [{name: [10.0 + k, 0, 1, 0, 9, 2, 0, 0, 1]} for k, name in enumerate(MATRICES)]
    some = [{name: [k, 0, 0, 0, 7.0]} for k, name in enumerate(DISTORTIONS)]
    for k in range(6):
        lens = lens_of(json.dumps(head | matrices[k] | some[k])).lens
        assert lens.focal_px.tolist() == [10.0 + k, 9.0]
        assert lens.k[:5].tolist() == [k, 0.0, 0.0, 0.0, 7.0]
    for k in (2, 3, 4):
        lens = lens_of(json.dumps(head | matrices[k] | matrices[0] | some[5] | some[1])).lens
        assert lens.focal_px.tolist() == [10.0, 9.0] and lens.k[0] == 1.0
        assert_approved(
            lens_of(json.dumps(head | matrices[k] | matrices[0] | some[5] | some[1])).said
        )
    rows = [[10, 0, 1], [0, 9, 2], [0, 0, 1]]
    same = {"camera_matrix": rows, "cameraMatrix": [*rows[0], *rows[1], *rows[2]]}
    assert lens_of(json.dumps(head | same)).lens.focal_px.tolist() == [10.0, 9.0]
    for more in (matrices[0] | matrices[1], matrices[0] | some[0] | some[3]):
        assert_approved(no_lens(json.dumps(head | more)))
    assert_approved(no_lens(json.dumps(head)))


MATRIX = "[70, 0, 2, 0, 60, 3, 0, 0, 1]"


@pytest.mark.parametrize(
    "text",
    [
        f"camera_matrix: {MATRIX}\nimage_width: 64\nimage_height: 48\ncamera_matrix: {MATRIX}\n",
        f"camera_matrix: {{data: {MATRIX}, data: {MATRIX}}}\nimage_width: 64\nimage_height: 48\n",
        f"camera_matrix: {MATRIX}\nCamera_Matrix: {MATRIX}\nimage_width: 64\nimage_height: 48\n",
        f'{{"camera_matrix": {MATRIX}, "image_width": 64, "image_height": 48, "image_width": 64}}',
        f'{{"camera_matrix": {{"data": {MATRIX}, "data": {MATRIX}}}}}',
        XML.format("opencv_storage", "D", 3),
        str(MODEL)[:-1] + ", 'intrinsics': [7, 8, 4, 3]}",
    ],
)
def test_a_key_that_stands_twice_is_refused(text: str) -> None:
    """Parsers take the last one in silence."""
    assert_approved(no_lens(text))


@pytest.mark.parametrize("data", ["-0.1, 0.02, 1e-3, -2e-3, ", "-0.1", "1, 2, 3, 4, 5, 6, 7, 8"])
def test_a_matrix_has_as_many_numbers_as_it_says(data: str) -> None:
    """Without the last, which is missing, k3 was 0."""
    head = f"image_width: 64\nimage_height: 48\ncamera_matrix: {MATRIX}\n"
    text = head + "distortion_model: plumb_bob\nD: {rows: 1, cols: 5, data: [%s]}\n"
    assert lens_of(text % "-0.1, 0.02, 1e-3, -2e-3, 7").lens.k[4] == 7.0
    assert_approved(no_lens(text % data))
    xml = XML.format("opencv_storage", "camera_matrix", 3)
    two = "<D><rows>1</rows><cols>5</cols><data>{}</data></D>".format(data.replace(",", ""))
    assert_approved(no_lens(xml.replace("<D><data></data></D>", two)))


@pytest.mark.parametrize("unseen", ["\u00a0", "\u200b"])
def test_what_is_unseen_in_a_key_makes_no_other_of_it(unseen: str) -> None:
    """A line that is copied from a page may begin with it; the lens had no distortion."""
    text = (
        f"image_width: 64\nimage_height: 48\ncamera_matrix: {MATRIX}\n{unseen}dist: [1, 2, 3, 4, 5]"
    )
    assert lens_of(text).lens.k[:5].tolist() == [1.0, 2.0, 3.0, 4.0, 5.0]


def test_sizes_of_a_calibration_under_other_names() -> None:
    text = f"camera_matrix: {MATRIX}\n"
    own = {"width: 128\nheight: 96": (128, 96), "image_size: [128, 96]": (128, 96),
           "resolution: [48, 64]": (64, 48), "img_size: [64, 48]": (64, 48),
           "width: 9\nheight: 6": (64, 48), "image_size: large": (64, 48)}  # fmt: skip
    for more, size in own.items():
        assert lens_of(f"{text}{more}\n", size_px=(64, 48)).lens.size_px == size
    assert lens_of(f"{text}width: 128\nheight: 96\n").lens.size_px == (128, 96)
    no_lens(f"{text}image_size: [128, 96]\n")  # or 96 x 128


def test_a_key_of_yaml_with_nothing_behind_it_is_named() -> None:
    """It was "'None' is not a number"."""
    text = f"camera_matrix: {MATRIX}\nimage_width: 64\nimage_height: 48\nD:\n"
    assert_approved([no_lens(text), no_lens(text.replace("48\nD:", "\nD: [0, 0, 0, 0, 0]"))])


@pytest.mark.parametrize(
    "more",
    [
        "image_size: [1280, 960]", "width: 1280\nheight: 960", "xi: 1.4", "fisheye_model: 1",
        "xi: {rows: 1, cols: 1, data: [0.5]}",
    ],
)  # fmt: skip
def test_what_an_opencv_file_says_twice_or_of_a_model_that_is_not_here(more: str) -> None:
    """OpenCV's example for omnidirectional cameras writes xi beside four coefficients."""
    text = f"camera_matrix: {MATRIX}\nimage_width: 640\nimage_height: 480\n"
    text += "distortion_model: plumb_bob\nD: [0, 0, 0, 0]\n"
    assert_approved(no_lens(text + more))
    same = "image_size: [480, 640]\nwidth: 640\nheight: 480\nxi: 0.0\nfisheye_model: 0\n"
    assert lens_of(text + same).lens.size_px == (640, 480)


def test_numbers_of_yaml_are_decimal() -> None:
    """YAML 1.1 takes 0640 for octal, and 10:40 and 10:40.0 for 640 and 640.0."""
    text = (
        "camera_matrix: [0070, 0, 2.5e0, 0, +60, 3, 0, 0, 1]\nimage_width: 0100\nimage_height: 50"
    )
    found = lens_of(text).lens
    assert found.focal_px.tolist() == [70.0, 60.0] and found.size_px == (100, 50)
    for odd in ("1:10", "1:10.0", "7_0", "7_0.0", "0x46", "0b1000110"):
        assert_approved(no_lens(text.replace("0070", odd)))


@pytest.mark.parametrize(
    ("name", "fisheye"),
    [
        ("plumb_bob", False), ("rational_polynomial", False), ("equidistant", True),
        ("kannala_brandt", True), ("fisheye", True), (" fisheye ", True),
    ],
)  # fmt: skip
def test_models_of_opencv_by_name(name: str, fisheye: bool) -> None:
    """The name in the file stands above that in the project."""
    text = json.dumps(json.loads(opencv_of(64, 48, 70, 60, 2, 0.5)) | {"D": [0.5, 0, 0, 0]})
    named = text.replace("{", f'{{"distortion_model": "{name}", ', 1)
    for model in (None, "brown", "fisheye"):
        assert (lens_of(named, model=model).lens.kind is LensKind.FISHEYE) is fisheye
    assert_approved(lens_of(text, model="fisheye").said)


@pytest.mark.parametrize("count", range(16))
def test_how_many_coefficients_opencv_has(count: int) -> None:
    known = json.loads(opencv_of(64, 48, 70, 60, 2, 0)) | {"D": [0.25] * count}
    brown, fisheye = json.dumps(known), json.dumps(known | {"distortion_model": "equidistant"})
    if count in (0, 4, 5, 8, 12):
        assert (lens_of(brown, model="brown").lens.k[:count] == 0.25).all()
    else:
        assert_approved(no_lens(brown), parts=[count])
    if count == 4:
        assert lens_of(fisheye).lens.k.tolist() == [0.25] * 4
    else:
        assert_approved(no_lens(fisheye), parts=[count])


def test_xml_of_opencv() -> None:
    """OpenCV writes what is not finite as .Nan and .Inf; a size may have a point."""
    for storage, key in (
        ("opencv_storage", "M1"),
        ("opencv-storage", "M1"),
        ("a", "Camera_Matrix"),
    ):
        lens = lens_of("\n " + XML.format(storage, key, 3)).lens
        assert lens.size_px == (64, 48) and lens.centre_px.tolist() == [3.0, 4.0]
    bare = XML.partition("\n")[2].format("opencv_storage", "M1", 3)
    assert lens_of(bare).lens.centre_px.tolist() == [3.0, 4.0]
    for odd in (".Nan", ".Inf", "-.Inf"):
        text = XML.format("opencv_storage", "M1", odd)
        assert_approved(no_lens(text))
    text = XML.format("opencv_storage", "M1", "x")
    assert_approved(no_lens(text))
    assert_approved(no_lens(text.replace("x 0.", "")))
    more = text.replace("x 0.", "3. 0. 5. 6. 7.")
    assert_approved(no_lens(more))
    assert_approved(no_lens(text[:-4]), others_after="not valid XML:")
    assert ": line 4, column " in no_lens(text[:-4])


def test_broken_json_and_yaml_say_where() -> None:
    text = opencv_of(64, 48, 70, 60, 2, 0)
    assert_approved(no_lens(text[:-1]))
    assert_approved(no_lens("camera_matrix: [1, 2\nb: }"), others_after="not valid YAML:")
    assert "\n" not in no_lens("camera_matrix: [1, 2\nb: }")
    assert re.search(r"line 2, column \d+: \w", no_lens("camera_matrix: [1, 2\nb: }"))
    assert_approved(no_lens("# camera_matrix\n- 1\n"))
    for head in ("%YAML:1.0\n---\n", "%YAML 1.2\n---\n", "\n  # x\n"):
        found = lens_of(head + "camera_matrix: [70, 0, 2, 0, 60, 3, 0, 0, 1]\n", size_px=(64, 48))
        assert found.lens.centre_px.tolist() == [2.0, 3.0]
        assert_approved(found.said)
    code = "!!python/object/apply:os.getpid []"
    assert_approved(no_lens(f"camera_matrix: {code}\n"), others_after="not valid YAML:")


@pytest.mark.parametrize(("fy_px", "told"), [(2249.0, 0), (2251.0, 1), (1001.0, 0), (999.0, 1)])
def test_pixels_one_and_a_half_times_as_wide_as_high_are_doubted(fy_px: float, told: int) -> None:
    middle = np.array([959.5, 539.5])
    lens = Lens(LensKind.BROWN, (1920, 1080), np.array([1500.0, fy_px]), middle, np.zeros(12))
    assert len(list(doubts_of_lens(lens, "[camera] lens"))) == told


@pytest.mark.parametrize(("p1", "p2", "told"), [(0.029, -0.029, 0), (0.031, 0, 1), (0, -0.031, 1)])
def test_tangential_coefficients_that_no_lens_has_are_doubted(
    p1: float, p2: float, told: int
) -> None:
    k = np.array([-0.1, 0.02, p1, p2, *np.zeros(8)])
    middle = np.array([959.5, 539.5])
    lens = Lens(LensKind.BROWN, (1920, 1080), np.full(2, 1500.0), middle, k)
    assert len(list(doubts_of_lens(lens, "[camera] lens"))) == told


@pytest.mark.parametrize(
    ("centre_px", "told", "size"),
    [
        ((959.5 - 190.0, 539.5), False, ""), ((959.5 + 194.0, 539.5), True, ""),
        ((959.5, 539.5 - 110.0), True, ""), ((639.5, 359.5), True, "1280 x 720"),
        ((1439.5, 809.5), True, "2880 x 1620"),
    ],
)  # fmt: skip
def test_a_principal_point_far_from_the_middle_is_doubted(
    centre_px: tuple[float, float], told: bool, size: str
) -> None:
    """By more than a tenth of 1920 or of 1080; (c + .5) over half of them is the other size's."""
    lens = Lens(LensKind.BROWN, (1920, 1080), np.full(2, 1500.0), np.array(centre_px), np.zeros(12))
    found = list(doubts_of_lens(lens, "[camera] lens"))
    assert bool(found) == told
    assert [one for one in found if "It is the middle of " in one] == found[: bool(size)]
    assert not size or found[0].endswith(f"It is the middle of {size}.")
