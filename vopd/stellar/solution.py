"""The result of every method: attitudes, or the reasons why there are none."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Literal

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.geometry.linear import transform
from vopd.geometry.rotations import ahead, nearest_rotation
from vopd.records import Record
from vopd.stellar import angles
from vopd.stellar.field import Failure, StarField, first_failure, image_points_mm, when

RotationChoice = Literal["nearest", "as-solved"]
"""Which attitude a matrix that is not quite a rotation stands for."""


@dataclass(frozen=True, eq=False)
class StarSolution(Record):
    """Attitudes of a stack of problems (...), as one method solved them.

    Attributes:
        matrix: orientation matrices as solved, not made orthogonal, (..., 3, 3);
            NaN where there is none
        failure: a `Failure` for each problem, (...)
        iterations: corrections made, (...); 0 for a method without iteration
        converged: whether there is a solution that no further correction would change, (...)
        weights: weights of the last correction, (..., n, 2); None if uniform
        axis: rotation axes of the single rotation, (..., 3)
        angle_deg: its angles about the axes, (...), degrees, -180 to 180
        conditioning: its sin(D1, D2), (...), 0 to 1
        interstar_discrepancy_arcsec: of a pair, the angle between the stars minus
            that between their images, (...), seconds of arc
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

    def problem(self, k: int) -> StarSolution:
        """Select one problem of a stack (p,), as a stack of one."""
        values = ((one.name, getattr(self, one.name)) for one in fields(self))
        return replace(self, **{name: v[k : k + 1] for name, v in values if v is not None})

    @classmethod
    def join(cls, solutions: Sequence[StarSolution]) -> StarSolution:
        """Join stacks (p,) of one method into one."""
        names = [one.name for one in fields(cls) if getattr(solutions[0], one.name) is not None]
        return cls(**{n: np.concatenate([getattr(one, n) for one in solutions]) for n in names})

    @property
    def omega_phi_kappa_deg(self) -> Floats:
        """omega, phi, kappa of the matrix as solved, (..., 3), degrees."""
        return angles.omega_phi_kappa_deg(self.matrix)

    @property
    def alpha_delta_swing_deg(self) -> Floats:
        """alpha, delta, swing of the matrix as solved, (..., 3), degrees."""
        return angles.alpha_delta_swing_deg(self.matrix)

    def rotation(self, choice: RotationChoice = "nearest") -> Floats:
        """Choose the rotation for each matrix.

        Args:
            choice: "nearest", the rotation nearest to the matrix as solved, or
                "as-solved", the rotation with the omega, phi, kappa of the matrix,
                which are those that the report's programs print

        Returns:
            Rotation matrices, (..., 3, 3). The two choices agree for methods
            whose matrix is a rotation; for a Church matrix the nearest rotation
            is the more accurate.
        """
        if choice == "as-solved":
            return angles.orientation_matrix(self.omega_phi_kappa_deg)
        return self._nearest

    @cached_property
    def _nearest(self) -> Floats:
        rotation, _ = nearest_rotation(self.matrix)
        return rotation

    def residuals_mm(self, field: StarField, choice: RotationChoice = "nearest") -> Floats:
        """Subtract the computed from the observed image coordinates of each star.

        Args:
            field: the problems that were solved
            choice: which rotation computes the images

        Returns:
            The residuals in x and y, (..., n, 2), mm.
        """
        camera = transform(self.rotation(choice), field.directions)
        residuals: Floats = field.image_mm - image_points_mm(camera, field.focal_length_mm)
        return residuals


def behind_camera(matrix: Floats, field: StarField) -> Bools:
    """Find stars behind the camera in a solution, (..., n); program STARS does not check this."""
    return np.asarray(field.used & (ahead(-matrix, field.directions) <= 0.0))


def closed_form_solution(
    matrix: Floats, failure: Ints, field: StarField, **extra: Floats
) -> StarSolution:
    """Build the solution of a direct method: NaN where it failed or a star is behind the camera."""
    blank = np.where((failure == Failure.NONE)[..., None, None], matrix, np.nan)
    behind = when(behind_camera(blank, field).any(axis=-1), Failure.BEHIND_CAMERA)
    all_failures = first_failure(failure, behind)
    solved = all_failures == Failure.NONE
    return StarSolution(blank, all_failures, np.zeros(solved.shape, int), solved, **extra)
