"""Every derivative of a flight's estimate, by differences of solves or of definitions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit.flight_project import LENS, MARK, UNUSED, local_to_camera, three_frames, truth_deg
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.estimate import Estimate
from vopd.flight.angles import AttackAngles, angles_of_attack
from vopd.flight.estimate import flight_estimate, gain_of_turns
from vopd.flight.flight import CameraPath, Flight, LandmarkSet, Picks, Refraction
from vopd.flight.solve.lines_of_sight import sight_lines
from vopd.flight.solve.rotations import SolvedFlight, solve
from vopd.geometry.earth import earth_centred_m, local_axes
from vopd.geometry.lenses import Lens, project
from vopd.geometry.rotations import FORWARD, mount_by_angles


@pytest.fixture(scope="module")
def estimate() -> Estimate:
    return flight_estimate(solve(three_frames()))


def test_partials_are_differences_of_computed_coordinates(estimate: Estimate) -> None:
    step_deg = 1e-3
    for frame in (1, 2):
        direction = estimate.direction[frame, :UNUSED]
        for axis in range(3):
            more = np.eye(3)[axis] * step_deg
            there, back = (
                -project(LENS, direction @ local_to_camera(truth_deg()[frame] + way).T).pixel
                for way in (more, -more)
            )
            slope = ((there - back) / np.radians(2 * step_deg)).T.ravel()
            found = estimate.partials[frame, [0, 1, 2, 4, 5, 6], axis]
            assert_close("minimiser's residual", found / 1500.0, slope / 1500.0)
    assert (estimate.partials[1:, [UNUSED, 4 + UNUSED]] == 0.0).all()


@pytest.mark.parametrize("axis", [0, 1], ids=["u", "v"])
def test_angles_and_body_turn_as_gain_and_body_gain_say(axis: int) -> None:
    """With picks that count differently, and a mount aslant."""
    one = replace(three_frames(), mount=mount_by_angles([20.0, -35.0, 50.0]))
    base, step, slot = flight_estimate(solve(one)), 1e-2, 1
    ends = []
    for way in (step, -step):
        pixel = one.picks.pixel.copy()
        pixel[MARK * 2 + slot, axis] += way
        other = solve(replace(one, picks=replace(one.picks, pixel=pixel)))
        body = flight_estimate(other).camera_deg, one.mount @ other.attitudes.rotation[2]
        ends.append(body)
    camera = np.radians(ends[0][0][2] - ends[1][0][2]) / (2 * step)
    assert_close("flight response", camera, -base.gain[2, :, slot + MARK * axis])
    turn = Rotation.from_matrix(ends[0][1] @ ends[1][1].T).as_rotvec() / (2 * step)
    assert_close("flight response", -turn, -base.body_gain[2, :, slot + MARK * axis])
    by_camera = (base.vehicle_by_camera[2] @ camera)[None]
    vehicle = Rotation.from_euler("ZYX", base.vehicle_deg[2], degrees=True)
    moved = (vehicle * Rotation.from_rotvec(-turn * step)).as_euler("ZYX", degrees=True)
    change = (moved - base.vehicle_deg[2] + 180.0) % 360.0 - 180.0
    assert_close("flight response", np.radians(change) / step, by_camera[0])


def test_wind_and_acceleration_count_for_angles_of_attack(estimate: Estimate) -> None:
    """Relative to the air 17 m/s north, 6 m/s east, 2 m/s up."""
    assert_close("ratio", estimate.airspeed[1:], np.full(2, np.sqrt(17.0**2 + 6.0**2 + 2.0**2)))
    body = Rotation.from_euler("ZYX", truth_deg()[2], degrees=True)
    ends = []
    for way in (1e-6, -1e-6):
        u, v, w = body.inv().apply([17 + 4 * way, 6 + 5 * way, -2 + 6 * way])
        ends.append([np.arctan2(w, u), np.arctan2(v, u), np.arctan2(np.hypot(v, w), u)])
    slope = (np.array(ends[0]) - ends[1]) / 2e-6
    assert_close("derivative by steps", estimate.responses.attack_by_time[2], slope)
    assert_close("flight angle", estimate.attack_deg[2], np.degrees(np.mean(ends, axis=0)))


@pytest.mark.parametrize(("weak", "determined"), [(1e-13, True), (1e-15, False), (0.0, False)])
def test_from_which_ratio_on_turns_are_not_determined(weak: float, determined: bool) -> None:
    """Eigenvalues of the normal equations 1, 1 and a weak one; another frame is good."""
    partials = np.zeros((2, 4, 3))
    partials[:, [0, 1, 2], [0, 1, 2]] = [[1.0, 1.0, np.sqrt(weak)], [1.0, 2.0, 4.0]]
    found = gain_of_turns(partials, np.ones((2, 4)))
    assert np.isfinite(found[0]).all() == determined
    assert_close("ratio", found[1], np.linalg.pinv(partials[1]))
    assert np.isnan(gain_of_turns(np.full((1, 4, 3), np.nan), np.ones((1, 4)))).all()


# How computed image coordinates answer to each input, the angles held: by differences


CAMERA = earth_centred_m(60.0, 20.0, 9000.0)
RAY = np.array([[-0.4, 0.1, 1.0], [0.1, 0.25, 1.0], [0.5, -0.2, 1.0], [0.2, 0.3, 1.0]])
CHECK_MARK = 3  # a check landmark
ANGLES_DEG = np.array([130.0, -12.0, 7.0])
VELOCITY = np.array([200.0, -70.0, 30.0])  # north, east, down
FRAME, FOUR_MARKS = np.zeros(4, np.int64), np.arange(4)


def solved() -> SolvedFlight:
    away = RAY @ local_to_camera(ANGLES_DEG) @ local_axes(CAMERA) * 50e3
    flight = Flight(
        name="", source="flight.toml", lens=LENS, frame=np.array([0]), image_name=(),
        time_s=np.zeros(1), epoch=None,
        picks=Picks(FRAME, FOUR_MARKS, project(LENS, RAY).pixel, np.ones(4)),
        landmarks=LandmarkSet(
            ("a", "b", "c", "d"), CAMERA + away, np.zeros((4, 3)), (True, True, True, False)
        ),
        path=CameraPath(CAMERA[None], velocity_m_s=VELOCITY[None]),
        mount=FORWARD,
        refraction=Refraction(0.0),
    )  # fmt: skip
    return solve(flight)


def pixel(one: SolvedFlight, camera: Floats, marks: Floats, lens: Lens = LENS) -> Floats:
    """Image coordinates (2L,) of landmarks with the camera's angles as they were solved."""
    lines = sight_lines(camera[None], marks, FRAME, FOUR_MARKS, Refraction(0.0))
    found = project(lens, lines.direction @ one.attitudes.rotation[0].T).pixel
    found[CHECK_MARK] = 0.0  # takes no part
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


# Angles of attack: each angle by hand, each derivative by differences of their definition


BODY_TO_NED = Rotation.from_euler("ZYX", [[20.0, -8.0, 5.0], [200.0, 30.0, -70.0]], degrees=True)
TWO_VELOCITIES = np.array([[60.0, -15.0, 9.0], [-3.0, 25.0, 40.0]])
ACCELERATION = np.array([[2.0, -7.0, 9.0], [-4.0, 6.0, 3.0]])
STEP = 1e-6


def attack() -> AttackAngles:
    return angles_of_attack(BODY_TO_NED.as_matrix(), TWO_VELOCITIES, ACCELERATION)


def defined(body_to_ned: Rotation, velocity: Floats) -> Floats:
    """Alpha, beta, eta (F, 3), radians, as the field defines them."""
    u, v, w = body_to_ned.inv().apply(velocity).T
    return np.stack(
        [np.arctan2(w, u), np.arctan2(v, u), np.arccos(u / np.hypot(u, np.hypot(v, w)))]
    ).T


def slope(there: Floats, back: Floats) -> Floats:
    return (there - back) / (2.0 * STEP)


def test_angles_and_airspeed_by_hand() -> None:
    """3 forward, 4 to the right, 12 down: 13 in all."""
    one = angles_of_attack(np.eye(3)[None], np.array([[3.0, 4.0, 12.0]]), np.zeros((1, 3)))
    assert_close("table value", one.airspeed_m_s, [13.0])
    expected = [np.arctan(12 / 3), np.arctan(4 / 3), np.arctan(np.sqrt(160) / 3)]
    assert_close("table value", one.angle_deg[0], np.degrees(expected))
    root = np.sqrt(160)
    rows = [[-12 / 153, 0, 3 / 153], [-4 / 25, 3 / 25, 0],
            [-root / 169, 12 / (root * 169), 36 / (root * 169)]]  # fmt: skip
    assert_close("table value", one.by_velocity[0], rows)


def test_a_nose_that_rises_by_a_degree_has_a_degree_more_of_alpha() -> None:
    one = angles_of_attack(np.eye(3)[None], np.array([[50.0, 0.0, 4.0]]), np.zeros((1, 3)))
    assert_close("table value", one.by_turns[0, 0, 1], 1.0)
    assert_close("table value", one.by_turns[0, 1, 2], -1.0)  # the nose to the right of the wind


@pytest.mark.parametrize("axis", range(3), ids=["forward", "right", "down"])
def test_angles_by_small_turns_of_the_body(axis: int) -> None:
    turn = Rotation.from_rotvec(np.eye(3)[axis] * STEP)
    there = defined(BODY_TO_NED * turn, TWO_VELOCITIES)
    back = defined(BODY_TO_NED * turn.inv(), TWO_VELOCITIES)
    assert_close("derivative by steps", attack().by_turns[..., axis], slope(there, back))


@pytest.mark.parametrize("axis", range(3), ids=["north", "east", "down"])
def test_angles_by_the_velocity(axis: int) -> None:
    more = np.eye(3)[axis] * STEP
    there, back = (defined(BODY_TO_NED, TWO_VELOCITIES + way) for way in (more, -more))
    assert_close("derivative by steps", attack().by_velocity[..., axis], slope(there, back))


def test_angles_by_time_are_by_the_acceleration() -> None:
    more = ACCELERATION * STEP
    there, back = (defined(BODY_TO_NED, TWO_VELOCITIES + way) for way in (more, -more))
    assert_close("derivative by steps", attack().by_time, slope(there, back))


def test_no_velocity_and_no_motion_cost_no_other_frame() -> None:
    """And no warning of numpy's is shown: the suite makes an error of it."""
    velocity = np.array([[np.nan] * 3, [0.0] * 3, [30.0, 0.0, 0.0]])
    one = angles_of_attack(np.tile(np.eye(3), (3, 1, 1)), velocity, np.zeros((3, 3)))
    assert np.isnan(one.angle_deg[0]).all() and np.isnan(one.airspeed_m_s[0])
    assert one.airspeed_m_s[1:].tolist() == [0.0, 30.0]
    assert one.angle_deg[2].tolist() == [0.0, 0.0, 0.0]
