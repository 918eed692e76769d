"""Variants of Metashape's, mrcal's, OpenSfM's and COLMAP's lens files, and what is said of them."""

from __future__ import annotations

import json
from typing import Any

import pytest

from tests.kit.flight_project import lens_told as told
from tests.kit.flight_project import read_lens_text as read
from tests.tolerances import assert_close

# Metashape


def calibration(inside: str, attributes: str = "") -> str:
    return f"<calibration {attributes}><f>200</f>{inside}</calibration>"


SIZE = "<width>400</width><height>300</height>"
OTHER_SIZE = '<resolution width="800" height="600"/>'
FRAME = "<projection>{}</projection>"


@pytest.mark.parametrize(
    ("projection", "own", "sensor", "refused"),
    [
        ("", "", "", ""), (" frame ", "", "", ""), ("", " frame ", "", ""), ("", "", " frame ", ""),
        ("fisheye", "frame", "frame", "fisheye"), ("frame", "fisheye", "fisheye", ""),
        ("", "fisheye", "frame", "fisheye"), ("", "frame", "fisheye", ""),
        ("", "", " spherical ", "spherical"), ("equidistant", "", "", "equidistant"),
    ],
)  # fmt: skip
def test_a_projection_is_the_calibration_s_and_then_the_sensor_s(
    projection: str, own: str, sensor: str, refused: str
) -> None:
    inside = SIZE + (FRAME.format(projection) if projection else "")
    text = calibration(inside, f'type="{own}"' if own else "")
    of = f'type="{sensor}"' if sensor else ""
    text = f'<document><sensor id="0" label="a" {of}>{text}</sensor></document>'
    if refused:
        assert told(text) == f"lens: projection {refused} is not known; frame is"
    else:
        said = "lens: Metashape, frame, p1 and p2 exchanged, corner grid"
        assert read(text).said == said


@pytest.mark.parametrize(
    ("inside", "outside", "size"),
    [
        (SIZE, "", (400, 300)), (SIZE + OTHER_SIZE, "", (400, 300)), (OTHER_SIZE, "", (800, 600)),
        (SIZE, OTHER_SIZE, (400, 300)), ("", OTHER_SIZE, (800, 600)),
        (OTHER_SIZE, '<resolution width="9" height="9"/>', (800, 600)),
        ("<width>400</width>", "", None), ("<height>300</height>", "", None),
        ("", '<resolution width="9"/>', None), ("", '<resolution height="9"/>', None),
    ],
)  # fmt: skip
def test_a_size_is_the_calibration_s_and_then_the_sensor_s(
    inside: str, outside: str, size: tuple[int, int] | None
) -> None:
    text = f"<a><sensor>{outside}{calibration(inside)}</sensor></a>"
    if size is None:
        assert told(text) == "lens: the image's width and height are missing"
    else:
        lens = read(text).lens
        assert lens.size_px == size
        assert lens.centre_px.tolist() == [(size[0] - 1) / 2, (size[1] - 1) / 2]


def test_what_metashape_s_files_are_refused_for() -> None:
    for k4 in ("1e-9", "-1e-9"):
        assert told(calibration(f"{SIZE}<k4>{k4}</k4>")) == (
            "lens: k4 is of the eighth power, which no model here has: calibrate without"
        )
    assert read(calibration(f"{SIZE}<k4>0</k4>")).lens.k.tolist() == [0.0] * 12
    for name in ("f", "cx", "cy", "k1", "k2", "k3", "k4", "p1", "p2", "b1", "b2", "width"):
        text = calibration(SIZE.replace("400", "x") if name == "width" else f"{SIZE}")
        text = text.replace(">200<", ">x<") if name == "f" else text
        if name not in ("width", "f"):
            text = calibration(f"{SIZE}<{name}>x</{name}>")
        assert told(text) == f"lens: {name}: 'x' is not a number"
    assert read(calibration(SIZE + "<cx>100</cx>")).lens.centre_px.tolist() == [299.5, 149.5]
    assert read(calibration(SIZE + "<cx>-100</cx>")).lens.centre_px.tolist() == [99.5, 149.5]
    far = "lens: cx is far from the image's middle: is it counted from the corner?"
    for cx in ("100.5", "-100.5"):
        assert told(calibration(f"{SIZE}<cx>{cx}</cx>")) == far
    assert told("<a><sensor/>" + "<calibration/>" + "</a>") == "lens: no calibration is in the file"
    assert told(calibration(SIZE)[:-1]).startswith("lens: not valid XML: unclosed token: line 1")
    filled = f"\n <?xml version='1.0'?><!-- {'x' * 30_000}\n -->"
    assert read(filled + calibration(SIZE)).lens.size_px == (400, 300)


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
        found = read(text)
        assert found.lens.size_px == (64, 48) and found.lens.focal_px.tolist() == [9.0, 8.0]
        assert found.said == "lens: mrcal, brown, no distortion, centre grid"
    for count in (4, 5, 8, 12):
        k = [0.25 * one for one in range(1, count + 1)]
        model = {"lensmodel": f"LENSMODEL_OPENCV{count}", "intrinsics": [9, 8, 4, 3, *k]}
        found = read(str(MODEL | model))
        assert found.lens.k[:count].tolist() == k
        assert found.said == f"lens: mrcal, brown, {count} coefficients, centre grid"
    known = "LENSMODEL_ PINHOLE, OPENCV4, OPENCV5, OPENCV8, OPENCV12 are"
    assert told(str(MODEL | {"lensmodel": "LENSMODEL_OPENCV14"})) == (
        f"lens: model LENSMODEL_OPENCV14 is not known; {known}"
    )


@pytest.mark.parametrize(
    "wrong",
    [
        "['LENSMODEL_PINHOLE']", "{'LENSMODEL_PINHOLE'", str(MODEL | {"imagersize": 64}),
        str(MODEL | {"imagersize": [64]}), str(MODEL | {"intrinsics": ["x"]}),
        str(MODEL).replace("'imagersize'", "'size'"), "LENSMODEL_PINHOLE",
    ],
)  # fmt: skip
def test_what_is_no_model_of_mrcal(wrong: str) -> None:
    assert told(wrong).startswith("lens: not a mrcal camera model: ")


# OpenSfM


def opensfm(**camera: Any) -> str:
    return json.dumps({"a": {"width": 400, "height": 300, "focal": 0.5} | camera})


def test_what_opensfm_s_files_are_refused_for() -> None:
    known = "perspective, simple_radial, radial, brown, fisheye, fisheye_opencv are"
    assert (
        told(opensfm(projection_type="dual")) == f"lens: a: projection dual is not known; {known}"
    )
    for key in ("width", "height", "focal", "k1", "c_x", "c_y"):
        for wrong in ("x", None, [1]):
            assert told(opensfm(**{key: wrong})).startswith(
                "lens: a: a camera needs width, height, focal as numbers: "
            )
    missing = json.dumps({"b": {"width": 400, "focal": 0.5}})
    assert told(missing).endswith(
        "lens: b: a camera needs width, height, focal as numbers: 'height'"
    )
    assert told(opensfm()[:-1]).startswith("lens: not valid JSON: Expecting ',' delimiter: line 1")
    none = "lens: 0 cameras: name one of its keys with [camera] camera"
    assert told(opensfm(), camera="b") == none
    assert told('[{"cameras": {}, "width": 1, "focal": 1}]') == none


def test_a_reconstruction_of_opensfm_is_the_first() -> None:
    one, other = json.loads(opensfm()), json.loads(opensfm(focal=0.75))
    text = "\n" + json.dumps([{"cameras": one}, {"cameras": other}])
    assert_close("ratio", read(text).lens.focal_px, [200.0, 200.0])
    assert_close("ratio", read(opensfm(focal_x=0.75)).lens.focal_px, [300.0, 300.0])
    text = opensfm().replace('"a"', '"camera_matrix"')  # also a word of OpenCV's
    assert read(text).said == "lens: OpenSfM, perspective, from the image's centre"
    brown = {"projection_type": "brown", "k1": 1, "k2": 2, "p1": 3, "p2": 4, "k3": 5}
    assert read(opensfm(**brown)).lens.k[:6].tolist() == [1.0, 2.0, 3.0, 4.0, 5.0, 0.0]


# COLMAP


def test_what_colmap_s_files_are_refused_for() -> None:
    models = (
        "SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, FULL_OPENCV, OPENCV_FISHEYE, "
        "SIMPLE_RADIAL_FISHEYE, RADIAL_FISHEYE, SIMPLE_FISHEYE, FISHEYE are"
    )
    assert told("# x\n1 FOV 90 70 1 2\n") == f"lens: line 2: model FOV is not known; {models}"
    for number, text in (
        (1, "1 PINHOLE 90 70 9 8 x 3\n"),
        (3, "\n  # a\n1 RADIAL 90 70 9 8 3 1 y"),
    ):
        assert told(text).startswith(f"lens: line {number}: could not convert string to float: '")
    assert told("1 PINHOLE 90 70 9 8 3\n") == "lens: line 1: PINHOLE has 4 parameters, not 3"
    assert told("1 RADIAL 90 70 9 8 3\n") == "lens: line 1: RADIAL has 5 parameters, not 3"
    two = "1 PINHOLE 90 70 9 8 4 3\n2 PINHOLE 90 70 9 7 4 3\n"
    number = "name one by its number with [camera] camera"
    assert told(two) == f"lens: 2 cameras: {number}"
    assert told(two, camera="3") == f"lens: 0 cameras: {number}"
    assert read(two, camera="2").lens.focal_px.tolist() == [9.0, 7.0]
    assert read("1 PINHOLE 90 70 9 8 4 3\n", camera="1").lens.size_px == (90, 70)
