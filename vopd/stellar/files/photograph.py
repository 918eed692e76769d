"""Solve one photograph: its stars, the methods that are asked for, and what is to be said."""

from __future__ import annotations

from dataclasses import replace
from itertools import chain

import numpy as np

from vopd.arrays import Ints
from vopd.findings import DeckError, Finding
from vopd.stellar.field import StarField
from vopd.stellar.files.counted_findings import KindOfFinding
from vopd.stellar.files.findings import explain, explain_plausibility
from vopd.stellar.files.mistakes import Plausibility, judge
from vopd.stellar.files.photograph_problem import PhotographProblem, photograph_problem
from vopd.stellar.files.photograph_status import exit_status, implausible, only_one_pair
from vopd.stellar.files.solved_calibration import SolvedCalibration, solve_calibration
from vopd.stellar.files.solved_photograph import SolvedPhotograph
from vopd.stellar.files.star_file import StarFile
from vopd.stellar.files.star_request import StarRequest
from vopd.stellar.interstar_angles import star_pairs
from vopd.stellar.methods.run import METHODS, refused, solve_by_methods
from vopd.stellar.methods.solved_stars import SolvedStars
from vopd.stellar.outlier_search import OutlierStart
from vopd.stellar.sky.file_sky import EQUATORIAL
from vopd.stellar.sky.sky_pointing import sky_pointing

MOST_STARS_IN_PAIRS = 200
"""How many stars are solved by all pairs, which then are 19,900."""


def solve_photograph(file: StarFile, request: StarRequest, label: str = "") -> SolvedPhotograph:
    """Solve one photograph.

    Args:
        file: its stars
        request: what to solve it for
        label: what tells it from others

    Raises:
        DeckError: no method can solve it.
        MissingOption: the file needs an option that is not given.
    """
    problem = photograph_problem(file, request)
    file, request, sky = problem.file, problem.request, problem.sky
    judged = _judged_as_read(problem)
    rejected = [outlier.star for outlier in judged.outliers] if request.rejects else []
    used = np.setdiff1d(np.arange(len(file.lines)), rejected)
    stars, solved, kinds = _solutions(problem, used)
    kinds = [*kinds, *(KindOfFinding(f"note {k}", one) for k, one in enumerate(problem.notes))]
    kinds += chain.from_iterable(explain(one, file, stars) for one in solved)
    kinds += only_one_pair(solved, file, request)
    kinds += explain_plausibility(judged, file, rejected=request.rejects)
    shown = [one for one in solved if not refused(one.failure)]
    if implausible(judged, request):  # an uncertainty from reading errors alone would mislead
        shown = [one.without_uncertainty() for one in shown]
    if sky is not None and file.kind in EQUATORIAL:
        mount = request.sky.mount
        shown = [
            replace(one, sky=sky_pointing(np.array(one.matrix), sky.frame, mount)) for one in shown
        ]
    dated = sky is not None and sky.frame is not None
    return SolvedPhotograph(
        label,
        file,
        stars,
        used,
        tuple(shown),
        tuple(kinds),
        exit_status(solved, judged, request),
        epoch=sky.epoch if sky else "",
        utc=request.sky.utc if dated else None,
        local=sky.frame.local if sky and sky.frame else None,
    )


def _judged_as_read(problem: PhotographProblem) -> Plausibility:
    """The test of the residuals, with the camera that fits all stars where one is solved."""
    file, request, stars = problem.file, problem.request, problem.stars
    if not request.free:
        return _judged(file, stars, request)
    try:
        camera = _calibrated(file, stars, np.arange(len(file.lines)), request)
    except DeckError as error:
        raise _with_mistake(error, _judged(file, stars, request)) from None
    return _judged(file, camera.stars, request)


def _solutions(
    problem: PhotographProblem, used: Ints
) -> tuple[StarField, list[SolvedStars], list[KindOfFinding]]:
    """The problem with its solutions, by what was asked for, and what is to be said of them."""
    file, request, stars = problem.file, problem.request, problem.stars
    if problem.position is not None:
        return stars, [problem.position.solved], problem.position.findings
    if request.free:
        camera = _calibrated(file, stars, used, request)
        return camera.stars, [camera.solved], camera.findings
    methods, pairs = _methods(file, request), _pairs(file, request)
    return stars, solve_by_methods(stars, methods, pairs, request.options, used), []


def _with_mistake(error: DeckError, judged: Plausibility) -> DeckError:
    """An error with the mistake that may be its reason."""
    if judged.mistake is None:
        return error
    found = error.finding
    return DeckError(replace(found, message=f"{found.message}; {judged.mistake.advice}"))


def _calibrated(
    file: StarFile, stars: StarField, used: Ints, request: StarRequest
) -> SolvedCalibration:
    sigma = request.options.reading_sigma_mm
    return solve_calibration(file, stars, used, request.free, request.axes, sigma)


def _judged(file: StarFile, stars: StarField, request: StarRequest) -> Plausibility:
    """The test of the residuals of all stars; none where a pair is asked for."""
    if request.pair is not None:
        return Plausibility(0.0)
    start: OutlierStart = "pairs" if request.edit_by_pairs else "interstar"
    return judge(file, stars, request.options.reading_sigma_mm, request.axes, start)


def _methods(file: StarFile, request: StarRequest) -> tuple[str, ...]:
    if request.method != "all":
        return (request.method,)
    few = len(file.lines) < 3
    return tuple(method for method in METHODS if not (few and method.startswith("church")))


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
