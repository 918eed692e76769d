"""`vopd new`: a project from files, and the example."""

from __future__ import annotations

import csv
import json
import shutil
import sys
import tomllib
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import vopd
from tests.approved.texts import assert_approved, refused
from tests.kit.command import ROOT
from tests.kit.command import vopd as run
from tests.kit.flight_project import write_project
from tests.kit.tagged_images import tagged_image
from tests.tolerances import within
from vopd.findings import VopdError
from vopd.flight.formats.track import TRACK_FORMATS, TrackRows
from vopd.flight.project.inspect import NewProject, look_at_times
from vopd.flight.project.keys import KEYS, read_project
from vopd.flight.project.new import EXAMPLE_VALUES, example_project, project_of_files
from vopd.flight.project.track import track_clock
from vopd.video import open_frames


def test_the_example_runs_and_is_near_its_truth(tmp_path: Path) -> None:
    """Its clicks alone are an attitude of their frame; tracked they are one of every frame."""
    ran = run("new", tmp_path / "try")
    assert ran.status == 0 and "flight.toml: written" in ran.stdout
    project = tmp_path / "try" / "flight.toml"
    with (tmp_path / "try" / "truth.csv").open() as file:
        truth = [[float(row[k]) for k in ("yaw_deg", "pitch_deg", "roll_deg")]
                 for row in csv.DictReader(file)]  # fmt: skip
    for frames in (1, 51):
        flight = vopd.solve_flight(project)
        off = (flight.camera_deg - np.array(truth)[:frames] + 180.0) % 360.0 - 180.0
        assert len(off) == frames and np.abs(off).max() < within("angle of six clicks")
        assert np.isfinite(flight.attack_deg).all()
        assert_approved([one.message for one in flight.findings]) if frames == 1 else None
        assert run("track", project).status == 0
    assert flight.findings == ()
    ran = run("check", project)
    assert ran.stdout.endswith("no errors, no warnings\n")


def test_the_rendered_frames_show_the_landmarks_where_they_are_clicked(tmp_path: Path) -> None:
    """Corners, where the edges in the patch around a click meet (Foerstner's operator)."""
    contents = example_project().contents
    (tmp_path / "flight.mp4").write_bytes(contents["flight.mp4"])
    frames = open_frames([str(tmp_path / "flight.mp4")])
    assert len(frames) == 51 and frames.time_s[-1] == 2.0
    ((_, picture),) = frames.decoded(0, 0)
    assert picture.shape == (360, 640, 3)
    rows = list(csv.DictReader(contents["clicks.csv"].decode().splitlines()[1:]))
    assert len(rows) == 6
    for row in rows:
        u, v = float(row["u_px"]), float(row["v_px"])
        top, left = round(v) - 2, round(u) - 2
        patch = picture[top : top + 5, left : left + 5].sum(axis=2, dtype=float)
        slope = np.stack(np.gradient(patch))[::-1].reshape(2, -1).T
        at = np.stack(np.meshgrid(left + np.arange(5.0), top + np.arange(5.0)), -1).reshape(-1, 2)
        square = slope[:, :, None] * slope[:, None, :]
        corner = np.linalg.solve(square.sum(axis=0), np.einsum("nij,nj->i", square, at))
        assert np.hypot(*(corner - [u, v])) < within("rendered pick"), row


def test_the_example_has_keys_that_stand_in_a_new_project() -> None:
    """But `tracked`, which stands in projects with a video alone."""
    others = {(key.section, key.name) for key in KEYS if key.example}
    assert set(EXAMPLE_VALUES) - others == {("picks", "tracked")}


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
    assert_approved(lines[:4])
    needed = [line.partition(" (")[0] for line in lines if line.startswith("needed: ")]
    assert needed == [
        "needed: [picks] pixel_grid", "needed: [landmarks] height", "needed: [landmarks] sigma_m",
        "needed: [track] height", "needed: [track] sigma_m", "needed: [track] sigma_t_s",
        "needed: [picks] frame_rate_hz", "needed: [picks] first_frame_t_s",
    ]  # fmt: skip
    path = tmp_path / "new" / "flight.toml"
    asked = run("check", path).stdout  # the same, all at once
    assert all(one.rpartition(" ")[2] + " = " in asked for one in needed)
    text = path.read_text()
    for line in text.splitlines():  # what a user does who takes every example as it is
        if "# NEEDED (" in line:
            text = text.replace(line, line.removeprefix("# "))
    path.write_text(text.replace("frame_rate_hz = 25.0", "frame_rate_hz = 10.0")
                    .replace("first_frame_t_s = 0.0", "first_frame_t_s = 2.0"))  # fmt: skip
    assert read_project(str(path)).section("camera").values["image_size_px"] == [1920, 1080]
    assert vopd.solve_flight(path).solved.all()


def test_a_track_in_gps_time_needs_no_zone(tmp_path: Path) -> None:
    """Also where a second call of the command says more."""
    for clock, zone in (("gps", ""), ("gps", "Z"), ("utc", "Z")):
        rows = [f"2026-05-01T12:00:0{k}{zone},47,16,540" for k in range(3)]
        track = tmp_path / "track.csv"
        track.write_text("\n".join(["t_utc,lat_deg,lon_deg,h_m", *rows, ""]))
        folder = tmp_path / (clock + zone)
        assert run("new", folder, "--track", track, "--clock", clock).status == 0
        assert run("new", folder, "--height", "ellipsoid").status == 0
        project = read_project(str(folder / "flight.toml"))
        rows_read = project.read("track", project.open("track"), TRACK_FORMATS)
        seconds = track_clock(project.section("track"), rows_read) - 1777636800.0
        assert seconds.tolist() == [k - 18.0 * (clock == "gps") for k in range(3)]


def test_a_gcp_list_is_picks_and_landmarks(tmp_path: Path) -> None:
    gcp = tmp_path / "gcp_list.txt"
    gcp.write_text(
        "EPSG:32633\n610000 5277000 400 100 200 a.jpg one\n610100 5277000 400 10 20 a.jpg two\n"
    )
    ran = run("new", tmp_path / "new", "--gcp", gcp)
    assert_approved([line for line in ran.stdout.splitlines() if line.startswith(str(gcp))])
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


# What each file of a new project answers, and what it leaves to be asked


FILES = {
    "lens.txt": "1 PINHOLE 64 48 70 60 32 24\n",
    "two.txt": "1 PINHOLE 64 48 70 60 32 24\n2 PINHOLE 64 48 70 60 32 24\n",
    "four.json": '{"camera_matrix": [9, 0, 3, 0, 9, 2, 0, 0, 1], "d": [1, 2, 3, 4], '
    '"image_width": 64, "image_height": 48}',
    "unsized.json": '{"camera_matrix": [9, 0, 3, 0, 9, 2, 0, 0, 1]}',
    "wrong.txt": "1 PINHOLE 64 48 70 60 32\n",
    "picks.csv": "frame,landmark,u_px,v_px\n3,a,1,2\n3,b,1,2\n",
    "named.csv": "image,landmark,u_px,v_px\nx,a,1,2\ny,a,1,2\ny,b,1,2\n",
    "cvat.xml": '<annotations><image name="a" width="40" height="30">'
    '<points label="m" points="1,2"/></image></annotations>',
    "marks.csv": "landmark,lat_deg,lon_deg,h_m\na,1,2,3\n",
    "known.csv": "landmark,lat_deg,lon_deg,h_m,sigma_m\na,1,2,3,.1\nb,1,2,3,.2\n",
    "partly.csv": "landmark,lat_deg,lon_deg,h_m,sigma_m\na,1,2,3,.1\nb,1,2,3,\n",
    "plane.csv": "landmark,x_m,y_m,z_m\na,1,2,3\nb,1,2,3\n",
    "marks.json": '{"type": "Feature", "geometry": {"type": "Point", "coordinates": [1, 2, 3]}, '
    '"properties": {"name": "a"}}',
    "gcp.txt": "EPSG:4979\n1 2 3 4 5 a.jpg m\n",
    "track.csv": "t_s,lat_deg,lon_deg,h_m\n1,2,3,4\n",
    "known_track.csv": "t_s,lat_deg,lon_deg,h_m,sigma_m\n1,2,3,4,.1\n2,2,3,4,\n",
    "utc.csv": "t_utc,x_m,y_m,z_m\n1970-01-01T00:00:00Z,2,3,4\n",
    "image.csv": "image,lat_deg,lon_deg,h_m\nx,2,3,4\n",
    "geo.txt": "EPSG:4979\nx 1 2 3\n",
    "wind.csv": "h_m,from_deg,speed_m_s\n0,1,2\n5,1,2\n",
}


def asked(folder: Path, **given: str) -> tuple[NewProject, dict[str, str]]:
    """The new project in a folder beside the files, and the values in its file."""
    (folder / "files").mkdir(exist_ok=True)
    for name, text in FILES.items():
        (folder / "files" / name).write_text(text)
    named = {kind: str(folder / "files" / name) for kind, name in given.items()}
    new = project_of_files(folder / "my flight", named)
    values, section = {}, ""
    for line in new.contents["flight.toml"].decode().splitlines():
        section = line[1:-1] if line.startswith("[") else section
        if line and line[0] not in "#[":
            key, _, value = line.partition(" # ")[0].partition(" = ")
            values[f"{section} {key}"] = value.strip()
    return new, values


def needs(new: NewProject) -> dict[str, str]:
    return {" ".join(key): why for key, why in new.needed.items()}


OF_FOUR = '{"camera_matrix": [9, 0, 3, 0, 9, 2, 0, 0, 1], "d": [1, 2, 3, 4]}'


@pytest.mark.parametrize(
    ("lens", "keys", "size_px", "needed"),
    [
        (FILES["two.txt"].replace("2 PINHOLE 64 48", "2 PINHOLE 8 6"), {"camera": "2"}, [8, 6], ""),
        (FILES["two.txt"], {"camera": "3"}, None, ""),
        (FILES["four.json"], {"model": "fisheye"}, [64, 48], ""),
        (OF_FOUR, {"model": "fisheye"}, None, "image_size_px"),
        (OF_FOUR, {"model": "fisheye", "image_size_px": [64, 48]}, [64, 48], ""),
        (FILES["lens.txt"], {"lens_size_px": [64, 48]}, None, "image_size_px"),
        (FILES["lens.txt"], {"lens_size_px": [64, 48], "image_size_px": [32, 24]}, [32, 24], ""),
    ],
)
def test_a_lens_is_read_with_what_is_said_of_it(
    lens: str, keys: dict[str, Any], size_px: list[int] | None, needed: str, tmp_path: Path
) -> None:
    """Model, camera and sizes that `--set` gives: it was asked for the model again and again."""
    (tmp_path / "lens").write_text(lens)
    said = [f"--set=camera.{key}={value}" for key, value in keys.items()]
    ran = run("new", tmp_path / "p", "--lens", tmp_path / "lens", *said)
    if keys.get("camera") == "3":
        assert (ran.status, "it has '1', '2'" in ran.stderr) == (1, True)
        return
    camera = tomllib.loads((tmp_path / "p" / "flight.toml").read_text())["camera"]
    asked_for = [line for line in ran.stdout.splitlines() if line.startswith("needed: [camera]")]
    assert [line.split()[2] for line in asked_for] == [needed] * bool(needed)
    assert camera == {"lens": "../lens"} | keys | ({"image_size_px": size_px} if size_px else {})


@pytest.mark.parametrize("size", ["--image-size=64,48", "--set=camera.image_size_px=[64,48]"])
def test_the_size_that_an_option_gives_is_the_lens_s(size: str, tmp_path: Path) -> None:
    """Of a file without one, which was said to be missing beside --image-size."""
    (tmp_path / "lens").write_text(OF_FOUR)
    given = ("--lens", tmp_path / "lens", "--set=camera.model=fisheye", size)
    ran = run("new", tmp_path / "p", *given)
    assert (ran.status, ran.stderr, "image_size_px" in ran.stdout) == (0, "", False)
    camera = tomllib.loads((tmp_path / "p" / "flight.toml").read_text())["camera"]
    assert camera["image_size_px"] == [64, 48]


def test_a_new_project_without_any_file(tmp_path: Path) -> None:
    new, values = asked(tmp_path)
    assert values == {"flight name": '"my flight"'}
    assert_approved(needs(new))
    assert_approved(new.contents["flight.toml"].decode().partition("\n[")[0])


@pytest.mark.parametrize(
    ("given", "values"),
    [
        ({"lens": "lens.txt"}, {"camera image_size_px": "[64, 48]"}),
        ({"lens": "two.txt"}, {}),
        ({"lens": "unsized.json"}, {}),
        ({"lens": "four.json"}, {}),
        ({"picks": "picks.csv"}, {}),
        ({"picks": "named.csv"}, {}),
        ({"picks": "cvat.xml"}, {"camera image_size_px": "[40, 30]"}),
        ({"landmarks": "marks.csv"}, {}),
        ({"landmarks": "known.csv"}, {}),
        ({"landmarks": "partly.csv"}, {}),
        ({"landmarks": "plane.csv"}, {}),
        ({"landmarks": "marks.json"}, {}),
        ({"landmarks": "gcp.txt"}, {}),
        ({"track": "track.csv"}, {}),
        ({"track": "known_track.csv"}, {}),
        ({"track": "utc.csv"}, {}),
        ({"track": "geo.txt"}, {}),
        ({"wind": "wind.csv"}, {}),
    ],
)
def test_what_a_file_answers_and_leaves_open(
    given: dict[str, str], values: dict[str, str], tmp_path: Path
) -> None:
    """Approved: what is said of the file, and what is asked of its own section and of times."""
    (kind, name), = given.items()  # fmt: skip
    new, found = asked(tmp_path, **given)
    section = "camera" if kind == "lens" else kind
    key = f"{section} lens" if kind == "lens" else f"{section} file"
    assert found.pop(key) == f'"../files/{name}"'
    assert found.pop("flight name") == '"my flight"' and found == values
    path = str(tmp_path / "files" / name)
    usual, asks = needs(asked(tmp_path)[0]), needs(new)
    of_others = {
        one: why for one, why in usual.items()
        if not one.startswith(f"{section} ") and not (one == "camera image_size_px" and values)
    }  # fmt: skip
    assert of_others.items() <= asks.items()
    assert not (values and "camera image_size_px" in asks)
    assert_approved([one for one in new.said if one.startswith(path)], parts=[path])
    own = {one: why for one, why in asks.items() if one not in of_others}
    if own:
        assert_approved(own)


def test_files_of_several_kinds(tmp_path: Path) -> None:
    """A file of landmarks stands before those of the list of both; a lens that is wrong is told."""
    _, found = asked(
        tmp_path, gcp="gcp.txt", landmarks="marks.csv", lens="lens.txt", picks="cvat.xml"
    )
    assert found["landmarks file"] == '"../files/marks.csv"'
    assert found["picks file"] == '"../files/cvat.xml"'
    assert found["camera image_size_px"] == "[64, 48]"
    _, found = asked(tmp_path, gcp="gcp.txt")
    assert found["landmarks file"] == found["picks file"] == '"../files/gcp.txt"'
    with refused(VopdError):
        asked(tmp_path, lens="wrong.txt")
    new, found = asked(tmp_path, track="image.csv", picks="named.csv")
    assert not [one for one in needs(new) if one.startswith(("picks f", "picks t", "flight"))]


def track(clock: str | None, *image: str) -> TrackRows:
    time = None if clock is None else np.zeros(1)
    return TrackRows(np.zeros((1, 3)), True, None, clock, time, "", [*image])


RATE = ["track sigma_t_s", "picks frame_rate_hz", "picks first_frame_t_s"]
EPOCH = [*RATE, "flight epoch"]


@pytest.mark.parametrize(
    ("rows", "by_number", "needed"),
    [
        (track(None, "a"), False, []), (track(None), True, []), (track("utc", "a"), False, []),
        (track("seconds"), True, RATE), (track("utc"), True, EPOCH),
        (track("gps", "a"), True, EPOCH), (track("utc-column"), True, EPOCH),
        (track("seconds"), False, ["track sigma_t_s", "picks times"]),
    ],
)  # fmt: skip
def test_what_a_track_by_time_asks_of_frames(
    rows: TrackRows, by_number: bool, needed: list[str]
) -> None:
    new, values = NewProject(), dict[tuple[str, str], str]()
    look_at_times(new, values, Path(), rows, None, by_number)
    assert ([*needs(new)], values, new.said) == (needed, {}, [])
    if needed:
        assert_approved(needs(new))


@pytest.mark.parametrize("picked", [True, False])
def test_images_without_tags_are_the_photographs_of_a_project(picked: bool, tmp_path: Path) -> None:
    """PNG has no tags: its size is that of its pixels; nothing was said of them beside picks."""
    folder = tmp_path / "images"
    folder.mkdir()
    for name in ("a.png", "c.png"):
        Image.new("RGB", (64, 48)).save(folder / name)
    (tmp_path / "p.csv").write_text("image,landmark,u_px,v_px\na.png,m,1,2\nb.png,m,3,4\n")
    (tmp_path / "t.csv").write_text(FILES["utc.csv"])
    given = {"images": str(folder), "track": str(tmp_path / "t.csv")}
    new = project_of_files(tmp_path, given | ({"picks": str(tmp_path / "p.csv")} if picked else {}))
    found = tomllib.loads(new.contents["flight.toml"].decode())
    assert found["picks"]["video"] == "images" and found["camera"]["image_size_px"] == [64, 48]
    assert ("camera", "image_size_px") not in new.needed
    lost = [one for one in new.said if "picked and not there" in one]
    assert len(lost) == picked
    assert_approved(lost)


def test_sigmas_of_velocities_and_lists_of_landmarks(tmp_path: Path) -> None:
    """A track's velocities have none; a list of names is written as one of TOML."""
    (tmp_path / "t.csv").write_text(
        "t_s,lat_deg,lon_deg,h_m,vn_m_s,ve_m_s,vd_m_s\n0,47,16,300,1,2,3\n1,47,16,301,1,2,3\n"
    )
    new = project_of_files(tmp_path, {"track": str(tmp_path / "t.csv")})
    assert_approved(new.needed["track", "velocity_sigma_m_s"])
    own = tmp_path / "own"
    run("new", own, "--track", tmp_path / "t.csv", "--set", "solve.check_landmarks=mast, old well")
    found = tomllib.loads((own / "flight.toml").read_text(encoding="utf-8"))
    assert found["solve"]["check_landmarks"] == ["mast", "old well"]


def test_images_of_a_new_project(tmp_path: Path) -> None:
    """They are the track, or with another track the times; a zone that is missing is asked."""
    folder = tmp_path / "images"
    folder.mkdir()
    clock: dict[str, Any] = {"taken": "2026:05:01 12:00:00", "zone": "+02:00"}
    for name, tags in (("a.jpg", clock), ("b.jpg", {}), ("c.jpg", clock)):
        tagged_image(folder / name, (47, 0, 0.0), (16, 0, 0.0), **tags)
    given = {"images": str(folder)}
    new = project_of_files(tmp_path, given)
    text = new.contents["flight.toml"].decode()
    assert '\nfile = "images"' in text and "\nimage_size_px = [64, 48]" in text
    assert "\ntimes" not in text and ("camera", "image_size_px") not in new.needed
    (tmp_path / "t.csv").write_text(FILES["utc.csv"])
    given["track"] = str(tmp_path / "t.csv")
    (tmp_path / "p.csv").write_text(FILES["named.csv"])
    given["picks"] = str(tmp_path / "p.csv")
    new = project_of_files(tmp_path, given)
    text = new.contents["flight.toml"].decode()
    assert '\ntimes = "images"' in text and '\nfile = "t.csv"' in text
    assert_approved(new.said[-1], parts=[folder, 3])
    assert ("picks", "utc_offset_h") not in new.needed
    tagged_image(folder / "c.jpg", (47, 0, 0.0), taken="2026:05:01 12:00:00")
    new = project_of_files(tmp_path, given)
    assert_approved(new.needed["picks", "utc_offset_h"])
    assert ("flight", "epoch") not in new.needed
    (tmp_path / "s.csv").write_text("t_s,lat_deg,lon_deg,h_m\n0,47,16,9\n5,47,16,9\n")
    on_seconds = project_of_files(tmp_path, given | {"track": str(tmp_path / "s.csv")})
    assert_approved(on_seconds.needed["flight", "epoch"])
    del given["track"]
    new = project_of_files(tmp_path, given)
    assert_approved([one for one in new.said if "zone" in one or "use" in one], parts=[folder])
    text = new.contents["flight.toml"].decode()
    assert "\ntimes" not in text and not [key for _, key in new.needed if "utc" in key]


def test_images_that_are_the_track_give_no_times_besides(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The size of the lens stands; a project in the folder that one is in has its name."""
    (tmp_path / "images").mkdir()
    clock: dict[str, Any] = {"taken": "2026:05:01 12:00:00", "zone": "+02:00"}
    for name in ("a.jpg", "b.jpg"):
        tagged_image(tmp_path / "images" / name, (47, 0, 0.0), (16, 0, 0.0), **clock)
    (tmp_path / "lens.txt").write_text("1 PINHOLE 50 40 70 60 32 24\n")
    monkeypatch.chdir(tmp_path)
    new = project_of_files(Path(), {"images": "images", "lens": "lens.txt"})
    text = new.contents["flight.toml"].decode()
    assert "\ntimes" not in text and "\nimage_size_px = [50, 40]" in text
    assert ("picks", "frame_rate_hz") not in new.needed
    assert f'\nname = "{tmp_path.name}"' in text
    assert_approved(new.said[-1], parts=[2])


@pytest.mark.parametrize(
    ("option", "own", "common"),
    [("--sigma-position=3", 1.5, 3.0),
     ("--sigma-position=2,2,4", [1.0, 1.0, 2.0], [2.0, 2.0, 4.0]),
     ("--sigma-position=0.02", 0.02, None), ("--sigma-position=exact", "exact", None),
     ("--set=track.sigma_m=3", 3, None)],
)  # fmt: skip
def test_the_error_of_a_receiver_without_a_base_is_common(
    option: str, own: object, common: object, tmp_path: Path
) -> None:
    """A key that is named itself is meant as it is."""
    (tmp_path / "track.csv").write_text("t_s,lat,lon,alt\n0,48,15,300\n1,48,15,301\n")
    arguments = ("--track", tmp_path / "track.csv", option)
    assert run("new", tmp_path / "here", *arguments).status == 0
    track = read_project(tmp_path / "here" / "flight.toml").sections["track"].values
    assert (track["sigma_m"], track.get("sigma_bias_m")) == (own, common)


@pytest.mark.parametrize(
    ("noise_m", "stated", "least_m", "most_m"),
    [(2.4, "3", 2.1, 2.9), (0.3, "3", 1.5, 1.5), (5.0, "3", 3.0, 3.0), (2.4, "3,3,2", 2.0, 2.0)],
)
def test_positions_have_the_sigma_by_which_they_scatter(
    noise_m: float, stated: str, least_m: float, most_m: float, tmp_path: Path
) -> None:
    """From half of what is said of the receiver to all of it; the last case is of its heights."""
    rng = np.random.default_rng(5)
    time_s = np.arange(600) / 10.0
    east, north, up = rng.normal(0.0, noise_m, (3, 600))
    lat, lon = 48.0 + (5.0 * time_s + north) / 111_200.0, 15.0 + east / 74_600.0
    rows = np.stack([time_s, lat, lon, 300.0 + 2.0 * time_s**1.5 + up], axis=1)
    text = "".join("{:.1f},{:.9f},{:.9f},{:.3f}\n".format(*row) for row in rows)
    (tmp_path / "track.csv").write_text(f"t_s,lat,lon,alt\n{text}")
    here = tmp_path / "here"
    ran = run("new", here, "--track", tmp_path / "track.csv", "--sigma-position", stated)
    assert ran.status == 0
    track = read_project(here / "flight.toml").sections["track"].values
    own = np.array([track["sigma_m"]]).ravel()
    assert least_m <= own[-1] <= most_m
    assert run("new", here, "--set", "track.sigma_m=7").status == 0
    again = read_project(here / "flight.toml").sections["track"].values
    assert (again["sigma_m"], again["sigma_bias_m"]) == (7, track["sigma_bias_m"])


def test_frames_and_files_of_a_project_are_replaced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A video's by images, images by a video; clicks and landmarks by a list of both."""
    monkeypatch.chdir(tmp_path)
    inputs = ROOT / "tests" / "approved" / "inputs"
    shutil.copytree(inputs / "f12-images", "images")
    shutil.copy(inputs / "f12-picks" / "gcp_list.txt", ".")
    assert run("new", "ex").status == 0

    def picks_after(*options: str) -> dict[str, Any]:
        assert run("new", "v", *options).status == 0
        own = ("file", "times", "video", "frame_rate_hz")
        values = tomllib.loads(Path("v/flight.toml").read_text(encoding="utf-8"))["picks"]
        return {key: value for key, value in values.items() if key in own}

    others = "--landmarks=ex/landmarks.csv", "--track=ex/track.csv", "--lens=ex/lens.json"
    clicks = {"file": "clicks.csv"}
    of_images = {"times": "../images", "video": "../images"}
    of_video = {"times": "video", "video": "../ex/flight.mp4"}
    assert picks_after("--video", "ex/flight.mp4", *others) == clicks | of_video
    assert picks_after("--images", "images") == clicks | of_images
    assert picks_after("--height", "ellipsoid") == clicks | of_images
    assert picks_after("--video", "ex/flight.mp4") == clicks | of_video
    (tmp_path / "v" / "clicks.csv").write_text("frame,landmark,u_px,v_px\n0,L1,1,2\n")
    assert picks_after("--sigma-time", ".02") == clicks | of_video
    ran = run("new", "v", "--gcp", "gcp_list.txt")  # of images, which a video does not have
    assert ran.status == 1
    assert_approved(ran.stderr)
    both = "--gcp", "gcp_list.txt", "--images", "images"
    assert picks_after(*both) == {"file": "../gcp_list.txt"} | of_images
    landmarks = tomllib.loads(Path("v/flight.toml").read_text(encoding="utf-8"))["landmarks"]
    assert landmarks["file"] == "../gcp_list.txt"
    for options in (
        ["--images", "images", "--wind", "ex/wind.csv"],
        ["--video", "images/F0.JPG", "--video", "images/F1.JPG", "--gcp", "gcp_list.txt"],
    ):
        ran = run("new", "ex", *options)
        assert ran.status == 1
        assert_approved(ran.stderr)


@pytest.mark.parametrize(("given", "expected"), [([], 0.0), (["--first-frame", "2.5"], 2.5)])
def test_the_first_frame_is_at_the_epoch_if_nothing_else_is_said(
    given: list[str], expected: float, tmp_path: Path
) -> None:
    write_project(tmp_path)
    rows = [f"2026-05-01T11:58:{k}Z,47.64,16.47,{500 + k}" for k in (40, 45, 50)]
    (tmp_path / "t.csv").write_text("\n".join(["t_utc,lat_deg,lon_deg,h_m", *rows, ""]))
    files = ["--picks", tmp_path / "picks.csv", "--track", tmp_path / "t.csv"]
    clock = ["--fps", "10", "--epoch", "2026-05-01T11:58:42Z"]
    assert run("new", tmp_path / "new", *files, *clock, *given).status == 0
    values = tomllib.loads((tmp_path / "new" / "flight.toml").read_text(encoding="utf-8"))
    assert values["picks"]["first_frame_t_s"] == expected


def test_the_epoch_of_a_track_in_seconds_is_its_own(tmp_path: Path) -> None:
    """It was not used; frame 0 need not be at second 0 of the track."""
    write_project(tmp_path)
    files = ["--picks", tmp_path / "picks.csv", "--track", tmp_path / "track.csv"]
    clock = ["--fps", "10", "--epoch", "2026-05-01T11:58:42Z"]
    said = run("new", tmp_path / "new", *files, *clock).stdout
    assert_approved([line for line in said.splitlines() if line.startswith("--epoch")])
    values = tomllib.loads((tmp_path / "new" / "flight.toml").read_text(encoding="utf-8"))
    assert values["flight"]["epoch"].isoformat() == "2026-05-01T11:58:42+00:00"
    assert "first_frame_t_s" not in values["picks"]


def test_a_value_of_set_may_have_an_equals_sign(tmp_path: Path) -> None:
    write_project(tmp_path)
    crs, track = "+proj=utm +zone=33 +ellps=WGS84", tmp_path / "track.csv"
    ran = run("new", tmp_path / "new", "--track", track, "--set", f"landmarks.crs={crs}")
    assert ran.status == 0
    values = tomllib.loads((tmp_path / "new" / "flight.toml").read_text(encoding="utf-8"))
    assert values["landmarks"]["crs"] == crs


@pytest.mark.parametrize(
    "value",
    [
        "track.height={ undulation = 4 }",
        "track.height={ undulation_m = 'x' }",
        "flight.name=two\nlines",
    ],
)
def test_a_wrong_value_of_set_is_refused_before_anything_is_written(
    value: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_project(tmp_path)
    monkeypatch.chdir(tmp_path)
    ran = run("new", "new", "--track", "track.csv", "--set", value)
    assert ran.status != 0 and not Path("new").exists()
    assert_approved(ran.stderr.splitlines()[-1])


@pytest.mark.parametrize("metres", [".5", "-.5", "48"])
def test_a_height_in_metres_is_the_geoid_s(metres: str, tmp_path: Path) -> None:
    write_project(tmp_path)
    folder = tmp_path / "new"
    files = ["--landmarks", tmp_path / "landmarks.csv", "--track", tmp_path / "track.csv"]
    assert run("new", folder, *files, "--height", metres).status == 0
    values = tomllib.loads((folder / "flight.toml").read_text(encoding="utf-8"))
    for section in ("landmarks", "track"):
        assert values[section]["height"] == {"undulation_m": float(metres)}


def test_errors_of_several_files_are_told_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "marks.csv").write_text("name,lat,My East,Height?\na,47,15,400\n")
    (tmp_path / "clicks.csv").write_text("frame,mark it,u,v\n0,a,1,2\n")
    files = ["--landmarks", "marks.csv", "--picks", "clicks.csv", "--track", "none.csv"]
    monkeypatch.chdir(tmp_path)
    ran = run("new", "p", *files)
    assert ran.status == 1 and not Path("p").exists()
    assert_approved(ran.stderr.splitlines())


@pytest.mark.parametrize("code", ["EPSG:2056", "EPSG:999999"])
def test_a_crs_without_pyproj_or_that_is_none_is_told_at_once(
    code: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "marks.csv").write_text("name,x,y,h\na,2600000,1200000,400\n")
    if code == "EPSG:2056":
        monkeypatch.setitem(sys.modules, "pyproj", None)
    monkeypatch.chdir(tmp_path)
    ran = run("new", "p", "--landmarks", "marks.csv", "--crs", code)
    assert ran.status == 1 and not Path("p").exists()
    assert_approved(ran.stderr.splitlines())


CAMERA = {
    "lens": {"model": "brown", "fx_px": 1500.0, "fy_px": 1490.0, "cx_px": 960.0, "cy_px": 540.0},
    "image_size_px": [1920, 1080], "pixel_grid": "corner",
}  # fmt: skip
OF_CAMERA = (
    "--lens", "1500,1490,960,540", "--image-size", "1920,1080", "--pixel-grid", "corner",
    "--sigma-landmarks", ".05",
)  # fmt: skip
ON_GRID = "landmark,x_m,y_m,z_m\nchurch,610000,5278000,465\nmast,610200,5278100,490\n"
PLACES = {
    "track": (
        ("--track", "track.csv", "--height", "ellipsoid", "--fps", "10", "--first-frame", "2",
         "--epoch", "2026-05-01T00:00:00Z", "--sigma-position", "2,2,4", "--sigma-time", ".02",
         "--wind", "wind.csv"),
        {
            "flight": {"name": "new", "epoch": datetime(2026, 5, 1, tzinfo=UTC)},
            "picks": {"frame_rate_hz": 10, "first_frame_t_s": 2},
            "landmarks": {"file": "../landmarks.csv", "height": "ellipsoid"},
            "track": {"file": "../track.csv", "height": "ellipsoid", "sigma_m": [1, 1, 2],
                      "sigma_bias_m": [2, 2, 4], "sigma_t_s": 0.02},
            "wind": {"file": "../wind.csv"},
        },
    ),
    "clock": (
        ("--clock", "gps", "--track", "dated.csv", "--height", "egm96", "--fps", "10",
         "--epoch", "2026-05-01T12:00:01Z", "--sigma-position", ".02", "--sigma-time", "0"),
        {
            "flight": {"name": "new", "epoch": datetime(2026, 5, 1, 12, 0, 1, tzinfo=UTC)},
            "picks": {"frame_rate_hz": 10, "first_frame_t_s": 0.0},
            "landmarks": {"file": "../landmarks.csv", "height": "egm96"},
            "track": {"file": "../dated.csv", "height": "egm96", "clock": "gps", "sigma_m": 0.02,
                      "sigma_t_s": 0},
        },
    ),
    "position": (
        ("--position", "47.64,16.47,540", "--height", "same", "--sigma-position", "2,2,4"),
        {
            "flight": {"name": "new"}, "picks": {},
            "landmarks": {"file": "../landmarks.csv", "height": "same"},
            "position": {"lat_deg": 47.64, "lon_deg": 16.47, "h_m": 540, "height": "same",
                         "sigma_m": [2, 2, 4]},
        },
    ),
    "grid": (
        ("--position", "610000,5278000,540", "--height", "40", "--crs", "EPSG:32633",
         "--sigma-position", "3"),
        {
            "flight": {"name": "new"}, "picks": {},
            "landmarks": {"file": "../grid.csv", "height": {"undulation_m": 40},
                          "crs": "EPSG:32633"},
            "position": {"x_m": 610000, "y_m": 5278000, "z_m": 540, "crs": "EPSG:32633",
                         "height": {"undulation_m": 40}, "sigma_m": 3},
        },
    ),
}  # fmt: skip


@pytest.mark.parametrize("place", PLACES)
def test_each_option_gives_its_keys_and_nothing_more_is_needed(place: str, tmp_path: Path) -> None:
    """At once, or those of the place in a second call, which writes the file again."""
    write_project(tmp_path)
    (tmp_path / "wind.csv").write_text("h_m,speed_m_s,from_deg\n0,3,90\n1000,5,100\n")
    (tmp_path / "grid.csv").write_text(ON_GRID)
    rows = [f"2026-05-01T12:00:{k:02},47.64,16.47,{500 + k}" for k in range(3)]
    (tmp_path / "dated.csv").write_text("\n".join(["t_utc,lat_deg,lon_deg,h_m", *rows, ""]))
    given, expected = PLACES[place]
    expected = {**expected, "camera": CAMERA}
    expected["picks"] = {**expected["picks"], "file": "../picks.csv", "pixel_grid": "corner"}
    expected["landmarks"] = {**expected["landmarks"], "sigma_m": 0.05}
    marks = "grid.csv" if place == "grid" else "landmarks.csv"
    files = ("--picks", "picks.csv", "--landmarks", marks, *OF_CAMERA, *given)
    options = [*zip(files[::2], files[1::2], strict=True)]
    options = [(o, str(tmp_path / v) if v.endswith(".csv") else v) for o, v in options]
    for folder, calls in (("new", [options]), ("two/new", [options[:6], options[6:]])):
        for one in calls:
            done = run("new", tmp_path / folder, *(part for pair in one for part in pair))
            assert done.status == 0, done.stderr
        text = (tmp_path / folder / "flight.toml").read_text(encoding="utf-8")
        values = {name: own for name, own in tomllib.loads(text).items() if own}
        there = "../" * folder.count("/") + ".."
        wanted = json.loads(json.dumps(expected, default=str).replace('"..', f'"{there}'))
        wanted = {name: own for name, own in wanted.items() if own}
        assert json.loads(json.dumps(values, default=str)) == wanted
        assert "NEEDED (" not in text


def test_a_later_call_reads_files_in_the_coordinate_system_of_the_project(tmp_path: Path) -> None:
    """Which the call before gave, and counts in feet: a file in metres is refused by both."""
    for unit, system, status in (
        ("m", ["--crs", "EPSG:2263"], 1), ("ft", ["--crs", "EPSG:2263"], 0), ("m", [], 1),
    ):  # fmt: skip
        marks = tmp_path / f"in_{unit}.csv"
        marks.write_text(f"name,x_{unit},y_{unit},z_{unit}\na,987000,213000,40\n")
        ran = run("new", tmp_path / "p", "--landmarks", marks, *system)
        assert (ran.status, "US survey feet" in ran.stderr) == (status, bool(status))


def test_numbers_of_a_lens_begin_a_project(tmp_path: Path) -> None:
    """They stand for a file: nothing else need be known yet."""
    assert run("new", tmp_path / "p", *OF_CAMERA).status == 0
    assert tomllib.loads((tmp_path / "p" / "flight.toml").read_text())["camera"] == CAMERA


def test_numbers_of_a_lens_take_the_place_of_its_file(tmp_path: Path) -> None:
    """In the project that `vopd new` wrote before, of which no lens is read again."""
    (tmp_path / "lens.txt").write_text("1 PINHOLE 1920 1080 1400 1400 960 540\n")
    assert run("new", tmp_path / "p", "--lens", tmp_path / "lens.txt").status == 0
    again = run("new", tmp_path / "p", *OF_CAMERA)
    camera = tomllib.loads((tmp_path / "p" / "flight.toml").read_text())["camera"]
    assert (again.status, camera) == (0, CAMERA)
    assert not any("lens.txt" in line for line in again.stdout.splitlines())
