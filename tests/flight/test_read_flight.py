"""What a project hands to its flight: landmarks, systems, datums, wind, doubts, and their order."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.kit.flight_project import LENS, MARKS, TOML, marks_m, write_project
from tests.tolerances import assert_close
from vopd.findings import Finding, VopdError
from vopd.flight import check_flight as checked
from vopd.flight.check_flight import _far, _file_messages, check_flight
from vopd.flight.flight import Flight
from vopd.flight.landmark_formats.landmark_rows import LandmarkRows
from vopd.flight.project_file import Project, Section
from vopd.flight.read_flight import _crs, _options, read_flight
from vopd.geometry.geodetic import earth_centred_m, geodetic


def flight(folder: Path, toml: str = TOML) -> Flight:
    return read_flight(str(write_project(folder, toml)))


def refused(folder: Path, toml: str) -> str:
    with pytest.raises(VopdError) as told:
        flight(folder, toml)
    return str(told.value).removeprefix(f"{folder / 'flight.toml'}: ")


def test_what_is_read_is_said_in_order(tmp_path: Path) -> None:
    (tmp_path / "wind.csv").write_text("h_m,from_deg,speed_m_s\n0,90,2\n900,90,2\n")
    keys = TOML.replace('"landmarks.csv"', '"landmarks.csv"\nsigma_m = [1, 2, 3]')
    found = flight(tmp_path, keys + '[wind]\nfile = "wind.csv"\n')
    assert found.about == (
        "lens: brown, 5 coefficients, centre grid",
        "picks.csv: CSV, 30 picks, centre grid, v down",
        "landmarks.csv: CSV, 6 landmarks, WGS 84, heights above the ellipsoid",
        "track.csv: CSV, 4 positions",
        "positions between those of the track: linear",
        "velocity by the differences of the track's positions",
        "wind.csv: CSV, m/s, 2 levels, linear in height, the last level held beyond the ends",
    )
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
    rate = "frame_rate_hz = 10.0\nfirst_frame_t_s = 2.0\n"
    (tmp_path / "times.csv").write_text("frame,t_s\n0,2\n1,2.1\n2,2.2\n3,2.3\n4,9\n")
    toml = TOML.replace(rate, 'times = "times.csv"\n').replace('name = "F12"\n', "")
    found = flight(tmp_path, toml)
    assert found.about[1:3] == (
        "picks.csv: CSV, 30 picks, centre grid, v down", "times.csv: times of 5 frames",
    )  # fmt: skip
    assert found.name == ""
    message = "the track has no position for frame 4"
    assert found.findings == (Finding(message, found.source, severity="warning"),)


FIXED = TOML.partition("[track]")[0] + (
    '[position]\nlat_deg = 47.6435\nlon_deg = 16.4759\nh_m = 540\nheight = "ellipsoid"\n'
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
    said = refused(tmp_path, TOML + '[solve]\nframes = "one"\n')
    assert said == '[solve] frames: "one" is for a camera that does not move: give [position]'
    assert refused(tmp_path, TOML + '[solve]\nframes = "all"\n') == (
        "[solve] frames: 'all' is not known; known are each, one"
    )


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
        assert refused(tmp_path, toml) == (
            f'[{message}] height: "same" must stand in [landmarks] and in [{where}], or in neither'
        )
    else:
        level = "above one level, not stated" if marks == "same" else "above the ellipsoid"
        assert flight(tmp_path, toml).about[2].endswith(f"WGS 84, heights {level}")


def test_landmarks_that_are_refused(tmp_path: Path) -> None:
    solve = TOML + '[solve]\ncheck_landmarks = ["mast", "NAME"]\n'
    assert refused(tmp_path, solve.replace("NAME", "chruch")) == (
        "[solve] check_landmarks: there is no landmark chruch; did you mean church?"
    )
    found = flight(tmp_path, solve.replace("NAME", "well"))
    assert found.landmarks.used == (True, False, True, True, True, False)
    rows = (tmp_path / "landmarks.csv").read_text()
    for twice in ("mast", "church"):
        rows += next(row for row in rows.splitlines() if row.startswith(twice)) + "\n"
        (tmp_path / "landmarks.csv").write_text(rows)
        with pytest.raises(VopdError) as told:
            read_flight(str(tmp_path / "flight.toml"))
        first = min(twice, "mast")
        assert str(told.value) == f"landmarks.csv: {first} has two positions"
    (tmp_path / "landmarks.csv").write_text("landmark,lat_deg,lon_deg,h_m\nmast,47,16,5\n")
    toml = TOML.replace('file = "landmarks.csv"', 'file = "landmarks.csv"\ncrs = "EPSG:32633"')
    (tmp_path / "flight.toml").write_text(toml)
    with pytest.raises(
        VopdError, match=r"flight\.toml: \[landmarks\]: latitude and longitude with"
    ):
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
    rows = LandmarkRows(["a"], np.zeros((1, 3)), geodetic, own, np.zeros(1), [1], "")
    section = Section("p.toml", "landmarks", {} if given is None else {"crs": given})
    if found is not None and found.startswith("crs: "):
        with pytest.raises(VopdError) as told:
            _crs(section, rows)
        assert str(told.value) == f"p.toml: [landmarks] {found}"
    else:
        assert _crs(section, rows) == found


@pytest.mark.parametrize(
    ("section", "key", "value", "message"),
    [
        ("solve", "loss", "hubr", "'hubr' is not known; did you mean huber?"),
        ("solve", "blunders", "keep", "'keep' is not known; known are name, drop"),
        ("uncertainty", "focal_rel", -0.5, "-0.5: a standard deviation is not below 0"),
        ("uncertainty", "principal_px", [1, 2, 3], "[1, 2, 3] is not a list of 2 numbers"),
    ],
)
def test_options_that_are_refused(section: str, key: str, value: Any, message: str) -> None:
    given = {section: Section("p.toml", section, {key: value})}
    with pytest.raises(VopdError) as told:
        _options(Project("p.toml", Path(), given))
    assert str(told.value) == f"p.toml: [{section}] {key}: {message}"


# What a check says


def test_an_error_stands_behind_the_warnings_and_has_no_name_of_the_file(tmp_path: Path) -> None:
    path = write_project(tmp_path, "[flight]\n")
    assert check_flight(str(path)) == [Finding("the section [camera] is needed", str(path))]
    path = write_project(tmp_path, TOML.replace('height = "ellipsoid"\n', ""))
    (found,) = check_flight(str(path))
    assert found.message.startswith("[landmarks]: `height` is needed: ")
    assert (found.deck, found.severity) == (str(path), "error")


def test_landmarks_never_picked_are_named_in_the_order_of_the_file(tmp_path: Path) -> None:
    """Ten, and the count of the rest; the first landmark, too."""
    one = flight(tmp_path)
    names = tuple(f"m{k}" for k in range(14))
    for picked, named in (
        (range(14), None), (range(1, 14), "m0"), (range(4, 14), "m0, m1, m2, m3"),
        (range(10, 14), "m0, m1, m2, m3, m4, m5, m6, m7, m8, m9"),
        (range(11, 14), "m0, m1, m2, m3, m4, m5, m6, m7, m8, m9 and 1 more"),
        (range(3), "m3, m4, m5, m6, m7, m8, m9, m10, m11, m12 and 1 more"),
    ):  # fmt: skip
        count = len(picked)
        picks = replace(
            one.picks, frame=np.zeros(count, int), landmark=np.array(picked)[::-1],
            pixel=np.full((count, 2), 5.0), sigma_px=np.ones(count),
        )  # fmt: skip
        landmarks = replace(one.landmarks, name=names)
        found = [*_file_messages(replace(one, picks=picks, landmarks=landmarks))]
        assert found == ([] if named is None else [f"never picked: {named}"])


def test_picks_outside_the_image_are_counted_and_the_first_is_named(tmp_path: Path) -> None:
    one = flight(tmp_path)
    pixel = one.picks.pixel.copy()
    pixel[8], pixel[20] = (-7.25, 50.0), (5.0, 3000.5)
    (found,) = _file_messages(replace(one, picks=replace(one.picks, pixel=pixel)))
    assert found == (
        "2 picks outside the image of 1920 x 1080, the first bridge in frame 1 at -7.25, 50"
    )


def far(one: Flight, camera_m: Any = None, marks_m: Any = None) -> list[str]:
    path = one.path if camera_m is None else replace(one.path, position_m=camera_m)
    marks = one.landmarks if marks_m is None else replace(one.landmarks, position_m=marks_m)
    return [*_far(replace(one, path=path, landmarks=marks))]


FAR = "landmarks are more than 300 km from the camera"


@pytest.mark.parametrize(("height_km", "told"), [(297.0, False), (303.0, True)])
def test_landmarks_300_km_away_are_far(height_km: float, told: bool, tmp_path: Path) -> None:
    one = flight(tmp_path)
    camera = np.tile(earth_centred_m(47.6435, 16.4759, 1e3 * height_km), (5, 1))
    assert far(one, camera) == [FAR] * told
    camera[3:] = np.nan  # frames without a position do not count
    assert far(one, camera) == [FAR] * told
    camera[:] = np.nan
    assert far(one, camera) == []
    # half of the landmarks is near, and they decide with their count
    marks = marks_m()
    marks[:2] = earth_centred_m(-47.0, 100.0, 0.0)
    assert far(one, marks_m=marks) == []
    marks[:4] = earth_centred_m(-47.0, 100.0, 0.0)
    assert far(one, marks_m=marks) == [FAR]


def test_whose_latitude_and_longitude_are_exchanged(tmp_path: Path) -> None:
    one = flight(tmp_path)

    def turned(position: Any) -> Any:
        where = geodetic(position)
        return earth_centred_m(where.longitude_deg, where.latitude_deg, where.height_m)

    whose = "the landmarks or of the camera"
    both = f"{FAR}; with latitude and longitude of {whose} exchanged they are not"
    assert far(one, marks_m=turned(one.landmarks.position_m)) == [both]
    assert far(one, turned(one.path.position_m)) == [both]
    assert far(one, turned(one.path.position_m), turned(one.landmarks.position_m)) == []
    east = earth_centred_m([47.0] * 6, [120.0] * 6, [0.0] * 6)
    across = earth_centred_m([60.0] * 5, [-133.0] * 5, [0.0] * 5)  # 120 degrees by the pole
    assert far(one, across, east) == [FAR]
    assert far(one, earth_centred_m([47.0] * 5, [16.4759] * 5, [0.0] * 5), east) == [FAR]


def test_findings_of_a_check_stand_in_order(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where landmarks are far no usual mistake is looked for."""
    path = str(write_project(tmp_path))
    monkeypatch.setattr(checked, "usual_mistakes", lambda project, result: ["a mistake"])
    usual = [Finding("a mistake", path, severity="warning")]
    assert check_flight(path) == usual
    rows = (tmp_path / "picks.csv").read_text().splitlines()
    (tmp_path / "picks.csv").write_text("\n".join([*rows, "9,mast,5,5", "0,steeple,1,1"]))
    found = check_flight(path)
    assert [(one.severity, one.message.partition(":")[0].partition(" (")[0]) for one in found] == [
        ("warning", "no landmark steeple"),
        ("warning", "frame 9"),
        ("warning", "a mistake"),
    ]
    monkeypatch.setattr(checked, "_far", lambda flight: ["far away"])
    found = check_flight(path)
    assert "a mistake" not in [one.message for one in found]
    assert Finding("far away", path, severity="warning") in found


@pytest.mark.parametrize(("solved", "told"), [([False, False], True), ([True, False], False)])
def test_a_solve_without_an_attitude_is_an_error(
    solved: list[bool], told: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = str(write_project(tmp_path))
    result = SimpleNamespace(solved=np.array(solved), findings=())
    monkeypatch.setattr(checked, "solve_flight_read", lambda flight: result)
    monkeypatch.setattr(checked, "usual_mistakes", lambda project, result: [])
    assert check_flight(path) == [Finding("no frame has an attitude", path)] * told
