"""Read a star file, solve it, and make the output of `vopd stars solve`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.findings import DeckError, Finding
from vopd.stellar.failures import Failure
from vopd.stellar.files.input_text import read_text
from vopd.stellar.files.solution_findings import (
    KindOfFinding,
    counted,
    explain,
    explain_plausibility,
    refuse_unsolvable,
)
from vopd.stellar.files.solution_output import as_csv, as_json
from vopd.stellar.files.solution_text import as_text
from vopd.stellar.files.star_file import StarFile, file_directions, read_star_file
from vopd.stellar.files.usual_mistakes import Plausibility, judge
from vopd.stellar.interstar_angles import star_pairs
from vopd.stellar.methods.run_methods import (
    METHODS,
    ONLY_PAIRS,
    StarOptions,
    refused,
    solve_by_methods,
)
from vopd.stellar.methods.solved_stars import SolvedStars
from vopd.stellar.rae1987.stars_printout import LISTED_CORRECTIONS, stars_printout
from vopd.stellar.star_field import StarField

MOST_STARS_IN_PAIRS = 200
"""How many stars are solved by all pairs, which then are 19,900."""


@dataclass(frozen=True)
class StarRequest:
    """The options of `vopd stars solve`.

    Attributes:
        focal_length_mm: principal distance, mm
        method: one of METHODS, or "all"
        pair: solve these two stars only, counted from 1
        all_pairs: solve every pair
        reject: leave out stars that do not fit the others
        y_down: the file's y axis points down
        listing: write the printout of program STARS instead of the solutions
        camera_m: the camera's position, metres, for ground points
        options: how to solve
    """

    focal_length_mm: float
    method: str = "collinearity"
    pair: tuple[int, int] | None = None
    all_pairs: bool = False
    reject: bool = False
    y_down: bool = False
    listing: bool = False
    camera_m: tuple[float, ...] | None = None
    options: StarOptions = field(default_factory=StarOptions)


class StarOutput(NamedTuple):
    """The output of `vopd stars solve`: text, findings, and the exit status 0, 1 or 3."""

    text: str
    findings: tuple[Finding, ...]
    status: int


def solve_star_file(name: str, form: str, request: StarRequest) -> StarOutput:
    """Read a star file, solve it, and write its solutions.

    Args:
        name: the file's name; `-` is standard input
        form: "text", "json" or "csv"
        request: what to solve it for

    Returns:
        The output. A method that fails is a finding and leaves the others'
        solutions; the status is then 1, and 3 where a solution did not converge
        or the residuals are implausible.

    Raises:
        DeckError: the file cannot be read, or no method can solve it.
    """
    text, deck = read_text(name)
    notes: list[Finding] = []
    file = read_star_file(text, deck)
    image_mm = file.image_mm * [1.0, -1.0] if request.y_down else file.image_mm
    camera = _camera(file, request.camera_m)
    stars = StarField.of(
        file_directions(file, camera, notes.append), image_mm, request.focal_length_mm
    )
    refuse_unsolvable(file, stars)
    judged = _judged(file, stars, request)
    rejected = [outlier.star for outlier in judged.outliers] if request.reject else []
    used = np.setdiff1d(np.arange(len(file.lines)), rejected)
    solved = solve_by_methods(
        stars, _methods(file, request), _pairs(file, request), request.options, used
    )
    kinds = [KindOfFinding(str(k), finding) for k, finding in enumerate(notes)]
    kinds += chain.from_iterable(explain(one, file, stars) for one in solved)
    kinds += _only_one_pair(solved, file, request)
    kinds += explain_plausibility(judged, file, rejected=request.reject)
    shown = [one for one in solved if not refused(one.failure)]
    if _implausible(judged, request):  # an uncertainty from reading errors alone would mislead
        shown = [replace(one, rotation_sigma_arcsec=None) for one in shown]
    if request.listing:
        page = _listing(stars.only(used), request)
    elif form == "json":
        page = as_json(shown)
    elif form == "csv":
        page = as_csv(shown)
    else:
        page = as_text(shown, file, stars, robust=request.options.weights == "robust")
    return StarOutput(page, tuple(counted(kinds)), _status(solved, judged, request))


def _status(solved: Sequence[SolvedStars], judged: Plausibility, request: StarRequest) -> int:
    """1 where a method failed, 3 where one did not converge or the residuals are implausible."""
    failures = {one.failure for one in solved} - {Failure.NONE}
    by_residuals = {Failure.NO_CONVERGENCE}
    if judged.expected:
        by_residuals |= {Failure.TOO_UNCERTAIN, Failure.NOT_A_ROTATION}
    if failures - by_residuals:
        return 1
    return 3 if failures or _implausible(judged, request) else 0


def _implausible(judged: Plausibility, request: StarRequest) -> bool:
    """Whether the residuals are implausible, and not for stars that the solution allows for."""
    about_stars = judged.mistake is not None and bool(judged.mistake.stars)
    allowed_for = about_stars and (request.reject or request.options.weights == "robust")
    return bool(judged.expected) and not allowed_for


def _listing(stars: StarField, request: StarRequest) -> str:
    """The printout of program STARS; four corrections unless a number is asked for."""
    options = request.options
    return stars_printout(
        stars,
        initial_deg=options.initial_deg,
        start=options.start,
        weights=options.weights,
        corrections=options.corrections or LISTED_CORRECTIONS,
    )


def _judged(file: StarFile, stars: StarField, request: StarRequest) -> Plausibility:
    """The test of the residuals; two stars, or a pair that is asked for, have none."""
    if len(file.lines) < 3 or request.pair is not None:
        return Plausibility(0.0)
    return judge(file, stars, request.options.reading_sigma_mm, y_down=request.y_down)


def _methods(file: StarFile, request: StarRequest) -> tuple[str, ...]:
    if request.method != "all":
        return (request.method,)
    few = len(file.lines) < 3
    return tuple(method for method in METHODS if not (few and method.startswith("church")))


def _camera(file: StarFile, camera_m: tuple[float, ...] | None) -> Floats | None:
    ground = file.kind == "x_m,y_m,z_m"
    if ground and camera_m is None:
        raise DeckError(Finding("ground points need --camera X,Y,Z", deck=file.deck))
    if camera_m is not None and not ground:
        message = f"--camera is for ground points; the file has {file.kind}"
        raise DeckError(Finding(message, deck=file.deck))
    return None if camera_m is None else np.array(camera_m)


def _pairs(file: StarFile, request: StarRequest) -> Ints | None:
    count = len(file.lines)
    if request.all_pairs:
        if count > MOST_STARS_IN_PAIRS:
            message = f"{count} stars: all pairs are solved of {MOST_STARS_IN_PAIRS} at most"
            raise DeckError(Finding(message, deck=file.deck))
        return star_pairs(count)
    if request.pair is None:
        return None
    if max(request.pair) > count:
        message = f"there is no star {max(request.pair)}: the file ends with star {count}"
        raise file.error(message, count - 1)
    return np.array([request.pair]) - 1


def _only_one_pair(
    solved: Sequence[SolvedStars], file: StarFile, request: StarRequest
) -> list[KindOfFinding]:
    """A warning where a method for two stars has solved the first two of many."""
    if request.all_pairs or request.pair is not None or len(file.lines) < 3:
        return []
    alone = [one for one in solved if one.method in ONLY_PAIRS]
    if not alone:
        return []
    first, second = alone[0].stars
    message = (
        f"{' and '.join(one.method for one in alone)}: stars {first} and {second} of "
        f"{len(file.lines)}, as listed; --pair or --all-pairs for others"
    )
    return [KindOfFinding("pair", Finding(message, deck=file.deck, severity="warning"))]
