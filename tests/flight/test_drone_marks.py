""".MRK files of drones: photos by number, with GPS time, position and standard deviations."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

import vopd
from tests.kit.command import vopd as run
from tests.kit.flight_project import TOML, camera_m, truth_deg, write_project
from tests.tolerances import assert_close, within
from vopd.findings import VopdError
from vopd.flight.files import open_input
from vopd.flight.formats.track import photo_number, read_mrk
from vopd.geometry.earth import geodetic

LINE = (
    "{number}\t{seconds:.6f}\t[{week}]\t     3,N\t     0,E\t    40,V\t"
    "{lat:.10f},Lat\t{lon:.10f},Lon\t{h:.4f},Ellh\t0.03, 0.01, 0.05\t{quality},Q\n"
)


def mark(number: int, week: int, seconds: float, quality: int = 50, **where: float) -> str:
    position = {"lat": 47.0, "lon": 16.0, "h": 500.0} | where
    return LINE.format(number=number, week=week, seconds=seconds, quality=quality, **position)


def marks_project(folder: Path) -> Path:
    """The project with a .MRK file in the place of its track, and photos 17 to 21."""
    project = write_project(folder, TOML[: TOML.index("[track]")] + '[track]\nfile = "a.MRK"\n')
    where = geodetic(camera_m(2.0 + np.arange(5) / 10.0))
    lines = []
    for k in range(5):
        taken = datetime(2026, 5, 1, 11, 58, 44, 100_000 * k, tzinfo=UTC) + timedelta(seconds=18)
        days = (taken - datetime(1980, 1, 6, tzinfo=UTC)).total_seconds()
        position = {"lat": where[0][k], "lon": where[1][k], "h": where[2][k]}
        lines.append(mark(17 + k, int(days // 604800), days % 604800, **position))
    (folder / "a.MRK").write_text("".join(lines))
    picks = folder / "picks.csv"
    rows = [f"a/DJI_{17 + int(r[0]):04d}.JPG{r[1:]}" for r in picks.read_text().splitlines()[1:]]
    picks.write_text("\n".join(["image,landmark,u_px,v_px", *rows]))
    return project


def test_gps_week_and_seconds(tmp_path: Path) -> None:
    """Week 2211 and 296289.777625 s are 2022-05-25, 10:18:09.777625 of GPS time."""
    (tmp_path / "a.mrk").write_text(mark(29, 2211, 296289.777625))
    rows = read_mrk(open_input("a.mrk", tmp_path))
    assert rows.time_s is not None and rows.sigma_m is not None
    assert datetime.fromtimestamp(rows.time_s[0], UTC).isoformat(timespec="milliseconds") == (
        "2022-05-25T10:18:09.777+00:00"
    )
    assert (rows.clock, rows.height, rows.image) == ("gps", "ellipsoid", ["29"])
    assert rows.coordinate.tolist() == [[16.0, 47.0, 500.0]]
    assert rows.sigma_m.tolist() == [[0.01, 0.03, 0.05]]  # the file has north first


@pytest.mark.parametrize(
    ("name", "number"),
    [
        ("MAX_0029.JPG", "29"),
        ("DJI_0029.JPG", "29"),
        ("100_0001_0029.JPG", "29"),
        ("DJI_20230101120000_0029_V.JPG", "29"),
        ("DJI_20220525101809_0029_Zenmuse-P1-mission.JPG", "29"),
        ("DCIM/100MEDIA/DJI_0029.JPG", "29"),
        ("front.jpg", "front.jpg"),
    ],
)
def test_the_number_of_a_photo_in_its_name(name: str, number: str) -> None:
    assert photo_number(name) == number


def test_a_flight_by_marks_has_positions_times_and_velocity(tmp_path: Path) -> None:
    """The clock is 18 s ahead of UTC; 20 m/s north, 5 east, climbing 2."""
    flight = vopd.solve_flight(marks_project(tmp_path))
    assert_close("flight angle", flight.camera_deg, truth_deg() % 360.0 - [0, 360, 0])
    assert flight.estimate.time_s.round(6).tolist() == [2.0, 2.1, 2.2, 2.3, 2.4]
    velocity = flight.flight.path.velocity_m_s
    assert velocity is not None
    assert np.abs(velocity - [20.0, 5.0, -2.0]).max() < within("speed of images")
    assert flight.flight.path.sigma_m.round(12).tolist() == [0.01, 0.03, 0.05]
    (said,) = (one for one in flight.about if one.startswith("a.MRK"))
    assert "its antenna offsets of up to 0.04 m are not added" in said


def test_without_an_epoch_time_begins_at_the_first_second_of_the_marks(tmp_path: Path) -> None:
    project = marks_project(tmp_path)
    project.write_text(project.read_text().replace("epoch =", "# epoch ="))
    flight = vopd.solve_flight(project)
    assert flight.estimate.time_s.round(6).tolist() == [0.0, 0.1, 0.2, 0.3, 0.4]
    assert flight.estimate.about.epoch == datetime(2026, 5, 1, 11, 58, 44, tzinfo=UTC)


def test_photos_without_position_are_left_out_and_loose_ones_counted(tmp_path: Path) -> None:
    path = tmp_path / "a.mrk"
    path.write_text(
        mark(1, 2211, 10.0) + mark(2, 2211, 12.0, 16) + mark(3, 2211, 14.0, 0, lat=0.0, lon=0.0)
    )
    rows = read_mrk(open_input("a.mrk", tmp_path))
    assert rows.image == ["1", "2"] and ", 1 without an RTK fix" in rows.said


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        (("47.0000000000,Lat", "47.0000000000"), "line 2: a line is number, seconds, [week]"),
        (("47.0000000000,Lat", "nan,Lat"), "line 2: a number is not finite"),
        (("47.0000000000,Lat", "147.0,Lat"), "line 2: a number is not finite, or no latitude"),
        (("[2211]", "[99999999]"), "or no latitude or GPS week"),
        (("[2211]", "[x]"), "line 2: invalid literal"),
        (("\t50,Q", ""), "line 2: a line is number"),
    ],
)
def test_lines_that_are_wrong_are_named(tmp_path: Path, wrong: tuple[str, str], told: str) -> None:
    path = tmp_path / "a.mrk"
    path.write_text(mark(1, 2211, 10.0) + mark(2, 2211, 12.0).replace(*wrong))
    with pytest.raises(VopdError) as error:
        read_mrk(open_input("a.mrk", tmp_path))
    assert told in str(error.value)


def test_heights_of_marks_are_known_and_not_asked(tmp_path: Path) -> None:
    project = marks_project(tmp_path / "a")
    ran = run("new", tmp_path / "new", "--track", tmp_path / "a" / "a.MRK")
    assert ran.status == 0 and "needed: [track]" not in ran.stdout
    project.write_text(project.read_text() + 'height = "egm96"\n')
    with pytest.raises(VopdError, match="the file has heights above the ellipsoid: leave it out"):
        vopd.solve_flight(project)


def test_photos_that_the_marks_do_not_have(tmp_path: Path) -> None:
    project = marks_project(tmp_path)
    marks = tmp_path / "a.MRK"
    text = marks.read_text()
    marks.write_text(text.replace("19\t", "99\t", 1))
    flight = vopd.solve_flight(project)
    assert flight.solved.tolist() == [True, True, False, True, True]
    assert "no position for a/DJI_0019.JPG" in str(flight.findings[0])
    marks.write_text(text.splitlines()[0] + "\n" + text)
    with pytest.raises(VopdError, match="17 has two positions"):
        vopd.solve_flight(project)
    marks.write_text(mark(1, 2211, 10.0))
    with pytest.raises(VopdError, match=r"none of the images.*DJI_0017\.JPG for one.*it has 1 for"):
        vopd.solve_flight(project)


def test_an_offset_that_leaves_no_date(tmp_path: Path) -> None:
    project = marks_project(tmp_path)
    text = project.read_text().replace("epoch =", "# epoch =")
    project.write_text(text + "offset_s = 1e300\n")
    with pytest.raises(VopdError, match=r"1e\+300 s after 1970 is no date of a frame"):
        vopd.solve_flight(project)
