"""Solved files."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.kit.command import DECKS, vopd
from tests.kit.stars import photograph as make_photograph
from tests.kit.stars import written
from vopd.findings import InputError
from vopd.stellar.files.images import ImageAxes
from vopd.stellar.files.photograph import StarRequest, solve_photographs

# Star files from reading to output: labels, what fails of several, status, printouts


REQUEST = StarRequest(ImageAxes(focal_mm=76.0))
STARS = make_photograph(8)


def files(folder: Path, *texts: str) -> list[str]:
    names = []
    for k, text in enumerate(texts):
        (folder / f"{k}.csv").write_text(text)
        names.append(str(folder / f"{k}.csv"))
    return names


GOOD = written(STARS)
NAMED = "image," + GOOD.replace("\n", "\nnight,").removesuffix("night,")
HUE = GOOD.replace("\n", ",1\n").replace("dec_deg,1", "dec_deg,hue")
TWO = NAMED + NAMED.split("\n", 1)[1].replace("night", "day")


def test_labels(tmp_path: Path) -> None:
    """The photograph's name; the file's of those without one of several; both where two agree."""
    bare, named, two = files(tmp_path, GOOD, NAMED, TWO)
    for names, labels in (
        ([bare], [""]), ([named], ["night"]), ([bare, bare], [bare, bare]),
        ([bare, named], [bare, "night"]), ([two], ["night", "day"]),
        ([named, two], [f"{named}: night", f"{two}: night", "day"]),
    ):  # fmt: skip
        photographs, *others = solve_photographs(names, REQUEST)
        assert [one.label for one in photographs] == labels
        assert others == [[], 0]


def test_what_fails_of_several(tmp_path: Path) -> None:
    """It is a finding in its turn, and the status 1; alone it is an error."""
    bad, good, one, hue = files(
        tmp_path, "x\n", GOOD, written(STARS[:1]), HUE
    )  # fmt: skip
    for alone in (bad, one):
        with pytest.raises(InputError):
            solve_photographs([alone], REQUEST)
    for names in ([bad, good], [good, bad], [one, good], [good, one]):
        photographs, (said,), status = solve_photographs(names, REQUEST)
        assert (len(photographs), status) == (1, 1)
        assert said.source in (bad, one) and said.severity == "error"
    photographs, findings, status = solve_photographs([bad, one], REQUEST)
    assert (photographs, status, len(findings)) == ([], 1, 2)
    _, (said,), status = solve_photographs([hue], REQUEST)
    assert (status, said.severity) == (0, "warning")


def test_failures_of_one_file(tmp_path: Path) -> None:
    """One photograph of two that cannot be solved, or read; and both."""
    head, *lines = TWO.splitlines()
    night, day = lines[:8], lines[8:]
    bad = [line.replace("night", "dusk") + "x" for line in night[:1]]
    for rows, decks, count in (
        (night + day[:1], 1, 1), (night + bad, 1, 1), (day[:1] + bad, 2, 0),
    ):  # fmt: skip
        (file,) = files(tmp_path, "\n".join([head, *rows]) + "\n")
        photographs, findings, status = solve_photographs([file], REQUEST)
        assert (len(photographs), status) == (count, 1)
        assert [one.source for one in findings] == [file] * decks
        assert [one.label for one in photographs] == ["night"] * count


def test_every_file_that_fails_is_said_first(tmp_path: Path) -> None:
    """They are of no kind of which there are many; warnings about solutions follow them."""
    (good,) = files(tmp_path, GOOD)
    names = [str(tmp_path / f"missing {k}.csv") for k in range(5)]
    request = replace(REQUEST, method="two-star")
    photographs, findings, _ = solve_photographs([*names, good], request)
    assert [one.source for one in findings] == [*names, good]
    assert [one.label for one in photographs] == [good]
    assert [one.severity for one in findings] == ["error"] * 5 + ["warning"]


def test_every_warning_about_a_star_is_said(tmp_path: Path) -> None:
    """They are of no kind of which there are many."""
    (long,) = files(tmp_path, "x_mm,y_mm,u,v,w\n" + "".join(
        f"{x},{y},{x / 38},{y / 38},-2\n" for x, y in ((1, 2), (9, -3), (-7, 5), (4, 11), (-2, -8))
    ))  # fmt: skip
    _, findings, status = solve_photographs([long], REQUEST)
    assert [str(one)[: len(long) + 8] for one in findings] == [
        f"{long}: line {n}" for n in range(2, 7)
    ]
    assert {one.severity for one in findings} == {"warning"} and status == 0


# Star attitudes in the file formats of `vopd attitude`


ORION, SAMPLE = DECKS / "stars" / "orion.csv", DECKS / "stars" / "table_6_3.csv"


def written_files(path: Path, *arguments: str) -> Path:
    result = vopd("stars", "solve", ORION, SAMPLE, "--focal", "76", "-o", path, *arguments)
    assert result.status == 0 and result.stdout == "", result.stderr
    return path


@pytest.fixture
def rows(tmp_path: Path) -> list[dict[str, str]]:
    """The same table as CSV."""
    with written_files(tmp_path / "solved.csv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def same(found: object, cell: str) -> bool:
    """Whether a value is that of a cell of CSV, where an empty cell is no number."""
    if cell == "":
        return found is None or found == "" or (isinstance(found, float) and found != found)
    return str(found) == cell or float(str(found)) == float(cell)


def test_json_lines(tmp_path: Path, rows: list[dict[str, str]]) -> None:
    head, *lines = written_files(tmp_path / "solved.jsonl").read_text().splitlines()
    described = json.loads(head)
    assert list(described["columns"]) == list(rows[0])
    assert described["columns"]["sigma_alpha_deg"]["unit"] == "deg"
    assert "camera axes" in described["conventions"]["matrix"]
    for line, row in zip(map(json.loads, lines), rows, strict=True):
        assert all(same(line[name], row[name]) for name in row)


def test_npz(tmp_path: Path, rows: list[dict[str, str]]) -> None:
    with np.load(written_files(tmp_path / "solved.npz")) as archive:
        assert json.loads(str(archive["columns"]))["rms_mm"]["unit"] == "mm"
        for name in rows[0]:
            values = archive[name].tolist()
            assert all(same(v, row[name]) for v, row in zip(values, rows, strict=True))


def test_parquet(tmp_path: Path, rows: list[dict[str, str]]) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    table = parquet.read_table(written_files(tmp_path / "solved.parquet"))
    assert table.schema.field("delta_deg").metadata[b"unit"] == b"deg"
    assert b"conventions" in table.schema.metadata
    for line, row in zip(table.to_pylist(), rows, strict=True):
        assert all(same(line[name], row[name]) for name in row)


def test_the_option_wins_over_the_suffix(tmp_path: Path) -> None:
    path = written_files(tmp_path / "solved.csv", "--format", "json")
    assert len(json.loads(path.read_text())) == 2
    assert written_files(tmp_path / "solved.lst").read_text().startswith("image")
