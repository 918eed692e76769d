"""Solve one star field by methods given by name: from all stars, from a pair, or from all pairs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.stellar import uncertainty
from vopd.stellar.failures import Failure
from vopd.stellar.field import StarField
from vopd.stellar.interstar_angles import interstar_reading_sigma_mm, star_disagreement_arcsec
from vopd.stellar.methods.church import ChurchWeights, church
from vopd.stellar.methods.collinearity import StartRule, collinearity
from vopd.stellar.methods.single_rotation import AngleRule, single_rotation
from vopd.stellar.methods.solved_stars import SolvedStars
from vopd.stellar.methods.split_solutions import ReadingScale, split_solutions
from vopd.stellar.methods.two_star import two_star
from vopd.stellar.methods.wahba import wahba
from vopd.stellar.methods.weights import WeightRule
from vopd.stellar.outlier_search import fit_attitude
from vopd.stellar.solution import RotationChoice, StarSolution

METHODS = (
    "collinearity",
    "church",
    "church-weighted",
    "church-weighted-r",
    "two-star",
    "single-rotation",
    "svd",
)
PAIR_METHODS = ("collinearity", "two-star", "single-rotation", "svd")
"""Methods that can solve two stars."""

CHURCH_WEIGHTS: dict[str, ChurchWeights] = {
    "church": "uniform",
    "church-weighted": "formula",
    "church-weighted-r": "formula-r",
}
"""The weights of each Church method."""

ONLY_PAIRS = ("two-star", "single-rotation")
"""Methods that solve two stars and no more."""

LISTED_PAIR = np.array([[0, 1]])
"""The pair that programs TESTU and TWOSTAR solve, and so the default of these methods."""


@dataclass(frozen=True)
class StarOptions:
    """Options of the solution.

    Attributes:
        initial_deg: omega, phi, kappa where collinearity starts; None: see `start`
        start: where collinearity starts without `initial_deg`
        weights: of collinearity's residuals
        corrections: exactly this many; None: to convergence
        reading_sigma_mm: standard deviation of an image coordinate, mm; None: estimated
            from the residuals where an uncertainty is stated
        unit_cross_products: whether the two-star method's third star is a unit vector
        rotation_angle: from which star the single rotation takes its angle
        rotation: which rotation a matrix that is not quite one stands for
    """

    initial_deg: tuple[float, ...] | None = None
    start: StartRule = "svd"
    weights: WeightRule = "uniform"
    corrections: int | None = None
    reading_sigma_mm: float | None = None
    unit_cross_products: bool = True
    rotation_angle: AngleRule = "farther"
    rotation: RotationChoice = "nearest"


def solve_by_methods(
    stars: StarField,
    methods: Sequence[str],
    pairs: Ints | None = None,
    options: StarOptions | None = None,
    subset: Ints | None = None,
) -> list[SolvedStars]:
    """Solve one star field by several methods.

    Args:
        stars: one problem, without a stack axis
        methods: names of METHODS
        pairs: solve these pairs of stars, counted from 0, (p, 2), by the methods
            that can; the others are left out. None: all stars at once, and stars
            1 and 2 by the methods for two, as their programs do
        options: how to solve
        subset: without `pairs`, use only these stars, counted from 0

    Returns:
        The solutions, those that failed among them.
    """
    options = options or StarOptions()
    everyone = np.arange(stars.used.shape[-1]) if subset is None else subset
    reading = _reading_scale(stars.only(everyone), options)
    disagreement = None
    if pairs is not None and len(pairs) > 1:
        disagreement = star_disagreement_arcsec(stars).total_arcsec
    solved = []
    for method in methods:
        if pairs is None and method not in ONLY_PAIRS:
            subsets = everyone[None, :]
        elif method in PAIR_METHODS:
            subsets = everyone[LISTED_PAIR] if pairs is None else pairs
        else:
            continue
        problems = stars.select(subsets)
        solution = _solution(method, problems, options)
        covariance = _covariance(method, problems, solution, options)
        solved += split_solutions(
            method,
            solution,
            problems,
            subsets,
            options.rotation,
            reading,
            covariance,
            disagreement,
            robust=options.weights == "robust",
        )
    return solved


def _reading_scale(stars: StarField, options: StarOptions) -> ReadingScale:
    """The reading sigma: as given, or from the residuals of all stars.

    With robust weights, where wrong stars are expected among the residuals, it is
    taken from the interstar angles.
    """
    if options.reading_sigma_mm is not None:
        return ReadingScale(options.reading_sigma_mm, None, options.reading_sigma_mm)
    interstar = interstar_reading_sigma_mm(stars)
    if int(stars.count) < 3:
        return ReadingScale(np.nan, None, np.nan)
    fit = fit_attitude(stars)
    by_residuals = float(np.sqrt(fit.variance_mm2))
    robust = options.weights == "robust" or not np.isfinite(by_residuals)
    sigma = interstar if robust else by_residuals
    return ReadingScale(sigma, fit.freedom, min(interstar, sigma))


def _solution(method: str, stars: StarField, options: StarOptions) -> StarSolution:
    """The problems solved by one method."""
    if method == "collinearity":
        return collinearity(
            stars,
            initial_deg=options.initial_deg,
            start=options.start,
            weights=options.weights,
            corrections=options.corrections,
            reading_sigma_mm=options.reading_sigma_mm,
        )
    if method in ONLY_PAIRS:
        return _solve_pair(method, stars, options)
    if method == "svd":
        return wahba(stars)
    return church(stars, weights=CHURCH_WEIGHTS[method], reading_sigma_mm=options.reading_sigma_mm)


def _solve_pair(method: str, stars: StarField, options: StarOptions) -> StarSolution:
    if method == "two-star":
        return two_star(stars, unit_cross_products=options.unit_cross_products)
    return single_rotation(stars, angle=options.rotation_angle)


def _covariance(
    method: str, stars: StarField, solution: StarSolution, options: StarOptions
) -> Floats:
    """Covariance of each solution about the camera's axes, for readings good to 1 mm."""
    rotation = solution.rotation()
    if method == "collinearity":
        return uncertainty.collinearity_covariance(stars, rotation, solution.weights)
    if method == "svd":
        return uncertainty.wahba_covariance(stars)
    if method in ONLY_PAIRS:
        return uncertainty.pair_covariance(
            stars, rotation, lambda pair: _solve_pair(method, pair, options)
        )
    return uncertainty.church_covariance(
        stars, rotation, weights=CHURCH_WEIGHTS[method], reading_sigma_mm=options.reading_sigma_mm
    )


def refused(failure: Failure) -> bool:
    """Whether a failure leaves no attitude to show; if it only did not converge, it is shown."""
    return failure not in (Failure.NONE, Failure.NO_CONVERGENCE)
