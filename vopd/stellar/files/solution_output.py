"""Solutions as JSON and CSV."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from typing import Any

from vopd.stellar.files.photograph import SolvedPhotograph
from vopd.stellar.methods.solved_stars import ANGLE_NAMES, ANGLE_SIGMA_NAMES

MATRIX_COLUMNS = tuple(f"m{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3))
AXIS_COLUMNS = ("axis_x", "axis_y", "axis_z")
SIGMA_COLUMNS = ("sigma_x_arcsec", "sigma_y_arcsec", "sigma_z_arcsec")

COVARIANCE_COLUMNS = tuple(
    f"covariance_{pair}_arcsec2" for pair in ("xx", "xy", "xz", "yy", "yz", "zz")
)
REGION_COLUMNS = ("boresight_95_major_arcsec", "boresight_95_minor_arcsec")
AXIS = ("axis_ra_deg", "axis_dec_deg", "angle_deg", "conditioning")


def _columns(unit: str) -> tuple[str, ...]:
    """The columns of CSV for a unit of image coordinates."""
    return (
        "method",
        "stars",
        *ANGLE_NAMES,
        *MATRIX_COLUMNS,
        "orthogonality_defect",
        f"rms_{unit}",
        f"residuals_{unit}",
        "iterations",
        "converged",
        f"reading_sigma_{unit}",
        "reading_freedom",
        *SIGMA_COLUMNS,
        *COVARIANCE_COLUMNS,
        *ANGLE_SIGMA_NAMES,
        *REGION_COLUMNS,
        "boresight_95_angle_deg",
        f"weighted_rms_{unit}",
        *AXIS_COLUMNS,
        *AXIS,
        "interstar_discrepancy_arcsec",
        "disagreement_arcsec",
        "weights",
        "camera_m",
        "camera_sigma_m",
    )


def as_json(photographs: Sequence[SolvedPhotograph]) -> str:
    """The solutions as a JSON array; numbers have all their digits."""
    solutions = [
        json.dumps(_image(photograph) | one.as_dict(photograph.file.unit), allow_nan=False)
        for photograph in photographs
        for one in photograph.solved
    ]
    return "[\n" + ",\n".join(solutions) + "\n]\n"


def as_csv(photographs: Sequence[SolvedPhotograph]) -> str:
    """The solutions as CSV, one line each; a list (stars, residuals) is one cell with spaces."""
    page = io.StringIO()
    units = list(dict.fromkeys(one.file.unit for one in photographs)) or ["mm"]
    columns = list(dict.fromkeys(name for unit in units for name in _columns(unit)))
    if any(one.label for one in photographs):
        columns.insert(0, "image")
    writer = csv.DictWriter(page, columns, lineterminator="\n", restval="")
    writer.writeheader()
    for photograph in photographs:
        for one in photograph.solved:
            row = _image(photograph) | one.as_dict(photograph.file.unit)
            elements = [element for line in row.pop("matrix") for element in line]
            for names, values in (
                (MATRIX_COLUMNS, elements),
                (AXIS_COLUMNS, row.pop("axis", None)),
                (SIGMA_COLUMNS, row.pop("rotation_sigma_arcsec", None)),
                (COVARIANCE_COLUMNS, _upper(row.pop("rotation_covariance_arcsec2", None))),
                (REGION_COLUMNS, row.pop("boresight_95_arcsec", None)),
            ):
                row.update(zip(names, values or [""] * len(names), strict=True))
            row["converged"] = str(one.converged).lower()
            writer.writerow({name: _cell(value) for name, value in row.items()})
    return page.getvalue()


def _image(photograph: SolvedPhotograph) -> dict[str, Any]:
    """The photograph's name, where there are several."""
    return {"image": photograph.label} if photograph.label else {}


def _upper(matrix: list[list[float]] | None) -> list[float] | None:
    """The elements of a symmetric matrix on and above its diagonal."""
    return None if matrix is None else [matrix[i][j] for i in range(3) for j in range(i, 3)]


def _cell(value: Any) -> Any:
    """A value, or the values of a list with spaces between."""
    if isinstance(value, list):
        return " ".join(str(_cell(item)) for item in value)
    return value
