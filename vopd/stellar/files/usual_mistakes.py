"""Common mistakes in star files: each is undone to see whether the stars then fit.

Hours read as degrees, exchanged or mirrored coordinates, a wrong camera and a
misidentified star leave large residuals and no other sign. Where the residuals
are implausible, each mistake is mended in turn and the stars are solved again.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from vopd.geometry.vectors import transform
from vopd.stellar.directions import image_points_mm
from vopd.stellar.files.image_axes import ImageAxes
from vopd.stellar.files.mended_camera import CAMERAS, SEVERAL_OF_CAMERA, mended_camera
from vopd.stellar.files.mended_coordinates import MendedStars, mended_directions, mended_images
from vopd.stellar.files.star_file import StarFile
from vopd.stellar.methods.wahba import wahba_rotation
from vopd.stellar.outlier_search import AttitudeFit, Outlier, find_outliers, fit_attitude
from vopd.stellar.star_field import StarField

CHANCE = 1e-4
"""Chance below which a mended mistake makes a difference (F test)."""

LEAST_GAIN = 9.0
"""How many times a mended mistake must make the variance of the residuals smaller."""

LARGEST_RESIDUAL = 0.01
"""Standard deviation of the residuals, in principal distances, that no reading has: half a degree.

The report's perturbed sample, with its large errors of .1 to .3 mm, has .003."""

AS_GOOD = 3.0
"""Ratio of residuals up to which a mistake about all stars is believed before one about some."""


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


def one_mistake(
    file: StarFile, stars: StarField, fit: AttitudeFit, outliers: list[Outlier], axes: ImageAxes
) -> UsualMistake | None:
    """The common mistake that, mended, makes the residuals much smaller, if one does.

    Args:
        file: the file, for its coordinates as they are written
        stars: its problem
        fit: the solution of the stars as they are
        outliers: stars that do not fit the others
        axes: how the file's image coordinates were read
    """
    coordinates = (*mended_images(file, stars, axes), *mended_directions(file, stars))
    tried = [_by_coordinates(mended, fit) for mended in coordinates]
    cameras = [_by_camera(stars, free, fit, file, axes) for free in CAMERAS]
    best = _best([*tried, *cameras, _by_wrong_stars(stars, outliers, fit)])
    if best is None or best not in cameras:
        return best
    several = _best(_by_camera(stars, free, fit, file, axes) for free in SEVERAL_OF_CAMERA)
    better = several is not None and several.sigma**2 * LEAST_GAIN < best.sigma**2
    return several if better else best


def two_mistakes(
    file: StarFile, stars: StarField, fit: AttitudeFit, axes: ImageAxes
) -> UsualMistake | None:
    """Two common mistakes that only together explain the residuals; arguments as `one_mistake`."""
    tried = [_by_camera(stars, free, fit, file, axes) for free in SEVERAL_OF_CAMERA]
    images = list(mended_images(file, stars, axes))
    directions = list(mended_directions(file, stars))
    for image in images:
        for direction in mended_directions(file, image.stars):
            both = MendedStars(f"{image.advice}, and {direction.advice}", direction.stars)
            tried.append(_by_coordinates(both, fit))
    for mended in (*images, *directions):
        for second in _second_mistakes(mended, fit, file, axes):
            tried.append(second._replace(advice=f"{mended.advice}, and {second.advice}"))
    return _best(tried)


def _second_mistakes(
    mended: MendedStars, fit: AttitudeFit, file: StarFile, axes: ImageAxes
) -> Iterator[UsualMistake]:
    """What else may be wrong where the coordinates are mended: the camera, or some stars."""
    for free in CAMERAS:
        found = _by_camera(mended.stars, free, fit, file, axes, named=not mended.moved)
        if found is not None:
            yield found
    wrong = _by_wrong_stars(mended.stars, find_outliers(mended.stars), fit)
    if wrong is not None:
        yield wrong


def _by_coordinates(mended: MendedStars, fit: AttitudeFit) -> UsualMistake | None:
    """A mistake of coordinates, tried first by the solution that takes no iteration."""
    if not _roughly_mm2(mended.stars) < fit.variance_mm2:
        return None
    return _mistake(mended.advice, fit, fit_attitude(mended.stars), mended.stars)


def _by_camera(
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


def _by_wrong_stars(
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
    unsolved = np.isinf(fit.variance_mm2)
    ratio = fit.variance_mm2 / mended.variance_mm2
    from scipy.special import fdtrc

    if not unsolved and fdtrc(fit.freedom, mended.freedom, ratio) > CHANCE:
        return None
    return UsualMistake(advice, float(np.sqrt(mended.variance_mm2)), wrong)


def _best(tried: Iterable[UsualMistake | None]) -> UsualMistake | None:
    """The mistake that leaves the least residuals, one about all stars before one about some.

    Of several that leave the same, to three digits, it is the first.
    """
    found = [one for one in tried if one is not None]
    if not found:
        return None
    largest = AS_GOOD * min(one.sigma for one in found)
    return min(found, key=lambda one: (one.sigma > largest, bool(one.stars), _rounded(one)))


def _rounded(one: UsualMistake) -> float:
    """Its residuals to three digits, as they are shown."""
    return float(f"{one.sigma:.3g}")


def _largest_mm2(stars: StarField) -> float:
    """Variance of the residuals that no reading has."""
    return (LARGEST_RESIDUAL * float(stars.focal_length_mm[0])) ** 2


def _roughly_mm2(stars: StarField) -> float:
    """Variance of the residuals of the singular-value solution, which takes no iteration."""
    matrix, _ = wahba_rotation(stars)
    computed = image_points_mm(transform(matrix, stars.directions), stars.focal_length_mm)
    return float(((stars.image_mm - computed) ** 2).sum() / (2 * len(computed) - 3))
