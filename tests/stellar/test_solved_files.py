"""Solved files."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.kit.command import DECKS, vopd
from tests.kit.stars import photograph as make_photograph
from tests.kit.stars import written
from vopd.findings import Finding, InputError
from vopd.stellar.files import solve as solve_star_file
from vopd.stellar.files.findings import KindOfFinding
from vopd.stellar.files.images import ImageAxes, MissingOption
from vopd.stellar.files.photograph import StarRequest, solve_photograph
from vopd.stellar.files.read import StarFile, read_star_csv
from vopd.stellar.files.solve import solution_text, solve_photographs
from vopd.stellar.methods.run import StarOptions

# Star files from reading to output: labels, what fails of several, status, printouts


REQUEST = StarRequest(ImageAxes(focal_mm=76.0))
STARS = make_photograph(8)


def star_file(count: int = 8) -> StarFile:
    (file,) = read_star_csv(written(STARS[:count]), "a.csv")
    return file


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
        found = solve_photographs(names, REQUEST)
        assert [one.label for one in found.photographs] == labels
        assert (found.findings, found.status) == ((), 0)


def test_what_fails_of_several(tmp_path: Path) -> None:
    """It is a finding in its turn, and the status 1; alone it is an error."""
    bad, good, one, hue = files(
        tmp_path, "x\n", GOOD, written(STARS[:1]), HUE
    )  # fmt: skip
    for alone in (bad, one):
        with pytest.raises(InputError):
            solve_photographs([alone], REQUEST)
    for names in ([bad, good], [good, bad], [one, good], [good, one]):
        found = solve_photographs(names, REQUEST)
        assert (len(found.photographs), found.status) == (1, 1)
        (said,) = found.findings
        assert said.deck in (bad, one) and said.severity == "error"
    found = solve_photographs([bad, one], REQUEST)
    assert (found.photographs, found.status, len(found.findings)) == ([], 1, 2)
    found = solve_photographs([hue], REQUEST)
    assert (found.status, [one.severity for one in found.findings]) == (0, ["warning"])


def test_failures_of_one_file(tmp_path: Path) -> None:
    """One photograph of two that cannot be solved, or read; and both."""
    head, *lines = TWO.splitlines()
    night, day = lines[:8], lines[8:]
    bad = [line.replace("night", "dusk") + "x" for line in night[:1]]
    for rows, decks, count in (
        (night + day[:1], 1, 1), (night + bad, 1, 1), (day[:1] + bad, 2, 0),
    ):  # fmt: skip
        (file,) = files(tmp_path, "\n".join([head, *rows]) + "\n")
        found = solve_photographs([file], REQUEST)
        assert (len(found.photographs), found.status) == (count, 1)
        assert [one.deck for one in found.findings] == [file] * decks
        assert [one.label for one in found.photographs] == ["night"] * count


def test_every_file_that_fails_is_said_first(tmp_path: Path) -> None:
    """They are of no kind of which there are many; warnings about solutions follow them."""
    (good,) = files(tmp_path, GOOD)
    names = [str(tmp_path / f"missing {k}.csv") for k in range(5)]
    found = solve_photographs([*names, good], replace(REQUEST, method="two-star"))
    assert [one.deck for one in found.findings] == [*names, good]
    assert [one.label for one in found.photographs] == [good]
    assert [one.severity for one in found.findings] == ["error"] * 5 + ["warning"]


def test_every_warning_about_a_star_is_said(tmp_path: Path) -> None:
    """They are of no kind of which there are many."""
    (long,) = files(tmp_path, "x_mm,y_mm,u,v,w\n" + "".join(
        f"{x},{y},{x / 38},{y / 38},-2\n" for x, y in ((1, 2), (9, -3), (-7, 5), (4, 11), (-2, -8))
    ))  # fmt: skip
    found = solve_photographs([long], REQUEST)
    assert [str(one)[: len(long) + 8] for one in found.findings] == [
        f"{long}: line {n}" for n in range(2, 7)
    ]
    assert {one.severity for one in found.findings} == {"warning"} and found.status == 0


def test_options_that_are_missing(tmp_path: Path) -> None:
    """They are wrong use where nothing is solved, and else a finding."""
    px = GOOD.replace("x_mm,y_mm", "x_px,y_px")
    good, pixels, others = files(tmp_path, GOOD, px, px)
    asked = StarRequest(ImageAxes(focal_px=76.0))
    for names in ([pixels], [pixels, others]):
        with pytest.raises(MissingOption, match=f"^{pixels}: the file has pixels: --centre"):
            solve_photographs(names, asked)
    with pytest.raises(MissingOption, match=r"^x$"):
        solve_photographs([good, pixels], _missing(REQUEST))
    found = solve_photographs([good, pixels], REQUEST)
    assert (len(found.photographs), found.status) == (1, 1)
    (said,) = found.findings
    assert said == Finding(f"{pixels}: the file has pixels: --centre X,Y or --size W,H is needed")


class _NoAxes(ImageAxes):
    """A camera of which something is missing, whatever the file."""

    def flipped(self, file: StarFile) -> bool:
        raise MissingOption("x")


def _missing(asked: StarRequest) -> StarRequest:
    return replace(asked, axes=_NoAxes(focal_mm=76.0))


@pytest.mark.parametrize(
    ("statuses", "status"), [((0, 0), 0), ((0, 3), 3), ((3, 1), 1), ((1, 0), 1), ((3, 3), 3)]
)
def test_the_worst_status(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, statuses: tuple[int, ...], status: int
) -> None:
    """Findings of four photographs of a kind are counted."""
    (two,) = files(tmp_path, TWO)
    left = list(statuses)
    said = tuple(KindOfFinding("svd: axis", Finding(str(k), "a")) for k in range(4))

    def solve(file: StarFile, request: StarRequest, label: str) -> Any:
        done = solve_photograph(file, request, label)
        return replace(done, status=left.pop(0), findings=said)

    monkeypatch.setattr(solve_star_file, "solve_photograph", solve)
    found = solve_photographs([two], REQUEST)
    assert found.status == status
    assert [one.message for one in found.findings] == ["0", "1", "2", "svd: 5 more like these"]


def test_forms_of_the_output() -> None:
    one = solve_photograph(star_file(), REQUEST)
    assert solution_text([one], "json", REQUEST).startswith("[\n{")
    assert solution_text([one], "csv", REQUEST).startswith("method,")
    text = solution_text([one], "text", REQUEST)
    assert text.startswith("method ") and "weight below" not in text
    weights = [[1.0, 1.0]] * 7 + [[0.1, 0.1]]
    small = replace(one, solved=tuple(replace(each, weights=weights) for each in one.solved))
    robust = replace(REQUEST, options=StarOptions(weights="robust"))
    assert "weight below" in solution_text([small], "text", robust)
    assert "weight below" not in solution_text([small], "text", replace(REQUEST, reject=True))


def test_the_printout_has_the_options(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the stars that are used; four corrections unless a number is asked for."""
    given: list[Any] = []

    def printout(stars: Any, **options: Any) -> str:
        given.append((stars.used.shape[-1], options))
        return "page"

    monkeypatch.setattr(solve_star_file, "stars_printout", printout)
    one = replace(solve_photograph(star_file(), REQUEST), used=np.arange(5))
    options = StarOptions(
        initial_deg=(1.0, 2.0, 3.0),
        start="two-star",
        weights="listed",
        corrections=7,
        reading_sigma_mm=0.02,
    )
    asked = replace(REQUEST, listing=True, options=options)
    assert solution_text([one, replace(one, label="x")], "json", asked) == "page\nx\npage"
    assert given[0] == (
        5,
        {
            "initial_deg": (1.0, 2.0, 3.0),
            "start": "two-star",
            "weights": "listed",
            "corrections": 7,
            "reading_sigma_mm": 0.02,
        },
    )
    solution_text([one], "text", replace(REQUEST, listing=True))
    assert given[2][1]["corrections"] == 4


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
