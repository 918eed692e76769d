"""Read solutions of star photographs back from the JSON of `vopd stars solve`."""

from __future__ import annotations

import json
from typing import Any, NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.findings import DeckError, Finding
from vopd.stellar.files.input_text import read_text
from vopd.stellar.files.star_columns import UNITS


class ReadSolution(NamedTuple):
    """One solution, as far as a picture of it needs it.

    Attributes:
        image: the photograph's name; empty where there is only one
        method: how it was solved
        labels: the stars' names, or numbers
        images: x right and y up from the principal point, (n, 2)
        residuals: observed minus computed, (n, 2)
        unit: of the images
        pointing: alpha, delta, swing, degrees
    """

    image: str
    method: str
    labels: tuple[str, ...]
    images: Floats
    residuals: Floats
    unit: str
    pointing: tuple[float, float, float]


def read_solutions(name: str) -> list[ReadSolution]:
    """Read a file of solutions.

    Args:
        name: the file's name; `-` is standard input

    Raises:
        DeckError: it is not what `vopd stars solve --format json` writes, or has no solution.
    """
    text, deck = read_text(name)
    what = "not the JSON of `vopd stars solve`"
    try:
        found = [_solution(one) for one in json.loads(text)]
    except (ValueError, TypeError, KeyError, RecursionError, OverflowError) as error:
        raise DeckError(Finding(f"{what}: {error}", deck=deck)) from None
    if not found:
        raise DeckError(Finding("it has no solution", deck=deck))
    return found


def _solution(row: dict[str, Any]) -> ReadSolution:
    """One object of the array; raises KeyError, TypeError or ValueError if it is something else."""
    unit = next((unit for unit in UNITS if f"images_{unit}" in row), UNITS[0])
    images = np.array(row[f"images_{unit}"], dtype=np.float64)
    residuals = np.array(row[f"residuals_{unit}"], dtype=np.float64)
    if images.ndim != 2 or images.shape[1] != 2 or images.shape != residuals.shape:
        raise ValueError("images and residuals do not go together")
    if not (np.isfinite(images).all() and np.isfinite(residuals).all()):
        raise ValueError("a coordinate is not a finite number")
    numbers = [str(star) for star in row["stars"]]
    names = [str(name) for name in row.get("names", numbers)]
    if not len(names) == len(numbers) == len(images):
        raise ValueError("names and stars do not go together")
    labels = tuple(name or number for name, number in zip(names, numbers, strict=True))
    alpha, delta, swing = (float(row[name]) for name in ("alpha_deg", "delta_deg", "swing_deg"))
    return ReadSolution(
        str(row.get("image", "")),
        str(row["method"]),
        labels,
        images,
        residuals,
        unit,
        (alpha, delta, swing),
    )
