"""Whether a star file fits with one mistake undone: the residuals are tested against chance."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.geometry.vectors import transform
from vopd.stellar.directions import image_points_mm
from vopd.stellar.field import StarField
from vopd.stellar.files.images import ImageAxes
from vopd.stellar.files.mended_camera import mended_camera
from vopd.stellar.files.mended_coordinates import MendedStars
from vopd.stellar.files.star_file import StarFile
from vopd.stellar.methods.wahba import wahba_rotation
from vopd.stellar.outlier_search import AttitudeFit, Outlier, fit_attitude

CHANCE = 1e-4
"""Chance below which a mended mistake makes a difference (F test)."""

LEAST_GAIN = 9.0
"""How many times a mended mistake must make the variance of the residuals smaller."""

LARGEST_RESIDUAL = 0.01
"""Standard deviation of the residuals, in principal distances, that no reading has: half a degree.

The report's perturbed sample, with its large errors of .1 to .3 mm, has .003."""


class UsualMistake(NamedTuple):
    """A mistake which, when undone, makes the stars fit.

    Attributes:
        advice: what seems to be wrong and what to do about it
        sigma: standard deviation of the residuals when it is mended, image units
        stars: the stars it is about, counted from 0; empty for all
    """

    advice: str
    sigma: float
    stars: tuple[int, ...] = ()


def by_coordinates(mended: MendedStars, fit: AttitudeFit) -> UsualMistake | None:
    """A mistake of coordinates, tried first by the solution that takes no iteration."""
    if not _roughly_mm2(mended.stars) < fit.variance_mm2:
        return None
    return _mistake(mended.advice, fit, fit_attitude(mended.stars), mended.stars)


def by_camera(
    stars: StarField,
    free: tuple[str, ...],
    fit: AttitudeFit,
    file: StarFile,
    axes: ImageAxes,
    *,
    named: bool = True,
) -> UsualMistake | None:
    """A mistake about the camera."""
    far = not fit.variance_mm2 < _largest_mm2(stars)
    found = mended_camera(stars, free, file, axes, named=named, far=far)
    return found and _mistake(found.advice, fit, found.fit, found.stars)


def by_wrong_stars(
    stars: StarField, outliers: list[Outlier], fit: AttitudeFit
) -> UsualMistake | None:
    """Stars that disagree with the others, of which three at least are left."""
    count = stars.used.shape[-1]
    if not outliers or len(outliers) > count - 3:
        return None
    numbers = sorted(outlier.star for outlier in outliers)
    good = stars.only(np.delete(np.arange(count), numbers))
    listed = ", ".join(str(number + 1) for number in numbers)
    alone = len(numbers) == 1
    verb = f"star {listed} disagrees" if alone else f"stars {listed} disagree"
    pronoun = "it" if alone else "them"
    advice = f"{verb} with the others: misidentified, or misread? --reject leaves {pronoun} out"
    return _mistake(advice, fit, fit_attitude(good), good, tuple(numbers))


def _mistake(
    advice: str,
    fit: AttitudeFit,
    mended: AttitudeFit,
    stars: StarField,
    wrong: tuple[int, ...] = (),
) -> UsualMistake | None:
    """The mistake, if the residuals without it are plausible and smaller than by chance."""
    if not mended.variance_mm2 * LEAST_GAIN < fit.variance_mm2:
        return None
    if not mended.variance_mm2 < _largest_mm2(stars):
        return None
    ratio = fit.variance_mm2 / mended.variance_mm2  # infinite without a solution: no chance
    from scipy.special import fdtrc

    if fdtrc(fit.freedom, mended.freedom, ratio) > CHANCE:
        return None
    return UsualMistake(advice, float(np.sqrt(mended.variance_mm2)), wrong)


def _largest_mm2(stars: StarField) -> float:
    """Variance of the residuals that no reading has."""
    return (LARGEST_RESIDUAL * float(stars.focal_length_mm[0])) ** 2


def _roughly_mm2(stars: StarField) -> float:
    """Variance of the residuals of the singular-value solution, which takes no iteration."""
    matrix, _ = wahba_rotation(stars)
    computed = image_points_mm(transform(matrix, stars.directions), stars.focal_length_mm)
    return float(((stars.image_mm - computed) ** 2).sum() / (2 * len(computed) - 3))
