"""The solution of one photograph, by the methods of a request."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime
from itertools import chain
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.findings import Finding, InputError, Report
from vopd.stellar.field import REASONS, Failure, StarField, ground_directions
from vopd.stellar.files.findings import (
    KindOfFinding,
    explain,
    explain_plausibility,
    refuse_unsolvable,
)
from vopd.stellar.files.images import (
    CentredImages,
    ErrorModel,
    ImageAxes,
    MissingOption,
    ReadingErrors,
    centred_images,
    in_file_coordinates,
    reading_errors,
)
from vopd.stellar.files.mistakes import Plausibility, judge
from vopd.stellar.files.read import MOST_STARS, StarFile, file_directions
from vopd.stellar.interstar_angles import star_pairs
from vopd.stellar.methods.calibration import (
    PARAMETERS,
    Calibration,
    LensOfStars,
    calibrate_from_both_starts,
    without_lens,
)
from vopd.stellar.methods.resection import LEAST, LIMIT, resection
from vopd.stellar.methods.run import (
    METHODS,
    ONLY_PAIRS,
    ReadingScale,
    SolvedStars,
    StarOptions,
    refused,
    solve_by_methods,
    split_solutions,
)
from vopd.stellar.outlier_search import OutlierStart
from vopd.stellar.sky import (
    EQUATORIAL,
    FileSky,
    SkyRequest,
    needs_no_date,
    sky_directions,
    sky_pointing,
)
from vopd.stellar.solution import StarSolution


@dataclass(frozen=True)
class StarRequest:
    """The options of `vopd stars solve`.

    Attributes:
        axes: how image coordinates are read, and the principal distance
        method: one of METHODS, or "all"
        pair: solve these two stars only, counted from 1
        all_pairs: solve every pair
        reject: leave out stars that do not fit the others
        edit_by_pairs: find those stars by the attitudes of all pairs
        errors: how the reading error of a star depends on the star
        listing: write the printout of program STARS instead of the solutions
        camera_m: the camera's position, metres, for ground points
        resection: solve the camera's position too
        sky: date and place of the photograph, and files about stars
        free: what of the camera is solved with the attitude: focal, centre, k1
        options: how to solve
    """

    axes: ImageAxes
    method: str = "collinearity"
    pair: tuple[int, int] | None = None
    all_pairs: bool = False
    reject: bool = False
    edit_by_pairs: bool = False
    errors: ErrorModel = field(default_factory=ErrorModel)
    listing: bool = False
    camera_m: tuple[float, ...] | None = None
    resection: bool = False
    sky: SkyRequest = field(default_factory=SkyRequest)
    free: tuple[str, ...] = ()
    options: StarOptions = field(default_factory=StarOptions)

    @property
    def rejects(self) -> bool:
        """Whether stars that do not fit the others are left out."""
        return self.reject or self.edit_by_pairs


# Directions


def photograph_directions(file: StarFile, request: StarRequest, report: Report) -> FileSky:
    """Find the directions of the stars, or of the ground points.

    Args:
        file: the photograph
        request: date, place and camera position
        report: takes warnings

    Raises:
        MissingOption: an option needs another one.
        InputError: an option is not for this kind of file, or a direction cannot be found.
    """
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
        raise InputError(wrong)
    directions = file_directions(file, _camera(file, request.camera_m), report)
    return FileSky(directions, None, "the axes of u, v, w" if file.kind == "u,v,w" else "")


def _camera(file: StarFile, camera_m: tuple[float, ...] | None) -> Floats | None:
    ground = file.kind == "x_m,y_m,z_m"
    if ground and camera_m is None:
        raise InputError(
            Finding("ground points need --camera X,Y,Z, or --resection", deck=file.deck)
        )
    if camera_m is not None and not ground:
        message = f"--camera is for ground points; the file has {file.kind}"
        raise InputError(Finding(message, deck=file.deck))
    return None if camera_m is None else np.array(camera_m)


# Resection: position and attitude together

RESECTION_METHOD = "resection"


class SolvedCamera(NamedTuple):
    """A photograph solved with its camera's position or lens.

    Attributes:
        stars: the problem with the camera found: points as directions, or images without the lens
        solved: the solution
        findings: warnings about it
    """

    stars: StarField
    solved: SolvedStars
    findings: list[KindOfFinding]


def solve_resection(
    file: StarFile, images: CentredImages, errors: ReadingErrors, reading_sigma: float | None
) -> SolvedCamera:
    """Find the camera's position and attitude.

    Args:
        file: the ground points
        images: their images
        errors: of the images
        reading_sigma: standard deviation of an image coordinate; None: from the residuals

    Raises:
        InputError: the file has no ground points, or too few, or there is no solution.
    """
    count = len(file.lines)
    if file.kind != "x_m,y_m,z_m":
        raise file.error(f"--resection is for ground points; the file has {file.kind}")
    if count < LEAST:
        raise file.error(f"--resection takes {LEAST} points at least, the file has {count}")
    found = resection(file.positions, images.points, images.focal, errors.relative)
    if found.failure != Failure.NONE:
        text = REASONS[found.failure]
        text += f" in {LIMIT} corrections" if found.failure == Failure.NO_CONVERGENCE else ""
        raise file.error(f"{RESECTION_METHOD}: {text}")
    directions = ground_directions(file.positions, found.position)
    stars = StarField.of(directions, images.points, images.focal, errors=errors.relative)
    reading = ReadingScale(reading_sigma or 0.0, None, reading_sigma or 0.0)
    if reading_sigma is None:
        square = float((stars.whitened(found.residuals) ** 2).sum())
        sigma = float(np.sqrt(square / (2 * count - 6)))  # six unknowns
        reading = ReadingScale(sigma, 2 * count - 6, sigma)
    solution = StarSolution(
        found.matrix[None],
        np.array([Failure.NONE]),
        np.array([found.iterations]),
        np.array([True]),
    )
    everyone = np.arange(count)[None]
    (solved,) = split_solutions(
        RESECTION_METHOD, solution, stars.select(everyone), everyone, "nearest", reading,
        found.covariance[None, :3, :3], None, robust=False,
    )  # fmt: skip
    solved = replace(
        solved,
        camera_m=found.position.tolist(),
        camera_sigma_m=(np.sqrt(np.diagonal(found.covariance)[3:]) * reading.sigma).tolist(),
    )
    return SolvedCamera(stars, solved, _second(found.second, file))


def _second(position: Floats | None, file: StarFile) -> list[KindOfFinding]:
    """Warn if the points look nearly the same from another position."""
    if position is None:
        return []
    listed = ", ".join(f"{value:.1f}" for value in position)
    text = (
        f"{RESECTION_METHOD}: the points fit as well from {listed}: give more points, or --camera"
    )
    return [KindOfFinding(RESECTION_METHOD, file.finding(text).warned())]


# The problem: directions, images, and their errors


class PhotographProblem(NamedTuple):
    """A photograph to solve.

    Attributes:
        file: its stars
        request: what to solve it for, with the date and the reading sigma of the file
        stars: the problem, its images as they were read
        sky: the sky of the stars; None where the camera's position is solved too
        position: that solution
        notes: warnings about the stars
    """

    file: StarFile
    request: StarRequest
    stars: StarField
    sky: FileSky | None
    position: SolvedCamera | None
    notes: list[Finding]


def photograph_problem(file: StarFile, request: StarRequest) -> PhotographProblem:
    """Find the directions of a photograph's stars, and read their images as the options say.

    Args:
        file: its stars
        request: what to solve it for

    Raises:
        InputError: no method can solve it.
        MissingOption: the file needs an option that is not given.
    """
    if len(file.lines) > MOST_STARS:
        raise file.error(f"more than {MOST_STARS} stars in one photograph", MOST_STARS)
    notes: list[Finding] = []
    if file.utc is not None:
        request = replace(request, sky=replace(request.sky, utc=file.utc))
    images = centred_images(file, request.axes)
    sky = None if request.resection else photograph_directions(file, request, notes.append)
    if sky is not None and file.magnitude is None:
        file = replace(file, magnitude=sky.magnitude)
    errors = reading_errors(file, request.errors, flipped=request.axes.flipped(file))
    request = _with_errors(request, errors, file)
    position = None
    if sky is None:
        position = solve_resection(file, images, errors, request.options.reading_sigma_mm)
        stars = position.stars
    else:
        stars = StarField.of(sky.directions, images.points, images.focal, errors=errors.relative)
    refuse_unsolvable(file, stars)
    return PhotographProblem(file, request, stars, sky, position, notes)


def _with_errors(request: StarRequest, errors: ReadingErrors, file: StarFile) -> StarRequest:
    """Add the reading sigma that the file states to the request."""
    options = request.options
    if errors.relative is not None and options.weights == "listed":
        raise file.error("--weights listed knows no columns of sigma, and no other errors")
    if errors.sigma is None:
        return request
    if options.reading_sigma_mm is not None:
        raise file.error("the file has standard deviations: no --reading-sigma")
    return replace(request, options=replace(options, reading_sigma_mm=errors.sigma))


# Exit status


def exit_status(solved: Sequence[SolvedStars], judged: Plausibility, request: StarRequest) -> int:
    """Choose the exit status: 1 if a method failed, 3 if not converged or implausible."""
    failures = {one.failure for one in solved} - {Failure.NONE}
    by_residuals = {Failure.NO_CONVERGENCE}
    if judged.expected:
        by_residuals |= {Failure.TOO_UNCERTAIN, Failure.NOT_A_ROTATION}
    if failures - by_residuals:
        return 1
    return 3 if failures or implausible(judged, request) else 0


def implausible(judged: Plausibility, request: StarRequest) -> bool:
    """Test whether residuals are implausible, other than by stars that the solution allows for."""
    allowed_for = judged.about_stars and (request.rejects or request.options.weights == "robust")
    return bool(judged.expected) and not allowed_for


def only_one_pair(
    solved: Sequence[SolvedStars], file: StarFile, request: StarRequest
) -> list[KindOfFinding]:
    """Warn if a method for two stars has solved the first two of many."""
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


@dataclass(frozen=True, eq=False)
class SolvedPhotograph:
    """One photograph with its solutions.

    Attributes:
        label: what tells it from others; empty where it is the only one
        file: its stars as they were read
        stars: its problem
        used: the stars that are not rejected, counted from 0
        solved: the solutions to show
        findings: errors and warnings
        status: exit status 0, 1 or 3
        epoch: what right ascensions and declinations refer to; empty for ground points
        utc: when it was taken, if that is known
        local: from ICRF axes to east, north, up at the place, (3, 3), if these are known
    """

    label: str
    file: StarFile
    stars: StarField
    used: Ints
    solved: tuple[SolvedStars, ...]
    findings: tuple[KindOfFinding, ...]
    status: int
    epoch: str = ""
    utc: datetime | None = None
    local: Floats | None = None


# Calibration: the lens with the attitude

METHOD = "collinearity"

LARGEST_GROWTH = 10.0
"""Growth of the attitude's standard deviation from which the stars do not hold the camera."""

LARGEST_SIGMA = 0.01
"""Standard deviation of focal, centre or k1, in principal distances, from which they do not."""


def solve_calibration(
    file: StarFile,
    stars: StarField,
    used: Ints,
    free: tuple[str, ...],
    axes: ImageAxes,
    reading_sigma: float | None,
) -> SolvedCamera:
    """Solve attitude and camera.

    Args:
        file: the photograph
        stars: its problem, with images as they were read
        used: the stars to solve, counted from 0
        free: names of PARAMETERS
        axes: how the image coordinates were read
        reading_sigma: standard deviation of an image coordinate; None: from the residuals

    Raises:
        InputError: too few stars, or there is no solution.
    """
    unknowns = tuple(name for one in PARAMETERS if one in free for name in PARAMETERS[one])
    needed = (3 + len(unknowns)) // 2 + 1
    if len(used) < needed:
        raise file.error(f"--free {','.join(free)} takes {needed} stars at least")
    some = stars.only(used)
    found = calibrate_from_both_starts(some, unknowns)
    if found.failure != Failure.NONE:
        raise file.error(f"--free {','.join(free)}: {_reason(found.failure)}")
    points = without_lens(stars.image_mm, found.lens)
    if not np.isfinite(points).all():
        raise file.error(f"--free {','.join(free)}: the lens that fits best cannot be inverted")
    corrected = replace(
        stars,
        image_mm=points,
        focal_length_mm=np.full_like(stars.focal_length_mm, found.lens.focal),
    )
    sigma = reading_sigma or float(np.sqrt(found.variance))
    reading = ReadingScale(sigma, found.freedom if reading_sigma is None else None, sigma)
    solution = StarSolution(
        found.matrix[None],
        np.array([Failure.NONE]),
        np.array([found.iterations]),
        np.array([True]),
    )
    (solved,) = split_solutions(
        METHOD, solution, corrected.select(used[None]), used[None], "nearest", reading,
        found.covariance[None, :3, :3], None, robust=False,
    )  # fmt: skip
    deviations = np.sqrt(np.diagonal(found.covariance)[3:]) * sigma
    sigmas = dict(zip(unknowns, deviations.tolist(), strict=True))
    shown = {name: _shown(name, found.lens, file, axes) for name in unknowns}
    solved = replace(solved, camera=shown, camera_sigmas=sigmas)
    return SolvedCamera(corrected, solved, _doubts(found, sigmas, file))


def _reason(failure: Failure) -> str:
    text = REASONS[failure]
    return "the stars do not determine it" if failure == Failure.SINGULAR else text


def _shown(name: str, lens: LensOfStars, file: StarFile, axes: ImageAxes) -> float:
    """Convert an unknown for output; the principal point to the file's own coordinates."""
    if name.startswith("centre"):
        point = in_file_coordinates(np.array([lens.centre_x, lens.centre_y]), file, axes)
        return float(point[0 if name == "centre_x" else 1])
    return float(getattr(lens, name))


def _and(names: tuple[str, ...]) -> str:
    """Join names in words: `a`, `a and b`, `a, b and c`."""
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last


def _doubts(found: Calibration, sigmas: dict[str, float], file: StarFile) -> list[KindOfFinding]:
    """Warn if the stars cannot hold the camera."""
    texts = []
    if found.growth > LARGEST_GROWTH:
        texts.append(
            f"the stars can hardly tell {_and(found.free)} from a turn of the camera: "
            f"the standard deviation of the attitude is {found.growth:.0f} times as large as "
            "with a known camera"
        )
    for name, sigma in sigmas.items():
        unit = 1.0 if name == "k1" else found.lens.focal
        if sigma > LARGEST_SIGMA * unit:
            suffix = "" if name == "k1" else f" {file.unit}"
            texts.append(
                f"the stars do not hold {name}: its standard deviation is {sigma:.3g}{suffix}"
            )
    return [
        KindOfFinding(f"calibration {k}", file.finding(text).warned())
        for k, text in enumerate(texts)
    ]


# The photograph

MOST_STARS_IN_PAIRS = 200
"""How many stars are solved by all pairs, which then are 19,900."""


def solve_photograph(file: StarFile, request: StarRequest, label: str = "") -> SolvedPhotograph:
    """Solve one photograph.

    Args:
        file: its stars
        request: what to solve it for
        label: what tells it from others

    Raises:
        InputError: no method can solve it.
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
    """Test the residuals, with the camera that fits all stars if one is solved."""
    file, request, stars = problem.file, problem.request, problem.stars
    if not request.free:
        return _judged(file, stars, request)
    try:
        camera = _calibrated(file, stars, np.arange(len(file.lines)), request)
    except InputError as error:
        raise _with_mistake(error, _judged(file, stars, request)) from None
    return _judged(file, camera.stars, request)


def _solutions(
    problem: PhotographProblem, used: Ints
) -> tuple[StarField, list[SolvedStars], list[KindOfFinding]]:
    """Solve the problem by the methods of the request, with findings about the solutions."""
    file, request, stars = problem.file, problem.request, problem.stars
    if problem.position is not None:
        return stars, [problem.position.solved], problem.position.findings
    if request.free:
        camera = _calibrated(file, stars, used, request)
        return camera.stars, [camera.solved], camera.findings
    methods, pairs = _methods(file, request), _pairs(file, request)
    return stars, solve_by_methods(stars, methods, pairs, request.options, used), []


def _with_mistake(error: InputError, judged: Plausibility) -> InputError:
    """Add the mistake that may be its reason to an error."""
    if judged.mistake is None:
        return error
    found = error.finding
    return InputError(replace(found, message=f"{found.message}; {judged.mistake.advice}"))


def _calibrated(file: StarFile, stars: StarField, used: Ints, request: StarRequest) -> SolvedCamera:
    sigma = request.options.reading_sigma_mm
    return solve_calibration(file, stars, used, request.free, request.axes, sigma)


def _judged(file: StarFile, stars: StarField, request: StarRequest) -> Plausibility:
    """Test the residuals of all stars; no test if a pair is asked for."""
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
            raise InputError(Finding(message, deck=file.deck))
        return star_pairs(count)
    if request.pair is None:
        return None
    if max(request.pair) > count:
        message = f"there is no star {max(request.pair)}: the file ends with star {count}"
        raise file.error(message, count - 1)
    return np.array([request.pair]) - 1
