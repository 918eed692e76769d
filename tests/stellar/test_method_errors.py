"""The table of errors in docs/stellar.md is what the methods do."""

from __future__ import annotations

import importlib.util
from pathlib import Path

from tests.tolerances import within

ROOT = Path(__file__).parents[2]


def documented() -> dict[str, dict[str, float]]:
    """The rows of the table, by stars and method."""
    lines = (ROOT / "docs" / "stellar.md").read_text(encoding="utf-8").splitlines()
    start = next(k for k, line in enumerate(lines) if line.startswith("| stars | collinearity"))
    names = [cell.strip() for cell in lines[start].strip("|").split("|")]
    rows = {}
    for line in lines[start + 2 :]:
        if not line.startswith("|"):
            break
        stars, *cells = (cell.strip() for cell in line.strip("|").split("|"))
        rows[stars] = {
            name: float(cell) for name, cell in zip(names[1:-1], cells[:-1], strict=True) if cell
        }
    return rows


def test_the_documented_errors_are_those_of_fresh_draws() -> None:
    path = ROOT / "tools" / "rae_method_errors.py"
    spec = importlib.util.spec_from_file_location("rae_method_errors", path)
    assert spec is not None and spec.loader is not None
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    counted, shown = tool.method_errors(5000), documented()
    assert list(shown) == list(counted) and len(shown) == 7
    for stars, row in counted.items():
        assert set(shown[stars]) == set(row)
        for name, error in row.items():
            assert abs(shown[stars][name] / error - 1.0) < within("rae method error"), (stars, name)
