"""Common mistakes in star files: each is undone to see whether the stars then fit.

Hours read as degrees, exchanged or mirrored coordinates, a wrong camera and a
misidentified star leave large residuals and no other sign. Where the residuals
are implausible, each mistake is mended in turn and the stars are solved again.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from vopd.stellar.field import StarField
from vopd.stellar.files.images import ImageAxes
from vopd.stellar.files.mended_camera import CAMERAS, SEVERAL_OF_CAMERA
from vopd.stellar.files.mended_coordinates import MendedStars, mended_directions, mended_images
from vopd.stellar.files.mistake_trials import (
    LEAST_GAIN,
    UsualMistake,
    by_camera,
    by_coordinates,
    by_wrong_stars,
)
from vopd.stellar.files.star_file import StarFile
from vopd.stellar.outlier_search import AttitudeFit, Outlier, find_outliers

AS_GOOD = 3.0
"""Ratio of residuals up to which the simpler mistake is believed.

A mistake about all stars is simpler than one about some, and fewer unknowns of the camera are."""


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
    tried = [by_coordinates(mended, fit) for mended in coordinates]
    cameras = [by_camera(stars, free, fit, file, axes) for free in CAMERAS]
    best = _best([*tried, *cameras, by_wrong_stars(stars, outliers, fit)])
    if best is None or best not in cameras:
        return best
    several = _several_of_camera(stars, fit, file, axes)
    better = several is not None and several.sigma**2 * LEAST_GAIN < best.sigma**2
    return several if better else best


def two_mistakes(
    file: StarFile, stars: StarField, fit: AttitudeFit, axes: ImageAxes
) -> UsualMistake | None:
    """Two common mistakes that only together explain the residuals; arguments as `one_mistake`."""
    tried = [_several_of_camera(stars, fit, file, axes)]
    images = list(mended_images(file, stars, axes))
    directions = list(mended_directions(file, stars))
    for image in images:
        for direction in mended_directions(file, image.stars):
            both = MendedStars(f"{image.advice}, and {direction.advice}", direction.stars)
            tried.append(by_coordinates(both, fit))
    for mended in (*images, *directions):
        for second in _second_mistakes(mended, fit, file, axes):
            tried.append(second._replace(advice=f"{mended.advice}, and {second.advice}"))
    return _best(tried)


def _several_of_camera(
    stars: StarField, fit: AttitudeFit, file: StarFile, axes: ImageAxes
) -> UsualMistake | None:
    """The fewest unknowns of the camera that leave residuals nearly as small as any."""
    tried = [by_camera(stars, free, fit, file, axes) for free in SEVERAL_OF_CAMERA]
    found = [one for one in tried if one is not None]
    least = min((one.sigma for one in found), default=0.0)
    return next((one for one in found if one.sigma <= AS_GOOD * least), None)


def _second_mistakes(
    mended: MendedStars, fit: AttitudeFit, file: StarFile, axes: ImageAxes
) -> Iterator[UsualMistake]:
    """What else may be wrong where the coordinates are mended: the camera, or some stars."""
    for free in CAMERAS:
        found = by_camera(mended.stars, free, fit, file, axes, named=not mended.moved)
        if found is not None:
            yield found
    wrong = by_wrong_stars(mended.stars, find_outliers(mended.stars), fit)
    if wrong is not None:
        yield wrong


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
