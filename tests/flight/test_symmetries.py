"""Flights that are mirrored, turned, delayed, enlarged or in another order: the same answer.

The Earth is alike at all longitudes, and east of the meridian as west of it. All columns of the
table of attitudes are compared, and what is said.
"""

from __future__ import annotations

import csv
import json
import re
import shutil
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vopd
from tests.kit.simulated_flights import Errors, LensErrors, Plan, write_flight
from tests.tolerances import assert_close, within
from vopd.attitude.table import table
from vopd.flight.adjust.adjustment import adjust
from vopd.flight.project.read import read_flight

SIZE = (1920, 1080)
EVERYTHING = Plan(
    Errors(
        landmark_m=(0.1,), fix_m=((1.0, 1.0, 2.0),), bias_m=(0.5, 0.5, 0.5), clock_s=0.05,
        readout_ms=2.0, velocity_m_s=0.1, wind_m_s=1.0, lens=LensErrors(focal_rel=0.001),
    ),
    frames=6, landmarks=6, sigma_px=True, velocity=True, wind=True, readout_ms=20.0,
    distortion=(-0.1, 0.02), refraction=0.13, swing_deg=3.0,
)  # fmt: skip
PLANS = {
    "everything": (EVERYTHING, ""),
    "at once": (
        EVERYTHING._replace(errors=EVERYTHING.errors._replace(readout_ms=0.0), readout_ms=0.0),
        "",
    ),
    "fit": (Plan(Errors(fix_m=((0.5, 0.5, 1.0),)), frames=12, landmarks=4, fix_hz=1.0), ""),
    "post": (Plan(Errors(bias_m=(0.1, 0.1, 0.1)), landmarks=5, frames=4, stands=True), ""),
    "labels": (
        Plan(Errors(fix_m=((0.02,) * 3,)), frames=6, landmarks=6, sigma_px=True),
        "labels of a frame",
    ),
    "landmark": (Plan(Errors(fix_m=((0.02,) * 3,)), frames=6, landmarks=6), "landmark"),
}
"""Flights with all errors, without a readout, of fixes at other times, from a post; mistakes."""


@cache
def drawn(name: str, folder: Path) -> Path:
    plan, blunder = PLANS[name]
    made = folder / name
    made.mkdir()
    write_flight(made, plan, np.random.default_rng(4), blunder, 6.0)
    if name == "everything":
        put(made, "cx_px = 959.5", "cx_px = 958.5")
        put(made, "0.02, 0.0, 0.0]", "0.02, 1e-05, -2e-05]")
        put(made, "[track]", "[vehicle]\nmount = { ypr_deg = [10.0, -20.0, 5.0] }\n[track]")
        put(made, "[track]", "[track]\nlever_arm_m = [0.5, 0.2, 0.1]")
    return made


def put(folder: Path, old: str, new: str) -> None:
    """Replace a text of the project, which is there once."""
    project = folder / "flight.toml"
    text = project.read_text(encoding="utf-8")
    assert text.count(old) == 1
    project.write_text(text.replace(old, new), encoding="utf-8")


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("drawn")


def change(file: Path, **columns: Callable[[float], float]) -> None:
    """Change the numbers of some columns of a file, where it is there and has them."""
    if not file.exists():
        return
    with file.open(encoding="utf-8") as text:
        rows = list(csv.DictReader(text))
    for row in rows:
        for name in {*row} & {*columns}:
            row[name] = repr(columns[name](float(row[name])))
    write(file, rows)


def write(file: Path, rows: list[dict[str, Any]]) -> None:
    with file.open("w", encoding="utf-8", newline="") as text:
        writer = csv.DictWriter(text, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


def of_project(folder: Path, **keys: Callable[[float], float]) -> None:
    """Change the number of some keys of the project."""
    project = folder / "flight.toml"
    text = project.read_text(encoding="utf-8")
    for key, new in keys.items():
        pattern = rf"(?m)^{key} = (-?[\d.]+)$"
        text = re.sub(pattern, lambda one, k=key, f=new: f"{k} = {f(float(one[1]))!r}", text)
    project.write_text(text, encoding="utf-8")


def mirrored(folder: Path) -> None:
    change(folder / "landmarks.csv", lon_deg=lambda x: -x)
    change(folder / "track.csv", lon_deg=lambda x: -x, ve_m_s=lambda x: -x)
    change(folder / "wind.csv", from_deg=lambda x: (360.0 - x) % 360.0)
    change(folder / "picks.csv", u_px=lambda u: SIZE[0] - 1.0 - u)
    of_project(folder, lon_deg=lambda x: -x, cx_px=lambda u: SIZE[0] - 1.0 - u)
    if folder.name == "everything":
        put(folder, "-2e-05]", "2e-05]")
        put(folder, "[10.0, -20.0, 5.0]", "[-10.0, -20.0, -5.0]")
        put(folder, "[0.5, 0.2, 0.1]", "[0.5, -0.2, 0.1]")


def turned(folder: Path) -> None:
    for name in ("landmarks.csv", "track.csv"):
        change(folder / name, lon_deg=lambda x: (x + 130.0) % 360.0 - 180.0)
    of_project(folder, lon_deg=lambda x: (x + 130.0) % 360.0 - 180.0)


def delayed(folder: Path) -> None:
    change(folder / "track.csv", t_s=lambda t: t + 1000.0)
    of_project(folder, first_frame_t_s=lambda t: t + 1000.0)


def larger(pixel: float) -> float:
    """Give the place of a pixel in a picture with twice as many."""
    return 2.0 * (pixel + 0.5) - 0.5


def enlarged(folder: Path) -> None:
    change(folder / "picks.csv", u_px=larger, v_px=larger)
    of_project(folder, cx_px=larger, cy_px=larger, fx_px=lambda f: 2.0 * f, fy_px=lambda f: 2.0 * f)
    of_project(folder, sigma_px=lambda s: 2.0 * s)
    put(folder, "[1920, 1080]", "[3840, 2160]")


def with_two_lenses(folder: Path) -> None:
    """Take every other frame by a camera whose pixels, and their errors, are half as large."""
    text = (folder / "flight.toml").read_text(encoding="utf-8")
    fx, cx, cy, k = (
        json.loads(text.partition(f"{key} = ")[2].splitlines()[0])
        for key in ("\nfx_px", "\ncx_px", "\ncy_px", "\nk")
    )
    for name, focal, at in (("a", fx, (cx, cy)), ("b", 2.0 * fx, (larger(cx), larger(cy)))):
        width, height = (side * (1 + (name == "b")) for side in SIZE)
        matrix = [[focal, 0.0, at[0]], [0.0, focal, at[1]], [0.0, 0.0, 1.0]]
        lens = {"image_width": width, "image_height": height, "camera_matrix": matrix}
        lens |= {"distortion_coefficients": k, "fisheye_model": 0}
        (folder / f"{name}.json").write_text(json.dumps(lens), encoding="utf-8")
    before, _, behind = text.partition("[camera.lens]\n")
    camera = before.replace('image_size_px = [1920, 1080]\npixel_grid = "centre"\n', "")
    camera += 'of_images = "lenses.csv"\n' + behind.partition("]\n")[2]
    (folder / "flight.toml").write_text(camera, encoding="utf-8")
    with (folder / "picks.csv").open(encoding="utf-8") as picks:
        rows = [row | {"sigma_px": 0.8} for row in csv.DictReader(picks)]
    frames = sorted({int(row["frame"]) for row in rows})
    write(folder / "lenses.csv", [{"frame": n, "lens": f"{'ab'[n % 2]}.json"} for n in frames])
    for row in rows:
        if int(row["frame"]) % 2:
            row |= {name: larger(float(row[name])) for name in ("u_px", "v_px")}
            row["sigma_px"] = 1.6
    write(folder / "picks.csv", rows)


def shuffled(folder: Path) -> None:
    rng = np.random.default_rng(1)
    for name in ("landmarks.csv", "picks.csv"):
        with (folder / name).open(encoding="utf-8") as text:
            rows = list(csv.DictReader(text))
        write(folder / name, [rows[k] for k in rng.permutation(len(rows))])


TURNS = re.compile(r"(camera|vehicle)_(yaw|pitch|roll)_deg|(latitude|longitude)_deg")
MIRRORED = re.compile(
    r"(camera|vehicle)_(yaw|roll)_deg|beta_deg|longitude_deg|vehicle_east_m|moved_east_m|"
    r"quaternion_[xz]|covariance_(common_)?(forward_right|right_down)_deg2"
)
SIGN_OF: Mapping[Callable[[Path], None], re.Pattern[str]] = {mirrored: MIRRORED}
TIMES: Mapping[Any, Mapping[str, Any]] = {
    enlarged: {"residual_rms_px": 2.0, "reading_sigma_px": 2.0},
    with_two_lenses: {"residual_rms_px": np.array([1.0, 2.0] * 3), "reading_sigma_px": 1.5},
}
"""By what columns in pixels are multiplied; one reading sigma is told, the mean of the picks'."""
SHIFTS = {turned: {"longitude_deg": 130.0 - 180.0}, delayed: {"time_s": 1000.0}}


def in_order(cell: str) -> str:
    """Put names that stand together, as m4+m0, in order."""
    return re.sub(r"\w+(\+\w+)+", lambda one: "+".join(sorted(one[0].split("+"))), cell)


def answer(folder: Path) -> tuple[dict[str, Any], list[str]]:
    result = vopd.solve_flight(folder / "flight.toml")
    said = [re.sub(r"-?\d[\d.e-]*", "#", one.message) for one in result.findings]
    return table([result.history()]), said


@cache
def first_answer(name: str, folder: Path) -> tuple[dict[str, Any], list[str]]:
    return answer(drawn(name, folder))


CASES = [(name, mirrored) for name in PLANS if name != "at once"]
CASES += [("everything", one) for one in (turned, delayed)] + [("at once", with_two_lenses)]
CASES += [("labels", one) for one in (enlarged, shuffled, with_two_lenses)]


@pytest.mark.parametrize(("name", "changed"), CASES)
def test_the_answer_is_the_same(
    name: str, changed: Callable[[Path], None], base: Path, tmp_path: Path
) -> None:
    one, said = first_answer(name, base)
    shutil.copytree(drawn(name, base), tmp_path / name)
    changed(tmp_path / name)
    other, again = answer(tmp_path / name)
    assert sorted(again) == sorted(said)
    assert [*one] == [*other]
    for column, values in one.items():
        found = other[column]
        if column in ("project", "last_correction_rad"):
            continue
        if values.dtype.kind != "f":
            both = [[in_order(str(cell)) for cell in cells.tolist()] for cells in (values, found)]
            assert both[0] == both[1], column
            continue
        sign = -1.0 if changed in SIGN_OF and SIGN_OF[changed].fullmatch(column) else 1.0
        times = TIMES.get(changed, {}).get(column, 1.0)
        expected = sign * times * values + SHIFTS.get(changed, {}).get(column, 0.0)
        away = found - expected
        if TURNS.fullmatch(column):
            away = (away + 180.0) % 360.0 - 180.0
        if column.startswith("quaternion"):
            away = np.minimum(np.abs(away), np.abs(found + expected))
        assert (np.isnan(found) == np.isnan(values)).all(), column
        size = np.maximum(np.abs(np.nan_to_num(values)), 1.0)
        assert np.abs(np.nan_to_num(away) / size).max() < within("symmetric flight"), column


def test_what_is_solved_for_is_mirrored(base: Path, tmp_path: Path) -> None:
    """The east of landmarks and p2 have the other sign, and so have their covariances."""
    shutil.copytree(drawn("everything", base), tmp_path / "everything")
    mirrored(tmp_path / "everything")
    free = ("focal", "aspect", "k1", "p1p2", "landmarks")
    one, other = (
        adjust(read_flight(str(folder / "flight.toml")), free)
        for folder in (drawn("everything", base), tmp_path / "everything")
    )
    names = [each.name for each in one.parameters]
    assert names == [each.name for each in other.parameters] and any(p.held for p in one.parameters)
    sign = np.array([-1.0 if name == "p2" or name.endswith(" east") else 1.0 for name in names])
    size = np.sqrt(np.diag(one.covariance))
    after = np.array([[each.after for each in both.parameters] for both in (one, other)])
    assert_close("part of a sigma", (after[1] - sign * after[0]) / size, 0.0)
    gap = other.covariance - one.covariance * sign * sign[:, None]
    assert_close("part of a sigma", gap / size / size[:, None], 0.0)
    assert [each.held for each in one.parameters] == [each.held for each in other.parameters]
