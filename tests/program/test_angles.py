"""The vehicle's angles, its look-ups along the trajectory, and the deviation of the residuals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.kit.jobs import film
from tests.tolerances import assert_close
from vopd.job import Job
from vopd.landmark_layout import LandmarkLayout
from vopd.program.angles import air_angles, air_lookup, attitude, residual_deviation
from vopd.program.film_jobs import FilmJobs, film_jobs
from vopd.program.frames import FilmOrientation
from vopd.program.ftlup import TableNotANumber, TableOutOfOrder

NAN = np.nan


def mounted(frames: int, multiplier: tuple[float, ...], offset: tuple[float, ...]) -> Job:
    job = film(frames)
    camera = replace(
        job.camera, multiplier=np.array(multiplier, float), offset_deg=np.array(offset, float)
    )
    return replace(job, camera=camera)


def solve(jobs: FilmJobs, camera_deg: list[list[float]]) -> FilmOrientation:
    """A solve that ended at these angles (F, 3); no two of its numbers are equal."""
    frames, points = len(camera_deg), jobs.readings.layout.total
    return FilmOrientation(
        angles=np.array(camera_deg).T,
        eps=np.arange(2.0 * points).reshape(points, 2) + 0.25,
        next=np.full((3, frames), -99.0),
        correction=np.arange(3.0 * frames).reshape(3, frames) + 0.5,
        last_pass=np.arange(frames) + 3,
        singular=np.arange(frames) == 1,
    )


def vehicle(camera_deg: list[list[float]], *jobs: Job) -> list[list[float]]:
    together = film_jobs(jobs)
    frames, points = len(camera_deg), together.readings.layout.total
    none, every = np.zeros(frames, bool), np.ones(points, bool)
    done = solve(together, camera_deg)
    found = attitude(together, done, np.zeros((3, frames)), none, every).vehicle_deg
    return np.asarray(found).tolist()


@pytest.mark.parametrize(
    ("angle", "wrapped"),
    [
        (0.0, 0.0), (360.0, 360.0), (-0.25, 359.75), (360.25, 0.25), (180.5, 180.5),
        (720.0, 360.0), (720.5, 360.5), (-360.0, 0.0), (-360.25, -0.25),
    ],
)  # fmt: skip
@pytest.mark.parametrize("which", [0, 2])
def test_yaw_and_roll_wrap_outside_0_and_360(which: int, angle: float, wrapped: float) -> None:
    """By one turn and no more; the limits themselves stay (A 296 to A 304)."""
    camera, expected = [[1.0, 2.0, 3.0]], [[1.0, 2.0, 3.0]]
    camera[0][which], expected[0][which] = angle, wrapped
    assert vehicle(camera, mounted(1, (1, 1, 1), (0, 0, 0))) == expected


@pytest.mark.parametrize(
    ("angle", "wrapped"),
    [
        (-180.0, -180.0), (180.0, 180.0), (-180.25, 179.75), (180.25, -179.75), (-0.25, -0.25),
        (540.0, 180.0), (540.5, 180.5), (-540.0, -180.0), (-540.5, -180.5),
    ],
)  # fmt: skip
def test_pitch_wraps_outside_180_either_side(angle: float, wrapped: float) -> None:
    job = mounted(1, (1, 1, 1), (0, 0, 0))
    assert vehicle([[1.0, angle, 3.0]], job) == [[1.0, wrapped, 3.0]]


def test_each_job_has_its_own_mounting() -> None:
    """Each angle its multiplier and its offset, which is added after."""
    jobs = mounted(2, (1, -1, 2), (10, 20, 30)), mounted(1, (-1, 0.5, 1), (100, -5, 7))
    camera = [[40.0, 50.0, 60.0], [1.0, 2.0, 3.0], [40.0, 50.0, 60.0]]
    expected = [[50.0, -30.0, 150.0], [11.0, 18.0, 36.0], [60.0, 20.0, 67.0]]
    assert vehicle(camera, *jobs) == expected


def test_what_is_handed_on_of_a_solve() -> None:
    """Of frames 1 to 3, of which the second is dropped, and landmarks, of which two are ignored."""
    jobs = film_jobs([mounted(3, (1, 1, 1), (0, 0, 0))])
    camera = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]]
    start = np.array([[11.0, 12.0, 13.0], [21.0, 22.0, 23.0], [31.0, 32.0, 33.0]])
    used = np.ones(15, bool)
    used[[2, 13]] = False
    found = attitude(jobs, solve(jobs, camera), start, np.array([False, True, False]), used)
    known = [camera[0], [NAN] * 3, camera[2]]
    np.testing.assert_array_equal(found.camera_deg, known)
    np.testing.assert_array_equal(found.vehicle_deg, known)
    np.testing.assert_array_equal(found.start_deg[:, 0], [11.0, 12.0, 13.0])
    np.testing.assert_array_equal(found.start_deg[2], [13.0, 23.0, 33.0])
    np.testing.assert_array_equal(found.correction_rad[1], [1.5, 4.5, 7.5])
    assert found.last_pass.tolist() == [3, 4, 5]
    assert found.singular.tolist() == [False, True, False]
    residual = np.arange(30.0).reshape(15, 2) + 0.25
    residual[[2, 13]] = NAN
    np.testing.assert_array_equal(found.residual_mm, residual)


def flown(frames: int, end_ft: float, wind_end_ft: float) -> Job:
    """From 1000 ft and 1, 2, 3 ft/s in 10 s; the wind begins at 1000 ft with 5, 6 ft/s."""
    job = film(frames)
    path = replace(
        job.trajectory,
        time_s=np.array([0.0, 10.0]),
        altitude_ft=np.array([1000.0, end_ft]),
        velocity_ft_s=np.array([[1.0, 2.0, 3.0], [11.0, 22.0, 33.0]]),
        position_ft=np.zeros((2, 3)),
    )
    heights, speeds = np.array([1000.0, wind_end_ft]), np.array([[5.0, 6.0], [15.0, 26.0]])
    wind = replace(job.wind, altitude_ft=heights, velocity_ft_s=speeds)
    return replace(job, trajectory=path, wind=wind)


def test_velocity_and_wind_are_looked_up_in_the_tables_of_the_job() -> None:
    """The velocity by time, the wind by the altitude at that time, 1250, 1750 and 1100 ft."""
    jobs = film_jobs([flown(2, 2000.0, 1500.0), flown(1, 1200.0, 1100.0)])
    air = air_lookup(jobs, np.array([2.5, 7.5, 5.0]))
    velocity = [[3.5, 7.0, 10.5], [8.5, 17.0, 25.5], [6.0, 12.0, 18.0]]
    np.testing.assert_array_equal(air.velocity_ft_s, velocity)
    np.testing.assert_array_equal(air.wind_ft_s, [[10.0, 16.0], [20.0, 36.0], [15.0, 26.0]])
    assert air.outside_wind.tolist() == [False, True, False]


def test_an_error_names_the_table_of_the_look_up() -> None:
    good = flown(1, 2000.0, 1500.0)
    path, wind = good.trajectory, good.wind
    bad = np.array([1000.0, NAN])
    fast = path.velocity_ft_s * np.array([1.0, 1.0, NAN])
    slow = replace(wind, velocity_ft_s=wind.velocity_ft_s * np.array([1.0, NAN]))
    for job, place in (
        (replace(good, trajectory=replace(path, altitude_ft=bad)), r"times \(group 7\).* 2$"),
        (replace(good, trajectory=replace(path, velocity_ft_s=fast)), r"times \(group 7\).* 1$"),
        (replace(good, wind=replace(wind, altitude_ft=bad)), r"altitudes \(group 4\).* 2$"),
        (replace(good, wind=slow), r"altitudes \(group 4\).* 1$"),
    ):
        with pytest.raises(TableNotANumber, match=place):
            air_lookup(film_jobs([job]), np.array([2.5]))
    with pytest.raises(TableOutOfOrder) as caught:
        air_lookup(film_jobs([flown(1, 2000.0, 1000.0)]), np.array([2.5]))
    assert caught.value.table == (4, "altitudes") and caught.value.position == 2


@pytest.mark.parametrize(
    ("vehicle_deg", "velocity", "wind", "angles"),
    [
        # yaw, pitch, roll; toward north, east, down; toward north, east; alpha, beta, eta, airspeed
        ((90.0, 0.0, 0.0), (0.0, 100.0, 0.0), (0.0, 0.0), (0.0, 0.0, 0.0, 100.0)),
        ((0.0, 90.0, 0.0), (0.0, 0.0, -100.0), (0.0, 0.0), (0.0, 0.0, 0.0, 100.0)),
        ((0.0, 0.0, 0.0), (30.0, 0.0, 30.0), (0.0, 0.0), (45.0, 0.0, 45.0, 30.0 * 2**0.5)),
        ((0.0, 0.0, 90.0), (30.0, 0.0, 30.0), (0.0, 0.0), (0.0, 45.0, 45.0, 30.0 * 2**0.5)),
        ((0.0, 0.0, 0.0), (30.0, 0.0, 0.0), (0.0, -30.0), (0.0, 45.0, 45.0, 30.0 * 2**0.5)),
        ((0.0, 0.0, 0.0), (60.0, 0.0, 30.0), (30.0, 0.0), (45.0, 0.0, 45.0, 30.0 * 2**0.5)),
    ],
)
def test_angles_of_attack_of_a_turned_vehicle(
    vehicle_deg: tuple[float, ...],
    velocity: tuple[float, ...],
    wind: tuple[float, ...],
    angles: tuple[float, ...],
) -> None:
    """Into its own motion there are none; motion along a rolled vehicle's right side is beta."""
    air = air_lookup(film_jobs([film(1)]), np.zeros(1))
    air = air._replace(
        velocity_ft_s=np.array([velocity]),
        wind_ft_s=np.array([wind]),
        outside_wind=np.array([True]),
    )
    found = air_angles(air, np.array([vehicle_deg]))
    three = [found.alpha_deg[0], found.beta_deg[0], found.eta_deg[0]]
    assert_close("angle of attack by hand", three, angles[:3])
    assert_close("airspeed by hand", found.airspeed_ft_s[0], angles[3])
    assert found.outside_wind.tolist() == [True]


@pytest.mark.parametrize(("fitted", "deviation"), [(0, (2.5, 1.0)), (3, (5.0, 2.0))])
def test_the_deviation_of_the_residuals(fitted: int, deviation: tuple[float, ...]) -> None:
    """sqrt(25/4) and sqrt(4/4); with three unknowns sqrt(25/1) and sqrt(4/1)."""
    residual = np.array([[3.0, -4.0], [0.0, 0.0], [1.0, -1.0], [NAN, NAN], [-1.0, 1.0]])
    used = np.array([True, True, True, False, True])
    found = residual_deviation(residual, used, fitted, LandmarkLayout(np.array([2, 3])))
    assert found.tolist() == list(deviation)
