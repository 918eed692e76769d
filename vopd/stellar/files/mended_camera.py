"""A camera that is stated wrongly: solved with the attitude, to see whether the stars then fit."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from vopd.stellar.failures import Failure
from vopd.stellar.field import StarField
from vopd.stellar.files.images import ImageAxes, in_file_coordinates
from vopd.stellar.files.star_file import StarFile
from vopd.stellar.methods.calibration import PARAMETERS, Calibration, LensOfStars, calibrate
from vopd.stellar.methods.calibration_start import calibrate_from_both_starts
from vopd.stellar.methods.wahba import wahba_rotation
from vopd.stellar.outlier_search import LEAST_VARIANCE, AttitudeFit

CAMERAS = (("focal",), ("centre",), ("k1",))
"""What may be wrong about a camera."""

SEVERAL_OF_CAMERA = (("focal", "k1"), ("focal", "centre"), ("focal", "centre", "k1"))
"""What may be wrong about it at once."""


class MendedCamera(NamedTuple):
    """A camera that fits the stars.

    Attributes:
        advice: what seems to be wrong and what to do about it
        fit: the attitude that was solved with it
        stars: the problem, with its principal distance
    """

    advice: str
    fit: AttitudeFit
    stars: StarField


def mended_camera(
    stars: StarField,
    free: tuple[str, ...],
    file: StarFile,
    axes: ImageAxes,
    *,
    named: bool,
    far: bool,
) -> MendedCamera | None:
    """Solve a part of the camera with the attitude.

    Args:
        stars: the problem of a file
        free: names of PARAMETERS
        file: the file, for the unit of its images
        axes: how the file's image coordinates were read
        named: whether a principal point can be stated in the file's coordinates
        far: whether the stated camera may be far from the true one

    Returns:
        The camera; None where there is no solution, or no residuals to judge it by.
    """
    unknowns = tuple(name for one in free for name in PARAMETERS[one])
    if 2 * int(stars.count) - 3 - len(unknowns) < 1:
        return None
    if far:
        found = calibrate_from_both_starts(stars, unknowns)
    else:
        found = calibrate(stars, wahba_rotation(stars)[0], unknowns)
    if found.failure != Failure.NONE:
        return None
    mended = replace(stars, focal_length_mm=np.full_like(stars.focal_length_mm, found.lens.focal))
    floor = LEAST_VARIANCE * found.lens.focal**2
    fit = AttitudeFit(max(found.variance, floor), found.freedom, found.matrix)
    return MendedCamera(_advice(found, free, file, axes, named=named), fit, mended)


def _advice(
    found: Calibration, free: tuple[str, ...], file: StarFile, axes: ImageAxes, *, named: bool
) -> str:
    """What seems to be wrong about the camera and what to do about it."""
    parts = [_part(one, found.lens, file, axes, named=named) for one in free]
    together = f"; --free {','.join(free)} solves them together" if len(free) > 1 else ""
    return ", and ".join(parts) + together


def _part(one: str, lens: LensOfStars, file: StarFile, axes: ImageAxes, *, named: bool) -> str:
    """What seems to be wrong about one of PARAMETERS."""
    if one == "focal":
        return f"the principal distance seems to be {axes.focal_advice(lens.focal, file.unit)}"
    if one == "k1":
        return f"the lens seems to distort the image: --free k1, or --k1 {axes.k1 + lens.k1:.4g}"
    if not named:
        return "the principal point seems to be another one: --free centre"
    x, y = in_file_coordinates(np.array([lens.centre_x, lens.centre_y]), file, axes).tolist()
    if file.unit == "px":
        return f"the principal point seems to be another one: --centre {x:.6g},{y:.6g}"
    return (
        f"the principal point seems to be at x {x:.4g}, y {y:.4g} mm of the file: subtract them "
        "from its coordinates, or --free centre"
    )
