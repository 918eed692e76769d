"""Space resection."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from tests.approved.texts import assert_approved
from tests.kit.command import DECKS, vopd
from tests.tolerances import assert_close, within
from vopd.stellar.field import Failure, StarField
from vopd.stellar.files import photograph as solved_resection
from vopd.stellar.files.photograph import solve_resection
from vopd.stellar.files.read import StarFile
from vopd.stellar.methods.resection import Resection, resection, three_point_resection
from vopd.stellar.methods.run import SolvedStars

# Position and attitude together from ground points


GROUND = DECKS / "stars" / "ground_points.csv"
FOCAL, SIGMA, HALF_FORMAT_MM = 152.4, 0.01, 150.0
Drawn = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def flight(seed: int, count: int) -> Drawn:
    """Points on rough ground, and a camera above them: points, position, matrix, exact images."""
    rng = np.random.default_rng(seed)
    while True:
        points = np.column_stack(
            [rng.uniform(-1000.0, 1000.0, (count, 2)), rng.uniform(0.0, 200.0, count)]
        )
        position = np.array([*rng.uniform(-400.0, 400.0, 2), 2500.0])
        tilt = rng.uniform(-0.3, 0.3, 3) * [1.0, 1.0, 10.0]
        matrix = Rotation.from_euler("XYZ", tilt).as_matrix().T
        images = seen(points, position, matrix)
        if (
            np.abs(images).max() < HALF_FORMAT_MM
            and np.linalg.matrix_rank(images - images[0], 5.0) > 1
        ):
            return points, position, matrix, images


def seen(points: np.ndarray, position: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    x, y, z = matrix @ (points - position).T
    return np.column_stack([-FOCAL * x / z, -FOCAL * y / z])


def test_three_points_have_the_true_position_among_their_solutions() -> None:
    for seed in range(20):
        points, position, matrix, images = flight(seed, 3)
        rays = np.column_stack([images, np.full(3, -FOCAL)])
        found = three_point_resection(points, rays / np.linalg.norm(rays, axis=1)[:, None])
        assert 1 <= len(found) <= 4
        nearest = min(found, key=lambda one: float(np.linalg.norm(one[1] - position)))
        assert np.linalg.norm(nearest[1] - position) < within("rae three-point position")
        assert np.abs(nearest[0] - matrix).max() < within("rae three-point element")


def test_counted_errors_have_the_stated_covariance() -> None:
    """Of 300 flights, each with errors and points of its own: the squares of errors over sigma."""
    scaled, squares = [], []
    for seed in range(300):
        points, position, matrix, images = flight(1000 + seed, 4 + seed % 5)
        noise = np.random.default_rng(seed).normal(0.0, SIGMA, images.shape)
        found = resection(points, images + noise, FOCAL)
        assert found.failure == Failure.NONE
        turn = Rotation.from_matrix(found.matrix @ matrix.T).as_rotvec()
        error = np.concatenate([turn, found.position - position])
        covariance = found.covariance * SIGMA**2
        scaled.append(error / np.sqrt(np.diag(covariance)))
        squares.append(error @ np.linalg.solve(covariance, error))
    assert np.abs(np.std(scaled, axis=0) - 1.0).max() < within("rae resection sigma")
    assert abs(np.mean(squares) / 6.0 - 1.0) < within("rae resection sigma")


def test_it_is_the_least_squares_solution_of_scipy() -> None:
    points, position, matrix, images = flight(5, 8)
    read = images + np.random.default_rng(6).normal(0.0, 0.05, images.shape)
    found = resection(points, read, FOCAL)

    def residuals(change: np.ndarray) -> np.ndarray:
        turned = Rotation.from_rotvec(change[:3]).as_matrix() @ matrix
        return (read - seen(points, position + 1000.0 * change[3:], turned)).ravel()

    other = least_squares(residuals, np.zeros(6), xtol=1e-15, ftol=1e-15, gtol=1e-15)
    expected = position + 1000.0 * other.x[3:]
    assert np.abs(found.position - expected).max() < within("rae resection position")
    assert_close("rae resection residual", found.residuals.ravel(), residuals(other.x))


def test_the_command_finds_the_position_of_the_example() -> None:
    """Made from 1000, 2000, 3000 and 2, -3, 40, with images rounded to .001 mm."""
    options = ("--focal", FOCAL, "--resection", "--format", "json")
    result = vopd("stars", "solve", GROUND, *map(str, options))
    assert result.status == 0, result.stderr
    (row,) = json.loads(result.stdout)
    off = np.abs(np.array(row["camera_m"]) - [1000.0, 2000.0, 3000.0])
    assert (off < 3.0 * np.array(row["camera_sigma_m"])).all()
    assert max(row["camera_sigma_m"]) < 0.1
    angles = np.array([row[name] for name in ("omega_deg", "phi_deg", "kappa_deg")])
    stated = 3.0 * max(row["rotation_sigma_arcsec"]) / 3600.0
    assert np.abs(angles - [2.0, -3.0, 40.0]).max() < stated
    assert 3600.0 * stated < 10.0
    assert (
        "camera at 999.989"
        in vopd("stars", "solve", GROUND, "--focal", str(FOCAL), "--resection").stdout
    )


HEAD = "x_mm,y_mm,x_m,y_m,z_m\n"
REFUSED = {
    "three points": HEAD + "1,2,3,4,5\n2,4,1,5,9\n7,1,2,6,4\n",
    "stars": "x_mm,y_mm,ra_deg,dec_deg\n1,2,3,4\n5,6,7,8\n",
    "one point": HEAD + "1,2,3,4,5\n" * 5,
    "a line": HEAD + "".join(f"{k},0,{k},0,0\n" for k in range(6)),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_has_no_position_is_refused(name: str) -> None:
    text = REFUSED[name]
    result = vopd("stars", "solve", "-", "--focal", "100", "--resection", stdin=text)
    assert result.status == 1
    assert_approved(result.stderr)


@pytest.mark.parametrize("option", ["--camera=1,2,3", "--reject", "--pair=1,2", "--method=svd"])
def test_options_without_use_are_refused(option: str) -> None:
    result = vopd("stars", "solve", GROUND, "--focal", "152.4", "--resection", option)
    assert result.status == 2
    assert_approved(result.stderr)


@pytest.mark.parametrize("seed", [12, 15, 22, 24, 27])
def test_the_best_of_several_solutions_is_that_of_the_weighted_residuals(seed: int) -> None:
    """From a false position three points look the same, and a fourth is read as it is from there.

    Its standard deviation is a hundred times that of the fifth, which is read truly: so its
    long residual at the true position counts less than the shorter one of the fifth at the false.
    """
    points, position, _, images = flight(seed, 5)
    rays = np.column_stack([images, np.full(5, -FOCAL)])
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    errors = np.tile(np.eye(2), (5, 1, 1))
    errors[0] *= 100.0**2
    tried = 0
    for matrix, other in three_point_resection(points[2:], rays[2:]):
        false = seen(points, other, matrix)
        off = np.linalg.norm(false - images, axis=1)
        if np.linalg.norm(other - position) > 50.0 and 1.5 < off[0] / off[1] < 10.0:
            read = np.concatenate([false[:1], images[1:]])
            found = resection(points, read, FOCAL, errors)
            assert found.failure == Failure.NONE
            nearer = np.linalg.norm(found.position - position) * 100.0
            assert nearer < np.linalg.norm(found.position - other)
            tried += 1
    assert tried


# Which of several positions is taken, what a second one is, and what each field of a result is


FOCAL_CHOICES = 152.4


def seen_choices(points: np.ndarray, position: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    x, y, z = matrix @ (points - position).T
    return np.column_stack([-FOCAL_CHOICES * x / z, -FOCAL_CHOICES * y / z])


def flight_choices(seed: int, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Points, position, matrix and exact images: 2,500 m above rough ground of 2 by 2 km."""
    rng = np.random.default_rng(seed)
    across = rng.uniform(-1000.0, 1000.0, (count, 2))
    points = np.column_stack([across, rng.uniform(0.0, 200.0, count)])
    position = np.array([*rng.uniform(-400.0, 400.0, 2), 2500.0])
    tilt = rng.uniform(-0.3, 0.3, 3) * [1.0, 1.0, 10.0]
    matrix = Rotation.from_euler("XYZ", tilt).as_matrix().T
    return points, position, matrix, seen_choices(points, position, matrix)


def rays_of(images: np.ndarray) -> np.ndarray:
    rays = np.column_stack([images, np.full(len(images), -FOCAL_CHOICES)])
    return np.asarray(rays / np.linalg.norm(rays, axis=1)[:, None])


def fitted(
    points: np.ndarray, read: np.ndarray, matrix: np.ndarray, position: np.ndarray
) -> tuple[float, np.ndarray]:
    """Least sum of squares near a position, and the position there, by scipy."""

    def residuals(change: np.ndarray) -> np.ndarray:
        turned = Rotation.from_rotvec(change[:3]).as_matrix() @ matrix
        return (read - seen_choices(points, position + 1000.0 * change[3:], turned)).ravel()

    found = least_squares(residuals, np.zeros(6), xtol=1e-14, ftol=1e-14, gtol=1e-14)
    return 2.0 * float(found.cost), position + 1000.0 * found.x[3:]


def test_every_solution_of_three_points_sees_them_along_their_rays() -> None:
    several = 0
    for seed in range(40):
        points, _, _, images = flight_choices(seed, 3)
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
        found = three_point_resection(points, rays_of(seen_choices(points, position, np.eye(3))))
        off = [np.abs(one - position).max() for _, one in found]
        assert min(off, default=np.inf) < within("rae position by a double root"), turn


@pytest.mark.parametrize("same", [(0, 1), (1, 2), (0, 2)])
def test_three_points_of_which_two_are_one_have_no_solution(same: tuple[int, int]) -> None:
    points, _, _, images = flight_choices(3, 3)
    points[same[1]] = points[same[0]]
    assert three_point_resection(points, rays_of(images)) == []
    assert three_point_resection(np.full((3, 3), np.nan), rays_of(images)) == []
    assert three_point_resection(flight_choices(3, 3)[0], np.full((3, 3), np.nan)) == []


def two_positions(
    seed: int, mixed: float
) -> tuple[float, np.ndarray, Resection, tuple[np.ndarray, np.ndarray]] | None:
    """Four points, the first read between where two positions that fit the others have it.

    The ratio of the sums of squares about both, the worse position, and the resection; and the
    points with their images.
    """
    points, position, matrix, images = flight_choices(seed, 4)
    for other, false in three_point_resection(points[1:], rays_of(images[1:])):
        if np.linalg.norm(false - position) > 300.0:
            read = images.copy()
            read[0] += mixed * (seen_choices(points[:1], false, other)[0] - images[0])
            ends = [fitted(points, read, matrix, position), fitted(points, read, other, false)]
            (best, _), (worse, second) = sorted(ends, key=lambda one: one[0])
            if np.linalg.norm(ends[0][1] - ends[1][1]) > 300.0 and best > 0.0:
                found = resection(points, read, FOCAL_CHOICES)
                return worse / best, second, found, (points, read)
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
    ratio, second, found, _ = made
    assert 2.9 < ratio < 5.5 and (ratio < 4.0) == there_is and found.failure == Failure.NONE
    assert (found.second is not None) == there_is
    if found.second is not None:
        assert_close("rae three-point position", found.second, second)
        assert np.linalg.norm(found.second - found.position) > 300.0


def test_the_command_warns_of_a_second_position() -> None:
    """To a tenth of a metre, as it is printed."""
    made = two_positions(6, 0.38)
    assert made is not None
    _, second, _, (points, read) = made
    rows = "".join(",".join(map(repr, map(float, row))) + "\n" for row in np.hstack([read, points]))
    options = ("--focal", str(FOCAL_CHOICES), "--resection")
    result = vopd("stars", "solve", "-", *options, stdin=HEAD + rows)
    assert_approved(result.stderr, parts=[f"{one:.1f}" for one in second])


@pytest.mark.parametrize("seed", range(6))
def test_points_that_fix_one_position_leave_no_second(seed: int) -> None:
    """Several first estimates lead to the same position, which is no second one."""
    points, position, matrix, images = flight_choices(seed, 8)
    found = resection(points, images, FOCAL_CHOICES)
    assert (found.failure, found.second) == (Failure.NONE, None)
    assert np.abs(found.position - position).max() < within("rae resection position")
    assert np.abs(found.matrix - matrix).max() < within("rae three-point element")


@pytest.mark.parametrize(("length", "image"), [(1e-6, 1.0), (1e6, 1.0), (1.0, 1e6), (1.0, 1e-6)])
def test_units_of_the_ground_and_of_the_images_make_no_difference(
    length: float, image: float
) -> None:
    points, _, _, images = flight_choices(28, 4)
    (other, false), *_ = (
        one
        for one in three_point_resection(points[1:], rays_of(images[1:]))
        if np.linalg.norm(one[1] - flight_choices(28, 4)[1]) > 300.0
    )
    images[0] += 0.34 * (seen_choices(points[:1], false, other)[0] - images[0])
    plain = resection(points, images, FOCAL_CHOICES)
    scaled = resection(length * points, image * images, image * FOCAL_CHOICES)
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
    points, _, _, images = flight_choices(5, 7)
    rng = np.random.default_rng(2)
    halves = rng.normal(size=(7, 2, 2)) + 2.0 * np.eye(2)
    errors = halves @ halves.swapaxes(1, 2)
    root = np.linalg.cholesky(errors)
    read = images + 0.05 * np.einsum("nij,nj->ni", root, rng.normal(size=(7, 2)))
    white = np.linalg.inv(np.linalg.cholesky(errors))
    found = resection(points, read, FOCAL_CHOICES, errors)

    def residuals(change: np.ndarray) -> np.ndarray:
        turned = Rotation.from_rotvec(change[:3]).as_matrix() @ found.matrix
        return read - seen_choices(points, found.position + 1000.0 * change[3:], turned)

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
    plain = resection(points, read, FOCAL_CHOICES)
    assert np.abs(plain.position - found.position).max() > 10.0 * within("rae resection position")


def test_points_that_fix_no_position() -> None:
    """Points on a line leave a turn about it; images without a point in front leave nothing."""
    points, position, matrix, _ = flight_choices(5, 6)
    line = np.array([0.0, 0.0, 50.0]) + np.linspace(-1.0, 1.0, 6)[:, None] * [900.0, 400.0, 10.0]
    for ground in (line, np.repeat(points[:1], 6, axis=0)):
        found = resection(ground, seen_choices(ground, position, matrix), FOCAL_CHOICES)
        assert (found.failure, found.iterations, found.second) == (Failure.SINGULAR, 0, None)
        assert found.matrix.shape == (3, 3) and found.position.shape == (3,)
        assert found.residuals.shape == (6, 2) and found.covariance.shape == (6, 6)
        for one in (found.matrix, found.position, found.residuals, found.covariance):
            assert np.isnan(one).all()


def noisy(seed: int, noise: float) -> tuple[np.ndarray, np.ndarray, Resection]:
    """Four points, their images with errors of some millimetres or more, and the resection."""
    points, _, _, images = flight_choices(seed, 4)
    small, large = np.random.default_rng(seed).normal(size=(2, 4, 2))
    read = images + noise * (small if noise < 1.0 else large)
    return points, read, resection(points, read, FOCAL_CHOICES)


@pytest.mark.parametrize(
    ("seed", "noise"),
    [(5, 20.0), (6, 20.0), (24, 20.0), (26, 20.0), (34, 20.0), (36, 0.5), (58, 20.0), (343, 20.0)],
)
def test_first_estimates_that_lead_nowhere_cost_no_solution(seed: int, noise: float) -> None:
    """Some are undetermined, do not settle or end behind the camera; the best of the rest is it."""
    points, read, found = noisy(seed, noise)
    assert found.failure == Failure.NONE
    assert ((found.matrix @ (points - found.position).T)[2] < 0.0).all()
    residuals = read - seen_choices(points, found.position, found.matrix)
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


# Standard deviations of a resection in the command's output, against numerical derivatives


FOCAL_SIGMAS, SIGMA_SIGMAS, STEP = 152.4, 0.01, 1e-6


def test_they_are_those_of_the_normal_equations() -> None:
    """The example, and the images' derivatives by small turns about camera axes and by metres."""
    options = (
        "--focal",
        FOCAL_SIGMAS,
        "--resection",
        "--reading-sigma",
        SIGMA_SIGMAS,
        "--format",
        "json",
    )
    result = vopd("stars", "solve", GROUND, *map(str, options))
    assert result.status in (0, 3), result.stderr
    (row,) = json.loads(result.stdout)
    lines = [line for line in GROUND.read_text().splitlines() if not line.startswith("#")]
    points = np.array([line.split(",")[2:5] for line in lines[1:]], float)

    def seen(change: np.ndarray) -> np.ndarray:
        turned = Rotation.from_rotvec(change[:3]).as_matrix() @ np.array(row["matrix"])
        x, y, z = turned @ (points - np.array(row["camera_m"]) - 1000.0 * change[3:]).T
        return np.concatenate([-FOCAL_SIGMAS * x / z, -FOCAL_SIGMAS * y / z])

    design = np.column_stack([(seen(one) - seen(-one)) / (2.0 * STEP) for one in STEP * np.eye(6)])
    sigmas = SIGMA_SIGMAS * np.sqrt(np.diag(np.linalg.inv(design.T @ design)))
    found = [*row["rotation_sigma_arcsec"], *row["camera_sigma_m"]]
    expected = [*np.degrees(sigmas[:3]) * 3600.0, *1000.0 * sigmas[3:]]
    assert_close("rae sigma by differences", np.divide(found, expected), np.ones(6))


@pytest.mark.parametrize("count", [4, 5])
def test_the_reading_sigma_by_the_residuals(count: int) -> None:
    """Two coordinates a point, less six unknowns; one that is given has no degrees of freedom."""
    lines = [line for line in GROUND.read_text().splitlines() if not line.startswith("#")]
    text = "\n".join(lines[: 1 + count]) + "\n"
    options = ("--focal", str(FOCAL_SIGMAS), "--resection", "--format", "json")
    (row,) = json.loads(vopd("stars", "solve", "-", *options, stdin=text).stdout)
    squares = (np.array(row["residuals_mm"]) ** 2).sum()
    assert row["reading_freedom"] == 2 * count - 6
    assert_close(
        "rae sigma by differences", row["reading_sigma_mm"], np.sqrt(squares / (2 * count - 6))
    )
    given = vopd("stars", "solve", "-", *options, "--reading-sigma", "0.02", stdin=text)
    (stated,) = json.loads(given.stdout)
    assert stated["reading_sigma_mm"] == 0.02 and "reading_freedom" not in stated
    for name in ("rotation_sigma_arcsec", "camera_sigma_m"):
        ratio = np.divide(stated[name], row[name]) * row["reading_sigma_mm"]
        assert_close("rae sigma by differences", ratio, 0.02 * np.ones(3))


# Positions of the camera solved with the attitude: values, deviations, needs and errors


COUNT = 8
IMAGE = np.random.default_rng(2).uniform(-20.0, 20.0, (COUNT, 2))


def star_file(count: int = COUNT, kind: str = "ra_deg,dec_deg") -> StarFile:
    lines = tuple(range(2, 2 + count))
    points = np.column_stack([100.0 * IMAGE, 5.0 * IMAGE[:, 0]])[:count]
    return StarFile("a.csv", lines, ("",) * count, IMAGE[:count], "mm", kind, points)


GROUND_POSITIONS = "x_m,y_m,z_m"
POSITION = np.array([10.0, 20.0, 7600.0])


def position(**more: Any) -> Resection:
    given: dict[str, Any] = {
        "failure": Failure.NONE, "matrix": np.eye(3), "position": POSITION, "iterations": 7,
        "residuals": np.tile([0.3, -0.4], (COUNT, 1)),
        "covariance": np.diag([1e-6, 4e-6, 9e-6, 16.0, 25.0, 36.0]),
    } | more  # fmt: skip
    return Resection(**given)


def resect(
    monkeypatch: pytest.MonkeyPatch, found: Resection, errors: np.ndarray | None = None,
    sigma: float | None = None, file: StarFile | None = None,
) -> tuple[StarField, SolvedStars, list[Any], list[Any]]:  # fmt: skip
    given: list[Any] = []
    monkeypatch.setattr(
        solved_resection, "resection", lambda *arguments: given.extend(arguments) or found
    )
    ground = file or star_file(kind=GROUND_POSITIONS)
    image = IMAGE[: len(ground.lines)]
    return *solve_resection(ground, image, 76.0, errors, sigma), given


@pytest.mark.parametrize("stated", [None, 0.25])
@pytest.mark.parametrize("by_sigma", [False, True])
def test_a_position(monkeypatch: pytest.MonkeyPatch, stated: float | None, by_sigma: bool) -> None:
    """Residuals of .5 in sixteen coordinates less six; with sigmas of 2 they count a quarter."""
    errors = np.tile(4.0 * np.eye(2), (COUNT, 1, 1)) if by_sigma else None
    stars, one, findings, given = resect(monkeypatch, position(), errors, stated)
    assert given[0].shape == (COUNT, 3) and given[1] is not None and given[2] == 76.0
    assert (given[3] is not None) == by_sigma and (stars.errors is not None) == by_sigma
    size = stated or (COUNT * 0.25 / (4.0 if by_sigma else 1.0) / 10.0) ** 0.5
    assert (one.method, one.stars, one.iterations) == ("resection", tuple(range(1, 9)), 7)
    assert one.converged and one.camera_m == [10.0, 20.0, 7600.0]
    assert one.camera_sigma_m is not None and one.rotation_sigma_arcsec is not None
    assert_close("rae element", one.camera_sigma_m, np.array([4.0, 5.0, 6.0]) * size)
    turns = np.degrees(np.array([1e-3, 2e-3, 3e-3]) * size) * 3600.0
    assert_close("rae angle", one.rotation_sigma_arcsec, turns)
    assert_close("rae element", one.reading_sigma, size)  # type: ignore[arg-type]
    assert one.reading_freedom == (10 if stated is None else None)
    away = star_file(kind=GROUND_POSITIONS).positions - POSITION
    assert_close("rae element", stars.directions, away / np.linalg.norm(away, axis=1)[:, None])
    assert findings == []


@pytest.mark.parametrize("stated", [None, 0.25])
def test_what_the_readings_do_not_determine(
    monkeypatch: pytest.MonkeyPatch, stated: float | None
) -> None:
    """An attitude known to 14 degrees is refused, however the reading sigma is known."""
    _, solved, _, _ = resect(monkeypatch, position(covariance=np.eye(6)), sigma=stated)
    assert solved.failure == Failure.TOO_UNCERTAIN
    for degrees, failure in ((2.99, Failure.NONE), (3.01, Failure.TOO_UNCERTAIN)):
        spread = np.eye(6) * np.radians(degrees) ** 2
        _, solved, _, _ = resect(monkeypatch, position(covariance=spread), sigma=1.0)
        assert solved.failure == failure
