"""Velocities that a track has itself, and those of its positions."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit.flight_project import TOML, write_project
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.flight.flight import CameraPath, TrackFixes
from vopd.flight.formats.track import TrackRows
from vopd.flight.project.keys import Section
from vopd.flight.project.read import read_flight
from vopd.flight.project.stated import Notes
from vopd.flight.project.times import FrameTimes
from vopd.flight.project.track import doubts_of_leaps, doubts_of_own_velocities, path_by_image
from vopd.flight.project.velocity import doubts_of_velocities, off_line, velocities_alone
from vopd.geometry.earth import earth_centred_m

TIME_S = np.arange(8.0)
TRUE_M_S = np.array([30.0, -12.0, -4.0])
"""Toward the north, the west, and up."""
ELLIPSOID_M = 6_378_137.0


def path(step_s: float = 1.0) -> Floats:
    """On the equator, where a metre north is a turn by (1 - e^2) / a, and east by 1 / a."""
    north, east, down = TRUE_M_S[:, None] * TIME_S * step_s
    latitude = np.degrees(north / (ELLIPSOID_M * (1.0 - 0.00669437999)))
    return earth_centred_m(latitude, 20.0 + np.degrees(east / ELLIPSOID_M), -down)


def doubts(velocity_m_s: Floats | list[float], sigma_m_s: float = 0.1) -> list[str]:
    own = np.tile(np.asarray(velocity_m_s, float), (len(TIME_S), 1))
    return doubts_of_velocities("t.csv", TIME_S, path(), own, sigma_m_s)


def test_velocities_of_the_positions_are_not_told() -> None:
    """Within .3 m/s or four sigmas; half a metre a second, of 33, that no mistake explains."""
    assert not doubts(TRUE_M_S)
    assert not doubts(np.add(TRUE_M_S, [0.0, 0.28, 0.0]), 0.0)
    assert not doubts(np.add(TRUE_M_S, [0.0, 0.39, 0.0]))
    assert not doubts(np.add(TRUE_M_S, [0.0, 0.5, 0.0]))  # no mistake, and no contradiction


@pytest.mark.parametrize(
    "columns",
    [
        [-12.0, 30.0, -4.0],  # exchanged
        [-12.0, 30.0, 4.0],  # east, north, up
        [30.0, -12.0, 4.0],
        [30.0, 12.0, -4.0],
        [-30.0, -12.0, -4.0],
        [-30.0, 12.0, 4.0],
        [58.3153, -23.3261, -7.7754],  # knots
        [67.1081, -26.8432, -8.9477],  # mph
        [98.4252, -39.3701, -13.1234],  # ft/s
        [108.0, -43.2, -14.4],  # km/h
        [3000.0, -1200.0, -400.0],
        [30000.0, -12000.0, -4000.0],
        [0.0, 0.0, 0.0],
        [5.0, 5.0, 5.0],
    ],
)
def test_what_makes_velocities_agree_with_positions(columns: list[float]) -> None:
    assert_approved(doubts(columns))


def test_what_no_mistake_explains_is_told_from_half_the_speed_on() -> None:
    """Of 32.56 m/s: 16.2 and 16.4 m/s off, with no mistake that makes it a third."""
    assert not doubts(np.add(TRUE_M_S, [0.0, 0.0, -16.2]))
    assert doubts(np.add(TRUE_M_S, [0.0, 0.0, -16.4]))


def test_an_error_of_the_vertical_is_told_where_it_is_more_than_what_is_stated() -> None:
    """The other sign of 4 m/s is 8 m/s: two sigmas of 4, and more than four of 1.9."""
    assert doubts([30.0, -12.0, 4.0], 1.9) and not doubts([30.0, -12.0, 4.0], 4.0)


def test_a_leap_does_not_make_velocities_wrong_and_few_positions_tell_nothing() -> None:
    leaping = path()
    leaping[3] += 500.0
    own = np.tile(TRUE_M_S, (8, 1))
    assert not doubts_of_velocities("t.csv", TIME_S, leaping, own, 0.1)
    assert doubts_of_velocities("t.csv", TIME_S[:5], path()[:5], -own[:5], 0.1)
    assert not doubts_of_velocities("t.csv", TIME_S[:4], path()[:4], -own[:4], 0.1)


def test_one_velocity_that_its_positions_contradict_is_found() -> None:
    """By more than the speed, 32.56 m/s, and by more than 16 sigmas, which half of it must be."""

    def alone(row: int, off_m_s: float, sigma_m_s: float = 0.1, count: int = 8) -> list[float]:
        own = np.tile(TRUE_M_S, (count, 1))
        own[row, 1] += off_m_s
        found, by = velocities_alone(TIME_S[:count], path()[:count], own, sigma_m_s)
        return [*found.tolist(), *by.round(1).tolist()]

    assert alone(3, 33.0) == [3, 33.0] and alone(3, -1e5) == [3, 1e5] and not alone(3, 32.0)
    assert alone(3, 100.0, 6.2) == [3, 100.0] and not alone(3, 100.0, 6.3)
    for count in (4, 5, 6):
        assert alone(1, 50.0, count=count) == [1, 50.0]
        assert alone(count - 2, 100.0, 6.2, count) == [count - 2, 100.0]
        assert not alone(count - 2, 100.0, 6.3, count)
    assert not alone(1, 50.0, count=3)  # all of them may be off
    assert not alone(0, 1e5) and not alone(7, 1e5)  # of one step alone
    leaping = path()
    leaping[3] += 500.0
    assert not velocities_alone(TIME_S, leaping, np.tile(TRUE_M_S, (8, 1)), 0.1)[0].size
    swing = 30.0 * np.array([1.0, 0.0, -1.0, 0.0, 1.0, 0.0, -1.0, 0.0])[:, None] * TRUE_M_S
    assert not velocities_alone(TIME_S, path(), swing, 0.1)[0].size  # all contradict them


@pytest.mark.parametrize("order", [[0, 1, 2, 3, 4, 5, 6, 7], [3, 0, 7, 1, 6, 2, 5, 4]])
def test_a_track_of_images_is_told_the_same_whatever_the_order_of_its_rows(
    order: list[int],
) -> None:
    names, time_s, own = [f"{k}.jpg" for k in order], TIME_S[order], np.tile(-TRUE_M_S, (8, 1))
    rows = TrackRows(path()[order], False, None, "utc", time_s, "", names, own)
    section = Section("p.toml", "track", {"sigma_m": 0.0, "velocity_sigma_m_s": 0.1})
    times = FrameTimes(TIME_S, tuple(sorted(names)), None)
    found = path_by_image(section, rows, path()[order], times, time_s, Notes([], {}))
    assert doubts_of_own_velocities(rows, path()[order], found, "t.csv") == doubts(-TRUE_M_S)
    right = replace(rows, velocity_m_s=np.where(np.array(order)[:, None] == 4, own, -own))
    assert_approved(doubts_of_own_velocities(right, path()[order], found, "t.csv"))
    few, off = [k for k in order if k < 5], np.tile(TRUE_M_S, (5, 1))
    off[np.array(few) == 2] *= -3.0  # 4 times the speed off, 65 m/s in the median of four steps
    five = TrackRows(path()[few], False, None, "utc", TIME_S[few], "", [], off)
    assert_approved(doubts_of_own_velocities(five, path()[few], found, "t.csv"))
    leaping = path()
    leaping[5] += 500.0
    for whole in (True, False):  # rounded to whole seconds they tell neither
        one = replace(rows, whole_seconds=whole)
        said = doubts_of_leaps(one, leaping[order], None, "t.csv")
        assert ["5.jpg" in text for text in said] == [True] * (not whole)
        assert bool(doubts_of_own_velocities(one, path()[order], found, "t.csv")) != whole


@pytest.mark.parametrize(
    ("step_s", "sigma_m", "by", "told"),
    [
        (0.1, 1.0, [-1.0, -1.0, -1.0], False),  # 65 m/s off; four sigmas are 98 m/s
        (0.2, 1.0, [-1.0, -1.0, -1.0], True),  # 49 m/s
        (20.0, 10.0, [1.0, 1.0, -1.0], True),  # 8 m/s off; 4.9 m/s
    ],
)
def test_positions_tell_less_of_a_velocity_the_nearer_in_time_they_are(
    step_s: float, sigma_m: float, by: list[float], told: bool
) -> None:
    """The difference of two, over its step, is off by the root of 6 sigma in length."""
    positions, own = path(step_s), np.tile(TRUE_M_S * by, (8, 1))
    rows = TrackRows(positions, False, None, "utc", TIME_S * step_s, "", [], own)
    fixes = TrackFixes(np.zeros(8, int), np.ones((8, 2)), np.full((8, 3), sigma_m))
    one = CameraPath(positions, fixes, velocity_m_s=own)
    assert bool(doubts_of_own_velocities(rows, positions, one, "t.csv")) == told


@pytest.mark.parametrize("sign", ["", "-"])
def test_a_flight_is_warned(tmp_path: Path, sign: str) -> None:
    """The track's camera moves straight on: its mean velocity is that of each of its rows."""
    project = write_project(tmp_path, TOML + "velocity_sigma_m_s = 0.05\n")
    track = tmp_path / "track.csv"
    head, *rows = track.read_text().splitlines()
    first, last = (np.array(row.split(","), float) for row in (rows[0], rows[-1]))
    latitude, longitude, height = ((last - first) / (last[0] - first[0]))[1:]
    north, east = latitude * 111_190.0, longitude * 111_320.0 * np.cos(np.radians(first[1]))
    step = (last - first) / (last[0] - first[0])
    every = [last + k * step for k in (1.0, 2.0)]
    rows += [",".join(f"{one:.12f}" for one in row) for row in every]
    more = f"{sign}{north:.4f},{sign}{east:.4f},{sign}{-height:.4f}".replace("--", "")
    lines = [f"{head},vn_m_s,ve_m_s,vd_m_s", *(f"{row},{more}" for row in rows)]
    track.write_text("\n".join(lines) + "\n")
    found = [one.message for one in read_flight(str(project)).findings]
    assert len(found) == bool(sign)
    if sign:
        assert_approved(found)


def test_velocities_between_rows_are_uncertain_by_what_they_bend() -> None:
    """t^2 and rows each 2 s: the line between two rows is a (1 - a) dt^2 = 1 m/s above at a = 1/2.

    Three quarters of it at a = 1/4; nothing at a row, of a straight line, or of two rows. Six rows
    do not tell how second differences grow with their step, and twice the square is taken.
    """
    time_s = np.arange(0.0, 12.0, 2.0)
    bent = np.stack([time_s**2, 3.0 * time_s, 0.0 * time_s], axis=1)
    exact, at_s = np.zeros((6, 3)), np.array([4.0, 5.0, 6.5, 9.0])
    found = off_line(at_s, time_s, bent, exact)
    twice = np.sqrt([0.0, 2.0, 2.0 * 0.75**2, 2.0])
    assert_close("flight speed", found, np.outer(twice, [1.0, 0.0, 0.0]))
    # second differences are 8 m/s at each row, by 4 s^2, and those of noise 6 sigma^2
    sigma = np.full((6, 3), 0.5)
    less = np.sqrt(2.0 * (8.0**2 - 6.0 * 0.25) / 8.0**2)
    assert_close("flight speed", off_line(at_s, time_s, bent, sigma)[1, 0], less)
    assert not off_line(at_s, time_s, bent, sigma)[:, 1:].any()
    assert not off_line(np.array([1.0]), time_s[:2], bent[:2], exact[:2]).any()


def test_uneven_rows() -> None:
    """t^2 has the second derivative 2 whatever the steps: the middle of a gap of 4 s is 4 off."""
    time_s = np.array([0.0, 1.0, 5.0, 6.0])
    bent = np.repeat(time_s[:, None] ** 2, 3, axis=1)
    found = off_line(np.array([3.0]), time_s, bent, np.zeros((4, 3)))
    assert_close("flight speed", found, np.full((1, 3), 4.0 * np.sqrt(2.0)))


@pytest.mark.parametrize(("bent", "ratio"), [("slowly", 16.0), ("at random", 2.0)])
def test_how_second_differences_grow_with_their_step_says_how_velocities_bend(
    bent: str, ratio: float
) -> None:
    """In the middle of a gap: half of the second difference over half of the step of a second.

    Over two steps those of t^2 are 4 times as large, and those of a sum of random steps have twice
    the square; over half a step 4 times smaller, and half the square. The squares are those of the
    six rows about five gaps.
    """
    time_s = np.arange(4001.0)
    steps = np.random.default_rng(1).choice([-1.0, 1.0], 4001)
    one = time_s**2 if bent == "slowly" else np.cumsum(steps)
    found = off_line(np.array([2000.5]), time_s, np.tile(one[:, None], 3), np.zeros((4001, 3)))
    square = np.average(np.diff(one, 2)[1997:2003] ** 2, weights=[0.5, 1.0, 1.0, 1.0, 1.0, 0.5])
    two = one[4:] - 2.0 * one[2:-2] + one[:-4]
    drawn = np.clip((two**2).mean() / (np.diff(one, 2) ** 2).mean(), 2.0, 16.0)
    assert round(drawn) == ratio
    assert_close("flight speed", found[0], np.full(3, np.sqrt(square / drawn / 4.0)))


def drawn_velocity(kind: str, time_s: Floats, rng: np.random.Generator) -> Floats:
    """A velocity, three columns, each .1 s."""
    if kind == "bends slowly":
        period_s, by, begin = (
            rng.uniform(15.0, 60.0),
            rng.normal(0.0, 5.0, 3),
            rng.uniform(0.0, 6.3),
        )
        angle = 2.0 * np.pi * time_s[:, None] / period_s + begin + np.arange(3.0)
        return np.asarray(by * np.sin(angle))
    if kind == "white second derivative":
        return np.asarray(np.cumsum(np.cumsum(rng.normal(0.0, 0.03, (len(time_s), 3)), 0), 0))
    out, rate, speed, wanted = np.empty((len(time_s), 3)), *np.zeros((3, 3))
    for k in range(len(time_s)):  # a pilot who wants another speed each 8 s or so
        wanted = np.where(rng.random(3) < 1.0 / 80.0, rng.uniform(-10.0, 10.0, 3), wanted)
        rate = rate + 0.1 * (wanted - speed - 1.6 * rate)
        out[k] = speed = speed + 0.1 * rate
    return out


@pytest.mark.parametrize(
    ("kind", "least", "most"),
    [
        ("bends slowly", 0.95, 1.0),
        ("white second derivative", 0.90, 0.97),
        ("a pilot's", 0.93, 0.98),
    ],
)
def test_velocities_between_rows_are_within_what_is_said(
    kind: str, least: float, most: float
) -> None:
    """Rows each 2 or 5 s of two minutes, to .1 m/s: 200 tracks, 20 moments, three columns."""
    rng, within = np.random.default_rng(7), []
    time_s = np.arange(1201) / 10.0
    for k in range(200):
        true, rows = drawn_velocity(kind, time_s, rng), slice(None, None, (20, 50)[k % 2])
        row_s, read = time_s[rows], true[rows] + rng.normal(0.0, 0.1, true[rows].shape)
        at_s = rng.choice(time_s[time_s <= row_s[-1]], 20)
        line, here = (
            np.stack([np.interp(at_s, of_s, one) for one in columns.T], axis=1)
            for of_s, columns in ((row_s, read), (time_s, true))
        )
        sigma = np.hypot(off_line(at_s, row_s, read, np.full(read.shape, 0.1)), 0.1)
        within.append((np.abs(line - here) < 1.96 * sigma).mean())
    assert least < np.mean(within) < most


@pytest.mark.parametrize("stated", ["0.05", '"exact"'])
def test_a_flight_has_what_its_velocities_bend(tmp_path: Path, stated: str) -> None:
    """In its first frame the track's row is that of the frame; .1 s later its velocity bends."""
    project = write_project(tmp_path, TOML + f"velocity_sigma_m_s = {stated}\n")
    track = tmp_path / "track.csv"
    head, *rows = track.read_text().splitlines()
    lines = [f"{row},{20 + 8 * k**2},5,-2" for k, row in enumerate(rows)]
    track.write_text("\n".join([f"{head},vn_m_s,ve_m_s,vd_m_s", *lines]) + "\n")
    sigma_m_s = read_flight(str(project)).path.velocity_sigma_m_s
    if stated == '"exact"':
        assert sigma_m_s is None or not sigma_m_s.any()
        return
    assert sigma_m_s is not None
    assert_close("flight speed", sigma_m_s[0], [0.05] * 3)
    # second differences of 16 m/s less those of noise, 6 sigma^2, at a = .1: .09 / 2 of them, and
    # twice their square
    bent = 0.045 * np.sqrt(2.0 * (16.0**2 - 6.0 * 0.05**2))
    assert_close("flight speed", sigma_m_s[1], [np.hypot(bent, 0.05), 0.05, 0.05])
