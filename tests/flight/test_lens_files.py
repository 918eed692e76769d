"""Focal lengths, centres and coefficients of lens files and of inline lenses, worked by hand."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.flight.files import open_input, read_by_content
from vopd.flight.formats.lens import LENS_FORMATS, LensQuestion, LensRead
from vopd.flight.project import Project, Section
from vopd.flight.read import read_lens
from vopd.geometry.lenses import LensKind


def read(folder: Path, text: str, **question: Any) -> LensRead:
    (folder / "lens").write_text(text)
    return read_by_content(LENS_FORMATS, open_input("lens", folder), LensQuestion(**question))


def told(folder: Path, text: str, **question: Any) -> str:
    with pytest.raises(VopdError) as refused:
        read(folder, text, **question)
    return str(refused.value)


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
    assert found.said == f"lens: COLMAP, {name}, corner grid, half a pixel taken off"


def test_a_camera_of_colmap_by_its_number(tmp_path: Path) -> None:
    text = "12 PINHOLE 90 70 900 800 45 35\n2 PINHOLE 80 60 600 500 40 30\n"
    assert numbers(read(tmp_path, text, camera="2")) == [600, 500, 39.5, 29.5]
    assert numbers(read(tmp_path, text, camera="12")) == [900, 800, 44.5, 34.5]
    assert "lens: 0 cameras: name one by its number" in told(tmp_path, text, camera="1")
    assert "lens: line 1: could not convert" in told(
        tmp_path, text.replace("800", "x"), camera="12"
    )


def opensfm(**camera: Any) -> str:
    return json.dumps({"a": {"width": 400, "height": 300, "focal": 0.5} | camera})


@pytest.mark.parametrize(
    ("camera", "expected"),
    [
        ({}, [200, 200, 199.5, 149.5]),
        ({"width": 300, "height": 400}, [200, 200, 149.5, 199.5]),
        ({"c_x": 0.01, "c_y": -0.02}, [200, 200, 203.5, 141.5]),
        ({"width": 300, "height": 400, "c_x": 0.01, "c_y": -0.02}, [200, 200, 153.5, 191.5]),
        ({"focal_x": 0.75, "focal_y": 0.25}, [300, 100, 199.5, 149.5]),
        ({"k1": 0.1, "k2": 0.2, "k3": 0.3}, [200, 200, 199.5, 149.5, 0.1, 0.2]),
        ({"projection_type": "simple_radial", "k1": 0.1, "k2": 9}, [200, 200, 199.5, 149.5, 0.1]),
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
    assert found.said == f"lens: OpenSfM, {kind}, from the image's centre"


def test_a_camera_of_opensfm_by_its_name_and_in_a_reconstruction(tmp_path: Path) -> None:
    one, other = (json.loads(opensfm(focal=f))["a"] for f in (0.5, 0.75))
    text = json.dumps({"one": one, "other": other})
    assert numbers(read(tmp_path, text, camera="other"))[0] == 300.0
    assert "lens: 2 cameras: name one of its keys" in told(tmp_path, text)
    assert "lens: 0 cameras: name one of its keys" in told(tmp_path, text, camera="none")
    text = json.dumps([{"cameras": {"other": other}, "shots": {}}])
    assert numbers(read(tmp_path, text))[0] == 300.0
    assert "lens: a: a camera needs width, height, focal as numbers" in told(
        tmp_path, opensfm(focal="x")
    )


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
    assert "2 sensors: name one by its label with [camera] camera" in told(tmp_path, text)
    assert "0 sensors: name one by its label" in told(tmp_path, text, camera="cam 2")
    initial = text.replace('class="adjusted"', 'class="initial"')
    assert numbers(read(tmp_path, initial, camera="0"))[0] == 100.0
    assert "width and height are missing" in told(tmp_path, metashape("<f>200</f>"))
    assert "projection fisheye is not known" in told(tmp_path, metashape(SIZE, 'type="fisheye"'))
    assert "lens: f: 'x' is not a number" in told(tmp_path, metashape(SIZE + "<f>x</f>"))


@pytest.mark.parametrize(
    ("cx", "far"), [(99.9, False), (100.1, True), (-99.9, False), (-101, True)]
)
def test_a_centre_a_quarter_of_the_width_away_is_from_the_corner(
    cx: float, far: bool, tmp_path: Path
) -> None:
    text = metashape(f"{SIZE}<f>200</f><cx>{cx}</cx>")
    if far:
        assert "is it counted from the corner?" in told(tmp_path, text)
    else:
        assert numbers(read(tmp_path, text))[2] == 199.5 + cx


OPENCV = {"camera_matrix": [[900, 0, 45], [0, 800, 35], [0, 0, 1]], "image_width": 90,
          "image_height": 70}  # fmt: skip


@pytest.mark.parametrize(
    ("keys", "question", "expected", "fisheye"),
    [
        ({}, {}, [900, 800, 45, 35], False),
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


def test_the_size_in_an_opencv_file_is_the_calibration_s(tmp_path: Path) -> None:
    """Where it has none, the project says it; where both are there, the file's is given back."""
    text = json.dumps(OPENCV)
    assert read(tmp_path, text, size_px=(45, 35)).lens.size_px == (90, 70)
    without = json.dumps({"camera_matrix": OPENCV["camera_matrix"]})
    assert read(tmp_path, without, size_px=(45, 35)).lens.size_px == (45, 35)
    assert "the image's size is not in the file: give [camera] image_size_px" in told(
        tmp_path, without
    )
    for name in ("cameraMatrix", "M1", "K", "intrinsic_matrix"):
        other = text.replace("camera_matrix", name) + " " * ("camera" not in name.lower())
        if "camera" in name.lower():
            assert numbers(read(tmp_path, other)) == [900, 800, 45, 35]


# A lens in the project itself


def inline(size: tuple[int, int] | None, lens: dict[str, Any], **camera: Any) -> LensRead:
    values = {"lens": lens, **camera} | ({"image_size_px": list(size)} if size else {})
    return read_lens(Project("p.toml", Path(), {"camera": Section("p.toml", "camera", values)}))


FX = {"model": "brown", "fx_px": 900.0}


@pytest.mark.parametrize(
    ("lens", "camera", "expected", "said"),
    [
        (FX, {}, [900, 900, 199.5, 149.5], "brown, no distortion, principal point in the image's"),
        (FX | {"fy_px": 800}, {}, [900, 800, 199.5, 149.5], "brown, no distortion, principal"),
        (
            {"model": "brown", "focal_mm": 35.0, "sensor_mm": [36.0, 24.0]},
            {},
            [35 * 400 / 36, 35 * 300 / 24, 199.5, 149.5],
            "brown, no distortion, focal length by the sensor's size, principal point in the",
        ),
        (
            FX | {"cx_px": 200, "cy_px": 150},
            {"pixel_grid": "centre"},
            [900, 900, 200, 150],
            "brown, no distortion, centre grid",
        ),
        (
            FX | {"cx_px": 200, "cy_px": 150},
            {"pixel_grid": "corner"},
            [900, 900, 199.5, 149.5],
            "brown, no distortion, corner grid",
        ),
        (
            FX | {"cx_px": 200, "cy_px": 150, "k": [0.1]},
            {"pixel_grid": "one-based"},
            [900, 900, 199, 149],
            "1 coefficients; 0, 4, 5, 8, 12 are known",
        ),
        (
            FX | {"model": "fisheye", "k": [0.1, 0.2]},
            {},
            [900, 900, 199.5, 149.5, 0.1, 0.2],
            "fisheye, 2 coefficients, principal",
        ),
        (
            FX | {"model": "fisheye", "k": [0.1]},
            {},
            [900, 900, 199.5, 149.5, 0.1],
            "fisheye, 1 coefficient, principal",
        ),
    ],
)
def test_inline_lenses(
    lens: dict[str, Any], camera: dict[str, Any], expected: list[float], said: str
) -> None:
    if "are known" in said:
        with pytest.raises(VopdError, match=rf"p\.toml: \[camera\.lens\] k: {said}"):
            inline((400, 300), lens, **camera)
        lens = {key: value for key, value in lens.items() if key != "k"}
        said = "brown, no distortion, one-based grid"
    found = inline((400, 300), lens, **camera)
    assert_close("ratio", numbers(found), expected)
    assert found.said.startswith(f"lens: {said}") and found.lens.size_px == (400, 300)
    assert found.lens.skew_px == 0.0
    assert inline((400, 300), lens | {"skew_px": 1.5}, **camera).lens.skew_px == 1.5


TABLE = {"model": "radial-table", "fx_px": 900.0, "table_px": [[100, 1.0], [200, -2.0]]}
REFUSED = {
    "no size": (None, FX, "[camera] image_size_px: is needed with an inline lens"),
    "part of a pixel": ((400.5, 300), FX, "image_size_px: is width and height, whole numbers"),
    "no pixel": ((0, 300), FX, "image_size_px: is width and height, whole numbers of pixels"),
    "two focal lengths": (
        (4, 3), FX | {"focal_mm": 35, "sensor_mm": [36, 24]}, "focal_mm: fx_px is there too",
    ),
    "no focal length": ((4, 3), {"model": "brown"}, "fx_px: is needed, or focal_mm and sensor_mm"),
    "no sensor": ((4, 3), {"model": "brown", "focal_mm": 35}, "sensor_mm: is needed, 2 numbers"),
    "sensor of 0": (
        (4, 3), {"model": "brown", "focal_mm": 35, "sensor_mm": [0, 24]}, "both above 0",
    ),
    "focal length of 1": ((4, 3), FX | {"fx_px": 1.0}, "fx_px: 1 is not above 1"),
    "of the other side": ((4, 3), FX | {"fy_px": 1.0}, "fy_px: 1 is not above 1"),
    "one row": ((4, 3), TABLE | {"table_px": [[100, 1.0]]}, "two at least"),
    "a text": ((4, 3), TABLE | {"table_px": [[1, "x"], [2, 3]]}, "something that is not a number"),
    "not finite": ((4, 3), TABLE | {"table_px": [[1, 2], [2, float("inf")]]}, "is not finite"),
    "at the centre": ((4, 3), TABLE | {"table_px": [[0, 1], [2, 3]]}, "begins with nothing at"),
    "falling": ((4, 3), TABLE | {"table_px": [[1, 1], [1, 3]]}, "both radius and what comes out"),
    "folding": ((4, 3), TABLE | {"table_px": [[1, 1], [2, -0.1]]}, "both radius and what comes"),
    "two focal lengths of a table": ((4, 3), TABLE | {"fy_px": 800}, "leave fy_px out"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_inline_lenses_that_are_refused(case: str) -> None:
    size, lens, message = REFUSED[case]
    with pytest.raises(VopdError) as refused:
        inline(size, lens)
    assert str(refused.value).startswith("p.toml: [camera") and message in str(refused.value)


def test_a_radial_table_begins_at_the_centre() -> None:
    for rows in ([[100, 1.0], [200, -2.0]], [[0, 0], [100, 1.0], [200, -2.0]]):
        table = inline((400, 300), TABLE | {"table_px": rows}).lens.table
        assert table is not None and table.tolist() == [[0, 0], [100, 1.0], [200, -2.0]]


@pytest.mark.parametrize(
    ("size", "message"),
    [([90, 70], ""), ([70, 90], r"70 x 90, but lens is a calibration for 90 x 70 \(turned by 90"),
     ([45, 35], "45 x 35, but lens is a calibration for 90 x 70; a calibration serves")],
)  # fmt: skip
def test_a_calibration_is_of_images_of_one_size(
    size: list[int], message: str, tmp_path: Path
) -> None:
    (tmp_path / "lens").write_text(json.dumps(OPENCV))
    values = {"lens": "lens", "image_size_px": size}
    project = Project("p.toml", tmp_path, {"camera": Section("p.toml", "camera", values)})
    if message:
        with pytest.raises(VopdError, match=message):
            read_lens(project)
    else:
        assert read_lens(project).lens.size_px == (90, 70)


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
RECOGNISED = {
    "colmap": ("COLMAP cameras.txt", "# x\n\n  7 PINHOLE 90 70 900 800 45 35\n"),
    "opensfm": ("OpenSfM or ODM cameras.json", "\n " + opensfm()),
    "opensfm, x": ("OpenSfM or ODM cameras.json", opensfm(focal_x=0.5)),
    "metashape": ("Metashape XML", metashape(SIZE + "<f>200</f>")),
    "opencv json": ("OpenCV yml, xml or json", json.dumps(OPENCV)),
    "opencv xml": ("OpenCV yml, xml or json", OPENCV_XML),
    "opencv yml": ("OpenCV yml, xml or json", OPENCV_YML),
    "mrcal": (
        "mrcal",
        "# made by hand\n{'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': [900, 800, 45, 35],"
        "'imagersize': [90, 70]}",
    ),
}


@pytest.mark.parametrize("name", RECOGNISED)
def test_a_format_is_recognised_by_its_content(name: str, tmp_path: Path) -> None:
    """Also with words that another format has: OpenCV's files may have a time of calibration."""
    expected, text = RECOGNISED[name]
    (tmp_path / "lens").write_text(text)
    file = open_input("lens", tmp_path)
    first = next(one for one in LENS_FORMATS if one.recognises(file))
    assert first.name == expected
    if name not in ("opensfm", "opensfm, x", "metashape"):
        assert numbers(read(tmp_path, text))[:2] == [900, 800]
