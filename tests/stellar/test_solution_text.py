"""The text of a single solution: what is said of a matrix that is not orthogonal."""

from __future__ import annotations

import json

import numpy as np
import pytest

from tests.kit.command import vopd
from tests.kit.star_files import SAMPLE

HEADING = "matrix (as solved its orthogonality defect is "


def solve(*options: str) -> str:
    done = vopd("stars", "solve", SAMPLE, "--focal", "76", *options)
    assert done.status == 0
    return done.stdout


@pytest.mark.parametrize("method", ["church", "church-weighted", "church-weighted-r"])
def test_a_matrix_as_solved_is_said_not_to_be_orthogonal(method: str) -> None:
    """By how much: the largest element of M M' - 1, of the matrix in the JSON output."""
    options = ("--method", method, "--rotation", "as-solved")
    (row,) = json.loads(solve(*options, "--format", "json"))
    m = np.array(row["matrix"])
    defect = np.abs(m @ m.T - np.eye(3)).max()
    assert 1e-9 < defect < 1.0
    assert f"{HEADING}{defect:.1e})" in solve(*options).splitlines()


@pytest.mark.parametrize("method", ["collinearity", "svd"])
def test_a_rotation_is_not(method: str) -> None:
    lines = solve("--method", method).splitlines()
    assert "matrix" in lines and HEADING not in "\n".join(lines)
