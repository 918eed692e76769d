"""Common mistakes in star files: each is undone to see whether the stars then fit.

Hours read as degrees, exchanged or mirrored coordinates, a wrong principal
distance and a misidentified star leave large residuals and no other sign.
Where the residuals are implausible, each mistake is mended in turn and
the stars are solved again.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.vectors import transform
from vopd.stellar.directions import image_points_mm, star_directions
from vopd.stellar.failures import Failure
from vopd.stellar.files.image_axes import ImageAxes
from vopd.stellar.files.star_file import StarFile
from vopd.stellar.methods.calibration import calibrate
from vopd.stellar.methods.wahba import wahba_rotation
from vopd.stellar.outlier_search import AttitudeFit, Outlier, fit_attitude
from vopd.stellar.star_field import StarField

CHANCE = 1e-4
"""Chance below which a mended mistake makes a difference (F test)."""

LEAST_GAIN = 9.0
"""How many times a mended mistake must make the variance of the residuals smaller."""


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


def mended_mistakes(
    file: StarFile, stars: StarField, fit: AttitudeFit, outliers: list[Outlier], axes: ImageAxes
) -> list[UsualMistake]:
    """The usual mistakes that, mended, make the residuals much smaller.

    Args:
        file: the file, for its right ascensions and declinations as they are written
        stars: its problem
        fit: the solution of the stars as they are
        outliers: stars that do not fit the others
        axes: how the file's image coordinates were read
    """
    return [one for one in _tried(file, stars, fit, outliers, axes) if one is not None]


def _tried(
    file: StarFile, stars: StarField, fit: AttitudeFit, outliers: list[Outlier], axes: ImageAxes
) -> Iterator[UsualMistake | None]:
    """Each usual mistake that, mended, makes the residuals much smaller."""
    for advice, directions, image_mm in _candidates(file, stars, axes):
        mended = replace(stars, directions=directions, image_mm=image_mm)
        if _roughly_mm2(mended) < fit.variance_mm2:
            yield _mistake(advice, fit, fit_attitude(mended))
    focal, by_focal = _fit_focal_length(stars)
    advice = f"the principal distance seems to be {axes.focal_advice(focal, file.unit)}"
    yield _mistake(advice, fit, by_focal)
    if outliers and len(outliers) <= len(file.lines) - 3:
        good = np.delete(np.arange(len(file.lines)), [outlier.star for outlier in outliers])
        numbers = sorted(outlier.star for outlier in outliers)
        listed = ", ".join(str(number + 1) for number in numbers)
        alone = len(numbers) == 1
        verb = f"star {listed} disagrees" if alone else f"stars {listed} disagree"
        pronoun = "it" if alone else "them"
        advice = f"{verb} with the others: misidentified, or misread? --reject leaves {pronoun} out"
        yield _mistake(advice, fit, fit_attitude(stars.only(good)), tuple(numbers))


def _candidates(
    file: StarFile, stars: StarField, axes: ImageAxes
) -> Iterator[tuple[str, Floats, Floats]]:
    """Mistakes of coordinates: what to do, and directions and images with it mended."""
    downward = "up: no --y-down" if axes.flipped(file) else "down: --y-down"
    mirrored = (
        f"the photograph is a mirror image of the sky: y seems to point {downward} "
        "(or x and y are exchanged; only the swing tells which)"
    )
    yield mirrored, stars.directions, stars.image_mm * [1.0, -1.0]
    if file.kind != "ra_deg,dec_deg":
        return
    ra_deg, dec_deg = file.positions.T
    if (np.abs(ra_deg) <= 24.0).all():
        advice = "right ascension seems to be in hours: name its column ra_hours"
        yield advice, star_directions(ra_deg * 15.0, dec_deg), stars.image_mm
    if (np.abs(ra_deg) <= 90.0).all():
        advice = "right ascension and declination seem to be exchanged"
        yield advice, star_directions(dec_deg, ra_deg), stars.image_mm


def _mistake(
    advice: str, fit: AttitudeFit, mended: AttitudeFit, stars: tuple[int, ...] = ()
) -> UsualMistake | None:
    """The mistake, if the residuals without it are smaller than chance can make them."""
    if not mended.variance_mm2 * LEAST_GAIN < fit.variance_mm2:
        return None
    unsolved = np.isinf(fit.variance_mm2)
    ratio = fit.variance_mm2 / mended.variance_mm2
    from scipy.special import fdtrc

    if not unsolved and fdtrc(fit.freedom, mended.freedom, ratio) > CHANCE:
        return None
    return UsualMistake(advice, float(np.sqrt(mended.variance_mm2)), stars)


def _roughly_mm2(stars: StarField) -> float:
    """Variance of the residuals of the singular-value solution, which takes no iteration."""
    matrix, _ = wahba_rotation(stars)
    computed = image_points_mm(transform(matrix, stars.directions), stars.focal_length_mm)
    return float(((stars.image_mm - computed) ** 2).sum() / (2 * len(computed) - 3))


def _fit_focal_length(stars: StarField) -> tuple[float, AttitudeFit]:
    """The principal distance that fits the stars best, solved with the attitude."""
    start, _ = wahba_rotation(stars)
    found = calibrate(stars, start, ("focal",))
    freedom = found.freedom
    if found.failure != Failure.NONE:
        return float("nan"), AttitudeFit(np.inf, freedom, start)
    focal = found.lens.focal
    fitted = fit_attitude(
        replace(stars, focal_length_mm=np.full_like(stars.focal_length_mm, focal))
    )
    return focal, AttitudeFit(fitted.variance_mm2 * fitted.freedom / freedom, freedom, found.matrix)
