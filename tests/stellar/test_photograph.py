"""Photographs: problem, solutions and exit status."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.command import DECKS, vopd
from tests.kit.stars import photograph as make_photograph
from tests.kit.stars import written
from tests.tolerances import assert_close
from vopd.findings import Finding, InputError
from vopd.mistakes import Explanation
from vopd.stellar.field import Failure, star_directions
from vopd.stellar.files.images import ImageAxes, MissingOption
from vopd.stellar.files.mistakes import Plausibility
from vopd.stellar.files.photograph import (
    StarRequest,
    exit_status,
    implausible,
    photograph_directions,
    solve_photograph,
    solve_photographs,
)
from vopd.stellar.files.read import StarFile, read_star_csv
from vopd.stellar.methods.run import SolvedStars, StarOptions
from vopd.stellar.sky import SkyRequest

# What is solved of a photograph: options that another needs, errors, and what is handed on


IMAGE = np.array([[1.0, 2.0], [3.0, 4.0], [-5.0, 6.0]])
SKY = np.array([[10.0, 20.0], [30.0, 40.0], [50.0, 60.0]])
AXES = ImageAxes(focal_mm=76.0)


def star_file(kind: str = "ra_deg,dec_deg", **more: Any) -> StarFile:
    positions = SKY if "dec" in kind else np.column_stack([SKY, [70.0, 80.0, 90.0]])
    if kind == "u,v,w":
        positions = star_directions(SKY[:, 0], SKY[:, 1])
    one = StarFile("a.csv", (2, 3, 4), ("", "", ""), IMAGE, "mm", kind, positions)
    return replace(one, **more)


def request(sky: dict[str, Any] | None = None, **more: Any) -> StarRequest:
    return StarRequest(AXES, sky=SkyRequest(**(sky or {})), **more)


def test_directions_and_what_they_refer_to() -> None:
    """Nothing is said of stars that are as the file has them."""
    found: list[Finding] = []
    for kind, more in (
        ("ra_deg,dec_deg", {}),
        ("u,v,w", {}),
        ("x_m,y_m,z_m", {"camera_m": (10.0, 20.0, 0.0)}),
    ):  # fmt: skip
        sky = photograph_directions(star_file(kind), request(**more), found.append)
        assert (sky.frame, sky.magnitude) == (None, None)
        assert_approved(sky.epoch)
        if kind != "x_m,y_m,z_m":
            assert_close("rae element", sky.directions, star_directions(SKY[:, 0], SKY[:, 1]))
        else:
            assert_close("rae element", sky.directions[0], [0.0, 0.0, 1.0])
    assert found == []
    long = star_file("u,v,w", positions=np.array([[0.0, 0.0, 2.0]] * 3))
    photograph_directions(long, request(), found.append)
    assert len(found) == 3 and "u, v, w have length 2" in str(found[0])


# Exit status of a photograph, what a method for pairs leaves unsaid, and counts of findings


SOLVED = SolvedStars("svd", (1, 2), Failure.NONE, [], [], 0.0, [], 0, True, 0.0)
GOOD = Plausibility(0.1)
BAD = Plausibility(9.0, "much less is allowed")
BY_STARS = BAD._replace(mistake=Explanation(0.1, "star 2 disagrees", (1,)))
BY_UNITS = BAD._replace(mistake=Explanation(0.1, "hours"))

PLAIN = StarRequest(ImageAxes(focal_mm=76.0))
REJECT, EDIT = replace(PLAIN, reject=True), replace(PLAIN, edit_by_pairs=True)
ROBUST = replace(PLAIN, options=StarOptions(weights="robust"))
LISTED_STATUS = replace(PLAIN, options=StarOptions(weights="listed"))

AFTER_ALL = {Failure.NONE: 0, Failure.NO_CONVERGENCE: 3}
WHERE_BAD = {Failure.NOT_A_ROTATION: 3, Failure.TOO_UNCERTAIN: 3, Failure.NO_CONVERGENCE: 3}


@pytest.mark.parametrize("failure", Failure)
def test_every_failure(failure: Failure) -> None:
    """Residuals that are too large explain two of them, which then are no error."""
    solved = [SOLVED, replace(SOLVED, failure=failure)]
    assert exit_status(solved, GOOD, PLAIN) == AFTER_ALL.get(failure, 1)
    assert exit_status(solved, BAD, PLAIN) == (WHERE_BAD | {Failure.NONE: 3}).get(failure, 1)
    allowed = WHERE_BAD | {Failure.NONE: 0}
    assert exit_status(solved, BY_STARS, REJECT) == allowed.get(failure, 1)


@pytest.mark.parametrize(
    ("judged", "request_", "doubtful"),
    [
        (GOOD, PLAIN, False), (GOOD, REJECT, False), (BAD, PLAIN, True), (BAD, REJECT, True),
        (BAD, ROBUST, True), (BY_UNITS, REJECT, True), (BY_UNITS, ROBUST, True),
        (BY_STARS, PLAIN, True), (BY_STARS, LISTED_STATUS, True), (BY_STARS, REJECT, False),
        (BY_STARS, EDIT, False), (BY_STARS, ROBUST, False),
    ],
)  # fmt: skip
def test_what_a_solution_allows_for(
    judged: Plausibility, request_: StarRequest, doubtful: bool
) -> None:
    """Wrong stars that are left out, or weigh little, do not spoil it; another mistake does."""
    assert implausible(judged, request_) == doubtful
    assert exit_status([SOLVED], judged, request_) == (3 if doubtful else 0)


# Photographs of stars solved: methods and pairs, judgements, cameras, and what is handed on


REQUEST = StarRequest(ImageAxes(focal_mm=76.0))
STARS = make_photograph(8)


def star_file_photographs(count: int = 8) -> StarFile:
    (file,) = read_star_csv(written(STARS[:count]), "a.csv")
    return file


def test_photographs_together_are_each_as_alone(tmp_path: Path) -> None:
    """To the last bit: of several numbers of stars, mirrored, with a wrong star and with two."""
    rng = np.random.default_rng(5)
    lines = []
    for k in range(14):
        for number, (x, y, ra, dec) in enumerate(make_photograph((8, 5, 3, 11)[k % 4])):
            wrong = 0.5 * (k > 9 and number in (1, 2 * k - 20))
            off = rng.normal(wrong, 0.004, 2)
            lines.append(f"{k},{x + off[0]},{(y + off[1]) * (-1.0 if k == 3 else 1.0)},{ra},{dec}")
    path = tmp_path / "a.csv"
    path.write_text("\n".join(["image,x_mm,y_mm,ra_deg,dec_deg", *lines]))
    together, _, _ = solve_photographs([str(path)], REQUEST)
    files = read_star_csv(path.read_text(), str(path))
    assert len(together) == len(files) == 14
    for one, file in zip(together, files, strict=True):
        alone = solve_photograph(file, REQUEST, one.label)
        assert (one.solved, one.findings) == (alone.solved, alone.findings)
    assert sum(bool(one.findings) for one in together) >= 4


METHODS = {
    2: ["collinearity", "two-star", "single-rotation", "svd"],
    3: ["collinearity", "church", "church-weighted", "church-weighted-r", "two-star",
        "single-rotation", "svd"],
}  # fmt: skip


@pytest.mark.parametrize("count", METHODS)
def test_all_methods(count: int) -> None:
    """Church's takes three stars."""
    found = solve_photograph(star_file_photographs(count), replace(REQUEST, method="all"), "x")
    assert [one.method for one in found.solved] == METHODS[count]
    assert found.label == "x" and found.used.tolist() == list(range(count))
    assert [kind for kind, _ in found.findings] == (["pair"] if count > 2 else [])
    assert found.epoch.startswith("ICRF") and (found.utc, found.local) == (None, None)
    assert {one.sky is not None and set(one.sky) == {"ra_deg", "ra_hours", "dec_deg"}
            for one in found.solved} == {True}  # fmt: skip


def test_a_solution_that_is_refused_is_not_shown() -> None:
    """It is an error of the photograph, and the status 1; the other methods stay."""
    asked = replace(REQUEST, method="church")
    flat = [(float(k), 0.0, -float(k), 0.0) for k in range(1, 5)]
    (file,) = read_star_csv(written(flat), "a.csv")
    found = solve_photograph(file, asked)
    assert (found.solved, found.status) == ((), 1)
    ((kind, said), *_) = found.findings
    assert kind == f"church: {Failure.GREAT_CIRCLE.name}"
    assert said.message.startswith("lines 2, 3, 4 and 5: church: the stars, or their")


# Star files from reading to output: labels, what fails of several, status, printouts


REQUEST_FILES = StarRequest(ImageAxes(focal_mm=76.0))


def files(folder: Path, *texts: str) -> list[str]:
    names = []
    for k, text in enumerate(texts):
        (folder / f"{k}.csv").write_text(text)
        names.append(str(folder / f"{k}.csv"))
    return names


GOOD_FILES = written(STARS)
NAMED = "image," + GOOD_FILES.replace("\n", "\nnight,").removesuffix("night,")
HUE = GOOD_FILES.replace("\n", ",1\n").replace("dec_deg,1", "dec_deg,hue")
TWO = NAMED + NAMED.split("\n", 1)[1].replace("night", "day")


def test_labels(tmp_path: Path) -> None:
    """The photograph's name; the file's of those without one of several; both where two agree."""
    bare, named, two = files(tmp_path, GOOD_FILES, NAMED, TWO)
    for names, labels in (
        ([bare], [""]), ([named], ["night"]), ([bare, bare], [bare, bare]),
        ([bare, named], [bare, "night"]), ([two], ["night", "day"]),
        ([named, two], [f"{named}: night", f"{two}: night", "day"]),
    ):  # fmt: skip
        photographs, *others = solve_photographs(names, REQUEST_FILES)
        assert [one.label for one in photographs] == labels
        assert others == [[], 0]


def test_what_fails_of_several(tmp_path: Path) -> None:
    """It is a finding in its turn, and the status 1; alone it is an error."""
    bad, good, one, hue = files(
        tmp_path, "x\n", GOOD_FILES, written(STARS[:1]), HUE
    )  # fmt: skip
    for alone in (bad, one):
        with pytest.raises(InputError):
            solve_photographs([alone], REQUEST_FILES)
    for names in ([bad, good], [good, bad], [one, good], [good, one]):
        photographs, (said,), status = solve_photographs(names, REQUEST_FILES)
        assert (len(photographs), status) == (1, 1)
        assert said.source in (bad, one) and said.severity == "error"
    photographs, findings, status = solve_photographs([bad, one], REQUEST_FILES)
    assert (photographs, status, len(findings)) == ([], 1, 2)
    _, (said,), status = solve_photographs([hue], REQUEST_FILES)
    assert (status, said.severity) == (0, "warning")


def test_a_file_that_needs_an_option_costs_no_other(tmp_path: Path) -> None:
    """Pixels need more than a focal length; of that file alone it is an error of the command."""
    pixels, good = files(tmp_path, GOOD_FILES.replace("_mm", "_px"), GOOD_FILES)
    with refused(MissingOption):
        solve_photographs([pixels], REQUEST_FILES)
    for names in ([pixels, good], [good, pixels]):
        (photograph,), (said,), status = solve_photographs(names, REQUEST_FILES)
        assert (photograph.label, said.severity, status) == (good, "error", 1)
        assert pixels in said.message


def test_failures_of_one_file(tmp_path: Path) -> None:
    """One photograph of two that cannot be solved, or read; and both."""
    head, *lines = TWO.splitlines()
    night, day = lines[:8], lines[8:]
    bad = [line.replace("night", "dusk") + "x" for line in night[:1]]
    for rows, decks, count in (
        (night + day[:1], 1, 1), (night + bad, 1, 1), (day[:1] + bad, 2, 0),
    ):  # fmt: skip
        (file,) = files(tmp_path, "\n".join([head, *rows]) + "\n")
        photographs, findings, status = solve_photographs([file], REQUEST_FILES)
        assert (len(photographs), status) == (count, 1)
        assert [one.source for one in findings] == [file] * decks
        assert [one.label for one in photographs] == ["night"] * count


def test_every_file_that_fails_is_said_first(tmp_path: Path) -> None:
    """They are of no kind of which there are many; warnings about solutions follow them."""
    (good,) = files(tmp_path, GOOD_FILES)
    names = [str(tmp_path / f"missing {k}.csv") for k in range(5)]
    request = replace(REQUEST_FILES, method="two-star")
    photographs, findings, _ = solve_photographs([*names, good], request)
    assert [one.source for one in findings] == [*names, good]
    assert [one.label for one in photographs] == [good]
    assert [one.severity for one in findings] == ["error"] * 5 + ["warning"]


def test_every_warning_about_a_star_is_said(tmp_path: Path) -> None:
    """They are of no kind of which there are many."""
    (long,) = files(tmp_path, "x_mm,y_mm,u,v,w\n" + "".join(
        f"{x},{y},{x / 38},{y / 38},-2\n" for x, y in ((1, 2), (9, -3), (-7, 5), (4, 11), (-2, -8))
    ))  # fmt: skip
    _, findings, status = solve_photographs([long], REQUEST_FILES)
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


def test_what_a_photograph_cannot_be_solved_with() -> None:
    """A camera's place is for ground points, and 5000 stars are the most."""
    placed = StarRequest(AXES, SkyRequest(), camera_m=(1.0, 2.0, 3.0))
    with refused(InputError):
        photograph_directions(star_file(), placed, lambda _: None)
    many = star_file(lines=tuple(range(2, 5003)))
    with refused(InputError):
        solve_photograph(many, StarRequest(AXES, SkyRequest()))
