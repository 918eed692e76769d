"""Stacks: every element as if it were alone, to the bit, and arguments as they were."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tests.tolerances import within
from vopd.stellar import (
    StarField,
    StarSolution,
    church,
    closed_form,
    collinearity,
    outliers,
    single_rotation,
    star_disagreement_arcsec,
    star_pairs,
    two_star,
)
from vopd.stellar.tables_1987 import DIRECTIONS, PERTURBED_MM, sample_field

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
        DIRECTIONS,
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
        stars = np.vstack([DIRECTIONS, [[junk, 0.0, 1.0]]])
        padded = StarField.of(stars, images, 76.0, [True] * 4 + [False])
        mine, plain = METHODS[method](padded).matrix, METHODS[method](sample_field()).matrix
        assert np.abs(mine - plain).max() < within("rae stack element")


@pytest.mark.parametrize("method", METHODS)
def test_the_order_of_the_stars_does_not_matter(method: str) -> None:
    order = [2, 0, 3, 1]
    turned = StarField.of(DIRECTIONS[order], PERTURBED_MM[order], 76.0)
    mine, plain = METHODS[method](turned).matrix, METHODS[method](sample_field()).matrix
    assert np.abs(mine - plain).max() < within("rae rotation")


def test_pair_by_pair_and_all_at_once() -> None:
    field = sample_field()
    pairs = star_pairs(4)
    assert pairs.tolist() == [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]
    for solve in (*PAIR_METHODS.values(), collinearity):
        together = solve(field.select(pairs)).matrix
        for k, index in enumerate(pairs):
            alone = solve(StarField.of(DIRECTIONS[index], PERTURBED_MM[index], 76.0)).matrix
            np.testing.assert_array_equal(together[k], alone)


def test_disagreements_and_outliers_of_a_stack() -> None:
    field = problems()
    total, median = star_disagreement_arcsec(field)
    chosen, start = outliers(field), closed_form(field)
    for i in range(4):
        for j in range(6):
            alone = one(field, i, j)
            for mine, other in zip(
                (total, median, chosen, start),
                (*star_disagreement_arcsec(alone), outliers(alone), closed_form(alone)),
                strict=True,
            ):
                np.testing.assert_array_equal(mine[i, j], other)
