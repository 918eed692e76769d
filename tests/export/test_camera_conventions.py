"""Conventions of photogrammetry: angles worked by hand and by other programs, and the files."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pyproj
import pytest
from scipy.spatial.transform import Rotation

from tests.kit.command import CASE_1
from tests.kit.command import vopd as run
from tests.kit.estimates import estimate
from tests.kit.flight_project import TOML, camera_m, local_to_camera, truth_deg, write_project
from tests.tolerances import assert_close, within
from vopd.arrays import Floats
from vopd.attitude.history import history
from vopd.export import FileRequest, of_file
from vopd.export import photogrammetry as odm_geo
from vopd.export.photogrammetry import grid_from_local, omega_phi_kappa_deg, yaw_pitch_roll_deg
from vopd.geometry.earth import local_axes
from vopd.geometry.rotations import from_axes

FIXED = "[position]\nlat_deg = 47.6435\nlon_deg = 16.4759\nh_m = 540.0\nheight = 'ellipsoid'\n"

# azimuth, elevation and roll (right side down) of the view; then what other programs call it
VECTORS = {
    "level, north": ((0, 0, 0), None, (90, 0, 0), (0.7071, 0.7071, 0, 0)),
    "nadir": ((0, -90, 0), (0, 0, 0), (0, 0, 0), (0, 1, 0, 0)),
    "az 60, 30 below": (
        (60, -30, 0), (60, 60, 0), (40.893, -48.590, -40.893), (0.4330, 0.7500, -0.4330, 0.2500)
    ),
    "the same, rolled": (
        (60, -30, 10), (79.425, 58.525, 16.740), (40.893, -48.590, -50.893),
        (0.4532, 0.7094, -0.4967, 0.2113),
    ),
    "az 45, 20 above": (
        (45, 20, 0), (-135, 70, 180), (117.236, -41.641, 18.882), (0.7568, 0.5299, -0.2195, 0.3135)
    ),
}  # fmt: skip


def camera(angles_deg: tuple[float, float, float]) -> Floats:
    """Right, down, forward as columns in east, north, up."""
    return local_to_camera(np.array(angles_deg, dtype=np.float64)).T[None]


@pytest.mark.parametrize("name", list(VECTORS))
def test_the_angles_are_those_of_other_programs(name: str) -> None:
    gimbal, ypr, opk, _ = VECTORS[name]
    found = yaw_pitch_roll_deg(camera(gimbal))[0]
    if ypr is not None:
        assert_close("published third decimal", np.abs((found - ypr + 180.0) % 360.0 - 180.0), 0.0)
    assert_close("published third decimal", omega_phi_kappa_deg(camera(gimbal))[0], opk)


def test_a_published_matrix() -> None:
    """Of the fourth camera: right, down, forward in east, north, up."""
    published = [[0.417212, -0.513258, 0.75], [-0.896281, -0.095818, 0.433013],
                 [-0.150384, -0.852869, -0.5]]  # fmt: skip
    assert_close("published cosine", camera((60, -30, 10))[0], published)


def test_angles_make_the_image_axes_again() -> None:
    """The definitions, by scipy: Rz(-yaw) Rx(pitch) Ry(roll), and Rx(omega) Ry(phi) Rz(kappa)."""
    turns = Rotation.random(200, random_state=4).as_matrix()
    image = turns @ np.diag([1.0, -1.0, -1.0])
    yaw, pitch, roll = yaw_pitch_roll_deg(turns).T
    again = Rotation.from_euler("ZXY", np.stack([-yaw, pitch, roll], axis=1), degrees=True)
    assert_close("unit rotation", again.as_matrix(), image)
    again = Rotation.from_euler("XYZ", omega_phi_kappa_deg(turns), degrees=True)
    assert_close("unit rotation", again.as_matrix(), image)


def test_a_level_view_has_pitch_90_and_no_roll() -> None:
    assert_close("published third decimal", yaw_pitch_roll_deg(camera((30, 0, 0)))[0], [30, 90, 0])


def test_grid_azimuth_is_true_azimuth_less_the_convergence() -> None:
    """True north has the grid azimuth -2 where the convergence is 2 degrees."""
    north = grid_from_local(np.array([2.0]))[0] @ [0.0, 1.0, 0.0]
    assert_close("ratio", np.degrees(np.arctan2(north[0], north[1])), -2.0)


def lines_of(folder: Path, name: str, toml: str = TOML) -> list[str]:
    path = write_project(folder, toml)
    ran = run("attitude", path, "-o", folder / name)
    assert ran.status == 0, ran.stderr
    return (folder / name).read_text().splitlines()


@pytest.mark.parametrize(("pitch", "near"), [(84.999, 0), (85.001, 1)])
def test_geo_txt_warns_near_the_horizon_and_has_no_minus_zero(
    pitch: float, near: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    angles = np.array([[-1e-9, pitch, -0.0], [359.5, -2e-7, 7.25]])
    monkeypatch.setattr(odm_geo, "yaw_pitch_roll_deg", lambda _: angles)
    said: list[str] = []
    found = history(estimate([[10.0, -60.0, 20.0]] * 2))
    text = odm_geo.render_odm_geo(
        [found], FileRequest(), lambda one: said.append(one.message)
    ).decode()
    rows = [line.split()[4:] for line in text.splitlines() if line.startswith("DJI_")]
    assert rows == [
        ["0.000000", f"{pitch:.6f}", "0.000000"],
        ["359.500000", "0.000000", "7.250000"],
    ]
    level = [one for one in said if "look nearly level or upward" in one]
    assert [one.split()[0] for one in level] == ["1"] * near


def test_geo_txt_is_read_back_as_a_track_and_states_its_convention(tmp_path: Path) -> None:
    lines = lines_of(tmp_path, "geo.txt")
    assert lines[0] == "EPSG:4326"
    assert any("Rz(-yaw) Rx(pitch) Ry(roll)" in line for line in lines)
    rows = [line.split() for line in lines[1:] if not line.startswith("#")]
    assert len(rows) == 5 and all(len(row) == 7 for row in rows)
    for row, angles in zip(rows, truth_deg(), strict=True):
        expected = yaw_pitch_roll_deg(local_to_camera(angles).T[None])[0]
        assert_close("flight angle", [float(x) for x in row[4:]], expected)
    assert [float(x) for x in rows[0][1:4]] == [16.4759, 47.6435, 540.0]


def test_images_txt_takes_landmarks_to_the_camera(tmp_path: Path) -> None:
    """Two lines an image; a point of the site at R X + T in camera axes."""
    lines = lines_of(tmp_path, "images.txt")
    rows = [line for line in lines if not line.startswith("#")]
    assert len(rows) == 10 and not any(rows[1::2])
    where = camera_m(2.0 + np.arange(5) / 10.0)
    site = local_axes(where[0])
    for k, row in enumerate(rows[::2]):
        number, *numbers, camera_id, name = row.split()
        assert (number, camera_id, name) == (str(k + 1), "1", str(k))
        q, t = np.array(numbers[:4], dtype=float), np.array(numbers[4:], dtype=float)
        turn = Rotation.from_quat(np.roll(q, -1)).as_matrix()
        centre = -turn.T @ t
        assert_close("flight position", centre, site @ (where[k] - where[0]))
        # a point 100 m ahead of the camera along its true view
        ahead = where[k] + 100.0 * local_to_camera(truth_deg()[k])[2] @ local_axes(where[k])
        seen = turn @ (site @ (ahead - where[0])) + t
        assert_close("flight position", seen, [0.0, 0.0, 100.0])


def test_quaternions_of_images_txt_are_those_of_other_programs() -> None:
    for gimbal, _, _, q in VECTORS.values():
        found = from_axes(camera(gimbal))[0]
        assert min(np.abs(found - q).max(), np.abs(found + q).max()) < within("four decimals")


def test_omega_phi_kappa_are_against_the_grid(tmp_path: Path) -> None:
    """UTM zone 33: 1.4759 degrees east of its meridian the convergence is 1.0908 degrees."""
    toml = TOML[: TOML.index("[track]")].replace(
        'height = "ellipsoid"', 'height = "ellipsoid"\ncrs = "EPSG:32633"'
    ) + FIXED  # fmt: skip
    path = write_project(tmp_path, toml)
    utm = ["landmark,x_m,y_m,z_m"]
    to_utm = pyproj.Transformer.from_crs("EPSG:4326", "EPSG:32633", always_xy=True)
    for row in (tmp_path / "landmarks.csv").read_text().splitlines()[1:]:
        name, latitude, longitude, height = row.split(",")
        x, y = to_utm.transform(float(longitude), float(latitude))
        utm.append(f"{name},{x:.6f},{y:.6f},{height}")
    (tmp_path / "landmarks.csv").write_text("\n".join(utm))
    (tmp_path / "picks.csv").write_text(
        "\n".join((tmp_path / "picks.csv").read_text().splitlines()[:7])
    )
    assert run("attitude", path, "-o", tmp_path / "a.opk.csv").status == 0
    text = (tmp_path / "a.opk.csv").read_text()
    assert "grid east, grid north, up of EPSG:32633 are\n# Rx(omega)" in text
    (row,) = csv.DictReader(line for line in text.splitlines() if not line.startswith("#"))
    convergence = np.degrees(np.arctan(np.tan(np.radians(1.4759)) * np.sin(np.radians(47.6435))))
    assert abs(float(row["convergence_deg"]) - convergence) < within("convergence of a sphere")
    assert_close("flight angle", float(row["azimuth_true_deg"]), 5.0)
    grid = 5.0 - float(row["convergence_deg"])
    assert_close("flight angle", float(row["azimuth_grid_deg"]), grid)
    expected = omega_phi_kappa_deg(camera((grid, -12.0, 2.0)))[0]
    found = [float(row[f"{name}_deg"]) for name in ("omega", "phi", "kappa")]
    assert_close("flight angle", found, expected)


def test_a_deck_has_these_files_too(tmp_path: Path) -> None:
    for name in ("geo.txt", "images.txt", "a.opk.csv"):
        assert run("attitude", CASE_1, "-o", tmp_path / name).status == 0
        assert "730" in (tmp_path / name).read_text()
    assert "toward the Earth's centre" in (tmp_path / "geo.txt").read_text()
    assert "true east, north, up are" in (tmp_path / "a.opk.csv").read_text()


def test_the_longest_suffix_names_the_format() -> None:
    names = {"x.csv": "csv", "x.opk.csv": "opk", "geo.txt": "odm", "sparse/images.txt": "colmap"}
    assert {name: of_file(name).name for name in names} == names


def test_a_name_with_a_blank_and_a_view_of_the_horizon_are_told(tmp_path: Path) -> None:
    toml = TOML[: TOML.index("[track]")] + FIXED
    path = write_project(tmp_path, toml)
    rows = (tmp_path / "picks.csv").read_text().splitlines()
    named = [f"a b{row[0]}.jpg{row[1:]}" if row[0] == "0" else f"c{row}" for row in rows[1:]]
    (tmp_path / "picks.csv").write_text("\n".join(["image,landmark,u_px,v_px", *named]))
    ran = run("attitude", path, "--format", "odm")
    assert "a b0.jpg: a name in geo.txt has no blank: the frame is left out" in ran.stderr
    assert "a b0" not in ran.stdout and "\nc1 16.4" in ran.stdout
