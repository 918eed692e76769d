"""How residuals and angles of attack change with what a deck states: every derivative by steps.

The computed images are those of Appendix A and the program's Earth, written anew in the test
kit; the angles of attack are scipy's. Nothing of `vopd.program` is used but the solved angles.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit import appendix_a, spherical_film
from tests.tolerances import assert_close
from vopd.estimate import Estimate
from vopd.film import film_estimate
from vopd.job import Job, Wind
from vopd.program.vopd import run

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
def solved() -> tuple[Job, Estimate]:
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
    job, one = solved()
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
    one = solved()[1].responses
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
    agree(solved()[1].responses.focal_length, changes)


def test_time() -> None:
    """The camera flies 400 ft east, 300 south and 50 down in a second."""
    flown = np.array([400.0, -300.0, -50.0]) * STEP_S
    changes = [
        -(images(k, flown, NOT_MOVED) - images(k, -flown, NOT_MOVED)) / (2.0 * STEP_S)
        for k in range(FRAMES)
    ]
    agree(solved()[1].responses.time, changes)


def attack(
    turned_deg: np.ndarray = NOT_MOVED,
    faster_ft_s: np.ndarray = NOT_MOVED,
    later_s: float = 0.0,
    of: Callable[[], tuple[Job, Estimate]] = solved,
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
    found = solved()[1].responses.attack_by_camera[:, :, axis]
    assert_close("derivative by steps", found, expected)


@pytest.mark.parametrize("axis", range(3), ids=("north", "east", "down"))
def test_angles_of_attack_by_velocity(axis: int) -> None:
    faster = np.eye(3)[axis] * 1e-2
    expected = change(attack(faster_ft_s=faster), attack(faster_ft_s=-faster)) / 2e-2
    found = solved()[1].responses.attack_by_velocity[:, :, axis]
    assert np.abs(expected).max() > 1e-3
    assert_close("derivative by steps", found, expected)


def test_angles_of_attack_by_time() -> None:
    """The wind changes by 50 and -55 ft/s in 30000 ft, of which 50 ft are sunk in a second."""
    expected = change(attack(later_s=0.1), attack(later_s=-0.1)) / 0.2
    found = solved()[1].responses.attack_by_time
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
