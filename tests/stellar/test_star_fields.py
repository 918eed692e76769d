"""Star fields: shapes, parts, errors and what no method can solve, with numbers by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.stellar.field import REASONS, Failure, StarField, coincide, first_failure, when

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
    assert one.errors is not None and one.errors.tolist() == np.array(errors).tolist()


def test_parts_of_a_stack() -> None:
    """Each has the errors of its stars and the principal distance of its problem."""
    field = stack()
    same(field, DIRECTIONS, IMAGES, FOCAL[:, None], USED, ERRORS)
    assert field.count.tolist() == [4, 3, 2]
    k = np.array([3, 1])
    same(field.only(k), DIRECTIONS[:, k], IMAGES[:, k], FOCAL[:, None], USED[:, k], ERRORS[:, k])
    m = np.array([True, False, True, True])
    same(field.only(m), DIRECTIONS[:, m], IMAGES[:, m], FOCAL[:, None], USED[:, m], ERRORS[:, m])
    t = np.array([2, 0])
    same(field.take(t), DIRECTIONS[t], IMAGES[t], FOCAL[t, None], USED[t], ERRORS[t])
    pairs = np.array([[0, 1], [3, 2], [1, 2], [0, 3], [2, 2]])
    focal = np.repeat(FOCAL, 5).reshape(3, 5, 1)
    parts = (DIRECTIONS[:, pairs], IMAGES[:, pairs], focal, USED[:, pairs], ERRORS[:, pairs])
    same(field.select(pairs), *parts)
    flat = field.select(pairs).flat()
    same(flat, *(one.reshape(15, *one.shape[2:]) for one in parts))
    for none in (
        field.only(k), field.take(t), field.select(pairs), field.select(pairs).flat(),
    ):  # fmt: skip
        assert none.errors is not None
    bare = stack(errors=None)
    for one in (bare, bare.only(k), bare.take(t), bare.select(pairs), bare.select(pairs).flat()):
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


WRONG: list[tuple[Any, Any, Any, str]] = [
    (np.zeros((4, 2)), np.zeros((5, 2)), 1.0, "directions must be (..., n, 3) and images "
     "(..., n, 2), not (4, 2) and (5, 2)"),
    (np.zeros((4, 3)), np.zeros((4, 3)), 1.0, "directions must be (..., n, 3) and images "
     "(..., n, 2), not (4, 3) and (4, 3)"),
    (np.zeros((0, 3)), np.zeros((0, 2)), 1.0, "a star field needs one star at least"),
    (np.zeros((1, 3)), np.zeros((0, 2)), 1.0, "a star field needs one star at least"),
    (np.zeros((0, 3)), np.zeros((1, 2)), 1.0, "a star field needs one star at least"),
    (np.zeros((4, 3)), np.zeros((4, 2)), 0.0, "a focal length must be positive"),
    (np.zeros((4, 3)), np.zeros((4, 2)), -1.0, "a focal length must be positive"),
    (np.zeros((4, 3)), np.zeros((4, 2)), np.nan, "a focal length must be positive"),
    (np.zeros((2, 4, 3)), np.zeros((4, 2)), [1.0, 0.0], "a focal length must be positive"),
    (np.zeros((4, 3)), np.zeros((5, 2)), 1.0, "the shapes of a star field do not fit: shape "
     "mismatch: objects cannot be broadcast to a single shape.  Mismatch is between arg 0 with "
     "shape (4,) and arg 1 with shape (5,)."),
]  # fmt: skip


@pytest.mark.parametrize(("directions", "images", "focal", "said"), WRONG)
def test_what_is_no_star_field(directions: Any, images: Any, focal: Any, said: str) -> None:
    with pytest.raises(VopdError) as caught:
        StarField.of(directions, images, focal)
    assert str(caught.value) == said


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
    assert REASONS[Failure.TOO_FEW_STARS] == "too few stars"
    said = "a star lies behind the camera in the solution"
    assert REASONS[Failure.BEHIND_CAMERA] == said


def test_codes_of_failures() -> None:
    """They are in arrays that callers keep."""
    assert {one.name: one.value for one in Failure} == {
        "NONE": 0, "NOT_FINITE": 1, "TOO_FEW_STARS": 2, "SAME_STAR": 3, "GREAT_CIRCLE": 4,
        "PRINCIPAL_POINT": 5, "NO_ROTATION": 6, "AXIS_IN_PLANE": 7, "SINGULAR": 8,
        "NO_CONVERGENCE": 9, "BEHIND_CAMERA": 10, "NOT_A_ROTATION": 11, "TOO_UNCERTAIN": 12,
    }  # fmt: skip
