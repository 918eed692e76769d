"""Solutions of the methods: properties, limits, errors."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from dataclasses import fields, replace
from math import cos, degrees, sin, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tests.kit.rae_listings import jnkmat
from tests.tolerances import assert_close, within
from vopd.stellar import (
    church,
    closed_form,
    collinearity,
    find_outliers,
    ground_directions,
    single_rotation,
    two_star,
    uncertainty,
    wahba,
)
from vopd.stellar.angles import (
    alpha_delta_swing_deg,
    matrix_from_alpha_delta_swing,
    omega_phi_kappa_deg,
    orientation_matrix,
    orthogonality_defect,
)
from vopd.stellar.field import Failure, StarField, image_points_mm, right_ascension_declination_deg
from vopd.stellar.interstar_angles import interstar_reading_sigma_mm, star_disagreement_arcsec
from vopd.stellar.methods.church import flatness
from vopd.stellar.methods.collinearity import turned
from vopd.stellar.methods.run import (
    SolvedStars,
    StarOptions,
    refused,
    solve_by_methods,
    split_solutions,
)
from vopd.stellar.methods.weights import huber, least_squares, listed
from vopd.stellar.solution import StarSolution, behind_camera, closed_form_solution
from vopd.stellar.tables_1987 import DIRECTIONS as DIRECTIONS_PROPERTIES
from vopd.stellar.tables_1987 import PERTURBED_MM, sample_field

# Solutions of stacks: which rotation stands for a matrix, residuals, stars behind the camera


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


def test_matrices_of_many_angles_are_those_of_each() -> None:
    angles = np.array([[[20.0, 30.0, 40.0], [50.0, -60.0, 70.0]], [[1.0, 2.0, 3.0], [170, 80, -9]]])
    found = matrix_from_alpha_delta_swing(angles)
    for at in np.ndindex(2, 2):
        assert_close("rae element", found[at], matrix_from_alpha_delta_swing(angles[at]))


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


# What holds for any camera and any stars


IMAGES_PROPERTIES = np.array(
    [[24.0, 20.0], [-15.0, 18.0], [-21.0, -22.0], [19.0, -14.0], [3.0, 5.0]]
)
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
    rays = np.column_stack([IMAGES_PROPERTIES, np.full(len(IMAGES_PROPERTIES), -focal_mm)])
    return StarField.of(
        rays / np.linalg.norm(rays, axis=1)[:, None] @ matrix, IMAGES_PROPERTIES, focal_mm
    )


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
    stack = matrix_of(
        METHODS[method](StarField.of(np.tile(DIRECTIONS_PROPERTIES, (30, 1, 1)), images, 76.0))
    )
    for k in range(30):
        alone = matrix_of(METHODS[method](StarField.of(DIRECTIONS_PROPERTIES, images[k], 76.0)))
        assert np.abs(stack[k] - alone).max() < within("rae stack element")
    assert np.array_equal(images, before)


def test_a_failure_keeps_its_place() -> None:
    images = np.stack([PERTURBED_MM, PERTURBED_MM, PERTURBED_MM])
    images[1, 2, 0] = np.nan
    answer = church(StarField.of(np.tile(DIRECTIONS_PROPERTIES, (3, 1, 1)), images, 76.0))
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
    assert not find_outliers(field)
    field.directions[2] = Rotation.from_rotvec([0.01, 0, 0]).apply(field.directions[2])
    assert [one.star for one in find_outliers(field)] == [2]


def test_ground_points_by_hand() -> None:
    """Eq. 5.1: a point 3 east, 4 north and 12 below is 13 away."""
    camera, point = np.array([100.0, 200.0, 300.0]), np.array([[103.0, 204.0, 288.0]])
    (direction,) = ground_directions(point, camera)
    assert_close("unit element", direction, np.array([3.0, 4.0, -12.0]) / 13.0)


# The table of errors in docs/stellar.md is what the methods do


ROOT = Path(__file__).parents[2]


def documented() -> dict[str, dict[str, float]]:
    """The rows of the table, by stars and method."""
    lines = (ROOT / "docs" / "stellar.md").read_text(encoding="utf-8").splitlines()
    start = next(k for k, line in enumerate(lines) if line.startswith("| stars | collinearity"))
    names = [cell.strip() for cell in lines[start].strip("|").split("|")]
    rows = {}
    for line in lines[start + 2 :]:
        if not line.startswith("|"):
            break
        stars, *cells = (cell.strip() for cell in line.strip("|").split("|"))
        rows[stars] = {
            name: float(cell) for name, cell in zip(names[1:-1], cells[:-1], strict=True) if cell
        }
    return rows


def test_the_documented_errors_are_those_of_fresh_draws() -> None:
    path = ROOT / "tools" / "rae_method_errors.py"
    spec = importlib.util.spec_from_file_location("rae_method_errors", path)
    assert spec is not None and spec.loader is not None
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    counted, shown = tool.method_errors(5000), documented()
    assert list(shown) == list(counted) and len(shown) == 7
    for stars, row in counted.items():
        assert set(shown[stars]) == set(row)
        for name, error in row.items():
            assert abs(shown[stars][name] / error - 1.0) < within("rae method error"), (stars, name)


# Where each method refuses a problem and with which reason: both sides of every limit


Solve = Callable[[StarField], StarSolution]
IMAGES_LIMITS = np.array([[20.0, 5.0], [-18.0, 9.0], [4.0, -23.0], [11.0, 14.0]])


def rays_of(images: np.ndarray) -> np.ndarray:
    rays = np.column_stack([images, np.full(len(images), -100.0)])
    return np.asarray(rays / np.linalg.norm(rays, axis=1)[:, None])


LOOK = np.array(jnkmat(30.0, 10.0, -50.0))
STARS = rays_of(IMAGES_LIMITS) @ LOOK
METHODS_LIMITS: dict[str, tuple[Solve, int]] = {
    "collinearity": (collinearity, 2),
    "church": (church, 3),
    "two-star": (two_star, 2),
    "single-rotation": (single_rotation, 2),
    "svd": (wahba, 2),
}


@pytest.mark.parametrize("name", METHODS_LIMITS)
def test_too_few_stars_and_coordinates_that_are_not_finite(name: str) -> None:
    """They come before any other reason; a star that is not used may hold anything."""
    solve, least = METHODS_LIMITS[name]
    n = 3 if name == "church" else 2
    for used in range(n + 1):
        mask = np.arange(n) < used
        failure = solve(StarField.of(STARS[:n], IMAGES_LIMITS[:n], 100.0, mask)).failure
        assert failure == (Failure.TOO_FEW_STARS if used < least else Failure.NONE)
    for k in range(2):
        for array in (STARS, IMAGES_LIMITS):
            spoiled = array[:n].copy()
            spoiled[k, 0] = np.nan
            given = (spoiled, IMAGES_LIMITS[:n]) if array is STARS else (STARS[:n], spoiled)
            assert solve(StarField.of(*given, 100.0)).failure == Failure.NOT_FINITE
            first = StarField.of(*given, 100.0, np.arange(n) < 1)
            assert solve(first).failure == (Failure.NOT_FINITE if k == 0 else Failure.TOO_FEW_STARS)


def apart(angle: float) -> np.ndarray:
    """Two unit vectors so far apart, radians, near the direction 1, 2, -9."""
    middle = np.array([1.0, 2.0, -9.0]) / sqrt(86.0)
    side = np.array([2.0, -1.0, 0.0]) / sqrt(5.0)
    return np.array([middle, cos(angle) * middle + sin(angle) * side])


@pytest.mark.parametrize("name", ["two-star", "single-rotation", "svd"])
@pytest.mark.parametrize(("angle", "same"), [(0.8e-6, True), (1.25e-6, False)])
@pytest.mark.parametrize("where", ["stars", "images"])
def test_how_near_two_stars_are_one(name: str, angle: float, same: bool, where: str) -> None:
    """A millionth of a radian; in the stars or in the images alone (not so for Wahba's sum)."""
    near, far = apart(angle), apart(angle if name == "svd" else 0.1)
    stars, images = (near, far) if where == "stars" else (far, near)
    solve, _ = METHODS_LIMITS[name]
    field = StarField.of(stars @ LOOK, -100.0 * images[:, :2] / images[:, 2:], 100.0)
    assert (solve(field).failure == Failure.SAME_STAR) == same


def test_opposite_stars_are_no_pair() -> None:
    for solve in (two_star, single_rotation, wahba):
        field = StarField.of([STARS[0], -STARS[0]], IMAGES_LIMITS[:2], 100.0)
        assert solve(field).failure == Failure.SAME_STAR
        field = StarField.of([STARS[0], -STARS[0]], IMAGES_LIMITS[[0, 0]], 100.0)
        assert solve(field).failure == Failure.SAME_STAR


def test_mirrored_images_of_a_cross_have_no_rotation() -> None:
    """Any turn about the axis brings one arm nearer by what it takes the other away.

    The sum of products is diagonal: of the arms (.04, -.04) / 1.04 twice, of the axis 4 / 1.04.
    """
    cross = np.array([[20.0, 0.0], [-20.0, 0.0], [0.0, 20.0], [0.0, -20.0]])
    assert wahba(StarField.of(rays_of(cross), cross, 100.0)).failure == Failure.NONE
    for mirrored in (cross * [1.0, -1.0], cross * [-1.0, 1.0], cross[:, ::-1]):
        field = StarField.of(rays_of(cross), mirrored, 100.0)
        assert wahba(field).failure == Failure.SAME_STAR


def test_one_star_that_does_not_move_is_first_of_all_the_same_star() -> None:
    rays = rays_of(IMAGES_LIMITS[[0, 0]])
    field = StarField.of(rays, IMAGES_LIMITS[[0, 0]], 100.0)
    assert single_rotation(field).failure == Failure.SAME_STAR


def test_errors_weigh_the_directions_of_wahbas_problem() -> None:
    """By scipy; a star's weight is the inverse of the mean variance of its x and y."""
    errors = np.array([np.diag(one) for one in ((1.0, 3.0), (9.0, 7.0), (0.5, 0.5), (2.0, 6.0))])
    read = IMAGES_LIMITS + np.array([[0.5, 0.0], [-0.3, 0.4], [0.0, -0.6], [0.2, 0.2]])
    solved = wahba(StarField.of(STARS, read, 100.0, True, errors))
    weights = [1.0 / 2.0, 1.0 / 8.0, 2.0, 1.0 / 4.0]
    expected, _ = Rotation.align_vectors(rays_of(read), STARS, weights)
    assert_close("rae rotation", solved.matrix, expected.as_matrix())


@pytest.mark.parametrize(("size", "still"), [(0.7e-6, True), (1.5e-6, False)])
def test_a_star_that_hardly_moves_has_no_rotation(size: float, still: bool) -> None:
    """One of the two is enough, either one."""
    axis = rays_of(np.array([[3.0, -2.0]]))[0]
    rays = rays_of(IMAGES_LIMITS[:2])
    rays[0] = axis + size * 2.0 * np.cross(axis, [1.0, 0.0, 0.0])  # turned by half a radian
    rays[0] /= np.linalg.norm(rays[0])
    turn = turned(np.eye(3)[None], 0.5 * axis[None])[0]
    for order in ([0, 1], [1, 0]):
        field = StarField.of((rays @ turn)[order], 100.0 * (rays / -rays[:, 2:])[order, :2], 100.0)
        moved = np.linalg.norm(field.directions - field.photo, axis=1).min()
        assert (moved < within("rae star that is still")) == still
        assert (single_rotation(field).failure == Failure.NO_ROTATION) == still


@pytest.mark.parametrize("turn", [8e-6, 3e-5, 0.0447, 0.0448, 1.0, -8e-6, -1.0, 3.0, -3.14159])
def test_the_angle_of_a_single_rotation_to_its_last_digits(turn: float) -> None:
    """Small angles by the arc tangent; both rules; axis and angle may both change their sign."""
    axis = np.array([0.48, -0.6, 0.64])
    rotation = turned(np.eye(3)[None], turn * axis[None])[0]
    images = np.array([[35.0, 5.0], [-38.0, 40.0]])
    field = StarField.of(rays_of(images) @ rotation, images, 100.0)
    for rule in ("farther", "mean"):
        solved = single_rotation(field, angle=rule)  # type: ignore[arg-type]
        assert solved.axis is not None and solved.angle_deg is not None
        assert solved.failure == Failure.NONE
        sense = np.sign(solved.axis @ axis)
        assert_close("rae angle", solved.angle_deg, sense * degrees(turn))
        assert_close("rae element", solved.matrix, rotation)


def test_the_mean_of_angles_on_either_side_of_a_half_turn() -> None:
    """179.9 and -179.9 degrees have the mean 180, not 0."""
    axis = np.array([0.0, 0.6, -0.8])
    rays = rays_of(np.array([[35.0, 75.0], [-35.0, 75.0]]))
    turns = [turned(np.eye(3)[None], np.radians(a) * axis[None])[0] for a in (179.9, 180.1)]
    stars = np.array([one.T @ ray for one, ray in zip(turns, rays, strict=True)])
    field = StarField.of(stars, 100.0 * rays[:, :2] / -rays[:, 2:], 100.0)
    angle = single_rotation(field, angle="mean").angle_deg
    assert angle is not None
    assert_close("rae half turn", np.abs(angle), 180.0)


def defect_of(stars: np.ndarray, images: np.ndarray) -> float:
    """Of three stars: the matrix that carries them onto their images exactly."""
    matrix = rays_of(images).T @ np.linalg.inv(stars.T)
    return float(np.abs(matrix @ matrix.T - np.eye(3)).max())


@pytest.mark.parametrize(("defect", "refused"), [(0.0995, False), (0.1005, True)])
def test_how_far_from_a_rotation_church_may_be(defect: float, refused: bool) -> None:
    low, high = 0.0, 30.0  # of a shift of one image, mm
    for _ in range(60):
        middle = (low + high) / 2.0
        images = IMAGES_LIMITS[:3] + np.array([[middle, 0.0], [0.0, 0.0], [0.0, 0.0]])
        low, high = (middle, high) if defect_of(STARS[:3], images) < defect else (low, middle)
    failure = church(StarField.of(STARS[:3], images, 100.0)).failure
    assert failure == (Failure.NOT_A_ROTATION if refused else Failure.NONE)


@pytest.mark.parametrize("weights", ["uniform", "formula", "formula-r"])
@pytest.mark.parametrize("sigma", [None, 0.01])
@pytest.mark.parametrize(
    ("radius", "central"),
    [((0.9e-4, 0.0), True), ((0.0, -0.9e-4), True), ((0.6e-4, 0.6e-4), True),
     ((0.8e-4, 0.8e-4), False), ((0.0, 1.1e-4), False)],
)  # fmt: skip
def test_an_image_at_the_principal_point(
    weights: str, sigma: float | None, radius: tuple[float, float], central: bool
) -> None:
    """Within a millionth of the principal distance, 1E-4 of 100 mm; not one that is not used."""
    images = np.vstack([IMAGES_LIMITS, radius])
    refused = central and weights != "uniform" and sigma is None
    for used in (True, False):
        mask = np.array([True] * 4 + [used])
        field = StarField.of(rays_of(images) @ LOOK, images, 100.0, mask)
        failure = church(field, weights=weights, reading_sigma_mm=sigma).failure  # type: ignore[arg-type]
        assert failure == (Failure.PRINCIPAL_POINT if refused and used else Failure.NONE)


def test_flatness_is_the_smaller_of_the_stars_and_of_their_images() -> None:
    """Singular values by numpy; 0 for fewer than three; a star that is not used does not count."""
    flat = IMAGES_LIMITS * [1.0, 0.001]
    for stars, images in (
        (IMAGES_LIMITS, flat),
        (flat, IMAGES_LIMITS),
        (IMAGES_LIMITS, IMAGES_LIMITS),
    ):
        field = StarField.of(rays_of(stars), images, 100.0)
        sizes = [np.linalg.svd(rays_of(one), compute_uv=False) for one in (stars, images)]
        assert_close("rae element", flatness(field), min(one[2] / one[0] for one in sizes))
    assert flatness(StarField.of(STARS[:2], IMAGES_LIMITS[:2], 100.0)) == 0.0
    mask = np.array([True, True, True, False])
    three = flatness(StarField.of(STARS[:3], IMAGES_LIMITS[:3], 100.0))
    spoiled = STARS.copy()
    spoiled[3] = np.nan
    assert_close("rae element", flatness(StarField.of(spoiled, IMAGES_LIMITS, 100.0, mask)), three)


@pytest.mark.parametrize(("half", "lost"), [(0.8e-8, True), (1.25e-8, False)])
def test_from_which_spread_on_two_stars_determine_an_attitude(half: float, lost: bool) -> None:
    """Two stars at +-half radian across the axis: their turn about it has half the others' size."""
    images = np.array([[100.0 * half, 0.0], [-100.0 * half, 0.0]])
    solved = collinearity(StarField.of(rays_of(images), images, 100.0), initial_deg=[0.0, 0.0, 0.0])
    assert (solved.failure == Failure.SINGULAR) == lost


def test_exactly_as_many_corrections_as_asked_for() -> None:
    """They do not stop where nothing moves any more, and `converged` is said of the last."""
    off = np.array([[0.1, 0.0], [0.0, -0.2], [0.0, 0.0], [0.1, 0.1]])
    field = StarField.of(STARS, IMAGES_LIMITS + off, 100.0)
    free = collinearity(field)
    assert free.converged and 2 <= free.iterations < 9 and free.weights is None
    for count, converged in ((1, False), (2, False), (9, True), (60, True)):
        one = collinearity(field, corrections=count, initial_deg=[25.0, 15.0, -45.0])
        assert (one.iterations, one.converged, one.failure) == (count, converged, Failure.NONE)
    none = collinearity(field, corrections=0)
    assert (none.iterations, none.converged, none.failure) == (0, False, Failure.NONE)
    assert_close("rae element", none.matrix, wahba(field).matrix)
    assert_close("rae element", collinearity(field, corrections=0, start="two-star").matrix,
                 closed_form(field))  # fmt: skip


def test_weights_of_stars_that_are_not_used_are_zero() -> None:
    field = StarField.of(STARS, IMAGES_LIMITS, 100.0, [True, True, False, True])
    for rule in ("listed", "robust"):
        given = {"weights": rule, "corrections": 1, "initial_deg": [25.0, 15.0, -45.0]}
        weights = collinearity(field, **given).weights  # type: ignore[arg-type]
        assert weights is not None and (weights[2] == 0.0).all() and (weights[[0, 1, 3]] > 0).all()


def test_a_star_behind_the_camera_is_a_failure_even_if_the_others_are_in_front() -> None:
    stars = np.vstack([STARS, -STARS[3]])
    images = np.vstack([IMAGES_LIMITS, IMAGES_LIMITS[3]])
    solved = collinearity(StarField.of(stars, images, 100.0), initial_deg=[30.0, 10.0, -50.0])
    assert (solved.failure, solved.converged) == (Failure.BEHIND_CAMERA, False)
    assert_close("rae element", solved.matrix, LOOK)


def test_the_widest_pair_of_the_stars_that_are_used() -> None:
    stars, images = STARS.copy(), IMAGES_LIMITS.copy()
    stars[1] = np.nan
    field = StarField.of(stars, images, 100.0, [True, False, True, True])
    assert_close("rae element", closed_form(field), LOOK)
    assert np.isnan(closed_form(StarField.of(STARS[:1], IMAGES_LIMITS[:1], 100.0))).all()
    two = closed_form(StarField.of(STARS[:2], IMAGES_LIMITS[:2], 100.0))
    assert_close("rae element", two, LOOK)
    one_used = StarField.of(STARS[:2], IMAGES_LIMITS[:2], 100.0, [True, False])
    assert np.isnan(closed_form(one_used)).all()


def test_least_squares_is_numpys_and_says_how_well_it_is_determined() -> None:
    rng = np.random.default_rng(3)
    design, side = rng.normal(size=(2, 7, 3)), rng.normal(size=(2, 7))
    weights = rng.uniform(0.1, 4.0, size=(2, 7))
    design[1, :, 2] = 1e-6 * design[1, :, 2] + design[1, :, 0]
    unknowns, spread = least_squares(design, side, weights)
    for k in range(2):
        rows = np.sqrt(weights[k])[:, None] * design[k]
        expected = np.linalg.lstsq(rows, np.sqrt(weights[k]) * side[k], rcond=None)[0]
        size = np.abs(expected).max()
        assert_close("rae rotation", unknowns[k] / size, expected / size)
        singular = np.linalg.svd(rows, compute_uv=False)
        assert_close("rae rotation", spread[k] / (singular[2] / singular[0]), 1.0)
    design[0, 3, 1] = np.nan
    assert least_squares(design, side, weights)[1][0] == 0.0
    assert least_squares(0.0 * design[1:], side[1:], weights[1:])[1] == 0.0


def test_no_turn_leaves_a_matrix_as_it_is() -> None:
    both = turned(np.array([LOOK, LOOK]), np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.1]]))
    assert (both[0] == LOOK).all()
    assert_close("rae element", both[1], np.array(jnkmat(0.0, 0.0, -degrees(0.1))) @ LOOK)


# Methods chosen by name: which stars each solves, what each is handed, and its reading sigma


FOCAL = 100.0
IMAGES_BY_NAME = np.array([[30.0, 5], [-28, 16], [4, -33], [21, 24], [-15, -22], [9, 12], [-3, 31]])
OFF = np.array([[3.0, -1], [-2, 2], [1, 3], [0, -2], [90, 60], [-1, 1], [2, 0]]) * 0.01
"""Errors of some hundredths of a millimetre, and one star that is a millimetre off."""


def field() -> StarField:
    rays = np.column_stack([IMAGES_BY_NAME, np.full(7, -FOCAL)])
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    return StarField.of(rays @ np.array(jnkmat(150.0, -20.0, 40.0)), IMAGES_BY_NAME + OFF, FOCAL)


FIELD = field()
ALL = np.arange(7)
START = {"initial_deg": (120.0, -10.0, 20.0)}
ALL_METHODS = [
    "collinearity", "church", "church-weighted", "church-weighted-r", "two-star",
    "single-rotation", "svd",
]  # fmt: skip


def solve(method: str, **more: Any) -> list[SolvedStars]:
    names = ("pairs", "subset", "stars")
    given = {name: more.pop(name) for name in names if name in more}
    stars = given.pop("stars", FIELD)
    return solve_by_methods(stars, [method], options=StarOptions(**more), **given)


def collinear(**options: Any) -> Any:
    return lambda one: collinearity(one, **options)


def churches(**options: Any) -> Any:
    return lambda one: church(one, **options)


CASES: dict[str, tuple[str, dict[str, Any], Any]] = {
    "usual": ("collinearity", {}, collinear()),
    "initial": ("collinearity", {**START, "corrections": 2}, collinear(**START, corrections=2)),
    "initial none": ("collinearity", {"corrections": 0}, collinear(start="svd", corrections=0)),
    "start": ("collinearity", {"start": "two-star", "corrections": 1},
              collinear(start="two-star", corrections=1)),
    "listed": ("collinearity", {"weights": "listed", "corrections": 3},
               collinear(weights="listed", corrections=3)),
    "robust": ("collinearity", {"weights": "robust"}, collinear(weights="robust")),
    "robust sigma": ("collinearity", {"weights": "robust", "reading_sigma_mm": 0.02},
                     collinear(weights="robust", reading_sigma_mm=0.02)),
    "church": ("church", {}, churches()),
    "weighted": ("church-weighted", {}, churches(weights="formula")),
    "weighted sigma": ("church-weighted", {"reading_sigma_mm": 1.0},
                       churches(weights="formula", reading_sigma_mm=1.0)),
    "weighted r": ("church-weighted-r", {}, churches(weights="formula-r")),
    "weighted r sigma": ("church-weighted-r", {"reading_sigma_mm": 1.0},
                         churches(weights="formula-r", reading_sigma_mm=1.0)),
    "svd": ("svd", {}, wahba),
    "two-star": ("two-star", {}, two_star),
    "raw": ("two-star", {"unit_cross_products": False},
            lambda one: two_star(one, unit_cross_products=False)),
    "farther": ("single-rotation", {}, single_rotation),
    "mean": ("single-rotation", {"rotation_angle": "mean"},
             lambda one: single_rotation(one, angle="mean")),
}  # fmt: skip


def expected_stars(method: str) -> np.ndarray:
    return ALL[:2] if method in ("two-star", "single-rotation") else ALL


@pytest.mark.parametrize("rotation", ["nearest", "as-solved"])
@pytest.mark.parametrize("name", CASES)
def test_each_method_is_handed_its_options(name: str, rotation: str) -> None:
    method, options, direct = CASES[name]
    (one,) = solve(method, **options, rotation=rotation)
    stars = expected_stars(method)
    solution = direct(FIELD.select(stars[None, :]))
    matrix = solution.matrix[0] if rotation == "as-solved" else solution.rotation()[0]
    assert (one.method, one.stars) == (method, tuple(int(k) + 1 for k in stars))
    assert_close("rae element", one.matrix, matrix)
    assert (one.iterations, one.failure) == (solution.iterations[0], solution.failure[0])
    if one.weights is not None or solution.weights is not None:
        assert_close("rae element", np.array(one.weights), solution.weights[0])


def test_the_cases_differ_so_that_a_lost_option_shows() -> None:
    found = {}
    for name, (method, options, _) in CASES.items():
        (one,) = solve(method, **options, rotation="as-solved")
        found[name] = (method, *np.round(np.ravel(one.matrix), 9))
    assert len(set(found.values())) == len(found)


def test_which_stars_each_method_solves() -> None:
    """Without pairs all stars, or the first two; with pairs those methods that can."""
    solved = solve_by_methods(FIELD, ALL_METHODS)
    assert [one.method for one in solved] == ALL_METHODS
    assert [one.stars for one in solved] == [
        tuple((expected_stars(name) + 1).tolist()) for name in ALL_METHODS
    ]
    pairs = np.array([[5, 1], [0, 3]])
    solved = solve_by_methods(FIELD, ALL_METHODS, pairs=pairs)
    names = ["collinearity", "two-star", "single-rotation", "svd"]
    assert [(one.method, one.stars) for one in solved] == [
        (name, pair) for name in names for pair in ((6, 2), (1, 4))
    ]
    some = solve_by_methods(FIELD, ALL_METHODS, subset=np.array([6, 2, 4, 0]))
    assert [one.stars for one in some] == [
        (7, 3) if name in ("two-star", "single-rotation") else (7, 3, 5, 1) for name in ALL_METHODS
    ]


def test_disagreements_are_shown_with_several_pairs_only() -> None:
    total, _ = star_disagreement_arcsec(FIELD)
    for one in solve("svd", pairs=np.array([[5, 1], [0, 3]])):
        assert one.disagreement_arcsec == [total[k - 1] for k in one.stars]
    assert solve("svd", pairs=np.array([[5, 1]]))[0].disagreement_arcsec is None
    assert solve("svd")[0].disagreement_arcsec is None
    assert solve("svd", subset=np.array([0, 1, 2, 3]))[0].disagreement_arcsec is None


def by_residuals(stars: StarField) -> float:
    off = collinearity(stars).residuals_mm(stars)
    return float(np.sqrt((off**2).sum() / (2 * len(off) - 3)))


GOOD = np.array([0, 1, 2, 3, 5, 6])


@pytest.mark.parametrize("method", ["collinearity", "svd", "church", "two-star"])
def test_whence_the_reading_sigma_comes(method: str) -> None:
    """Given; or from the residuals of all stars that are used; robust: from interstar angles."""
    given = solve(method, reading_sigma_mm=0.25)[0]
    assert (given.reading_sigma, given.reading_freedom) == (0.25, None)
    for subset in (ALL, GOOD, GOOD[:3]):
        one = solve(method, subset=subset)[0]
        stars = FIELD.select(subset)
        assert_close("rae element", one.reading_sigma or 0.0, by_residuals(stars))
        assert one.reading_freedom == 2 * len(subset) - 3
        robust = solve(method, subset=subset, weights="robust")[0]
        assert robust.reading_sigma == interstar_reading_sigma_mm(stars)
        assert robust.reading_freedom == 2 * len(subset) - 3
    two = solve(method, subset=GOOD[:2])[0]
    if method != "church":
        assert two.reading_sigma is None and two.rotation_sigma_arcsec is None
        assert two.failure == Failure.NONE


def test_robust_weights_below_a_half_leave_a_star_out_of_the_rms() -> None:
    """Listed ones do not: they fall with small residuals too."""
    (robust,) = solve("collinearity", weights="robust")
    counts = np.array(robust.weights) >= 0.5
    assert 0 < (~counts[:, 0]).sum() < 4
    squares = np.array(robust.residuals)[counts] ** 2
    assert_close("rae element", robust.rms, np.sqrt(squares.mean()))
    (listed,) = solve("collinearity", weights="listed", corrections=2)
    assert (np.array(listed.weights) < 0.5).any()
    assert_close("rae element", listed.rms, np.sqrt((np.array(listed.residuals) ** 2).mean()))


def test_without_a_solution_the_reading_sigma_is_that_of_the_interstar_angles() -> None:
    stars = FIELD.directions * np.where(np.arange(7) == 2, -1.0, 1.0)[:, None]
    behind = StarField.of(stars, FIELD.image_mm, FOCAL)
    assert collinearity(behind).failure != Failure.NONE
    (one,) = solve("two-star", stars=behind)
    assert one.reading_sigma == interstar_reading_sigma_mm(behind)


def test_a_wrong_star_is_no_reason_to_refuse_a_solution() -> None:
    """With the sigma of the residuals a pair 1 mm apart would be too uncertain, by angles not."""
    images = np.array([[30.0, 5], [30.3, 5], [4, -33], [21, 24], [-15, -22], [9, 12], [-3, 31]])
    rays = np.column_stack([images, np.full(7, -FOCAL)])
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    noise = np.array([[2.0, -1], [-1, 1], [1, 2], [0, -2], [4000, 9000], [-1, 1], [2, 0]]) * 5e-4
    one = StarField.of(rays, images + noise, FOCAL)
    interstar, residuals = interstar_reading_sigma_mm(one), by_residuals(one)
    sigma_deg = np.degrees(np.sqrt(2.0)) / 0.3  # of the turn about the pair, for readings of 1 mm
    assert interstar * sigma_deg < 1.5 and residuals * sigma_deg > 6.0
    pair = np.array([[0, 1]])
    assert solve("svd", stars=one, pairs=pair)[0].failure == Failure.NONE
    given = solve("svd", stars=one, pairs=pair, reading_sigma_mm=residuals)[0]
    assert given.failure == Failure.TOO_UNCERTAIN


COVARIANCES: dict[str, Any] = {
    "usual": lambda f, m, s: uncertainty.collinearity_covariance(f, m),
    "listed": lambda f, m, s: uncertainty.collinearity_covariance(f, m, s.weights),
    "robust sigma": lambda f, m, s: uncertainty.collinearity_covariance(f, m, s.weights),
    "svd": lambda f, m, s: uncertainty.wahba_covariance(f),
    "church": lambda f, m, s: uncertainty.church_covariance(f, m),
    "weighted": lambda f, m, s: uncertainty.church_covariance(f, m, weights="formula"),
    "weighted sigma": lambda f, m, s: uncertainty.church_covariance(
        f, m, weights="formula", reading_sigma_mm=1.0
    ),
    "weighted r": lambda f, m, s: uncertainty.church_covariance(f, m, weights="formula-r"),
    "two-star": lambda f, m, s: uncertainty.pair_covariance(f, m, two_star),
    "raw": lambda f, m, s: uncertainty.pair_covariance(f, m, CASES["raw"][2]),
    "farther": lambda f, m, s: uncertainty.pair_covariance(f, m, single_rotation),
    "mean": lambda f, m, s: uncertainty.pair_covariance(f, m, CASES["mean"][2]),
}


@pytest.mark.parametrize("name", COVARIANCES)
def test_each_solution_has_the_covariance_of_its_own_method(name: str) -> None:
    method, options, direct = CASES[name]
    (one,) = solve(method, **options)
    problem = FIELD.select(expected_stars(method)[None, :])
    solution = direct(problem)
    stated = COVARIANCES[name](problem, solution.rotation(), solution)[0]
    seconds = np.array(one.rotation_covariance_arcsec2)
    found = seconds / (3600.0 * 180.0 / np.pi * (one.reading_sigma or 0.0)) ** 2
    assert_close("ratio", found / np.abs(stated).max(), stated / np.abs(stated).max())


def test_what_leaves_no_attitude_to_show() -> None:
    """All failures but none at all, and no convergence."""
    shown = {code.name for code in Failure if not refused(code)}
    assert shown == {"NONE", "NO_CONVERGENCE"} and len(Failure) == 13


# Every field of a solved photograph, by numbers made by hand, and its names in a dictionary


ANGLES = ((10.0, 20.0, 30.0), (-40.0, 5.0, 170.0))
TRUE = np.array([jnkmat(*one) for one in ANGLES])
SHEARED = TRUE @ np.diag([1.02, 1.0, 0.99])  # as a Church matrix: M'M - 1 is .0404 and -.0199
IMAGES_FIELDS = np.array([[[5.0, 2.0], [-7.0, 3.0]], [[1.0, -6.0], [8.0, 8.0]]])
OFF_FIELDS = np.array([[[0.3, -0.4], [0.0, 0.1]], [[0.6, 0.0], [-0.2, 0.2]]])
COVARIANCE = np.array([np.diag([1.0, 4.0, 16.0]), np.diag([9.0, 1.0, 1.0])]) * 1e-6
SIGMA = 0.01
ARCSEC = degrees(1.0) * 3600.0
SUBSETS = np.array([[0, 3], [4, 2]])


def problems(errors: np.ndarray | None = None) -> StarField:
    """Two problems of two stars whose residuals are OFF by the matrices TRUE, and 100 mm."""
    rays = np.concatenate([IMAGES_FIELDS - OFF_FIELDS, np.full((2, 2, 1), -100.0)], axis=-1)
    rays /= np.linalg.norm(rays, axis=-1)[..., None]
    stars = np.einsum("pji,pnj->pni", TRUE, rays)
    return StarField.of(stars, IMAGES_FIELDS, 100.0, True, errors)


def solution_by_name(matrix: np.ndarray = TRUE, **more: object) -> StarSolution:
    none = np.array([0, 0])
    given = {"failure": none, "iterations": np.array([5, 7]), "converged": np.array([True, False])}
    return StarSolution(matrix, **{**given, **more})  # type: ignore[arg-type]


def split(one: StarSolution, **more: object) -> list[SolvedStars]:
    given = {
        "problems": problems(), "subsets": SUBSETS, "covariance": COVARIANCE, "sigma": SIGMA,
        "freedom": 6, "least_sigma": SIGMA, **more,
    }  # fmt: skip
    return split_solutions("a method", one, **given)  # type: ignore[arg-type]


def test_what_every_solution_has() -> None:
    first, second = split(solution_by_name(), disagreement_arcsec=np.array([10.0, 11, 12, 13, 14]))
    assert (first.method, first.failure, first.reading_sigma) == ("a method", Failure.NONE, SIGMA)
    assert (first.stars, second.stars) == ((1, 4), (5, 3))
    assert (first.iterations, second.iterations) == (5, 7)
    assert (first.converged, second.converged) == (True, False)
    assert (first.disagreement_arcsec, second.disagreement_arcsec) == ([10.0, 13.0], [14.0, 12.0])
    assert first.reading_freedom == second.reading_freedom == 6
    for k, one in enumerate((first, second)):
        m = TRUE[k]
        assert_close("rae angle", one.angles_deg[:3], ANGLES[k])
        alpha, delta, swing = np.radians(one.angles_deg[3:])
        axis = [cos(alpha) * cos(delta), sin(alpha) * cos(delta), sin(delta)]
        assert_close("rae element", axis, -m[2])  # the camera looks along -z
        north = np.array([-cos(alpha) * sin(delta), -sin(alpha) * sin(delta), cos(delta)])
        assert_close("rae element", [sin(swing), cos(swing)], m[:2] @ north)
        assert_close("rae element", one.matrix, m)
        assert_close("rae element", one.orthogonality_defect, 0.0)
        assert_close("residual", one.residuals, OFF_FIELDS[k])
        assert_close("residual", one.rms, sqrt((OFF_FIELDS[k] ** 2).sum() / 4.0))
        assert one.images == IMAGES_FIELDS[k].tolist()
        sigmas = np.sqrt(np.diag(COVARIANCE[k])) * SIGMA * ARCSEC
        assert_close("rae angle", one.rotation_sigma_arcsec or [], sigmas)
        assert_close("rae angle", one.rotation_rms_arcsec or 0.0, sqrt((sigmas**2).sum()))
        found = one.rotation_covariance_arcsec2 or []
        assert_close("rae angle", found, COVARIANCE[k] * (SIGMA * ARCSEC) ** 2)
        assert one.weighted_rms is None and one.weights is None and one.axis is None


def test_sigmas_of_the_angles_and_where_the_axis_points() -> None:
    """Seen straight: omega turns about x, phi about y, kappa about z; 95 percent by Student's F."""
    straight = solution_by_name(np.array([np.eye(3), jnkmat(0.0, 0.0, 90.0)]))
    plain, turned = split(straight, freedom=None)
    by_turns = [[1e-3, 2e-3, 4e-3], [1e-3, 3e-3, 1e-3]]
    for one, turns in ((plain, by_turns[0]), (turned, by_turns[1])):
        expected = degrees(SIGMA) * np.array(turns)
        assert_close("rae angle", (one.angle_sigmas_deg or [])[:3], expected)
    two = 2.447746830680816 * SIGMA * ARCSEC  # the root of chi square of two, 95 percent
    assert_close("rae angle", plain.boresight_95_arcsec or [], [two * 2e-3, two * 1e-3])
    assert_close("rae angle", turned.boresight_95_arcsec or [], [two * 3e-3, two * 1e-3])
    (estimated, _) = split(straight)
    f_2_6 = sqrt(2.0 * 5.143252849784718) * SIGMA * ARCSEC
    assert_close("rae angle", estimated.boresight_95_arcsec or [], [f_2_6 * 2e-3, f_2_6 * 1e-3])
    assert estimated.boresight_95_angle_deg == plain.boresight_95_angle_deg
    factors = [plain.covariance_factor_95, estimated.covariance_factor_95]
    assert_close("rae angle of nine digits", factors, [7.814727903251178, 3.0 * 4.757062663089414])


def test_the_direction_of_the_longer_semi_axis_is_in_degrees() -> None:
    """A turn about y moves the axis along x, which at swing 0 and the equator is -east."""
    looking = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    one, other = split(solution_by_name(np.array([looking, looking])))
    assert_close("rae angle", (one.boresight_95_angle_deg or 0.0) % 180.0, 90.0)
    assert_close("rae angle", (other.boresight_95_angle_deg or 0.0) % 180.0, 0.0)


def test_the_matrix_as_solved_and_the_nearest_rotation() -> None:
    """TRUE diag(1.02, 1, .99): its nearest rotation is TRUE; the defect is of the matrix itself."""
    nearest, _ = split(solution_by_name(SHEARED))
    as_solved, _ = split(solution_by_name(SHEARED), choice="as-solved")
    assert_close("rae element", nearest.matrix, TRUE[0])
    assert_close("rae element", as_solved.matrix, SHEARED[0])
    gram = np.abs(SHEARED[0] @ SHEARED[0].T - np.eye(3)).max()
    assert_close("rae defect", [nearest.orthogonality_defect, as_solved.orthogonality_defect], gram)
    _, straight = split(solution_by_name(np.array([SHEARED[0], TRUE[1]])))
    assert_close("rae defect", straight.orthogonality_defect, 0.0)
    m = SHEARED[0]
    angles = [np.arctan2(-m[2, 1], m[2, 2]), np.arcsin(m[2, 0]), np.arctan2(-m[1, 0], m[0, 0])]
    assert_close("rae angle", as_solved.angles_deg[:3], np.degrees(angles))
    assert_close("rae angle", nearest.angles_deg[:3], ANGLES[0])
    assert np.abs(np.array(as_solved.residuals) - OFF_FIELDS[0]).max() > 0.01
    assert_close("residual", nearest.residuals, OFF_FIELDS[0])
    assert nearest.rotation_sigma_arcsec is not None
    assert as_solved == as_solved.without_uncertainty() and as_solved.reading_sigma == SIGMA


WEIGHTS = np.array([[[1.0, 1.0], [0.5, 0.5]], [[0.49, 0.49], [1.0, 1.0]]])


def test_root_mean_squares_with_weights_and_errors() -> None:
    """A robust weight below a half leaves a star out of the rms; weighted squares by their sum."""
    robust = split(solution_by_name(weights=WEIGHTS), robust=True)
    plain = split(solution_by_name(weights=WEIGHTS))
    assert_close("residual", robust[0].rms, sqrt((OFF_FIELDS[0] ** 2).sum() / 4.0))
    assert_close("residual", robust[1].rms, sqrt((OFF_FIELDS[1, 1] ** 2).sum() / 2.0))
    for k in (0, 1):
        assert_close("residual", plain[k].rms, sqrt((OFF_FIELDS[k] ** 2).sum() / 4.0))
        expected = sqrt((WEIGHTS[k] * OFF_FIELDS[k] ** 2).sum() / WEIGHTS[k].sum())
        assert_close("residual", [robust[k].weighted_rms, plain[k].weighted_rms], expected)
        assert robust[k].weights == WEIGHTS[k].tolist()
    errors = np.broadcast_to(np.diag([4.0, 0.25]), (2, 2, 2, 2))
    for k, one in enumerate(split(solution_by_name(), problems=problems(errors))):
        whitened = OFF_FIELDS[k] * [0.5, 2.0]
        assert_close("residual", one.weighted_rms or 0.0, sqrt((whitened**2).sum() / 4.0))
        assert_close("residual", one.rms, sqrt((OFF_FIELDS[k] ** 2).sum() / 4.0))


def test_what_only_a_single_rotation_has() -> None:
    axes = np.array([[0.0, 0.6, 0.8], [-0.6, 0.0, -0.8]])
    given = {
        "axis": axes, "angle_deg": np.array([-12.0, 34.0]), "conditioning": np.array([0.1, 0.2]),
        "interstar_discrepancy_arcsec": np.array([-5.0, 6.0]),
    }  # fmt: skip
    first, second = split(solution_by_name(**given))
    dec = degrees(np.arcsin(0.8))
    for one, expected in ((first, (90.0, dec)), (second, (180.0, -dec))):
        assert_close("rae angle", [one.axis_ra_deg or 0.0, one.axis_dec_deg or 0.0], expected)
    names = ("axis", "angle_deg", "conditioning", "interstar_discrepancy_arcsec")
    for k, one in enumerate((first, second)):
        expected = [np.asarray(given[name])[k].tolist() for name in names]
        assert [getattr(one, name) for name in names] == expected


@pytest.mark.parametrize(
    ("least", "sigma", "refused"),
    [(0.99, 1.0, False), (1.01, 1.0, True), (0.5, 90.0, False), (1.01, np.nan, True)],
)
def test_from_which_uncertainty_on_there_is_no_solution(
    least: float, sigma: float, refused: bool
) -> None:
    """Three degrees about the worst axis, with the smallest reading sigma that is possible."""
    covariance = np.array([np.diag([1e-9, np.radians(3.0) ** 2, 1e-9]), np.eye(3) * 1e-9])
    reading = {"sigma": sigma, "freedom": 4, "least_sigma": least}
    first, second = split(solution_by_name(), covariance=covariance, **reading)
    assert first.failure == (Failure.TOO_UNCERTAIN if refused else Failure.NONE)
    assert second.failure == Failure.NONE
    failed = solution_by_name(failure=np.array([Failure.BEHIND_CAMERA, Failure.NONE]))
    assert split(failed, covariance=covariance, **reading)[0].failure == Failure.BEHIND_CAMERA


def test_where_no_uncertainty_is_stated() -> None:
    unknown = split(solution_by_name(), sigma=np.nan, freedom=None, least_sigma=np.nan)
    assert all(one == one.without_uncertainty() and one.reading_sigma is None for one in unknown)
    holes = COVARIANCE.copy()
    holes[0, 2, 2] = np.nan
    first, second = split(solution_by_name(), covariance=holes)
    assert first == first.without_uncertainty() and second != second.without_uncertainty()
    codes = np.array([Failure.NO_CONVERGENCE, Failure.BEHIND_CAMERA])
    first, second = split(solution_by_name(failure=codes))
    assert first == first.without_uncertainty() and second.rotation_sigma_arcsec is not None


FULL = SolvedStars(
    method="m", stars=(1, 4), failure=Failure.NONE, angles_deg=[1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
    matrix=[[7.0]], orthogonality_defect=8.0, residuals=[[9.0]], iterations=10, converged=True,
    rms=11.0, reading_sigma=12.0, reading_freedom=13, rotation_sigma_arcsec=[2.0, 3.0, 6.0],
    rotation_covariance_arcsec2=[[15.0]], covariance_factor_95=46.0,
    angle_sigmas_deg=[16.0, 17.0, 18.0, 19.0, 20.0, 21.0],
    boresight_95_arcsec=[22.0, 23.0], boresight_95_angle_deg=24.0, weighted_rms=25.0, axis=[26.0],
    axis_ra_deg=27.0, axis_dec_deg=28.0, angle_deg=29.0, conditioning=30.0,
    interstar_discrepancy_arcsec=31.0, weights=[[32.0]], disagreement_arcsec=[33.0],
    camera_m=[34.0], camera_sigma_m=[35.0], sky={"azimuth_deg": 36.0},
    camera={"focal": 37.0, "centre_x": 38.0, "centre_y": 39.0, "k1": 40.0},
    camera_sigmas={"focal": 41.0, "centre_x": 42.0, "centre_y": 43.0, "k1": 44.0}, images=[[45.0]],
)  # fmt: skip

NAMES = {
    "method": "m", "stars": [1, 4],
    "omega_deg": 1.0, "phi_deg": 2.0, "kappa_deg": 3.0,
    "alpha_deg": 4.0, "delta_deg": 5.0, "swing_deg": 6.0,
    "matrix": [[7.0]], "orthogonality_defect": 8.0, "residuals_U": [[9.0]], "iterations": 10,
    "converged": True, "rms_U": 11.0, "reading_sigma_U": 12.0, "reading_freedom": 13,
    "rotation_sigma_arcsec": [2.0, 3.0, 6.0], "rotation_covariance_arcsec2": [[15.0]],
    "covariance_factor_95": 46.0,
    "sigma_omega_deg": 16.0, "sigma_phi_deg": 17.0, "sigma_kappa_deg": 18.0,
    "sigma_alpha_deg": 19.0, "sigma_delta_deg": 20.0, "sigma_swing_deg": 21.0,
    "boresight_95_arcsec": [22.0, 23.0], "boresight_95_angle_deg": 24.0, "weighted_rms_U": 25.0,
    "axis": [26.0], "axis_ra_deg": 27.0, "axis_dec_deg": 28.0, "angle_deg": 29.0,
    "conditioning": 30.0, "interstar_discrepancy_arcsec": 31.0, "weights": [[32.0]],
    "disagreement_arcsec": [33.0], "camera_m": [34.0], "camera_sigma_m": [35.0],
    "azimuth_deg": 36.0, "focal_U": 37.0, "centre_x_U": 38.0, "centre_y_U": 39.0, "k1": 40.0,
    "sigma_focal_U": 41.0, "sigma_centre_x_U": 42.0, "sigma_centre_y_U": 43.0, "sigma_k1": 44.0,
    "images_U": [[45.0]],
}  # fmt: skip


@pytest.mark.parametrize("unit", ["mm", "px"])
def test_the_dictionary_has_every_value_under_its_name(unit: str) -> None:
    expected = {name.replace("_U", f"_{unit}"): value for name, value in NAMES.items()}
    assert FULL.as_dict(unit) == expected
    assert list(FULL.as_dict(unit))[:8] == list(expected)[:8]
    if unit == "mm":
        assert FULL.as_dict() == expected


def test_a_value_that_there_is_not_has_no_name_and_zero_has_one() -> None:
    optional = {one.name: None for one in fields(FULL) if one.default is None}
    bare = replace(FULL, **optional, iterations=0, rms=0.0, converged=False)  # type: ignore[arg-type]
    assert list(bare.as_dict()) == [
        "method", "stars", "omega_deg", "phi_deg", "kappa_deg", "alpha_deg", "delta_deg",
        "swing_deg", "matrix", "orthogonality_defect", "residuals_mm", "iterations", "converged",
        "rms_mm",
    ]  # fmt: skip
    assert (bare.as_dict()["iterations"], bare.as_dict()["rms_mm"]) == (0, 0.0)
    assert bare.rotation_rms_arcsec is None


def test_without_uncertainty_six_fields_are_missing_and_no_others() -> None:
    bare = FULL.without_uncertainty()
    gone = {one.name for one in fields(FULL) if getattr(bare, one.name) != getattr(FULL, one.name)}
    assert gone == {
        "rotation_sigma_arcsec", "rotation_covariance_arcsec2", "angle_sigmas_deg",
        "boresight_95_arcsec", "boresight_95_angle_deg", "covariance_factor_95",
    }  # fmt: skip
    assert all(getattr(bare, name) is None for name in gone)
    assert FULL.rotation_rms_arcsec == 7.0 and bare.rotation_rms_arcsec is None
    unlike = replace(FULL, angle_sigmas_deg=None)
    assert unlike.rotation_rms_arcsec == 7.0
