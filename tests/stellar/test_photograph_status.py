"""Exit status of a photograph, what a method for pairs leaves unsaid, and counts of findings."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from vopd.findings import Finding
from vopd.stellar.field import Failure
from vopd.stellar.files.findings import KindOfFinding, counted
from vopd.stellar.files.images import ImageAxes
from vopd.stellar.files.mistakes import Plausibility, UsualMistake
from vopd.stellar.files.photograph import StarRequest, exit_status, implausible, only_one_pair
from vopd.stellar.files.read import StarFile
from vopd.stellar.methods.run import SolvedStars, StarOptions

SOLVED = SolvedStars("svd", (1, 2), Failure.NONE, [], [], 0.0, [], 0, True, 0.0)
GOOD = Plausibility(0.1)
BAD = Plausibility(9.0, "much less is allowed")
BY_STARS = BAD._replace(mistake=UsualMistake("star 2 disagrees", 0.1, (1,)))
BY_UNITS = BAD._replace(mistake=UsualMistake("hours", 0.1))

PLAIN = StarRequest(ImageAxes(focal_mm=76.0))
REJECT, EDIT = replace(PLAIN, reject=True), replace(PLAIN, edit_by_pairs=True)
ROBUST = replace(PLAIN, options=StarOptions(weights="robust"))
LISTED = replace(PLAIN, options=StarOptions(weights="listed"))

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
        (BY_STARS, PLAIN, True), (BY_STARS, LISTED, True), (BY_STARS, REJECT, False),
        (BY_STARS, EDIT, False), (BY_STARS, ROBUST, False),
    ],
)  # fmt: skip
def test_what_a_solution_allows_for(
    judged: Plausibility, request_: StarRequest, doubtful: bool
) -> None:
    """Wrong stars that are left out, or weigh little, do not spoil it; another mistake does."""
    assert implausible(judged, request_) == doubtful
    assert exit_status([SOLVED], judged, request_) == (3 if doubtful else 0)


def star_file(count: int) -> StarFile:
    image = np.zeros((count, 2))
    return StarFile("a.csv", tuple(range(count)), ("",) * count, image, "mm", "name", image)


PAIR = replace(SOLVED, method="two-star", stars=(1, 2))
TURN = replace(SOLVED, method="single-rotation", stars=(1, 2))
SAID = "stars 1 and 2 of {}, as listed; --pair or --all-pairs for others"
ASKED: list[tuple[tuple[SolvedStars, ...], int, dict[str, Any], str]] = [
    ((PAIR,), 3, {}, "two-star: " + SAID.format(3)),
    ((SOLVED, PAIR, TURN), 9, {}, "two-star and single-rotation: " + SAID.format(9)),
    ((TURN, SOLVED), 4, {"reject": True}, "single-rotation: " + SAID.format(4)),
    ((PAIR,), 2, {}, ""),
    ((SOLVED,), 9, {}, ""),
    ((), 9, {}, ""),
    ((PAIR,), 9, {"all_pairs": True}, ""),
    ((PAIR,), 9, {"pair": (1, 2)}, ""),
]


@pytest.mark.parametrize(("solved", "count", "options", "said"), ASKED)
def test_the_first_two_stars_of_many(
    solved: tuple[SolvedStars, ...], count: int, options: dict[str, Any], said: str
) -> None:
    found = only_one_pair(solved, star_file(count), replace(PLAIN, **options))
    expected = [KindOfFinding("pair", Finding(said, deck="a.csv", severity="warning"))]
    assert found == (expected if said else [])


@pytest.mark.parametrize(
    ("reject", "edit", "rejects"),
    [(False, False, False), (True, False, True), (False, True, True), (True, True, True)],
)
def test_what_rejects_stars(reject: bool, edit: bool, rejects: bool) -> None:
    assert replace(PLAIN, reject=reject, edit_by_pairs=edit).rejects == rejects


def test_defaults_of_a_request() -> None:
    """As `vopd stars solve --help` has them."""
    asked = StarRequest(ImageAxes())
    assert (asked.method, asked.pair, asked.free) == ("collinearity", None, ())
    assert not (asked.all_pairs or asked.reject or asked.edit_by_pairs or asked.listing)
    assert (asked.resection, asked.camera_m, tuple(asked.errors)) == (False, None, (None, False))
    assert (asked.axes.y_down, asked.axes.k1) == (False, 0.0)
    sky = asked.sky
    assert (sky.utc, sky.place, sky.pressure_mbar, sky.temperature_c) == (None, None, None, 10.0)
    assert (sky.ephemeris, sky.catalogue, sky.mount) == (None, None, None)


def test_findings_of_several_kinds_and_files() -> None:
    """The three first of each in their order; then of each kind the others, with the last file."""
    given = [
        KindOfFinding(kind, Finding(f"{kind} {k}", f"{k}.csv", severity="warning"))
        for k in range(5)
        for kind in ("svd: axis", "plausibility", "pair")
    ]
    shown = counted(given)
    assert [one.message for one in shown] == [
        *(f"{kind} {k}" for k in range(3) for kind in ("svd: axis", "plausibility", "pair")),
        "plausibility 3", "plausibility 4", "svd: 2 more like these", "pair: 2 more like these",
    ]  # fmt: skip
    assert {one.deck for one in shown[-2:]} == {"4.csv"}
    assert {one.severity for one in shown} == {"warning"}
    assert counted([]) == []
