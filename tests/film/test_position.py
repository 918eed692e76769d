"""Positions of frames against geometry written apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.kit.jobs import case
from tests.tolerances import assert_close, within
from vopd.errata import fixes
from vopd.estimate import Vertical
from vopd.film import joined_jobs, position
from vopd.program.vopd import run
from vopd.synthetic import Plan
from vopd.synthetic.flight import make

SIZES = {  # half the major axis, km, and the flattening
    "wgs84": (6378.137, 1 / 298.257223563),
    "clarke1866": (6378.2064, 1 / 294.978698214),
    "international1924": (6378.388, 1 / 297),
}


def ecef_km(
    latitude_deg: float, longitude_deg: float, height_km: float, size: str = "wgs84"
) -> np.ndarray:
    """An ellipsoid by its textbook formula."""
    a, f = SIZES[size]
    e2 = f * (2 - f)
    s, c = np.sin(np.radians(latitude_deg)), np.cos(np.radians(latitude_deg))
    n = a / np.sqrt(1 - e2 * s * s)
    t = np.radians(longitude_deg)
    across = (n + height_km) * c
    return np.array([across * np.cos(t), across * np.sin(t), (n * (1 - e2) + height_km) * s])


def test_a_flight_above_its_origin_is_there() -> None:
    """Group 8's latitude and longitude come back on either Earth.

    On that of 1974 up leans by the .1765 degree between geodetic and geocentric
    latitude: 44 km up is 134 m south.
    """
    job = case(1)
    path = job.trajectory
    above = replace(job, trajectory=replace(path, position_ft=path.position_ft * [0.0, 0.0, 1.0]))
    for names, south_m in (((), 134.4), (("earth",), 0.0)):
        found = position(joined_jobs([run(above, fixes(*names))]))
        off_m = (path.origin_latitude_deg - found.latitude_deg[0]) * 110_900
        assert abs(off_m - south_m) < within("metres of a latitude")
        assert_close("longitude", found.longitude_deg[0], path.origin_longitude_deg)


def test_positions_by_a_flat_step_from_the_origin() -> None:
    """With the ellipsoid: origin, and feet east, north, up of it, by textbook geometry."""
    job = case(1)
    results = run(job, fixes("earth", "feet-per-km"))
    path = job.trajectory
    phi, theta = np.radians([path.origin_latitude_deg, path.origin_longitude_deg])
    sp, cp, st_, ct = np.sin(phi), np.cos(phi), np.sin(theta), np.cos(theta)
    axes = np.array([[-st_, ct, 0.0], [-sp * ct, -sp * st_, cp], [cp * ct, cp * st_, sp]])
    origin = ecef_km(path.origin_latitude_deg, path.origin_longitude_deg, 0.0)
    camera = origin + results.vehicle_ft[0] / 3280.8336 @ axes
    found = position(joined_jobs([results]))
    height = np.linalg.norm(camera) - np.linalg.norm(
        ecef_km(found.latitude_deg[0], found.longitude_deg[0], 0.0)
    )
    back = ecef_km(found.latitude_deg[0], found.longitude_deg[0], float(height))
    aside_km = np.linalg.norm(np.cross(back, camera)) / np.linalg.norm(camera)
    assert aside_km < within("position, km")
    north, east, down = found.north_east_down[0]
    assert np.abs(np.cross(north, east) - down).max() < within("rae element")
    assert_close("cosine of a small angle", down @ axes[2], -1.0)
    assert north[2] > 0.0 and abs(east[2]) < within("unit element")


def test_down_is_the_earth_s_centre_in_1974_and_the_normal_with_the_fix() -> None:
    job = case(1)
    plain, fixed = (position(joined_jobs([one])) for one in (run(job), run(job, fixes("earth"))))
    apart = np.degrees(np.arccos(plain.north_east_down[0, 2] @ fixed.north_east_down[0, 2]))
    assert_close("lean of the vertical", apart, 0.1765)
    assert_close("latitude on either Earth", plain.latitude_deg[0], fixed.latitude_deg[0])


def test_the_demo_s_positions() -> None:
    jobs, _ = make(Plan(frames=5, seed=1))
    found = position(joined_jobs([run(jobs[0])]))
    path = jobs[0].trajectory
    metres = 0.3048 * run(jobs[0]).vehicle_ft
    north = (found.latitude_deg - path.origin_latitude_deg) * 110_900  # a degree at 33 north
    leans = np.radians(0.1765) * metres[:, 2]  # up, as above
    assert_close("metres by a flat step", north, metres[:, 1] - leans)


@pytest.mark.parametrize("size", SIZES)
def test_latitude_and_down_are_those_of_the_ellipsoid_of_the_run(size: str) -> None:
    """The camera is put back by its latitude and longitude, at the height that fits."""
    job = case(1)
    results = run(job, fixes("earth", ellipsoid=size))
    path = job.trajectory
    phi, theta = np.radians([path.origin_latitude_deg, path.origin_longitude_deg])
    sp, cp, st_, ct = np.sin(phi), np.cos(phi), np.sin(theta), np.cos(theta)
    axes = np.array([[-st_, ct, 0.0], [-sp * ct, -sp * st_, cp], [cp * ct, cp * st_, sp]])
    origin = ecef_km(path.origin_latitude_deg, path.origin_longitude_deg, 0.0, size)
    camera = origin + results.vehicle_ft[0] / 3280.8336 @ axes
    found = position(joined_jobs([results]))
    latitude, longitude = found.latitude_deg[0], found.longitude_deg[0]
    foot = ecef_km(latitude, longitude, 0.0, size)
    down = (foot - camera) / np.linalg.norm(foot - camera)
    lean = np.degrees(np.linalg.norm(np.cross(found.north_east_down[0, 2], down)))
    assert_close("longitude", lean, 0.0)
    assert found.vertical is Vertical.GEODETIC
    geocentric = np.degrees(np.arctan2(camera[2], np.hypot(camera[0], camera[1])))
    assert_close("longitude", found.geocentric_latitude_deg[0], geocentric)
    assert_close("longitude", longitude, np.degrees(np.arctan2(camera[1], camera[0])))


def test_where_the_deck_s_own_coordinates_put_the_camera() -> None:
    """On the Earth of 1974, some metres east and north of the position; on WGS 84 nowhere else."""
    job = case(1)
    path = job.trajectory
    phi, theta = np.radians([path.origin_latitude_deg, path.origin_longitude_deg])
    sp, cp, st_, ct = np.sin(phi), np.cos(phi), np.sin(theta), np.cos(theta)
    axes = np.array([[-st_, ct, 0.0], [-sp * ct, -sp * st_, cp], [cp * ct, cp * st_, sp]])
    results = run(job)
    origin = ecef_km(path.origin_latitude_deg, path.origin_longitude_deg, 0.0)
    own = origin + results.vehicle_ft[0] / 3280.8336 @ axes
    found = position(joined_jobs([results]))
    assert found.vertical is Vertical.GEOCENTRIC
    height = np.linalg.norm(own) - np.linalg.norm(
        ecef_km(found.latitude_deg[0], found.longitude_deg[0], 0.0)
    )
    here = ecef_km(found.latitude_deg[0], found.longitude_deg[0], float(height))
    east = axes[0] @ (own - here) * 1000.0
    north = axes[1] @ (own - here) * 1000.0
    to_own = found.to_own_m
    assert to_own is not None
    assert np.hypot(east, north) > 10.0
    assert np.abs(to_own[0] - [east, north]).max() < within("metres of a latitude")
    fixed = position(joined_jobs([run(job, fixes("earth"))])).to_own_m
    assert fixed is not None and np.abs(fixed).max() < within("metres of a latitude")
