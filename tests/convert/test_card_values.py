"""Numbers of a flight on cards, in the cards' units and columns, by hand."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import vopd
from tests.kit.command import vopd as run
from tests.kit.flight_project import HEIGHT, MARKS, TOML, write_project
from tests.tolerances import assert_close
from vopd.convert.flight_to_deck import (
    _to_the_reader,
    card_landmarks,
    flight_job,
    frame_numbers,
    to_ten_columns,
)
from vopd.flight.read import read_flight
from vopd.flight.result import FlightResult
from vopd.job import Job

FT = 3.2808336  # of a metre, as the program of 1974 has it
PLAIN = re.sub("lens = .*", 'lens = { model = "brown", fx_px = 1500.0 }', TOML)
WIND = '[wind]\nfile = "wind.csv"\n'
STILL = "[position]\nlat_deg = 47.6435\nlon_deg = 16.4759\nh_m = 540.0\nheight = 'ellipsoid'\n"


@pytest.mark.parametrize(
    ("inches", "text"),
    [
        (0.0, "0.00000"), (9.999994, "9.99999"), (9.999996, "10.0000"), (10.0, "10.0000"),
        (99.99994, "99.9999"), (99.99996, "100.000"), (-1e-7, "0.00000"), (-9.99994, "-9.9999"),
        (-9.99996, "-10.000"), (-99.9994, "-99.999"),
    ],
)  # fmt: skip
def test_a_reading_keeps_the_decimals_that_seven_columns_hold(inches: float, text: str) -> None:
    assert _to_the_reader(np.array([inches])) == float(text)
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
    return flight_job(vopd.solve_flight(write_project(folder, toml))).job


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
    wind = flight_job(vopd.solve_flight(path)).job.wind
    assert_close("cards of a flight", wind.altitude_ft, np.array([540.2, 540.4, 540.6, 540.8]) * FT)
    east = np.array([12.0, 14.0, 16.0, 18.0]) * FT
    assert_close("ratio", wind.velocity_ft_s[:, 0], 0.0)
    assert_close("wind on cards", wind.velocity_ft_s[:, 1], east)


def test_landmarks_are_in_degrees_minutes_and_feet(tmp_path: Path) -> None:
    """West and south are whole degrees downward and minutes from there: -16.4 is -17 and 36."""
    path = write_project(tmp_path, PLAIN.split("[track]")[0] + STILL.replace("16.4759", "-16.4"))
    rows = [f"{name},47.65,-16.4,{400 + 10 * k}" for k, name in enumerate(MARKS)]
    (tmp_path / "landmarks.csv").write_text("\n".join(["landmark,lat_deg,lon_deg,h_m", *rows]))
    flight = read_flight(str(path))
    marks = card_landmarks(flight, np.array([1, 3]), np.array([0, 7, 0, 9, 0, 0]))
    assert marks.number.tolist() == [7, 9]
    assert marks.longitude_deg.tolist() == [-17, -17] and marks.latitude_deg.tolist() == [47, 47]
    assert_close("cards of a flight", marks.longitude_min, 36.0)
    assert_close("cards of a flight", marks.latitude_min, 39.0)
    assert_close("cards of a flight", marks.altitude_ft, np.array([410.0, 430.0]) * FT)


@pytest.mark.parametrize("last", [9999, 10000])
def test_frames_keep_numbers_of_four_columns(last: int, tmp_path: Path) -> None:
    path = write_project(tmp_path, PLAIN)
    text = (tmp_path / "picks.csv").read_text().replace("\n4,", f"\n{last},")
    (tmp_path / "picks.csv").write_text(text)
    number, rows = frame_numbers(read_flight(str(path)), np.arange(5))
    if last == 9999:
        assert number.tolist() == [0, 1, 2, 3, 9999] and rows == []
    else:
        assert number.tolist() == [1, 2, 3, 4, 5]
        assert [row.name for row in rows] == ["0", "1", "2", "3", "10000"]


@pytest.mark.parametrize("turn", [0, 30, -150])
def test_a_turn_about_the_view_is_group_3(turn: int, tmp_path: Path) -> None:
    """The vehicle's roll is the camera's less the turn."""
    job = job_of(tmp_path, PLAIN + f"[vehicle]\nmount = {{ ypr_deg = [0, 0, {turn}] }}\n")
    assert job.camera.multiplier.tolist() == [1.0, 1.0, 1.0]
    assert job.camera.offset_deg.tolist() == [0.0, 0.0, -turn]


ALWAYS = {"altitudes are above the ellipsoid"}
NOTES = {
    "nothing": ("", set()),
    "refraction": ('[atmosphere]\nrefraction = "standard"\n', {"refraction is taken off"}),
    "constant refraction": ("[atmosphere]\nrefraction = { k = 0.1 }\n", {"refraction is taken"}),
    "a date": ("[flight]\nepoch = 2026-05-01T11:58:42Z\n", {"the date of time zero"}),
    "an arm": ("lever_arm_m = [0.1, 0, 0]\n", {"the lever arm is applied"}),
    "no arm": ("lever_arm_m = [0, 0, 0]\n", set()),
    "a loss": ('[solve]\nloss = "cauchy"\n', {"the loss cauchy is not on"}),
    "a mount": ('[vehicle]\nmount = "down"\n', {"the camera's mount is not on"}),
    "a turn": ("[vehicle]\nmount = { ypr_deg = [0, 0, 5] }\n", set()),
    "sigmas of the path": ("sigma_m = 0.5\n", {"standard deviations of landmarks, positions"}),
    "of the time": ("sigma_t_s = 0.5\n", {"standard deviations of landmarks, positions"}),
    "none": ("sigma_m = 0\n", set()),
}


@pytest.mark.parametrize("name", NOTES)
def test_what_cards_do_not_hold_is_said_and_nothing_else(name: str, tmp_path: Path) -> None:
    more, said = NOTES[name]
    toml = PLAIN.replace("epoch = 2026-05-01T11:58:42Z\n", "")
    if more.startswith("[flight]"):
        toml, more = PLAIN, ""
    off = "" if "refraction" in more else '[atmosphere]\nrefraction = "off"\n'
    assert_said(vopd.solve_flight(write_project(tmp_path, toml + more + off)), said)


def assert_said(result: FlightResult, said: set[str]) -> None:
    """Each note begins with one of these, and none is missing."""
    left = said | ALWAYS
    for note in flight_job(result).notes:
        (found,) = [one for one in left if note.startswith(one)]
        left.remove(found)
    assert not left


def test_notes_about_frames_and_picks_have_their_numbers(tmp_path: Path) -> None:
    """Two of five frames have one pick; a pick has another standard deviation; no velocity."""
    off = '[atmosphere]\nrefraction = "off"\n'
    toml = PLAIN.replace("epoch = 2026-05-01T11:58:42Z\n", "").split("[track]")[0] + STILL + off
    path = write_project(tmp_path, toml)
    head, *rows = (tmp_path / "picks.csv").read_text().splitlines()
    kept = [row for row in rows if row[0] not in "12" or "mast" in row]
    texts = [f"{head},sigma_px", *(f"{row},{0.5 if k else 1.0}" for k, row in enumerate(kept))]
    (tmp_path / "picks.csv").write_text("\n".join(texts))
    said = {
        "2 of 5 frames have no attitude and are left out",
        "2 picks take no part and are left out",
        "picks of different standard deviations count alike",
        "the velocity is not known",
    }
    assert_said(vopd.solve_flight(path), said)


def test_the_command_says_the_notes(tmp_path: Path) -> None:
    path = write_project(tmp_path, PLAIN)
    ran = run("punch", path, "-o", tmp_path / "deck.dat")
    assert f"{path}: the date of time zero is not on the cards: give --epoch\n" in ran.stderr
