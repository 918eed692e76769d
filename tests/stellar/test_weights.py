"""Weights of observations and stars."""

from __future__ import annotations

import json
from math import log, sqrt
from typing import Any

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from tests.approved.texts import assert_approved, refused
from tests.kit.command import Ran, vopd
from tests.tolerances import assert_close, within
from vopd.findings import InputError
from vopd.stellar import StarField, church, collinearity, find_outliers, uncertainty, wahba
from vopd.stellar.files.images import reading_errors
from vopd.stellar.files.read import StarFile
from vopd.stellar.methods.weights import (
    church_formula_weights,
    direction_weights,
    huber,
    listed,
    ray_partials,
    residual_weights,
    star_weights,
)

# Weights of the user: standard deviations, correlation, magnitude and elongation of images


COUNT, FOCAL, DRAWS = 9, 60.0, 4000
LOOK = Rotation.from_euler("ZYX", [40.0, 25.0, -70.0], degrees=True).as_matrix()


def problem() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Images, directions and covariance matrices whose sizes differ a hundredfold."""
    rng = np.random.default_rng(7)
    images = rng.uniform(-18.0, 18.0, (COUNT, 2))
    rays = np.column_stack([images, np.full(COUNT, -FOCAL)])
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    sigma = 0.005 * 10.0 ** rng.uniform(-0.5, 0.5, (COUNT, 2))
    rho = rng.uniform(-0.8, 0.8, COUNT)
    mixed = sigma.prod(axis=1) * rho
    covariance = np.array(
        [[[sx**2, m], [m, sy**2]] for (sx, sy), m in zip(sigma, mixed, strict=True)]
    )
    return images, rays @ LOOK, covariance


def drawn(images: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    rng = np.random.default_rng(8)
    root = np.linalg.cholesky(covariance)
    return images + np.einsum("nij,dnj->dni", root, rng.normal(size=(DRAWS, COUNT, 2)))


METHODS: dict[str, tuple[Any, Any]] = {
    "collinearity": (collinearity, lambda f: uncertainty.collinearity_covariance(f, LOOK)),
    "svd": (wahba, uncertainty.wahba_covariance),
    "church": (church, lambda f: uncertainty.church_covariance(f, LOOK)),
    "church-weighted": (
        lambda f: church(f, weights="formula"),
        lambda f: uncertainty.church_covariance(f, LOOK, weights="formula"),
    ),
}


@pytest.mark.parametrize("method", METHODS)
def test_counted_errors_have_the_stated_covariance(method: str) -> None:
    """Of 4,000 draws with correlated errors of different sizes."""
    solve, stated_by = METHODS[method]
    images, stars, covariance = problem()
    stated = stated_by(StarField.of(stars, images, FOCAL, errors=covariance))
    field = StarField.of(stars, drawn(images, covariance), FOCAL, errors=covariance)
    turns = Rotation.from_matrix(solve(field).rotation() @ LOOK.T).as_rotvec()
    counted = np.cov(turns.T)
    sigmas = np.sqrt(np.diag(stated))
    assert np.abs(np.sqrt(np.diag(counted)) / sigmas - 1.0).max() < within("rae stated sigma")
    off = np.abs((counted - stated) / np.outer(sigmas, sigmas)).max()
    assert off < within("rae stated correlation")


def test_weights_make_the_error_smaller() -> None:
    images, stars, covariance = problem()
    read = drawn(images, covariance)
    errors = []
    for given in (covariance, None):
        solved = collinearity(StarField.of(stars, read, FOCAL, errors=given)).matrix
        errors.append(np.mean(Rotation.from_matrix(solved @ LOOK.T).magnitude() ** 2))
    assert errors[0] < 0.5 * errors[1]


def solve(text: str, *arguments: str) -> Ran:
    return vopd("stars", "solve", "-", "--focal", str(FOCAL), "--format", "json", *arguments,
                stdin=text)  # fmt: skip


def written(read: np.ndarray, stars: np.ndarray, more: dict[str, np.ndarray]) -> str:
    table = np.column_stack([read, stars, *more.values()])
    head = ",".join(["x_mm,y_mm,u,v,w", *more])
    return "\n".join([head, *(",".join(f"{v:.17g}" for v in row) for row in table)]) + "\n"


def sigmas(covariance: np.ndarray) -> dict[str, np.ndarray]:
    sx, sy = np.sqrt(covariance[:, 0, 0]), np.sqrt(covariance[:, 1, 1])
    rho = covariance[:, 0, 1] / sx / sy
    return {"sigma_x_mm": sx, "sigma_y_mm": sy, "rho_xy": rho}


def test_columns_of_sigma_and_correlation_weigh_as_scipy_does() -> None:
    """The least-squares attitude by scipy, of residuals made independent by Cholesky factors."""
    images, stars, covariance = problem()
    read = drawn(images, covariance)[0]
    result = solve(written(read, stars, sigmas(covariance)))
    (row,) = json.loads(result.stdout)
    root = np.linalg.inv(np.linalg.cholesky(covariance))

    def residuals(turn: np.ndarray) -> np.ndarray:
        p, q, r = (Rotation.from_rotvec(turn).as_matrix() @ LOOK) @ stars.T
        off = read - np.column_stack([-FOCAL * p / r, -FOCAL * q / r])
        return np.einsum("nij,nj->ni", root, off).ravel()

    found = least_squares(residuals, np.zeros(3), xtol=1e-15, ftol=1e-15, gtol=1e-15)
    expected = Rotation.from_rotvec(found.x).as_matrix() @ LOOK
    assert np.abs(np.array(row["matrix"]) - expected).max() < within("rae weighted element")
    stated = np.sqrt(np.diag(np.linalg.inv(found.jac.T @ found.jac)))
    ratio = np.radians(np.array(row["rotation_sigma_arcsec"]) / 3600.0) / stated
    assert np.abs(ratio - 1.0).max() < within("rae sigma by scipy")


def test_a_y_axis_that_points_down_turns_the_correlation_too() -> None:
    images, stars, covariance = problem()
    read = drawn(images, covariance)[0]
    columns = sigmas(covariance)
    (up,) = json.loads(solve(written(read, stars, columns)).stdout)
    columns["rho_xy"] = -columns["rho_xy"]
    (down,) = json.loads(solve(written(read * [1.0, -1.0], stars, columns), "--y-down").stdout)
    assert_close("rae angle", down["omega_deg"], up["omega_deg"])
    assert_close("rae angle", down["kappa_deg"], up["kappa_deg"])


def test_one_sigma_for_all_is_the_reading_sigma() -> None:
    images, stars, covariance = problem()
    read = drawn(images, covariance)[0]
    (stated,) = json.loads(solve(written(read, stars, {"sigma": np.full(COUNT, 0.02)})).stdout)
    plain = json.loads(solve(written(read, stars, {}), "--reading-sigma", "0.02").stdout)[0]
    assert_close("rae angle", stated["omega_deg"], plain["omega_deg"])
    assert_close("rae stack element", stated["reading_sigma_mm"], 0.02)
    assert_close("rae sum of seconds", stated["rotation_sigma_arcsec"],
                 plain["rotation_sigma_arcsec"])  # fmt: skip


def test_magnitude_and_elongation_as_weights() -> None:
    """By hand: the variance of a star at the limit is twice that of a bright one; e squared."""
    images, stars, covariance = problem()
    read = drawn(images, covariance)[0]
    magnitude = np.array([-30.0, 6.0, 6.0, 8.5, 3.5, -30.0, -30.0, -30.0, 6.0])
    variance = 1.0 + 10.0 ** (0.4 * (magnitude - 6.0))
    assert_close("rae stack element", variance[[0, 1, 3]], [1.0, 2.0, 11.0])
    (found,) = json.loads(
        solve(written(read, stars, {"mag": magnitude}), "--magnitude-limit", "6").stdout
    )
    (expected,) = json.loads(solve(written(read, stars, {"sigma": np.sqrt(variance)})).stdout)
    assert_close("rae angle", found["omega_deg"], expected["omega_deg"])
    length = np.linspace(1.0, 3.0, COUNT)
    (found,) = json.loads(
        solve(written(read, stars, {"elongation": length}), "--weigh-elongation").stdout
    )
    (expected,) = json.loads(solve(written(read, stars, {"sigma": length})).stdout)
    assert_close("rae angle", found["kappa_deg"], expected["kappa_deg"])


SKY = "x_mm,y_mm,ra_deg,dec_deg"
REFUSED = {
    "no magnitude": (f"{SKY},mag\n1,2,3,4,5\n5,6,7,8,\n", ("--magnitude-limit", "6")),
    "no column": (f"{SKY}\n1,2,3,4\n5,6,7,8\n", ("--weigh-elongation",)),
    "short": (f"{SKY},elongation\n1,2,3,4,.5\n5,6,7,8,1\n", ("--weigh-elongation",)),
    "two sigmas": (f"{SKY},sigma\n1,2,3,4,1\n5,6,7,8,1\n", ("--reading-sigma", "1")),
    "listed": (f"{SKY},sigma\n1,2,3,4,1\n5,6,7,8,1\n", ("--weights", "listed")),
    "rho": (f"{SKY},sigma_x_mm,sigma_y_mm,rho_xy\n1,2,3,4,1,1,1\n", ()),
}


@pytest.mark.parametrize("name", REFUSED)
def test_weights_that_cannot_be_are_refused(name: str) -> None:
    text, options = REFUSED[name]
    result = solve(text, *options)
    assert result.status == 1
    assert_approved(result.stderr)


@pytest.mark.parametrize("wrong", [[4], [0, 5], [1, 2, 8]])
def test_editing_by_pairs_finds_the_wrong_stars(wrong: list[int]) -> None:
    images, stars, _ = problem()
    read = images + np.random.default_rng(9).normal(0.0, 0.005, images.shape)
    read[wrong] += [[3.0, -2.0]] * len(wrong)
    field = StarField.of(stars, read, FOCAL)
    assert sorted(one.star for one in find_outliers(field, start="pairs")) == wrong
    text = written(read, stars, {})
    (row,) = json.loads(solve(text, "--edit-by-pairs").stdout)
    assert row["stars"] == [k + 1 for k in range(COUNT) if k not in wrong]
    assert solve(text, "--edit-by-pairs", "--reject").status == 2
    assert solve(text, "--edit-by-pairs", "--all-pairs").status == 2


# Weights of residuals and directions: each rule by hand, both sides of each limit


FOCAL_WEIGHTS = np.array([100.0])


def field(used: object = True, errors: object = None) -> StarField:
    images = [[3.0, 4.0], [-60.0, 0.0], [0.0, 80.0], [10.0, -20.0]]
    rays = np.column_stack([images, [-100.0] * 4])
    return StarField.of(rays, images, 100.0, used, errors)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("residual", "weight"),
    [
        (0.0, 0.0), (0.99e-7, 0.0), (1e-7, 3.0), (1.01e-7, 3.0), (0.00099, 3.0), (0.000999, 3.0),
        (0.001001, 0.000009 / 0.001001**2), (0.0012, 6.25), (0.003, 1.0), (0.03, 0.01), (3.0, 1e-6),
    ],
)  # fmt: skip
def test_reswts(residual: float, weight: float) -> None:
    """(.003 / residual)**2, 3 above 9, which is at .001 mm, and 0 below 1E-7 mm; either sign."""
    found = listed(np.array([[residual, -residual], [-residual, 0.0]]))
    assert_close("rae element", found, [[weight, weight], [weight, 0.0]])


def by_hand(lengths: list[float], sigma: float) -> list[float]:
    """Huber's weights: 1 up to two sigmas, from there two sigmas over the length."""
    return [min(1.0, 2.0 * sigma / one) if one else 1.0 for one in lengths]


LENGTHS = [0.01, 0.05, 0.02, 0.5, 0.04]


def residuals(lengths: list[float]) -> np.ndarray:
    """Residuals of these lengths, by 3 and 4 of 5 to either side."""
    signs = np.array([[0.6, -0.8], [-0.8, 0.6], [0.8, 0.6], [-0.6, -0.8], [0.0, 1.0]])
    return np.array(lengths)[:, None] * signs[: len(lengths)]


@pytest.mark.parametrize("sigma", [0.001, 0.01, 0.02, 0.025, 0.1, 1.0])
def test_hubers_weights_with_a_reading_sigma(sigma: float) -> None:
    found = huber(residuals(LENGTHS), np.ones(5, bool), FOCAL_WEIGHTS, sigma)
    expected = by_hand(LENGTHS, sigma)
    assert_close("rae element", found, np.column_stack([expected, expected]))


@pytest.mark.parametrize(
    ("used", "median"),
    [([1, 1, 1, 1, 1], 0.04), ([1, 1, 1, 1, 0], 0.035), ([1, 1, 1, 0, 0], 0.02),
     ([1, 1, 0, 0, 0], 0.03), ([1, 0, 0, 0, 0], 0.01)],
)  # fmt: skip
def test_hubers_weights_with_the_sigma_of_the_median(used: list[int], median: float) -> None:
    """A plane vector's median is sqrt(2 ln 2) sigmas; 2 n coordinates have 2 n - 3 of freedom."""
    n = sum(used)
    sigma = median / sqrt(2.0 * log(2.0)) * sqrt(2.0 * n / max(2.0 * n - 3.0, 1.0))
    found = huber(residuals(LENGTHS), np.array(used, bool), FOCAL_WEIGHTS)
    expected = by_hand(LENGTHS, sigma)
    assert_close("rae element", found, np.column_stack([expected, expected]))
    if n == 5:
        assert min(expected) < 0.5 and sorted(expected)[1] == 1.0


def test_rounding_is_not_weighed() -> None:
    """The bend is a billionth of the principal distance at least: 1E-7 of 100 mm."""
    exact = residuals([1e-9, 0.5e-7, 0.99e-7, 2e-7, 0.0])
    found = huber(exact, np.ones(5, bool), FOCAL_WEIGHTS, 1e-12)[:, 0]
    assert_close("rae element", found, [1.0, 1.0, 1.0, 0.5, 1.0])
    assert (huber(0.0 * exact, np.ones(5, bool), FOCAL_WEIGHTS) == 1.0).all()


def test_the_three_rules() -> None:
    """A star that is not used has weight 0 by each; the sigma counts for the robust rule alone."""
    off = residuals([0.01, 0.002, 0.02, 0.5])
    one = field([True, True, False, True])
    assert residual_weights("uniform", off, one, 0.01).tolist() == [[1, 1], [1, 1], [0, 0], [1, 1]]
    expected = listed(off)
    expected[2] = 0.0
    assert residual_weights("listed", off, one, 0.01).tolist() == expected.tolist()
    found = residual_weights("robust", off, one, 0.1)
    assert_close("rae element", found, [[1.0, 1.0], [1.0, 1.0], [0.0, 0.0], [0.4, 0.4]])
    median = residual_weights("robust", off, one, None)  # of .002, .01 and .5
    sigma = 0.01 / sqrt(2.0 * log(2.0)) * sqrt(6.0 / 3.0)
    assert_close("rae element", median[3], [4.0 * sigma] * 2)


def cosines(x: float, y: float) -> np.ndarray:
    return np.array([x, y, -100.0]) / sqrt(x * x + y * y + 1e4)


def partials(x: float, y: float) -> np.ndarray:
    """dP, dQ, dR by x and y, (3, 2), by differences of 2E-4 mm."""
    h = 1e-4
    by_x = (cosines(x + h, y) - cosines(x - h, y)) / (2.0 * h)
    by_y = (cosines(x, y + h) - cosines(x, y - h)) / (2.0 * h)
    return np.column_stack([by_x, by_y])


IMAGES = [(3.0, 4.0), (-60.0, 20.0), (10.0, 80.0), (10.0, -20.0)]


def test_formula_weights_are_those_of_the_cosines_variances() -> None:
    """1 / (dP/dx**2 + dP/dy**2) and so on; near the point sigma**2 stands beside r**2."""
    found = church_formula_weights(np.array(IMAGES), FOCAL_WEIGHTS)
    for k, (x, y) in enumerate(IMAGES):
        expected = 1.0 / (partials(x, y) ** 2).sum(axis=1)
        assert_close("rae weight by differences", found[:, k] / expected, 1.0)
    bounded = church_formula_weights(np.array([[3.0, 4.0], [0.0, 0.0]]), FOCAL_WEIGHTS, 0.5)
    assert_close("ratio", bounded[:2, 0] / found[:2, 0], 1.0)
    assert_close("ratio", bounded[2, 0] / found[2, 0], 25.0 / 25.25)
    assert_close("rae element", bounded[2, 1] / 4e8, 1.0)  # 100**6 / (100**2 / 4)
    assert np.isinf(church_formula_weights(np.zeros((1, 2)), FOCAL_WEIGHTS)[2, 0])


COVARIANCES = np.array(
    [[[4.0, 1.0], [1.0, 2.0]], [[1.0, 0.0], [0.0, 9.0]], [[0.25, 0.0], [0.0, 0.25]], [[3.0, -1.0],
     [-1.0, 1.0]]]
)  # fmt: skip


def test_weights_of_stars_with_errors() -> None:
    """The inverse of the mean of the variances of x and y; without errors 1, not used 0."""
    used = np.array([True, True, False, True])
    assert star_weights(field(used)).tolist() == [1.0, 1.0, 0.0, 1.0]
    found = star_weights(field(used, COVARIANCES))
    assert_close("rae element", found, [1.0 / 3.0, 0.2, 0.0, 0.5])
    assert_close("rae element", star_weights(field(True, COVARIANCES))[2], 4.0)


def test_weights_of_directions_with_errors() -> None:
    rays = np.column_stack([IMAGES, [-100.0] * 4])
    used = np.array([True, True, False, True])
    one = StarField.of(rays, IMAGES, 100.0, used, COVARIANCES)
    slopes, weights = ray_partials(one), direction_weights(one, None)
    bounded = direction_weights(one, 0.5)
    for k in (0, 1, 3):
        x, y = IMAGES[k]
        by = partials(x, y)
        assert_close("rae angle", slopes[k], by)
        variance = np.diag(by @ COVARIANCES[k] @ by.T)
        assert_close("rae weight by differences", weights[:, k] * variance, 1.0)
        mean = np.trace(COVARIANCES[k]) / 2.0  # f**2 (mean sigma)**2 / d**6 is added to R's
        more = 100.0**2 * (mean * 0.5) ** 2 / (x * x + y * y + 1e4) ** 3
        assert_close("rae weight by differences", bounded[2, k] * (variance[2] + more), 1.0)
        assert_close("ratio", bounded[:2, k] / weights[:2, k], 1.0)
    assert (slopes[2] == 0.0).all() and np.isinf(weights[:, 2]).all()
    plain = direction_weights(StarField.of(rays, IMAGES, 100.0), 0.5)
    formula = church_formula_weights(np.array(IMAGES), FOCAL_WEIGHTS, 0.5)
    assert_close("ratio", plain[:2] / formula[:2], 1.0)


@pytest.mark.parametrize("rule", ["uniform", "formula", "formula-r"])
@pytest.mark.parametrize("sigma", [None, 0.5])
def test_church_weighs_stars_and_cosines_by_their_errors(rule: str, sigma: float | None) -> None:
    """Each row of M by numpy: by the mean variance of x and y, or by that of P, Q, R."""
    images = np.array([*IMAGES, (-30.0, -45.0), (50.0, 15.0)])
    errors = np.concatenate([COVARIANCES, COVARIANCES[:2] * 0.3])
    off = np.array([[0.2, -0.1], [0.1, 0.3], [-0.3, 0.1], [0.0, -0.2], [0.2, 0.2], [-0.1, 0.0]])
    stars = np.array([cosines(x, y) for x, y in images])
    read = images + off
    solved = church(StarField.of(stars, read, 100.0, True, errors), weights=rule,
                    reading_sigma_mm=sigma)  # type: ignore[arg-type]  # fmt: skip
    mean = np.trace(errors, axis1=1, axis2=2) / 2.0
    photo = np.array([cosines(x, y) for x, y in read])
    for row in range(3):
        weight = 1.0 / mean
        if rule == "formula" or (rule == "formula-r" and row == 2):
            by = np.array([partials(x, y)[row] for x, y in read])
            variance = np.einsum("ni,nij,nj->n", by, errors, by)
            if row == 2 and sigma is not None:
                square = (read**2).sum(axis=1) + 1e4
                variance += 1e4 * (mean * sigma) ** 2 / square**3
            weight = 1.0 / variance
        root = np.sqrt(weight)
        expected = np.linalg.lstsq(root[:, None] * stars, root * photo[:, row], rcond=None)[0]
        assert_close("rae rotation", solved.matrix[row], expected)


# Errors of readings by columns of sigma, magnitude and elongation, worked by hand


ZERO = np.zeros((3, 2))
ROUND = np.broadcast_to(np.eye(2), (3, 2, 2))


def star_file(**columns: Any) -> StarFile:
    given = {name: np.array(value) for name, value in columns.items()}
    return StarFile("a.csv", (12, 13, 14), ("",) * 3, ZERO, "mm", "name", ZERO, **given)  # type: ignore[arg-type]


BRIGHT, LONG = [5.0, 7.5, 10.0], [1.0, 2.0, 3.0]
"""2.5 magnitudes are a factor of 10 in light."""

Model = tuple[float | None, bool]
"""The magnitude limit, and whether errors grow with the elongation."""

PLAIN: Model = (None, False)
BY_LENGTH: Model = (None, True)


def errors_of(file: StarFile, model: Model = PLAIN, *, flipped: bool = False) -> tuple[Any, Any]:
    return reading_errors(file, model[0], by_elongation=model[1], flipped=flipped)


FACTORS: list[tuple[Model, list[float]]] = [
    ((7.5, False), [1.1, 2.0, 11.0]),
    ((5.0, False), [2.0, 11.0, 101.0]),
    ((None, True), [1.0, 4.0, 9.0]),
    ((7.5, True), [1.1, 8.0, 99.0]),
]


@pytest.mark.parametrize(("model", "factors"), FACTORS)
def test_variances_by_brightness_and_length(model: Model, factors: list[float]) -> None:
    """Relative to their mean; the reading sigma to that of a bright and round star."""
    relative, sigma = errors_of(star_file(magnitude=BRIGHT, elongation=LONG), model, flipped=True)
    assert relative is not None
    assert_close("rae element", sigma, np.mean(factors) ** 0.5)
    expected = np.array(factors)[:, None, None] / np.mean(factors) * ROUND
    assert_close("rae element", relative, expected)


def test_errors_that_are_all_alike() -> None:
    same = star_file(magnitude=[6.0] * 3, elongation=[2.0] * 3)
    for model, sigma in ((PLAIN, 1.0), ((6.0, False), 2.0**0.5), (BY_LENGTH, 2.0)):
        relative, found = errors_of(same, model)
        assert relative is None
        assert_close("rae element", found, sigma)
    bright = star_file(magnitude=BRIGHT, elongation=LONG)
    assert errors_of(bright) == (None, 1.0)


def test_faint_and_bright_beyond_measure() -> None:
    """Differences count up to 50 magnitudes, which are a factor of 1E20."""
    relative, _ = errors_of(star_file(magnitude=[-100.0, 60.0, 100.0]), (10.0, False))
    assert relative is not None
    ratio = relative[:, 0, 0] / relative[2, 0, 0]
    assert_close("rae element", ratio, [1e-20, 1.0, 1.0])


SIGMAS = [[0.1, 0.2, 0.5], [0.3, 0.1, -0.25], [0.2, 0.2, 0.0]]
COVARIANCE = [
    [[0.01, 0.01], [0.01, 0.04]], [[0.09, -0.0075], [-0.0075, 0.01]], [[0.04, 0.0], [0.0, 0.04]],
]  # fmt: skip


@pytest.mark.parametrize("flipped", [False, True])
def test_stated_standard_deviations(flipped: bool) -> None:
    """The reading sigma is their root mean square: squares of .23 in six coordinates."""
    relative, sigma = errors_of(star_file(sigmas=SIGMAS), flipped=flipped)
    assert relative is not None and sigma is not None
    mean = 0.23 / 6.0
    turn = np.array([[1.0, -1.0], [-1.0, 1.0]]) if flipped else np.ones((2, 2))
    assert_close("rae element", relative, np.array(COVARIANCE) * turn / mean)
    assert_close("rae element", sigma, mean**0.5)


def test_stated_standard_deviations_of_long_images() -> None:
    """Variances times 1, 4, 9: .05 + .4 + .72."""
    file = star_file(sigmas=SIGMAS, elongation=LONG)
    relative, sigma = errors_of(file, BY_LENGTH)
    assert relative is not None and sigma is not None
    mean = (0.05 + 0.4 + 0.72) / 6.0
    expected = np.array(COVARIANCE) * np.array([1.0, 4.0, 9.0])[:, None, None] / mean
    assert_close("rae element", relative, expected)
    assert_close("rae element", sigma, mean**0.5)


REFUSED_ERRORS = [
    ({}, (7.0, False)),
    ({"elongation": LONG}, (7.0, False)),
    ({"magnitude": BRIGHT}, BY_LENGTH),
    ({"magnitude": [1, np.nan, np.nan]}, (7.0, False)),
    ({"elongation": [1, 1, np.nan]}, BY_LENGTH),
    ({"elongation": [1, 0.99, 0.5]}, BY_LENGTH),
]  # fmt: skip


@pytest.mark.parametrize(("columns", "model"), REFUSED_ERRORS)
def test_columns_that_lack(columns: dict[str, Any], model: Model) -> None:
    with refused(InputError):
        errors_of(star_file(**columns), model)
    empty = star_file(magnitude=[np.nan] * 3, elongation=[0.5] * 3)
    assert errors_of(empty) == (None, 1.0)
