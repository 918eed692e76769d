"""Flights of known attitudes with random errors, through the files of a project.

A pinhole camera that looks forward and down over WGS 84; the geometry is that of
`tests.kit.film_earths`, and nothing of the package is used to make the files.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tests.kit.coverage_count import Count, Solved, count
from tests.kit.film_earths import WGS84
from tests.kit.simulated_films import body_to_ned
from tests.kit.wgs84_film import ecef
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.uncertainty import uncertainty
from vopd.flight.result import FlightResult
from vopd.pipeline import solve_sources

Array = np.ndarray
FOCAL_PX, WIDE, HIGH = 1500.0, 1920, 1080
CAMERA_FROM_BODY = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
NED_FROM_ENU = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
FRAME_S = 0.5
EARTH_M = 6371e3

TOML = """\
[flight]
name = "simulated"
[camera]
image_size_px = [{wide}, {high}]
pixel_grid = "centre"
lens = {{ model = "brown", fx_px = {focal}, fy_px = {focal}, cx_px = 959.5, cy_px = 539.5, k = [] }}
[picks]
file = "picks.csv"
pixel_grid = "centre"
frame_rate_hz = 2.0
first_frame_t_s = 0.0
{sigma_px}[landmarks]
file = "landmarks.csv"
height = "ellipsoid"
sigma_m = {landmark_m}
[track]
file = "track.csv"
height = "ellipsoid"
sigma_m = {position_m}
sigma_t_s = {time_s}
[atmosphere]
refraction = "off"
[uncertainty]
focal_rel = {focal_rel}
"""


class FlightErrors(NamedTuple):
    """Standard deviations of what goes wrong in a flight, 0 for nothing."""

    pick_px: float = 0.0
    landmark_m: float = 0.0  # each landmark the same in the whole flight
    position_m: float = 0.0  # of every frame by itself
    time_s: float = 0.0  # one a flight
    focal_rel: float = 0.0  # one a flight


class FlightPlan(NamedTuple):
    """What flights to draw."""

    errors: FlightErrors
    landmarks: int = 4
    poor: bool = False  # the landmarks in a strip of 200 by 40 px
    jobs: int = 40
    frames: int = 30


class FlightRow(NamedTuple):
    """A configuration: the flights, and whether the sigma of the picks is stated."""

    name: str
    plan: FlightPlan
    reading: bool = False


def _plan(errors: FlightErrors, poor: bool = False) -> FlightPlan:
    common = errors.landmark_m or errors.time_s or errors.focal_rel
    return FlightPlan(errors, poor=poor, jobs=80 if common else 40, frames=12 if common else 50)


PICKS = FlightErrors(pick_px=0.8)
ALL = FlightErrors(0.8, 0.1, 0.3, 0.02, 5e-4)
FLIGHT_ROWS = (
    FlightRow("flight, picks .8 px", _plan(PICKS)),
    FlightRow("flight, picks .8 px, sigma_px stated", _plan(PICKS), reading=True),
    FlightRow("flight, picks .8 px, poor geometry", _plan(PICKS, poor=True)),
    FlightRow("flight, picks .4 px", _plan(FlightErrors(pick_px=0.4))),
    FlightRow("flight, picks 4 px", _plan(FlightErrors(pick_px=4.0))),
    FlightRow("flight, landmarks .2 m", _plan(PICKS._replace(landmark_m=0.2))),
    FlightRow("flight, positions .5 m", _plan(PICKS._replace(position_m=0.5))),
    FlightRow("flight, time .05 s", _plan(PICKS._replace(time_s=0.05))),
    FlightRow("flight, focal length .002", _plan(PICKS._replace(focal_rel=0.002))),
    FlightRow("flight, all together", _plan(ALL)),
    FlightRow("flight, all together, sigma_px stated", _plan(ALL), reading=True),
)


def flight_counted(row: FlightRow, landmarks: int, seed: int, jobs: int | None = None) -> Count:
    """Count a cell of the table; the truth of the angles of attack is not known.

    Args:
        row: the configuration
        landmarks: in a frame
        seed: of the random numbers
        jobs: how many flights, in the place of the row's
    """
    plan = row.plan._replace(landmarks=landmarks)
    rng = np.random.default_rng(seed)
    flights, truth = [], []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(jobs or plan.jobs):
            truth.append(write_flight(Path(folder), plan, rng, row.reading))
            flights.append(_solved(Path(folder) / "flight.toml"))
    return count(flights, np.array(truth))


def _solved(project: Path) -> Solved:
    result, _ = solve_sources([str(project)])
    assert isinstance(result, FlightResult), result
    return Solved(result.estimate, uncertainty(result.estimate, Sigmas()))


def write_flight(folder: Path, plan: FlightPlan, rng: np.random.Generator, stated: bool) -> Array:
    """Write the files of one flight.

    Args:
        folder: where to
        plan: what to draw
        rng: the random numbers
        stated: whether the sigma of the picks is stated

    Returns:
        The true angles (F, 9): yaw, pitch, roll of camera and vehicle, no angles of attack.
    """
    e, frames, count = plan.errors, plan.frames, plan.landmarks
    latitude, longitude = rng.uniform(-60.0, 60.0), rng.uniform(-179.0, 179.0)
    ground = np.asarray(ecef(latitude, longitude, 300.0))
    axes = WGS84.camera_axes(ground)
    base = np.array([rng.uniform(0.0, 360.0), rng.uniform(-60.0, -25.0), rng.uniform(-5.0, 5.0)])
    angles = base + rng.uniform(-3.0, 3.0, (frames, 3))
    time_s = FRAME_S * np.arange(frames)
    velocity = rng.normal(0.0, 3.0, 3) * [1.0, 1.0, 0.3]
    start = np.array([0.0, 0.0, rng.uniform(80.0, 120.0)])
    late = rng.normal(0.0, e.time_s)
    local = start + np.outer(time_s + late - time_s[-1] / 2.0, velocity)
    camera_m = ground + local @ axes
    to_camera = CAMERA_FROM_BODY @ body_to_ned(angles).swapaxes(-1, -2) @ NED_FROM_ENU
    marks_m = _landmarks(plan, rng, base, ground, axes, start)
    away = np.einsum("fij,flj->fli", WGS84.camera_axes(camera_m), marks_m - camera_m[:, None])
    x, y, z = np.moveaxis(np.einsum("fij,flj->fli", to_camera, away), -1, 0)
    focal = FOCAL_PX * (1.0 + rng.normal(0.0, e.focal_rel))
    pixel = np.stack([959.5 + focal * x / z, 539.5 + focal * y / z], axis=-1)
    assert (z > 0.0).all()
    pixel += rng.normal(0.0, e.pick_px, pixel.shape)
    stated_marks = marks_m + rng.normal(0.0, e.landmark_m, marks_m.shape)
    on_time = ground + (local - late * velocity) @ axes
    stated_camera = on_time + rng.normal(0.0, e.position_m, on_time.shape)
    _table(folder / "picks.csv", "frame,landmark,u_px,v_px", [
        (k, f"m{i}", *pixel[k, i]) for k in range(frames) for i in range(count)
    ])  # fmt: skip
    _table(folder / "landmarks.csv", "landmark,lat_deg,lon_deg,h_m", [
        (f"m{i}", *_geodetic(point)) for i, point in enumerate(stated_marks)
    ])  # fmt: skip
    _table(folder / "track.csv", "t_s,lat_deg,lon_deg,h_m", [
        (t, *_geodetic(point)) for t, point in zip(time_s, stated_camera, strict=True)
    ])  # fmt: skip
    text = TOML.format(
        wide=WIDE, high=HIGH, focal=FOCAL_PX, landmark_m=e.landmark_m, position_m=e.position_m,
        time_s=e.time_s, focal_rel=e.focal_rel,
        sigma_px=f"sigma_px = {e.pick_px}\n" if stated else "",
    )  # fmt: skip
    (folder / "flight.toml").write_text(text, encoding="utf-8")
    return np.hstack([angles, angles, np.full((frames, 3), np.nan)])


def _landmarks(
    plan: FlightPlan, rng: np.random.Generator, base: Array, ground: Array, axes: Array,
    start: Array,
) -> Array:  # fmt: skip
    """Landmarks (L, 3) near the ground, where the camera in the middle of the flight sees them."""
    n = plan.landmarks
    if plan.poor:
        along = np.linspace(-100.0, 100.0, n) + rng.uniform(-20.0, 20.0, n)
        image = np.stack([along, rng.uniform(-20.0, 20.0, n)], axis=1) + rng.uniform(
            -200.0, 200.0, 2
        )
    else:
        angle = 2 * np.pi * (np.arange(n) / n + rng.random()) + rng.uniform(-1.0, 1.0, n) / n
        image = np.stack([np.cos(angle), np.sin(angle)], axis=1) * rng.uniform(0.5, 0.9, (n, 1))
        image *= [WIDE / 2, HIGH / 2]
    rays = np.hstack([image / FOCAL_PX, np.ones((n, 1))])
    local = rays @ CAMERA_FROM_BODY @ body_to_ned(base[None])[0].T @ NED_FROM_ENU
    height = rng.uniform(0.0, 10.0, n)
    reach = (start[2] - height) / np.maximum(-local[:, 2], 0.15)
    return np.asarray(ground + (start + local * reach[:, None]) @ axes)


def _geodetic(point: Array) -> tuple[float, float, float]:
    latitude, longitude = WGS84.label(point)
    foot = np.asarray(ecef(latitude, longitude, 0.0))
    up = WGS84.camera_axes(point)[2]
    return float(latitude), float(longitude), float((point - foot) @ up)


def _table(path: Path, head: str, rows: list[tuple[object, ...]]) -> None:
    lines = [",".join(v if isinstance(v, str) else f"{v:.12g}" for v in row) for row in rows]
    path.write_text("\n".join([head, *lines, ""]), encoding="utf-8")
