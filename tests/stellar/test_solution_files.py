"""Star attitudes in the file formats of `vopd attitude`."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from tests.kit.command import DECKS, vopd

ORION, SAMPLE = DECKS / "stars" / "orion.csv", DECKS / "stars" / "table_6_3.csv"


def written(path: Path, *arguments: str) -> Path:
    result = vopd("stars", "solve", ORION, SAMPLE, "--focal", "76", "-o", path, *arguments)
    assert result.status == 0 and result.stdout == "", result.stderr
    return path


@pytest.fixture
def rows(tmp_path: Path) -> list[dict[str, str]]:
    """The same table as CSV."""
    with written(tmp_path / "solved.csv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def same(found: object, cell: str) -> bool:
    """Whether a value is that of a cell of CSV, where an empty cell is no number."""
    if cell == "":
        return found is None or found == "" or (isinstance(found, float) and found != found)
    return str(found) == cell or float(str(found)) == float(cell)


def test_json_lines(tmp_path: Path, rows: list[dict[str, str]]) -> None:
    head, *lines = written(tmp_path / "solved.jsonl").read_text().splitlines()
    described = json.loads(head)
    assert list(described["columns"]) == list(rows[0])
    assert described["columns"]["sigma_alpha_deg"]["unit"] == "deg"
    assert "camera axes" in described["conventions"]["matrix"]
    for line, row in zip(map(json.loads, lines), rows, strict=True):
        assert all(same(line[name], row[name]) for name in row)


def test_npz(tmp_path: Path, rows: list[dict[str, str]]) -> None:
    with np.load(written(tmp_path / "solved.npz")) as archive:
        assert json.loads(str(archive["columns"]))["rms_mm"]["unit"] == "mm"
        for name in rows[0]:
            values = archive[name].tolist()
            assert all(same(v, row[name]) for v, row in zip(values, rows, strict=True))


def test_parquet(tmp_path: Path, rows: list[dict[str, str]]) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    table = parquet.read_table(written(tmp_path / "solved.parquet"))
    assert table.schema.field("delta_deg").metadata[b"unit"] == b"deg"
    assert b"conventions" in table.schema.metadata
    for line, row in zip(table.to_pylist(), rows, strict=True):
        assert all(same(line[name], row[name]) for name in row)


def test_the_option_wins_over_the_suffix(tmp_path: Path) -> None:
    path = written(tmp_path / "solved.csv", "--format", "json")
    assert len(json.loads(path.read_text())) == 2
    assert written(tmp_path / "solved.lst").read_text().startswith("image")
