"""One solution of one set of stars, as plain values for output."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.geometry.vectors import ARCSEC_PER_RADIAN
from vopd.stellar.directions import right_ascension_declination_deg
from vopd.stellar.failures import Failure
from vopd.stellar.orientation_angles import (
    alpha_delta_swing_deg,
    omega_phi_kappa_deg,
    orthogonality_defect,
)
from vopd.stellar.rotation_uncertainty import LARGEST_SIGMA_DEG
from vopd.stellar.star_field import StarField
from vopd.stellar.star_solution import RotationChoice, StarSolution

REDUCED_WEIGHT = 0.5
"""Robust weight below which a star does not count in the rms and is marked."""

ANGLE_NAMES = ("omega_deg", "phi_deg", "kappa_deg", "alpha_deg", "delta_deg", "swing_deg")

IN_IMAGE_UNITS = ("residuals", "rms", "reading_sigma")
"""Quantities with the unit of the image coordinates."""


@dataclass(frozen=True)
class SolvedStars:
    """One solution; quantities that a method does not give are None.

    Attributes:
        method: its name
        stars: the stars solved, counted from 1
        failure: why there is no solution, or `Failure.NONE`
        angles_deg: omega, phi, kappa, alpha, delta, swing
        matrix: the rotation shown, or the matrix as solved if that was chosen
        orthogonality_defect: of the matrix as solved
        residuals: observed minus computed x and y of each star, image units
        iterations: corrections made
        converged: whether no further correction would change the solution
        rms: root mean square of the residuals' coordinates; with robust weights
            without the stars whose weight is below REDUCED_WEIGHT
        reading_sigma: standard deviation of an image coordinate, image units, given or estimated
        rotation_sigma_arcsec: standard deviations about the camera's x, y, z
        axis, axis_ra_deg, axis_dec_deg, angle_deg, conditioning: of a single rotation
        interstar_discrepancy_arcsec: of a pair
        weights: of the residuals, if not uniform
        disagreement_arcsec: of each star with all others, when all pairs are solved
        camera_m, camera_sigma_m: position of the camera, where it is solved, and its
            standard deviations along the axes of the ground points
    """

    method: str
    stars: tuple[int, ...]
    failure: Failure
    angles_deg: list[float]
    matrix: list[list[float]]
    orthogonality_defect: float
    residuals: list[list[float]]
    iterations: int
    converged: bool
    rms: float
    reading_sigma: float | None = None
    rotation_sigma_arcsec: list[float] | None = None
    axis: list[float] | None = None
    axis_ra_deg: float | None = None
    axis_dec_deg: float | None = None
    angle_deg: float | None = None
    conditioning: float | None = None
    interstar_discrepancy_arcsec: float | None = None
    weights: list[list[float]] | None = None
    disagreement_arcsec: list[float] | None = None
    camera_m: list[float] | None = None
    camera_sigma_m: list[float] | None = None

    @property
    def rotation_rms_arcsec(self) -> float | None:
        """Root mean square of the whole attitude error, the angle of its rotation."""
        if self.rotation_sigma_arcsec is None:
            return None
        return float(np.linalg.norm(self.rotation_sigma_arcsec))

    def as_dict(self, unit: str = "mm") -> dict[str, Any]:
        """The solution as a dictionary with the names of the JSON and CSV output, without None.

        Args:
            unit: of the image coordinates, for the names
        """
        values = {
            f"{name}_{unit}" if name in IN_IMAGE_UNITS else name: value
            for name, value in asdict(self).items()
            if value is not None
        }
        del values["failure"]
        angles = dict(zip(ANGLE_NAMES, values.pop("angles_deg"), strict=True))
        head = {"method": values.pop("method"), "stars": list(values.pop("stars"))}
        return {**head, **angles, **values}


def solved_stars(
    method: str,
    solution: StarSolution,
    problems: StarField,
    subsets: Ints,
    choice: RotationChoice,
    reading_sigma: float,
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
        reading_sigma: standard deviation of an image coordinate; NaN if unknown
        covariance: of each solution about the camera's axes, (p, 3, 3), radians squared
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
        rms = np.sqrt((counts * residuals**2).sum(axis=(1, 2)) / counts.sum(axis=(1, 2)))
        sigmas = np.sqrt(np.diagonal(covariance, axis1=-2, axis2=-1)) * ARCSEC_PER_RADIAN
    ra_deg = dec_deg = None
    if solution.axis is not None:
        ra_deg, dec_deg = right_ascension_declination_deg(solution.axis)
    too_uncertain = np.asarray(sigmas.max(axis=-1) > LARGEST_SIGMA_DEG * 3600.0)
    stated = np.asarray(np.isfinite(sigmas).all(axis=-1))
    found = []
    for k, stars in enumerate(subsets):
        failure = Failure(int(solution.failure[k]))
        if failure == Failure.NONE and too_uncertain[k]:
            failure = Failure.TOO_UNCERTAIN
        found.append(
            SolvedStars(
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
                reading_sigma=reading_sigma if np.isfinite(reading_sigma) else None,
                rotation_sigma_arcsec=sigmas[k].tolist() if stated[k] and not as_solved else None,
                axis=_element(solution.axis, k),
                axis_ra_deg=_element(ra_deg, k),
                axis_dec_deg=_element(dec_deg, k),
                angle_deg=_element(solution.angle_deg, k),
                conditioning=_element(solution.conditioning, k),
                interstar_discrepancy_arcsec=_element(solution.interstar_discrepancy_arcsec, k),
                weights=_element(solution.weights, k),
                disagreement_arcsec=None
                if disagreement_arcsec is None
                else disagreement_arcsec[stars].tolist(),
            )
        )
    return found


def _element(values: Floats | None, k: int) -> Any:
    """One problem's value or list of values, None where the method has none."""
    return None if values is None else values[k].tolist()
