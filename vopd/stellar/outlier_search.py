"""Stars that do not fit the others: a test of each star against the attitude without it."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.geometry.linear import transform
from vopd.stellar.field import Failure, StarField, image_points_mm
from vopd.stellar.interstar_angles import median_disagreement_mm, star_pairs
from vopd.stellar.methods.collinearity import collinearity, image_partials
from vopd.stellar.methods.two_star import two_star

OutlierStart = Literal["interstar", "pairs"]
"""From which half of the stars the search begins."""

CHANCE = 1e-3
"""Chance that good readings have an outlier as large, below which a star is one."""

MOST_PAIRS, LEAST_PAIRS = 500_000, 200
"""Pairs times stars that are tried at most, and pairs at least; they are chosen evenly."""

ROUNDS = 20
"""How often the set of good stars is solved again at most."""

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
    """The collinearity solution of one field, as far as the tests for outliers need it.

    Attributes:
        variance_mm2: sum of squares of the residuals over their degrees of freedom;
            infinite where there is no solution
        freedom: degrees of freedom
        matrix: the attitude, (3, 3)
    """

    variance_mm2: float
    freedom: int
    matrix: Floats


def fit_attitude(field: StarField) -> AttitudeFit:
    """Solve one problem by the collinearity equations, with statistics of its residuals."""
    solution = collinearity(field)
    freedom = max(2 * int(field.count) - 3, 1)
    if solution.failure != Failure.NONE:
        return AttitudeFit(np.inf, freedom, np.full((3, 3), np.nan))
    residuals = field.whitened(solution.residuals_mm(field))
    squares = np.where(field.used[..., None], residuals, 0.0) ** 2
    floor = LEAST_VARIANCE * float(field.focal_length_mm[0]) ** 2
    return AttitudeFit(max(float(squares.sum()) / freedom, floor), freedom, solution.matrix)


def find_outliers(field: StarField, *, start: OutlierStart = "interstar") -> list[Outlier]:
    """Find stars whose images are implausibly far from where the attitude of the others puts them.

    It starts from half of the stars, and adds all that fit their attitude until none
    is left that does. So several wrong stars cannot hide each other, up to half of them.

    Args:
        field: one problem, without a stack axis
        start: from which half: "interstar", those that agree best in their interstar
            angles; "pairs", those nearest to where the attitude of one pair puts
            them, the pair for which the median distance is least

    Returns:
        The outliers, the least likely first; none where there are fewer than
        four stars, of which two agree or disagree with the third alike.

    Source: Rae (1987), recommendation 4 (data editing by pairwise solutions).
    """
    count = field.used.shape[-1]
    if count < 4:
        return []
    doubt = median_disagreement_mm(field) if start == "interstar" else _distance_by_pairs(field)
    order = np.argsort(doubt, kind="stable")
    good = np.zeros(count, bool)
    good[order[: max(3, count // 2 + 1)]] = True
    for _ in range(ROUNDS):
        fit = fit_attitude(field.select(good))
        if not np.isfinite(fit.variance_mm2):
            return []
        chance, distance = _chances(field, good, fit)
        kept = good | (chance >= CHANCE)
        if (kept == good).all():
            break
        good = kept
    bad = np.flatnonzero(~good)
    found = [Outlier(int(k), float(distance[k]), float(chance[k])) for k in bad]
    return sorted(found, key=lambda outlier: (outlier.chance, -outlier.distance_mm))


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


def _chances(field: StarField, good: Bools, fit: AttitudeFit) -> tuple[Floats, Floats]:
    """Test each star by the F test: the chance of an error as large, and its distance in mm."""
    computed = image_points_mm(transform(fit.matrix, field.directions), field.focal_length_mm)
    off = field.image_mm - computed
    residual = field.whitened(off)
    design = field.whitened(image_partials(computed, field.focal_length_mm))
    normal = np.einsum("nak,nal->kl", design[good], design[good])
    spread = np.eye(2) + np.einsum("nak,kl,nbl->nab", design, np.linalg.pinv(normal), design)
    size = np.einsum("na,na->n", residual, np.linalg.solve(spread, residual[..., None])[..., 0])
    ratio = np.nan_to_num(size, nan=np.inf) / 2.0 / fit.variance_mm2
    exceeded = (1.0 + 2.0 * ratio / fit.freedom) ** (-fit.freedom / 2.0)  # F with 2 and freedom
    chance = np.minimum(1.0, len(residual) * exceeded)
    return np.asarray(chance), np.hypot(off[:, 0], off[:, 1])
