"""A flight on cards: readings, numbers, values."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import vopd
from tests.approved.texts import assert_approved, refused
from tests.kit.command import vopd as run
from tests.kit.flight_project import HEIGHT, MARKS, TOML, three_frames, write_project
from tests.kit.random_flights import lenses
from tests.tolerances import assert_close
from vopd.convert.flight_to_deck import (
    CardFilm,
    card_ignored,
    card_landmarks,
    card_readings,
    flight_job,
    frame_numbers,
    frame_times,
    landmark_numbers,
    radius_table,
    rounded_rows,
    to_ten_columns,
    to_the_reader,
)
from vopd.findings import VopdError
from vopd.flight.flight import LandmarkSet
from vopd.flight.project.read import read_flight
from vopd.geometry.lenses import Lens, LensKind
from vopd.job import Job

# Readings, fiducials, ignored landmarks, and the table of a lens on cards, by hand


INCHES = 0.005
POINT_IN = np.stack([4.0 + 0.1 * np.arange(12.0), 2.0 + 0.2 * np.arange(12.0)], axis=1)
NUMBER = np.array([11, 12, 0, 14])


def film(centre_in: tuple[float, float] = (5.0, 3.0)) -> CardFilm:
    none = np.zeros(25)
    return CardFilm(INCHES, 5.0, np.array(centre_in), POINT_IN, none, none, ())


def test_three_readings_whose_mean_is_the_pick_and_has_its_deviation() -> None:
    """Frames 1 and 2 of three; the pick of the third landmark is not held."""
    flight = three_frames()
    held = np.tile([True, True, False, True], 3)
    frame = np.array([71, 72])
    found = card_readings(flight, film(), held, np.array([1, 2]), frame, NUMBER)
    assert found.frame.tolist() == [71, 72]
    assert found.landmark.tolist() == [[11, 12, 14]] * 2 and found.present.all()
    readings = found.landmark_in  # (F, L, 3, 2)
    rows = np.array([[4, 5, 7], [8, 9, 11]])
    assert_close("five decimals", readings.mean(axis=2), POINT_IN[rows])
    deviation = readings.std(axis=2, ddof=1) / np.sqrt(3.0) / INCHES
    sigma = np.array([0.5, 1.0, 4.0])[None, :, None]  # of u and of v
    assert_close("pick by readings", deviation, np.broadcast_to(sigma, (2, 3, 2)))


@pytest.mark.parametrize(
    ("centre", "away"), [((5.0, 3.0), (4.5, 2.7)), ((4.94, 2.47), (4.44, 2.22))]
)
def test_four_fiducials_stand_nine_tenths_off_the_centre(
    centre: tuple[float, float], away: tuple[float, float]
) -> None:
    """Each read three times alike: left below, right below, right above, left above."""
    found = card_readings(
        three_frames(), film(centre), np.ones(12, bool), np.arange(3), np.arange(3), NUMBER
    ).fiducial_in
    assert found.shape == (3, 4, 3, 2)
    (x, y), (dx, dy) = centre, away
    corners = [[x - dx, y - dy], [x + dx, y - dy], [x + dx, y + dy], [x - dx, y + dy]]
    for frame in range(3):
        for reading in range(3):
            assert_close("film length", found[frame, :, reading], corners)


def test_check_landmarks_are_ignored_everywhere_and_others_nowhere() -> None:
    """A column for each landmark that is seen; the last is a check landmark."""
    found = card_ignored(three_frames(), NUMBER)
    assert found.everywhere.tolist() == [14, 0, 0]
    assert len(found.frame) == 0
    assert card_ignored(three_frames(), np.array([11, 12, 13, 0])).everywhere.tolist() == [0] * 3
    base = three_frames()
    both = replace(base, landmarks=replace(base.landmarks, used=(False, True, True, False)))
    assert card_ignored(both, np.array([0, 12, 13, 14])).everywhere.tolist() == [14, 0, 0]
    every = replace(base, landmarks=replace(base.landmarks, used=()))
    assert card_ignored(every, NUMBER).everywhere.tolist() == [0, 0, 0]


def lens(kind: LensKind = LensKind.BROWN, **more: Any) -> Lens:
    k = np.zeros(12)
    for index, value in more.pop("k", {}).items():
        k[index] = value
    usual = {"focal_px": np.array([1500.0, 1500.0]), "centre_px": np.array([960.0, 540.0])}
    return Lens(kind, (1920, 1080), k=k, **(usual | more))


@pytest.mark.parametrize("index", range(12))
def test_which_coefficients_are_radial(index: int) -> None:
    """OpenCV's order k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4: p and s are across."""
    assert lens(k={index: 1e-6}).is_radial == (index in (0, 1, 4, 5, 6, 7))


def test_which_lenses_are_radial() -> None:
    assert lens().is_radial and lens(LensKind.FISHEYE).is_radial
    assert lenses()["table"].is_radial
    assert not lens(skew_px=1e-3).is_radial
    assert not lens(focal_px=np.array([1500.0, 1500.001])).is_radial


def test_rows_of_a_table_and_those_beyond_it() -> None:
    """100 mm of focal length: 200 and 300 um at 10 and 20 mm, then 10 um a mm in steps of 2 mm."""
    table = np.array([[0.0, 0.0], [0.1, 0.102], [0.2, 0.203]])
    radius, added = rounded_rows(table, 100.0)
    assert len(radius) == len(added) == 25
    assert_close("ratio", radius, [0.0, 10.0, *np.arange(20.0, 65.0, 2.0)])
    assert_close("ratio", added, [0.0, 200.0, *np.arange(300.0, 750.0, 20.0)])
    radius, added = rounded_rows(np.array([[0.0, 0.0], [0.003, 0.0031]]), 100.0)
    assert_close("ratio", radius[1:4], [0.3, 0.4, 0.5])  # a tenth of a millimetre at least
    assert_close("ratio", added[1:4], [10.0, 13.333, 16.667])
    radius, added = rounded_rows(np.array([[0.0, 0.0], [0.0123456789, 0.0123499999]]), 100.0)
    assert (radius[1], added[1]) == (1.234568, 0.432)
    whole = np.linspace(0.0, 0.24, 25)
    assert len(rounded_rows(np.stack([whole, whole], axis=1), 100.0)[0]) == 25


def test_the_table_of_a_lens_goes_to_its_farthest_pick() -> None:
    """Two percent farther than the ideal radius .5, and at least .1; k1 = -.1 at every row."""
    ideal = np.array([[0.3, 0.4], [0.1, 0.0], [np.nan, np.nan]])
    found = radius_table(lens(k={0: -0.1}), ideal)
    assert len(found) == 25
    assert_close("ratio", found[:, 1], np.linspace(0.0, 0.51, 25))
    assert_close("ratio", found[:, 0], found[:, 1] * (1 - 0.1 * found[:, 1] ** 2))
    assert_close("ratio", radius_table(lens(), ideal[2:])[-1, 1], 0.102)
    folding = radius_table(lens(k={0: -1.5}), ideal)  # grows until r2 = 1 / 4.5, .471
    assert 20 < len(folding) < 25 and folding[-1, 1] < 0.472


@pytest.mark.parametrize("rows", [25, 26])
def test_a_table_of_25_rows_is_taken_as_it_is(rows: int) -> None:
    table = np.stack([np.linspace(0.0, 1000.0, rows), np.linspace(0.0, 30.0, rows)], axis=1)
    one = lens(LensKind.RADIAL_TABLE, table=table)
    found = radius_table(one, np.array([[0.2, 0.0]]))
    assert len(found) == 25
    last = [1000.0 / 1500.0, 1030.0 / 1500.0] if rows == 25 else [0.204 / 1.03, 0.204]
    assert_close("ratio", found[-1], last)


# Numbers of landmarks and frames on cards, from both sides of what their columns hold


NONE = np.zeros(0)


def marks(*names: str) -> Any:
    return SimpleNamespace(landmarks=LandmarkSet(names, NONE, NONE))


@pytest.mark.parametrize(
    ("names", "seen", "number", "kept"),
    [
        (("7", "99", "1"), [0, 1, 2], [7, 99, 1], True),
        (("7", "100", "1"), [0, 1, 2], [1, 2, 3], False),
        (("7", "100", "1"), [0, 2], [7, 0, 1], True),  # that of 100 is not seen
        (("7", "0", "1"), [0, 1, 2], [1, 2, 3], False),
        (("7", "b", "1"), [0, 2], [1, 0, 2], False),  # with b they have the numbers 1 and 3
        (("b", "c"), [1], [0, 1], False),
    ],
)
def test_landmarks_keep_numbers_from_1_to_99(
    names: tuple[str, ...], seen: list[int], number: list[int], kept: bool
) -> None:
    found, rows = landmark_numbers(marks(*names), np.array(seen))
    assert found.tolist() == number
    if kept:
        assert rows == []
    else:
        assert [tuple(row) for row in rows] == [("landmark", number[k], names[k]) for k in seen]


@pytest.mark.parametrize("count", [99, 100])
def test_99_landmarks_are_the_most(count: int) -> None:
    flight = marks(*(f"mark {k}" for k in range(150)))
    if count == 99:
        assert landmark_numbers(flight, np.arange(99))[0].tolist() == [*range(1, 100), *[0] * 51]
        return
    with refused(VopdError):
        landmark_numbers(flight, np.arange(100))


@pytest.mark.parametrize(
    ("own", "images", "frames", "number", "names"),
    [
        ([5, 0, 9999], (), [0, 1, 2], [5, 0, 9999], None),
        ([5, 0, 10000], (), [0, 1, 2], [1, 2, 3], ["5", "0", "10000"]),
        ([5, 0, 10000], (), [1, 0], [0, 5], None),
        ([5, -1, 3], (), [1, 2], [1, 2], ["-1", "3"]),
        ([0, 1, 2], ("a.jpg", "b.jpg", "c.jpg"), [2, 0], [1, 2], ["c.jpg", "a.jpg"]),
    ],
)
def test_frames_keep_numbers_from_0_to_9999(
    own: list[int], images: Any, frames: list[int], number: list[int], names: Any
) -> None:
    flight: Any = SimpleNamespace(frame=np.array(own), image_name=images)
    found, rows = frame_numbers(flight, np.array(frames))
    assert found.tolist() == number
    expected = [("frame", n, name) for n, name in zip(number, names or [], strict=False)]
    assert [tuple(row) for row in rows] == expected


@pytest.mark.parametrize("count", [9999, 10000])
def test_9999_frames_are_the_most(count: int) -> None:
    flight: Any = SimpleNamespace(frame=np.arange(count), image_name=())
    if count == 9999:
        assert frame_numbers(flight, np.arange(count))[1] == []
        return
    with refused(VopdError):
        frame_numbers(flight, np.arange(count))


@pytest.mark.parametrize(
    ("own", "time_s", "noted"),
    [
        ([2.0, 2.1, 7.5], [2.0, 2.1, 7.5], False),
        ([2.00000000049, 3.0], [2.0, 3.0], False),  # ten columns with sign and point
        ([2.0, 2.0, 3.0], [0.0, 1.0, 2.0], True),
        ([2.0, 1.0], [0.0, 1.0], True),
        ([2.0, np.nan], [0.0, 1.0], True),
        ([np.nan], [0.0], True),
        ([5.0], [5.0], False),
        ([1.7e9, 1.7e9 + 0.125, 1.7e9 + 2.5], [0.0, 0.125, 2.5], True),  # seconds of a Unix clock
    ],
)
def test_times_that_increase_are_those_of_the_frames(
    own: list[float], time_s: list[float], noted: bool
) -> None:
    flight: Any = SimpleNamespace(time_s=np.array([-99.0, *own]))
    found, notes = frame_times(flight, np.arange(1, len(own) + 1))
    assert found.tolist() == time_s
    assert len(notes) == noted
    if noted:
        assert_approved(notes)


# Numbers of a flight on cards, in the cards' units and columns, by hand


FT = 3.2808336  # of a metre, as the program of 1974 has it
PLAIN = re.sub("lens = .*", 'lens = { model = "brown", fx_px = 1500.0 }', TOML)
WIND = '[wind]\nfile = "wind.csv"\n'
STILL = (
    "[position]\nlat_deg = 47.6435\nlon_deg = 16.4759\nh_m = 540.0\n"
    "height = 'ellipsoid'\nsigma_m = 'exact'\n"
)


@pytest.mark.parametrize(
    ("inches", "text"),
    [
        (0.0, "0.00000"), (9.999994, "9.99999"), (9.999996, "10.0000"), (10.0, "10.0000"),
        (99.99994, "99.9999"), (99.99996, "100.000"), (-1e-7, "0.00000"), (-9.99994, "-9.9999"),
        (-9.99996, "-10.000"), (-99.9994, "-99.999"),
    ],
)  # fmt: skip
def test_a_reading_keeps_the_decimals_that_seven_columns_hold(inches: float, text: str) -> None:
    assert to_the_reader(np.array([inches])) == float(text)
    assert len(text) == 7


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1.23456789012, "1.23456789"), (12345.678949, "12345.6789"), (99999999.4, "99999999.4"),
        (9.999999999, "10.0"), (-1.23456789, "-1.2345679"), (-12345.678949, "-12345.679"),
        (0.123456789012, "0.12345679"), (0.0, "0"),
    ],
)  # fmt: skip
def test_a_number_keeps_the_digits_that_ten_columns_hold(value: float, text: str) -> None:
    assert to_ten_columns(np.array([value])) == float(text)


def job_of(folder: Path, toml: str, wind: str = "") -> Job:
    folder.mkdir(exist_ok=True)
    (folder / "wind.csv").write_text(wind)
    return flight_job(vopd.solve_flight(write_project(folder, toml)))[0]


def test_the_trajectory_is_in_feet_and_feet_a_second(tmp_path: Path) -> None:
    """Of the track: 20 m/s north, 5 east, 2 up; the first frame 80 m above the origin's height.

    The last frame is .4 s, 2 m east, 8 m north and .8 m up, later.
    """
    path = job_of(tmp_path, PLAIN).trajectory
    assert_close("flight time", path.time_s, [2.0, 2.1, 2.2, 2.3, 2.4])
    velocity = np.tile(np.array([20.0, 5.0, -2.0]) * FT, (5, 1))
    assert_close("motion on cards", path.velocity_ft_s, velocity)
    assert_close("cards of a flight", path.altitude_ft[0], (HEIGHT + 80.0) * FT)
    moved = path.position_ft[4] - path.position_ft[0]
    assert_close("motion on cards", moved, np.array([2.0, 8.0, 0.8]) * FT)
    assert_close("cards of a flight", path.position_ft[0, 2], (HEIGHT + 80.0) * FT)


def test_the_wind_is_that_of_the_frames_upward(tmp_path: Path) -> None:
    """By height: from the west, 10 m/s at 540 m, 20 at 541. Frame 0, with the first picks, has
    been left without; the four others are at 540.2, 540.4 ... m.
    """
    levels = "h_m,from_deg,speed_m_s\n540,270,10\n541,270,20\n"
    path = write_project(tmp_path, PLAIN + WIND)
    (tmp_path / "wind.csv").write_text(levels)
    rows = (tmp_path / "picks.csv").read_text().splitlines()
    few = [rows[0], *(row for row in rows[1:] if not row.startswith("0,")), "0,mast,5,5"]
    (tmp_path / "picks.csv").write_text("\n".join(few))
    wind = flight_job(vopd.solve_flight(path))[0].wind
    assert_close("cards of a flight", wind.altitude_ft, np.array([540.2, 540.4, 540.6, 540.8]) * FT)
    east = np.array([12.0, 14.0, 16.0, 18.0]) * FT
    assert_close("ratio", wind.velocity_ft_s[:, 0], 0.0)
    assert_close("wind on cards", wind.velocity_ft_s[:, 1], east)


def test_landmarks_are_in_degrees_minutes_and_feet(tmp_path: Path) -> None:
    """West and south have the sign in both, as cards have it: -16.4 is -16 and -24."""
    path = write_project(tmp_path, PLAIN.split("[track]")[0] + STILL.replace("16.4759", "-16.4"))
    rows = [f"{name},47.65,-16.4,{400 + 10 * k}" for k, name in enumerate(MARKS)]
    (tmp_path / "landmarks.csv").write_text("\n".join(["landmark,lat_deg,lon_deg,h_m", *rows]))
    flight = read_flight(str(path))
    marks = card_landmarks(flight, np.array([1, 3]), np.array([0, 7, 0, 9, 0, 0]))
    assert marks.number.tolist() == [7, 9]
    assert marks.longitude_deg.tolist() == [-16, -16] and marks.latitude_deg.tolist() == [47, 47]
    assert_close("cards of a flight", marks.longitude_min, -24.0)
    assert_close("cards of a flight", marks.latitude_min, 39.0)
    assert_close("cards of a flight", marks.altitude_ft, np.array([410.0, 430.0]) * FT)


@pytest.mark.parametrize("turn", [0.0, 30.0, -150.2])
def test_a_turn_about_the_view_is_group_3(turn: float, tmp_path: Path) -> None:
    """The vehicle's roll is the camera's less the turn."""
    job = job_of(tmp_path, PLAIN + f"[vehicle]\nmount = {{ ypr_deg = [0, 0, {turn}] }}\n")
    assert job.camera.multiplier.tolist() == [1.0, 1.0, 1.0]
    assert job.camera.offset_deg.tolist() == [0.0, 0.0, -turn]


ALWAYS = {"altitudes are above the ellipsoid"}
NOTES = {
    "nothing": "",
    "refraction": '[atmosphere]\nrefraction = "standard"\n',
    "constant refraction": "[atmosphere]\nrefraction = { k = 0.1 }\n",
    "a date": "[flight]\nepoch = 2026-05-01T11:58:42Z\n",
    "an arm": "lever_arm_m = [0.1, 0, 0]\n",
    "no arm": "lever_arm_m = [0, 0, 0]\n",
    "a loss": '[solve]\nloss = "cauchy"\n',
    "a mount": '[vehicle]\nmount = "down"\n',
    "a turn": "[vehicle]\nmount = { ypr_deg = [0, 0, 5] }\n",
    "a turn of more digits": "[vehicle]\nmount = { ypr_deg = [0, 0, -150.25] }\n",
    "sigmas of the path": "sigma_m = 0.5\n",
    "of the time": "sigma_t_s = 0.5\n",
    "none": "sigma_m = 0\n",
    "a free offset": 'offset_s = 0.05\nsigma_bias_m = 2.0\n[solve]\nfree = ["track-offset"]\n',
}


@pytest.mark.parametrize("name", NOTES)
def test_what_cards_do_not_hold_is_said_and_nothing_else(name: str, tmp_path: Path) -> None:
    more = NOTES[name]
    toml = PLAIN.replace("epoch = 2026-05-01T11:58:42Z\n", "")
    if more.startswith("[flight]"):
        toml, more = PLAIN, ""
    off = "" if "refraction" in more else '[atmosphere]\nrefraction = "off"\n'
    key = more.partition(" = ")[0]
    if key.startswith("sigma"):  # those of the track stand last
        toml = toml.replace(f'\n{key} = "exact"', "")
        toml = toml.replace(
            "[track]", 'sigma_m = "exact"\n[track]' if key == "sigma_m" else "[track]"
        )
    assert_approved(flight_job(vopd.solve_flight(write_project(tmp_path, toml + more + off)))[2])


def test_notes_about_frames_and_picks_have_their_numbers(tmp_path: Path) -> None:
    """Two of five frames have one pick; a pick has another standard deviation; no velocity."""
    off = '[atmosphere]\nrefraction = "off"\n'
    toml = PLAIN.replace("epoch = 2026-05-01T11:58:42Z\n", "").split("[track]")[0] + STILL + off
    path = write_project(tmp_path, toml)
    head, *rows = (tmp_path / "picks.csv").read_text().splitlines()
    kept = [row for row in rows if row[0] not in "12" or "mast" in row]
    texts = [f"{head},sigma_px", *(f"{row},{0.5 if k else 1.0}" for k, row in enumerate(kept))]
    (tmp_path / "picks.csv").write_text("\n".join(texts))
    assert_approved(flight_job(vopd.solve_flight(path))[2], parts=["2 of 5", 2])


def test_the_command_says_the_notes(tmp_path: Path) -> None:
    path = write_project(tmp_path, PLAIN)
    ran = run("punch", path, "-o", tmp_path / "deck.dat")
    assert_approved([line for line in ran.stderr.splitlines() if "on the cards" in line])
