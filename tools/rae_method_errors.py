"""Make the table of errors in docs/stellar.md: python tools/rae_method_errors.py [DRAWS].

Images of table 6.1 are read with normal errors of .01 mm in x and y, many
times, and solved by every method. The error of an attitude is the angle of the
rotation between it and the truth.
"""

from __future__ import annotations

import sys
from collections.abc import Callable

import numpy as np
from scipy.spatial.transform import Rotation

from vopd.stellar import (
    StarField,
    StarSolution,
    church,
    collinearity,
    orientation_matrix,
    single_rotation,
    star_pairs,
    two_star,
    wahba,
)
from vopd.stellar.solution import RotationChoice
from vopd.stellar.tables_1987 import DIRECTIONS, EXACT_MM, FOCAL_LENGTH_MM, TRUTH_DEG

DRAWS = 40_000
SIGMA_MM = 0.01
SEED = 6
ARCSEC = 3600.0 * 180.0 / np.pi

Method = Callable[[StarField], StarSolution]
FOR_ALL: dict[str, tuple[Method, RotationChoice]] = {
    "collinearity": (collinearity, "nearest"),
    "svd": (wahba, "nearest"),
    "Church": (church, "nearest"),
    "Church as solved": (church, "as-solved"),
    "Church weighted": (lambda field: church(field, weights="formula"), "nearest"),
}
FOR_PAIRS: dict[str, tuple[Method, RotationChoice]] = {
    "collinearity": (collinearity, "nearest"),
    "svd": (wahba, "nearest"),
    "two-star": (two_star, "nearest"),
    "two-star as solved": (two_star, "as-solved"),
    "single rotation": (single_rotation, "nearest"),
}
COLUMNS = (*FOR_ALL, "two-star", "two-star as solved", "single rotation")


def method_errors(draws: int = DRAWS) -> dict[str, dict[str, float]]:
    """Root-mean-square errors, seconds of arc, by stars (`all four`, `1, 2`, ...) and method."""
    noise = np.random.default_rng(SEED).normal(0.0, SIGMA_MM, (draws, *EXACT_MM.shape))
    fields = StarField.of(DIRECTIONS, EXACT_MM + noise, FOCAL_LENGTH_MM)
    rows = {"all four": {name: _rms(fields, *how) for name, how in FOR_ALL.items()}}
    for pair in star_pairs(len(DIRECTIONS)):
        label = f"{pair[0] + 1}, {pair[1] + 1}"
        rows[label] = {name: _rms(fields.select(pair), *how) for name, how in FOR_PAIRS.items()}
    return rows


def _rms(fields: StarField, method: Method, choice: RotationChoice) -> float:
    matrix = method(fields).rotation(choice)
    turn = Rotation.from_matrix(matrix @ orientation_matrix(TRUTH_DEG).T).magnitude()
    return float(np.sqrt(np.mean(turn**2)) * ARCSEC)


def table(rows: dict[str, dict[str, float]]) -> list[str]:
    """The table as Markdown, with sin(D1, D2) of each pair last."""
    lines = [f"| stars | {' | '.join(COLUMNS)} | sin(D1, D2) |", "|---" * (len(COLUMNS) + 2) + "|"]
    exact = StarField.of(DIRECTIONS, EXACT_MM, FOCAL_LENGTH_MM)
    sines = single_rotation(exact.select(star_pairs(len(DIRECTIONS)))).conditioning
    assert sines is not None
    shown = ["", *(f"{sine:.2f}" for sine in sines)]
    for (label, row), sine in zip(rows.items(), shown, strict=True):
        cells = [f"{row[name]:.0f}" if name in row else "" for name in COLUMNS]
        lines.append(f"| {label} | {' | '.join([*cells, sine])} |")
    return lines


if __name__ == "__main__":
    print("\n".join(table(method_errors(int(sys.argv[1]) if len(sys.argv) > 1 else DRAWS))))
