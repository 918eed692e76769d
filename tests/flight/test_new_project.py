"""`vopd new`: a project from files, and the example."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import vopd
from tests.kit.command import vopd as run
from tests.kit.flight_project import write_project
from tests.tolerances import within
from vopd.flight.new import EXAMPLE_VALUES, example_project
from vopd.flight.project import KEYS, read_project


def test_the_example_runs_and_is_near_its_truth(tmp_path: Path) -> None:
    ran = run("new", tmp_path / "try")
    assert ran.status == 0 and "flight.toml: written" in ran.stdout
    flight = vopd.solve_flight(tmp_path / "try" / "flight.toml")
    with (tmp_path / "try" / "truth.csv").open() as file:
        truth = [[float(row[k]) for k in ("yaw_deg", "pitch_deg", "roll_deg")]
                 for row in csv.DictReader(file)]  # fmt: skip
    off = flight.camera_deg - np.array(truth)
    sigma = flight.to_dataframe()[[f"sigma_camera_{a}_deg" for a in ("yaw", "pitch", "roll")]]
    chi2 = ((off / sigma.to_numpy()) ** 2).mean()
    assert 0.5 < chi2 < 1.6  # 63 numbers: a tenth of a thousandth lie outside
    assert flight.findings == () and np.isfinite(flight.attack_deg).all()
    assert run("check", tmp_path / "try" / "flight.toml").stdout.endswith(
        "no errors, no warnings\n"
    )


@pytest.mark.parametrize("frame", [0, 50, 100])
def test_the_rendered_frames_show_the_landmarks_where_they_are_picked(frame: int) -> None:
    """The white disc of a mast: the centre of what is whiter than what is around it."""
    contents = example_project().contents
    picture = np.asarray(Image.open(io.BytesIO(contents[f"frame_{frame:03d}.png"])).convert("RGB"))
    assert picture.shape == (360, 640, 3)
    green = picture[..., 1].astype(float)
    rows = csv.DictReader(contents["picks.csv"].decode().splitlines())
    picks = [row for row in rows if int(row["frame"]) == frame]
    assert len(picks) == 6
    for row in picks:
        u, v = float(row["u_px"]), float(row["v_px"])
        top, left = round(v) - 4, round(u) - 4
        patch = green[top : top + 9, left : left + 9]
        red = picture[top : top + 9, left : left + 9, 0] - patch
        disc = (red > 40) | (patch > 190)  # the ring and what it encloses
        y, x = (np.average(axis, weights=disc) for axis in np.mgrid[:9, :9])
        assert np.hypot(x + left - u, y + top - v) < within("rendered pick"), row


def test_the_example_has_keys_that_stand_in_a_new_project() -> None:
    assert set(EXAMPLE_VALUES) <= {(key.section, key.name) for key in KEYS if key.example}


def test_files_are_recognised_and_what_they_leave_open_is_asked(tmp_path: Path) -> None:
    write_project(tmp_path / "files")
    (tmp_path / "files" / "lens.txt").write_text(
        "1 OPENCV 1920 1080 1500 1490 960 540 -0.1 0.02 0 0\n"
    )
    names = {k: tmp_path / "files" / f"{k}.csv" for k in ("picks", "landmarks", "track")}
    options = [part for k, path in names.items() for part in (f"--{k}", path)]
    ran = run("new", tmp_path / "new", *options, "--lens", tmp_path / "files" / "lens.txt")
    assert ran.status == 0
    lines = ran.stdout.splitlines()
    assert lines[0].endswith("lens.txt: COLMAP, OPENCV, corner grid, half a pixel taken off")
    assert lines[1].endswith("picks.csv: CSV, 30 picks in 5 frames")
    assert lines[2].endswith("landmarks.csv: CSV, 6 landmarks")
    assert lines[3].endswith("track.csv: CSV, 4 positions")
    needed = [line.partition(" (")[0] for line in lines if line.startswith("needed: ")]
    assert needed == [
        "needed: [picks] pixel_grid", "needed: [landmarks] height", "needed: [landmarks] sigma_m",
        "needed: [track] height", "needed: [track] sigma_m",
        "needed: [picks] frame_rate_hz", "needed: [picks] first_frame_t_s",
    ]  # fmt: skip
    path = tmp_path / "new" / "flight.toml"
    assert "pixel_grid: is needed" in run("check", path).stdout
    text = path.read_text()
    for line in text.splitlines():  # what a user does who takes every example as it is
        if "# NEEDED, " in line:
            text = text.replace(line, line.removeprefix("# "))
    path.write_text(text.replace("frame_rate_hz = 25.0", "frame_rate_hz = 10.0")
                    .replace("first_frame_t_s = 0.0", "first_frame_t_s = 2.0"))  # fmt: skip
    assert read_project(str(path)).section("camera").values["image_size_px"] == [1920, 1080]
    assert vopd.solve_flight(path).solved.all()


def test_a_gcp_list_is_picks_and_landmarks(tmp_path: Path) -> None:
    gcp = tmp_path / "gcp_list.txt"
    gcp.write_text(
        "EPSG:32633\n610000 5277000 400 100 200 a.jpg one\n610100 5277000 400 10 20 a.jpg two\n"
    )
    ran = run("new", tmp_path / "new", "--gcp", gcp)
    assert "gcp_list.txt: gcp_list.txt, 2 picks in 1 frame, centre grid" in ran.stdout
    assert "x east or longitude, 2 landmarks" in ran.stdout
    assert (tmp_path / "new" / "flight.toml").read_text().count('file = "../gcp_list.txt"') == 2


def test_nothing_that_is_there_is_overwritten(tmp_path: Path) -> None:
    (tmp_path / "flight.toml").write_text("mine")
    ran = run("new", tmp_path)
    assert ran.status == 1 and "is there already; name another folder" in ran.stderr
    assert [one.name for one in tmp_path.iterdir()] == ["flight.toml"]
    other = tmp_path / "other"
    other.mkdir()
    (other / "truth.csv").write_text("mine")
    assert run("new", other).status == 1
    assert [one.name for one in other.iterdir()] == ["truth.csv"]
    ran = run("new", other / "truth.csv" / "x")
    assert ran.status == 1 and "cannot be written" in ran.stderr


def test_a_file_that_cannot_be_read_writes_nothing(tmp_path: Path) -> None:
    (tmp_path / "x.csv").write_text("a,b\n1,2\n")
    for option in ("--lens", "--picks", "--landmarks", "--track", "--wind", "--gcp"):
        ran = run("new", tmp_path / "new", option, tmp_path / "x.csv")
        assert ran.status == 1 and "the format is not recognised" in ran.stderr, option
        ran = run("new", tmp_path / "new", option, tmp_path / "none.csv")
        assert ran.status == 1 and "No such file" in ran.stderr
    assert not (tmp_path / "new").exists()


def test_a_lens_that_leaves_something_open_is_asked_about(tmp_path: Path) -> None:
    (tmp_path / "lens.json").write_text(
        '{"camera_matrix": {"data": [900, 0, 320, 0, 900, 240, 0, 0, 1]}, '
        '"distortion_coefficients": {"data": [0.1, 0.01, 0, 0]}, '
        '"image_width": 640, "image_height": 480}'
    )
    ran = run("new", tmp_path / "new", "--lens", tmp_path / "lens.json")
    assert "needed: [camera] model" in ran.stdout
    assert '# model = "brown"' in (tmp_path / "new" / "flight.toml").read_text()
