"""Inline lenses of a project, and what a project says of the file of a lens."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit.command import vopd as run
from vopd.findings import VopdError
from vopd.flight.formats.lens import LensRead
from vopd.flight.project.camera import read_lens
from vopd.flight.project.inspect import lens_of_numbers
from vopd.flight.project.keys import Project, Section

UNSIZED = '{"camera_matrix": [70, 0, 2, 0, 60, 3, 0, 0, 1]}'
SIZED = ', "image_width": 64, "image_height": 48}'


def lens(folder: Path, lens: Any, **values: Any) -> LensRead:
    section = Section("p.toml", "camera", {"lens": lens} | values)
    return read_lens(Project("p.toml", folder, {"camera": section}))


def refusal(folder: Path, inside: Any, **values: Any) -> str:
    with pytest.raises(VopdError) as told:
        lens(folder, inside, **values)
    return str(told.value).removeprefix("p.toml: [camera")


def test_a_calibration_of_another_size_is_scaled_with_its_standard_deviations(
    tmp_path: Path,
) -> None:
    """Of half the size; what is in pixels is halved, and the distortion is of angles."""
    matrix = np.diag([16.0, 4.0, 9.0, 1e-4]).ravel()
    (tmp_path / "m.xml").write_text(
        "<calibration><width>200</width><height>100</height><f>400</f><b2>6</b2><covariance>"
        f"<params>f cx cy k1</params><coeffs>{' '.join(map(str, matrix))}</coeffs></covariance>"
        "</calibration>"
    )
    found = lens(tmp_path, "m.xml", image_size_px=[100, 50], lens_size_px=[200, 100])
    assert (found.lens.focal_px.tolist(), found.lens.skew_px) == ([200.0, 200.0], 3.0)
    assert found.sigma == {"focal": 2.0, "centre_u": 1.0, "centre_v": 1.5, "k1": 0.01}


def test_what_the_project_says_of_a_file(tmp_path: Path) -> None:
    (tmp_path / "cameras").write_text("1 PINHOLE 64 48 70 60 2 3\n" + "2 PINHOLE 6 4 7 8 3 2\n")
    four = json.loads(UNSIZED[:-1] + SIZED) | {"D": [0.5, 0, 0, 0]}
    (tmp_path / "four").write_text(json.dumps(four))
    (tmp_path / "unsized").write_text(UNSIZED)
    assert lens(tmp_path, "cameras", camera="2").lens.size_px == (6, 4)
    assert lens(tmp_path, "cameras", camera="1", image_size_px=[64, 48]).lens.size_px == (64, 48)
    for model in ("brown", "fisheye"):
        assert lens(tmp_path, "four", model=model).lens.kind.value == model
    said = refusal(tmp_path, "four", model="radial-table")
    assert_approved(said)
    assert lens(tmp_path, "unsized", image_size_px=[9, 8]).lens.size_px == (9, 8)
    for size in ((64, 47), (63, 48), (48, 64)):
        assert_approved(
            refusal(tmp_path, "cameras", camera="1", image_size_px=[*size]),
            parts=[size[0], size[1]],
        )


def test_a_lens_that_is_said_to_be_of_another_model_is_refused(tmp_path: Path) -> None:
    (tmp_path / "cameras").write_text("1 PINHOLE 64 48 70 60 2 3\n")
    for inside in ("cameras", FX):
        assert lens(tmp_path, inside, model="brown", image_size_px=[64, 48]).lens.size_px
        assert_approved(refusal(tmp_path, inside, model="fisheye", image_size_px=[64, 48]))


FX = {"model": "brown", "fx_px": 90.0}
TABLE = {"model": "radial-table", "fx_px": 90.0, "table_px": [[10, 1.0], [20, -2.0]]}


@pytest.mark.parametrize(
    "inside",
    [
        FX | {"cx_px": 5},
        FX | {"cy_px": 5},
        FX | {"fy_px": 1},
        FX | {"fx_px": 1},
        FX | {"model": "pinhole"},
        FX | {"k": 0.1},
        FX | {"k": "x"},
        FX | {"f_px": 3},
        *[FX | {"k": [0.1] * count} for count in (1, 2, 3, 6, 7, 9, 11, 13, 14)],
        FX | {"model": "fisheye", "k": [0] * 5},
        *[
            {"model": "brown", "focal_mm": f, "sensor_mm": size}
            for f, size in ((0, [36, 24]), (35, [36, 0]), (35, [-36, 24]), (35, [36]))
        ],
        *[
            TABLE | {"table_px": rows}
            for rows in (3, [[1, 2]], [[1, 2], [2, 3, 4]], [[1, 2], 3], [[1, 2], [3]])
        ],
        TABLE | {"table_px": [[1, "x"], [2, 3]]},
        TABLE | {"table_px": [[1, {}], [2, 3]]},
        TABLE | {"table_px": [[1, 2], [2, float("nan")]]},
        *[
            TABLE | {"table_px": rows}
            for rows in (
                [[0, 1], [2, 3]],
                [[-1, 0], [2, 3]],
                [[1, 1], [1, 3]],
                [[1, 1], [2, 0]],
                [[2, 0], [1, 2]],
            )
        ],
        TABLE | {"fy_px": 91},
        *[FX | {"k": empty} for empty in (0, "", {}, False)],
    ],
)
def test_inline_lenses_that_are_refused(inside: dict[str, Any]) -> None:
    said = refusal(Path(), inside, image_size_px=[64, 48], pixel_grid="centre")
    assert_approved(said)


@pytest.mark.parametrize("size", [[64.5, 48], [64, 48.5], [0, 48], [64, 0], [-64, 48]])
def test_a_size_is_whole_and_above_0(size: list[float]) -> None:
    assert_approved(refusal(Path(), FX, image_size_px=size))
    assert lens(Path(), FX, image_size_px=[1, 1]).lens.size_px == (1, 1)


def test_a_centre_needs_its_grid() -> None:
    message = "] pixel_grid: is needed: centre, corner, one-based"
    assert refusal(Path(), FX | {"cx_px": 5, "cy_px": 4}, image_size_px=[64, 48]) == message


def test_inline_lenses_at_their_limits() -> None:
    def found(inside: dict[str, Any], **values: Any) -> LensRead:
        return lens(Path(), inside, image_size_px=[64, 48], **values)

    for count in range(5):
        k = [0.5 + one for one in range(count)]
        fisheye = found(FX | {"model": "fisheye", "k": k})
        assert fisheye.lens.k.tolist() == k + [0.0] * (4 - count)
        if count in (0, 4):
            assert found(FX | {"k": k}).lens.k[:count].tolist() == k
    assert found(FX | {"fx_px": 1.5, "fy_px": 1.25}).lens.focal_px.tolist() == [1.5, 1.25]
    by_sensor = found({"model": "brown", "focal_mm": 10, "sensor_mm": [32, 16]})
    assert by_sensor.lens.focal_px.tolist() == [20.0, 30.0]  # 10 of 64 / 32, 10 of 48 / 16
    assert_approved(by_sensor.said)
    table = found(TABLE)
    assert_approved(table.said)
    assert table.lens.centre_px.tolist() == [31.5, 23.5]
    given = TABLE | {"cx_px": 30, "cy_px": 20, "table_px": [[1, 0.5], [2, -0.4]]}
    for grid, shift in (("centre", 0.0), ("corner", -0.5), ("one-based", -1.0)):
        one = found(given, pixel_grid=grid)
        assert one.lens.centre_px.tolist() == [30.0 + shift, 20.0 + shift]
        assert_approved(one.said, parts=[grid])
        assert one.lens.table is not None
        assert one.lens.table.tolist() == [[0.0, 0.0], [1.0, 0.5], [2.0, -0.4]]
        assert one.lens.focal_px.tolist() == [90.0, 90.0] and one.lens.skew_px == 0.0
    sensor = {"focal_mm": 10, "sensor_mm": [32, 24], "cx_px": 3, "cy_px": 2, "skew_px": 0.5}
    both = found({"model": "brown"} | sensor, pixel_grid="corner")
    assert_approved(both.said)
    assert both.lens.skew_px == 0.5


UNUSED: dict[str, dict[str, Any]] = {
    "a table of another model": TABLE | FX,
    "coefficients beside a table": TABLE | {"k": [0.5]},
    "a skew beside a table": TABLE | {"skew_px": 0.5},
    "a sensor beside pixels": FX | {"sensor_mm": [32, 16]},
    "a focal length in mm and along v in pixels": {
        "model": "brown", "focal_mm": 10, "sensor_mm": [32, 24], "fy_px": 25.0,
    },
}  # fmt: skip


@pytest.mark.parametrize("name", UNUSED)
def test_numbers_that_a_lens_does_not_use(name: str) -> None:
    """They were left out without a word."""
    assert_approved(refusal(Path(), UNUSED[name], image_size_px=[64, 48]))


LENGTHS = {1: None, 4: None, 5: 4, 6: 4, 8: 4, 9: 5}  # how many numbers are given, and k has


@pytest.mark.parametrize("count", range(1, 12))
def test_a_lens_of_numbers_has_those_that_opencv_has(count: int) -> None:
    """Focal length; or fx, fy, cx, cy and k1, k2, p1, p2, k3, of which two or four may lack."""
    numbers = [float(k) for k in range(2, count + 2)]
    given = ", ".join(map(str, numbers))
    if count not in LENGTHS:
        with pytest.raises(VopdError, match=f"^{count} numbers: "):
            lens_of_numbers(given)
        return
    text = lens_of_numbers(given)
    found = tomllib.loads(f"lens = {text}")["lens"]
    names = ("fx_px", "fy_px", "cx_px", "cy_px")
    expected: dict[str, Any] = {"model": "brown", **dict(zip(names, numbers, strict=False))}
    if (length := LENGTHS[count]) is not None:
        expected["k"] = [*numbers[4:], *[0.0] * (length + 4 - count)]
    assert found == expected


def test_numbers_of_a_fisheye_are_written_as_one(tmp_path: Path) -> None:
    """The key is for files of four numbers; of a table it is the table's own model."""
    folder = tmp_path / "mine"
    ran = run(
        "new", folder, "--lens", "870,870,959.5,539.5,0.03,-0.01,0.003,0.0", "--set",
        "camera.model=fisheye", "--image-size", "1920,1080", "--pixel-grid", "centre",
    )  # fmt: skip
    camera = tomllib.loads((folder / "flight.toml").read_text())["camera"]
    assert ran.status == 0 and "model" not in camera
    assert camera["lens"]["k"] == [0.03, -0.01, 0.003, 0.0]
    assert lens(tmp_path, camera.pop("lens"), **camera).lens.kind.value == "fisheye"
    assert_approved(
        run("new", folder, "--set", "camera.lens.model=fisheye").stderr.splitlines()[-1:]
    )
