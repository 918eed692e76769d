"""The film: coordinates of the landmarks (A 233 to A 254), lens correction (A 343 to A 348)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.errata import Fix, Fixes
from vopd.job import Camera, Readings
from vopd.program.average import averages
from vopd.program.constants import factor
from vopd.program.ftlup import TableName, ftlup
from vopd.program.orient import Sight
from vopd.program.tgtcam import Dircos
from vopd.results import Results

LENS_RADII = TableName(1, "radial distances")


class FilmCoordinates(NamedTuple):
    """Frame centres and landmarks, on the reader and on the film: fields of `Results`."""

    centre_in: Floats
    point_in: Floats
    centre_mm: Floats
    point_mm: Floats


def film_coordinates(readings: Readings, fixes: Fixes) -> FilmCoordinates:
    """Average the readings and scale them from the reader to the film (A 233 to A 254)."""
    centre, point = averages(readings, rounded=Fix.EIGHT_DIGITS not in fixes)
    return FilmCoordinates(centre, point, centre * factor, point * factor)


class LensCorrection(NamedTuple):
    """Distance of each landmark from the frame's centre and its distortion: fields of `Results`."""

    radius_mm: Floats
    distortion_mm: Floats
    at_centre: Bools


def lens_correction(camera: Camera, film: FilmCoordinates, used: Bools) -> LensCorrection:
    """Look up the lens distortion of every landmark (A 343 to A 348)."""
    away = film.point_mm - film.centre_mm[:, None]
    r = np.sqrt(away[..., 0] ** 2 + away[..., 1] ** 2)
    delr = -ftlup(r, 1, camera.lens_radius_mm, camera.lens_distortion_um, LENS_RADII) / 1000.0
    return LensCorrection(
        radius_mm=np.where(used, r, np.nan),
        distortion_mm=np.where(used, delr, np.nan),
        at_centre=(r == 0) & used,
    )


def sight(
    film: FilmCoordinates,
    lens: LensCorrection,
    direction: Floats,
    used: Bools,
    focal_length_mm: Floats,
    fixes: Fixes,
) -> Sight:
    """What the Euler solve is given.

    Args:
        film: centres and landmarks on the film.
        lens: distance and distortion of the landmarks.
        direction: cosines of the landmarks (F, L, 3) along east, north, up.
        used: which landmarks take part (F, L).
        focal_length_mm: the focal length for every frame (F,).
        fixes: which errata are corrected.
    """
    r, delr = lens.radius_mm, lens.distortion_mm
    distr = np.where(r == 0, 1.0, 1.0 - delr / r)  # not 0/0 at the frame's centre
    away = film.point_mm - film.centre_mm[:, None]
    x, y = (np.ascontiguousarray((distr * away[..., k]).T) for k in (0, 1))
    dircos = Dircos(*(np.ascontiguousarray(direction[..., k].T) for k in range(3)))
    first = used.argmax(axis=1)
    xmu1 = np.broadcast_to(dircos.xmu[first, np.arange(len(first))], dircos.xmu.shape)
    return Sight(
        dircos=dircos,
        x=x,
        y=y,
        xmu1=dircos.xmu if Fix.FIRST_LANDMARK in fixes else xmu1,
        used=np.ascontiguousarray(used.T),
        cc=focal_length_mm,
    )


@np.errstate(all="ignore")
def sight_of(results: Results) -> Sight:
    """What the Euler solve of these results was given."""
    r = results
    return sight(
        FilmCoordinates(r.centre_in, r.point_in, r.centre_mm, r.point_mm),
        LensCorrection(r.radius_mm, r.distortion_mm, r.at_centre),
        r.direction,
        r.used,
        r.focal_length_mm,
        r.fixes,
    )
