"""Where each method refuses a problem and with which reason: both sides of every limit."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, degrees, sin, sqrt

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit.rae_listings import jnkmat
from tests.tolerances import assert_close, within
from vopd.stellar import Failure, StarField, church, collinearity, single_rotation, two_star, wahba
from vopd.stellar.methods.church import flatness
from vopd.stellar.methods.collinearity import turned
from vopd.stellar.methods.wahba import closed_form
from vopd.stellar.methods.weights import least_squares
from vopd.stellar.solution import StarSolution

Solve = Callable[[StarField], StarSolution]
IMAGES = np.array([[20.0, 5.0], [-18.0, 9.0], [4.0, -23.0], [11.0, 14.0]])


def rays_of(images: np.ndarray) -> np.ndarray:
    rays = np.column_stack([images, np.full(len(images), -100.0)])
    return np.asarray(rays / np.linalg.norm(rays, axis=1)[:, None])


LOOK = np.array(jnkmat(30.0, 10.0, -50.0))
STARS = rays_of(IMAGES) @ LOOK
METHODS: dict[str, tuple[Solve, int]] = {
    "collinearity": (collinearity, 2),
    "church": (church, 3),
    "two-star": (two_star, 2),
    "single-rotation": (single_rotation, 2),
    "svd": (wahba, 2),
}


@pytest.mark.parametrize("name", METHODS)
def test_too_few_stars_and_coordinates_that_are_not_finite(name: str) -> None:
    """They come before any other reason; a star that is not used may hold anything."""
    solve, least = METHODS[name]
    n = 3 if name == "church" else 2
    for used in range(n + 1):
        mask = np.arange(n) < used
        failure = solve(StarField.of(STARS[:n], IMAGES[:n], 100.0, mask)).failure
        assert failure == (Failure.TOO_FEW_STARS if used < least else Failure.NONE)
    for k in range(2):
        for array in (STARS, IMAGES):
            spoiled = array[:n].copy()
            spoiled[k, 0] = np.nan
            given = (spoiled, IMAGES[:n]) if array is STARS else (STARS[:n], spoiled)
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
    solve, _ = METHODS[name]
    field = StarField.of(stars @ LOOK, -100.0 * images[:, :2] / images[:, 2:], 100.0)
    assert (solve(field).failure == Failure.SAME_STAR) == same


def test_opposite_stars_are_no_pair() -> None:
    for solve in (two_star, single_rotation, wahba):
        field = StarField.of([STARS[0], -STARS[0]], IMAGES[:2], 100.0)
        assert solve(field).failure == Failure.SAME_STAR
        field = StarField.of([STARS[0], -STARS[0]], IMAGES[[0, 0]], 100.0)
        assert solve(field).failure == Failure.SAME_STAR


def test_one_star_that_does_not_move_is_first_of_all_the_same_star() -> None:
    rays = rays_of(IMAGES[[0, 0]])
    field = StarField.of(rays, IMAGES[[0, 0]], 100.0)
    assert single_rotation(field).failure == Failure.SAME_STAR


def test_errors_weigh_the_directions_of_wahbas_problem() -> None:
    """By scipy; a star's weight is the inverse of the mean variance of its x and y."""
    errors = np.array([np.diag(one) for one in ((1.0, 3.0), (9.0, 7.0), (0.5, 0.5), (2.0, 6.0))])
    read = IMAGES + np.array([[0.5, 0.0], [-0.3, 0.4], [0.0, -0.6], [0.2, 0.2]])
    solved = wahba(StarField.of(STARS, read, 100.0, True, errors))
    weights = [1.0 / 2.0, 1.0 / 8.0, 2.0, 1.0 / 4.0]
    expected, _ = Rotation.align_vectors(rays_of(read), STARS, weights)
    assert_close("rae rotation", solved.matrix, expected.as_matrix())


@pytest.mark.parametrize(("size", "still"), [(0.7e-6, True), (1.5e-6, False)])
def test_a_star_that_hardly_moves_has_no_rotation(size: float, still: bool) -> None:
    """One of the two is enough, either one."""
    axis = rays_of(np.array([[3.0, -2.0]]))[0]
    rays = rays_of(IMAGES[:2])
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
        images = IMAGES[:3] + np.array([[middle, 0.0], [0.0, 0.0], [0.0, 0.0]])
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
    images = np.vstack([IMAGES, radius])
    refused = central and weights != "uniform" and sigma is None
    for used in (True, False):
        mask = np.array([True] * 4 + [used])
        field = StarField.of(rays_of(images) @ LOOK, images, 100.0, mask)
        failure = church(field, weights=weights, reading_sigma_mm=sigma).failure  # type: ignore[arg-type]
        assert failure == (Failure.PRINCIPAL_POINT if refused and used else Failure.NONE)


def test_flatness_is_the_smaller_of_the_stars_and_of_their_images() -> None:
    """Singular values by numpy; 0 for fewer than three; a star that is not used does not count."""
    flat = IMAGES * [1.0, 0.001]
    for stars, images in ((IMAGES, flat), (flat, IMAGES), (IMAGES, IMAGES)):
        field = StarField.of(rays_of(stars), images, 100.0)
        sizes = [np.linalg.svd(rays_of(one), compute_uv=False) for one in (stars, images)]
        assert_close("rae element", flatness(field), min(one[2] / one[0] for one in sizes))
    assert flatness(StarField.of(STARS[:2], IMAGES[:2], 100.0)) == 0.0
    mask = np.array([True, True, True, False])
    three = flatness(StarField.of(STARS[:3], IMAGES[:3], 100.0))
    spoiled = STARS.copy()
    spoiled[3] = np.nan
    assert_close("rae element", flatness(StarField.of(spoiled, IMAGES, 100.0, mask)), three)


@pytest.mark.parametrize(("half", "lost"), [(0.8e-8, True), (1.25e-8, False)])
def test_from_which_spread_on_two_stars_determine_an_attitude(half: float, lost: bool) -> None:
    """Two stars at +-half radian across the axis: their turn about it has half the others' size."""
    images = np.array([[100.0 * half, 0.0], [-100.0 * half, 0.0]])
    solved = collinearity(StarField.of(rays_of(images), images, 100.0), initial_deg=[0.0, 0.0, 0.0])
    assert (solved.failure == Failure.SINGULAR) == lost


def test_exactly_as_many_corrections_as_asked_for() -> None:
    """They do not stop where nothing moves any more, and `converged` is said of the last."""
    off = np.array([[0.1, 0.0], [0.0, -0.2], [0.0, 0.0], [0.1, 0.1]])
    field = StarField.of(STARS, IMAGES + off, 100.0)
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
    field = StarField.of(STARS, IMAGES, 100.0, [True, True, False, True])
    for rule in ("listed", "robust"):
        given = {"weights": rule, "corrections": 1, "initial_deg": [25.0, 15.0, -45.0]}
        weights = collinearity(field, **given).weights  # type: ignore[arg-type]
        assert weights is not None and (weights[2] == 0.0).all() and (weights[[0, 1, 3]] > 0).all()


def test_a_star_behind_the_camera_is_a_failure_even_if_the_others_are_in_front() -> None:
    stars = np.vstack([STARS, -STARS[3]])
    images = np.vstack([IMAGES, IMAGES[3]])
    solved = collinearity(StarField.of(stars, images, 100.0), initial_deg=[30.0, 10.0, -50.0])
    assert (solved.failure, solved.converged) == (Failure.BEHIND_CAMERA, False)
    assert_close("rae element", solved.matrix, LOOK)


def test_the_widest_pair_of_the_stars_that_are_used() -> None:
    stars, images = STARS.copy(), IMAGES.copy()
    stars[1] = np.nan
    field = StarField.of(stars, images, 100.0, [True, False, True, True])
    assert_close("rae element", closed_form(field), LOOK)
    assert np.isnan(closed_form(StarField.of(STARS[:1], IMAGES[:1], 100.0))).all()
    two = closed_form(StarField.of(STARS[:2], IMAGES[:2], 100.0))
    assert_close("rae element", two, LOOK)
    one_used = StarField.of(STARS[:2], IMAGES[:2], 100.0, [True, False])
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
    assert least_squares(design, side, weights).spread[0] == 0.0
    assert least_squares(0.0 * design[1:], side[1:], weights[1:]).spread == 0.0


def test_no_turn_leaves_a_matrix_as_it_is() -> None:
    both = turned(np.array([LOOK, LOOK]), np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.1]]))
    assert (both[0] == LOOK).all()
    assert_close("rae element", both[1], np.array(jnkmat(0.0, 0.0, -degrees(0.1))) @ LOOK)
