"""Weights of the user: standard deviations, correlation, magnitude and elongation of images."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from tests.kit.command import Ran, vopd
from tests.tolerances import assert_close, within
from vopd.stellar import StarField, church, collinearity, find_outliers, uncertainty, wahba

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
    "no magnitude": (f"{SKY},mag\n1,2,3,4,5\n5,6,7,8,\n", ("--magnitude-limit", "6"), "line 3: "),
    "no column": (f"{SKY}\n1,2,3,4\n5,6,7,8\n", ("--weigh-elongation",), "a column elongation"),
    "short": (f"{SKY},elongation\n1,2,3,4,.5\n5,6,7,8,1\n", ("--weigh-elongation",), "line 2: "),
    "two sigmas": (f"{SKY},sigma\n1,2,3,4,1\n5,6,7,8,1\n", ("--reading-sigma", "1"), "no --read"),
    "listed": (f"{SKY},sigma\n1,2,3,4,1\n5,6,7,8,1\n", ("--weights", "listed"), "listed knows no"),
    "rho": (f"{SKY},sigma_x_mm,sigma_y_mm,rho_xy\n1,2,3,4,1,1,1\n", (), "line 2: rho_xy: 1 is bey"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_weights_that_cannot_be_are_refused(name: str) -> None:
    text, options, said = REFUSED[name]
    result = solve(text, *options)
    assert result.status == 1 and said in result.stderr, result.stderr


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
