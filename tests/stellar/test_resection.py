"""Position and attitude together from ground points."""

from __future__ import annotations

import json

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from tests.kit.command import DECKS, vopd
from tests.tolerances import assert_close, within
from vopd.stellar.field import Failure
from vopd.stellar.methods.resection import resection, three_point_resection

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
    "three points": (HEAD + "1,2,3,4,5\n2,4,1,5,9\n7,1,2,6,4\n", "takes 4 points at least"),
    "stars": ("x_mm,y_mm,ra_deg,dec_deg\n1,2,3,4\n5,6,7,8\n", "is for ground points"),
    "one point": (HEAD + "1,2,3,4,5\n" * 5, "the stars leave the attitude undetermined"),
    "a line": (HEAD + "".join(f"{k},0,{k},0,0\n" for k in range(6)), "undetermined"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_has_no_position_is_refused(name: str) -> None:
    text, said = REFUSED[name]
    result = vopd("stars", "solve", "-", "--focal", "100", "--resection", stdin=text)
    assert result.status == 1 and said in result.stderr, result.stderr


@pytest.mark.parametrize("option", ["--camera=1,2,3", "--reject", "--pair=1,2", "--method=svd"])
def test_options_without_use_are_refused(option: str) -> None:
    result = vopd("stars", "solve", GROUND, "--focal", "152.4", "--resection", option)
    assert result.status == 2 and "exclude each other" in result.stderr


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
