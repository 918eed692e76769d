"""Star attitudes as a table: rows of plain values, and arrays of its columns."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vopd.stellar.files.solved_photograph import SolvedPhotograph
from vopd.stellar.files.table import (
    AXIS_COLUMNS,
    COLUMNS,
    CONVENTIONS,
    COVARIANCE_COLUMNS,
    IMAGE,
    MATRIX_COLUMNS,
    REGION_COLUMNS,
    SIGMA_COLUMNS,
    SolutionColumn,
)
from vopd.stellar.methods.solved_stars import SolvedStars
from vopd.version import __version__


class SolutionTable(NamedTuple):
    """A table of star attitudes: arrays, unit and meaning of each column, and conventions."""

    values: dict[str, NDArray[Any]]
    columns: dict[str, dict[str, str]]
    conventions: dict[str, str]


def columns_of(photographs: Sequence[SolvedPhotograph]) -> list[SolutionColumn]:
    """The columns of a table of these photographs, with the units of their images."""
    units = list(dict.fromkeys(one.file.unit for one in photographs)) or ["mm"]
    named = {
        column.name.format(unit=unit): column._replace(
            name=column.name.format(unit=unit), unit=column.unit.format(unit=unit)
        )
        for column in COLUMNS
        for unit in units
    }
    several = any(one.label for one in photographs)
    return [*([IMAGE] if several else []), *named.values()]


def rows_of(photographs: Sequence[SolvedPhotograph]) -> list[dict[str, Any]]:
    """A row for each solution: plain values by the names of columns; "" where there is none."""
    return [_row(photograph, one) for photograph in photographs for one in photograph.solved]


def solution_table(photographs: Sequence[SolvedPhotograph]) -> SolutionTable:
    """The table as arrays: numbers are NaN where there are none, text is empty."""
    columns, rows = columns_of(photographs), rows_of(photographs)
    values = {
        column.name: np.array([str(row.get(column.name, "")) for row in rows], dtype=str)
        if column.text
        else np.array([_number(row.get(column.name, "")) for row in rows], dtype=np.float64)
        for column in columns
    }
    described = {one.name: {"unit": one.unit, "meaning": one.meaning} for one in columns}
    sources = ", ".join(dict.fromkeys(one.file.deck for one in photographs))
    stated = {"program": f"vopd {__version__}", "source": sources, **CONVENTIONS}
    return SolutionTable(values, described, stated)


def _row(photograph: SolvedPhotograph, one: SolvedStars) -> dict[str, Any]:
    row = one.as_dict(photograph.file.unit)
    elements = [element for line in row.pop("matrix") for element in line]
    covariance = row.pop("rotation_covariance_arcsec2", None)
    upper = covariance and [covariance[i][j] for i in range(3) for j in range(i, 3)]
    for names, values in (
        (MATRIX_COLUMNS, elements),
        (AXIS_COLUMNS, row.pop("axis", None)),
        (SIGMA_COLUMNS, row.pop("rotation_sigma_arcsec", None)),
        (COVARIANCE_COLUMNS, upper),
        (REGION_COLUMNS, row.pop("boresight_95_arcsec", None)),
    ):
        row.update(zip(names, values or [""] * len(names), strict=True))
    row["converged"] = str(one.converged).lower()
    if photograph.epoch:
        row["epoch"] = photograph.epoch
    if photograph.label:
        row["image"] = photograph.label
    return {name: _cell(value) for name, value in row.items()}


def _cell(value: Any) -> Any:
    """A value, or the values of a list with spaces between."""
    if isinstance(value, list):
        return " ".join(str(_cell(item)) for item in value)
    return value


def _number(value: Any) -> float:
    return float("nan") if value == "" else float(value)
