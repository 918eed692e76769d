"""Star files solved: by one method or all, for the whole set, a pair, or all pairs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from dataclasses import field as attribute
from typing import Any

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.stellar.failures import Failure
from vopd.stellar.interstar_angles import star_disagreement_arcsec
from vopd.stellar.methods.church import church
from vopd.stellar.methods.collinearity import collinearity
from vopd.stellar.methods.observation_weights import WeightRule
from vopd.stellar.methods.single_rotation import single_rotation
from vopd.stellar.methods.two_star import two_star
from vopd.stellar.orientation_angles import orthogonality_defect
from vopd.stellar.star_field import StarField
from vopd.stellar.star_solution import StarSolution

METHODS = ("collinearity", "church", "church-weighted", "two-star", "single-rotation")
PAIR_METHODS = ("collinearity", "two-star", "single-rotation")
"""Methods that can solve two stars; the last two solve no more."""

LISTED_PAIR = np.array([[0, 1]])
"""The pair that TESTU and TWOSTAR solve, and so the default of the two-star methods."""


@dataclass(frozen=True)
class StarOptions:
    """How to solve: each as the function of its method says."""

    initial_deg: tuple[float, ...] | None = None
    weights: WeightRule = "uniform"
    corrections: int | None = None
    reading_sigma_mm: float | None = None
    unit_cross_products: bool = True


@dataclass(frozen=True)
class SolvedField:
    """One solution: plain values, `stars` counted from 1, keys of JSON in order.

    `values` holds what the method has of the keys that not every method has.
    """

    method: str
    stars: tuple[int, ...]
    failure: Failure
    omega_phi_kappa_deg: list[float]
    alpha_delta_swing_deg: list[float]
    matrix: list[list[float]]
    orthogonality_defect: float
    residuals_mm: list[list[float]]
    iterations: int
    converged: bool
    values: dict[str, Any] = attribute(default_factory=dict)

    @property
    def rms_mm(self) -> float:
        """Root mean square of the residuals' coordinates."""
        return float(np.sqrt(np.mean(np.square(self.residuals_mm))))

    @property
    def printable(self) -> bool:
        """Whether there is an attitude to show; one that did not converge is."""
        return self.failure in (Failure.NONE, Failure.NO_CONVERGENCE)

    def as_dict(self) -> dict[str, Any]:
        """The solution as JSON has it."""
        angles = (*self.omega_phi_kappa_deg, *self.alpha_delta_swing_deg)
        names = ("omega_deg", "phi_deg", "kappa_deg", "alpha_deg", "delta_deg", "swing_deg")
        return {
            "method": self.method,
            "stars": list(self.stars),
            **dict(zip(names, angles, strict=True)),
            "matrix": self.matrix,
            "orthogonality_defect": self.orthogonality_defect,
            "residuals_mm": self.residuals_mm,
            "iterations": self.iterations,
            "converged": self.converged,
            **self.values,
        }


def solve(
    stars: StarField,
    methods: Sequence[str],
    pairs: Ints | None = None,
    options: StarOptions | None = None,
) -> list[SolvedField]:
    """Solutions of one problem (no stack axis), failed ones among them.

    Without `pairs` the methods for many stars take them all, and those for two
    take stars 1 and 2, as the listings do. With pairs (p, 2), counted from 0,
    the methods that can solve two stars solve each; the others are left out.
    """
    options = options or StarOptions()
    disagreement = None
    if pairs is not None and len(pairs) > 1:
        disagreement = star_disagreement_arcsec(stars)[0]
    records = []
    for method in methods:
        if pairs is None and method not in ("two-star", "single-rotation"):
            subsets = np.arange(stars.used.shape[-1])[None, :]
        elif method in PAIR_METHODS:
            subsets = LISTED_PAIR if pairs is None else pairs
        else:
            continue
        subset = stars.select(subsets)
        solution = _solution(method, subset, options)
        records += _records(method, solution, subset, subsets, disagreement)
    return records


def _solution(method: str, stars: StarField, options: StarOptions) -> StarSolution:
    if method == "collinearity":
        return collinearity(
            stars,
            initial_deg=options.initial_deg,
            weights=options.weights,
            corrections=options.corrections,
            reading_sigma_mm=options.reading_sigma_mm,
        )
    if method == "two-star":
        return two_star(stars, unit_cross_products=options.unit_cross_products)
    if method == "single-rotation":
        return single_rotation(stars)
    weighted = method == "church-weighted"
    return church(
        stars,
        formula_weights=weighted,
        reading_sigma_mm=options.reading_sigma_mm if weighted else None,
    )


def _records(
    method: str,
    solution: StarSolution,
    subset: StarField,
    subsets: Ints,
    disagreement: Floats | None,
) -> list[SolvedField]:
    """One record a subset: the solution's arrays taken apart along their first axis."""
    extra = {
        name: getattr(solution, name)
        for name in (
            "axis",
            "angle_deg",
            "conditioning",
            "interstar_discrepancy_arcsec",
            "weights",
        )
        if getattr(solution, name) is not None
    }
    if disagreement is not None:
        extra["disagreement_arcsec"] = disagreement[subsets]
    angles, second = solution.omega_phi_kappa_deg, solution.alpha_delta_swing_deg
    defect, residuals = orthogonality_defect(solution.matrix), solution.residuals_mm(subset)
    return [
        SolvedField(
            method=method,
            stars=tuple((stars + 1).tolist()),
            failure=Failure(int(solution.failure[k])),
            omega_phi_kappa_deg=angles[k].tolist(),
            alpha_delta_swing_deg=second[k].tolist(),
            matrix=solution.matrix[k].tolist(),
            orthogonality_defect=float(defect[k]),
            residuals_mm=residuals[k].tolist(),
            iterations=int(solution.iterations[k]),
            converged=bool(solution.converged[k]),
            values={name: array[k].tolist() for name, array in extra.items()},
        )
        for k, stars in enumerate(subsets)
    ]
