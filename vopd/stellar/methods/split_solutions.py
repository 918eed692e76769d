"""Split a stack of solutions into single ones, with residuals and uncertainty as plain values."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.geometry.vectors import ARCSEC_PER_RADIAN
from vopd.stellar.angle_uncertainty import angle_sigmas_rad, boresight_region
from vopd.stellar.angles import alpha_delta_swing_deg, omega_phi_kappa_deg, orthogonality_defect
from vopd.stellar.directions import right_ascension_declination_deg
from vopd.stellar.failures import Failure
from vopd.stellar.field import StarField
from vopd.stellar.methods.solved_stars import REDUCED_WEIGHT, SolvedStars
from vopd.stellar.solution import RotationChoice, StarSolution
from vopd.stellar.uncertainty import LARGEST_SIGMA_DEG


class ReadingScale(NamedTuple):
    """The standard deviation of an image coordinate, and how it is known.

    Attributes:
        sigma: image units; NaN if unknown
        freedom: degrees of freedom of the estimate; None where it is given
        least: the smallest value that it may have: with it a solution is refused as
            too uncertain, so that a wrong star cannot be the reason
    """

    sigma: float
    freedom: int | None
    least: float


def split_solutions(
    method: str,
    solution: StarSolution,
    problems: StarField,
    subsets: Ints,
    choice: RotationChoice,
    reading: ReadingScale,
    covariance: Floats,
    disagreement_arcsec: Floats | None,
    *,
    robust: bool,
) -> list[SolvedStars]:
    """Split a stack of solutions into single ones, and reject those that are too uncertain.

    Args:
        method: the method's name
        solution: solutions of p problems
        problems: the problems
        subsets: the stars of each problem, counted from 0, (p, k)
        choice: which rotation is shown
        reading: standard deviation of an image coordinate
        covariance: of each solution about the camera's axes, (p, 3, 3), radians squared,
            for readings good to 1 image unit
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
    with np.errstate(invalid="ignore"):
        whitened = problems.whitened(residuals)
        weights = np.ones(residuals.shape) if solution.weights is None else solution.weights
        weighted = np.sqrt((weights * whitened**2).sum(axis=(1, 2)) / weights.sum(axis=(1, 2)))
        rms = np.sqrt((counts * residuals**2).sum(axis=(1, 2)) / counts.sum(axis=(1, 2)))
        unit_sigmas = np.sqrt(np.diagonal(covariance, axis1=-2, axis2=-1)) * ARCSEC_PER_RADIAN
    ra_deg = dec_deg = None
    if solution.axis is not None:
        ra_deg, dec_deg = right_ascension_declination_deg(solution.axis)
    too_uncertain = unit_sigmas.max(axis=-1) * reading.least > LARGEST_SIGMA_DEG * 3600.0
    sigmas = unit_sigmas * reading.sigma
    stated = np.asarray(np.isfinite(sigmas).all(axis=-1) & (not as_solved))
    spread = covariance * reading.sigma**2
    angle_sigmas = np.degrees(angle_sigmas_rad(solution.rotation(), spread))
    region = boresight_region(solution.rotation(), spread, reading.freedom)
    alike = problems.errors is None and solution.weights is None
    found = []
    for k, stars in enumerate(subsets):
        failure = Failure(int(solution.failure[k]))
        if failure == Failure.NONE and too_uncertain[k]:
            failure = Failure.TOO_UNCERTAIN
        one = SolvedStars(
            method=method,
            stars=tuple((stars + 1).tolist()),
            failure=failure,
            angles_deg=angles[k].tolist(),
            matrix=matrix[k].tolist(),
            orthogonality_defect=float(defect[k]),
            residuals=residuals[k].tolist(),
            rms=float(rms[k]),
            iterations=int(solution.iterations[k]),
            converged=bool(solution.converged[k]),
            reading_sigma=reading.sigma if np.isfinite(reading.sigma) else None,
            reading_freedom=reading.freedom,
            rotation_sigma_arcsec=sigmas[k].tolist(),
            rotation_covariance_arcsec2=(spread[k] * ARCSEC_PER_RADIAN**2).tolist(),
            angle_sigmas_deg=angle_sigmas[k].tolist(),
            boresight_95_arcsec=(region.semi_axes[k] * ARCSEC_PER_RADIAN).tolist(),
            boresight_95_angle_deg=float(np.degrees(region.angle_rad[k])),
            weighted_rms=None if alike else float(weighted[k]),
            axis=_element(solution.axis, k),
            axis_ra_deg=_element(ra_deg, k),
            axis_dec_deg=_element(dec_deg, k),
            angle_deg=_element(solution.angle_deg, k),
            conditioning=_element(solution.conditioning, k),
            interstar_discrepancy_arcsec=_element(solution.interstar_discrepancy_arcsec, k),
            weights=_element(solution.weights, k),
            images=problems.image_mm[k].tolist(),
            disagreement_arcsec=None
            if disagreement_arcsec is None
            else disagreement_arcsec[stars].tolist(),
        )
        known = stated[k] and failure != Failure.NO_CONVERGENCE
        found.append(one if known else one.without_uncertainty())
    return found


def _element(values: Floats | None, k: int) -> Any:
    """One problem's value or list of values, None where the method has none."""
    return None if values is None else values[k].tolist()
