"""One solution of one set of stars, as plain values for output."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from vopd.stellar.failures import Failure

REDUCED_WEIGHT = 0.5
"""Robust weight below which a star does not count in the rms and is marked."""

ANGLE_NAMES = ("omega_deg", "phi_deg", "kappa_deg", "alpha_deg", "delta_deg", "swing_deg")
ANGLE_SIGMA_NAMES = tuple(f"sigma_{name}" for name in ANGLE_NAMES)

IN_IMAGE_UNITS = ("residuals", "rms", "reading_sigma", "weighted_rms", "images")
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
        reading_freedom: degrees of freedom of that estimate; None where it is given
        rotation_sigma_arcsec: standard deviations about the camera's x, y, z
        rotation_covariance_arcsec2: their covariance, (3, 3)
        angle_sigmas_deg: standard deviations of the angles in `angles_deg`
        boresight_95_arcsec: semi-axes of the ellipse that holds the optical axis with a
            probability of 95 percent, the longer one first
        boresight_95_angle_deg: direction of the longer one, from north toward
            increasing right ascension
        weighted_rms: root mean square of the residuals' coordinates over their standard
            deviations, times the reading sigma, image units; None where all weigh alike
        axis, axis_ra_deg, axis_dec_deg, angle_deg, conditioning: of a single rotation
        interstar_discrepancy_arcsec: of a pair
        weights: of the residuals, if not uniform
        disagreement_arcsec: of each star with all others, when all pairs are solved
        camera, camera_sigmas: focal, centre_x, centre_y and k1 that were solved with the
            attitude, in image units and the file's coordinates, and standard deviations
        sky: where the optical axis points, by the names of columns
        images: x, y of each star from the principal point, y up, image units
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
    reading_freedom: int | None = None
    rotation_sigma_arcsec: list[float] | None = None
    rotation_covariance_arcsec2: list[list[float]] | None = None
    angle_sigmas_deg: list[float] | None = None
    boresight_95_arcsec: list[float] | None = None
    boresight_95_angle_deg: float | None = None
    weighted_rms: float | None = None
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
    sky: dict[str, float] | None = None
    camera: dict[str, float] | None = None
    camera_sigmas: dict[str, float] | None = None
    images: list[list[float]] | None = None

    def without_uncertainty(self) -> SolvedStars:
        """The same solution with no statement of its uncertainty."""
        return replace(
            self,
            rotation_sigma_arcsec=None,
            rotation_covariance_arcsec2=None,
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
        sigmas = values.pop("angle_sigmas_deg", None)
        if sigmas is not None:
            values |= dict(zip(ANGLE_SIGMA_NAMES, sigmas, strict=True))
        for prefix, found in (("", "camera"), ("sigma_", "camera_sigmas")):
            for name, value in (values.pop(found, None) or {}).items():
                values[f"{prefix}{name}" + ("" if name == "k1" else f"_{unit}")] = value
        values |= values.pop("sky", None) or {}
        head = {"method": values.pop("method"), "stars": list(values.pop("stars"))}
        return {**head, **angles, **values}
