"""What is to be solved of a photograph: its stars' directions and images, and their errors."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

from vopd.findings import Finding
from vopd.stellar.field import StarField
from vopd.stellar.files.findings import refuse_unsolvable
from vopd.stellar.files.images import centred_images
from vopd.stellar.files.photograph_directions import photograph_directions
from vopd.stellar.files.reading_errors import ReadingErrors, reading_errors
from vopd.stellar.files.solved_resection import SolvedResection, solve_resection
from vopd.stellar.files.star_file import MOST_STARS, StarFile
from vopd.stellar.files.star_request import StarRequest
from vopd.stellar.sky.file_sky import FileSky


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
    position: SolvedResection | None
    notes: list[Finding]


def photograph_problem(file: StarFile, request: StarRequest) -> PhotographProblem:
    """Find the directions of a photograph's stars, and read their images as the options say.

    Args:
        file: its stars
        request: what to solve it for

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
    """The request with the reading sigma that the file states."""
    options = request.options
    if errors.relative is not None and options.weights == "listed":
        raise file.error("--weights listed knows no columns of sigma, and no other errors")
    if errors.sigma is None:
        return request
    if options.reading_sigma_mm is not None:
        raise file.error("the file has standard deviations: no --reading-sigma")
    return replace(request, options=replace(options, reading_sigma_mm=errors.sigma))
