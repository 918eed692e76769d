"""Rolling shutter: rows and their times, turning rates, and picks shifted to their frame's time."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.approved.texts import assert_approved, refused
from tests.kit.clicked_flights import clicked_flight, with_rows
from tests.kit.flight_project import TOML, write_project
from tests.tolerances import assert_close, within
from vopd.arrays import Floats
from vopd.findings import VopdError
from vopd.flight.flight import CameraPath, Flight, LandmarkSet, Picks, Refraction, Shutter
from vopd.flight.result import FlightResult, solve_flight
from vopd.flight.solve import readout
from vopd.flight.solve.readout import (
    picks_at_frame_times,
    readout_findings,
    row_parts,
    turning_rates,
)
from vopd.flight.solve.rotations import solve
from vopd.geometry.earth import NED_FROM_ENU, earth_centred_m, local_axes
from vopd.geometry.lenses import Lens, LensKind

WIDE, HIGH, FOCAL = 4001, 3001, 3000.0
CENTRE = np.array([2000.0, 1500.0])
LENS = Lens(LensKind.BROWN, (WIDE, HIGH), np.array([FOCAL, FOCAL]), CENTRE, np.zeros(12))
ORIGIN = earth_centred_m(47.0, 8.0, 400.0)
AXES = local_axes(ORIGIN)
DOWNWARD = Rotation.from_euler("x", 150.0, degrees=True)  # 30 degrees from the nadir


def flight_of(
    pixel: Floats, frame: Floats, landmark: Floats, marks: Floats, time_s: Floats, speed: Floats,
    shutter: Shutter | None,
) -> Flight:  # fmt: skip
    """A camera that moves evenly, north, above landmarks east, north, up of an origin."""
    frames = len(time_s)
    camera = ORIGIN + (time_s[:, None] * speed) @ AXES
    return Flight(
        "turning", "turning.toml", LENS, np.arange(frames), (), time_s, None,
        Picks(frame, landmark, pixel, np.ones(len(pixel))),
        LandmarkSet(tuple(map(str, range(len(marks)))), ORIGIN + marks @ AXES, 0.0 * marks),
        CameraPath(
            camera, np.full(3, np.nan), velocity_m_s=np.tile(speed @ NED_FROM_ENU.T, (frames, 1))
        ),
        np.eye(3), Refraction(0.0, False), shutter=shutter,
    )  # fmt: skip


def seen_by_rows(
    rate_rad_s: Floats, speed: Floats, shutter: Shutter, frames: int = 7
) -> tuple[Flight, Floats]:
    """Picks of a camera that turns about its own axes while its rows are read, and the attitudes.

    Every pick is where the landmark's image meets the row that is being read.
    """
    rng = np.random.default_rng(1)
    time_s = np.arange(frames) / 30.0
    marks = np.stack([rng.uniform(-20, 20, 8), rng.uniform(-70, -30, 8), -np.full(8, 100.0)], 1)
    true, pixels = [], []
    for t in time_s:
        at = DOWNWARD.inv() * Rotation.from_rotvec(rate_rad_s * t).inv()
        true.append(at.inv().as_matrix())
        pixel = np.tile(CENTRE, (8, 1))
        for _ in range(30):
            axis = int(shutter.way in ("down", "up"))
            part = pixel[:, axis] / (HIGH - 1.0 if axis else WIDE - 1.0)
            part = 1.0 - part if shutter.way in ("up", "left") else part
            late = (part - 0.5 * shutter.middle) * shutter.readout_s
            turned = Rotation.from_rotvec(rate_rad_s * (t + late)[:, None]) * DOWNWARD
            ray = turned.apply(marks - (t + late)[:, None] * speed)
            pixel = CENTRE + FOCAL * ray[:, :2] / ray[:, 2:]
        pixels.append(pixel)
    frame, landmark = np.repeat(np.arange(frames), 8), np.tile(np.arange(8), frames)
    flight = flight_of(np.concatenate(pixels), frame, landmark, marks, time_s, speed, shutter)
    return flight, np.array(true)


def off_deg(flight: Flight, rotation: Floats, true: Floats) -> Floats:
    """Angles between solved and true attitudes, the local axes of the camera taken off (F,)."""
    own = rotation @ local_axes(flight.path.position_m) @ AXES.T
    return np.asarray(np.degrees(Rotation.from_matrix(own @ true.swapaxes(1, 2)).magnitude()))


@pytest.mark.parametrize(
    ("way", "middle", "expected"),
    [
        ("down", False, [0.0, 1.0, 0.25]), ("up", False, [1.0, 0.0, 0.75]),
        ("right", False, [0.5, 0.0, 1.0]), ("left", False, [0.5, 1.0, 0.0]),
        ("down", True, [-0.5, 0.5, -0.25]), ("left", True, [0.0, 0.5, -0.5]),
    ],
)  # fmt: skip
def test_parts_of_the_readout(way: str, middle: bool, expected: list[float]) -> None:
    """Of 4001 x 3001 pixels: the first row, the last, and a quarter of the way."""
    pixel = np.array([[2000.0, 0.0], [0.0, 3000.0], [4000.0, 750.0]])
    none = np.zeros(3, np.int64)
    flight = flight_of(
        pixel, none, none, np.zeros((1, 3)), np.zeros(1), np.zeros(3), Shutter(0.016, way, middle)
    )
    assert_close("table value", row_parts(flight), expected)


RATE = np.radians([0.0, 0.0, 20.0])  # about the camera's forward axis


def test_eight_milliseconds_at_twenty_degrees_a_second() -> None:
    """A frame's time 8 ms off, of the first row and not of the middle one, is .16 degree."""
    flight, true = seen_by_rows(RATE, np.zeros(3), Shutter(0.016, "down", False))
    wrong = replace(flight, shutter=Shutter(0.016, "down", True))
    shifted = picks_at_frame_times(wrong, solve(wrong))
    shifted = picks_at_frame_times(wrong, solve(shifted))
    off = off_deg(flight, solve(shifted).attitudes.rotation, true)
    assert_close("turn of a readout", off, np.full(7, 0.16))


@pytest.mark.parametrize("way", ["down", "up", "right", "left"])
@pytest.mark.parametrize("middle", [False, True])
def test_two_rounds_are_enough(way: str, middle: bool) -> None:
    """Turning 27 degrees a second about all axes, 15 m/s: errors after no, one, two, three rounds.

    Without a round they are .1 to .8 degree, after one .001 to .008, after two 2E-5 to 4E-4.
    """
    rate, speed = np.radians([15.0, -10.0, 20.0]), np.array([0.0, 15.0, 0.0])
    flight, true = seen_by_rows(rate, speed, Shutter(0.016, way, middle))
    solved = solve(flight)
    off = [off_deg(flight, solved.attitudes.rotation, true).max()]
    for _ in range(3):
        shifted = picks_at_frame_times(flight, solved)
        solved = solve(shifted)
        off.append(off_deg(flight, solved.attitudes.rotation, true).max())
        assert shifted.path.turning_rad_s is not None
        assert np.isfinite(shifted.path.turning_rad_s).all()
    assert off[0] > 0.05 and off[1] < 0.1 * off[0]
    assert off[2] < within("turn of a readout") and off[3] < off[2]


def test_turning_rates_by_hand() -> None:
    """20 degrees a second, a frame lost in between, another by itself, one without an attitude."""
    number = np.array([0, 1, 2, 4, 8, 9])
    time_s = number / 10.0
    rotation = Rotation.from_rotvec(RATE * time_s[:, None]).as_matrix()
    rotation[5] = np.nan
    flight, _ = seen_by_rows(RATE, np.zeros(3), Shutter(0.016, "down", False), 6)
    flight = replace(flight, frame=number, time_s=time_s)
    found, changes = turning_rates(flight, rotation)
    assert changes is None
    assert_close("flight turn", found[:4], np.tile(RATE, (4, 1)))
    assert np.isnan(found[4:]).all()


def test_a_tracked_flight_follows_shake() -> None:
    """A tenth of a degree at 7.5 Hz, thirty frames a second; a frame is missing in the middle."""
    flight = clicked_flight(np.random.default_rng(1), frames=40).flight
    axis, wave = np.array([0.6, 0.0, 0.8]) * np.radians(0.1), 2.0 * np.pi * 7.5
    angle = np.sin(wave * flight.time_s)[:, None] * axis
    rotation = Rotation.from_rotvec(angle).as_matrix()
    rates, changes = turning_rates(flight, rotation)
    assert changes is not None
    true = wave * np.cos(wave * flight.time_s)[:, None] * axis
    inner = slice(8, -8)
    assert_close("turning rate of shake", rates[inner], true[inner])
    assert_close("turning rate of shake", 0.008 * changes[inner], -0.008 * wave**2 * angle[inner])
    assert not changes[[0, -1]].any()
    rotation[20] = np.nan
    rates, changes = turning_rates(flight, rotation)
    assert changes is not None
    assert np.isnan(rates[20]).all()
    assert_close("turning rate of shake", rates[[9, 30]], true[[9, 30]])
    assert not changes[[19, 21]].any()  # two frames apart are not even


@pytest.mark.parametrize("ends", [(0.45, 0.9), (-0.3, 0.3)])
@pytest.mark.parametrize("most", [1, 2, 8])
def test_rates_of_a_readout_turn_as_far_as_the_frames_do(
    most: int, ends: tuple[float, float]
) -> None:
    """Of a turn s + 3 s^2 + [2 s^3] the rate is 1 and its change 6, [and what the cubic adds].

    2 s^3 at moments a and b is that of the rate -2 a b and the change 4 (a + b).
    """
    (one, other), s = ends, np.arange(-most, most + 1.0)
    weights = readout._weights(np.arange(-most, most + 1), one, other)
    assert_close("table value", weights @ (s + 3.0 * s**2), [1.0, 6.0])
    if most > 1:
        expected = [1.0 - 2.0 * one * other, 6.0 + 4.0 * (one + other)]
        assert_close("table value", weights @ (s + 3.0 * s**2 + 2.0 * s**3), expected)


def test_picks_that_are_equally_late_turn_their_frame_by_their_lateness() -> None:
    """Of unequal ones the turn lies between: no frame turns farther than its latest pick."""
    flight, _ = seen_by_rows(RATE, np.zeros(3), Shutter(0.016, "down", False))
    solved = solve(flight)
    late = row_parts(flight)
    even, uneven = readout._turns_until_read(solved, np.stack([np.full_like(late, 0.02), late]))
    assert_close("table value", even, np.tile(0.02 * np.eye(3), (7, 1, 1)))
    turns = np.linalg.eigvals(uneven)
    assert (turns.real > late.min()).all() and (turns.real < late.max()).all()


def test_a_frame_without_an_attitude_costs_no_other_its_turning_rate() -> None:
    """Also in the second round, whose rates are counted from those of the first."""
    one = clicked_flight(np.random.default_rng(1), frames=12)
    marks = np.array(one.rows.landmark)
    flight = with_rows(one.flight, one.rows.where((one.rows.frame != 6) | (marks == marks[0])))
    flight = shifted = replace(flight, shutter=Shutter(0.016, "down", False))
    for _ in range(2):
        solved = solve(shifted)
        assert np.flatnonzero(np.isnan(solved.attitudes.rotation[:, 0, 0])).tolist() == [6]
        shifted = picks_at_frame_times(flight, solved)
        rates = shifted.path.turning_rad_s
        assert rates is not None
        assert np.flatnonzero(np.isnan(rates).any(axis=1)).tolist() == [6]


def test_a_long_readout_of_a_tracked_flight_is_told() -> None:
    """24 and 22 ms of 33.3, and of clicks by hand none."""
    tracked = clicked_flight(np.random.default_rng(1), frames=9).flight
    (one,) = readout_findings(replace(tracked, shutter=Shutter(0.024, "down", False)))
    assert_approved(one.message)
    assert not readout_findings(replace(tracked, shutter=Shutter(0.022, "down", False)))
    assert not readout_findings(tracked)
    by_hand, _ = seen_by_rows(RATE, np.zeros(3), Shutter(0.03, "down", False))
    assert not readout_findings(by_hand)


def test_frames_half_a_second_apart_say_nothing_of_their_turning() -> None:
    flight, _ = seen_by_rows(RATE, np.zeros(3), Shutter(0.016, "down", False), 3)
    rotation = solve(flight).attitudes.rotation
    named = replace(flight, image_name=("a", "b", "c"), time_s=np.array([0.0, 2.0, 4.0]))
    assert np.isnan(turning_rates(named, rotation)[0]).all()
    for apart_s, known in ((0.6, False), (0.5, True), (-0.1, True)):  # or named backward
        one = replace(named, time_s=apart_s * np.arange(3.0))
        assert (np.isfinite(turning_rates(one, rotation)[0]) == known).all()
    unknown = replace(flight, time_s=np.full(3, np.nan))
    assert np.isnan(turning_rates(unknown, rotation)[0]).all()
    tenth = replace(flight, frame=10 * np.arange(3), time_s=np.arange(3) / 3.0, frame_rate_hz=30.0)
    for name in ((), ("f00.png", "f10.png", "f20.png")):  # ten frames apart, by either name
        assert np.isnan(turning_rates(replace(tenth, image_name=name), rotation)[0]).all()
    shifted = picks_at_frame_times(named, solve(named))
    assert shifted.path.turning_rad_s is not None
    assert np.isnan(shifted.path.turning_rad_s).all()
    assert_close("flight pixel", shifted.picks.pixel, named.picks.pixel)  # it does not move


def test_tracked_frames_two_seconds_apart_are_not_shifted() -> None:
    one = clicked_flight(np.random.default_rng(1), frames=9).flight
    apart = replace(one, shutter=Shutter(0.016, "down", False), time_s=2.0 * np.arange(9.0))
    still = replace(apart, path=replace(apart.path, velocity_m_s=None))
    shifted = picks_at_frame_times(still, solve(still))
    assert shifted.path.turning_rad_s is not None
    assert np.isnan(shifted.path.turning_rad_s).all()
    assert_close("flight pixel", shifted.picks.pixel, still.picks.pixel)


def rolling(folder: Path, readout_ms: float, more: str = "") -> FlightResult:
    """A flight that turns by 10 degrees a second, its picks all of one time."""
    keys = f'readout_ms = {readout_ms}\nreadout = "down"\nframe_time = "first-row"\n[picks]\nfile'
    folder.mkdir(exist_ok=True)
    return solve_flight(
        str(write_project(folder, TOML.replace("[picks]\nfile", keys, 1) + more, noise_px=0.3))
    )


def test_the_readouts_sigma_is_what_another_readout_does(tmp_path: Path) -> None:
    """Angles with 18 ms less those with 16 ms, and the component of 2 ms; two solves of rows."""
    result = rolling(tmp_path / "a", 16.0, "[uncertainty]\nreadout_ms = 2.0\n")
    plain = solve_flight(str(write_project(tmp_path, noise_px=0.3)))
    moved = rolling(tmp_path / "b", 18.0).camera_deg - result.camera_deg
    found = result.history().uncertainty.components["readout"][:, :3]
    assert_close("turn of a readout", found, np.abs(moved))
    # 10 degrees a second about the vertical, 540 of 1080 rows: about half of .16 degree
    turned = np.abs(result.camera_deg - plain.camera_deg)[:, 0]
    assert (turned > 3.0 * found[:, 0]).all() and (turned < 0.16).all()
    assert not result.history().flags.raised["rate_unknown"].any()


def test_picks_of_a_rolling_shutter_are_shown_where_they_were_picked(tmp_path: Path) -> None:
    """And the computed places beside them: both are moved from their frame's time to their row's.

    At 10 degrees a second, .0349 px a millisecond, a last row of 16 ms is some 4 px away.
    """
    result = rolling(tmp_path, 16.0)
    scene_of = result.estimates.whole().scene
    assert scene_of is not None
    image = scene_of().image
    assert image is not None
    with (tmp_path / "picks.csv").open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["frame"] == "2"]
    view = image(2, "")
    picked = [[float(row["u_px"]), float(row["v_px"])] for row in rows]
    assert_close("pick moved by a shutter", view.pixel, picked)
    assert_close("residual of noisy picks", view.fitted, view.pixel)
    moved = view.fitted - view.computed[view.landmark]
    farthest_px = float(np.abs(moved).max())
    assert 1.0 < farthest_px < 8.0


@pytest.mark.parametrize(
    ("readout_ms", "said"),
    [(109.0, False), (111.0, True), (0.51, False), (0.016, True), (0.49, True)],
)
def test_a_readout_longer_than_a_frame_or_in_seconds_is_doubted(
    readout_ms: float, said: bool, tmp_path: Path
) -> None:
    result = rolling(tmp_path, readout_ms)
    found = [one.message for one in result.findings if one.message.startswith("[camera] readout")]
    assert len(found) == said
    assert_approved(found)


def test_every_third_frame_says_how_the_camera_turns() -> None:
    """Whatever the times are rounded by: 3 / 60 s are more from frame 9 to frame 12 than before."""
    flight, _ = seen_by_rows(RATE, np.zeros(3), Shutter(0.016, "down", False), 5)
    rotation = solve(flight).attitudes.rotation
    for start_s in (2.0, 7.1, 1e3):
        number = 3 * np.arange(5)
        third = replace(flight, frame=number, time_s=start_s + number / 60.0)
        for rate_hz in (60.0, None):
            assert np.isfinite(
                turning_rates(replace(third, frame_rate_hz=rate_hz), rotation)[0]
            ).all()


def test_a_readout_longer_than_a_frame_of_a_table_of_times_is_doubted(tmp_path: Path) -> None:
    keys = 'readout_ms = 111\nreadout = "down"\nframe_time = "middle"\n[picks]\nfile'
    rate = "frame_rate_hz = 10.0\nfirst_frame_t_s = 2.0\n"
    toml = TOML.replace("[picks]\nfile", keys, 1).replace(rate, 'times = "times.csv"\n')
    rows = "".join(f"{k},{2 + k / 10}\n" for k in range(5))
    (tmp_path / "times.csv").write_text(f"frame,t_s\n{rows}")
    found = solve_flight(write_project(tmp_path, toml)).findings
    assert_approved([one.message for one in found if one.message.startswith("[camera] readout")])


def test_a_frame_by_itself_has_no_turning_rate(tmp_path: Path) -> None:
    keys = 'readout_ms = 16\nreadout = "down"\nframe_time = "middle"\n[picks]\nfile'
    path = write_project(tmp_path, TOML.replace("[picks]\nfile", keys, 1))
    picks = (tmp_path / "picks.csv").read_text().splitlines()
    kept = [row for row in picks if not row.startswith(("1,", "2,", "3,", "4,"))]
    (tmp_path / "picks.csv").write_text("\n".join(kept) + "\n")
    flags = solve_flight(str(path)).history().flags
    assert flags.raised["rate_unknown"].tolist() == [True]


@pytest.mark.parametrize(
    "keys",
    ['readout = "down"', "readout_ms = 16", 'readout_ms = 16\nreadout = "down"', "readout_ms = 0",
     'readout_ms = 16\nreadout = "down"\nframe_time = "last-row"'],
)  # fmt: skip
def test_a_shutter_has_three_keys(keys: str, tmp_path: Path) -> None:
    path = write_project(tmp_path, TOML.replace("[picks]\nfile", f"{keys}\n[picks]\nfile", 1))
    with refused(VopdError):
        solve_flight(str(path))


def test_keys_of_a_shutter_are_told_with_the_errors_of_files(tmp_path: Path) -> None:
    path = write_project(
        tmp_path, TOML.replace("[picks]\nfile", "readout_ms = 16\n[picks]\nfile", 1)
    )
    (tmp_path / "picks.csv").write_text("frame,landmark,u_px,v_px\n0,church,here,1\n")
    with refused(VopdError):
        solve_flight(str(path))
