"""Covariances of attitudes and of their angles, by differences of the solutions themselves."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import chi2
from scipy.stats import f as f_distribution

from tests.tolerances import assert_close
from vopd.stellar.field import StarField
from vopd.stellar.interstar_angles import _angle_gain
from vopd.stellar.methods.church import church
from vopd.stellar.methods.two_star import two_star
from vopd.stellar.methods.wahba import wahba
from vopd.stellar.uncertainty import (
    angle_sigmas_rad,
    boresight_region,
    church_covariance,
    collinearity_covariance,
    pair_covariance,
    turns_of_pointing,
    wahba_covariance,
)

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
    found = boresight_region(TURN[None], COVARIANCE[None], freedom)
    same(found.semi_axes[0], np.sqrt(sizes[::-1] * scale))
    angle = np.arctan2(axes[0, 1], axes[1, 1]) % np.pi
    assert_close("rae sigma by differences", found.angle_rad[0], angle)


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
