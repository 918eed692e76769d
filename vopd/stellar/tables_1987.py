"""Table 6.5 and figures 6.1 to 6.3, which are lost in the scan, and two routines as listed."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.stellar.interstar_angles import star_pairs
from vopd.stellar.methods.church import ChurchWeights, church
from vopd.stellar.methods.collinearity import collinearity
from vopd.stellar.methods.single_rotation import single_rotation
from vopd.stellar.methods.two_star import two_star
from vopd.stellar.rae1987 import sample_data
from vopd.stellar.rae1987.report_table import ReportRow, ReportTable
from vopd.stellar.rae1987.truopk import truopk
from vopd.stellar.rae1987.tustar import tustar
from vopd.stellar.solution import StarSolution


def rotation_table() -> ReportTable:
    """Table 6.5: axis and angle of the single rotation of every pair."""
    pairs = star_pairs(len(sample_data.DIRECTIONS))
    solution = single_rotation(sample_data.sample_field().select(pairs))
    assert solution.axis is not None
    assert solution.angle_deg is not None
    assert solution.conditioning is not None
    values = np.column_stack([solution.axis, solution.angle_deg, solution.conditioning])
    rows = [
        ReportRow(_pair(pair), [f"{v:.8f}" for v in value[:4]] + [f"{value[4]:.2f}"])
        for pair, value in zip(pairs, values.tolist(), strict=True)
    ]
    columns = ("XR", "YR", "ZR", "angle, deg", "sin(D1,D2)")
    lost = "The report's values are lost in the scan. sin(D1,D2) is not among them."
    title = "Table 6.5. Rotation axes and angles of the single rotations"
    return ReportTable(title, columns, rows, [lost])


FIGURE_METHODS: dict[str, Callable[..., StarSolution]] = {
    "collinearity": collinearity,
    "two-star unit": two_star,
    "two-star raw": lambda pair: two_star(pair, unit_cross_products=False),
    "single-rotation": single_rotation,
}


class FigureErrors(NamedTuple):
    """What figures 6.1 to 6.3 show: pairs, methods, and errors (pairs, methods, 3), degrees."""

    pairs: list[str]
    methods: tuple[str, ...]
    errors: Floats


FIGURE_ANGLES = ("omega", "phi", "kappa")
FIGURE_TITLE = "Figure 6.{number}. Error of {name}, truth minus estimate, degrees"


def figure_errors() -> FigureErrors:
    """Errors of omega, phi and kappa of every pair by four methods, the sign of table 6.4."""
    pairs = star_pairs(len(sample_data.DIRECTIONS))
    fields = sample_data.sample_field().select(pairs)
    errors = np.stack(
        [angle_errors_deg(method(fields)) for method in FIGURE_METHODS.values()], axis=1
    )
    return FigureErrors([_pair(pair) for pair in pairs], tuple(FIGURE_METHODS), errors)


def figure_tables() -> list[ReportTable]:
    """Figures 6.1 to 6.3 as tables."""
    pairs, methods, errors = figure_errors()
    lost = "The figures are lost in the scan."
    return [
        ReportTable(
            FIGURE_TITLE.format(number=k + 1, name=name),
            methods,
            [
                ReportRow(pair, [f"{value:.7f}" for value in error])
                for pair, error in zip(pairs, errors[:, :, k].tolist(), strict=True)
            ],
            [lost],
        )
        for k, name in enumerate(FIGURE_ANGLES)
    ]


def as_listed_table() -> ReportTable:
    """Results of the two routines that, as listed, cannot have made the printed tables."""
    listed = tustar(
        sample_data.sample_field(sample_data.EXACT_MM).select(np.array([0, 1])[None, :])
    )
    angles = (*listed.omega_phi_kappa_deg[0].tolist(), *listed.alpha_delta_swing_deg[0].tolist())
    rows = [ReportRow("TUSTAR, stars 1,2 of table 6.1", [f"{value:.4f}" for value in angles])]
    choices: tuple[tuple[str, ChurchWeights], ...] = (
        ("church", "uniform"),
        ("church-weighted", "formula"),
    )
    for name, weights in choices:
        solution = church(sample_data.sample_field(), weights=weights)
        m = solution.matrix
        found = truopk(solution.omega_phi_kappa_deg, m[0, 1], m[0, 2], m[1, 1], m[1, 2])
        texts = [f"{value:.4f}" if np.isfinite(value) else "not found" for value in found]
        rows.append(ReportRow(f"TRUOPK, {name}", texts))
    columns = ("omega", "phi", "kappa", "alpha", "delta", "swing")
    return ReportTable("As listed. What TUSTAR and TRUOPK answer, degrees", columns, rows)


def angle_errors_deg(solution: StarSolution) -> Floats:
    """Truth minus estimate, degrees, the sign of table 6.4."""
    error: Floats = sample_data.TRUTH_DEG - solution.omega_phi_kappa_deg
    return error


def _pair(pair: Ints) -> str:
    return f"stars {int(pair[0]) + 1},{int(pair[1]) + 1}"
