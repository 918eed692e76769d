"""The arrays of results by name, and results with some of them replaced."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

from vopd.results import LandmarkResults, Results

BY_LANDMARK = tuple(field.name for field in fields(LandmarkResults))
BY_FRAME = tuple(
    field.name
    for field in fields(Results)
    if field.name not in ("layout", "points", "job", "fixes", "stop")
)
ARRAYS = (*BY_FRAME, *BY_LANDMARK)


def with_arrays(results: Results, **values: Any) -> Results:
    """The results with other values, arrays by landmark as (F, L, ...)."""
    marks = {name: values.pop(name) for name in BY_LANDMARK if name in values}
    flat = {name: results.layout.flat(array) for name, array in marks.items()}
    return replace(results, points=replace(results.points, **flat), **values)
