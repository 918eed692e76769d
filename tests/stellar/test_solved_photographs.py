"""Photographs of stars solved: methods and pairs, judgements, cameras, and what is handed on."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.kit.star_photographs import photograph as make_photograph
from tests.kit.star_photographs import written
from vopd.findings import Finding, InputError
from vopd.stellar.field import Failure
from vopd.stellar.files import photograph
from vopd.stellar.files.findings import KindOfFinding
from vopd.stellar.files.images import ImageAxes
from vopd.stellar.files.mistakes import Plausibility, UsualMistake
from vopd.stellar.files.photograph import (
    SolvedCalibration,
    SolvedResection,
    StarRequest,
    photograph_problem,
    solve_photograph,
)
from vopd.stellar.files.read import StarFile, read_star_csv
from vopd.stellar.methods.run import StarOptions
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
        with pytest.raises(InputError) as caught:
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
        with pytest.raises(InputError) as caught:
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
        with pytest.raises(InputError) as caught:
            solve_photograph(star_file(2), asked)
        assert str(caught.value) == f"a.csv: --free focal,k1 takes 3 stars at least{end}"


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
