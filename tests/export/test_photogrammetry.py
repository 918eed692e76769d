"""geo.txt, images.txt, omega, phi, kappa: angles by hand and by other programs, line by line."""

from __future__ import annotations

import csv
import re
import shutil
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pyproj
import pytest
from scipy.spatial.transform import Rotation

from tests.approved.texts import assert_approved, refused
from tests.kit.command import CASE_1
from tests.kit.command import vopd as run
from tests.kit.estimates import ABOUT, WORDS, estimate, level_flight, text_of
from tests.kit.flight_project import TOML, camera_m, local_to_camera, truth_deg, write_project
from tests.tolerances import assert_close, within
from vopd.arrays import Floats
from vopd.attitude.history import history
from vopd.estimate import MapGrid
from vopd.export import FileRequest
from vopd.export import photogrammetry as odm_geo
from vopd.export.photogrammetry import grid_from_local, omega_phi_kappa_deg, yaw_pitch_roll_deg
from vopd.findings import VopdError
from vopd.geometry.earth import local_axes
from vopd.geometry.rotations import from_axes

FIXED = (
    "[position]\nlat_deg = 47.6435\nlon_deg = 16.4759\nh_m = 540.0\n"
    "height = 'ellipsoid'\nsigma_m = 'exact'\n"
)

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


def test_grid_azimuth_is_true_azimuth_less_the_convergence() -> None:
    """True north has the grid azimuth -2 where the convergence is 2 degrees."""
    north = grid_from_local(np.array([2.0]))[0] @ [0.0, 1.0, 0.0]
    assert_close("ratio", np.degrees(np.arctan2(north[0], north[1])), -2.0)


def lines_of(folder: Path, name: str, toml: str = TOML) -> list[str]:
    path = write_project(folder, toml)
    ran = run("attitude", path, "-o", folder / name)
    assert ran.status == 0, ran.stderr
    return (folder / name).read_text().splitlines()


@pytest.mark.parametrize(("pitch", "near"), [(84.999, 0), (85.001, 1), (-85.001, 1)])
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
    level = [one for one in said if "nearly level or upward" in one]
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
    assert_approved(text.splitlines()[1:3], parts=["EPSG:32633"])
    (row,) = csv.DictReader(line for line in text.splitlines() if not line.startswith("#"))
    convergence = np.degrees(np.arctan(np.tan(np.radians(1.4759)) * np.sin(np.radians(47.6435))))
    assert abs(float(row["convergence_deg"]) - convergence) < within("convergence of a sphere")
    assert_close("flight angle", float(row["azimuth_true_deg"]), 5.0)
    grid = 5.0 - float(row["convergence_deg"])
    assert_close("flight angle", float(row["azimuth_grid_deg"]), grid)
    expected = omega_phi_kappa_deg(camera((grid, -12.0, 2.0)))[0]
    found = [float(row[f"{name}_deg"]) for name in ("omega", "phi", "kappa")]
    assert_close("flight angle", found, expected)


def test_the_place_on_the_grid_is_that_which_is_solved(tmp_path: Path) -> None:
    """The summits' camera stated 20 m farther east, known to 50 m: by pyproj from its longitude."""
    shutil.copytree("examples/summits", tmp_path / "p")
    project, out = tmp_path / "p" / "flight.toml", tmp_path / "a.opk.csv"
    text = project.read_text().replace("x_m = 396167.1", "x_m = 396187.1")
    project.write_text(text.replace("sigma_m = 0.5", "sigma_m = 50"))
    assert run("attitude", str(project), "-o", str(out)).status in (0, 3)
    rows = csv.DictReader(line for line in out.read_text().splitlines() if not line.startswith("#"))
    to_grid = pyproj.Transformer.from_crs("EPSG:4326", "EPSG:32633", always_xy=True)
    for row in rows:
        x, y = to_grid.transform(float(row["longitude_deg"]), float(row["latitude_deg"]))
        assert abs(float(row["x"]) - 396187.1) > 1.0
        assert_close("place on the grid", [float(row["x"]), float(row["y"])], [x, y])


def test_a_deck_has_these_files_too(tmp_path: Path) -> None:
    for name in ("geo.txt", "images.txt", "a.opk.csv"):
        assert run("attitude", CASE_1, "-o", tmp_path / name).status == 0
        assert "730" in (tmp_path / name).read_text()
    for name, words in (("geo.txt", "# Down is "), ("a.opk.csv", " north, up ")):
        lines = (tmp_path / name).read_text().splitlines()
        assert_approved([line for line in lines if words in line])


def test_the_azimuth_of_a_camera_whose_pitch_is_beyond_90_is_that_of_its_axis(
    tmp_path: Path,
) -> None:
    """A deck that starts from yaw + 180, 180 - pitch, roll + 180 has the same attitude so."""
    start, other = b"     198.      -36.      285.", b"      18.      216.      105."
    deck = CASE_1.read_bytes()
    assert deck.count(start) == 1
    (tmp_path / "a.dat").write_bytes(deck.replace(start, other))
    rows = []
    for name in (CASE_1, tmp_path / "a.dat"):
        assert run("attitude", name, "-o", tmp_path / "a.opk.csv").status == 0
        rows += [(tmp_path / "a.opk.csv").read_text().splitlines()[-1]]
    assert rows[0] == rows[1]


def test_a_name_with_a_blank_and_a_view_of_the_horizon_are_told(tmp_path: Path) -> None:
    toml = TOML[: TOML.index("[track]")] + FIXED
    path = write_project(tmp_path, toml)
    rows = (tmp_path / "picks.csv").read_text().splitlines()
    named = [f"a b{row[0]}.jpg{row[1:]}" if row[0] == "0" else f"c{row}" for row in rows[1:]]
    (tmp_path / "picks.csv").write_text("\n".join(["image,landmark,u_px,v_px", *named]))
    ran = run("attitude", path, "--format", "odm")
    assert_approved([line for line in ran.stderr.splitlines() if "a b0.jpg" in line])
    assert "a b0" not in ran.stdout and "\nc1 16.4" in ran.stdout


def test_a_name_that_geo_txt_takes_for_a_comment_is_told() -> None:
    text, said = text_of("odm", level_flight(frame_names=["#1.jpg", "c.jpg"]))
    assert "#1" not in text and "\nc.jpg " in text
    assert_approved(said)


# Every line of two views straight down

CAMERA = "{} 90.000000000 0.000000000 {}.0000 {} 0.000000 0.000000"


def test_a_geo_txt() -> None:
    lines = text_of("odm")[0].splitlines()
    assert lines[0] == "EPSG:4326" and lines[1].endswith(", flight hand.toml")
    assert "x longitude, y latitude, degrees, z metres above the ellipsoid" in lines[2]
    assert "Rz(-yaw) Rx(pitch) Ry(roll). Looking straight down they are 0 0 0" in lines[5]
    assert_approved(lines[6])
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
    assert_approved(lines[1:3])
    assert lines[8] == (
        "image,x,y,h_m,omega_deg,phi_deg,kappa_deg,azimuth_true_deg,azimuth_grid_deg,"
        "convergence_deg,longitude_deg,latitude_deg,sigma_omega_deg,sigma_phi_deg,sigma_kappa_deg"
    )
    where, level = "90.000000000,0.000000000", "0.000000,0.000000"
    assert [line.rsplit(",", 3)[0] for line in lines[9:]] == [
        f"DJI_0000.JPG,{where},100.0000,{level},0.000000,{level},0.000000,{where}",
        f"DJI_0001.JPG,{where},200.0000,{level},-90.000000,90.000000,90.000000,0.000000,{where}",
    ]


def opk_sigmas(text: str) -> list[list[str]]:
    rows = csv.DictReader(line for line in text.splitlines() if not line.startswith("#"))
    return [[row[f"sigma_{name}_deg"] for name in ("omega", "phi", "kappa")] for row in rows]


def test_sigmas_of_omega_phi_kappa_of_a_view_straight_down() -> None:
    """North up: turns about right, forward and down are omega, phi and -kappa; then east up."""
    one = level_flight()
    turn = np.tile(np.diag([0.04, 0.09, 0.16]), (2, 1, 1))  # forward, right, down
    doubt = replace(one.uncertainty, covariance_deg2=turn)
    one = replace(one, uncertainty=doubt)
    assert opk_sigmas(text_of("opk", one)[0]) == [
        ["0.300000", "0.200000", "0.400000"], ["0.200000", "0.300000", "0.400000"]
    ]  # fmt: skip
    one.flags.raised["misfit"][1] = True
    assert opk_sigmas(text_of("opk", one)[0])[1] == [""] * 3
    deck = level_flight(about=ABOUT._replace(words=replace(WORDS, source="deck")))
    assert opk_sigmas(text_of("opk", deck)[0])[0] == [""] * 3


def attitude(row: dict[str, str], body: str) -> Floats:
    angles = [float(row[f"{body}_{name}_deg"]) for name in ("yaw", "pitch", "roll")]
    return np.asarray(Rotation.from_euler("ZYX", angles, degrees=True).as_matrix())


def opk_of_turned(turn_deg: Floats, camera: Floats, body: Floats) -> Floats:
    """Omega, phi, kappa of a camera with a body that is turned about its forward, right, down."""
    own = body @ Rotation.from_rotvec(turn_deg, degrees=True).as_matrix() @ body.T @ camera
    image = own[[1, 0, 2]] * [[1.0], [1.0], [-1.0]]  # in east, north, up
    image = image[:, [1, 2, 0]] * [1.0, -1.0, -1.0]  # right, up, backward
    return np.asarray(Rotation.from_matrix(image).as_euler("XYZ", degrees=True))


def test_sigmas_of_omega_phi_kappa_are_those_of_small_turns(tmp_path: Path) -> None:
    """By scipy's angles of the attitude turned a little about the vehicle's axes; not the mount."""
    mount = "[vehicle]\nmount = { ypr_deg = [30, -40, 10] }\nmount_sigma_deg = 0.5\n"
    path = write_project(tmp_path, TOML + mount)
    for name in ("a.csv", "a.opk.csv"):
        assert run("attitude", path, "-o", tmp_path / name).status == 0
    found = np.array(opk_sigmas((tmp_path / "a.opk.csv").read_text()), float)
    lines = (tmp_path / "a.csv").read_text().splitlines()
    axes = ("forward", "right", "down")
    for k, row in enumerate(csv.DictReader(line for line in lines if not line.startswith("#"))):
        value = {
            (a, b): float(row[f"covariance_{a}_{b}_deg2"]) for a in axes for b in axes
            if f"covariance_{a}_{b}_deg2" in row
        }  # fmt: skip
        turn = np.array([[value.get((a, b), value.get((b, a))) for b in axes] for a in axes])
        camera, body = (attitude(row, of) for of in ("camera", "vehicle"))
        angles = partial(opk_of_turned, camera=camera, body=body)
        steps = 1e-4 * np.eye(3)
        slope = np.array([(angles(step) - angles(-step)) / 2e-4 for step in steps]).T
        expected = np.sqrt(np.diag(slope @ (turn - 0.25 * np.eye(3)) @ slope.T))
        assert_close("sigma of printed covariances", found[k], expected)


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
        assert_approved(said[0], parts=["job 4", 1])
        assert "DJI_0000" in text and "DJI_0001" not in text


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


@pytest.mark.parametrize("form", ["odm", "colmap", "opk"])
@pytest.mark.parametrize("gone", [1, 3])
def test_it_is_the_frames_that_are_left_out_that_are_counted(form: str, gone: int) -> None:
    angles, own = np.tile([140.0, -60.0, 20.0], (4, 1)), np.arange(4.0)
    grid, lens = MapGrid("EPSG:1", own, own, own), own.astype(int)
    left = np.where(own[:, None] < gone, np.nan, angles)
    one = history(estimate(angles, camera_deg=left, grid=grid, lens=lens))
    one.flags.raised["misfit"][3] = True
    text, said = text_of(form, one)
    assert_approved(said, parts=["job 1", gone])
    assert text.count("DJI_") == 4 - gone
    *_, last = filter(None, text.splitlines())
    if form == "opk":
        assert last.startswith("DJI_0003.JPG,3.0000,3.0000,") and last.endswith(",,,")
        assert last.split(",")[9] == "3.000000"
    elif form == "colmap":
        assert last.endswith(" 4 DJI_0003.JPG")


@pytest.mark.parametrize("others", [("", "EPSG:2"), ("EPSG:1", "EPSG:2"), ("EPSG:1", "EPSG:1")])
def test_one_file_has_one_coordinate_system(others: tuple[str, str]) -> None:
    none = np.zeros(2)
    grids = [MapGrid(crs, none + 7.0, none + 9.0, none) if crs else None for crs in others]
    jobs = [level_flight(k, grid=grid) for k, grid in enumerate(grids, 1)]
    if others[0] == others[1]:
        lines = text_of("opk", *jobs)[0].splitlines()
        assert_approved([lines[1], lines[5]], parts=["EPSG:1", "EPSG:1"])
        assert [line.split(",")[1:3] for line in lines[9:]] == [["7.0000", "9.0000"]] * 4
    else:
        with refused(VopdError):
            text_of("opk", *jobs)


def test_an_images_txt_of_several_cameras() -> None:
    """A number for each lens; another source or focal length has its own, another job has not."""
    two, other = level_flight(lens=np.array([1, 0])), ABOUT._replace(source="other.toml")
    text, said = text_of(
        "colmap", two, level_flight(job=2, about=ABOUT), level_flight(about=other),
        level_flight(about=other, lens=np.array([0, 1])), level_flight(focal_length=40.0),
    )  # fmt: skip
    rows = [line.split() for line in text.splitlines() if line and not line.startswith("#")]
    assert [row[8] for row in rows] == ["2", "1", "1", "1", "3", "3", "3", "4", "5", "5"]
    assert_approved(re.findall("(?m)^# CAMERA_ID.*\n.*", text), parts=["1 to 5"])
    assert_approved(said)


@pytest.mark.parametrize("form", ["odm", "colmap", "opk"])
def test_images_of_one_name_are_told(form: str) -> None:
    """The same two images in two jobs."""
    text, said = text_of(form, level_flight(), level_flight(2))
    assert text.count("DJI_0001.JPG") == 2
    assert_approved(said)
    assert text_of(form)[1] == []


@pytest.mark.parametrize("form", ["odm", "colmap", "opk"])
def test_heights_above_different_levels_are_refused(form: str) -> None:
    """Each file states one."""
    words = replace(WORDS, altitude="above sea level")
    other = level_flight(about=ABOUT._replace(source="other.toml", words=words))
    assert re.search("above sea level(?! of WGS 84)", text_of(form, other)[0])
    with refused(VopdError):
        text_of(form, level_flight(), other)


def test_names_that_colmap_cuts_are_told() -> None:
    names = level_flight(frame_names=["a b.jpg", "c.jpg"])
    text, said = text_of("colmap", names)
    assert " 1 a b.jpg\n" in text
    assert_approved(said)
    assert text_of("colmap")[1] == []
