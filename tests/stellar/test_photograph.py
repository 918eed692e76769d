"""Photographs: problem, solutions and exit status."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.kit.stars import photograph as make_photograph
from tests.kit.stars import written
from tests.tolerances import assert_close
from vopd.findings import Finding
from vopd.mistakes import Explanation
from vopd.stellar.field import Failure, star_directions
from vopd.stellar.files.images import ImageAxes
from vopd.stellar.files.mistakes import Plausibility
from vopd.stellar.files.photograph import (
    StarRequest,
    exit_status,
    implausible,
    photograph_directions,
    solve_photograph,
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
    for kind, more, epoch in (
        ("ra_deg,dec_deg", {}, "ICRF axes (J2000), stars as the file has them: no proper motion, "
         "aberration or refraction"),
        ("u,v,w", {}, "the axes of u, v, w"),
        ("x_m,y_m,z_m", {"camera_m": (10.0, 20.0, 0.0)}, ""),
    ):  # fmt: skip
        sky = photograph_directions(star_file(kind), request(**more), found.append)
        assert (sky.epoch, sky.frame, sky.magnitude) == (epoch, None, None)
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
