"""What the tests of the stellar methods share."""

from __future__ import annotations

import csv
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1]))  # for the table of tolerances
GOLDEN = Path(__file__).parents[2] / "golden_outputs" / "rae_1987"


@pytest.fixture
def golden() -> object:
    """Reads a golden file: a list of rows by column name, never empty."""

    def read(name: str) -> list[dict[str, str]]:
        with (GOLDEN / name).open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        assert rows, f"{name} is empty"
        return rows

    return read
