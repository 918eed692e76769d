"""Solutions as JSON and CSV."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from typing import Any

from vopd.stellar.methods.solved_stars import ANGLE_NAMES, SolvedStars

MATRIX_COLUMNS = tuple(f"m{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3))
AXIS_COLUMNS = ("axis_x", "axis_y", "axis_z")
SIGMA_COLUMNS = ("sigma_x_arcsec", "sigma_y_arcsec", "sigma_z_arcsec")

CSV_COLUMNS = (
    "method",
    "stars",
    *ANGLE_NAMES,
    *MATRIX_COLUMNS,
    "orthogonality_defect",
    "rms_mm",
    "residuals_mm",
    "iterations",
    "converged",
    "reading_sigma_mm",
    *SIGMA_COLUMNS,
    *AXIS_COLUMNS,
    "axis_ra_deg",
    "axis_dec_deg",
    "angle_deg",
    "conditioning",
    "interstar_discrepancy_arcsec",
    "disagreement_arcsec",
    "weights",
)


def as_json(solved: Sequence[SolvedStars]) -> str:
    """The solutions as a JSON array; numbers have all their digits."""
    solutions = [json.dumps(one.as_dict(), allow_nan=False) for one in solved]
    return "[\n" + ",\n".join(solutions) + "\n]\n"


def as_csv(solved: Sequence[SolvedStars]) -> str:
    """The solutions as CSV, one line each; a list (stars, residuals) is one cell with spaces."""
    page = io.StringIO()
    writer = csv.DictWriter(page, CSV_COLUMNS, lineterminator="\n", restval="")
    writer.writeheader()
    for one in solved:
        row = one.as_dict()
        elements = [element for line in row.pop("matrix") for element in line]
        for names, values in (
            (MATRIX_COLUMNS, elements),
            (AXIS_COLUMNS, row.pop("axis", None)),
            (SIGMA_COLUMNS, row.pop("rotation_sigma_arcsec", None)),
        ):
            row.update(zip(names, values or [""] * len(names), strict=True))
        row["converged"] = str(one.converged).lower()
        writer.writerow({name: _cell(value) for name, value in row.items()})
    return page.getvalue()


def _cell(value: Any) -> Any:
    """A value, or the values of a list with spaces between."""
    if isinstance(value, list):
        return " ".join(str(_cell(item)) for item in value)
    return value
