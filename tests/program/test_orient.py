"""The Euler solve against Appendix A: partials, least squares, known attitudes, last bits."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from tests.kit import appendix_a, spherical_film
from tests.kit.jobs import film, reread
from tests.tolerances import assert_close, within
from vopd.errata import fixes
from vopd.job import Readings
from vopd.program.alpbet import alpbet
from vopd.program.average import averages
from vopd.program.orient import orient, sums_in_order, wrapped
from vopd.program.vopd import run

FOCAL = 10.4
SEEDS = st.integers(0, 2**32 - 1)


def attitudes(rng: np.random.Generator, frames: int) -> np.ndarray:
    return rng.uniform([0.0, -90.0, 0.0], [360.0, 90.0, 360.0], (frames, 3))


def turned(found: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """The difference of two directions, -180 to 180 degrees."""
    return (found - wanted + 180.0) % 360.0 - 180.0


def test_the_matrix_of_appendix_a_is_a_rotation() -> None:
    """Yaw, pitch, roll of a body whose forward, right, down are axis, -x, -y of the image."""
    angles = np.radians([195.27, -38.65, 285.84])
    north_east_down = Rotation.from_euler("ZYX", angles).as_matrix()
    east_north_up = north_east_down[[1, 0, 2]] * [[1], [1], [-1]]
    forward, right, down = east_north_up.T
    assert_close("unit element", appendix_a.matrix(angles), [-right, -down, forward])


def unconverged(marks: int) -> list[tuple[np.ndarray, ...]]:
    """Angles of pass 22, 22nd correction, cosines, film of frames that are still on their way."""
    rng = np.random.default_rng(1974)
    truth = attitudes(rng, 600)
    cosines, film = appendix_a.random_film(rng, truth, marks, noise_mm=0.5)
    start = truth + rng.uniform(-60.0, 60.0, truth.shape)
    done = orient(start.T.copy(), appendix_a.sight(cosines, film, FOCAL))
    going = np.flatnonzero((np.abs(done.correction) > 1e-5).any(axis=0))
    return [(done.angles[:, f] / appendix_a.RAD, done.correction[:, f], cosines[f], film[f])
            for f in going]  # fmt: skip


@pytest.mark.parametrize("marks", [2, 3, 6])
def test_the_partials_have_the_erratum_and_no_other(marks: int) -> None:
    """A correction is the step by the partials with the erratum, and not by the true ones.

    Where the iteration has converged any partials give no step, so these are
    frames in which it has not.
    """
    seen = 0
    for angles, correction, cosines, points in unconverged(marks):
        b = appendix_a.partials(angles, cosines, FOCAL, erratum=True).reshape(-1, 3)
        if np.linalg.cond(b) > 1e3:
            continue
        seen += 1
        assert_close(
            "correction", correction, appendix_a.correction(angles, cosines, points, FOCAL)
        )
        true_step = appendix_a.correction(angles, cosines, points, FOCAL, erratum=False)
        assert np.abs(correction - true_step).max() > 1e4 * within("correction")
    assert seen >= 3


def test_the_erratum_is_none_where_all_landmarks_have_one_xmu() -> None:
    """XMU(1) = XMU(J): the answer is the least squares of A4, by scipy's minimiser."""
    east = np.array([-0.4, 0.0, 0.3])
    cosines = np.column_stack([east, np.full(3, -0.2), -np.sqrt(1 - east**2 - 0.04)])
    truth = np.array([20.0, -80.0, 100.0])
    film = appendix_a.project(truth / appendix_a.RAD, cosines, FOCAL)
    film += [[0.05, -0.02], [0.01, 0.06], [-0.04, 0.03]]
    done = orient(truth[:, None] + 3.0, appendix_a.sight(cosines[None], film[None], FOCAL))

    def residuals(angles: np.ndarray) -> np.ndarray:
        return (film - appendix_a.project(angles, cosines, FOCAL)).ravel()

    best = least_squares(residuals, truth / appendix_a.RAD, xtol=1e-15, ftol=1e-15, gtol=1e-15)
    assert_close("minimiser's angle", done.angles[:, 0], best.x * appendix_a.RAD)
    assert_close(
        "residual", done.eps[:, :, 0].T.ravel(), residuals(done.angles[:, 0] / appendix_a.RAD)
    )


def test_the_erratum_moves_the_answer_off_the_least_squares() -> None:
    """What vanishes is the product of the partials with the erratum with the residuals."""
    rng = np.random.default_rng(3)
    truth = np.array([[40.0, -50.0, 300.0]])
    cosines, film = appendix_a.random_film(rng, truth, 3, noise_mm=0.1)
    done = orient(truth.T.copy(), appendix_a.sight(cosines, film, FOCAL))
    angles, eps = done.angles[:, 0] / appendix_a.RAD, done.eps[:, :, 0].T.ravel()
    with_it, true = (
        appendix_a.partials(angles, cosines[0], FOCAL, erratum).reshape(-1, 3).T @ eps
        for erratum in (True, False)
    )
    assert_close("normal equation", with_it, 0.0)
    assert abs(true[1]) > 1e6 * within("normal equation")


@pytest.mark.parametrize("marks", [2, 3, 5])
@pytest.mark.parametrize("noise_mm", [0.0, 0.1])
def test_against_another_solver(marks: int, noise_mm: float) -> None:
    """All 22 passes, with complex-step partials and QR in place of formulas and MATINV."""
    rng = np.random.default_rng(marks)
    truth = attitudes(rng, 25)
    cosines, film = appendix_a.random_film(rng, truth, marks, noise_mm)
    start = truth + rng.uniform(-8.0, 8.0, truth.shape)
    done = orient(start.T.copy(), appendix_a.sight(cosines, film, FOCAL))
    other = [appendix_a.solve(*frame, FOCAL) for frame in zip(start, cosines, film, strict=True)]
    assert_close("angle after 22 passes", turned(done.angles.T, np.array(other)), 0.0)


def test_known_attitudes_come_back() -> None:
    """Without noise the erratum changes the way, not the end; at some places the way is long."""
    rng = np.random.default_rng(87)
    truth = attitudes(rng, 2000)
    truth = truth[np.abs(truth[:, 1]) < 80.0]  # near the vertical yaw and roll are one
    cosines, film = appendix_a.random_film(rng, truth, 6, noise_mm=0.0)
    start = truth + rng.uniform(-5.0, 5.0, truth.shape)
    done = orient(start.T.copy(), appendix_a.sight(cosines, film, FOCAL))
    at_rest = (np.abs(done.correction) < 1e-13).all(axis=0)
    assert at_rest.mean() > 0.9
    assert_close("recovered angle", turned(done.angles.T, truth)[at_rest], 0.0)
    assert not done.singular.any()


@pytest.mark.parametrize(
    ("start", "truth"),
    [
        ((359.0, 10.0, 1.0), (1.0, 10.0, 359.0)),  # yaw past 360 to 361, roll past 0 to -1
        ((1.0, 10.0, 359.0), (359.0, 10.0, 1.0)),
        ((30.0, 179.0, 40.0), (30.0, -179.0, 40.0)),  # pitch past 180 to 181
        ((30.0, -179.0, 40.0), (30.0, 179.0, 40.0)),
    ],
)
def test_angles_wrap_after_a_correction(start: tuple[float, ...], truth: tuple[float, ...]) -> None:
    """A 432 to A 437: 0 to 360 degrees for yaw and roll, -180 to 180 for pitch."""
    rng = np.random.default_rng(5)
    cosines, film = appendix_a.random_film(rng, np.array([truth]), 4, noise_mm=0.0)
    done = orient(np.array([start]).T, appendix_a.sight(cosines, film, FOCAL))
    assert_close("recovered angle", done.angles[:, 0], truth)


@pytest.mark.parametrize(
    ("start", "left"),
    [
        # TWOPI * RAD = 2 * 3.14159265 * 57.29577951 = 359.999999569273
        ((400.0, 0.0, 0.0), (40.000000430727, 0.0, 0.0)),
        ((-40.0, 0.0, 0.0), (319.999999569273, 0.0, 0.0)),
        ((0.0, 0.0, 400.0), (0.0, 0.0, 40.000000430727)),
        ((0.0, 0.0, -40.0), (0.0, 0.0, 319.999999569273)),
        ((0.0, 190.0, 0.0), (0.0, -169.999999569273, 0.0)),
        ((0.0, -190.0, 0.0), (0.0, 169.999999569273, 0.0)),
        ((0.0, 179.0, 0.0), (0.0, 179.0, 0.0)),
        ((359.0, -179.0, 359.0), (359.0, -179.0, 359.0)),
    ],
)
def test_wrapping_by_hand(start: tuple[float, ...], left: tuple[float, ...]) -> None:
    """A focal length of zero gives no correction, so only the wrapping is seen."""
    cosines, film = np.array([[[0.1, 0.9, -0.4]]]), np.ones((1, 1, 2))
    done = orient(np.array([start]).T, appendix_a.sight(cosines, film, 0.0))
    assert_close("wrapped angle", done.next[:, 0], left)
    assert done.singular.all()
    assert (done.correction == 0).all()


def test_wrapping_is_done_once_a_pass() -> None:
    """1000 degrees lose one circle in each of passes 1 and 2 and print as 280."""
    cosines, film = np.array([[[0.1, 0.9, -0.4]]]), np.ones((1, 1, 2))
    done = orient(np.array([[1000.0], [0.0], [0.0]]), appendix_a.sight(cosines, film, 0.0))
    assert_close("wrapped angle", done.angles[0, 0], 280.000000861454)


def test_residuals_that_vanish_end_the_frame() -> None:
    """Level and north is (0, 1, 0); a landmark there stands at the centre of the film, exactly."""
    north = np.tile([0.0, 1.0, 0.0], (1, 2, 1))
    done = orient(np.zeros((3, 1)), appendix_a.sight(north, np.zeros((1, 2, 2)), FOCAL))
    assert done.last_pass[0] == 1
    assert (done.eps == 0).all()
    assert (done.angles == 0).all()


def test_residuals_that_vanish_but_for_one() -> None:
    north = np.tile([0.0, 1.0, 0.0], (1, 2, 1))
    film = np.zeros((1, 2, 2))
    film[0, 1, 1] = 1e-300
    assert orient(np.zeros((3, 1)), appendix_a.sight(north, film, FOCAL)).last_pass[0] == 0


def test_a_landmark_abeam_is_no_number() -> None:
    """East, seen by a camera that looks north: the projection divides by zero."""
    cosines = np.array([[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]])
    done = orient(np.zeros((3, 1)), appendix_a.sight(cosines, np.ones((1, 2, 2)), FOCAL))
    assert np.isnan(done.angles).all()
    assert np.isnan(done.correction).all()
    assert done.last_pass[0] == 0


def mixed(seed: int, frames: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Starts, cosines, film, used: good frames, far starts, landmarks abeam, exact ones."""
    rng = np.random.default_rng(seed)
    truth = attitudes(rng, frames)
    cosines, film = appendix_a.random_film(rng, truth, 4, noise_mm=rng.choice([0.0, 0.3]))
    start = truth + rng.uniform(-1.0, 1.0, truth.shape) * rng.choice([0.0, 5.0, 90.0])
    used = rng.random((frames, 4)) < 0.7
    used[:, 0] |= ~used.any(axis=1)
    kind = rng.integers(0, 8, frames)
    start[kind < 2] = 0.0
    cosines[kind == 0] = (0.0, 1.0, 0.0)
    film[kind == 0] = 0.0
    cosines[kind == 1, :2] = (1.0, 0.0, 0.0)
    return start, cosines, film, used


@settings(max_examples=15)
@given(SEEDS, st.integers(1, 12))
def test_a_stack_is_its_frames_bit_for_bit(seed: int, frames: int) -> None:
    start, cosines, film, used = mixed(seed, frames)
    whole = orient(start.T.copy(), appendix_a.sight(cosines, film, FOCAL, used))
    for f in range(frames):
        one = slice(f, f + 1)
        seen = appendix_a.sight(cosines[one], film[one], FOCAL, used[one])
        alone = orient(start[one].T.copy(), seen)
        for name, ours, theirs in zip(whole._fields, whole, alone, strict=True):
            np.testing.assert_array_equal(ours[..., one], theirs, err_msg=name, strict=True)


def test_arguments_are_not_changed() -> None:
    start, cosines, film, used = mixed(7, 20)
    seen, first = appendix_a.sight(cosines, film, FOCAL, used), start.T.copy()
    arrays = [first, *seen.dircos, seen.x, seen.y, seen.xmu1, seen.used]
    before = [array.tobytes() for array in arrays]
    orient(first, seen)
    assert [array.tobytes() for array in arrays] == before


def test_the_ends_of_a_circle_stay() -> None:
    """Angles that are just 0, 2 pi and -pi, pi, beside a frame that is wrapped (A 432 to A 437)."""
    pi, twopi = 3.14159265, 6.2831853
    ends = np.array([[0.0, twopi, 0.0, 7.0], [-pi, pi, 0.0, 4.0], [twopi, 0.0, 0.0, -1.0]])
    found = wrapped(ends.copy())
    assert found[:, :3].tolist() == ends[:, :3].tolist()
    assert found[:, 3].tolist() == [7.0 - twopi, 4.0 - twopi, -1.0 + twopi]
    assert wrapped(ends[:, :3].copy()).tolist() == ends[:, :3].tolist()


@pytest.mark.parametrize("marks", [1, 2, 8, 9, 20])
@pytest.mark.parametrize("frames", [1, 31, 32, 40])
def test_sums_are_added_landmark_by_landmark_x_and_y_by_turns(marks: int, frames: int) -> None:
    """To the last bit, of numbers of very different size; no sum is minus zero."""
    random = np.random.default_rng(marks)
    sizes = 10.0 ** random.integers(-9, 9, marks)[:, None]
    terms = random.normal(size=(2, 9, marks, frames)) * sizes
    terms[:, 0] = -0.0
    expected = np.zeros((9, frames))
    for mark in range(marks):
        for axis in range(2):
            expected = expected + terms[axis, :, mark]
    assert sums_in_order(terms.copy()).tobytes() == expected.tobytes()


# The order of operations


RD = 57.29577951


def test_the_distance_from_the_centre_is_the_root_of_the_sum_of_squares() -> None:
    """A 343 to A 347; another routine for the length of a vector rounds otherwise."""
    job = film(40)
    read = np.random.default_rng(1).uniform(-9.0, 9.0, (40, 5, 3, 2))
    corners = np.zeros((40, 4, 3, 2))
    found = run(replace(job, readings=reread(job.readings, landmark_in=read, fiducial_in=corners)))
    point = found.point_mm.reshape(-1, 2)  # the centre is at 0, 0
    expected = [math.sqrt(x * x + y * y) for x, y in point.tolist()]
    assert found.radius_mm.ravel().tolist() == expected
    assert expected != [math.hypot(x, y) for x, y in point.tolist()]


def test_eta_and_the_airspeed_are_from_roots_of_sums_of_squares() -> None:
    """C 1 to C 40, of a vehicle that looks north and level in still air."""
    velocity = np.random.default_rng(2).uniform(-900.0, 900.0, (200, 3))
    zero = np.zeros(200)
    _, _, etad, cvp = alpbet(velocity, np.zeros((200, 2)), theta=zero, psi=zero, phi=zero)
    across = [math.sqrt(v * v + w * w) for _, v, w in velocity.tolist()]
    assert etad.tolist() == (np.arctan2(across, velocity[:, 0]) * RD).tolist()
    speed = [math.sqrt(u * u + v * v + w * w) for u, v, w in velocity.tolist()]
    assert cvp.tolist() == speed


def test_a_mean_is_a_sum_of_quotients() -> None:
    """A 84 to A 104: each reading over 12, or over 3, and then the sum, from the least reading."""
    random = np.random.default_rng(3)
    corners, marks = (
        random.uniform(0.0, 9.0, (30, 4, 3, 2)),
        random.uniform(0.0, 9.0, (30, 1, 3, 2)),
    )
    one = np.ones((30, 1), np.int64)
    readings = Readings.of(
        frame=np.arange(30), fiducial_in=corners, landmark=one, present=one > 0, landmark_in=marks
    )
    centre, point = averages(readings, rounded=False)
    for frame in range(30):
        for axis in (0, 1):
            mean = 0.0
            for corner in range(4):
                for value in sorted(corners[frame, corner, :, axis].tolist()):
                    mean = mean + value / 12.0
            assert centre[frame, axis] == mean
            low, middle, high = sorted(marks[frame, 0, :, axis].tolist())
            assert point[frame, axis] == low / 3.0 + middle / 3.0 + high / 3.0


def test_the_angles_of_a_frame_that_rests_at_once_have_been_radians() -> None:
    """Those printed are radians times RAD; where all residuals vanish at once, group 8's own."""
    start = np.random.default_rng(4).uniform([[0.0], [-170.0], [0.0]], 170.0, (3, 50))
    cosines = np.tile([0.1, 0.9, -0.4], (50, 3, 1))
    back = start / RD * RD
    assert (back != start).any()
    for film_mm, expected in ((1.0, back), (0.0, start)):
        seen = appendix_a.sight(cosines, np.full((50, 3, 2), film_mm), 0.0)
        assert orient(start, seen).angles.tolist() == expected.tolist()


def test_a_frame_whose_residuals_vanish_at_once_is_not_wrapped() -> None:
    """It ends in its first pass, at angles beyond a circle too."""
    start = np.array([[361.0, -1.0, 10.0], [2.0, 181.0, -190.0], [3.0, 400.0, -5.0]])
    cosines = np.tile([0.1, 0.9, -0.4], (3, 3, 1))
    found = orient(start, appendix_a.sight(cosines, np.zeros((3, 3, 2)), 0.0))
    assert found.angles.tolist() == start.tolist()
    assert found.last_pass.tolist() == [1, 1, 1] and not found.singular.any()


# Known attitudes, photographed by an independent camera


def turned_of_photographs(found: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    return (found - wanted + 180.0) % 360.0 - 180.0


def looking_down(frames: int) -> np.ndarray:
    """Pitch -86 to -60, all yaws and rolls."""
    k = np.arange(frames)
    return np.stack(
        [(20.0 + 47.0 * k) % 360, -86.0 + 26.0 * k / frames, (300.0 - 61.0 * k) % 360], 1
    )


@pytest.mark.parametrize("k", range(8))
def test_one_frame(k: int) -> None:
    """From six degrees away in every angle."""
    truth = looking_down(8)[k : k + 1]
    results = run(spherical_film.job(truth, truth[0] + [6.0, -6.0, 6.0]))
    assert results.converged.all()
    assert_close("angle from readings", turned_of_photographs(results.camera_deg, truth), 0.0)
    assert_close("residual of readings", results.residual_mm, 0.0)


def test_a_film_that_is_tracked() -> None:
    """Group 8's estimate serves 12 frames that wander 10 degrees from it."""
    k = np.arange(12.0)
    truth = np.stack([140.0 + k, -80.0 + 0.8 * k, 60.0 - 0.9 * k], axis=1)
    results = run(spherical_film.job(truth, truth[5]))
    assert results.converged.all()
    assert_close("angle from readings", turned_of_photographs(results.camera_deg, truth), 0.0)
    assert (results.start_deg == truth[5]).all()


def test_every_part_of_the_model_matters() -> None:
    """What the errata change, the independent model has as the listing does, so each one shows."""
    truth = looking_down(2)
    job = spherical_film.job(truth[:1], truth[0])
    for name in ("latitude-series", "earth"):
        moved = turned_of_photographs(run(job, fixes(name)).camera_deg, truth[:1])
        assert np.abs(moved).max() > 1e-3, name
    for name in ("feet-per-km", "sin-6phi"):
        moved = turned_of_photographs(run(job, fixes(name)).camera_deg, run(job).camera_deg)
        assert 0 < np.abs(moved).max() < 1e-4, name


def test_the_camera_in_the_vehicle() -> None:
    """Vehicle angles are minus the camera's: 20, -86, 300 become 340, 86, 60."""
    truth = np.array([[20.0, -86.0, 300.0]])
    results = run(spherical_film.job(truth, truth[0], multiplier=(-1, -1, -1)))
    assert_close("angle from readings", results.vehicle_deg, [[340.0, 86.0, 60.0]])
