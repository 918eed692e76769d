"""Every line of geo.txt, images.txt and omega, phi, kappa, of two views straight down."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.approved.texts import refused
from tests.kit.estimates import estimate, level_flight, text_of
from tests.tolerances import assert_close
from vopd.attitude.history import history
from vopd.estimate import MapGrid
from vopd.export.photogrammetry import omega_phi_kappa_deg, yaw_pitch_roll_deg
from vopd.findings import VopdError

CAMERA = "{} 90.000000000 0.000000000 {}.0000 {} 0.000000 0.000000"


def test_a_geo_txt() -> None:
    lines = text_of("odm")[0].splitlines()
    assert lines[0] == "EPSG:4326" and lines[1].endswith(", flight hand.toml")
    assert "x longitude, y latitude, degrees, z metres above the ellipsoid" in lines[2]
    assert "Rz(-yaw) Rx(pitch) Ry(roll). Looking straight down they are 0 0 0" in lines[5]
    assert lines[6] == "# Down is along the ellipsoid's normal."
    assert lines[8:] == [
        CAMERA.format("DJI_0000.JPG", 100, "0.000000"),
        CAMERA.format("DJI_0001.JPG", 200, "90.000000"),
    ]


def test_an_images_txt() -> None:
    """From east, north, up there to right, down, forward: half turns about E, and about E - N."""
    lines = text_of("colmap")[0].splitlines()
    assert lines[0] == "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME"
    assert "Q: Hamilton, scalar first, from site axes to camera axes (right, down, for" in lines[3]
    assert lines[5] == (
        "# latitude 0.000000000, longitude 90.000000000, height 100.0000 m above the ellipsoid"
    )
    assert lines[6] == "# Number of images: 2"
    assert lines[7] == "1 0 1 0 0 0 0 0 1 DJI_0000.JPG" and lines[8] == lines[10] == ""
    number, *numbers, camera, name = lines[9].split()
    assert (number, camera, name, len(lines)) == ("2", "1", "DJI_0001.JPG", 11)
    turn, shift = np.array(numbers[:4], float), np.array(numbers[4:], float)
    assert_close("unit rotation", turn * np.sign(turn[1]), [0.0, 0.5**0.5, -(0.5**0.5), 0.0])
    assert_close("flight direction", shift, [0.0, 0.0, 100.0])


def test_all_jobs_have_the_site_of_the_first() -> None:
    """Images are numbered on; the third and fourth are 200 and 300 m above the first."""
    here = replace(level_flight().estimate.position, altitude=np.array([300.0, 400.0]))
    lines = text_of("colmap", level_flight(1), level_flight(2, position=here))[0].splitlines()
    assert "height 100.0000 m above the ellipsoid" in lines[5]
    assert lines[6] == "# Number of images: 4"
    rows = [line.split() for line in lines[7::2]]
    assert [row[0] for row in rows] == ["1", "2", "3", "4"]
    assert [round(float(row[7]), 6) for row in rows] == [0.0, 100.0, 200.0, 300.0]


def test_an_opk_csv() -> None:
    lines = text_of("opk")[0].splitlines()
    assert "in true east, north, up are" in lines[1] and lines[2].startswith(
        "# Rx(omega) Ry(phi) Rz(kappa), right-handed turns of a vector, degrees."
    )
    assert lines[7] == (
        "image,x,y,h_m,omega_deg,phi_deg,kappa_deg,azimuth_true_deg,azimuth_grid_deg,"
        "convergence_deg,longitude_deg,latitude_deg"
    )
    where, level = "90.000000000,0.000000000", "0.000000,0.000000"
    assert lines[8:] == [
        f"DJI_0000.JPG,{where},100.0000,{level},0.000000,{level},0.000000,{where}",
        f"DJI_0001.JPG,{where},200.0000,{level},-90.000000,90.000000,90.000000,0.000000,{where}",
    ]


@pytest.mark.parametrize("form", ["odm", "colmap", "opk"])
@pytest.mark.parametrize("missing", ["camera_deg", "longitude_deg", "latitude_deg", "altitude"])
def test_frames_without_an_attitude_or_a_position_are_counted(form: str, missing: str) -> None:
    """With the job; where none is left there is no file."""
    for gone in ([1], [0, 1]):
        one = level_flight(4)
        here = one.estimate.position
        angles, part = one.estimate.camera_deg.copy(), None
        if missing == "camera_deg":
            angles[gone, 1] = np.nan
        else:
            part = getattr(here, missing).copy()
            part[gone] = np.nan
            here = replace(here, **{missing: part})
        spoiled = replace(one, estimate=replace(one.estimate, camera_deg=angles, position=here))
        if len(gone) == 2:
            with refused(VopdError):
                text_of(form, spoiled)
            continue
        text, said = text_of(form, spoiled)
        told = "hand.toml: job 4: 1 frames have no attitude or position and are left out"
        assert said[0] == told and "DJI_0000" in text and "DJI_0001" not in text


@pytest.mark.parametrize("pitch", [-80.0, 0.0, 60.0, 89.0, 89.9999, 89.999999, 90.0])
def test_turns_near_the_level_view(pitch: float) -> None:
    """I = Rz(-yaw) Rx(pitch) Ry(roll); at 90 degrees only yaw and roll together can be told."""
    yaw, roll = 20.0, 30.0
    (a, b, c), (d, e, f) = ((fun(np.radians([yaw, pitch, roll]))) for fun in (np.cos, np.sin))
    z = np.array([[a, d, 0.0], [-d, a, 0.0], [0.0, 0.0, 1.0]])
    x = np.array([[1.0, 0.0, 0.0], [0.0, b, -e], [0.0, e, b]])
    y = np.array([[c, 0.0, f], [0.0, 1.0, 0.0], [-f, 0.0, c]])
    camera = (z @ x @ y) @ np.diag([1.0, -1.0, -1.0])
    (found,) = yaw_pitch_roll_deg(camera[None])
    if pitch < 90.0:
        assert np.round(found, 4).tolist() == [yaw, np.round(pitch, 4), roll]
    else:
        assert np.round(found, 6).tolist() == [yaw - roll, 90.0, 0.0]


@pytest.mark.parametrize("angles", [(10.0, 20.0, 30.0), (-170.0, -80.0, 100.0), (0.0, 0.0, 0.0)])
def test_omega_phi_kappa_make_the_image_axes(angles: tuple[float, float, float]) -> None:
    """I = Rx(omega) Ry(phi) Rz(kappa)."""
    (a, b, c), (d, e, f) = ((fun(np.radians(angles))) for fun in (np.cos, np.sin))
    x = np.array([[1.0, 0.0, 0.0], [0.0, a, -d], [0.0, d, a]])
    y = np.array([[b, 0.0, e], [0.0, 1.0, 0.0], [-e, 0.0, b]])
    z = np.array([[c, -f, 0.0], [f, c, 0.0], [0.0, 0.0, 1.0]])
    camera = (x @ y @ z) @ np.diag([1.0, -1.0, -1.0])
    (found,) = omega_phi_kappa_deg(camera[None])
    assert np.round(found, 9).tolist() == list(angles)


@pytest.mark.parametrize("form", ["odm", "colmap", "opk"])
@pytest.mark.parametrize("gone", [1, 3])
def test_it_is_the_frames_that_are_left_out_that_are_counted(form: str, gone: int) -> None:
    one = history(estimate(np.tile([140.0, -60.0, 20.0], (4, 1))))
    angles = one.estimate.camera_deg.copy()
    angles[:gone] = np.nan
    text, said = text_of(form, replace(one, estimate=replace(one.estimate, camera_deg=angles)))
    told = f"hand.toml: job 1: {gone} frames have no attitude or position and are left out"
    assert said == [told] and text.count("DJI_") == 4 - gone


@pytest.mark.parametrize("others", [("", "EPSG:2"), ("EPSG:1", "EPSG:2"), ("EPSG:1", "EPSG:1")])
def test_one_file_has_one_coordinate_system(others: tuple[str, str]) -> None:
    none = np.zeros(2)
    grids = [MapGrid(crs, none + 7.0, none + 9.0, none) if crs else None for crs in others]
    jobs = [level_flight(k, grid=grid) for k, grid in enumerate(grids, 1)]
    if others[0] == others[1]:
        lines = text_of("opk", *jobs)[0].splitlines()
        assert "in grid east, grid north, up of EPSG:1 are" in lines[1]
        assert "# x, y: easting and northing, EPSG:1; h_m" in lines[5]
        assert [line.split(",")[1:3] for line in lines[8:]] == [["7.0000", "9.0000"]] * 4
    else:
        with refused(VopdError):
            text_of("opk", *jobs)
