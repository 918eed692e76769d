"""Solve one photograph: its stars, the methods that are asked for, and what is to be said."""

from __future__ import annotations

from dataclasses import replace
from itertools import chain

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.findings import DeckError, Finding, Report
from vopd.stellar.files.counted_findings import KindOfFinding
from vopd.stellar.files.image_axes import MissingOption, centred_images
from vopd.stellar.files.photograph_status import exit_status, implausible, only_one_pair
from vopd.stellar.files.plausibility import Plausibility, judge
from vopd.stellar.files.reading_errors import ReadingErrors, reading_errors
from vopd.stellar.files.solution_findings import (
    explain,
    explain_plausibility,
    refuse_unsolvable,
)
from vopd.stellar.files.solved_calibration import SolvedCalibration, solve_calibration
from vopd.stellar.files.solved_photograph import SolvedPhotograph
from vopd.stellar.files.solved_resection import solve_resection
from vopd.stellar.files.star_file import MOST_STARS, StarFile, file_directions
from vopd.stellar.files.star_request import StarRequest
from vopd.stellar.interstar_angles import star_pairs
from vopd.stellar.methods.run_methods import (
    METHODS,
    refused,
    solve_by_methods,
)
from vopd.stellar.outlier_search import OutlierStart
from vopd.stellar.sky.file_sky import EQUATORIAL, FileSky, needs_no_date, sky_directions
from vopd.stellar.sky.sky_pointing import sky_pointing
from vopd.stellar.star_field import StarField

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
    if len(file.lines) > MOST_STARS:
        raise file.error(f"more than {MOST_STARS} stars in one photograph", MOST_STARS)
    notes: list[Finding] = []
    if file.utc is not None:
        request = replace(request, sky=replace(request.sky, utc=file.utc))
    images = centred_images(file, request.axes)
    kinds: list[KindOfFinding] = []
    sky: FileSky | None = None
    if not request.resection:
        sky = _sky(file, request, notes.append)
        if file.magnitude is None:
            file = replace(file, magnitude=sky.magnitude)
    errors = reading_errors(file, request.errors, flipped=request.axes.flipped(file))
    request = _with_errors(request, errors, file)
    if sky is None:
        position = solve_resection(file, images, errors, request.options.reading_sigma_mm)
        stars, solved, kinds = position.stars, [position.solved], position.findings
    else:
        stars = StarField.of(sky.directions, images.points, images.focal, errors=errors.relative)
    refuse_unsolvable(file, stars)
    as_read = stars
    if request.free:
        try:
            stars = _calibrated(file, as_read, np.arange(len(file.lines)), request).stars
        except DeckError as error:
            raise _with_mistake(error, _judged(file, as_read, request)) from None
    judged = _judged(file, stars, request)
    rejected = [outlier.star for outlier in judged.outliers] if request.rejects else []
    used = np.setdiff1d(np.arange(len(file.lines)), rejected)
    if request.free:
        camera = _calibrated(file, as_read, used, request)
        stars, solved, kinds = camera.stars, [camera.solved], camera.findings
    elif not request.resection:
        solved = solve_by_methods(
            stars, _methods(file, request), _pairs(file, request), request.options, used
        )
    kinds += [KindOfFinding(f"note {k}", finding) for k, finding in enumerate(notes)]
    kinds += chain.from_iterable(explain(one, file, stars) for one in solved)
    kinds += only_one_pair(solved, file, request)
    kinds += explain_plausibility(judged, file, rejected=request.rejects)
    shown = [one for one in solved if not refused(one.failure)]
    if implausible(judged, request):  # an uncertainty from reading errors alone would mislead
        shown = [one.without_uncertainty() for one in shown]
    status = exit_status(solved, judged, request)
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
        status,
        epoch=sky.epoch if sky else "",
        utc=request.sky.utc if dated else None,
        local=sky.frame.local if sky and sky.frame else None,
    )


def _sky(file: StarFile, request: StarRequest, report: Report) -> FileSky:
    """The directions of the stars, or of the ground points."""
    sky = request.sky
    if sky.utc is None and (sky.place is not None or sky.ephemeris is not None):
        option = "--place" if sky.place is not None else "--ephemeris"
        raise MissingOption(f"{file.deck}: {option} needs --date, or a column utc")
    if sky.mount is not None and sky.place is None:
        raise MissingOption(f"{file.deck}: --mount needs --place, for the vehicle's yaw and pitch")
    if file.kind in EQUATORIAL:
        if request.camera_m is not None:
            raise file.error(f"--camera is for ground points; the file has {file.kind}")
        return sky_directions(file, request.sky, report)
    wrong = needs_no_date(file, request.sky)
    if wrong is not None:
        raise DeckError(wrong)
    directions = file_directions(file, _camera(file, request.camera_m), report)
    return FileSky(directions, None, "the axes of u, v, w" if file.kind == "u,v,w" else "")


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


def _with_errors(request: StarRequest, errors: ReadingErrors, file: StarFile) -> StarRequest:
    """The request with the reading sigma that the file states."""
    options = request.options
    if errors.relative is not None and options.weights == "listed":
        raise file.error("--weights listed knows no columns of sigma, and no other errors")
    if errors.sigma is None:
        return request
    if options.reading_sigma_mm is not None:
        raise file.error("the file has standard deviations: no --reading-sigma")
    return replace(request, options=replace(options, reading_sigma_mm=errors.sigma))


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


def _camera(file: StarFile, camera_m: tuple[float, ...] | None) -> Floats | None:
    ground = file.kind == "x_m,y_m,z_m"
    if ground and camera_m is None:
        raise DeckError(
            Finding("ground points need --camera X,Y,Z, or --resection", deck=file.deck)
        )
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
