"""A project from its files to angles, and all that can be wrong with it."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.command import vopd
from tests.kit.flight_files import (
    LANDMARKS,
    LENSES,
    OTHER_LENSES,
    PICKS,
    POSITION,
    TRACKS,
    WINDS,
    Part,
    project,
)
from tests.kit.flight_project import FRAMES, MARKS, TOML, truth_deg, write_project
from tests.tolerances import assert_close, within
from vopd.findings import VopdError
from vopd.flight.result import FlightResult, solve_flight

FIXED = (
    "[position]\nlat_deg = 47.6435\nlon_deg = 16.4759\nh_m = 540.0\n"
    "height = 'ellipsoid'\nsigma_m = 'exact'\n"
)


def test_a_project_gives_the_true_angles(tmp_path: Path) -> None:
    result = solve_flight(str(write_project(tmp_path)))
    assert result.findings == ()
    assert_close("flight angle", result.estimate.camera_deg, truth_deg() % 360.0 - [0, 360, 0])
    assert_close("flight angle", result.estimate.vehicle_deg, truth_deg() % 360.0 - [0, 360, 0])
    assert_close("flight time", result.estimate.time_s, 2.0 + np.arange(FRAMES) / 10.0)
    assert_close("flight speed", result.estimate.airspeed, np.full(FRAMES, np.sqrt(429.0)))


def test_longitudes_west_of_greenwich_are_negative(tmp_path: Path) -> None:
    """All places are turned by 100 degrees about the Earth's axis, and the angles stay."""
    path = write_project(tmp_path)
    for name in ("landmarks.csv", "track.csv"):
        head, *rows = (line.split(",") for line in (tmp_path / name).read_text().splitlines())
        turned = [[a, b, f"{float(lon) - 100.0:.12f}", h] for a, b, lon, h in rows]
        (tmp_path / name).write_text("".join(",".join(row) + "\n" for row in [head, *turned]))
    estimate = solve_flight(str(path)).estimate
    longitude_deg = estimate.position.longitude_deg
    assert ((longitude_deg > -84.0) & (longitude_deg < -83.0)).all()
    assert_close("flight angle", estimate.camera_deg, truth_deg() % 360.0 - [0, 360, 0])


@pytest.mark.usefixtures("no_figures")
def test_the_commands_take_a_project_as_they_take_a_deck(tmp_path: Path) -> None:
    path = write_project(tmp_path, noise_px=0.3)
    ran = vopd("attitude", path)
    assert ran.status == 0 and ran.stderr.count("\n") == 1
    assert_approved(ran.stderr)
    rows = [line.split(",") for line in ran.stdout.splitlines() if not line.startswith("#")]
    assert len(rows) == 1 + FRAMES
    table = dict(zip(rows[0], rows[3], strict=True))
    assert abs(float(table["camera_yaw_deg"]) - 7.0) < within("angle of an example")
    assert 0.0 < float(table["sigma_camera_yaw_deg"]) < 0.1
    assert {"airspeed_m_s", "residual_rms_px", "altitude_m"} <= set(rows[0])
    ran = vopd("report", path, "-o", tmp_path / "f.html")
    assert ran.status == 0, ran.stderr
    assert ">airspeed_m_s<" in (tmp_path / "f.html").read_text()
    ran = vopd("attitude", path, "-o", tmp_path / "f.aem", "--epoch", "2026-05-01T00:00:00Z")
    assert ran.status == 0, ran.stderr
    assert (tmp_path / "f.aem").read_text().count("\n2026-05-01T00:00:") == FRAMES


def test_the_offset_is_added_to_the_times_of_the_track(tmp_path: Path) -> None:
    """A track whose clock is a quarter of a second slow, and the offset that mends it."""
    toml = TOML.replace("[track]\n", "[track]\noffset_s = 0.25\n")
    path = write_project(tmp_path, toml)
    head, *rows = (tmp_path / "track.csv").read_text().splitlines()
    cells = [row.split(",") for row in rows]
    at = head.split(",").index("t_s")
    slow = [",".join([*r[:at], repr(float(r[at]) - 0.25), *r[at + 1 :]]) for r in cells]
    (tmp_path / "track.csv").write_text("\n".join([head, *slow, ""]))
    result = solve_flight(str(path))
    assert_close("flight angle", result.estimate.camera_deg, truth_deg() % 360.0 - [0, 360, 0])


def test_a_figure_of_a_project(tmp_path: Path) -> None:
    ran = vopd("plot", write_project(tmp_path), "-o", tmp_path / "f.svg", "--figure", "image")
    assert ran.status == 0, ran.stderr
    assert "airspeed" not in ran.stdout and (tmp_path / "f.svg").read_text().count("<svg") == 1


def test_a_project_that_fails_costs_no_other_source(tmp_path: Path) -> None:
    good = write_project(tmp_path / "good")
    bad = write_project(tmp_path / "bad", TOML.replace("10.0", "-10.0"))
    ran = vopd("attitude", bad, good, "-o", tmp_path / "both.csv")
    assert ran.status == 1
    assert "[picks] frame_rate_hz: must be above 0, not -10" in ran.stderr
    assert "F12" not in ran.stderr and (tmp_path / "both.csv").exists()


WRONG_KEYS = {
    "unknown section": ("[flight]", "[fligth]"),
    "unknown key": ("frame_rate_hz", "frame_rate"),
    "no grid": ('.csv"\npixel_grid = "centre"', '.csv"'),
    "another grid": ('"centre"\nlens', '"center"\nlens'),
    "no height": ('landmarks.csv"\nheight = "ellipsoid"', 'landmarks.csv"'),
    "naive epoch": ("42Z", "42"),
    "no file": ('"landmarks.csv"', '"marks.csv"'),
    "not TOML": ("[track]", "[track"),
    "model": ('model = "brown"', 'model = "browne"'),
    "focal": ("fx_px = 1500.0", "fx_px = 0.85"),
    "coefficients": ("3e-3]", "3e-3, 0.0]"),
    "lens key": ("fy_px", "f_y_px"),
    "datum": ('landmarks.csv"\nheight = "ellipsoid"', 'landmarks.csv"\nheight = "same"'),
    "sigma": ('picks.csv"', 'picks.csv"\nsigma_px = -1'),
    "sigmas": ('sigma_m = "exact"\nsigma_t_s', "sigma_m = [1, -2, 3]\nsigma_t_s"),
    "two times": ("frame_rate_hz", 'times = "t.csv"\nframe_rate_hz'),
    "no name": ('"track.csv"', '" "'),
    "null": ('"track.csv"', r'"a\u0000"'),
    "sensor": ("fx_px = 1500.0, fy_px = 1490.0", "focal_mm = 8.8, sensor_mm = [0, 8.8]"),
    "two focal lengths": ("fx_px = 1500.0,", "fx_px = 1500.0, focal_mm = 8.8, sensor_mm = [9, 6],"),
    "both": ("[track]", "[position]\nlat_deg = 1\n[track]"),
    "geoid": ('landmarks.csv"\nheight = "ellipsoid"', 'landmarks.csv"\nheight = "egm96"'),
    "crs": ('landmarks.csv"', 'landmarks.csv"\ncrs = "EPSG:99999"'),
}


@pytest.mark.parametrize("case", list(WRONG_KEYS))
def test_what_is_wrong_in_the_project_names_its_key(tmp_path: Path, case: str) -> None:
    before, after = WRONG_KEYS[case]
    assert before in TOML
    path = write_project(tmp_path, TOML.replace(before, after))
    others = {
        "not TOML": "not valid TOML:",
        "null": "file:",
        "crs": "is not known:",
        "geoid": "height:",
    }
    with refused(VopdError, parts=[path], others_after=others.get(case, "")) as told:
        solve_flight(str(path))
    assert case != "geoid" or "height = { undulation_m = ... }" in str(told.value)


def test_a_crs_that_the_track_contradicts_is_not_ignored(tmp_path: Path) -> None:
    path = write_project(tmp_path, TOML.replace('track.csv"', 'geo.txt"\ncrs = "EPSG:32633"'))
    (tmp_path / "geo.txt").write_text("EPSG:4326\na.jpg 16.4 47.6 500\n")
    with refused(VopdError):
        solve_flight(str(path))


WRONG_ROWS = {
    "number": ("picks.csv", 2, "0,church,12x,5"),
    "comma": ("picks.csv", 2, '0,church,"1,5",5'),
    "empty": ("picks.csv", 3, "0,mast,,5"),
    "cells": ("picks.csv", 3, "0,mast,1,2,3"),
    "header": ("picks.csv", 1, "frame,landmark,width,v_px"),
    "name": ("picks.csv", 3, "0,,1,2"),
    "nan": ("landmarks.csv", 2, "church,nan,16,5"),
    "inf": ("landmarks.csv", 2, "church,inf,16,5"),
    "frame below 0": ("picks.csv", 2, "-1,church,1,5"),
    "frame 1.0": ("picks.csv", 3, "1.0,mast,1,5"),
    "mixed": ("picks.csv", 3, "a.jpg,mast,1,5"),
    "exchanged": ("landmarks.csv", 2, "church,116,47,5"),
    "twice": ("landmarks.csv", 3, "church,47.6,16.4,5"),
    "backwards": ("track.csv", 4, "1.5,47.6,16.4,500"),
    "kind": ("track.csv", 1, "when,lat,lon,height"),
}


@pytest.mark.parametrize("case", list(WRONG_ROWS))
def test_what_is_wrong_in_a_table_names_its_line(tmp_path: Path, case: str) -> None:
    name, line, text = WRONG_ROWS[case]
    path = write_project(tmp_path)
    lines = (tmp_path / name).read_text().splitlines()
    lines[line - 1] = text
    (tmp_path / name).write_text("\n".join(lines))
    with refused(VopdError, parts=[name]):
        solve_flight(str(path))


def picks(path: Path, change: dict[int, str], more: str = "") -> None:
    file = path.parent / "picks.csv"
    lines = file.read_text().splitlines()
    for line, text in change.items():
        lines[line - 1] = text
    file.write_text("\n".join([*lines, more, ""]))


def test_a_blunder_is_named_and_with_drop_left_out(tmp_path: Path) -> None:
    path = write_project(tmp_path, noise_px=0.3)
    picks(path, {10: "1,bridge,900.0,300.0"})  # frame 1, the third landmark
    named = solve_flight(str(path))
    assert_approved(named.findings)
    dropped = TOML + '[solve]\nblunders = "drop"\n'
    path.write_text(dropped)
    result = solve_flight(str(path))
    assert_approved(result.findings[0].message)
    truth = truth_deg() % 360.0 - [0, 360, 0]
    assert np.abs(result.estimate.camera_deg - truth).max() < within("angle of an example")
    assert np.abs(named.estimate.camera_deg - truth)[1].max() > 0.1


def test_picks_of_one_point_are_averaged_or_contradict_each_other(tmp_path: Path) -> None:
    path = write_project(tmp_path)
    lines = (tmp_path / "picks.csv").read_text().splitlines()
    frame, mark, u, v = lines[1].split(",")
    near = [f"{frame},{mark},{float(u) + d},{float(v) + e}" for d, e in ((0.6, 0.0), (0.0, -0.8))]
    picks(path, {2: near[0]}, near[1])
    result = solve_flight(str(path))
    # two picks, .6 and .8 px apart: variance .36/2 and .64/2, one degree of freedom each
    assert_close("flight pixel", result.flight.picks.repeatability_px, np.sqrt((0.18 + 0.32) / 2))
    assert len(result.flight.picks.frame) == FRAMES * len(MARKS)
    picks(path, {}, f"{frame},{mark},100.0,100.0")
    told = solve_flight(str(path)).findings
    assert_approved(told[0].message, parts=["frame 0", mark, 3])


def test_frames_outside_the_track_and_unknown_landmarks_are_told(tmp_path: Path) -> None:
    path = write_project(tmp_path, TOML.replace("first_frame_t_s = 2.0", "first_frame_t_s = 0.8"))
    picks(path, {2: "0,chruch,5,5"})
    result = solve_flight(str(path))
    assert_approved([f.message for f in result.findings])
    assert np.isnan(result.estimate.camera_deg[:2]).all()
    path.write_text(TOML.replace("first_frame_t_s = 2.0", "first_frame_t_s = 100.0"))
    with refused(VopdError):
        solve_flight(str(path))


def test_one_landmark_a_frame_is_refused_with_what_can_be_said(tmp_path: Path) -> None:
    path = write_project(tmp_path)
    file = tmp_path / "picks.csv"
    rows = file.read_text().splitlines()
    file.write_text("\n".join(rows[:1] + rows[1::6]))
    with refused(VopdError):
        solve_flight(str(path))
    file.write_text("\n".join(rows[:7] + rows[7::6]))  # the first frame has all six
    told = solve_flight(str(path))
    assert_approved(told.findings[0].message)
    assert np.isfinite(told.estimate.camera_deg[0]).all()


def test_check_landmarks_are_predicted_and_not_used(tmp_path: Path) -> None:
    path = write_project(tmp_path, TOML + '[solve]\ncheck_landmarks = ["mast"]\n')
    picks(path, {3: "0,mast,100.0,100.0"})
    result = solve_flight(str(path))
    assert_close("flight angle", result.estimate.camera_deg, truth_deg() % 360.0 - [0, 360, 0])
    path.write_text(TOML + '[solve]\ncheck_landmarks = ["mest"]\n')
    with refused(VopdError):
        solve_flight(str(path))


def test_a_track_in_gps_time_is_18_seconds_ahead(tmp_path: Path) -> None:
    path = write_project(tmp_path)
    rows = (tmp_path / "track.csv").read_text().splitlines()
    # epoch 11:58:42 UTC is 11:59:00 GPS: t = 1 is 11:59:01
    utc = [row.replace(row.split(",")[0], f"2026-05-01T11:59:0{k}Z", 1) for k, row in
           enumerate(rows[1:], 1)]  # fmt: skip
    (tmp_path / "track.csv").write_text("\n".join([rows[0].replace("t_s", "t_utc"), *utc]))
    with refused(VopdError):
        solve_flight(str(path))
    path.write_text(TOML + 'clock = "gps"\n')
    result = solve_flight(str(path))
    assert_close("flight angle", result.estimate.camera_deg, truth_deg() % 360.0 - [0, 360, 0])


def test_v_up_and_the_grids_are_turned_into_the_one_of_the_package(tmp_path: Path) -> None:
    path = write_project(tmp_path)
    rows = [row.split(",") for row in (tmp_path / "picks.csv").read_text().splitlines()]
    for grid, shift in (("centre", 0.0), ("corner", 0.5), ("one-based", 1.0)):
        up = [f"{f},{n},{float(u) + shift},{1079.0 - float(v) + shift}" for f, n, u, v in rows[1:]]
        (tmp_path / "picks.csv").write_text("\n".join([",".join(rows[0]), *up]))
        toml = TOML.replace(
            '.csv"\npixel_grid = "centre"', f'.csv"\npixel_grid = "{grid}"\nv = "up"'
        )
        path.write_text(toml)
        result = solve_flight(str(path))
        assert_close("flight angle", result.estimate.camera_deg, truth_deg() % 360.0 - [0, 360, 0])


def test_projected_landmarks_and_a_fixed_position(tmp_path: Path) -> None:
    pyproj = pytest.importorskip("pyproj")
    path = write_project(tmp_path)
    rows = [row.split(",") for row in (tmp_path / "landmarks.csv").read_text().splitlines()[1:]]
    to_utm = pyproj.Transformer.from_crs("EPSG:4326", "EPSG:32633", always_xy=True)
    lines = ["landmark,x_m,y_m,z_m"]
    for name, lat, lon, h in rows:
        x, y = to_utm.transform(float(lon), float(lat))
        lines.append(f"{name},{x:.9f},{y:.9f},{float(h) - 45.7}")
    (tmp_path / "landmarks.csv").write_text("\n".join(lines))
    (tmp_path / "picks.csv").write_text(
        "\n".join((tmp_path / "picks.csv").read_text().splitlines()[:7])
    )
    text = TOML.partition("[landmarks]")[0] + (
        '[landmarks]\nfile = "landmarks.csv"\ncrs = "EPSG:32633"\n'
        "height = { undulation_m = 45.7 }\nsigma_m = 'exact'\n" + FIXED
    )
    path.write_text(text)
    result = solve_flight(str(path))
    assert_close("flight angle", result.estimate.camera_deg, truth_deg()[:1] % 360 - [0, 360, 0])
    assert np.isnan(result.estimate.attack_deg).all()
    # tan of the convergence of a sphere's transverse cylinder: tan(1.4759 deg) sin(47.6435 deg)
    convergence = np.degrees(np.arctan(np.tan(np.radians(1.4759)) * np.sin(np.radians(47.6435))))
    assert abs(result.flight.grid_convergence_deg - convergence) < within("convergence of a sphere")


def test_wind_changes_the_angles_of_attack(tmp_path: Path) -> None:
    path = write_project(tmp_path, TOML + '[wind]\nfile = "wind.csv"\n')
    # from the north at 20 m/s: against the air 40 m/s north
    (tmp_path / "wind.csv").write_text("h_m,from_deg,speed_m_s\n0,0,20\n5000,0,20\n")
    result = solve_flight(str(path))
    expected = np.sqrt(40.0**2 + 5.0**2 + 2.0**2)
    assert_close("flight speed", result.estimate.airspeed, np.full(FRAMES, expected))


def test_mounts(tmp_path: Path) -> None:
    ahead = solve_flight(str(write_project(tmp_path))).estimate.vehicle_deg
    for mount in (
        "{ ypr_deg = [0, 0, 0] }",
        "{ matrix = [[0, 0, 1], [1, 0, 0], [0, 1, 0]] }",
        '"forward"',
    ):
        path = write_project(tmp_path, TOML + f"[vehicle]\nmount = {mount}\n")
        assert_close("flight angle", solve_flight(str(path)).estimate.vehicle_deg, ahead)
    path = write_project(tmp_path, TOML + "[vehicle]\nmount = { matrix = [[1, 0, 0]] }\n")
    with refused(VopdError):
        solve_flight(str(path))
    # a camera that looks 90 to the right of the nose, 30 down: the nose is 90 to its left
    path = write_project(tmp_path, TOML + "[vehicle]\nmount = { ypr_deg = [90, 0, 0] }\n")
    yaw = solve_flight(str(path)).estimate.vehicle_deg[:, 0]
    # camera forward is vehicle right: its elevation is vehicle's, so nose lies level of roll
    assert np.abs((yaw - ahead[:, 0] + 180.0) % 360.0 - 180.0 + 90.0).max() < within(
        "mount to the side"
    )


def test_all_frames_of_a_camera_that_does_not_turn_as_one(tmp_path: Path) -> None:
    """Frame 0's picks, and again 2 px to the right and to the left: the mean is frame 0."""
    fixed = TOML[: TOML.index("[track]")] + FIXED + '[solve]\nframes = "one"\n'
    path = write_project(tmp_path, fixed)
    rows = (tmp_path / "picks.csv").read_text().splitlines()
    cells = [row.split(",") for row in rows[1:7]]
    moved = [
        f"{frame},{name},{float(u) + shift:.9f},{v}"
        for frame, shift in enumerate((0.0, 2.0, -2.0))
        for _, name, u, v in cells
    ]
    (tmp_path / "picks.csv").write_text("\n".join([rows[0], *moved]))
    result = solve_flight(path)
    assert result.frame.tolist() == [0]
    assert_close("flight angle", result.camera_deg, truth_deg()[:1] % 360.0 - [0, 360, 0])
    # six times (0, 2, -2) in u and nothing in v, over twice 2 of 3 picks
    assert_close("ratio", result.flight.picks.repeatability_px, np.sqrt(6 * 8.0 / (6 * 4)))
    path.write_text(TOML + '[solve]\nframes = "one"\n')
    with refused(VopdError):
        solve_flight(path)


# The example that is shipped is the one that the tests know the truth of


EXAMPLES = Path(__file__).parents[2] / "examples"
HILL = EXAMPLES / "hill"


def test_the_example_is_near_the_truth_that_its_page_states() -> None:
    angles = solve_flight(str(HILL / "flight.toml")).estimate.camera_deg
    assert np.abs(angles - truth_deg() % 360.0 + [0.0, 360.0, 0.0]).max() < within(
        "angle of an example"
    )


def test_the_example_is_the_project_of_the_tests(tmp_path: Path) -> None:
    """All but the last digits, which another machine may round otherwise."""
    write_project(tmp_path, noise_px=0.3)
    assert (tmp_path / "flight.toml").read_text() == (HILL / "flight.toml").read_text()
    for name in ("picks.csv", "landmarks.csv", "track.csv"):
        made, shipped = ((folder / name).read_text().split() for folder in (tmp_path, HILL))
        assert len(made) == len(shipped)
        for one, other in zip(made[1:], shipped[1:], strict=True):
            for a, b in zip(one.split(","), other.split(","), strict=True):
                assert a == b or abs(float(a) - float(b)) < within("shipped number")


def test_the_examples_of_survey_post_and_shore_are_near_their_truth(tmp_path: Path) -> None:
    """The angles that docs/drone.md and docs/fixed-camera.md state."""
    survey = EXAMPLES / "survey"
    files = ("--gcp", survey / "gcp_list.txt", "--lens", survey / "cameras.json")
    assert vopd("new", tmp_path / "s", *files, "--track", survey / "geo.txt").status == 0
    project = tmp_path / "s" / "flight.toml"
    text = project.read_text().replace("# height =", "height =")
    text = text.replace("# sigma_m =", "sigma_m =").replace("= [1.0, 1.0, 2.0]", "= 0.02")
    project.write_text(text)
    shore = EXAMPLES / "shore"
    files = ("--landmarks", shore / "gcp.txt", "--lens", shore / "intrinsics.json")
    place = ("--crs", "EPSG:25832", "--position", "403210,6052480,32", "--height", "same")
    sure = ("--sigma-position", ".05", "--sigma-landmarks", ".02")
    ran = vopd("new", tmp_path / "camera", *files, "--images", shore / "shore.jpg", *place, *sure)
    assert ran.status == 0
    shutil.copy(shore / "clicks.csv", tmp_path / "camera")
    truth = [[12, -84, 1.5], [10, -85, 0.8], [11, -83, -1.0], [9, -86, 2.2]]
    for path, expected in (
        (project, truth),
        (EXAMPLES / "summits" / "flight.toml", [[2.5, 6, -0.7]]),
        (tmp_path / "camera" / "flight.toml", [[250, -12, 0.5]]),
    ):
        flight = solve_flight(path)
        off = (flight.camera_deg - expected + 180.0) % 360.0 - 180.0
        assert np.abs(off).max() < within("angle of an example") and flight.findings == ()


# One flight in every format that a project can name: the same angles


LENS, SEEN = LENSES["inline"], PICKS["CSV of frames"]
GEODETIC, TRACK = LANDMARKS["CSV, geodetic"], TRACKS["CSV by seconds"]


def solved(folder: Path, *parts: Part) -> FlightResult:
    for name, text in project(*parts).items():
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return solve_flight(str(folder / "flight.toml"))


@pytest.mark.parametrize("name", LENSES)
def test_lenses(tmp_path: Path, name: str) -> None:
    found = solved(tmp_path, LENSES[name], SEEN, GEODETIC, TRACK)
    assert_close("flight angle", found.estimate.camera_deg, truth_deg())


@pytest.mark.parametrize("track", TRACKS)
@pytest.mark.parametrize("picks", PICKS)
def test_picks_and_tracks(tmp_path: Path, picks: str, track: str) -> None:
    if PICKS[picks].frames_by == "number" and TRACKS[track].frames_by == "image":
        return  # numbers of frames say nothing of images
    found = solved(tmp_path, LENS, PICKS[picks], GEODETIC, TRACKS[track])
    assert_close("flight angle", found.estimate.camera_deg, truth_deg())


@pytest.mark.parametrize("name", LANDMARKS)
def test_every_format_of_landmarks(tmp_path: Path, name: str) -> None:
    found = solved(tmp_path, LENS, SEEN, LANDMARKS[name], TRACK)
    assert_close("flight angle", found.estimate.camera_deg, truth_deg())


@pytest.mark.parametrize("name", WINDS)
def test_every_format_of_wind(tmp_path: Path, name: str) -> None:
    found = solved(tmp_path, LENS, SEEN, GEODETIC, TRACK, WINDS[name])
    assert_close("flight angle", found.estimate.camera_deg, truth_deg())
    assert found.flight.path.wind_m_s is not None


@pytest.mark.parametrize("name", OTHER_LENSES)
def test_other_lenses_are_read(tmp_path: Path, name: str) -> None:
    """The picks were made with another lens, so the angles are some tenths of a degree off."""
    found = solved(tmp_path, OTHER_LENSES[name], SEEN, GEODETIC, POSITION)
    assert_close("angle with another lens", found.estimate.camera_deg, truth_deg())
