"""ALPBET and the vehicle's angles against hand work and a rotation by scipy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tests.approved.texts import refused
from tests.kit.jobs import film, without
from tests.tolerances import assert_close
from vopd.errata import NO_FIXES, Fixes, fixes
from vopd.job import Job
from vopd.program import vopd
from vopd.program.alpbet import alpbet
from vopd.program.ftlup import TableNotANumber
from vopd.program.orient import FilmSight, Orientation
from vopd.results import Results

LEVEL_NORTH = (0.0, 0.0, 0.0)


def attack(
    velocity: tuple[float, ...], wind: tuple[float, ...], angles: tuple[float, ...]
) -> tuple[float, ...]:
    """Alpha, beta, eta, airspeed of one frame at yaw, pitch, roll `angles`."""
    psi, theta, phi = (np.array([angle]) for angle in angles)
    done = alpbet(np.array([velocity]), np.array([wind]), theta=theta, psi=psi, phi=phi)
    return tuple(float(part[0]) for part in done)


@pytest.mark.parametrize(
    ("velocity", "wind", "angles", "alpha", "beta", "eta", "airspeed"),
    [
        # velocity north, east, down; wind toward north, toward east; yaw, pitch, roll
        ((100.0, 0.0, 0.0), (0.0, 0.0), LEVEL_NORTH, 0.0, 0.0, 0.0, 100.0),
        # sinking with a level nose: the air comes from below, tan ALPHA = 10/100
        ((100.0, 0.0, 10.0), (0.0, 0.0), LEVEL_NORTH, 5.71059, 0.0, 5.71059, 100.4987562),
        # wind from the west, + VYO: the air comes from the left, tan BETA = -10/100
        ((100.0, 0.0, 0.0), (0.0, 10.0), LEVEL_NORTH, 0.0, -5.71059, 5.71059, 100.4987562),
        # wind from the south, + VXO: a tail wind, 100 - 30
        ((100.0, 0.0, 7.0), (30.0, 0.0), LEVEL_NORTH, 5.71059, 0.0, 5.71059, 70.3491293),
        # drifting east with the nose north: the air comes from the right
        ((100.0, 10.0, 0.0), (0.0, 0.0), LEVEL_NORTH, 0.0, 5.71059, 5.71059, 100.4987562),
        # the same, rolled right by 90: right is now down, so the right wing meets nothing,
        # and the air from the east meets the belly's other side: ALPHA = -5.7
        ((100.0, 10.0, 0.0), (0.0, 0.0), (0.0, 0.0, 90.0), -5.71059, 0.0, 5.71059, 100.4987562),
        # nose up by 30 on a level path
        ((100.0, 0.0, 0.0), (0.0, 0.0), (0.0, 30.0, 0.0), 30.0, 0.0, 30.0, 100.0),
        # nose east, flying north: the air comes from the left at 90
        ((100.0, 0.0, 0.0), (0.0, 0.0), (90.0, 0.0, 0.0), None, -90.0, 90.0, 100.0),
        # flying backwards: ETA passes 90
        ((-100.0, 0.0, 0.0), (0.0, 0.0), (0.0, 30.0, 0.0), -150.0, None, 150.0, 100.0),
    ],
)
def test_by_hand(
    velocity: tuple[float, ...],
    wind: tuple[float, ...],
    angles: tuple[float, ...],
    alpha: float | None,
    beta: float | None,
    eta: float,
    airspeed: float,
) -> None:
    """Arc tangent of .1 is 5.71059 degrees. None: a rounded zero over a rounded zero decides."""
    found = attack(velocity, wind, angles)
    for got, wanted in zip(found[:3], (alpha, beta, eta), strict=True):
        if wanted is not None:
            assert_close("angle of attack by hand", got, wanted)
    assert_close("airspeed by hand", found[3], airspeed)


ANGLE = st.floats(-360.0, 360.0)
SPEED = st.floats(-2000.0, 2000.0)


@given(st.tuples(SPEED, SPEED, SPEED), st.tuples(SPEED, SPEED), st.tuples(ANGLE, ANGLE, ANGLE))
def test_against_a_rotation(
    velocity: tuple[float, ...], wind: tuple[float, ...], angles: tuple[float, ...]
) -> None:
    """Body axes are north, east, down turned by yaw, pitch, roll; the wind is level."""
    body = Rotation.from_euler("ZYX", np.array(angles) * 0.0174532925)
    u, v, w = body.inv().apply(np.array(velocity) - (*wind, 0.0))
    alpha, beta, eta, airspeed = attack(velocity, wind, angles)
    assert_close("airspeed", airspeed, np.sqrt(u * u + v * v + w * w))
    assert 0.0 <= eta <= 180.0
    # tan ALPHA = w/u and so on: each angle turns (u, w) and so on back onto the first axis
    for angle, across in ((alpha, w), (beta, v), (eta, np.hypot(v, w))):
        length = np.hypot(u, across)
        radians = angle / 57.29577951
        assert_close("airspeed", length * np.cos(radians), u)
        assert_close("airspeed", length * np.sin(radians), across)


def test_frames_one_by_one() -> None:
    rng = np.random.default_rng(2)
    v1, v0, angles = rng.normal(size=(9, 3)), rng.normal(size=(9, 2)), rng.normal(size=(3, 9)) * 90
    whole = alpbet(v1, v0, *angles)
    for f in range(9):
        alone = alpbet(v1[f : f + 1], v0[f : f + 1], *angles[:, f : f + 1])
        assert [part[f] for part in whole] == [part[0] for part in alone]


# The vehicle's angles, and the deviation of the residuals


NAN = np.nan


def mounted(frames: int, multiplier: tuple[float, ...], offset: tuple[float, ...]) -> Job:
    job = film(frames)
    camera = replace(
        job.camera, multiplier=np.array(multiplier, float), offset_deg=np.array(offset, float)
    )
    return replace(job, camera=camera)


def solved(
    jobs: list[Job],
    camera_deg: list[list[float]],
    eps: np.ndarray | None = None,
    chosen: Fixes = NO_FIXES,
) -> list[Results]:
    """Jobs whose solve ended at these angles (F, 3); no two of its numbers are equal."""
    frames = len(camera_deg)

    def orient_frames(initial: np.ndarray, seen: FilmSight, *_: object) -> object:
        marks = len(seen.xmu1)
        residuals = np.arange(2.0 * marks).reshape(marks, 2) + 0.25
        done = Orientation(
            angles=np.array(camera_deg).T,
            eps=residuals if eps is None else eps,
            next=np.full((3, frames), -99.0),
            correction=np.arange(3.0 * frames).reshape(3, frames) + 0.5,
            last_pass=np.arange(frames) + 3,
            singular=np.arange(frames) == 1,
        )
        start = np.arange(3.0 * frames).reshape(3, frames) + 11.0
        return done, start

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(vopd, "orient_frames", orient_frames)
        found = vopd.run_jobs(jobs, chosen)
    return [one for one in found if isinstance(one, Results)]


def vehicle(camera_deg: list[list[float]], *jobs: Job) -> list[list[float]]:
    return [row for one in solved([*jobs], camera_deg) for row in one.vehicle_deg.tolist()]


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
    job = without(mounted(3, (1, 1, 1), (0, 0, 0)), 2)
    cards = np.array([[100, 0, 0, 0, 0, 0], [13, 0, 0, 0, 0, 0], [14, 0, 0, 0, 0, 0]])
    job = replace(job, ignored=replace(job.ignored, frame=np.array([2, 1, 3]), landmark=cards))
    camera = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]]
    (found,) = solved([job], camera)
    known = [camera[0], [NAN] * 3, camera[2]]
    np.testing.assert_array_equal(found.camera_deg, known)
    np.testing.assert_array_equal(found.vehicle_deg, known)
    np.testing.assert_array_equal(found.start_deg[:, 0], [11.0, 12.0, 13.0])
    np.testing.assert_array_equal(found.start_deg[2], [13.0, 16.0, 19.0])
    np.testing.assert_array_equal(found.correction_rad[1], [1.5, 4.5, 7.5])
    assert found.last_pass.tolist() == [3, 4, 5]
    assert found.singular.tolist() == [False, True, False]
    residual = np.full((3, 5, 2), NAN)  # of four landmarks of frame 1 and four of frame 3
    residual[0, [0, 1, 3, 4]] = np.arange(8.0).reshape(4, 2) + 0.25
    residual[2, [0, 1, 2, 4]] = np.arange(8.0, 16.0).reshape(4, 2) + 0.25
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


def at(job: Job, *time_s: float) -> Job:
    """The job with its frames at these times, and its vehicle at yaw, pitch and roll zero."""
    clock = replace(job.clock, frame=np.arange(len(time_s)) + 1, time_s=np.array(time_s))
    level = replace(job.camera, multiplier=np.zeros(3), offset_deg=np.zeros(3))
    return replace(job, clock=clock, camera=level)


def test_velocity_and_wind_are_looked_up_in_the_tables_of_the_job() -> None:
    """The velocity by time, the wind by the altitude at that time, 1250, 1750 and 1100 ft."""
    jobs = [at(flown(2, 2000.0, 1500.0), 2.5, 7.5), at(flown(1, 1200.0, 1100.0), 5.0)]
    one, other = solved(jobs, [[0.0, 0.0, 0.0]] * 3)
    velocity = np.array([[3.5, 7.0, 10.5], [8.5, 17.0, 25.5], [6.0, 12.0, 18.0]])
    velocity[:, :2] -= [[10.0, 16.0], [20.0, 36.0], [15.0, 26.0]]
    north, east, down = velocity.T
    speed = np.concatenate([one.airspeed_ft_s, other.airspeed_ft_s])
    assert_close("airspeed", speed, np.sqrt(north**2 + east**2 + down**2))
    alpha = np.concatenate([one.alpha_deg, other.alpha_deg])
    assert_close("angle of attack by hand", alpha, np.degrees(np.arctan2(down, north)))
    beta = np.concatenate([one.beta_deg, other.beta_deg])
    assert_close("angle of attack by hand", beta, np.degrees(np.arctan2(east, north)))
    assert [*one.outside_wind, *other.outside_wind] == [False, True, False]


def test_an_error_names_the_table_of_the_look_up() -> None:
    good = at(flown(1, 2000.0, 1500.0), 2.5)
    path, wind = good.trajectory, good.wind
    bad = np.array([1000.0, NAN])
    fast = path.velocity_ft_s * np.array([1.0, 1.0, NAN])
    slow = replace(wind, velocity_ft_s=wind.velocity_ft_s * np.array([1.0, NAN]))
    for job in (
        replace(good, trajectory=replace(path, altitude_ft=bad)),
        replace(good, trajectory=replace(path, velocity_ft_s=fast)),
        replace(good, wind=replace(wind, altitude_ft=bad)),
        replace(good, wind=slow),
    ):
        with refused(TableNotANumber):
            vopd.run(job)
    stop = vopd.run(at(flown(1, 2000.0, 1000.0), 2.5)).stop
    assert stop is not None and (stop.group, stop.table, stop.position) == (4, "altitudes", 2)


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
    job = flown(1, 1000.0, 2000.0)
    path = replace(job.trajectory, velocity_ft_s=np.array([velocity] * 2))
    mount = replace(job.camera, multiplier=np.zeros(3), offset_deg=np.array(vehicle_deg))
    air = replace(job.wind, velocity_ft_s=np.array([wind] * 2))
    (found,) = solved([replace(job, trajectory=path, camera=mount, wind=air)], [[1.0, 2.0, 3.0]])
    three = [found.alpha_deg[0], found.beta_deg[0], found.eta_deg[0]]
    assert_close("angle of attack by hand", three, angles[:3])
    assert_close("airspeed by hand", found.airspeed_ft_s[0], angles[3])


@pytest.mark.parametrize(
    ("names", "deviation"), [((), (2.5, 1.0)), (("standard-deviation",), (5.0, 2.0))]
)
def test_the_deviation_of_the_residuals(
    names: tuple[str, ...], deviation: tuple[float, ...]
) -> None:
    """sqrt(25/4) and sqrt(4/4); with three unknowns sqrt(25/1) and sqrt(4/1)."""
    eps = np.array([[3.0, -4.0], [0.0, 0.0], [1.0, -1.0], [-1.0, 1.0]])
    job = film(2)
    cards = np.array([[11, 12, 13, 0, 0, 0], [11, 13, 15, 0, 0, 0]])
    job = replace(job, ignored=replace(job.ignored, frame=np.array([1, 2]), landmark=cards))
    (found,) = solved([job], [[1.0, 2.0, 3.0]] * 2, eps, fixes(*names))
    assert found.residual_deviation_mm.tolist() == list(deviation)
