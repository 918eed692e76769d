"""The stated uncertainty against counted errors, and solutions that are refused."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.linalg import polar
from scipy.spatial.transform import Rotation

from tests.kit.star_files import seen_straight, solve_text
from tests.tolerances import within
from vopd.geometry.rotations import nearest_rotation
from vopd.stellar import (
    Failure,
    StarField,
    StarSolution,
    church,
    collinearity,
    orientation_matrix,
    single_rotation,
    two_star,
    uncertainty,
    wahba,
)
from vopd.stellar.interstar_angles import interstar_reading_sigma_mm
from vopd.stellar.tables_1987 import DIRECTIONS, EXACT_MM, TRUTH_DEG, sample_field

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
    assert np.isnan(interstar_reading_sigma_mm(sample_field().only(np.array([0, 1]))))


def test_the_nearest_rotation_is_scipys() -> None:
    """The polar decomposition; a reflected matrix becomes a rotation too."""
    rng = np.random.default_rng(51)
    matrices = rng.normal(size=(20, 3, 3))
    found = nearest_rotation(matrices).rotation
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
