"""Images, residuals, partials, gain, and derivatives by what a deck states.

The camera's angles are those that the run ended with; everything else is worked out here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit import appendix_a, spherical_film
from tests.kit.jobs import case, film, reread
from tests.tolerances import assert_close
from vopd.errata import fixes
from vopd.estimate import Estimate
from vopd.film import JoinedJobs, film_estimate, joined_jobs
from vopd.job import Job, Wind
from vopd.program.vopd import run

FOCAL = 10.4
MM_PER_INCH = 0.713816400205
RUNS = {"1974": fixes("eight-digits"), "first-landmark": fixes("first-landmark", "eight-digits")}


@cache
def solved(name: str) -> tuple[np.ndarray, Estimate]:
    """Two frames, read with errors of some micrometres by a lens without distortion.

    The vehicle's pitch is half the camera's, backward, and its roll is turned by 30 degrees.
    Gives film coordinates (F, L, 2), mm, and the estimate.
    """
    truth = np.array([[140.0, -60.0, 60.0], [143.0, -57.0, 64.0]])
    job = spherical_film.job(truth, truth[0], multiplier=(1.0, -0.5, 1.0))
    errors = np.random.default_rng(8).normal(0.0, 0.02, (2, 5, 1, 2))
    camera = replace(
        job.camera,
        lens_distortion_um=0.0 * job.camera.lens_distortion_um,
        offset_deg=np.array([0.0, 0.0, 30.0]),
    )
    readings = reread(job.readings, landmark_in=job.readings.landmark_in + errors)
    job = replace(job, camera=camera, readings=readings)
    centre = readings.fiducial_in.mean(axis=(1, 2))[:, None]
    film = (readings.landmark_in.mean(axis=2) - centre) * MM_PER_INCH
    return film, film_estimate(run(job, RUNS[name]))


def flat(pairs: np.ndarray) -> np.ndarray:
    """x of every landmark, then y of every landmark."""
    return np.concatenate([pairs[:, 0], pairs[:, 1]])


def partials(one: Estimate, frame: int, erratum: bool) -> np.ndarray:
    """Of the computed coordinates by camera yaw, pitch, roll, (2L, 3) mm per radian."""
    angles = one.camera_deg[frame] / appendix_a.RAD
    return -flat(appendix_a.partials(angles, one.direction[frame], FOCAL, erratum))


@pytest.mark.parametrize("name", RUNS)
@pytest.mark.parametrize("frame", [0, 1])
def test_images_and_residuals(name: str, frame: int) -> None:
    """A residual is measured minus computed."""
    film, one = solved(name)
    angles = one.camera_deg[frame] / appendix_a.RAD
    computed = appendix_a.project(angles, one.direction[frame], FOCAL)
    assert np.abs(film[frame] - computed).max() > 1e-3
    assert_close("residual", one.image[frame], film[frame])
    assert_close("residual", one.residual[frame], flat(film[frame] - computed))


@pytest.mark.parametrize("name", RUNS)
@pytest.mark.parametrize("frame", [0, 1])
def test_partials_and_gain(name: str, frame: int) -> None:
    """The partials are the correct ones; the gain has those of the run, with its erratum."""
    _, one = solved(name)
    true = partials(one, frame, erratum=False)
    of_run = partials(one, frame, erratum=name == "1974")
    assert_close("derivative by steps", one.partials[frame] / 10.0, true / 10.0)
    gain = np.linalg.solve(of_run.T @ true, of_run.T)
    assert_close("derivative by steps", one.gain[frame], gain)
    if name == "1974":
        assert np.abs(gain - np.linalg.pinv(true)).max() > 1e-4


@pytest.mark.parametrize("axis", range(3), ids=("yaw", "pitch", "roll"))
def test_the_gain_of_the_body_is_its_small_rotation(axis: int) -> None:
    """Residuals that turn the camera by a small angle turn the body about its own axes.

    Group 3 makes the vehicle's angles of the camera's; forward, right, down by scipy.
    """
    _, one = solved("1974")
    step = 1e-4 * np.eye(3)[axis]
    turn = np.degrees(step) * [1.0, -0.5, 1.0]
    ends = [
        Rotation.from_euler("ZYX", one.vehicle_deg[0] + sign * turn, degrees=True)
        for sign in (-1.0, 1.0)
    ]
    expected = (ends[0].inv() * ends[1]).as_rotvec() / 2e-4
    found = one.body_gain[0] @ one.partials[0] @ step / 1e-4
    assert_close("derivative by steps", found, expected)
    assert (one.vehicle_by_camera == np.diag([1.0, -0.5, 1.0])).all()


# Landmarks that are one but for rounding


def one_place(apart_min: float) -> Job:
    """Case 1 with its landmarks read at one place, and so many minutes of longitude apart."""
    job = case(1)
    readings, known = job.readings, job.landmarks
    film = np.broadcast_to(readings.landmark_in[:, :1], readings.landmark_in.shape)
    columns = {
        name: np.full_like(column, column[0])
        for name, column in vars(known).items()
        if name != "number"
    }
    columns["longitude_min"] = columns["longitude_min"] + apart_min * np.arange(len(known.number))
    landmarks = replace(known, **columns)
    return replace(job, readings=reread(readings, landmark_in=film.copy()), landmarks=landmarks)


@pytest.mark.parametrize(
    ("apart_min", "known"),
    [(1e-3, True), (1e-5, True), (1e-6, False), (1e-7, False), (1e-11, False)],
)
def test_what_is_left_by_rounding_determines_no_angle(apart_min: float, known: bool) -> None:
    """1E-3 minute is 1.8 m from 44 km, 1E-7 is .2 mm: a relative size of 1E-17 in P'B.

    The limit is 1E-14, between those of 1E-5 and 1E-6.
    """
    results = run(one_place(apart_min))
    assert results.solved.all()
    gain = film_estimate(results).gain
    assert np.isfinite(gain).all() == known and np.isnan(gain).all() != known


# Path and wind before and after each frame


MS = 1e-3
NEITHER_BEFORE_AFTER = [0.0, MS, -MS]


def flown(frames: int, climb: float, wind: float) -> Job:
    """1000 ft a second east, 10 south; each velocity and the wind grow by the second."""
    job = film(frames)
    time = np.array([-50.0, 50.0])
    path = replace(
        job.trajectory,
        time_s=time,
        position_ft=job.trajectory.position_ft[:1] + time[:, None] * [1000.0, -10.0, climb],
        velocity_ft_s=np.array([[-10.0, 1000.0, -climb]]) + time[:, None] * [1.0, 2.0, 3.0],
        altitude_ft=120000.0 + time * climb,
    )
    speeds = np.array([[0.0, 0.0], [wind, -wind]])
    air = replace(job.wind, altitude_ft=np.array([110000.0, 130000.0]), velocity_ft_s=speeds)
    return replace(job, trajectory=path, wind=air)


def looked_up(*jobs: Job) -> tuple[JoinedJobs, np.ndarray]:
    joined = joined_jobs([run(job) for job in jobs])
    return joined, joined.results.time_s


def hold(path: JoinedJobs, time_s: np.ndarray, frames: slice, climb: float, wind: float) -> None:
    """What is linear in the time, by hand."""
    for f, at in zip(range(frames.start, frames.stop), time_s[frames].tolist(), strict=True):
        assert_close("vehicle position", path.altitude_ft[f], 120000.0 + at * climb)
        for k, after in enumerate(NEITHER_BEFORE_AFTER):
            moved = [1000.0 * after, -10.0 * after, climb * after]
            assert_close("vehicle position", path.travelled_ft[f, k], moved)
            velocity = np.array([-10.0, 1000.0, -climb]) + (at + after) * np.array([1.0, 2.0, 3.0])
            steps = np.concatenate([np.zeros((1, 3)), np.eye(3) * MS, np.eye(3) * -MS])
            assert_close("airspeed", path.velocity_ft_s[f, k], velocity + steps)
            part = (10000.0 + (at + after) * climb) / 20000.0
            assert_close("airspeed", path.wind_ft_s[f, k], [wind * part, -wind * part])


def test_of_jobs_together_each_by_its_tables() -> None:
    path, time_s = looked_up(flown(2, 5.0, 40.0), flown(3, -80.0, 300.0))
    hold(path, time_s, slice(0, 2), 5.0, 40.0)
    hold(path, time_s, slice(2, 5), -80.0, 300.0)


def test_a_job_whose_wind_is_out_of_order_leaves_the_others_theirs() -> None:
    """Its own wind is NaN; so is that of no other."""
    bad = flown(2, 5.0, 40.0)
    bad = replace(bad, wind=replace(bad.wind, altitude_ft=np.array([9.0, 9.0])))
    path, time_s = looked_up(flown(2, 1.0, 40.0), bad, flown(3, -80.0, 300.0))
    hold(path, time_s, slice(0, 2), 1.0, 40.0)
    last = len(time_s) - 3
    assert last > 2 and np.isnan(path.wind_ft_s[2:last]).all()
    assert np.isfinite(path.velocity_ft_s).all()
    hold(path, time_s, slice(last, last + 3), -80.0, 300.0)


# Derivatives by steps
#
# The computed images are those of Appendix A and the program's Earth, written anew in the test
# kit; the angles of attack are scipy's. Nothing of `vopd.program` is used but the solved angles.


FRAMES, STEP_S = 3, 1e-3
AXES = ("east", "north", "up")


@cache
def backward() -> tuple[Job, Estimate]:
    """A vehicle that flies backward, so that alpha and beta are at the cut, 180 and -180 degrees.

    Along its body axes the air comes with -1000, 4E-6 and -4E-6 ft/s, and down with the wind.
    """
    truth = np.tile([140.0, -80.0, 60.0], (FRAMES, 1))
    job = spherical_film.job(truth, truth[0])
    body = Rotation.from_euler("ZYX", run(job).vehicle_deg[0], degrees=True)
    velocity = np.tile(body.apply([-1000.0, 4e-6, -4e-6]), (FRAMES, 1))
    change_of_wind = body.apply([0.0, 1.0, -1.0])[:2] * 0.01
    wind = Wind(np.array([119950.0, 119951.0]), np.array([[0.0, 0.0], change_of_wind]))
    path = replace(job.trajectory, velocity_ft_s=velocity)
    job = replace(job, trajectory=path, wind=wind)
    return job, film_estimate(run(job))


@cache
def solved_by_steps() -> tuple[Job, Estimate]:
    """A film in a wind that changes with height; the camera's pitch counts half and backward."""
    truth = np.array([[140.0, -80.0, 60.0], [143.0, -77.0, 64.0], [139.0, -74.0, 70.0]])
    job = spherical_film.job(truth, truth[0], multiplier=(1.0, -0.5, 1.0))
    wind = Wind(np.array([100e3, 130e3]), np.array([[-30.0, 10.0], [20.0, -45.0]]))
    job = replace(job, wind=wind)
    return job, film_estimate(run(job))


def images(
    frame: int, moved_ft: np.ndarray, mark_ft: np.ndarray, focal_mm: float = 10.4
) -> np.ndarray:
    """Computed images (2L,), x then y, with the camera and all landmarks moved east, north, up."""
    job, one = solved_by_steps()
    at = job.trajectory.position_ft[frame] + moved_ft
    angles = one.camera_deg[frame] / appendix_a.RAD
    seen = spherical_film.cosines(at, job.landmarks, mark_ft)
    return appendix_a.project(angles, seen, focal_mm).T.ravel()


def agree(found: np.ndarray, residuals: list[np.ndarray]) -> None:
    """Derivatives of residuals, measured minus computed, of all frames, on a scale of 1."""
    expected = np.array(residuals)
    scale = np.abs(expected).max()
    assert_close("derivative by steps", found / scale, expected / scale)


NOT_MOVED = np.zeros(3)


@pytest.mark.parametrize("axis", range(3), ids=AXES)
def test_landmarks_and_position(axis: int) -> None:
    """By a foot; an image moves the other way when the camera is moved than when landmarks are."""
    one = solved_by_steps()[1].responses
    foot = np.eye(3)[axis]
    by_marks = [
        -(images(k, NOT_MOVED, foot) - images(k, NOT_MOVED, -foot)) / 2.0 for k in range(FRAMES)
    ]
    by_camera = [
        -(images(k, foot, NOT_MOVED) - images(k, -foot, NOT_MOVED)) / 2.0 for k in range(FRAMES)
    ]
    agree(one.landmark[..., axis], by_marks)
    agree(one.position[..., axis], by_camera)
    assert (np.sign(by_marks) == -np.sign(by_camera)).mean() > 0.9


def test_focal_length() -> None:
    changes = [
        -(images(k, NOT_MOVED, NOT_MOVED, 10.401) - images(k, NOT_MOVED, NOT_MOVED, 10.399)) / 2e-3
        for k in range(FRAMES)
    ]
    agree(solved_by_steps()[1].responses.focal_length, changes)


def test_time() -> None:
    """The camera flies 400 ft east, 300 south and 50 down in a second."""
    flown = np.array([400.0, -300.0, -50.0]) * STEP_S
    changes = [
        -(images(k, flown, NOT_MOVED) - images(k, -flown, NOT_MOVED)) / (2.0 * STEP_S)
        for k in range(FRAMES)
    ]
    agree(solved_by_steps()[1].responses.time, changes)


def attack(
    turned_deg: np.ndarray = NOT_MOVED,
    faster_ft_s: np.ndarray = NOT_MOVED,
    later_s: float = 0.0,
    of: Callable[[], tuple[Job, Estimate]] = solved_by_steps,
) -> np.ndarray:
    """Alpha, beta, eta (F, 3), radians, with the vehicle's angles, velocity and time changed."""
    job, one = of()
    low, high = job.wind.altitude_ft
    part = (job.trajectory.altitude_ft - 50.0 * later_s - low) / (high - low)
    below, above = job.wind.velocity_ft_s
    wind = below + part[:, None] * (above - below)
    air = job.trajectory.velocity_ft_s + faster_ft_s - np.column_stack([wind, 0.0 * part])
    body = Rotation.from_euler("ZYX", one.vehicle_deg + turned_deg, degrees=True)
    u, v, w = body.inv().apply(air).T
    return np.stack([np.arctan2(w, u), np.arctan2(v, u), np.arctan2(np.hypot(v, w), u)], axis=1)


def change(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """The difference of angles the short way round, radians."""
    return np.asarray((one - other + np.pi) % (2.0 * np.pi) - np.pi)


@pytest.mark.parametrize("axis", range(3), ids=("yaw", "pitch", "roll"))
def test_angles_of_attack_by_camera_angles(axis: int) -> None:
    """Degrees by degrees of the camera's angle, which turns the vehicle as group 3 says."""
    turned = np.eye(3)[axis] * [1.0, -0.5, 1.0] * 1e-3
    expected = np.degrees(change(attack(turned), attack(-turned))) / 2e-3
    found = solved_by_steps()[1].responses.attack_by_camera[:, :, axis]
    assert_close("derivative by steps", found, expected)


@pytest.mark.parametrize("axis", range(3), ids=("north", "east", "down"))
def test_angles_of_attack_by_velocity(axis: int) -> None:
    faster = np.eye(3)[axis] * 1e-2
    expected = change(attack(faster_ft_s=faster), attack(faster_ft_s=-faster)) / 2e-2
    found = solved_by_steps()[1].responses.attack_by_velocity[:, :, axis]
    assert np.abs(expected).max() > 1e-3
    assert_close("derivative by steps", found, expected)


def test_angles_of_attack_by_time() -> None:
    """The wind changes by 50 and -55 ft/s in 30000 ft, of which 50 ft are sunk in a second."""
    expected = change(attack(later_s=0.1), attack(later_s=-0.1)) / 0.2
    found = solved_by_steps()[1].responses.attack_by_time
    assert np.abs(expected).max() > 1e-4
    assert_close("derivative by steps", found, expected)


def test_angles_of_attack_that_pass_180_degrees() -> None:
    """Changes are taken the short way round: none is of a full circle.

    Frame 2 is at the cut; eta has a corner there, and no derivative.
    """
    found = backward()[1].responses

    def pairs() -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """What is found, and alpha and beta on either side of the frame, over the step."""
        for axis, step in enumerate(np.eye(3) * 1e-3):
            ends = [np.degrees(attack(end, of=backward)) / 2e-3 for end in (step, -step)]
            yield found.attack_by_camera[:, :, axis], *ends
            ends = [attack(faster_ft_s=end, of=backward) / 2e-3 for end in (step, -step)]
            yield found.attack_by_velocity[:, :, axis], *ends
        ends = [attack(later_s=end, of=backward) / 2e-3 for end in (1e-3, -1e-3)]
        yield found.attack_by_time, *ends

    cut = 0
    for values, one, other in pairs():
        circle = 2.0 * np.pi / 2e-3 * (180.0 / np.pi if np.abs(one).max() > np.pi / 2e-3 else 1.0)
        short = (one - other + circle / 2.0) % circle - circle / 2.0
        cut += int((np.abs(one - other)[1, :2] > circle / 2.0).any())
        assert_close("ratio by steps", values[1, :2], short[1, :2])
    assert cut >= 3
