"""How computed image coordinates answer to each input, the angles held: by differences.

Landmarks are 50 km away, where the turn of the local axes along the path is seen.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit.flight_project import LENS, local_to_camera
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.flight.estimate import flight_estimate
from vopd.flight.flight import CameraPath, Flight, LandmarkSet, Picks, Refraction
from vopd.flight.solve import SolvedFlight, sight_lines, solve
from vopd.geometry.earth import earth_centred_m, local_axes
from vopd.geometry.lenses import Lens, project
from vopd.geometry.rotations import FORWARD

CAMERA = earth_centred_m(60.0, 20.0, 9000.0)
RAY = np.array([[-0.4, 0.1, 1.0], [0.1, 0.25, 1.0], [0.5, -0.2, 1.0], [0.2, 0.3, 1.0]])
UNUSED = 3  # a check landmark
ANGLES_DEG = np.array([130.0, -12.0, 7.0])
VELOCITY = np.array([200.0, -70.0, 30.0])  # north, east, down
FRAME, MARK = np.zeros(4, np.int64), np.arange(4)


def solved() -> SolvedFlight:
    away = RAY @ local_to_camera(ANGLES_DEG) @ local_axes(CAMERA) * 50e3
    flight = Flight(
        name="", source="flight.toml", lens=LENS, frame=np.array([0]), image_name=(),
        time_s=np.zeros(1), epoch=None,
        picks=Picks(FRAME, MARK, project(LENS, RAY).pixel, np.ones(4)),
        landmarks=LandmarkSet(
            ("a", "b", "c", "d"), CAMERA + away, np.full((4, 3), np.nan), (True, True, True, False)
        ),
        path=CameraPath(CAMERA[None], np.full(3, np.nan), velocity_m_s=VELOCITY[None]),
        mount=FORWARD,
        refraction=Refraction(0.0),
    )  # fmt: skip
    return solve(flight)


def pixel(one: SolvedFlight, camera: Floats, marks: Floats, lens: Lens = LENS) -> Floats:
    """Image coordinates (2L,) of landmarks with the camera's angles as they were solved."""
    lines = sight_lines(camera[None], marks, FRAME, MARK, Refraction(0.0))
    found = project(lens, lines.direction @ one.attitudes.rotation[0].T).pixel
    found[UNUSED] = 0.0  # takes no part
    return found.T.ravel()


@pytest.fixture(scope="module")
def one() -> SolvedFlight:
    return solved()


@pytest.mark.parametrize("axis", range(3), ids=["east", "north", "up"])
def test_residuals_by_position_and_by_landmark(one: SolvedFlight, axis: int) -> None:
    marks, responses = one.flight.landmarks.position_m, flight_estimate(one).responses
    way = 50.0 * local_axes(CAMERA)[axis]
    slope = pixel(one, CAMERA + way, marks) - pixel(one, CAMERA - way, marks)
    assert_close("turn by a metre", responses.position[0, :, axis] / 1500, slope / 100 / 1500)
    way = 50.0 * local_axes(marks)[:, axis]
    slope = pixel(one, CAMERA, marks + way) - pixel(one, CAMERA, marks - way)
    assert_close("turn by a metre", responses.landmark[0, :, axis] / 1500, slope / 100 / 1500)


def test_residuals_by_time_are_those_along_the_velocity(one: SolvedFlight) -> None:
    marks, responses = one.flight.landmarks.position_m, flight_estimate(one).responses
    east, north, up = local_axes(CAMERA)
    way = 0.25 * (VELOCITY[0] * north + VELOCITY[1] * east - VELOCITY[2] * up)
    slope = (pixel(one, CAMERA + way, marks) - pixel(one, CAMERA - way, marks)) / 0.5
    speed = np.linalg.norm(VELOCITY)
    assert_close("turn by a metre", responses.time[0] / 1500 / speed, slope / 1500 / speed)
    still = replace(
        one, flight=replace(one.flight, path=replace(one.flight.path, velocity_m_s=None))
    )
    assert (flight_estimate(still).responses.time == 0.0).all()


def test_residuals_by_the_focal_length_are_by_a_pixel_of_its_mean(one: SolvedFlight) -> None:
    marks = one.flight.landmarks.position_m
    longer, shorter = (
        replace(LENS, focal_px=LENS.focal_px * (1.0 + way / 1495.0)) for way in (1.0, -1.0)
    )
    slope = (pixel(one, CAMERA, marks, longer) - pixel(one, CAMERA, marks, shorter)) / 2.0
    assert_close("ten decimals", flight_estimate(one).responses.focal_length[0], slope)


def test_angles_of_attack_by_the_camera_and_the_velocity(one: SolvedFlight) -> None:
    """No turn about the velocity changes them, and no more of it in its own direction."""
    found = flight_estimate(one)
    assert_close("table value", found.responses.attack_by_velocity[0] @ VELOCITY, np.zeros(3))
    assert (found.responses.attack_by_time == 0.0).all()  # no acceleration is known
    more = VELOCITY / 1e6
    ends = []
    for sign in (1.0, -1.0):
        path = replace(one.flight.path, velocity_m_s=(VELOCITY + sign * more[::-1])[None])
        ends.append(flight_estimate(replace(one, flight=replace(one.flight, path=path))).attack_deg)
    slope = np.radians(ends[0] - ends[1])[0] / 2.0
    expected = found.responses.attack_by_velocity[0] @ more[::-1]
    assert_close("rae printed cosine", slope * 1e3, expected * 1e3)


def test_angles_of_attack_by_the_camera_s_angles(one: SolvedFlight) -> None:
    """The camera looks forward, so that its angles are those of the body."""
    step_deg = 1e-3
    for axis in range(3):
        ends = []
        for way in (step_deg, -step_deg):
            angles = ANGLES_DEG + way * np.eye(3)[axis]
            u, v, w = Rotation.from_euler("ZYX", angles, degrees=True).inv().apply(VELOCITY)
            ends.append([np.arctan2(w, u), np.arctan2(v, u), np.arctan2(np.hypot(v, w), u)])
        slope = (np.array(ends[0]) - ends[1]) / np.radians(2 * step_deg)
        found = flight_estimate(one).responses.attack_by_camera[0, :, axis]
        assert_close("derivative by steps", found, slope)
