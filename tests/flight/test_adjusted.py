"""Adjusted projects: what was solved for is held, and gives the angles of the joint solution."""

from __future__ import annotations

import csv
import json
import os
import re
import shutil
import tomllib
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pyproj
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.command import ROOT, vopd
from tests.kit.simulated_flights import Errors, LensErrors, Plan, write_flight
from tests.kit.video import write_video
from tests.tolerances import assert_close
from vopd.attitude.history import History
from vopd.attitude.mean import mean_attitude
from vopd.attitude.sigmas import Sigmas
from vopd.cli.new import write_project
from vopd.findings import VopdError
from vopd.flight.adjust.adjustment import Adjustment, adjust
from vopd.flight.adjust.project import (
    adjusted_project,
    opencv_text,
    toml_value,
)
from vopd.flight.coordinates import STEPS, HeightDatum, coordinates_at, earth_centred_positions
from vopd.flight.formats.files import InputFile
from vopd.flight.formats.lens import LensQuestion, read_opencv
from vopd.flight.project.covariance import CovarianceFile, digests, digests_of_keys, held_text
from vopd.flight.project.keys import read_project
from vopd.flight.project.read import flight_of
from vopd.flight.result import FlightResult, solve_flight
from vopd.geometry.lenses import Lens, LensKind
from vopd.geometry.linear import norm

LENS = LensErrors(focal_rel=0.003, k1=0.01)
DRONE = Plan(
    Errors(landmark_m=(0.3,), fix_m=((1.0, 1.0, 2.0),), clock_s=0.1, lens=LENS),
    frames=24, landmarks=6, fix_hz=1.0, weave_m=8.0, speed_m_s=8.0,
)  # fmt: skip
LOOSE = DRONE._replace(
    errors=DRONE.errors._replace(bias_m=(1.0, 1.0, 1.0), lens=LENS._replace(u_px=3.0, v_px=3.0)),
    swing_deg=5.0,
)
FISHEYE = DRONE._replace(fisheye=True, focal_px=600.0)
TRIPOD = Plan(
    Errors(landmark_m=(0.3,), bias_m=(1.0, 1.0, 1.0), lens=LENS), frames=12, landmarks=6,
    stands=True,
)  # fmt: skip
EXACT = DRONE._replace(errors=Errors(lens=LENS), fix_hz=0.0)
"""Nothing is solved for besides the rotations once the lens is held."""


PLACE = "lon_deg", "lat_deg", "h_m"


class Both(NamedTuple):
    """A flight solved with free parameters, and its adjusted project."""

    joint: Adjustment
    again: FlightResult
    folder: Path


def adjusted(folder: Path, plan: Plan, *free: str, more: str = "", seed: int = 1) -> Both:
    file = written(folder, plan, {}, seed)
    file.write_text(file.read_text(encoding="utf-8") + more, encoding="utf-8")
    return again(folder, file, *free)


def written(folder: Path, plan: Plan, keys: dict[str, str], seed: int = 1) -> Path:
    """A flight in a folder below, with further lines at the beginning of some sections."""
    source = folder / "source"
    source.mkdir()
    write_flight(source, plan, np.random.default_rng(seed))
    file = source / "flight.toml"
    text = file.read_text(encoding="utf-8")
    for section, lines in keys.items():
        assert f"[{section}]\n" in text
        text = text.replace(f"[{section}]\n", f"[{section}]\n{lines}\n", 1)
    file.write_text(text, encoding="utf-8")
    return file


def again(folder: Path, file: Path, *free: str) -> Both:
    project = read_project(str(file))
    joint = adjust(flight_of(project), free)
    new = folder / "new"
    write_project(new, adjusted_project(project, joint, new))
    return Both(joint, solve_flight(new / "flight.toml"), new)


@pytest.fixture(scope="module")
def drone(tmp_path_factory: pytest.TempPathFactory) -> Both:
    return adjusted(tmp_path_factory.mktemp("drone"), DRONE, "focal", "k1", "clock", "landmarks")


@pytest.fixture
def copied(drone: Both, tmp_path: Path) -> Path:
    """The folder of an adjusted project, whose files may be spoiled."""
    shutil.copytree(drone.folder.parent, tmp_path, dirs_exist_ok=True)
    return tmp_path / "new"


# Angles and standard deviations


def assert_alike(both: Both) -> None:
    """Within a hundredth of a standard deviation, each of them and their covariance."""
    joint, held = both.joint.result.history(), both.again.history()
    sigma = joint.uncertainty.total[:, :6]
    for name in ("vehicle_deg", "camera_deg"):
        own = np.s_[:, 3:] if name == "vehicle_deg" else np.s_[:, :3]
        away = getattr(held.estimate, name) - getattr(joint.estimate, name)
        assert_close("part of a sigma", (((away + 180.0) % 360.0) - 180.0) / sigma[own], 0.0)
    assert_close("part of a sigma", held.uncertainty.total[:, :6] / sigma, 1.0)
    size = np.sqrt(np.einsum("fii->fi", joint.uncertainty.covariance_deg2))
    gap = held.uncertainty.covariance_deg2 - joint.uncertainty.covariance_deg2
    assert_close("part of a sigma", gap / (size[:, :, None] * size[:, None]), 0.0)
    half = held.uncertainty.half_width_95[:, :6] / joint.uncertainty.half_width_95[:, :6]
    assert_close("part of a sigma", half, 1.0)
    means = mean_attitude(held), mean_attitude(joint)
    assert_close("part of a sigma", means[0].total / means[1].total, 1.0)
    assert_close("part of a sigma", means[0].half_width_95 / means[1].half_width_95, 1.0)


def assert_sigmas_are_of_one_unit(both: Both) -> None:
    """Those of the parameters, as ppm and ms, and the roots of their covariance."""
    held = np.array([one.held for one in both.joint.parameters])
    sigma = np.array([one.sigma_after for one in both.joint.parameters])
    variance = np.diag(both.joint.covariance)
    assert held.any()
    assert_close("part of a sigma", sigma[held] / np.sqrt(variance[held]), 1.0)


def test_a_drone(drone: Both) -> None:
    assert_alike(drone)
    assert "adjusted" in drone.again.history().uncertainty.components


@pytest.mark.parametrize(
    ("plan", "free", "more"),
    [
        (LOOSE, ("focal", "aspect", "centre", "k1", "clock", "clock-rate", "track-offset"), ""),
        (FISHEYE, ("focal", "k1", "clock"), ""),
        (LOOSE, ("focal", "clock"), ""),
        (TRIPOD, ("focal", "k1"), ""),
        (EXACT, ("focal", "k1"), ""),
        (DRONE, ("focal", "clock"), '[solve]\nloss = "huber"\n'),
        (DRONE._replace(sigma_px=True), ("k1",), ""),
    ],
    ids=["all", "fisheye", "some", "tripod", "exact", "huber", "stated"],
)
def test_angles_and_sigmas_are_those_of_the_joint_solution(
    tmp_path: Path, plan: Plan, free: tuple[str, ...], more: str
) -> None:
    both = adjusted(tmp_path, plan, *free, more=more)
    assert_alike(both)
    assert_sigmas_are_of_one_unit(both)
    one, other = (r.history().estimate for r in (both.joint.result, both.again))
    if plan is not EXACT:  # where a clock alone moves the places
        assert one.position_sigma is not None and other.position_sigma is not None
        assert_close("sigma of a place", other.position_sigma / one.position_sigma, 1.0)


def test_errors_of_places_that_are_fixed_are_in_the_values_and_in_the_frames(
    tmp_path: Path,
) -> None:
    """In both by themselves; the values had those of the picks alone."""
    errors = DRONE.errors._replace(clock_s=0.5, lens=LENS._replace(focal_rel=0.03))
    plan = DRONE._replace(errors=errors)
    both = adjusted(tmp_path, plan, "focal", "clock", more='[solve]\nposition = "fixed"\n')
    assert_sigmas_are_of_one_unit(both)
    one, other = both.joint.result.history(), both.again.history()
    sigma = one.uncertainty.total[:, :6]
    away = other.estimate.camera_deg - one.estimate.camera_deg
    assert_close("part of a sigma", (((away + 180.0) % 360.0) - 180.0) / sigma[:, :3], 0.0)
    assert_close("sigma beside fixed places", other.uncertainty.total[:, :6] / sigma, 1.0)
    means = mean_attitude(other), mean_attitude(one)
    assert_close("sigma beside fixed places", means[0].total / means[1].total, 1.0)


def test_a_rate_of_the_clock_moves_all_frames_but_the_middle_one(tmp_path: Path) -> None:
    """By their velocity, and by how late they are by it."""
    both = adjusted(tmp_path, DRONE._replace(frames=7), "clock-rate")
    (rate,) = [one.after * 1e-6 for one in both.joint.parameters if one.name == "clock-rate"]
    read = both.joint.result.read
    fixes = read.path.fixes
    assert fixes is not None and fixes.slopes is not None
    late_s = rate * (read.time_s - 1.5)
    moved_m = norm(both.again.read.path.position_m - read.path.position_m)
    by_m = norm(fixes.slopes.velocity_m_s) * np.abs(late_s)
    others = np.arange(7) != 3
    assert moved_m[3] == 0.0 and (by_m[others] > 0.2).all()
    assert (np.abs(moved_m - by_m) < 0.1 * by_m)[others].all()  # they turn, too


def test_a_readout_is_written_in_milliseconds(tmp_path: Path) -> None:
    """The rows of these frames are all of one time, and 16 ms are far off."""
    keys = {
        "camera": 'readout_ms = 16.0\nreadout = "down"\nframe_time = "middle"',
        "uncertainty": "readout_ms = 2.0",
    }
    file = written(tmp_path, DRONE._replace(swing_deg=15.0), keys)
    both = again(tmp_path, file, "readout")
    (readout,) = both.joint.parameters
    away_deg = both.again.camera_deg - both.joint.result.camera_deg
    sigma_deg = both.again.history().uncertainty.total[:, :3]
    assert_close("part of a sigma", away_deg / sigma_deg, 0.0)
    assert_sigmas_are_of_one_unit(both)
    project = tomllib.loads((both.folder / "flight.toml").read_text(encoding="utf-8"))
    assert readout.after < readout.before / 2.0
    assert_close("table value", project["camera"]["readout_ms"], readout.after)


def test_a_readout_that_no_shutter_has_is_not_written(tmp_path: Path) -> None:
    keys = {"camera": 'readout_ms = 16.0\nreadout = "down"\nframe_time = "middle"'}
    file = written(tmp_path, DRONE._replace(swing_deg=15.0), keys, seed=2)
    project = read_project(str(file))
    joint = adjust(flight_of(project), ("readout",))
    (readout,) = joint.parameters
    assert readout.after < 0.0
    with refused(parts=[f"{readout.after:.3g}"]):
        adjusted_project(project, joint, tmp_path / "new")


PLACED = "(?m)^(m0.*)$", "(?m)^(m[1-9].*)$"


@pytest.mark.parametrize(
    ("edits", "free"),
    [
        ([("landmarks.csv", "(?m)^m0,", '"#0",'), ("picks.csv", ",m0,", ',"#0",')], ("k1",)),
        (
            [
                ("landmarks.csv", "h_m", "h_m,sigma_m"),
                ("landmarks.csv", PLACED[0], r"\1,exact"),
                ("landmarks.csv", PLACED[1], r"\1,"),
            ],
            ("k1",),
        ),
        (
            [
                ("flight.toml", "= 0.3\n", "= [0.3, 0.3, 0]\n"),
                ("flight.toml", "bias_m = 1\n", "bias_m = [0, 1, 1]\n"),
            ],
            ("focal", "k1"),
        ),
        ([("flight.toml", "bias_m = 1\n", "bias_m = [1, 0, 1]\n")], ("k1", "track-offset")),
        (
            [
                ("flight.toml", "1500.0", "3000.0"),
                ("flight.toml", "959.5", "1919.5"),
                ("flight.toml", "539.5", "1079.5"),
                ("flight.toml", "(image_size.*)", r"\1\nlens_size_px = [3840, 2160]"),
            ],
            ("k1",),
        ),
        (
            [("flight.toml", r"(?s)\[camera\.lens\].*?\]\n", 'lens = "two.txt"\ncamera = "2"\n')],
            ("k1",),
        ),
    ],
    ids=["comment", "exact", "exact heights", "exact offset", "size", "camera"],
)
def test_what_is_written_can_be_read(
    tmp_path: Path, edits: list[tuple[str, str, str]], free: tuple[str, ...]
) -> None:
    """A name like a comment, exact landmarks and axes, a lens of another size, one of two."""
    file = written(tmp_path, LOOSE, {})
    found = re.search(r"k = \[(.*)\]", file.read_text(encoding="utf-8"))
    k = found[1].replace(",", "") if found else ""
    lenses = f"1 PINHOLE 64 48 70 70 32 24\n2 OPENCV 1920 1080 1500 1500 960 540 {k}\n"
    file.with_name("two.txt").write_text(lenses, encoding="utf-8")
    for name, old, new in edits:
        one = file.with_name(name)
        text, count = re.subn(old, new, one.read_text(encoding="utf-8"))
        assert count
        one.write_text(text, encoding="utf-8")
    assert_alike(again(tmp_path, file, *free))


def test_patches_of_landmarks_stay_as_they_are(tmp_path: Path) -> None:
    """A mast has a patch of its own, and the others the usual one."""
    file = written(tmp_path, LOOSE, {})
    table = file.with_name("landmarks.csv")
    head, first, *rows = table.read_text(encoding="utf-8").split()
    lines = [f"{head},patch_px", f"{first},13", *(f"{row}," for row in rows)]
    table.write_text("\n".join(lines), encoding="utf-8")
    sides = again(tmp_path, file, "landmarks").again.flight.landmarks.patch_px
    assert sides is not None and np.array_equal(sides[:2], [13.0, np.nan], equal_nan=True)


@pytest.mark.skipif(os.name == "nt", reason="links need a right of their own")
def test_files_are_named_from_where_a_link_leads(tmp_path: Path) -> None:
    """The system takes .. from there."""
    deep = tmp_path / "a" / "b" / "c"
    deep.mkdir(parents=True)
    (tmp_path / "link").symlink_to(deep)
    file = written(tmp_path, DRONE, {})
    project = read_project(str(file))
    joint = adjust(flight_of(project), ("focal",))
    new = tmp_path / "link" / "new"
    write_project(new, adjusted_project(project, joint, new))
    assert solve_flight(new / "flight.toml").solved.all()


def test_all_files_of_a_video_are_named_from_the_new_folder(tmp_path: Path) -> None:
    file = written(tmp_path, DRONE, {"picks": 'video = ["a.mp4", "b.mp4"]'})
    for name in ("a.mp4", "b.mp4"):
        at_ms = np.arange(12) * 1000 / DRONE.frame_hz
        write_video(file.with_name(name), at_ms.astype(int).tolist())
    new = again(tmp_path, file, "focal").folder / "flight.toml"
    picks = tomllib.loads(new.read_text(encoding="utf-8"))["picks"]
    assert picks["video"] == ["../source/a.mp4", "../source/b.mp4"]


def history_with(folder: Path, change: Callable[[dict[str, Any]], None]) -> History:
    file = folder / "covariance.json"
    values = json.loads(file.read_text(encoding="utf-8"))
    change(values)
    file.write_text(json.dumps(values), encoding="utf-8")
    return solve_flight(folder / "flight.toml").history()


def test_twice_the_stated_errors_are_twice_their_component(drone: Both, copied: Path) -> None:
    """The angles stay: what is named is held."""

    def quadrupled(values: dict[str, Any]) -> None:
        for key in ("covariance", "by_picks"):
            values[key] = (4.0 * np.array(values[key])).tolist()

    before, after = drone.again.history(), history_with(copied, quadrupled)
    assert_close("part of a sigma", after.estimate.vehicle_deg - before.estimate.vehicle_deg, 0.0)
    ratio = after.uncertainty.components["adjusted"] / before.uncertainty.components["adjusted"]
    assert_close("part of a sigma", ratio, 2.0)


def test_other_standard_deviations_are_for_the_project_that_was_adjusted(drone: Both) -> None:
    with refused():
        drone.again.history(Sigmas(landmark=1.0))
    assert drone.again.history(Sigmas(mount_deg=1.0)).uncertainty.components["mount"].any()


# Files


def test_unchanged_files_stay_where_they_are(drone: Both) -> None:
    project = tomllib.loads((drone.folder / "flight.toml").read_text(encoding="utf-8"))
    assert project["picks"]["file"] == "../source/picks.csv"
    assert project["track"]["file"] == "../source/track.csv"
    assert sorted(one.name for one in drone.folder.iterdir()) == [
        "covariance.json", "flight.toml", "landmarks.csv", "lens.json",
    ]  # fmt: skip


def test_the_files_have_what_was_solved_for(drone: Both) -> None:
    flight = flight_of(read_project(str(drone.folder / "flight.toml")))
    joint = drone.joint.result.estimates.joint
    assert joint is not None
    value = {one.name: one.after for one in drone.joint.parameters}
    assert_close("flight pixel", flight.lens.focal_px.mean(), value["focal"])
    project = tomllib.loads((drone.folder / "flight.toml").read_text(encoding="utf-8"))
    assert_close("table value", project["track"]["offset_s"], -value["clock"])
    moved = joint.model.flight.landmarks.position_m + joint.model.landmark_by_m(joint.state)
    assert_close("moved position", flight.landmarks.position_m, moved)
    held = json.loads((drone.folder / "covariance.json").read_text(encoding="utf-8"))
    sigma = dict(zip(held["names"], np.sqrt(np.diag(held["covariance"])), strict=True))
    for one in drone.joint.parameters:
        assert_close("part of a sigma", sigma[one.name] / one.sigma_after, 1.0)


def test_a_covariance_is_written_to_the_last_bit(drone: Both) -> None:
    """Variances of 1e-30 to 1e9, as those of k5 and of pixels are."""
    file = drone.folder / "covariance.json"
    values = json.loads(file.read_text(encoding="utf-8"))
    names = values["names"]
    scale = np.logspace(-15.0, 4.5, len(names))
    root = np.random.default_rng(1).normal(size=(len(names), len(names))) * scale[:, None]
    covariance = root @ root.T
    written = CovarianceFile(
        "flight.toml", ("focal",), tuple(names), tuple(values["units"]), scale, covariance,
        covariance / 3.0, 0, None, 1.0, 1.0, 5.0, "", {},
    )  # fmt: skip
    read = json.loads(written.text())
    assert read["values"] == scale.tolist()
    assert read["covariance"] == covariance.tolist()
    assert read["by_picks"] == (covariance / 3.0).tolist()


def test_all_that_is_held_is_named(drone: Both) -> None:
    held: Any = SimpleNamespace(parameter=("focal", "k1", "east"), landmark=np.arange(3))
    flight = flight_of(read_project(str(drone.folder / "flight.toml")))
    assert_approved(held_text(flight, held))


def test_a_project_that_is_there_is_not_overwritten(drone: Both) -> None:
    source = drone.folder.parent / "source" / "flight.toml"
    project = read_project(str(source))
    new = adjusted_project(project, drone.joint, drone.folder)
    with refused():
        write_project(drone.folder, new)


@pytest.mark.parametrize("name", ["source/picks.csv", "source/track.csv", "new/landmarks.csv"])
def test_changed_files_are_refused(copied: Path, name: str) -> None:
    file = copied.parent / name
    file.write_text(file.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    with refused():
        solve_flight(copied / "flight.toml")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (r"(?m)^(\[picks\]\n(.+\n)*)pixel_grid = .centre.", r'\1pixel_grid = "one-based"'),
        ("(?m)^frame_rate_hz = 2.0", "frame_rate_hz = 2.1"),
        ("(?m)^refraction = .*", "refraction = { k = 0.13 }"),
        (r"(?m)^\[picks\]", '[picks]\nv = "up"'),
        (r"(?m)^\[flight\]", "[flight]\nepoch = 2026-05-01T11:58:42Z"),
        (r"(?m)^(\[landmarks\]\n(.+\n)*)height = .ellipsoid.", r"\1height = { undulation_m = 5 }"),
        ("(?m)^image_size_px = .*\n", ""),
    ],
    ids=["grid", "rate", "refraction", "v", "epoch", "height", "size"],
)
def test_files_that_are_read_otherwise_are_refused(copied: Path, old: str, new: str) -> None:
    """The lens and the landmarks came out of the files as they were read."""
    file = copied / "flight.toml"
    text, count = re.subn(old, new, file.read_text(encoding="utf-8"))
    assert count == 1
    file.write_text(text, encoding="utf-8")
    with refused():
        solve_flight(file)


def test_keys_that_say_nothing_of_the_files_may_change(drone: Both, copied: Path) -> None:
    """A title, a standard deviation, a default; and all beside a file of an earlier day."""
    file, covariance = copied / "flight.toml", copied / "covariance.json"
    text = file.read_text(encoding="utf-8")
    for old, new in (
        ('"simulated"', '"other"'),
        ("frame_rate_hz = 2.0", 'frame_rate_hz = 2\nv = "down"'),
        ("(?m)^sigma_t_s = 0.1", "sigma_t_s = 1.0"),
    ):
        text, count = re.subn(old, new, text)
        assert count == 1
    file.write_text(text, encoding="utf-8")
    assert_close("residual as solved", solve_flight(file).camera_deg, drone.again.camera_deg)
    values = json.loads(covariance.read_text(encoding="utf-8"))
    values["sha256"] = {k: v for k, v in values["sha256"].items() if k.endswith((" file", " lens"))}
    covariance.write_text(json.dumps(values), encoding="utf-8")
    file.write_text(re.sub("(?m)^refraction = .*", "", text), encoding="utf-8")
    assert solve_flight(file).solved.all()


def test_the_mount_counts_where_there_is_a_lever_arm() -> None:
    """It places the camera then; without one it turns the vehicle's angles alone."""
    arm, mount = {"track": {"lever_arm_m": [1.0, 0.0, 0.0]}}, {"vehicle": {"mount": "down"}}
    assert not digests_of_keys(mount)
    assert {*digests_of_keys(arm | mount)} - {*digests_of_keys(arm)} == {"[vehicle] mount"}


def test_a_file_that_is_new_is_refused(copied: Path) -> None:
    file = copied / "flight.toml"
    (copied / "times.csv").write_text("frame,t_s\n0,1\n", encoding="utf-8")
    text = file.read_text(encoding="utf-8")
    file.write_text(re.sub("(?m)^frame_rate_hz.*$", 'times = "times.csv"', text), encoding="utf-8")
    with refused():
        solve_flight(file)


def test_of_the_images_of_a_folder_names_sizes_and_tags_count(tmp_path: Path) -> None:
    """Those of drones have some megabytes each: what is behind the tags is not read."""

    def digest(name: str, content: bytes) -> str:
        folder = tmp_path / f"{len([*tmp_path.iterdir()])}"
        (folder / "inside").mkdir(parents=True)
        (folder / name).write_bytes(content)
        return digests({"[track] file": folder})["[track] file"]

    first = digest("a.jpg", b"tags" + bytes(70_000))
    assert digest("a.jpg", b"tags" + bytes(69_999) + b"1") == first
    others = [("b.jpg", b"tags" + bytes(70_000)), ("a.jpg", b"tags" + bytes(70_001)),
              ("a.jpg", b"tagS" + bytes(70_000))]  # fmt: skip
    assert first not in [digest(*one) for one in others]


def test_a_lens_with_a_skew_is_written_as_a_table(tmp_path: Path) -> None:
    """As OpenCV has none like it."""
    file = written(tmp_path, EXACT, {"camera.lens": "skew_px = 2.5"})
    both = again(tmp_path, file, "focal", "k1")
    lens = both.again.flight.lens
    assert isinstance(lens, Lens) and lens.skew_px == 2.5
    assert_close("flight pixel", lens.focal_px, both.joint.result.flight.lens.focal_px)
    assert_close("table value", lens.k, both.joint.result.flight.lens.k)
    assert_alike(both)


def test_the_lens_of_a_table_of_images_is_the_one_solved_for(tmp_path: Path) -> None:
    """Images of one camera: the new project names the new lens, and the table no more."""
    file = written(tmp_path, EXACT, {})
    flight, table = flight_of(read_project(str(file))), file.with_name("lenses.csv")
    file.with_name("old.json").write_text(opencv_text(flight.lens), encoding="utf-8")
    rows = [f"{frame},old.json" for frame in flight.frame.tolist()]
    table.write_text("\n".join(["frame,lens", *rows]), encoding="utf-8")
    text = file.read_text(encoding="utf-8")
    file.write_text(text.replace("[camera]", '[camera]\nof_images = "lenses.csv"'))
    both = again(tmp_path, file, "focal", "k1")
    assert both.again.flight.lens.focal_px[0] != flight.lens.focal_px[0]
    assert_alike(both)


def test_another_offset_of_the_clock_is_refused(copied: Path) -> None:
    file = copied / "flight.toml"
    text = file.read_text(encoding="utf-8")
    file.write_text(re.sub("\noffset_s = [-.0-9e]+", "\noffset_s = 0.5", text))
    with refused():
        solve_flight(file)


def test_free_parameters_of_an_adjusted_project_are_refused(copied: Path) -> None:
    file = copied / "flight.toml"
    text = file.read_text(encoding="utf-8")
    file.write_text(text.replace("[solve]\n", '[solve]\nfree = ["k1"]\n'))
    with refused():
        solve_flight(file)


def test_the_command_writes_a_project_and_starts_from_the_priors_of_the_first(
    drone: Both, tmp_path: Path
) -> None:
    source, new = drone.folder.parent / "source" / "flight.toml", tmp_path / "new"
    done = vopd("adjust", source, "--free", "focal", "--format", "csv", "-o", new)
    assert done.status == 0
    assert vopd("attitude", new / "flight.toml", "-q").status == 0
    assert vopd("adjust", source, "--free", "focal", "-o", new).status == 1
    once_more = vopd("adjust", new / "flight.toml", "--free", "focal", "--format", "csv")
    assert once_more.stdout == done.stdout
    assert_approved(once_more.stderr.splitlines()[0], parts=[source.as_posix()])


def test_a_flight_that_misfits_is_status_3(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "examples" / "hill", tmp_path, dirs_exist_ok=True)
    file = tmp_path / "flight.toml"
    sharp = file.read_text(encoding="utf-8").replace("[picks]\n", "[picks]\nsigma_px = 0.01\n")
    file.write_text(sharp, encoding="utf-8")
    assert vopd("adjust", file, "--free", "focal", "-q").status == 3


def test_a_project_that_was_adjusted_needs_the_first(copied: Path) -> None:
    """Whose priors it starts from: it says which, and why it cannot be read."""
    first = copied.parent / "source" / "flight.toml"
    first.write_text(first.read_text(encoding="utf-8") + "[nonsense]\n", encoding="utf-8")
    with refused(VopdError, parts=[copied.parent.as_posix()]):
        adjust(str(copied / "flight.toml"), ["focal"])


@pytest.mark.parametrize("name", ["a\nb", " a", "\u2028"])
def test_a_name_that_a_table_would_not_have_as_it_is_is_not_written(
    name: str, tmp_path: Path
) -> None:
    """The project was written, and every command refused its table of landmarks."""
    file = written(tmp_path, DRONE, {})
    table = file.with_name("landmarks.csv")
    rows = csv.DictReader(table.read_text(encoding="utf-8").splitlines())
    places = {one["landmark"]: [float(one[key]) for key in PLACE] for one in rows}
    features = [
        {
            "type": "Feature",
            "properties": {"name": one},
            "geometry": {"type": "Point", "coordinates": place},
        }
        for one, place in (places | {name: next(iter(places.values()))}).items()
    ]
    text = json.dumps({"type": "FeatureCollection", "features": features})
    table.write_text(text, encoding="utf-8")
    project = read_project(str(file))
    joint = adjust(flight_of(project), ["focal", "landmarks"])
    with refused(VopdError, parts=[tmp_path.as_posix()]):
        adjusted_project(project, joint, tmp_path / "new")


def test_where_nothing_is_in_common_nothing_is_written(tmp_path: Path) -> None:
    source = tmp_path / "source"
    source.mkdir()
    write_flight(source, EXACT._replace(errors=Errors()), np.random.default_rng(1))
    project = read_project(str(source / "flight.toml"))
    with refused(VopdError, parts=[tmp_path.as_posix()]):
        adjusted_project(project, adjust(flight_of(project), []), tmp_path / "new")


# A damaged covariance file


def put(*path: Any, value: Any) -> Callable[[dict[str, Any]], None]:
    def change(values: dict[str, Any]) -> None:
        where: Any = values
        for one in path[:-1]:
            where = where[one]
        where[path[-1]] = value

    return change


def shortened(values: dict[str, Any]) -> None:
    del values["covariance"][2]


def larger(values: dict[str, Any]) -> None:
    values["by_picks"] = (2.0 * np.array(values["covariance"])).tolist()


def crooked(values: dict[str, Any]) -> None:
    values["covariance"][0][1], values["covariance"][1][0] = 1.0, 2.0


@pytest.mark.parametrize(
    "change",
    [
        crooked,
        shortened,
        larger,
        put("covariance", 0, 0, value=-1.0),
        put("by_picks", 1, 1, value=1e-30),
        put("covariance", 0, 1, value=float("nan")),
        put("covariance", value=1.0),
        put("values", 2, value=1e999),
        put("covariance", 1, 1, value=1e308),
        put("sigma_px", value=1e308),
        put("values", 2, value=10**400),
        put("values", 2, value="0"),
        put("names", 1, value="focal"),
        put("names", 1, value="k7"),
        put("names", 1, value="readout"),
        put("names", -1, value="landmark:m0 uq"),
        put("names", 1, value=7),
        put("names", value=[]),
        put("units", 0, value="mm"),
        put("units", value=["px"]),
        put("sigma_px", value=0),
        put("degrees_of_freedom", value=True),
        put("reading_sigma_by", value="guess"),
        put("reading_sigma_by", value=[]),
        put("unknowns", value=-1),
        put("adjusted_from", value=""),
        put("sha256", value=[]),
        put("version", value=2),
        lambda values: values.pop("units"),
        lambda values: [values[key].pop() for key in ("names", "units", "values")],
        lambda values: values.update(names=["k2" if n == "clock" else n for n in values["names"]]),
        put("values", 0, value=1500.0),
        put("values", -1, value=1.0),
        put("offset_s_before", value=None),
        put("sigma_px", value=1e-300),
        put("reading_sigma_px", value=1e-300),
        put("covariance", 0, value=[1.0, 2.0]),
        lambda values: values["covariance"][0].append(0.0),
        lambda values: values["values"].append(1.0),
        put("covariance", 0, value="row"),
        put("sha256", "[wind] file", value="0" * 64),
        put("adjusted_from", value="a\nb"),
        put("free", value=["focal\u2028"]),
        lambda values: values.update(adjusted_from="a b", free=["$(id)", "k1"], sha256={}),
    ],
)
def test_a_damaged_covariance_file_is_refused(
    copied: Path, change: Callable[[dict[str, Any]], None]
) -> None:
    with refused():
        history_with(copied, change)


@pytest.mark.parametrize("text", ["", "{", "[" * 100_000, "[]", '"a"'])
def test_a_covariance_file_that_is_no_table_is_refused(copied: Path, text: str) -> None:
    (copied / "covariance.json").write_text(text, encoding="utf-8")
    with refused():
        solve_flight(copied / "flight.toml")


def test_a_folder_is_no_covariance_file(copied: Path) -> None:
    (copied / "covariance.json").unlink()
    (copied / "covariance.json").mkdir()
    with refused():
        solve_flight(copied / "flight.toml")


def test_a_landmark_has_three_coordinates(copied: Path) -> None:
    def without_last(values: dict[str, Any]) -> None:
        for key in ("names", "units", "values", "covariance", "by_picks"):
            del values[key][-1]
        for key in ("covariance", "by_picks"):
            values[key] = [row[:-1] for row in values[key]]

    with refused():
        history_with(copied, without_last)


# Parts


def test_lenses_go_through_opencv() -> None:
    k = np.array([-0.1, 0.02, 1e-3, -2e-3, 3e-3, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    focal, centre = np.array([1500.0, 1490.0]), np.array([962.3, 534.8])
    for lens in (
        Lens(LensKind.BROWN, (1920, 1080), focal, centre, k, 0.0),
        Lens(LensKind.BROWN, (1920, 1080), focal, centre, k * (np.arange(12) < 1), 0.0),
        Lens(LensKind.FISHEYE, (1920, 1080), focal, centre, k[:4], 0.0),
    ):
        found = read_opencv(InputFile("lens.json", Path(), opencv_text(lens)), LensQuestion()).lens
        assert found.kind == lens.kind
        assert found.size_px == lens.size_px
        assert_close("flight pixel", np.r_[found.focal_px, found.centre_px], np.r_[focal, centre])
        assert found.k.tolist() == lens.k.tolist()


def test_values_are_written_as_toml_has_them() -> None:
    text = 'a = 1\nb = [1.5, "x\\"y"]\nc = { d = true, e = [[1, 2]] }\nf = 2026-05-01T11:58:42Z\n'
    values = tomllib.loads(text)
    lines = "".join(f"{key} = {toml_value(value)}\n" for key, value in values.items())
    assert tomllib.loads(lines) == values


@pytest.mark.parametrize("crs", ["+proj=utm +zone={} +datum=WGS84 +units=us-ft", "EPSG:4326"])
def test_landmarks_are_written_in_the_units_of_their_crs(tmp_path: Path, crs: str) -> None:
    """The new table would be metres by its names, and x and y are feet; or degrees of six decimals.

    As x and y degrees are in gcp_list.txt; the sixth is a tenth of a metre.
    """
    source = tmp_path / "source"
    source.mkdir()
    write_flight(source, DRONE, np.random.default_rng(1))
    file, table = source / "flight.toml", source / "landmarks.csv"
    head, *rows = (one.split(",") for one in table.read_text(encoding="utf-8").split())
    assert head[:4] == ["landmark", "lat_deg", "lon_deg", "h_m"]
    zone = round((float(rows[0][2]) + 183.0) / 6.0)
    crs = crs.format(zone)
    plane = pyproj.Transformer.from_crs("EPSG:4326", crs, always_xy=True)
    for row in rows:
        row[1:3] = map(repr, plane.transform(float(row[2]), float(row[1])))
    lines = [",".join(one) for one in (["landmark", "x", "y", "z_m", *head[4:]], *rows)]
    table.write_text("\n".join(lines), encoding="utf-8")
    text = file.read_text(encoding="utf-8").replace("[landmarks]", f'[landmarks]\ncrs = "{crs}"')
    file.write_text(text, encoding="utf-8")
    assert_alike(again(tmp_path, file, "focal", "landmarks"))


@pytest.mark.parametrize("crs", ["EPSG:32633", None])
def test_coordinates_are_moved_in_their_own_system(crs: str | None) -> None:
    before = np.array([[15.0, 48.0, 300.0], [15.1, 48.1, 900.0]])
    if crs is not None:
        before = np.array([[500000.0, 5316000.0, 300.0], [507000.0, 5327000.0, 900.0]])

    def positions(coordinate: np.ndarray) -> np.ndarray:
        return earth_centred_positions(coordinate, crs is None, crs, HeightDatum("ellipsoid"), "x")

    wanted = positions(before) + np.array([[3.0, -40.0, 7.0], [-0.5, 0.25, 100.0]])
    found = coordinates_at(wanted, before, positions, STEPS[crs is None])
    assert_close("moved position", positions(found), wanted)
