"""The estimate of a flight: angles by published vectors, responses by differences."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit.flight_project import (
    EPOCH,
    LENS,
    MARKS,
    THREE_FRAMES,
    TIME_S,
    UNUSED,
    camera_m,
    local_to_camera,
    pixels,
    three_frames,
    truth_deg,
)
from tests.kit.random_flights import lenses, random_frame
from tests.tolerances import assert_close
from vopd.attitude.history import history
from vopd.estimate import Estimate, MapGrid
from vopd.flight.estimate import FlightEstimates, flight_estimate, lean_of_verticals_deg
from vopd.flight.flight import CameraPath, Flight, FlightOptions, LandmarkSet, Picks, Refraction
from vopd.flight.project.keys import ROWS
from vopd.flight.solve.rotations import SolvedFlight, solve
from vopd.flight.words import SIGMA_KEYS, flight_words
from vopd.geometry.earth import earth_centred_m, local_axes
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
            np.zeros((5 * frames, 3)),
        ),
        path=CameraPath(
            np.array([one.camera_m for one in seen]),
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


# Every field of a flight's estimate, by the truth that the flight was made from


@pytest.fixture(scope="module")
def solved() -> SolvedFlight:
    return solve(three_frames())


@pytest.fixture(scope="module")
def estimate(solved: SolvedFlight) -> Estimate:
    return flight_estimate(solved)


def test_what_the_estimate_is_of(estimate: Estimate) -> None:
    about = estimate.about
    assert (about.source, about.title, about.epoch) == ("flight.toml", "F12", EPOCH)
    assert about.words.surface != ""
    assert tuple(estimate.units) == ("m", "px", 1.0, "px", 1.0)
    assert estimate.frame.tolist() == [7, 9, 12]
    assert estimate.frame_names == ["a.jpg", "b.jpg", "c.jpg"]
    assert estimate.time_s.tolist() == TIME_S.tolist()
    assert estimate.status.tolist() == [4, 0, 0]  # unsolved, solved, solved
    assert estimate.solved.tolist() == estimate.converged.tolist() == [True] * 3
    assert estimate.landmark_names == dict(zip(range(1, 5), MARKS, strict=False))
    assert estimate.grid is not None and estimate.grid.easting.tolist() == [0, 1, 2]
    assert estimate.gimbal_deg is not None and estimate.gimbal_deg[1].tolist() == [3, 4, 5]
    assert (estimate.reading_spread, estimate.reading_floor) == (0.7, 0.2)
    assert estimate.focal_length == 1495.0  # of 1500 and 1490


def test_the_plane_of_figures_is_in_metres_on_a_grid_in_feet(estimate: Estimate) -> None:
    """A landmark 600 m north of another is not 2000 m north of it; UTM shrinks 4 in 10,000."""
    grid = MapGrid("+proj=utm +zone=33 +datum=WGS84 +units=us-ft", *np.zeros((3, 3)))
    scene = flight_estimate(solve(replace(three_frames(), grid=grid))).scene
    assert scene is not None
    plane, places = scene().plane, scene().landmark_m
    assert plane is not None
    on_grid_m = np.linalg.norm(np.diff(plane(places)[0], axis=0), axis=1)
    flat_m = (places - places[0]) @ local_axes(places[:1])[0].T
    assert_close("map on a grid", on_grid_m, np.linalg.norm(np.diff(flat_m[:, :2], axis=0), axis=1))


def test_a_frame_that_has_not_converged_is_not_said_to_have(solved: SolvedFlight) -> None:
    attitudes = solved.attitudes
    left = attitudes._replace(converged=np.array([False, True, False]))
    found = flight_estimate(replace(solved, attitudes=left))
    assert found.converged.tolist() == [True, True, False]  # the first has nothing to converge
    assert found.status.tolist() == [4, 0, 0]
    assert np.array_equal(found.correction_rad, attitudes.correction_rad, equal_nan=True)
    assert (np.abs(attitudes.correction_rad[1:]) > 0.0).any()


def test_which_picks_take_part(estimate: Estimate) -> None:
    assert estimate.landmark.tolist() == [[1, 2, 3, 4]] * 3
    assert estimate.used.tolist() == [[False] * 4, [True] * 3 + [False], [True] * 3 + [False]]
    assert estimate.ignored.tolist() == [[False] * 3 + [True]] * 3
    assert_close("ratio", estimate.relative_sigma, np.tile([0.25, 0.5, 1.0, 2.0], (3, 1)))
    for values in (estimate.direction, estimate.image):
        assert (values[0] == 0.0).all() and (values[:, UNUSED] == 0.0).all()
        assert (values[1:, :UNUSED] != 0.0).all()


def test_a_pick_without_weight_takes_no_part(solved: SolvedFlight) -> None:
    weight = solved.attitudes.weight.copy()
    weight[5] = 0.0
    found = flight_estimate(replace(solved, attitudes=solved.attitudes._replace(weight=weight)))
    assert found.used[1].tolist() == [True, False, True, False]
    assert not found.ignored[1, 1]


def test_angles_directions_and_images_are_the_truth(estimate: Estimate) -> None:
    truth = truth_deg()[1:THREE_FRAMES] % 360.0 - [0.0, 360.0, 0.0]
    assert_close("flight angle", estimate.camera_deg[1:], truth)
    assert_close("flight angle", estimate.vehicle_deg[1:], truth)
    for frame in (1, 2):
        ray = estimate.direction[frame, :UNUSED] @ local_to_camera(truth_deg()[frame]).T
        seen = project(LENS, ray).pixel
        assert_close("trial without noise", seen, pixels()[frame, :UNUSED])
        ideal = -1495.0 * ray[:, :2] / ray[:, 2:]
        assert_close("trial without noise", estimate.image[frame, :UNUSED], ideal)


def test_residuals_are_measured_less_computed_to_the_left_and_up(solved: SolvedFlight) -> None:
    """A pick 3 px to the right and 2 px down of its image, the attitude as it was."""
    pixel = solved.flight.picks.pixel.copy()
    pixel[[5, 7]] += [3.0, 2.0]
    one = replace(solved.flight, picks=replace(solved.flight.picks, pixel=pixel))
    found = flight_estimate(replace(solved, flight=one)).residual
    expected = np.zeros((3, 8))
    expected[1, [1, 5]] = [-3.0, -2.0]  # that of the check landmark takes no part
    assert_close("trial without noise", found, expected)


def test_positions_and_how_far_the_camera_went(estimate: Estimate) -> None:
    """From the first position that is known, 20 m/s north, 5 m/s east, 2 m/s up."""
    where, camera = estimate.position, camera_m(TIME_S)
    back = earth_centred_m(where.latitude_deg, where.longitude_deg, where.altitude)
    assert_close("flight position", back[1:], camera[1:])
    sine = camera[1:, 2] / np.linalg.norm(camera[1:], axis=1)
    assert_close("latitude, deg", where.geocentric_latitude_deg[1:], np.degrees(np.arcsin(sine)))
    lat, lon = np.radians(where.latitude_deg[2]), np.radians(where.longitude_deg[2])
    north = [-np.sin(lat) * np.cos(lon), -np.sin(lat) * np.sin(lon), np.cos(lat)]
    down = [-np.cos(lat) * np.cos(lon), -np.cos(lat) * np.sin(lon), -np.sin(lat)]
    assert_close("ratio", where.north_east_down[2], [north, [-np.sin(lon), np.cos(lon), 0], down])
    assert_close("flight position", estimate.displacement[1:], [[0, 0, 0], [0.5, 2.0, 0.2]])
    assert where.largest_lean_deg is not None
    lean = where.latitude_deg - where.geocentric_latitude_deg
    assert where.largest_lean_deg == np.nanmax(np.abs(lean)) > 0.19


def test_the_lean_is_the_largest_of_both_hemispheres() -> None:
    """tan of the geocentric latitude is (1 - f)2 tan of the geodetic one, on the ground."""
    ratio = (1 - 1 / 298.257223563) ** 2
    lean = 45.0 - np.degrees(np.arctan(ratio))
    somewhere = earth_centred_m([-45.0, np.nan, 10.0], [20.0, 30.0, 40.0], [0.0, 0.0, 0.0])
    assert_close("latitude, deg", lean_of_verticals_deg(somewhere), lean)
    assert (
        lean_of_verticals_deg(np.full((2, 3), np.nan))
        == 0.0
        == lean_of_verticals_deg(np.zeros((0, 3)))
    )


def test_a_flight_without_any_position_has_no_origin(solved: SolvedFlight) -> None:
    lost = replace(solved, camera_m=np.full((3, 3), np.nan))
    assert np.isnan(FlightEstimates(lost).origin_m).all()


def test_without_velocity_or_acceleration(solved: SolvedFlight) -> None:
    path = solved.flight.path
    for without in (
        replace(path, velocity_m_s=None),
        replace(path, acceleration_m_s2=None, wind_m_s=None),
    ):
        found = flight_estimate(replace(solved, flight=replace(solved.flight, path=without)))
        if without.velocity_m_s is None:
            assert np.isnan(found.attack_deg).all() and np.isnan(found.airspeed).all()
        else:
            assert (found.responses.attack_by_time[1:] == 0.0).all()
            assert_close("ratio", found.airspeed[1:], np.full(2, np.sqrt(429.0)))


def test_stated_sigmas_are_those_of_each_landmark_and_of_all_frames(estimate: Estimate) -> None:
    """Four landmarks, two with standard deviations: 1, 2, 3 m and 7, 4, 1 m."""
    stated = estimate.stated
    assert estimate.landmark_sigma is not None and estimate.fix_sigma is not None
    assert estimate.fix_sigma.tolist() == [[0.5, 0.0, 0.25]] * 3
    own = estimate.landmark_sigma[estimate.used]
    assert {tuple(row) for row in own.tolist()} == {(1.0, 2.0, 3.0), (7.0, 4.0, 1.0), (0.0,) * 3}
    assert stated.landmark == stated.position == stated.place == (0.0, 0.0, 0.0)
    assert stated.time_s == 0.01
    assert_close("ratio", stated.focal_length, 0.002 * 1495.0)
    assert stated.principal_point == (1.5, 2.5)


# What the output says of a flight: refraction, angles of attack, time, repeated picks


CAMERA = np.array([6_379_137.0, 0.0, 0.0])  # 1000 m above the equator
RAY = np.array([[-0.2, -0.1, 1.0], [0.3, 0.1, 1.0], [0.1, -0.2, 1.0], [-0.1, 0.2, 1.0]])
LEVEL_NORTH = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])  # right, down, forward
CONSTANT = Refraction(0.13, decays=False)


def level_flight(**changes: Any) -> Flight:
    """One frame, level to the north, of four landmarks 10 km to the north of the camera."""
    lens = lenses()["pinhole"]
    made = Flight(
        name="a flight",
        source="flight.toml",
        lens=lens,
        frame=np.arange(1),
        image_name=(),
        time_s=np.zeros(1),
        epoch=None,
        picks=Picks(np.zeros(4, int), np.arange(4), project(lens, RAY).pixel, np.ones(4)),
        landmarks=LandmarkSet(
            tuple("abcd"),
            CAMERA + 10e3 * RAY @ LEVEL_NORTH @ local_axes(CAMERA),
            np.zeros((4, 3)),
        ),
        path=CameraPath(CAMERA[None]),
        mount=np.eye(3),
    )
    return replace(made, **changes)


def said(name: str, **changes: Any) -> str:
    return flight_words(solve(level_flight(**changes))).conventions[name]


def test_no_refraction() -> None:
    assert said("refraction", refraction=Refraction(0.0)) == "off"


def test_lines_of_sight_that_bend_the_other_way() -> None:
    words = said("refraction", refraction=Refraction(-0.1, decays=False))
    assert_approved(words)


def test_constant_refraction_and_the_most_it_does() -> None:
    """k s cos(elevation) / 2R of the landmark farthest along the ground: 10 km by hypot(1, .3)."""
    degree = np.degrees(0.13 * 10e3 * np.sqrt(1.0 + 0.3**2) / (2.0 * 6371e3))
    assert_approved(said("refraction", refraction=CONSTANT), parts=[f"{degree:.5f}"])


def test_refraction_that_decays() -> None:
    """All lines are below 3 km: it is less than constant refraction, and more than exp(-3/8)."""
    words = said("refraction", refraction=Refraction(0.2))
    start, _, figure = words.removesuffix(" degree at most").rpartition(" by ")
    assert_approved(start)
    constant = np.degrees(0.2 * 10e3 * np.sqrt(1.0 + 0.3**2) / (2.0 * 6371e3))
    assert constant * np.exp(-3.0 / 8.0) < float(figure) < constant


def test_without_a_position_nothing_is_raised() -> None:
    unknown = CameraPath(np.full((1, 3), np.nan))
    words = said("refraction", refraction=CONSTANT, path=unknown)
    assert_approved(words)


@pytest.mark.parametrize(
    ("velocity", "wind"),
    [(None, None), ([[9.0, 0.0, 0.0]], None), ([[9.0, 0.0, 0.0]], [[1.0, 0.0]])],
)
def test_what_angles_of_attack_are_against(
    velocity: list[list[float]] | None, wind: list[list[float]] | None
) -> None:
    path = CameraPath(
        CAMERA[None],
        velocity_m_s=None if velocity is None else np.array(velocity),
        wind_m_s=None if wind is None else np.array(wind),
    )
    assert_approved(said("angles of attack", path=path))


@pytest.mark.skipif(not hasattr(time, "tzset"), reason="no time zone by environment")
def test_where_time_begins(monkeypatch: pytest.MonkeyPatch) -> None:
    """In UTC, also where the computer's own zone is another."""
    monkeypatch.setenv("TZ", "Asia/Tokyo")
    time.tzset()
    try:
        _where_time_begins()
    finally:
        monkeypatch.delenv("TZ")
        time.tzset()


def _where_time_begins() -> None:
    assert_approved(said("time"))
    epoch = datetime(2024, 5, 1, 12, 30, 0, 250_000, UTC)
    assert_approved(said("time", epoch=epoch))


def test_every_other_sentence_about_a_flight() -> None:
    velocity = CameraPath(CAMERA[None], velocity_m_s=np.array([[9.0, 0, 0]]))
    options = FlightOptions("cauchy")
    given = level_flight(about=("one", "two, x", "three"), options=options, path=velocity)
    words = flight_words(solve(given))
    assert [*words.conventions] == [
        "input", "solve", "pixels", "refraction", "angles of attack", "position", "time",
        "mount",
    ]  # fmt: skip
    assert words.conventions["input"] == "one; two, x; three"
    assert_approved(words.conventions["solve"])
    assert_approved(words.conventions["pixels"])
    assert_approved(words.conventions["angles of attack"])
    assert (words.source, words.landmark, words.reading) == (
        "project", "its name", "a pick's u or v",
    )  # fmt: skip
    assert_approved(words.flags)


def test_the_gimbal_is_compared_with_the_solved_angles() -> None:
    """The camera looks level to the north: the gimbal said 3 degrees up."""
    path = CameraPath(CAMERA[None], gimbal_deg=np.array([[0.0, 3.0, 0.0]]))
    sentence = said("gimbal", path=path, refraction=Refraction(0.0))
    assert_approved(sentence)
    assert "right -3.00" in sentence


@pytest.mark.parametrize(("convergence", "said_deg"), [(1.23456, "1.2346"), (-0.5, "-0.5000")])
def test_a_grid_has_its_convergence(convergence: float, said_deg: str) -> None:
    one = np.zeros(1)
    grid = MapGrid("EPSG:32633", one, one, np.array([convergence]))
    assert_approved(said("grid azimuth", grid=grid), parts=[said_deg])


def test_the_keys_of_standard_deviations_are_there() -> None:
    for component, text in SIGMA_KEYS.items():
        *sections, keys = re.split(r"\[(\w+)\](?: or )?", text)
        named = [one for one in sections if one]
        for key in re.findall(r"\w+", keys.partition(":")[0]):
            for section in named:
                assert (section, key) in ROWS, (component, section, key)
