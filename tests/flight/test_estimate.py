"""The estimate of a flight: angles by published vectors, responses by differences."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from tests.kit.random_flights import lenses, random_frame
from tests.tolerances import assert_close
from vopd.attitude.history import history
from vopd.estimate import Estimate
from vopd.flight.estimate import flight_estimate
from vopd.flight.flight import CameraPath, Flight, LandmarkSet, Picks
from vopd.flight.solve import solve
from vopd.geometry.earth import local_axes
from vopd.geometry.lenses import project

FORWARD = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
DOWN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


def flight(seed: int, name: str = "brown", frames: int = 3, noise_px: float = 0.0) -> Flight:
    """Frames of five landmarks each, with a velocity and a wind."""
    rng = np.random.default_rng(seed)
    lens = lenses()[name]
    seen = [random_frame(rng, lens, 5, noise_px) for _ in range(frames)]
    return Flight(
        name="a flight",
        source="flight.toml",
        lens=lens,
        frame=np.arange(frames),
        image_name=(),
        time_s=np.arange(frames) * 0.1,
        epoch=None,
        picks=Picks(
            np.repeat(np.arange(frames), 5),
            np.arange(5 * frames),
            np.concatenate([one.pixel for one in seen]),
            np.ones(5 * frames),
        ),
        landmarks=LandmarkSet(
            tuple(f"mark {k}" for k in range(5 * frames)),
            np.concatenate([one.landmark_m for one in seen]),
            np.full((5 * frames, 3), np.nan),
        ),
        path=CameraPath(
            np.array([one.camera_m for one in seen]),
            np.full(3, np.nan),
            velocity_m_s=rng.normal(0.0, 50.0, (frames, 3)),
            wind_m_s=rng.normal(0.0, 5.0, (frames, 2)),
        ),
        mount=FORWARD,
    )


def looking(camera_to_enu: list[list[float]], mount: np.ndarray) -> Estimate:
    """The estimate of a frame whose camera's right, down, forward are these columns."""
    rng = np.random.default_rng(5)
    base = flight(5, "pinhole", 1)
    axes = local_axes(base.path.position_m[0])
    ray = np.concatenate([rng.uniform(-0.3, 0.3, (5, 2)), np.ones((5, 1))], axis=1)
    points = base.path.position_m[0] + 300.0 * ray @ np.array(camera_to_enu).T @ axes
    flat = replace(base.refraction, k=0.0)
    marks = replace(base.landmarks, position_m=points)
    picks = replace(base.picks, pixel=project(base.lens, ray).pixel)
    one = replace(base, landmarks=marks, picks=picks, mount=mount, refraction=flat)
    return flight_estimate(solve(one))


S, C = 0.5, np.sqrt(0.75)
R = np.sqrt(0.5)
VECTORS = {  # camera to east, north, up by hand; DJI gimbal angles; YPR of a camera looking down
    "level, north": ([[1, 0, 0], [0, 0, 1], [0, -1, 0]], (0, 0, 0), (0, 90, 0)),
    "nadir, top north": ([[1, 0, 0], [0, -1, 0], [0, 0, -1]], (0, -90, 0), (0, 0, 0)),
    "60, 30 below": (
        [[S, -S * C, C * C], [-C, -S * S, C * S], [0, -C, -S]], (60, -30, 0), (60, 60, 0)
    ),
    "60, 30 below, right side 10 down": (
        [[0.417212, -0.513258, 0.75], [-0.896281, -0.095818, 0.433013],
         [-0.150384, -0.852869, -0.5]],
        (60, -30, 10), (79.425, 58.525, 16.740),
    ),
    "45, 20 above": (
        [[R, np.sin(np.radians(20)) * R, np.cos(np.radians(20)) * R],
         [-R, np.sin(np.radians(20)) * R, np.cos(np.radians(20)) * R],
         [0, -np.cos(np.radians(20)), np.sin(np.radians(20))]],
        (45, 20, 0), (-135, 70, 180),
    ),
}  # fmt: skip


def apart(one: np.ndarray, other: tuple[float, ...]) -> np.ndarray:
    return (one - np.array(other) + 180.0) % 360.0 - 180.0


@pytest.mark.parametrize("name", list(VECTORS))
def test_angles_are_those_of_the_published_vectors(name: str) -> None:
    matrix, gimbal, looking_down = VECTORS[name]
    forward, down = looking(matrix, FORWARD), looking(matrix, DOWN)
    if name == "nadir, top north":  # yaw and roll together
        together = forward.vehicle_deg[0] - [0.0, 0.0, forward.vehicle_deg[0, 0]]
        assert_close("published angle", forward.vehicle_deg[0, 1], -90.0)
        assert_close("published angle", apart(together[[2]] * -1.0, (0.0,)), 0.0)
    else:
        assert_close("published angle", apart(forward.vehicle_deg[0], gimbal), 0.0)
        assert_close("published angle", apart(forward.camera_deg[0], gimbal), 0.0)
        free = name == "level, north"  # looking down and pitched by 90: yaw and roll together
        shown = slice(1, 2) if free else slice(None)
        assert_close("published angle", apart(down.vehicle_deg[0], looking_down)[shown], 0.0)


def test_quaternion_turns_north_east_down_into_the_body() -> None:
    """Forward is the view: its components by the quaternion, q v q*."""
    matrix = np.array(VECTORS["60, 30 below, right side 10 down"][0])
    estimate = looking(matrix.tolist(), FORWARD)
    w, x, y, z = history(estimate).quaternion[0]
    forward = [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)]
    east, north, up = matrix[:, 2]
    assert_close("published cosine", forward, [north, east, -up])


def moved(one: Flight, **path: np.ndarray) -> Flight:
    return replace(one, path=replace(one.path, **path))


def slope(one: Flight, change: Callable[[float], Flight]) -> np.ndarray:
    """Camera yaw, pitch, roll (F, 3), radians by a unit of a change, by central differences."""
    step = 1e-3
    there, back = (flight_estimate(solve(f)).camera_deg for f in (change(step), change(-step)))
    return np.radians(apart(there, (0.0,)) - apart(back, (0.0,))) / (2.0 * step)


def test_angles_answer_to_picks_as_the_gain_says() -> None:
    one = flight(7)
    base = flight_estimate(solve(one))
    for pick, axis in ((0, 0), (7, 1), (13, 0)):

        def change(step: float, pick: int = pick, axis: int = axis) -> Flight:
            pixel = one.picks.pixel.copy()
            pixel[pick, axis] += step
            return replace(one, picks=replace(one.picks, pixel=pixel))

        frame, slot = divmod(pick, 5)
        expected = -base.gain[frame, :, slot + 5 * axis]  # image x is -u, y is -v
        assert_close("flight response", slope(one, change)[frame], expected)


@pytest.mark.parametrize("k", range(3), ids=["east", "north", "up"])
def test_angles_answer_to_position_and_landmark_as_the_responses_say(k: int) -> None:
    one = flight(8)
    base = flight_estimate(solve(one))
    here, there = local_axes(one.path.position_m), local_axes(one.landmarks.position_m)

    def camera(step: float) -> Flight:
        return moved(one, position_m=one.path.position_m + here[:, k] * step)

    def landmark(step: float) -> Flight:
        position = one.landmarks.position_m.copy()
        position[0] += there[0, k] * step
        return replace(one, landmarks=replace(one.landmarks, position_m=position))

    by_position = (base.gain @ base.responses.position[..., k, None])[..., 0]
    assert_close("flight response", slope(one, camera), by_position)
    only = np.zeros_like(base.residual[0])
    only[[0, 5]] = base.responses.landmark[0, [0, 5], k]
    assert_close("flight response", slope(one, landmark)[0], base.gain[0] @ only)


def test_angles_answer_to_time_and_focal_length_as_the_responses_say() -> None:
    one = flight(9, "pinhole")
    base = flight_estimate(solve(one))
    axes, velocity = local_axes(one.path.position_m), one.path.velocity_m_s
    assert velocity is not None
    way = np.einsum("fji,fj->fi", axes, velocity[:, [1, 0, 2]] * [1.0, 1.0, -1.0])

    def later(step: float) -> Flight:
        return moved(one, position_m=one.path.position_m + way / 100.0 * step)

    def longer(step: float) -> Flight:
        focal = one.lens.focal_px * (1.0 + step / one.lens.focal_px.mean())
        return replace(one, lens=replace(one.lens, focal_px=focal))

    by_time = (base.gain @ base.responses.time[..., None])[..., 0] / 100.0
    assert_close("flight response", slope(one, later), by_time)
    by_focal = (base.gain @ base.responses.focal_length[..., None])[..., 0]
    assert_close("flight response", slope(one, longer), by_focal)


@pytest.mark.parametrize("mount", [FORWARD, DOWN], ids=["forward", "down"])
def test_vehicle_and_attack_follow_the_camera_as_their_derivatives_say(mount: np.ndarray) -> None:
    one = replace(flight(10, "pinhole"), mount=mount)
    base = flight_estimate(solve(one))
    pixel = one.picks.pixel + np.array([0.02, -0.03])
    other = replace(one, picks=replace(one.picks, pixel=pixel))
    turned = flight_estimate(solve(other))
    camera = np.radians(apart(turned.camera_deg - base.camera_deg, (0.0,)))
    vehicle = np.radians(apart(turned.vehicle_deg - base.vehicle_deg, (0.0,)))
    attack = np.radians(turned.attack_deg - base.attack_deg)
    assert np.abs(camera).max() > 1e-6
    assert_close("flight turn", (base.vehicle_by_camera @ camera[..., None])[..., 0], vehicle)
    by_camera = base.responses.attack_by_camera
    assert_close("flight turn", (by_camera @ camera[..., None])[..., 0], attack)


def test_angles_of_attack_by_hand() -> None:
    matrix = VECTORS["60, 30 below"][0]
    rest = looking(matrix, FORWARD)
    assert np.isnan(rest.airspeed).sum() == 0  # the flight has a velocity
    one = flight(5, "pinhole", 1)
    assert one.path.velocity_m_s is not None and one.path.wind_m_s is not None
    north, east = one.path.velocity_m_s[0, :2] - one.path.wind_m_s[0]
    down = one.path.velocity_m_s[0, 2]
    to_camera = np.array(matrix).T @ [east, north, -down]  # right, down, forward
    v, w, u = to_camera
    expected = np.degrees([np.arctan2(w, u), np.arctan2(v, u), np.arctan2(np.hypot(v, w), u)])
    assert_close("published angle", rest.attack_deg[0], expected)


def test_frames_without_solution_are_nan_and_cost_no_other() -> None:
    one = flight(11)
    position = one.path.position_m.copy()
    position[1] = np.nan
    lost = moved(one, position_m=position)
    whole, base = flight_estimate(solve(lost)), flight_estimate(solve(one))
    assert np.isnan(whole.camera_deg[1]).all() and np.isfinite(whole.camera_deg[[0, 2]]).all()
    np.testing.assert_array_equal(whole.camera_deg[[0, 2]], base.camera_deg[[0, 2]])
    told = history(whole)
    assert told.status == ["solved", "unsolved", "solved"]
    assert "undetermined" in told.flag_text[1]


def test_a_history_has_finite_sigmas() -> None:
    one = flight(12, noise_px=0.5)
    told = history(flight_estimate(solve(one)))
    assert np.isfinite(told.uncertainty.total).all()


def test_the_lever_arm_is_applied_with_the_solved_attitude() -> None:
    one = flight(13)
    truth = flight_estimate(solve(one))
    arm = np.array([1.0, 0.5, -0.3])
    yaw, pitch, roll = np.radians(truth.vehicle_deg.T)
    away = np.zeros((3, 3))
    for k in range(3):  # body to north, east, down by elementary turns
        cy, sy, cp, sp = np.cos(yaw[k]), np.sin(yaw[k]), np.cos(pitch[k]), np.sin(pitch[k])
        cr, sr = np.cos(roll[k]), np.sin(roll[k])
        turn = (
            np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
            @ np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
            @ np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
        )
        north, east, down = turn @ arm
        away[k] = np.array([east, north, -down]) @ local_axes(one.path.position_m[k])
    behind = moved(one, position_m=one.path.position_m - away, lever_arm_m=arm)
    solved = flight_estimate(solve(behind))
    assert_close("published angle", solved.vehicle_deg, truth.vehicle_deg)
