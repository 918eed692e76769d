"""Stars that do not fit the others: a test of each star against the attitude without it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple, get_args

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.findings import VopdError, refuse_other_word
from vopd.geometry.linear import transform
from vopd.stellar.field import Failure, StarField, image_points_mm, refuse_other_field
from vopd.stellar.interstar_angles import (
    interstar_reading_sigma_mm,
    median_disagreement_mm,
    sampled_discrepancies_mm,
    star_pairs,
)
from vopd.stellar.methods.collinearity import collinearity, image_partials
from vopd.stellar.methods.two_star import two_star
from vopd.stellar.solution import StarSolution

OutlierStart = Literal["interstar", "pairs"]  # from which half of the stars the search begins
CHANCE = 1e-3  # chance that good readings have an outlier as large, below which a star is one
MOST_PAIRS, LEAST_PAIRS = 500_000, 200
"""Pairs times stars that are tried at most, and pairs at least; they are chosen evenly."""

LEAST_VARIANCE = 1e-18
"""Variance of an image coordinate, in focal lengths squared, that rounding alone makes."""


class Outlier(NamedTuple):
    """A star that does not fit the others.

    Attributes:
        star: its number, counted from 0
        distance_mm: its image's distance from where the others' attitude puts it, mm
        chance: that the largest error of good readings is as large
    """

    star: int
    distance_mm: float
    chance: float


class AttitudeFit(NamedTuple):
    """The collinearity solution of one field, as far as the tests for outliers need it."""

    # sum of squares of the residuals over their degrees of freedom; infinite where there is no
    # solution
    variance_mm2: float
    freedom: int  # degrees of freedom
    matrix: Floats  # the attitude, (3, 3)

    @property
    def square_mm2(self) -> float:
        """Sum of squares of the residuals, mm squared."""
        return self.variance_mm2 * self.freedom


def fit_attitude(field: StarField) -> AttitudeFit:
    """Solve one problem by the collinearity equations, with statistics of its residuals."""
    (fit,) = fit_attitudes(StarField.stack([field]))
    return fit


def fit_attitudes(field: StarField, solution: StarSolution | None = None) -> list[AttitudeFit]:
    """Solve a stack of problems as `fit_attitude` does.

    Args:
        field: the stack, (p,)
        solution: its collinearity solution, if it is known
    """
    solution = solution or collinearity(field)
    freedom = np.maximum(2 * field.count - 3, 1)
    residuals = field.whitened(solution.residuals_mm(field))
    squares = np.where(field.used[..., None], residuals, 0.0) ** 2
    floor = LEAST_VARIANCE * field.focal_length_mm[:, 0] ** 2
    variance = np.maximum(squares.reshape(len(freedom), -1).sum(axis=1) / freedom, floor)
    failed = solution.failure != Failure.NONE
    variance = np.where(failed, np.inf, variance)
    matrix = np.where(failed[:, None, None], np.nan, solution.matrix)
    return [*map(AttitudeFit, variance.tolist(), freedom.tolist(), matrix)]


def find_outliers(field: StarField, *, start: OutlierStart = "interstar") -> list[Outlier]:
    """Find stars whose images are implausibly far from where the attitude of the others puts them.

    It starts from half of the stars, and adds all that fit their attitude until none
    is left that does. Those that fit are searched once more, as one of the half may have been
    wrong. So several wrong stars cannot hide each other, where fewer than half are.

    Args:
        field: one problem, without a stack axis
        start: from which half: "interstar", those that agree best in their interstar
            angles; "pairs", those nearest to where the attitude of one pair puts
            them, the pair for which the median distance is least

    Returns:
        The outliers, the least likely first; none where there are fewer than
        four stars, of which two agree or disagree with the third alike.

    Raises:
        VopdError: where it is no field, or a stack, or there is no such start

    Source: Rae (1987), recommendation 4 (data editing by pairwise solutions).
    """
    refuse_other_field(field, "find_outliers")
    refuse_other_word(start, get_args(OutlierStart), "start")
    if field.used.ndim > 1:
        raise VopdError("find_outliers takes one problem, not a stack: `problems` has each")
    used = np.flatnonzero(field.used).tolist()
    (found,) = outliers_of_each(StarField.stack([field.select(field.used)]), start)
    return [one._replace(star=used[one.star]) for one in found]


def outliers_of_each(
    field: StarField,
    start: OutlierStart,
    whole: Sequence[AttitudeFit] | None = None,
    discrepancies_mm: Floats | None = None,
) -> list[list[Outlier]]:
    """Find the outliers of each problem of a stack, as `find_outliers` does.

    Args:
        field: the stack, (p,)
        start: from which half
        whole: the solutions with all stars, if they are known
        discrepancies_mm: `sampled_discrepancies_mm`, if they are known
    """
    problems, count = field.used.shape
    found: list[list[Outlier]] = [[] for _ in range(problems)]
    if count < 4:
        return found
    if start == "interstar":
        doubt = median_disagreement_mm(field, discrepancies_mm)
    else:
        doubt = np.stack([_distance_by_pairs(one) for one in field.problems()])
    half = np.argsort(doubt, axis=-1, kind="stable")[:, : max(3, count // 2 + 1)]
    good = np.zeros((problems, count), bool)
    np.put_along_axis(good, half, True, axis=-1)
    lost = np.zeros(problems, bool)
    chance, distance = np.zeros((2, problems, count))
    left = np.arange(problems)
    while left.size:  # the good stars only become more
        fits: dict[int, AttitudeFit] = {}
        numbers = good[left].sum(axis=1)
        for number in set(numbers.tolist()):  # as many good stars together
            rows = left[numbers == number]
            if whole is not None and number == count:
                fits |= {k: whole[k] for k in rows.tolist()}
                continue
            stars = np.nonzero(good[rows])[1].reshape(len(rows), number)
            some = fit_attitudes(field.take(rows).select_each(stars))
            fits |= zip(rows.tolist(), some, strict=True)
        lost[left] = [not np.isfinite(fits[k].variance_mm2) for k in left.tolist()]
        left = left[~lost[left]]
        if not left.size:
            break
        own = [fits[k] for k in left.tolist()]
        chance[left], distance[left] = _chances(field.take(left), good[left], own)
        kept = good[left] | (chance[left] >= CHANCE)
        moved = (kept != good[left]).any(axis=1)
        good[left] = kept
        left = left[moved]
    for k in np.flatnonzero(~lost).tolist():
        again = _again_without(field.take(np.array([k])), good[k], start)
        if again is not None:
            good[k], chance[k], distance[k] = again
        bad = np.flatnonzero(~good[k]).tolist()
        listed = [Outlier(one, float(distance[k, one]), float(chance[k, one])) for one in bad]
        found[k] = sorted(listed, key=lambda outlier: (outlier.chance, -outlier.distance_mm))
    return found


LEAST_LEFT = 4  # stars, by which as many others are known to be wrong


def _again_without(
    field: StarField, good: Bools, start: OutlierStart
) -> tuple[Bools, Floats, Floats] | None:
    """Search the good stars of a problem once more: half of the stars may have had a wrong one.

    Args:
        field: a stack of the problem alone
        good: the stars that fit, (n,)
        start: from which half

    Returns:
        The good stars, chances and distances of all, (n,) each; None if no more are left out, or
        fewer than half of all stars would be left.
    """
    kept, count = np.flatnonzero(good), len(good)
    if len(kept) == count:
        return None
    (more,) = outliers_of_each(field.select_each(kept[None]), start)
    left = np.delete(kept, [one.star for one in more])
    if not more or len(left) < max(LEAST_LEFT, count / 2.0):
        return None
    fits = fit_attitudes(field.select_each(left[None]))
    good = np.isin(np.arange(count), left)
    chance, distance = _chances(field, good[None], fits)
    return good, chance[0], distance[0]


def _distance_by_pairs(field: StarField) -> Floats:
    """Measure each image's distance from where the best pair's attitude puts it, (n,).

    The attitudes are two-star Church solutions; the best has the least median distance.
    """
    count = field.used.shape[-1]
    pairs = star_pairs(count)
    most = max(LEAST_PAIRS, MOST_PAIRS // count)
    if len(pairs) > most:
        pairs = pairs[np.linspace(0, len(pairs) - 1, most).round().astype(int)]
    solution = two_star(field.select(pairs))
    computed = image_points_mm(
        transform(solution.rotation(), field.directions), field.focal_length_mm[0]
    )
    off = np.moveaxis(field.whitened(np.moveaxis(field.image_mm - computed, 0, -1)), -1, 0)
    distance = np.nan_to_num(np.hypot(off[..., 0], off[..., 1]), nan=np.inf)
    return np.asarray(distance[np.argmin(np.median(distance, axis=1))])


def _chances(field: StarField, good: Bools, fits: Sequence[AttitudeFit]) -> tuple[Floats, Floats]:
    """Test each star by the F test: chances of errors as large, and distances in mm, (p, n)."""
    variance, freedom = (
        np.array([fit[k] for fit in fits], dtype=np.float64)[:, None] for k in range(2)
    )
    matrix = np.stack([fit.matrix for fit in fits])
    computed = image_points_mm(transform(matrix, field.directions), field.focal_length_mm)
    off = field.image_mm - computed
    residual = field.whitened(off)
    design = field.whitened(image_partials(computed, field.focal_length_mm))
    rows = np.where(good[..., None, None], design, 0.0).reshape(len(fits), -1, 3)
    spread = np.linalg.pinv(rows.swapaxes(1, 2) @ rows)[:, None]
    spread = np.eye(2) + design @ spread @ design.swapaxes(2, 3)
    solved = np.linalg.solve(spread, residual[..., None])[..., 0]
    ratio = np.nan_to_num((residual * solved).sum(axis=-1), nan=np.inf) / 2.0 / variance
    exceeded = (1.0 + 2.0 * ratio / freedom) ** (-freedom / 2.0)  # F with 2 and freedom
    chance = np.minimum(1.0, residual.shape[1] * exceeded)
    return np.asarray(chance), np.hypot(off[..., 0], off[..., 1])


# Photographs together


class FittedStars(NamedTuple):
    """One problem with its collinearity solution."""

    fit: AttitudeFit  # the statistics of its residuals
    solution: StarSolution  # the solution, a stack of one
    interstar_mm: float  # reading sigma by the interstar angles, mm; NaN if unknown
    outliers: list[Outlier]  # the stars that do not fit the others


def fit_together(
    fields: Sequence[StarField], start: OutlierStart = "interstar"
) -> list[FittedStars]:
    """Solve problems, those of as many stars together: of 30 stars five times as fast as alone.

    Args:
        fields: problems of two stars or more, without a stack axis
        start: from which half of the stars the search for outliers begins
    """
    found: dict[int, FittedStars] = {}
    for indices, field in StarField.stacks(fields):
        solution = collinearity(field)
        fits = fit_attitudes(field, solution)
        off = sampled_discrepancies_mm(field)
        sigmas = interstar_reading_sigma_mm(field, off).tolist()
        outliers = outliers_of_each(field, start, fits, off)
        each = [solution.problem(k) for k in range(len(indices))]
        found |= zip(indices, map(FittedStars, fits, each, sigmas, outliers), strict=True)
    return [found[k] for k in range(len(fields))]
