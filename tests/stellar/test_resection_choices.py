"""Which of several positions is taken, what a second one is, and what each field of a result is."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from tests.tolerances import assert_close, within
from vopd.stellar.field import Failure
from vopd.stellar.methods.resection import Resection, resection, three_point_resection

FOCAL = 152.4


def seen(points: np.ndarray, position: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    x, y, z = matrix @ (points - position).T
    return np.column_stack([-FOCAL * x / z, -FOCAL * y / z])


def flight(seed: int, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Points, position, matrix and exact images: 2,500 m above rough ground of 2 by 2 km."""
    rng = np.random.default_rng(seed)
    across = rng.uniform(-1000.0, 1000.0, (count, 2))
    points = np.column_stack([across, rng.uniform(0.0, 200.0, count)])
    position = np.array([*rng.uniform(-400.0, 400.0, 2), 2500.0])
    tilt = rng.uniform(-0.3, 0.3, 3) * [1.0, 1.0, 10.0]
    matrix = Rotation.from_euler("XYZ", tilt).as_matrix().T
    return points, position, matrix, seen(points, position, matrix)


def rays_of(images: np.ndarray) -> np.ndarray:
    rays = np.column_stack([images, np.full(len(images), -FOCAL)])
    return np.asarray(rays / np.linalg.norm(rays, axis=1)[:, None])


def fitted(
    points: np.ndarray, read: np.ndarray, matrix: np.ndarray, position: np.ndarray
) -> tuple[float, np.ndarray]:
    """Least sum of squares near a position, and the position there, by scipy."""

    def residuals(change: np.ndarray) -> np.ndarray:
        turned = Rotation.from_rotvec(change[:3]).as_matrix() @ matrix
        return (read - seen(points, position + 1000.0 * change[3:], turned)).ravel()

    found = least_squares(residuals, np.zeros(6), xtol=1e-14, ftol=1e-14, gtol=1e-14)
    return 2.0 * float(found.cost), position + 1000.0 * found.x[3:]


def test_every_solution_of_three_points_sees_them_along_their_rays() -> None:
    several = 0
    for seed in range(40):
        points, _, _, images = flight(seed, 3)
        rays = rays_of(images)
        found = three_point_resection(points, rays)
        several += len(found) > 1
        for matrix, position in found:
            assert_close("rae angle", matrix @ matrix.T, np.eye(3))
            toward = (points - position) @ matrix.T
            toward /= np.linalg.norm(toward, axis=1)[:, None]
            assert np.abs(toward - rays).max() < within("rae three-point element")
    assert several > 5


def test_positions_on_the_dangerous_cylinder_are_found() -> None:
    """There two solutions are one: a double root, which rounding parts into two complex ones.

    Which of them it parts, and how far, depends on the processor. Positions straight above a corner
    are left out: there more than half of the digits are lost.
    """
    corners = np.radians([90.0, 215.0, 330.0])
    points = 500.0 * np.column_stack([np.cos(corners), np.sin(corners), np.zeros(3)])
    for turn in np.radians([turn for turn in range(0, 360, 10) if turn not in (90, 330)]):
        position = np.array([500.0 * np.cos(turn), 500.0 * np.sin(turn), 2500.0])
        found = three_point_resection(points, rays_of(seen(points, position, np.eye(3))))
        off = [np.abs(one - position).max() for _, one in found]
        assert min(off, default=np.inf) < within("rae position by a double root"), turn


@pytest.mark.parametrize("same", [(0, 1), (1, 2), (0, 2)])
def test_three_points_of_which_two_are_one_have_no_solution(same: tuple[int, int]) -> None:
    points, _, _, images = flight(3, 3)
    points[same[1]] = points[same[0]]
    assert three_point_resection(points, rays_of(images)) == []
    assert three_point_resection(np.full((3, 3), np.nan), rays_of(images)) == []
    assert three_point_resection(flight(3, 3)[0], np.full((3, 3), np.nan)) == []


def two_positions(seed: int, mixed: float) -> tuple[float, np.ndarray, Resection] | None:
    """Four points, the first read between where two positions that fit the others have it.

    The ratio of the sums of squares about both, the worse position, and the resection.
    """
    points, position, matrix, images = flight(seed, 4)
    for other, false in three_point_resection(points[1:], rays_of(images[1:])):
        if np.linalg.norm(false - position) > 300.0:
            read = images.copy()
            read[0] += mixed * (seen(points[:1], false, other)[0] - images[0])
            ends = [fitted(points, read, matrix, position), fitted(points, read, other, false)]
            (best, _), (worse, second) = sorted(ends, key=lambda one: one[0])
            if np.linalg.norm(ends[0][1] - ends[1][1]) > 300.0 and best > 0.0:
                return worse / best, second, resection(points, read, FOCAL)
    return None


TWO = [
    (6, 0.34, False), (6, 0.38, True), (28, 0.3, False), (28, 0.34, True), (37, 0.3, True),
    (37, 0.34, False), (72, 0.3, False), (72, 0.34, True),
]  # fmt: skip


@pytest.mark.parametrize(("seed", "mixed", "there_is"), TWO)
def test_a_second_position_fits_up_to_four_times_as_badly(
    seed: int, mixed: float, there_is: bool
) -> None:
    made = two_positions(seed, mixed)
    assert made is not None
    ratio, second, found = made
    assert 2.9 < ratio < 5.5 and (ratio < 4.0) == there_is and found.failure == Failure.NONE
    assert (found.second is not None) == there_is
    if found.second is not None:
        assert_close("rae three-point position", found.second, second)
        assert np.linalg.norm(found.second - found.position) > 300.0


@pytest.mark.parametrize("seed", range(6))
def test_points_that_fix_one_position_leave_no_second(seed: int) -> None:
    """Several first estimates lead to the same position, which is no second one."""
    points, position, matrix, images = flight(seed, 8)
    found = resection(points, images, FOCAL)
    assert (found.failure, found.second) == (Failure.NONE, None)
    assert np.abs(found.position - position).max() < within("rae resection position")
    assert np.abs(found.matrix - matrix).max() < within("rae three-point element")


@pytest.mark.parametrize(("length", "image"), [(1e-6, 1.0), (1e6, 1.0), (1.0, 1e6), (1.0, 1e-6)])
def test_units_of_the_ground_and_of_the_images_make_no_difference(
    length: float, image: float
) -> None:
    points, _, _, images = flight(28, 4)
    (other, false), *_ = (
        one
        for one in three_point_resection(points[1:], rays_of(images[1:]))
        if np.linalg.norm(one[1] - flight(28, 4)[1]) > 300.0
    )
    images[0] += 0.34 * (seen(points[:1], false, other)[0] - images[0])
    plain = resection(points, images, FOCAL)
    scaled = resection(length * points, image * images, image * FOCAL)
    assert plain.second is not None and scaled.second is not None
    assert scaled.failure == plain.failure == Failure.NONE
    for one, two in ((plain.position, scaled.position), (plain.second, scaled.second)):
        assert_close("seven digits", two / (1e4 * length), one / 1e4)
    assert_close("seven digits", scaled.residuals / image, plain.residuals)
    factor = np.repeat([1.0 / image, length / image], 3)
    expected = plain.covariance * np.outer(factor, factor)
    size = np.sqrt(np.diag(expected))
    assert_close("seven digits", scaled.covariance / np.outer(size, size),
                 expected / np.outer(size, size))  # fmt: skip


def test_errors_weigh_the_residuals_that_are_shown_as_they_are() -> None:
    """Position by scipy on residuals made independent; the covariance by its derivatives."""
    points, _, _, images = flight(5, 7)
    rng = np.random.default_rng(2)
    halves = rng.normal(size=(7, 2, 2)) + 2.0 * np.eye(2)
    errors = halves @ halves.swapaxes(1, 2)
    root = np.linalg.cholesky(errors)
    read = images + 0.05 * np.einsum("nij,nj->ni", root, rng.normal(size=(7, 2)))
    white = np.linalg.inv(np.linalg.cholesky(errors))
    found = resection(points, read, FOCAL, errors)

    def residuals(change: np.ndarray) -> np.ndarray:
        turned = Rotation.from_rotvec(change[:3]).as_matrix() @ found.matrix
        return read - seen(points, found.position + 1000.0 * change[3:], turned)

    def whitened(change: np.ndarray) -> np.ndarray:
        return np.asarray(np.einsum("nij,nj->ni", white, residuals(change)).ravel())

    ends = {"xtol": 1e-15, "ftol": 1e-15, "gtol": 1e-15}
    other = least_squares(whitened, np.full(6, 1e-4), jac="3-point", **ends)
    assert 1000.0 * np.abs(other.x[3:]).max() < within("rae resection position")
    assert_close("rae resection residual", found.residuals, residuals(np.zeros(6)))
    stated = np.linalg.inv(other.jac.T @ other.jac)
    units = np.array([1.0, 1.0, 1.0, 1e3, 1e3, 1e3])
    sigmas = np.sqrt(np.diag(stated))
    ratio = found.covariance / np.outer(units * sigmas, units * sigmas)
    off = np.abs(ratio - stated / np.outer(sigmas, sigmas)).max()
    assert off < within("rae sigma by scipy")
    plain = resection(points, read, FOCAL)
    assert np.abs(plain.position - found.position).max() > 10.0 * within("rae resection position")


def test_points_that_fix_no_position() -> None:
    """Points on a line leave a turn about it; images without a point in front leave nothing."""
    points, position, matrix, _ = flight(5, 6)
    line = np.array([0.0, 0.0, 50.0]) + np.linspace(-1.0, 1.0, 6)[:, None] * [900.0, 400.0, 10.0]
    for ground in (line, np.repeat(points[:1], 6, axis=0)):
        found = resection(ground, seen(ground, position, matrix), FOCAL)
        assert (found.failure, found.iterations, found.second) == (Failure.SINGULAR, 0, None)
        assert found.matrix.shape == (3, 3) and found.position.shape == (3,)
        assert found.residuals.shape == (6, 2) and found.covariance.shape == (6, 6)
        for one in (found.matrix, found.position, found.residuals, found.covariance):
            assert np.isnan(one).all()


def noisy(seed: int, noise: float) -> tuple[np.ndarray, np.ndarray, Resection]:
    """Four points, their images with errors of some millimetres or more, and the resection."""
    points, _, _, images = flight(seed, 4)
    small, large = np.random.default_rng(seed).normal(size=(2, 4, 2))
    read = images + noise * (small if noise < 1.0 else large)
    return points, read, resection(points, read, FOCAL)


@pytest.mark.parametrize(
    ("seed", "noise"),
    [(5, 20.0), (6, 20.0), (24, 20.0), (26, 20.0), (34, 20.0), (36, 0.5), (58, 20.0), (343, 20.0)],
)
def test_first_estimates_that_lead_nowhere_cost_no_solution(seed: int, noise: float) -> None:
    """Some are undetermined, do not settle or end behind the camera; the best of the rest is it."""
    points, read, found = noisy(seed, noise)
    assert found.failure == Failure.NONE
    assert ((found.matrix @ (points - found.position).T)[2] < 0.0).all()
    residuals = read - seen(points, found.position, found.matrix)
    assert_close("rae resection residual", found.residuals, residuals)
    least, position = fitted(points, read, found.matrix, found.position)
    assert_close("seven digits", (residuals**2).sum() / least, 1.0)
    assert np.linalg.norm(position - found.position) < within("rae three-point position")


@pytest.mark.parametrize(("seed", "noise"), [(26, 0.5), (62, 20.0)])
def test_where_none_settles_nothing_is_shown(seed: int, noise: float) -> None:
    _, _, found = noisy(seed, noise)
    assert (found.failure, found.iterations, found.second) == (Failure.NO_CONVERGENCE, 0, None)
    for one in (found.matrix, found.position, found.residuals, found.covariance):
        assert np.isnan(one).all()
