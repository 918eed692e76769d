"""Solve attitude and camera where the stated camera may be far from the true one."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.stellar.failures import Failure
from vopd.stellar.field import StarField
from vopd.stellar.methods.calibration import Calibration, LensOfStars, calibrate
from vopd.stellar.methods.wahba import wahba_rotation

FARTHEST_COSINE = 0.1
"""Cosine of the largest angle from the stars' mean direction from which a start is estimated."""


class CalibrationStart(NamedTuple):
    """Where `calibrate` starts: a rotation, (3, 3), and a lens."""

    matrix: Floats
    lens: LensOfStars


def calibrate_from_both_starts(field: StarField, free: tuple[str, ...]) -> Calibration:
    """Solve attitude and lens, from the stated lens and from one estimated from the images.

    Args:
        field: one problem, its images as they were read
        free: names of UNKNOWNS to solve; the others keep their values

    Returns:
        The solution with the smaller residuals; where there is none, that from the
        stated lens with its failure.
    """
    stated = calibrate(field, wahba_rotation(field)[0], free)
    estimated = estimated_start(field, free)
    tried = [stated]
    if estimated is not None:
        tried.append(calibrate(field, estimated.matrix, free, estimated.lens))
    solved = [one for one in tried if one.failure == Failure.NONE]
    return min(solved, key=lambda one: one.variance, default=stated)


def estimated_start(field: StarField, free: tuple[str, ...]) -> CalibrationStart | None:
    """Estimate principal point and distance from the images: their mean and their spread.

    Args:
        field: one problem
        free: names of UNKNOWNS; only these are estimated

    Returns:
        The start, or None where the stars lie too far apart for an estimate.
    """
    focal = float(field.focal_length_mm[0])
    centre = field.image_mm.mean(axis=0) if "centre_x" in free else np.zeros(2)
    if "focal" in free:
        mean = field.directions.mean(axis=0)
        along = field.directions @ (mean / np.linalg.norm(mean))
        if along.min() < FARTHEST_COSINE:
            return None
        tangents = field.directions / along[:, None]
        focal = _spread(field.image_mm) / _spread(tangents)
    moved = replace(
        field,
        image_mm=field.image_mm - centre,
        focal_length_mm=np.full_like(field.focal_length_mm, focal),
    )
    matrix, _ = wahba_rotation(moved)
    return CalibrationStart(matrix, LensOfStars(focal, *centre.tolist()))


def _spread(points: Floats) -> float:
    """Root mean square distance of points from their mean."""
    return float(np.sqrt(points.var(axis=0).sum()))
