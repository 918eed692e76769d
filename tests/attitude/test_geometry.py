"""Geometry of the landmarks: condition, free axis, one landmark, second solution."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from tests.approved.texts import assert_approved
from tests.kit import repeated_frame
from tests.kit.estimates import FOCAL, estimate, no_landmark, one_landmark
from tests.kit.jobs import film, only, reread, turned
from tests.kit.wgs84_film import camera_matrix
from tests.tolerances import assert_close, within
from vopd.attitude import geometry as second_solution
from vopd.attitude.flags import MAX_CONDITION
from vopd.attitude.geometry import (
    AXES,
    LandmarkGeometry,
    free_turn_text,
    landmark_geometry,
    second_solution_rms,
    weak_axis_text,
)
from vopd.attitude.history import History, history
from vopd.attitude.sigmas import Sigmas, angle_gains
from vopd.attitude.uncertainty import uncertainty
from vopd.errata import fixes
from vopd.estimate import Estimate
from vopd.film import film_estimate
from vopd.geometry.rotation_fit import Sights
from vopd.geometry.rotations import angles_by_turns, turns_by_body_angles
from vopd.job import Job
from vopd.pipeline import run

NARROW = [[0.1, 0.0], [-0.1, 0.1], [0.0, -0.1]]
LINE = [[5.0, 0.0], [-5.0, 0.0], [2.0, 0.1]]
WIDE = [[3.0, 2.0], [-4.0, 1.0], [1.0, -4.0], [2.0, 2.0]]
NEAR_POLE = [30.0, -89.99, 200.0]


def by_turned_rays(image: np.ndarray) -> tuple[float, np.ndarray]:
    """Condition and weakest axis of differences of images of slightly turned rays."""
    rays = np.column_stack([image, np.full(len(image), FOCAL)])
    columns = []
    for axis in np.eye(3):
        images = []
        for step in (1e-6, -1e-6):
            x, y, z = Rotation.from_rotvec(step * axis).apply(rays).T
            images.append(FOCAL * np.concatenate([x / z, y / z]))
        columns.append((images[0] - images[1]) / 2e-6)
    _, sizes, axes = np.linalg.svd(np.stack(columns, axis=1))
    return float(sizes[0] / sizes[2]), axes[2]


@pytest.mark.parametrize("truth", [[140.0, -80.0, 60.0], NEAR_POLE, [10.0, 3.0, 0.0]], ids=str)
@pytest.mark.parametrize("image", [NARROW, LINE, WIDE], ids=["narrow", "line", "wide"])
def test_condition_by_turning_rays(truth: list[float], image: list[list[float]]) -> None:
    """The same wherever the camera looks, almost straight down too."""
    found = landmark_geometry(estimate(np.array([truth]), np.array(image)))
    condition, axis = by_turned_rays(np.array(image))
    assert abs(found.condition[0] / condition - 1.0) < within("condition by turned rays")
    assert found.weak_axis[0] == np.abs(axis).argmax()
    assert (condition > MAX_CONDITION) == (image is NARROW)
    assert not found.behind.any()


coordinate = st.integers(-5000, 5000).map(lambda micrometres: micrometres / 1000.0)
points = st.lists(st.tuples(coordinate, coordinate), min_size=2, max_size=6, unique=True)


@given(points)
def test_condition_of_any_image(image: list[tuple[float, float]]) -> None:
    """As far as differences of 1e-6 radian can tell."""
    condition, _ = by_turned_rays(np.array(image))
    found = landmark_geometry(estimate([200.0, -60.0, 30.0], np.array(image)))
    if condition < 1e4:
        assert abs(found.condition[0] / condition - 1.0) < within("large condition by turned rays")
    else:
        assert not found.condition[0] < 5e3


@pytest.mark.parametrize(
    ("centre", "axis"),
    [([0.0, 0.0], "optical axis"), ([40.0, 0.0], "image x axis"), ([0.0, -40.0], "image y axis")],
)
def test_landmarks_close_together_leave_the_turn_about_their_direction(
    centre: list[float], axis: str
) -> None:
    """40 mm, four focal lengths, from the centre that is nearer to an image axis."""
    found = landmark_geometry(estimate([140.0, -70.0, 60.0], np.array(centre) + np.array(NARROW)))
    assert AXES[found.weak_axis[0]] == axis and found.condition[0] > MAX_CONDITION


def test_the_limit_is_twenty() -> None:
    """Two landmarks d to either side of the centre: by hand the condition is f/d + d/f."""
    for apart, expected in ((0.522, False), (0.520, True)):
        image = np.array([[-apart, 0.0], [apart, 0.0]])
        condition = float(landmark_geometry(estimate([140.0, -70.0, 60.0], image)).condition[0])
        by_hand = (FOCAL**2 + apart**2) / (FOCAL * apart)
        assert abs(condition / by_hand - 1.0) < within("condition by hand")
        assert (condition > MAX_CONDITION) == expected


@pytest.mark.parametrize(
    ("turned", "used", "behind"),
    [(2, True, True), (0, True, True), (2, False, False), (None, True, False)],
)
def test_a_landmark_behind_the_camera_counts_if_it_takes_part(
    turned: int | None, used: bool, behind: bool
) -> None:
    """Of two frames the second has one landmark on the opposite side."""
    one = estimate(np.tile([140.0, -70.0, 60.0], (2, 1)))
    direction, part = one.direction.copy(), one.used.copy()
    if turned is not None:
        direction[1, turned] *= -1.0
        part[1, turned] = used
    found = landmark_geometry(replace(one, direction=direction, used=part))
    assert found.behind.tolist() == [False, behind]


# What determines nothing


def history_of(job: Job) -> History:
    (one,) = run(job).histories()
    return one


def with_landmarks(job: Job, rows: dict[int, list[int]]) -> Job:
    """The job with only these landmarks in some of its frames."""
    present = job.readings.present.copy()
    for frame, chosen in rows.items():
        present[frame] = np.isin(np.arange(present.shape[1]), chosen)
    landmark = np.where(present, job.readings.landmark, 0)
    return replace(job, readings=reread(job.readings, present=present, landmark=landmark))


def means_nothing(one: History, frame: int) -> bool:
    """Flagged, and without any standard deviation that could be believed."""
    flagged = bool(one.flags.raised["undetermined"][frame])
    return flagged and not np.isfinite(one.uncertainty.total[frame]).any()


def test_frames_of_few_landmarks() -> None:
    """None (a frame that is `exact` without any landmark), one, two, five."""
    one = history_of(with_landmarks(film(4), {0: [], 1: [2], 2: [0, 3]}))
    assert one.status == ["exact", "solved", "solved", "solved"]
    assert [means_nothing(one, k) for k in range(4)] == [True, True, False, False]
    assert one.landmarks.tolist() == [0, 1, 2, 5]
    assert np.isfinite(one.uncertainty.total[2:]).all()


@pytest.mark.parametrize("count", [2, 3, 5])
def test_one_landmark_read_several_times(count: int) -> None:
    """Rounding does not make an attitude of it, in none of 50 frames."""
    rng = np.random.default_rng(1)
    job = repeated_frame.repeated(landmarks=[2] * count, draws=50)
    one = history_of(repeated_frame.misread(job, 1e-4, rng))
    assert all(means_nothing(one, k) for k in range(50))


def test_landmarks_a_hundred_feet_apart_are_weak_and_flagged() -> None:
    """At 40 km: a standard deviation of many degrees about the line of sight."""
    job = repeated_frame.repeated(landmarks=(2, 2), draws=4)
    marks = job.landmarks
    second = marks.number == 14
    pair = replace(
        marks,
        longitude_min=np.where(second, marks.longitude_min[2], marks.longitude_min),
        latitude_min=np.where(second, marks.latitude_min[2] + 0.0165, marks.latitude_min),
        altitude_ft=np.where(second, marks.altitude_ft[2], marks.altitude_ft),
    )
    number = np.tile([13, 14], (4, 1))
    job = replace(job, landmarks=pair, readings=reread(job.readings, landmark=number))
    one = history_of(job)
    assert one.flags.raised["weak_geometry"].all() and not one.flags.raised["undetermined"].any()
    assert (one.geometry.condition > 500.0).all()


def test_the_geometry_of_some_frames_and_of_one_landmark() -> None:
    angles = np.array([[30.0, -60.0, 20.0], [40.0, -70.0, 30.0], [50.0, -80.0, 40.0]])
    every = landmark_geometry(estimate(angles, np.array([NARROW, LINE, WIDE[:3]])))
    some = every.take(slice(1, 3))
    for name in ("condition", "weak_axis", "behind"):
        assert getattr(some, name).tolist() == getattr(every, name)[1:].tolist()
    alone = landmark_geometry(estimate(angles, np.array(WIDE[:1])))
    assert not (alone.condition < 1e12).any()


# The details of the flags of frames with weak geometry, by estimates made by hand


FREE = re.compile(r"undetermined:turn about azimuth (\d+\.\d) elevation (-?\d+\.\d) is free")


def axis_of(one: History, frame: int = 0) -> np.ndarray:
    """The axis that the flag names, as a unit vector east, north, up."""
    found = FREE.search(one.flag_text[frame])
    assert found, one.flag_text[frame]
    azimuth, elevation = np.radians([float(found[1]), float(found[2])])
    level = np.cos(elevation)
    return np.array([level * np.sin(azimuth), level * np.cos(azimuth), np.sin(elevation)])


@pytest.mark.parametrize("landmark", range(4))
def test_with_one_landmark_the_turn_about_its_line_of_sight_is_free(landmark: int) -> None:
    one = history(one_landmark(landmark))
    towards = one.estimate.direction[0, landmark]
    assert_close("cosine of a printed axis", axis_of(one) @ towards, 1.0)
    assert "undetermined" not in one.flag_text[1]


def test_the_covariance_is_infinite_along_the_free_axis_only() -> None:
    """The camera looks straight at the landmark: only its roll is free, forward is the axis."""
    image = np.array([[0.0, 0.0], [3.0, 2.0], [-2.0, 3.0]])
    one = estimate([[30.0, -20.0, 0.0]], image)
    used = np.array([[True, False, False]])
    nothing = np.full_like(one.gain, np.nan)
    one = replace(one, used=used, gain=nothing, body_gain=nothing)
    covariance = history(one).uncertainty.covariance_deg2[0]
    assert covariance[0, 0] == np.inf and np.isfinite(covariance[1:, 1:]).all()
    sigma = history(one).uncertainty.total[0]
    assert np.isinf(sigma[[2, 5]]).all() and np.isfinite(sigma[[0, 1, 3, 4]]).all()


def test_without_a_landmark_nothing_is_said() -> None:
    assert history(no_landmark()).flag_text[0].split(";")[0] == "undetermined"


def test_a_deck_with_one_landmark() -> None:
    """Its body is that of the camera: the axis in the body, turned to north, east, down."""
    (one,) = run(repeated_frame.repeated(landmarks=[2], draws=1)).histories()
    towards = one.estimate.direction[0, 0]
    assert_close("cosine of a printed axis", axis_of(one) @ towards, 1.0)


def test_sigmas_about_the_weak_axis_and_the_others() -> None:
    turn = Rotation.from_euler("ZYX", [40.0, 20.0, 70.0], degrees=True).as_matrix()
    matrices = np.array([turn @ np.diag([0.01, 4.0, 0.0625]) @ turn.T, np.full((3, 3), np.inf)])
    shape = LandmarkGeometry(np.array([30.0, 30.0]), np.array([2, 0]), np.ones((2, 1)))
    told = weak_axis_text(shape, matrices, np.ones(len(matrices), bool))
    assert told == ["optical_axis sigma 2 others 0.25 0.1", "image_x_axis"]


def test_two_landmarks_close_together() -> None:
    """A turn about the line of sight moves one .1 px against the other, two readings of sigma."""
    one = history(estimate([[30.0, 0.0, 0.0]], np.array([[0.0, -0.05], [0.0, 0.05]])))
    detail = one.flags.detail["weak_geometry"][0]
    found = re.fullmatch(r"optical_axis sigma (\S+) others (\S+) (\S+)", detail)
    assert found and one.flags.raised["weak_geometry"][0]
    sigma = one.uncertainty.reading.sigma
    turn = np.degrees(sigma * np.sqrt(2.0) / 0.1)
    assert_close("ratio of three digits", float(found[1]) / turn, 1.0)


def level(turn: list[float], seen: list[list[float]], used: list[bool]) -> str:
    """What is said of a level vehicle heading north; directions are east, north, up."""
    e = estimate([[0.0, 0.0, 0.0]], np.zeros((len(seen), 2)))
    e = replace(e, direction=np.array([seen], float), used=np.array([used]))
    return free_turn_text(e, np.array([turn]))[0]


@pytest.mark.parametrize(
    ("turn", "seen", "used", "azimuth", "elevation"),
    [
        ([1.0, 0.0, 0.0], [[0.1, 1, 0]], [True], "0.0", "0.0"),
        ([1.0, 0.0, 0.0], [[0.1, -1, 0]], [True], "180.0", "0.0"),  # the landmark is behind
        ([0.0, 1.0, 0.0], [[1, 0, 0]], [True], "90.0", "0.0"),
        ([0.0, 1.0, 0.0], [[-1, 0, 0]], [True], "270.0", "0.0"),
        ([0.0, 0.0, 1.0], [[0, 0, -1]], [True], "0.0", "-90.0"),
        ([0.0, 0.0, 1.0 + 1e-15], [[0, 0, -1]], [True], "0.0", "-90.0"),  # by rounding
        ([0.6, 0.0, 0.8], [[0, 1, -1]], [True], "0.0", "-53.1"),
        ([0.6, 0.0, 0.8], [[0, -1, 1]], [True], "180.0", "53.1"),
        ([0.6, -0.8, 0.0], [[-1, 1, 0]], [True], "306.9", "0.0"),
        ([1.0, 0.0, 0.0], [[0, 1, 0], [0, -3, 0]], [True, False], "0.0", "0.0"),
        ([1.0, 0.0, 0.0], [[0, 1, 0], [0, -3, 0]], [True, True], "180.0", "0.0"),
        ([1.0, 0.0, 0.0], [[0, -1, 0], [0, np.nan, 0]], [True, True], "180.0", "0.0"),
    ],
)
def test_the_end_of_the_free_axis_on_the_landmarks_side(
    turn: list[float], seen: list[list[float]], used: list[bool], azimuth: str, elevation: str
) -> None:
    said = level(turn, seen, used)
    assert_approved(said.replace("-0.0 ", "0.0 "), parts=[azimuth, elevation])


@pytest.mark.parametrize("turn", [[0.0, 0.0, 0.0], [np.nan, 0.0, 0.0]])
def test_no_free_axis_no_words(turn: list[float]) -> None:
    assert level(turn, [[0, 1, 0]], [True]) == ""


def test_a_covariance_that_is_singular_by_rounding_has_a_sigma_of_nothing() -> None:
    shape = LandmarkGeometry(np.full(3, 30.0), np.array([0, 1, 2]), np.ones((3, 1)))
    some = np.array([np.diag([4.0, -1e-20, 1.0]), np.diag([0.0, 4.0, 9.0]), np.eye(3)])
    told = weak_axis_text(shape, some, np.array([True, True, False]))
    assert told == ["image_x_axis sigma 2 others 1 0", "image_y_axis sigma 3 others 2 0", ""]


# Frames with one landmark: two turns out of three are determined


ANGLES = np.array([[140.0, -60.0, 20.0], [20.0, 30.0, 330.0]])
GIVEN = Sigmas(reading=0.5, mount_deg=0.4)


def made() -> Estimate:
    """Two frames whose vehicle and angles of attack go with the camera in any way."""
    rng = np.random.default_rng(8)
    e = estimate(
        ANGLES, vehicle_deg=ANGLES[::-1] + 7.0, vehicle_by_camera=rng.normal(size=(2, 3, 3))
    )
    by_camera = rng.normal(size=(2, 3, 3))
    return replace(e, responses=replace(e.responses, attack_by_camera=by_camera))


def test_one_landmark_determines_two_turns_out_of_three() -> None:
    """The gains are those of least squares without the turn about the line of sight."""
    e = made()
    used = np.array([[False, True, False, False], [True] * 4])
    e = replace(e, used=used, gain=np.where([[[True]], [[False]]], np.nan, e.gain))
    found = angle_gains(e)
    by_turns = angles_by_turns(np.radians(e.camera_deg))[0]
    rows = np.where(np.tile(used[0], 2)[:, None], e.partials[0], 0.0) @ by_turns
    inverse = np.linalg.pinv(rows, rcond=1e-9)
    assert np.linalg.matrix_rank(rows, tol=1e-9) == 2
    to_attack, to_vehicle = e.responses.attack_by_camera[0], e.vehicle_by_camera[0]
    chain = np.vstack([np.eye(3), to_vehicle, to_attack]) @ by_turns
    body = turns_by_body_angles(np.radians(e.vehicle_deg))[0] @ to_vehicle @ by_turns
    assert_close("inverse element", found.angles[0], chain @ inverse)
    assert_close("inverse element", found.body[0], body @ inverse)
    free = np.linalg.svd(rows)[2][2]
    axis = body @ free / np.linalg.norm(body @ free)
    along = found.free_turn[0] @ axis
    assert_close("inverse element", np.abs(along), 1.0)
    assert_close("inverse element", found.free_turn[0] * along, axis)
    assert found.free[0].all() and not found.free[1].any() and not found.free_turn[1].any()
    covariance = uncertainty(e, GIVEN).covariance_deg2[0]
    assert np.isinf(covariance).all()
    assert np.array_equal(np.sign(covariance), np.sign(np.outer(axis, axis)))


def test_angles_that_the_free_turn_does_not_change_are_known() -> None:
    """The camera looks at the landmark: only camera roll and vehicle roll are free, in any
    attitude. Of these no component is stated, and the total is infinite.
    """
    angles = [[33.0, -21.0, 47.0], [140.0, 60.0, 200.0], [77.0, -85.0, 3.0]]
    e = estimate(angles, np.array([[0.0, 0.0], [3.0, 2.0], [-2.0, 3.0]]))
    nothing = np.full_like(e.gain, np.nan)
    used = np.tile([True, False, False], (3, 1))
    found = uncertainty(replace(e, used=used, gain=nothing, body_gain=nothing), GIVEN)
    free = np.isin(np.arange(9), [2, 5, 8])  # roll, and eta, which goes with it here
    assert (np.isinf(found.total) == free).all() and (np.isinf(found.half_width_95) == free).all()
    for one in found.components.values():
        assert (np.isnan(one) == free).all()
    no_attitude = np.full((3, 3), np.nan)
    lost = uncertainty(
        replace(e, camera_deg=no_attitude, gain=nothing, body_gain=nothing, used=used), GIVEN
    )
    assert np.isnan(lost.covariance_deg2).all() and np.isnan(lost.total).all()


# The attitude with the landmarks behind the camera, against scipy's search for the best


def best_behind(one: Estimate) -> float:
    """The least root mean square of all minima with the landmarks behind, by scipy."""
    used = one.used[0]
    measured, cosines = one.image[0][used], one.direction[0][used]
    best = np.inf
    rng = np.random.default_rng(0)

    def residual(turn: np.ndarray, base: np.ndarray) -> np.ndarray:
        p, q, r = Rotation.from_rotvec(turn).as_matrix() @ base @ cosines.T
        return np.concatenate([measured[:, 0] - 10.4 * p / r, measured[:, 1] - 10.4 * q / r])

    for base in Rotation.random(12, random_state=rng).as_matrix():
        fit = least_squares(residual, np.zeros(3), args=(base,), method="lm", xtol=1e-14)
        ahead = (Rotation.from_rotvec(fit.x).as_matrix() @ base @ cosines.T)[2]
        if (ahead < 0.0).all():
            best = min(best, float(np.sqrt(np.mean(fit.fun**2))))
    return best


@pytest.mark.parametrize(
    ("landmarks", "pitch"),
    [((0, 3), -80.0), ((0, 3), -70.0), ((0, 1, 2), -80.0), ((0, 1, 3, 4), -70.0)],
)
def test_the_second_solution_is_the_best_on_the_other_side(
    landmarks: tuple[int, ...], pitch: float
) -> None:
    angles = np.array([[140.0, pitch, 60.0]])
    job = only(turned(angles, angles[0]), *landmarks)
    one = film_estimate(run(job, fixes("first-landmark"))[0])
    found = float(second_solution_rms(one)[0])
    best = best_behind(one)
    assert_close("minimiser's residual", found, best)
    assert (len(landmarks) == 2) == (best < within("exact fit"))


@pytest.mark.parametrize("spread", [1.0, 0.3, 0.03, 1e-3])
def test_what_cannot_fit_is_not_searched_and_what_fits_is_found(spread: float) -> None:
    """Landmarks about a line in the image, whose plane the second attitude is mirrored at."""
    points = np.random.default_rng(3).uniform(-4.0, 4.0, (200, 4, 2)) * [1.0, spread]
    frames = estimate(np.tile([140.0, -70.0, 60.0], (len(points), 1)), points, noise=0.01)
    every = second_solution_rms(frames)
    assert np.isfinite(every).sum() > 20
    for limit in np.nanquantile(every, [0.0, 0.2, 0.9]):
        found, fits = second_solution_rms(frames, limit), every <= limit
        assert (found[fits] == every[fits]).all()
        assert not (found[~fits] <= limit).any()
    skipped = np.isnan(second_solution_rms(frames, 0.0)) & np.isfinite(every)
    assert skipped.any()


FLAT = np.array([[3.0, 0.3], [-4.0, -0.2], [1.0, -0.3], [2.0, 0.2], [-1.0, 0.1]])


def mirrored(one: Estimate, k: int) -> float:
    """Least squares by scipy from the attitude mirrored at the landmarks' plane."""
    here = one.used[k]
    cosines, measured = one.direction[k, here], one.image[k, here]
    normal = np.linalg.svd(cosines)[2][2]
    base = -camera_matrix(*one.camera_deg[k]) @ (np.eye(3) - 2.0 * np.outer(normal, normal))

    def residual(turn: np.ndarray) -> np.ndarray:
        p, q, r = Rotation.from_rotvec(turn).as_matrix() @ base @ cosines.T
        return np.concatenate([measured[:, 0] - 10.4 * p / r, measured[:, 1] - 10.4 * q / r])

    fit = least_squares(residual, np.zeros(3), method="lm", xtol=1e-14)
    assert ((Rotation.from_rotvec(fit.x).as_matrix() @ base @ cosines.T)[2] < 0.0).all()
    return float(np.sqrt(np.mean(fit.fun**2)))


@pytest.mark.parametrize("count", [2, 3, 5])
def test_frames_by_hand(count: int) -> None:
    """Solved, one landmark only, not solved, and with a landmark that takes no part."""
    angles = np.tile([140.0, -60.0, 20.0], (4, 1))
    points = np.array([FLAT[:count]] * 4) + np.random.default_rng(1).normal(0, 0.02, (4, count, 2))
    points[3, -1] = 1.0, 9.0  # which would spoil the plane
    used = np.ones((4, count), bool)
    used[1, 1:] = used[3, -1] = False
    solved = np.array([True, True, False, True])
    one = estimate(angles, np.array([FLAT[:count]] * 4), used=used, solved=solved)
    one.__dict__["image"] = points
    found = second_solution_rms(one)
    least = count > 2
    assert np.isfinite(found).tolist() == [True, False, False, least]
    assert_close("minimiser's residual", found[0], mirrored(one, 0))
    if least:
        assert_close("minimiser's residual", found[3], mirrored(one, 3))
    for limit in (found[0] * 1.001, found[0] * 0.999):
        some = second_solution_rms(one, limit)[0]
        assert some == found[0] or (np.isnan(some) and limit < found[0])
    if least:
        assert np.isnan(second_solution_rms(one, 1e-9)[0])


def test_a_solution_behind_the_camera_is_always_searched() -> None:
    """Directions that point away show the same image; the other side is then the front, and the
    bound that spares a search is not for it.
    """
    angles = np.tile([140.0, -60.0, 20.0], (1, 1))
    front = estimate(angles, FLAT)
    behind = estimate(angles, FLAT, direction=-front.direction)
    (expected,) = second_solution_rms(front)
    assert_close("minimiser's residual", second_solution_rms(behind, 1e-9), [expected])
    assert np.isnan(second_solution_rms(front, 1e-9)).all()


@pytest.mark.parametrize(
    ("same_side", "turn", "found"),
    [([], 0.9e-3, True), ([], 1.1e-3, False), ([], np.nan, False), ([1], 1e-9, False),
     ([0, 1, 2, 3, 4], 1e-9, False)],
)  # fmt: skip
def test_a_second_solution_has_settled_with_all_landmarks_on_the_other_side(
    same_side: list[int], turn: float, found: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A last turn below a thousandth of a radian. Directions are turned instead of the camera."""
    one = estimate(np.array([[140.0, -60.0, 20.0]]), FLAT)
    axes = camera_matrix(140.0, -60.0, 20.0)[None]
    sides = iter([np.isin(np.arange(5), same_side)[None] - 0.5, np.ones((1, 5))])
    monkeypatch.setattr(
        second_solution, "fit_rotations", lambda *_: (axes, np.array([[0.0, -turn, 0.0]]))
    )
    monkeypatch.setattr(second_solution, "ahead", lambda *_: next(sides))
    sights = Sights(one.direction, one.image, one.used, 10.4)
    assert np.isfinite(second_solution._searched(sights, axes)).tolist() == [found]


def test_the_bound_allows_for_the_residuals_of_the_first_solution() -> None:
    """An image that the second solution fits exactly, and the first one badly."""
    one = estimate(np.array([[140.0, -60.0, 20.0]]), FLAT)
    cosines = one.direction[0]
    normal = np.linalg.svd(cosines)[2][2]
    axes = -camera_matrix(140.0, -60.0, 20.0) @ (np.eye(3) - 2.0 * np.outer(normal, normal))
    p, q, r = axes @ cosines.T
    one.__dict__["image"] = 10.4 * np.stack([p / r, q / r], axis=1)[None]
    assert_close("minimiser's residual", second_solution_rms(one, 1e-3), [0.0])
