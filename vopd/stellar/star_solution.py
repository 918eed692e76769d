"""What every method returns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.geometry.vectors import dot, transform
from vopd.stellar import orientation_angles as angles
from vopd.stellar.directions import image_points_mm
from vopd.stellar.failures import Failure, first_failure, when
from vopd.stellar.star_field import StarField


@dataclass(frozen=True)
class StarSolution:
    """Attitudes of a stack of problems (...).

    `matrix` (..., 3, 3) as its method solved it, not made orthogonal, NaN where
    there is none; `failure` one Failure each; `iterations` corrections made, 0
    of a closed form. Where the method has them: `weights` (..., n, 2) of the
    last correction if not uniform, `axis` (..., 3) and `angle_deg` of the single
    rotation, its `conditioning` sin(D1, D2), and `interstar_discrepancy_arcsec`,
    the celestial minus the photographed angle between the two stars of a pair.
    """

    matrix: Floats
    failure: Ints
    iterations: Ints
    converged: Bools
    weights: Floats | None = None
    axis: Floats | None = None
    angle_deg: Floats | None = None
    conditioning: Floats | None = None
    interstar_discrepancy_arcsec: Floats | None = None

    @property
    def omega_phi_kappa_deg(self) -> Floats:
        """(..., 3)."""
        return angles.omega_phi_kappa_deg(self.matrix)

    @property
    def alpha_delta_swing_deg(self) -> Floats:
        """(..., 3)."""
        return angles.alpha_delta_swing_deg(self.matrix)

    def residuals_mm(self, field: StarField) -> Floats:
        """Observed minus computed image of each star: (..., n, 2).

        Computed from omega, phi, kappa, which make a true rotation: a Church
        matrix as solved passes through its stars whatever their errors.
        """
        rotation = angles.orientation_matrix(self.omega_phi_kappa_deg)
        camera = transform(rotation, field.directions)
        residuals: Floats = field.image_mm - image_points_mm(camera, field.focal_length_mm)
        return residuals


def behind_camera(matrix: Floats, field: StarField) -> Bools:
    """Which stars a solution puts behind the camera, where STARS looked through them: (..., n)."""
    behind: Bools = field.used & (dot(matrix[..., 2:, :], field.directions) >= 0.0)
    return behind


def closed(matrix: Floats, failure: Ints, field: StarField, **extra: Floats) -> StarSolution:
    """The solution of a closed form: NaN where it failed, stars behind the camera found."""
    blank = np.where((failure == Failure.NONE)[..., None, None], matrix, np.nan)
    behind = when(behind_camera(blank, field).any(axis=-1), Failure.BEHIND_CAMERA)
    outcome = first_failure(failure, behind)
    return StarSolution(
        blank, outcome, np.zeros(outcome.shape, int), outcome == Failure.NONE, **extra
    )
