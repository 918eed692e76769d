"""What a project hands to its flight: landmarks, systems, datums, wind, doubts, and their order."""

from __future__ import annotations

import struct
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import vopd
from tests.approved.texts import assert_approved, refused
from tests.kit.flight_project import LENS, MARKS, TOML, marks_m, write_project
from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.flight.check import check_flight, messages_of_files
from vopd.flight.estimate import FlightEstimates
from vopd.flight.flight import CameraPath, Flight, FlightOptions, LandmarkSet, frame_label
from vopd.flight.formats.landmarks import LandmarkRows
from vopd.flight.formats.lens import LensRead
from vopd.flight.formats.picks import Names
from vopd.flight.formats.track import TrackRows
from vopd.flight.misfits.unsolved import picks_set_aside, require_two_landmarks
from vopd.flight.project import read as read_module
from vopd.flight.project.camera import CameraLens
from vopd.flight.project.inspect import NewProject, ask_height, look_at_track
from vopd.flight.project.keys import Project, Section
from vopd.flight.project.read import (
    add_wind,
    frames_uncovered,
    landmark_crs,
    mount_of,
    read_flight,
    refraction_of,
)
from vopd.flight.project.stated import Notes, flight_options
from vopd.flight.project.times import FrameTimes, number_frames
from vopd.flight.project.track import fixed_path, lever_arm, path_by_image
from vopd.flight.result import solve_flight_read
from vopd.flight.solve.rotations import SolvedFlight, no_attitudes, pick_distances_px, solve
from vopd.geometry.earth import earth_centred_m


def flight(folder: Path, toml: str = TOML) -> Flight:
    return read_flight(str(write_project(folder, toml)))


def refusal(folder: Path, toml: str) -> str:
    with pytest.raises(VopdError) as told:
        flight(folder, toml)
    return str(told.value).removeprefix(f"{folder / 'flight.toml'}: ")


def test_what_is_read_is_said_in_order(tmp_path: Path) -> None:
    (tmp_path / "wind.csv").write_text("h_m,from_deg,speed_m_s\n0,90,2\n900,90,2\n")
    keys = TOML.replace('sigma_m = "exact"\n[track]', "sigma_m = [1, 2, 3]\n[track]")
    found = flight(tmp_path, keys + '[wind]\nfile = "wind.csv"\n')
    assert_approved(found.about)
    assert (found.name, found.source) == ("F12", str(tmp_path / "flight.toml"))
    assert found.epoch == datetime(2026, 5, 1, 11, 58, 42, tzinfo=UTC)
    assert found.frame.tolist() == [0, 1, 2, 3, 4] and found.image_name == ()
    assert_close("time", found.time_s, [2.0, 2.1, 2.2, 2.3, 2.4])
    assert found.landmarks.name == MARKS and found.landmarks.used == (True,) * 6
    assert found.landmarks.sigma_m.tolist() == [[1.0, 2.0, 3.0]] * 6
    assert_close("flight position", found.landmarks.position_m, marks_m())
    assert found.lens.size_px == LENS.size_px and found.grid is None and found.findings == ()
    assert found.path.wind_m_s is not None
    assert_close("flight speed", found.path.wind_m_s, [[0.0, -2.0]] * 5)


def test_times_of_a_table_are_said_behind_the_picks(tmp_path: Path) -> None:
    """Frames are called by their numbers, or by the names of their images."""
    rate = "frame_rate_hz = 10.0\nfirst_frame_t_s = 2.0\n"
    toml = TOML.replace(rate, 'times = "times.csv"\n').replace('name = "F12"\n', "")
    path = write_project(tmp_path, toml)
    rows = (tmp_path / "picks.csv").read_text().splitlines()[1:]
    seconds = ("2", "2.1", "2.2", "2.3", "9")
    for kind, named in (("frame", "1{}"), ("image", "{}.jpg")):
        cells = [named.format(row[0]) + row[1:] for row in rows]
        (tmp_path / "picks.csv").write_text("\n".join([f"{kind},landmark,u_px,v_px", *cells]))
        times = [f"{named.format(k)},{second}" for k, second in enumerate(seconds)]
        (tmp_path / "times.csv").write_text("\n".join([f"{kind},t_s", *times]))
        found = read_flight(str(path))
        assert found.about[1:3] == (
            "picks.csv: CSV, 30 picks, centre grid, v down", "times.csv: times of 5 frames",
        )  # fmt: skip
        assert found.name == "" and found.source == str(path)
        lost = "frame 14" if kind == "frame" else "4.jpg"
        assert_approved(found.findings, parts=[lost])
        assert found.frame.tolist() == [10 * (kind == "frame") + k for k in range(5)]
        names = () if kind == "frame" else tuple(f"{k}.jpg" for k in range(5))
        assert found.image_name == names


def test_doubts_about_the_track_are_warnings_behind_those_about_picks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write_project(tmp_path)
    rows = (tmp_path / "picks.csv").read_text()
    (tmp_path / "picks.csv").write_text(rows + "0,steeple,1,2\n99,mast,1,2\n")
    read = read_module.read_path
    monkeypatch.setattr(
        read_module, "read_path", lambda *given: read(*given)._replace(doubts=["one", "two"])
    )
    found = read_flight(str(path)).findings
    assert_approved([one.message.partition(" (")[0] for one in found])
    assert {(one.severity, one.source) for one in found} == {("warning", str(path))}


def test_frames_without_a_time_are_told_apart_from_those_without_a_position(
    tmp_path: Path,
) -> None:
    text = TOML.replace("frame_rate_hz = 10.0\nfirst_frame_t_s = 2.0\n", 'times = "t.csv"\n')
    assert text != TOML
    path = write_project(tmp_path, text)
    (tmp_path / "t.csv").write_text("frame,t_s\n0,2\n2,2.2\n4,99\n", encoding="utf-8")
    assert_approved([one.message for one in read_flight(str(path)).findings])


@pytest.mark.parametrize("apart", [0.0, 0.001])
def test_copies_of_picks_are_told(apart: float, tmp_path: Path) -> None:
    path = write_project(tmp_path)
    file = tmp_path / "picks.csv"
    first = file.read_text(encoding="utf-8").splitlines()[1].split(",")
    first[-1] = str(float(first[-1]) + apart)
    with file.open("a", encoding="utf-8") as more:
        more.write(",".join(first) + "\n")
    assert_approved([one.message for one in read_flight(str(path)).findings])


def test_every_section_reaches_the_flight(tmp_path: Path) -> None:
    usual = flight(tmp_path)
    assert (usual.refraction.k, usual.refraction.decays) == (0.13, True)
    assert (usual.options.loss, usual.options.drop_blunders) == ("least-squares", False)
    given = flight(
        tmp_path,
        TOML.replace('sigma_m = "exact"\nsigma_t_s', "sigma_m = [1, 2, 3]\nsigma_t_s")
        + "lever_arm_m = [4, 5, 6]\n"
        + '[vehicle]\nmount = "down"\n[atmosphere]\nrefraction = { k = 0.25 }\n'
        '[solve]\nloss = "huber"\nblunders = "drop"\n'
        "[uncertainty]\nfocal_rel = 0.01\nprincipal_px = [1, 2]\n",
    )
    assert (given.refraction.k, given.refraction.decays) == (0.25, False)
    options = given.options
    assert (options.loss, options.drop_blunders) == ("huber", True)
    assert options.parameter_sigma == {
        "focal": 0.01 * 1495.0, "centre_u": 1.0, "centre_v": 2.0, "refraction": 0.125, "clock": 0.0,
    }  # fmt: skip
    assert given.mount.tolist() == [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    assert usual.mount.tolist() == [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    fixes = given.path.fixes
    assert fixes is not None and fixes.sigma_m.tolist() == [[1.0, 2.0, 3.0]] * 4
    assert given.path.lever_arm_m is not None and given.path.lever_arm_m.tolist() == [4, 5, 6]
    rows = (tmp_path / "landmarks.csv").read_text()
    assert rows.startswith("landmark,lat_deg")
    plane = TOML.replace('"landmarks.csv"', '"landmarks.csv"\ncrs = "EPSG:4258"')
    assert_approved(flight(tmp_path, plane).about[2])


def test_a_drop_of_interpolated_picks_leaves_some(tmp_path: Path) -> None:
    """Where none was clicked it ended in Python's own error."""
    points = "<points frame='0' keyframe='0' points='1,2'/><points frame='1' points='1,2'/>"
    (tmp_path / "p.xml").write_text(f"<annotations><track label='m'>{points}</track></annotations>")
    keys = 'file = "p.xml"\ninterpolated = "drop"'
    toml = TOML.replace('file = "picks.csv"\npixel_grid = "centre"', keys)
    assert len(read_flight(str(write_project(tmp_path, toml))).frame) == 1
    (tmp_path / "p.xml").write_text(
        (tmp_path / "p.xml").read_text().replace("frame='1'", "frame='1' keyframe='0'")
    )
    with refused(VopdError):
        read_flight(str(tmp_path / "flight.toml"))


def test_v_is_counted_from_the_last_row_of_the_lens_s_images(tmp_path: Path) -> None:
    """The last of 1080 rows is 1079."""
    down = flight(tmp_path).picks.pixel
    up = flight(tmp_path, TOML.replace('"picks.csv"', '"picks.csv"\nv = "up"')).picks.pixel
    assert_close("flight pixel", up, [0.0, 1079.0] + [1.0, -1.0] * down)


FIXED = TOML.partition("[track]")[0] + (
    '[position]\nlat_deg = 47.6435\nlon_deg = 16.4759\nh_m = 540\nheight = "ellipsoid"\n'
    'sigma_m = "exact"\n'
)


def test_frames_of_a_fixed_camera_are_each_or_one(tmp_path: Path) -> None:
    each = flight(tmp_path, FIXED)
    assert each.frame.tolist() == [0, 1, 2, 3, 4] and len(each.picks.frame) == 30
    head, *rows = (tmp_path / "picks.csv").read_text().splitlines()
    again = [row.replace("0,", "1,", 1) for row in rows[:6]]
    (tmp_path / "picks.csv").write_text("\n".join([head, *rows[:6], *again]))
    (tmp_path / "flight.toml").write_text(FIXED + '[solve]\nframes = "one"\n')
    one = read_flight(str(tmp_path / "flight.toml"))
    assert one.frame.tolist() == [0] and one.time_s.tolist() == [2.0]
    assert one.picks.frame.tolist() == [0] * 6 and one.path.position_m.shape == (1, 3)
    named = [f"b{k % 2}.jpg{row[1:]}" for k, row in enumerate(rows[:6])]
    (tmp_path / "picks.csv").write_text("\n".join([head.replace("frame", "image"), *named]))
    one = read_flight(str(tmp_path / "flight.toml"))
    assert (one.image_name, one.frame.tolist()) == (("b0.jpg",), [0])
    said = refusal(tmp_path, TOML + '[solve]\nframes = "one"\n')
    assert_approved(said)
    assert_approved(refusal(tmp_path, TOML + '[solve]\nframes = "all"\n'))


@pytest.mark.parametrize(
    ("marks", "camera", "where", "message"),
    [
        ("same", "same", "track", ""), ("ellipsoid", "ellipsoid", "track", ""),
        ("same", "ellipsoid", "track", "landmarks"), ("ellipsoid", "same", "track", "track"),
        ("same", "same", "position", ""), ("same", "ellipsoid", "position", "landmarks"),
        ("ellipsoid", "same", "position", "position"),
    ],
)  # fmt: skip
def test_one_unknown_level_is_that_of_both(
    marks: str, camera: str, where: str, message: str, tmp_path: Path
) -> None:
    head, _, rest = (TOML if where == "track" else FIXED).partition(f"[{where}]")
    toml = head.replace('"ellipsoid"', f'"{marks}"') + f"[{where}]"
    toml += rest.replace('"ellipsoid"', f'"{camera}"')
    if message:
        assert_approved(refusal(tmp_path, toml), parts=[message, where])
    else:
        assert_approved(flight(tmp_path, toml).about[2])


def test_landmarks_that_are_refused(tmp_path: Path) -> None:
    solve = TOML + '[solve]\ncheck_landmarks = ["mast", "NAME"]\n'
    assert_approved(refusal(tmp_path, solve.replace("NAME", "chruch")))
    found = flight(tmp_path, solve.replace("NAME", "well"))
    assert found.landmarks.used == (True, False, True, True, True, False)
    rows = (tmp_path / "landmarks.csv").read_text()
    for twice in ("mast", "church"):
        rows += next(row for row in rows.splitlines() if row.startswith(twice)) + "\n"
        (tmp_path / "landmarks.csv").write_text(rows)
        with pytest.raises(VopdError) as told:
            read_flight(str(tmp_path / "flight.toml"))
        first = min(twice, "mast")
        assert_approved(str(told.value), parts=[first])
    (tmp_path / "landmarks.csv").write_text("landmark,lat_deg,lon_deg,h_m\nmast,47,16,5\n")
    toml = TOML.replace('file = "landmarks.csv"', 'file = "landmarks.csv"\ncrs = "EPSG:32633"')
    (tmp_path / "flight.toml").write_text(toml)
    with refused(VopdError):
        read_flight(str(tmp_path / "flight.toml"))


@pytest.mark.parametrize(
    ("own", "given", "geodetic", "found"),
    [
        (None, None, True, None), (None, "EPSG:4258", True, "EPSG:4258"),
        (None, "EPSG:32633", False, "EPSG:32633"), (None, None, False, "crs: is needed"),
        ("EPSG:32633", None, False, "EPSG:32633"),
        ("EPSG:32633", "WGS84 UTM 33N", False, "EPSG:32633"),
        ("EPSG:4326", "EPSG:32633", True, "crs: the file says EPSG:4326: leave the key out"),
        ("EPSG:4326", None, True, "EPSG:4326"),
    ],
)  # fmt: skip
def test_the_system_of_landmarks(
    own: str | None, given: str | None, geodetic: bool, found: str | None
) -> None:
    rows = LandmarkRows(["a"], np.zeros((1, 3)), geodetic, own, None, [1], "")
    section = Section("p.toml", "landmarks", {} if given is None else {"crs": given})
    if found is not None and found.startswith("crs: "):
        with refused(VopdError):
            landmark_crs(section, rows)
    else:
        assert landmark_crs(section, rows) == found


@pytest.mark.parametrize(
    ("section", "key", "value"),
    [
        ("solve", "loss", "hubr"),
        ("solve", "blunders", "keep"),
        ("uncertainty", "focal_rel", -0.5),
        ("uncertainty", "principal_px", [1, 2, 3]),
    ],
)
def test_options_that_are_refused(section: str, key: str, value: Any) -> None:
    given = {section: Section("p.toml", section, {key: value})}
    with refused(VopdError, parts=[section, key]):
        options_of(given)


@pytest.mark.parametrize(
    "value",
    [
        "xyz",
        5,
        {"k": 0.1, "decays": True},
        {},
        {"k": "x"},
    ],
)  # fmt: skip
def test_refractions_that_are_refused(value: Any) -> None:
    with refused(VopdError):
        refraction_of(Section("p.toml", "atmosphere", {"refraction": value}))


@pytest.mark.parametrize(
    "value",
    [
        "up",
        ["forward"],
        [],
        5,
        {"matrix": [1], "roll": 2},
        {},
        {"ypr_deg": [0, 90, 0], "matrix": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]},
        {"ypr_deg": [0, 0, 361]},
    ],
)
def test_mounts_that_are_refused(value: Any) -> None:
    with refused(VopdError):
        mount_of(Section("p.toml", "vehicle", {"mount": value}))


# Values of a project from both sides of their limits, what is warned of, and in which words


def section(name: str, **values: Any) -> Section:
    return Section("p.toml", name, values)


def options_of(sections: dict[str, Section]) -> FlightOptions:
    """The options of a flight with the lens of the kit and nothing that is uncertain by row."""
    project = Project("p.toml", Path(), sections)
    refraction = refraction_of(project.section("atmosphere"))
    marks = LandmarkSet((), np.zeros((0, 3)), np.zeros((0, 3)))
    path = CameraPath(np.zeros((1, 3)))
    return flight_options(project, CameraLens(LensRead(LENS, "")), refraction, path, marks)


def raises(message: str) -> Any:
    return pytest.raises(VopdError, match=message)


def test_a_lever_arm_is_read_or_none() -> None:
    arm = lever_arm(section("track", lever_arm_m=[1, 2, 3]))
    assert arm is not None and arm.tolist() == [1.0, 2.0, 3.0]
    assert lever_arm(section("track")) is None


TURN = Rotation.from_euler("ZYX", [30.0, -20.0, 10.0], degrees=True).as_matrix()


@pytest.mark.parametrize(
    ("matrix", "good"),
    [
        (TURN, True), (TURN + 1e-7, True), (TURN + 1e-5, False), (-TURN, False),
        (TURN * [1, 1, -1], False), (2.0 * TURN, False), (TURN[:2], False), ("x", False),
        ([[1, 0, 0], [0, "a", 0], [0, 0, 1]], False), (None, False),
        ([[1, 0, 0], [0, "1", 0], [0, 0, 1]], False), ([[1, 0, 0], [0, True, 0], [0, 0, 1]], False),
    ],
)  # fmt: skip
def test_a_mount_is_a_right_handed_rotation(matrix: Any, good: bool) -> None:
    given = matrix.tolist() if isinstance(matrix, np.ndarray) else matrix
    one = section("vehicle", mount={"matrix": given})
    if good:
        found = mount_of(one)
        assert_close("mount of rounded elements", found, TURN)
        assert_close("unit rotation", found @ found.T, np.eye(3))
    else:
        with raises(r"\[vehicle\.mount\] matrix: is not a rotation: three rows of three, right-"):
            mount_of(one)


def test_mounts_by_name_and_angles() -> None:
    """Rows are forward, right, down of the body in the camera's right, down, forward."""
    assert mount_of(section("vehicle")).tolist() == [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    assert mount_of(section("vehicle", mount="down")).tolist() == [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    angles = mount_of(section("vehicle", mount={"ypr_deg": [30, -20, 10]}))
    assert_close("unit rotation", angles, TURN @ [[0, 0, 1], [1, 0, 0], [0, 1, 0]])
    with refused(VopdError):
        mount_of(section("vehicle", mount="dwon"))
    with refused(VopdError):
        mount_of(section("vehicle", mount={"ypr": [1, 2, 3]}))


def test_refraction_of_a_project() -> None:
    found = [
        refraction_of(section("atmosphere", **given))
        for given in ({}, {"refraction": "standard"}, {"refraction": "off"},
                      {"refraction": {"k": 0.25}})
    ]  # fmt: skip
    assert [(one.k, one.decays) for one in found] == [
        (0.13, True), (0.13, True), (0.0, False), (0.25, False),
    ]  # fmt: skip


def test_options_of_a_project() -> None:
    def options(solve: dict[str, Any], doubt: dict[str, Any]) -> Any:
        sections = {"solve": section("solve", **solve)}
        sections["uncertainty"] = section("uncertainty", **doubt)
        return options_of(sections)

    usual = options({}, {})
    assert (usual.loss, usual.drop_blunders) == ("least-squares", False)
    assert usual.solve_position and usual.parameter_sigma == {"refraction": 0.065}
    assert not options({"position": "fixed"}, {}).solve_position
    for loss in ("least-squares", "huber", "cauchy"):
        assert options({"loss": loss}, {}).loss == loss
    assert options({"blunders": "drop"}, {}).drop_blunders
    assert not options({"blunders": "name"}, {}).drop_blunders
    found = options({}, {"focal_rel": 0.001, "principal_px": [1.5, 2.5]})
    refraction = {"refraction": 0.065}
    assert found.parameter_sigma == {"focal": 1.495, "centre_u": 1.5, "centre_v": 2.5} | refraction
    found = options({}, {"principal_px": 2})
    assert found.parameter_sigma == {"centre_u": 2.0, "centre_v": 2.0} | refraction


@pytest.mark.parametrize(
    ("lost", "named"),
    [
        ([1], "frame 11"),
        ([0, 1, 2], "frame 10, frame 11, frame 12"),
        ([0, 1, 2, 4], "frame 10, frame 11, frame 12 and 1 more"),
    ],
)
def test_frames_outside_the_track_are_a_warning(lost: list[int], named: str) -> None:
    position = np.where(np.isin(np.arange(5), lost)[:, None], np.nan, np.ones((5, 3)))
    path = CameraPath(position)
    project, times = Project("p.toml", Path(), {}), FrameTimes(np.arange(5.0), (), None)
    found = frames_uncovered(project, path, times, lambda k: f"frame {k + 10}")
    assert_approved(found, parts=[named])
    assert frames_uncovered(project, CameraPath(np.ones((5, 3))), times, str) == []


def picked(folder: Path, keep: dict[str, int], last: str = "") -> vopd.FlightResult:
    """The project with so many picks of some frames."""
    path = write_project(folder)
    head, *rows = (folder / "picks.csv").read_text().splitlines()
    rows = [row for k, row in enumerate(rows) if k % 6 < keep.get(row[0], 6)]
    (folder / "picks.csv").write_text("\n".join([head, *rows, last]))
    return vopd.solve_flight(path)


def test_frames_without_an_attitude_are_warned_of_by_reason(tmp_path: Path) -> None:
    """One landmark is too few; two on one line of sight, the second behind the first, too."""
    result = picked(tmp_path, {"1": 1, "3": 1})
    assert_approved(result.findings)
    picks = result.flight.picks
    both = picks.frame == 0
    marks = result.flight.landmarks.position_m.copy()
    camera = result.flight.path.position_m[0]
    keep = ~both | (picks.landmark < 2)
    marks[1] = camera + 2.0 * (marks[0] - camera)
    pixel = picks.pixel.copy()
    pixel[both & (picks.landmark == 1)] = pixel[both & (picks.landmark == 0)]
    few = replace(
        picks, frame=picks.frame[keep], landmark=picks.landmark[keep], pixel=pixel[keep],
        sigma_px=picks.sigma_px[keep],
    )  # fmt: skip
    landmarks = replace(result.flight.landmarks, position_m=marks)
    found = solve_flight_read(replace(result.flight, picks=few, landmarks=landmarks)).findings
    of_frame_0 = [one.message for one in found if "frame 0" in one.message]
    assert_approved(of_frame_0)
    assert {one.severity for one in found} == {"warning"}


@pytest.mark.parametrize(
    ("count", "named"),
    [(5, ""), (6, " and 1 more")],
)
def test_five_frames_of_a_reason_are_named(count: int, named: str, tmp_path: Path) -> None:
    path = write_project(tmp_path)
    rows = (tmp_path / "picks.csv").read_text().splitlines()
    rows += [f"{10 + k},mast,5,5" for k in range(count)]
    (tmp_path / "picks.csv").write_text("\n".join(rows))
    (found,) = vopd.solve_flight(path).findings
    labels = ", ".join(f"frame {10 + k}" for k in range(5))
    assert found.message.startswith(f"{labels}{named}: fewer than two landmarks")
    flight = read_flight(str(path))
    assert [frame_label(flight, k) for k in (0, 4, 5)] == ["frame 0", "frame 4", "frame 10"]


@pytest.mark.parametrize(
    ("u", "v", "outside"),
    [
        (-0.49, 5.0, False), (-0.51, 5.0, True), (1919.49, 5.0, False), (1919.51, 5.0, True),
        (5.0, -0.49, False), (5.0, -0.51, True), (5.0, 1079.49, False), (5.0, 1079.51, True),
    ],
)  # fmt: skip
def test_an_image_ends_half_a_pixel_beyond_its_last(
    u: float, v: float, outside: bool, tmp_path: Path
) -> None:
    flight = read_flight(str(write_project(tmp_path)))
    pixel = flight.picks.pixel.copy()
    pixel[7] = u, v
    found = [*messages_of_files(replace(flight, picks=replace(flight.picks, pixel=pixel)))]
    assert bool(found) == bool(outside)
    assert_approved(found, parts=[f"{u:g}", f"{v:g}"] if outside else [])


def test_picks_above_the_image_may_have_v_upward(tmp_path: Path) -> None:
    flight = read_flight(str(write_project(tmp_path)))
    for above in (15, 16):
        pixel = flight.picks.pixel.copy()
        pixel[:above, 1] = -100.0
        (found,) = messages_of_files(replace(flight, picks=replace(flight.picks, pixel=pixel)))
        assert found.startswith(f"{above} picks outside the image")
        assert_approved(found)
        assert ("up?" in found) == (above == 16)


def test_angles_of_camera_vehicle_and_attack_by_name(tmp_path: Path) -> None:
    """A camera that looks down has other angles than its vehicle."""
    path = write_project(tmp_path, TOML + '[vehicle]\nmount = "down"\n')
    flight = vopd.solve_flight(path)
    e = flight.estimate
    assert np.array_equal(flight.camera_deg, e.camera_deg)
    assert np.array_equal(flight.vehicle_deg, e.vehicle_deg)
    assert np.array_equal(flight.attack_deg, e.attack_deg)
    assert np.array_equal(flight.time_s, e.time_s) and np.array_equal(flight.frame, e.frame)
    assert np.abs(flight.camera_deg - flight.vehicle_deg).max() > 10.0
    assert np.abs(flight.attack_deg - flight.vehicle_deg).max() > 10.0


@pytest.mark.parametrize("latitude", [47.6, -47.6])
def test_the_lean_of_the_vertical_is_the_same_in_the_south(latitude: float, tmp_path: Path) -> None:
    """.5 f sin 2 phi (1 + ...) is .19205 degree at 47.6 degrees, 540 m up."""
    flight = read_flight(str(write_project(tmp_path)))
    camera = np.tile(earth_centred_m(latitude, 16.0, 540.0), (5, 1))
    camera[3] = np.nan
    camera[4] = earth_centred_m(latitude / 2.0, 16.0, 540.0)
    used = np.ones(len(flight.picks.frame), bool)
    solved = SolvedFlight(flight, camera, no_attitudes(5, len(used)), used, np.nan)
    sine, cosine, e2 = np.sin(np.radians(47.6)), np.cos(np.radians(47.6)), 0.0066943799901413165
    normal = 6378137.0 / np.sqrt(1.0 - e2 * sine**2)
    above = ((normal * (1.0 - e2) + 540.0) * sine, (normal + 540.0) * cosine)
    expected = 47.6 - np.degrees(np.arctan2(*above))
    assert_close("ratio", FlightEstimates(solved).largest_lean_deg, expected)


def test_a_new_project_asks_for_heights_unless_a_file_says_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where the coordinate system cannot be looked up."""

    def asks(crs: str | None) -> bool:
        new = NewProject()
        ask_height(new, "track", crs)
        return new.needed == {("track", "height"): "no file says what its heights are counted from"}

    assert asks(None) and asks("EPSG:4326") and asks("EPSG:32633") and not asks("EPSG:4979")
    assert asks("EPSG:nonsense")
    (tmp_path / "t.mrk").write_text(
        "1\t1.5\t[2300]\t0,N\t0,E\t0,V\t47.6,Lat\t16.4,Lon\t540,Ellh\t1.0, 2.0, 3.0\t50,Q\n"
    )
    (tmp_path / "t.csv").write_text("t_utc,lat_deg,lon_deg,h_m\n2026-05-01T00:00:00Z,1,2,3\n")
    for name, needed in (("t.mrk", set()), ("t.csv", {"height", "clock", "sigma_m"})):
        new = NewProject()
        look_at_track(new, {}, tmp_path, str(tmp_path / name))
        assert {key for _, key in new.needed} == needed


# Wind, fixed positions, speeds of images, other clocks, check landmarks: what a flight takes


WITHOUT_TRACK = TOML.partition("[track]")[0]


# Wind


def with_wind(
    folder: Path,
    velocity: Any,
    levels: str = "500,180,10\n600,180,30\n",
    crs: str | None = None,
    **height: object,
) -> tuple[CameraPath, list[str], list[str]]:
    """A path at heights of 0, 550 and 9000 m, its wind, and what is doubtful of it."""
    (folder / "wind.csv").write_text(f"h_m,from_deg,speed_m_s\n{levels}")
    sections = {"wind": Section("p.toml", "wind", {"file": "wind.csv"})}
    sections |= {name: Section("p.toml", name, {"height": one}) for name, one in height.items()}
    project = Project("p.toml", folder, sections)
    position = earth_centred_m(47.0, 16.0, np.array([0.0, 550.0, 9000.0]))
    return add_wind(project, CameraPath(position, velocity_m_s=velocity), crs)


def test_wind_is_linear_in_height_and_held_beyond_the_ends(tmp_path: Path) -> None:
    """From the south is toward the north: 10 m/s at 500 m and below, 30 at 600 and above."""
    path, (said,), (far,) = with_wind(tmp_path, np.zeros((3, 3)))
    assert path.wind_m_s is not None
    assert_close("flight speed", path.wind_m_s[:, 0], [10.0, 20.0, 30.0])
    assert_close("flight speed", path.wind_m_s[:, 1:], np.zeros((3, 1)))
    assert_approved([said, far])


def test_levels_of_the_wind_count_from_the_sea(tmp_path: Path) -> None:
    """The sea is 25 m above the ellipsoid: the camera is at -25, 525 and 8975 m above it."""
    geoid: dict[str, object] = {"undulation_m": 25.0}
    still = np.zeros((3, 3))
    for height in (
        {"track": geoid},
        {"position": geoid},
        {"track": "ellipsoid", "landmarks": geoid},
        {"track": {"ground_m": 300.0}, "landmarks": geoid},
    ):
        path, (said,), _ = with_wind(tmp_path, still, **height)
        assert path.wind_m_s is not None
        assert_close("flight speed", path.wind_m_s[:, 0], [10.0, 15.0, 30.0])
        assert_approved([said])
    for name in ("same", "ellipsoid"):
        path, (said,), _ = with_wind(tmp_path, still, track=name, landmarks=name)
        assert path.wind_m_s is not None
        assert_close("flight speed", path.wind_m_s[:, 0], [10.0, 20.0, 30.0])
        assert_approved([said])


def test_levels_of_the_wind_count_from_the_geoid_of_a_crs(tmp_path: Path) -> None:
    """A grid of a geoid that is 25 m above the ellipsoid; of +vunits alone heights are above that.

    The format is NOAA's: latitude and longitude of a corner, steps, rows, columns, and heights.
    """
    grid = tmp_path / "geoid.gtx"
    grid.write_bytes(struct.pack(">4d2i4f", 40.0, 10.0, 10.0, 10.0, 2, 2, *[25.0] * 4))
    of_geoid = f"+proj=longlat +datum=WGS84 +geoidgrids={grid.as_posix()} +vunits=us-ft"
    for crs, expected in (
        (of_geoid, [10.0, 15.0, 30.0]),
        ("+proj=longlat +datum=WGS84 +vunits=us-ft", [10.0, 20.0, 30.0]),
        ("EPSG:4978", [10.0, 20.0, 30.0]),
    ):
        path, (said,), _ = with_wind(tmp_path, np.zeros((3, 3)), crs=crs)
        assert path.wind_m_s is not None
        assert_close("flight speed", path.wind_m_s[:, 0], expected)
        assert ("25 m above the ellipsoid" in said) == (crs == of_geoid)


def test_levels_half_a_kilometre_away_are_near_and_faster_than_any_wind_is_told(
    tmp_path: Path,
) -> None:
    assert not with_wind(tmp_path, np.zeros((3, 3)), "499,180,150\n8501,180,0\n")[2]
    assert_approved(with_wind(tmp_path, np.zeros((3, 3)), "499,180,151\n8501,180,0\n")[2])


def test_wind_without_a_velocity_is_refused(tmp_path: Path) -> None:
    with refused(VopdError):
        with_wind(tmp_path, None)
    path = CameraPath(np.zeros((1, 3)))
    assert add_wind(Project("p.toml", tmp_path, {}), path, None) == (path, [], [])


# Positions and speeds


def test_a_fixed_position_has_every_key_of_its_section() -> None:
    keys = {"lat_deg": 47.5, "lon_deg": 16.25, "h_m": 540.0, "height": "ellipsoid"}
    more = {"sigma_m": [1, 2, 3], "lever_arm_m": [4, 5, 6]}
    times = FrameTimes(np.array([7.0, 8.0]), (), None)
    read = fixed_path(Section("p.toml", "position", keys | more), times)
    here = earth_centred_m(47.5, 16.25, 540.0)
    assert_close("ratio", read.path.position_m / here, np.ones((2, 3)))
    assert read.path.bias_sigma_m.tolist() == [1.0, 2.0, 3.0] and read.missing == {}
    assert read.path.lever_arm_m is not None and read.path.lever_arm_m.tolist() == [4.0, 5.0, 6.0]
    assert (read.path.velocity_m_s, read.times) == (None, times)
    plain = fixed_path(Section("p.toml", "position", dict(keys)), times)
    assert plain.path.lever_arm_m is None
    assert [*plain.missing] == [("position", "sigma_m")]


def test_a_fixed_position_is_not_in_feet() -> None:
    grid = {"x_m": 6.48e6, "y_m": 1.84e6, "z_m": 3.0, "crs": "EPSG:2229", "height": "ellipsoid"}
    degrees = {"lat_deg": 34.0, "lon_deg": -118.0, "h_m": 3.0, "crs": "EPSG:4269+6360"}
    for wrong in (grid, degrees):
        with refused(VopdError):
            fixed_path(Section("p.toml", "position", wrong), FrameTimes(np.zeros(1), (), None))


@pytest.mark.parametrize("key", ["lat_deg", "lon_deg", "h_m", "x_m", "y_m", "z_m", "crs"])
def test_a_fixed_position_needs_its_coordinates(key: str) -> None:
    geodetic = {"lat_deg": 47.5, "lon_deg": 16.25, "h_m": 540.0, "height": "ellipsoid"}
    grid = {"x_m": 1.0, "y_m": 2.0, "z_m": 3.0, "crs": "EPSG:32633", "height": "ellipsoid"}
    given: dict[str, Any] = dict(geodetic if key in geodetic else grid)
    del given[key]
    with refused(VopdError):
        fixed_path(Section("p.toml", "position", given), FrameTimes(np.zeros(1), (), None))


@pytest.mark.parametrize(
    ("time_s", "whole", "known"),
    [
        ([3.0, 0.0, 1.0], False, True), ([3.0, 0.0, 1.0], True, False),
        ([1.0, 0.0, 1.0], False, False), ([3.0, 0.0, np.nan], False, True),
        ([3.0, 0.0, 1e-9], False, True), ([5.0], False, False),
    ],
)  # fmt: skip
def test_speed_by_the_positions_of_images(time_s: list[float], whole: bool, known: bool) -> None:
    """Of a path of 2 m/s east: the same at all that have a time, in whatever order they stand."""
    time, names = np.array(time_s), [f"{k}.jpg" for k in range(len(time_s))]
    position = earth_centred_m(0.0, 0.0, 0.0) + np.outer(time, [0.0, 2.0, 0.0])
    rows = TrackRows(position, False, None, None, time, "", names, whole_seconds=whole)
    said: list[str] = []
    section, times = (
        Section("p.toml", "track", {"sigma_m": 0.0}),
        FrameTimes(time, tuple(names), None),
    )
    path = path_by_image(section, rows, position, times, time, Notes(said, {}))
    if known:
        assert path.velocity_m_s is not None
        assert_approved(said)
        timed = np.isfinite(time)
        assert np.array_equal(np.isfinite(path.velocity_m_s).all(axis=1), timed)
        assert_close("flight speed", path.velocity_m_s[timed], [[0.0, 2.0, 0.0]] * timed.sum())
    else:
        assert path.velocity_m_s is None
        assert_approved(said)


# Keys changed in a copy


def test_a_key_of_a_project_is_changed_or_added_in_a_copy(tmp_path: Path) -> None:
    project = Project("p.toml", tmp_path, {
        name: Section("p.toml", name, {"file": name, "offset_s": 1.0}) for name in ("track", "wind")
    })  # fmt: skip
    changed = project.changed("track", "offset_s", 2.5).changed("track", "clock", "gps")
    assert changed.section("track").values == {"file": "track", "offset_s": 2.5, "clock": "gps"}
    for one in (project.section("track"), project.section("wind"), changed.section("wind")):
        assert one.values == {"file": one.name, "offset_s": 1.0}


# Picks


@pytest.mark.parametrize(
    ("checked", "enough"),
    [((), True), (("church", "mast", "bridge", "corner"), True),
     (("church", "mast", "bridge", "corner", "tower"), False)],
)  # fmt: skip
def test_check_landmarks_are_not_among_the_two_of_a_frame(
    checked: tuple[str, ...], enough: bool, tmp_path: Path
) -> None:
    """All six are picked in each of the five frames."""
    names = ", ".join(f'"{name}"' for name in checked)
    path = write_project(
        tmp_path, f"{TOML}[solve]\ncheck_landmarks = [{names}]\n" if names else TOML
    )
    flight = read_flight(str(path))
    if enough:
        require_two_landmarks(flight)
    else:
        with refused(VopdError):
            require_two_landmarks(flight)


def test_warnings_stay_where_the_solve_is_refused(tmp_path: Path) -> None:
    path = write_project(tmp_path)
    head, *rows = (tmp_path / "picks.csv").read_text().splitlines()
    (tmp_path / "picks.csv").write_text("\n".join([head, *rows[::6], "0,steeple,5,5"]))
    found = check_flight(str(path))
    assert_approved([(one.severity, one.message.partition(" (")[0]) for one in found])
    assert {one.source for one in found} == {str(path)}


def test_how_far_a_pick_is_off_is_its_distance(tmp_path: Path) -> None:
    """3 px to the right and 4 down are 5; every other pick is where its landmark is."""
    flight = read_flight(str(write_project(tmp_path)))
    solved = solve(flight)
    pixel = flight.picks.pixel.copy()
    pixel[7] += [3.0, 4.0]
    pixel[11] += [-5.0, 12.0]
    moved = replace(flight, picks=replace(flight.picks, pixel=pixel))
    expected = np.zeros(30)
    expected[[7, 11]] = 5.0, 13.0
    assert_close("trial without noise", pick_distances_px(replace(solved, flight=moved)), expected)


def test_frames_by_name_and_by_number_are_in_order() -> None:
    number, image, index = number_frames(Names(["b.jpg", "a.jpg", "b.jpg", "c.jpg"]))
    assert (number.tolist(), image, index.tolist()) == ([0, 1, 2], ("a.jpg", "b.jpg", "c.jpg"),
                                                        [1, 0, 1, 2])  # fmt: skip
    number, image, index = number_frames(np.array([7, 3, 7, 5]))
    assert (number.tolist(), image, index.tolist()) == ([3, 5, 7], (), [2, 0, 2, 1])


@pytest.mark.parametrize("names", [(), tuple(f"{k}.jpg" for k in range(5))])
def test_every_pick_that_is_set_aside_is_a_warning(names: tuple[str, ...], tmp_path: Path) -> None:
    """The third landmark of frames 1 and 2 and the last of frame 4, each with its reason."""
    flight = replace(read_flight(str(write_project(tmp_path))), image_name=names)
    aside = np.zeros(30, np.int64)
    aside[[8, 14, 29]] = 1, 3, 2
    solved: Any = SimpleNamespace(attitudes=SimpleNamespace(set_aside=aside))
    assert_approved(picks_set_aside(flight, solved))
