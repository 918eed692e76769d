"""Common mistakes in the coordinates of a star file, undone: other images, or other directions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.findings import VopdError
from vopd.stellar.directions import star_directions
from vopd.stellar.field import StarField
from vopd.stellar.files.images import ImageAxes, centred_images
from vopd.stellar.files.star_file import StarFile


class MendedStars(NamedTuple):
    """The stars of a file with a mistake undone.

    Attributes:
        advice: what seems to be wrong and what to do about it
        stars: the problem without the mistake
        moved: whether the images are other ones
    """

    advice: str
    stars: StarField
    moved: bool = False


def mended_images(file: StarFile, stars: StarField, axes: ImageAxes) -> Iterator[MendedStars]:
    """The stars with their images mirrored, or with x and y exchanged.

    Args:
        file: the file, for its coordinates as they are written
        stars: its problem
        axes: how the file's image coordinates were read
    """
    downward = "up: no --y-down" if axes.flipped(file) else "down: --y-down"
    mirrored = (
        f"the photograph is a mirror image of the sky: y seems to point {downward} "
        "(or x and y are exchanged; only the swing tells which)"
    )
    yield MendedStars(mirrored, replace(stars, image_mm=stars.image_mm * [1.0, -1.0]), moved=True)
    if file.unit == "mm":  # the same, a quarter turn away
        return
    try:
        exchanged = centred_images(replace(file, image=file.image[:, ::-1]), axes)
    except VopdError:  # --k1 does not hold there
        return
    advice = "x_px and y_px seem to be exchanged"
    yield MendedStars(advice, replace(stars, image_mm=exchanged.points), moved=True)


def mended_directions(file: StarFile, stars: StarField) -> Iterator[MendedStars]:
    """The stars in directions by other units of right ascension and declination, or exchanged.

    Args:
        file: the file, for its right ascensions and declinations as they are written
        stars: its problem
    """
    if file.kind not in ("ra_deg,dec_deg", "ra_hours,dec_deg"):
        return
    ra_deg, dec_deg = file.positions.T
    if file.kind == "ra_hours,dec_deg":
        advice = "right ascension seems to be in degrees: name its column ra_deg"
        yield MendedStars(advice, _toward(stars, ra_deg / 15.0, dec_deg))
        return
    if (np.abs(ra_deg) <= 24.0).all():
        advice = "right ascension seems to be in hours: name its column ra_hours"
        yield MendedStars(advice, _toward(stars, ra_deg * 15.0, dec_deg))
    if (np.abs(ra_deg) <= 90.0).all():
        advice = "right ascension and declination seem to be exchanged"
        yield MendedStars(advice, _toward(stars, dec_deg, ra_deg))
    if (np.abs(ra_deg) <= 2.0 * np.pi).all() and (np.abs(dec_deg) <= np.pi / 2.0).all():
        advice = "right ascension and declination seem to be in radians: write degrees"
        yield MendedStars(advice, _toward(stars, np.degrees(ra_deg), np.degrees(dec_deg)))


def _toward(stars: StarField, ra_deg: Floats, dec_deg: Floats) -> StarField:
    """The stars with other directions."""
    return replace(stars, directions=star_directions(ra_deg, dec_deg))
