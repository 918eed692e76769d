"""A flight on cards whose landmarks are metres away: the decimals of their columns."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import vopd
from tests.approved.texts import assert_approved
from tests.kit.command import vopd as run
from tests.kit.flight_project import EAST_NORTH_UP, LENS, MARKS, TOML, local_to_camera
from tests.tolerances import assert_close, within
from vopd.convert import flight_to_deck
from vopd.convert.flight_to_deck import card_landmarks
from vopd.errata import fixes
from vopd.flight.project.read import read_flight
from vopd.geometry.earth import earth_centred_m, geodetic, local_axes
from vopd.geometry.lenses import project

SOUTH, WEST = -47.6435, -122.4759


def near_flight(folder: Path, nearer: float, height_m: float) -> Path:
    """A camera that stands, 80 m above marks some 400 m away, all of it that many times nearer."""
    position = ["[position]", f"lat_deg = {SOUTH}", f"lon_deg = {WEST}", f"h_m = {height_m}"]
    keys = ['height = "ellipsoid"', 'sigma_m = "exact"', "[atmosphere]"]
    text = [TOML.split("[track]")[0], *position, *keys, "refraction = { k = 0.0 }", ""]
    (folder / "flight.toml").write_text("\n".join(text))
    camera = earth_centred_m(SOUTH, WEST, height_m)
    enu = (EAST_NORTH_UP - [0.0, 0.0, 80.0]) / nearer
    where = geodetic(camera + enu @ local_axes(camera))
    rows = [
        f"{name},{a:.14f},{b:.14f},{h:.9f}" for name, a, b, h in zip(MARKS, *where, strict=True)
    ]
    (folder / "landmarks.csv").write_text("\n".join(["landmark,lat_deg,lon_deg,h_m", *rows]))
    pixel = project(LENS, enu @ local_to_camera(np.array([7.0, -12.0, 2.0])).T).pixel
    rows = [f"0,{name},{u:.9f},{v:.9f}" for name, (u, v) in zip(MARKS, pixel, strict=True)]
    (folder / "picks.csv").write_text("\n".join(["frame,landmark,u_px,v_px", *rows]))
    return folder / "flight.toml"


@pytest.mark.parametrize("nearer", [1.0, 30.0, 100.0])
def test_the_deck_has_the_angles_of_a_flight_near_its_landmarks(
    tmp_path: Path, nearer: float
) -> None:
    """Metres away, a minute of six decimals, .9 mm, would be .01 degree."""
    path = near_flight(tmp_path, nearer, 540.0)
    flight = vopd.solve_flight(path)
    told = run("punch", path, "-o", tmp_path / "deck.dat")
    assert told.status == 0 and "columns hold" not in told.stderr
    deck = vopd.run(vopd.read_deck(tmp_path / "deck.dat"), fixes("all"))
    assert np.abs(deck.camera_deg - flight.camera_deg).max() < within("angle by cards")


@pytest.mark.parametrize(("nearest_m", "step"), [(400.0, 1.0), (4.0, 0.01)])
def test_degrees_are_whole_where_minutes_have_decimals_enough(
    tmp_path: Path, nearest_m: float, step: float
) -> None:
    """-122.4759 is -122 and -28.554, or -122.47 and -.354; the signs are alike."""
    flight = read_flight(str(near_flight(tmp_path, 1.0, 540.0)))
    at = geodetic(flight.landmarks.position_m)
    marks = card_landmarks(flight, np.arange(6), np.arange(1, 7), np.full(6, nearest_m))
    for degrees, minutes, angle in (
        (marks.longitude_deg, marks.longitude_min, at.longitude_deg),
        (marks.latitude_deg, marks.latitude_min, at.latitude_deg),
    ):
        assert_close("ratio", degrees / step, np.round(degrees / step))
        assert (minutes <= 0.0).all() and (minutes > -60.0 * step).all()
        assert_close("coordinates on cards", degrees * 60.0 + minutes, angle * 60.0)


def test_what_the_columns_do_not_hold_is_told(tmp_path: Path) -> None:
    """At 31 km, 101,706 ft, feet have three decimals: .15 mm at most, and marks are 4 m away."""
    path = near_flight(tmp_path, 100.0, 31000.0)
    told = run("punch", path, "-o", tmp_path / "deck.dat")
    (line,) = [one for one in told.stderr.splitlines() if "columns hold" in one]
    assert_approved(line.partition(": ")[2])


def test_the_nearest_frame_of_a_landmark_counts_and_not_the_last() -> None:
    """By 100, 10 and no metres known of one landmark; of the other it is not on cards."""
    solved: Any = SimpleNamespace(camera_m=np.array([[0.0, 0, 90], [0, 0, 0], [np.nan] * 3]))
    marks = SimpleNamespace(position_m=np.array([[0.0, 0.0, 100.0], [0.0, 0.0, 50.0]]))
    picks = SimpleNamespace(landmark=np.array([0, 0, 0, 1]), frame=np.array([0, 1, 2, 0]))
    flight: Any = SimpleNamespace(landmarks=marks, picks=picks)
    held = np.array([True, True, True, False])
    nearest_m = flight_to_deck._nearest_m(solved, flight, held)
    assert nearest_m.tolist() == [10.0, np.inf]
