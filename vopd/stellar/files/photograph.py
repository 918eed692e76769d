"""Photographs of star files: attitudes, cameras and findings."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime
from itertools import chain
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.findings import Finding, InputError, Report, input_error, size_text
from vopd.stellar.field import REASONS, Failure, StarField, ground_directions
from vopd.stellar.files.findings import (
    KindOfFinding,
    counted,
    explain,
    explain_plausibility,
    refuse_unsolvable,
)
from vopd.stellar.files.images import (
    ImageAxes,
    MissingOption,
    centred_images,
    in_file_coordinates,
    outside_image,
    reading_errors,
)
from vopd.stellar.files.mistakes import (
    Plausibility,
    fisheye_advice,
    judge,
    suspicious_photographs,
)
from vopd.stellar.files.plate_solvers import read_corr_fits, read_plate_solutions
from vopd.stellar.files.points import beyond_the_stars, point_directions
from vopd.stellar.files.read import (
    MOST_STARS,
    StarFile,
    decoded_text,
    file_directions,
    read_bytes,
    read_star_csv,
)
from vopd.stellar.identify import identified
from vopd.stellar.interstar_angles import star_pairs
from vopd.stellar.methods.calibration import (
    PARAMETERS,
    Calibration,
    calibrate_from_both_starts,
    calibrate_together,
    focal_by_pairs,
    without_lens,
)
from vopd.stellar.methods.resection import LEAST, LIMIT, resection
from vopd.stellar.methods.run import (
    METHODS,
    ONLY_PAIRS,
    SolvedStars,
    StarOptions,
    refused,
    single_solution,
    solve_alike,
    solve_by_methods,
)
from vopd.stellar.outlier_search import FittedStars, OutlierStart, fit_together
from vopd.stellar.sky import EQUATORIAL, NAMES, FileSky, SkyRequest, sky_directions, sky_pointing


@dataclass(frozen=True)
class StarRequest:
    """The options of `vopd stars solve`."""

    axes: ImageAxes  # how image coordinates are read, and the principal distance
    method: str = "collinearity"  # one of METHODS, or "all"
    pair: tuple[int, int] | None = None  # solve these two stars only, counted from 1
    all_pairs: bool = False  # solve every pair
    reject: bool = False  # leave out stars that do not fit the others
    edit_by_pairs: bool = False  # find those stars by the attitudes of all pairs
    # the magnitude at which the noise of a star's light is as large as all other reading errors;
    # None: they do not depend on it
    magnitude_limit: float | None = None
    by_elongation: bool = False  # whether they grow with the length of an image over its width
    listing: bool = False  # write the printout of program STARS instead of the solutions
    camera_m: tuple[float, ...] | None = None  # the camera's position, metres, for ground points
    resection: bool = False  # solve the camera's position too
    # date and place of the photograph, and files about stars
    sky: SkyRequest = field(default_factory=SkyRequest)
    free: tuple[str, ...] = ()  # what of the camera is solved with the attitude: focal, centre, k1
    # x, y of points of the picture whose directions are wanted, in the coordinates of the file
    points: tuple[tuple[float, ...], ...] = ()
    options: StarOptions = field(default_factory=StarOptions)  # how to solve
    # the solution of one photograph with the camera of all, if there are several
    shared: Calibration | None = None

    @property
    def rejects(self) -> bool:
        """Whether stars that do not fit the others are left out."""
        return self.reject or self.edit_by_pairs


@dataclass(frozen=True, eq=False)
class SolvedPhotograph:
    """One photograph with its solutions."""

    label: str  # what tells it from others; empty where it is the only one
    file: StarFile  # its stars as they were read
    stars: StarField  # its problem
    used: Ints  # the stars that are not rejected, counted from 0
    solved: tuple[SolvedStars, ...]  # the solutions to show
    findings: tuple[KindOfFinding, ...]  # errors and warnings
    status: int  # exit status 0, 1 or 3
    # how its image coordinates were read; None: its solutions are written without a picture
    axes: ImageAxes | None = None
    odd: tuple[int, ...] = ()  # stars that do not fit the others, counted from 1
    epoch: str = ""  # what right ascensions and declinations refer to; empty for ground points
    utc: datetime | None = None  # when it was taken, if that is known
    # from ICRF axes to east, north, up at the place, (3, 3), if these are known
    local: Floats | None = None
    # how it was solved, with its own reading sigma
    options: StarOptions = field(default_factory=StarOptions)
    spread: float = 1.0  # its reading sigma, as `reading_errors` has it

    @property
    def doubts(self) -> list[str]:
        """Say why its solutions are doubted; nothing where its exit status is 0."""
        return [one.message for _, one in self.findings] if self.status else []


# Files of photographs

FITS = b"SIMPLE  ="  # how every FITS file begins


def solve_photographs(
    names: Sequence[str], request: StarRequest
) -> tuple[list[SolvedPhotograph], list[Finding], int]:
    """Read star files and solve their photographs.

    Args:
        names: the files' names; `-` is standard input
        request: what to solve them for

    Returns:
        The photographs, the findings and the exit status. A method or a photograph that
        fails is a finding and leaves the other solutions; the status is then 1, and 3 where
        a solution did not converge or residuals are implausible.

    Raises:
        InputError: there is only one photograph, and it cannot be read, or no method
            can solve it.
        MissingOption: no photograph is solved, and one needs an option that is not given.
    """
    notes: list[Finding] = []
    files: list[StarFile] = []
    for name in names:
        try:
            files += read_photographs(name, notes.append)
        except InputError as error:
            if len(names) == 1:
                raise
            notes.append(error.finding)
    catalogue = request.sky.catalogue
    if catalogue is not None and files and all(one.kind not in ("", NAMES) for one in files):
        text = "not read: --catalogue is for stars by name, or that have neither name nor position"
        notes.append(Finding(text, catalogue, severity="warning"))
    if (
        request.sky.utc is not None
        and files
        and not {None, request.sky.utc} & {one.utc for one in files}
    ):
        text = "not used: every photograph has another date in its column utc"
        notes.append(Finding(text, "--date", severity="warning"))
    findings: list[KindOfFinding] = [(str(k), finding) for k, finding in enumerate(notes)]
    failed = any(finding.severity == "error" for finding in notes)
    several = len(files) > 1 or len(names) > 1
    photographs = []
    missing = None
    labels = _labels(files, several=several)
    for one in chain.from_iterable(
        _solve_together(files[k : k + TOGETHER], labels[k : k + TOGETHER], request)
        for k in range(0, len(files), TOGETHER)
    ):
        if isinstance(one, SolvedPhotograph):
            photographs.append(one)
        elif isinstance(one, MissingOption):
            findings.append(("unsolvable", Finding(str(one))))
            missing, failed = missing or one, True
        else:
            if not several and not failed:
                raise one
            findings.append(("unsolvable", one.finding))
            failed = True
    photographs = _with_one_camera(photographs, request)
    if missing is not None and not photographs:
        raise missing
    findings += chain.from_iterable(one.findings for one in photographs)
    statuses = {1} if failed else {one.status for one in photographs}
    status = next((status for status in (1, 3) if status in statuses), 0)
    return photographs, counted(findings), status


TOGETHER = 100  # how many photographs are solved together: more are no quicker


def _solve_together(
    files: Sequence[StarFile], labels: Sequence[str], request: StarRequest
) -> Iterator[SolvedPhotograph | InputError | MissingOption]:
    """Solve some photographs; those of as many stars at once."""
    read: list[StarProblem | InputError | MissingOption] = []
    for file in files:
        try:
            read.append(star_problem(file, request))
        except (InputError, MissingOption) as error:
            read.append(error)
    usual = [one for one in read if isinstance(one, StarProblem) and one.judged_as_read]
    fields = [one.stars for one in usual]
    fitted = fit_together(fields, usual[0].start) if usual else []
    suspicious = suspicious_photographs([one.file for one in usual], fields, request.axes, fitted)
    known = iter(zip(fitted, suspicious, strict=True))
    judged: list[JudgedPhotograph | InputError | MissingOption] = []
    for each in read:
        if isinstance(each, StarProblem):
            try:
                judged.append(
                    judged_photograph(each, *(next(known) if each.judged_as_read else ()))
                )
            except InputError as error:
                judged.append(error)
        else:
            judged.append(each)
    alike: dict[object, list[JudgedPhotograph]] = {}
    for one in judged:
        if isinstance(one, JudgedPhotograph) and one.by_all_stars:
            alike.setdefault(one.kind, []).append(one)
    solved: dict[int, list[SolvedStars]] = {}
    for some in alike.values():
        problem = some[0].problem
        solutions = solve_alike(
            [one.problem.stars for one in some],
            problem.methods,
            np.stack([one.used for one in some]),
            problem.options,
            [one.fitted for one in some],
        )
        solved |= zip(map(id, some), solutions, strict=True)
    for one, label in zip(judged, labels, strict=True):
        if not isinstance(one, JudgedPhotograph):
            yield one
            continue
        try:
            yield solved_photograph(one, label, solved.get(id(one)))
        except InputError as error:
            yield error


def _with_one_camera(
    photographs: list[SolvedPhotograph], request: StarRequest
) -> list[SolvedPhotograph]:
    """Solve photographs again with the one camera that took them all.

    Where units differ, or the solution of all does not converge, each keeps its own.
    """
    own = [one for one in photographs if one.solved and one.solved[0].camera is not None]
    units = {one.file.unit for one in own}
    if not request.free or request.resection or len(own) < 2 or len(units) > 1:
        return photographs
    if not request.axes.has_focal(own[0].file):
        start = float(own[0].stars.focal_length_mm[0])
        request = replace(request, axes=request.axes.with_focal(start, own[0].file.unit))
    unknowns = tuple(name for one in PARAMETERS if one in request.free for name in PARAMETERS[one])
    fields = []
    for one in own:
        points, focal = centred_images(one.file, _axes_as_read(request))
        read = replace(
            one.stars,
            image_mm=points,
            focal_length_mm=np.full_like(one.stars.focal_length_mm, focal),
        )
        fields.append(read.select(one.used))
    starts = [calibrate_from_both_starts(one, unknowns, request.axes.k1) for one in fields]
    spread = [one.spread for one in own]
    stated = [one.file.sigmas is not None for one in own]
    if any(stated) and not all(stated):  # the residuals tell the others
        each = zip(stated, spread, starts, strict=True)
        spread = [sigma if known else start.variance**0.5 for known, sigma, start in each]
    found = calibrate_together(fields, starts, spread)
    if found is None:
        return photographs
    camera = {id(one): shared for one, shared in zip(own, found, strict=True)}
    return [
        solve_photograph(one.file, replace(request, shared=camera[id(one)]), one.label)
        if id(one) in camera
        else one
        for one in photographs
    ]


def read_photographs(name: str, report: Report) -> list[StarFile]:
    """Read the photographs of a file: CSV, a plate solution in JSON, or astrometry.net's corr.fits.

    The format is known by the content, not by the name.

    Args:
        name: the file's name; `-` is standard input
        report: takes warnings, and errors of one photograph of several

    Raises:
        InputError: the file cannot be read, or is none of these.
        VopdError: where a package that the format needs is not installed.
    """
    data, source = read_bytes(name)
    if data.startswith(FITS):
        return [read_corr_fits(data, source)]
    text = decoded_text(data, source)
    if text.lstrip()[0] in "{[":
        return read_plate_solutions(text, source, report)
    return read_star_csv(text, source, report=report)


def _labels(files: Sequence[StarFile], *, several: bool) -> list[str]:
    """Label each photograph by its name, its file's name, or both."""
    names = Counter(file.photograph for file in files)
    labels = []
    for file in files:
        label = file.photograph or (file.source if several else "")
        if file.photograph and names[file.photograph] > 1:
            label = f"{file.source}: {file.photograph}"
        labels.append(label)
    return labels


# One photograph

MOST_STARS_IN_PAIRS = 200  # how many stars are solved by all pairs, which then are 19,900


class StarProblem(NamedTuple):
    """One photograph as a problem."""

    file: StarFile  # its stars as they were read
    request: StarRequest  # what to solve it for, with its own date
    options: StarOptions  # how to solve it, with its own reading sigma
    stars: StarField  # the problem
    sky: FileSky | None  # directions, frame and date; None for a resection
    resected: tuple[SolvedStars, ...]  # the solution of a resection
    findings: tuple[KindOfFinding, ...]  # warnings
    spread: float  # its reading sigma, as `reading_errors` has it

    @property
    def judged_as_read(self) -> bool:
        """Whether the residuals of the stars as they were read are tested."""
        return self.request.pair is None and not self.request.free

    @property
    def methods(self) -> tuple[str, ...]:
        """The methods to solve it by."""
        if self.request.method != "all":
            return (self.request.method,)
        few = len(self.file.lines) < 3
        return tuple(method for method in METHODS if not (few and method.startswith("church")))

    @property
    def start(self) -> OutlierStart:
        """From which half of the stars the search for outliers begins."""
        return "pairs" if self.request.edit_by_pairs else "interstar"


def star_problem(file: StarFile, request: StarRequest) -> StarProblem:
    """Make the problem of one photograph.

    Raises:
        InputError: no method can solve it.
        MissingOption: the file needs an option that is not given.
    """
    count = len(file.lines)
    if count > MOST_STARS:
        raise file.error(f"more than {MOST_STARS} stars in one photograph", MOST_STARS)
    if file.utc is not None:
        request = replace(request, sky=replace(request.sky, utc=file.utc))
    unknown = "focal" in request.free and not (request.resection or request.axes.has_focal(file))
    axes = _axes_as_read(request)
    if unknown:
        axes = axes.with_focal(1.0, file.unit)
    notes: list[Finding] = []
    if not file.kind:
        if request.resection or request.camera_m is not None:
            raise file.error("ground points need columns x_m, y_m, z_m")
        known = axes if unknown else request.axes
        file = identified(file, known, request.sky, focal_known=not unknown)
    points, focal = centred_images(file, axes)
    notes += (*file.notes, *outside_image(file, axes))
    sky = None if request.resection else photograph_directions(file, request, notes.append)
    if sky is not None and unknown:
        focal = focal_by_pairs(points, sky.directions)
        request = replace(request, axes=request.axes.with_focal(focal, file.unit))
    if sky is not None and file.magnitude is None:
        file = replace(file, magnitude=sky.magnitude)
    errors, spread = reading_errors(
        file,
        request.magnitude_limit,
        by_elongation=request.by_elongation,
        flipped=request.axes.flipped(file),
    )
    options = request.options
    if errors is not None and options.weights == "listed":
        raise file.error("--weights listed knows no columns of sigma, and no other errors")
    if file.sigmas is not None:
        if options.reading_sigma_mm is not None:
            raise file.error("the file has standard deviations: no --reading-sigma")
        options = replace(options, reading_sigma_mm=spread)
    doubts: list[KindOfFinding] = []
    resected: list[SolvedStars] = []
    if sky is None:
        stars, solution, doubts = solve_resection(
            file, points, focal, errors, options.reading_sigma_mm
        )
        resected = [solution]
    else:
        stars = StarField.of(sky.directions, points, focal, errors=errors)
    refuse_unsolvable(file, stars)
    findings = (*doubts, *((f"note {k}", one) for k, one in enumerate(notes)))
    return StarProblem(file, request, options, stars, sky, tuple(resected), findings, spread)


def _axes_as_read(request: StarRequest) -> ImageAxes:
    """Leave a known distortion in images of which the camera is solved, as it goes by that."""
    return replace(request.axes, k1=0.0) if request.free else request.axes


def solve_photograph(file: StarFile, request: StarRequest, label: str = "") -> SolvedPhotograph:
    """Solve one photograph.

    Raises:
        InputError: no method can solve it.
        MissingOption: the file needs an option that is not given.
    """
    (found,) = _solve_together([file], [label], request)
    if isinstance(found, SolvedPhotograph):
        return found
    raise found


class JudgedPhotograph(NamedTuple):
    """One photograph, its residuals tested."""

    problem: StarProblem  # its problem
    fitted: FittedStars | None  # its collinearity solution, if it is known
    judged: Plausibility  # what the test found
    used: Ints  # the stars that are not rejected, counted from 0

    @property
    def by_all_stars(self) -> bool:
        """Whether all stars are solved at once with the camera as stated."""
        request = self.problem.request
        by_pairs = request.all_pairs or request.pair is not None
        return not (by_pairs or request.free or self.problem.sky is None)

    @property
    def kind(self) -> object:
        """What photographs that are solved together have in common."""
        problem = self.problem
        return problem.methods, problem.options, len(self.used), problem.stars.errors is None


def judged_photograph(
    problem: StarProblem, fitted: FittedStars | None = None, suspicious: bool = True
) -> JudgedPhotograph:
    """Test the residuals of a photograph, and leave out stars if that is asked for.

    Raises:
        InputError: the camera cannot be solved.
    """
    judged = _judged(problem, fitted, suspicious)
    outliers = [outlier.star for outlier in judged.outliers] if problem.request.rejects else []
    used = np.setdiff1d(np.arange(len(problem.file.lines)), outliers)
    return JudgedPhotograph(problem, fitted, judged, used)


def solved_photograph(
    photograph: JudgedPhotograph, label: str, alike: Sequence[SolvedStars] | None
) -> SolvedPhotograph:
    """Describe the solutions of a photograph, and find them if they are not of all stars.

    Args:
        photograph: the photograph
        label: what tells it from others
        alike: its solutions, if it was solved with others

    Raises:
        InputError: no method can solve it.
    """
    problem, fitted, judged, used = photograph
    file, request, options, stars, sky = problem[:5]
    sigma = options.reading_sigma_mm
    doubts: list[KindOfFinding] = []
    solved = list(problem.resected)
    calibration = None
    if alike is not None:
        solved = list(alike)
    elif request.free and sky is not None:
        stars, solution, calibration, doubts = solve_calibration(file, stars, used, request, sigma)
        solved = [solution]
    elif sky is not None:
        pairs = _pairs(file, request)
        solved = solve_by_methods(stars, problem.methods, pairs, options, used, fitted)

    findings = [*doubts, *problem.findings]
    findings += chain.from_iterable(explain(one, file, stars) for one in solved)
    findings += _only_one_pair(solved, file, request)
    findings += explain_plausibility(judged, file, rejected=request.rejects)
    shown = [one for one in solved if not refused(one.failure)]
    if implausible(judged, request):  # an uncertainty from reading errors alone would mislead
        shown = [one.without_uncertainty() for one in shown]
    frame = None if sky is None else sky.frame
    if sky is not None and file.kind in EQUATORIAL:
        mount = request.sky.mount
        shown = [
            replace(one, sky=sky_pointing(
                np.array(one.matrix), frame, mount, one.rotation_covariance_arcsec2
            ))
            for one in shown
        ]  # fmt: skip
    axes = _axes_as_read(request)
    far = beyond_the_stars(request.points, file, axes, problem.stars.image_mm)
    findings += [("points", one) for one in far]
    if request.points:
        focal = float(np.ravel(stars.focal_length_mm)[0])
        shown = [
            replace(one, points=point_directions(
                request.points, file, axes, one, focal, calibration, frame,
                equatorial=file.kind in EQUATORIAL,
            ))
            for one in shown
        ]  # fmt: skip
    return SolvedPhotograph(
        label,
        file,
        stars,
        used,
        tuple(shown),
        tuple(findings),
        exit_status(solved, judged, request),
        request.axes,
        odd=tuple(sorted(star + 1 for star in judged.odd)),
        epoch=sky.epoch if sky else "",
        utc=request.sky.utc if frame else None,
        local=frame.local if frame else None,
        options=options,
        spread=problem.spread,
    )


def photograph_directions(file: StarFile, request: StarRequest, report: Report) -> FileSky:
    """Find the directions of the stars, or of the ground points.

    Raises:
        MissingOption: an option needs another one.
        InputError: an option is not for this kind of file, or a direction cannot be found.
    """
    sky, camera_m = request.sky, request.camera_m
    if sky.utc is None and (sky.place is not None or sky.ephemeris is not None):
        option = "--place" if sky.place is not None else "--ephemeris"
        raise MissingOption(f"{file.source}: {option} needs --date, or a column utc")
    if sky.mount is not None and sky.place is None:
        raise MissingOption(
            f"{file.source}: --mount needs --place, for the vehicle's yaw and pitch"
        )
    ground = file.kind == "x_m,y_m,z_m"
    if camera_m is not None and not ground:
        raise file.error(f"--camera is for ground points; the file has {file.kind}")
    if file.kind in EQUATORIAL:
        return sky_directions(file, sky, report)
    if sky.utc is not None or sky.place is not None:
        text = f"a date and a place are for stars by ra and dec or by name, not {file.kind}"
        raise input_error(text, file.source)
    if ground and camera_m is None:
        text = "ground points need --camera X,Y,Z, or --resection"
        raise input_error(text, file.source)
    directions = file_directions(file, camera_m, report)
    return FileSky(directions, None, "" if ground else "the axes of u, v, w")


def _judged(problem: StarProblem, fitted: FittedStars | None, suspicious: bool) -> Plausibility:
    """Test the residuals of all stars, with the camera that fits them if one is solved."""
    file, request, options, stars = problem[:4]
    sigma = options.reading_sigma_mm
    if request.pair is not None:
        return Plausibility(0.0)

    def judgement(stars: StarField) -> Plausibility:
        axes, start = replace(request.axes, free=request.free), problem.start
        return judge(file, stars, sigma, axes, start, fitted, suspicious=suspicious)

    if not request.free:
        return judgement(stars)
    try:
        camera, *_ = solve_calibration(file, stars, np.arange(len(file.lines)), request, sigma)
    except InputError as error:
        judged = judgement(stars)
        advice = judged.mistake.advice if judged.mistake else fisheye_advice(file, stars)
        if not advice:
            raise
        finding = error.finding
        message = f"{finding.message}; {advice}"
        raise InputError(replace(finding, message=message)) from None
    judged = judgement(camera)
    if judged.unexplained and (advice := fisheye_advice(file, stars)):  # a solved k1 hides it
        judged = judged._replace(unexplained=advice)
    return judged


def _pairs(file: StarFile, request: StarRequest) -> Ints | None:
    count = len(file.lines)
    if request.all_pairs:
        if count > MOST_STARS_IN_PAIRS:
            message = f"{count} stars: all pairs are solved of {MOST_STARS_IN_PAIRS} at most"
            raise input_error(message, file.source)
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
    return [("pair", Finding(message, source=file.source, severity="warning"))]


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


# Position and attitude together

RESECTION_METHOD = "resection"


def solve_resection(
    file: StarFile,
    image: Floats,
    focal: float,
    errors: Floats | None,
    reading_sigma: float | None,
) -> tuple[StarField, SolvedStars, list[KindOfFinding]]:
    """Find the camera's position and attitude.

    Args:
        file: the ground points
        image: their images from the principal point, (n, 2)
        focal: principal distance, in the same unit
        errors: covariance matrices of the images for a reading sigma of 1, (n, 2, 2)
        reading_sigma: standard deviation of an image coordinate; None: from the residuals

    Returns:
        The problem with the points as directions, the solution, and warnings about it.

    Raises:
        InputError: the file has no ground points, or too few, or there is no solution.
    """
    count = len(file.lines)
    if file.kind != "x_m,y_m,z_m":
        raise file.error(f"--resection is for ground points; the file has {file.kind}")
    if count < LEAST:
        raise file.error(f"--resection takes {LEAST} points at least, the file has {count}")
    found = resection(file.positions, image, focal, errors)
    if found.failure != Failure.NONE:
        text = REASONS[found.failure]
        text += f" in {LIMIT} corrections" if found.failure == Failure.NO_CONVERGENCE else ""
        raise file.error(f"{RESECTION_METHOD}: {text}")
    directions = ground_directions(file.positions, found.position)
    stars = StarField.of(directions, image, focal, errors=errors)
    sigma, freedom = reading_sigma, None
    if sigma is None:
        freedom = 2 * count - 6  # six unknowns
        sigma = float(np.sqrt((stars.whitened(found.residuals) ** 2).sum() / freedom))
    solved = single_solution(
        RESECTION_METHOD, found.matrix, found.iterations, stars, np.arange(count),
        found.covariance[:3, :3], sigma, freedom,
    )  # fmt: skip
    solved = replace(
        solved,
        camera_m=found.position.tolist(),
        camera_sigma_m=(np.sqrt(np.diagonal(found.covariance)[3:]) * sigma).tolist(),
    )
    if found.second is None:
        return stars, solved, []
    listed = ", ".join(f"{value:.1f}" for value in found.second)
    text = (
        f"{RESECTION_METHOD}: the points fit as well from {listed}: give more points, or --camera"
    )
    return stars, solved, [(RESECTION_METHOD, file.finding(text).warned())]


# Lens and attitude together

CALIBRATION_METHOD = "collinearity"

LARGEST_GROWTH = 10.0
"""Growth of the attitude's standard deviation from which the stars do not hold the camera."""

LARGEST_SIGMA = 0.01
"""Standard deviation of focal, centre or k1, in principal distances, from which they do not."""


def solve_calibration(
    file: StarFile,
    stars: StarField,
    used: Ints,
    request: StarRequest,
    reading_sigma: float | None,
) -> tuple[StarField, SolvedStars, Calibration, list[KindOfFinding]]:
    """Solve attitude and camera.

    Args:
        file: the photograph
        stars: its problem, with images as they were read
        used: the stars to solve, counted from 0
        request: what of the camera is solved, and how image coordinates were read
        reading_sigma: standard deviation of an image coordinate; None: from the residuals

    Returns:
        The problem with images without the lens, the solution, the camera, and warnings.

    Raises:
        InputError: too few stars, or there is no solution.
    """
    unknowns = tuple(name for one in PARAMETERS if one in request.free for name in PARAMETERS[one])
    option = f"--free {','.join(request.free)}"
    needed = (3 + len(unknowns)) // 2 + 1
    if len(used) < needed:
        raise file.error(f"{option} takes {needed} stars at least")
    found = request.shared or calibrate_from_both_starts(
        stars.select(used), unknowns, request.axes.k1
    )
    if found.failure == Failure.SINGULAR:
        raise file.error(f"{option}: the stars do not determine it")
    if found.failure != Failure.NONE:
        raise file.error(f"{option}: {REASONS[found.failure]}")
    lens = found.lens
    points = without_lens(stars.image_mm, lens)
    if not np.isfinite(points).all():
        raise file.error(f"{option}: the lens that fits best cannot be inverted")
    corrected = replace(
        stars, image_mm=points, focal_length_mm=np.full_like(stars.focal_length_mm, lens.focal)
    )
    sigma = reading_sigma or float(np.sqrt(found.variance))
    solved = single_solution(
        CALIBRATION_METHOD, found.matrix, found.iterations, corrected, used,
        found.covariance[:3, :3], sigma, found.freedom if reading_sigma is None else None,
    )  # fmt: skip
    deviations = np.sqrt(np.diagonal(found.covariance)[3:]) * sigma
    sigmas = dict(zip(unknowns, deviations.tolist(), strict=True))
    centre = in_file_coordinates(np.array([lens.centre_x, lens.centre_y]), file, request.axes)
    camera = lens._replace(centre_x=float(centre[0]), centre_y=float(centre[1]))
    values = {name: float(getattr(camera, name)) for name in unknowns}
    solved = replace(solved, camera=values, camera_sigmas=sigmas)

    doubts = []
    if found.growth > LARGEST_GROWTH:
        *first, last = found.free
        names = f"{', '.join(first)} and {last}" if first else last
        doubts.append(
            f"the stars can hardly tell {names} from a turn of the camera: "
            f"the standard deviation of the attitude is {found.growth:.0f} times as large as "
            "with a known camera"
        )
    for name, deviation in sigmas.items():
        size, unit = (1.0, "") if name == "k1" else (lens.focal, f" {file.unit}")
        if deviation > LARGEST_SIGMA * size:
            doubts.append(
                f"the stars do not hold {name}: its standard deviation is "
                f"{size_text(deviation, 3)}{unit}"
            )
    kinds = [(f"calibration {k}", file.finding(text).warned()) for k, text in enumerate(doubts)]
    return corrected, solved, found, kinds
