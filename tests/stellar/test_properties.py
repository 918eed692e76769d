"""What holds for any camera and any stars."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tests.tolerances import assert_close, within
from vopd.stellar import (
    StarField,
    alpha_delta_swing_deg,
    church,
    closed_form,
    collinearity,
    ground_directions,
    matrix_from_alpha_delta_swing,
    omega_phi_kappa_deg,
    orientation_matrix,
    outliers,
    single_rotation,
    two_star,
)
from vopd.stellar.field import Failure
from vopd.stellar.methods.weights import huber, listed
from vopd.stellar.tables_1987 import DIRECTIONS, PERTURBED_MM, sample_field

IMAGES = np.array([[24.0, 20.0], [-15.0, 18.0], [-21.0, -22.0], [19.0, -14.0], [3.0, 5.0]])
METHODS = {
    "collinearity": lambda field: collinearity(field),
    "robust": lambda field: collinearity(field, weights="robust"),
    "church": lambda field: church(field),
    "church-weighted": lambda field: church(field, weights="formula"),
    "two-star": lambda field: two_star(pair(field)),
    "two-star raw": lambda field: two_star(pair(field), unit_cross_products=False),
    "closed form": lambda field: closed_form(field),
}
rotations = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: sum(x * x for x in q) > 0.01)


def pair(field: StarField) -> StarField:
    return StarField(
        field.directions[..., :2, :], field.image_mm[..., :2, :], field.focal_length_mm,
        field.used[..., :2],
    )  # fmt: skip


def seen(matrix: np.ndarray, focal_mm: float = 76.0) -> StarField:
    """Stars that a camera of this attitude images at IMAGES: rays (x, y, -f), turned back."""
    rays = np.column_stack([IMAGES, np.full(len(IMAGES), -focal_mm)])
    return StarField.of(rays / np.linalg.norm(rays, axis=1)[:, None] @ matrix, IMAGES, focal_mm)


def matrix_of(answer: object) -> np.ndarray:
    return answer if isinstance(answer, np.ndarray) else answer.matrix  # type: ignore[attr-defined,no-any-return]


@settings(max_examples=30)
@given(rotations)
@pytest.mark.parametrize("method", METHODS)
def test_error_free_data_give_the_attitude_back(method: str, q: tuple[float, ...]) -> None:
    truth = Rotation.from_quat(q).as_matrix()
    off = np.abs(matrix_of(METHODS[method](seen(truth))) - truth).max()
    assert off < within("rae rotation by angles" if method == "closed form" else "rae rotation")


@settings(max_examples=30)
@given(rotations)
def test_one_rotation_gives_it_back_where_it_can(q: tuple[float, ...]) -> None:
    """It cannot for no rotation, and not where the axis lies in the plane of the two stars."""
    truth = Rotation.from_quat(q).as_matrix()
    answer = single_rotation(pair(seen(truth)))
    assert answer.conditioning is not None
    if answer.failure == Failure.NONE:
        off = np.abs(answer.matrix - truth).max()
        assert off < within("rae rotation") / float(answer.conditioning)
    else:
        assert answer.failure in (Failure.NO_ROTATION, Failure.AXIS_IN_PLANE)
        assert np.isnan(answer.matrix).all()


@given(rotations)
def test_angles_and_matrices(q: tuple[float, ...]) -> None:
    m = Rotation.from_quat(q).as_matrix()
    for back in (
        orientation_matrix(omega_phi_kappa_deg(m)),
        matrix_from_alpha_delta_swing(alpha_delta_swing_deg(m)),
    ):
        assert np.abs(back - m).max() < within("rae rotation by angles")


@pytest.mark.parametrize("phi", [90.0, -90.0])
def test_straight_along_the_axis_kappa_is_zero(phi: float) -> None:
    """Only omega +- kappa is defined there: 30 and 20 are 50, or 10."""
    omega, found, kappa = omega_phi_kappa_deg(orientation_matrix(np.array([30.0, phi, 20.0])))
    assert abs(found - phi) < within("angle at a pole") and kappa == 0.0
    assert abs(omega - (50.0 if phi > 0 else 10.0)) < within("rae angle")


@pytest.mark.parametrize("method", [name for name in METHODS if name != "closed form"])
def test_turning_sky_and_camera_together_changes_nothing(method: str) -> None:
    turn = Rotation.from_rotvec([0.4, -1.1, 2.0]).as_matrix()
    field = sample_field()
    turned = StarField(field.directions @ turn.T, field.image_mm, field.focal_length_mm, field.used)
    one, other = matrix_of(METHODS[method](field)), matrix_of(METHODS[method](turned))
    assert np.abs(other @ turn - one).max() < within("rae rotation")


@pytest.mark.parametrize("method", METHODS)
def test_a_stack_is_its_elements(method: str) -> None:
    rng = np.random.default_rng(7)
    images = PERTURBED_MM + rng.normal(0.0, 0.3, (30, 4, 2))
    before = images.copy()
    stack = matrix_of(METHODS[method](StarField.of(np.tile(DIRECTIONS, (30, 1, 1)), images, 76.0)))
    for k in range(30):
        alone = matrix_of(METHODS[method](StarField.of(DIRECTIONS, images[k], 76.0)))
        assert np.abs(stack[k] - alone).max() < within("rae stack element")
    assert np.array_equal(images, before)


def test_a_failure_keeps_its_place() -> None:
    images = np.stack([PERTURBED_MM, PERTURBED_MM, PERTURBED_MM])
    images[1, 2, 0] = np.nan
    answer = church(StarField.of(np.tile(DIRECTIONS, (3, 1, 1)), images, 76.0))
    assert answer.failure.tolist() == [0, Failure.NOT_FINITE, 0]
    assert np.isnan(answer.matrix[1]).all() and np.isfinite(answer.matrix[[0, 2]]).all()


def test_weights() -> None:
    """Listed: (.003/residual)**2, 3 above 9, 0 below 1E-7. Huber: bounded by 1, never rising."""
    residual = np.array([[5e-8, 0.0005, 0.003, 0.3]]).T.repeat(2, axis=1)
    assert_close("unit element", listed(residual)[:, 0], [0.0, 3.0, 1.0, 1e-4])
    lengths = np.geomspace(1e-6, 10.0, 50)
    column = np.column_stack([lengths, np.zeros(50)])
    weight = huber(column, np.ones(50, bool), np.array([76.0]), 0.01)[:, 0]
    assert weight[0] == 1.0 and weight[-1] > 0.0
    assert (np.diff(weight) <= 0).all() and weight[-1] < 0.01


def test_listed_weights_of_error_free_data_are_no_solution() -> None:
    """Every residual is below 1E-7 mm once it has come near: all weights are zero."""
    exact = seen(Rotation.from_rotvec([0.3, 0.2, 0.1]).as_matrix())
    answer = collinearity(exact, weights="listed", initial_deg=[17.0, 11.0, 6.0], corrections=12)
    assert answer.failure == Failure.SINGULAR


def test_robust_weights_resist_a_blunder() -> None:
    truth = Rotation.from_rotvec([0.3, 0.2, 0.1]).as_matrix()
    field = seen(truth)
    field.image_mm[3] += [2.0, -1.5]
    off = {
        weights: np.abs(collinearity(field, weights=weights).matrix - truth).max()
        for weights in ("uniform", "robust")
    }
    assert off["robust"] < off["uniform"] / 3


def test_a_misidentified_star_stands_out() -> None:
    field = seen(Rotation.from_rotvec([0.3, 0.2, 0.1]).as_matrix())
    assert not outliers(field).any()
    field.directions[2] = Rotation.from_rotvec([0.01, 0, 0]).apply(field.directions[2])
    assert outliers(field).tolist() == [False, False, True, False, False]


def test_ground_points_by_hand() -> None:
    """Eq. 5.1: a point 3 east, 4 north and 12 below is 13 away."""
    camera, point = np.array([100.0, 200.0, 300.0]), np.array([[103.0, 204.0, 288.0]])
    (direction,) = ground_directions(point, camera)
    assert_close("unit element", direction, np.array([3.0, 4.0, -12.0]) / 13.0)
