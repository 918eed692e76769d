"""Solutions of stacks: which rotation stands for a matrix, residuals, stars behind the camera."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.tolerances import assert_close
from vopd.stellar.angles import (
    alpha_delta_swing_deg,
    matrix_from_alpha_delta_swing,
    omega_phi_kappa_deg,
    orientation_matrix,
    orthogonality_defect,
)
from vopd.stellar.field import Failure, StarField, image_points_mm, right_ascension_declination_deg
from vopd.stellar.solution import StarSolution, behind_camera, closed_form_solution

TURN = Rotation.from_euler("xyz", [0.1, -0.2, 0.3]).as_matrix()
BENT = TURN + np.array([[0.01, 0.0, 0.02], [0.0, -0.03, 0.0], [0.02, 0.01, 0.0]])
DIRECTIONS = np.array([[0.1, 0.2, -0.9], [-0.3, 0.1, -0.8], [0.2, -0.2, -0.7]])
IMAGES = np.array([[1.0, 2.0], [3.0, -4.0], [-5.0, 6.0]])


def solution(matrix: np.ndarray) -> StarSolution:
    return StarSolution(matrix, np.array(0), np.array(1), np.array(True))


def test_the_rotation_of_a_matrix_that_is_none() -> None:
    """The nearest in the sum of squares; or that of the three angles as they are solved."""
    u, _, v = np.linalg.svd(BENT)
    nearest = u @ v
    assert_close("rae rotation", solution(BENT).rotation(), nearest)
    assert_close("rae rotation", solution(BENT).rotation("nearest"), nearest)
    omega, phi = np.arctan2(-BENT[2, 1], BENT[2, 2]), np.arcsin(BENT[2, 0])
    kappa = np.arctan2(-BENT[1, 0], BENT[0, 0])
    turns = [Rotation.from_rotvec(-angle * axis).as_matrix()
             for angle, axis in zip((omega, phi, kappa), np.eye(3), strict=True)]  # fmt: skip
    as_solved = solution(BENT).rotation("as-solved")
    assert_close("rae rotation", as_solved, turns[2] @ turns[1] @ turns[0])
    assert np.abs(as_solved - nearest).max() > 0.001
    assert_close("rae angle", solution(BENT).omega_phi_kappa_deg, np.degrees([omega, phi, kappa]))
    alpha, delta = np.arctan2(-BENT[2, 1], -BENT[2, 0]), np.arcsin(-BENT[2, 2])
    swing = np.arctan2(BENT[0, 2], BENT[1, 2])
    found = solution(BENT).alpha_delta_swing_deg
    assert_close("rae angle", found, np.degrees([alpha, delta, swing]))
    for choice, turn in (("nearest", nearest), ("as-solved", as_solved)):
        seen = DIRECTIONS @ turn.T
        expected = IMAGES - seen[:, :2] / -seen[:, 2:] * 50.0
        field = StarField.of(DIRECTIONS, IMAGES, 50.0)
        off = solution(BENT).residuals_mm(field, choice)  # type: ignore[arg-type]
        assert_close("residual", off, expected)
        if choice == "nearest":
            assert solution(BENT).residuals_mm(field).tolist() == off.tolist()


@pytest.mark.parametrize(("z", "behind"), [(-1e-9, False), (0.0, True), (0.5, True)])
def test_stars_behind_the_camera(z: float, behind: bool) -> None:
    """At right angles to the optical axis too; those that are not used never."""
    directions = [[0.6, 0.0, -0.8], [0.0, 1.0, z]]
    field = StarField.of(directions, IMAGES[:2], 50.0)
    assert behind_camera(np.eye(3), field).tolist() == [False, behind]
    unused = StarField.of(directions, IMAGES[:2], 50.0, [True, False])
    assert not behind_camera(np.eye(3), unused).any()
    turned = np.diag([-1.0, 1.0, -1.0])
    assert behind_camera(turned, field).tolist() == [True, z <= 0.0]


def test_solutions_of_direct_methods() -> None:
    """An earlier failure stays; one star behind the camera is enough; the matrix is kept then."""
    field = StarField.of(np.tile(DIRECTIONS, (4, 1, 1)), IMAGES, 50.0)
    matrix = np.stack(
        [np.eye(3), np.diag([-1.0, 1.0, -1.0]), np.eye(3), np.diag([-1.0, 1.0, -1.0])]
    )
    failure = np.array([0, 0, Failure.SINGULAR, Failure.SINGULAR])
    found = closed_form_solution(matrix, failure, field, conditioning=np.arange(4.0))
    assert found.failure.tolist() == [0, Failure.BEHIND_CAMERA, Failure.SINGULAR, Failure.SINGULAR]
    assert found.converged.tolist() == [True, False, False, False]
    assert found.iterations.tolist() == [0, 0, 0, 0]
    assert np.isfinite(found.matrix).all(axis=(1, 2)).tolist() == [True, True, False, False]
    assert found.conditioning is not None and found.conditioning.tolist() == [0.0, 1.0, 2.0, 3.0]
    one_behind = DIRECTIONS * [[1.0], [-1.0], [1.0]]
    single = StarField.of(one_behind[None], IMAGES, 50.0)
    behind = closed_form_solution(np.eye(3)[None], np.array([0]), single)
    assert behind.failure.tolist() == [Failure.BEHIND_CAMERA]


NEAR = 1e-7


@pytest.mark.parametrize(("middle", "outer"), [(NEAR, [20, 30]), (0.3e-8, [50, 0])])
def test_angles_near_a_pole(middle: float, outer: list[int]) -> None:
    """A cosine of the middle angle of 1E-7 tells the outer two; below 1E-8 their sum is told."""
    angles = np.array([20.0, 90.0 - np.degrees(middle), 30.0])
    omega, phi, kappa = omega_phi_kappa_deg(orientation_matrix(angles))
    assert [round(float(one)) for one in (omega, kappa)] == outer
    alpha, delta, swing = alpha_delta_swing_deg(matrix_from_alpha_delta_swing(angles))
    outer = [20, 30] if outer[1] else [20 - 30, 0]
    assert [round(float(one)) for one in (alpha, swing)] == outer
    assert_close("angle at a pole", [phi, delta], [angles[1]] * 2)


def test_the_defect_of_each_matrix() -> None:
    """The largest element of M M' - I: 1.21 - 1 of a row of length 1.1, .1 of two that lean."""
    lean = np.array([[1.0, 0.1, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    stack = np.stack([np.eye(3), np.diag([1.0, 1.1, 1.0]), lean, np.diag([0.5, 1.0, 1.0])])
    assert_close("rae element", orthogonality_defect(stack), [0.0, 0.21, 0.1, 0.75])


def test_directions_of_any_length() -> None:
    """Right ascensions are -180 to 180, declinations -90 to 90."""
    vectors = np.array([[3.0, 0.0, 4.0], [0.0, -0.5, -0.5], [-2.0, 0.0, 0.0], [-1.0, -1.0, 0.0]])
    ra, dec = right_ascension_declination_deg(vectors)
    assert_close("rae angle", ra, [0.0, -90.0, 180.0, -135.0])
    assert_close("rae angle", dec, [np.degrees(np.arctan2(4.0, 3.0)), -45.0, 0.0, 0.0])


def test_images_at_right_angles_are_not_finite() -> None:
    """Without a warning; a vector behind the camera has the image of its opposite."""
    with np.errstate(all="raise"):
        points = image_points_mm(
            np.array([[1.0, 2.0, 0.0], [0.0, 0.0, 0.0], [1.0, 2.0, 4.0], [1.0, 2.0, -4.0]]), 8.0
        )
    assert not np.isfinite(points[:2]).any()
    assert points[2:].tolist() == [[-2.0, -4.0], [2.0, 4.0]]
