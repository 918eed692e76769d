"""What a number of a lens must be, in every format; the keys and models that formats have."""

from __future__ import annotations

import json
from collections.abc import Callable

import pytest

from tests.kit.flight_project import lens_told as told
from tests.kit.flight_project import read_lens_text as read
from vopd.flight.formats.lens import coefficients_said
from vopd.geometry.lenses import LensKind


def colmap(width: int, height: int, fx: float, fy: float, cx: float, k1: float) -> str:
    return f"1 OPENCV {width} {height} {fx} {fy} {cx} 30 {k1} 0 0 0\n"


def metashape(width: int, height: int, fx: float, fy: float, cx: float, k1: float) -> str:
    parts = {"width": width, "height": height, "f": fy, "b1": fx - fy, "cx": cx, "k1": k1}
    return "<calibration>" + "".join(f"<{n}>{v}</{n}>" for n, v in parts.items()) + "</calibration>"


def mrcal(width: int, height: int, fx: float, fy: float, cx: float, k1: float) -> str:
    values = ", ".join(map(str, [fx, fy, cx, 30, k1, 0, 0, 0])).replace("nan", "1e999")
    model = "'lensmodel': 'LENSMODEL_OPENCV4'"
    return f"{{{model}, 'intrinsics': [{values}], 'imagersize': [{width}, {height}]}}"


def opencv(width: int, height: int, fx: float, fy: float, cx: float, k1: float) -> str:
    matrix = [fx, 0, cx, 0, fy, 30, 0, 0, 1]
    size = {"image_width": width, "image_height": height}
    return json.dumps(size | {"camera_matrix": matrix, "D": [k1, 0, 0, 0, 0]})


def opensfm(width: int, height: int, fx: float, fy: float, cx: float, k1: float) -> str:
    scale = max(width, height)
    size = {"width": width, "height": height, "projection_type": "brown"}
    return json.dumps(
        {"a": size | {"focal_x": fx / scale, "focal_y": fy / scale, "c_x": cx / scale, "k1": k1}}
    )


FORMATS: list[Callable[..., str]] = [colmap, metashape, mrcal, opencv, opensfm]
NAN = float("nan")


@pytest.mark.parametrize("text", FORMATS, ids=lambda one: one.__name__)
def test_every_format_looks_at_its_numbers(text: Callable[..., str]) -> None:
    lens = read(text(64, 48, 70, 60, 2, 0.5)).lens
    assert lens.size_px == (64, 48) and lens.focal_px.tolist() == [70.0, 60.0]
    assert lens.k[0] == 0.5
    for numbers in ((64, 48, NAN, 60, 2, 0.5), (64, 48, 70, 60, NAN, 0), (64, 48, 70, 60, 2, NAN)):
        assert told(text(*numbers)) == "lens: the lens has a number that is not finite"
    for fx, fy, least in ((1.0, 60, "1"), (60, 1.0, "1"), (0.5, -3, "-3")):
        assert (
            told(text(64, 48, fx, fy, 2, 0)) == f"lens: focal length {least} px: is it in pixels?"
        )
    assert read(text(64, 48, 1.5, 1.25, 2, 0)).lens.focal_px.tolist() == [1.5, 1.25]
    if text is metashape:
        for size in ((64, 0), (0, 48)):
            assert told(text(*size, 70, 60, 0, 0)) == (
                "lens: the image's width and height are missing"
            )
    else:
        assert told(text(64, 0, 70, 60, 2, 0)) == "lens: the image's size is 64 x 0 px"
        assert told(text(0, 48, 70, 60, 0, 0)) == "lens: the image's size is 0 x 48 px"
        assert read(text(64, 1, 70, 60, 2, 0)).lens.size_px == (64, 1)


def test_a_skew_is_finite() -> None:
    text = metashape(64, 48, 70, 60, 2, 0)
    assert read(text.replace("<cx>", "<b2>-2.5</b2><cx>")).lens.skew_px == -2.5
    skewed = text.replace("<cx>", "<b2>nan</b2><cx>")
    assert told(skewed) == "lens: the lens has a number that is not finite"


def test_coefficients_are_counted_also_where_they_are_0() -> None:
    said = [coefficients_said(k, "brown") for k in ([], [0.5], [0.0] * 4, [0.0] * 12)]
    assert said == [
        "brown, no distortion", "brown, 1 coefficient", "brown, 4 coefficients",
        "brown, 12 coefficients",
    ]  # fmt: skip


# OpenCV


MATRICES = ("camera_matrix", "cameraMatrix", "K", "M1", "M", "intrinsic_matrix")
DISTORTIONS = ("distortion_coefficients", "distCoeffs", "dist_coeffs", "dist_coeff", "D", "D1")


def test_of_several_keys_of_opencv_the_first_of_the_list_counts() -> None:
    head = {"calibration_of": "cameraMatrix", "image_width": 64, "image_height": 48}
    for first in range(6):
        matrices = {MATRICES[k]: [10.0 + k, 0, 1, 0, 9, 2, 0, 0, 1] for k in range(first, 6)}
        some = {DISTORTIONS[k]: [k, 0, 0, 0, 7.0] for k in range(first, 6)}
        lens = read(json.dumps(head | dict(reversed((matrices | some).items())))).lens
        assert lens.focal_px.tolist() == [10.0 + first, 9.0]
        assert lens.k[:5].tolist() == [first, 0.0, 0.0, 0.0, 7.0]
    looked = "camera_matrix, cameramatrix, k, m1, m, intrinsic_matrix"
    assert told(json.dumps(head)) == f"lens: no camera matrix: looked for {looked}"


@pytest.mark.parametrize(
    ("name", "fisheye"),
    [
        ("plumb_bob", False), ("rational_polynomial", False), ("equidistant", True),
        ("kannala_brandt", True), ("fisheye", True), (" fisheye ", True),
    ],
)  # fmt: skip
def test_models_of_opencv_by_name(name: str, fisheye: bool) -> None:
    """The name in the file stands above that in the project."""
    text = json.dumps(json.loads(opencv(64, 48, 70, 60, 2, 0.5)) | {"D": [0.5, 0, 0, 0]})
    named = text.replace("{", f'{{"distortion_model": "{name}", ', 1)
    for model in (None, "brown", "fisheye"):
        assert (read(named, model=model).lens.kind is LensKind.FISHEYE) is fisheye
    assert read(text, model="fisheye").said == "lens: OpenCV, fisheye, 4 coefficients, centre grid"


@pytest.mark.parametrize("count", range(16))
def test_how_many_coefficients_opencv_has(count: int) -> None:
    known = json.loads(opencv(64, 48, 70, 60, 2, 0)) | {"D": [0.25] * count}
    brown, fisheye = json.dumps(known), json.dumps(known | {"distortion_model": "equidistant"})
    if count in (0, 4, 5, 8, 12):
        assert (read(brown, model="brown").lens.k[:count] == 0.25).all()
    else:
        hint = " (a tilted sensor is not)" if count == 14 else ""
        assert told(brown) == f"lens: {count} coefficients; 0, 4, 5, 8, 12 are known{hint}"
    if count == 4:
        assert read(fisheye).lens.k.tolist() == [0.25] * 4
    else:
        assert told(fisheye) == f"lens: a fisheye has 4 coefficients, not {count}"


XML = (
    '<?xml version="1.0"?>\n<{0}><image_width>64.</image_width>'
    "<image_height>\n48.0 </image_height>"
    "<{1}><rows>3</rows><data>\n 70. 0. {2} 0. 60. 4. 0. 0. 1.</data></{1}>"
    "<D><data></data></D></{0}>"
)


def test_xml_of_opencv() -> None:
    """OpenCV writes what is not finite as .Nan and .Inf; a size may have a point."""
    for storage, key in (
        ("opencv_storage", "M1"),
        ("opencv-storage", "M1"),
        ("a", "Camera_Matrix"),
    ):
        lens = read("\n " + XML.format(storage, key, 3)).lens
        assert lens.size_px == (64, 48) and lens.centre_px.tolist() == [3.0, 4.0]
    bare = XML.partition("\n")[2].format("opencv_storage", "M1", 3)
    assert read(bare).lens.centre_px.tolist() == [3.0, 4.0]
    for odd in (".Nan", ".Inf", "-.Inf"):
        text = XML.format("opencv_storage", "M1", odd)
        assert told(text) == "lens: the lens has a number that is not finite"
    text = XML.format("opencv_storage", "M1", "x")
    assert told(text).startswith("lens: a matrix element is not a number: could not convert")
    assert told(text.replace("x 0.", "")) == "lens: the camera matrix has 7 elements, not 9"
    more = text.replace("x 0.", "3. 0. 5. 6. 7.")
    assert told(more) == "lens: the camera matrix has 12 elements, not 9"
    assert told(text[:-4]).startswith("lens: not valid XML: unclosed token: line 4, column")


def test_broken_json_and_yaml_say_where() -> None:
    text = opencv(64, 48, 70, 60, 2, 0)
    assert told(text[:-1]).startswith("lens: not valid JSON: Expecting ',' delimiter: line 1 colu")
    assert told("camera_matrix: [1, 2\nb: }").startswith("lens: not valid YAML: while parsing a ")
    assert "\n" not in told("camera_matrix: [1, 2\nb: }")
    assert told("# camera_matrix\n- 1\n") == "lens: no keys are in the file"
    for head in ("%YAML:1.0\n---\n", "%YAML 1.2\n---\n", "\n  # x\n"):
        found = read(head + "camera_matrix: [70, 0, 2, 0, 60, 3, 0, 0, 1]\n", size_px=(64, 48))
        assert found.lens.centre_px.tolist() == [2.0, 3.0]
        assert found.said == "lens: OpenCV, brown, no distortion, centre grid"
    code = "!!python/object/apply:os.getpid []"
    assert "not valid YAML: could not determine a constructor" in told(f"camera_matrix: {code}\n")
