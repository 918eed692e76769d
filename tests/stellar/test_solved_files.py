"""Star files from reading to output: what is handed on to each step, labels, status, printouts."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.kit.star_photographs import photograph as make_photograph
from tests.kit.star_photographs import written
from vopd.findings import DeckError, Finding
from vopd.stellar.failures import Failure
from vopd.stellar.files import photograph, solve_star_file
from vopd.stellar.files.counted_findings import KindOfFinding
from vopd.stellar.files.image_axes import ImageAxes, MissingOption
from vopd.stellar.files.mistake_trials import UsualMistake
from vopd.stellar.files.photograph import solve_photograph
from vopd.stellar.files.photograph_problem import photograph_problem
from vopd.stellar.files.plausibility import Plausibility
from vopd.stellar.files.solve_star_file import solution_text, solve_photographs
from vopd.stellar.files.solved_calibration import SolvedCalibration
from vopd.stellar.files.solved_resection import SolvedResection
from vopd.stellar.files.star_csv import read_star_csv
from vopd.stellar.files.star_file import StarFile
from vopd.stellar.files.star_request import StarRequest
from vopd.stellar.methods.run_methods import StarOptions
from vopd.stellar.outlier_search import Outlier

REQUEST = StarRequest(ImageAxes(focal_mm=76.0))
STARS = make_photograph(8)


def star_file(count: int = 8) -> StarFile:
    (file,) = read_star_csv(written(STARS[:count]), "a.csv")
    return file


METHODS = {
    2: ["collinearity", "two-star", "single-rotation", "svd"],
    3: ["collinearity", "church", "church-weighted", "church-weighted-r", "two-star",
        "single-rotation", "svd"],
}  # fmt: skip


@pytest.mark.parametrize("count", METHODS)
def test_all_methods(count: int) -> None:
    """Church's takes three stars."""
    found = solve_photograph(star_file(count), replace(REQUEST, method="all"), "x")
    assert [one.method for one in found.solved] == METHODS[count]
    assert found.label == "x" and found.used.tolist() == list(range(count))
    assert [one.kind for one in found.findings] == (["pair"] if count > 2 else [])
    assert found.epoch.startswith("ICRF") and (found.utc, found.local) == (None, None)
    assert {one.sky is not None and set(one.sky) == {"ra_deg", "ra_hours", "dec_deg"}
            for one in found.solved} == {True}  # fmt: skip


@pytest.mark.parametrize("pair", [(1, 8), (8, 1), (3, 2)])
def test_a_pair(monkeypatch: pytest.MonkeyPatch, pair: tuple[int, int]) -> None:
    """In the order in which it is asked for; its residuals are judged by nobody."""
    monkeypatch.setattr(photograph, "judge", lambda *given: BAD_STAR)
    found = solve_photograph(star_file(), replace(REQUEST, method="svd", pair=pair))
    assert [one.stars for one in found.solved] == [pair] and found.findings == ()
    for k in (0, 1):
        beyond = (9, 1) if k else (1, 9)
        with pytest.raises(DeckError) as caught:
            solve_photograph(star_file(), replace(REQUEST, pair=beyond))
        said = "a.csv: line 9: there is no star 9: the file ends with star 8"
        assert str(caught.value) == said


def test_all_pairs_are_of_200_stars_at_most(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = replace(REQUEST, method="svd", all_pairs=True)
    found = solve_photograph(star_file(3), asked)
    assert [one.stars for one in found.solved] == [(1, 2), (1, 3), (2, 3)]
    image = np.zeros((201, 2))
    for count in (200, 201):
        file = StarFile("a.csv", tuple(range(count)), ("",) * count, image, "mm", "name", image)
        if count == 200:
            pairs = photograph._pairs(file, asked)
            assert pairs is not None and len(pairs) == 19_900
            continue
        with pytest.raises(DeckError) as caught:
            photograph._pairs(file, asked)
        assert str(caught.value) == "a.csv: 201 stars: all pairs are solved of 200 at most"


BAD_STAR = Plausibility(
    9.0, "less", UsualMistake("star 3 disagrees", 0.1, (2,)), (Outlier(2, 5.0, 1e-9),)
)
JUDGED = {
    "good": (Plausibility(0.1), {}, True, 0, 8),
    "bad": (Plausibility(9.0, "less", unexplained="why?"), {}, False, 3, 8),
    "star": (BAD_STAR, {}, False, 3, 8),
    "rejected": (BAD_STAR, {"reject": True}, True, 0, 7),
    "edited": (BAD_STAR, {"edit_by_pairs": True}, True, 0, 7),
    "robust": (BAD_STAR, {"options": StarOptions(weights="robust")}, True, 0, 8),
}


@pytest.mark.parametrize("name", JUDGED)
def test_what_a_judgement_changes(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """Implausible residuals leave no statement of uncertainty; stars that do not fit may go."""
    judged, options, certain, status, count = JUDGED[name]
    monkeypatch.setattr(photograph, "judge", lambda *given: judged)
    found = solve_photograph(star_file(), replace(REQUEST, **options))
    (one,) = found.solved
    assert (one.rotation_sigma_arcsec is not None) == certain
    assert (found.status, len(found.used), len(one.stars)) == (status, count, count)
    assert (3 in one.stars) == (count == 8)
    said = [one.finding.message for one in found.findings]
    assert any("is left out" in text for text in said) == (count == 7)
    assert any("implausible" in text for text in said) == (name in ("bad", "star", "robust"))
    assert {one.kind for one in found.findings} <= {"plausibility"}


@pytest.mark.parametrize("edit", [False, True])
@pytest.mark.parametrize("sigma", [None, 0.01])
def test_what_is_judged(monkeypatch: pytest.MonkeyPatch, edit: bool, sigma: float | None) -> None:
    """All stars, by the sigma that was stated, and from the half that was asked for."""
    given: list[Any] = []

    def judge(*arguments: Any) -> Plausibility:
        given.append(arguments)
        return Plausibility(0.1)

    monkeypatch.setattr(photograph, "judge", judge)
    options = StarOptions(reading_sigma_mm=sigma)
    solve_photograph(star_file(), replace(REQUEST, edit_by_pairs=edit, options=options))
    ((file, stars, stated, axes, start),) = given
    assert (len(file.lines), stars.used.sum(), stated, axes) == (8, 8, sigma, REQUEST.axes)
    assert start == ("pairs" if edit else "interstar")


def test_a_solved_camera(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is judged by the stars as that camera of all of them sees them."""
    seen: list[Any] = []
    monkeypatch.setattr(photograph, "judge", lambda *given: seen.append(given[1]) or BAD_STAR)
    off = [(x * 1.25, y * 1.25, ra, dec) for x, y, ra, dec in STARS]
    (file,) = read_star_csv(written(off), "a.csv")
    found = solve_photograph(file, replace(REQUEST, free=("focal",), reject=True))
    (one,) = found.solved
    assert one.camera is not None and one.stars == (1, 2, 4, 5, 6, 7, 8)
    for stars in (seen[0], found.stars):
        assert round(float(stars.focal_length_mm[0])) == 95
    assert seen[0].focal_length_mm[0] != found.stars.focal_length_mm[0]  # of all stars, of seven
    assert one.reading_freedom == 2 * 7 - 3 - 1
    stated = replace(REQUEST, free=("focal",), options=StarOptions(reading_sigma_mm=0.5))
    (known,) = solve_photograph(file, stated).solved
    assert (known.reading_sigma, known.reading_freedom) == (0.5, None)


def test_what_is_said_of_a_camera_or_a_position(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is handed on, with the stars as they are solved."""
    problem = photograph_problem(star_file(), REQUEST)
    (solved,) = solve_photograph(star_file(), REQUEST).solved
    said = [KindOfFinding("x", Finding("x"))]
    other = problem.stars.only(np.arange(5))
    position = problem._replace(position=SolvedResection(other, solved, said))
    found = photograph._solutions(position, np.arange(8))
    assert (found[0] is problem.stars, found[1:]) == (True, ([solved], said))
    camera = SolvedCalibration(other, solved, said)
    monkeypatch.setattr(photograph, "solve_calibration", lambda *given: camera)
    free = problem._replace(request=replace(REQUEST, free=("k1",)))
    found = photograph._solutions(free, np.arange(8))
    assert (found[0] is other, found[1:]) == (True, ([solved], said))


def test_an_unsolvable_camera_is_said_with_the_mistake(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = replace(REQUEST, free=("focal", "k1"))
    for judged, end in ((BAD_STAR, "; star 3 disagrees"), (Plausibility(0.1), "")):
        monkeypatch.setattr(photograph, "judge", lambda *given, judged=judged: judged)
        with pytest.raises(DeckError) as caught:
            solve_photograph(star_file(2), asked)
        assert str(caught.value) == f"a.csv: --free focal,k1 takes 3 stars at least{end}"


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
        with pytest.raises(DeckError):
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
        initial_deg=(1.0, 2.0, 3.0), start="two-star", weights="listed", corrections=7
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
        },
    )
    solution_text([one], "text", replace(REQUEST, listing=True))
    assert given[2][1]["corrections"] == 4


def test_a_solution_that_is_refused_is_not_shown() -> None:
    """It is an error of the photograph, and the status 1; the other methods stay."""
    asked = replace(REQUEST, method="church")
    flat = [(float(k), 0.0, -float(k), 0.0) for k in range(1, 5)]
    (file,) = read_star_csv(written(flat), "a.csv")
    found = solve_photograph(file, asked)
    assert (found.solved, found.status) == ((), 1)
    (said, *_) = found.findings
    assert said.kind == f"church: {Failure.GREAT_CIRCLE.name}"
    assert said.finding.message.startswith("lines 2, 3, 4 and 5: church: the stars, or their")
