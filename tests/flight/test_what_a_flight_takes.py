"""Wind, fixed positions, speeds of images, other clocks, check landmarks: what a flight takes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.kit.flight_project import TOML, write_project
from tests.tolerances import assert_close
from vopd.findings import Finding, VopdError
from vopd.flight.check_flight import check_flight
from vopd.flight.flight import CameraPath
from vopd.flight.formats.picks import Names
from vopd.flight.formats.track import TrackRows
from vopd.flight.project import Project, Section
from vopd.flight.read import _with_wind, read_flight
from vopd.flight.result import _enough, _off_px, _set_aside
from vopd.flight.solve import solve
from vopd.flight.track import FrameTimes, _fixed, _frames, _speed
from vopd.geometry.earth import earth_centred_m

WITHOUT_TRACK = TOML.partition("[track]")[0]


# Wind


def with_wind(folder: Path, velocity: Any) -> tuple[CameraPath, list[str]]:
    """A path at heights of 0, 550 and 9000 m, and its wind."""
    (folder / "wind.csv").write_text("h_m,from_deg,speed_m_s\n500,180,10\n600,180,30\n")
    project = Project("p.toml", folder, {"wind": Section("p.toml", "wind", {"file": "wind.csv"})})
    position = earth_centred_m(47.0, 16.0, np.array([0.0, 550.0, 9000.0]))
    return _with_wind(project, CameraPath(position, np.zeros(3), velocity_m_s=velocity))


def test_wind_is_linear_in_height_and_held_beyond_the_ends(tmp_path: Path) -> None:
    """From the south is toward the north: 10 m/s at 500 m and below, 30 at 600 and above."""
    path, (said,) = with_wind(tmp_path, np.zeros((3, 3)))
    assert path.wind_m_s is not None
    assert_close("flight speed", path.wind_m_s[:, 0], [10.0, 20.0, 30.0])
    assert_close("flight speed", path.wind_m_s[:, 1:], np.zeros((3, 1)))
    assert said.endswith(", linear in height, the last level held beyond the ends")


def test_wind_without_a_velocity_is_refused(tmp_path: Path) -> None:
    with pytest.raises(VopdError) as refused:
        with_wind(tmp_path, None)
    assert str(refused.value) == (
        "p.toml: [wind] file: is of no use: the velocity is not known without a track by time"
    )
    path = CameraPath(np.zeros((1, 3)), np.zeros(3))
    assert _with_wind(Project("p.toml", tmp_path, {}), path) == (path, [])


# Positions and speeds


def test_a_fixed_position_has_every_key_of_its_section() -> None:
    keys = {"lat_deg": 47.5, "lon_deg": 16.25, "h_m": 540.0, "height": "ellipsoid"}
    more = {"sigma_m": [1, 2, 3], "lever_arm_m": [4, 5, 6]}
    times = FrameTimes(np.array([7.0, 8.0]), (), None)
    read = _fixed(Section("p.toml", "position", keys | more), times)
    here = earth_centred_m(47.5, 16.25, 540.0)
    assert_close("ratio", read.path.position_m / here, np.ones((2, 3)))
    assert read.path.sigma_m.tolist() == [1.0, 2.0, 3.0]
    assert read.path.lever_arm_m is not None and read.path.lever_arm_m.tolist() == [4.0, 5.0, 6.0]
    assert (read.path.velocity_m_s, read.times) == (None, times)
    plain = _fixed(Section("p.toml", "position", dict(keys)), times).path
    assert plain.lever_arm_m is None and np.isnan(plain.sigma_m).all()


@pytest.mark.parametrize("key", ["lat_deg", "lon_deg", "h_m", "x_m", "y_m", "z_m", "crs"])
def test_a_fixed_position_needs_its_coordinates(key: str) -> None:
    geodetic = {"lat_deg": 47.5, "lon_deg": 16.25, "h_m": 540.0, "height": "ellipsoid"}
    grid = {"x_m": 1.0, "y_m": 2.0, "z_m": 3.0, "crs": "EPSG:32633", "height": "ellipsoid"}
    given: dict[str, Any] = dict(geodetic if key in geodetic else grid)
    del given[key]
    named = "x_m" if key == "lat_deg" else key
    with pytest.raises(VopdError, match=rf"^p\.toml: \[position\] {named}: "):
        _fixed(Section("p.toml", "position", given), FrameTimes(np.zeros(1), (), None))


@pytest.mark.parametrize(
    ("time_s", "whole", "known"),
    [
        ([3.0, 0.0, 1.0], False, True), ([3.0, 0.0, 1.0], True, False),
        ([1.0, 0.0, 1.0], False, False), ([3.0, 0.0, np.nan], False, False),
        ([3.0, 0.0, 1e-9], False, True), ([5.0], False, False), ([], False, False),
    ],
)  # fmt: skip
def test_speed_by_the_positions_of_images(time_s: list[float], whole: bool, known: bool) -> None:
    """Of a path of 2 m/s east: the same at all of them, in whatever order they stand."""
    time = np.array(time_s)
    position = np.stack([2.0 * time, 0.0 * time, 0.0 * time + 5.0], axis=1)
    rows = TrackRows(position, False, None, None, time, "", whole_seconds=whole)
    said: list[str] = []
    speed = _speed(rows, position, time, said)
    if known:
        assert speed is not None and said == [
            "velocity by the differences of the images' positions"
        ]
        assert_close("flight speed", speed, np.tile([2.0, 0.0, 0.0], (len(time), 1)))
    else:
        assert speed is None
        assert said == ["no velocity: the images' times are whole seconds, or too few, or alike"]


def test_speed_at_the_ends_is_of_the_nearest_pair() -> None:
    """Of t squared at 0, 1 and 3 s: 1 and 4 m/s at the ends, the derivative 2 between them."""
    time = np.array([3.0, 0.0, 1.0])
    position = np.outer(time**2, [1.0, 0.0, -1.0])
    speed = _speed(TrackRows(position, False, None, None, time, ""), position, time, [])
    assert_close("flight speed", speed, np.outer([4.0, 1.0, 2.0], [1.0, 0.0, -1.0]))


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
        _enough(flight)
    else:
        with pytest.raises(VopdError, match=r"no frame has two landmarks \(frames: 5, one at most"):
            _enough(flight)


def test_warnings_stay_where_the_solve_is_refused(tmp_path: Path) -> None:
    path = write_project(tmp_path)
    head, *rows = (tmp_path / "picks.csv").read_text().splitlines()
    (tmp_path / "picks.csv").write_text("\n".join([head, *rows[::6], "0,steeple,5,5"]))
    found = check_flight(str(path))
    assert [(one.severity, one.message.partition(" (")[0]) for one in found] == [
        ("warning", "no landmark steeple"),
        ("warning", "never picked: mast, bridge, corner, tower, well"),
        ("error", "no frame has two landmarks"),
    ]
    assert {one.deck for one in found} == {str(path)}


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
    assert_close("trial without noise", _off_px(replace(solved, flight=moved)), expected)


def test_frames_by_name_and_by_number_are_in_order() -> None:
    number, image, index = _frames(Names(["b.jpg", "a.jpg", "b.jpg", "c.jpg"]))
    assert (number.tolist(), image, index.tolist()) == ([0, 1, 2], ("a.jpg", "b.jpg", "c.jpg"),
                                                        [1, 0, 1, 2])  # fmt: skip
    number, image, index = _frames(np.array([7, 3, 7, 5]))
    assert (number.tolist(), image, index.tolist()) == ([3, 5, 7], (), [2, 0, 2, 1])


@pytest.mark.parametrize("names", [(), tuple(f"{k}.jpg" for k in range(5))])
def test_every_pick_that_is_set_aside_is_a_warning(names: tuple[str, ...], tmp_path: Path) -> None:
    """The third landmark of frame 1 and the last of frame 4, each with its reason."""
    flight = replace(read_flight(str(write_project(tmp_path))), image_name=names)
    aside = np.zeros(30, np.int64)
    aside[[8, 29]] = 1, 2
    solved: Any = SimpleNamespace(attitudes=SimpleNamespace(set_aside=aside))
    labels = ["1.jpg", "4.jpg"] if names else ["frame 1", "frame 4"]
    why = [
        "bridge lies behind the camera",
        "well lies outside the field in which the lens model holds",
    ]
    end = "as the others have it; its pick is not used"
    assert _set_aside(flight, solved) == [
        Finding(f"{label}: {one} {end}", flight.source, severity="warning")
        for label, one in zip(labels, why, strict=True)
    ]
