"""The 95 percent region and the standard deviations of angles, against counted errors."""

from __future__ import annotations

import json

import numpy as np
import pytest
from scipy import stats
from scipy.spatial.transform import Rotation

from tests.kit.command import DECKS, vopd
from tests.tolerances import within
from vopd.geometry.linear import confidence_ellipse
from vopd.stellar import StarField, alpha_delta_swing_deg, collinearity, omega_phi_kappa_deg
from vopd.stellar.uncertainty import angle_sigmas_rad, boresight_region, collinearity_covariance

DRAWS, FOCAL, SIGMA = 4000, 50.0, 0.02
LOOK = Rotation.from_euler("ZYX", [-200.0, -55.0, 20.0], degrees=True).as_matrix()


def field(count: int, noise: float = SIGMA, seed: int = 1) -> StarField:
    """Stars of a narrow strip, so that the region is long; 4,000 draws of readings."""
    rng = np.random.default_rng(seed)
    images = rng.uniform([-15.0, 3.0], [15.0, 9.0], (count, 2))
    rays = np.column_stack([images, np.full(count, -FOCAL)])
    stars = rays / np.linalg.norm(rays, axis=1)[:, None] @ LOOK
    return StarField.of(stars, images + rng.normal(0.0, noise, (DRAWS, count, 2)), FOCAL)


def sky(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Right ascension and declination of minus the third row, by hand, radians."""
    u, v, w = -np.moveaxis(matrix[..., 2, :], -1, 0)
    return np.arctan2(v, u), np.arctan2(w, np.hypot(u, v))


@pytest.mark.parametrize("known", [True, False])
@pytest.mark.parametrize("count", [3, 4, 12])
def test_the_region_covers_95_of_100(count: int, known: bool) -> None:
    """4,000 draws, standard deviation .34 percent: within four of them."""
    drawn = field(count)
    solution = collinearity(drawn)
    residuals = solution.residuals_mm(drawn)
    freedom = 2 * count - 3
    sigma = np.sqrt((residuals**2).sum(axis=(1, 2)) / freedom)
    covariance = collinearity_covariance(drawn, solution.matrix)
    scale = np.full(DRAWS, SIGMA) if known else sigma
    region = boresight_region(
        solution.matrix, covariance * scale[:, None, None] ** 2, None if known else freedom
    )
    ra, dec = sky(solution.matrix)
    true_ra, true_dec = sky(LOOK)
    east, north = (ra - true_ra) * np.cos(true_dec), dec - true_dec
    angle = region.angle_rad
    along = north * np.cos(angle) + east * np.sin(angle)
    across = -north * np.sin(angle) + east * np.cos(angle)
    major, minor = region.semi_axes.T
    inside = (along / major) ** 2 + (across / minor) ** 2 <= 1.0
    assert abs(inside.mean() - 0.95) < within("rae coverage of 4,000")
    assert (major > 1.3 * minor).all()  # so that a wrong direction would show


def test_the_scale_of_the_ellipse_is_that_of_the_tables() -> None:
    circle = np.eye(2)
    for freedom in (1, 3, 9, 200):
        expected = np.sqrt(2.0 * stats.f.ppf(0.95, 2, freedom))
        found = confidence_ellipse(circle, freedom).semi_axes / expected
        assert np.abs(found - 1.0).max() < within("rae element")
    known = confidence_ellipse(circle).semi_axes / np.sqrt(stats.chi2.ppf(0.95, 2))
    assert np.abs(known - 1.0).max() < within("rae element")


def test_counted_angles_have_the_stated_deviations() -> None:
    drawn = field(12)
    matrix = collinearity(drawn).matrix
    angles = np.concatenate([omega_phi_kappa_deg(matrix), alpha_delta_swing_deg(matrix)], axis=1)
    middle = np.concatenate([omega_phi_kappa_deg(LOOK), alpha_delta_swing_deg(LOOK)])
    counted = np.std((angles - middle + 180.0) % 360.0, axis=0)
    exact = field(12, noise=0.0).take(np.array([0]))
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
