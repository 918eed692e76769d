"""The printed numbers of Rae (1987): reads the golden files."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path

RAE_GOLDENS = Path(__file__).parents[2] / "golden_outputs" / "rae_1987"
Golden = Callable[[str], list[dict[str, str]]]


def read_golden(name: str) -> list[dict[str, str]]:
    """The rows of a golden file by column name; a file without rows is an error."""
    with (RAE_GOLDENS / name).open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert rows, f"{name} is empty"
    return rows
