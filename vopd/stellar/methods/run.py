"""Solutions of one star field by methods given by name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import repeat
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vopd.arrays import Floats, Ints
from vopd.geometry.linear import ARCSEC_PER_RADIAN, covariance_factor_95
from vopd.stellar import uncertainty
from vopd.stellar.angles import alpha_delta_swing_deg, omega_phi_kappa_deg, orthogonality_defect
from vopd.stellar.field import Failure, StarField, right_ascension_declination_deg
from vopd.stellar.interstar_angles import interstar_reading_sigma_mm, star_disagreement_arcsec
from vopd.stellar.methods.church import ChurchWeights, church
from vopd.stellar.methods.collinearity import StartRule, collinearity
from vopd.stellar.methods.single_rotation import AngleRule, single_rotation
from vopd.stellar.methods.two_star import two_star
from vopd.stellar.methods.wahba import wahba
from vopd.stellar.methods.weights import WeightRule
from vopd.stellar.outlier_search import FittedStars, fit_attitude
from vopd.stellar.solution import RotationChoice, StarSolution
from vopd.stellar.uncertainty import LARGEST_SIGMA_DEG, angle_sigmas_rad, boresight_region

# One solution as plain values

REDUCED_WEIGHT = 0.5  # robust weight below which a star does not count in the rms and is marked
ANGLE_NAMES = ("omega_deg", "phi_deg", "kappa_deg", "alpha_deg", "delta_deg", "swing_deg")
ANGLE_SIGMA_NAMES = tuple(f"sigma_{name}" for name in ANGLE_NAMES)

IN_IMAGE_UNITS = ("residuals", "rms", "reading_sigma", "weighted_rms", "images")
"""Quantities with the unit of the image coordinates."""


@dataclass(frozen=True)
class SolvedStars:
    """One solution; quantities that a method does not give are None."""

    method: str  # its name
    stars: tuple[int, ...]  # the stars solved, counted from 1
    failure: Failure  # why there is no solution, or `Failure.NONE`
    angles_deg: list[float]  # omega, phi, kappa, alpha, delta, swing
    matrix: list[list[float]]  # the rotation shown, or the matrix as solved if that was chosen
    orthogonality_defect: float  # of the matrix as solved
    residuals: list[list[float]]  # observed minus computed x and y of each star, image units
    iterations: int  # corrections made
    converged: bool  # whether no further correction would change the solution
    # root mean square of the residuals' coordinates; with robust weights without the stars whose
    # weight is below REDUCED_WEIGHT, if that is not so of all
    rms: float
    # standard deviation of an image coordinate, image units, given or estimated; and the degrees
    # of freedom of that estimate, None where it is given
    reading_sigma: float | None = None
    reading_freedom: int | None = None
    # standard deviations about the camera's x, y, z, and their covariance, (3, 3); its ellipsoid
    # times the factor contains the true attitude with 95 percent
    rotation_sigma_arcsec: list[float] | None = None
    rotation_covariance_arcsec2: list[list[float]] | None = None
    covariance_factor_95: float | None = None
    angle_sigmas_deg: list[float] | None = None  # of `angles_deg`
    # semi-axes of the ellipse that holds the optical axis with a probability of 95 percent, the
    # longer one first, and the direction of that, from north toward increasing right ascension
    boresight_95_arcsec: list[float] | None = None
    boresight_95_angle_deg: float | None = None
    # root mean square of the residuals' coordinates over their standard deviations, times the
    # reading sigma, image units; None where all weigh alike
    weighted_rms: float | None = None
    axis: list[float] | None = None  # of a single rotation, and so the next four
    axis_ra_deg: float | None = None
    axis_dec_deg: float | None = None
    angle_deg: float | None = None
    conditioning: float | None = None
    interstar_discrepancy_arcsec: float | None = None  # of a pair
    weights: list[list[float]] | None = None  # of the residuals, if not uniform
    disagreement_arcsec: list[float] | None = None  # of each star with all others, of all pairs
    # position of the camera, where it is solved, and its standard deviations along the axes of
    # the ground points
    camera_m: list[float] | None = None
    camera_sigma_m: list[float] | None = None
    sky: dict[str, float] | None = None  # where the optical axis points, by the names of columns
    # focal, centre_x, centre_y and k1 that were solved with the attitude, in image units and the
    # file's coordinates, and standard deviations
    camera: dict[str, float] | None = None
    camera_sigmas: dict[str, float] | None = None
    images: list[list[float]] | None = None  # x, y from the principal point, y up, image units
    # of each point that was asked for its x, y, and angles and standard deviations by the names of
    # columns
    points: list[dict[str, float]] | None = None

    def without_uncertainty(self) -> SolvedStars:
        """Remove the statement of uncertainty."""
        return replace(
            self,
            rotation_sigma_arcsec=None,
            rotation_covariance_arcsec2=None,
            covariance_factor_95=None,
            angle_sigmas_deg=None,
            boresight_95_arcsec=None,
            boresight_95_angle_deg=None,
        )

    @property
    def rotation_rms_arcsec(self) -> float | None:
        """Root mean square of the whole attitude error, the angle of its rotation."""
        if self.rotation_sigma_arcsec is None:
            return None
        return float(np.linalg.norm(self.rotation_sigma_arcsec))

    def as_dict(self, unit: str = "mm") -> dict[str, Any]:
        """Convert the solution to a dictionary with the names of JSON and CSV, without None."""
        values = {
            f"{name}_{unit}" if name in IN_IMAGE_UNITS else name: value
            for name, value in vars(self).items()
            if value is not None
        }
        del values["failure"]
        angles = dict(zip(ANGLE_NAMES, values.pop("angles_deg"), strict=True))
        sigmas = values.pop("angle_sigmas_deg", None)
        if sigmas is not None:
            values |= dict(zip(ANGLE_SIGMA_NAMES, sigmas, strict=True))
        for prefix, found in (("", "camera"), ("sigma_", "camera_sigmas")):
            for name, value in (values.pop(found, None) or {}).items():
                values[f"{prefix}{name}" + ("" if name == "k1" else f"_{unit}")] = value
        values |= values.pop("sky", None) or {}
        head = {"method": values.pop("method"), "stars": list(values.pop("stars"))}
        return {**head, **angles, **values}


# Stacks of solutions split into single ones


def split_solutions(
    method: str,
    solution: StarSolution,
    problems: StarField,
    subsets: Ints,
    covariance: Floats,
    *,
    sigma: float | Floats,
    freedom: int | None,
    least_sigma: float | Floats,
    choice: RotationChoice = "nearest",
    disagreement_arcsec: Floats | None = None,
    robust: bool = False,
) -> list[SolvedStars]:
    """Split a stack of solutions into single ones, and reject those that are too uncertain.

    Args:
        method: the method's name
        solution: solutions of p problems
        problems: the problems
        subsets: the stars of each problem, counted from 0, (p, k)
        covariance: of each solution about the camera's axes, (p, 3, 3), radians squared,
            for readings good to 1 image unit
        sigma: standard deviation of an image coordinate, image units, one for all problems
            or (p,); NaN if unknown
        freedom: degrees of freedom of its estimate; None where it is given
        least_sigma: the smallest value that it may have, likewise: with it a solution is refused as
            too uncertain, so that a wrong star cannot be the reason
        choice: which rotation is shown
        disagreement_arcsec: of each star with all others, (n,)
        robust: whether the weights are robust ones, so that a small one marks a bad star

    Returns:
        One for each problem.
    """
    as_solved = choice == "as-solved"
    matrix = solution.matrix if as_solved else solution.rotation()
    angles = np.concatenate([omega_phi_kappa_deg(matrix), alpha_delta_swing_deg(matrix)], axis=-1)
    defect = orthogonality_defect(solution.matrix)
    residuals = solution.residuals_mm(problems, choice)
    counts = np.ones(residuals.shape)
    if robust and solution.weights is not None:
        counts = np.where(solution.weights < REDUCED_WEIGHT, 0.0, counts)
        counts[~counts.any(axis=(1, 2))] = 1.0  # where none counts fully, all count
    with np.errstate(invalid="ignore"):
        whitened = problems.whitened(residuals)
        weights = np.ones(residuals.shape) if solution.weights is None else solution.weights
        weighted = np.sqrt((weights * whitened**2).sum(axis=(1, 2)) / weights.sum(axis=(1, 2)))
        rms = np.sqrt((counts * residuals**2).sum(axis=(1, 2)) / counts.sum(axis=(1, 2)))
        unit_sigmas = np.sqrt(np.diagonal(covariance, axis1=-2, axis2=-1)) * ARCSEC_PER_RADIAN
    ra_deg = dec_deg = None
    if solution.axis is not None:
        ra_deg, dec_deg = right_ascension_declination_deg(solution.axis)
    too_uncertain = unit_sigmas.max(axis=-1) * least_sigma > LARGEST_SIGMA_DEG * 3600.0
    sigma = np.broadcast_to(np.asarray(sigma, dtype=np.float64), (len(subsets),))
    sigmas = unit_sigmas * sigma[:, None]
    stated = np.asarray(np.isfinite(sigmas).all(axis=-1) & (not as_solved))
    spread = covariance * sigma[:, None, None] ** 2
    angle_sigmas = np.degrees(angle_sigmas_rad(solution.rotation(), spread))
    semi_axes, longer = boresight_region(solution.rotation(), spread, freedom)
    factor = _factor_95(freedom)
    alike = problems.errors is None and solution.weights is None
    columns: dict[str, NDArray[Any] | None] = {
        "stars": subsets + 1,
        "angles_deg": angles,
        "matrix": matrix,
        "orthogonality_defect": defect,
        "residuals": residuals,
        "rms": rms,
        "iterations": solution.iterations,
        "converged": solution.converged,
        "reading_sigma": sigma,
        "weighted_rms": None if alike else weighted,
        "axis": solution.axis,
        "axis_ra_deg": ra_deg,
        "axis_dec_deg": dec_deg,
        "angle_deg": solution.angle_deg,
        "conditioning": solution.conditioning,
        "interstar_discrepancy_arcsec": solution.interstar_discrepancy_arcsec,
        "weights": solution.weights,
        "images": problems.image_mm,
        "disagreement_arcsec": None
        if disagreement_arcsec is None
        else disagreement_arcsec[subsets],
    }
    uncertain: dict[str, NDArray[Any] | None] = {
        "rotation_sigma_arcsec": sigmas,
        "rotation_covariance_arcsec2": spread * ARCSEC_PER_RADIAN**2,
        "angle_sigmas_deg": angle_sigmas,
        "boresight_95_arcsec": semi_axes * ARCSEC_PER_RADIAN,
        "boresight_95_angle_deg": np.degrees(longer),
    }
    failures = np.where(
        (solution.failure == Failure.NONE) & too_uncertain, Failure.TOO_UNCERTAIN, solution.failure
    )
    known = stated & (failures != Failure.NO_CONVERGENCE)
    found = []
    for failure, certain, one, more in zip(
        failures.tolist(), known.tolist(), _rows(columns), _rows(uncertain), strict=True
    ):
        one["stars"] = tuple(one["stars"])
        if not np.isfinite(one["reading_sigma"]):
            one["reading_sigma"] = None
        if certain:
            one |= more | {"covariance_factor_95": factor}
        found.append(
            SolvedStars(method=method, failure=Failure(failure), reading_freedom=freedom, **one)
        )
    return found


def _rows(columns: Mapping[str, NDArray[Any] | None]) -> Iterator[dict[str, Any]]:
    """Iterate over the rows of columns as plain values, without the columns that are None."""
    known = {name: values.tolist() for name, values in columns.items() if values is not None}
    for row in zip(*known.values(), strict=True):
        yield dict(zip(known, row, strict=True))


@lru_cache
def _factor_95(freedom: int | None) -> float:
    return float(covariance_factor_95(np.asarray(np.inf if freedom is None else float(freedom))))


def single_solution(
    method: str,
    matrix: Floats,
    iterations: int,
    stars: StarField,
    used: Ints,
    covariance: Floats,
    sigma: float,
    freedom: int | None,
) -> SolvedStars:
    """Describe the solution of one problem that a method has solved with its camera.

    Args:
        method: the method's name
        matrix: orientation matrix, (3, 3)
        iterations: corrections made
        stars: the problem, with the camera as it was found
        used: the stars that were solved, counted from 0
        covariance: about the camera's axes, (3, 3), for readings good to 1 image unit
        sigma: standard deviation of an image coordinate, image units
        freedom: degrees of freedom of its estimate; None where it is given
    """
    solution = StarSolution(
        matrix[None], np.array([Failure.NONE]), np.array([iterations]), np.array([True])
    )
    (solved,) = split_solutions(
        method, solution, stars.select(used[None]), used[None], covariance[None],
        sigma=sigma, freedom=freedom, least_sigma=sigma,
    )  # fmt: skip
    return solved


# All stars, a pair, or all pairs, by methods given by name

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

ONLY_PAIRS = ("two-star", "single-rotation")  # methods that solve two stars and no more
LISTED_PAIR = np.array([[0, 1]])
"""The pair that programs TESTU and TWOSTAR solve, and so the default of these methods."""


@dataclass(frozen=True)
class StarOptions:
    """Options of the solution."""

    # omega, phi, kappa where collinearity starts; None: see `start`
    initial_deg: tuple[float, ...] | None = None
    start: StartRule = "svd"  # where collinearity starts without `initial_deg`
    weights: WeightRule = "uniform"  # of collinearity's residuals
    corrections: int | None = None  # exactly this many; None: to convergence
    # standard deviation of an image coordinate, mm; None: estimated from the residuals where an
    # uncertainty is stated
    reading_sigma_mm: float | None = None
    unit_cross_products: bool = True  # whether the two-star method's third star is a unit vector
    rotation_angle: AngleRule = "farther"  # from which star the single rotation takes its angle
    rotation: RotationChoice = "nearest"  # which rotation a matrix that is not quite one stands for


def solve_by_methods(
    stars: StarField,
    methods: Sequence[str],
    pairs: Ints | None = None,
    options: StarOptions | None = None,
    subset: Ints | None = None,
    fitted: FittedStars | None = None,
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
        fitted: all stars with their collinearity solution, if it is known

    Returns:
        The solutions, those that failed among them.
    """
    options = options or StarOptions()
    if pairs is None:
        everyone = np.arange(stars.used.shape[-1]) if subset is None else subset
        (solved,) = solve_alike([stars], methods, everyone[None], options, [fitted])
        return solved
    sigmas = _reading_sigma(stars, options, fitted)
    disagreement = star_disagreement_arcsec(stars)[0] if len(pairs) > 1 else None
    found = []
    for method in methods:
        if method in PAIR_METHODS:
            problems = stars.select(pairs)
            solution = _solution(method, problems, options)
            found += _split(method, problems, solution, pairs, options, sigmas, disagreement)
    return found


def solve_alike(
    fields: Sequence[StarField],
    methods: Sequence[str],
    subsets: Ints,
    options: StarOptions,
    fitted: Sequence[FittedStars | None],
) -> list[list[SolvedStars]]:
    """Solve star fields of as many stars together: thirty stars ten times as fast as alone.

    Args:
        fields: problems without a stack axis, which all state errors, or none does
        methods: names of METHODS
        subsets: the stars to use of each problem, counted from 0, (p, k)
        options: how to solve
        fitted: all stars of each with their collinearity solution, if it is known

    Returns:
        The solutions of each field by all methods, those that failed among them.
    """
    whole = [len(used) == one.used.shape[-1] for one, used in zip(fields, subsets, strict=True)]
    fitted = [one if all_used else None for one, all_used in zip(fitted, whole, strict=True)]
    chosen = [one.select(used) for one, used in zip(fields, subsets, strict=True)]
    sigmas = [_reading_sigma(*one) for one in zip(chosen, repeat(options), fitted)]
    sigma, freedoms, least = zip(*sigmas, strict=True)
    stack = StarField.stack(chosen)
    known = [one.solution for one in fitted if one is not None]
    usual = (options.initial_deg, options.start, options.weights, options.corrections)
    by_default = usual == (None, "svd", "uniform", None) and len(known) == len(fields)
    found: list[list[SolvedStars]] = [[] for _ in fields]
    for method in methods:
        problems, numbers = stack, subsets
        if method in ONLY_PAIRS:
            problems, numbers = stack.select(LISTED_PAIR[0]), subsets[:, LISTED_PAIR[0]]
        if by_default and method == "collinearity":
            solution = StarSolution.join(known)
        else:
            solution = _solution(method, problems, options)
        given = np.array(sigma), freedoms[0], np.array(least)
        split = _split(method, problems, solution, numbers, options, given)
        for one, each in zip(found, split, strict=True):
            one.append(each)
    return found


def _split(
    method: str,
    problems: StarField,
    solution: StarSolution,
    subsets: Ints,
    options: StarOptions,
    sigmas: tuple[float | Floats, int | None, float | Floats],
    disagreement_arcsec: Floats | None = None,
) -> list[SolvedStars]:
    """Split a stack of solutions with their uncertainty; `sigmas` as of `_reading_sigma`."""
    sigma, freedom, least = sigmas
    return split_solutions(
        method,
        solution,
        problems,
        subsets,
        _covariance(method, problems, solution, options),
        sigma=sigma,
        freedom=freedom,
        least_sigma=least,
        choice=options.rotation,
        disagreement_arcsec=disagreement_arcsec,
        robust=options.weights == "robust",
    )


def _reading_sigma(
    stars: StarField, options: StarOptions, fitted: FittedStars | None
) -> tuple[float, int | None, float]:
    """Choose the reading sigma: as given, or from the residuals of all stars.

    With robust weights, where wrong stars are expected among the residuals, it is
    taken from the interstar angles.

    Returns:
        The sigma, its degrees of freedom (None where it is given), and the smallest value
        that it may have.
    """
    if options.reading_sigma_mm is not None:
        return options.reading_sigma_mm, None, options.reading_sigma_mm
    if int(stars.count) < 3:
        return np.nan, None, np.nan
    interstar = fitted.interstar_mm if fitted else float(interstar_reading_sigma_mm(stars))
    fit = fitted.fit if fitted else fit_attitude(stars)
    by_residuals = float(np.sqrt(fit.variance_mm2))
    robust = options.weights == "robust" or not np.isfinite(by_residuals)
    sigma = interstar if robust else by_residuals
    return sigma, fit.freedom, min(interstar, sigma)


def _solution(method: str, stars: StarField, options: StarOptions) -> StarSolution:
    """Solve the problems by one method."""
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
    """Estimate each solution's covariance about the camera's axes, for readings good to 1 mm."""
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
    """Test whether a failure leaves no attitude to show; one without convergence is shown."""
    return failure not in (Failure.NONE, Failure.NO_CONVERGENCE)
