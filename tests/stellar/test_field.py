"""Star fields: shapes, stacks and edges."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tests.approved.texts import assert_approved, refused
from tests.kit import rae_listings as listings
from tests.tolerances import assert_close, within
from vopd.findings import VopdError
from vopd.geometry.sexagesimal import format_dms, parse_angle_deg
from vopd.stellar import (
    StarSolution,
    alpha_delta_swing_deg,
    calibrate,
    church,
    closed_form,
    collinearity,
    find_outliers,
    matrix_from_alpha_delta_swing,
    omega_phi_kappa_deg,
    orientation_matrix,
    orthogonality_defect,
    resection,
    single_rotation,
    star_directions,
    star_disagreement_arcsec,
    star_pairs,
    two_star,
    wahba,
)
from vopd.stellar.field import REASONS, Failure, StarField, coincide, first_failure, when
from vopd.stellar.listed import tustar
from vopd.stellar.radec import radec2
from vopd.stellar.tables_1987 import DIRECTIONS as DIRECTIONS_EDGES
from vopd.stellar.tables_1987 import DIRECTIONS as DIRECTIONS_STACKS
from vopd.stellar.tables_1987 import PERTURBED_MM, TRUTH_DEG, sample_field

# Star fields: shapes, parts, errors and what no method can solve, with numbers by hand


N, P = 4, 3
RNG = np.random.default_rng(4)
DIRECTIONS = RNG.normal(size=(P, N, 3))
IMAGES = RNG.uniform(-20.0, 20.0, (P, N, 2))
FOCAL = np.array([70.0, 80.0, 90.0])
USED = np.array([[1, 1, 1, 1], [1, 0, 1, 1], [0, 1, 1, 0]], bool)
ROOT = RNG.normal(size=(P, N, 2, 2))
ERRORS = ROOT @ ROOT.swapaxes(-1, -2)


def stack(**more: Any) -> StarField:
    return StarField.of(DIRECTIONS, IMAGES, FOCAL, USED, **({"errors": ERRORS} | more))


def same(one: StarField, directions: Any, image: Any, focal: Any, used: Any, errors: Any) -> None:
    """Every part of a field, where its stars are used."""
    used = np.array(used, bool)
    assert one.used.tolist() == used.tolist()
    assert one.directions[used].tolist() == np.array(directions)[used].tolist()
    assert one.image_mm[used].tolist() == np.array(image)[used].tolist()
    assert one.focal_length_mm.tolist() == np.array(focal).tolist()
    assert one.errors is not None and one.errors[used].tolist() == np.array(errors)[used].tolist()


def test_parts_of_a_stack() -> None:
    """Each has the errors of its stars and the principal distance of its problem."""
    field = stack()
    same(field, DIRECTIONS, IMAGES, FOCAL[:, None], USED, ERRORS)
    assert field.count.tolist() == [4, 3, 2]
    k = np.array([3, 1])
    same(field.select(k), DIRECTIONS[:, k], IMAGES[:, k], FOCAL[:, None], USED[:, k], ERRORS[:, k])
    m = np.array([True, False, True, True])
    same(field.select(m), DIRECTIONS[:, m], IMAGES[:, m], FOCAL[:, None], USED[:, m], ERRORS[:, m])
    t = np.array([2, 0])
    same(field.take(t), DIRECTIONS[t], IMAGES[t], FOCAL[t, None], USED[t], ERRORS[t])
    pairs = np.array([[0, 1], [3, 2], [1, 2], [0, 3], [2, 2]])
    focal = np.repeat(FOCAL, 5).reshape(3, 5, 1)
    parts = (DIRECTIONS[:, pairs], IMAGES[:, pairs], focal, USED[:, pairs], ERRORS[:, pairs])
    same(field.select(pairs), *parts)
    flat = field.select(pairs).flat()
    same(flat, *(one.reshape(15, *one.shape[2:]) for one in parts))
    for none in (
        field.select(k), field.take(t), field.select(pairs), field.select(pairs).flat(),
    ):  # fmt: skip
        assert none.errors is not None
    bare = stack(errors=None)
    for one in (bare, bare.select(k), bare.take(t), bare.select(pairs), bare.select(pairs).flat()):
        assert one.errors is None


def test_shapes_are_broadcast() -> None:
    """One set of directions and errors for many photographs, and the reverse."""
    field = StarField.of(DIRECTIONS[0], IMAGES, 76.0, errors=np.eye(2))
    assert field.directions.shape == (P, N, 3) and field.focal_length_mm.shape == (P, 1)
    assert field.used.all() and field.errors is not None and field.errors.shape == (P, N, 2, 2)
    assert field.count.tolist() == [4, 4, 4]
    one = StarField.of(DIRECTIONS[0], IMAGES[0], FOCAL, used=USED[1])
    assert one.image_mm.shape == (P, N, 2) and one.count.tolist() == [3, 3, 3]
    assert one.focal_length_mm.tolist() == [[70.0], [80.0], [90.0]]


WRONG = [
    (np.zeros((4, 2)), np.zeros((5, 2)), 1.0),
    (np.zeros((4, 3)), np.zeros((4, 3)), 1.0),
    (np.zeros((0, 3)), np.zeros((0, 2)), 1.0),
    (np.zeros((1, 3)), np.zeros((0, 2)), 1.0),
    (np.zeros((0, 3)), np.zeros((1, 2)), 1.0),
    (np.zeros((4, 3)), np.zeros((4, 2)), 0.0),
    (np.zeros((4, 3)), np.zeros((4, 2)), -1.0),
    (np.zeros((4, 3)), np.zeros((4, 2)), np.nan),
    (np.zeros((2, 4, 3)), np.zeros((4, 2)), [1.0, 0.0]),
    (np.zeros((4, 3)), np.zeros((5, 2)), 1.0),
]  # fmt: skip


@pytest.mark.parametrize(("directions", "images", "focal"), WRONG)
def test_what_is_no_star_field(directions: Any, images: Any, focal: Any) -> None:
    with refused(VopdError):
        StarField.of(directions, images, focal)


def test_stars_that_are_not_used_may_hold_anything() -> None:
    """Absurd coordinates of others are no numbers."""
    directions, images = DIRECTIONS.copy(), IMAGES.copy()
    directions[1, 1], images[1, 1] = np.nan, 1e60
    field = StarField.of(directions, images, FOCAL, USED)
    assert np.isfinite(field.directions).all() and np.isfinite(field.image_mm).all()
    assert field.photo[1, 1].tolist() == [0.0, 0.0, 0.0]
    assert field.unfit(2).tolist() == [0, 0, 0]
    for value, sound in ((0.9e50, True), (-0.9e50, True), (1.1e50, False), (-1.1e50, False)):
        images = np.zeros((1, 2))
        images[0, 1] = value
        one = StarField.of([[0.0, 0.0, -1.0]], images, 1.0)
        assert np.isfinite(one.image_mm[0, 1]) == sound


def test_rays_of_images() -> None:
    field = StarField.of(DIRECTIONS[0, :1], [[3.0, 4.0]], 12.0)
    assert_close("rae element", field.photo, [[3.0 / 13.0, 4.0 / 13.0, -12.0 / 13.0]])


def test_coordinates_by_their_deviations() -> None:
    """A covariance 4, 6, 25 is L L' of L = 2, 0, 3, 4: L (a, b) is 2 a, 3 a + 4 b."""
    errors = [[[4.0, 6.0], [6.0, 25.0]]]
    field = StarField.of([[0.0, 0.0, -1.0]], [[0.0, 0.0]], 1.0, errors=errors)
    one, other = np.array([5.0, -7.0]), np.array([1.0, 11.0])
    apply = np.array([[2.0, 0.0], [3.0, 4.0]])
    assert_close("rae element", field.whitened((apply @ one)[None]), one[None])
    both = np.stack([one, other], axis=-1)
    assert_close("rae element", field.whitened((apply @ both)[None]), both[None])
    plain = StarField.of([[0.0, 0.0, -1.0]], [[0.0, 0.0]], 1.0)
    assert plain.whitened(both[None]) is not None
    assert plain.whitened(both[None]).tolist() == both[None].tolist()


def test_problems_that_cannot_be_solved() -> None:
    """A number that is none comes before too few stars."""
    assert stack().unfit(2).tolist() == [Failure.NONE] * 3
    few = Failure.TOO_FEW_STARS
    assert stack().unfit(3).tolist() == [Failure.NONE, Failure.NONE, few]
    assert stack().unfit(4).tolist() == [Failure.NONE, few, few]
    for part in (0, 1, 2):
        given = [DIRECTIONS.copy(), IMAGES.copy(), FOCAL.copy()]
        if part == 2:
            given[2][0] = np.inf
        else:
            given[part][0, 2, 1] = np.inf
        assert StarField.of(*given, USED).unfit(3).tolist() == [Failure.NOT_FINITE, 0, few]
        assert StarField.of(*given, USED).unfit(5).tolist() == [Failure.NOT_FINITE, few, few]


@pytest.mark.parametrize(("sine", "same"), [(0.9e-6, True), (1.1e-6, False)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_directions_that_are_the_same(sine: float, same: bool, sign: float) -> None:
    one = np.array([0.6, 0.0, 0.8])
    other = sign * (one + sine * np.array([0.0, 1.0, 0.0]))
    assert bool(coincide(one, other)) == same


def test_the_first_of_several_failures() -> None:
    a, b, c = np.array([0, 2, 0, 3]), np.array([4, 5, 0, 0]), np.array([6, 7, 8, 0])
    assert first_failure(a, b, c).tolist() == [4, 2, 8, 3]
    assert first_failure(c, b, a).tolist() == [6, 7, 8, 3]
    assert first_failure(a).tolist() == a.tolist()
    assert when(np.array([True, False]), Failure.SINGULAR).tolist() == [8, 0]


def test_reasons_of_failures() -> None:
    """Those of which no other test holds every word."""
    assert set(REASONS) == set(Failure) - {Failure.NONE}
    assert_approved(REASONS[Failure.TOO_FEW_STARS])
    assert_approved(REASONS[Failure.BEHIND_CAMERA])


def test_codes_of_failures() -> None:
    """They are in arrays that callers keep."""
    assert {one.name: one.value for one in Failure} == {
        "NONE": 0, "NOT_FINITE": 1, "TOO_FEW_STARS": 2, "SAME_STAR": 3, "GREAT_CIRCLE": 4,
        "PRINCIPAL_POINT": 5, "NO_ROTATION": 6, "AXIS_IN_PLANE": 7, "SINGULAR": 8,
        "NO_CONVERGENCE": 9, "BEHIND_CAMERA": 10, "NOT_A_ROTATION": 11, "TOO_UNCERTAIN": 12,
    }  # fmt: skip


# Stacks: every element as if it were alone, to the bit, and arguments as they were


START = [140.0, -10.0, 45.0]
METHODS: dict[str, Callable[[StarField], StarSolution]] = {
    "collinearity": collinearity,
    "collinearity from a start": lambda field: collinearity(field, initial_deg=START),
    "listed": lambda f: collinearity(f, initial_deg=START, weights="listed", corrections=4),
    "robust": lambda field: collinearity(field, weights="robust"),
    "robust, sigma": lambda f: collinearity(f, weights="robust", reading_sigma_mm=0.3),
    "church": church,
    "church-weighted": lambda field: church(field, weights="formula"),
    "church-weighted, sigma": lambda f: church(f, weights="formula", reading_sigma_mm=0.3),
}
PAIR_METHODS: dict[str, Callable[[StarField], StarSolution]] = {
    "two-star": two_star,
    "two-star raw": lambda pair: two_star(pair, unit_cross_products=False),
    "single-rotation": single_rotation,
}
FIELDS = ("matrix", "failure", "iterations", "converged", "weights", "axis", "angle_deg",
          "conditioning", "interstar_discrepancy_arcsec")  # fmt: skip


def problems(count: int = 24) -> StarField:
    """The sample with other reading errors each time, as a stack of 4 by 6; the third is hopeless.

    Each has its own focal length; some lack their last star.
    """
    rng = np.random.default_rng(11)
    images = PERTURBED_MM + rng.normal(0.0, 0.3, (count, 4, 2))
    images[2] = np.nan
    used = np.ones((count, 4), bool)
    used[5::7, 3] = False
    focal = 76.0 + rng.normal(0.0, 0.1, count)
    shape = (4, count // 4)
    return StarField.of(
        DIRECTIONS_STACKS,
        images.reshape(*shape, 4, 2),
        focal.reshape(shape),
        used.reshape(*shape, 4),
    )


def one(field: StarField, i: int, j: int) -> StarField:
    return StarField(*(a[i, j] for a in arrays(field)))  # type: ignore[arg-type]


def arrays(field: StarField) -> list[np.ndarray]:
    return [field.directions, field.image_mm, field.focal_length_mm, field.used]


def pair(field: StarField) -> StarField:
    return StarField(field.directions[..., :2, :], field.image_mm[..., :2, :],
                     field.focal_length_mm, field.used[..., :2])  # fmt: skip


@pytest.mark.parametrize("method", [*METHODS, *PAIR_METHODS])
def test_a_stack_is_its_elements_to_the_bit(method: str) -> None:
    field = problems() if method in METHODS else pair(problems())
    solve = {**METHODS, **PAIR_METHODS}[method]
    whole = solve(field)
    assert whole.failure.shape == (4, 6) and whole.failure[0, 2] != 0
    assert (whole.failure == 0).sum() == 23
    for i in range(4):
        for j in range(6):
            alone = solve(one(field, i, j))
            for name in FIELDS:
                mine, other = getattr(whole, name), getattr(alone, name)
                assert (mine is None) == (other is None)
                if mine is not None:
                    np.testing.assert_array_equal(mine[i, j], other, err_msg=name)


@pytest.mark.parametrize("method", [*METHODS, *PAIR_METHODS])
def test_arguments_stay_as_they_were(method: str) -> None:
    field = problems() if method in METHODS else pair(problems())
    kept = [a.copy() for a in arrays(field)]
    start = list(START)
    {**METHODS, **PAIR_METHODS}[method](field)
    for before, after in zip(kept, arrays(field), strict=True):
        np.testing.assert_array_equal(before, after)
    assert start == START


@pytest.mark.parametrize("method", METHODS)
def test_a_star_that_is_not_used_changes_nothing(method: str) -> None:
    """Whatever it holds: nonsense, NaN."""
    for junk in (np.nan, 1e30, 0.0):
        images = np.vstack([PERTURBED_MM, [[junk, junk]]])
        stars = np.vstack([DIRECTIONS_STACKS, [[junk, 0.0, 1.0]]])
        padded = StarField.of(stars, images, 76.0, [True] * 4 + [False])
        mine, plain = METHODS[method](padded).matrix, METHODS[method](sample_field()).matrix
        assert np.abs(mine - plain).max() < within("rae stack element")


def test_a_star_that_is_not_used_is_no_outlier_and_tells_no_camera() -> None:
    images = np.vstack([[[900.0, 900.0]], PERTURBED_MM, [[30.0, 30.0]]])
    stars = np.vstack([[[1.0, 0.0, 0.0]], DIRECTIONS_STACKS, DIRECTIONS_STACKS[:1]])
    errors = np.tile(np.eye(2), (6, 1, 1))
    errors[0] = 0.0
    padded = StarField.of(stars, images, 76.0, [False] + [True] * 5, errors)
    alone = StarField.of(stars[1:], images[1:], 76.0)
    for start in ("interstar", "pairs"):
        mine, plain = find_outliers(padded, start=start), find_outliers(alone, start=start)
        assert [one.star for one in mine] == [one.star + 1 for one in plain]
    matrix = wahba(alone).matrix
    mine, plain = (calibrate(one, matrix, ("focal",)) for one in (padded, alone))
    assert plain.failure == Failure.NONE
    assert mine.lens == plain.lens


@pytest.mark.parametrize("method", METHODS)
def test_the_order_of_the_stars_does_not_matter(method: str) -> None:
    order = [2, 0, 3, 1]
    turned = StarField.of(DIRECTIONS_STACKS[order], PERTURBED_MM[order], 76.0)
    mine, plain = METHODS[method](turned).matrix, METHODS[method](sample_field()).matrix
    assert np.abs(mine - plain).max() < within("rae rotation")


def test_pair_by_pair_and_all_at_once() -> None:
    field = sample_field()
    pairs = star_pairs(4)
    assert pairs.tolist() == [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]
    for solve in (*PAIR_METHODS.values(), collinearity):
        together = solve(field.select(pairs)).matrix
        for k, index in enumerate(pairs):
            alone = solve(StarField.of(DIRECTIONS_STACKS[index], PERTURBED_MM[index], 76.0)).matrix
            np.testing.assert_array_equal(together[k], alone)


def test_one_star_has_no_widest_pair() -> None:
    field = sample_field()
    assert np.isnan(closed_form(field.select(np.array([[0], [1]])))).all()
    assert closed_form(field.select(np.array([[0], [1]]))).shape == (2, 3, 3)
    assert np.isfinite(closed_form(field.select(np.array([[0, 1]])))).all()


def test_disagreements_of_a_stack() -> None:
    field = problems()
    total, median = star_disagreement_arcsec(field)
    start = closed_form(field)
    for i in range(4):
        for j in range(6):
            alone = one(field, i, j)
            for mine, other in zip(
                (total, median, start),
                (*star_disagreement_arcsec(alone), closed_form(alone)),
                strict=True,
            ):
                np.testing.assert_array_equal(mine[i, j], other)


# Thresholds and first steps: where the rules of the stellar methods begin and end


def test_the_first_robust_pass_has_no_weights() -> None:
    start = {"initial_deg": [150.0, -15.0, 50.0], "corrections": 1}
    first = collinearity(sample_field(), weights="robust", **start).matrix  # type: ignore[arg-type]
    plain = collinearity(sample_field(), **start).matrix  # type: ignore[arg-type]
    np.testing.assert_array_equal(first, plain)


def test_every_start_within_60_degrees_leads_home() -> None:
    """Axes all around the true one, by 10 and by 60 degrees, whatever the turn about them."""
    home = orientation_matrix(TRUTH_DEG)
    around = np.radians(np.arange(0.0, 360.0, 30.0))
    tilts = [
        Rotation.from_rotvec(np.radians(tilt) * np.array([np.cos(a), np.sin(a), 0.0]))
        for tilt in (10.0, 60.0)
        for a in around
    ]
    spins = [Rotation.from_rotvec([0.0, 0.0, spin]) for spin in (0.0, 2.0, np.pi)]
    starts = np.array([(s * t).as_matrix() @ home for t in tilts for s in spins])
    angles = np.degrees(  # of these matrices, by eq. 3.5
        [[np.arctan2(-m[2, 1], m[2, 2]), np.arcsin(m[2, 0]), np.arctan2(-m[1, 0], m[0, 0])]
         for m in starts]
    )  # fmt: skip
    fields = StarField.of(np.tile(DIRECTIONS_EDGES, (len(starts), 1, 1)), PERTURBED_MM, 76.0)
    solution = collinearity(fields, initial_deg=angles)
    assert solution.converged.all() and solution.iterations.max() < 50
    assert np.ptp(solution.matrix, axis=0).max() < within("rae rotation")


@pytest.mark.parametrize("solve", [two_star, single_rotation])
def test_one_image_of_two_stars_is_no_pair(solve: object) -> None:
    rays = np.array([[0.1, 0.2, -1.0], [0.1, 0.3, -1.0]])
    stars = rays / np.linalg.norm(rays, axis=1)[:, None]
    same = StarField.of(stars, [[5.0, 5.0], [5.0, 5.0]], 76.0)
    assert solve(same).failure == Failure.SAME_STAR  # type: ignore[operator]
    same = StarField.of(stars[[0, 0]], [[5.0, 5.0], [7.0, 5.0]], 76.0)
    assert solve(same).failure == Failure.SAME_STAR  # type: ignore[operator]


def test_too_few_stars_and_shapes_that_do_not_fit() -> None:
    assert church(StarField.of(DIRECTIONS_EDGES[:2], PERTURBED_MM[:2], 76.0)).failure == 2
    single = StarField.of(np.tile(DIRECTIONS_EDGES[:1], (3, 1, 1)), PERTURBED_MM[:1], 76.0)
    assert collinearity(single).failure.tolist() == [2, 2, 2]
    assert np.isnan(closed_form(single)).all()
    for stars, images, focal in (
        (DIRECTIONS_EDGES[:3], PERTURBED_MM, 76.0),
        (DIRECTIONS_EDGES[:, :2], PERTURBED_MM, 76.0),
        (DIRECTIONS_EDGES[:0], PERTURBED_MM[:0], 76.0),
        (DIRECTIONS_EDGES, PERTURBED_MM, -76.0),
    ):
        with pytest.raises(VopdError):
            StarField.of(stars, images, focal)


OTHER: dict[str, Callable[[], object]] = {
    "names in the place of degrees": lambda: star_directions(["Vega"], [38.78]),
    "no right ascension": lambda: star_directions(None, 38.78),
    "one declination for two stars": lambda: star_directions([1.0, 2.0, 3.0], [4.0, 5.0]),
    "images in words": lambda: StarField.of(np.eye(3), [["a", "b"]] * 3, 76.0),
    "a masked image": lambda: StarField.of(
        np.eye(3), np.ma.masked_greater([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]], 5.5), 76.0
    ),
    "points of a space resection in the plane": lambda: resection(np.eye(2), np.eye(2), 76.0),
    "errors that are no covariance": lambda: StarField.of(
        np.eye(3), np.eye(3)[:, :2], 76.0, errors=[[1.0, 2.0], [2.0, 1.0]]
    ),
    "errors of nothing": lambda: StarField.of(
        np.eye(3), np.eye(3)[:, :2], 76.0, errors=np.zeros((2, 2))
    ),
    "an unknown that no camera has": lambda: calibrate(THREE, np.eye(3), ("centre",)),
    "three stars by two": lambda: two_star(THREE),
    "three stars by a single rotation": lambda: single_rotation(THREE),
    "one star by two": lambda: two_star(THREE.select(np.array([0]))),
    "vectors in the place of a field": lambda: collinearity(THREE.directions),  # type: ignore[arg-type]
    "a list of fields": lambda: wahba([THREE]),  # type: ignore[arg-type]
    "no field": lambda: church(None),  # type: ignore[arg-type]
    "no field to search": lambda: find_outliers(None),  # type: ignore[arg-type]
    "no field of pairs": lambda: closed_form(None),  # type: ignore[arg-type]
    "no field of angles": lambda: star_disagreement_arcsec(None),  # type: ignore[arg-type]
    "a stack to search": lambda: find_outliers(stack()),
    "weights that there are not": lambda: collinearity(THREE, weights="huber"),  # type: ignore[arg-type]
    "no weights": lambda: collinearity(THREE, weights=None),  # type: ignore[arg-type]
    "a start that there is not": lambda: collinearity(THREE, start="wahba"),  # type: ignore[arg-type]
    "weights of church that there are not": lambda: church(THREE, weights="robust"),  # type: ignore[arg-type]
    "an angle that there is not": lambda: single_rotation(TWO, angle="nearer"),  # type: ignore[arg-type]
    "half of the stars that there is not": lambda: find_outliers(THREE, start="all"),  # type: ignore[arg-type]
    "one angle to start from": lambda: collinearity(THREE, initial_deg=[1.0]),
    "angles in words": lambda: collinearity(THREE, initial_deg="svd"),
    "corrections below zero": lambda: collinearity(THREE, corrections=-1),
    "half a correction": lambda: collinearity(THREE, corrections=1.5),  # type: ignore[arg-type]
    "a sigma below zero": lambda: collinearity(THREE, weights="robust", reading_sigma_mm=-1.0),
    "a sigma that is no number": lambda: church(THREE, reading_sigma_mm=np.nan),
    "sigmas of church": lambda: church(THREE, reading_sigma_mm=[1.0]),  # type: ignore[arg-type]
    "a principal distance below zero": lambda: resection(np.eye(3), np.eye(3)[:, :2], -76.0),
    "no covariance of a resection": lambda: resection(
        np.eye(3), np.eye(3)[:, :2], 76.0, np.zeros((3, 2, 2))
    ),
    "angles of a matrix in the plane": lambda: omega_phi_kappa_deg(np.eye(2)),
    "alpha of no matrix": lambda: alpha_delta_swing_deg(None),  # type: ignore[arg-type]
    "the defect of a number": lambda: orthogonality_defect(1.0),  # type: ignore[arg-type]
    "a matrix of two angles": lambda: orientation_matrix([1.0, 2.0]),  # type: ignore[arg-type]
    "a matrix of a swing": lambda: matrix_from_alpha_delta_swing(3.0),  # type: ignore[arg-type]
}
THREE = StarField.of(np.eye(3), [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]], 76.0)
TWO = THREE.select(np.array([0, 1]))


@pytest.mark.parametrize("what", OTHER)
def test_arguments_of_another_kind(what: str) -> None:
    """Errors of numpy and Python; masked elements were numbers, and a third star was left out.

    Words that there are not were the usual ones, and one angle was all three.
    """
    with refused(VopdError):
        OTHER[what]()


def test_lists_are_taken_and_solutions_compared_by_their_values() -> None:
    ground = [[0.0, 0.0, 10.0], [900.0, 0.0, 0.0], [0.0, 900.0, 5.0], [900.0, 800.0, 0.0]]
    seen = [[-30.0, -25.0], [31.0, -26.0], [-29.0, 35.0], [30.0, 28.0]]
    found, same = (resection(kind(ground), kind(seen), 76.0) for kind in (list, np.array))
    assert found.matrix.tobytes() == same.matrix.tobytes()
    assert collinearity(THREE) == collinearity(THREE) != wahba(THREE)


def test_tustar_s_discrepancy_is_celestial_minus_photo() -> None:
    """As the sound one, to what an arc cosine can."""
    pair = StarField.of(DIRECTIONS_EDGES[:2], PERTURBED_MM[:2], 76.0)
    sound = two_star(pair).interstar_discrepancy_arcsec
    assert sound is not None and sound < -400.0  # -474.40, by hand from the tables
    assert_close("rae arc cosine, rounded stars", tustar(pair).discrepancy_arcsec, sound)


# Angles of matrices where they are hard: phi and delta near +-90, elements past 1


turn = st.floats(-180.0, 180.0)


@given(turn, st.floats(-90.0, 90.0), turn)
def test_the_matrix_is_jnkmats(omega: float, phi: float, kappa: float) -> None:
    mine = orientation_matrix(np.array([omega, phi, kappa]))
    assert np.abs(mine - listings.jnkmat(omega, phi, kappa)).max() < within("rae element")


@pytest.mark.parametrize("short", [1.0, 1e-2, 1e-4, 1e-6, 1e-7, 1e-9, 0.0])
@pytest.mark.parametrize("side", [-1.0, 1.0])
@given(first=turn, last=turn)
def test_near_the_pole_the_matrix_comes_back(
    side: float, short: float, first: float, last: float
) -> None:
    angles = np.array([first, side * (90.0 - short), last])
    m = orientation_matrix(angles)
    back = orientation_matrix(omega_phi_kappa_deg(m))
    assert np.abs(back - m).max() < within("rae element near a pole")
    m = matrix_from_alpha_delta_swing(angles)
    back = matrix_from_alpha_delta_swing(alpha_delta_swing_deg(m))
    assert np.abs(back - m).max() < within("rae element near a pole")


def test_a_thousandth_from_the_pole_all_three_are_known() -> None:
    for phi in (-89.999, 89.999):
        m = orientation_matrix(np.array([30.0, phi, 20.0]))
        found = omega_phi_kappa_deg(m)
        assert_close("rae angle", found, [30.0, phi, 20.0])


@pytest.mark.parametrize(("delta", "alpha"), [(90.0, 40.0), (-90.0, 60.0)])
def test_at_the_celestial_pole_swing_is_zero(delta: float, alpha: float) -> None:
    """Alpha 50, swing 10: only 50 - 10 is defined above, 50 + 10 below (y axis worked by hand)."""
    found = alpha_delta_swing_deg(matrix_from_alpha_delta_swing(np.array([50.0, delta, 10.0])))
    assert_close("rae angle", found[0], alpha)
    assert abs(found[1] - delta) < within("angle at a pole") and found[2] == 0.0


def test_an_element_past_one_is_clipped() -> None:
    m = orientation_matrix(np.array([10.0, 90.0, 0.0]))
    m[2, 0] = 1.0 + 1e-6
    assert abs(omega_phi_kappa_deg(m)[1] - 90.0) < within("angle of a matrix")
    m = orientation_matrix(np.array([180.0, 0.0, 0.0]))
    m[2, 2] = -1.0 - 1e-6
    assert abs(alpha_delta_swing_deg(m)[1] - 90.0) < within("angle of a matrix")


def test_the_two_triples_are_one_attitude() -> None:
    """The source notes: the sample is exactly alpha 50, delta 60, swing 10."""
    angles = omega_phi_kappa_deg(matrix_from_alpha_delta_swing(np.array([50.0, 60.0, 10.0])))
    assert_close("rae angle of seven digits", angles, [156.1413452, -18.7472372, 46.0052148])


def test_the_optical_axis_points_to_alpha_delta() -> None:
    made = radec2(np.array([[0.0, 0.0]]), 76.0, np.array([156.1413452, -18.7472372, 46.0052148]))
    assert_close("rae axis by seven decimals", [made.ra_deg[0], made.dec_deg[0]], [50.0, 60.0])


def test_omega_turns_y_toward_z_then_phi_z_toward_x_then_kappa_x_toward_y() -> None:
    """A quarter turn each: the rows of M are the camera's axes in the sky's."""
    quarter = np.eye(3) * 90.0
    expected = [
        [[1, 0, 0], [0, 0, 1], [0, -1, 0]],  # y becomes the old z
        [[0, 0, -1], [0, 1, 0], [1, 0, 0]],  # z becomes the old x
        [[0, 1, 0], [-1, 0, 0], [0, 0, 1]],  # x becomes the old y
    ]
    assert np.abs(orientation_matrix(quarter) - expected).max() < within("rae element")


def test_defect_by_hand() -> None:
    """diag(1, 1.1, 1): M M' - I has 1.21 - 1."""
    assert_close("table value", orthogonality_defect(np.diag([1.0, 1.1, 1.0])), 0.21)
    assert orthogonality_defect(np.eye(3)) == 0.0


@pytest.mark.parametrize(
    ("text", "degrees"),
    [
        ("-0 30 0", -0.5),
        ("-0h30m0s", -7.5),
        ("+1:30:36", 1.51),
        ("5h12m3s", 78.0125),
        ("12°30'", 12.5),
        ("-4.5", -4.5),
    ],
)
def test_angles_as_people_write_them(text: str, degrees: float) -> None:
    assert abs(parse_angle_deg(text, hours=True) - degrees) < within("rae element")


@pytest.mark.parametrize("text", ["3 60 0", "3 0 60", "3 0 59 9", "3 -1 0", "", "3h", "1e", "٣"])
def test_what_is_no_angle(text: str) -> None:
    with pytest.raises(ValueError, match=r"angle|below 60"):
        parse_angle_deg(text, hours=True)


def test_angles_are_written_with_their_carry() -> None:
    assert format_dms(-0.25) == "-0°15'00.00\"" and format_dms(59.9999999) == "60°00'00.00\""
