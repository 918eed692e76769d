"""Uncertainty of attitudes, and the region of the optical axis."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy import stats
from scipy.linalg import polar
from scipy.spatial.transform import Rotation
from scipy.stats import chi2
from scipy.stats import f as f_distribution

from tests.kit.command import DECKS, vopd
from tests.kit.stars import seen_straight, solve_text
from tests.tolerances import assert_close, within
from vopd.geometry.linear import confidence_ellipse, covariance_factor_95
from vopd.geometry.rotations import nearest_rotation
from vopd.stellar import (
    Failure,
    StarField,
    StarSolution,
    alpha_delta_swing_deg,
    church,
    collinearity,
    omega_phi_kappa_deg,
    orientation_matrix,
    single_rotation,
    two_star,
    uncertainty,
    wahba,
)
from vopd.stellar.interstar_angles import _angle_gain, interstar_reading_sigma_mm
from vopd.stellar.tables_1987 import DIRECTIONS, EXACT_MM, TRUTH_DEG, sample_field
from vopd.stellar.uncertainty import (
    angle_sigmas_rad,
    boresight_region,
    church_covariance,
    collinearity_covariance,
    pair_covariance,
    turns_of_pointing,
    wahba_covariance,
)

# The stated uncertainty against counted errors, and solutions that are refused


DRAWS = 4000
SIGMA_MM = 0.01
TRUTH = orientation_matrix(TRUTH_DEG)
FOUR, PAIR = [0, 1, 2, 3], [1, 3]
Stated = Callable[[StarField], np.ndarray]
METHODS: dict[str, tuple[list[int], Callable[[StarField], StarSolution], Stated]] = {
    "collinearity": (
        FOUR, collinearity, lambda f: uncertainty.collinearity_covariance(f, TRUTH)
    ),
    "svd": (FOUR, wahba, uncertainty.wahba_covariance),
    "church": (FOUR, church, lambda f: uncertainty.church_covariance(f, TRUTH)),
    "church-weighted": (
        FOUR,
        lambda f: church(f, weights="formula"),
        lambda f: uncertainty.church_covariance(f, TRUTH, weights="formula"),
    ),
    "two-star": (PAIR, two_star, lambda f: uncertainty.pair_covariance(f, TRUTH, two_star)),
    "single-rotation": (
        PAIR, single_rotation, lambda f: uncertainty.pair_covariance(f, TRUTH, single_rotation)
    ),
}  # fmt: skip


def drawn(stars: list[int], exact_mm: np.ndarray = EXACT_MM) -> StarField:
    noise = np.random.default_rng(21).normal(0.0, SIGMA_MM, (DRAWS, len(stars), 2))
    return StarField.of(DIRECTIONS[stars], exact_mm[stars] + noise, 76.0)


def turns(matrix: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Rotation vectors from the truth, about the camera's axes, radians."""
    return Rotation.from_matrix(matrix @ truth.T).as_rotvec()


@pytest.mark.parametrize("method", METHODS)
def test_counted_errors_have_the_stated_covariance(method: str) -> None:
    """Of 4,000 draws: deviations and correlations."""
    stars, solve, covariance = METHODS[method]
    stated = covariance(StarField.of(DIRECTIONS[stars], EXACT_MM[stars], 76.0)) * SIGMA_MM**2
    counted = np.cov(turns(solve(drawn(stars)).rotation(), TRUTH).T)
    sigmas = np.sqrt(np.diag(stated))
    assert np.abs(np.sqrt(np.diag(counted)) / sigmas - 1.0).max() < within("rae stated sigma")
    assert np.abs((counted - stated) / np.outer(sigmas, sigmas)).max() < within(
        "rae stated correlation"
    )


@pytest.mark.parametrize("flat", [0.3, 0.1, 0.03, 0.01, 0.003, 0.001])
def test_church_near_a_great_circle_is_refused_or_good_to_its_sigma(flat: float) -> None:
    """Ten stars on a strip this high, in focal lengths, read to .1 mm of 76 mm."""
    rng = np.random.default_rng(31)
    images = np.column_stack([np.linspace(-15.0, 15.0, 10), 76.0 * flat * rng.uniform(-1, 1, 10)])
    rays = np.column_stack([images, np.full(10, -76.0)])
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    noisy = images + rng.normal(0.0, 0.1, (1000, 10, 2))
    solution = church(StarField.of(rays, noisy, 76.0))
    exact = StarField.of(rays, images, 76.0)
    covariance = uncertainty.church_covariance(exact, np.eye(3)) * 0.1**2
    largest = np.sqrt(np.linalg.eigvalsh(covariance)[-1])
    refused = np.degrees(largest) > uncertainty.LARGEST_SIGMA_DEG
    good = solution.failure == Failure.NONE
    assert set(solution.failure.tolist()) <= {Failure.NONE, Failure.NOT_A_ROTATION}
    if flat >= 0.1:
        assert good.all() and not refused
    if flat <= 0.001:
        assert refused or not good.any()
    if good.any() and not refused:
        error = np.linalg.norm(turns(solution.rotation()[good], np.eye(3)), axis=1)
        stated = np.sqrt(np.trace(covariance))
        assert np.sqrt(np.mean(error**2)) < 1.3 * stated
        assert error.max() < 5.0 * stated


def test_the_command_refuses_what_the_readings_do_not_determine() -> None:
    """Two stars .02 mm apart, read to .01 mm: some 30 degrees about the optical axis."""
    text = seen_straight((0.0, 0.0), (0.02, 0.0), (0.0, 0.02))
    result = solve_text(text, "--reading-sigma", "0.01", "--pair", "1,2")
    assert result.status == 1
    assert "lines 2 and 3: collinearity: the stars do not determine" in result.stderr
    wide = seen_straight((0.0, 0.0), (20.0, 0.0), (0.0, 20.0))
    assert solve_text(wide, "--reading-sigma", "0.01", "--pair", "1,2").status == 0


@pytest.mark.parametrize("count", [3, 8, 200])
def test_interstar_angles_tell_the_reading_error(count: int) -> None:
    """The median of the estimates from 100 photographs of stars all over the field."""
    rng = np.random.default_rng(41)
    found = []
    for _ in range(100):
        images = rng.uniform(-18.0, 18.0, (count, 2))
        rays = np.column_stack([images, np.full(count, -50.0)])
        turn = Rotation.random(random_state=rng.integers(1 << 30)).as_matrix()
        stars = rays / np.linalg.norm(rays, axis=1)[:, None] @ turn
        read = images + rng.normal(0.0, 0.01, images.shape)
        found.append(interstar_reading_sigma_mm(StarField.of(stars, read, 50.0)))
    assert abs(np.median(found) / 0.01 - 1.0) < within("rae interstar sigma")


def test_two_stars_tell_no_reading_error() -> None:
    assert np.isnan(interstar_reading_sigma_mm(sample_field().select(np.array([0, 1]))))


def test_the_nearest_rotation_is_scipys() -> None:
    """The polar decomposition; a reflected matrix becomes a rotation too."""
    rng = np.random.default_rng(51)
    matrices = rng.normal(size=(20, 3, 3))
    found = nearest_rotation(matrices)[0]
    assert np.abs(np.linalg.det(found) - 1.0).max() < within("rae element")
    proper = np.linalg.det(matrices) > 0
    expected = np.array([polar(matrix)[0] for matrix in matrices[proper]])
    assert np.abs(found[proper] - expected).max() < within("rae element")
    better = np.einsum("kij,kij->k", found, matrices)
    for other in Rotation.random(50, random_state=1).as_matrix():
        assert (np.einsum("ij,kij->k", other, matrices) <= better + within("rae element")).all()


def test_wahba_is_scipys_align_vectors() -> None:
    field = sample_field()
    expected, _ = Rotation.align_vectors(field.photo, field.directions)
    assert np.abs(wahba(field).matrix - expected.as_matrix()).max() < within("rae rotation")


def test_both_starts_lead_to_the_same_solution() -> None:
    field = drawn(FOUR)
    by_svd, by_pair = (collinearity(field, start=start) for start in ("svd", "two-star"))
    assert by_svd.converged.all() and by_pair.converged.all()
    assert np.abs(by_svd.matrix - by_pair.matrix).max() < within("rae rotation")
    assert by_svd.iterations.mean() < by_pair.iterations.mean()


# Covariances of attitudes and of their angles, by differences of the solutions themselves


FOCAL, COUNT, STEP = 76.0, 6, 1e-4
RNG = np.random.default_rng(8)
TURN = Rotation.from_euler("xyz", [0.3, -0.4, 0.9]).as_matrix()
IMAGE = RNG.uniform(-20.0, 20.0, (COUNT, 2))
RAYS = np.column_stack([IMAGE, np.full(COUNT, -FOCAL)])
SKY = RAYS / np.linalg.norm(RAYS, axis=1)[:, None] @ TURN
ROOTS = RNG.normal(size=(COUNT, 2, 2)) + 2.0 * np.eye(2)
ERRORS = ROOTS @ ROOTS.swapaxes(-1, -2)


def field(image: np.ndarray = IMAGE, count: int = COUNT, **more: Any) -> StarField:
    return StarField.of(SKY[:count], image[:count], FOCAL, **more)


def by_differences(solve: Callable[[np.ndarray], np.ndarray], count: int, errors: Any) -> Any:
    """Covariance of the turn of a solution's rotation, by central differences of the images."""
    gain = np.zeros((3, count, 2))
    for star in range(count):
        for axis in range(2):
            turns = []
            for step in (STEP, -STEP):
                image = IMAGE.copy()
                image[star, axis] += step
                turns.append(Rotation.from_matrix(solve(image) @ TURN.T).as_rotvec())
            gain[:, star, axis] = (turns[0] - turns[1]) / (2.0 * STEP)
    spread = np.tile(np.eye(2), (count, 1, 1)) if errors is None else errors[:count]
    return np.einsum("ina,nab,jnb->ij", gain, spread, gain)


def same(found: np.ndarray, expected: np.ndarray) -> None:
    """Equal in units of the largest element."""
    largest = np.abs(expected).max()
    assert_close("rae sigma by differences", found / largest, expected / largest)


@pytest.mark.parametrize("errors", [None, ERRORS])
def test_wahba(errors: Any) -> None:
    def solve(image: np.ndarray) -> np.ndarray:
        return wahba(field(image, errors=errors)).rotation()

    same(wahba_covariance(field(errors=errors)), by_differences(solve, COUNT, errors))


@pytest.mark.parametrize("errors", [None, ERRORS])
@pytest.mark.parametrize("weights", ["uniform", "formula", "formula-r"])
def test_church(weights: Any, errors: Any) -> None:
    """With the reading sigma that bounds a weight near the principal point."""
    given = {"weights": weights, "reading_sigma_mm": None if weights == "uniform" else 0.5}

    def solve(image: np.ndarray) -> np.ndarray:
        return church(field(image, errors=errors), **given).rotation()

    found = church_covariance(field(errors=errors), TURN, **given)
    same(found, by_differences(solve, COUNT, errors))


@pytest.mark.parametrize("errors", [None, ERRORS])
def test_a_pair(errors: Any) -> None:
    def solve(image: np.ndarray) -> np.ndarray:
        return two_star(field(image, 2, errors=None if errors is None else errors[:2])).rotation()

    pair = field(count=2, errors=None if errors is None else errors[:2])
    images = pair.image_mm.copy()
    same(pair_covariance(pair, TURN, two_star), by_differences(solve, 2, errors))
    assert pair.image_mm.tolist() == images.tolist()


@pytest.mark.parametrize("errors", [None, ERRORS])
@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize("unused", [(), (1, 4)])
def test_collinearity(errors: Any, weighted: bool, unused: tuple[int, ...]) -> None:
    """(D'WD)^-1 D'W W D (D'WD)^-1, D by differences of images under small turns."""
    weights = np.array([[1.0, 0.5], [0.25, 2.0], [1.0, 1.0], [0.1, 3.0], [2.0, 2.0], [0.7, 0.2]])
    used = np.array([k not in unused for k in range(COUNT)])
    root = np.linalg.inv(np.linalg.cholesky(np.tile(np.eye(2), (COUNT, 1, 1)) if errors is None
                                            else errors))  # fmt: skip
    columns = []
    for axis in np.eye(3):
        ends = []
        for step in (1e-6, -1e-6):
            seen = SKY @ (Rotation.from_rotvec(step * axis).as_matrix() @ TURN).T
            ends.append(seen[:, :2] / -seen[:, 2:] * FOCAL)
        change = (ends[0] - ends[1]) / 2e-6
        columns.append(np.einsum("nab,nb->na", root, change)[used].ravel())
    design = np.stack(columns, axis=-1)
    w = np.diag(weights[used].ravel()) if weighted else np.eye(2 * int(used.sum()))
    spread = np.linalg.inv(design.T @ w @ design)
    expected = spread @ design.T @ w @ w @ design @ spread
    one = field(used=used, errors=errors)
    found = collinearity_covariance(one, TURN, weights if weighted else None)
    same(found, expected)


COVARIANCE = np.array([[4.0, 1.5, -0.7], [1.5, 2.0, 0.4], [-0.7, 0.4, 3.0]]) * 1e-8


def jacobian() -> np.ndarray:
    """Changes of the six angles by turns about the camera's axes, from the elements."""

    def angles(m: np.ndarray) -> np.ndarray:
        return np.array([
            np.arctan2(-m[2, 1], m[2, 2]), np.arcsin(m[2, 0]), np.arctan2(-m[1, 0], m[0, 0]),
            np.arctan2(-m[2, 1], -m[2, 0]), np.arcsin(-m[2, 2]), np.arctan2(m[0, 2], m[1, 2]),
        ])  # fmt: skip

    turned = [
        angles(Rotation.from_rotvec(step * axis).as_matrix() @ TURN)
        for axis in np.eye(3)
        for step in (1e-6, -1e-6)
    ]
    return np.stack([(turned[2 * k] - turned[2 * k + 1]) / 2e-6 for k in range(3)], axis=-1)


def test_deviations_of_angles() -> None:
    by_turns = jacobian()
    expected = np.sqrt(np.diag(by_turns @ COVARIANCE @ by_turns.T))
    same(angle_sigmas_rad(TURN[None], COVARIANCE[None])[0], expected)


def test_turns_by_right_ascension_declination_and_swing() -> None:
    same(turns_of_pointing(TURN[None])[0], np.linalg.inv(jacobian()[3:]))


@pytest.mark.parametrize("freedom", [None, 5])
def test_the_region_of_the_optical_axis(freedom: int | None) -> None:
    """Of right ascension times the cosine of the declination, and declination."""
    alpha, delta = jacobian()[3:5]
    cosine = np.hypot(TURN[2, 0], TURN[2, 1])
    east_north = np.stack([alpha * cosine, delta])
    sizes, axes = np.linalg.eigh(east_north @ COVARIANCE @ east_north.T)
    scale = chi2.ppf(0.95, 2) if freedom is None else 2.0 * f_distribution.ppf(0.95, 2, freedom)
    semi_axes, longer = boresight_region(TURN[None], COVARIANCE[None], freedom)
    same(semi_axes[0], np.sqrt(sizes[::-1] * scale))
    angle = np.arctan2(axes[0, 1], axes[1, 1]) % np.pi
    assert_close("rae sigma by differences", longer[0], angle)


@pytest.mark.parametrize("errors", [None, ERRORS[:2]])
def test_how_errors_of_images_change_the_angle_between_them(errors: Any) -> None:
    """The length of the gradient of the angle by each image, in terms of its errors."""

    def angle(image: np.ndarray) -> float:
        one, other = np.column_stack([image, [-FOCAL, -FOCAL]])
        return float(np.arccos(one @ other / np.linalg.norm(one) / np.linalg.norm(other)))

    image = np.array([[15.0, -3.0], [-12.0, 20.0]])
    expected = []
    for star in range(2):
        gradient = []
        for axis in range(2):
            ends = []
            for step in (1e-3, -1e-3):
                moved = image.copy()
                moved[star, axis] += step
                ends.append(angle(moved))
            gradient.append((ends[0] - ends[1]) / 2e-3)
        spread = np.eye(2) if errors is None else errors[star]
        expected.append((np.array(gradient) @ spread @ np.array(gradient)) ** 0.5)
    found = _angle_gain(StarField.of(SKY[:2], image, FOCAL, errors=errors))
    same(found, np.array(expected))


# The 95 percent region and the standard deviations of angles, against counted errors


DRAWS_REGION, FOCAL_REGION, SIGMA = 4000, 50.0, 0.02
LOOK = Rotation.from_euler("ZYX", [-200.0, -55.0, 20.0], degrees=True).as_matrix()


def field_region(count: int, noise: float = SIGMA, seed: int = 1) -> StarField:
    """Stars of a narrow strip, so that the region is long; 4,000 draws of readings."""
    rng = np.random.default_rng(seed)
    images = rng.uniform([-15.0, 3.0], [15.0, 9.0], (count, 2))
    rays = np.column_stack([images, np.full(count, -FOCAL_REGION)])
    stars = rays / np.linalg.norm(rays, axis=1)[:, None] @ LOOK
    return StarField.of(
        stars, images + rng.normal(0.0, noise, (DRAWS_REGION, count, 2)), FOCAL_REGION
    )


def sky(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Right ascension and declination of minus the third row, by hand, radians."""
    u, v, w = -np.moveaxis(matrix[..., 2, :], -1, 0)
    return np.arctan2(v, u), np.arctan2(w, np.hypot(u, v))


@pytest.mark.parametrize("known", [True, False])
@pytest.mark.parametrize("count", [3, 4, 12])
def test_the_region_covers_95_of_100(count: int, known: bool) -> None:
    """4,000 draws, standard deviation .34 percent: within four of them."""
    drawn = field_region(count)
    solution = collinearity(drawn)
    residuals = solution.residuals_mm(drawn)
    freedom = 2 * count - 3
    sigma = np.sqrt((residuals**2).sum(axis=(1, 2)) / freedom)
    covariance = collinearity_covariance(drawn, solution.matrix)
    scale = np.full(DRAWS_REGION, SIGMA) if known else sigma
    semi_axes, angle = boresight_region(
        solution.matrix, covariance * scale[:, None, None] ** 2, None if known else freedom
    )
    ra, dec = sky(solution.matrix)
    true_ra, true_dec = sky(LOOK)
    east, north = (ra - true_ra) * np.cos(true_dec), dec - true_dec
    along = north * np.cos(angle) + east * np.sin(angle)
    across = -north * np.sin(angle) + east * np.cos(angle)
    major, minor = semi_axes.T
    inside = (along / major) ** 2 + (across / minor) ** 2 <= 1.0
    assert abs(inside.mean() - 0.95) < within("rae coverage of 4,000")
    assert (major > 1.3 * minor).all()  # so that a wrong direction would show
    turns = Rotation.from_matrix(solution.matrix @ LOOK.T).as_rotvec()
    whole = np.linalg.inv(covariance * scale[:, None, None] ** 2)
    squares = np.einsum("ki,kij,kj->k", turns, whole, turns)
    factor = covariance_factor_95(np.asarray(np.inf if known else float(freedom)))
    assert abs((squares <= factor).mean() - 0.95) < within("rae coverage of 4,000")


def test_the_scale_of_the_ellipse_is_that_of_the_tables() -> None:
    circle = np.eye(2)
    for freedom in (1, 3, 9, 200):
        expected = np.sqrt(2.0 * stats.f.ppf(0.95, 2, freedom))
        found = confidence_ellipse(circle, freedom)[0] / expected
        assert np.abs(found - 1.0).max() < within("rae element")
    known = confidence_ellipse(circle)[0] / np.sqrt(stats.chi2.ppf(0.95, 2))
    assert np.abs(known - 1.0).max() < within("rae element")


def test_counted_angles_have_the_stated_deviations() -> None:
    drawn = field_region(12)
    matrix = collinearity(drawn).matrix
    angles = np.concatenate([omega_phi_kappa_deg(matrix), alpha_delta_swing_deg(matrix)], axis=1)
    middle = np.concatenate([omega_phi_kappa_deg(LOOK), alpha_delta_swing_deg(LOOK)])
    counted = np.std((angles - middle + 180.0) % 360.0, axis=0)
    exact = field_region(12, noise=0.0).take(np.array([0]))
    covariance = collinearity_covariance(exact, LOOK[None]) * SIGMA**2
    stated = np.degrees(angle_sigmas_rad(LOOK[None], covariance))[0]
    assert np.abs(counted / stated - 1.0).max() < within("rae stated sigma")


def test_angles_at_the_pole_have_finite_deviations() -> None:
    up = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
    sigmas = angle_sigmas_rad(up[None], np.eye(3)[None] * 1e-10)
    assert np.isfinite(sigmas).all() and (1e5 * sigmas < 2.0).all()


def test_the_command_states_them_together() -> None:
    """Covariance, deviations and region of one solution fit each other."""
    result = vopd("stars", "solve", DECKS / "stars" / "orion.csv", "--focal", "76",
                  "--format", "json")  # fmt: skip
    (row,) = json.loads(result.stdout)
    covariance = np.array(row["rotation_covariance_arcsec2"])
    sigmas = np.sqrt(np.diag(covariance))
    assert np.abs(sigmas / row["rotation_sigma_arcsec"] - 1.0).max() < within("rae element")
    assert row["reading_freedom"] == 13
    sizes = np.sqrt(np.linalg.eigvalsh(covariance[:2, :2])[::-1])
    stretch = np.sqrt(2.0 * stats.f.ppf(0.95, 2, 13))
    ratio = np.array(row["boresight_95_arcsec"]) / sizes / stretch
    assert np.abs(ratio - 1.0).max() < within("rae element")
    squares = (np.array(row["residuals_mm"]) ** 2).sum()
    assert abs(row["reading_sigma_mm"] / np.sqrt(squares / 13) - 1.0) < within("rae element")
    near = np.array([row["sigma_alpha_deg"], row["sigma_delta_deg"]]) * 3600.0
    assert np.abs(near / sigmas[:2] - 1.0).max() < within("rae near the equator")
