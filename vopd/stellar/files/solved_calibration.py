"""Solve a photograph's camera with its attitude, and say how well the stars hold it."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from vopd.arrays import Ints
from vopd.stellar.failures import REASONS, Failure
from vopd.stellar.field import StarField
from vopd.stellar.files.counted_findings import KindOfFinding
from vopd.stellar.files.images import ImageAxes, in_file_coordinates
from vopd.stellar.files.star_file import StarFile
from vopd.stellar.methods.calibration import PARAMETERS, Calibration, LensOfStars, without_lens
from vopd.stellar.methods.calibration_start import calibrate_from_both_starts
from vopd.stellar.methods.solved_stars import SolvedStars
from vopd.stellar.methods.split_solutions import ReadingScale, split_solutions
from vopd.stellar.solution import StarSolution

METHOD = "collinearity"

LARGEST_GROWTH = 10.0
"""Growth of the attitude's standard deviation from which the stars do not hold the camera."""

LARGEST_SIGMA = 0.01
"""Standard deviation of focal, centre or k1, in principal distances, from which they do not."""


class SolvedCalibration(NamedTuple):
    """A photograph with its camera: the stars with corrected images, and the solution."""

    stars: StarField
    solved: SolvedStars
    findings: list[KindOfFinding]


def solve_calibration(
    file: StarFile,
    stars: StarField,
    used: Ints,
    free: tuple[str, ...],
    axes: ImageAxes,
    reading_sigma: float | None,
) -> SolvedCalibration:
    """Solve attitude and camera.

    Args:
        file: the photograph
        stars: its problem, with images as they were read
        used: the stars to solve, counted from 0
        free: names of PARAMETERS
        axes: how the image coordinates were read
        reading_sigma: standard deviation of an image coordinate; None: from the residuals

    Raises:
        DeckError: too few stars, or there is no solution.
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
    return SolvedCalibration(corrected, solved, _doubts(found, sigmas, file))


def _reason(failure: Failure) -> str:
    text = REASONS[failure]
    return "the stars do not determine it" if failure == Failure.SINGULAR else text


def _shown(name: str, lens: LensOfStars, file: StarFile, axes: ImageAxes) -> float:
    """The value of an unknown; the principal point in the file's own coordinates."""
    if name.startswith("centre"):
        point = in_file_coordinates(np.array([lens.centre_x, lens.centre_y]), file, axes)
        return float(point[0 if name == "centre_x" else 1])
    return float(getattr(lens, name))


def _and(names: tuple[str, ...]) -> str:
    """Names in words: `a`, `a and b`, `a, b and c`."""
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last


def _doubts(found: Calibration, sigmas: dict[str, float], file: StarFile) -> list[KindOfFinding]:
    """Warnings where the stars cannot hold the camera."""
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
