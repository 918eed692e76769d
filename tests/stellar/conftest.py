"""The report's printed numbers, for the tests of the stellar methods."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path

import pytest

GOLDEN = Path(__file__).parents[2] / "golden_outputs" / "rae_1987"
Golden = Callable[[str], list[dict[str, str]]]


@pytest.fixture
def golden() -> Golden:
    """Reads a golden file: a list of rows by column name, never empty."""

    def read(name: str) -> list[dict[str, str]]:
        with (GOLDEN / name).open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        assert rows, f"{name} is empty"
        return rows

    return read
