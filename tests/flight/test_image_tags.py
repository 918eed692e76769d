"""Positions and gimbal angles from the tags of images."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import vopd
from tests.kit.command import vopd as run
from tests.kit.flight_project import TOML, camera_m, truth_deg, write_project
from tests.kit.tagged_images import tagged_image
from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.flight.image_tags import read_tags
from vopd.geometry.earth import geodetic


def test_exif_degrees_minutes_seconds_and_references(tmp_path: Path) -> None:
    """25 36 21.73 S is 25 + 36/60 + 21.73/3600 south; altitude reference 1 is below the sea."""
    path = tmp_path / "a.jpg"
    tagged_image(path, (25, 36, 21.73), (49, 25, 17.51), "SW", 12.5, below=True)
    tags = read_tags(path)
    expected = (-(49 + 25 / 60 + 17.51 / 3600), -(25 + 36 / 60 + 21.73 / 3600), -12.5)
    assert_close("ratio", tags.position, expected)
    assert np.isnan(tags.gimbal_deg).all() and tags.size_px == (64, 48)


@pytest.mark.parametrize("longitude", ["GpsLongitude", "GpsLongtitude"])
def test_xmp_has_more_digits_and_a_misspelt_name(tmp_path: Path, longitude: str) -> None:
    xmp = (
        f'drone-dji:GpsLatitude="+47.643500001" drone-dji:{longitude}="16.475900002" '
        'drone-dji:AbsoluteAltitude="+540.123" drone-dji:GimbalYawDegree="-5.50" '
        'drone-dji:GimbalPitchDegree="-12.1"><drone-dji:GimbalRollDegree>+0.30'
        "</drone-dji:GimbalRollDegree>"
    )
    tagged_image(tmp_path / "a.jpg", (47, 38, 36.6), (16, 28, 33.2), "NE", 500.0, xmp=xmp)
    tags = read_tags(tmp_path / "a.jpg")
    assert tags.position == (16.475900002, 47.643500001, 540.123)
    assert tags.gimbal_deg == (-5.5, -12.1, 0.3)


def images_project(folder: Path) -> Path:
    """The frames of the project as images with tags; the gimbal is off by 1, -2 and .5 degree."""
    project = write_project(folder, TOML[: TOML.index("[track]")])
    project.write_text(project.read_text() + '[track]\nfile = "images"\nheight = "ellipsoid"\n')
    (folder / "images").mkdir()
    where = geodetic(camera_m(2.0 + np.arange(5) / 10.0))
    gimbal = truth_deg() - [1.0, -2.0, 0.5]
    for k, (latitude, longitude, height) in enumerate(zip(*where, strict=True)):
        yaw, pitch, roll = gimbal[k]
        xmp = (
            f'drone-dji:GpsLatitude="{latitude:.12f}" drone-dji:GpsLongitude="{longitude:.12f}" '
            f'drone-dji:AbsoluteAltitude="{height:.6f}" drone-dji:GimbalYawDegree="{yaw:.2f}" '
            f'drone-dji:GimbalPitchDegree="{pitch:.2f}" drone-dji:GimbalRollDegree="{roll:.2f}">'
        )
        tagged_image(folder / "images" / f"IMG_{k}.JPG", xmp=xmp)
    picks = folder / "picks.csv"
    rows = [f"IMG_{row[0]}.JPG{row[1:]}" for row in picks.read_text().splitlines()[1:]]
    picks.write_text("\n".join(["image,landmark,u_px,v_px", *rows]))
    return project


def test_a_folder_of_images_is_a_track_and_the_gimbal_a_comparison(tmp_path: Path) -> None:
    flight = vopd.solve_flight(images_project(tmp_path))
    assert_close("flight angle", flight.camera_deg, truth_deg() % 360.0 - [0, 360, 0])
    assert (
        "images: EXIF and XMP tags of 5 images; gimbal angles for comparison only" in flight.about
    )
    table = flight.to_dataframe()
    assert_close("flight angle", table["gimbal_yaw_deg"], truth_deg()[:, 0] - 1.0)
    assert (
        "median of 5 frames and range: yaw +1.00 (+1.00 to +1.00), pitch -2.00 (-2.00 to -2.00), "
        "roll +0.50 (+0.50 to +0.50)"
    ) in table.attrs["gimbal"]
    assert "gimbal" not in vopd.solve_flight(write_project(tmp_path / "other")).to_dataframe().attrs


def test_tables_of_flights_with_and_without_a_gimbal_join(tmp_path: Path) -> None:
    both = images_project(tmp_path / "a"), write_project(tmp_path / "b")
    ran = run("attitude", *both, "--format", "jsonl")
    assert ran.status == 0
    assert ran.stdout.count('"gimbal_yaw_deg": null') == 5


def test_a_new_project_from_images(tmp_path: Path) -> None:
    images_project(tmp_path / "a")
    ran = run("new", tmp_path / "new", "--images", tmp_path / "a" / "images")
    assert ran.status == 0
    text = (tmp_path / "new" / "flight.toml").read_text()
    assert 'file = "../a/images"' in text and "image_size_px = [64, 48]" in text
    assert "needed: [track] height" in ran.stdout


def test_images_without_position_and_files_that_are_none(tmp_path: Path) -> None:
    project = images_project(tmp_path)
    tagged_image(tmp_path / "images" / "IMG_2.JPG")
    flight = vopd.solve_flight(project)
    assert flight.solved.tolist() == [True, True, False, True, True]
    assert any("5 images, 1 without position" in one for one in flight.about)
    (tmp_path / "images" / "IMG_2.JPG").write_text("no image")
    with pytest.raises(VopdError, match=r"IMG_2\.JPG: not an image that can be read"):
        vopd.solve_flight(project)
    for path in (tmp_path / "images").iterdir():
        tagged_image(path)
    with pytest.raises(VopdError, match="none of the 5 images has a position in its tags"):
        vopd.solve_flight(project)


def test_without_pillow_the_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    project = images_project(tmp_path)
    monkeypatch.setitem(sys.modules, "PIL.Image", None)
    with pytest.raises(VopdError, match=r"pip install 'vopd\[images\]'"):
        vopd.solve_flight(project)
