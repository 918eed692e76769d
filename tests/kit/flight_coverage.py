"""How often the truth of simulated flights lies in what the attitude table states of them.

A flight is solved as a user solves it, from the files of its project, and all that is compared
are columns of its table. The configurations are the rows of the tables of docs/coverage.md.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.special import stdtr, stdtrit

import vopd
from tests.kit.coverage import VEHICLE, Count
from tests.kit.simulated_flights import (
    Errors,
    LensErrors,
    Plan,
    Triple,
    Truth,
    body_to_ned,
    ecef,
    local_axes,
    mean_angles_deg,
    turns_deg,
    write_flight,
)
from vopd.attitude.history import History
from vopd.attitude.table import TableArrays, table

Array = np.ndarray
ANGLES = (
    "camera_yaw", "camera_pitch", "camera_roll", "vehicle_yaw", "vehicle_pitch", "vehicle_roll",
    "alpha", "beta", "eta",
)  # fmt: skip
BODY_AXES = ("forward", "right", "down")
PLACE_95 = 1.959964
FREEDOM = np.geomspace(0.5, 1e9, 400)


class FlightRow(NamedTuple):
    """A configuration: the flights, and what of them is counted."""

    name: str
    plan: Plan
    columns: tuple[int, ...] = (2, 3, 4, 6, 8)  # numbers of landmarks in a frame
    parts: tuple[str, ...] = ("",)  # rows of a table: the classes of the frames, one after another
    attack: bool = False  # whether alpha, beta and eta are counted
    mean: bool = False  # whether the mean over a flight's frames is
    low: float = 0.93  # the share of truths inside 95 % intervals that is right
    high: float = 0.97


# Counting


def flight_counted(
    row: FlightRow, landmarks: int, seed: int, flights: int | None = None
) -> list[Count]:
    """Count a cell of the table, for each part of the row.

    Args:
        row: the configuration
        landmarks: in a frame
        seed: of the random numbers
        flights: how many, in the place of the row's
    """
    plan = row.plan._replace(landmarks=landmarks)
    rng = np.random.default_rng(seed)
    found, groups = [], []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(flights or plan.flights):
            truth = write_flight(Path(folder), plan, rng)
            found.append(_inside(Path(folder) / "flight.toml", truth, row))
            groups.append(truth.group)
    arrays = [np.stack(part) for part in zip(*found, strict=True)]
    lost = int(np.isnan(arrays[2][..., VEHICLE]).any(axis=-1).sum())
    group = np.stack(groups)[..., None]
    counts = []
    for k in range(len(row.parts)):
        counted = (group == k) | (len(row.parts) == 1)
        *frames, mean = arrays
        one, chance, wide, attitude, place = (np.where(counted, part, np.nan) for part in frames)
        counts.append(Count(one, chance, wide, attitude, mean, lost, place))
    return counts


def _inside(project: Path, truth: Truth, row: FlightRow) -> tuple[Array, ...]:
    """Solve a flight, and compare its table with the truth; NaN where nothing is compared.

    Returns:
        Angles inside one standard deviation, the probability of that, and angles inside the 95 %
        interval (F, 9), attitudes inside the ellipsoid (F, 1), places inside 95 % (F, 3), and
        mean angles inside 95 % (1, 3).
    """
    history = vopd.solve_flight(project).history()
    stated = table([history])
    error = np.abs((_columns(stated, "{}_deg") - truth.angles_deg + 180.0) % 360.0 - 180.0)
    if not row.attack:
        error[:, 6:] = np.nan
    sigma, half = _columns(stated, "sigma_{}_deg"), _columns(stated, "half_width_95_{}_deg")
    narrow, wide = (np.where(np.isnan(w + error), np.nan, error <= w) for w in (sigma, half))
    student = np.interp(-half / sigma, -stdtrit(FREEDOM, 0.975), FREEDOM)  # its degrees of freedom
    chance = np.where(np.isnan(narrow + half), np.nan, 2.0 * stdtr(student, 1.0) - 1.0)
    eta = truth.angles_deg[:, 8]
    within = (stated["eta_low_95_deg"] <= eta) & (eta <= stated["eta_high_95_deg"])
    wide[:, 8] = np.where(np.isnan(error[:, 8]), np.nan, within)
    mean = _mean_inside(history, truth) if row.mean else np.full((1, 3), np.nan)
    return narrow, chance, wide, _attitudes(stated, truth), _places(stated, truth), mean


def _columns(stated: TableArrays, name: str) -> Array:
    """Stack a column of each of the nine angles, (F, 9); eta has no half-width."""
    missing = np.full(len(stated["frame"]), np.nan)
    return np.stack([stated.get(name.format(angle), missing) for angle in ANGLES], axis=1)


def _attitudes(stated: TableArrays, truth: Truth) -> Array:
    """Whether the true attitudes are inside the ellipsoids of the covariance, (F, 1)."""
    found = body_to_ned(_columns(stated, "{}_deg")[:, VEHICLE])
    off = turns_deg(found.swapaxes(-1, -2) @ body_to_ned(truth.angles_deg[:, VEHICLE]))
    spread = np.empty((len(off), 3, 3))
    for i, a in enumerate(BODY_AXES):
        for j, b in enumerate(BODY_AXES[i:], i):
            spread[:, i, j] = spread[:, j, i] = stated[f"covariance_{a}_{b}_deg2"]
    known = np.isfinite(off + spread.sum(axis=2)).all(axis=1)
    spread[~known] = np.eye(3)
    square = np.einsum("fi,fi->f", off, np.linalg.solve(spread, off[..., None])[..., 0])
    return np.where(known, square <= stated["covariance_factor_95"], np.nan)[:, None]


def _places(stated: TableArrays, truth: Truth) -> Array:
    """Whether east, north and up of the true places are inside 95 % of the solved ones, (F, 3)."""
    if "sigma_east_m" not in stated:
        return np.full((len(stated["frame"]), 3), np.nan)
    latitude, longitude = (np.radians(stated[f"{n}_deg"]) for n in ("latitude", "longitude"))
    place = ecef(latitude, longitude, stated["altitude_m"])
    off = np.einsum("fij,fj->fi", local_axes(place), truth.place_m - place)
    sigma = np.stack([stated[f"sigma_{axis}_m"] for axis in ("east", "north", "up")], axis=1)
    known = np.isfinite(off) & (sigma > 0.0)
    return np.where(known, np.abs(off) <= PLACE_95 * sigma, np.nan)


def _mean_inside(history: History, truth: Truth) -> Array:
    """Whether yaw, pitch, roll of the mean attitude are inside their 95 % intervals, (1, 3)."""
    stated = history.mean()
    off = stated.vehicle_deg - mean_angles_deg(truth.angles_deg[:, VEHICLE])
    inside = np.abs((off + 180.0) % 360.0 - 180.0) <= stated.half_width_95[VEHICLE]
    return inside.astype(float)[None]


# Rows: errors are of picks of 1 px, stated, unless the name says otherwise

PICKS = Errors(pick_px=0.8)
ALL = Errors(0.8, (0.1,), ((0.3, 0.3, 0.3),), clock_s=0.02, lens=LensErrors(focal_rel=5e-4))
GPS: Triple = (2.0, 2.0, 4.0)
FIX: Triple = (0.02, 0.02, 0.02)
FLOAT: Triple = (2.0, 2.0, 2.0)
RTK = Errors(1.0, fix_m=(FIX,))
CONSUMER = Errors(1.0, fix_m=(GPS,))
BIASED = Errors(1.0, fix_m=((0.5, 0.5, 1.0),), bias_m=GPS)
MANY = {"flights": 1000, "frames": 6}  # where an error is common to a flight
ONE = {"flights": 1000, "frames": 1, "stands": True}
DRONE = Plan(CONSUMER, flights=200, frames=10, height_m=(300.0, 660.0), sigma_px=True)
FILM = Plan(CONSUMER, flights=1000, frames=90, frame_hz=30.0, fix_hz=1.0, jitter_deg=1.0,
            sigma_px=True)  # fmt: skip
STANDS = Plan(Errors(1.0, (0.1,), bias_m=(0.3, 0.3, 0.3)), flights=1000, frames=100, stands=True,
              sigma_px=True)  # fmt: skip
STILL = Errors(1.0, bias_m=(0.3, 0.3, 0.3))
AHEAD = Plan(RTK, flights=200, frames=30, frame_hz=10.0, fix_hz=5.0, ahead=True, speed_m_s=10.0,
             pitch_deg=(-25.0, -10.0), sigma_px=True)  # fmt: skip
TELE = Plan(
    Errors(1.0, refraction=0.5), **MANY, sigma_px=True, refraction=0.13, focal_px=20000.0,
    pitch_deg=(-5.0, -3.0), height_m=(4e3, 5e3), distance_m=(20e3, 40e3), jitter_deg=0.3,
)  # fmt: skip
FISHEYE = {"fisheye": True, "focal_px": 700.0, "distortion": (0.05, -0.01)}


def _lens(**sigmas: float) -> Plan:
    plan = Plan(Errors(1.0, lens=LensErrors(**sigmas)), **MANY, sigma_px=True)
    return plan._replace(distortion=(-0.1, 0.02))


FLIGHT_ROWS = (
    FlightRow("picks .8 px", Plan(PICKS)),
    FlightRow("picks .8 px, sigma_px stated", Plan(PICKS, sigma_px=True)),
    FlightRow("picks .8 px, poor geometry", Plan(PICKS, poor=True)),
    FlightRow("picks .4 px", Plan(Errors(0.4))),
    FlightRow("picks 4 px", Plan(Errors(4.0))),
    FlightRow("picks .8 px, one frame", Plan(PICKS, **ONE)),
    FlightRow("picks .8 px, one frame, sigma_px stated", Plan(PICKS, **ONE, sigma_px=True)),
    FlightRow("landmarks .2 m", Plan(PICKS._replace(landmark_m=(0.2,)), **MANY)),
    FlightRow("positions .5 m", Plan(PICKS._replace(fix_m=((0.5, 0.5, 0.5),)))),
    FlightRow("clock .05 s", Plan(PICKS._replace(clock_s=0.05), **MANY)),
    FlightRow("focal length .002", _lens(focal_rel=0.002)),
    FlightRow("principal point 3 px", _lens(u_px=3.0, v_px=3.0)),
    FlightRow("k1 .005, k2 .005", _lens(k1=0.005, k2=0.005)),
    FlightRow("all together", Plan(ALL, **MANY)),
    FlightRow("all together, sigma_px stated", Plan(ALL, **MANY, sigma_px=True)),
    FlightRow("consumer GPS 2, 2, 4 m", DRONE),
    FlightRow("consumer GPS, sigma_px not stated", DRONE._replace(sigma_px=False)),
    FlightRow("consumer GPS, fisheye", DRONE._replace(**FISHEYE, height_m=(80.0, 120.0))),
    FlightRow("consumer GPS, one frame",
              DRONE._replace(errors=Errors(1.0, bias_m=GPS), **ONE)),
    FlightRow("consumer GPS .5, .5, 1 m with a bias of 2, 2, 4 m",
              DRONE._replace(errors=BIASED, **MANY), mean=True),
    FlightRow("consumer GPS stated a third", DRONE._replace(stated=1 / 3), low=0.0, high=1.0),
    FlightRow("consumer GPS stated three times", DRONE._replace(stated=3.0), high=1.0),
    FlightRow("1-Hz track of 2, 2, 4 m, 30 frames a second", FILM, (3, 4, 6), mean=True),
    FlightRow("5-Hz track of 2, 2, 4 m, 30 frames a second",
              FILM._replace(fix_hz=5.0), (3, 4, 6), mean=True),
    FlightRow("1-Hz track of .5, .5, 1 m with a bias of 2, 2, 4 m",
              FILM._replace(errors=BIASED), (3, 4, 6), mean=True),
    FlightRow("RTK by column", DRONE._replace(errors=Errors(1.0, fix_m=(FIX, FLOAT))),
              parts=("fix .02 m", "float 2 m")),
    FlightRow("landmarks by column, each frame its own",
              DRONE._replace(errors=Errors(1.0, (0.05, 2.0), (FIX,)), own=True),
              parts=("good ones .05 m", "bad ones 2 m")),
    FlightRow("landmarks of .05 and 2 m by column",
              DRONE._replace(errors=Errors(1.0, (0.05, 2.0), (FIX,)), **MANY)),
    FlightRow("camera that stands .3 m, landmarks .1 m", STANDS, (3, 4, 6), mean=True),
    FlightRow("camera that stands .3 m", STANDS._replace(errors=STILL), (3, 4, 6), mean=True),
    FlightRow("velocity by the track of .02 m, 5 Hz", AHEAD, (3, 6), attack=True),
    FlightRow("velocity by the track of .02 m, weaving",
              AHEAD._replace(weave_m=2.0, weave_s=6.0), (3, 6), attack=True),
    FlightRow("velocity by consumer GPS of 2, 2, 4 m, 5 Hz",
              AHEAD._replace(errors=CONSUMER), (3, 6), attack=True),
    FlightRow("velocity given .1 m/s",
              AHEAD._replace(errors=RTK._replace(velocity_m_s=0.1), velocity=True),
              (3, 6), attack=True),
    FlightRow("velocity given, bias of .1 m/s",
              AHEAD._replace(errors=RTK._replace(velocity_bias_m_s=0.1), velocity=True, **MANY),
              (3, 6), attack=True),
    FlightRow("wind 1 m/s",
              AHEAD._replace(errors=RTK._replace(wind_m_s=1.0), wind=True, **MANY),
              (3, 6), attack=True),
    FlightRow("1-Hz track of .02 m, weaving by 2 m in 6 s",
              FILM._replace(errors=RTK, weave_m=2.0, weave_s=6.0), (3, 4, 6), mean=True),
    FlightRow("1-Hz track of .02 m, weaving by 2 m in 3 s",
              FILM._replace(errors=RTK, weave_m=2.0, weave_s=3.0, flights=200), (3, 6), mean=True),
    FlightRow("1-Hz track that is exact, weaving by 2 m in 6 s",
              FILM._replace(errors=Errors(1.0), weave_m=2.0, weave_s=6.0, flights=200), (3, 6),
              mean=True),
    FlightRow("refraction of a telephoto lens, 20 to 40 km", TELE, (3, 6)),
    FlightRow("readout of 8 ms, turning to 8 degrees a second",
              FILM._replace(errors=RTK, readout_ms=8.0, swing_deg=5.0, jitter_deg=0.0,
                            flights=100), (3, 6)),
)  # fmt: skip
