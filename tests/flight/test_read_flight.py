"""What a project hands to its flight: landmarks, systems, datums, wind, doubts, and their order."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.kit.flight_project import LENS, MARKS, TOML, marks_m, write_project
from tests.tolerances import assert_close
from vopd.findings import Finding, VopdError
from vopd.flight import read as reading
from vopd.flight.flight import Flight
from vopd.flight.formats.landmarks import LandmarkRows
from vopd.flight.project import Project, Section
from vopd.flight.read import _crs, _mount, _options, _refraction, read_flight


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
        message = f"the track has no position for {lost}"
        assert found.findings == (Finding(message, found.source, severity="warning"),)
        assert found.frame.tolist() == [10 * (kind == "frame") + k for k in range(5)]
        names = () if kind == "frame" else tuple(f"{k}.jpg" for k in range(5))
        assert found.image_name == names


def test_doubts_about_the_track_are_warnings_behind_those_about_picks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write_project(tmp_path)
    rows = (tmp_path / "picks.csv").read_text()
    (tmp_path / "picks.csv").write_text(rows + "0,steeple,1,2\n99,mast,1,2\n")
    read = reading.read_path
    monkeypatch.setattr(
        reading, "read_path", lambda *given: read(*given)._replace(doubts=["one", "two"])
    )
    found = read_flight(str(path)).findings
    assert [one.message.partition(" (")[0] for one in found] == [
        "no landmark steeple", "one", "two", "the track has no position for frame 99",
    ]  # fmt: skip
    assert {(one.severity, one.deck) for one in found} == {("warning", str(path))}


def test_every_section_reaches_the_flight(tmp_path: Path) -> None:
    usual = flight(tmp_path)
    assert (usual.refraction.k, usual.refraction.decays) == (0.13, True)
    assert (usual.options.loss, usual.options.drop_blunders) == ("least-squares", False)
    given = flight(
        tmp_path,
        TOML.replace('"track.csv"', '"track.csv"\nsigma_m = [1, 2, 3]\nlever_arm_m = [4, 5, 6]')
        + '[vehicle]\nmount = "down"\n[atmosphere]\nrefraction = { k = 0.25 }\n'
        '[solve]\nloss = "huber"\nblunders = "drop"\n'
        "[uncertainty]\nfocal_rel = 0.01\nprincipal_px = [1, 2]\n",
    )
    assert (given.refraction.k, given.refraction.decays) == (0.25, False)
    options = given.options
    assert (options.loss, options.drop_blunders) == ("huber", True)
    assert (options.focal_relative_sigma, options.principal_point_sigma_px) == (0.01, (1.0, 2.0))
    assert given.mount.tolist() == [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    assert usual.mount.tolist() == [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    assert given.path.sigma_m.tolist() == [1.0, 2.0, 3.0]
    assert given.path.lever_arm_m is not None and given.path.lever_arm_m.tolist() == [4, 5, 6]
    rows = (tmp_path / "landmarks.csv").read_text()
    assert rows.startswith("landmark,lat_deg")
    plane = TOML.replace('"landmarks.csv"', '"landmarks.csv"\ncrs = "EPSG:4258"')
    assert flight(tmp_path, plane).about[2].endswith("EPSG:4258, heights above the ellipsoid")


def test_v_is_counted_from_the_last_row_of_the_lens_s_images(tmp_path: Path) -> None:
    """The last of 1080 rows is 1079."""
    down = flight(tmp_path).picks.pixel
    up = flight(tmp_path, TOML.replace('"picks.csv"', '"picks.csv"\nv = "up"')).picks.pixel
    assert_close("flight pixel", up, [0.0, 1079.0] + [1.0, -1.0] * down)


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
    named = [f"b{k % 2}.jpg{row[1:]}" for k, row in enumerate(rows[:6])]
    (tmp_path / "picks.csv").write_text("\n".join([head.replace("frame", "image"), *named]))
    one = read_flight(str(tmp_path / "flight.toml"))
    assert (one.image_name, one.frame.tolist()) == (("b0.jpg",), [0])
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


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("xyz", "[atmosphere] refraction: 'xyz' is not known; known are standard, off"),
        (5, "[atmosphere] refraction: 5 is not a text in quotes"),
        ({"k": 0.1, "decays": True},
         "[atmosphere.refraction] decays: there is no such key; known are k"),
        ({}, "[atmosphere.refraction] k: is needed"),
        ({"k": "x"}, "[atmosphere.refraction] k: 'x' is not a finite number"),
    ],
)  # fmt: skip
def test_refractions_that_are_refused(value: Any, message: str) -> None:
    with pytest.raises(VopdError) as told:
        _refraction(Section("p.toml", "atmosphere", {"refraction": value}))
    assert str(told.value) == f"p.toml: {message}"


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("up", "[vehicle] mount: 'up' is not known; known are forward, down"),
        (["forward"], "[vehicle] mount: ['forward'] is not a table, { ypr_deg = ... }"),
        ([], "[vehicle] mount: [] is not a table, { ypr_deg = ... }"),
        (5, "[vehicle] mount: 5 is not a table, { ypr_deg = ... }"),
        ({"matrix": [1], "roll": 2}, "[vehicle.mount] roll: there is no such key; known are ypr"),
        ({}, "[vehicle.mount] matrix: is not a rotation: three rows of three, right-handed"),
    ],
)
def test_mounts_that_are_refused(value: Any, message: str) -> None:
    with pytest.raises(VopdError) as told:
        _mount(Section("p.toml", "vehicle", {"mount": value}))
    assert str(told.value).startswith(f"p.toml: {message}")
