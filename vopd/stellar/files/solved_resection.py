"""Solve a photograph of ground points for position and attitude together."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.stellar.directions import ground_directions
from vopd.stellar.failures import REASONS, Failure
from vopd.stellar.field import StarField
from vopd.stellar.files.counted_findings import KindOfFinding
from vopd.stellar.files.images import CentredImages
from vopd.stellar.files.reading_errors import ReadingErrors
from vopd.stellar.files.star_file import StarFile
from vopd.stellar.methods.resection import LEAST, LIMIT, Resection, resection
from vopd.stellar.methods.solved_stars import SolvedStars
from vopd.stellar.methods.split_solutions import ReadingScale, split_solutions
from vopd.stellar.solution import StarSolution

METHOD = "resection"


class SolvedResection(NamedTuple):
    """A solved resection: the points as directions from the position found, and the solution."""

    stars: StarField
    solved: SolvedStars
    findings: list[KindOfFinding]


def solve_resection(
    file: StarFile, images: CentredImages, errors: ReadingErrors, reading_sigma: float | None
) -> SolvedResection:
    """Find the camera's position and attitude.

    Args:
        file: the ground points
        images: their images
        errors: of the images
        reading_sigma: standard deviation of an image coordinate; None: from the residuals

    Raises:
        DeckError: the file has no ground points, or too few, or there is no solution.
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
        raise file.error(f"{METHOD}: {text}")
    directions = ground_directions(file.positions, found.position)
    stars = StarField.of(directions, images.points, images.focal, errors=errors.relative)
    reading = ReadingScale(reading_sigma or 0.0, None, reading_sigma or 0.0)
    if reading_sigma is None:
        sigma = _residual_sigma(found, stars)
        reading = ReadingScale(sigma, 2 * count - 6, sigma)
    solution = StarSolution(
        found.matrix[None],
        np.array([Failure.NONE]),
        np.array([found.iterations]),
        np.array([True]),
    )
    everyone = np.arange(count)[None]
    (solved,) = split_solutions(
        METHOD, solution, stars.select(everyone), everyone, "nearest", reading,
        found.covariance[None, :3, :3], None, robust=False,
    )  # fmt: skip
    solved = replace(
        solved,
        camera_m=found.position.tolist(),
        camera_sigma_m=(np.sqrt(np.diagonal(found.covariance)[3:]) * reading.sigma).tolist(),
    )
    return SolvedResection(stars, solved, _second(found.second, file))


def _residual_sigma(found: Resection, stars: StarField) -> float:
    """Standard deviation of an image coordinate by the residuals; six of them are used up."""
    square = float((stars.whitened(found.residuals) ** 2).sum())
    return float(np.sqrt(square / (found.residuals.size - 6)))


def _second(position: Floats | None, file: StarFile) -> list[KindOfFinding]:
    """A warning where the points look nearly the same from another position."""
    if position is None:
        return []
    listed = ", ".join(f"{value:.1f}" for value in position)
    text = f"{METHOD}: the points fit as well from {listed}: give more points, or --camera"
    return [KindOfFinding(METHOD, file.finding(text).warned())]
