"""Values of a project from both sides of their limits, what is warned of, and in which words."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import vopd
from tests.kit.flight_project import TOML, write_project
from tests.tolerances import assert_close
from vopd.findings import Finding, VopdError
from vopd.flight.check_flight import _file_messages
from vopd.flight.estimate import whole_flight
from vopd.flight.flight import CameraPath
from vopd.flight.formats.landmarks import LandmarkRows
from vopd.flight.formats.track import TrackRows
from vopd.flight.new import NewProject, _height, look_at_track
from vopd.flight.project import Project, Section
from vopd.flight.read import _mount, _options, _refraction, _sigma, _uncovered, read_flight
from vopd.flight.result import frame_label, solve_flight_read
from vopd.flight.solve import SolvedFlight, no_attitudes
from vopd.flight.track import lever_arm, path_sigma
from vopd.geometry.earth import earth_centred_m


def section(name: str, **values: Any) -> Section:
    return Section("p.toml", name, values)


def refused(message: str) -> Any:
    return pytest.raises(VopdError, match=message)


def test_sigmas_of_landmarks_are_the_file_s_and_then_the_project_s() -> None:
    own = np.array([0.1, np.nan, 0.3])
    rows = LandmarkRows(["a", "b", "c"], np.zeros((3, 3)), True, None, own, [2, 3, 4], "CSV")
    stated = _sigma(section("landmarks", sigma_m=[1, 2, 3]), rows)
    assert stated.tolist() == [[0.1] * 3, [1.0, 2.0, 3.0], [0.3] * 3]
    none = _sigma(section("landmarks"), rows)
    assert none[[0, 2]].tolist() == [[0.1] * 3, [0.3] * 3] and np.isnan(none[1]).all()


def test_sigmas_of_a_track_are_the_project_s_and_then_the_file_s() -> None:
    """Of the file their root mean square: of 3 and 4, and of 5 alone, 3.54 and 5."""
    own = np.array([[3.0, 5.0, 1.0], [4.0, np.nan, 7.0]])
    rows = TrackRows(np.zeros((2, 3)), True, None, None, None, "", sigma_m=own)
    assert path_sigma(section("track", sigma_m=2), rows).tolist() == [2.0] * 3
    assert_close("ratio", path_sigma(section("track"), rows), [np.sqrt(12.5), 5.0, 5.0])
    nothing = replace(rows, sigma_m=np.full((2, 3), np.nan))
    for one in (nothing, replace(rows, sigma_m=None), None):
        assert np.isnan(path_sigma(section("track"), one)).all()
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
    ],
)  # fmt: skip
def test_a_mount_is_a_right_handed_rotation(matrix: Any, good: bool) -> None:
    given = matrix.tolist() if isinstance(matrix, np.ndarray) else matrix
    one = section("vehicle", mount={"matrix": given})
    if good:
        found = _mount(one)
        assert_close("mount of rounded elements", found, TURN)
        assert_close("unit rotation", found @ found.T, np.eye(3))
    else:
        with refused(r"\[vehicle\.mount\] matrix: is not a rotation: three rows of three, right-"):
            _mount(one)


def test_mounts_by_name_and_angles() -> None:
    """Rows are forward, right, down of the body in the camera's right, down, forward."""
    assert _mount(section("vehicle")).tolist() == [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    assert _mount(section("vehicle", mount="down")).tolist() == [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    angles = _mount(section("vehicle", mount={"ypr_deg": [30, -20, 10]}))
    assert_close("unit rotation", angles, TURN @ [[0, 0, 1], [1, 0, 0], [0, 1, 0]])
    with refused(r"\[vehicle\] mount: 'dwon' is not known; did you mean down\?"):
        _mount(section("vehicle", mount="dwon"))
    with refused(r"\[vehicle\.mount\] ypr: there is no such key; did you mean ypr_deg\?"):
        _mount(section("vehicle", mount={"ypr": [1, 2, 3]}))


def test_refraction_of_a_project() -> None:
    found = [
        _refraction(section("atmosphere", **given))
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
        return _options(Project("p.toml", Path(), sections))

    usual = options({}, {})
    assert (usual.loss, usual.drop_blunders) == ("least-squares", False)
    assert (usual.focal_relative_sigma, usual.principal_point_sigma_px) == (0.0, (0.0, 0.0))
    for loss in ("least-squares", "huber", "cauchy"):
        assert options({"loss": loss}, {}).loss == loss
    assert options({"blunders": "drop"}, {}).drop_blunders
    assert not options({"blunders": "name"}, {}).drop_blunders
    found = options({}, {"focal_rel": 0.001, "principal_px": [1.5, 2.5]})
    assert (found.focal_relative_sigma, found.principal_point_sigma_px) == (0.001, (1.5, 2.5))
    assert options({}, {"principal_px": 2}).principal_point_sigma_px == (2.0, 2.0)


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
    path = CameraPath(position, np.full(3, np.nan))
    found = _uncovered(Project("p.toml", Path(), {}), path, lambda k: f"frame {k + 10}")
    message = f"the track has no position for {named}"
    assert found == [Finding(message, "p.toml", severity="warning")]
    assert _uncovered(Project("p", Path(), {}), CameraPath(np.ones((5, 3)), np.zeros(3)), str) == []


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
    why = "fewer than two landmarks: two of three angles at most, no attitude"
    assert result.findings == (
        Finding(f"frame 1, frame 3: {why}", result.flight.source, severity="warning"),
    )
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
    why = "its landmarks lie on one line of sight, or too few can be used"
    of_frame_0 = [one.message for one in found if "frame 0" in one.message]
    assert of_frame_0 == [f"frame 0: {why}"]
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
    found = [*_file_messages(replace(flight, picks=replace(flight.picks, pixel=pixel)))]
    message = f"1 pick outside the image of 1920 x 1080, the first mast in frame 1 at {u:g}, {v:g}"
    assert found == [message] * outside


def test_picks_above_the_image_may_have_v_upward(tmp_path: Path) -> None:
    flight = read_flight(str(write_project(tmp_path)))
    for above, hint in ((15, ""), (16, '; does v point up? then give [picks] v = "up"')):
        pixel = flight.picks.pixel.copy()
        pixel[:above, 1] = -100.0
        (found,) = _file_messages(replace(flight, picks=replace(flight.picks, pixel=pixel)))
        assert found.startswith(f"{above} picks outside the image")
        assert found.endswith(hint) and ("upward" in found or "up?" in found) == bool(hint)


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
    assert_close("ratio", whole_flight(solved).largest_lean_deg, expected)


def test_a_new_project_asks_for_heights_unless_a_file_says_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where the coordinate system cannot be looked up."""

    def asks(crs: str | None) -> bool:
        new = NewProject()
        _height(new, "track", crs)
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
